//! Stage 2 on the device.
//!
//! 1. *Count.* One bit for each corner of the grid says whether it is a digital Voronoi vertex, another whether it has two
//!    triangles; a scan over the triangles of each 32 corners gives slots: the one of a corner is that of its word and the
//!    bits before its own. That is three words for 32 corners, not one for each.
//! 2. *Check* that there are as many triangles as a sphere of the sites has.
//! 3. *Write and link.* Each half-edge of a vertex's triangles follows the border that it crosses, two pixels a step, to
//!    the vertex at the other end. Borders are short, about two sides of pixels, wherever points are.
//! 4. *Leap.* Borders that are longer than a few steps have been listed and are followed by a kernel of their own, in leaps
//!    along the bisector of their two sites. One that did not fit on the list has been followed in steps.
//!
//! Triangles that are not counterclockwise are found on the way. A diagram that is no flooded one leaves no triangle, and
//! [`Read::result`] says what was wrong with it.
//!
//! The hull is left as it is: sequences of sites along the four sides of the grid, each strictly monotone along its side.

use crate::DualizeError;
use crate::kernels::*;
use crate::reference::kernels::dualize::words_in_row;
use polder_flip::gpu::Mesh;
use polder_vulkan::primitives::Scan;
use polder_vulkan::{Buffer, Device, Error, Estimate, Kernel, Pool, ReadBack, Recording, RunReport, View};

/// Columns and rows of corners that a workgroup counts.
const COUNT_TILE: [u32; 2] = [256, 8];
/// Columns and rows of corners whose triangles a workgroup writes.
const WRITE_TILE: [u32; 2] = [64, 14];
const WORKGROUP: u32 = 256;
const NONE: u32 = u32::MAX;
const WORDS: usize = 36;
/// Pixels for each long border that there is room for.
const PIXELS_A_LONG_BORDER: usize = 64;
/// Workgroups that follow long borders.
const LEAP_GROUPS: [u32; 3] = [528, 1, 1];

/// Places of single words in the counts: views begin at multiples of 4 words.
#[derive(Clone, Copy)]
enum Word {
    Necks = 0,
    Ghosts = 4,
    Crossing = 8,
    Uncolored = 12,
    Lost = 16,
    Folded = 20,
    Total = 24,
    Sites = 28,
    Far = 32,
}

/// What the stage takes: a flooded diagram and its sites, on the device.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// Width and height of the grid.
    pub size: [u32; 2],
    /// The site of each pixel, row by row.
    pub colors: View<'a, u32>,
    /// The pixel of each site, and of further points perhaps.
    pub pixels: View<'a, [u16; 2]>,
    /// How many sites there are.
    pub sites: View<'a, u32>,
}

/// What the stage counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Sites.
    pub sites: u64,
    /// Triangles, ghosts included.
    pub triangles: u64,
    /// Ghost triangles.
    pub ghosts: u64,
    /// Necks that were passed over.
    pub necks: u64,
}

/// Words of corners of a grid: 32 corners of a row each.
pub fn words_of([width, height]: [u32; 2]) -> usize {
    words_in_row(width) as usize * (height as usize + 1)
}

/// Borders that are left to the last kernel at most.
fn long_borders([width, height]: [u32; 2]) -> usize {
    (width as usize * height as usize).div_ceil(PIXELS_A_LONG_BORDER)
}

/// Workgroups of the kernel that counts.
pub fn count_groups(size: [u32; 2]) -> [u32; 3] {
    tiles(size, COUNT_TILE)
}

/// Workgroups of the kernel that writes.
pub fn write_groups(size: [u32; 2]) -> [u32; 3] {
    tiles(size, WRITE_TILE)
}

fn tiles([width, height]: [u32; 2], tile: [u32; 2]) -> [u32; 3] {
    [(width + 1).div_ceil(tile[0]), (height + 1).div_ceil(tile[1]), 1]
}

/// Scratch memory of the stage, for one size of the grid: three words for 32 corners, and a list.
#[derive(Debug)]
pub struct Buffers {
    size: [u32; 2],
    vertices: Buffer<[u32; 2]>,
    first: Buffer<u32>,
    far: Buffer<[u32; 2]>,
    counts: Buffer<u32>,
    scan: Scan,
}

impl Buffers {
    /// Gives all but the counts; see [`Buffer::give`].
    pub fn give(&self, pool: &Pool) {
        self.vertices.give(pool);
        self.first.give(pool);
        self.far.give(pool);
    }

    fn word(&self, word: Word) -> Result<View<'_, u32>, Error> {
        self.counts.slice(word as usize..word as usize + 1)
    }
}

/// The kernels of the stage on one device.
#[derive(Debug)]
pub struct Stage {
    device: Device,
    count: Kernel<DualizeCount>,
    check: Kernel<DualizeCheck>,
    write: Kernel<DualizeWrite>,
    leap: Kernel<DualizeLeap>,
}

impl Stage {
    /// Compiles the kernels.
    ///
    /// # Errors
    ///
    /// Those of the device.
    pub fn new(device: &Device) -> Result<Self, Error> {
        let workgroup = [("WORKGROUP", WORKGROUP)];
        Ok(Self {
            device: device.clone(),
            count: Kernel::new(device, &workgroup)?,
            check: Kernel::new(device, &[])?,
            write: Kernel::new(device, &workgroup)?,
            leap: Kernel::new(device, &workgroup)?,
        })
    }

    /// What [`Stage::buffers`] will hold.
    pub fn estimate(size: [u32; 2]) -> Estimate {
        let words = words_of(size);
        Estimate::new()
            .buffer::<[u32; 2]>("vertices of the grid", words)
            .buffer::<u32>("slots of the grid", words)
            .buffer::<[u32; 2]>("long borders", long_borders(size))
            .buffer::<u32>("counts", WORDS)
            .and(Scan::estimate(words))
    }

    /// Scratch memory for a grid of this size.
    ///
    /// # Errors
    ///
    /// If a side is impossible, or the memory cannot be had: then before any of it is allocated.
    pub fn buffers(&self, size: [u32; 2]) -> Result<Buffers, Error> {
        if size.iter().any(|side| !(1..=polder_voronoi::MAX_SIDE).contains(side)) {
            let why = format!("a grid of {size:?}; sides between 1 and {} are possible", polder_voronoi::MAX_SIDE);
            return Err(Error::Recording { command: "dualize buffers", why });
        }
        Self::estimate(size).check(&self.device)?;
        let words = words_of(size);
        Ok(Buffers {
            size,
            vertices: Buffer::new(&self.device, "vertices of the grid", words)?,
            first: Buffer::new(&self.device, "slots of the grid", words)?,
            far: Buffer::new(&self.device, "long borders", long_borders(size))?,
            counts: Buffer::new(&self.device, "counts", WORDS)?,
            scan: Scan::new(&self.device, words)?,
        })
    }

    /// Writes the dual of a flooded diagram into the mesh, as [`reference::dual`](crate::reference::dual) does. There must be
    /// room for as many triangles as a sphere of all sites and the ghost has.
    ///
    /// # Errors
    ///
    /// If the parts are not of one size.
    pub fn record(
        &self,
        recording: &mut Recording,
        input: Input<'_>,
        mesh: &Mesh,
        buffers: &Buffers,
    ) -> Result<Read, Error> {
        let [width, height] = input.size;
        let refused = |why: String| Err(Error::Recording { command: "dualize", why });
        if input.size != buffers.size || input.colors.len() != width as usize * height as usize {
            return refused(format!("{:?} on {:?} pixels; buffers for {:?}", input.colors, input.size, buffers.size));
        }
        let room = mesh.capacity();
        let wanted = crate::reference::kernels::dualize::triangles_of(input.pixels.len().min(input.colors.len()));
        if room < wanted {
            return refused(format!("room for {room} triangles; {wanted} may be needed"));
        }
        recording.fill(buffers.counts.view(), 0);
        recording.fill(buffers.counts.slice(Word::Crossing as usize..Word::Total as usize)?, NONE);
        recording.copy(input.sites, buffers.word(Word::Sites)?);
        let [necks, ghosts] = [buffers.word(Word::Necks)?, buffers.word(Word::Ghosts)?];
        let [crossing, uncolored] = [buffers.word(Word::Crossing)?, buffers.word(Word::Uncolored)?];
        let (colors, sites, first) = (input.colors, input.sites, buffers.first.view());
        let arguments = DualizeCountArgs {
            colors,
            sites,
            vertices: buffers.vertices.view().cast(),
            counts: first,
            necks,
            ghosts,
            crossing,
            uncolored,
            width,
            height,
        };
        recording.dispatch(&self.count, count_groups(input.size), &arguments);
        let total = buffers.word(Word::Total)?;
        buffers.scan.record(recording, first.len(), first, first, Some(total));
        let slots = mesh.slots();
        let arguments = DualizeCheckArgs { sites, total, crossing, uncolored, slots, limit: room as u32 };
        recording.dispatch(&self.check, [1, 1, 1], &arguments);
        let arguments = DualizeWriteArgs {
            colors,
            pixels: input.pixels.cast(),
            vertices: buffers.vertices.view().cast(),
            first,
            slots,
            triangles: mesh.corners(),
            links: mesh.twins(),
            lost: buffers.word(Word::Lost)?,
            folded: buffers.word(Word::Folded)?,
            far: buffers.far.view().cast(),
            far_count: buffers.word(Word::Far)?,
            width,
            height,
            far_limit: buffers.far.len() as u32,
        };
        recording.dispatch(&self.write, write_groups(input.size), &arguments);
        let arguments = DualizeLeapArgs {
            colors,
            pixels: input.pixels.cast(),
            vertices: buffers.vertices.view().cast(),
            first,
            triangles: mesh.corners(),
            links: mesh.twins(),
            lost: buffers.word(Word::Lost)?,
            far: buffers.far.view().cast(),
            far_count: buffers.word(Word::Far)?,
            width,
            height,
            far_limit: buffers.far.len() as u32,
        };
        recording.dispatch(&self.leap, LEAP_GROUPS, &arguments);
        Ok(Read { words: recording.read(buffers.counts.view()), width })
    }
}

/// Where the counts will be found in the report of a run.
#[derive(Clone, Copy, Debug)]
pub struct Read {
    words: ReadBack,
    width: u32,
}

impl Read {
    /// The counts, or what was wrong with the diagram.
    ///
    /// # Errors
    ///
    /// Those of [`reference::dual`](crate::reference::dual), and [`DualizeError::NotCounterclockwise`]. A site that no
    /// region belongs to does not show here; it does in the certificate of the next stage.
    pub fn result(&self, report: &RunReport) -> Result<Counts, DualizeError> {
        let words = report.words(self.words);
        let word = |word: Word| words.get(word as usize).copied().unwrap_or(NONE);
        let corner = |i: u32| DualizeError::CrossingNecks { x: i % (self.width + 1), y: i / (self.width + 1) };
        let (total, sites) = (word(Word::Total) as usize, word(Word::Sites) as usize);
        let expected = crate::reference::kernels::dualize::triangles_of(sites);
        if word(Word::Uncolored) != NONE {
            let index = word(Word::Uncolored) as usize;
            return Err(DualizeError::Mismatch { what: "a pixel without the color of a site", index });
        }
        if let Some(&place) = [word(Word::Crossing), word(Word::Lost)].iter().find(|&&place| place != NONE) {
            return Err(corner(place));
        }
        if total != expected {
            return Err(DualizeError::NotASphere { triangles: total, sites, expected });
        }
        if word(Word::Folded) != NONE {
            let triangle = word(Word::Folded) as usize;
            return Err(DualizeError::NotCounterclockwise { stage: "dualize", triangle });
        }
        Ok(Counts {
            sites: sites as u64,
            triangles: total as u64,
            ghosts: word(Word::Ghosts).into(),
            necks: word(Word::Necks).into(),
        })
    }
}
