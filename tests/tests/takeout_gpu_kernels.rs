//! Each kernel of the last step of stage 3 against the reference of its name, bit for bit; lists in order of arrival as sets.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod shift_gpu_support;
mod vulkan_support;

use polder_dualize::kernels::*;
use polder_dualize::reference::kernels::{shift, takeout};
use polder_flip::gpu::Arithmetic;
use shift::{PINNED, Word};
use shift_gpu_support::takeout::{Stuck, each_round, elect, words};
use shift_gpu_support::{Device, cases, sorted};

const NONE: u32 = u32::MAX;

#[test]
fn takeout_elect() {
    let mut device = Device::open();
    let (mut winners_in_all, mut chains) = ([0; 2], 0);
    for case in cases() {
        // Kept from round to round.
        let waits_for = device.gpu.buffer(&[NONE, 0].repeat(case.centers.len()));
        let mut rounds = 0;
        each_round(&case, |now, expected| {
            let held = device.hold(&now.mesh, &now.positions);
            let room = vec![7_u32; now.state.len()];
            let [winners, second] = [0; 2].map(|_| device.gpu.buffer(&room));
            let (states, waiting) = (device.gpu.buffer(&now.state), device.gpu.buffer(&now.sites));
            let mut counts = words(Word::OutCounts as usize, 2, now.sites.len());
            counts[Word::OutRounds as usize] = rounds;
            rounds += 1;
            let counts = device.gpu.buffer(&counts);
            let mut before = 0;
            for (turn, [from, to], next) in [(0, [&waiting, &second], 288 + 2), (1, [&second, &waiting], 160 + 3)] {
                let arguments = TakeoutElectArgs {
                    triangles: held.mesh.corners(),
                    links: held.mesh.twins(),
                    state: states.view(),
                    waiting: from.view(),
                    later: to.view(),
                    winners: winners.view(),
                    waits_for: waits_for.view(),
                    words: counts.view(),
                    round: 2,
                    turn,
                };
                device.run::<TakeoutElect>(&arguments);
                let counts = device.gpu.fetch(counts.view());
                let end = counts[192 + 2] as usize;
                let found = takeout::Elected {
                    winners: sorted(device.gpu.fetch(winners.view())[before..end].to_vec()),
                    later: sorted(device.gpu.fetch(to.view())[..counts[next] as usize].to_vec()),
                    chain: turn == 0 && counts[Word::Chain as usize] == 3,
                };
                before = end;
                let expected = &expected[turn as usize];
                let [winners, later] = [&expected.winners, &expected.later].map(|list| sorted(list.clone()));
                winners_in_all[turn as usize] += winners.len();
                assert_eq!(found, takeout::Elected { winners, later, chain: expected.chain }, "{}", case.name);
                if expected.chain {
                    // There is no second turn.
                    chains += 1;
                    break;
                }
            }
        });
    }
    assert!(winners_in_all[0] > 500 && winners_in_all[1] > 50 && chains > 0, "{winners_in_all:?} {chains}");
}

/// A hub in the middle of so many vertices on a circle, to be taken out.
fn hub(spokes: u32) -> (Stuck, [takeout::Elected; 2]) {
    let on_circle = |i| glam::DVec2::from_angle(std::f64::consts::TAU * f64::from(i) / f64::from(spokes));
    let positions: Vec<_> = std::iter::once(glam::DVec2::ZERO).chain((0..spokes).map(on_circle)).collect();
    let (mut mesh, _) = polder_flip::reference::sweep(&positions).unwrap();
    polder_flip::reference::flip(&mut mesh, &positions).unwrap();
    let mut state: Vec<u32> = (0..=spokes).collect();
    state[0] = PINNED | mesh.half_edge_of_vertex(1)[0];
    let now = Stuck { mesh, positions, state, sites: vec![0] };
    let elected = elect(&now);
    (now, elected)
}

/// Cutting and linking, which give a mesh together.
fn cut_and_link(only_cut: bool) {
    let mut device = Device::open();
    for spokes in [3, 15, 16, 17, 40, 383, 384, 385, 1000] {
        let (now, elected) = hub(spokes);
        assert_eq!(elected[0].winners.len(), 1);
        cut_and_link_round(&mut device, "hub", only_cut, &now, &elected);
    }
    for case in cases() {
        each_round(&case, |now, elected| cut_and_link_round(&mut device, &case.name, only_cut, now, elected));
    }
}

fn cut_and_link_round(device: &mut Device, name: &str, only_cut: bool, now: &Stuck, elected: &[takeout::Elected; 2]) {
    let elected = [&elected[0].winners[..], &elected[1].winners].concat();
    // By the filter first, or by workgroups alone; and without f64.
    for (arithmetic, few) in [(Arithmetic::Filtered, 0), (Arithmetic::Filtered, 1024), (Arithmetic::Integers, 0)] {
        let held = device.hold(&now.mesh, &now.positions);
        let (sites, slots) = (now.state.len(), now.mesh.slots());
        let states = device.gpu.buffer(&now.state);
        let mut winners = elected.clone();
        winners.push(7);
        let (winners, deferred) = (device.gpu.buffer(&winners), device.gpu.buffer(&vec![7_u32; sites]));
        let freed = device.gpu.buffer(&vec![[NONE; 2]; sites]);
        let (edge_of, edges) = (device.gpu.buffer(&vec![7_u32; slots]), device.gpu.buffer(&vec![[7_u32; 2]; slots]));
        let counts = device.gpu.buffer(&words(192, 1, elected.len()));
        let cut = TakeoutCutArgs {
            triangles: held.mesh.corners(),
            links: held.mesh.twins(),
            positions: held.mesh.positions().cast(),
            state: states.view(),
            winners: winners.view(),
            deferred: deferred.view(),
            freed: freed.view().cast(),
            edge_of: edge_of.view(),
            edges: edges.view(),
            words: counts.view(),
            round: 1,
            again: 0,
        };
        device.run_both::<TakeoutCut>(arithmetic, few, &cut, &TakeoutCutArgs { again: 1, ..cut });
        let (mut mesh, mut state) = (now.mesh.clone(), now.state.clone());
        let expected = takeout::takeout_cut(&mut mesh, &now.positions, &mut state, &elected).unwrap();
        let found = device.gpu.fetch(freed.view());
        assert!(expected.iter().all(|&(v, slots)| found[v as usize] == slots), "{}", name);
        assert_eq!(device.gpu.fetch(states.view()), state, "{}", name);

        let before = held.mesh.download(&mut device.gpu.engine).unwrap();
        assert!(before.triangles == mesh.triangles, "{}: triangles", name);
        let link = TakeoutLinkArgs {
            triangles: held.mesh.corners(),
            links: held.mesh.twins(),
            state: states.view(),
            edge_of: edge_of.view(),
            edges: edges.view(),
            words: counts.view(),
            round: 1,
        };
        device.run::<TakeoutLink>(&link);
        let after = held.mesh.download(&mut device.gpu.engine).unwrap();
        if only_cut {
            assert!(after == mesh, "{}: links", name);
            continue;
        }
        let count = device.gpu.fetch(counts.view())[256 + 1] as usize;
        let edges = device.gpu.fetch(edges.view())[..count].to_vec();
        let mut linked = before;
        takeout::takeout_link(&mut linked, &mut state, &edges);
        assert!(after == linked, "{}", name);
        // Which of its half-edges a site is told of is left to chance.
        let told = device.gpu.fetch(states.view());
        assert!(told.iter().zip(&state).all(|(a, b)| a & PINNED == b & PINNED), "{}", name);
        let is_out_of = |v: u32, word: u32| word & PINNED == 0 || after.origin(word ^ PINNED) == v;
        assert!((0..).zip(&told).all(|(v, &word)| is_out_of(v, word)), "{}", name);
    }
}

#[test]
fn takeout_cut() {
    cut_and_link(true);
}

#[test]
fn takeout_link() {
    cut_and_link(false);
}

#[test]
fn takeout_heirs() {
    let mut device = Device::open();
    for case in cases() {
        for is_empty in [false, true] {
            let sites = case.centers.len() as u32;
            // Each third site names a later one, which may be gone too.
            let mut state: Vec<u32> = (0..sites)
                .map(|v| if v % 3 == 0 && v + 3 < sites { v + 3 - u32::from(v % 7 == 0) } else { v })
                .collect();
            let before = state.clone();
            let all: Vec<u32> = (0..sites).filter(|v| v % 3 == 0).collect();
            let held = device.hold(&case.mesh, &vec![glam::DVec2::ONE; case.truth.len()]);
            if is_empty {
                device.gpu.engine.upload(held.mesh.slots().slice(0..1).unwrap(), &[0]).unwrap();
            } else if case.mesh.slots() == 0 {
                continue;
            }
            let (states, entries) = (device.gpu.buffer(&state), device.gpu.buffer(&[&all[..], &[7]].concat()));
            let taken = device.gpu.buffer(&vec![7_u32; sites as usize]);
            let (points, order) = (device.gpu.buffer(&case.points), device.gpu.buffer(&case.order));
            let mut counts = words(Word::Bad as usize, 0, all.len());
            counts[Word::OutRounds as usize] = sites;
            let (counts, count) = (device.gpu.buffer(&counts), device.gpu.buffer(&[sites]));
            let arguments = TakeoutHeirsArgs {
                state: states.view(),
                all: entries.view(),
                taken: taken.view(),
                positions: held.mesh.positions().cast(),
                points: points.view().cast(),
                order: order.view(),
                words: counts.view(),
                sites: count.view(),
                slots: held.mesh.slots(),
                limit: sites,
            };
            device.run::<TakeoutHeirs>(&arguments);
            let expected = takeout::takeout_heirs(&mut state, &all, is_empty);
            assert_eq!(device.gpu.fetch(states.view()), state, "{}", case.name);
            let found = device.gpu.fetch(counts.view())[16] as usize;
            assert_eq!(sorted(device.gpu.fetch(taken.view())[..found].to_vec()), expected, "{}", case.name);
            let positions = device.gpu.fetch(held.mesh.positions());
            // The others are there already.
            let mut gone = all.iter().filter(|&&v| before[v as usize] != v);
            assert!(gone.all(|&v| positions[v as usize] == case.truth[v as usize]), "{}", case.name);
        }
    }
}
