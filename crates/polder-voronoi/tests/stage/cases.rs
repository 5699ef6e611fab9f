//! Grids to test on: families of sites, each a pure function of a seed.

use polder_voronoi::{Sites, reference};

/// SplitMix64.
pub(crate) struct Random(pub u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `end`.
    pub(crate) fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }

    /// A number in `[0, 1)`.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Family {
    /// A few sites on a grid of any shape.
    Sparse,
    /// One pixel in seven is a site's.
    Random,
    /// Most pixels are sites'.
    Dense,
    /// Sites on one slanted line.
    Line,
    /// Sites along a diagonal, a pixel or two off it.
    NearDiagonal,
    /// Sites on a circle around the middle.
    Circle,
    /// Pairs of sites mirrored at both axes: many ties.
    Cocircular,
    /// Sites on a lattice: ties everywhere.
    Lattice,
    /// One pixel high.
    Strip,
    /// One pixel wide.
    Column,
    /// A large grid, all sites in one row.
    OneRow,
    /// A single site.
    Single,
    /// A single pixel.
    Pixel,
}

pub(crate) const FAMILIES: [Family; 13] = [
    Family::Sparse,
    Family::Random,
    Family::Dense,
    Family::Line,
    Family::NearDiagonal,
    Family::Circle,
    Family::Cocircular,
    Family::Lattice,
    Family::Strip,
    Family::Column,
    Family::OneRow,
    Family::Single,
    Family::Pixel,
];

/// The families with sharp corners, where debris arises.
pub(crate) const SHARP: [Family; 3] = [Family::Circle, Family::NearDiagonal, Family::Sparse];

/// Sites on a grid with sides of at most `side` pixels, `side >= 8`.
pub(crate) fn sites(family: Family, side: usize, seed: u64) -> Sites {
    let random = &mut Random(seed);
    let any_side = |random: &mut Random| 2 + random.below(side - 1);
    let [width, height] = match family {
        Family::Strip => [any_side(random), 1],
        Family::Column => [1, any_side(random)],
        Family::Circle | Family::NearDiagonal => [side, side],
        Family::Pixel => [1, 1],
        _ => [any_side(random), any_side(random)],
    };
    let anywhere = |random: &mut Random| [random.below(width), random.below(height)];
    let mut pixels: Vec<[usize; 2]> = Vec::new();
    match family {
        Family::Sparse => {
            let count = 1 + random.below(8);
            pixels.extend((0..count).map(|_| anywhere(random)));
        }
        Family::Random | Family::Strip | Family::Column => {
            let count = 1 + width * height / 7;
            pixels.extend((0..count).map(|_| anywhere(random)));
        }
        Family::Dense => {
            let count = 2 * width * height;
            pixels.extend((0..count).map(|_| anywhere(random)));
        }
        Family::Line => {
            let (start, end, count) = (anywhere(random), anywhere(random), 1 + random.below(side));
            let along = |k: usize, i: usize| {
                (start[k] as i64 + (end[k] as i64 - start[k] as i64) * i as i64 / count as i64) as usize
            };
            pixels.extend((0..=count).map(|i| [along(0, i), along(1, i)]));
        }
        Family::NearDiagonal => {
            let (count, shift) = (3 + random.below(side), random.below(side / 2));
            for _ in 0..count {
                let along = random.below(width);
                let off = (along * (4 + shift) / (5 + shift) + random.below(3)).min(height - 1);
                pixels.push([along, off]);
            }
        }
        Family::Circle => {
            let (count, radius) = (3 + random.below(4 * side), side as f64 * (0.3 + 0.2 * random.unit()));
            let center = side as f64 / 2.0;
            for _ in 0..count {
                let angle = random.unit() * std::f64::consts::TAU;
                let at = |x: f64| ((center + radius * x) as usize).min(side - 1);
                pixels.push([at(angle.cos()), at(angle.sin())]);
            }
        }
        Family::Cocircular => {
            for _ in 0..1 + random.below(4) {
                let [x, y] = anywhere(random);
                let mirrored = [width - 1 - x, height - 1 - y];
                pixels.extend([[x, y], [mirrored[0], y], [x, mirrored[1]], mirrored]);
            }
        }
        Family::Lattice => {
            let step = [1 + random.below(6), 1 + random.below(6)];
            let columns = (0..width).step_by(step[0]);
            pixels.extend(columns.flat_map(|x| (0..height).step_by(step[1]).map(move |y| [x, y])));
        }
        Family::OneRow => {
            let y = random.below(height);
            let count = 1 + random.below(width);
            pixels.extend((0..count).map(|_| [random.below(width), y]));
        }
        Family::Single => pixels.push(anywhere(random)),
        Family::Pixel => pixels.extend([[0, 0]; 3]),
    }
    let pixels: Vec<[u16; 2]> = pixels.iter().map(|p| p.map(|x| x as u16)).collect();
    reference::elect([width as u32, height as u32], &pixels).unwrap()
}

/// The sites without number `removed`.
pub(crate) fn without(sites: &Sites, removed: usize) -> Sites {
    let mut pixels = sites.pixels[..sites.count].to_vec();
    pixels.remove(removed);
    reference::elect(sites.size, &pixels).unwrap()
}

/// The neighbors of a pixel, by definition.
pub(crate) fn neighbors([width, height]: [u32; 2], [x, y]: [u16; 2]) -> impl Iterator<Item = [u16; 2]> {
    let columns = x.saturating_sub(1)..=(x + 1).min(width as u16 - 1);
    let around = columns.flat_map(move |a| (y.saturating_sub(1)..=(y + 1).min(height as u16 - 1)).map(move |b| [a, b]));
    around.filter(move |&p| p != [x, y])
}

/// All pixels of a grid, row by row.
pub(crate) fn pixels([width, height]: [u32; 2]) -> impl Iterator<Item = [u16; 2]> {
    (0..height as u16).flat_map(move |y| (0..width as u16).map(move |x| [x, y]))
}
