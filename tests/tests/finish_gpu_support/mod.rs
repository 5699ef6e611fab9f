//! Meshes as the stages leave them, and one device for all tests of a file.
#![allow(dead_code, clippy::unwrap_used, reason = "tests; each takes what it needs")]

use crate::vulkan_support::{Gpu, words};
use polder_canonical::gpu::Stage;
use polder_flip::gpu::{Arithmetic, Mesh};
use polder_mesh::{DVec2, GhostMesh};
use polder_vulkan::Buffer;
use std::sync::{Mutex, PoisonError};

pub(crate) struct Shared {
    pub(crate) gpu: Gpu,
    /// As users get it, and one that sorts all but the shortest lists by workgroups, and decides signs by integers alone.
    pub(crate) stages: [Stage; 2],
}

static SHARED: Mutex<Option<Shared>> = Mutex::new(None);

/// Runs a test on the device of this process; the validation layer must have had nothing to say.
pub(crate) fn with_device(test: impl FnOnce(&mut Shared)) {
    let mut shared = SHARED.lock().unwrap_or_else(PoisonError::into_inner);
    let shared = shared.get_or_insert_with(|| {
        let gpu = Gpu::open();
        let stages = [
            Stage::new(&gpu.device, Arithmetic::Filtered).unwrap(),
            Stage::with_longest(&gpu.device, Arithmetic::Integers, 1).unwrap(),
        ];
        Shared { gpu, stages }
    });
    test(shared);
    assert_eq!(shared.gpu.device.validation_messages(), Vec::<String>::new());
    assert_eq!(shared.gpu.device.overruns(), Vec::<String>::new());
}

/// What the step takes.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) mesh: GhostMesh,
    pub(crate) positions: Vec<DVec2>,
    pub(crate) vertex_of: Vec<u32>,
    pub(crate) order: Vec<u32>,
}

impl Case {
    /// The Delaunay triangulation of some points by the references of the stages before.
    pub(crate) fn of(name: &str, points: &[DVec2]) -> Case {
        let name = name.to_owned();
        if points.is_empty() {
            let (mesh, positions, vertex_of, order) = Default::default();
            return Case { name, mesh, positions, vertex_of, order };
        }
        let phases = polder_dualize::reference::triangulate(points, &Default::default()).unwrap();
        let positions = phases.positions(points);
        let mut mesh = phases.inserted.mesh;
        polder_flip::reference::flip(&mut mesh, &positions).unwrap();
        Case { name, mesh, positions, vertex_of: phases.inserted.vertex_of, order: phases.voronoi.sites.order }
    }

    /// With some edges constrained, and free slots among the others.
    pub(crate) fn marked(mut self, seed: u64) -> Case {
        self.name += ", marked";
        let slots = self.mesh.slots();
        for word in words(seed, slots / 3) {
            let h = word % (3 * slots as u32);
            if self.mesh.is_finite(h as usize / 3) {
                self.mesh.set_constrained(h, true);
            }
        }
        // Every fourth slot is free.
        let place = |t: u32| t + t / 3;
        let mut mesh = GhostMesh::with_slots(slots + slots.div_ceil(3));
        for t in 0..slots {
            let to = place(t as u32) as usize;
            mesh.triangles[to] = self.mesh.triangles[t];
            mesh.links[to] = self.mesh.links[t].map(|h| 3 * place(h / 3) + h % 3);
            mesh.constrained[to] = self.mesh.constrained[t];
        }
        mesh.check().unwrap();
        self.mesh = mesh;
        self
    }

    pub(crate) fn vertices(&self) -> u32 {
        (0..).zip(&self.vertex_of).filter(|(i, v)| i == *v).count() as u32
    }

    pub(crate) fn upload(&self, gpu: &mut Gpu) -> OnDevice {
        let slots = self.mesh.slots() + 5;
        let mesh = Mesh::with_slots(&gpu.device, self.positions.len(), slots).unwrap();
        // What lies behind the slots in use must not matter.
        gpu.engine.upload(mesh.corners(), &words(3, 8 * slots)).unwrap();
        mesh.upload(&mut gpu.engine, &self.mesh, &self.positions).unwrap();
        OnDevice { mesh, vertex_of: gpu.buffer(&self.vertex_of), order: gpu.buffer(&self.order) }
    }
}

pub(crate) struct OnDevice {
    pub(crate) mesh: Mesh,
    pub(crate) vertex_of: Buffer<u32>,
    pub(crate) order: Buffer<u32>,
}

/// Every family, and sizes around a workgroup; plain and marked.
pub(crate) fn cases(n: usize, seed: u64) -> Vec<Case> {
    let mut cases: Vec<Case> =
        polder_tests::families(n, seed).iter().map(|(name, pslg)| Case::of(name, pslg.points())).collect();
    for count in [0, 1, 2, 3, 4, 127, 128, 129, 130, 257, 2049] {
        let points = polder_io::generate::uniform(count, seed + count as u64);
        cases.push(Case::of(&format!("{count} uniform"), points.points()));
    }
    let marked: Vec<Case> = cases.iter().step_by(3).map(|case| case.clone().marked(seed)).collect();
    cases.into_iter().chain(marked).collect()
}

/// A hub with a fan around it, larger than a workgroup, whose triangles all begin at the hub.
pub(crate) fn hub(n: usize) -> Case {
    let mut points = vec![DVec2::ZERO];
    points.extend_from_slice(polder_io::generate::circle(n, 5).points());
    Case::of("hub", &points)
}
