//! Stage 3 on the device.
//!
//! 1. *Pin.* One kernel tests all triangles, with every site at its true position, and puts half-edges out of the corners
//!    of bad ones on a list. Rounds then work on the end of that list: its sites go to their pixel centers, which are
//!    computed from the pixels in integers, and the triangles around them are tested.
//! 2. *Unpin.* Rounds over lists of the pinned sites. A site is tried in the round in which no neighbor of lower priority
//!    waits; the rounds in which sites were tried are kept, so that finding and trying are one kernel.
//! 3. *Close.* `polder-flip` closes the hull. Ghost flips leave finite triangles as they are, and so the half-edges of
//!    pinned sites stay theirs. The first step has listed the ghost's edges.
//! 4. *Take out*, in rounds of three steps: find the sites that go, in two turns; cut their stars, each within its own triangles; link
//!    the stars' outer edges to what is across. See [`reference`](mod@crate::reference). Many small stars are cut by one
//!    invocation each, which reads all of a star, decides by the f64 filter alone, and then writes; few or large ones, and
//!    what the filter leaves open, by a workgroup each, in shared memory.
//!
//! Walks around vertices are chains of reads that wait for each other. So the neighbors of pinned sites are kept when they
//! are pinned, and a site that waits remembers one that it waits for, and does not look around before that one is done.
//!
//! Step 1 reads all triangles once, everything else lists. Sites on lists are in order of arrival, and nothing depends on
//! that order. Positions are those of the mesh: true ones but for pinned sites, and at the end true ones.
//!
//! Rounds are recorded in batches. A batch that does not suffice is noticed when the recording has run ahead
//! ([`Recording::repeat_ahead`]), so the host waits for nothing else.
//!
//! Departures from the reference: the certificates are not checked here.

use super::shift_buffers::{Row, Word};
use crate::kernels::*;
use glam::DVec2;
use polder_flip::gpu::{Arithmetic, EdgeList, Mesh, Tally};
use polder_voronoi::GridMapping;
use polder_vulkan::{Device, DeviceKind, Error, Estimate, Kernel, Recording, View};

pub use super::shift_buffers::{Buffers, Counts, Read};

/// Rounds of a batch: even where two lists change places. Rings pin in 3 to 8 rounds and unpin in 15; what is left to do
/// after a batch costs more than an empty round, since all that follows has to be sent again.
pub(super) const PIN_ROUNDS: u32 = 8;
pub(super) const UNPIN_ROUNDS: u32 = 16;
pub(super) const OUT_ROUNDS: u32 = 4;
/// Workgroups of a wide kernel, whose invocations stride over their items.
const WIDE: u32 = 2112;
/// Wide rounds after the first that close the hull.
const HULL_WIDE: usize = 5;
/// Stars that are cut by workgroups at a time.
const STARS: u32 = 1056;
const WIDE_ON_CPU: u32 = 16;
/// Invocations that share a star.
const WORKGROUP_OF_STAR: u32 = 32;

/// What the stage takes beside the dualized mesh, all on the device.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// The mapping that gave the sites their pixels.
    pub mapping: &'a GridMapping,
    /// All points by input index.
    pub points: View<'a, DVec2>,
    /// The input index of each point in the new order, sites first.
    pub order: View<'a, u32>,
    /// The pixel of each site, and of further points perhaps.
    pub pixels: View<'a, [u16; 2]>,
    /// How many sites there are.
    pub sites: View<'a, u32>,
}

/// What the predicates' ARITHMETIC is in a kernel that has the filter alone.
const FILTER: u32 = 0;

/// The flips that close the hull: kernels, memory for as many slots as the mesh has, and where to count them.
#[derive(Clone, Copy, Debug)]
pub struct Flips<'a> {
    /// The kernels.
    pub stage: &'a polder_flip::gpu::Stage,
    /// Their memory, over which [`record_start`](polder_flip::gpu::Stage::record_start) has been recorded.
    pub buffers: &'a polder_flip::gpu::Buffers,
    /// Flips are added to this.
    pub tally: &'a Tally,
}

/// The kernels of the stage on one device.
#[derive(Debug)]
pub struct Stage {
    pub(super) device: Device,
    pub(super) groups: [u32; 3],
    pub(super) stars: [u32; 3],
    shift_move: Kernel<ShiftMove>,
    pin_triangles: Kernel<PinTriangles>,
    pin_stars: Kernel<PinStars>,
    unpin_stars: Kernel<UnpinStars>,
    unpin_finish: Kernel<UnpinFinish>,
    pub(super) advance: Kernel<ShiftAdvance>,
    pub(super) elect: Kernel<TakeoutElect>,
    /// Leaves to the next one what the filter leaves; not there where there is no f64.
    pub(super) cut_by_filter: Option<Kernel<TakeoutCut>>,
    pub(super) cut: Kernel<TakeoutCut>,
    pub(super) link: Kernel<TakeoutLink>,
    pub(super) heirs: Kernel<TakeoutHeirs>,
}

impl Stage {
    /// Compiles the kernels.
    ///
    /// # Errors
    ///
    /// Those of the device.
    pub fn new(device: &Device, arithmetic: Arithmetic) -> Result<Self, Error> {
        let wide = if device.info().kind == DeviceKind::Cpu { WIDE_ON_CPU } else { WIDE };
        // The filter for small stars, each by one invocation; for others, a small workgroup each.
        let filtered = arithmetic == Arithmetic::Filtered;
        let small = WORKGROUP_OF_STAR.max(device.info().limits.subgroup);
        let constants: &[_] = if filtered { &[("WORKGROUP", small)] } else { &[] };
        let filter = || Kernel::new(device, &[("ARITHMETIC", FILTER)]);
        Ok(Self {
            device: device.clone(),
            groups: [wide, 1, 1],
            stars: [wide.min(STARS), 1, 1],
            shift_move: Kernel::new(device, &[])?,
            pin_triangles: arithmetic.kernel(device, &[])?,
            pin_stars: arithmetic.kernel(device, &[])?,
            unpin_stars: arithmetic.kernel(device, &[])?,
            unpin_finish: Kernel::new(device, &[])?,
            advance: Kernel::new(device, &[])?,
            elect: Kernel::new(device, &[])?,
            cut_by_filter: filtered.then(filter).transpose()?,
            cut: arithmetic.kernel(device, constants)?,
            link: Kernel::new(device, &[])?,
            heirs: Kernel::new(device, &[])?,
        })
    }

    /// What [`Stage::buffers`] will hold.
    pub fn estimate(sites: usize) -> Estimate {
        super::shift_buffers::estimate(sites)
    }

    /// Results and scratch memory for up to so many sites, at least one.
    ///
    /// # Errors
    ///
    /// If the memory cannot be had: then before any of it is allocated.
    pub fn buffers(&self, sites: usize) -> Result<Buffers, Error> {
        Buffers::new(&self.device, sites)
    }

    /// The whole stage, over a dualized mesh: its triangles, links and slots. It writes the positions of all points, and
    /// [`Buffers::heirs`], [`Buffers::freed`] and [`Buffers::taken`]. What the flips did is for their tally to say.
    ///
    /// # Errors
    ///
    /// If the parts are not of one size.
    pub fn record(
        &self,
        recording: &mut Recording,
        input: Input<'_>,
        mesh: &Mesh,
        flips: Flips<'_>,
        buffers: &Buffers,
    ) -> Result<Read, Error> {
        let hull = flips.buffers.list();
        self.record_pin(recording, input, mesh, hull, buffers)?;
        flips.stage.record_close_hull(recording, mesh, flips.buffers, Some((hull, HULL_WIDE)), flips.tally)?;
        let unclosed = recording.read(flips.buffers.pending()?);
        self.record_take_out(recording, input, mesh, buffers)?;
        Ok(buffers.read(recording, unclosed))
    }

    /// Steps 1 and 2: afterwards sites are where they stay until they are taken out, and `hull` lists all edges to the
    /// ghost.
    ///
    /// # Errors
    ///
    /// As [`Stage::record`].
    pub fn record_pin(
        &self,
        recording: &mut Recording,
        input: Input<'_>,
        mesh: &Mesh,
        hull: &EdgeList,
        buffers: &Buffers,
    ) -> Result<(), Error> {
        buffers.check(input, mesh)?;
        recording.fill(buffers.words.view(), 0);
        hull.record_clear(recording);
        let (words, state, pinned) = (buffers.words.view(), buffers.state.view(), buffers.all.view());
        let (triangles, links) = (mesh.corners(), mesh.twins());
        let positions: View<'_, [u32; 4]> = mesh.positions().cast();
        let points: View<'_, [u32; 4]> = input.points.cast();
        let arguments = ShiftMoveArgs {
            points,
            order: input.order,
            positions,
            state,
            sites: input.sites,
            count: input.points.len() as u32,
            limit: buffers.sites as u32,
        };
        recording.dispatch(&self.shift_move, self.groups, &arguments);

        let arguments = PinTrianglesArgs {
            triangles,
            positions,
            state,
            pinned,
            words,
            slots: mesh.slots(),
            hull: hull.edges(),
            hull_count: hull.count(),
            hull_limit: hull.limit(),
            limit: mesh.capacity().min(buffers.edges.len()) as u32,
        };
        recording.dispatch(&self.pin_triangles, self.groups, &arguments);
        let [translation_x, translation_y] = input.mapping.translation();
        let [exponent_x, exponent_y] = input.mapping.exponents();
        let [half_side_x, half_side_y] = input.mapping.sides().map(|side| side / 2);
        let bound = buffers.sites as u32;
        recording.repeat_ahead("pinning", buffers.word(Word::PinLeft)?, bound, 1, 2, |body| {
            for round in 0..PIN_ROUNDS {
                let arguments = PinStarsArgs {
                    triangles,
                    links,
                    positions,
                    state,
                    pinned,
                    words,
                    pixels: input.pixels.cast(),
                    translation_x,
                    translation_y,
                    exponent_x,
                    exponent_y,
                    half_side_x,
                    half_side_y,
                    rings: buffers.edge_of.view(),
                    ring_limit: buffers.rings(),
                    round,
                };
                body.dispatch(&self.pin_stars, self.groups, &arguments);
            }
            self.record_advance(body, mesh, buffers, Row::Pin, PIN_ROUNDS);
            for round in 0..UNPIN_ROUNDS {
                let [waiting, later] = buffers.lists(round);
                let arguments = UnpinStarsArgs {
                    triangles,
                    links,
                    positions,
                    state,
                    points,
                    order: input.order,
                    all: pinned,
                    waiting,
                    later,
                    rings: buffers.edge_of.view(),
                    words,
                    ring_limit: buffers.rings(),
                    round,
                };
                body.dispatch(&self.unpin_stars, self.groups, &arguments);
            }
            self.record_advance(body, mesh, buffers, Row::Unpin, UNPIN_ROUNDS);
        });
        let [stuck, _] = buffers.lists(0);
        let arguments =
            UnpinFinishArgs { triangles, state, all: pinned, stuck, waits_for: buffers.freed.view().cast(), words };
        recording.dispatch(&self.unpin_finish, self.groups, &arguments);
        Ok(())
    }

    pub(super) fn record_advance(&self, body: &mut Recording, mesh: &Mesh, buffers: &Buffers, phase: Row, rounds: u32) {
        let (words, slots) = (buffers.words.view(), mesh.slots());
        let arguments = ShiftAdvanceArgs { words, slots, phase: phase as u32, rounds };
        body.dispatch(&self.advance, [1, 1, 1], &arguments);
    }
}
