//! The working mesh on a device.

use glam::DVec2;
use polder_mesh::{DELETED, GhostMesh, NONE};
use polder_vulkan::{Buffer, Device, Engine, Error, Estimate, View};

/// The mark of a constrained edge in a word of links.
pub const CONSTRAINED: u32 = 1 << 31;
/// The bits of a link that name a half-edge.
pub const HALF_EDGE: u32 = CONSTRAINED - 1;
/// The most slots: half-edges take 30 bits.
pub const MOST_SLOTS: usize = (1 << 30) / 3;

/// Slots beyond two for each vertex.
const SPARE: usize = 8;

/// A [`GhostMesh`] in device memory, with the positions of its vertices.
///
/// Triangles are as there; a word of links carries in its highest bit whether the edge is constrained. How many slots are in
/// use is a word on the device, so that kernels can add some; what lies behind them is not defined.
#[derive(Debug)]
pub struct Mesh {
    triangles: Buffer<[u32; 3]>,
    links: Buffer<[u32; 3]>,
    positions: Buffer<DVec2>,
    slots: Buffer<u32>,
}

impl Mesh {
    /// Slots for a mesh of so many vertices: a triangulation of the sphere has two triangles for each but four.
    pub fn slots_for(vertices: usize) -> usize {
        2 * vertices + SPARE
    }

    /// What [`Mesh::new`] will hold.
    pub fn estimate(vertices: usize) -> Estimate {
        let slots = Self::slots_for(vertices);
        Estimate::new()
            .buffer::<[u32; 3]>("triangles", slots)
            .buffer::<[u32; 3]>("links", slots)
            .buffer::<DVec2>("positions", vertices)
            .buffer::<u32>("slots", 4)
    }

    /// Memory for a mesh of so many vertices; what it holds is not defined.
    ///
    /// # Errors
    ///
    /// If the memory cannot be had, or half-edges would not fit in 30 bits.
    pub fn new(device: &Device, vertices: usize) -> Result<Self, Error> {
        Self::with_slots(device, vertices, Self::slots_for(vertices))
    }

    /// With another number of slots.
    ///
    /// # Errors
    ///
    /// As [`Mesh::new`].
    pub fn with_slots(device: &Device, vertices: usize, slots: usize) -> Result<Self, Error> {
        if slots > MOST_SLOTS {
            let why = format!("{slots} slots of triangles; up to {MOST_SLOTS} are possible");
            return Err(Error::Recording { command: "mesh", why });
        }
        Ok(Self {
            triangles: Buffer::new(device, "triangles", slots)?,
            links: Buffer::new(device, "links", slots)?,
            positions: Buffer::new(device, "positions", vertices)?,
            slots: Buffer::new(device, "slots", 4)?,
        })
    }

    /// Slots that there is memory for.
    pub fn capacity(&self) -> usize {
        self.triangles.len()
    }

    /// Vertices that there is memory for.
    pub fn vertices(&self) -> usize {
        self.positions.len()
    }

    /// Corners by slot.
    pub fn triangles(&self) -> View<'_, [u32; 3]> {
        self.triangles.view()
    }

    /// Links by slot.
    pub fn links(&self) -> View<'_, [u32; 3]> {
        self.links.view()
    }

    /// Corners by half-edge: each half-edge's apex, as kernels take them.
    pub fn corners(&self) -> View<'_, u32> {
        self.triangles.view().cast()
    }

    /// Links by half-edge, as kernels take them.
    pub fn twins(&self) -> View<'_, u32> {
        self.links.view().cast()
    }

    /// Positions by vertex.
    pub fn positions(&self) -> View<'_, DVec2> {
        self.positions.view()
    }

    /// One word: slots in use.
    pub fn slots(&self) -> View<'_, u32> {
        self.slots.view()
    }

    /// Brings a mesh here, with the positions of its vertices.
    ///
    /// # Errors
    ///
    /// If a corner has no position, or the mesh more slots or vertices than there is memory for; and those of the device.
    pub fn upload(&self, engine: &mut Engine, mesh: &GhostMesh, positions: &[DVec2]) -> Result<(), Error> {
        let refused = |why| Err(Error::Recording { command: "mesh", why });
        if let Err(error) = crate::reference::check_positions(mesh, positions) {
            return refused(error.to_string());
        }
        if mesh.slots() > self.capacity() || positions.len() > self.vertices() {
            let (slots, vertices) = (mesh.slots(), positions.len());
            let (room, most) = (self.capacity(), self.vertices());
            return refused(format!("{slots} slots and {vertices} vertices; there is memory for {room} and {most}"));
        }
        let links: Vec<[u32; 3]> =
            mesh.links.iter().zip(&mesh.constrained).map(|(&row, &bits)| marked(row, bits)).collect();
        engine.upload(self.triangles.view().slice(0..mesh.slots())?, &mesh.triangles)?;
        engine.upload(self.links.view().slice(0..mesh.slots())?, &links)?;
        engine.upload(self.positions.view().slice(0..positions.len())?, positions)?;
        engine.upload(self.slots.slice(0..1)?, &[mesh.slots() as u32])?;
        Ok(())
    }

    /// Brings the mesh back.
    ///
    /// # Errors
    ///
    /// Those of the device.
    pub fn download(&self, engine: &mut Engine) -> Result<GhostMesh, Error> {
        let slots = engine.download_vec(self.slots.slice(0..1)?)?[0] as usize;
        let slots = slots.min(self.capacity());
        let triangles = engine.download_vec(self.triangles.slice(0..slots)?)?;
        let mut links = engine.download_vec(self.links.slice(0..slots)?)?;
        let mut constrained = vec![0; slots];
        for (t, row) in links.iter_mut().enumerate().filter(|&(t, _)| triangles[t][0] != DELETED) {
            for (k, link) in row.iter_mut().enumerate() {
                constrained[t] |= ((*link >> 31) as u8) << k;
                *link &= HALF_EDGE;
            }
        }
        Ok(GhostMesh { triangles, links, constrained })
    }
}

fn marked(row: [u32; 3], bits: u8) -> [u32; 3] {
    let mut k = 0;
    row.map(|link| {
        let mark = if bits >> k & 1 == 1 && link != NONE { CONSTRAINED } else { 0 };
        k += 1;
        link | mark
    })
}
