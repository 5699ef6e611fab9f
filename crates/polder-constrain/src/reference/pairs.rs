//! Which pairs of triangles with the same owner may be flipped, and whose the triangles are afterwards.

use super::configuration::{Configuration, Side, configuration};
use super::keys::claim_key;
use super::place;
use glam::DVec2;
use polder_mesh::{GhostMesh, NONE};

/// A pair (A, C) that may be flipped.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    /// The half-edge of A towards C.
    pub(super) h: u32,
    /// B, where it is claimed too.
    pub(super) b: u32,
    pub(super) case: u8,
}

impl Candidate {
    pub(super) fn key(&self) -> u32 {
        claim_key(self.case, self.h / 3)
    }
}

/// A mesh whose triangles have owners.
#[derive(Clone, Copy)]
pub(super) struct Owned<'a> {
    pub(super) mesh: &'a GhostMesh,
    pub(super) positions: &'a [DVec2],
    pub(super) owner: &'a [u32],
}

impl Owned<'_> {
    /// The corner opposite the edge where the owner of its triangle comes in or goes out.
    pub(super) fn corner(&self, h: u32) -> (u32, Side) {
        (self.mesh.apex(h), place::side(self.owner[(h / 3) as usize]))
    }

    /// The half-edge from A to C and the configuration of the two, if C has the same owner.
    pub(super) fn next_pair(&self, a: usize) -> Option<(u32, Configuration)> {
        let h = 3 * a as u32 + place::outward(self.owner[a])?;
        let g = self.mesh.twin(h);
        if !place::same_owner(self.owner[a], self.owner[(g / 3) as usize]) {
            return None;
        }
        let ends = [self.mesh.origin(h), self.mesh.destination(h)];
        Some((h, configuration(self.positions, [self.corner(h), self.corner(g)], ends)))
    }

    /// Whether (A, C) may be flipped, by its configuration and that of (B, A).
    pub(super) fn candidate(
        &self,
        a: usize,
        own: Configuration,
        before: impl FnOnce(u32) -> Option<Configuration>,
        blind: bool,
    ) -> Option<Candidate> {
        let h = 3 * a as u32 + place::outward(self.owner[a])?;
        match own {
            Configuration::Zero | Configuration::Single => return Some(Candidate { h, b: NONE, case: 1 }),
            Configuration::Concave => return None,
            Configuration::Double if blind => return Some(Candidate { h, b: NONE, case: 1 }),
            Configuration::Double => {}
        }
        let entry = self.mesh.twin(3 * a as u32 + place::inward(self.owner[a])?);
        let b = entry / 3;
        if !place::same_owner(self.owner[a], self.owner[b as usize]) {
            return None;
        }
        let before = before(b)?;
        // After the flip B is followed by the triangle of its edge and the far corner of C, which lies on the other side
        // than A's near corner: it takes the place of A's third corner.
        let far = self.corner(self.mesh.twin(h));
        let ends = [self.mesh.origin(entry), self.mesh.destination(entry)];
        let then = configuration(self.positions, [self.corner(entry), far], ends);
        let case = match (before, then) {
            (Configuration::Double, Configuration::Zero | Configuration::Single) => 2,
            (Configuration::Concave, then) if then != Configuration::Concave => 3,
            _ => return None,
        };
        Some(Candidate { h, b, case })
    }
}

/// The words of the two triangles after a flip, by the edges along which they were flipped and the sides of the corners near
/// and far: the corners from there on are near, right, far in the first, and far, left, near in the second.
pub(super) fn words_of_flip(owner: u32, edges: [usize; 2], [near, far]: [Side; 2]) -> [u32; 2] {
    let word = |k: usize, from_k: [Side; 3]| {
        let mut sides = [0; 3];
        (sides[k], sides[(k + 1) % 3], sides[(k + 2) % 3]) = (from_k[0], from_k[1], from_k[2]);
        place::word(owner, sides)
    };
    [word(edges[0], [near, -1, far]), word(edges[1], [far, 1, near])]
}
