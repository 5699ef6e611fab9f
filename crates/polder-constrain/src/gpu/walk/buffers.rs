//! What the stage holds on the device beside the mesh.

use crate::gpu::pieces;
use polder_vulkan::primitives::Scan;
use polder_vulkan::{Buffer, Device, Error, Estimate, Pool, View};

const WORDS: usize = 128;
/// Room for later pieces beyond one for every four constraints.
const SPARE_PIECES: usize = 1 << 16;

/// Places of words that the host knows, as in `walk.glsl`.
#[derive(Clone, Copy)]
pub(super) enum Word {
    Waiting = 0,
    Groups = 4,
    Stops = 8,
    Lost = 12,
    SubConstraints = 16,
    Chained = 20,
    Listed = 24,
    StopsBefore = 126,
}

/// What the stage holds beside the mesh.
#[derive(Debug)]
pub struct Buffers {
    pub(super) constraints: usize,
    pub(super) stops_room: usize,
    pub(super) spokes: Buffer<u32>,
    pub(super) degrees: Buffer<u32>,
    pub(super) ends: Buffer<[u32; 2]>,
    pub(super) met: Buffer<u32>,
    pub(super) offsets: Buffer<u32>,
    pub(super) stops: Buffer<[u32; 3]>,
    /// Before there are chains: where the later pieces of constraints stand.
    pub(super) chains: Buffer<u32>,
    /// Before there are sub-constraints: the state of walks and two lists.
    pub(super) sub_constraints: Buffer<[u32; 2]>,
    pub(super) pieces: pieces::Buffers,
    pub(super) piece_met: Buffer<u32>,
    pub(super) words: Buffer<u32>,
    pub(super) scan: Scan,
}

/// How much room there is for what.
#[derive(Clone, Copy)]
struct Room {
    vertices: usize,
    constraints: usize,
    stops: usize,
    pieces: usize,
}

/// Room for later pieces. Lists of items lie behind each other, each at a multiple of 16 bytes.
pub(super) fn pieces(constraints: usize) -> usize {
    (constraints + constraints / 4 + SPARE_PIECES).next_multiple_of(4) - constraints
}

impl Room {
    fn new(vertices: usize, constraints: usize, stops: usize) -> Self {
        Self { vertices, constraints, stops, pieces: pieces(constraints) }
    }

    /// Constraints and later pieces.
    fn items(&self) -> usize {
        self.constraints + self.pieces
    }

    fn chains(&self) -> usize {
        2 * self.constraints + self.stops
    }

    fn sub_constraints(&self) -> usize {
        (self.constraints + self.stops).max((3 * self.items()).div_ceil(2))
    }

    fn estimate(&self) -> Estimate {
        Estimate::new()
            .buffer::<u32>("spokes", self.vertices)
            .buffer::<u32>("degrees", self.vertices)
            .buffer::<[u32; 2]>("ends of constraints", self.constraints)
            .buffer::<u32>("vertices met", self.constraints)
            .buffer::<u32>("offsets of chains", self.constraints + 1)
            .buffer::<[u32; 3]>("stops", self.stops)
            .buffer::<u32>("chains", self.chains())
            .buffer::<[u32; 2]>("sub-constraints", self.sub_constraints())
            .buffer::<u32>("vertices met by pieces", self.pieces)
            .buffer::<u32>("walk words", WORDS)
            .and(pieces::Buffers::estimate(self.vertices, self.pieces))
            .and(Scan::estimate(self.items().max(self.constraints + 1)))
    }
}

/// What [`Buffers::new`] will hold.
pub(super) fn estimate(vertices: usize, constraints: usize, stops: usize) -> Estimate {
    Room::new(vertices, constraints, stops).estimate()
}

impl Buffers {
    pub(super) fn new(device: &Device, vertices: usize, constraints: usize, stops: usize) -> Result<Self, Error> {
        let room = Room::new(vertices, constraints, stops);
        room.estimate().check(device)?;
        Ok(Self {
            constraints,
            stops_room: stops,
            spokes: Buffer::new(device, "spokes", vertices)?,
            degrees: Buffer::new(device, "degrees", vertices)?,
            ends: Buffer::new(device, "ends of constraints", constraints)?,
            met: Buffer::new(device, "vertices met", constraints)?,
            offsets: Buffer::new(device, "offsets of chains", constraints + 1)?,
            stops: Buffer::new(device, "stops", stops)?,
            chains: Buffer::new(device, "chains", room.chains())?,
            sub_constraints: Buffer::new(device, "sub-constraints", room.sub_constraints())?,
            pieces: pieces::Buffers::new(device, vertices, room.pieces)?,
            piece_met: Buffer::new(device, "vertices met by pieces", room.pieces)?,
            words: Buffer::new(device, "walk words", WORDS)?,
            scan: Scan::new(device, room.items().max(constraints + 1))?,
        })
    }

    /// Gives what later stages do not need: all but chains, sub-constraints, spokes and degrees, and the pieces with their
    /// seeds. See [`Buffer::give`].
    pub fn give(&self, pool: &Pool) {
        self.ends.give(pool);
        self.met.give(pool);
        self.stops.give(pool);
        self.piece_met.give(pool);
    }

    /// A list of later pieces, which serves again for other walks, and seeds if a grid was given.
    pub fn pieces(&self) -> &pieces::Buffers {
        &self.pieces
    }

    /// For each vertex some half-edge that leaves it; [`NONE`](polder_mesh::NONE) for a point that is no vertex.
    pub fn spokes(&self) -> View<'_, u32> {
        self.spokes.view()
    }

    /// For each vertex how many half-edges leave it.
    pub fn degrees(&self) -> View<'_, u32> {
        self.degrees.view()
    }

    /// The sub-constraints, constraint after constraint and along each: pairs of vertices, the lower one first. Where
    /// constraints repeat or overlap, theirs stand here repeatedly.
    pub fn sub_constraints(&self) -> View<'_, [u32; 2]> {
        self.sub_constraints.view()
    }

    /// One word: how many there are; none if a walk was lost or there was no room.
    ///
    /// # Errors
    ///
    /// None.
    pub fn sub_constraint_count(&self) -> Result<View<'_, u32>, Error> {
        self.word(Word::SubConstraints, 1)
    }

    /// For each constraint where its chain begins, and the end of the last one. Its sub-constraints begin at the same
    /// number, less its own.
    ///
    /// # Errors
    ///
    /// None.
    pub fn offsets(&self) -> Result<View<'_, u32>, Error> {
        self.offsets.slice(0..self.constraints + 1)
    }

    /// The vertices along the constraints, from first end to second; one for a constraint of zero length.
    pub fn chains(&self) -> View<'_, u32> {
        self.chains.view()
    }

    /// One word: how many vertices all chains have.
    ///
    /// # Errors
    ///
    /// None.
    pub fn chained(&self) -> Result<View<'_, u32>, Error> {
        self.word(Word::Chained, 1)
    }

    /// By constraint, before there are chains: where its later pieces stand.
    pub(super) fn runs(&self) -> Result<View<'_, u32>, Error> {
        self.chains.slice(0..self.constraints)
    }

    /// The first list of walks, before there are sub-constraints: behind the state of all items.
    pub(super) fn walkers(&self) -> Result<View<'_, u32>, Error> {
        let items = self.constraints + self.piece_met.len();
        self.sub_constraints.view().cast::<u32>().slice(items..2 * items)
    }

    pub(super) fn word(&self, word: Word, count: usize) -> Result<View<'_, u32>, Error> {
        self.words.slice(word as usize..word as usize + count)
    }
}
