//! Stage 3 on the device.
