//! What each kernel does, under its name: a module for each stage.

pub mod dualize;
pub mod insert;
pub mod shift;
pub mod takeout;
