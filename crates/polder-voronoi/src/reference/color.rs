//! The exact Euclidean coloring in linear time, by the Parallel Banding Algorithm run in sequence: \[QCT\] section 3.1.
//!
//! 1. Each column by itself: for every pixel the nearest site of its column.
//! 2. Each row by itself: of these one site a column, those that are nearest to some pixel of the row, as a stack; a
//!    newcomer takes off the stack whom it dominates together with the one below.
//! 3. Each row again: its pixels take the color of the stack's entries one after the other.
//!
//! Ties are settled by [`Key`](crate::Key) in every step, so that the result is that of comparing every pixel with
//! every site: within a column the lower site wins, between columns the left one. Both follow from the order for a
//! fixed pixel, and neither depends on which pixel of the row asks.

use crate::{Diagram, Sites, VoronoiError};

/// No site in this column.
const NONE: u32 = u32::MAX;

/// An entry of a row's stack: a site, and the first pixel that it wins against those below.
#[derive(Clone, Copy)]
struct Entry {
    x: i64,
    /// Square of the vertical distance.
    rise: i64,
    from: i64,
    color: u32,
}

/// Colors every pixel by its nearest site, in the order of [`Key`](crate::Key).
///
/// # Errors
///
/// Those of [`Sites::check`].
pub fn color(sites: &Sites) -> Result<Diagram, VoronoiError> {
    sites.check()?;
    let [width, height] = sites.size;
    let mut colors = nearest_in_column(sites);
    let mut stack: Vec<Entry> = Vec::with_capacity(width as usize);
    for (y, row) in colors.chunks_exact_mut(width as usize).enumerate() {
        proximate_sites(sites, y as i64, row, &mut stack);
        color_row(row, &stack);
    }
    Ok(Diagram { width, height, colors, debris: Vec::new() })
}

/// Step 1: two sweeps over the rows, upward for the nearest site below, downward for the nearest above.
fn nearest_in_column(sites: &Sites) -> Vec<u32> {
    let [width, height] = sites.size.map(|side| side as usize);
    let mut colors = vec![NONE; width * height];
    for (site, &[x, y]) in sites.pixels[..sites.count].iter().enumerate() {
        colors[usize::from(y) * width + usize::from(x)] = site as u32;
    }
    for y in 1..height {
        let (below, row) = colors.split_at_mut(y * width);
        for (color, &below) in row[..width].iter_mut().zip(&below[(y - 1) * width..]) {
            *color = if *color == NONE { below } else { *color };
        }
    }
    let row_of = |site: u32| i64::from(sites.pixels[site as usize][1]);
    let mut above = vec![NONE; width];
    for y in (0..height).rev() {
        let row = &mut colors[y * width..][..width];
        for (color, above) in row.iter_mut().zip(&mut above) {
            let below = *color;
            if below != NONE && row_of(below) == y as i64 {
                *above = below;
            } else if *above != NONE && (below == NONE || row_of(*above) - (y as i64) < y as i64 - row_of(below)) {
                *color = *above;
            }
        }
    }
    colors
}

/// Step 2. The entries' first pixels ascend strictly and start at 0.
fn proximate_sites(sites: &Sites, y: i64, row: &[u32], stack: &mut Vec<Entry>) {
    stack.clear();
    let width = row.len() as i64;
    for (x, &color) in row.iter().enumerate().filter(|&(_, &color)| color != NONE) {
        let rise = i64::from(sites.pixels[color as usize][1]) - y;
        let mut entry = Entry { x: x as i64, rise: rise * rise, from: 0, color };
        while let Some(top) = stack.last() {
            entry.from = takes_over(top, &entry);
            if entry.from > top.from {
                break;
            }
            entry.from = 0;
            stack.pop();
        }
        if entry.from < width {
            stack.push(entry);
        }
    }
}

/// The first pixel, at least 0, that is strictly nearer to the right one of two sites: ties go to the left.
fn takes_over(left: &Entry, right: &Entry) -> i64 {
    // (p - right.x)^2 + right.rise < (p - left.x)^2 + left.rise, solved for p
    let numerator = (right.x * right.x + right.rise) - (left.x * left.x + left.rise);
    (numerator.div_euclid(2 * (right.x - left.x)) + 1).max(0)
}

/// Step 3.
fn color_row(row: &mut [u32], stack: &[Entry]) {
    let ends = stack.iter().skip(1).map(|next| next.from as usize).chain([row.len()]);
    for (entry, end) in stack.iter().zip(ends) {
        row[entry.from as usize..end].fill(entry.color);
    }
}
