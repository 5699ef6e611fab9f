//! Each kernel of stage 6 that rebuilds chains or flips pairs against the reference of its name.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod constrain_gpu_support;
mod constrain_support;
mod vulkan_support;

use constrain_gpu_support::*;
use polder_constrain::kernels::*;
use polder_constrain::reference::kernels;
use vulkan_support::Gpu;

#[test]
fn rebuild_chains() {
    let mut gpu = Gpu::open();
    let (mut all, mut flips) = (0, [0; 2]);
    for case in cases() {
        for longest in [case.longest, 62] {
            let mut case = Case { longest, ..case.clone() };
            let waiting = case.takes.clone();
            let (walkers, marked) = case.walk();
            let on = On::new(&mut gpu, &case, &[(ADMITTED, walkers.len() as u32)]);
            gpu.engine.upload(on.walkers.slice(0..walkers.len()).unwrap(), &walkers).unwrap();
            let barred: Vec<u32> = waiting.iter().copied().filter(|s| !walkers.contains(s)).collect();
            gpu.engine.upload(on.lost.view(), &case.known(&marked.losers, &barred)).unwrap();
            let arguments = RebuildChainsArgs {
                triangles: on.mesh.corners(),
                links: on.mesh.twins(),
                positions: on.mesh.positions().cast(),
                walkers: on.walkers.view(),
                runs: on.runs.view(),
                pieces: on.pieces.view(),
                piece_count: on.piece_count.view(),
                piece_walked: on.piece_walked.view(),
                lost: on.lost.view(),
                state: on.state.view().cast(),
                spokes: on.spokes.view(),
                degrees: on.degrees.view(),
                words: on.words.view(),
                piece_limit: 1,
            };
            run::<RebuildChains>(&mut gpu, EXACT, 2, &arguments);
            let rebuilt = case.rebuild(&walkers, &marked.losers);
            let by_flips = walkers.iter().any(|&s| case.begun[s as usize].by_flips());
            assert_eq!([INSERTED, REBUILT].map(|word| on.word(&mut gpu, word)), [rebuilt; 2], "{}", case.name);
            assert_eq!(on.word(&mut gpu, MARKED), u32::from(by_flips));
            assert_eq!(on.word(&mut gpu, DEPART_FAULT + 1), NONE);
            on.assert_spokes(&mut gpu, &case);
            on.assert_state(&mut gpu, &case, case.scratch.round as usize & 1);
            all += rebuilt;
            flips[usize::from(by_flips)] += 1;
        }
    }
    assert!(all > 200 && flips.iter().all(|&n| n > 3), "{all} {flips:?}");
}

#[test]
fn configure_pairs() {
    let mut gpu = Gpu::open();
    let mut pairs = 0;
    for mut case in cases() {
        let (walkers, marked) = case.walk();
        case.rebuild(&walkers, &marked.losers);
        let marked = marked.triangles;
        let on = On::new(&mut gpu, &case, &[(MARKED, 1), (OUTER, case.scratch.round)]);
        let arguments = ConfigurePairsArgs {
            triangles: on.mesh.corners(),
            links: on.mesh.twins(),
            positions: on.mesh.positions().cast(),
            state: on.state.view().cast(),
            lost: on.lost.view(),
            even_pairs: on.pairs[0].view().cast(),
            odd_pairs: on.pairs[1].view().cast(),
            words: on.words.view(),
            slots: case.start.mesh.slots() as u32,
        };
        run::<ConfigurePairs>(&mut gpu, EXACT, 2, &arguments);
        case.configure(&marked);
        let parity = case.scratch.round as usize & 1;
        assert!(on.pairs(&mut gpu, parity) == sorted(&case.pairs), "{}", case.name);
        on.assert_state(&mut gpu, &case, parity);
        pairs += case.pairs.len();
        let mut distinct = sorted(&case.pairs);
        distinct.dedup_by_key(|pair| pair[0]);
        assert!(distinct.len() == case.pairs.len() || case.scratch.held > 0, "{}: a pair twice", case.name);
    }
    assert!(pairs > 200, "{pairs}");
}

/// The cases with pairs to be flipped.
fn with_pairs() -> impl Iterator<Item = Case> {
    cases().into_iter().map(|mut case| {
        let (walkers, marked) = case.walk();
        case.rebuild(&walkers, &marked.losers);
        let marked = marked.triangles;
        case.configure(&marked);
        case
    })
}

#[test]
fn flip_pairs() {
    let mut gpu = Gpu::open();
    let mut flips = [0; 4];
    for mut case in with_pairs() {
        let parity = case.scratch.round as usize & 1;
        let taken = case.pairs.len() as u32;
        for least in [taken + 1, taken] {
            let on = On::new(&mut gpu, &case, &[(INNER_LIMIT, 8)]);
            let arguments = FlipPairsArgs {
                triangles: on.mesh.corners(),
                links: on.mesh.twins(),
                state: on.state.view().cast(),
                even_pairs: on.pairs[0].view().cast(),
                odd_pairs: on.pairs[1].view().cast(),
                spokes: on.spokes.view(),
                degrees: on.degrees.view(),
                words: on.words.view(),
                least,
            };
            run::<FlipPairs>(&mut gpu, &[], 2, &arguments);
            let mut expected = [0; 4];
            if least == taken {
                expected = case.flip();
                assert_eq!(on.word(&mut gpu, ROUND_NOW), case.scratch.round);
            }
            assert_eq!(on.word(&mut gpu, TAKEN), if least == taken { taken } else { 0 });
            assert_eq!(on.flips(&mut gpu), expected, "{}", case.name);
            assert!(on.pairs(&mut gpu, parity) == sorted(&case.pairs), "{}", case.name);
            on.assert_state(&mut gpu, &case, parity);
            if least == taken {
                on.assert_spokes(&mut gpu, &case);
            }
            flips.iter_mut().zip(expected).for_each(|(sum, n)| *sum += n);
        }
    }
    assert!(flips.iter().all(|&n| n > 0), "{flips:?}");
}

#[test]
fn advance_pairs() {
    let mut gpu = Gpu::open();
    let mut pairs = 0;
    for mut case in with_pairs() {
        let parity = case.scratch.round as usize & 1;
        case.flip();
        let round = case.scratch.round;
        case.scratch.round -= 1;
        let taken = case.pairs.len() as u32;
        let on = On::new(&mut gpu, &case, &[(TAKEN, taken), (ROUND_NOW, round), (INNER, 3)]);
        case.scratch.round += 1;
        let arguments = AdvancePairsArgs {
            triangles: on.mesh.corners(),
            links: on.mesh.twins(),
            positions: on.mesh.positions().cast(),
            state: on.state.view().cast(),
            even_pairs: on.pairs[0].view().cast(),
            odd_pairs: on.pairs[1].view().cast(),
            words: on.words.view(),
        };
        run::<AdvancePairs>(&mut gpu, EXACT, 2, &arguments);
        case.advance();
        let turned = u32::from(taken != 0);
        assert_eq!(on.word(&mut gpu, ROUND), round - 1 + turned);
        assert_eq!(on.word(&mut gpu, INNER), 3 + turned);
        assert_eq!(on.word(&mut gpu, INNER_ROUNDS), turned);
        assert!(on.pairs(&mut gpu, 1 - parity) == sorted(&case.pairs), "{}", case.name);
        assert_eq!(on.word(&mut gpu, CANDIDATES + parity), 0);
        on.assert_state(&mut gpu, &case, 1 - parity);
        pairs += case.pairs.len();
    }
    assert!(pairs > 100, "{pairs}");
}

#[test]
fn pair_tail() {
    let mut gpu = Gpu::open();
    let (mut rounds_of_all, mut left_of_all, mut went_on) = (0, 0, 0);
    for (turn, mut case) in with_pairs().enumerate() {
        // Where some of the rounds of this outer round are left, and where as many are made as are allowed.
        for limit in [NONE, 8] {
            let mut case = case.clone();
            let (inner, losers, outer) = (5, 2, 4);
            let most = 4 + turn as u32 % 3;
            let least = 100 + 10 * turn as u32;
            let words = [(GOES_ON, 1), (LOSERS, losers), (INNER, inner), (INNER_LIMIT, limit), (OUTER, outer)];
            let on = On::new(&mut gpu, &case, &words);
            let arguments = PairTailArgs {
                triangles: on.mesh.corners(),
                links: on.mesh.twins(),
                positions: on.mesh.positions().cast(),
                state: on.state.view().cast(),
                even_pairs: on.pairs[0].view().cast(),
                odd_pairs: on.pairs[1].view().cast(),
                spokes: on.spokes.view(),
                degrees: on.degrees.view(),
                counter: None,
                words: on.words.view(),
                limit: case.subs.len() as u32,
                least,
                most,
                most_pairs: NONE,
                inner: 8,
                long_chain: 64,
                most_times: 8,
                usual_rounds: 4,
            };
            run::<PairTail>(&mut gpu, EXACT, 1, &arguments);
            let bounds = [least as usize, most.min(limit - inner) as usize];
            let Case { start, pairs, scratch, spokes, degrees, .. } = &mut case;
            let spokes = [&mut spokes[..], degrees];
            let (left, rounds, flips) =
                kernels::pair_tail(&mut start.mesh, &start.positions, pairs, bounds, scratch, spokes);
            let parity = scratch.round as usize & 1;
            let inner = inner + rounds as u32;
            let goes_on = !left.is_empty() && inner < limit;
            assert_eq!(on.word(&mut gpu, GOES_ON), u32::from(goes_on));
            assert_eq!(on.word(&mut gpu, ROUND), scratch.round + if goes_on { 0 } else { 2 });
            assert_eq!(u64::from(on.word(&mut gpu, INNER_ROUNDS)), rounds);
            let turned = [OUTER, LOSERS, INNER].map(|word| on.word(&mut gpu, word));
            assert_eq!(turned, if goes_on { [outer, losers, inner] } else { [outer + 1, 0, 0] });
            assert_eq!(on.flips(&mut gpu), flips, "{}", case.name);
            assert!(on.pairs(&mut gpu, parity) == sorted(&left), "{}", case.name);
            on.assert_state(&mut gpu, &case, parity);
            on.assert_spokes(&mut gpu, &case);
            rounds_of_all += rounds;
            left_of_all += left.len();
            went_on += u32::from(goes_on);
        }
        case.flip();
    }
    assert!(rounds_of_all > 30 && left_of_all > 10 && went_on > 2, "{rounds_of_all} {left_of_all} {went_on}");
}
