//! One function for each kernel, of its name. Where a kernel takes a short way, the function takes the plain one.

use super::debris::has_closer;
use super::recolor::best_candidate;
use crate::order::{neighbors, squared_distance};
use crate::{Diagram, GridMapping, Sites, UNCOLORED, VoronoiError};
use glam::DVec2;

/// No point.
pub const NONE: u32 = u32::MAX;

/// Pixels of a tile, along x.
pub const TILE_WIDTH: u32 = 64;
/// Pixels of a tile, along y.
pub const TILE_HEIGHT: u32 = 62;
/// In a column: no row with a site.
pub const NO_ROW: u32 = 0xffff;

/// The word and the bit of a pixel in a grid of bits.
fn bit_of(pixel: [u16; 2], width: u32) -> (usize, u32) {
    (usize::from(pixel[1]) * width.div_ceil(32) as usize + usize::from(pixel[0] / 32), u32::from(pixel[0] % 32))
}

/// A grid of bits, a row of whole words for each row of pixels, with those of some pixels set.
pub fn bits_of(pixels: &[[u16; 2]], [width, height]: [u32; 2]) -> Vec<u32> {
    let mut bits = vec![0; (width.div_ceil(32) * height) as usize];
    for &pixel in pixels {
        let (word, bit) = bit_of(pixel, width);
        bits[word] |= 1 << bit;
    }
    bits
}

fn number_of(bits: &[u32], ranks: &[u32], pixel: [u16; 2], width: u32) -> u32 {
    let (word, bit) = bit_of(pixel, width);
    ranks[word] + (bits[word] & ((1 << bit) - 1)).count_ones()
}

fn numbers_of_bits(words: &[u32]) -> impl Iterator<Item = u32> {
    (0..32 * words.len() as u32).filter(|&i| words[i as usize / 32] >> (i % 32) & 1 != 0)
}

/// The pixel of each point, and a bit for each pixel that has one.
pub fn map_points(points: &[DVec2], mapping: &GridMapping) -> (Vec<[u16; 2]>, Vec<u32>) {
    let pixels: Vec<[u16; 2]> = points.iter().map(|&p| mapping.pixel(p).map(|x| x as u16)).collect();
    let bits = bits_of(&pixels, mapping.size());
    (pixels, bits)
}

/// How many bits each word has.
pub fn count_bits(words: &[u32]) -> Vec<u32> {
    words.iter().map(|word| word.count_ones()).collect()
}

/// For each pixel that has points, in order, the lowest index, as many as there are points and NONE behind; and a bit for each
/// point that is not among them.
pub fn elect_sites(pixels: &[[u16; 2]], bits: &[u32], ranks: &[u32], width: u32) -> (Vec<u32>, Vec<u32>) {
    let (mut order, mut lost) = (vec![NONE; pixels.len()], vec![0; pixels.len().div_ceil(32)]);
    for (point, &pixel) in pixels.iter().enumerate() {
        let owner = &mut order[number_of(bits, ranks, pixel, width) as usize];
        if *owner == NONE {
            *owner = point as u32;
        } else {
            lost[point / 32] |= 1 << (point % 32);
        }
    }
    (order, lost)
}

/// The pixels whose bits are set, in order.
pub fn list_sites(bits: &[u32], width: u32) -> Vec<[u16; 2]> {
    let padded = width.div_ceil(32) * 32;
    numbers_of_bits(bits).map(|i| [(i % padded) as u16, (i / padded) as u16]).collect()
}

/// The points whose bits are set, in order, and the number of the site in the pixel of each.
pub fn list_missing(
    lost: &[u32],
    pixels: &[[u16; 2]],
    bits: &[u32],
    ranks: &[u32],
    width: u32,
) -> (Vec<u32>, Vec<u32>) {
    numbers_of_bits(lost).map(|i| (i, number_of(bits, ranks, pixels[i as usize], width))).unzip()
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

/// What [`color_tiles`] gives.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tiles {
    /// The color of each pixel, [`UNCOLORED`] in tiles that are left.
    pub colors: Vec<u32>,
    /// A bit for each pixel of the others that has no closer neighbor of its color.
    pub debris_bits: Vec<u32>,
    /// The tiles that are left, ascending.
    pub left: Vec<u32>,
    /// Whether there are any in each row of tiles.
    pub wanted: Vec<u32>,
}

/// Colors the tiles in which, and next to which, no pixel is as far as `radius + 1` from its site.
pub fn color_tiles(sites: &Sites, colored: &Diagram, radius: u32) -> Tiles {
    let [width, height] = sites.size;
    let near = |index: usize| {
        let site = sites.pixels[colored.colors[index] as usize];
        squared_distance(colored.pixel(index), site) < (radius + 1) * (radius + 1)
    };
    let mut tiles = Tiles {
        colors: vec![UNCOLORED; colored.colors.len()],
        debris_bits: vec![0; colored.colors.len().div_ceil(32)],
        left: Vec::new(),
        wanted: Vec::new(),
    };
    for y in (0..height).step_by(TILE_HEIGHT as usize) {
        tiles.wanted.push(0);
        for x in (0..width).step_by(TILE_WIDTH as usize) {
            let tile = y / TILE_HEIGHT * width.div_ceil(TILE_WIDTH) + x / TILE_WIDTH;
            let rows = y.saturating_sub(1)..height.min(y + TILE_HEIGHT + 1);
            let columns = x.saturating_sub(1)..width.min(x + TILE_WIDTH + 1);
            let mut around = rows.flat_map(|y| columns.clone().map(move |x| (y * width + x) as usize));
            if !around.all(near) {
                tiles.left.push(tile);
                tiles.wanted[(y / TILE_HEIGHT) as usize] = 1;
                continue;
            }
            for index in pixels_of_tile(tile, sites.size) {
                tiles.colors[index] = colored.colors[index];
                if !has_closer(colored, sites, index) {
                    tiles.debris_bits[index / 32] |= 1 << (index % 32);
                }
            }
        }
    }
    tiles
}

/// The pixels of a tile.
pub fn pixels_of_tile(tile: u32, [width, height]: [u32; 2]) -> impl Iterator<Item = usize> {
    let across = width.div_ceil(TILE_WIDTH);
    let (x, y) = (tile % across * TILE_WIDTH, tile / across * TILE_HEIGHT);
    let columns = x..width.min(x + TILE_WIDTH);
    (y..height.min(y + TILE_HEIGHT)).flat_map(move |y| columns.clone().map(move |x| (y * width + x) as usize))
}

/// Sizes of dispatches: none if no tile is left, else as many workgroups as wanted, and one for each tile.
pub fn plan_bands(left: u32, groups: [u32; 5]) -> [[u32; 3]; 6] {
    let [a, b, c, d, e] = if left == 0 { [0; 5] } else { groups };
    let sizes = [a, b, c, d, e, left];
    sizes.map(|size| polder_vulkan::groups_for(size as usize, 1))
}

fn has_site(bits: &[u32], [x, y]: [u32; 2], width: u32) -> bool {
    let (word, bit) = bit_of([x as u16, y as u16], width);
    bits[word] >> bit & 1 != 0
}

/// For each band of rows and each column the first row with a site (lower half word) and the last (upper).
pub fn column_ends(bits: &[u32], [width, height]: [u32; 2], band: u32) -> Vec<u32> {
    let mut ends = Vec::new();
    for from in (0..height).step_by(band as usize) {
        for x in 0..width {
            let mut rows = (from..height.min(from + band)).filter(|&y| has_site(bits, [x, y], width));
            let first = rows.next();
            let last = rows.next_back().or(first);
            ends.push(last.unwrap_or(0xffff) << 16 | first.unwrap_or(0xffff));
        }
    }
    ends
}

/// For each pixel the row of the nearest site in its column, the lower one of two, or [`NO_ROW`].
pub fn column_fill(bits: &[u32], [width, height]: [u32; 2]) -> Vec<u32> {
    let mut nearest = vec![NO_ROW; (width * height) as usize];
    for x in 0..width {
        let rows: Vec<u32> = (0..height).filter(|&y| has_site(bits, [x, y], width)).collect();
        let mut place = 0;
        for y in 0..height {
            while place + 1 < rows.len() && rows[place + 1].abs_diff(y) < rows[place].abs_diff(y) {
                place += 1;
            }
            nearest[(y * width + x) as usize] = rows.get(place).copied().unwrap_or(NO_ROW);
        }
    }
    nearest
}

/// The columns, of those given, whose nearest sites win pixels of a row, each with the first pixel that it wins: by
/// comparing all.
fn winners(row: &[u32], y: u32, columns: &[u32]) -> Vec<(u32, u32)> {
    let columns: Vec<u32> = columns.iter().copied().filter(|&x| row[x as usize] != NO_ROW).collect();
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

/// Narrows each stack to those that win against all of its group of bands, gives the first of them its first pixel, and links
/// each stack that is left to the one before in its group. If the group is the row: returns the first pixel of each; an empty
/// one has that of the next. Else: for the first band of each group the last one with a stack, and `untouched` for the others.
pub fn row_merge(
    nearest: &[u32],
    [width, height]: [u32; 2],
    [band, group]: [u32; 2],
    entries: &mut [u32],
    live: &mut [u32],
    untouched: u32,
) -> Vec<u32> {
    let bands = width.div_ceil(band);
    let mut starts = vec![if group < bands { untouched } else { width }; live.len()];
    for y in 0..height {
        let row = (y * width) as usize;
        let all: Vec<u32> = (0..bands).collect();
        for group_bands in all.chunks(group as usize) {
            let columns: Vec<u32> = (group_bands[0] * band..width.min((group_bands[0] + group) * band)).collect();
            let winners = winners(&nearest[row..][..width as usize], y, &columns);
            let mut previous = 0xffff;
            for &b in group_bands {
                let (word, start) = ((y * bands + b) as usize, row + (b * band) as usize);
                let begin = live[word] & 0xff;
                let stack = &mut entries[start..][begin as usize..(live[word] >> 8 & 0xff) as usize];
                let won = |entry: &u32| winners.iter().find(|(column, _)| *column == entry & 0xffff);
                let first = stack.iter().position(|entry| won(entry).is_some());
                let last = stack.iter().rposition(|entry| won(entry).is_some());
                live[word] = 0;
                if let (Some(first), Some(last)) = (first, last) {
                    let from = won(&stack[first]).map_or(0, |(_, from)| *from);
                    stack[first] = from << 16 | stack[first] & 0xffff;
                    live[word] = previous << 16 | (begin + last as u32 + 1) << 8 | (begin + first as u32);
                    previous = b;
                    if group >= bands {
                        starts[word] = from;
                    }
                }
            }
            if group < bands {
                starts[(y * bands + group_bands[0]) as usize] = previous;
            }
        }
        for b in (0..bands.saturating_sub(1)).rev().filter(|_| group >= bands) {
            let word = (y * bands + b) as usize;
            if live[word] == 0 {
                starts[word] = starts[word + 1];
            }
        }
    }
    starts
}

/// Each pixel of some tiles takes the site that its row's stacks have for it; other pixels get none.
pub fn color_pixels(
    sites: &Sites,
    nearest: &[u32],
    entries: &[u32],
    live: &[u32],
    left: &[u32],
    band: u32,
) -> Vec<u32> {
    let [width, height] = sites.size;
    let bits = bits_of(&sites.pixels[..sites.count], sites.size);
    let (ranks, _) = polder_vulkan::reference::exclusive_scan(&count_bits(&bits));
    let bands = width.div_ceil(band);
    let mut all = vec![UNCOLORED; nearest.len()];
    for y in 0..height {
        let row = y * width;
        for b in 0..bands {
            let word = live[(y * bands + b) as usize];
            for k in word & 0xff..word >> 8 & 0xff {
                let entry = entries[(row + b * band + k) as usize];
                let column = entry & 0xffff;
                let pixel = [column as u16, nearest[(row + column) as usize] as u16];
                all[(row + (entry >> 16)) as usize..(row + width) as usize]
                    .fill(number_of(&bits, &ranks, pixel, width));
            }
        }
    }
    let mut colors = vec![UNCOLORED; all.len()];
    for index in left.iter().flat_map(|&tile| pixels_of_tile(tile, sites.size)) {
        colors[index] = all[index];
    }
    colors
}

/// A bit for each pixel of some tiles that has no closer neighbor of its own color.
pub fn mark_debris(diagram: &Diagram, sites: &Sites, left: &[u32]) -> Vec<u32> {
    let mut bits = vec![0; diagram.colors.len().div_ceil(32)];
    for index in left.iter().flat_map(|&tile| pixels_of_tile(tile, sites.size)) {
        if !has_closer(diagram, sites, index) {
            bits[index / 32] |= 1 << (index % 32);
        }
    }
    bits
}

/// The pixels whose bits are set, ascending.
pub fn list_debris(bits: &[u32]) -> Vec<u32> {
    numbers_of_bits(bits).collect()
}

/// Those neighbors of some pixels without color that have lost their last closer neighbor of their own color, ascending. A
/// device may find more in a turn: what is debris because these are.
pub fn spread_debris(diagram: &Diagram, sites: &Sites, dropped: &[u32]) -> Vec<u32> {
    let around = dropped.iter().flat_map(|&index| neighbors(diagram, diagram.pixel(index as usize)));
    let mut found: Vec<u32> = around
        .map(|pixel| diagram.index(pixel))
        .filter(|&index| diagram.colors[index] != UNCOLORED && !has_closer(diagram, sites, index))
        .map(|index| index as u32)
        .collect();
    found.sort_unstable();
    found.dedup();
    found
}

/// All pixels of a list take the best color on offer, one after the other or at once: repeated over the debris until nothing
/// changes it leads to the same colors. One after the other, here; returns the debris around those that changed, ascending.
pub fn recolor_debris(diagram: &mut Diagram, sites: &Sites, list: &[u32]) -> Vec<u32> {
    let mut next = Vec::new();
    for &index in list {
        let color = best_candidate(diagram, sites, index as usize);
        if std::mem::replace(&mut diagram.colors[index as usize], color) != color {
            let around = neighbors(diagram, diagram.pixel(index as usize)).map(|pixel| diagram.index(pixel) as u32);
            next.extend(around.filter(|index| diagram.debris.binary_search(index).is_ok()));
        }
    }
    next.sort_unstable();
    next.dedup();
    next
}

/// Finds all debris and recolors it.
///
/// # Errors
///
/// Those of [`debris`](super::debris) and [`recolor`](super::recolor).
pub fn repair(diagram: &mut Diagram, sites: &Sites) -> Result<(), VoronoiError> {
    super::debris(diagram, sites)?;
    super::recolor(diagram, sites)?;
    Ok(())
}
