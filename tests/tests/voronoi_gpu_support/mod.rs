//! One device for all tests of a file, and sites to color.
#![allow(dead_code, clippy::unwrap_used, reason = "tests; each takes what it needs")]

use crate::vulkan_support::{Gpu, words};
use polder_voronoi::gpu::{Buffers, Stage, Tuning};
use polder_voronoi::{Sites, reference};
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

pub(crate) struct Shared {
    pub(crate) gpu: Gpu,
    /// As users get it; with short bands, many in a small grid, for everything; and with them for what is not very near.
    pub(crate) stages: [Stage; 3],
    /// For each stage and size, kept: making them costs more than a test, and what they hold from before must not matter.
    held: HashMap<(usize, [u32; 2]), Buffers>,
}

impl Shared {
    /// Buffers of a stage that hold these sites, as mapping would leave them.
    pub(crate) fn holding(&mut self, stage: usize, sites: &Sites) -> (&mut Gpu, &Stage, &Buffers) {
        let Shared { gpu, stages, held } = self;
        let pixels = (sites.size[0] * sites.size[1]) as usize;
        let make = || stages[stage].buffers(pixels, sites.size).unwrap();
        let buffers = held.entry((stage, sites.size)).or_insert_with(make);
        gpu.engine.upload(buffers.pixels(), &sites.pixels[..sites.count]).unwrap();
        gpu.engine.upload(buffers.site_count().unwrap(), &[sites.count as u32]).unwrap();
        let (bits, ranks) = ranked(sites);
        gpu.engine.upload(buffers.site_bits(), &bits).unwrap();
        gpu.engine.upload(buffers.site_ranks(), &ranks).unwrap();
        (gpu, &stages[stage], buffers)
    }
}

static SHARED: Mutex<Option<Shared>> = Mutex::new(None);

pub(crate) const SHORT: Tuning = Tuning { radius: 0, rows: 5, columns: 7, tile_lanes: 64, row_lanes: 32 };

/// The bits of the sites, and how many stand before each word.
pub(crate) fn ranked(sites: &Sites) -> (Vec<u32>, Vec<u32>) {
    let bits = reference::kernels::bits_of(&sites.pixels[..sites.count], sites.size);
    let (ranks, _) = polder_vulkan::reference::exclusive_scan(&reference::kernels::count_bits(&bits));
    (bits, ranks)
}

/// Runs a test on the device of this process; the validation layer must have had nothing to say.
pub(crate) fn with_device(test: impl FnOnce(&mut Shared)) {
    let mut shared = SHARED.lock().unwrap_or_else(PoisonError::into_inner);
    let shared = shared.get_or_insert_with(|| {
        let gpu = Gpu::open();
        let make = |tuning| Stage::with_tuning(&gpu.device, tuning).unwrap();
        let stages = [
            Stage::new(&gpu.device).unwrap(),
            make(SHORT),
            make(Tuning { radius: 8, rows: 30, columns: 20, ..Tuning::default() }),
        ];
        Shared { gpu, stages, held: HashMap::new() }
    });
    test(shared);
    assert_eq!(shared.gpu.device.validation_messages(), Vec::<String>::new());
    assert_eq!(shared.gpu.device.overruns(), Vec::<String>::new());
}

/// Some `count` points on pixels anywhere in a grid.
pub(crate) fn anywhere(size: [u32; 2], count: usize, seed: u64) -> Sites {
    let at = |pair: &[u32]| [(pair[0] % size[0]) as u16, (pair[1] % size[1]) as u16];
    elected(size, &words(seed, 2 * count).chunks(2).map(at).collect::<Vec<_>>())
}

pub(crate) fn elected(size: [u32; 2], pixels: &[[u16; 2]]) -> Sites {
    reference::elect(size, pixels).unwrap()
}

/// Many small circles of sites: every pixel has one near, and the regions in the middle of a circle are long and thin.
pub(crate) fn rings(size: [u32; 2], radius: f64) -> Sites {
    let spacing = 2 * radius as u32 + 2;
    let corners = (0..size[1]).step_by(spacing as usize);
    let corners = corners.flat_map(|y| (0..size[0]).step_by(spacing as usize).map(move |x| [x, y]));
    let mut pixels = Vec::new();
    for (ring, corner) in corners.enumerate() {
        let turns = words(900 + ring as u64, 160);
        let part = |i: usize| f64::from(turns[i]) / 4_294_967_296.0;
        for i in 2..turns.len() {
            let (sin, cos) = (part(i) * std::f64::consts::TAU).sin_cos();
            let [x, y] = [[cos, part(0)], [sin, part(1)]].map(|[along, off]| radius * (1.0 + along) + off);
            let (x, y) = (f64::from(corner[0]) + x, f64::from(corner[1]) + y);
            if x < f64::from(size[0]) && y < f64::from(size[1]) {
                pixels.push([x as u16, y as u16]);
            }
        }
    }
    elected(size, &pixels)
}

/// Grids with sites on them: strips, empty rows and columns, lines, dense and sparse ones.
pub(crate) fn grids() -> Vec<(String, Sites)> {
    let mut grids = Vec::new();
    let mut add = |name: &str, sites: Sites| grids.push((format!("{name}, {:?}", sites.size), sites));
    let sizes = [[1, 1], [1, 2], [2, 1], [3, 3], [1, 257], [257, 1], [64, 65], [130, 7], [7, 130]];
    for (seed, size) in sizes.into_iter().enumerate() {
        let pixels = (size[0] * size[1]) as usize;
        for count in [1, 2, pixels.div_ceil(50), pixels.div_ceil(7), pixels, 4 * pixels] {
            add(&format!("{count} anywhere"), anywhere(size, count, 100 * seed as u64 + count as u64));
        }
        let [last_x, last_y] = size.map(|side| side as u16 - 1);
        add("corners", elected(size, &[[0, 0], [last_x, 0], [0, last_y], [last_x, last_y]]));
        let all = |keep: fn([u16; 2]) -> bool| {
            let pixels = (0..=last_y).flat_map(|y| (0..=last_x).map(move |x| [x, y])).filter(|&p| keep(p));
            elected(size, &pixels.collect::<Vec<_>>())
        };
        add("every pixel", all(|_| true));
        add("one row", all(|[_, y]| y == 0));
        add("one column", all(|[x, _]| x == 0));
        add("every other row", all(|[x, y]| y % 2 == 0 && (x + y) % 3 == 0));
        add("lattice", all(|[x, y]| x % 4 == 0 && y % 4 == 0));
        add("diagonal", all(|[x, y]| x == y));
        add("far rows", all(|[x, y]| y % 60 == 0 && x % 9 == y / 60));
    }
    // Tiles of all kinds: inner ones, and some that are left to the bands beside others that are not.
    for (seed, size) in [[64, 62], [128, 124], [200, 190], [129, 125]].into_iter().enumerate() {
        for sparse in [7, 40, 150, 400] {
            let count = (size[0] * size[1]) as usize / sparse;
            add(&format!("one in {sparse}"), anywhere(size, count, 7000 + seed as u64));
        }
    }
    add("rings", rings([200, 190], 16.0));
    add("larger rings", rings([190, 200], 24.0));
    grids
}
