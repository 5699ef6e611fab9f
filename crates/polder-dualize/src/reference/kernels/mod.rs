//! What each kernel does, under its name: a module for each stage.

pub mod dualize;
pub mod shift;
pub mod takeout;
