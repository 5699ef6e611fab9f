use std::sync::atomic::{AtomicBool, Ordering};
use thiserror::Error;

/// How far a stage has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// The stage at work.
    pub stage: &'static str,
    /// Units of work done, in units that the stage chooses.
    pub done: u64,
    /// Units of work in all, as far as is known.
    pub total: u64,
}

/// The caller asked to stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("cancelled by the caller")]
pub struct Cancelled;

/// What a long computation tells its caller, and asks of it, between rounds.
#[derive(Clone, Copy, Default)]
pub struct Monitor<'a> {
    /// Called between rounds, from any thread.
    pub progress: Option<&'a (dyn Fn(Progress) + Sync)>,
    /// Set to true by the caller to stop.
    pub cancel: Option<&'a AtomicBool>,
}

impl Monitor<'_> {
    /// Reports progress and asks whether to go on.
    ///
    /// # Errors
    ///
    /// [`Cancelled`] if the caller has set the cancel flag.
    pub fn step(&self, stage: &'static str, done: u64, total: u64) -> Result<(), Cancelled> {
        if self.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed)) {
            return Err(Cancelled);
        }
        if let Some(progress) = self.progress {
            progress(Progress { stage, done, total });
        }
        Ok(())
    }
}
