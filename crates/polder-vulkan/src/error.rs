//! What can go wrong.

use ash::vk;

/// The errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The machine has no Vulkan loader.
    #[error("no Vulkan on this machine: {0}")]
    NoVulkan(String),
    /// Validation was asked for, and the layer is not installed.
    #[error("the validation layer VK_LAYER_KHRONOS_validation is not installed")]
    NoValidation,
    /// No device fits the selection.
    #[error("no Vulkan device {wanted}; there are: {found}")]
    NoDevice {
        /// What was asked for, to be said of a device: `has index 3`.
        wanted: String,
        /// The devices that there are, and why each was not taken.
        found: String,
    },
    /// The device lacks what every kernel here, or the one named, needs.
    #[error("{device} lacks {missing}")]
    Unsupported {
        /// The device's name.
        device: String,
        /// Every missing feature or limit, with a comma between.
        missing: String,
    },
    /// It would not fit; nothing was allocated.
    #[error("{needed} bytes of device memory are needed and {available} available ({what})")]
    TooLarge {
        /// Bytes needed, in all.
        needed: u64,
        /// Bytes that can be had.
        available: u64,
        /// The limit that was met, and by which buffer.
        what: String,
    },
    /// An allocation failed, or would have passed the cap.
    #[error("out of device memory: {bytes} bytes for `{what}` with {used} bytes in use")]
    OutOfMemory {
        /// The buffer's name.
        what: String,
        /// Its bytes.
        bytes: u64,
        /// Bytes that were in use on this device.
        used: u64,
    },
    /// The device is gone: open it anew.
    #[error("the device was lost")]
    DeviceLost,
    /// The device did not finish in time. What it works on stays alive until it does.
    #[error("the device did not finish within {seconds} s")]
    Timeout {
        /// The seconds that were allowed.
        seconds: f64,
    },
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// A repeated body was not done within its bound.
    #[error("`{name}` was not done after {bound} rounds")]
    Bound {
        /// The loop's name.
        name: &'static str,
        /// Rounds that were allowed, and done.
        bound: u32,
    },
    /// A recording asks for something that cannot be.
    #[error("`{command}`: {why}")]
    Recording {
        /// The kernel or command.
        command: &'static str,
        /// What is wrong with it.
        why: String,
    },
    /// A range does not lie in its buffer, or does not begin at a multiple of 16 bytes.
    #[error("range {start}..{end} of buffer `{buffer}`, which has {len} elements: {why}")]
    Range {
        /// The buffer's name.
        buffer: &'static str,
        /// First element.
        start: usize,
        /// One past the last.
        end: usize,
        /// Elements in the buffer.
        len: usize,
        /// What is wrong.
        why: &'static str,
    },
    /// Vulkan refused a call.
    #[error("{call}: {result:?}")]
    Vulkan {
        /// The call.
        call: &'static str,
        /// What it gave back.
        result: vk::Result,
    },
}

/// Names the call that failed. Loss is told apart; memory is by whoever knows the buffer.
pub(crate) trait Called<T> {
    fn called(self, call: &'static str) -> Result<T, Error>;
}

impl<T> Called<T> for Result<T, vk::Result> {
    fn called(self, call: &'static str) -> Result<T, Error> {
        self.map_err(|result| match result {
            vk::Result::ERROR_DEVICE_LOST => Error::DeviceLost,
            vk::Result::ERROR_OUT_OF_DEVICE_MEMORY | vk::Result::ERROR_OUT_OF_HOST_MEMORY => {
                Error::OutOfMemory { what: call.to_owned(), bytes: 0, used: 0 }
            }
            _ => Error::Vulkan { call, result },
        })
    }
}
