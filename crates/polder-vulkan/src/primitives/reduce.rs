//! Reduction: sum, minimum, maximum.

use super::{Count, MOST, holds};
use crate::Error;
use crate::buffer::{Buffer, View};
use crate::device::Device;
use crate::kernel::Kernel;
use crate::kernels::{ReduceU32, ReduceU32Args, ReduceU64, ReduceU64Args};
use crate::recording::Recording;
use crate::shader::Shader;
use bytemuck::Pod;

const NAME: &str = "reduce";
const WORKGROUP: usize = 256;
/// Workgroups of the first pass, each of which writes one value for the second.
const GROUPS: usize = 1024;

/// What is made of two values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operation {
    /// The sum, wrapping around; of nothing it is 0.
    Sum,
    /// The minimum; of nothing it is the largest number.
    Minimum,
    /// The maximum; of nothing it is 0.
    Maximum,
}

/// Numbers that can be reduced: u32 and u64.
pub trait ReduceValue: Pod + sealed::Value {}

mod sealed {
    use super::*;
    pub trait Value: Sized {
        type Kernel: Shader;
        fn args<'a>(
            values: View<'a, Self>,
            results: View<'a, Self>,
            count: Count<'a>,
        ) -> <Self::Kernel as Shader>::Args<'a>;
    }
}

macro_rules! reduce_value {
    ($value:ty, $kernel:ident, $args:ident) => {
        impl ReduceValue for $value {}
        impl sealed::Value for $value {
            type Kernel = $kernel;
            fn args<'a>(values: View<'a, $value>, results: View<'a, $value>, count: Count<'a>) -> $args<'a> {
                $args { values, results, counter: count.counter, limit: count.limit() }
            }
        }
    };
}

reduce_value!(u32, ReduceU32, ReduceU32Args);
reduce_value!(u64, ReduceU64, ReduceU64Args);

/// One value out of many.
#[derive(Debug)]
pub struct Reduce<T: ReduceValue> {
    kernel: Kernel<T::Kernel>,
    partial: Buffer<T>,
}

impl<T: ReduceValue> Reduce<T> {
    /// For up to [`MOST`] values, or half as many of 8 bytes; holds a few KiB.
    pub fn new(device: &Device, operation: Operation) -> Result<Self, Error> {
        let constants = [("WORKGROUP", WORKGROUP as u32), ("OPERATION", operation as u32)];
        Ok(Reduce {
            kernel: Kernel::new(device, &constants)?,
            partial: Buffer::new(device, "partial results", GROUPS)?,
        })
    }

    /// Writes the result to the first of `result`.
    pub fn record<'a>(
        &self,
        recording: &mut Recording,
        count: impl Into<Count<'a>>,
        values: View<'a, T>,
        result: View<'a, T>,
    ) {
        let count = count.into();
        if !count.fits(recording, NAME, MOST / (size_of::<T>() / 4))
            || !holds(recording, NAME, values, count.limit)
            || !holds(recording, NAME, result, 1)
        {
            return;
        }
        // Shorter inputs take fewer workgroups, and one takes a single pass.
        let groups = count.limit.div_ceil(WORKGROUP * 16).clamp(1, GROUPS);
        let partial = self.partial.view();
        let first = if groups == 1 { result } else { partial };
        recording.dispatch(&self.kernel, [groups as u32, 1, 1], &short::<T>(values, first, count));
        if groups > 1 {
            recording.dispatch(&self.kernel, [1, 1, 1], &short::<T>(partial, result, groups.into()));
        }
    }
}

/// Arguments with one lifetime for all.
fn short<'a, T: ReduceValue>(
    values: View<'a, T>,
    results: View<'a, T>,
    count: Count<'a>,
) -> <T::Kernel as Shader>::Args<'a> {
    T::args(values, results, count)
}
