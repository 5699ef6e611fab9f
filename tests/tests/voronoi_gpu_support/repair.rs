//! The kernels that mark debris, and the one that repairs it.

use super::*;

#[test]
fn mark_debris() {
    with_device(|Shared { gpu, .. }| {
        let mut found = 0;
        for (turn, (sites, diagram)) in diagrams().into_iter().enumerate() {
            let [width, height] = sites.size;
            let tiles = width.div_ceil(kernels::TILE_WIDTH) * height.div_ceil(kernels::TILE_HEIGHT);
            let tiles: Vec<u32> = (0..tiles).rev().filter(|tile| turn % 2 == 0 || tile % 2 == 0).collect();
            let (colors, pixels) = (gpu.buffer(&diagram.colors), gpu.buffer(&words_of(&sites.pixels)));
            let (left, left_count) = (gpu.buffer(&tiles), gpu.buffer(&[tiles.len() as u32]));
            let (bits, any) = (gpu.buffer(&vec![0_u32; diagram.colors.len().div_ceil(32)]), gpu.buffer(&[0_u32]));
            let arguments = MarkDebrisArgs {
                colors: colors.view(),
                sites: pixels.view(),
                left: left.view(),
                left_count: left_count.view(),
                debris_bits: bits.view(),
                any_debris: any.view(),
                width,
                height,
            };
            run_with::<MarkDebris>(gpu, &[], groups_for(tiles.len() + 1, 1), &arguments);
            let expected = kernels::mark_debris(&diagram, &sites, &tiles);
            let count: u32 = expected.iter().map(|word| word.count_ones()).sum();
            assert_eq!(gpu.fetch(bits.view()), expected);
            assert_eq!(gpu.fetch(any.view()), [u32::from(count > 0)]);
            found += count;
        }
        assert!(found > 20, "{found}");
    });
}

#[test]
fn list_debris() {
    with_device(|Shared { gpu, .. }| {
        for count in [1, 8, 256, 3000] {
            let input: Vec<u32> =
                vulkan_support::words(5, count).iter().map(|word| word & word >> 7 & word >> 9).collect();
            let expected = kernels::list_debris(&input);
            let (bits, colors) = (gpu.buffer(&input), gpu.buffer(&vec![7_u32; 32 * count]));
            let list = gpu.buffer(&vec![7_u32; expected.len() + 1]);
            let total = gpu.buffer(&[0_u32]);
            for flag in [0_u32, 1] {
                let any = gpu.buffer(&[flag]);
                let arguments = ListDebrisArgs {
                    any_debris: any.view(),
                    debris_bits: bits.view(),
                    colors: colors.view(),
                    list: list.view(),
                    count: total.view(),
                    words: count as u32,
                };
                run::<ListDebris>(gpu, count, &arguments);
                assert_eq!(gpu.fetch(total.view()), [flag * expected.len() as u32]);
            }
            let found = gpu.fetch(list.view());
            let mut uncolored = vec![7; 32 * count];
            expected.iter().for_each(|&index| uncolored[index as usize] = UNCOLORED);
            assert_eq!((sorted(found[..expected.len()].to_vec()), found[expected.len()]), (expected, 7));
            assert!(gpu.fetch(colors.view()) == uncolored);
        }
    });
}

/// Debris that is marked first and has lost its color, on the device: as the kernels after `list_debris` find it.
struct Listed {
    colors: Buffer<u32>,
    sites: Buffer<u32>,
    list: Buffer<u32>,
    bits: Buffer<u32>,
    /// As `repair` keeps it; the first words count what each turn has found.
    progress: Buffer<u32>,
    /// What turn 1 finds at least.
    then: Vec<u32>,
}

impl Listed {
    fn new(gpu: &mut Gpu, sites: &Sites, diagram: &Diagram) -> Self {
        let [width, height] = sites.size;
        let all: Vec<u32> = (0..width.div_ceil(64) * height.div_ceil(62)).collect();
        let marked = kernels::mark_debris(diagram, sites, &all);
        let mut list = kernels::list_debris(&marked);
        let mut dropped = diagram.clone();
        list.iter().for_each(|&index| dropped.colors[index as usize] = UNCOLORED);
        let then = kernels::spread_debris(&dropped, sites, &list);
        let mut progress = vec![0_u32; 44];
        progress[0] = list.len() as u32;
        list.resize(dropped.colors.len(), 7);
        Listed {
            colors: gpu.buffer(&dropped.colors),
            sites: gpu.buffer(&words_of(&sites.pixels)),
            list: gpu.buffer(&list),
            bits: gpu.buffer(&marked),
            progress: gpu.buffer(&progress),
            then,
        }
    }

    /// Runs a turn and returns what it has listed.
    fn spread(&self, gpu: &mut Gpu, turn: u32, [width, height]: [u32; 2]) -> Vec<u32> {
        let arguments = SpreadDebrisArgs {
            colors: self.colors.view(),
            sites: self.sites.view(),
            list: self.list.view(),
            debris_bits: self.bits.view(),
            counts: self.progress.view(),
            turn,
            width,
            height,
        };
        // Fewer invocations than neighbors.
        run_with::<SpreadDebris>(gpu, &[("WORKGROUP", 64)], [3, 1, 1], &arguments);
        let counts = gpu.fetch(self.progress.view());
        let ends: Vec<usize> = (0..=turn as usize).map(|turn| counts[4 * turn] as usize).collect();
        let end: usize = ends.iter().sum();
        gpu.fetch(self.list.view())[end - ends[turn as usize]..end].to_vec()
    }
}

#[test]
fn spread_debris() {
    with_device(|Shared { gpu, .. }| {
        let mut found = [0, 0];
        for (sites, mut diagram) in diagrams() {
            let listed = Listed::new(gpu, &sites, &diagram);
            let marked = gpu.fetch(listed.progress.view())[0] as usize;
            let mut all = gpu.fetch(listed.list.view())[..marked].to_vec();
            for turn in 1.. {
                let more = listed.spread(gpu, turn, sites.size);
                if turn == 1 {
                    assert!(listed.then.iter().all(|index| more.contains(index)));
                }
                all.extend(&more);
                found[usize::from(turn > 1)] += more.len();
                if more.is_empty() || turn == 9 {
                    break;
                }
            }
            // Once a turn finds nothing there is nothing left.
            reference::debris(&mut diagram, &sites).unwrap();
            assert_eq!(sorted(all), diagram.debris);
            assert_eq!(kernels::list_debris(&gpu.fetch(listed.bits.view())), diagram.debris);
            assert!(gpu.fetch(listed.colors.view()) == diagram.colors);
        }
        assert!(found[0] > 20 && found[1] > 0, "{found:?}");
    });
}

#[test]
fn recolor_debris() {
    with_device(|Shared { gpu, .. }| {
        let mut turns = 0;
        for (sites, mut diagram) in diagrams() {
            let [width, height] = sites.size;
            reference::debris(&mut diagram, &sites).unwrap();
            let words = diagram.colors.len().div_ceil(32);
            let mut debris_bits = vec![0_u32; words];
            diagram.debris.iter().for_each(|&index| debris_bits[index as usize / 32] |= 1 << (index % 32));
            let (colors, pixels) = (gpu.buffer(&diagram.colors), gpu.buffer(&words_of(&sites.pixels)));
            let debris_bits = gpu.buffer(&debris_bits);
            let bits = [gpu.buffer(&vec![0_u32; words]), gpu.buffer(&vec![0_u32; words])];
            let mut list = diagram.debris.clone();
            let mut before = diagram.colors.clone();
            for turn in 0.. {
                assert!(turn < 10_000);
                // In the other phases it does nothing.
                for phase in [0_u32, 2, 1] {
                    let (now, count) =
                        (gpu.buffer(&[list.as_slice(), &[7]].concat()), gpu.buffer(&[list.len() as u32]));
                    let (next, next_count) = (gpu.buffer(&vec![7_u32; diagram.debris.len() + 1]), gpu.buffer(&[0_u32]));
                    let phase_word = gpu.buffer(&[phase]);
                    let arguments = RecolorDebrisArgs {
                        colors: colors.view(),
                        sites: pixels.view(),
                        list: now.view(),
                        count: count.view(),
                        next_list: next.view(),
                        next_count: next_count.view(),
                        debris_bits: debris_bits.view(),
                        listed_bits: bits[turn % 2].view(),
                        next_bits: bits[1 - turn % 2].view(),
                        phase: phase_word.view(),
                        width,
                        height,
                    };
                    run_with::<RecolorDebris>(gpu, &[("WORKGROUP", 64)], [3, 1, 1], &arguments);
                    let count = gpu.fetch(next_count.view())[0] as usize;
                    let after = gpu.fetch(colors.view());
                    if phase != 1 {
                        assert!(after == before && count == 0);
                        continue;
                    }
                    // What is listed is the debris around what has changed, and has a bit each.
                    let changed = (0..after.len()).filter(|&index| after[index] != before[index]);
                    let mut around: Vec<u32> = changed.flat_map(|index| neighbors(index, sites.size)).collect();
                    around.retain(|index| diagram.debris.binary_search(index).is_ok());
                    around = sorted(around);
                    around.dedup();
                    list = gpu.fetch(next.view())[..count].to_vec();
                    assert_eq!(sorted(list.clone()), around);
                    assert_eq!(kernels::list_debris(&gpu.fetch(bits[1 - turn % 2].view())), around);
                    assert_eq!(gpu.fetch(bits[turn % 2].view()), vec![0; words]);
                    before = after;
                }
                turns += 1;
                if list.is_empty() {
                    break;
                }
            }
            let mut active = diagram.debris.clone();
            while !active.is_empty() {
                active = kernels::recolor_debris(&mut diagram, &sites, &active);
            }
            assert!(before == diagram.colors);
        }
        assert!(turns > 20, "{turns}");
    });
}

/// The indices of the pixels around one.
fn neighbors(index: usize, [width, height]: [u32; 2]) -> Vec<u32> {
    let (x, y) = (index as i64 % i64::from(width), index as i64 / i64::from(width));
    let around = (0..9).filter(|&k| k != 4).map(|k| (x + k % 3 - 1, y + k / 3 - 1));
    let inside = |&(x, y): &(i64, i64)| x >= 0 && y >= 0 && x < i64::from(width) && y < i64::from(height);
    around.filter(inside).map(|(x, y)| (y * i64::from(width) + x) as u32).collect()
}

#[test]
fn repair() {
    with_device(|Shared { gpu, .. }| {
        let (mut most, mut dispatches) = (0, 0);
        for (turn, (sites, mut diagram)) in diagrams().into_iter().enumerate() {
            let [width, height] = sites.size;
            let listed = Listed::new(gpu, &sites, &diagram);
            for done in 1..=turn as u32 % 4 {
                listed.spread(gpu, done, sites.size);
            }
            let words = diagram.colors.len().div_ceil(32);
            let other_list = gpu.buffer(&vec![7_u32; diagram.colors.len()]);
            let (listed_bits, other_bits) = (gpu.buffer(&vec![0_u32; words]), gpu.buffer(&vec![0_u32; words]));
            let (count, unfinished) = (gpu.buffer(&[0_u32]), gpu.buffer(&[0_u32]));
            let mut arguments = RepairArgs {
                colors: listed.colors.view(),
                sites: listed.sites.view(),
                list: listed.list.view(),
                other_list: other_list.view(),
                debris_bits: listed.bits.view(),
                listed_bits: listed_bits.view(),
                other_bits: other_bits.view(),
                progress: listed.progress.view(),
                progressed: listed.progress.view(),
                count: count.view(),
                unfinished: unfinished.view(),
                width,
                height,
                recolors: 0,
            };
            // In many dispatches, and in one; first finding alone, or all by one kernel.
            let (workgroup, rounds) = [(32, 1), (64, 3), (256, 256)][turn % 3];
            let constants = [("WORKGROUP", workgroup), ("ROUNDS", rounds)];
            let finds_first = turn % 2 == 0;
            if finds_first {
                run_with::<Repair>(gpu, &constants, [1, 1, 1], &arguments);
                let mut state = gpu.fetch(listed.progress.view());
                if state[24] == 1 {
                    // All found: the list of two turns of recolor_debris that have changed nothing yet is all of it.
                    state[40] = gpu.fetch(count.view())[0];
                    gpu.engine.upload(listed.progress.view(), &state).unwrap();
                }
            }
            arguments.recolors = 1;
            run_with::<Repair>(gpu, &constants, [1, 1, 1], &arguments);
            while gpu.fetch(unfinished.view())[0] != 0 {
                run_with::<Repair>(gpu, &constants, [1, 1, 1], &arguments);
                dispatches += 1;
                assert!(dispatches < 10_000);
            }
            kernels::repair(&mut diagram, &sites).unwrap();
            assert!(gpu.fetch(listed.colors.view()) == diagram.colors);
            assert_eq!(kernels::list_debris(&gpu.fetch(listed.bits.view())), diagram.debris);
            assert_eq!(gpu.fetch(count.view()), [diagram.debris.len() as u32]);
            assert_eq!(gpu.fetch(listed_bits.view()), vec![0; words]);
            assert_eq!(gpu.fetch(other_bits.view()), vec![0; words]);
            most = most.max(diagram.debris.len());
        }
        assert!(most > 300 && dispatches > 10, "{most} {dispatches}");
    });
}
