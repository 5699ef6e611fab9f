//! Which arithmetic decides signs on a device, the kernels made for it, and signs of many tuples at once.
//!
//! The shaders ask `orient2d` and `must_flip` of `include/predicates.glsl`. They give the signs of
//! [`polder_predicates`] on every device, in one of two ways:
//!
//! - [`Filtered`](Arithmetic::Filtered): f64 with a proven bound decides nearly all calls, integers decide the rest.
//! - [`Integers`](Arithmetic::Integers): integers alone; no f64 operation at all.
//!
//! Each is one kernel, which decides every item. Filtering first and deciding the rest from a list, in a second kernel, was
//! measured slower for every kind of points: integers behind the filter cost a tenth of a test where they are not needed.
//!
//! \[Shewchuk1997\] for the filter. Departures: the bound is four times as large, since Vulkan does not promise that f64
//! operations are rounded correctly; what the filter leaves is not evaluated by expansions of f64, but by integers.

use crate::kernels::{MustFlipSigns, MustFlipSignsArgs, Orient2dSigns, Orient2dSignsArgs};
use glam::DVec2;
use polder_vulkan::{Device, Error, Kernel, Recording, Shader, View, groups_for};

/// The specialization constant of every kernel that asks predicates.
const ARITHMETIC: &str = "ARITHMETIC";
/// Its values: integers behind the filter, and alone.
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

impl Arithmetic {
    /// [`Filtered`](Self::Filtered) where the device's self-test found its f64 to be that of a CPU.
    ///
    /// # Errors
    ///
    /// Those of the device.
    pub fn of(device: &Device) -> Result<Self, Error> {
        Ok(if device.self_test()?.passed() { Self::Filtered } else { Self::Integers })
    }

    /// Compiles a kernel that includes `predicates.glsl`, with its other constants. It decides every item.
    ///
    /// # Errors
    ///
    /// Those of [`Kernel::new`]; one is that the shader does not include it.
    pub fn kernel<S: Shader>(self, device: &Device, constants: &[(&'static str, u32)]) -> Result<Kernel<S>, Error> {
        let with = |arithmetic| [constants, &[(ARITHMETIC, arithmetic)]].concat();
        match self {
            Self::Filtered => Kernel::new(device, &with(EXACT)),
            Self::Integers => Kernel::without_float64(device, &with(INTEGERS)),
        }
    }
}

/// The predicates for many tuples of vertices.
#[derive(Debug)]
pub struct Signs {
    orient2d: Kernel<Orient2dSigns>,
    must_flip: Kernel<MustFlipSigns>,
}

impl Signs {
    /// Compiles the kernels.
    ///
    /// # Errors
    ///
    /// Those of the device.
    pub fn new(device: &Device, arithmetic: Arithmetic) -> Result<Self, Error> {
        let constants = [("WORKGROUP", WORKGROUP)];
        Ok(Self { orient2d: arithmetic.kernel(device, &constants)?, must_flip: arithmetic.kernel(device, &constants)? })
    }

    /// Writes the bits of [`orient2d_signs`](crate::reference::orient2d_signs). Vertices must have a position.
    ///
    /// # Errors
    ///
    /// If the output is shorter than the input.
    pub fn record_orient2d(
        &self,
        recording: &mut Recording,
        positions: View<'_, DVec2>,
        triples: View<'_, [u32; 3]>,
        signs: View<'_, u32>,
    ) -> Result<(), Error> {
        let count = check("orient2d_signs", triples.len(), signs)?;
        let arguments = Orient2dSignsArgs { positions: positions.cast(), triples: triples.cast(), signs, count };
        recording.dispatch(&self.orient2d, groups_for(triples.len(), WORKGROUP), &arguments);
        Ok(())
    }

    /// Writes the words of [`must_flip_signs`](crate::reference::must_flip_signs). Vertices must have a position.
    ///
    /// # Errors
    ///
    /// If the output is shorter than the input.
    pub fn record_must_flip(
        &self,
        recording: &mut Recording,
        positions: View<'_, DVec2>,
        quadruples: View<'_, [u32; 4]>,
        signs: View<'_, u32>,
    ) -> Result<(), Error> {
        let count = check("must_flip_signs", quadruples.len(), signs)?;
        let arguments = MustFlipSignsArgs { positions: positions.cast(), quadruples: quadruples.cast(), signs, count };
        recording.dispatch(&self.must_flip, groups_for(quadruples.len(), WORKGROUP), &arguments);
        Ok(())
    }
}

/// The number of tuples, if there is room for as many signs.
fn check(command: &'static str, tuples: usize, signs: View<'_, u32>) -> Result<u32, Error> {
    let room = signs.len();
    match u32::try_from(tuples) {
        Ok(count) if tuples <= room => Ok(count),
        _ => Err(Error::Recording { command, why: format!("{tuples} tuples; there is room for {room} signs") }),
    }
}
