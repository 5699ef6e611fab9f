//! Which arithmetic decides signs on a device, the kernels made for it, and signs of many tuples at once.
//!
//! The shaders ask `orient2d` and `must_flip` of `include/predicates.glsl`. They give the signs of
//! [`polder_predicates`] on every device, in one of two ways:
//!
//! - [`Filtered`](Arithmetic::Filtered): f64 with a proven bound decides nearly all calls in a small kernel. What it leaves
//!   goes on a list, and the same kernel with integers behind the filter runs over the list.
//! - [`Integers`](Arithmetic::Integers): integers alone, in one kernel; no f64 operation at all.
//!
//! \[Shewchuk1997\] for the filter. Departures: the bound is four times as large, since Vulkan does not promise that f64
//! operations are rounded correctly; what the filter leaves is not evaluated by expansions of f64, but by integers.

use crate::kernels::{MustFlipSigns, MustFlipSignsArgs, Orient2dSigns, Orient2dSignsArgs};
use glam::DVec2;
use polder_vulkan::kernels::{DispatchSize, DispatchSizeArgs};
use polder_vulkan::{Buffer, Device, Error, Estimate, Kernel, Recording, Shader, View, groups_for};

/// The specialization constant of every kernel that asks predicates.
const ARITHMETIC: &str = "ARITHMETIC";
/// Its values: what the filter knows; what the filter or else integers know; what integers know.
const FAST: u32 = 0;
const EXACT: u32 = 1;
const INTEGERS: u32 = 2;
/// Invocations of a workgroup.
const WORKGROUP: u32 = 256;

/// What decides signs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Arithmetic {
    /// f64 first, then integers.
    Filtered,
    /// Integers alone.
    Integers,
}

/// A kernel that asks predicates, compiled as an [`Arithmetic`] needs it.
#[derive(Debug, Clone)]
pub struct Kernels<S> {
    /// Runs over all items. Without `rest` it decides all of them; else it writes nothing for an item of which a predicate
    /// is undecided, but puts it on a list.
    pub first: Kernel<S>,
    /// Runs over that list right afterwards, and decides every item.
    pub rest: Option<Kernel<S>>,
}

impl Arithmetic {
    /// [`Filtered`](Self::Filtered) where the device's self-test found its f64 to be that of a CPU.
    ///
    /// # Errors
    ///
    /// Those of the device.
    pub fn of(device: &Device) -> Result<Self, Error> {
        Ok(if device.self_test()?.passed() { Self::Filtered } else { Self::Integers })
    }

    /// Compiles a kernel that includes `predicates.glsl`, with its other constants.
    ///
    /// # Errors
    ///
    /// Those of [`Kernel::new`]; one is that the shader does not include it.
    pub fn kernels<S: Shader>(self, device: &Device, constants: &[(&'static str, u32)]) -> Result<Kernels<S>, Error> {
        let with = |arithmetic| [constants, &[(ARITHMETIC, arithmetic)]].concat();
        Ok(match self {
            Self::Filtered => {
                Kernels { first: Kernel::new(device, &with(FAST))?, rest: Some(Kernel::new(device, &with(EXACT))?) }
            }
            Self::Integers => Kernels { first: Kernel::without_float64(device, &with(INTEGERS))?, rest: None },
        })
    }
}

/// The predicates for many tuples of vertices.
#[derive(Debug)]
pub struct Signs {
    device: Device,
    orient2d: Kernels<Orient2dSigns>,
    must_flip: Kernels<MustFlipSigns>,
    dispatch_size: Kernel<DispatchSize>,
}

/// What [`Signs`] needs beside input and output: the list of tuples that the filter left.
#[derive(Debug)]
pub struct SignsBuffers {
    deferred: Buffer<u32>,
    counter: Buffer<u32>,
    groups: Buffer<u32>,
}

impl SignsBuffers {
    /// The tuples that the filter left, in the order of arrival.
    pub fn deferred(&self) -> View<'_, u32> {
        self.deferred.view()
    }

    /// One word: how many tuples the filter left, once the recording has run.
    pub fn deferred_count(&self) -> View<'_, u32> {
        self.counter.view()
    }
}

impl Signs {
    /// Compiles the kernels.
    ///
    /// # Errors
    ///
    /// Those of the device.
    pub fn new(device: &Device, arithmetic: Arithmetic) -> Result<Self, Error> {
        let constants = [("WORKGROUP", WORKGROUP)];
        Ok(Self {
            device: device.clone(),
            orient2d: arithmetic.kernels(device, &constants)?,
            must_flip: arithmetic.kernels(device, &constants)?,
            dispatch_size: Kernel::new(device, &[])?,
        })
    }

    /// What [`Signs::buffers`] will hold.
    pub fn estimate(tuples: usize) -> Estimate {
        Estimate::new()
            .buffer::<u32>("deferred tuples", tuples)
            .buffer::<u32>("deferred tuples, count", 4)
            .buffer::<u32>("deferred tuples, groups", 4)
    }

    /// Memory for so many tuples.
    ///
    /// # Errors
    ///
    /// If it cannot be had.
    pub fn buffers(&self, tuples: usize) -> Result<SignsBuffers, Error> {
        Ok(SignsBuffers {
            deferred: Buffer::new(&self.device, "deferred tuples", tuples)?,
            counter: Buffer::new(&self.device, "deferred tuples, count", 4)?,
            groups: Buffer::new(&self.device, "deferred tuples, groups", 4)?,
        })
    }

    /// Writes the bits of [`orient2d_signs`](crate::reference::orient2d_signs). Vertices must have a position.
    ///
    /// # Errors
    ///
    /// If output or buffers are shorter than the input.
    pub fn record_orient2d(
        &self,
        recording: &mut Recording,
        positions: View<'_, DVec2>,
        triples: View<'_, [u32; 3]>,
        signs: View<'_, u32>,
        buffers: &SignsBuffers,
    ) -> Result<(), Error> {
        let limit = check("orient2d_signs", triples.len(), signs, buffers)?;
        let all = Orient2dSignsArgs {
            positions: positions.cast(),
            triples: triples.cast(),
            signs,
            items: None,
            counter: None,
            deferred: buffers.deferred.view(),
            deferred_count: buffers.counter.view(),
            limit,
        };
        let (items, counter) = (Some(buffers.deferred.view()), Some(buffers.counter.view()));
        let list = Orient2dSignsArgs { items, counter, ..all };
        self.record(recording, &self.orient2d, [all, list], buffers, limit);
        Ok(())
    }

    /// Writes the words of [`must_flip_signs`](crate::reference::must_flip_signs). Vertices must have a position.
    ///
    /// # Errors
    ///
    /// If output or buffers are shorter than the input.
    pub fn record_must_flip(
        &self,
        recording: &mut Recording,
        positions: View<'_, DVec2>,
        quadruples: View<'_, [u32; 4]>,
        signs: View<'_, u32>,
        buffers: &SignsBuffers,
    ) -> Result<(), Error> {
        let limit = check("must_flip_signs", quadruples.len(), signs, buffers)?;
        let all = MustFlipSignsArgs {
            positions: positions.cast(),
            quadruples: quadruples.cast(),
            signs,
            items: None,
            counter: None,
            deferred: buffers.deferred.view(),
            deferred_count: buffers.counter.view(),
            limit,
        };
        let (items, counter) = (Some(buffers.deferred.view()), Some(buffers.counter.view()));
        let list = MustFlipSignsArgs { items, counter, ..all };
        self.record(recording, &self.must_flip, [all, list], buffers, limit);
        Ok(())
    }

    fn record<'a, S: Shader>(
        &self,
        recording: &mut Recording,
        kernels: &Kernels<S>,
        [all, list]: [S::Args<'a>; 2],
        buffers: &'a SignsBuffers,
        limit: u32,
    ) {
        recording.fill(buffers.counter.view(), 0);
        recording.dispatch(&kernels.first, groups_for(limit as usize, WORKGROUP), &all);
        if let Some(rest) = &kernels.rest {
            let (counter, groups) = (Some(buffers.counter.view()), buffers.groups.view());
            let size = DispatchSizeArgs { counter, groups, limit, items: WORKGROUP };
            recording.dispatch(&self.dispatch_size, [1, 1, 1], &size);
            recording.dispatch_indirect(rest, groups, &list);
        }
    }
}

/// The number of tuples, if all that is written has room for as many.
fn check(command: &'static str, tuples: usize, signs: View<'_, u32>, buffers: &SignsBuffers) -> Result<u32, Error> {
    let room = signs.len().min(buffers.deferred.len());
    match u32::try_from(tuples) {
        Ok(limit) if tuples <= room => Ok(limit),
        _ => Err(Error::Recording { command, why: format!("{tuples} tuples; there is memory for {room}") }),
    }
}
