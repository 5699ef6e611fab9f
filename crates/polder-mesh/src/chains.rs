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

    /// From an array of all vertices, one chain behind the other: chain `i` is `vertices[offsets[i]..offsets[i + 1]]`. `None`
    /// if the offsets do not begin with 0, fall, or do not end with the number of vertices.
    pub fn from_parts(offsets: Vec<u32>, vertices: Vec<u32>) -> Option<Self> {
        let ends = (offsets.first().copied(), offsets.last().map(|&end| end as usize));
        let fit = ends == (Some(0), Some(vertices.len())) && offsets.windows(2).all(|w| w[0] <= w[1]);
        fit.then_some(Self { offsets, vertices })
    }

    /// Its [`offsets`](Self::offsets) and [`vertices`](Self::vertices).
    pub fn into_parts(self) -> (Vec<u32>, Vec<u32>) {
        (self.offsets, self.vertices)
    }

    /// Where the chain of each constraint begins among the [`vertices`](Self::vertices), and where the last one ends.
    pub fn offsets(&self) -> &[u32] {
        &self.offsets
    }

    /// The vertices along all constraints, one chain behind the other.
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
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

#[cfg(test)]
mod tests {
    use super::Chains;

    #[test]
    fn parts_make_the_chains_that_were_pushed() {
        let mut chains = Chains::with_capacity(3);
        [vec![4, 1, 2], vec![7], vec![0, 3]].into_iter().for_each(|chain| chains.push(chain));
        assert_eq!((chains.offsets(), chains.vertices()), (&[0, 3, 4, 6][..], &[4, 1, 2, 7, 0, 3][..]));
        assert_eq!(Chains::from_parts(chains.offsets().to_vec(), chains.vertices().to_vec()), Some(chains));
        assert_eq!(Chains::from_parts(vec![0], vec![]), Some(Chains::default()));
        for (offsets, vertices) in [(vec![], 0), (vec![1], 1), (vec![0, 2], 1), (vec![0, 2, 1], 1), (vec![0], 2)] {
            assert_eq!(Chains::from_parts(offsets, vec![5; vertices]), None);
        }
    }
}
