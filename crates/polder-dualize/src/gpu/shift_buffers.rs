//! What stage 3 holds on the device, and what it counts.

use super::shift::Input;
use crate::DualizeError;
use polder_flip::gpu::Mesh;
use polder_vulkan::{Buffer, Device, Error, Estimate, Pool, ReadBack, Recording, RunReport, View};

const WORDS: usize = 320;
/// Words of the ring of a site.
const NEIGHBORS: usize = 8;

/// Places of words, as `shift.glsl` has them; views begin at multiples of 4 words.
#[derive(Clone, Copy)]
pub(super) enum Word {
    PinLeft = 0,
    OutLeft = 4,
    Broken = 8,
    Taken = 16,
    PinRounds = 21,
    UnpinRounds = 23,
    OutRounds = 25,
    Bad = 27,
    Stuck = 28,
}

/// What rounds do.
#[derive(Clone, Copy)]
pub(super) enum Row {
    Pin = 0,
    Unpin = 1,
    Out = 2,
}

/// Results and scratch memory of the stage, for one number of sites: 12 bytes a site, and 40.
#[derive(Debug)]
pub struct Buffers {
    pub(super) sites: usize,
    pub(super) state: Buffer<u32>,
    /// First, for whom each site waits.
    pub(super) freed: Buffer<[u32; 2]>,
    /// Half-edges out of all sites that were pinned, then these sites.
    pub(super) all: Buffer<u32>,
    waiting: [Buffer<u32>; 2],
    pub(super) winners: Buffer<u32>,
    /// The outer edge of each triangle of a star; before, the neighbors of the first sites that were pinned.
    pub(super) edge_of: Buffer<u32>,
    /// Outer edges of stars.
    pub(super) edges: Buffer<[u32; 2]>,
    pub(super) words: Buffer<u32>,
}

pub(super) fn estimate(sites: usize) -> Estimate {
    let mut estimate = Estimate::new().buffer::<[u32; 2]>("freed", sites).buffer::<u32>("shift words", WORDS);
    for name in ["heirs", "pinned", "waiting", "later", "winners"] {
        estimate = estimate.buffer::<u32>(name, sites);
    }
    let slots = Mesh::slots_for(sites);
    estimate.buffer::<u32>("edges of triangles", slots).buffer::<[u32; 2]>("outer edges", slots)
}

impl Buffers {
    pub(super) fn new(device: &Device, sites: usize) -> Result<Self, Error> {
        estimate(sites).check(device)?;
        let words = |name, len| Buffer::<u32>::new(device, name, len);
        let slots = Mesh::slots_for(sites);
        Ok(Self {
            sites,
            state: words("heirs", sites)?,
            freed: Buffer::new(device, "freed", sites)?,
            all: words("pinned", sites)?,
            waiting: [words("waiting", sites)?, words("later", sites)?],
            winners: words("winners", sites)?,
            edge_of: words("edges of triangles", slots)?,
            edges: Buffer::new(device, "outer edges", slots)?,
            words: words("shift words", WORDS)?,
        })
    }

    /// Gives all but the slots that sites left free; see [`Buffer::give`].
    pub fn give(&self, pool: &Pool) {
        self.state.give(pool);
        self.all.give(pool);
        self.waiting[0].give(pool);
        self.waiting[1].give(pool);
        self.winners.give(pool);
        self.edge_of.give(pool);
        self.edges.give(pool);
    }

    /// Gives the slots that sites left free; see [`Buffer::give`].
    pub fn give_freed(&self, pool: &Pool) {
        self.freed.give(pool);
    }

    /// Sites that it was made for.
    pub fn sites(&self) -> usize {
        self.sites
    }

    /// For each site itself if it is a vertex, else a vertex close to where it was taken out, or
    /// [`polder_mesh::NONE`] if the mesh is empty.
    pub fn heirs(&self) -> View<'_, u32> {
        self.state.view()
    }

    /// For each site that was taken out the two slots that it left free. Of other sites it says nothing, nor of any if the
    /// mesh is empty.
    pub fn freed(&self) -> View<'_, [u32; 2]> {
        self.freed.view()
    }

    /// The sites taken out, in any order: as many as [`Buffers::taken_count`] says.
    pub fn taken(&self) -> View<'_, u32> {
        self.winners.view()
    }

    /// How many sites were taken out.
    ///
    /// # Errors
    ///
    /// None.
    pub fn taken_count(&self) -> Result<View<'_, u32>, Error> {
        self.word(Word::Taken)
    }

    pub(super) fn word(&self, word: Word) -> Result<View<'_, u32>, Error> {
        self.words.slice(word as usize..word as usize + 1)
    }

    /// Sites whose neighbors are kept: more than twice as many as a random set pins.
    pub(super) fn rings(&self) -> u32 {
        (self.edge_of.len() / NEIGHBORS) as u32
    }

    /// The list that a round works on, and that of the next.
    pub(super) fn lists(&self, round: u32) -> [View<'_, u32>; 2] {
        let [even, odd] = &self.waiting;
        if round.is_multiple_of(2) { [even.view(), odd.view()] } else { [odd.view(), even.view()] }
    }

    pub(super) fn check(&self, input: Input<'_>, mesh: &Mesh) -> Result<(), Error> {
        let points = input.points.len();
        let fits = input.order.len() == points && mesh.vertices() >= points && input.pixels.len() >= self.sites;
        if fits && self.sites <= points {
            return Ok(());
        }
        let (order, pixels) = (input.order.len(), input.pixels.len());
        let why = format!(
            "{points} points in an order of {order}, {pixels} pixels, a mesh of {} vertices; buffers for {} sites",
            mesh.vertices(),
            self.sites
        );
        Err(Error::Recording { command: "shift", why })
    }

    pub(super) fn read(&self, recording: &mut Recording, unclosed: ReadBack) -> Read {
        Read { words: recording.read(self.words.view()), unclosed }
    }
}

/// What the stage counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Sites pinned in the first step.
    pub bad: u64,
    /// Those of them that the second step could not free.
    pub stuck: u64,
    /// Sites taken out.
    pub taken: u64,
    /// Rounds of pinning, of unpinning, of taking out.
    pub rounds: [u64; 3],
}

/// Where the counts will be found in the report of a run.
#[derive(Clone, Copy, Debug)]
pub struct Read {
    words: ReadBack,
    /// Reflex vertices that are left.
    unclosed: ReadBack,
}

impl Read {
    /// The counts, or what was wrong with the mesh.
    ///
    /// # Errors
    ///
    /// [`DualizeError::Broken`] if the triangles around some vertex do not close up, [`DualizeError::BoundExceeded`] if the
    /// hull did not become convex in as many rounds as its flips may take.
    pub fn result(&self, report: &RunReport) -> Result<Counts, DualizeError> {
        let words = report.words(self.words);
        let word = |word: Word| words.get(word as usize).copied().unwrap_or(0);
        if word(Word::Broken) != 0 {
            return Err(DualizeError::Broken { stage: "shift", vertex: !word(Word::Broken) });
        }
        if report.words(self.unclosed).iter().any(|&left| left != 0) {
            return Err(DualizeError::BoundExceeded {
                stage: "shift, close hull",
                bound: u64::from(polder_flip::gpu::TAIL_ROUNDS),
            });
        }
        let count = |of| u64::from(word(of));
        Ok(Counts {
            bad: count(Word::Bad),
            stuck: count(Word::Stuck),
            taken: count(Word::Taken),
            // The device counts the rounds that pinned some.
            rounds: [count(Word::PinRounds) + 1, count(Word::UnpinRounds), count(Word::OutRounds)],
        })
    }
}
