//! What the stage holds on the device.

use super::Bands;
use crate::{Counts, MAX_SIDE};
use polder_vulkan::primitives::{Compact, Scan, Sort};
use polder_vulkan::{Buffer, Device, Error, Estimate, ReadBack, Recording, RunReport, View};

/// The most points: kernels reach 4 GiB from an address.
pub(super) const MOST_POINTS: usize = 1 << 28;
const WORDS: usize = 40;

/// Places of single words in the counts: views begin at multiples of 4 words.
#[derive(Clone, Copy)]
pub(super) enum Word {
    Sites = 0,
    Missing = 4,
    Debris = 8,
    DebrisRounds = 12,
    RecolorRounds = 16,
    Marked = 20,
    Candidates = 24,
    Again = 28,
    Groups = 32,
}

/// Results and scratch memory of the stage, for one number of points and one size of the grid.
///
/// Results are what [`Sites`](crate::Sites) and [`Diagram`](crate::Diagram) hold, under the same names. Scratch memory is
/// three words a pixel and, beside the sort, four words a point.
#[derive(Debug)]
pub struct Buffers {
    pub(super) points: usize,
    pub(super) size: [u32; 2],
    pub(super) order: Buffer<u32>,
    pub(super) pixels: Buffer<[u16; 2]>,
    pub(super) colors: Buffer<u32>,
    pub(super) debris: Buffer<u32>,
    pub(super) counts: Buffer<u32>,
    /// By pixel: who owns it; then site numbers in their pixels; then which pixels are debris.
    pub(super) a: Buffer<u32>,
    /// By pixel: how many sites come before it; then the nearest row; then debris as it is found, and colors for it.
    pub(super) b: Buffer<u32>,
    /// By pixel: entries of the rows' stacks; then candidates for debris.
    pub(super) c: Buffer<u32>,
    pub(super) point_pixels: Buffer<u32>,
    pub(super) lost: Buffer<u32>,
    pub(super) missing: Buffer<u32>,
    pub(super) keys: Buffer<u32>,
    pub(super) ends: Buffer<u32>,
    pub(super) live: Buffer<u32>,
    pub(super) starts: Buffer<u32>,
    pub(super) scan: Scan,
    pub(super) compact_points: Compact,
    pub(super) compact_pixels: Compact,
    pub(super) sort: Sort<u32>,
}

/// Words of bands: column ends, and row stacks.
fn bands_of([width, height]: [u32; 2], bands: Bands) -> [usize; 2] {
    [width as usize * height.div_ceil(bands.rows) as usize, height as usize * width.div_ceil(bands.columns) as usize]
}

pub(super) fn estimate(device: &Device, points: usize, size: [u32; 2], bands: Bands) -> Estimate {
    let pixels = size[0] as usize * size[1] as usize;
    let [ends, stacks] = bands_of(size, bands);
    let mut estimate = Estimate::new().buffer::<u32>("counts", WORDS);
    for name in ["order", "pixels of sites", "pixels of points", "lost", "missing", "keys"] {
        estimate = estimate.buffer::<u32>(name, points);
    }
    for name in ["colors", "debris", "pixels a", "pixels b", "pixels c"] {
        estimate = estimate.buffer::<u32>(name, pixels);
    }
    estimate
        .buffer::<u32>("column ends", ends)
        .buffer::<u32>("row stacks", stacks)
        .buffer::<u32>("row starts", stacks)
        .and(Scan::estimate(pixels))
        .and(Compact::estimate(points))
        .and(Compact::estimate(pixels))
        .and(Sort::<u32>::estimate(device, points))
}

impl Buffers {
    pub(super) fn new(device: &Device, points: usize, size: [u32; 2], bands: Bands) -> Result<Self, Error> {
        let refused = |why| Err(Error::Recording { command: "voronoi buffers", why });
        if points == 0 || points > MOST_POINTS {
            return refused(format!("{points} points; between 1 and {MOST_POINTS} are possible"));
        }
        if size.iter().any(|side| !(1..=MAX_SIDE).contains(side)) {
            return refused(format!("a grid of {size:?}; sides between 1 and {MAX_SIDE} are possible"));
        }
        estimate(device, points, size, bands).check(device)?;
        let pixels = size[0] as usize * size[1] as usize;
        let [ends, stacks] = bands_of(size, bands);
        let words = |name, len| Buffer::<u32>::new(device, name, len);
        Ok(Buffers {
            points,
            size,
            order: words("order", points)?,
            pixels: Buffer::new(device, "pixels of sites", points)?,
            colors: words("colors", pixels)?,
            debris: words("debris", pixels)?,
            counts: words("counts", WORDS)?,
            a: words("pixels a", pixels)?,
            b: words("pixels b", pixels)?,
            c: words("pixels c", pixels)?,
            point_pixels: words("pixels of points", points)?,
            lost: words("lost", points)?,
            missing: words("missing", points)?,
            keys: words("keys", points)?,
            ends: words("column ends", ends)?,
            live: words("row stacks", stacks)?,
            starts: words("row starts", stacks)?,
            scan: Scan::new(device, pixels)?,
            compact_points: Compact::new(device, points)?,
            compact_pixels: Compact::new(device, pixels)?,
            sort: Sort::new(device, points)?,
        })
    }

    /// Points that it was made for.
    pub fn points(&self) -> usize {
        self.points
    }

    /// Width and height of the grid that it was made for.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The input index of each point in the new order.
    pub fn order(&self) -> View<'_, u32> {
        self.order.view()
    }

    /// The pixel of each point in the new order.
    pub fn pixels(&self) -> View<'_, [u16; 2]> {
        self.pixels.view()
    }

    /// The site number of each pixel, row by row.
    pub fn colors(&self) -> View<'_, u32> {
        self.colors.view()
    }

    /// Which pixels are debris, ascending: as many as [`Buffers::debris_count`] says. Behind them it is not defined.
    pub fn debris(&self) -> View<'_, u32> {
        self.debris.view()
    }

    /// How many points are sites.
    pub fn site_count(&self) -> Result<View<'_, u32>, Error> {
        self.word(Word::Sites)
    }

    /// How many pixels are debris.
    pub fn debris_count(&self) -> Result<View<'_, u32>, Error> {
        self.word(Word::Debris)
    }

    pub(super) fn word(&self, word: Word) -> Result<View<'_, u32>, Error> {
        self.counts.slice(word as usize..word as usize + 1)
    }

    pub(super) fn groups(&self) -> Result<View<'_, u32>, Error> {
        self.counts.slice(Word::Groups as usize..Word::Groups as usize + 3)
    }

    /// Asks a recording to bring the counts back.
    pub fn read_counts(&self, recording: &mut Recording) -> CountsRead {
        let pixels = u64::from(self.size[0]) * u64::from(self.size[1]);
        CountsRead { words: recording.read(self.counts.view()), points: self.points as u64, pixels }
    }
}

/// Where the counts will be found in the report of a run.
#[derive(Clone, Copy, Debug)]
pub struct CountsRead {
    words: ReadBack,
    points: u64,
    pixels: u64,
}

impl CountsRead {
    /// The counts, after the whole stage.
    pub fn counts(&self, report: &RunReport) -> Counts {
        let words = report.words(self.words);
        let word = |word: Word| words.get(word as usize).map_or(0, |&word| u64::from(word));
        Counts {
            points: self.points,
            pixels: self.pixels,
            sites: word(Word::Sites),
            missing: word(Word::Missing),
            debris: word(Word::Debris),
            // The device counts the rounds that found some.
            debris_rounds: word(Word::DebrisRounds) + 1,
            recolor_rounds: word(Word::RecolorRounds),
        }
    }
}
