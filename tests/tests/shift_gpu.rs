//! Stage 3 on the device against its reference, bit for bit.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod vulkan_support;

use glam::DVec2;
use polder_dualize::gpu::shift::{Input, Stage};
use polder_dualize::{Dualized, Shifted, reference};
use polder_flip::gpu::{Arithmetic, Mesh};
use polder_mesh::GhostMesh;
use polder_tests::families;
use polder_voronoi::reference::Output;
use polder_voronoi::{Options, Resolution};
use vulkan_support::Gpu;

struct Case {
    points: Vec<DVec2>,
    voronoi: Output,
    dualized: Dualized,
    shifted: Shifted,
}

fn case(points: &[DVec2], options: &Options) -> Case {
    let phases = reference::triangulate(points, options).unwrap();
    Case { points: points.to_vec(), voronoi: phases.voronoi, dualized: phases.dualized, shifted: phases.shifted }
}

fn check(gpu: &mut Gpu, stage: &Stage, name: &str, case: &Case) {
    let Case { points, voronoi, dualized, shifted } = case;
    let (sites, count) = (&voronoi.sites, points.len());
    let mesh = Mesh::new(&gpu.device, count).unwrap();
    let positions: Vec<DVec2> = sites.order.iter().map(|&i| points[i as usize]).collect();
    mesh.upload(&mut gpu.engine, &dualized.mesh, &vec![DVec2::ZERO; count]).unwrap();
    let (points, order) = (gpu.buffer(points), gpu.buffer(&sites.order));
    let (pixels, site_count) = (gpu.buffer(&sites.pixels), gpu.buffer(&[sites.count as u32]));
    let buffers = stage.buffers(count).unwrap();
    let input = Input {
        mapping: &voronoi.mapping,
        points: points.view(),
        order: order.view(),
        pixels: pixels.view(),
        sites: site_count.view(),
    };
    let mut recording = gpu.recording();
    stage.record_pin(&mut recording, input, &mesh, &buffers).unwrap();
    gpu.run(&recording);
    let at: Vec<DVec2> = gpu.fetch(mesh.positions());
    let mut closed: GhostMesh = mesh.download(&mut gpu.engine).unwrap();
    assert!(closed == dualized.mesh);
    polder_flip::reference::close_hull(&mut closed, &at).unwrap();
    mesh.upload(&mut gpu.engine, &closed, &at).unwrap();
    let mut recording = gpu.recording();
    stage.record_take_out(&mut recording, input, &mesh, &buffers).unwrap();
    let read = buffers.read(&mut recording);
    let counts = read.result(&gpu.run(&recording)).unwrap();
    let found = (counts.bad, counts.stuck, counts.rounds);
    assert_eq!(found, (shifted.bad as u64, shifted.stuck as u64, shifted.rounds), "{name}: counts");
    let heirs = gpu.fetch(buffers.heirs());
    assert!(heirs[..sites.count] == shifted.heirs, "{name}: heirs");
    let ended = mesh.download(&mut gpu.engine).unwrap();
    assert!(ended == shifted.mesh, "{name}: mesh");
    let bits = |points: &[DVec2]| points.iter().map(|p| p.to_array().map(f64::to_bits)).collect::<Vec<_>>();
    assert!(bits(&gpu.fetch(mesh.positions())) == bits(&positions), "{name}: positions");
    let mut taken = gpu.fetch(buffers.taken())[..counts.taken as usize].to_vec();
    taken.sort_unstable();
    let freed = gpu.fetch(buffers.freed());
    assert_eq!(taken, shifted.taken_out().map(|(site, _)| site).collect::<Vec<_>>(), "{name}: taken out");
    if shifted.mesh.slots() > 0 {
        assert!(taken.iter().all(|&v| freed[v as usize] == shifted.freed[v as usize]), "{name}: freed");
    }
}

#[test]
fn every_family() {
    let mut gpu = Gpu::open();
    for arithmetic in [Arithmetic::Filtered, Arithmetic::Integers] {
        let stage = Stage::new(&gpu.device, arithmetic).unwrap();
        for (name, pslg) in families(1000, 31) {
            for options in [Options::default(), Resolution::LongerSide(40).into()] {
                let case = case(pslg.points(), &options);
                eprintln!("{name}, {arithmetic:?}, {options:?}");
                check(&mut gpu, &stage, name, &case);
            }
        }
    }
}
