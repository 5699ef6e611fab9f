//! Stage 2 on a device against its reference, bit for bit.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod voronoi_gpu_support;
mod vulkan_support;

use polder_dualize::gpu::dualize::{Counts, Input, Stage};
use polder_dualize::reference::{certify, dual};
use polder_dualize::{DVec2, DualizeError, Dualized};
use polder_flip::gpu::Mesh;
use polder_mesh::{GHOST, GhostMesh};
use polder_tests::families;
use polder_voronoi::{Diagram, Options, Resolution, Sites, reference};
use polder_vulkan::{Buffer, Error};
use voronoi_gpu_support::{anywhere, grids, with_device};
use vulkan_support::{Gpu, words};

/// Dualizes on the device: the mesh as far as it goes, and what the report says.
fn dualized(
    gpu: &mut Gpu,
    stage: &Stage,
    diagram: &Diagram,
    sites: &Sites,
) -> ([Vec<[u32; 3]>; 2], Result<Counts, DualizeError>) {
    let size = [diagram.width, diagram.height];
    let buffers = stage.buffers(size).unwrap();
    let (colors, pixels) = (gpu.buffer(&diagram.colors), gpu.buffer(&sites.pixels));
    let count = gpu.buffer(&[sites.count as u32]);
    let room = 2 * sites.pixels.len();
    let mesh = Mesh::with_slots(&gpu.device, 0, room).unwrap();
    gpu.engine.upload(mesh.records(), &vec![[7; 8]; room]).unwrap();
    let mut recording = gpu.recording();
    let input = Input { size, colors: colors.view(), pixels: pixels.view(), sites: count.view() };
    let read = stage.record(&mut recording, input, &mesh, &buffers).unwrap();
    let report = gpu.run(&recording);
    let slots = gpu.fetch(mesh.slots())[0] as usize;
    let records = gpu.fetch(mesh.records());
    assert!(records[slots..].iter().all(|&words| words == [7; 8]), "written beyond the end");
    let rows = |from: usize| records[..slots].iter().map(|record| [0, 1, 2].map(|k| record[from + k])).collect();
    ([rows(0), rows(4)], read.result(&report))
}

fn certified(mesh: &GhostMesh, sites: &Sites) -> Result<(), DualizeError> {
    let positions: Vec<DVec2> = sites.pixels.iter().map(|&pixel| DVec2::from(pixel.map(f64::from))).collect();
    certify(mesh, &positions, "dualize")
}

fn assert_dual(gpu: &mut Gpu, stage: &Stage, name: &str, diagram: &Diagram, sites: &Sites) {
    let ([triangles, links], counts) = dualized(gpu, stage, diagram, sites);
    let Dualized { mesh, necks, .. } = dual(diagram, sites).unwrap();
    assert!(triangles == mesh.triangles, "{name}: triangles");
    assert!(links == mesh.links, "{name}: links");
    let ghosts = mesh.triangles.iter().filter(|corners| corners.contains(&GHOST)).count() as u64;
    let expected = Counts { sites: sites.count as u64, triangles: mesh.slots() as u64, ghosts, necks };
    assert_eq!(counts.unwrap(), expected, "{name}");
}

#[test]
fn every_family() {
    with_device(|shared| {
        let stage = Stage::new(&shared.gpu.device).unwrap();
        for options in [Options::default(), Resolution::LongerSide(40).into(), Resolution::LongerSide(300).into()] {
            for (name, pslg) in families(1000, 41) {
                let output = reference::diagram(pslg.points(), &options).unwrap();
                assert_dual(&mut shared.gpu, &stage, name, &output.diagram, &output.sites);
            }
        }
    });
}

#[test]
fn every_number_of_points_around_a_tile() {
    with_device(|shared| {
        let stage = Stage::new(&shared.gpu.device).unwrap();
        for count in [1, 2, 3, 4, 127, 128, 129, 255, 256, 257, 20_000] {
            let points = polder_io::generate::uniform(count, count as u64);
            let output = reference::diagram(points.points(), &Options::default()).unwrap();
            assert_dual(&mut shared.gpu, &stage, "uniform", &output.diagram, &output.sites);
        }
    });
}

#[test]
fn strips_lines_dense_and_sparse_grids() {
    with_device(|shared| {
        let stage = Stage::new(&shared.gpu.device).unwrap();
        for (name, sites) in grids() {
            let diagram = reference::flooding::flood(&sites).unwrap().diagram;
            assert_dual(&mut shared.gpu, &stage, &name, &diagram, &sites);
        }
        for size in [[32768, 1], [1, 32768], [32768, 3], [3, 32768], [1000, 1000]] {
            for count in [1, 2, 3, 500] {
                let sites = anywhere(size, count, count as u64);
                let mut diagram = reference::color(&sites).unwrap();
                reference::debris(&mut diagram, &sites).unwrap();
                reference::recolor(&mut diagram, &sites).unwrap();
                assert_dual(&mut shared.gpu, &stage, "long", &diagram, &sites);
            }
        }
    });
}

#[test]
fn what_no_flooding_gives_is_an_error() {
    with_device(|shared| {
        let stage = Stage::new(&shared.gpu.device).unwrap();
        let mut kinds = [0; 3];
        for seed in 0..300 {
            let size = [1 + seed as u32 * 7 % 19, 1 + seed as u32 * 13 % 17];
            let sites = anywhere(size, 1 + seed as usize % 9, seed);
            let mut diagram = reference::flooding::flood(&sites).unwrap().diagram;
            // Some pixels get other colors, now and then one that no site has.
            let colors = sites.count as u32 + u32::from(seed % 5 == 0);
            for pair in words(seed, 2 + 2 * (seed as usize % 4)).chunks(2) {
                let at = pair[0] as usize % diagram.colors.len();
                diagram.colors[at] = pair[1] % colors;
            }
            let ([triangles, _], found) = dualized(&mut shared.gpu, &stage, &diagram, &sites);
            match (dual(&diagram, &sites), found) {
                // Left to the certificate, which cannot hold where one site has two stars and another none.
                (Err(DualizeError::Mismatch { what: "a site that no region belongs to", .. }), _) => {}
                (Err(expected), Err(found)) => {
                    assert_eq!(found, expected, "{seed}");
                    let kind = match found {
                        DualizeError::Mismatch { .. } => 0,
                        DualizeError::CrossingNecks { .. } => 1,
                        _ => 2,
                    };
                    assert!(triangles.is_empty());
                    kinds[kind] += 1;
                }
                (Ok(expected), _) => assert!(triangles == expected.mesh.triangles, "{seed}"),
                (Err(expected), found) => panic!("{seed}: {expected}, not {found:?}"),
            }
        }
        assert!(kinds.iter().all(|&count| count > 3), "{kinds:?}");
    });
}

#[test]
fn triangles_that_are_not_counterclockwise_are_found() {
    with_device(|shared| {
        let stage = Stage::new(&shared.gpu.device).unwrap();
        let mut sites = anywhere([60, 60], 500, 3);
        let diagram = reference::flooding::flood(&sites).unwrap().diagram;
        sites.pixels.swap(100, 300);
        let Dualized { mesh, .. } = dual(&diagram, &sites).unwrap();
        let has = |t: &usize| mesh.triangles[*t].iter().any(|v| [100, 300].contains(v));
        let expected = certified(&mesh, &sites).unwrap_err();
        assert!(matches!(expected, DualizeError::NotCounterclockwise { triangle, .. } if has(&triangle)));
        assert_eq!(dualized(&mut shared.gpu, &stage, &diagram, &sites).1, Err(expected));
    });
}

#[test]
fn a_recording_serves_again() {
    with_device(|shared| {
        let gpu = &mut shared.gpu;
        let stage = Stage::new(&gpu.device).unwrap();
        let size = [90, 70];
        let buffers = stage.buffers(size).unwrap();
        let room = 400;
        let pixels = Buffer::<[u16; 2]>::new(&gpu.device, "pixels", room).unwrap();
        let colors = Buffer::<u32>::new(&gpu.device, "colors", 90 * 70).unwrap();
        let count = Buffer::<u32>::new(&gpu.device, "word", 1).unwrap();
        let on_device = Mesh::with_slots(&gpu.device, 0, 2 * room).unwrap();
        let mut recording = gpu.recording();
        let input = Input { size, colors: colors.view(), pixels: pixels.view(), sites: count.view() };
        let read = stage.record(&mut recording, input, &on_device, &buffers).unwrap();
        for points in [1, 2, 30, 400] {
            let sites = anywhere(size, points, points as u64);
            let diagram = reference::flooding::flood(&sites).unwrap().diagram;
            gpu.engine.upload(colors.view(), &diagram.colors).unwrap();
            gpu.engine.upload(pixels.view(), &sites.pixels).unwrap();
            gpu.engine.upload(count.view(), &[sites.count as u32]).unwrap();
            let report = gpu.run(&recording);
            let Dualized { mesh, necks, .. } = dual(&diagram, &sites).unwrap();
            let found = read.result(&report).unwrap();
            assert_eq!((found.necks, found.triangles), (necks, mesh.slots() as u64));
            assert!(on_device.download(&mut gpu.engine).unwrap() == mesh, "{points}");
        }
    });
}

#[test]
fn what_does_not_fit_is_refused() {
    with_device(|shared| {
        let gpu = &mut shared.gpu;
        let stage = Stage::new(&gpu.device).unwrap();
        for size in [[0, 4], [4, 0], [32769, 4]] {
            assert!(matches!(stage.buffers(size), Err(Error::Recording { .. })), "{size:?}");
        }
        let buffers = stage.buffers([4, 4]).unwrap();
        let (colors, pixels) = (gpu.buffer(&[0_u32; 16]), gpu.buffer(&[[0_u16; 2]; 3]));
        let count = gpu.buffer(&[1_u32]);
        let [mesh, short] = [4, 3].map(|slots| Mesh::with_slots(&gpu.device, 0, slots).unwrap());
        let mut recording = gpu.recording();
        let input = Input { size: [4, 4], colors: colors.view(), pixels: pixels.view(), sites: count.view() };
        assert!(stage.record(&mut recording, input, &short, &buffers).is_err());
        assert!(stage.record(&mut recording, Input { size: [2, 8], ..input }, &mesh, &buffers).is_err());
        assert!(recording.is_empty());
        assert!(stage.record(&mut recording, input, &mesh, &buffers).is_ok());
    });
}
