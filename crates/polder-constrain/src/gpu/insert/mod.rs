//! Sub-constraints become edges, on the device. \[QCT\] section 4, algorithms 4 and 5.
//!
//! An outer round is [`reference::insert`](crate::reference::insert())'s, in these dispatches:
//!
//! 1. *Depart.* Sub-constraints that do not own their whole chain are listed; before the first round those that are edges are found
//!    by the numbers of vertices alone. The others leave the star of one of their ends. Those that begin at a hub claim the
//!    triangle there; who does not get it does not walk in this round. Those that do walk have a list of their own.
//! 2. *Mark.* The others walk, and each triangle that they cross takes the least word by an atomic minimum. The word has the
//!    owner's priority above and the edges by which the owner comes in and goes out below. Who finds a lower word, or has its
//!    own replaced, does not own its whole chain; so that is known without counting. Who finds a triangle free stamps
//!    it: later rounds never change an owner, as who crosses the triangles of a flip has crossed those before it. Only who has
//!    waited at a hub has not claimed what it crosses before, and stamps what it takes from others.
//!    Long walks go in pieces, each of which claims its part.
//! 3. *Rebuild.* One invocation for each walker that owns its whole chain, if that is short, replaces the triangles. Half-edges
//!    at the border get new names; where both sides do, who comes second joins them. Words of owners stay: that one is an edge
//!    is known, and who claims a triangle of it later takes it.
//! 4. *Configure.* The triangles that got an owner that goes by flips are looked at, and those beside them along the chain: found by going
//!    through all triangles, so that pairs stand in the order of triangles and what is nearby is worked on together. Pairs
//!    that may be flipped claim their triangles, by words of 32 bits: the case, then a hash of the first triangle.
//! 5. *Inner rounds*, two dispatches each. One flips the pairs that have all they claimed; links outward keep the names that
//!    the neighbors had before, and a stamp on each triangle says along which edge it was flipped. The other renews these
//!    links, and looks at what the flips have changed: their triangles, the one before and the one after. All corners and words
//!    are final by then, and where a link leads follows from the stamp whether it was renewed or not. So what may be flipped
//!    claims its triangles for the next round at once.
//! 6. *Tail.* In one workgroup: the inner rounds that are left where few pairs may be flipped, and the turn to the next outer
//!    round. Inner rounds for which there is no room go on in the dispatches after, and nobody walks meanwhile.
//!
//! Departures from the reference, none of which shows in the result: only pairs are listed, not triangles; a pair that was not
//! flipped and of which no triangle has changed is not looked at again.
//!
//! Tried on an NVIDIA H200 with a million constraints of all lengths among ten million points, without gain: constraints in
//! the order of their places (rebuilding 3.8 ms in place of 4.0, walks 2.6 in place of 2.7), and walkers in the order of their
//! lengths within each 256 (4.0 and 2.6). Neither scattered access nor short walks that wait for long ones are the bound.

mod rounds;

use super::pieces::{self, Grid};
use crate::kernels::*;
use crate::reference::{INNER_ROUNDS, LEAST_REBUILT, LONGEST_REBUILT, MOST_SUB_CONSTRAINTS};
use crate::{Fault, InsertReport};
use polder_flip::gpu::{Arithmetic, Mesh};
use polder_vulkan::{
    Buffer, Device, DeviceKind, Error, Estimate, Kernel, Pool, ReadBack, Recording, RunReport, View, groups_for,
};

const NONE: u32 = u32::MAX;
const WORKGROUP: u32 = 256;
const WORDS: usize = 44;
/// Outer rounds before the host looks: where all goes by flips, and where chains may be rebuilt; and after that.
const FIRST: [u32; 2] = [4, 6];
const BATCH: u32 = 4;
/// Fewer pairs than these are left to the tail, which keeps them up to four times as many.
const FEW: u32 = 256;

/// Places of words that the host knows, as in `insert.glsl`.
#[derive(Clone, Copy)]
enum Word {
    Left = 0,
    Inserted = 1,
    Stuck = 5,
    Admitted = 8,
    EdgesAlready = 20,
    Hubs = 21,
    Rebuilt = 39,
    Intersections = 22,
    Walked = 24,
    OuterRounds = 26,
    InnerRounds = 27,
    Flips = 28,
    DepartFault = 36,
}

/// How much is done in one dispatch.
#[derive(Debug)]
struct Pace {
    /// Workgroups of kernels that stride over their items.
    groups: u32,
    /// Rounds of a tail, and pairs taken in all of them, but for those of the last.
    rounds: u32,
    pairs: u32,
}

impl Pace {
    const GPU: Self = Self { groups: 1056, rounds: 8192, pairs: 1 << 20 };
    /// lavapipe leaves a shader, without a word, once its loops have made 65535 turns, those of the predicates included.
    const CPU: Self = Self { groups: 64, rounds: 64, pairs: 4096 };
}

/// Inner rounds to an outer one, outer rounds at most, and the triangles of the longest chain that is rebuilt.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub struct Rounds {
    pub inner: u32,
    pub outer: u32,
    /// At most [`LONGEST_REBUILT`].
    pub longest: u32,
    /// If so many are no edges.
    pub least: u32,
}

impl Default for Rounds {
    fn default() -> Self {
        Self { inner: INNER_ROUNDS, outer: u32::MAX, longest: LONGEST_REBUILT, least: LEAST_REBUILT }
    }
}

/// What is to be inserted.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// Pairs of distinct vertices with no vertex between them, as [`Insertion`](crate::reference::Insertion) takes them. They
    /// need not be sorted, and may repeat.
    pub sub_constraints: View<'a, [u32; 2]>,
    /// How many there are: all of the view without.
    pub count: Option<View<'a, u32>>,
    /// For each vertex a half-edge that leaves it, and how many do. They are kept up.
    pub spokes: View<'a, u32>,
    /// See there. Only what edges are added to the ends of sub-constraints is kept up.
    pub degrees: View<'a, u32>,
    /// So that long walks go in pieces: a grid over all points, and buffers in which its seeds have been recorded.
    pub pieces: Option<(Grid, &'a pieces::Buffers)>,
}

/// What the stage holds beside the mesh: 32 bytes a slot, 20 a sub-constraint and 8 a piece.
#[derive(Debug)]
pub struct Buffers {
    slots: usize,
    /// By triangle: the least key that claims it, in even rounds and again in odd ones; its stamp; and whose it is.
    state: Buffer<[u32; 4]>,
    /// Of even rounds, and of odd ones: two buffers of half the size find room where one does not.
    pairs: [Buffer<[u32; 2]>; 2],
    /// Those that are to walk, and of these those that do.
    walkers: Buffer<u32>,
    admitted: Buffer<u32>,
    firsts: Buffer<u32>,
    runs: Buffer<u32>,
    lost: Buffer<u32>,
    piece_walked: Buffer<u32>,
    no_pieces: pieces::Buffers,
    words: Buffer<u32>,
}

impl Buffers {
    /// Before there are pairs: by vertex how many sub-constraints end there.
    fn counts(&self, vertices: usize) -> Result<View<'_, u32>, Error> {
        self.pairs[0].view().cast::<u32>().slice(0..vertices)
    }

    /// Gives all of it; see [`Buffer::give`].
    pub fn give(&self, pool: &Pool) {
        for words in [&self.walkers, &self.admitted, &self.firsts, &self.runs, &self.lost, &self.piece_walked] {
            words.give(pool);
        }
        self.state.give(pool);
        self.pairs.iter().for_each(|pairs| pairs.give(pool));
    }
}

/// What an insertion did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// As the reference reports it, but that sub-constraints that repeat count each time.
    pub report: InsertReport,
    /// Sub-constraints that are constrained edges.
    pub inserted: u64,
    /// Why it ended too early, if it did.
    pub fault: Option<Fault>,
}

/// Where [`Counts`] will be found in the report of a run.
#[derive(Clone, Copy, Debug)]
pub struct Read(ReadBack);

impl Read {
    /// After the run.
    pub fn counts(&self, report: &RunReport) -> Counts {
        let words = report.words(self.0);
        let word = |at: usize| words.get(at).copied().unwrap_or(0);
        let narrow = |at: Word| u64::from(word(at as usize));
        let wide = |at: Word, i: usize| {
            let at = at as usize + 2 * i;
            u64::from(word(at)) | u64::from(word(at + 1)) << 32
        };
        let faults = [word(Word::DepartFault as usize), word(Word::DepartFault as usize + 1)];
        let fault = match faults.into_iter().find(|&fault| fault != NONE) {
            Some(fault) => {
                Some([Fault::Blocked, Fault::ThroughVertex, Fault::Lost][(fault as usize & 3).min(2)](fault >> 2))
            }
            None => (narrow(Word::Stuck) != 0).then_some(Fault::Stuck),
        };
        let report = InsertReport {
            sub_constraints: narrow(Word::Inserted) + narrow(Word::Left),
            edges_already: narrow(Word::EdgesAlready),
            intersections: (narrow(Word::Hubs) == 0).then_some(wide(Word::Intersections, 0)),
            walked: wide(Word::Walked, 0),
            outer_rounds: narrow(Word::OuterRounds),
            inner_rounds: narrow(Word::InnerRounds),
            rebuilt: narrow(Word::Rebuilt),
            flips: [0, 1, 2].map(|i| wide(Word::Flips, i)),
        };
        Counts { report, inserted: narrow(Word::Inserted), fault }
    }
}

/// The kernels of the stage on one device.
#[derive(Debug)]
pub struct Stage {
    device: Device,
    pace: Pace,
    spokes: Kernel<FindSpokes>,
    list: Kernel<ListWalkers>,
    depart: Kernel<DepartWalks>,
    admit: Kernel<AdmitWalks>,
    mark: Kernel<MarkChains>,
    rebuild: Kernel<RebuildChains>,
    configure: Kernel<ConfigurePairs>,
    flip: Kernel<FlipPairs>,
    advance: Kernel<AdvancePairs>,
    tail: Kernel<PairTail>,
    pieces: pieces::Stage,
}

impl Stage {
    /// Compiles the kernels.
    ///
    /// # Errors
    ///
    /// Those of the device.
    pub fn new(device: &Device) -> Result<Self, Error> {
        Self::with_arithmetic(device, Arithmetic::of(device)?)
    }

    /// With a given arithmetic: for tests, and where the device was asked before.
    ///
    /// # Errors
    ///
    /// Those of the device.
    pub fn with_arithmetic(device: &Device, arithmetic: Arithmetic) -> Result<Self, Error> {
        let workgroup = [("WORKGROUP", WORKGROUP)];
        Ok(Self {
            device: device.clone(),
            pace: if device.info().kind == DeviceKind::Cpu { Pace::CPU } else { Pace::GPU },
            spokes: Kernel::new(device, &workgroup)?,
            list: Kernel::new(device, &workgroup)?,
            depart: arithmetic.kernel(device, &workgroup)?,
            admit: Kernel::new(device, &workgroup)?,
            mark: arithmetic.kernel(device, &workgroup)?,
            rebuild: arithmetic.kernel(device, &workgroup)?,
            configure: arithmetic.kernel(device, &workgroup)?,
            flip: Kernel::new(device, &workgroup)?,
            advance: arithmetic.kernel(device, &workgroup)?,
            tail: arithmetic.kernel(device, &workgroup)?,
            pieces: pieces::Stage::new(device, arithmetic)?,
        })
    }

    /// What [`Stage::buffers`] will hold.
    pub fn estimate(sub_constraints: usize, pieces: usize, slots: usize) -> Estimate {
        Estimate::new()
            .buffer::<[u32; 4]>("triangles of chains", slots)
            .buffer::<[u32; 2]>("pairs of even rounds", slots)
            .buffer::<[u32; 2]>("pairs of odd rounds", slots)
            .buffer::<u32>("walkers", sub_constraints)
            .buffer::<u32>("admitted walkers", sub_constraints)
            .buffer::<u32>("first edges crossed", sub_constraints)
            .buffer::<u32>("pieces of walkers", sub_constraints)
            .buffer::<u32>("lost", sub_constraints)
            .buffer::<u32>("triangles of pieces", 2 * pieces)
            .and(pieces::Buffers::estimate(1, 1))
            .buffer::<u32>("constrain words", WORDS)
    }

    /// Memory for so many sub-constraints, lists of so many pieces, and meshes of up to so many slots.
    ///
    /// # Errors
    ///
    /// If there are more sub-constraints than [`MOST_SUB_CONSTRAINTS`], or the memory cannot be had: then before any of it is
    /// allocated.
    pub fn buffers(&self, sub_constraints: usize, pieces: usize, slots: usize) -> Result<Buffers, Error> {
        let device = &self.device;
        if sub_constraints > MOST_SUB_CONSTRAINTS {
            let why = format!("{sub_constraints} sub-constraints; up to {MOST_SUB_CONSTRAINTS} are possible");
            return Err(Error::Recording { command: "constrain", why });
        }
        Self::estimate(sub_constraints, pieces, slots).check(device)?;
        Ok(Buffers {
            slots,
            state: Buffer::new(device, "triangles of chains", slots)?,
            pairs: [
                Buffer::new(device, "pairs of even rounds", slots)?,
                Buffer::new(device, "pairs of odd rounds", slots)?,
            ],
            walkers: Buffer::new(device, "walkers", sub_constraints)?,
            admitted: Buffer::new(device, "admitted walkers", sub_constraints)?,
            firsts: Buffer::new(device, "first edges crossed", sub_constraints)?,
            runs: Buffer::new(device, "pieces of walkers", sub_constraints)?,
            lost: Buffer::new(device, "lost", sub_constraints)?,
            piece_walked: Buffer::new(device, "triangles of pieces", 2 * pieces.max(1))?,
            no_pieces: pieces::Buffers::new(device, 1, 1)?,
            words: Buffer::new(device, "constrain words", WORDS)?,
        })
    }

    /// Finds the spokes of all vertices, for those that have no walk before.
    pub fn record_spokes(&self, recording: &mut Recording, mesh: &Mesh, spokes: View<'_, u32>, degrees: View<'_, u32>) {
        recording.fill(spokes, NONE);
        recording.fill(degrees, 0);
        let arguments = FindSpokesArgs {
            triangles: mesh.corners(),
            slots: mesh.slots(),
            spokes,
            degrees,
            limit: mesh.capacity() as u32,
            vertices: spokes.len().min(degrees.len()) as u32,
        };
        recording.dispatch(&self.spokes, groups_for(mesh.capacity(), WORKGROUP), &arguments);
    }

    /// Makes each sub-constraint a constrained edge, as [`reference::insert`](crate::reference::insert()) does.
    ///
    /// # Errors
    ///
    /// If the buffers are for fewer sub-constraints or slots, or there are fewer spokes than vertices.
    pub fn record(
        &self,
        recording: &mut Recording,
        mesh: &Mesh,
        buffers: &Buffers,
        input: Input<'_>,
    ) -> Result<Read, Error> {
        self.record_rounds(recording, mesh, buffers, input, Rounds::default())
    }

    /// The same with other numbers than the usual ones: for tests.
    ///
    /// # Errors
    ///
    /// As [`Stage::record`].
    #[doc(hidden)]
    pub fn record_rounds(
        &self,
        recording: &mut Recording,
        mesh: &Mesh,
        buffers: &Buffers,
        input: Input<'_>,
        rounds: Rounds,
    ) -> Result<Read, Error> {
        let (vertices, slots) = (mesh.vertices(), mesh.capacity());
        let (count, room) = (input.sub_constraints.len(), buffers.lost.len());
        let with_spokes = input.spokes.len().min(input.degrees.len());
        if vertices > with_spokes || slots > buffers.slots || count > room {
            let most = buffers.slots;
            let why = format!("{slots} slots, {count} sub-constraints; buffers for {most} and {room}");
            let why = format!("{why}; {vertices} vertices, spokes of {with_spokes}");
            return Err(Error::Recording { command: "constrain", why });
        }
        if count > 0 && vertices > 2 * buffers.slots {
            let why = format!("{vertices} vertices, and slots for a mesh over no more than {}", 2 * buffers.slots);
            return Err(Error::Recording { command: "constrain", why });
        }
        let piece_room = buffers.piece_walked.len() / 2;
        if let Some((_, list)) = input.pieces.filter(|(_, list)| list.pieces().len() > piece_room) {
            let why = format!("{} pieces; buffers for {piece_room}", list.pieces().len());
            return Err(Error::Recording { command: "constrain", why });
        }
        if count > 0 {
            Self::record_start(recording, buffers, vertices)?;
            if input.pieces.is_none() {
                recording.fill(buffers.runs.view(), NONE);
                recording.fill(buffers.no_pieces.count(), 0);
            }
            if rounds.outer == u32::MAX {
                let left = buffers.words.slice(Word::Left as usize..Word::Left as usize + 1)?;
                // Each outer round inserts or flips something, or looks at a tail of thousands of flips.
                let mut recorded = Ok(());
                // There is room for more than there are.
                let first = FIRST[usize::from(count / 2 >= rounds.least as usize)];
                recording.repeat_ahead("insert constraints", left, u32::MAX, first, BATCH, |round| {
                    recorded = self.record_outer(round, mesh, buffers, input, rounds);
                });
                recorded?;
            } else {
                (0..rounds.outer).try_for_each(|_| self.record_outer(recording, mesh, buffers, input, rounds))?;
            }
        } else {
            recording.fill(buffers.words.view(), 0);
            recording.fill(buffers.words.slice(Word::DepartFault as usize..Word::Rebuilt as usize)?, NONE);
        }
        Ok(Read(recording.read(buffers.words.view())))
    }

    fn record_start(recording: &mut Recording, buffers: &Buffers, vertices: usize) -> Result<(), Error> {
        recording.fill(buffers.words.view(), 0);
        recording.fill(buffers.words.slice(Word::DepartFault as usize..Word::Rebuilt as usize)?, NONE);
        recording.fill(buffers.state.view().cast(), NONE);
        recording.fill(buffers.counts(vertices)?, 0);
        Ok(())
    }
}
