//! Each kernel of the canonical order against the reference of its name, bit for bit.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod finish_gpu_support;
mod vulkan_support;

use finish_gpu_support::{Case, OnDevice, Shared, cases, hub, with_device};
use polder_canonical::kernels::*;
use polder_canonical::reference::kernels::{self, Lists};
use polder_canonical::reference::{self, Check};
use polder_flip::gpu::Arithmetic;
use polder_mesh::NONE;
use polder_vulkan::{Kernel, Shader, groups_for};
use vulkan_support::{Gpu, words};

/// Runs one kernel over so many items.
fn run<S: Shader>(gpu: &mut Gpu, items: usize, constants: &[(&'static str, u32)], arguments: &S::Args<'_>) {
    let kernel = Kernel::<S>::new(&gpu.device, constants).unwrap();
    let mut recording = gpu.recording();
    recording.dispatch(&kernel, groups_for(items, 256), arguments);
    gpu.run(&recording);
}

/// A case, and all that the references make of it up to the lists.
struct Steps {
    case: Case,
    names: Vec<u32>,
    representatives: Vec<u32>,
    counts: Vec<u32>,
    ghosts: u32,
    places: Vec<u32>,
    starts: Vec<u32>,
    named_starts: Vec<u32>,
    list: Vec<u32>,
    keys: Vec<u32>,
}

fn scanned(counts: &[u32]) -> Vec<u32> {
    let sum = |sum: &mut u32, &count: &u32| Some(std::mem::replace(sum, *sum + count));
    counts.iter().scan(0, sum).collect()
}

impl Steps {
    fn of(case: Case) -> Steps {
        let (mut names, mut representatives) = kernels::start_names(&case.order);
        kernels::elect_names(&case.vertex_of, &case.order, &mut names);
        kernels::name_points(&case.vertex_of, &case.order, &names, &mut representatives);
        let (places, counts, ghosts) = kernels::count_triangles(&case.mesh, &names);
        let starts = scanned(&counts);
        let mut named = vec![0; names.len()];
        kernels::spread_counts(&starts, &names, &mut named);
        let named_starts = scanned(&named);
        let (list, keys) = kernels::list_triangles(&case.mesh, &names, &places, &starts);
        Steps { case, names, representatives, counts, ghosts, places, starts, named_starts, list, keys }
    }

    fn lists(&self) -> Lists<'_> {
        Lists { starts: &self.starts, named_starts: &self.named_starts, list: &self.list, keys: &self.keys }
    }

    fn points(&self) -> usize {
        self.names.len()
    }
}

/// Runs a test on every case that has points.
fn with_steps(mut test: impl FnMut(&mut Gpu, &Steps, &OnDevice)) {
    with_device(|Shared { gpu, .. }| {
        let all = cases(400, 51).into_iter().chain([hub(700)]);
        for case in all.filter(|case| !case.order.is_empty()) {
            let on_device = case.upload(gpu);
            test(gpu, &Steps::of(case), &on_device);
        }
    });
}

#[test]
fn start_names() {
    with_steps(|gpu, steps, on_device| {
        let count = steps.points();
        let (names, representatives) = (gpu.buffer(&vec![7; count]), gpu.buffer(&vec![7; count]));
        let (order, count) = (on_device.order.view(), count as u32);
        let arguments = StartNamesArgs { order, names: names.view(), representatives: representatives.view(), count };
        run::<StartNames>(gpu, steps.points(), &[], &arguments);
        let expected = kernels::start_names(&steps.case.order);
        assert_eq!((gpu.fetch(names.view()), gpu.fetch(representatives.view())), expected, "{}", steps.case.name);
    });
}

#[test]
fn elect_names() {
    with_steps(|gpu, steps, on_device| {
        let names = gpu.buffer(&steps.case.order);
        let (vertex_of, order) = (on_device.vertex_of.view(), on_device.order.view());
        let arguments = ElectNamesArgs { vertex_of, order, names: names.view(), count: steps.points() as u32 };
        run::<ElectNames>(gpu, steps.points(), &[], &arguments);
        assert_eq!(gpu.fetch(names.view()), steps.names, "{}", steps.case.name);
    });
}

#[test]
fn name_points() {
    with_steps(|gpu, steps, on_device| {
        let names = gpu.buffer(&steps.names);
        let identity: Vec<u32> = (0..steps.points() as u32).collect();
        let (representatives, duplicates) = (gpu.buffer(&identity), gpu.buffer(&[5_u32]));
        let arguments = NamePointsArgs {
            vertex_of: on_device.vertex_of.view(),
            order: on_device.order.view(),
            names: names.view(),
            representatives: representatives.view(),
            duplicates: duplicates.view(),
            count: steps.points() as u32,
        };
        run::<NamePoints>(gpu, steps.points(), &[], &arguments);
        assert_eq!(gpu.fetch(representatives.view()), steps.representatives, "{}", steps.case.name);
        let expected = steps.points() as u32 - steps.case.vertices();
        assert_eq!(gpu.fetch(duplicates.view()), [5 + expected], "{}", steps.case.name);
    });
}

#[test]
fn count_triangles() {
    with_steps(|gpu, steps, on_device| {
        let slots = steps.case.mesh.slots();
        let (names, counts) = (gpu.buffer(&steps.names), gpu.buffer(&vec![0; steps.points() + 1]));
        let (places, ghosts) = (gpu.buffer(&vec![7; slots]), gpu.buffer(&[5_u32]));
        let arguments = CountTrianglesArgs {
            triangles: on_device.mesh.corners(),
            names: names.view(),
            counts: counts.view(),
            places: places.view(),
            ghosts: ghosts.view(),
            counter: Some(on_device.mesh.slots()),
            limit: on_device.mesh.capacity() as u32,
            count: steps.points() as u32,
        };
        run::<CountTriangles>(gpu, on_device.mesh.capacity(), &[], &arguments);
        let name = &steps.case.name;
        assert_eq!(gpu.fetch(counts.view()), steps.counts, "{name}");
        assert_eq!(gpu.fetch(ghosts.view()), [5 + steps.ghosts], "{name}");
        // The same corners; the places of each list in some order.
        let found = gpu.fetch(places.view());
        let corner = |&place: &u32| if place == NONE { NONE } else { place & 3 };
        assert!(found.iter().map(corner).eq(steps.places.iter().map(corner)), "{name}");
        let listed = |places: &[u32]| {
            let slots = (0..slots).filter(|&t| places[t] != NONE);
            let mut all: Vec<[u32; 2]> =
                slots.map(|t| [steps.case.mesh.triangles[t][places[t] as usize & 3], places[t] >> 2]).collect();
            all.sort_unstable();
            all
        };
        assert_eq!(listed(&found), listed(&steps.places), "{name}");
    });
}

#[test]
fn spread_counts() {
    with_steps(|gpu, steps, _| {
        let (names, starts) = (gpu.buffer(&steps.names), gpu.buffer(&steps.starts));
        let named_counts = gpu.buffer(&vec![0; steps.points()]);
        let arguments = SpreadCountsArgs {
            starts: starts.view(),
            names: names.view(),
            named_counts: named_counts.view(),
            count: steps.points() as u32,
        };
        run::<SpreadCounts>(gpu, steps.points(), &[], &arguments);
        let mut expected = vec![0; steps.points()];
        kernels::spread_counts(&steps.starts, &steps.names, &mut expected);
        assert_eq!(gpu.fetch(named_counts.view()), expected, "{}", steps.case.name);
    });
}

#[test]
fn list_triangles() {
    with_steps(|gpu, steps, on_device| {
        let (names, starts, places) = (gpu.buffer(&steps.names), gpu.buffer(&steps.starts), gpu.buffer(&steps.places));
        let (list, keys) = (gpu.buffer(&vec![7; steps.list.len()]), gpu.buffer(&vec![7; steps.list.len()]));
        let arguments = ListTrianglesArgs {
            triangles: on_device.mesh.corners(),
            names: names.view(),
            places: places.view(),
            starts: starts.view(),
            list: list.view(),
            keys: keys.view(),
            counter: Some(on_device.mesh.slots()),
            limit: on_device.mesh.capacity() as u32,
        };
        run::<ListTriangles>(gpu, on_device.mesh.capacity(), &[], &arguments);
        assert_eq!(gpu.fetch(list.view()), steps.list, "{}", steps.case.name);
        assert_eq!(gpu.fetch(keys.view()), steps.keys, "{}", steps.case.name);
    });
}

#[test]
fn place_triangles() {
    with_steps(|gpu, steps, _| {
        let [names, starts, named_starts, list, keys] =
            [&steps.names, &steps.starts, &steps.named_starts, &steps.list, &steps.keys].map(|data| gpu.buffer(data));
        for longest in [0, 1, 2, 64] {
            let places = gpu.buffer(&steps.places);
            let (long_lists, long_count) = (gpu.buffer(&vec![NONE; steps.points()]), gpu.buffer(&[0_u32]));
            let arguments = PlaceTrianglesArgs {
                names: names.view(),
                starts: starts.view(),
                named_starts: named_starts.view(),
                list: list.view(),
                keys: keys.view(),
                places: places.view(),
                long_lists: long_lists.view(),
                long_count: long_count.view(),
                count: steps.points() as u32,
                longest,
            };
            run::<PlaceTriangles>(gpu, steps.points(), &[], &arguments);
            let mut expected = steps.places.clone();
            let (mesh, lists) = (&steps.case.mesh, steps.lists());
            let long = kernels::place_triangles(mesh, &steps.names, lists, longest as usize, &mut expected);
            assert_eq!(gpu.fetch(places.view()), expected, "{}", steps.case.name);
            let mut found = gpu.fetch(long_lists.view());
            found.truncate(gpu.fetch(long_count.view())[0] as usize);
            found.sort_unstable();
            assert_eq!(found, long, "{}", steps.case.name);
        }
    });
}

#[test]
fn sort_long() {
    with_steps(|gpu, steps, _| {
        let all: Vec<u32> = (0..steps.points() as u32).filter(|&v| steps.counts[v as usize] > 0).collect();
        let (long, count) = (gpu.buffer(&all), gpu.buffer(&[all.len() as u32]));
        let [names, starts, named_starts] =
            [&steps.names, &steps.starts, &steps.named_starts].map(|data| gpu.buffer(data));
        let mut expected = steps.places.clone();
        kernels::sort_long(&all, &steps.names, steps.lists(), &mut expected);
        let limits = gpu.device.info().limits;
        for (workgroup, passes) in [(limits.subgroup, 4), (256, 8), (limits.workgroup_invocations, 4)] {
            let [list, keys, other_list, other_keys, places] =
                [&steps.list, &steps.keys, &steps.list, &steps.keys, &steps.places].map(|data| gpu.buffer(data));
            let arguments = SortLongArgs {
                long_lists: long.view(),
                long_count: count.view(),
                names: names.view(),
                starts: starts.view(),
                named_starts: named_starts.view(),
                list: list.view(),
                keys: keys.view(),
                other_list: other_list.view(),
                other_keys: other_keys.view(),
                places: places.view(),
                passes,
            };
            // A workgroup for each, and some more.
            run::<SortLong>(gpu, (all.len() + 3) * 256, &[("WORKGROUP", workgroup)], &arguments);
            assert_eq!(gpu.fetch(places.view()), expected, "{}, {workgroup}", steps.case.name);
            // Lists are sorted, and keys have stayed with their entries.
            let (list, keys) = (gpu.fetch(list.view()), gpu.fetch(keys.view()));
            let pairs = |list: &[u32], keys: &[u32], v: u32| {
                let range = steps.starts[v as usize] as usize..steps.starts[v as usize + 1] as usize;
                keys[range.clone()].iter().copied().zip(list[range].iter().copied()).collect::<Vec<_>>()
            };
            for &v in &all {
                let mut sorted = pairs(&steps.list, &steps.keys, v);
                sorted.sort_unstable();
                assert_eq!(pairs(&list, &keys, v), sorted, "{}", steps.case.name);
            }
        }
    });
}

#[test]
fn write_triangles() {
    with_steps(|gpu, steps, on_device| {
        let mesh = &steps.case.mesh;
        let mut place = steps.places.clone();
        kernels::place_triangles(mesh, &steps.names, steps.lists(), usize::MAX, &mut place);
        let [names, list, places] = [&steps.names, &steps.list, &place].map(|data| gpu.buffer(data));
        let count = steps.list.len();
        let (sorted, neighbors) = (gpu.buffer(&vec![[7; 3]; count]), gpu.buffer(&vec![[7; 3]; count]));
        let (constrained, finite) = (gpu.buffer(&vec![0; count.div_ceil(4)]), gpu.buffer(&[count as u32]));
        let arguments = WriteTrianglesArgs {
            triangles: on_device.mesh.corners(),
            links: on_device.mesh.twins(),
            names: names.view(),
            list: list.view(),
            places: places.view(),
            sorted: sorted.view().cast(),
            neighbors: neighbors.view().cast(),
            constrained: constrained.view(),
            counter: Some(finite.view()),
            limit: on_device.mesh.capacity() as u32,
            slot_count: on_device.mesh.slots(),
            slot_limit: on_device.mesh.capacity() as u32,
        };
        run::<WriteTriangles>(gpu, 3 * on_device.mesh.capacity(), &[], &arguments);
        let expected = kernels::write_triangles(mesh, &steps.names, &steps.list, &steps.keys, &place);
        let bytes: Vec<u8> = gpu.fetch(constrained.view().cast());
        let found = (gpu.fetch(sorted.view()), gpu.fetch(neighbors.view()), bytes[..count].to_vec());
        assert_eq!(found, expected, "{}", steps.case.name);
    });
}

#[test]
fn check_triangles() {
    with_steps(|gpu, steps, on_device| {
        let capacity = on_device.mesh.capacity();
        let words = gpu.buffer(&[0, 0, 0, 0, NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE, 0, 0, 0, 0_u32]);
        let word = |place: usize| words.slice(4 * place..4 * place + 1).unwrap();
        let finite = steps.case.mesh.finite().next().is_some();
        let finite_count = gpu.buffer(&[u32::from(finite)]);
        let arguments = CheckTrianglesArgs {
            triangles: on_device.mesh.corners(),
            links: on_device.mesh.twins(),
            positions: on_device.mesh.positions().cast(),
            minima: word(0),
            broken: word(1),
            clockwise: word(2),
            reflex: word(3),
            finite: finite_count.view(),
            slot_count: on_device.mesh.slots(),
            limit: capacity as u32,
            vertices: steps.points() as u32,
        };
        let kernel = Arithmetic::Filtered.kernel::<CheckTriangles>(&gpu.device, &[]).unwrap();
        let mut recording = gpu.recording();
        recording.dispatch(&kernel, groups_for(capacity, 256), &arguments);
        gpu.run(&recording);
        let found = gpu.fetch(words.view());
        let found = Check { minima: found[0], broken: found[4], clockwise: found[8], reflex: found[12] };
        let expected = reference::check_triangles(&steps.case.mesh, &steps.case.positions, finite);
        assert_eq!(found, expected, "{}", steps.case.name);
    });
}

#[test]
fn name_chains() {
    with_steps(|gpu, steps, _| {
        let points = steps.points() as u32;
        for constraints in [1_usize, 2, 255, 256, 257, 700] {
            let lengths: Vec<u32> = words(7, constraints).iter().map(|word| 1 + word % 4).chain([0]).collect();
            let starts = scanned(&lengths);
            let total = starts[constraints] as usize;
            // Among them one that is no vertex, and behind them what is not to be touched.
            let mut chains: Vec<u32> = words(8, total + 9).iter().map(|word| word % points).collect();
            chains[total / 2] = points;
            let [names, begins, vertices, counter, through] =
                [&steps.names, &starts, &chains, &vec![total as u32], &vec![3]].map(|data| gpu.buffer(data));
            let arguments = NameChainsArgs {
                names: names.view(),
                starts: begins.view(),
                chains: vertices.view(),
                through: through.view(),
                counter: Some(counter.view()),
                limit: chains.len() as u32,
                constraints: constraints as u32,
                count: points,
            };
            run::<NameChains>(gpu, chains.len().max(constraints), &[], &arguments);
            let expected = kernels::name_chains(&steps.names, &starts, &mut chains[..total]);
            assert_eq!(gpu.fetch(vertices.view()), chains, "{}", steps.case.name);
            assert_eq!(gpu.fetch(through.view()), [3 + expected], "{}", steps.case.name);
        }
    });
}

#[test]
fn count_constrained() {
    with_steps(|gpu, steps, _| {
        let case = &steps.case;
        let result = reference::canonical(&case.mesh, &case.vertex_of, &case.order);
        let count = result.triangles.len();
        // Behind the last triangle anything may stand.
        let mut bits = result.constrained.clone();
        bits.resize(count.next_multiple_of(16) + 16, 7);
        let (bits, neighbors) = (gpu.buffer(&bits), gpu.buffer(&result.neighbors));
        let (edges, counter) = (gpu.buffer(&[2_u32]), gpu.buffer(&[count as u32]));
        let arguments = CountConstrainedArgs {
            constrained: bits.view().cast(),
            neighbors: neighbors.view().cast(),
            edges: edges.view(),
            counter: Some(counter.view()),
            limit: count as u32 + 8,
        };
        run::<CountConstrained>(gpu, count.div_ceil(4) + 2, &[], &arguments);
        let expected = kernels::count_constrained(&result.constrained, &result.neighbors);
        let edges_of_mesh = (0..3 * case.mesh.slots() as u32)
            .filter(|&h| !case.mesh.is_deleted(h as usize / 3) && h < case.mesh.twin(h) && case.mesh.is_constrained(h));
        assert_eq!(expected as usize, edges_of_mesh.count(), "{}", case.name);
        assert_eq!(gpu.fetch(edges.view()), [2 + expected], "{}", case.name);
    });
}
