//! What stands between the stages on a Vulkan device, against the reference.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod vulkan_support;

use polder_dualize::gpu::{dualize, shift, to_insert};
use polder_flip::gpu::{self as flip, Arithmetic, Mesh, Tally};
use polder_mesh::NONE;
use polder_tests::point_families;
use polder_voronoi::{GridMapping, Options};
use vulkan_support::Gpu;

#[test]
fn points_to_insert() {
    let mut gpu = Gpu::open();
    let device = gpu.device.clone();
    let arithmetic = Arithmetic::Filtered;
    let flips = flip::Stage::with_arithmetic(&device, arithmetic).unwrap();
    let voronoi = polder_voronoi::gpu::Stage::new(&device).unwrap();
    let dual = dualize::Stage::new(&device).unwrap();
    let shifts = shift::Stage::new(&device, arithmetic).unwrap();
    let stage = to_insert::Stage::new(&device).unwrap();
    let mut families = point_families(700, 71);
    families.extend([1, 2, 3, 257].map(|count| ("few", polder_io::generate::uniform(count, 5))));
    for (name, pslg) in families {
        let points = pslg.points();
        let mapping = GridMapping::fit(points, &Options::default()).unwrap();
        let (size, uploaded) = (mapping.size(), gpu.buffer(points));
        let mesh = Mesh::new(&device, points.len()).unwrap();
        let diagram = voronoi.buffers(points.len(), size).unwrap();
        let dual_buffers = dual.buffers(size).unwrap();
        let shifted = shifts.buffers(points.len()).unwrap();
        let (flip_buffers, tally) = (flips.buffers(mesh.capacity()).unwrap(), Tally::new(&device).unwrap());
        let buffers = to_insert::Buffers::new(&device, points.len()).unwrap();

        let mut recording = gpu.recording();
        voronoi.record(&mut recording, &mapping, uploaded.view(), &diagram).unwrap();
        let (order, pixels, colors) = (diagram.order(), diagram.pixels(), diagram.colors());
        let sites = diagram.site_count().unwrap();
        let input = dualize::Input { size, colors, pixels, sites };
        dual.record(&mut recording, input, &mesh, &dual_buffers).unwrap();
        flips.record_start(&mut recording, &flip_buffers);
        tally.record_clear(&mut recording);
        let input = shift::Input { mapping: &mapping, points: uploaded.view(), order, pixels, sites };
        let hull = shift::Flips { stage: &flips, buffers: &flip_buffers, tally: &tally };
        shifts.record(&mut recording, input, &mesh, hull, &shifted).unwrap();
        let input = to_insert::Input { width: size[0], colors, pixels, sites };
        stage.record(&mut recording, input, &shifted, &buffers).unwrap();
        gpu.run(&recording);

        let count = gpu.fetch(buffers.count().unwrap())[0] as usize;
        let mut found: Vec<(u32, u32)> =
            gpu.fetch(buffers.points()).into_iter().zip(gpu.fetch(buffers.starts())).take(count).collect();
        found.sort_unstable();
        let phases = polder_dualize::reference::triangulate(points, &Options::default()).unwrap();
        let (sites, heirs) = (&phases.voronoi.sites, &phases.shifted.heirs);
        let heir = |i: usize| {
            let owner = phases.voronoi.diagram.color(sites.pixels[i]) as usize;
            (i as u32, heirs.get(owner).copied().unwrap_or(NONE))
        };
        let missing = (sites.count..points.len()).map(heir);
        let mut expected: Vec<(u32, u32)> = phases.shifted.taken_out().chain(missing).collect();
        expected.sort_unstable();
        assert_eq!(found, expected, "{name}");
    }
}
