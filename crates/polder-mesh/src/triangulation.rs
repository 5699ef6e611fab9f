use crate::canonical::{self, Slot};
use crate::{
    AddedVertex, Chains, ConstraintId, Digest, EdgeId, GhostMesh, MeshError, NONE, TriangleId, VertexId, next, prev,
};
use std::sync::OnceLock;

/// The constrained Delaunay triangulation of a PSLG, in canonical order.
///
/// Vertices are numbered as the input's points; of points equal in value the lowest index is the vertex, the others
/// are its [duplicates](Self::duplicates). Each triangle starts at its smallest vertex and goes counterclockwise;
/// triangles are sorted by their corners. Two triangulations of the same input are therefore equal, byte for byte,
/// if and only if they have the same triangles, and [`digest`](Self::digest) tells.
///
/// Where the input has no triangle (fewer than three vertices, or all on one line) it is empty, and the chains of the
/// constraints are still there.
#[derive(Clone, Debug, Default)]
pub struct Triangulation {
    triangles: Vec<[u32; 3]>,
    neighbors: Vec<[u32; 3]>,
    constrained: Vec<u8>,
    representatives: Vec<u32>,
    chains: Chains,
    added: Vec<AddedVertex>,
    half_edges: OnceLock<Vec<u32>>,
}

/// What a triangulation holds beside its triangles.
#[derive(Clone, Debug, Default)]
pub struct Parts {
    /// For each input point the vertex that stands for it: itself, or the lowest point equal to it.
    pub representatives: Vec<u32>,
    /// The vertices along each constraint.
    pub chains: Chains,
}

/// The arrays of a triangulation, as [`Triangulation::from_canonical`] takes them.
#[derive(Clone, Debug, Default)]
pub struct Arrays {
    /// [`Triangulation::triangles`].
    pub triangles: Vec<[u32; 3]>,
    /// [`Triangulation::neighbors`].
    pub neighbors: Vec<[u32; 3]>,
    /// [`Triangulation::constrained_bits`].
    pub constrained: Vec<u8>,
    /// All else.
    pub parts: Parts,
}

/// An edge of a triangulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// The edge as seen from its (lower) triangle.
    pub id: EdgeId,
    /// Its two vertices, in the order in which that triangle runs through them.
    pub vertices: [VertexId; 2],
    /// Whether it is part of a constraint.
    pub constrained: bool,
}

impl PartialEq for Triangulation {
    fn eq(&self, other: &Self) -> bool {
        self.triangles == other.triangles
            && self.constrained == other.constrained
            && self.representatives == other.representatives
            && self.chains == other.chains
            && self.added == other.added
    }
}

impl Eq for Triangulation {}

impl Triangulation {
    /// Puts the finite triangles among `slots` slots into canonical order; `get` gives the triangle of a slot, if it
    /// holds one. Corners must be smaller than the number of representatives.
    pub fn from_slots(slots: usize, get: impl Fn(usize) -> Option<Slot> + Sync, parts: Parts) -> Self {
        let sorted = canonical::sort(parts.representatives.len(), slots, get);
        Self {
            triangles: sorted.triangles,
            neighbors: sorted.neighbors,
            constrained: sorted.constrained,
            representatives: parts.representatives,
            chains: parts.chains,
            added: Vec::new(),
            half_edges: OnceLock::new(),
        }
    }

    /// Puts the finite triangles of a working mesh into canonical order; vertex `v` of the mesh becomes `names[v]`.
    pub fn from_mesh(mesh: &GhostMesh, names: &[u32], parts: Parts) -> Self {
        let get = |t: usize| {
            mesh.is_finite(t).then(|| Slot {
                corners: mesh.triangles[t].map(|v| names[v as usize]),
                neighbors: mesh.links[t].map(|h| h / 3),
                constrained: mesh.constrained[t],
            })
        };
        Self::from_slots(mesh.slots(), get, parts)
    }

    /// A triangulation whose arrays are in canonical order already.
    ///
    /// # Errors
    ///
    /// [`MeshError::Broken`] if the arrays differ in length, a corner is not below the number of representatives, a triangle
    /// does not start at its smallest corner, is not greater than the one before it, or has a neighbor that does not exist.
    /// Nothing else is checked.
    pub fn from_canonical(
        triangles: Vec<[u32; 3]>,
        neighbors: Vec<[u32; 3]>,
        constrained: Vec<u8>,
        parts: Parts,
    ) -> Result<Self, MeshError> {
        canonical::check(parts.representatives.len(), &triangles, &neighbors, &constrained)?;
        let Parts { representatives, chains } = parts;
        let (added, half_edges) = (Vec::new(), OnceLock::new());
        Ok(Self { triangles, neighbors, constrained, representatives, chains, added, half_edges })
    }

    /// Gives its arrays back; what vertices were added is forgotten.
    pub fn into_arrays(self) -> Arrays {
        let Self { triangles, neighbors, constrained, representatives, chains, .. } = self;
        Arrays { triangles, neighbors, constrained, parts: Parts { representatives, chains } }
    }

    /// Gives back memory that it does not need.
    pub fn shrink_to_fit(&mut self) {
        self.triangles.shrink_to_fit();
        self.neighbors.shrink_to_fit();
        self.constrained.shrink_to_fit();
        self.representatives.shrink_to_fit();
    }

    /// A triangulation from bare triangles, as a mesh file gives them: neighbors are found by sorting edges.
    ///
    /// # Errors
    ///
    /// [`MeshError::Broken`] if a corner is not below `points`, a triangle has a vertex twice, or two triangles lie on
    /// the same side of an edge. Nothing else is checked.
    pub fn from_triangles(points: usize, triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        let neighbors = canonical::neighbors_of(points, triangles)?;
        let get = |t: usize| Some(Slot { corners: triangles[t], neighbors: neighbors[t], constrained: 0 });
        let parts = Parts { representatives: (0..points as u32).collect(), chains: Chains::default() };
        Ok(Self::from_slots(triangles.len(), get, parts))
    }

    /// The triangles for which `keep` says so, in the same order, and which these were.
    ///
    /// Vertices, chains and constrained edges are as before, also those that no triangle has any more. Where triangles
    /// are gone there is no neighbor, as at the hull; [`hull`](Self::hull) and [`star`](Self::star) then tell one border and
    /// one fan of several.
    pub fn filter(&self, keep: impl Fn(TriangleId) -> bool) -> (Self, Vec<TriangleId>) {
        let kept: Vec<TriangleId> = (0..self.triangles.len() as u32).map(TriangleId).filter(|&t| keep(t)).collect();
        let mut place = vec![NONE; self.triangles.len()];
        kept.iter().enumerate().for_each(|(i, t)| place[t.index()] = i as u32);
        let renamed = |n: u32| place.get(n as usize).copied().unwrap_or(NONE);
        let filtered = Self {
            triangles: kept.iter().map(|t| self.triangles[t.index()]).collect(),
            neighbors: kept.iter().map(|t| self.neighbors[t.index()].map(renamed)).collect(),
            constrained: kept.iter().map(|t| self.constrained[t.index()]).collect(),
            representatives: self.representatives.clone(),
            chains: self.chains.clone(),
            added: self.added.clone(),
            half_edges: OnceLock::new(),
        };
        (filtered, kept)
    }

    /// The corners of each triangle, counterclockwise, smallest first, sorted.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The triangle across each edge, or [`NONE`] at the hull; edge `k` is opposite corner `k`.
    pub fn neighbors(&self) -> &[[u32; 3]] {
        &self.neighbors
    }

    /// For each triangle, bit `k` says that edge `k` is part of a constraint.
    pub fn constrained_bits(&self) -> &[u8] {
        &self.constrained
    }

    /// For each input point the vertex that stands for it.
    pub fn representatives(&self) -> &[u32] {
        &self.representatives
    }

    /// The points that equal a lower point, each with that vertex.
    pub fn duplicates(&self) -> impl Iterator<Item = (u32, VertexId)> + '_ {
        self.representatives
            .iter()
            .enumerate()
            .filter(|(i, v)| *i != **v as usize)
            .map(|(i, v)| (i as u32, VertexId(*v)))
    }

    /// The vertices: all points but the duplicates.
    pub fn vertices(&self) -> impl Iterator<Item = VertexId> + '_ {
        self.representatives.iter().enumerate().filter(|(i, v)| *i == **v as usize).map(|(_, v)| VertexId(*v))
    }

    /// The vertices along each constraint.
    pub fn chains(&self) -> &Chains {
        &self.chains
    }

    /// The vertices along one constraint, from its first end to its second.
    pub fn chain(&self, constraint: ConstraintId) -> &[u32] {
        self.chains.get(constraint.index())
    }

    /// The vertices that are no input points: the last ones of [`representatives`](Self::representatives).
    pub fn added(&self) -> &[AddedVertex] {
        &self.added
    }

    /// Says that the last vertices were added where constraints cross, and what the chains of the constraints are then.
    pub fn with_added(self, added: Vec<AddedVertex>, chains: Chains) -> Self {
        Self { added, chains, ..self }
    }

    /// The corners of one triangle.
    pub fn triangle(&self, t: TriangleId) -> [VertexId; 3] {
        self.triangles[t.index()].map(VertexId)
    }

    /// The edge on the other side of an edge, if there is a triangle.
    pub fn twin(&self, edge: EdgeId) -> Option<EdgeId> {
        let neighbor = self.neighbors[edge.triangle().index()][edge.k()];
        if neighbor == NONE {
            return None;
        }
        let from = self.ends(edge)[0];
        let t = TriangleId(neighbor);
        (0..3).map(|k| EdgeId::of(t, k)).find(|&other| self.ends(other)[1] == from)
    }

    /// The two vertices of an edge, in the order in which its triangle runs through them.
    pub fn ends(&self, edge: EdgeId) -> [VertexId; 2] {
        let corners = self.triangles[edge.triangle().index()];
        [corners[(edge.k() + 1) % 3], corners[(edge.k() + 2) % 3]].map(VertexId)
    }

    /// Whether an edge is part of a constraint.
    pub fn is_constrained(&self, edge: EdgeId) -> bool {
        self.constrained[edge.triangle().index()] >> edge.k() & 1 == 1
    }

    /// Every edge once, seen from its lower triangle, in the order of the triangles.
    pub fn edges(&self) -> impl Iterator<Item = Edge> + '_ {
        (0..3 * self.triangles.len() as u32).map(EdgeId).filter_map(|id| {
            let neighbor = self.neighbors[id.triangle().index()][id.k()];
            (neighbor > id.triangle().0).then(|| Edge {
                id,
                vertices: self.ends(id),
                constrained: self.is_constrained(id),
            })
        })
    }

    /// The vertices of the convex hull, counterclockwise, from the smallest one, collinear ones included.
    pub fn hull(&self) -> Vec<VertexId> {
        let outside = |e: &EdgeId| self.neighbors[e.triangle().index()][e.k()] == NONE;
        let all = (0..3 * self.triangles.len() as u32).map(EdgeId);
        let Some(first) = all.filter(outside).min_by_key(|&e| self.ends(e)[0]) else { return Vec::new() };
        let mut hull = Vec::new();
        let mut edge = first;
        // Each hull edge is met once, so that a broken mesh cannot keep this loop going.
        while hull.len() < 3 * self.triangles.len() {
            hull.push(self.ends(edge)[0]);
            edge = EdgeId(next(edge.0));
            for _ in 0..self.triangles.len() {
                let Some(other) = self.twin(edge) else { break };
                edge = EdgeId(next(other.0));
            }
            if edge == first {
                break;
            }
        }
        hull
    }

    /// The triangles around a vertex, counterclockwise; at the hull, from the first to the last. Empty for a
    /// duplicate. The first call builds a table of one half-edge a vertex.
    pub fn star(&self, vertex: VertexId) -> Vec<TriangleId> {
        let table = self.half_edges.get_or_init(|| self.first_half_edges());
        let Some(&start) = table.get(vertex.index()).filter(|&&h| h != NONE) else { return Vec::new() };
        let mut star = Vec::new();
        let mut edge = EdgeId(start);
        while star.len() < self.triangles.len() {
            star.push(edge.triangle());
            match self.twin(EdgeId(prev(edge.0))) {
                Some(other) if other.0 != start => edge = other,
                _ => break,
            }
        }
        star
    }

    /// For each vertex a half-edge that starts there: the hull's own where there is one.
    fn first_half_edges(&self) -> Vec<u32> {
        let mut table = vec![NONE; self.representatives.len()];
        for h in (0..3 * self.triangles.len() as u32).rev() {
            let from = self.ends(EdgeId(h))[0].index();
            let outside = |h: u32| self.neighbors[h as usize / 3][h as usize % 3] == NONE;
            if table[from] == NONE || !outside(table[from]) {
                table[from] = h;
            }
        }
        table
    }

    /// A hash of the triangles in canonical order, and of the added vertices' positions: the same on every backend,
    /// device and number of threads.
    pub fn digest(&self) -> Digest {
        Digest::of(&self.triangles, &self.added)
    }
}
