//! What is left to take out, and the rounds of that.

use super::Case;
use polder_dualize::reference::kernels::{shift, takeout};
use polder_mesh::GhostMesh;
use shift::{PINNED, WORDS};

/// The counts of a batch: so many items in the first entry of a row.
pub(crate) fn words(row: usize, entry: usize, count: usize) -> Vec<u32> {
    let mut words = vec![0; WORDS];
    words[row + entry] = count as u32;
    words
}

/// All sites at their true positions, and what the first test pins.
pub(crate) fn moved(case: &Case) -> (Vec<u32>, Vec<u32>) {
    let (_, state) = shift::shift_move(&case.points, &case.order, case.centers.len());
    let pinned = shift::pin_triangles(&case.mesh, &case.truth, &state, 0..case.mesh.slots());
    (state, pinned)
}

/// The state of sites that are on a list of half-edges.
pub(crate) fn listed(mesh: &GhostMesh, state: &mut [u32], list: &[u32]) {
    (0..).zip(list).for_each(|(place, &h)| state[mesh.origin(h) as usize] = PINNED | place);
}

/// What is left of a case after pinning and unpinning, by the kernels' references.
pub(crate) struct Stuck {
    pub(crate) mesh: GhostMesh,
    pub(crate) positions: Vec<glam::DVec2>,
    pub(crate) state: Vec<u32>,
    pub(crate) sites: Vec<u32>,
}

pub(crate) fn stuck(case: &Case) -> Stuck {
    let (mut state, mut list) = moved(case);
    let mut positions = case.truth.clone();
    let mut begin = 0;
    listed(&case.mesh, &mut state, &list);
    while begin < list.len() {
        let fresh = list[begin..].to_vec();
        begin = list.len();
        list.extend(shift::pin_stars(&case.mesh, &case.centers, &mut positions, &state, &fresh));
        listed(&case.mesh, &mut state, &list);
    }
    let (mut waiting, mut round) = (list.clone(), 0);
    while !waiting.is_empty() {
        waiting = shift::unpin_stars(&case.mesh, &case.truth, &mut positions, &mut state, &waiting, round);
        round += 1;
    }
    let (_, sites) = shift::unpin_finish(&case.mesh, &mut state, &list);
    let mut mesh = case.mesh.clone();
    polder_flip::reference::close_hull(&mut mesh, &positions).unwrap();
    Stuck { mesh, positions, state, sites }
}

/// Both turns of a round; the first's winners come first.
pub(crate) fn elect(now: &Stuck) -> [takeout::Elected; 2] {
    let mut beside = vec![false; now.state.len()];
    let first = takeout::takeout_elect(&now.mesh, &now.state, &now.sites, &mut beside, false);
    let second = takeout::takeout_elect(&now.mesh, &now.state, &first.later, &mut beside, true);
    [first, second]
}

/// The rounds of taking out: before each, what it starts from and whom its turns elect.
pub(crate) fn each_round(case: &Case, mut look: impl FnMut(&Stuck, &[takeout::Elected; 2])) {
    let mut now = stuck(case);
    while !now.sites.is_empty() {
        let elected = elect(&now);
        look(&now, &elected);
        if elected[0].chain {
            return;
        }
        let winners = [&elected[0].winners[..], &elected[1].winners].concat();
        takeout::takeout_cut(&mut now.mesh, &now.positions, &mut now.state, &winners).unwrap();
        let [_, second] = elected;
        now.sites = second.later;
        let half_edges = now.mesh.half_edge_of_vertex(now.state.len());
        now.sites.iter().for_each(|&v| now.state[v as usize] = PINNED | half_edges[v as usize]);
    }
}
