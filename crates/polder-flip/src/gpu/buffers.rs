//! What the stage holds on the device beside the mesh.

use super::Mesh;
use crate::FlipReport;
use polder_vulkan::{Buffer, Device, Error, Estimate, Pool, ReadBack, Recording, RunReport, View};

/// Words of a list's count, and of a report.
const WORDS: usize = 8;
/// Words that steer rounds, and the one that says how many illegal edges a tail left.
const STEERING: usize = 20;
const PENDING: usize = 16;

/// Edges to be tested in the next flip round: half-edges in any order, from either side. Kernels append by `edge_list.glsl`.
#[derive(Debug)]
pub struct EdgeList {
    edges: Buffer<u32>,
    count: Buffer<u32>,
    limit: usize,
}

impl EdgeList {
    /// Room for so many.
    ///
    /// # Errors
    ///
    /// If the memory cannot be had.
    pub fn new(device: &Device, limit: usize) -> Result<Self, Error> {
        Self::with_room(device, limit, limit)
    }

    /// With so many words.
    fn with_room(device: &Device, limit: usize, words: usize) -> Result<Self, Error> {
        let (edges, count) = (Buffer::new(device, "edges", words)?, Buffer::new(device, "edge count", WORDS)?);
        Ok(Self { edges, count, limit })
    }

    /// What [`EdgeList::new`] will hold.
    pub fn estimate(limit: usize) -> Estimate {
        Estimate::new().buffer::<u32>("edges", limit).buffer::<u32>("edge count", WORDS)
    }

    /// Gives the list; see [`Buffer::give`].
    pub fn give(&self, pool: &Pool) {
        self.edges.give(pool);
    }

    /// The half-edges.
    pub fn edges(&self) -> View<'_, u32> {
        self.edges.view()
    }

    /// How many there are, in the first word; more than [`EdgeList::limit`] if some did not fit.
    pub fn count(&self) -> View<'_, u32> {
        self.count.view()
    }

    /// How many fit.
    pub fn limit(&self) -> u32 {
        self.limit as u32
    }

    /// Records that the list becomes empty.
    pub fn record_clear(&self, recording: &mut Recording) {
        recording.fill(self.count.view(), 0);
    }
}

/// A [`FlipReport`] in the making, on the device.
#[derive(Debug)]
pub struct Tally {
    words: Buffer<u32>,
}

impl Tally {
    /// One that is not yet cleared.
    ///
    /// # Errors
    ///
    /// If the memory cannot be had.
    pub fn new(device: &Device) -> Result<Self, Error> {
        Ok(Self { words: Buffer::new(device, "flip report", WORDS)? })
    }

    /// Records that it becomes zero.
    pub fn record_clear(&self, recording: &mut Recording) {
        recording.fill(self.words.view(), 0);
    }

    /// Asks a recording to bring it back.
    pub fn read(&self, recording: &mut Recording) -> TallyRead {
        TallyRead(recording.read(self.words.view()))
    }

    pub(super) fn words(&self) -> View<'_, u32> {
        self.words.view()
    }
}

/// Where a [`FlipReport`] will be found in the report of a run.
#[derive(Clone, Copy, Debug)]
pub struct TallyRead(ReadBack);

impl TallyRead {
    /// The report, after the run.
    pub fn report(&self, report: &RunReport) -> FlipReport {
        let words = report.words(self.0);
        let word = |at: usize| words.get(at).map_or(0, |&word| u64::from(word));
        FlipReport { rounds: word(0), flips: word(1) | word(2) << 32, tests: word(3) | word(4) << 32 }
    }
}

/// Scratch memory of the stage, for one number of slots: 28.4 bytes a slot.
#[derive(Debug)]
pub struct Buffers {
    pub(super) slots: usize,
    /// By triangle the least priority that claims it.
    pub(super) claims: Buffer<u32>,
    /// A bit for each half-edge: whether it was met in this round.
    pub(super) listed: Buffer<u32>,
    /// Illegal edges of even rounds, each by both half-edges.
    pub(super) illegal: Buffer<[u32; 2]>,
    /// Those of odd rounds; a list for others, which a round has read before it writes there.
    pub(super) list: EdgeList,
    pub(super) words: Buffer<u32>,
}

/// Edges of a mesh of so many slots.
fn edges_of(slots: usize) -> usize {
    3 * slots.div_ceil(2)
}

fn listed_of(slots: usize) -> usize {
    (3 * slots).div_ceil(32)
}

pub(super) fn estimate(slots: usize) -> Estimate {
    Estimate::new()
        .buffer::<u32>("claims", slots)
        .buffer::<u32>("listed", listed_of(slots))
        .buffer::<[u32; 2]>("illegal", edges_of(slots))
        .and(EdgeList::estimate(2 * edges_of(slots)))
        .buffer::<u32>("flip words", STEERING)
}

impl Buffers {
    /// Gives all of it; see [`Buffer::give`].
    pub fn give(&self, pool: &Pool) {
        self.claims.give(pool);
        self.listed.give(pool);
        self.illegal.give(pool);
        self.list.give(pool);
    }

    pub(super) fn new(device: &Device, slots: usize) -> Result<Self, Error> {
        estimate(slots).check(device)?;
        let words = |name, len| Buffer::<u32>::new(device, name, len);
        Ok(Self {
            slots,
            claims: words("claims", slots)?,
            listed: words("listed", listed_of(slots))?,
            illegal: Buffer::new(device, "illegal", edges_of(slots))?,
            list: EdgeList::with_room(device, edges_of(slots), 2 * edges_of(slots))?,
            words: words("flip words", STEERING)?,
        })
    }

    /// A list that may be given to [`Stage::record_close_hull`](super::Stage::record_close_hull). Others than that and
    /// [`Stage::record_round`](super::Stage::record_round) lose what is in it.
    pub fn list(&self) -> &EdgeList {
        &self.list
    }

    /// Illegal edges of even and of odd rounds.
    pub(super) fn illegal(&self, parity: usize) -> View<'_, [u32; 2]> {
        if parity == 0 { self.illegal.view() } else { self.list.edges.view().cast() }
    }

    /// One word: how many illegal edges the last [`Stage::record_flip`](super::Stage::record_flip) or
    /// [`Stage::record_close_hull`](super::Stage::record_close_hull) left; zero if it is done.
    ///
    /// # Errors
    ///
    /// None.
    pub fn pending(&self) -> Result<View<'_, u32>, Error> {
        self.words.slice(PENDING..PENDING + 1)
    }

    pub(super) fn fit(&self, mesh: &Mesh, command: &'static str) -> Result<(), Error> {
        if mesh.capacity() > self.slots {
            let why = format!("buffers for {} slots, a mesh of {}", self.slots, mesh.capacity());
            return Err(Error::Recording { command, why });
        }
        Ok(())
    }
}
