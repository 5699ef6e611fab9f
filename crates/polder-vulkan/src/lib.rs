//! The Vulkan compute engine of polder. It knows no geometry.
//!
//! Vulkan is loaded when it is first used, never linked; shaders are SPIR-V in the crates that use them.
//!
//! # How it fits together
//!
//! - [`Device`]: opened by [`Selection`], or lent by a caller ([`Device::borrow`]). [`requirements`] says as data what it
//!   must have; [`Device::self_test`] whether its f64 arithmetic gives the CPU's bits.
//! - [`Buffer`] and [`View`]: typed memory on the device. An [`Estimate`] says how much a piece of work will hold, and
//!   fails before anything is allocated where that does not fit.
//! - [`Kernel`]: a compiled shader. `cargo xtask shaders` makes from each shader a type with typed arguments, so that a
//!   dispatch names its buffers, and how each is used is known without anybody saying it twice.
//! - [`Recording`]: a list of dispatches, fills, copies and repeated bodies, to which stages append. It allocates nothing
//!   on the device, and touches no queue.
//! - [`Engine`]: runs recordings. It puts the narrowest barriers between commands that conflict, submits, waits by a
//!   timeline semaphore, and turns loss, time-out and lack of memory into an [`Error`].
//! - [`primitives`]: scan, compaction, reduction, sort. [`mod@reference`] is the same in plain Rust, bit for bit.
//!
//! # Addresses, not bindings
//!
//! Kernels reach memory by address (`buffer_reference`), handed over with their other arguments. So no limit on the range
//! of a descriptor applies (128 MiB on lavapipe), there are no descriptor sets to keep, and one kernel serves any part
//! of any buffer. The price: Vulkan checks no bounds, so every kernel has to, and the SPIR-V that the engine is given is
//! trusted.
//!
//! # Guarantees
//!
//! - No `unsafe` outside of this crate; inside, each with the reason that makes it sound. The one `unsafe` call for users
//!   is [`Device::borrow`], whose handles nobody can check.
//! - What a submission uses lives until the device is done with it, also after a time-out.
//! - Every wait is bounded by a time, every repeated body by a count.
//! - After [`Error::DeviceLost`] all calls on that device fail alike, and dropping everything gives everything back; a
//!   device opened anew works.

#![allow(unsafe_code, reason = "the one crate that calls Vulkan")]

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod ahead;
mod buffer;
mod cache;
mod device;
mod engine;
mod error;
mod faults;
mod hazards;
mod host;
mod info;
mod instance;
mod kernel;
pub mod kernels;
mod memory;
mod pool;
pub mod primitives;
mod queries;
mod recording;
pub mod reference;
mod run;
mod select;
mod self_test;
mod shader;
mod submit;
mod table;
mod timing;
mod transfer;

pub use ash;
pub use buffer::{Buffer, VIEW_ALIGN, View};
pub use cache::CacheFolder;
pub use device::{Device, DeviceOptions, Lent};
pub use engine::{Engine, RunOptions, RunReport};
pub use error::Error;
pub use faults::Faults;
pub use gpu_allocator;
pub use host::room_for;
pub use info::{DeviceInfo, DeviceKind, Feature, Limits, Requirements, requirements};
pub use instance::Instance;
pub use kernel::Kernel;
pub use memory::{Estimate, MemoryUse};
pub use pool::Pool;
pub use recording::{ReadBack, Recording, groups_for};
pub use select::Selection;
pub use self_test::SelfTest;
pub use shader::{Access, Aligned, BufferArgument, Code, Constant, Encoder, Shader, Side};
pub use timing::{Timing, Timings};
pub use transfer::Downloads;
