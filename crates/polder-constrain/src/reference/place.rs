//! How the owner of a triangle runs through it.
//!
//! In one word: the owner's priority, then the edge by which it goes out, then that by which it comes in, two bits each;
//! 3 stands for none, in the triangles at its ends. The directions are those from the lower end to the higher one. The
//! sides of the corners follow from the edges. All words of an owner are less than those of owners with a higher priority,
//! and of two sub-constraints that cross a triangle the lower word names the owner.

use super::configuration::Side;
use super::keys::{owner_of, owner_priority};

/// The word of a triangle that nobody owns.
pub(super) const FREE: u32 = u32::MAX;
/// No edge.
const NO_EDGE: u32 = 3;

/// The word of a triangle by its owner and the sides of its corners; [`FREE`] if the owner does not run through it.
pub(super) fn word(owner: u32, sides: [Side; 3]) -> u32 {
    let gate = |from: Side, to: Side| (0..3).find(|k| sides[(k + 1) % 3] == from && sides[(k + 2) % 3] == to);
    match (gate(1, -1), gate(-1, 1)) {
        (None, None) => FREE,
        (inward, outward) => {
            let bits = |edge: Option<usize>| edge.map_or(NO_EDGE, |k| k as u32);
            owner_priority(owner) << 4 | bits(outward) << 2 | bits(inward)
        }
    }
}

/// The owner, if there is one.
pub(super) fn owner(word: u32) -> Option<u32> {
    (word != FREE).then(|| owner_of(word >> 4))
}

/// Whether two triangles have the same owner, if the first has one.
pub(super) fn same_owner(a: u32, b: u32) -> bool {
    a != FREE && b != FREE && a >> 4 == b >> 4
}

/// The edge by which the owner comes in.
pub(super) fn inward(word: u32) -> Option<u32> {
    (word & 3 != NO_EDGE).then_some(word & 3)
}

/// The edge by which the owner goes out.
pub(super) fn outward(word: u32) -> Option<u32> {
    let edge = word >> 2 & 3;
    (edge != NO_EDGE).then_some(edge)
}

/// The side of the corners opposite the edges where the owner comes in and goes out: of an end, 0; else both lie on the
/// same side, and the third corner on the other one.
pub(super) fn side(word: u32) -> Side {
    match (inward(word), outward(word)) {
        (Some(i), Some(o)) => 2 * Side::from(o == (i + 1) % 3) - 1,
        _ => 0,
    }
}
