//! Constraints are cut at the vertices that they run through. \[QCT\] section 4.1.
//!
//! 1. *Names.* The ends of the constraints, as the input numbers its points, become vertices of the mesh.
//! 2. *Edges.* Every vertex learns some half-edge that leaves it, and how many do. A constraint looks for its other end
//!    among the neighbors of the end that has fewer, by their numbers alone: then it is an edge and done.
//! 3. *Walk.* The others walk straight to their other end, one invocation each, and list the vertices that they meet; long
//!    ones go in [`pieces`], one invocation for each. Signs are always those of the whole line, so that a step
//!    is one orientation wherever the walk is. A walk that has not ended after some number of steps goes on in the next
//!    dispatch. If few have not ended after the first, all vertices are held against them, and one that runs through many
//!    begins again in pieces that begin at some of these.
//! 4. *Chains.* A constraint's chain is its ends and what it met; where chains begin is a prefix sum. From each vertex of a
//!    chain to the next is a sub-constraint.
//!
//! Departures from the reference: constraints that repeat walk each for itself and their sub-constraints stand there
//! repeatedly, in the order of constraints, not sorted. Chains are the same.
//!
//! # Cost
//!
//! Memory: 12 bytes a vertex, 37 a constraint, and 24 for each vertex that may be met between ends. A constraint that is an
//! edge reads a row of the mesh for each spoke that it looks at, half of them on average.

mod buffers;

pub use buffers::Buffers;

use super::pieces::{self, Grid, Walkers, strides};
use crate::ConstrainError;
use crate::kernels::*;
use buffers::Word;
use polder_flip::gpu::{Arithmetic, Mesh};
use polder_vulkan::primitives::Count;
use polder_vulkan::{Device, DeviceKind, Error, Estimate, Kernel, ReadBack, Recording, RunReport, View, groups_for};

const NONE: u32 = u32::MAX;
const WORKGROUP: u32 = 256;
/// Workgroups of kernels that stride over lists whose length only the device knows.
const GROUPS: u32 = 1056;
/// Steps after which a walk is begun again in other pieces, if it runs through many vertices: most pieces have a tenth as many.
const FIRST_STEPS: u32 = 512;

/// The input's points in the order of the mesh, and which vertices they are.
#[derive(Clone, Copy, Debug)]
pub struct Names<'a> {
    /// The point of the input, by the number that positions have; each once.
    pub order: View<'a, u32>,
    /// The vertex that it is or equals, by the same.
    pub vertex_of: View<'a, u32>,
}

/// What is to be cut.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// The ends of the constraints.
    pub constraints: View<'a, [u32; 2]>,
    /// Where ends are points of the input. Without, they are vertices.
    pub names: Option<Names<'a>>,
    /// A grid over all points, so that long walks go in pieces.
    pub grid: Option<Grid>,
}

/// What came out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Sub-constraints, repeated ones included.
    pub sub_constraints: u64,
    /// Vertices in all chains.
    pub chained: u64,
}

/// Where [`Counts`] will be found in the report of a run.
#[derive(Clone, Copy, Debug)]
pub struct Read {
    words: ReadBack,
    room: u32,
}

impl Read {
    /// After the run.
    ///
    /// # Errors
    ///
    /// [`ConstrainError::WalkLost`] if the mesh was no triangulation; [`ConstrainError::TooManyStops`] if buffers with more
    /// room are needed.
    pub fn result(&self, report: &RunReport) -> Result<Counts, ConstrainError> {
        let words = report.words(self.words);
        let word = |at: Word| words.get(at as usize).copied().unwrap_or(0);
        let (constraint, needed, room) = (word(Word::Lost), word(Word::Stops), self.room);
        if constraint != NONE {
            return Err(ConstrainError::WalkLost { constraint });
        }
        if needed > room {
            // How far walks get before they begin again may differ from run to run.
            let needed = needed.saturating_add(word(Word::StopsBefore));
            return Err(ConstrainError::TooManyStops { needed, room });
        }
        Ok(Counts { sub_constraints: word(Word::SubConstraints).into(), chained: word(Word::Chained).into() })
    }
}

/// The kernels of the stage on one device.
#[derive(Debug)]
pub struct Stage {
    device: Device,
    /// Steps of a walk in one dispatch, and in the first one.
    most: u32,
    first_most: u32,
    name_points: Kernel<NamePoints>,
    name_ends: Kernel<NameEnds>,
    find_spokes: Kernel<FindSpokes>,
    find_edges: Kernel<FindEdges>,
    pieces: pieces::Stage,
    turn: Kernel<WalkTurn>,
    walk: Kernel<WalkConstraints>,
    plan_again: Kernel<PlanAgain>,
    spread: Kernel<SpreadVertices>,
    begin_again: Kernel<BeginAgain>,
    trim: Kernel<TrimPieces>,
    place: Kernel<PlaceChains>,
    list: Kernel<ListSubConstraints>,
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
        // lavapipe leaves a shader, without a word, once its loops have made 65535 turns.
        let most = if device.info().kind == DeviceKind::Cpu { 128 } else { 8192 };
        Ok(Self {
            device: device.clone(),
            most,
            first_most: most.min(FIRST_STEPS),
            name_points: Kernel::new(device, &workgroup)?,
            name_ends: Kernel::new(device, &workgroup)?,
            find_spokes: Kernel::new(device, &workgroup)?,
            find_edges: Kernel::new(device, &workgroup)?,
            pieces: pieces::Stage::new(device, arithmetic)?,
            turn: Kernel::new(device, &workgroup)?,
            walk: arithmetic.kernel(device, &workgroup)?,
            plan_again: Kernel::new(device, &workgroup)?,
            spread: arithmetic.kernel(device, &workgroup)?,
            begin_again: Kernel::new(device, &workgroup)?,
            trim: Kernel::new(device, &workgroup)?,
            place: Kernel::new(device, &workgroup)?,
            list: Kernel::new(device, &workgroup)?,
        })
    }

    /// Steps of a walk in one dispatch, other than what suits the device: for tests.
    #[doc(hidden)]
    pub fn set_most_steps(&mut self, most: u32) {
        self.most = most.max(2);
        self.first_most = self.most;
    }

    /// Room for vertices between ends that most inputs do with.
    pub fn usual_stops(constraints: usize) -> usize {
        2 * constraints + (1 << 16)
    }

    /// Room for later pieces of long walks: see [`Buffers::pieces`].
    pub fn pieces(constraints: usize) -> usize {
        buffers::pieces(constraints)
    }

    /// What [`Stage::buffers`] will hold.
    pub fn estimate(vertices: usize, constraints: usize, stops: usize) -> Estimate {
        buffers::estimate(vertices, constraints, stops)
    }

    /// Memory for so many constraints on a mesh of so many vertices, which meet at most `stops` vertices between their ends.
    ///
    /// # Errors
    ///
    /// If the memory cannot be had: then before any of it is allocated.
    pub fn buffers(&self, vertices: usize, constraints: usize, stops: usize) -> Result<Buffers, Error> {
        Buffers::new(&self.device, vertices, constraints, stops)
    }

    /// Cuts constraints at the vertices of a triangulation of a convex hull, Delaunay or not.
    ///
    /// # Errors
    ///
    /// If the buffers are for another number of constraints or vertices.
    pub fn record(
        &self,
        recording: &mut Recording,
        mesh: &Mesh,
        buffers: &Buffers,
        input: Input<'_>,
    ) -> Result<Read, Error> {
        let (count, vertices) = (buffers.constraints, buffers.spokes.len());
        let named = input.names.map_or(vertices, |names| names.order.len().min(names.vertex_of.len()));
        if input.constraints.len() != count || mesh.vertices() != vertices || named != vertices {
            let (constraints, points) = (input.constraints.len(), mesh.vertices());
            let why = format!(
                "{constraints} constraints, {points} vertices, {named} names; buffers for {count} and {vertices}"
            );
            return Err(Error::Recording { command: "walk", why });
        }
        recording.fill(buffers.words.view(), 0);
        recording.fill(buffers.word(Word::Lost, 1)?, NONE);
        let ends = self.record_names(recording, buffers, input);
        self.record_spokes(recording, mesh, buffers);
        self.record_edges(recording, mesh, buffers, ends)?;
        self.record_pieces(recording, mesh, buffers, ends, input.grid)?;
        self.record_walks(recording, mesh, buffers, ends, input.grid)?;
        self.record_chains(recording, buffers, ends, input.grid.is_some());
        Ok(Read { words: recording.read(buffers.words.view()), room: buffers.stops_room as u32 })
    }

    fn record_names<'a>(
        &self,
        recording: &mut Recording,
        buffers: &'a Buffers,
        input: Input<'a>,
    ) -> View<'a, [u32; 2]> {
        let Some(names) = input.names else { return input.constraints };
        let (points, count) = (buffers.spokes.len(), buffers.constraints);
        // Degrees come later.
        let vertices = buffers.degrees.view();
        let Names { order, vertex_of } = names;
        let arguments = NamePointsArgs { order, vertex_of, vertices, count: points as u32 };
        recording.dispatch(&self.name_points, groups_for(points, WORKGROUP), &arguments);
        let (constraints, ends) = (input.constraints, buffers.ends.view());
        let arguments = NameEndsArgs {
            vertices,
            constraints: constraints.cast(),
            ends: ends.cast(),
            count: count as u32,
            points: points as u32,
        };
        recording.dispatch(&self.name_ends, groups_for(count, WORKGROUP), &arguments);
        ends
    }

    fn record_spokes(&self, recording: &mut Recording, mesh: &Mesh, buffers: &Buffers) {
        let (spokes, degrees) = (buffers.spokes.view(), buffers.degrees.view());
        recording.fill(spokes, NONE);
        recording.fill(degrees, 0);
        let arguments = FindSpokesArgs {
            triangles: mesh.corners(),
            slots: mesh.slots(),
            spokes,
            degrees,
            limit: mesh.capacity() as u32,
            vertices: mesh.vertices() as u32,
        };
        recording.dispatch(&self.find_spokes, groups_for(mesh.capacity(), WORKGROUP), &arguments);
    }

    fn record_edges(
        &self,
        recording: &mut Recording,
        mesh: &Mesh,
        buffers: &Buffers,
        ends: View<'_, [u32; 2]>,
    ) -> Result<(), Error> {
        let arguments = FindEdgesArgs {
            triangles: mesh.corners(),
            links: mesh.twins(),
            ends: ends.cast(),
            spokes: buffers.spokes.view(),
            degrees: buffers.degrees.view(),
            met: buffers.met.view(),
            lengths: buffers.offsets.view(),
            list: buffers.walkers()?,
            words: buffers.words.view(),
            constraints: buffers.constraints as u32,
        };
        recording.dispatch(&self.find_edges, groups_for(buffers.constraints + 1, WORKGROUP), &arguments);
        Ok(())
    }

    fn record_pieces(
        &self,
        recording: &mut Recording,
        mesh: &Mesh,
        buffers: &Buffers,
        ends: View<'_, [u32; 2]>,
        grid: Option<Grid>,
    ) -> Result<(), Error> {
        let Some(grid) = grid else {
            recording.fill(buffers.pieces.count(), 0);
            recording.fill(buffers.runs()?, NONE);
            return Ok(());
        };
        let spokes = buffers.spokes.view();
        self.pieces.record_seeds(recording, mesh, spokes, grid, &buffers.pieces)?;
        let walkers = Walkers {
            ends,
            list: buffers.walkers()?,
            listed: buffers.word(Word::Listed, 1)?,
            runs: buffers.runs()?,
            spokes,
            degrees: buffers.degrees.view(),
            known: None,
        };
        self.pieces.record(recording, mesh, &walkers, grid, &buffers.pieces);
        Ok(())
    }

    fn record_walks(
        &self,
        recording: &mut Recording,
        mesh: &Mesh,
        buffers: &Buffers,
        ends: View<'_, [u32; 2]>,
        grid: Option<Grid>,
    ) -> Result<(), Error> {
        let (words, piece_count) = (buffers.words.view(), buffers.pieces.count());
        let piece_limit = buffers.pieces.pieces().len() as u32;
        let turn = |begins| WalkTurnArgs { words, piece_count, piece_limit, begins };
        recording.dispatch(&self.turn, [1, 1, 1], &turn(1));
        let waiting = buffers.word(Word::Waiting, 1)?;
        let groups = buffers.word(Word::Groups, 3)?;
        let runs = buffers.runs()?;
        // A walk crosses each edge, or turns over it, from each of its ends once at most.
        let bound = 16 + 8 * (mesh.capacity() as u64) / u64::from(self.most - 1);
        let bound = u32::try_from(bound).unwrap_or(u32::MAX);
        let walk = |round: &mut Recording, most| {
            let arguments = WalkConstraintsArgs {
                triangles: mesh.corners(),
                links: mesh.twins(),
                positions: mesh.positions().cast(),
                ends: ends.cast(),
                spokes: buffers.spokes.view(),
                met: buffers.met.view(),
                lengths: buffers.offsets.view(),
                runs,
                pieces: buffers.pieces.pieces().cast(),
                piece_met: buffers.piece_met.view(),
                stops: buffers.stops.view().cast(),
                state: buffers.sub_constraints.view().cast(),
                words,
                constraints: buffers.constraints as u32,
                piece_limit,
                stop_limit: buffers.stops_room as u32,
                most,
            };
            round.dispatch_indirect(&self.walk, groups, &arguments);
            round.dispatch(&self.turn, [1, 1, 1], &turn(0));
        };
        if let Some(grid) = grid {
            walk(recording, self.first_most);
            self.record_again(recording, mesh, buffers, ends, grid)?;
        }
        recording.repeat_ahead("walk", waiting, bound, 1, 4, |round| walk(round, self.most));
        Ok(())
    }

    /// Walks that go on and run through many vertices begin again, from many of these.
    fn record_again(
        &self,
        recording: &mut Recording,
        mesh: &Mesh,
        buffers: &Buffers,
        ends: View<'_, [u32; 2]>,
        grid: Grid,
    ) -> Result<(), Error> {
        let (words, state, runs) = (buffers.words.view(), buffers.sub_constraints.view().cast(), buffers.runs()?);
        let (pieces, piece_count) = (buffers.pieces.pieces().cast(), buffers.pieces.count());
        let (piece_met, piece_limit) = (buffers.piece_met.view(), buffers.piece_met.len() as u32);
        let (constraints, spokes, met) = (buffers.constraints as u32, buffers.spokes.view(), buffers.met.view());
        let arguments = PlanAgainArgs { state, runs, pieces, piece_met, piece_count, words, constraints, piece_limit };
        recording.dispatch(&self.plan_again, [1, 1, 1], &arguments);
        let vertices = mesh.vertices();
        let (exponent, [low_x, low_y]) = grid.fine();
        let arguments = SpreadVerticesArgs {
            positions: mesh.positions().cast(),
            ends: ends.cast(),
            spokes,
            met,
            pieces,
            words,
            low_x,
            low_y,
            exponent,
            vertices: vertices as u32,
        };
        recording.dispatch(&self.spread, strides(vertices), &arguments);
        let arguments = BeginAgainArgs {
            ends: ends.cast(),
            spokes,
            met,
            runs,
            pieces,
            piece_met,
            stops: buffers.stops.view().cast(),
            state,
            words,
            constraints,
            piece_limit,
            stop_limit: buffers.stops_room as u32,
        };
        recording.dispatch(&self.begin_again, strides(buffers.piece_met.len()), &arguments);
        Ok(())
    }

    fn record_chains(&self, recording: &mut Recording, buffers: &Buffers, ends: View<'_, [u32; 2]>, in_pieces: bool) {
        let constraints = buffers.constraints as u32;
        let (met, offsets, words) = (buffers.met.view(), buffers.offsets.view(), buffers.words.view());
        let (pieces, before) = (buffers.pieces.pieces().cast(), buffers.piece_met.view());
        let (stops, stop_limit) = (buffers.stops.view().cast(), buffers.stops_room as u32);
        let chains = buffers.chains.view();
        if in_pieces {
            let (room, piece_count) = (before.len(), buffers.pieces.count());
            let piece_limit = room as u32;
            let arguments = TrimPiecesArgs { pieces, piece_met: before, lengths: offsets, piece_count, piece_limit };
            recording.dispatch(&self.trim, strides(room), &arguments);
            buffers.scan.record(recording, Count::on_device(piece_count, room), before, before, None);
        }
        buffers.scan.record(recording, buffers.constraints + 1, offsets, offsets, None);
        // One invocation a constraint at least; they stride over what the constraints met.
        let most = buffers.stops_room.min((GROUPS * WORKGROUP) as usize);
        let groups = groups_for(buffers.constraints.max(most).max(1), WORKGROUP);
        let arguments = PlaceChainsArgs {
            ends: ends.cast(),
            met,
            offsets,
            pieces,
            before,
            stops,
            words,
            chains,
            constraints,
            stop_limit,
        };
        recording.dispatch(&self.place, groups, &arguments);
        let arguments = ListSubConstraintsArgs {
            met,
            offsets,
            pieces,
            before,
            stops,
            words,
            chains,
            sub_constraints: buffers.sub_constraints.view().cast(),
            constraints,
            stop_limit,
        };
        recording.dispatch(&self.list, groups, &arguments);
    }
}
