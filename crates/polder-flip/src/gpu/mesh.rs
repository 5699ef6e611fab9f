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

/// A triangle on the device.
type Record = [u32; 8];
/// Where links begin in a record.
const LINKS: usize = 4;

/// A [`GhostMesh`] in device memory, with the positions of its vertices.
///
/// A triangle is a record of eight words, 32 bytes that memory brings as one: its corners in the first three, its links from
/// the fifth on; the others are [`NONE`]. A word of links carries in its highest bit whether the edge is constrained. How many
/// slots are in use is a word on the device, so that kernels can add some; what lies behind them is not defined.
#[derive(Debug)]
pub struct Mesh {
    records: Buffer<Record>,
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
            .buffer::<Record>("triangles", slots)
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
            records: Buffer::new(device, "triangles", slots)?,
            positions: Buffer::new(device, "positions", vertices)?,
            slots: Buffer::new(device, "slots", 4)?,
        })
    }

    /// Slots that there is memory for.
    pub fn capacity(&self) -> usize {
        self.records.len()
    }

    /// Vertices that there is memory for.
    pub fn vertices(&self) -> usize {
        self.positions.len()
    }

    /// All records.
    pub fn records(&self) -> View<'_, [u32; 8]> {
        self.records.view()
    }

    /// Where the corners of the first triangle lie, and those of all others eight words further on each: as kernels take them.
    pub fn corners(&self) -> View<'_, u32> {
        self.records.view().cast()
    }

    /// Where the links of the first triangle lie, in the same way.
    pub fn twins(&self) -> View<'_, u32> {
        let words = self.corners();
        // Without a slot there is no link.
        words.slice(LINKS.min(words.len())..words.len()).unwrap_or(words)
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
        let rows = mesh.triangles.iter().zip(&mesh.links).zip(&mesh.constrained);
        let records: Vec<Record> = rows.map(|((&row, &links), &bits)| record(row, marked(links, bits))).collect();
        engine.upload(self.records.view().slice(0..mesh.slots())?, &records)?;
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
        let records = engine.download_vec(self.records.slice(0..slots)?)?;
        let triangles: Vec<_> = records.iter().map(|&[a, b, c, ..]| [a, b, c]).collect();
        let mut links: Vec<_> = records.iter().map(|&[.., f, g, h, _]| [f, g, h]).collect();
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

fn record([a, b, c]: [u32; 3], [f, g, h]: [u32; 3]) -> Record {
    [a, b, c, NONE, f, g, h, NONE]
}

fn marked(row: [u32; 3], bits: u8) -> [u32; 3] {
    let mut k = 0;
    row.map(|link| {
        let mark = if bits >> k & 1 == 1 && link != NONE { CONSTRAINED } else { 0 };
        k += 1;
        link | mark
    })
}
