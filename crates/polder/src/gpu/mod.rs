//! The Vulkan backend: every stage on one device, from points and constraints in its memory to a triangulation there.
//!
//! 1. Points and constraints go to the device, if they are not there. The bounding box of the points is found there, and the
//!    pixel grid fitted to it.
//! 2. All stages are one recording: digital Voronoi diagram, dualization, shift, insertion, walks of the constraints,
//!    insertion of constraints, flips, canonical order with its certificate. Loops run ahead, so that the host waits once if
//!    they take no more rounds than was guessed. Without constraints nothing is recorded for them; with about as many as
//!    there are points, most of them are edges of the Delaunay triangulation, and flips come before them too.
//! 3. What the stages found wrong is looked at; then the result is fetched, or lent where it lies.
//!
//! Constraints that cross are met on the device; which ones they are is found on the CPU, from the points and constraints
//! alone, for the error that names them. Cutting them where they cross is done there too, and its stages say so in the report.

mod auto;
mod constraints;
mod cut;
mod held;
mod line;
mod pipeline;
mod report;
mod result;
mod work;

pub use auto::AUTO_FROM;
pub(crate) use auto::{auto, vulkan};
pub use result::{ChainsOnDevice, OnDevice};

use crate::report::{Place, Stopwatch};
use crate::{CrossingPolicy, Error, Options, Output, cpu, split};
use held::Held;
use pipeline::Pipeline;
use polder_flip::gpu::Arithmetic;
use polder_mesh::{DVec2, Pslg};
use polder_vulkan::{Buffer, Device, DeviceOptions, Engine, View};
use work::Input;

/// An input brought here from the host.
#[derive(Debug)]
struct Uploaded {
    points: Buffer<DVec2>,
    constraints: Buffer<[u32; 2]>,
}

impl Uploaded {
    fn on_device(&self) -> Input<'_> {
        let constraints = (!self.constraints.is_empty()).then(|| self.constraints.view());
        Input { points: self.points.view(), constraints, checked: true }
    }

    fn bytes(&self) -> usize {
        self.points.len() * size_of::<DVec2>() + self.constraints.len() * size_of::<[u32; 2]>()
    }
}

/// A Vulkan device with everything that triangulating on it needs: compiled kernels (those for constraints once there are
/// some), and the memory of the last call, which the next one of the same size uses again.
///
/// ```no_run
/// use polder::{Gpu, Options};
///
/// # fn main() -> Result<(), polder::Error> {
/// # let inputs: Vec<polder::Pslg> = Vec::new();
/// let mut gpu = Gpu::open(&Default::default())?;
/// for pslg in &inputs {
///     let output = gpu.triangulate(pslg, &Options::default())?;
///     assert!(output.report.stages_on_cpu().next().is_none());
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Gpu {
    device: Device,
    engine: Engine,
    arithmetic: Arithmetic,
    pipeline: Pipeline,
    input: Option<Uploaded>,
    held: Option<Held>,
}

impl Gpu {
    /// Opens a device and compiles the kernels, or takes them from a cache on disk.
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if there is no such device, or it lacks something.
    pub fn open(options: &DeviceOptions) -> Result<Self, Error> {
        Self::on(&Device::open(options)?)
    }

    /// On a device that is open already, which may be a caller's own ([`Device::borrow`]).
    ///
    /// # Errors
    ///
    /// [`Error::Unsupported`] if it lacks something.
    pub fn on(device: &Device) -> Result<Self, Error> {
        Self::with_arithmetic(device, Arithmetic::of(device)?)
    }

    /// With a given arithmetic for signs, instead of what the device's self-test allows: for tests. The result does not
    /// depend on it.
    ///
    /// # Errors
    ///
    /// As [`Gpu::on`].
    pub fn with_arithmetic(device: &Device, arithmetic: Arithmetic) -> Result<Self, Error> {
        let pipeline = Pipeline::new(device, arithmetic)?;
        device.compile()?;
        Ok(Self { device: device.clone(), engine: Engine::new(device)?, arithmetic, pipeline, input: None, held: None })
    }

    /// The device.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// The engine, to bring points to buffers and fetch results from them.
    pub fn engine(&mut self) -> &mut Engine {
        &mut self.engine
    }

    /// Gives the memory of the last call back to the device.
    pub fn release(&mut self) {
        self.held = None;
        self.input = None;
    }

    /// Triangulates points and constraints in memory of the host, and fetches the result.
    ///
    /// Backend and device of the options are not looked at; threads are those of the CPU that name crossings.
    ///
    /// # Errors
    ///
    /// - [`Error::CrossingConstraints`] as on the CPU: which pairs cross is found there, once one is met on the device. Where
    ///   they shall be split that is done on the CPU too, with [`Error::SplitTooLarge`] and [`Error::SplitUnfinished`].
    /// - [`Error::Unsupported`] for a grid that cannot be, and for more than 2²⁷ constraints or 2²⁸ pieces of them.
    /// - [`Error::OutOfMemory`] if memory does not suffice, which is found out before any work; [`Error::DeviceLost`].
    /// - [`Error::Cancelled`]; [`Error::BoundExceeded`] and [`Error::Internal`] are defects of polder.
    pub fn triangulate(&mut self, pslg: &Pslg, options: &Options) -> Result<Output, Error> {
        split::by_policy(pslg, options, Place::Device, |pslg, options| self.triangulate_uncut(pslg, options))
    }

    /// Constraints that cross are an error.
    fn triangulate_uncut(&mut self, pslg: &Pslg, options: &Options) -> Result<Output, Error> {
        let mut watch = Stopwatch::start();
        let input = self.upload(pslg)?;
        watch.stage_on(Place::Transfer, "upload", [("bytes", input.bytes() as u64)]);
        let (made, room) = std::thread::scope(|scope| {
            let room = scope.spawn(|| result::room(pslg));
            let made = self.work(input.on_device(), options, watch);
            (made, room.join().unwrap_or_default())
        });
        self.input = Some(input);
        let (found, report) = match made {
            Err(Error::CrossingConstraints { .. }) => return Err(cpu::crossings(pslg, options)?),
            other => other?,
        };
        let (triangulation, report) = self.result(found, report).into_parts(room)?;
        Ok(Output { triangulation, report })
    }

    /// Brings an input to the device, into the memory of the last one, which is taken out.
    fn upload(&mut self, pslg: &Pslg) -> Result<Uploaded, Error> {
        let mut input = match self.input.take() {
            Some(input) => input,
            None => Uploaded {
                points: Buffer::new(&self.device, "points", 0)?,
                constraints: Buffer::new(&self.device, "constraints", 0)?,
            },
        };
        let (points, constraints) = (pslg.points(), pslg.constraints());
        input.points.resize(points.len())?;
        input.constraints.resize(constraints.len())?;
        self.engine.upload(input.points.view(), points)?;
        if !constraints.is_empty() {
            self.engine.upload(input.constraints.view(), constraints)?;
        }
        Ok(input)
    }

    /// Triangulates points that lie on the device, and leaves the result there. They must be finite; the first that is not
    /// is an error.
    ///
    /// # Errors
    ///
    /// [`Error::Input`] for coordinates that are not finite; else as [`Gpu::triangulate`].
    pub fn triangulate_on_device(&mut self, points: View<'_, DVec2>, options: &Options) -> Result<OnDevice<'_>, Error> {
        let (found, report) =
            self.work(Input { points, constraints: None, checked: true }, options, Stopwatch::start())?;
        Ok(self.result(found, report))
    }

    /// The same with constraints, pairs of points, that lie on the device too.
    ///
    /// Where some cross and shall be split, points and constraints are fetched, cut in the host's memory and brought back, as
    /// stages of the report say; the result lies on the device nevertheless, with [`OnDevice::added`] vertices.
    ///
    /// # Errors
    ///
    /// [`Error::Input`] for coordinates that are not finite and indices of points that do not exist;
    /// [`Error::CrossingConstraints`] names all pairs, for which points and constraints are fetched. Else as
    /// [`Gpu::triangulate`].
    pub fn triangulate_constrained_on_device(
        &mut self,
        points: View<'_, DVec2>,
        constraints: View<'_, [u32; 2]>,
        options: &Options,
    ) -> Result<OnDevice<'_>, Error> {
        let input = Input { points, constraints: (!constraints.is_empty()).then_some(constraints), checked: false };
        let watch = Stopwatch::start();
        match self.work(input, options, Stopwatch::start()) {
            Ok((found, report)) => Ok(self.result(found, report)),
            Err(Error::CrossingConstraints { .. }) if options.crossings == CrossingPolicy::Split => {
                self.cut(input, options, watch)
            }
            Err(Error::CrossingConstraints { .. }) => {
                let pslg = input.download(&mut self.engine)?;
                Err(cpu::crossings(&pslg, options)?)
            }
            Err(other) => Err(other),
        }
    }

    fn result(&mut self, found: Option<held::Found>, report: crate::Report) -> OnDevice<'_> {
        OnDevice::new(&mut self.engine, self.held.as_ref().zip(found), report)
    }
}

fn internal(what: &str) -> Error {
    Error::Internal { stage: "vulkan", what: what.to_owned() }
}
