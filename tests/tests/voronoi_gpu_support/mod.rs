//! One device for all tests of a file, and sites to color.
#![allow(dead_code, clippy::unwrap_used, reason = "tests; each takes what it needs")]

use crate::vulkan_support::{Gpu, words};
use polder_voronoi::gpu::{Bands, Buffers, Stage};
use polder_voronoi::{Sites, reference};
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

pub(crate) struct Shared {
    pub(crate) gpu: Gpu,
    /// With the bands that users get, and with short ones that make many of a small grid.
    pub(crate) stages: [Stage; 2],
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
        (gpu, &stages[stage], buffers)
    }
}

static SHARED: Mutex<Option<Shared>> = Mutex::new(None);

pub(crate) const SHORT: Bands = Bands { rows: 5, columns: 7 };

/// Runs a test on the device of this process; the validation layer must have had nothing to say.
pub(crate) fn with_device(test: impl FnOnce(&mut Shared)) {
    let mut shared = SHARED.lock().unwrap_or_else(PoisonError::into_inner);
    let shared = shared.get_or_insert_with(|| {
        let gpu = Gpu::open();
        let stages = [Stage::new(&gpu.device).unwrap(), Stage::with_bands(&gpu.device, SHORT).unwrap()];
        Shared { gpu, stages, held: HashMap::new() }
    });
    test(shared);
    assert_eq!(shared.gpu.device.validation_messages(), Vec::<String>::new());
}

/// Some `count` points on pixels anywhere in a grid.
pub(crate) fn anywhere(size: [u32; 2], count: usize, seed: u64) -> Sites {
    let at = |pair: &[u32]| [(pair[0] % size[0]) as u16, (pair[1] % size[1]) as u16];
    elected(size, &words(seed, 2 * count).chunks(2).map(at).collect::<Vec<_>>())
}

pub(crate) fn elected(size: [u32; 2], pixels: &[[u16; 2]]) -> Sites {
    reference::elect(size, pixels).unwrap()
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
    grids
}
