//! Each kernel of stage 6 that cuts constraints against the reference of its name.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod constrain_support;
mod vulkan_support;

use constrain_support::Start;
use polder_constrain::kernels::*;
use polder_constrain::reference::kernels as expected;
use polder_flip::gpu::Mesh;
use polder_mesh::NONE;
use polder_tests::families;
use polder_vulkan::{Kernel, Shader};
use vulkan_support::Gpu;

fn run<S: Shader>(gpu: &mut Gpu, kernel: &Kernel<S>, items: usize, arguments: &S::Args<'_>) {
    let mut recording = gpu.recording();
    recording.dispatch(kernel, polder_vulkan::groups_for(items, 256), arguments);
    gpu.run(&recording);
}

/// The families at some sizes: meshes of stage 4, and constraints as pairs of their vertices.
fn starts(sizes: &[(usize, u64)]) -> impl Iterator<Item = (&'static str, Start)> {
    let pslgs = sizes.iter().flat_map(|&(n, seed)| families(n, seed));
    pslgs.map(|(name, pslg)| (name, Start::stage_4(&pslg)))
}

fn upload(gpu: &mut Gpu, start: &Start) -> Mesh {
    let mesh = Mesh::new(&gpu.device, start.positions.len()).unwrap();
    mesh.upload(&mut gpu.engine, &start.mesh, &start.positions).unwrap();
    mesh
}

#[test]
fn find_spokes() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<FindSpokes>::new(&gpu.device, &[]).unwrap();
    for (name, start) in starts(&[(8, 1), (200, 2), (1500, 3)]) {
        let vertices = start.positions.len();
        let mesh = upload(&mut gpu, &start);
        let (spokes, degrees) = (gpu.buffer(&vec![NONE; vertices]), gpu.buffer(&vec![0u32; vertices]));
        let arguments = FindSpokesArgs {
            triangles: mesh.corners(),
            slots: mesh.slots(),
            spokes: spokes.view(),
            degrees: degrees.view(),
            limit: mesh.capacity() as u32,
            vertices: vertices as u32,
        };
        run(&mut gpu, &kernel, mesh.capacity(), &arguments);
        let (some, counts) = expected::find_spokes(&start.mesh, vertices);
        assert!(gpu.fetch(degrees.view()) == counts, "{name}: degrees");
        for (v, (&h, &one)) in gpu.fetch(spokes.view()).iter().zip(&some).enumerate() {
            assert_eq!(h == NONE, one == NONE, "{name}: vertex {v}");
            assert!(h == NONE || start.mesh.origin(h) == v as u32, "{name}: half-edge {h} does not leave vertex {v}");
        }
    }
}
