//! The kernels of stage 6 with which sub-constraints begin and walk against the references of their names.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod constrain_gpu_support;
mod constrain_support;
mod vulkan_support;

use constrain_gpu_support::*;
use polder_constrain::Fault;
use polder_constrain::kernels::*;
use polder_constrain::reference::{HUB, HUB_WALK, MOST_SPOKES, kernels};
use vulkan_support::Gpu;

#[test]
fn list_walkers() {
    let mut gpu = Gpu::open();
    let (mut edges, mut hubs) = (0, 0);
    for mut case in cases() {
        let (takes, first, round) = (case.takes.clone(), case.is_first(), case.scratch.round);
        let words = if first { [(OUTER, 0), (WAITED, 0)] } else { [(OUTER, 2), (WAITED, takes.len() as u32)] };
        let on = On::new(&mut gpu, &case, &words);
        let known = if first { vec![7; case.known(&[], &[]).len()] } else { case.known(&takes, &takes) };
        gpu.engine.upload(on.lost.view(), &known).unwrap();
        let room = case.subs.len();
        let arguments = ListWalkersArgs {
            triangles: on.mesh.corners(),
            links: on.mesh.twins(),
            sub_constraints: on.subs.view().cast(),
            counter: None,
            spokes: on.spokes.view(),
            degrees: on.degrees.view(),
            walkers: on.walkers.view(),
            lost: on.lost.view(),
            counts: on.counts.view(),
            words: on.words.view(),
            limit: room as u32,
            most: 3 * case.start.mesh.slots() as u32,
            crowd: HUB,
        };
        run::<ListWalkers>(&mut gpu, &[], 2, &arguments);
        let (walkers, counts, inserted) = case.list();
        let count = on.word(&mut gpu, WALKERS) as usize;
        assert!(sorted(&gpu.fetch(on.walkers.view())[..count]) == sorted(&walkers), "{}", case.name);
        assert_eq!(on.word(&mut gpu, INSERTED), inserted);
        assert_eq!(on.word(&mut gpu, EDGES_ALREADY), inserted);
        let (pairs, round) = (case.pairs.len() as u32, if first || !takes.is_empty() { round } else { NONE });
        assert_eq!([STOLEN, HELD, HELD_ROUND].map(|word| on.word(&mut gpu, word)), [0, pairs, round]);
        let known = case.known(&[], &[]);
        assert_eq!(gpu.fetch(on.lost.view())[..room], known[..room]);
        for (v, count) in counts.iter().flatten().enumerate() {
            let found = gpu.fetch(on.counts.view())[v];
            assert_eq!(found.min(HUB), (*count).min(HUB), "{}: {v}", case.name);
            hubs += u32::from(*count >= HUB);
        }
        assert!(on.mesh(&mut gpu) == case.start.mesh, "{}", case.name);
        edges += inserted;
    }
    assert!(edges > 100 && hubs > 0, "{edges} {hubs}");
}

#[test]
fn depart_walks() {
    let mut gpu = Gpu::open();
    let (mut edges, mut stolen, mut at_hub) = (0, 0, 0);
    for mut case in cases() {
        let first = case.is_first();
        let (walkers, counts, _) = case.list();
        let words = [(OUTER, u32::from(!first)), (WALKERS, walkers.len() as u32), (HUBS, u32::from(!first))];
        let on = On::new(&mut gpu, &case, &words);
        gpu.engine.upload(on.walkers.slice(0..walkers.len()).unwrap(), &walkers).unwrap();
        if let Some(counts) = &counts {
            gpu.engine.upload(on.counts.slice(0..counts.len()).unwrap(), counts).unwrap();
        }
        let arguments = DepartWalksArgs {
            triangles: on.mesh.corners(),
            links: on.mesh.twins(),
            positions: on.mesh.positions().cast(),
            sub_constraints: on.subs.view().cast(),
            spokes: on.spokes.view(),
            degrees: on.degrees.view(),
            counts: on.counts.view(),
            walkers: on.walkers.view(),
            firsts: on.firsts.view(),
            lost: on.lost.view(),
            state: on.state.view().cast(),
            words: on.words.view(),
            most: 3 * case.start.mesh.slots() as u32,
            crowd: HUB,
            most_spokes: MOST_SPOKES,
            longest: 5,
            least: walkers.len() as u32 + case.name.len() as u32 % 2,
        };
        run::<DepartWalks>(&mut gpu, EXACT, 2, &arguments);
        let mut expected = case.depart(&walkers, counts.as_deref());
        assert_eq!(expected.fault, None);
        let done: Vec<u32> = walkers.iter().copied().filter(|s| !expected.walkers.contains(s)).collect();
        let (firsts, wanted) = (gpu.fetch(on.firsts.view()), case.firsts());
        for &s in &walkers {
            let wanted = if done.contains(&s) { NONE } else { wanted[s as usize] };
            assert_eq!(firsts[s as usize], wanted, "{}: {s}", case.name);
        }
        let losers = &mut expected.marked.losers;
        losers.sort_unstable();
        losers.dedup();
        assert_eq!(gpu.fetch(on.lost.view()), case.known(losers, &done), "{}", case.name);
        assert_eq!(on.word(&mut gpu, LOSERS) as usize, losers.len());
        assert_eq!(on.word(&mut gpu, INSERTED), expected.inserted);
        assert_eq!(on.word(&mut gpu, EDGES_ALREADY), 0);
        let longest = [5, 0][case.name.len() % 2];
        assert_eq!(on.word(&mut gpu, LONGEST), if first { longest } else { case.longest });
        assert_eq!(on.word(&mut gpu, DEPART_FAULT), NONE);
        assert_eq!(on.word(&mut gpu, HUBS) != 0, !first || case.begun.iter().any(|b| b.at_hub));
        let parity = case.scratch.round as usize & 1;
        on.assert_state(&mut gpu, &case, parity);
        edges += expected.inserted;
        stolen += usize::from(!first && expected.marked.stolen);
        at_hub += case.begun.iter().filter(|b| b.at_hub).count();
    }
    assert!(edges > 0 && stolen > 0 && at_hub > 100, "{edges} {stolen} {at_hub}");
}

#[test]
fn admit_walks() {
    let mut gpu = Gpu::open();
    let mut all = [0; 2];
    for mut case in cases() {
        let (walkers, counts, _) = case.list();
        let mut walkers = case.depart(&walkers, counts.as_deref()).walkers;
        // One is an edge by now.
        let done: Vec<u32> = walkers.pop().into_iter().collect();
        let list = [&walkers[..], &done].concat();
        let on = On::new(&mut gpu, &case, &[(WALKERS, list.len() as u32)]);
        gpu.engine.upload(on.walkers.slice(0..list.len()).unwrap(), &list).unwrap();
        gpu.engine.upload(on.lost.view(), &case.known(&[], &done)).unwrap();
        let arguments = AdmitWalksArgs {
            walkers: on.walkers.view(),
            firsts: on.firsts.view(),
            admitted: on.admitted.view(),
            lost: on.lost.view(),
            state: on.state.view().cast(),
            words: on.words.view(),
        };
        run::<AdmitWalks>(&mut gpu, &[], 2, &arguments);
        let [admitted, barred] = kernels::admit_walks(&walkers, &case.begun, &case.scratch);
        let count = on.word(&mut gpu, ADMITTED) as usize;
        assert!(sorted(&gpu.fetch(on.admitted.view())[..count]) == sorted(&admitted), "{}", case.name);
        assert_eq!(on.word(&mut gpu, LOSERS) as usize, barred.len());
        let known = case.known(&barred, &[&barred[..], &done].concat());
        assert_eq!(gpu.fetch(on.lost.view()), known, "{}", case.name);
        all = [all[0] + admitted.len(), all[1] + barred.len()];
    }
    assert!(all.iter().all(|&n| n > 100), "{all:?}");
}

#[test]
fn mark_chains() {
    let mut gpu = Gpu::open();
    let (mut lost, mut met, mut stolen, mut partial) = (0, [0; 2], 0, 0);
    for mut case in cases() {
        let first = case.is_first();
        let (walkers, counts, _) = case.list();
        let walkers = case.depart(&walkers, counts.as_deref()).walkers;
        let [mut walkers, barred] = kernels::admit_walks(&walkers, &case.begun, &case.scratch);
        // Half of them, first as they are, then with an edge on their way constrained.
        for blocked in [false, true] {
            let mut case = case.clone();
            if let (true, Some(&s)) = (blocked, walkers.iter().max()) {
                case.start.mesh.set_constrained(case.begun[s as usize].first, true);
            }
            walkers.retain(|&s| !polder_flip::priority(s).is_multiple_of(4) || blocked);
            let words = [(OUTER, 3), (ADMITTED, walkers.len() as u32), (HUBS, u32::from(!first))];
            let on = On::new(&mut gpu, &case, &words);
            gpu.engine.upload(on.walkers.slice(0..walkers.len()).unwrap(), &walkers).unwrap();
            gpu.engine.upload(on.lost.view(), &case.known(&[], &barred)).unwrap();
            let arguments = MarkChainsArgs {
                triangles: on.mesh.corners(),
                links: on.mesh.twins(),
                positions: on.mesh.positions().cast(),
                sub_constraints: on.subs.view().cast(),
                walkers: on.walkers.view(),
                firsts: on.firsts.view(),
                runs: on.runs.view(),
                pieces: on.pieces.view(),
                piece_count: on.piece_count.view(),
                piece_walked: on.piece_walked.view(),
                lost: on.lost.view(),
                state: on.state.view().cast(),
                words: on.words.view(),
                stride: on.stride as u32,
                piece_limit: 1,
                hub_walk: HUB_WALK,
            };
            run::<MarkChains>(&mut gpu, EXACT, 2, &arguments);
            let expected = case.mark(&walkers);
            let parity = case.scratch.round as usize & 1;
            on.assert_state(&mut gpu, &case, parity);
            assert_eq!(u64::from(on.word(&mut gpu, WALKED)), expected.walked);
            assert_eq!(on.word(&mut gpu, LOSERS) as usize, expected.losers.len());
            assert_eq!(on.word(&mut gpu, STOLEN), u32::from(!first && expected.stolen));
            assert_eq!(on.word(&mut gpu, PARTIAL_WALKS), expected.partial);
            partial += expected.partial;
            assert_eq!(gpu.fetch(on.lost.view()), case.known(&expected.losers, &barred), "{}", case.name);
            let fault = match expected.fault {
                None => NONE,
                Some(Fault::Blocked(s)) => s << 2,
                other => panic!("{other:?}"),
            };
            assert_eq!(on.word(&mut gpu, DEPART_FAULT + 1), fault, "{}", case.name);
            met[usize::from(fault == NONE)] += 1;
            lost += expected.losers.len();
            stolen += usize::from(!first && expected.stolen);
        }
    }
    assert!(lost > 50 && met.iter().all(|&n| n > 3) && stolen > 1 && partial > 0, "{lost} {met:?} {stolen} {partial}");
}
