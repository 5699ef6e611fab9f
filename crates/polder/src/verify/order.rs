//! Step 7: names and order of the triangles as given.

use super::verdict::{Found, Kind, Place};

pub(super) fn check(representatives: &[u32], triangles: &[[u32; 3]], found: &mut Found) {
    let higher = |&corner: &u32| representatives.get(corner as usize).is_some_and(|&v| v != corner);
    found.sweep(triangles.len(), |range, found| {
        for t in range {
            let place = Place::Triangle(t as u32);
            let [a, b, c] = triangles[t];
            if triangles[t].iter().any(higher) {
                found.add(Kind::HigherName, place);
            }
            if b < a || c < a {
                found.add(Kind::NotSmallestFirst, place);
            }
            if t > 0 && triangles[t] < triangles[t - 1] {
                found.add(Kind::NotSorted, place);
            }
        }
    });
}
