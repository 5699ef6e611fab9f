//! What the stage holds on the device.

use super::Tuning;
use crate::reference::kernels::{TILE_HEIGHT, TILE_WIDTH};
use crate::{Counts, MAX_SIDE};
use polder_vulkan::primitives::{Scan, Sort};
use polder_vulkan::{Buffer, Device, Error, Estimate, Pool, ReadBack, Recording, RunReport, View};

/// The most points: kernels reach 4 GiB from an address.
pub(super) const MOST_POINTS: usize = 1 << 28;
const WORDS: usize = 92;

/// Places of single words in the counts: views begin at multiples of 4 words.
#[derive(Clone, Copy)]
pub(super) enum Word {
    Sites = 0,
    Missing = 4,
    /// From here on zeros before coloring.
    Debris = 8,
    AnyDebris = 12,
    Left = 16,
    Unfinished = 20,
    /// Of repair, words four apart; the first four count the debris that was marked, and that of each turn after.
    Progress = 24,
    Phase = 48,
    ListedOnce = 60,
    Listed = 64,
    /// Six sizes of dispatches.
    Groups = 68,
}

/// Dispatches whose sizes `plan_bands` writes, in its order.
#[derive(Clone, Copy)]
pub(super) enum Planned {
    ColumnEnds,
    ColumnFill,
    RowStacks,
    MergeGroups,
    MergeRows,
    Tiles,
}

/// Results and scratch memory of the stage, for one number of points and one size of the grid.
///
/// Results are what [`Sites`](crate::Sites) and [`Diagram`](crate::Diagram) hold, under the same names. Scratch memory is
/// two words and about a byte a pixel and, beside the sort, a word and a quarter byte a point.
#[derive(Debug)]
pub struct Buffers {
    pub(super) points: usize,
    pub(super) size: [u32; 2],
    pub(super) order: Buffer<u32>,
    pub(super) pixels: Buffer<[u16; 2]>,
    pub(super) colors: Buffer<u32>,
    pub(super) counts: Buffer<u32>,
    /// A bit a pixel, 32 pixels of a row in a word.
    pub(super) site_bits: Buffer<u32>,
    pub(super) site_ranks: Buffer<u32>,
    /// Three times a bit a pixel, without gaps: which pixels are debris, and which stand on the one list and the other.
    pub(super) debris_bits: Buffer<u32>,
    /// The pixels of the points; then the nearest row of each pixel, half a word; then lists of debris.
    pub(super) a: Buffer<u32>,
    /// What the missing points are sorted by; then entries of the rows' stacks; then lists of debris.
    pub(super) b: Buffer<u32>,
    pub(super) missing: Buffer<u32>,
    /// A bit a point.
    pub(super) lost: Buffer<u32>,
    pub(super) lost_ranks: Buffer<u32>,
    pub(super) left: Buffer<u32>,
    pub(super) wanted: Buffer<u32>,
    pub(super) ends: Buffer<u32>,
    pub(super) live: Buffer<u32>,
    pub(super) starts: Buffer<u32>,
    pub(super) scan: Scan,
    pub(super) sort: Sort<u32>,
}

/// Words of a bit a pixel, so many that another view can begin behind them.
fn debris_words(pixels: usize) -> usize {
    pixels.div_ceil(128) * 4
}

/// How many words each array has.
struct Lengths {
    points: usize,
    pixels: usize,
    site_bits: usize,
    debris_bits: usize,
    scratch: usize,
    lost: usize,
    tiles: usize,
    tile_rows: usize,
    ends: usize,
    stacks: usize,
}

impl Lengths {
    fn of(points: usize, [width, height]: [u32; 2], tuning: Tuning) -> Self {
        let (columns, rows) = (width as usize, height as usize);
        let pixels = columns * rows;
        let site_bits = columns.div_ceil(32) * rows;
        let tile_rows = height.div_ceil(TILE_HEIGHT) as usize;
        Lengths {
            points,
            pixels,
            site_bits,
            debris_bits: 3 * debris_words(pixels),
            scratch: pixels.max(points),
            lost: points.div_ceil(32),
            tiles: width.div_ceil(TILE_WIDTH) as usize * tile_rows,
            tile_rows,
            ends: columns * height.div_ceil(tuning.rows) as usize,
            stacks: rows * width.div_ceil(tuning.columns) as usize,
        }
    }

    fn scanned(&self) -> usize {
        self.site_bits.max(self.lost)
    }
}

pub(super) fn estimate(device: &Device, points: usize, size: [u32; 2], tuning: Tuning) -> Estimate {
    let lengths = Lengths::of(points, size, tuning);
    let mut estimate = Estimate::new().buffer::<u32>("counts", WORDS);
    for (name, len) in [
        ("order", lengths.points),
        ("pixels of points", lengths.points),
        ("colors", lengths.pixels),
        ("bits of sites", lengths.site_bits),
        ("ranks of sites", lengths.site_bits),
        ("bits of debris", lengths.debris_bits),
        ("scratch a", lengths.scratch),
        ("scratch b", lengths.scratch),
        ("missing points", lengths.points),
        ("bits of points that lost", lengths.lost),
        ("ranks of points that lost", lengths.lost),
        ("tiles left", lengths.tiles),
        ("rows of tiles wanted", lengths.tile_rows),
        ("column ends", lengths.ends),
        ("row stacks", lengths.stacks),
        ("row starts", lengths.stacks),
    ] {
        estimate = estimate.buffer::<u32>(name, len);
    }
    estimate.and(Scan::estimate(lengths.scanned())).and(Sort::<u32>::estimate(device, points))
}

impl Buffers {
    pub(super) fn new(device: &Device, points: usize, size: [u32; 2], tuning: Tuning) -> Result<Self, Error> {
        let refused = |why| Err(Error::Recording { command: "voronoi buffers", why });
        if points == 0 || points > MOST_POINTS {
            return refused(format!("{points} points; between 1 and {MOST_POINTS} are possible"));
        }
        if size.iter().any(|side| !(1..=MAX_SIDE).contains(side)) {
            return refused(format!("a grid of {size:?}; sides between 1 and {MAX_SIDE} are possible"));
        }
        estimate(device, points, size, tuning).check(device)?;
        let lengths = Lengths::of(points, size, tuning);
        let words = |name, len| Buffer::<u32>::new(device, name, len);
        Ok(Buffers {
            points,
            size,
            order: words("order", points)?,
            pixels: Buffer::new(device, "pixels of points", points)?,
            colors: words("colors", lengths.pixels)?,
            counts: words("counts", WORDS)?,
            site_bits: words("bits of sites", lengths.site_bits)?,
            site_ranks: words("ranks of sites", lengths.site_bits)?,
            debris_bits: words("bits of debris", lengths.debris_bits)?,
            a: words("scratch a", lengths.scratch)?,
            b: words("scratch b", lengths.scratch)?,
            missing: words("missing points", points)?,
            lost: words("bits of points that lost", lengths.lost)?,
            lost_ranks: words("ranks of points that lost", lengths.lost)?,
            left: words("tiles left", lengths.tiles)?,
            wanted: words("rows of tiles wanted", lengths.tile_rows)?,
            ends: words("column ends", lengths.ends)?,
            live: words("row stacks", lengths.stacks)?,
            starts: words("row starts", lengths.stacks)?,
            scan: Scan::new(device, lengths.scanned())?,
            sort: Sort::new(device, points)?,
        })
    }

    /// Gives what only the stage itself needs; see [`Buffer::give`].
    pub fn give_scratch(&self, pool: &Pool) {
        self.site_bits.give(pool);
        self.site_ranks.give(pool);
        self.a.give(pool);
        self.b.give(pool);
        self.missing.give(pool);
        self.lost.give(pool);
        self.lost_ranks.give(pool);
        self.ends.give(pool);
        self.live.give(pool);
        self.starts.give(pool);
        self.sort.give(pool);
    }

    /// Gives colors and pixels; see [`Buffer::give`].
    pub fn give_diagram(&self, pool: &Pool) {
        self.colors.give(pool);
        self.pixels.give(pool);
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

    /// Which pixels have a site: bit `x % 32` of word `x / 32` of row `y`, rows of whole words.
    pub fn site_bits(&self) -> View<'_, u32> {
        self.site_bits.view()
    }

    /// For each word of [`Buffers::site_bits`] the number of sites before it: the number of its first site, if it has one.
    pub fn site_ranks(&self) -> View<'_, u32> {
        self.site_ranks.view()
    }

    /// Which pixels are debris: bit `i % 32` of word `i / 32` for the pixel at index `i` of the colors.
    pub fn debris_bits(&self) -> Result<View<'_, u32>, Error> {
        self.bits_of_debris(0)
    }

    /// How many points are sites.
    pub fn site_count(&self) -> Result<View<'_, u32>, Error> {
        self.word(Word::Sites)
    }

    /// How many pixels are debris.
    pub fn debris_count(&self) -> Result<View<'_, u32>, Error> {
        self.word(Word::Debris)
    }

    /// The debris, or the debris on one of the lists.
    pub(super) fn bits_of_debris(&self, number: usize) -> Result<View<'_, u32>, Error> {
        let pixels = self.size[0] as usize * self.size[1] as usize;
        let first = number * debris_words(pixels);
        self.debris_bits.slice(first..first + pixels.div_ceil(32))
    }

    pub(super) fn word(&self, word: Word) -> Result<View<'_, u32>, Error> {
        self.counts.slice(word as usize..word as usize + 1)
    }

    /// What `repair` keeps from one dispatch to the next.
    pub(super) fn progress(&self) -> Result<View<'_, u32>, Error> {
        self.counts.slice(Word::Progress as usize..Word::Groups as usize)
    }

    pub(super) fn groups(&self, planned: Planned) -> Result<View<'_, u32>, Error> {
        let place = Word::Groups as usize + 4 * planned as usize;
        self.counts.slice(place..place + 3)
    }

    pub(super) fn all_groups(&self) -> Result<View<'_, u32>, Error> {
        self.counts.slice(Word::Groups as usize..WORDS)
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
        let at = |place: usize| words.get(place).map_or(0, |&word| u64::from(word));
        Counts {
            points: self.points,
            pixels: self.pixels,
            sites: at(Word::Sites as usize),
            missing: at(Word::Missing as usize),
            debris: at(Word::Debris as usize),
        }
    }

    /// How many tiles of the grid had to be colored by bands, after the whole stage.
    pub fn tiles_left(&self, report: &RunReport) -> u32 {
        report.words(self.words).get(Word::Left as usize).copied().unwrap_or(0)
    }
}
