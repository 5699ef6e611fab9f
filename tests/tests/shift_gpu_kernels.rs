//! Each kernel of stage 3 against the reference of its name, bit for bit; lists in order of arrival as sets.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod shift_gpu_support;
mod vulkan_support;

use bytemuck::Zeroable;
use polder_dualize::kernels::*;
use polder_dualize::reference::kernels::{shift, takeout};
use polder_flip::gpu::Arithmetic;
use polder_mesh::GhostMesh;
use shift::{PINNED, ROW, WORDS, Word};
use shift_gpu_support::{Case, Device, cases, sorted};

const NONE: u32 = u32::MAX;

/// The counts of a batch: so many items in the first entry of a row.
fn words(row: usize, entry: usize, count: usize) -> Vec<u32> {
    let mut words = vec![0; WORDS];
    words[row + entry] = count as u32;
    words
}

/// All sites at their true positions, and what the first test pins.
fn moved(case: &Case) -> (Vec<u32>, Vec<u32>) {
    let (_, state) = shift::shift_move(&case.points, &case.order, case.centers.len());
    let pinned = shift::pin_triangles(&case.mesh, &case.truth, &state, 0..case.mesh.slots());
    (state, pinned)
}

/// The state of sites that are on a list of half-edges.
fn listed(mesh: &GhostMesh, state: &mut [u32], list: &[u32]) {
    (0..).zip(list).for_each(|(place, &h)| state[mesh.origin(h) as usize] = PINNED | place);
}

/// What is left of a case after pinning and unpinning, by the kernels' references.
struct Stuck {
    mesh: GhostMesh,
    positions: Vec<glam::DVec2>,
    state: Vec<u32>,
    sites: Vec<u32>,
}

fn stuck(case: &Case) -> Stuck {
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
fn elect(now: &Stuck) -> [takeout::Elected; 2] {
    let mut beside = vec![false; now.state.len()];
    let first = takeout::takeout_elect(&now.mesh, &now.state, &now.sites, &mut beside, false);
    let second = takeout::takeout_elect(&now.mesh, &now.state, &first.later, &mut beside, true);
    [first, second]
}

/// The rounds of taking out: before each, what it starts from and whom its turns elect.
fn each_round(case: &Case, mut look: impl FnMut(&Stuck, &[takeout::Elected; 2])) {
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

#[test]
fn shift_move() {
    let mut device = Device::open();
    for case in cases() {
        let held = device.hold(&case.mesh, &case.truth);
        let (points, order) = (device.gpu.buffer(&case.points), device.gpu.buffer(&case.order));
        let sites = device.gpu.buffer(&[case.centers.len() as u32]);
        let state = device.gpu.buffer(&vec![7_u32; case.truth.len()]);
        let positions = device.gpu.buffer(&vec![glam::DVec2::zeroed(); case.truth.len()]);
        let arguments = ShiftMoveArgs {
            points: points.view().cast(),
            order: order.view(),
            positions: positions.view().cast(),
            state: state.view(),
            sites: sites.view(),
            count: case.points.len() as u32,
            limit: held.sites as u32,
        };
        device.run::<ShiftMove>(&arguments);
        let expected = shift::shift_move(&case.points, &case.order, case.centers.len());
        assert_eq!(device.gpu.fetch(positions.view()), expected.0, "{}", case.name);
        assert_eq!(device.gpu.fetch(state.view())[..case.centers.len()], expected.1, "{}", case.name);
    }
}

#[test]
fn pin_triangles() {
    let mut device = Device::open();
    let mut pinned = 0;
    for case in cases() {
        let (state, expected) = moved(&case);
        for arithmetic in device.arithmetics() {
            let held = device.hold(&case.mesh, &case.truth);
            let (states, list) = (device.gpu.buffer(&state), device.gpu.buffer(&vec![7_u32; case.truth.len()]));
            let counts = device.gpu.buffer(&[0; WORDS]);
            let hull = device.gpu.buffer(&vec![7_u32; case.mesh.slots().max(1)]);
            let hull_count = device.gpu.buffer(&[0_u32]);
            let arguments = PinTrianglesArgs {
                triangles: held.mesh.corners(),
                positions: held.mesh.positions().cast(),
                state: states.view(),
                pinned: list.view(),
                words: counts.view(),
                slots: held.mesh.slots(),
                hull: hull.view(),
                hull_count: hull_count.view(),
                hull_limit: hull.len() as u32,
                limit: case.mesh.slots() as u32,
            };
            device.run_deciding::<PinTriangles>(arithmetic, &arguments);
            let count = device.gpu.fetch(counts.view())[Word::PinCounts as usize] as usize;
            let list = device.gpu.fetch(list.view())[..count].to_vec();
            let mut wanted = state.clone();
            listed(&case.mesh, &mut wanted, &list);
            assert_eq!(device.gpu.fetch(states.view()), wanted, "{}", case.name);
            let origins = |list: &[u32]| sorted(list.iter().map(|&h| case.mesh.origin(h)).collect());
            assert_eq!(origins(&list), origins(&expected), "{}", case.name);
            let count_of_hull = device.gpu.fetch(hull_count.view())[0] as usize;
            let found = sorted(device.gpu.fetch(hull.view())[..count_of_hull].to_vec());
            assert_eq!(found, shift::hull_edges(&case.mesh), "{}", case.name);
            pinned += count;
        }
    }
    assert!(pinned > 1000, "{pinned}");
}

#[test]
fn pin_stars() {
    let mut device = Device::open();
    let mut pinned = 0;
    for case in cases() {
        let (mut state, list) = moved(&case);
        listed(&case.mesh, &mut state, &list);
        let mut positions = case.truth.clone();
        let expected = shift::pin_stars(&case.mesh, &case.centers, &mut positions, &state, &list);
        let held = device.hold(&case.mesh, &case.truth);
        let states = device.gpu.buffer(&state);
        let mut entries = list.clone();
        entries.resize(case.truth.len(), 7);
        let pixels = device.gpu.buffer(&case.pixels);
        let (entries, counts) =
            (device.gpu.buffer(&entries), device.gpu.buffer(&words(Word::PinCounts as usize, 0, list.len())));
        let rings = device.gpu.buffer(&vec![7_u32; 8 * list.len().max(1)]);
        let ([translation_x, translation_y], [exponent_x, exponent_y]) =
            (case.mapping.translation(), case.mapping.exponents());
        let [half_side_x, half_side_y] = case.mapping.sides().map(|side| side / 2);
        let arguments = PinStarsArgs {
            triangles: held.mesh.corners(),
            links: held.mesh.twins(),
            positions: held.mesh.positions().cast(),
            state: states.view(),
            pinned: entries.view(),
            words: counts.view(),
            pixels: pixels.view().cast(),
            translation_x,
            translation_y,
            exponent_x,
            exponent_y,
            half_side_x,
            half_side_y,
            rings: rings.view(),
            ring_limit: list.len() as u32,
            round: 0,
        };
        device.run_deciding::<PinStars>(Arithmetic::Integers, &arguments);
        assert_eq!(device.gpu.fetch(rings.view())[..8 * list.len()], shift::rings(&case.mesh, &list), "{}", case.name);
        let bits = |points: &[glam::DVec2]| points.iter().map(|p| p.to_array().map(f64::to_bits)).collect::<Vec<_>>();
        assert_eq!(bits(&device.gpu.fetch(held.mesh.positions())), bits(&positions), "{}", case.name);
        let count = device.gpu.fetch(counts.view())[Word::PinCounts as usize + 1] as usize;
        let found = device.gpu.fetch(entries.view())[list.len()..][..count].to_vec();
        let origins = |list: &[u32]| sorted(list.iter().map(|&h| case.mesh.origin(h)).collect());
        assert_eq!(origins(&found), origins(&expected), "{}", case.name);
        listed(&case.mesh, &mut state, &[list, found].concat());
        assert_eq!(device.gpu.fetch(states.view()), state, "{}", case.name);
        pinned += count;
    }
    assert!(pinned > 0, "{pinned}");
}

#[test]
fn unpin_stars() {
    let mut device = Device::open();
    let mut rounds = 0;
    for case in cases() {
        for arithmetic in device.arithmetics() {
            let (mut state, list) = moved(&case);
            listed(&case.mesh, &mut state, &list);
            let mut positions = case.truth.clone();
            list.iter().map(|&h| case.mesh.origin(h) as usize).for_each(|v| positions[v] = case.centers[v]);
            let held = device.hold(&case.mesh, &positions);
            let states = device.gpu.buffer(&state);
            let (points, order) = (device.gpu.buffer(&case.points), device.gpu.buffer(&case.order));
            let room = vec![7_u32; case.truth.len()];
            let [all, even, odd] = [0; 3].map(|_| device.gpu.buffer(&room));
            device.gpu.engine.upload(all.view().slice(0..list.len()).unwrap(), &list).unwrap();
            let mut counts = words(Word::UnpinCounts as usize, 0, list.len());
            counts[Word::UnpinStarted as usize] = 1;
            let counts = device.gpu.buffer(&counts);
            // Of some there is no room for a ring.
            let kept = list.len() - list.len() / 3;
            let mut rings = shift::rings(&case.mesh, &list[..kept]);
            rings.push(7);
            let rings = device.gpu.buffer(&rings);
            let mut place = vec![NONE; case.centers.len()];
            (0..).zip(&list).for_each(|(i, &h)| place[case.mesh.origin(h) as usize] = i);
            let (mut waiting, mut round) = (list, 0);
            while !waiting.is_empty() && round < 5 {
                let [from, to] = if round % 2 == 0 { [&even, &odd] } else { [&odd, &even] };
                let arguments = UnpinStarsArgs {
                    triangles: held.mesh.corners(),
                    links: held.mesh.twins(),
                    positions: held.mesh.positions().cast(),
                    state: states.view(),
                    points: points.view().cast(),
                    order: order.view(),
                    all: all.view(),
                    waiting: from.view(),
                    later: to.view(),
                    rings: rings.view(),
                    words: counts.view(),
                    ring_limit: kept as u32,
                    round,
                };
                device.run_deciding::<UnpinStars>(arithmetic, &arguments);
                waiting = shift::unpin_stars(&case.mesh, &case.truth, &mut positions, &mut state, &waiting, round);
                round += 1;
                assert_eq!(device.gpu.fetch(held.mesh.positions()), positions, "{}", case.name);
                assert_eq!(device.gpu.fetch(states.view()), state, "{}", case.name);
                let count = device.gpu.fetch(counts.view())[Word::UnpinCounts as usize + round as usize] as usize;
                let later = device.gpu.fetch(to.view())[..count].to_vec();
                let expected = waiting.iter().map(|&h| place[case.mesh.origin(h) as usize]).collect();
                assert_eq!(sorted(later), sorted(expected), "{}", case.name);
                rounds += 1;
            }
        }
    }
    assert!(rounds > 100, "{rounds}");
}

#[test]
fn unpin_finish() {
    let mut device = Device::open();
    for case in cases() {
        let (mut state, list) = moved(&case);
        for (i, &h) in list.iter().enumerate() {
            state[case.mesh.origin(h) as usize] = PINNED | shift::TRIED | if i % 3 == 0 { shift::FREED } else { 0 } | 5;
        }
        let held = device.hold(&case.mesh, &case.truth);
        let (states, all) = (device.gpu.buffer(&state), device.gpu.buffer(&[&list[..], &[7]].concat()));
        let stuck = device.gpu.buffer(&vec![7_u32; case.truth.len()]);
        let counts = device.gpu.buffer(&words(Word::Bad as usize, 0, list.len()));
        let waits_for = device.gpu.buffer(&vec![7_u32; 2 * case.truth.len()]);
        let arguments = UnpinFinishArgs {
            triangles: held.mesh.corners(),
            state: states.view(),
            all: all.view(),
            stuck: stuck.view(),
            waits_for: waits_for.view(),
            words: counts.view(),
        };
        device.run::<UnpinFinish>(&arguments);
        let (sites, expected) = shift::unpin_finish(&case.mesh, &mut state, &list);
        assert_eq!(device.gpu.fetch(all.view())[..list.len()], sites, "{}", case.name);
        assert_eq!(device.gpu.fetch(states.view()), state, "{}", case.name);
        let count = device.gpu.fetch(counts.view())[Word::OutCounts as usize] as usize;
        assert_eq!(sorted(device.gpu.fetch(stuck.view())[..count].to_vec()), expected, "{}", case.name);
        let waits_for = device.gpu.fetch(waits_for.view());
        assert!(expected.iter().all(|&v| waits_for[2 * v as usize..][..2] == [NONE, 0]), "{}", case.name);
    }
}

#[test]
fn shift_advance() {
    let mut device = Device::open();
    for seed in 0..200 {
        let (phase, rounds) = (seed as u32 % 3, 2 + seed as u32 % 5 * 2);
        let mut words: Vec<u32> = vulkan_support::words(seed, WORDS).iter().map(|w| w % 9 * (w >> 8 & 1)).collect();
        let buffer = device.gpu.buffer(&words);
        let slots = device.gpu.buffer(&[99_u32]);
        let arguments = ShiftAdvanceArgs { words: buffer.view(), slots: slots.view(), phase, rounds };
        device.run::<ShiftAdvance>(&arguments);
        let mut expected = 99;
        shift::shift_advance(&mut words, &mut expected, phase, rounds);
        assert_eq!(device.gpu.fetch(buffer.view()), words, "{phase}");
        assert_eq!(device.gpu.fetch(slots.view()), [expected]);
    }
}

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

#[test]
fn rows_do_not_overlap() {
    let rows = [Word::PinCounts, Word::UnpinCounts, Word::OutCounts].map(|word| word as usize);
    assert_eq!((rows, WORDS), ([ROW, 3 * ROW, 5 * ROW], 10 * ROW));
}
