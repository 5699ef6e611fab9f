//! Stage 4 on the device.
