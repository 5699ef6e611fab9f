//! `polder draw`.

use crate::args::DrawArgs;
use crate::failure::Failure;
use crate::job::Job;
use std::process::ExitCode;

pub(crate) fn draw(_job: &Job, _args: &DrawArgs) -> Result<ExitCode, Failure> {
    Err(Failure::new("unsupported", "drawing"))
}
