//! The canonical order and its certificate on the device against the reference, bit for bit.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod finish_gpu_support;
mod vulkan_support;

use finish_gpu_support::{Case, Shared, cases, hub, with_device};
use polder_canonical::CanonicalError;
use polder_canonical::gpu::{Chains, Counts, Input, Stage};
use polder_canonical::reference::{Canonical, canonical, certify, check_triangles, kernels};
use polder_mesh::{GHOST, Parts, Triangulation};
use vulkan_support::Gpu;

fn run(gpu: &mut Gpu, stage: &Stage, case: &Case) -> (Canonical, Counts) {
    let on_device = case.upload(gpu);
    let buffers = stage.buffers(case.order.len(), on_device.mesh.capacity()).unwrap();
    let input = Input {
        mesh: &on_device.mesh,
        vertex_of: on_device.vertex_of.view(),
        order: on_device.order.view(),
        chains: None,
    };
    let mut recording = gpu.recording();
    let read = stage.record(&mut recording, &input, &buffers).unwrap();
    let counts = read.counts(&gpu.run(&recording));
    let found = counts.triangles as usize;
    let result = Canonical {
        triangles: gpu.fetch(buffers.triangles().slice(0..found).unwrap()),
        neighbors: gpu.fetch(buffers.neighbors().slice(0..found).unwrap()),
        constrained: gpu.fetch(buffers.constrained().slice(0..found).unwrap()),
        representatives: gpu.fetch(buffers.representatives()),
    };
    (result, counts)
}

fn assert_step(gpu: &mut Gpu, stage: &Stage, case: &Case) -> Counts {
    let (result, counts) = run(gpu, stage, case);
    let expected = canonical(&case.mesh, &case.vertex_of, &case.order);
    assert!(result == expected, "{}", case.name);
    assert_eq!(counts.verdict(), Ok(()), "{}", case.name);
    let finite = case.mesh.finite().count();
    let ghosts = (0..case.mesh.slots()).filter(|&t| case.mesh.is_ghost(t)).count();
    let wanted = (finite as u32, ghosts as u32, case.vertices());
    assert_eq!((counts.triangles, counts.ghosts, counts.vertices), wanted, "{}", case.name);
    counts
}

#[test]
fn every_family() {
    with_device(|Shared { gpu, stages, .. }| {
        for case in cases(1000, 41) {
            for stage in stages.iter() {
                assert_step(gpu, stage, &case);
            }
        }
    });
}

#[test]
fn the_reference_is_the_order_of_polder_mesh() {
    for case in cases(300, 42) {
        let result = canonical(&case.mesh, &case.vertex_of, &case.order);
        let mut names = case.order.clone();
        for (&v, &input) in case.vertex_of.iter().zip(&case.order) {
            names[v as usize] = names[v as usize].min(input);
        }
        let parts = Parts { representatives: result.representatives.clone(), chains: Default::default() };
        let expected = Triangulation::from_mesh(&case.mesh, &names, parts.clone());
        assert_eq!(expected.triangles(), result.triangles, "{}", case.name);
        assert_eq!(expected.neighbors(), result.neighbors, "{}", case.name);
        assert_eq!(expected.constrained_bits(), result.constrained, "{}", case.name);
        let whole =
            Triangulation::from_canonical(result.triangles, result.neighbors, result.constrained, parts).unwrap();
        assert!(whole == expected && whole.neighbors() == expected.neighbors());
        assert_eq!(certify(&case.mesh, &case.positions, case.vertices()), Ok(()), "{}", case.name);
    }
}

#[test]
fn a_hub_is_sorted_by_a_workgroup() {
    with_device(|Shared { gpu, stages, .. }| {
        for n in [29, 40, 3000] {
            let mut case = hub(n);
            // The hub is the first point.
            let center = case.order.iter().position(|&input| input == 0).unwrap() as u32;
            let fan = case.mesh.finite().filter(|&t| case.mesh.triangles[t].contains(&center)).count();
            assert!(fan > n / 2, "{fan}");
            let counts = assert_step(gpu, &stages[0], &case);
            assert_eq!(counts.long_lists, u32::from(fan > 32));
            assert_step(gpu, &stages[1], &case);
            // Other names, so that keys have other digits.
            let last = case.order.len() as u32 - 1;
            case.order.iter_mut().filter(|input| **input != 0).for_each(|input| *input = last + 1 - *input);
            assert_step(gpu, &stages[0], &case);
        }
    });
}

/// The same finding on both sides, and the error that it leads to.
fn assert_refused(gpu: &mut Gpu, stages: &[Stage], case: &Case, what: &str) -> CanonicalError {
    let (_, counts) = run(gpu, &stages[0], case);
    let finite = case.mesh.finite().next().is_some();
    assert_eq!(counts.check, check_triangles(&case.mesh, &case.positions, finite), "{what}");
    let expected = certify(&case.mesh, &case.positions, case.vertices());
    assert_eq!(counts.verdict(), expected, "{what}");
    expected.unwrap_err()
}

/// Chains come along in the numbering of the input, and what constraints came to is counted.
#[test]
fn chains_are_named_and_constrained_edges_counted() {
    with_device(|Shared { gpu, stages, .. }| {
        for case in cases(300, 43).into_iter().filter(|case| case.order.len() > 3) {
            let on_device = case.upload(gpu);
            let buffers = stages[0].buffers(case.order.len(), on_device.mesh.capacity()).unwrap();
            let chains = [0, 1, 2, 1, 3, 0].map(|i| case.vertex_of[i]);
            let (starts, vertices, count) =
                (gpu.buffer(&[0_u32, 1, 3, 6]), gpu.buffer(&[&chains[..], &[9; 4]].concat()), gpu.buffer(&[6_u32]));
            let input = Input {
                mesh: &on_device.mesh,
                vertex_of: on_device.vertex_of.view(),
                order: on_device.order.view(),
                chains: Some(Chains { starts: starts.view(), vertices: vertices.view(), count: Some(count.view()) }),
            };
            let mut recording = gpu.recording();
            let read = stages[0].record(&mut recording, &input, &buffers).unwrap();
            let counts = read.counts(&gpu.run(&recording));
            let expected = canonical(&case.mesh, &case.vertex_of, &case.order);
            let edges = kernels::count_constrained(&expected.constrained, &expected.neighbors);
            assert_eq!((counts.constrained_edges, counts.through_vertices), (edges, 1), "{}", case.name);
            assert!(edges > 0 || !case.name.contains("uniform, marked"), "{}", case.name);
            let name = |v: u32| expected.representatives[case.order[v as usize] as usize];
            let named = [&chains.map(name)[..], &[9; 4]].concat();
            assert_eq!(gpu.fetch(vertices.view()), named, "{}", case.name);
        }
    });
}

#[test]
fn what_is_no_triangulation_is_refused() {
    with_device(|Shared { gpu, stages, .. }| {
        let good = Case::of("uniform", polder_io::generate::uniform(500, 7).points());
        let finite: Vec<usize> = good.mesh.finite().collect();
        let ghost = (0..good.mesh.slots()).find(|&t| good.mesh.is_ghost(t)).unwrap();

        // A vertex moved across its star.
        let mut case = good.clone();
        let v = case.mesh.triangles[finite[10]][0] as usize;
        case.positions[v] += polder_mesh::DVec2::new(0.3, 0.1);
        let error = assert_refused(gpu, stages, &case, "moved");
        assert!(matches!(error, CanonicalError::NotCounterclockwise { .. }), "{error}");

        // A hull vertex pulled in, so far that triangles stay counterclockwise, if at all.
        let mut case = good.clone();
        let k = case.mesh.triangles[ghost].iter().position(|&v| v == GHOST).unwrap();
        let v = case.mesh.triangles[ghost][(k + 1) % 3] as usize;
        let middle = polder_mesh::DVec2::new(0.5, 0.5);
        case.positions[v] = case.positions[v].lerp(middle, 1e-2);
        assert_refused(gpu, stages, &case, "pulled in");

        // Links that do not lead back, or lead to other vertices.
        let mut case = good.clone();
        case.mesh.links[finite[5]][1] = case.mesh.links[finite[6]][2];
        assert!(matches!(assert_refused(gpu, stages, &case, "link"), CanonicalError::Broken { .. }));
        let mut case = good.clone();
        case.mesh.triangles[finite[9]].swap(0, 1);
        assert!(matches!(assert_refused(gpu, stages, &case, "corners"), CanonicalError::Broken { .. }));
        // An edge that is constrained on one side alone, within and at the hull.
        for t in [finite[20], ghost] {
            let mut case = good.clone();
            case.mesh.constrained[t] = 2;
            let triangle = t.min(good.mesh.links[t][1] as usize / 3) as u32;
            assert_eq!(assert_refused(gpu, stages, &case, "mark"), CanonicalError::Broken { triangle });
        }

        // A vertex more than the mesh has.
        let mut case = good.clone();
        case.positions.push(middle);
        case.vertex_of.push(case.order.len() as u32);
        case.order.push(case.order.len() as u32);
        assert!(matches!(assert_refused(gpu, stages, &case, "one missing"), CanonicalError::Count { .. }));

        // Two triangulations, one beside the other.
        let mut case = good.clone();
        let (slots, vertices) = (good.mesh.slots() as u32, good.order.len() as u32);
        let other = |v: u32| if v == GHOST { GHOST } else { v + vertices };
        case.mesh.triangles.extend(good.mesh.triangles.iter().map(|t| t.map(other)));
        case.mesh.links.extend(good.mesh.links.iter().map(|l| l.map(|h| h + 3 * slots)));
        case.mesh.constrained.extend_from_slice(&good.mesh.constrained);
        case.positions.extend(good.positions.iter().map(|&p| p + polder_mesh::DVec2::new(3.0, 0.0)));
        case.vertex_of.extend(good.vertex_of.iter().map(|v| v + vertices));
        case.order.extend(good.order.iter().map(|v| v + vertices));
        assert_refused(gpu, stages, &case, "two of them");
    });
}

#[test]
fn sizes_that_do_not_fit_are_errors() {
    with_device(|Shared { gpu, stages, .. }| {
        let case = Case::of("uniform", polder_io::generate::uniform(50, 7).points());
        let on_device = case.upload(gpu);
        let slots = on_device.mesh.capacity();
        let stage = &stages[0];
        assert!(stage.buffers(50, usize::MAX).is_err());
        let input = Input {
            mesh: &on_device.mesh,
            vertex_of: on_device.vertex_of.view(),
            order: on_device.order.view(),
            chains: None,
        };
        let mut recording = gpu.recording();
        for (points, slots) in [(51, slots), (50, slots + 1), (50, slots - 1)] {
            let buffers = stage.buffers(points, slots).unwrap();
            assert!(stage.record(&mut recording, &input, &buffers).is_err());
        }
        assert!(recording.is_empty());
        assert!(stage.estimate(50, slots).bytes() >= 4 * (9 * slots as u64 + 4 * 50));
    });
}
