//! The kernels of the coloring.

use super::*;

/// A grid with the site numbers of its pixels.
fn grid_of(sites: &Sites) -> Vec<u32> {
    let mut grid = vec![NONE; (sites.size[0] * sites.size[1]) as usize];
    kernels::place_sites(&sites.pixels[..sites.count], sites.size[0], &mut grid);
    grid
}

fn stacks_of(size: [u32; 2]) -> usize {
    (size[1] * size[0].div_ceil(SHORT.columns)) as usize
}

fn buffers(gpu: &mut Gpu, arrays: [&[u32]; 3]) -> [Buffer<u32>; 3] {
    arrays.map(|array| gpu.buffer(array))
}

#[test]
fn place_sites() {
    with_device(|Shared { gpu, .. }| {
        for (name, sites) in grids() {
            let pixels = gpu.buffer(&words_of(&sites.pixels));
            let (counter, expected) = (gpu.buffer(&[sites.count as u32]), grid_of(&sites));
            let grid = gpu.buffer(&vec![NONE; expected.len()]);
            let arguments = PlaceSitesArgs {
                sites: pixels.view(),
                grid: grid.view(),
                counter: Some(counter.view()),
                limit: sites.pixels.len() as u32,
                width: sites.size[0],
            };
            run::<PlaceSites>(gpu, sites.pixels.len(), &arguments);
            assert_eq!(gpu.fetch(grid.view()), expected, "{name}");
        }
    });
}

#[test]
fn column_ends() {
    with_device(|Shared { gpu, .. }| {
        for (name, sites) in grids() {
            let ([width, height], band) = (sites.size, SHORT.rows);
            let count = (width * height.div_ceil(band)) as usize;
            let placed = grid_of(&sites);
            let (grid, ends) = (gpu.buffer(&placed), gpu.buffer(&vec![7_u32; count]));
            let arguments = ColumnEndsArgs { grid: grid.view(), ends: ends.view(), width, height, band };
            run::<ColumnEnds>(gpu, count, &arguments);
            assert_eq!(gpu.fetch(ends.view()), kernels::column_ends(&placed, sites.size, band), "{name}");
        }
    });
}

#[test]
fn column_fill() {
    with_device(|Shared { gpu, .. }| {
        for (name, sites) in grids() {
            let ([width, height], band) = (sites.size, SHORT.rows);
            let placed = grid_of(&sites);
            let found = kernels::column_ends(&placed, sites.size, band);
            let [grid, ends, nearest] = buffers(gpu, [&placed, &found, &vec![7; placed.len()]]);
            let (grid, ends) = (grid.view(), ends.view());
            let arguments = ColumnFillArgs { grid, ends, nearest: nearest.view(), width, height, band };
            run::<ColumnFill>(gpu, found.len(), &arguments);
            assert_eq!(gpu.fetch(nearest.view()), kernels::column_fill(&placed, sites.size), "{name}");
        }
    });
}

#[test]
fn row_stacks() {
    with_device(|Shared { gpu, .. }| {
        for (name, sites) in grids() {
            let ([width, height], band) = (sites.size, SHORT.columns);
            let near = kernels::column_fill(&grid_of(&sites), sites.size);
            let count = stacks_of(sites.size);
            let [nearest, entries, live] = buffers(gpu, [&near, &vec![0; near.len()], &vec![7; count]]);
            let arguments = RowStacksArgs {
                nearest: nearest.view(),
                entries: entries.view(),
                live: live.view(),
                width,
                height,
                band,
            };
            run::<RowStacks>(gpu, count, &arguments);
            let (expected, expected_live) = kernels::row_stacks(&near, sites.size, band);
            assert_eq!(gpu.fetch(live.view()), expected_live, "{name}");
            // What the kernel took off again still stands behind a stack's end.
            let found = gpu.fetch(entries.view());
            for (stack, word) in expected_live.iter().enumerate() {
                let bands = width.div_ceil(band) as usize;
                let start = stack / bands * width as usize + stack % bands * band as usize;
                let end = start + (word >> 8) as usize;
                assert_eq!(found[start..end], expected[start..end], "{name}");
            }
        }
    });
}

#[test]
fn row_merge() {
    with_device(|Shared { gpu, .. }| {
        for (name, sites) in grids() {
            let ([width, height], band) = (sites.size, SHORT.columns);
            let near = kernels::column_fill(&grid_of(&sites), sites.size);
            let (mut stacks, mut words) = kernels::row_stacks(&near, sites.size, band);
            let [nearest, entries, live] = buffers(gpu, [&near, &stacks, &words]);
            let starts = gpu.buffer(&vec![7_u32; words.len()]);
            let arguments = RowMergeArgs {
                nearest: nearest.view(),
                entries: entries.view(),
                live: live.view(),
                starts: starts.view(),
                width,
                height,
                band,
            };
            run::<RowMerge>(gpu, height as usize, &arguments);
            let expected = kernels::row_merge(&near, sites.size, band, &mut stacks, &mut words);
            assert_eq!(gpu.fetch(starts.view()), expected, "{name}");
            assert_eq!(gpu.fetch(live.view()), words, "{name}");
            // An entry that has been left as the first for a while, and was taken off later, keeps what it had then.
            let found = gpu.fetch(entries.view());
            for (stack, word) in words.iter().enumerate() {
                let bands = width.div_ceil(band) as usize;
                let start = stack / bands * width as usize + stack % bands * band as usize;
                let (first, end) = (start + (word & 0xff) as usize, start + (word >> 8 & 0xff) as usize);
                assert_eq!(found[first..end], stacks[first..end], "{name}");
            }
        }
    });
}

#[test]
fn color_pixels() {
    with_device(|Shared { gpu, .. }| {
        for (name, sites) in grids() {
            let ([width, height], band) = (sites.size, SHORT.columns);
            let placed = grid_of(&sites);
            let near = kernels::column_fill(&placed, sites.size);
            let (mut stacks, mut words) = kernels::row_stacks(&near, sites.size, band);
            let begins = kernels::row_merge(&near, sites.size, band, &mut stacks, &mut words);
            let [grid, nearest, entries] = buffers(gpu, [&placed, &near, &stacks]);
            let [live, starts, colors] = buffers(gpu, [&words, &begins, &vec![7; placed.len()]]);
            let arguments = ColorPixelsArgs {
                grid: grid.view(),
                nearest: nearest.view(),
                entries: entries.view(),
                live: live.view(),
                starts: starts.view(),
                colors: colors.view(),
                width,
                height,
                band,
            };
            run::<ColorPixels>(gpu, placed.len(), &arguments);
            let expected = kernels::color_pixels(&placed, &near, &stacks, &words, sites.size, band);
            assert_eq!(gpu.fetch(colors.view()), expected, "{name}");
            assert_eq!(expected, reference::color(&sites).unwrap().colors, "{name}: the steps together");
        }
    });
}
