//! Shared helpers of the workspace tests.
#![forbid(unsafe_code)]
