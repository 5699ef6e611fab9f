//! Stage 6: constraints inserted by flips, crossings named
#![forbid(unsafe_code)]
