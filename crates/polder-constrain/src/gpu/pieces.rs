//! Long walks in pieces: one invocation for a walk of thousands of triangles is a chain of as many dependent reads.
//!
//! 1. *Seeds.* A coarse grid over the vertices, a few of them to a cell, has up to two vertices of each cell.
//! 2. *Plan.* A *walker* (what is to walk: a pair of vertices) has one piece for about [`TRIANGLES`] triangles that it can
//!    be expected to cross, or for several times as many if there is no room for all these pieces. The later ones of all walkers
//!    stand in a list, those of one walker together.
//! 3. *Beginnings.* Where a piece is to begin, a vertex to the left of the walker and one to the right are taken from cells
//!    nearby. A walk from the one to the other comes over an edge that the walker crosses; exact signs say that it does.
//!    It must not lie far off along the walker, else pieces begin out of order. A vertex on the walker serves as well. Where nothing is found the piece has no beginning, and the one before goes on.
//!
//! A piece ends where the next one begins that has a beginning, or else at the end of the walker. Nobody knows whether
//! beginnings stand in order along the walker. If they do not, a piece comes to the end though there are later ones; then the
//! pieces up to the first that came to the end are the whole walk, and the others are superfluous.
//!
//! Which vertices are seeds, and so where pieces begin, may differ from run to run. What walks find does not depend on it.
//!
//! Known before: \[QCT\] walks each constraint in one thread.

use crate::kernels::*;
use glam::DVec2;
use polder_flip::gpu::{Arithmetic, Mesh};
use polder_vulkan::{Buffer, Device, Error, Estimate, Kernel, Pool, Recording, View, groups_for};

const NONE: u32 = u32::MAX;
const WORKGROUP: u32 = 256;
/// Workgroups of kernels that stride over lists whose length only the device knows.
const GROUPS: u32 = 1056;

/// Triangles that a piece is meant to have.
pub const TRIANGLES: u32 = 32;

/// A coarse grid over points. Integers decide what lies where.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    /// Places are multiples of 2 to this power, 64 of them to the side of a cell.
    exponent: i32,
    /// The place of the lower left corner.
    low: [i64; 2],
    /// Cells in a row, and rows.
    size: [u32; 2],
    /// The length of a piece, in places.
    piece_length: u32,
    /// Finer places, and that of the lower left corner.
    fine_exponent: i32,
    fine_low: [i64; 2],
}

impl Grid {
    /// Over the bounding box of so many points; two to eight of them to a cell, if they lie everywhere.
    pub fn over(low: DVec2, high: DVec2, points: usize) -> Self {
        let cells = cells_of(points) as u64;
        let largest = low.abs().max(high.abs()).max_element();
        let finest = (largest.to_bits() >> 52 & 0x7ff).max(1) as i32 - 1075;
        let mut exponent = finest;
        loop {
            let place = |p: DVec2| p.to_array().map(|x| floor_units(x, exponent));
            let (from, to) = (place(low), place(high));
            let size = [0, 1].map(|k| ((to[k].saturating_sub(from[k]).max(0) >> 6) + 1) as u64);
            // Coordinates have 54 bits in the first of these units.
            if size[0].saturating_mul(size[1]) <= cells || exponent > 1024 {
                // A line crosses about two edges where it passes by one point, as points of a lattice lie.
                let points_a_cell = points.max(1) as f64 / (size[0] * size[1]).max(1) as f64;
                let cells_a_piece = f64::from(TRIANGLES) / (2.2 * points_a_cell.sqrt());
                let piece_length = (64.0 * cells_a_piece).clamp(64.0, 1e6) as u32;
                let fine_exponent = finest.max(exponent - 14);
                let fine_low = low.to_array().map(|x| floor_units(x, fine_exponent));
                let size = size.map(|n| n.min(cells) as u32);
                return Self { exponent, low: from, size, piece_length, fine_exponent, fine_low };
            }
            exponent += 1;
        }
    }

    /// Cells in a row, and rows.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The length of a piece, in 64ths of a cell.
    #[doc(hidden)]
    pub fn piece_length(&self) -> u32 {
        self.piece_length
    }

    /// The length of a piece other than the usual one, in 64ths of a cell: for tests.
    #[doc(hidden)]
    pub fn with_piece_length(self, piece_length: u32) -> Self {
        Self { piece_length: piece_length.max(1), ..self }
    }

    /// The exponent of places finer than those of cells, and where they begin.
    #[doc(hidden)]
    pub fn fine(&self) -> (i32, [i64; 2]) {
        (self.fine_exponent, self.fine_low)
    }

    /// In which of so many buckets along a line a point on it falls: for tests.
    #[doc(hidden)]
    pub fn bucket(&self, line: [DVec2; 2], p: DVec2, buckets: u32) -> usize {
        let (exponent, low) = self.fine();
        let [from, to, at] = [line[0], line[1], p].map(|p| [0, 1].map(|k| floor_units(p[k], exponent) - low[k]));
        let across = [0, 1].map(|k| (to[k] - from[k]).abs());
        let k = usize::from(across[0] < across[1]);
        let bucket = (at[k] - from[k]).abs() * i64::from(buckets) / across[k].max(1);
        bucket.min(i64::from(buckets) - 1) as usize
    }

    /// The cell of a point, by its number.
    pub fn cell(&self, p: DVec2) -> usize {
        let [x, y] = [0, 1].map(|k| {
            let place = floor_units(p[k], self.exponent).saturating_sub(self.low[k]) >> 6;
            place.clamp(0, i64::from(self.size[k]) - 1) as usize
        });
        y * self.size[0] as usize + x
    }

    /// Whether what lies between two points is near enough to where piece `number` of `count` is to begin: for tests.
    #[doc(hidden)]
    pub fn is_near(&self, line: [DVec2; 2], number: u32, count: u32, between: [DVec2; 2]) -> bool {
        let at = |p: DVec2| [0, 1].map(|k| floor_units(p[k], self.exponent) - self.low[k]);
        let ([from, to], [p, q]) = (line.map(at), between.map(at));
        let across = [0, 1].map(|k| to[k] - from[k]);
        let k = usize::from(across[0].abs() < across[1].abs());
        let place = from[k] + across[k] * i64::from(number) / i64::from(count);
        (((p[k] + q[k]) >> 1) - place).abs() * 2 <= across[k].abs() / i64::from(count)
    }

    /// The seeds near where piece `number` of `count` is to begin, in the order in which they are looked at: for tests.
    #[doc(hidden)]
    pub fn seeds_near(&self, line: [DVec2; 2], number: u32, count: u32, seeds: &[[u32; 2]]) -> Vec<u32> {
        let [from, to] = line.map(|p| [0, 1].map(|k| floor_units(p[k], self.exponent) - self.low[k]));
        let across = [0, 1].map(|k| to[k] - from[k]);
        let cell = [0, 1].map(|k| {
            let place = from[k] + across[k] * i64::from(number) / i64::from(count);
            (place >> 6).clamp(0, i64::from(self.size[k]) - 1)
        });
        let aside = if across[0].abs() >= across[1].abs() { [0, 1] } else { [1, 0] };
        let along = [aside[1], aside[0]];
        let rings = (1..=3)
            .flat_map(|r| [along.map(|x| r * x), aside.map(|x| -r * x), aside.map(|x| r * x), along.map(|x| -r * x)]);
        let inside = |k: usize, x: i64| (0..i64::from(self.size[k])).contains(&x);
        let cells = std::iter::once([0, 0]).chain(rings).map(|by: [i64; 2]| [cell[0] + by[0], cell[1] + by[1]]);
        let cells = cells.filter(|&[x, y]| inside(0, x) && inside(1, y));
        let both = cells.flat_map(|[x, y]| seeds[y as usize * self.size[0] as usize + x as usize]);
        both.filter(|&v| v != NONE).collect()
    }

    /// How many pieces a walker has, if there is room for all.
    pub fn pieces(&self, [a, b]: [DVec2; 2]) -> u32 {
        let places = [a, b].map(|p| p.to_array().map(|x| floor_units(x, self.exponent)));
        let [x, y] = [0, 1].map(|k| places[0][k].abs_diff(places[1][k]));
        let length = x.max(y) + x.min(y) * 3 / 8;
        (length / u64::from(self.piece_length)).clamp(1, 4096) as u32
    }
}

/// Cells that a grid over so many points may have.
fn cells_of(points: usize) -> usize {
    (points / 2).max(1)
}

/// floor(x / 2^exponent), saturated at 62 bits.
fn floor_units(x: f64, exponent: i32) -> i64 {
    let bits = x.to_bits();
    let biased = (bits >> 52 & 0x7ff) as i32;
    let magnitude = (bits & ((1 << 52) - 1)) as i64 | i64::from(biased > 0) << 52;
    let significand = if x.is_sign_negative() { -magnitude } else { magnitude };
    match biased.max(1) - 1075 - exponent {
        shift @ ..0 => significand >> (-shift).min(63),
        shift @ 0..=9 => significand << shift,
        10.. => significand.signum() << 62,
    }
}

/// A grid's seeds, and a list of later pieces.
#[derive(Debug)]
pub struct Buffers {
    seeds: Buffer<[u32; 2]>,
    pieces: Buffer<[u32; 4]>,
    count: Buffer<u32>,
}

impl Buffers {
    /// What [`Buffers::new`] will hold.
    pub fn estimate(vertices: usize, pieces: usize) -> Estimate {
        Estimate::new()
            .buffer::<[u32; 2]>("seeds", cells_of(vertices))
            .buffer::<[u32; 4]>("pieces", pieces)
            .buffer::<u32>("piece count", 4)
    }

    /// Memory for grids over so many vertices, and so many pieces.
    ///
    /// # Errors
    ///
    /// If the memory cannot be had.
    pub fn new(device: &Device, vertices: usize, pieces: usize) -> Result<Self, Error> {
        Ok(Self {
            seeds: Buffer::new(device, "seeds", cells_of(vertices))?,
            pieces: Buffer::new(device, "pieces", pieces)?,
            count: Buffer::new(device, "piece count", 4)?,
        })
    }

    /// Gives all of it; see [`Buffer::give`].
    pub fn give(&self, pool: &Pool) {
        self.seeds.give(pool);
        self.pieces.give(pool);
    }

    /// Up to two vertices of each cell, row by row; else [`NONE`](polder_mesh::NONE).
    pub fn seeds(&self) -> View<'_, [u32; 2]> {
        self.seeds.view()
    }

    /// Later pieces, four words each: see `pieces.glsl`.
    pub fn pieces(&self) -> View<'_, [u32; 4]> {
        self.pieces.view()
    }

    /// How many there are, in the first word; and how many were wanted, in the third and fourth.
    pub fn count(&self) -> View<'_, u32> {
        self.count.view()
    }
}

/// What is to walk, on a mesh whose vertices know a half-edge that leaves them and how many do.
#[derive(Clone, Copy, Debug)]
pub struct Walkers<'a> {
    /// By walker its two vertices. It walks from the one with fewer edges, of two like ones from the first.
    pub ends: View<'a, [u32; 2]>,
    /// The walkers that walk.
    pub list: View<'a, u32>,
    /// One word: how many there are.
    pub listed: View<'a, u32>,
    /// By walker, written for those listed: where its later pieces stand, or [`NONE`](polder_mesh::NONE).
    pub runs: View<'a, u32>,
    /// By vertex a half-edge that leaves it.
    pub spokes: View<'a, u32>,
    /// By vertex how many do.
    pub degrees: View<'a, u32>,
    /// By walker: whether it goes in one piece, in the second bit.
    pub known: Option<View<'a, u32>>,
}

/// The kernels on one device.
#[derive(Debug)]
pub struct Stage {
    sow: Kernel<SowSeeds>,
    count: Kernel<CountPieces>,
    plan: Kernel<PlanPieces>,
    find: Kernel<FindBeginnings>,
}

impl Stage {
    /// Compiles them.
    ///
    /// # Errors
    ///
    /// Those of the device.
    pub fn new(device: &Device, arithmetic: Arithmetic) -> Result<Self, Error> {
        let workgroup = [("WORKGROUP", WORKGROUP)];
        Ok(Self {
            sow: Kernel::new(device, &workgroup)?,
            count: Kernel::new(device, &workgroup)?,
            plan: Kernel::new(device, &workgroup)?,
            find: arithmetic.kernel(device, &workgroup)?,
        })
    }

    /// Step 1. A point whose spoke is [`NONE`](polder_mesh::NONE) is no vertex. Once for any number of plans: vertices stay.
    ///
    /// # Errors
    ///
    /// If the buffers are for fewer vertices.
    pub fn record_seeds(
        &self,
        recording: &mut Recording,
        mesh: &Mesh,
        spokes: View<'_, u32>,
        grid: Grid,
        buffers: &Buffers,
    ) -> Result<(), Error> {
        let (cells, vertices) = (grid.size[0] as usize * grid.size[1] as usize, mesh.vertices().min(spokes.len()));
        if cells > buffers.seeds.len() {
            let why = format!("a grid of {cells} cells; buffers for {}", buffers.seeds.len());
            return Err(Error::Recording { command: "seeds", why });
        }
        let seeds = buffers.seeds.view().cast();
        recording.fill(seeds, NONE);
        let arguments = SowSeedsArgs {
            positions: mesh.positions().cast(),
            spokes,
            seeds,
            low_x: grid.low[0],
            low_y: grid.low[1],
            exponent: grid.exponent,
            width: grid.size[0],
            height: grid.size[1],
            vertices: vertices as u32,
        };
        recording.dispatch(&self.sow, groups_for(vertices, WORKGROUP), &arguments);
        Ok(())
    }

    /// Steps 2 and 3: later pieces for all listed walkers.
    pub fn record(&self, recording: &mut Recording, mesh: &Mesh, walkers: &Walkers<'_>, grid: Grid, buffers: &Buffers) {
        let (low_x, low_y, exponent) = (grid.low[0], grid.low[1], grid.exponent);
        let (positions, ends) = (mesh.positions().cast(), walkers.ends.cast());
        let (pieces, piece_count) = (buffers.pieces.view(), buffers.count.view());
        let piece_limit = pieces.len() as u32;
        recording.fill(piece_count, 0);
        let groups = strides(walkers.list.len());
        let arguments = CountPiecesArgs {
            positions,
            ends,
            list: walkers.list,
            listed: walkers.listed,
            known: walkers.known,
            piece_count,
            exponent,
            limit: walkers.list.len() as u32,
            piece_length: grid.piece_length,
        };
        recording.dispatch(&self.count, groups, &arguments);
        let arguments = PlanPiecesArgs {
            positions,
            ends,
            list: walkers.list,
            listed: walkers.listed,
            known: walkers.known,
            runs: walkers.runs,
            pieces,
            piece_count,
            exponent,
            limit: walkers.list.len() as u32,
            piece_limit,
            piece_length: grid.piece_length,
        };
        recording.dispatch(&self.plan, groups, &arguments);
        let arguments = FindBeginningsArgs {
            triangles: mesh.corners(),
            links: mesh.twins(),
            positions,
            ends,
            spokes: walkers.spokes,
            degrees: walkers.degrees,
            seeds: buffers.seeds.view().cast(),
            pieces,
            piece_count,
            low_x,
            low_y,
            exponent,
            width: grid.size[0],
            height: grid.size[1],
            piece_limit,
        };
        recording.dispatch(&self.find, strides(pieces.len()), &arguments);
    }
}

/// Workgroups that stride over up to so many items.
pub(super) fn strides(items: usize) -> [u32; 3] {
    [(items as u64).div_ceil(WORKGROUP.into()).clamp(1, GROUPS.into()) as u32, 1, 1]
}
