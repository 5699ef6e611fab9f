use super::is_ghost_edge;
use polder_mesh::{GhostMesh, NONE};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scope {
    /// Every edge.
    All,
    /// Ghost edges alone.
    Hull,
}

/// The edges to be tested in the next round, and the arrays that rounds need.
///
/// Half-edges may be added at any time, in any order, from either side and repeatedly, also while slots are added or
/// freed between rounds: an edge is tested once a round, a freed one not at all.
#[derive(Clone, Debug)]
pub struct Active {
    pub(super) scope: Scope,
    pub(super) candidates: Vec<u32>,
    /// For each triangle the least priority that claims it, [`NONE`] between rounds.
    pub(super) claims: Vec<u32>,
    /// Whether a triangle is part of one of this round's flips; all false between rounds.
    pub(super) flipped: Vec<bool>,
    /// Whether a half-edge has been met in this round; all false between rounds.
    pub(super) listed: Vec<bool>,
    pub(super) legal: Vec<u32>,
    pub(super) winners: Vec<u32>,
    pub(super) tests: u64,
    pub(super) illegal: u64,
}

impl Default for Active {
    fn default() -> Self {
        Self::new()
    }
}

impl Active {
    fn with(scope: Scope, candidates: Vec<u32>) -> Self {
        Self {
            scope,
            candidates,
            claims: Vec::new(),
            flipped: Vec::new(),
            listed: Vec::new(),
            legal: Vec::new(),
            winners: Vec::new(),
            tests: 0,
            illegal: 0,
        }
    }

    /// No edge yet.
    pub fn new() -> Self {
        Self::with(Scope::All, Vec::new())
    }

    /// Every edge of the mesh.
    pub fn all(mesh: &GhostMesh) -> Self {
        let edges = (0..3 * mesh.slots() as u32).filter(|&h| mesh.twin(h) != NONE && h < mesh.twin(h));
        Self::with(Scope::All, edges.collect())
    }

    /// Every ghost edge of the mesh; rounds then make ghost flips alone, whatever else is added.
    pub fn hull(mesh: &GhostMesh) -> Self {
        let edges = (0..3 * mesh.slots() as u32).filter(|&h| mesh.twin(h) != NONE && h < mesh.twin(h));
        Self::with(Scope::Hull, edges.filter(|&h| is_ghost_edge(mesh, h)).collect())
    }

    /// Adds the edge of a half-edge.
    pub fn push(&mut self, h: u32) {
        self.candidates.push(h);
    }

    /// Adds the three edges of a triangle.
    pub fn push_triangle(&mut self, t: usize) {
        let h = 3 * t as u32;
        self.candidates.extend([h, h + 1, h + 2]);
    }

    /// Drops all that was added.
    pub fn clear(&mut self) {
        self.candidates.clear();
    }

    /// The half-edges added, in no particular order.
    pub fn half_edges(&self) -> &[u32] {
        &self.candidates
    }

    /// Whether nothing is left to test.
    pub fn is_empty(&self) -> bool {
        self.candidates.is_empty()
    }

    /// How many tests all rounds so far have made.
    pub fn tests(&self) -> u64 {
        self.tests
    }

    /// How many of the edges that the last round tested were illegal.
    pub fn illegal(&self) -> u64 {
        self.illegal
    }

    pub(super) fn fit(&mut self, mesh: &GhostMesh) {
        self.claims.resize(mesh.slots(), NONE);
        self.flipped.resize(mesh.slots(), false);
        self.listed.resize(3 * mesh.slots(), false);
    }
}
