//! Radix sort: keys of u32 or u64 with values of u32, least digit first, stable.
//!
//! A pass for each 8 bits: count the digits of each tile, scan the counts digit by digit, move each tile's keys and values
//! to their places. The middle step is [`Scan`].

use super::{Copier, Count, MOST, Scan, holds};
use crate::Error;
use crate::buffer::{Buffer, View};
use crate::device::Device;
use crate::kernel::Kernel;
use crate::kernels::{
    SortCountU32, SortCountU32Args, SortCountU64, SortCountU64Args, SortMoveU32, SortMoveU32Args, SortMoveU64,
    SortMoveU64Args,
};
use crate::memory::Estimate;
use crate::pool::Pool;
use crate::recording::{Recording, groups_for};
use crate::shader::Shader;
use bytemuck::Pod;

const NAME: &str = "sort";
const DIGITS: usize = 256;
const DIGIT_BITS: u32 = 8;

/// Keys that can be sorted: u32 and u64.
pub trait SortKey: Pod + sealed::Key {}

pub(super) mod sealed {
    use super::*;

    /// What both kernels of a pass are told.
    #[derive(Clone, Copy)]
    pub struct Pass<'a, K> {
        pub from: (View<'a, K>, Option<View<'a, u32>>),
        pub to: (View<'a, K>, Option<View<'a, u32>>),
        pub counts: View<'a, u32>,
        pub count: Count<'a>,
        pub tiles: u32,
        pub shift: u32,
        pub mask: u32,
    }

    pub trait Key: Sized {
        type Count: Shader;
        type Move: Shader;
        fn count_args(pass: Pass<'_, Self>) -> <Self::Count as Shader>::Args<'_>;
        fn move_args(pass: Pass<'_, Self>) -> <Self::Move as Shader>::Args<'_>;
    }
}

use sealed::Pass;

macro_rules! sort_key {
    ($key:ty, $count:ident, $count_args:ident, $move:ident, $move_args:ident) => {
        impl SortKey for $key {}
        impl sealed::Key for $key {
            type Count = $count;
            type Move = $move;
            fn count_args(pass: Pass<'_, $key>) -> $count_args<'_> {
                let Pass { from, counts, count, tiles, shift, mask, .. } = pass;
                let limit = count.limit();
                $count_args { keys: from.0, counts, counter: count.counter, limit, tiles, shift, mask }
            }
            fn move_args(pass: Pass<'_, $key>) -> $move_args<'_> {
                let Pass { from, to, counts, count, tiles, shift, mask } = pass;
                $move_args {
                    keys: from.0,
                    values: from.1,
                    moved_keys: to.0,
                    moved_values: to.1,
                    starts: counts,
                    counter: count.counter,
                    limit: count.limit(),
                    tiles,
                    shift,
                    mask,
                }
            }
        }
    };
}

sort_key!(u32, SortCountU32, SortCountU32Args, SortMoveU32, SortMoveU32Args);
sort_key!(u64, SortCountU64, SortCountU64Args, SortMoveU64, SortMoveU64Args);

/// Sizes of the sort's workgroups.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SortShape {
    /// Invocations.
    pub workgroup: u32,
    /// Keys of an invocation.
    pub items: u32,
}

impl SortShape {
    /// What fits the device: 16 subgroups, or as many as it takes; as many keys as its shared memory holds.
    pub fn for_device<K: SortKey>(device: &Device) -> Self {
        let limits = device.info().limits;
        let workgroup = (16 * limits.subgroup).min(512).min(limits.workgroup_invocations);
        // Beside the pool stand a base for each digit and the sums of a scan.
        let words = (limits.shared_bytes / 4).saturating_sub(DIGITS as u32 + workgroup / 4 + 64);
        let key_words = size_of::<K>() as u32 / 4;
        SortShape { workgroup, items: (words / (workgroup * key_words)).clamp(1, 8) }
    }

    fn tile(&self) -> usize {
        (self.workgroup * self.items) as usize
    }

    /// Words of shared memory for counters, and then for keys.
    fn pool<K: SortKey>(&self, subgroup: u32) -> u32 {
        let counters = DIGITS as u32 * self.workgroup.div_ceil(subgroup);
        counters.max(self.workgroup * self.items * (size_of::<K>() as u32 / 4))
    }
}

/// Sorts in place, through memory of its own as large as keys and values.
#[derive(Debug)]
pub struct Sort<K: SortKey> {
    count: Kernel<K::Count>,
    moving: Kernel<K::Move>,
    scan: Scan,
    copier: Copier,
    counts: Buffer<u32>,
    keys: Buffer<K>,
    values: Buffer<u32>,
    shape: SortShape,
    capacity: usize,
}

impl<K: SortKey> Sort<K> {
    /// What a sort of so many keys holds.
    pub fn estimate(device: &Device, capacity: usize) -> Estimate {
        let counts = DIGITS * capacity.div_ceil(SortShape::for_device::<K>(device).tile());
        Estimate::new()
            .buffer::<K>("sort: keys", capacity)
            .buffer::<u32>("sort: values", capacity)
            .buffer::<u32>("sort: counts", counts)
            .and(Scan::estimate(counts))
    }

    /// For up to `capacity` keys, at most [`MOST`], or half as many of 8 bytes.
    pub fn new(device: &Device, capacity: usize) -> Result<Self, Error> {
        Sort::with_shape(device, capacity, SortShape::for_device::<K>(device))
    }

    /// With workgroups of another shape: for measurements.
    pub fn with_shape(device: &Device, capacity: usize, shape: SortShape) -> Result<Self, Error> {
        let capacity = capacity.min(MOST / (size_of::<K>() / 4));
        let subgroup = device.info().limits.subgroup;
        let (workgroup, items) = (("WORKGROUP", shape.workgroup), ("ITEMS", shape.items));
        let pool = ("POOL", shape.pool::<K>(subgroup));
        let counts = DIGITS * capacity.div_ceil(shape.tile().max(1));
        Ok(Sort {
            count: Kernel::new(device, &[workgroup, items])?,
            moving: Kernel::new(device, &[workgroup, items, ("SUBGROUP", subgroup), pool])?,
            scan: Scan::new(device, counts)?,
            copier: Copier::new(device)?,
            counts: Buffer::new(device, "sort: counts", counts)?,
            keys: Buffer::new(device, "sort: keys", capacity)?,
            values: Buffer::new(device, "sort: values", capacity)?,
            shape,
            capacity,
        })
    }

    /// Gives the memory that is as large as keys and values; see [`Buffer::give`].
    pub fn give(&self, pool: &Pool) {
        self.keys.give(pool);
        self.values.give(pool);
    }

    /// Sorts keys, and values along, by the lowest `bits` of the keys; equal ones stay in the order that they have. Time
    /// goes with bits: say how many can differ. Keys beyond a count on the device may be overwritten.
    pub fn record<'a>(
        &self,
        recording: &mut Recording,
        count: impl Into<Count<'a>>,
        keys: View<'a, K>,
        values: Option<View<'a, u32>>,
        bits: u32,
    ) {
        let count = count.into();
        let limit = count.limit;
        if bits > 8 * size_of::<K>() as u32 {
            return recording.fail(NAME, format!("{bits} bits of a key"));
        }
        if !count.fits(recording, NAME, self.capacity)
            || !holds(recording, NAME, keys, limit)
            || values.is_some_and(|values| !holds(recording, NAME, values, limit))
        {
            return;
        }
        self.passes(recording, count, keys, values, bits);
    }

    fn passes<'b>(
        &'b self,
        recording: &mut Recording,
        count: Count<'b>,
        keys: View<'b, K>,
        values: Option<View<'b, u32>>,
        bits: u32,
    ) {
        let tiles = count.limit.div_ceil(self.shape.tile());
        let groups = groups_for(count.limit, self.shape.tile() as u32);
        let other = (self.keys.view(), values.map(|_| self.values.view()));
        let (mut from, mut to) = ((keys, values), other);
        for shift in (0..bits).step_by(DIGIT_BITS as usize) {
            let mask = (1 << (bits - shift).min(DIGIT_BITS)) - 1;
            let counts = self.counts.view();
            let pass = Pass { from, to, counts, count, tiles: tiles as u32, shift, mask };
            recording.dispatch(&self.count, groups, &K::count_args(pass));
            self.scan.record(recording, DIGITS * tiles, counts, counts, None);
            recording.dispatch(&self.moving, groups, &K::move_args(pass));
            std::mem::swap(&mut from, &mut to);
        }
        if bits.div_ceil(DIGIT_BITS) % 2 == 1 {
            // `from` is where the last pass wrote.
            if let (Ok(sorted), Ok(place)) = (from.0.slice(0..count.limit), keys.slice(0..count.limit)) {
                self.copier.record(recording, sorted, place);
            }
            if let (Some(sorted), Some(values)) = (from.1, values)
                && let (Ok(sorted), Ok(place)) = (sorted.slice(0..count.limit), values.slice(0..count.limit))
            {
                self.copier.record(recording, sorted, place);
            }
        }
    }
}
