//! The largest grids: 2^30 pixels, checked at many pixels against a search through the sites around. For a device with
//! 40 GiB, so by hand.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod vulkan_support;

use polder_voronoi::gpu::Stage;
use polder_voronoi::{DVec2, GridMapping, Key, MAX_SIDE, Resolution, UNCOLORED};
use polder_vulkan::RunOptions;
use rand_core::RngCore;
use std::time::Instant;
use vulkan_support::{Gpu, random};

/// Pixels of a side of a cell.
const CELL: i64 = 64;

/// Sites by cell.
struct Cells {
    across: [i64; 2],
    first: Vec<u32>,
    sites: Vec<u32>,
}

impl Cells {
    fn new([width, height]: [u32; 2], pixels: &[[u16; 2]]) -> Cells {
        let across = [width, height].map(|side| (i64::from(side) + CELL - 1) / CELL);
        let cell = |&[x, y]: &[u16; 2]| (i64::from(y) / CELL * across[0] + i64::from(x) / CELL) as usize;
        let mut first = vec![0_u32; (across[0] * across[1]) as usize + 1];
        pixels.iter().for_each(|pixel| first[cell(pixel) + 1] += 1);
        for i in 1..first.len() {
            first[i] += first[i - 1];
        }
        let (mut next, mut sites) = (first.clone(), vec![0; pixels.len()]);
        for (site, pixel) in pixels.iter().enumerate() {
            let next = &mut next[cell(pixel)];
            sites[*next as usize] = site as u32;
            *next += 1;
        }
        Cells { across, first, sites }
    }

    /// The nearest site of a pixel: of few, the best of all; else by rings of cells until none can be nearer.
    fn nearest(&self, pixels: &[[u16; 2]], pixel: [u16; 2]) -> u32 {
        if pixels.len() < 2000 {
            return (0..pixels.len() as u32).min_by_key(|&site| Key::of(pixel, pixels[site as usize])).unwrap();
        }
        let [x, y] = pixel.map(|x| i64::from(x) / CELL);
        let mut best: Option<(Key, u32)> = None;
        for ring in 0..=self.across[0].max(self.across[1]) {
            if let Some((_, site)) = best {
                let [dx, dy] = [0, 1].map(|k| i64::from(pixel[k]) - i64::from(pixels[site as usize][k]));
                let near = (ring - 1) * CELL;
                if near > 0 && near * near > dx * dx + dy * dy {
                    break;
                }
            }
            for cy in (y - ring).max(0)..=(y + ring).min(self.across[1] - 1) {
                for cx in (x - ring).max(0)..=(x + ring).min(self.across[0] - 1) {
                    if (cy - y).abs().max((cx - x).abs()) != ring {
                        continue;
                    }
                    let cell = (cy * self.across[0] + cx) as usize;
                    for &site in &self.sites[self.first[cell] as usize..self.first[cell + 1] as usize] {
                        let key = Key::of(pixel, pixels[site as usize]);
                        if best.as_ref().is_none_or(|(least, _)| key < *least) {
                            best = Some((key, site));
                        }
                    }
                }
            }
        }
        best.unwrap().1
    }
}

fn uniform(seed: u64, count: usize, [width, height]: [f64; 2]) -> Vec<DVec2> {
    let mut random = random(seed);
    let mut next = |scale: f64| (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64 * scale;
    let mut points: Vec<DVec2> = (0..count).map(|_| DVec2::new(next(width), next(height))).collect();
    // The whole grid is used.
    points.extend([DVec2::ZERO, DVec2::new(width, height)]);
    points
}

#[test]
#[ignore = "needs a device with 40 GiB"]
fn grids_of_the_most_pixels() {
    let mut gpu = Gpu::open();
    let stage = Stage::new(&gpu.device).unwrap();
    let side = f64::from(MAX_SIDE);
    for (shape, count) in [
        ([side, side], 10_000_000),
        ([side, side], 1000),
        ([side, side], 3),
        ([side, side / 7.0], 3_000_000),
        ([side / 32768.0, side], 20_000),
        ([side, side / 32768.0], 20_000),
    ] {
        let points = uniform(count as u64, count, shape);
        let mapping = GridMapping::fit(&points, &Resolution::LongerSide(MAX_SIDE).into()).unwrap();
        let [width, height] = mapping.size();
        assert_eq!(width.max(height), MAX_SIDE);
        let start = Instant::now();
        let buffers = stage.buffers(points.len(), mapping.size()).unwrap();
        let allocated = start.elapsed();
        let input = gpu.buffer(&points);
        let mut recording = gpu.recording();
        let read = stage.record(&mut recording, &mapping, input.view(), &buffers).unwrap();
        let options = RunOptions { timestamps: true, ..RunOptions::default() };
        let report = gpu.engine.run(&recording, &options).unwrap();
        let counts = read.counts(&report);
        println!(
            "{width} x {height}, {} points: {:.1} ms, {} waits, {counts:?}; {} MiB in {allocated:?}",
            points.len(),
            report.timings.total().as_secs_f64() * 1e3,
            report.waits,
            gpu.device.memory_use().used >> 20,
        );
        let pixels = gpu.fetch(buffers.pixels().slice(0..counts.sites as usize).unwrap());
        assert!(pixels.windows(2).all(|pair| (pair[0][1], pair[0][0]) < (pair[1][1], pair[1][0])));
        let colors = gpu.fetch(buffers.colors());
        let debris = gpu.fetch(buffers.debris_bits().unwrap());
        assert_eq!(counts.debris, debris.iter().map(|word| u64::from(word.count_ones())).sum::<u64>());
        let cells = Cells::new(mapping.size(), &pixels);
        let mut random = random(9);
        let total = width as u64 * u64::from(height);
        let sample = (0..100_000).map(|_| random.next_u64() % total).chain([0, total - 1, u64::from(width) - 1]);
        for index in sample {
            let color = colors[index as usize];
            assert_ne!(color, UNCOLORED);
            if debris[index as usize / 32] >> (index % 32) & 1 == 0 {
                let pixel = [(index % u64::from(width)) as u16, (index / u64::from(width)) as u16];
                assert_eq!(color, cells.nearest(&pixels, pixel), "{pixel:?} of {width} x {height}");
            }
        }
        // Every site has its own pixel.
        for (site, &[x, y]) in pixels.iter().enumerate() {
            assert_eq!(colors[usize::from(y) * width as usize + usize::from(x)], site as u32);
        }
    }
}
