//! From points to sites: \[QCT\] section 3.1, first paragraph.
//!
//! 1. Every point claims its pixel; the lowest index keeps it.
//! 2. The sites are numbered in pixel order, row by row.
//! 3. The points that lost, the missing ones, follow in pixel order, those of one pixel by index: counted for each
//!    pixel, summed up, put in place.

use crate::{GridMapping, MAX_SIDE, Sites, VoronoiError};
use glam::DVec2;

const NOBODY: u32 = u32::MAX;

/// Elects the sites and renumbers the points. A point equal to a site is missing like any other.
///
/// # Errors
///
/// If there are no points, or more than 32-bit numbers can count. A point outside the grid goes to the nearest pixel
/// along each axis.
pub fn map(points: &[DVec2], mapping: &GridMapping) -> Result<Sites, VoronoiError> {
    let pixels: Vec<[u16; 2]> = points.iter().map(|&p| mapping.pixel(p).map(|x| x as u16)).collect();
    elect(mapping.size(), &pixels)
}

/// The same from the points' pixels, which must lie in the grid.
///
/// # Errors
///
/// As [`map`], and if the size is impossible or a pixel lies outside of it.
pub fn elect(size: [u32; 2], pixels: &[[u16; 2]]) -> Result<Sites, VoronoiError> {
    if let Some(&side) = size.iter().find(|side| !(1..=MAX_SIDE).contains(*side)) {
        return Err(VoronoiError::GridSide { side, limit: MAX_SIDE });
    }
    let (points, limit) = (pixels.len(), (u32::MAX - 1) as usize);
    if points == 0 {
        return Err(VoronoiError::NoPoints);
    }
    if points > limit {
        return Err(VoronoiError::TooManyPoints { points, limit });
    }
    let outside = |&[x, y]: &[u16; 2]| u32::from(x) >= size[0] || u32::from(y) >= size[1];
    if let Some(index) = pixels.iter().position(outside) {
        return Err(VoronoiError::Mismatch { what: "a pixel outside the grid", index });
    }
    let index = |[x, y]: [u16; 2]| usize::from(y) * size[0] as usize + usize::from(x);

    let mut owner = vec![NOBODY; size[0] as usize * size[1] as usize];
    for (point, &pixel) in pixels.iter().enumerate() {
        let owner = &mut owner[index(pixel)];
        *owner = (*owner).min(point as u32);
    }
    let mut order: Vec<u32> = owner.iter().copied().filter(|&point| point != NOBODY).collect();
    let count = order.len();

    if count < points {
        let lost = |point: usize| owner[index(pixels[point])] != point as u32;
        let missing: Vec<u32> = (0..points).filter(|&point| lost(point)).map(|point| point as u32).collect();
        // From here on: the slot that the next missing point of each pixel takes.
        let mut slot = owner;
        slot.fill(0);
        missing.iter().for_each(|&point| slot[index(pixels[point as usize])] += 1);
        let mut sum = count as u32;
        for slot in &mut slot {
            sum += std::mem::replace(slot, sum);
        }
        order.resize(points, NOBODY);
        for &point in &missing {
            let slot = &mut slot[index(pixels[point as usize])];
            order[*slot as usize] = point;
            *slot += 1;
        }
    }
    let pixels = order.iter().map(|&point| pixels[point as usize]).collect();
    Ok(Sites { size, order, count, pixels })
}
