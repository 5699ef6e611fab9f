//! What the step holds on the device.

use crate::CanonicalError;
use crate::reference::Check;
use polder_vulkan::primitives::Scan;
use polder_vulkan::{Buffer, Device, Error, Estimate, ReadBack, Recording, RunReport, View};

/// Kernels reach 4 GiB from an address: that many triangles of 12 bytes.
const MOST_SLOTS: usize = (1 << 30) / 3;
const WORDS: usize = 44;

/// Places of single words in the counts: views begin at multiples of 4 words.
#[derive(Clone, Copy)]
pub(super) enum Word {
    Finite = 0,
    Ghosts = 4,
    Duplicates = 8,
    Long = 12,
    Minima = 16,
    /// From here on all ones at first.
    Broken = 20,
    Clockwise = 24,
    Reflex = 28,
    Groups = 32,
    /// Zero at first.
    ConstrainedEdges = 36,
    Through = 40,
}

/// Results and scratch memory of the step, for some number of points and slots.
///
/// Results are 14 words a point and two slots, if there are twice as many slots as points; scratch memory is 9 words. The
/// scratch arrays may be used for anything else before and after.
#[derive(Debug)]
pub struct Buffers {
    pub(super) points: usize,
    pub(super) slots: usize,
    pub(super) triangles: Buffer<[u32; 3]>,
    pub(super) neighbors: Buffer<[u32; 3]>,
    pub(super) constrained: Buffer<u32>,
    pub(super) representatives: Buffer<u32>,
    pub(super) counts: Buffer<u32>,
    /// By vertex: its name.
    pub(super) names: Buffer<u32>,
    /// By vertex, and one more: where its list begins.
    pub(super) starts: Buffer<u32>,
    /// The same by name, as a place in the result.
    pub(super) named_starts: Buffer<u32>,
    /// By slot: the place in a list, then in the result.
    pub(super) places: Buffer<u32>,
    pub(super) list: Buffer<u32>,
    pub(super) keys: Buffer<u32>,
    pub(super) scan: Scan,
}

pub(super) fn estimate(points: usize, slots: usize) -> Estimate {
    let mut estimate = Estimate::new()
        .buffer::<u32>("counts", WORDS)
        .buffer::<[u32; 3]>("sorted triangles", slots)
        .buffer::<[u32; 3]>("neighbors", slots)
        .buffer::<u32>("constrained bits", slots.div_ceil(4))
        .buffer::<u32>("starts of lists", points + 1);
    for name in ["representatives", "names", "starts by name"] {
        estimate = estimate.buffer::<u32>(name, points);
    }
    for name in ["places", "lists", "keys of lists"] {
        estimate = estimate.buffer::<u32>(name, slots);
    }
    estimate.and(Scan::estimate(points + 1))
}

impl Buffers {
    pub(super) fn new(device: &Device, points: usize, slots: usize) -> Result<Self, Error> {
        if slots > MOST_SLOTS {
            let why = format!("{slots} slots; at most {MOST_SLOTS} are possible");
            return Err(Error::Recording { command: "canonical buffers", why });
        }
        estimate(points, slots).check(device)?;
        let words = |name, len| Buffer::<u32>::new(device, name, len);
        Ok(Self {
            points,
            slots,
            triangles: Buffer::new(device, "sorted triangles", slots)?,
            neighbors: Buffer::new(device, "neighbors", slots)?,
            constrained: words("constrained bits", slots.div_ceil(4))?,
            representatives: words("representatives", points)?,
            counts: words("counts", WORDS)?,
            names: words("names", points)?,
            starts: words("starts of lists", points + 1)?,
            named_starts: words("starts by name", points)?,
            places: words("places", slots)?,
            list: words("lists", slots)?,
            keys: words("keys of lists", slots)?,
            scan: Scan::new(device, points + 1)?,
        })
    }

    /// Points that it was made for.
    pub fn points(&self) -> usize {
        self.points
    }

    /// Slots that it was made for.
    pub fn slots(&self) -> usize {
        self.slots
    }

    /// Corners by input index, counterclockwise from the smallest, sorted: as many as [`Buffers::triangle_count`] says.
    /// Behind them nothing is defined, in the other arrays by triangle neither.
    pub fn triangles(&self) -> View<'_, [u32; 3]> {
        self.triangles.view()
    }

    /// The triangle across the edge opposite each corner, [`polder_mesh::NONE`] at the hull.
    pub fn neighbors(&self) -> View<'_, [u32; 3]> {
        self.neighbors.view()
    }

    /// A byte for each triangle, whose bit `k` says that the edge opposite corner `k` is constrained.
    pub fn constrained(&self) -> View<'_, u8> {
        self.constrained.view().cast()
    }

    /// For each input point the input index of its vertex.
    pub fn representatives(&self) -> View<'_, u32> {
        self.representatives.view()
    }

    /// How many triangles there are.
    ///
    /// # Errors
    ///
    /// None.
    pub fn triangle_count(&self) -> Result<View<'_, u32>, Error> {
        self.word(Word::Finite)
    }

    pub(super) fn word(&self, word: Word) -> Result<View<'_, u32>, Error> {
        self.counts.slice(word as usize..word as usize + 1)
    }

    pub(super) fn groups(&self) -> Result<View<'_, u32>, Error> {
        self.counts.slice(Word::Groups as usize..Word::Groups as usize + 3)
    }

    /// Asks a recording to bring the counts back.
    pub fn read_counts(&self, recording: &mut Recording) -> CountsRead {
        CountsRead { words: recording.read(self.counts.view()), points: self.points as u32 }
    }
}

/// What the step counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// Finite triangles: the length of the result.
    pub triangles: u32,
    /// Ghost triangles.
    pub ghosts: u32,
    /// Points that are vertices.
    pub vertices: u32,
    /// Lists of triangles that a workgroup sorted.
    pub long_lists: u32,
    /// Edges that are constrained, counted if there were chains.
    pub constrained_edges: u32,
    /// Chains with a vertex between their ends.
    pub through_vertices: u32,
    /// What the certificate found.
    pub check: Check,
}

impl Counts {
    /// Whether the certificate holds.
    ///
    /// # Errors
    ///
    /// What does not hold, with the slot at fault.
    pub fn verdict(&self) -> Result<(), CanonicalError> {
        self.check.verdict(self.triangles, self.ghosts, self.vertices)
    }
}

/// Where the counts will be found in the report of a run.
#[derive(Clone, Copy, Debug)]
pub struct CountsRead {
    words: ReadBack,
    points: u32,
}

impl CountsRead {
    /// The counts, after the whole step.
    pub fn counts(&self, report: &RunReport) -> Counts {
        let words = report.words(self.words);
        let word = |word: Word| words.get(word as usize).copied().unwrap_or(0);
        Counts {
            triangles: word(Word::Finite),
            ghosts: word(Word::Ghosts),
            vertices: self.points.saturating_sub(word(Word::Duplicates)),
            long_lists: word(Word::Long),
            constrained_edges: word(Word::ConstrainedEdges),
            through_vertices: word(Word::Through),
            check: Check {
                broken: word(Word::Broken),
                clockwise: word(Word::Clockwise),
                reflex: word(Word::Reflex),
                minima: word(Word::Minima),
            },
        }
    }
}
