use polder_mesh::{Digest, Pslg, Triangulation};
use rand_core::{RngCore, SeedableRng};
use rand_pcg::Pcg64;

/// A PSLG with its points and constraints in another order, and the way back.
#[derive(Clone, Debug)]
pub struct Shuffled {
    /// The shuffled input; constraints may also run the other way.
    pub pslg: Pslg,
    /// For each point of the shuffled input its index in the original.
    pub points: Vec<u32>,
    /// For each constraint of the shuffled input its index in the original.
    pub constraints: Vec<u32>,
    classes: Vec<u32>,
}

/// Shuffles the points and constraints of an input, and the ends of each constraint.
pub fn shuffled(pslg: &Pslg, seed: u64) -> Shuffled {
    let mut random = Pcg64::seed_from_u64(seed);
    let points = permutation(pslg.points().len(), &mut random);
    let constraints = permutation(pslg.constraints().len(), &mut random);
    let mut place = vec![0; points.len()];
    for (new, &old) in points.iter().enumerate() {
        place[old as usize] = new as u32;
    }
    let ends = |&old: &u32| {
        let [a, b] = pslg.constraints()[old as usize].map(|v| place[v as usize]);
        if random.next_u64() & 1 == 1 { [b, a] } else { [a, b] }
    };
    let moved = constraints.iter().map(ends).collect();
    let at = points.iter().map(|&old| pslg.points()[old as usize]).collect();
    let shuffled = Pslg::new(at, moved).expect("a shuffled PSLG is as valid as before");
    Shuffled { pslg: shuffled, points, constraints, classes: classes(pslg) }
}

impl Shuffled {
    /// The triangles of the shuffled input's triangulation, in the original numbering and canonical order; a
    /// duplicate counts as the lowest point equal to it.
    pub fn triangles_back(&self, triangulation: &Triangulation) -> Vec<[u32; 3]> {
        let name = |v: u32| self.classes[self.points[v as usize] as usize];
        sorted(triangulation.triangles().iter().map(|t| t.map(name)))
    }

    /// The digest of the shuffled input's triangulation, had it been computed from the original.
    pub fn digest_back(&self, triangulation: &Triangulation) -> Digest {
        digest(self.classes.len(), &self.triangles_back(triangulation))
    }
}

/// For each point the lowest one equal to it in value.
pub fn classes(pslg: &Pslg) -> Vec<u32> {
    let key = |i: &u32| {
        let p = pslg.points()[*i as usize] + 0.0;
        (p.x.to_bits(), p.y.to_bits(), *i)
    };
    let mut order: Vec<u32> = (0..pslg.points().len() as u32).collect();
    order.sort_unstable_by_key(key);
    let mut classes = vec![0; order.len()];
    for group in order.chunk_by(|i, j| pslg.points()[*i as usize] == pslg.points()[*j as usize]) {
        for &i in group {
            classes[i as usize] = group[0];
        }
    }
    classes
}

/// The triangles as the canonical order has them, duplicates replaced by the lowest point equal to them.
pub fn canonical_triangles(pslg: &Pslg, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let classes = classes(pslg);
    sorted(triangles.iter().map(|t| t.map(|v| classes[v as usize])))
}

/// The digest of bare triangles, put into canonical order.
pub fn canonical_digest(pslg: &Pslg, triangles: &[[u32; 3]]) -> Digest {
    digest(pslg.points().len(), &canonical_triangles(pslg, triangles))
}

fn digest(points: usize, triangles: &[[u32; 3]]) -> Digest {
    Triangulation::from_triangles(points, triangles).expect("the triangles make a mesh").digest()
}

fn sorted(triangles: impl Iterator<Item = [u32; 3]>) -> Vec<[u32; 3]> {
    let mut triangles: Vec<_> = triangles
        .map(|[a, b, c]| {
            if a < b && a < c {
                [a, b, c]
            } else if b < c {
                [b, c, a]
            } else {
                [c, a, b]
            }
        })
        .collect();
    triangles.sort_unstable();
    triangles
}

fn permutation(n: usize, random: &mut Pcg64) -> Vec<u32> {
    let mut order: Vec<u32> = (0..n as u32).collect();
    for i in (1..n).rev() {
        let j = (random.next_u64() as u128 * (i as u128 + 1)) >> 64;
        order.swap(i, j as usize);
    }
    order
}
