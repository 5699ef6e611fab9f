//! Rounds of stage 4 about to begin, in the reference and on a device.
#![allow(dead_code, clippy::unwrap_used, reason = "tests; each takes what it needs")]

use crate::vulkan_support::Gpu;
use glam::DVec2;
use polder_dualize::reference::kernels::insert as expected;
use polder_dualize::reference::{self, ToInsert};
use polder_flip::gpu::Mesh;
use polder_flip::reference::sweep;
use polder_mesh::{GhostMesh, NONE};
use polder_tests::point_families;
use polder_voronoi::{Options, Resolution};
use polder_vulkan::{Buffer, Kernel, Shader};

/// How many words there are, and their places, as in `insert.glsl`.
pub(crate) const WORDS: usize = 52;
pub(crate) const WAITING: usize = 0;
pub(crate) const NEXT: usize = 1;
pub(crate) const PARITY: usize = 2;
pub(crate) const ROUND: usize = 3;
pub(crate) const GROUPS: usize = 4;
pub(crate) const SLOW: usize = 7;
pub(crate) const FINISHED: usize = 8;
pub(crate) const WAITING_STEADY: usize = 12;
pub(crate) const WAITING_BEHIND: usize = 24;
pub(crate) const MESH_GROUPS: usize = 36;
pub(crate) const WIDE_GROUPS: usize = 40;
pub(crate) const ONE_GROUP: usize = 44;
pub(crate) const TESTED: usize = 48;
pub(crate) const CENTER: usize = 9;
pub(crate) const SITES: usize = 13;
pub(crate) const CHAIN: usize = 14;
pub(crate) const INSERTED: usize = 16;
pub(crate) const DUPLICATES: usize = 17;
pub(crate) const LOST: usize = 18;
pub(crate) const OPEN_HULL: usize = 19;
pub(crate) const CENTER_SLOT: usize = 28;
pub(crate) const APEX: usize = 29;
pub(crate) const ENDS: usize = 30;
pub(crate) const GIVEN: usize = 32;

/// Words before anything has run.
pub(crate) fn words() -> [u32; WORDS] {
    let mut words = [0; WORDS];
    words[CENTER_SLOT..CENTER_SLOT + 8].fill(NONE);
    words
}

pub(crate) fn run<S: Shader>(gpu: &mut Gpu, items: usize, arguments: &S::Args<'_>) {
    let kernel = Kernel::<S>::new(&gpu.device, &[]).unwrap();
    run_kernel(gpu, &kernel, items, arguments);
}

pub(crate) fn run_kernel<S: Shader>(gpu: &mut Gpu, kernel: &Kernel<S>, items: usize, arguments: &S::Args<'_>) {
    let mut recording = gpu.recording();
    recording.dispatch(kernel, polder_vulkan::groups_for(items, 256), arguments);
    gpu.run(&recording);
}

/// A round about to begin, in the reference and on the device.
pub(crate) struct Round {
    pub(crate) mesh: GhostMesh,
    pub(crate) positions: Vec<DVec2>,
    pub(crate) slots: Vec<[u32; 2]>,
    pub(crate) new: ToInsert,
    pub(crate) begun: expected::Begun,
    pub(crate) center: [DVec2; 3],
    pub(crate) waiting: Vec<[u32; 2]>,
    pub(crate) claims: Vec<[u32; 3]>,
}

impl Round {
    pub(crate) fn new(mesh: GhostMesh, positions: Vec<DVec2>, new: ToInsert) -> Self {
        let count = 2 * positions.len() - 2;
        let mut padded = GhostMesh::with_slots(count);
        padded.triangles[..mesh.slots()].copy_from_slice(&mesh.triangles);
        padded.links[..mesh.slots()].copy_from_slice(&mesh.links);
        let mut slots = vec![[NONE; 2]; positions.len()];
        new.points.iter().zip(&new.slots).for_each(|(&point, &pair)| slots[point as usize] = pair);
        let begun = expected::insert_begin(&padded, positions.len());
        let center = padded.triangles[begun.center_slot as usize].map(|v| positions[v as usize]);
        let waiting = expected::insert_wait(&begun, &new.points, &new.starts);
        let claims = vec![[NONE; 3]; count];
        Self { mesh: padded, positions, slots, new, begun, center, waiting, claims }
    }

    pub(crate) fn locate(&mut self) -> expected::Located {
        expected::insert_locate(&self.mesh, &self.positions, self.center, &self.waiting, &mut self.claims).unwrap()
    }

    pub(crate) fn claim(&mut self, places: &mut [[u32; 2]]) {
        expected::insert_claim(&self.mesh, &self.waiting, places, &mut self.claims);
    }

    pub(crate) fn graft(&mut self, places: &mut [[u32; 2]]) -> Vec<[u32; 2]> {
        let Self { mesh, slots, waiting, claims, .. } = self;
        expected::insert_graft(mesh, slots, waiting, places, claims, 1)
    }

    pub(crate) fn words(&self) -> [u32; WORDS] {
        let mut words = words();
        words[WAITING] = self.waiting.len() as u32;
        words[ROUND] = 1;
        words[SITES] = self.positions.len() as u32;
        words[LOST] = NONE;
        words[CENTER_SLOT] = self.begun.center_slot;
        words[CENTER..CENTER + 3].copy_from_slice(&self.mesh.triangles[self.begun.center_slot as usize]);
        words
    }

    pub(crate) fn on(&self, gpu: &mut Gpu, places: &[[u32; 2]], words: &[u32; WORDS]) -> On {
        let mesh = Mesh::with_slots(&gpu.device, self.positions.len(), self.mesh.slots()).unwrap();
        mesh.upload(&mut gpu.engine, &self.mesh, &self.positions).unwrap();
        let mut records = gpu.fetch(mesh.records());
        for (record, claims) in records.iter_mut().zip(&self.claims).filter(|(_, claims)| claims[2] != NONE) {
            record[7] = SPLIT | claims[2];
        }
        gpu.engine.upload(mesh.records(), &records).unwrap();
        let limit = self.waiting.len();
        let mut waiting = self.waiting.clone();
        waiting.resize(2 * limit, [7; 2]);
        let mut held = vec![[7; 2]; limit];
        held[..places.len()].copy_from_slice(places);
        On {
            mesh,
            waiting: gpu.buffer(&waiting),
            freed: gpu.buffer(&self.slots),
            places: gpu.buffer(held.as_flattened()),
            claims: gpu.buffer(&self.claims.iter().map(|&[a, b, _]| [a, b]).collect::<Vec<_>>()),
            vertex_of: gpu.buffer(&vec![7; self.positions.len()]),
            hull: gpu.buffer(&[0]),
            words: gpu.buffer(words),
            limit: limit as u32,
        }
    }
}

/// The mark of a note behind links.
const SPLIT: u32 = 1 << 30;

impl On {
    /// Whether claims and notes are these.
    pub(crate) fn claims(&self, gpu: &mut Gpu, claims: &[[u32; 3]]) -> bool {
        let found = gpu.fetch(self.claims.view());
        let notes = gpu.fetch(self.mesh.records()).into_iter().map(|record| record[7]);
        let found = found.into_iter().zip(notes).map(|([score, first], note)| (score, first, note));
        found.eq(claims.iter().map(|&[score, first, split]| (score, first, split | SPLIT)))
    }
}

pub(crate) struct On {
    pub(crate) mesh: Mesh,
    pub(crate) waiting: Buffer<[u32; 2]>,
    pub(crate) freed: Buffer<[u32; 2]>,
    pub(crate) places: Buffer<u32>,
    pub(crate) claims: Buffer<[u32; 2]>,
    pub(crate) vertex_of: Buffer<u32>,
    pub(crate) hull: Buffer<u32>,
    pub(crate) words: Buffer<u32>,
    pub(crate) limit: u32,
}

/// First rounds, with many points for each triangle and with few, outside and on vertices and edges.
pub(crate) fn rounds() -> Vec<(String, Round)> {
    let mut all = Vec::new();
    for options in [Options::default(), Resolution::LongerSide(5).into()] {
        for (name, pslg) in point_families(500, 41) {
            let phases = reference::triangulate(pslg.points(), &options).unwrap();
            let new = reference::points_to_insert(&phases.voronoi.diagram, &phases.voronoi.sites, &phases.shifted);
            if phases.inserted.bootstrapped || new.is_empty() {
                continue;
            }
            let positions = phases.positions(pslg.points());
            all.push((format!("{name}, {options:?}"), Round::new(phases.shifted.mesh, positions, new)));
        }
    }
    // Points on edges and vertices.
    for side in [3, 9] {
        let coarse = polder_io::generate::lattice(side, side);
        let (mesh, _) = sweep(coarse.points()).unwrap();
        let mut positions = coarse.points().to_vec();
        positions.extend(polder_io::generate::lattice(2 * side, 2 * side).points().iter().map(|p| *p / 2.0));
        let points: Vec<u32> = ((side * side) as u32..positions.len() as u32).collect();
        let starts = points.iter().map(|p| p % 9).collect();
        let new = ToInsert::into_free_slots(&mesh, points, starts);
        all.push((format!("on edges, {side}"), Round::new(mesh, positions, new)));
    }
    all
}
