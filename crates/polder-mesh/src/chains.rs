/// For each constraint, the vertices along it from its first end to its second, both included.
///
/// Each pair of successive vertices is one piece of the constraint; together the pieces cover it. A constraint of
/// zero length has one vertex and no piece. Chains speak of vertices, not of mesh edges, so that they have an
/// answer where all points lie on one line and there is no mesh at all.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chains {
    offsets: Vec<u32>,
    vertices: Vec<u32>,
}

impl Default for Chains {
    fn default() -> Self {
        Self { offsets: vec![0], vertices: Vec::new() }
    }
}

impl Chains {
    /// The most vertices that all chains together can have.
    pub const MAX_VERTICES: usize = u32::MAX as usize;

    /// No chains, with room for `constraints` of them.
    pub fn with_capacity(constraints: usize) -> Self {
        let mut offsets = Vec::with_capacity(constraints + 1);
        offsets.push(0);
        Self { offsets, vertices: Vec::with_capacity(2 * constraints) }
    }

    /// Appends the chain of the next constraint.
    ///
    /// # Panics
    ///
    /// If all chains together have more than [`MAX_VERTICES`](Self::MAX_VERTICES) vertices; callers count before.
    pub fn push(&mut self, chain: impl IntoIterator<Item = u32>) {
        self.vertices.extend(chain);
        let end = u32::try_from(self.vertices.len()).expect("at most MAX_VERTICES vertices in all chains");
        self.offsets.push(end);
    }

    /// The number of constraints.
    pub fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Whether there are no constraints.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The vertices along constraint `i`.
    pub fn get(&self, i: usize) -> &[u32] {
        &self.vertices[self.offsets[i] as usize..self.offsets[i + 1] as usize]
    }

    /// The chains of all constraints in order.
    pub fn iter(&self) -> impl Iterator<Item = &[u32]> {
        (0..self.len()).map(|i| self.get(i))
    }

    /// Renames every vertex `v` to `names[v]`.
    pub fn rename(&mut self, names: &[u32]) {
        for v in &mut self.vertices {
            *v = names[*v as usize];
        }
    }
}
