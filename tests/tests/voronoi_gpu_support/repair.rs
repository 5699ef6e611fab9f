//! The kernels that find debris and recolor it.

use super::*;
use crate::vulkan_support::words;
use polder_voronoi::UNCOLORED;

/// Device copies of what the kernels of a round share.
struct Round {
    colors: Buffer<u32>,
    sites: Buffer<u32>,
    state: Buffer<u32>,
    debris: Buffer<u32>,
    candidates: Buffer<u32>,
    total: Buffer<u32>,
    marked: Buffer<u32>,
    count: Buffer<u32>,
    width: u32,
    height: u32,
}

impl Round {
    /// As it stands after so much debris was found, the last `marked` pixels of it in the last round.
    fn new(gpu: &mut Gpu, sites: &Sites, diagram: &Diagram, debris: &[u32], marked: usize, candidates: &[u32]) -> Self {
        let mut list = vec![7_u32; diagram.colors.len()];
        list[..debris.len()].copy_from_slice(debris);
        let mut state = vec![0_u32; diagram.colors.len()];
        debris.iter().for_each(|&index| state[index as usize] = 1);
        candidates.iter().for_each(|&index| state[index as usize] = 2);
        let mut offered = vec![7_u32; diagram.colors.len()];
        offered[..candidates.len()].copy_from_slice(candidates);
        Round {
            colors: gpu.buffer(&diagram.colors),
            sites: gpu.buffer(&words_of(&sites.pixels)),
            state: gpu.buffer(&state),
            debris: gpu.buffer(&list),
            candidates: gpu.buffer(&offered),
            total: gpu.buffer(&[debris.len() as u32]),
            marked: gpu.buffer(&[marked as u32]),
            count: gpu.buffer(&[candidates.len() as u32]),
            width: diagram.width,
            height: diagram.height,
        }
    }
}

#[test]
fn mark_debris() {
    with_device(|Shared { gpu, .. }| {
        let mut found = 0;
        for (sites, diagram) in diagrams() {
            let round = Round::new(gpu, &sites, &diagram, &[], 0, &[]);
            let arguments = MarkDebrisArgs {
                colors: round.colors.view(),
                sites: round.sites.view(),
                state: round.state.view(),
                debris: round.debris.view(),
                total: round.total.view(),
                marked: round.marked.view(),
                width: round.width,
                height: round.height,
            };
            run::<MarkDebris>(gpu, diagram.colors.len(), &arguments);
            let expected = kernels::mark_debris(&diagram, &sites);
            let count = expected.len();
            assert_eq!(
                (gpu.fetch(round.total.view()), gpu.fetch(round.marked.view())),
                (vec![count as u32], vec![count as u32])
            );
            assert_eq!(sorted(gpu.fetch(round.debris.view())[..count].to_vec()), expected);
            let mut state = vec![0; diagram.colors.len()];
            expected.iter().for_each(|&index| state[index as usize] = 1);
            assert_eq!(gpu.fetch(round.state.view()), state);
            found += count;
        }
        assert!(found > 20, "{found}");
    });
}

#[test]
fn drop_debris() {
    with_device(|Shared { gpu, .. }| {
        for (sites, mut diagram) in diagrams() {
            // Any pixels will do; in two rounds, as if they had been marked one after the other.
            let random = words(7, diagram.colors.len());
            let all: Vec<u32> =
                (0..diagram.colors.len() as u32).filter(|&i| random[i as usize].is_multiple_of(5)).collect();
            let (early, late) = all.split_at(all.len() / 3);
            kernels::drop_debris(&mut diagram, early);
            let round = Round::new(gpu, &sites, &diagram, &all, late.len(), &[]);
            let arguments = DropDebrisArgs {
                colors: round.colors.view(),
                state: round.state.view(),
                debris: round.debris.view(),
                total: round.total.view(),
                marked: round.marked.view(),
                candidates: round.candidates.view(),
                count: round.count.view(),
                width: round.width,
                height: round.height,
            };
            run::<DropDebris>(gpu, late.len(), &arguments);
            let expected = kernels::drop_debris(&mut diagram, late);
            assert_eq!(gpu.fetch(round.colors.view()), diagram.colors);
            assert_eq!(gpu.fetch(round.count.view()), [expected.len() as u32]);
            assert_eq!(sorted(gpu.fetch(round.candidates.view())[..expected.len()].to_vec()), expected);
        }
    });
}

#[test]
fn check_debris() {
    with_device(|Shared { gpu, .. }| {
        for (sites, mut diagram) in diagrams() {
            let random = words(8, diagram.colors.len());
            let early: Vec<u32> =
                (0..diagram.colors.len() as u32).filter(|&i| random[i as usize].is_multiple_of(5)).collect();
            let candidates = kernels::drop_debris(&mut diagram, &early);
            let round = Round::new(gpu, &sites, &diagram, &early, 0, &candidates);
            let arguments = CheckDebrisArgs {
                colors: round.colors.view(),
                sites: round.sites.view(),
                state: round.state.view(),
                debris: round.debris.view(),
                total: round.total.view(),
                marked: round.marked.view(),
                candidates: round.candidates.view(),
                count: round.count.view(),
                width: round.width,
                height: round.height,
            };
            run::<CheckDebris>(gpu, candidates.len(), &arguments);
            let expected = kernels::check_debris(&diagram, &sites, &candidates);
            let (before, total) = (early.len(), early.len() + expected.len());
            assert_eq!(gpu.fetch(round.total.view()), [total as u32]);
            assert_eq!(gpu.fetch(round.marked.view()), [expected.len() as u32]);
            let list = gpu.fetch(round.debris.view());
            assert_eq!((&list[..before], sorted(list[before..total].to_vec())), (&early[..], expected.clone()));
            let mut state = vec![0; diagram.colors.len()];
            early.iter().chain(&expected).for_each(|&index| state[index as usize] = 1);
            assert_eq!(gpu.fetch(round.state.view()), state);
        }
    });
}

/// Diagrams without their debris, half way through recoloring, and others that have any colors where debris is said to be.
fn uncolored() -> Vec<(Sites, Diagram)> {
    let mut diagrams = diagrams();
    for (turn, (sites, diagram)) in diagrams.iter_mut().enumerate() {
        reference::debris(diagram, sites).unwrap();
        for _ in 0..turn % 3 {
            let found = kernels::find_color(diagram, sites);
            kernels::take_color(diagram, &found);
        }
    }
    let disturbed = diagrams.clone().into_iter().map(|(sites, mut diagram)| {
        let random = words(9, diagram.colors.len());
        diagram.debris = (0..diagram.colors.len() as u32).filter(|&i| random[i as usize].is_multiple_of(3)).collect();
        for &index in &diagram.debris {
            let word = random[index as usize] / 3;
            match word % 3 {
                0 => diagram.colors[index as usize] = UNCOLORED,
                1 => diagram.colors[index as usize] = word / 3 % sites.count as u32,
                _ => {}
            }
        }
        (sites, diagram)
    });
    let disturbed: Vec<_> = disturbed.collect();
    diagrams.extend(disturbed);
    diagrams
}

#[test]
fn find_color() {
    with_device(|Shared { gpu, .. }| {
        for (sites, diagram) in uncolored() {
            let round = Round::new(gpu, &sites, &diagram, &diagram.debris, 0, &[]);
            let found = gpu.buffer(&vec![7_u32; diagram.debris.len()]);
            let arguments = FindColorArgs {
                colors: round.colors.view(),
                sites: round.sites.view(),
                debris: round.debris.view(),
                found: found.view(),
                count: round.total.view(),
                width: round.width,
                height: round.height,
            };
            run::<FindColor>(gpu, diagram.debris.len(), &arguments);
            assert_eq!(gpu.fetch(found.view()), kernels::find_color(&diagram, &sites));
        }
    });
}

#[test]
fn take_color() {
    with_device(|Shared { gpu, .. }| {
        let mut agains = [0, 0];
        for (sites, mut diagram) in uncolored() {
            let offered = kernels::find_color(&diagram, &sites);
            let round = Round::new(gpu, &sites, &diagram, &diagram.debris, 0, &[]);
            let (found, again) = (gpu.buffer(&offered), gpu.buffer(&[0_u32]));
            let arguments = TakeColorArgs {
                colors: round.colors.view(),
                state: round.state.view(),
                debris: round.debris.view(),
                found: found.view(),
                count: round.total.view(),
                again: again.view(),
                width: round.width,
                height: round.height,
            };
            run::<TakeColor>(gpu, offered.len(), &arguments);
            let expected = kernels::take_color(&mut diagram, &offered);
            assert_eq!(gpu.fetch(round.colors.view()), diagram.colors);
            assert_eq!(gpu.fetch(again.view()), [if expected { offered.len() as u32 } else { 0 }]);
            agains[usize::from(expected)] += 1;
        }
        assert!(agains[0] > 0 && agains[1] > 0, "{agains:?}");
    });
}
