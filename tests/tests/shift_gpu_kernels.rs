//! Each kernel of stage 3 against the reference of its name, bit for bit; lists in order of arrival as sets.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod shift_gpu_support;
mod vulkan_support;

use bytemuck::Zeroable;
use polder_dualize::kernels::*;
use polder_dualize::reference::kernels::shift;
use polder_flip::gpu::Arithmetic;
use shift::{PINNED, ROW, WORDS, Word};
use shift_gpu_support::takeout::{listed, moved, words};
use shift_gpu_support::{Device, cases, sorted};

const NONE: u32 = u32::MAX;

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
fn rows_do_not_overlap() {
    let rows = [Word::PinCounts, Word::UnpinCounts, Word::OutCounts].map(|word| word as usize);
    assert_eq!((rows, WORDS), ([ROW, 3 * ROW, 5 * ROW], 10 * ROW));
}
