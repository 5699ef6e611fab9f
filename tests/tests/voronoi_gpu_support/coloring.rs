//! The kernels of the coloring.

use super::*;
use polder_voronoi::reference::kernels::{TILE_HEIGHT, TILE_WIDTH};

/// The tiles of a grid, across and down.
fn tiles_of([width, height]: [u32; 2]) -> [u32; 2] {
    [width.div_ceil(TILE_WIDTH), height.div_ceil(TILE_HEIGHT)]
}

/// Rows of tiles that are wanted: all, or every other one.
fn wanted_of(turn: usize, size: [u32; 2]) -> Vec<u32> {
    (0..tiles_of(size)[1]).map(|row| u32::from(turn.is_multiple_of(2) || row % 2 == 1)).collect()
}

fn is_wanted(wanted: &[u32], y: usize) -> bool {
    wanted[y / TILE_HEIGHT as usize] != 0
}

/// Half words, two columns in a word, each row from a new word on.
fn halves(nearest: &[u32], width: u32) -> Vec<u32> {
    let row = |row: &[u32]| -> Vec<u32> {
        row.chunks(2).map(|two| two[0] | two.get(1).map_or(kernels::NO_ROW << 16, |row| row << 16)).collect()
    };
    nearest.chunks(width as usize).flat_map(row).collect()
}

fn stacks_of(size: [u32; 2]) -> usize {
    (size[1] * size[0].div_ceil(SHORT.columns)) as usize
}

fn buffers(gpu: &mut Gpu, arrays: [&[u32]; 3]) -> [Buffer<u32>; 3] {
    arrays.map(|array| gpu.buffer(array))
}

/// Workgroups of 32 rows.
const ROWS: (&str, u32) = ("WORKGROUP", 32);

#[test]
fn color_tiles() {
    with_device(|Shared { gpu, .. }| {
        let (mut marked, mut left_over, mut colored) = (0, 0, 0);
        let cases = grids().into_iter().chain([("rings".to_owned(), rings([190, 250], 18.0))]);
        for (turn, (name, sites)) in cases.enumerate() {
            let diagram = reference::color(&sites).unwrap();
            let ([width, height], [across, down]) = (sites.size, tiles_of(sites.size));
            let (input, counts) = ranked(&sites);
            let (bits, ranks) = (gpu.buffer(&input), gpu.buffer(&counts));
            let all_radii: &[u32] = &[0, 4, 8, 16, 28];
            for &radius in if width > 100 { all_radii } else { &all_radii[turn % 5..][..1] } {
                let expected = kernels::color_tiles(&sites, &diagram, radius);
                let blank = vec![UNCOLORED; diagram.colors.len()];
                let [colors, debris_bits, left] =
                    buffers(gpu, [&blank, &vec![0; blank.len().div_ceil(32)], &vec![7; (across * down) as usize]]);
                let [any, left_count, wanted] = buffers(gpu, [&[0], &[0], &vec![0; down as usize]]);
                let arguments = ColorTilesArgs {
                    bits: bits.view(),
                    ranks: ranks.view(),
                    colors: colors.view(),
                    debris_bits: debris_bits.view(),
                    any_debris: any.view(),
                    left: left.view(),
                    left_count: left_count.view(),
                    wanted: wanted.view(),
                    width,
                    height,
                };
                run_with::<ColorTiles>(gpu, &[("RADIUS", radius)], [across, down, 1], &arguments);
                let count = gpu.fetch(left_count.view())[0] as usize;
                let found = kernels::Tiles {
                    colors: gpu.fetch(colors.view()),
                    debris_bits: gpu.fetch(debris_bits.view()),
                    left: sorted(gpu.fetch(left.view())[..count].to_vec()),
                    wanted: gpu.fetch(wanted.view()),
                };
                assert!(found == expected, "{name}, radius {radius}");
                let here: u32 = expected.debris_bits.iter().map(|word| word.count_ones()).sum();
                assert_eq!(gpu.fetch(any.view()), [u32::from(here > 0)], "{name}");
                marked += here;
                left_over += count;
                colored += (across * down) as usize - count;
            }
        }
        assert!(marked > 20 && left_over > 20 && colored > 20, "{marked} {left_over} {colored}");
    });
}

#[test]
fn plan_bands() {
    with_device(|Shared { gpu, .. }| {
        for left in [0, 1, 65535, 65536, 1 << 20] {
            let wanted = [1, 65535, 65536, 200_000, 3];
            let (left_count, groups) = (gpu.buffer(&[left]), gpu.buffer(&[7_u32; 24]));
            let arguments = PlanBandsArgs {
                left_count: left_count.view(),
                groups: groups.view(),
                column_groups: wanted[0],
                fill_groups: wanted[1],
                stack_groups: wanted[2],
                merge_groups: wanted[3],
                row_groups: wanted[4],
            };
            run::<PlanBands>(gpu, 1, &arguments);
            let found: Vec<[u32; 3]> =
                gpu.fetch(groups.view()).chunks(4).map(|size| [size[0], size[1], size[2]]).collect();
            assert_eq!(found, kernels::plan_bands(left, wanted), "{left}");
        }
    });
}

#[test]
fn column_ends() {
    with_device(|Shared { gpu, .. }| {
        for (name, sites) in grids() {
            let ([width, height], band) = (sites.size, SHORT.rows);
            let count = (width * height.div_ceil(band)) as usize;
            let (input, _) = ranked(&sites);
            let (bits, ends) = (gpu.buffer(&input), gpu.buffer(&vec![7_u32; count]));
            let arguments = ColumnEndsArgs { bits: bits.view(), ends: ends.view(), width, height, band };
            run::<ColumnEnds>(gpu, count, &arguments);
            assert_eq!(gpu.fetch(ends.view()), kernels::column_ends(&input, sites.size, band), "{name}");
        }
    });
}

#[test]
fn column_fill() {
    with_device(|Shared { gpu, .. }| {
        for (turn, (name, sites)) in grids().into_iter().enumerate() {
            let ([width, height], band) = (sites.size, SHORT.rows);
            let (input, _) = ranked(&sites);
            let (found, wanted_rows) = (kernels::column_ends(&input, sites.size, band), wanted_of(turn, sites.size));
            let expected = halves(&kernels::column_fill(&input, sites.size), width);
            let [bits, ends, nearest] = buffers(gpu, [&input, &found, &vec![7; expected.len()]]);
            let wanted = gpu.buffer(&wanted_rows);
            let arguments = ColumnFillArgs {
                bits: bits.view(),
                ends: ends.view(),
                wanted: wanted.view(),
                nearest: nearest.view(),
                width,
                height,
                band,
            };
            run::<ColumnFill>(gpu, (width.div_ceil(2) * height.div_ceil(band)) as usize, &arguments);
            let rows = gpu.fetch(nearest.view());
            let pitch = width.div_ceil(2) as usize;
            for (y, (row, expected)) in rows.chunks(pitch).zip(expected.chunks(pitch)).enumerate() {
                // A band has rows of tiles beside the wanted one as well.
                assert!(row == expected || !is_wanted(&wanted_rows, y), "{name}, row {y}");
            }
        }
    });
}

#[test]
fn row_stacks() {
    with_device(|Shared { gpu, .. }| {
        for (turn, (name, sites)) in grids().into_iter().enumerate() {
            let ([width, height], band) = (sites.size, SHORT.columns);
            let near = kernels::column_fill(&ranked(&sites).0, sites.size);
            let count = stacks_of(sites.size);
            let [nearest, entries, live] = buffers(gpu, [&halves(&near, width), &vec![0; near.len()], &vec![7; count]]);
            let wanted_rows = wanted_of(turn, sites.size);
            let wanted = gpu.buffer(&wanted_rows);
            let arguments = RowStacksArgs {
                nearest: nearest.view(),
                wanted: wanted.view(),
                entries: entries.view(),
                live: live.view(),
                width,
                height,
            };
            let bands = width.div_ceil(band);
            run_with::<RowStacks>(gpu, &[ROWS, ("BAND", band)], [bands, height.div_ceil(ROWS.1), 1], &arguments);
            let (expected, expected_live) = kernels::row_stacks(&near, sites.size, band);
            let (found, found_live) = (gpu.fetch(entries.view()), gpu.fetch(live.view()));
            for (stack, word) in expected_live.iter().enumerate() {
                let y = stack / bands as usize;
                if is_wanted(&wanted_rows, y) {
                    let start = y * width as usize + stack % bands as usize * band as usize;
                    let end = start + (word >> 8) as usize;
                    assert_eq!((found_live[stack], &found[start..end]), (*word, &expected[start..end]), "{name}");
                }
            }
        }
    });
}

#[test]
fn row_merge() {
    with_device(|Shared { gpu, .. }| {
        for (turn, (name, sites)) in grids().into_iter().enumerate() {
            let ([width, height], band) = (sites.size, SHORT.columns);
            let near = kernels::column_fill(&ranked(&sites).0, sites.size);
            let wanted_rows = wanted_of(turn, sites.size);
            let wanted = gpu.buffer(&wanted_rows);
            let bands = width.div_ceil(band);
            // All at once, and in two turns.
            for groups in [&[bands][..], &[3, bands]] {
                let (mut stacks, mut words) = kernels::row_stacks(&near, sites.size, band);
                let [nearest, entries, live] = buffers(gpu, [&halves(&near, width), &stacks, &words]);
                let starts = gpu.buffer(&vec![7_u32; words.len()]);
                let mut unit = 1;
                for &group in groups {
                    let arguments = RowMergeArgs {
                        nearest: nearest.view(),
                        wanted: wanted.view(),
                        entries: entries.view(),
                        live: live.view(),
                        starts: starts.view(),
                        width,
                        height,
                        band,
                        unit,
                        group,
                    };
                    run::<RowMerge>(gpu, (height * bands.div_ceil(group)) as usize, &arguments);
                    unit = group.min(bands);
                    let expected = kernels::row_merge(&near, sites.size, [band, group], &mut stacks, &mut words, 7);
                    let (found, found_live, begins) =
                        (gpu.fetch(entries.view()), gpu.fetch(live.view()), gpu.fetch(starts.view()));
                    for (stack, word) in words.iter().enumerate() {
                        let (y, b) = (stack / bands as usize, stack % bands as usize);
                        if !is_wanted(&wanted_rows, y) {
                            assert_eq!(begins[stack], 7, "{name}");
                            continue;
                        }
                        assert_eq!((begins[stack], found_live[stack]), (expected[stack], *word), "{name}");
                        // An entry that has been left as the first for a while, and was taken off later, keeps what it had.
                        let start = y * width as usize + b * band as usize;
                        let (first, end) = (start + (word & 0xff) as usize, start + (word >> 8 & 0xff) as usize);
                        assert_eq!(found[first..end], stacks[first..end], "{name}");
                    }
                    if group >= bands {
                        break;
                    }
                }
            }
        }
    });
}

#[test]
fn color_pixels() {
    with_device(|Shared { gpu, .. }| {
        for (turn, (name, sites)) in grids().into_iter().enumerate() {
            let ([width, height], band) = (sites.size, SHORT.columns);
            let (input, counts) = ranked(&sites);
            let near = kernels::column_fill(&input, sites.size);
            let (mut stacks, mut words) = kernels::row_stacks(&near, sites.size, band);
            let all = width.div_ceil(band);
            let begins = kernels::row_merge(&near, sites.size, [band, all], &mut stacks, &mut words, 0);
            let [across, down] = tiles_of(sites.size);
            // All of them, in any order; or every other one.
            let tiles: Vec<u32> = (0..across * down).rev().filter(|tile| turn % 2 == 0 || tile % 2 == 0).collect();
            let [bits, ranks, nearest] = buffers(gpu, [&input, &counts, &halves(&near, width)]);
            let [entries, live, starts] = buffers(gpu, [&stacks, &words, &begins]);
            let [left, left_count, colors] =
                buffers(gpu, [&tiles, &[tiles.len() as u32], &vec![UNCOLORED; near.len()]]);
            let arguments = ColorPixelsArgs {
                bits: bits.view(),
                ranks: ranks.view(),
                nearest: nearest.view(),
                entries: entries.view(),
                live: live.view(),
                starts: starts.view(),
                left: left.view(),
                left_count: left_count.view(),
                colors: colors.view(),
                width,
                height,
                band,
            };
            run_with::<ColorPixels>(gpu, &[], groups_for(tiles.len() + 1, 1), &arguments);
            let expected = kernels::color_pixels(&sites, &near, &stacks, &words, &tiles, band);
            assert_eq!(gpu.fetch(colors.view()), expected, "{name}");
            if turn % 2 == 0 {
                assert_eq!(expected, reference::color(&sites).unwrap().colors, "{name}: the steps together");
            }
        }
    });
}
