//! One function for each kernel, of its name. Where a kernel takes a short way, the function takes the plain one.

use super::debris::has_closer;
use super::recolor::best_candidate;
use crate::order::neighbors;
use crate::{Diagram, GridMapping, Sites, UNCOLORED};
use glam::DVec2;

/// In a grid or a column: no site, no owner.
pub const NONE: u32 = u32::MAX;

fn index_of([x, y]: [u16; 2], width: u32) -> usize {
    usize::from(y) * width as usize + usize::from(x)
}

/// The pixel of each point, and the lowest index that each pixel of the grid has.
pub fn map_points(points: &[DVec2], mapping: &GridMapping) -> (Vec<[u16; 2]>, Vec<u32>) {
    let [width, height] = mapping.size();
    let pixels: Vec<[u16; 2]> = points.iter().map(|&p| mapping.pixel(p).map(|x| x as u16)).collect();
    let mut owner = vec![NONE; width as usize * height as usize];
    for (point, &pixel) in pixels.iter().enumerate() {
        let owner = &mut owner[index_of(pixel, width)];
        *owner = (*owner).min(point as u32);
    }
    (pixels, owner)
}

/// A one for each owned pixel, and one for each point that does not own its pixel; zeros else.
pub fn elect_sites(pixels: &[[u16; 2]], owner: &[u32], width: u32) -> (Vec<u32>, Vec<u32>) {
    let owned = owner.iter().map(|&owner| u32::from(owner != NONE)).collect();
    let lost = |(point, &pixel): (usize, &[u16; 2])| u32::from(owner[index_of(pixel, width)] != point as u32);
    (owned, pixels.iter().enumerate().map(lost).collect())
}

/// Puts each site, and its pixel, at its number.
pub fn number_sites(
    pixels: &[[u16; 2]],
    owner: &[u32],
    number: &[u32],
    width: u32,
    order: &mut [u32],
    order_pixels: &mut [[u16; 2]],
) {
    for (point, &pixel) in pixels.iter().enumerate() {
        let index = index_of(pixel, width);
        if owner[index] == point as u32 {
            order[number[index] as usize] = point as u32;
            order_pixels[number[index] as usize] = pixel;
        }
    }
}

/// The index of the pixel of each missing point.
pub fn missing_keys(pixels: &[[u16; 2]], missing: &[u32], width: u32) -> Vec<u32> {
    missing.iter().map(|&point| index_of(pixels[point as usize], width) as u32).collect()
}

/// Puts the missing points, and their pixels, behind the sites.
pub fn number_missing(
    pixels: &[[u16; 2]],
    missing: &[u32],
    sites: usize,
    order: &mut [u32],
    order_pixels: &mut [[u16; 2]],
) {
    for (i, &point) in missing.iter().enumerate() {
        order[sites + i] = point;
        order_pixels[sites + i] = pixels[point as usize];
    }
}

/// The number of each site at its pixel.
pub fn place_sites(sites: &[[u16; 2]], width: u32, grid: &mut [u32]) {
    for (site, &pixel) in sites.iter().enumerate() {
        grid[index_of(pixel, width)] = site as u32;
    }
}

/// For each band of rows and each column the first row with a site (lower half word) and the last (upper).
pub fn column_ends(grid: &[u32], [width, height]: [u32; 2], band: u32) -> Vec<u32> {
    let mut ends = Vec::new();
    for from in (0..height).step_by(band as usize) {
        for x in 0..width {
            let mut rows = (from..height.min(from + band)).filter(|y| grid[(y * width + x) as usize] != NONE);
            let first = rows.next();
            let last = rows.next_back().or(first);
            ends.push(last.unwrap_or(0xffff) << 16 | first.unwrap_or(0xffff));
        }
    }
    ends
}

/// For each pixel the row of the nearest site in its column, the lower one of two.
pub fn column_fill(grid: &[u32], [width, height]: [u32; 2]) -> Vec<u32> {
    let mut nearest = vec![NONE; grid.len()];
    for x in 0..width {
        let rows: Vec<u32> = (0..height).filter(|y| grid[(y * width + x) as usize] != NONE).collect();
        let mut place = 0;
        for y in 0..height {
            while place + 1 < rows.len() && rows[place + 1].abs_diff(y) < rows[place].abs_diff(y) {
                place += 1;
            }
            nearest[(y * width + x) as usize] = rows.get(place).copied().unwrap_or(NONE);
        }
    }
    nearest
}

/// The columns, of those given, whose nearest sites win pixels of a row, each with the first pixel that it wins: by
/// comparing all.
fn winners(row: &[u32], y: u32, columns: &[u32]) -> Vec<(u32, u32)> {
    let columns: Vec<u32> = columns.iter().copied().filter(|&x| row[x as usize] != NONE).collect();
    let mut winners: Vec<(u32, u32)> = Vec::new();
    for pixel in 0..row.len() as u32 {
        let distance = |&x: &u32| {
            let (across, up) = (u64::from(x.abs_diff(pixel)), u64::from(row[x as usize].abs_diff(y)));
            (across * across + up * up, x)
        };
        let winner = columns.iter().copied().min_by_key(distance);
        if let Some(winner) = winner
            && winners.last().is_none_or(|&(last, _)| last != winner)
        {
            winners.push((winner, pixel));
        }
    }
    winners
}

/// For each row and each band of columns the stack of proximate sites: entries (column in the lower half word, first pixel
/// in the upper) from the band's first column on, zeros behind them; and how many, in the second byte of `live`.
pub fn row_stacks(nearest: &[u32], [width, _]: [u32; 2], band: u32) -> (Vec<u32>, Vec<u32>) {
    let (mut entries, mut live) = (vec![0; nearest.len()], Vec::new());
    for (y, row) in nearest.chunks(width as usize).enumerate() {
        let columns: Vec<u32> = (0..width).collect();
        for columns in columns.chunks(band as usize) {
            let winners = winners(row, y as u32, columns);
            live.push((winners.len() as u32) << 8);
            let start = y * width as usize + columns[0] as usize;
            for (entry, (column, from)) in entries[start..].iter_mut().zip(winners) {
                *entry = from << 16 | column;
            }
        }
    }
    (entries, live)
}

/// Narrows each stack to those that win against all of the row, gives the first of them its first pixel, links each stack
/// that is left to the one before, and returns the first pixel of each; an empty one has that of the next.
pub fn row_merge(
    nearest: &[u32],
    [width, height]: [u32; 2],
    band: u32,
    entries: &mut [u32],
    live: &mut [u32],
) -> Vec<u32> {
    let bands = width.div_ceil(band);
    let mut starts = vec![width; live.len()];
    for y in 0..height {
        let row = (y * width) as usize;
        let columns: Vec<u32> = (0..width).collect();
        let winners = winners(&nearest[row..][..width as usize], y, &columns);
        let mut previous = 0xffff;
        for b in 0..bands {
            let (word, start) = ((y * bands + b) as usize, row + (b * band) as usize);
            let stack = &mut entries[start..][..(live[word] >> 8) as usize];
            let won = |entry: &u32| winners.iter().find(|(column, _)| *column == entry & 0xffff);
            let first = stack.iter().position(|entry| won(entry).is_some());
            let last = stack.iter().rposition(|entry| won(entry).is_some());
            live[word] = 0;
            if let (Some(first), Some(last)) = (first, last) {
                let from = won(&stack[first]).map_or(0, |(_, from)| *from);
                stack[first] = from << 16 | stack[first] & 0xffff;
                live[word] = previous << 16 | (last as u32 + 1) << 8 | first as u32;
                previous = b;
                starts[word] = from;
            }
        }
        for b in (0..bands.saturating_sub(1)).rev() {
            let word = (y * bands + b) as usize;
            if live[word] == 0 {
                starts[word] = starts[word + 1];
            }
        }
    }
    starts
}

/// Each pixel takes the site that its row's stacks have for it.
pub fn color_pixels(
    grid: &[u32],
    nearest: &[u32],
    entries: &[u32],
    live: &[u32],
    [width, height]: [u32; 2],
    band: u32,
) -> Vec<u32> {
    let bands = width.div_ceil(band);
    let mut colors = vec![UNCOLORED; grid.len()];
    for y in 0..height {
        let row = y * width;
        for b in 0..bands {
            let word = live[(y * bands + b) as usize];
            for k in word & 0xff..word >> 8 & 0xff {
                let entry = entries[(row + b * band + k) as usize];
                let column = entry & 0xffff;
                let site = grid[(nearest[(row + column) as usize] * width + column) as usize];
                colors[(row + (entry >> 16)) as usize..(row + width) as usize].fill(site);
            }
        }
    }
    colors
}

/// The pixels that have no closer neighbor of their own color.
pub fn mark_debris(diagram: &Diagram, sites: &Sites) -> Vec<u32> {
    let all: Vec<u32> = (0..diagram.colors.len() as u32).collect();
    check_debris(diagram, sites, &all)
}

/// Takes the color from the marked pixels; returns those neighbors, in order, that have kept the same color.
pub fn drop_debris(diagram: &mut Diagram, marked: &[u32]) -> Vec<u32> {
    let mut candidates = Vec::new();
    for &index in marked {
        let color = diagram.colors[index as usize];
        let around = neighbors(diagram, diagram.pixel(index as usize)).map(|p| diagram.index(p));
        candidates.extend(around.filter(|&i| diagram.colors[i] == color).map(|i| i as u32));
    }
    marked.iter().for_each(|&index| diagram.colors[index as usize] = UNCOLORED);
    candidates.sort_unstable();
    candidates.dedup();
    candidates.retain(|&index| diagram.colors[index as usize] != UNCOLORED);
    candidates
}

/// Those of the candidates that have no closer neighbor of their own color.
pub fn check_debris(diagram: &Diagram, sites: &Sites, candidates: &[u32]) -> Vec<u32> {
    candidates.iter().copied().filter(|&index| !has_closer(diagram, sites, index as usize)).collect()
}

/// Workgroups for so many items, of which one takes `items`.
pub fn advance_round(count: u32, items: u32) -> [u32; 3] {
    polder_vulkan::groups_for(count as usize, items)
}

/// The best color on offer to each debris pixel.
pub fn find_color(diagram: &Diagram, sites: &Sites) -> Vec<u32> {
    diagram.debris.iter().map(|&index| best_candidate(diagram, sites, index as usize)).collect()
}

/// All debris takes what it found; whether a pixel changed that has debris around it.
pub fn take_color(diagram: &mut Diagram, found: &[u32]) -> bool {
    let mut again = false;
    for (i, &color) in found.iter().enumerate() {
        let index = diagram.debris[i] as usize;
        if std::mem::replace(&mut diagram.colors[index], color) != color {
            let is_debris = |p: [u16; 2]| diagram.debris.binary_search(&(diagram.index(p) as u32)).is_ok();
            again |= neighbors(diagram, diagram.pixel(index)).any(is_debris);
        }
    }
    again
}
