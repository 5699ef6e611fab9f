//! The kernels of stage 3 that take sites out. A pinned site's state here is [`PINNED`] and a half-edge that starts there.

use super::super::star::star;
use super::super::takeout::remove;
use super::shift::PINNED;
use crate::DualizeError;
use glam::DVec2;
use polder_flip::priority;
use polder_mesh::{DELETED, GHOST, GhostMesh, NONE};

/// What [`takeout_elect`] finds.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Elected {
    /// The sites that go, each as the half-edge to its heir.
    pub winners: Vec<u32>,
    /// The sites that wait.
    pub later: Vec<u32>,
    /// Whether a site that should go has no finite triangle.
    pub chain: bool,
}

/// Which of the pinned sites `waiting` go in this round. In the first turn those that have no pinned neighbor of lower
/// priority; then `beside` says who has one of them as a neighbor. The second turn decides on those who have none, among
/// each other.
pub fn takeout_elect(
    mesh: &GhostMesh,
    state: &[u32],
    waiting: &[u32],
    beside: &mut [bool],
    second_turn: bool,
) -> Elected {
    let mut out = Elected::default();
    if !second_turn {
        beside.fill(false);
    }
    let is_pinned = |u: u32| state[u as usize] & PINNED != 0;
    for &v in waiting {
        let spokes: Vec<u32> = star(mesh, state[v as usize] & !PINNED).collect();
        let neighbors = || spokes.iter().copied().filter(|&h| mesh.destination(h) < DELETED);
        let is_open = |u: u32| is_pinned(u) && !(second_turn && beside[u as usize]);
        if !is_open(v) || neighbors().map(|h| mesh.destination(h)).any(|u| is_open(u) && priority(u) < priority(v)) {
            out.later.push(v);
        } else if spokes.iter().all(|&h| mesh.is_ghost((h / 3) as usize)) {
            out.chain = true;
        } else {
            let rank = |u: u32| (is_pinned(u), u);
            out.winners.extend(neighbors().min_by_key(|&h| rank(mesh.destination(h))));
        }
    }
    if !second_turn {
        for &h in &out.winners {
            star(mesh, h).map(|h| mesh.destination(h)).filter(|&u| u < DELETED).for_each(|u| beside[u as usize] = true);
        }
    }
    out
}

/// Takes the origins of `winners` out, which name their heirs, and links what is left; the slots that each frees. On the
/// device the links of outer edges are left to [`takeout_link`].
///
/// # Errors
///
/// [`DualizeError::Broken`] for a mesh that is no triangulation.
pub fn takeout_cut(
    mesh: &mut GhostMesh,
    positions: &[DVec2],
    state: &mut [u32],
    winners: &[u32],
) -> Result<Vec<(u32, [u32; 2])>, DualizeError> {
    let ends: Vec<[u32; 2]> = winners.iter().map(|&h| [mesh.origin(h), mesh.destination(h)]).collect();
    let mut freed = Vec::new();
    for ([v, heir], &h) in ends.into_iter().zip(winners) {
        // A star cut before may have taken the half-edge of a neighbor's neighbor along, but not one in this star.
        freed.push((v, remove(mesh, positions, h)?));
        state[v as usize] = heir;
    }
    Ok(freed)
}

/// Links outer edges of stars, given as the triangle of old and the half-edge of today, to what is across; and gives pinned
/// sites around them a half-edge that is theirs.
pub fn takeout_link(mesh: &mut GhostMesh, state: &mut [u32], edges: &[[u32; 2]]) {
    let mut today = vec![NONE; mesh.slots()];
    edges.iter().for_each(|&[t, h]| today[t as usize] = h);
    let across: Vec<u32> = edges.iter().map(|&[_, h]| mesh.twin(h)).collect();
    for (&[_, h], across) in edges.iter().zip(across) {
        match today[(across / 3) as usize] {
            NONE => mesh.link(across, h),
            moved => mesh.links[(h / 3) as usize][h as usize % 3] = moved,
        }
        let v = mesh.origin(h);
        if v != GHOST && state[v as usize] & PINNED != 0 {
            state[v as usize] = PINNED | h;
        }
    }
}

/// The final state of the sites `all` that were pinned: for those taken out an heir that is still there; and these sites.
pub fn takeout_heirs(state: &mut [u32], all: &[u32], is_empty: bool) -> Vec<u32> {
    if is_empty {
        state.fill(NONE);
        return (0..state.len() as u32).collect();
    }
    let mut taken: Vec<u32> = all.iter().copied().filter(|&v| state[v as usize] != v).collect();
    for &v in &taken {
        while state[state[v as usize] as usize] != state[v as usize] {
            state[v as usize] = state[state[v as usize] as usize];
        }
    }
    taken.sort_unstable();
    taken
}
