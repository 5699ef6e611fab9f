//! Each kernel of stage 2 against the reference of its name, bit for bit.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod voronoi_gpu_support;
mod vulkan_support;

use polder_dualize::gpu::dualize::{count_groups, words_of, write_groups};
use polder_dualize::kernels::*;
use polder_dualize::reference::kernels::dualize as expected;
use polder_flip::gpu::Mesh;
use polder_tests::families;
use polder_voronoi::{Diagram, Options, Sites, reference};
use polder_vulkan::{Kernel, Shader};
use voronoi_gpu_support::{grids, with_device};
use vulkan_support::{Gpu, words};

const NONE: u32 = u32::MAX;

/// Runs one kernel.
fn run<S: Shader>(gpu: &mut Gpu, groups: [u32; 3], arguments: &S::Args<'_>) {
    let kernel = Kernel::<S>::new(&gpu.device, &[]).unwrap();
    let mut recording = gpu.recording();
    recording.dispatch(&kernel, groups, arguments);
    gpu.run(&recording);
}

/// Flooded diagrams of every family and of grids of every shape, and colorings that no flooding gives.
fn diagrams() -> Vec<(String, Diagram, Sites)> {
    let mut all = Vec::new();
    for (name, pslg) in families(700, 5) {
        let output = reference::diagram(pslg.points(), &Options::default()).unwrap();
        all.push((name.to_owned(), output.diagram, output.sites));
    }
    for (name, sites) in grids() {
        all.push((name, reference::flooding::flood(&sites).unwrap().diagram, sites));
    }
    for seed in 0..12 {
        let size = [1 + seed as u32 * 7 % 70, 1 + seed as u32 * 13 % 50];
        let sites = voronoi_gpu_support::anywhere(size, 1 + seed as usize, seed);
        let colors = words(seed, (size[0] * size[1]) as usize).iter().map(|w| w % (sites.count as u32 + 1)).collect();
        let diagram = Diagram { width: size[0], height: size[1], colors, debris: Vec::new() };
        all.push((format!("random colors, {size:?}"), diagram, sites));
    }
    all
}

#[test]
fn dualize_count() {
    with_device(|shared| {
        let gpu = &mut shared.gpu;
        let (mut necks, mut crossings, mut uncolored) = (0, 0, 0);
        for (name, diagram, sites) in diagrams() {
            let count = words_of([diagram.width, diagram.height]);
            let (colors, sites_word) = (gpu.buffer(&diagram.colors), gpu.buffer(&[sites.count as u32]));
            let (vertices, counts) = (gpu.buffer(&vec![[7_u32; 2]; count]), gpu.buffer(&vec![7_u32; count]));
            let (neck_word, ghost_word) = (gpu.buffer(&[0_u32]), gpu.buffer(&[0_u32]));
            let (crossing_word, uncolored_word) = (gpu.buffer(&[NONE]), gpu.buffer(&[NONE]));
            let arguments = DualizeCountArgs {
                colors: colors.view(),
                sites: sites_word.view(),
                vertices: vertices.view().cast(),
                counts: counts.view(),
                necks: neck_word.view(),
                ghosts: ghost_word.view(),
                crossing: crossing_word.view(),
                uncolored: uncolored_word.view(),
                width: diagram.width,
                height: diagram.height,
            };
            run::<DualizeCount>(gpu, count_groups([diagram.width, diagram.height]), &arguments);
            let expected = expected::dualize_count(&diagram, sites.count as u32);
            assert!(gpu.fetch(vertices.view()) == expected.vertices, "{name}: vertices");
            assert!(gpu.fetch(counts.view()) == expected.counts, "{name}: counts");
            let found = [neck_word, ghost_word, crossing_word, uncolored_word].map(|word| gpu.fetch(word.view())[0]);
            let wanted = [expected.necks, expected.ghosts, expected.crossing, expected.uncolored];
            assert_eq!(found, wanted, "{name}");
            necks += expected.necks;
            crossings += u32::from(expected.crossing != NONE);
            uncolored += u32::from(expected.uncolored != NONE);
        }
        assert!(necks > 0 && crossings > 0 && uncolored > 0, "{necks} {crossings} {uncolored} show nothing");
    });
}

#[test]
fn dualize_check() {
    with_device(|shared| {
        let gpu = &mut shared.gpu;
        let mut good = 0;
        for sites in [0, 1, 2, 3, 1000, 1 << 29] {
            let right: u32 = if sites < 2 { 0 } else { 2 * sites - 2 };
            for total in [right, right + 1, right.wrapping_sub(1)] {
                for (crossing, uncolored) in [(NONE, NONE), (3, NONE), (NONE, 0)] {
                    for limit in [1 << 30, right, right.saturating_sub(1)] {
                        let words = [sites, total, crossing, uncolored].map(|word| gpu.buffer(&[word]));
                        let slots = gpu.buffer(&[7_u32]);
                        let arguments = DualizeCheckArgs {
                            sites: words[0].view(),
                            total: words[1].view(),
                            crossing: words[2].view(),
                            uncolored: words[3].view(),
                            slots: slots.view(),
                            limit,
                        };
                        run::<DualizeCheck>(gpu, [1, 1, 1], &arguments);
                        let wanted = expected::dualize_check(sites, total, crossing, uncolored, limit);
                        assert_eq!(gpu.fetch(slots.view()), [wanted], "{sites} {total} {limit}");
                        good += u32::from(wanted > 0);
                    }
                }
            }
        }
        assert!(good > 0);
    });
}

#[test]
fn dualize_write() {
    with_device(|shared| {
        let gpu = &mut shared.gpu;
        let (mut folded, mut lines) = (0, 0);
        for (turn, (name, diagram, sites)) in diagrams().into_iter().enumerate() {
            let counted = expected::dualize_count(&diagram, sites.count as u32);
            if counted.crossing != NONE || counted.uncolored != NONE {
                continue;
            }
            let (first, slots) = polder_vulkan::reference::exclusive_scan(&counted.counts);
            // Every other diagram gets its sites in strange places, so that some triangles are not counterclockwise.
            let mut pixels = sites.pixels.clone();
            if turn % 2 == 1 {
                pixels.iter_mut().zip(words(turn as u64, sites.count)).for_each(|(pixel, w)| {
                    *pixel = [(w % 32768) as u16, (w >> 17) as u16];
                });
            }
            let colors = gpu.buffer(&diagram.colors);
            let (places, vertices) = (gpu.buffer(&pixels), gpu.buffer(&counted.vertices));
            let first_buffer = gpu.buffer(&first);
            let room = slots as usize + 1;
            let mesh = Mesh::with_slots(&gpu.device, 0, room).unwrap();
            gpu.engine.upload(mesh.records(), &vec![[7; 8]; room]).unwrap();
            gpu.engine.upload(mesh.slots().slice(0..1).unwrap(), &[slots]).unwrap();
            let (lost_word, folded_word) = (gpu.buffer(&[NONE]), gpu.buffer(&[NONE]));
            let (far, far_word) = (gpu.buffer(&[[7_u32; 2]]), gpu.buffer(&[0_u32]));
            let arguments = DualizeWriteArgs {
                colors: colors.view(),
                pixels: places.view().cast(),
                vertices: vertices.view().cast(),
                first: first_buffer.view(),
                slots: mesh.slots(),
                triangles: mesh.corners(),
                links: mesh.twins(),
                lost: lost_word.view(),
                folded: folded_word.view(),
                far: far.view().cast(),
                far_count: far_word.view(),
                width: diagram.width,
                height: diagram.height,
                // All borders are followed here.
                far_limit: 0,
            };
            run::<DualizeWrite>(gpu, write_groups([diagram.width, diagram.height]), &arguments);
            let expected = expected::dualize_write(&diagram, &pixels, &counted.vertices, &first, slots);
            let found = [lost_word, folded_word].map(|word| gpu.fetch(word.view())[0]);
            assert_eq!(found, [expected.lost, expected.folded], "{name}");
            lines += u32::from(slots > 0 && expected.mesh.finite().next().is_none());
            let rows = expected.mesh.triangles.iter().zip(&expected.mesh.links);
            let mut records: Vec<_> = rows.map(|([a, b, c], [f, g, h])| [*a, *b, *c, NONE, *f, *g, *h, NONE]).collect();
            records.push([7; 8]);
            assert!(gpu.fetch(mesh.records()) == records, "{name}");
            assert_eq!(gpu.fetch(far.view()), [[7; 2]]);
            folded += u32::from(expected.folded != NONE);
        }
        assert!(folded > 10 && lines > 10, "{folded} {lines} show nothing");
    });
}

/// Long borders are listed with the corner that they have come to, as many as there is room for, and each leads from there to
/// the half-edge that it would have been linked to.
#[test]
fn dualize_leap() {
    with_device(|shared| {
        let gpu = &mut shared.gpu;
        let (mut leaps, mut full) = (0, 0);
        let sparse = [([300, 200], 9), ([700, 500], 40), ([1, 900], 3), ([900, 2], 7), ([400, 400], 2)];
        let sparse = sparse.map(|(size, count)| {
            let sites = voronoi_gpu_support::anywhere(size, count, 3);
            (format!("{count} on {size:?}"), reference::flooding::flood(&sites).unwrap().diagram, sites)
        });
        let flooded = diagrams().into_iter().filter(|(name, ..)| !name.contains("random"));
        for (turn, (name, diagram, sites)) in sparse.into_iter().chain(flooded).enumerate() {
            let counted = expected::dualize_count(&diagram, sites.count as u32);
            let (first, slots) = polder_vulkan::reference::exclusive_scan(&counted.counts);
            let whole = expected::dualize_write(&diagram, &sites.pixels, &counted.vertices, &first, slots);
            let room = [1000, 3][turn % 2];
            let (colors, places) = (gpu.buffer(&diagram.colors), gpu.buffer(&sites.pixels));
            let (vertices, first_buffer) = (gpu.buffer(&counted.vertices), gpu.buffer(&first));
            let (slots_word, lost, folded) = (gpu.buffer(&[slots]), gpu.buffer(&[NONE]), gpu.buffer(&[NONE]));
            let mesh = Mesh::with_slots(&gpu.device, 0, slots as usize).unwrap();
            let (far, far_word) = (gpu.buffer(&vec![[7_u32; 2]; room]), gpu.buffer(&[0_u32]));
            let arguments = DualizeWriteArgs {
                colors: colors.view(),
                pixels: places.view().cast(),
                vertices: vertices.view().cast(),
                first: first_buffer.view(),
                slots: slots_word.view(),
                triangles: mesh.corners(),
                links: mesh.twins(),
                lost: lost.view(),
                folded: folded.view(),
                far: far.view().cast(),
                far_count: far_word.view(),
                width: diagram.width,
                height: diagram.height,
                far_limit: room as u32,
            };
            run::<DualizeWrite>(gpu, write_groups([diagram.width, diagram.height]), &arguments);
            let listed = gpu.fetch(far_word.view())[0] as usize;
            let list = gpu.fetch(far.view())[..listed.min(room)].to_vec();
            let arguments = DualizeLeapArgs {
                colors: colors.view(),
                pixels: places.view().cast(),
                vertices: vertices.view().cast(),
                first: first_buffer.view(),
                triangles: mesh.corners(),
                links: mesh.twins(),
                lost: lost.view(),
                far: far.view().cast(),
                far_count: far_word.view(),
                width: diagram.width,
                height: diagram.height,
                far_limit: room as u32,
            };
            run::<DualizeLeap>(gpu, [3, 1, 1], &arguments);
            let found: Vec<_> = gpu.fetch(mesh.records()).iter().map(|&[.., f, g, h, _]| [f, g, h]).collect();
            for (h, link) in expected::dualize_leap(&diagram, &counted.vertices, &first, &list) {
                assert_eq!(Some(found.as_flattened()[h as usize]), link, "{name}: {h}");
            }
            assert!(found == whole.mesh.links, "{name}: links");
            assert_eq!(gpu.fetch(lost.view()), [NONE]);
            leaps += list.len();
            full += usize::from(listed > room);
        }
        assert!(leaps > 200 && full > 3, "{leaps} {full} show nothing");
    });
}
