//! The checker of a whole triangulation rejects false neighbors, constrained bits, representatives and chains.
#![allow(clippy::unwrap_used, reason = "tests")]

mod verify_support;

use polder::verify::{Kind, Place, Verdict, check_triangulation};
use polder::{Options, triangulate};
use polder_mesh::{Chains, NONE, Parts, Pslg, Slot, Triangulation};
use verify_support::pslg;

/// A constraint through a vertex, one of zero length, and two equal points.
fn sample() -> (Pslg, Triangulation) {
    let points = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0), (2.0, 1.0), (4.0, 2.0), (2.0, 1.0)];
    let pslg = pslg(&points, &[[0, 5], [6, 4], [3, 6]]);
    let triangulation = triangulate(&pslg, &Options::default()).unwrap().triangulation;
    assert!(check_triangulation(&pslg, &triangulation).is_canonical());
    assert_eq!(triangulation.chains().get(0), [0, 4, 5]);
    (pslg, triangulation)
}

/// The sample with its slots, representatives and chains changed.
fn changed(slot: impl Fn(usize, &mut Slot) + Sync, parts: impl Fn(&mut Vec<u32>, &mut Vec<Vec<u32>>)) -> Verdict {
    let (pslg, mesh) = sample();
    let get = |t: usize| {
        let mut one = Slot {
            corners: mesh.triangles()[t],
            neighbors: mesh.neighbors()[t],
            constrained: mesh.constrained_bits()[t],
        };
        slot(t, &mut one);
        Some(one)
    };
    let mut representatives = mesh.representatives().to_vec();
    let mut vertices: Vec<_> = mesh.chains().iter().map(<[u32]>::to_vec).collect();
    parts(&mut representatives, &mut vertices);
    let mut chains = Chains::default();
    vertices.into_iter().for_each(|chain| chains.push(chain));
    let other = Triangulation::from_slots(mesh.triangles().len(), get, Parts { representatives, chains });
    check_triangulation(&pslg, &other)
}

fn only(verdict: &Verdict, kind: Kind, place: Place) {
    assert!(!verdict.is_valid());
    assert_eq!(verdict.totals(), [(kind, 1)], "{verdict}");
    assert_eq!(verdict.problems()[0].place, place);
}

fn edge(t: usize, k: usize) -> Place {
    let corners = sample().1.triangles()[t];
    Place::Edge { ends: [corners[(k + 1) % 3], corners[(k + 2) % 3]], triangle: t as u32 }
}

#[test]
fn nothing_changed_is_accepted() {
    assert!(changed(|_, _| (), |_, _| ()).is_canonical());
}

#[test]
fn false_neighbors() {
    let triangles = sample().1.triangles().len();
    for t in 0..triangles {
        for k in 0..3 {
            let right = sample().1.neighbors()[t][k];
            for wrong in [NONE, 0, 1, triangles as u32 - 1].into_iter().filter(|&wrong| wrong != right) {
                let change = |u: usize, slot: &mut Slot| {
                    if u == t {
                        slot.neighbors[k] = wrong;
                    }
                };
                only(&changed(change, |_, _| ()), Kind::WrongNeighbor, edge(t, k));
            }
        }
    }
}

#[test]
fn false_constrained_bits() {
    for t in 0..sample().1.triangles().len() {
        for k in 0..3 {
            let change = |u: usize, slot: &mut Slot| slot.constrained ^= u8::from(u == t) << k;
            only(&changed(change, |_, _| ()), Kind::WrongConstrainedBit, edge(t, k));
        }
    }
}

#[test]
fn false_representatives() {
    only(&changed(|_, _| (), |all, _| all[6] = 6), Kind::WrongRepresentative, Place::Point(6));
    only(&changed(|_, _| (), |all, _| all[2] = 1), Kind::WrongRepresentative, Place::Point(2));
    only(&changed(|_, _| (), |all, _| all.push(0)), Kind::WrongRepresentative, Place::Point(7));
}

#[test]
fn false_chains() {
    let (_, mesh) = sample();
    let middle = mesh.chains().get(2).to_vec();
    let first: [&[u32]; 8] = [&[], &[0], &[0, 5], &[5, 4, 0], &[0, 4, 4, 5], &[0, 6, 5], &[0, 4, 2, 5], &[0, 4, 99, 5]];
    for chain in first {
        let verdict = changed(|_, _| (), |_, chains| chains[0] = chain.to_vec());
        only(&verdict, Kind::WrongChain, Place::Constraint { constraint: 0, vertex: 0 });
    }
    for chain in [vec![], vec![6], vec![4, 4]] {
        let verdict = changed(|_, _| (), |_, chains| chains[1] = chain.clone());
        only(&verdict, Kind::WrongChain, Place::Constraint { constraint: 1, vertex: 4 });
    }
    let verdict = changed(|_, _| (), |_, chains| chains[2] = middle.iter().rev().copied().collect());
    only(&verdict, Kind::WrongChain, Place::Constraint { constraint: 2, vertex: 3 });
    only(&changed(|_, _| (), |_, chains| drop(chains.pop())), Kind::WrongChain, Place::Mesh);
}

#[test]
fn chains_along_a_line_miss_no_point() {
    let pslg = pslg(&[(0.0, 0.0), (3.0, 3.0), (1.0, 1.0), (2.0, 2.0), (1.0, 1.0)], &[[1, 0], [4, 2]]);
    let with = |first: &[u32]| {
        let mut chains = Chains::default();
        chains.push(first.iter().copied());
        chains.push([2]);
        let parts = Parts { representatives: vec![0, 1, 2, 3, 2], chains };
        check_triangulation(&pslg, &Triangulation::from_slots(0, |_| None, parts))
    };
    assert!(with(&[1, 3, 2, 0]).is_canonical());
    for wrong in [&[1, 0][..], &[1, 3, 0], &[0, 2, 3, 1], &[1, 3, 4, 0], &[1, 3, 2, 3, 2, 0]] {
        only(&with(wrong), Kind::WrongChain, Place::Constraint { constraint: 0, vertex: 1 });
    }
}
