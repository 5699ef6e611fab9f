//! Everything that can fail in a piece of work, made to fail in turn.

use super::{Gpu, options};
use polder_vulkan::{CacheFolder, Device, DeviceOptions, Error};
use std::fmt::Debug;

/// How often each kind of failure struck.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Struck {
    pub(crate) losses: u64,
    pub(crate) timeouts: u64,
    pub(crate) refusals: u64,
}

/// Runs `work` with the device lost at each submission in turn, each wait timing out in turn, and each allocation refused in
/// turn. Each must give the typed error, which `engine_error` finds in the error of the work; leave no memory held; and
/// let the same work succeed afterwards, on the same device, or after a loss on one opened anew.
///
/// `work` makes all that it needs from the device, and its result is a pure function of nothing.
pub(crate) fn fail_everywhere<T: PartialEq + Debug, E: Debug>(
    work: impl Fn(&Device) -> Result<T, E>,
    engine_error: impl Fn(&E) -> Option<&Error>,
) -> Struck {
    // Compiled once: every loss takes a new device.
    let folder = tempfile::tempdir().unwrap();
    let open = || Gpu::with(&DeviceOptions { cache: CacheFolder::At(folder.path().to_owned()), ..options() });
    let gpu = open();
    let expected = work(&gpu.device).unwrap();
    gpu.device.save_pipelines();
    let before = gpu.device.memory_use().used;
    let mut struck = Struck::default();

    for index in 0.. {
        gpu.device.faults().refuse_allocation(index);
        let done = work(&gpu.device);
        gpu.device.faults().clear();
        assert_eq!(gpu.device.memory_use().used, before, "after allocation {index} was refused");
        match done {
            Ok(found) => {
                assert_eq!(found, expected);
                struck.refusals = index;
                break;
            }
            Err(error) => {
                assert!(matches!(engine_error(&error), Some(Error::OutOfMemory { .. })), "{index}: {error:?}");
                assert_eq!(work(&gpu.device).unwrap(), expected, "after allocation {index} was refused");
            }
        }
    }
    for index in 0.. {
        gpu.device.faults().time_out_at_submission(index);
        let done = work(&gpu.device);
        gpu.device.faults().clear();
        assert_eq!(gpu.device.memory_use().used, before, "after wait {index} timed out");
        match done {
            Ok(found) => {
                assert_eq!(found, expected);
                struck.timeouts = index;
                break;
            }
            Err(error) => {
                assert!(matches!(engine_error(&error), Some(Error::Timeout { .. })), "{index}: {error:?}");
                assert_eq!(work(&gpu.device).unwrap(), expected, "after wait {index} timed out");
            }
        }
    }
    for index in 0.. {
        let gpu = open();
        gpu.device.faults().lose_at_submission(index);
        match work(&gpu.device) {
            Ok(found) => {
                assert_eq!(found, expected);
                struck.losses = index;
                break;
            }
            Err(error) => {
                assert_eq!(engine_error(&error), Some(&Error::DeviceLost), "{index}: {error:?}");
                assert!(gpu.device.is_lost());
                assert_eq!(gpu.device.memory_use().used, 0, "after a loss at submission {index}");
                // Lost for good, and said so; a device opened anew works.
                let again = work(&gpu.device);
                assert!(again.is_err_and(|error| engine_error(&error) == Some(&Error::DeviceLost)));
            }
        }
        assert_eq!(work(&open().device).unwrap(), expected, "after a loss at submission {index}");
    }
    assert!(struck.losses > 0 && struck.timeouts > 0 && struck.refusals > 0, "{struck:?}");
    struck
}
