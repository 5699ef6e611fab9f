#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod error;
pub mod generate;
mod input;
mod mesh;
mod node_poly;
mod raw;
mod source;
pub mod svg;
mod text;

pub use error::{IoError, Place};
pub use input::{Input, InputFormat, Region};
pub use mesh::{
    MeshFile, MeshFormat, lowest_equal, write_edge, write_ele, write_neigh, write_obj, write_ply, write_vtk,
};
pub use node_poly::{write_node, write_poly};
pub use raw::{write_pslg, write_tri};
pub use source::Source;
