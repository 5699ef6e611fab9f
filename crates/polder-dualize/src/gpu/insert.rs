//! Stage 4 on the device.
//!
//! Before the rounds each vertex gets some half-edge that leaves it, for walks to start from, and a mesh without finite
//! triangles gets some: a chain is joined by the point off its line that has the least priority, in place; an empty mesh is
//! given the chain of the first and last of all points before. If all points lie on one line, the stage says so and leaves
//! them to the host. A round is four kernels here,
//! then one round of flips, and ghost flips, which `polder-flip` records:
//!
//! 1. *Locate.* One invocation a point walks to its container, scores the point and claims by score, by atomics on [`u32`]
//!    alone.
//! 2. *Claim* by priority, among those with the least score.
//! 3. *Graft.* Who got all it claimed writes its triangles; the others go on the next list. Slots are known beforehand, so
//!    nothing is counted or scanned, and lists may be in any order.
//! 4. *Relink.* Outer edges of what was split learn the new names of their other sides. The last workgroup to end turns to
//!    the next round.
//!
//! A round with nothing to do is a row of empty dispatches. The host looks after as many rounds as most inputs need.
//!
//! The last kernel of a round sees whether the mesh falls behind. Once it has, a second loop goes on in place of the first: a
//! turn of it flips, many rounds at once, and inserts only if no illegal edge is left; what is not its turn is dispatched in
//! no workgroup. Most inputs never come there, so nothing of it is recorded before the host has looked.

use crate::DualizeError;
use crate::kernels::*;
use polder_flip::FlipReport;
use polder_flip::gpu::{self as flips, Arithmetic, EdgeList, Mesh, Tally, TallyRead};
use polder_flip::reference::round_bound;
use polder_vulkan::{Buffer, Device, Error, Estimate, Kernel, Pool, ReadBack, Recording, RunReport, View, groups_for};

const NONE: u32 = u32::MAX;
const WORKGROUP: u32 = 256;
const WORDS: usize = 52;
/// Words from there on that begin as [`NONE`].
const UNSET: usize = 8;
/// Most workgroups that look for the ends of a chain.
const END_GROUPS: u32 = 1024;
/// Rounds before the host looks, and after that: clusters take 19, rings 15.
const FIRST: u32 = 5;
const BATCH: u32 = 15;
/// Turns before the host looks again, in a mesh that fell behind.
const BATCH_BEHIND: u32 = 16;

/// Places of words that the host knows, as in `insert.glsl`.
#[derive(Clone, Copy)]
enum Word {
    Round = 3,
    Groups = 4,
    WaitingSteady = 12,
    Inserted = 16,
    Duplicates = 17,
    Lost = 18,
    OpenHull = 19,
    WaitingBehind = 24,
    CenterSlot = 28,
    MeshGroups = 36,
    WideGroups = 40,
    OneGroup = 44,
    Tested = 48,
}

/// What is to be inserted into a mesh, as [`ToInsert`](crate::reference::ToInsert), but for the slots.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// The points.
    pub points: View<'a, u32>,
    /// For each a vertex from which the search for it starts; [`NONE`](polder_mesh::NONE) for anywhere.
    pub starts: View<'a, u32>,
    /// How many there are: all of the view without.
    pub count: Option<View<'a, u32>>,
    /// How many sites there were: the mesh has two slots for each, but two.
    pub sites: View<'a, u32>,
    /// The two slots that each site left free if it was taken out. A point that was no site has twice its number, less two,
    /// and the one after.
    pub freed: View<'a, [u32; 2]>,
}

/// What the stage holds beside the mesh: 32 bytes a point and 14 a slot.
#[derive(Debug)]
pub struct Buffers {
    waiting: Buffer<[u32; 2]>,
    places: Buffer<u32>,
    claims: Buffer<u32>,
    /// By vertex: a half-edge out of it.
    half_edges: Buffer<u32>,
    vertex_of: Buffer<u32>,
    words: Buffer<u32>,
    ends: Buffer<u32>,
    edges: EdgeList,
    hull: Tally,
    flips: Tally,
}

/// Room for the edges of a round of flips: each once.
fn edges_of(slots: usize) -> usize {
    3 * slots.div_ceil(2)
}

impl Buffers {
    /// Gives all but the vertices of the points; see [`Buffer::give`].
    pub fn give(&self, pool: &Pool) {
        self.waiting.give(pool);
        self.places.give(pool);
        self.claims.give(pool);
        self.half_edges.give(pool);
        self.edges.give(pool);
    }

    /// For each point the vertex that it is or equals.
    pub fn vertex_of(&self) -> View<'_, u32> {
        self.vertex_of.view()
    }

    fn word(&self, word: Word, count: usize) -> Result<View<'_, u32>, Error> {
        self.words.slice(word as usize..word as usize + count)
    }
}

/// What the stage did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Rounds of insertion.
    pub rounds: u64,
    /// Points that the rounds inserted.
    pub inserted: u64,
    /// Points that were found equal to a vertex.
    pub duplicates: u64,
    /// Whether all points lie on one line, or are equal. Then nothing was inserted, and neither the mesh nor the vertices of
    /// points mean anything: what remains is to sort, as [`reference::insert`](crate::reference::insert) does.
    pub on_a_line: bool,
    /// Ghost flips.
    pub hull: FlipReport,
    /// The flip rounds between insertion rounds.
    pub flips: FlipReport,
}

/// Where [`Counts`] will be found in the report of a run.
#[derive(Clone, Copy, Debug)]
pub struct Read {
    words: ReadBack,
    hull: TallyRead,
    flips: TallyRead,
}

impl Read {
    /// After the run.
    ///
    /// # Errors
    ///
    /// [`DualizeError::WalkLost`] if the mesh was no triangulation; [`DualizeError::BoundExceeded`] if a hull was not closed
    /// in as many rounds of flips as one round of insertion may take.
    pub fn result(&self, report: &RunReport) -> Result<Counts, DualizeError> {
        let words = report.words(self.words);
        let word = |at: Word| words.get(at as usize).copied().unwrap_or(0);
        if word(Word::Lost) != NONE {
            return Err(DualizeError::WalkLost { point: word(Word::Lost), steps: 0 });
        }
        if word(Word::OpenHull) != 0 {
            let bound = u64::from(word(Word::Round));
            return Err(DualizeError::BoundExceeded { stage: "insert, close hull", bound });
        }
        Ok(Counts {
            rounds: u64::from(word(Word::Round).saturating_sub(1)),
            inserted: word(Word::Inserted).into(),
            duplicates: word(Word::Duplicates).into(),
            on_a_line: word(Word::CenterSlot) == NONE,
            hull: self.hull.report(report),
            flips: self.flips.report(report),
        })
    }
}

/// The kernels of the stage on one device.
#[derive(Debug)]
pub struct Stage {
    device: Device,
    begin: Kernel<InsertBegin>,
    ends: Kernel<InsertEnds>,
    apex: Kernel<InsertApex>,
    join: Kernel<InsertJoin>,
    wait: Kernel<InsertWait>,
    locate: Kernel<InsertLocate>,
    claim: Kernel<InsertClaim>,
    graft: Kernel<InsertGraft>,
    relink: Kernel<InsertRelink>,
    turn: Kernel<InsertTurn>,
    clear: Kernel<InsertClear>,
    resume: Kernel<InsertResume>,
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
            begin: Kernel::new(device, &workgroup)?,
            ends: Kernel::new(device, &workgroup)?,
            apex: arithmetic.kernel(device, &workgroup)?,
            join: arithmetic.kernel(device, &workgroup)?,
            wait: Kernel::new(device, &workgroup)?,
            locate: arithmetic.kernel(device, &workgroup)?,
            claim: Kernel::new(device, &workgroup)?,
            graft: Kernel::new(device, &workgroup)?,
            relink: Kernel::new(device, &workgroup)?,
            turn: Kernel::new(device, &workgroup)?,
            clear: Kernel::new(device, &workgroup)?,
            resume: Kernel::new(device, &workgroup)?,
        })
    }

    /// What [`Stage::buffers`] will hold.
    pub fn estimate(points: usize, slots: usize) -> Estimate {
        Estimate::new()
            .buffer::<[u32; 2]>("points that wait", 2 * points)
            .buffer::<[u32; 2]>("places", points)
            .buffer::<[u32; 2]>("claims of points", slots)
            .buffer::<u32>("half-edges of vertices", points)
            .buffer::<u32>("vertices of points", points)
            .buffer::<u32>("insert words", WORDS)
            .buffer::<u32>("ends of a chain", 2 * END_GROUPS as usize)
            .and(EdgeList::estimate(edges_of(slots)))
    }

    /// Memory for so many points, and meshes of up to so many slots.
    ///
    /// # Errors
    ///
    /// If the memory cannot be had: then before any of it is allocated.
    pub fn buffers(&self, points: usize, slots: usize) -> Result<Buffers, Error> {
        let device = &self.device;
        Self::estimate(points, slots).check(device)?;
        Ok(Buffers {
            waiting: Buffer::new(device, "points that wait", 2 * points)?,
            places: Buffer::new(device, "places", 2 * points)?,
            claims: Buffer::new(device, "claims of points", 2 * slots)?,
            half_edges: Buffer::new(device, "half-edges of vertices", points)?,
            vertex_of: Buffer::new(device, "vertices of points", points)?,
            words: Buffer::new(device, "insert words", WORDS)?,
            ends: Buffer::new(device, "ends of a chain", 2 * END_GROUPS as usize)?,
            edges: EdgeList::new(device, edges_of(slots))?,
            hull: Tally::new(device)?,
            flips: Tally::new(device)?,
        })
    }

    /// Inserts points into a triangulation, as [`reference::insert`](crate::reference::insert) does. Each position of the
    /// mesh must be a vertex or among the points.
    ///
    /// # Errors
    ///
    /// If the buffers are for another number of points or fewer slots.
    pub fn record(
        &self,
        recording: &mut Recording,
        mesh: &Mesh,
        flips: (&flips::Stage, &flips::Buffers),
        buffers: &Buffers,
        input: Input<'_>,
    ) -> Result<Read, Error> {
        let (points, slots) = (buffers.vertex_of.len(), buffers.claims.len() / 2);
        if mesh.vertices() != points || mesh.capacity() > slots || input.points.len().max(input.starts.len()) > points {
            let (vertices, capacity) = (mesh.vertices(), mesh.capacity());
            let why = format!("{vertices} vertices and {capacity} slots; buffers for {points} and {slots}");
            return Err(Error::Recording { command: "insert", why });
        }
        self.record_begin(recording, mesh, buffers, input)?;
        buffers.edges.record_clear(recording);
        flips.1.list().record_clear(recording);
        buffers.hull.record_clear(recording);
        buffers.flips.record_clear(recording);
        // Each round inserts a point.
        let bound = (points as u32).saturating_add(1);
        let mut failed = None;
        let waiting = buffers.word(Word::WaitingSteady, 1)?;
        recording.repeat_ahead("insert", waiting, bound, FIRST, BATCH, |round| {
            failed = self.record_round(round, mesh, flips, buffers, input).err();
        });
        let groups = buffers.word(Word::MeshGroups, 3)?;
        let arguments = InsertClearArgs {
            triangles: mesh.corners(),
            links: mesh.twins(),
            waiting: buffers.waiting.view(),
            freed: input.freed,
            words: buffers.words.view(),
            limit: mesh.vertices() as u32,
        };
        recording.dispatch_indirect(&self.clear, groups, &arguments);
        flips.0.record_test(recording, mesh, flips.1, &buffers.flips, groups)?;
        // Each turn inserts a point or flips an edge.
        let bound = bound.saturating_add(u32::try_from(round_bound(slots)).unwrap_or(u32::MAX));
        let waiting = buffers.word(Word::WaitingBehind, 1)?;
        recording.repeat_ahead("insert behind", waiting, bound, 0, BATCH_BEHIND, |turn| {
            failed = failed.take().or(self.record_turn(turn, mesh, flips, buffers, input).err());
        });
        failed.map_or(Ok(()), Err)?;
        Ok(Read {
            words: recording.read(buffers.words.view()),
            hull: buffers.hull.read(recording),
            flips: buffers.flips.read(recording),
        })
    }

    fn record_begin(
        &self,
        recording: &mut Recording,
        mesh: &Mesh,
        buffers: &Buffers,
        input: Input<'_>,
    ) -> Result<(), Error> {
        let (limit, vertices) = (mesh.capacity() as u32, mesh.vertices() as u32);
        let (words, half_edges) = (buffers.words.view(), buffers.half_edges.view());
        recording.fill(buffers.claims.view(), NONE);
        recording.fill(half_edges, NONE);
        recording.fill(words, 0);
        recording.fill(buffers.word(Word::CenterSlot, UNSET)?, NONE);
        let arguments = InsertBeginArgs {
            triangles: mesh.corners(),
            slots: mesh.slots(),
            half_edges,
            vertex_of: buffers.vertex_of.view(),
            sites: input.sites,
            words,
            limit,
            vertices,
        };
        recording.dispatch(&self.begin, groups_for(mesh.capacity().max(mesh.vertices()), WORKGROUP), &arguments);
        self.record_bootstrap(recording, mesh, buffers, input);
        let points = input.points.len().min(input.starts.len());
        let arguments = InsertWaitArgs {
            triangles: mesh.corners(),
            half_edges,
            points: input.points,
            starts: input.starts,
            counter: input.count,
            waiting: buffers.waiting.view(),
            slots: mesh.slots(),
            words,
            limit: points as u32,
            vertices,
        };
        recording.dispatch(&self.wait, groups_for(points.max(1), WORKGROUP), &arguments);
        Ok(())
    }

    /// A start where no triangle is finite; else these kernels do nothing.
    fn record_bootstrap(&self, recording: &mut Recording, mesh: &Mesh, buffers: &Buffers, input: Input<'_>) {
        let (triangles, links, positions) = (mesh.corners(), mesh.twins(), mesh.positions().cast());
        let (words, count) = (buffers.words.view(), mesh.vertices() as u32);
        let groups = count.div_ceil(WORKGROUP).clamp(1, END_GROUPS);
        let (half_edges, ends) = (buffers.half_edges.view(), buffers.ends.view());
        for (groups, count, last) in [(groups, count, 0), (1, 2 * groups, 1)] {
            let arguments = InsertEndsArgs { triangles, links, positions, half_edges, ends, words, count, last };
            recording.dispatch(&self.ends, [groups, 1, 1], &arguments);
        }
        recording.dispatch(&self.apex, [groups, 1, 1], &InsertApexArgs { positions, words, count });
        let arguments = InsertJoinArgs { triangles, links, positions, slots: mesh.slots(), freed: input.freed, words };
        recording.dispatch(&self.join, [groups, 1, 1], &arguments);
    }

    /// One round, and one round of flips.
    fn record_round(
        &self,
        round: &mut Recording,
        mesh: &Mesh,
        flips: (&flips::Stage, &flips::Buffers),
        buffers: &Buffers,
        input: Input<'_>,
    ) -> Result<(), Error> {
        let hull = flips.1.list();
        self.record_insertion(round, mesh, hull, buffers, input)?;
        let note = Some(buffers.word(Word::Tested, 2)?);
        flips.0.record_round(round, mesh, flips.1, &buffers.edges, &buffers.flips, note)?;
        // A hull is closed often, and little is to be done.
        flips.0.record_close_hull(round, mesh, flips.1, Some((hull, 0)), &buffers.hull)?;
        self.record_end(round, mesh, flips.1, buffers)
    }

    /// Where the mesh fell behind: rounds of flips and, if none are left to be made, a round.
    fn record_turn(
        &self,
        turn: &mut Recording,
        mesh: &Mesh,
        flips: (&flips::Stage, &flips::Buffers),
        buffers: &Buffers,
        input: Input<'_>,
    ) -> Result<(), Error> {
        let (hull, words) = (flips.1.list(), buffers.words.view());
        flips.0.record_rounds(turn, mesh, flips.1, &buffers.edges, &buffers.flips)?;
        let arguments = InsertResumeArgs { pending: flips.1.pending()?, words, groups: flips.0.groups() };
        turn.dispatch(&self.resume, [1, 1, 1], &arguments);
        self.record_insertion(turn, mesh, hull, buffers, input)?;
        let sizes = [buffers.word(Word::WideGroups, 3)?, buffers.word(Word::OneGroup, 3)?];
        flips.0.record_close_hull_told(turn, mesh, flips.1, (hull, 0), &buffers.hull, sizes)?;
        self.record_end(turn, mesh, flips.1, buffers)
    }

    fn record_end(
        &self,
        round: &mut Recording,
        mesh: &Mesh,
        flips: &flips::Buffers,
        buffers: &Buffers,
    ) -> Result<(), Error> {
        let (words, slots) = (buffers.words.view(), mesh.capacity() as u32);
        round.dispatch(&self.turn, [1, 1, 1], &InsertTurnArgs { reflex: flips.pending()?, words, slots });
        Ok(())
    }

    /// The four kernels of a round.
    fn record_insertion(
        &self,
        round: &mut Recording,
        mesh: &Mesh,
        hull: &EdgeList,
        buffers: &Buffers,
        input: Input<'_>,
    ) -> Result<(), Error> {
        let (triangles, links) = (mesh.corners(), mesh.twins());
        let (waiting, places, claims) = (buffers.waiting.view(), buffers.places.view(), buffers.claims.view());
        let words = buffers.words.view();
        let groups = buffers.word(Word::Groups, 3)?;
        let (limit, freed) = (mesh.vertices() as u32, input.freed);
        let arguments = InsertLocateArgs {
            triangles,
            links,
            positions: mesh.positions().cast(),
            waiting,
            freed,
            places,
            claims,
            vertex_of: buffers.vertex_of.view(),
            words,
            limit,
            vertices: mesh.vertices() as u32,
        };
        round.dispatch_indirect(&self.locate, groups, &arguments);
        let arguments = InsertClaimArgs { links, waiting, places, claims, words, limit };
        round.dispatch_indirect(&self.claim, groups, &arguments);
        let arguments = InsertGraftArgs { triangles, links, waiting, freed, places, claims, words, limit };
        round.dispatch_indirect(&self.graft, groups, &arguments);
        let arguments = InsertRelinkArgs {
            triangles,
            links,
            places,
            claims,
            edges: buffers.edges.edges(),
            edge_count: buffers.edges.count(),
            hull_edges: hull.edges(),
            hull_count: hull.count(),
            words,
            edge_limit: buffers.edges.limit(),
            hull_limit: hull.limit(),
        };
        round.dispatch_indirect(&self.relink, groups, &arguments);
        Ok(())
    }
}
