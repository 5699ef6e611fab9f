//! Which cells over the bounding box have points, as the kernels count them.

use crate::Bounds;
use crate::occupancy::{Cells, LEVELS, SIDE};
use glam::DVec2;

const PITCH: usize = SIDE as usize / 32;

/// A bit for each cell that has a point, of every `every` runs of eight points one; 2048 rows of as many bits.
pub fn mark_cells(points: &[DVec2], bounds: &Bounds, every: u32) -> Vec<u32> {
    let cells = Cells::of(bounds);
    let mut bits = vec![0; PITCH * SIDE as usize];
    for run in points.chunks(8).step_by(every as usize) {
        for &point in run {
            let [x, y] = cells.of_point(point);
            bits[y as usize * PITCH + x as usize / 32] |= 1 << (x % 32);
        }
    }
    bits
}

/// How many bits are set, and how many squares of 2 x 2, 4 x 4 and 8 x 8 bits have one that is.
pub fn count_cells(bits: &[u32]) -> [u32; LEVELS] {
    let mut set: Vec<[u32; 2]> = Vec::new();
    for (place, &word) in bits.iter().enumerate() {
        let [x, y] = [place % PITCH * 32, place / PITCH].map(|at| at as u32);
        set.extend((0..32).filter(|bit| word >> bit & 1 != 0).map(|bit| [x + bit, y]));
    }
    let mut counts = [0; LEVELS];
    for count in &mut counts {
        *count = set.len() as u32;
        set.iter_mut().for_each(|cell| *cell = cell.map(|at| at / 2));
        set.sort_unstable();
        set.dedup();
    }
    counts
}
