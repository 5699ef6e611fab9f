//! The CPU backend.

use crate::{Error, Options, Output};
use polder_mesh::Pslg;

pub(crate) fn triangulate(_pslg: &Pslg, _options: &Options) -> Result<Output, Error> {
    Err(Error::Unsupported { what: "the CPU backend is being built".into() })
}
