//! Failures on demand, for tests: what a lost device or a full memory does to callers, at every place in turn.

use std::sync::atomic::{AtomicU64, Ordering};

const NEVER: u64 = u64::MAX;

/// Counts submissions and allocations, and fails the ones that it was told to.
///
/// Indices count from the moment the fault is set: 0 is the next one.
#[derive(Debug)]
pub struct Faults {
    submissions: Countdown,
    waits: Countdown,
    allocations: Countdown,
}

impl Default for Faults {
    fn default() -> Self {
        Faults { submissions: Countdown::new(), waits: Countdown::new(), allocations: Countdown::new() }
    }
}

impl Faults {
    /// What the environment variable `POLDER_FAULT` asks of every device that is opened, so that programs can be tested as
    /// well: `lose:3`, `time_out:3` or `refuse:3`, the fourth submission, wait or allocation from the opening on. Only in
    /// programs with debug assertions.
    pub(crate) fn of_environment() -> Self {
        let faults = Self::default();
        let asked =
            if cfg!(debug_assertions) { std::env::var("POLDER_FAULT").unwrap_or_default() } else { String::new() };
        if let Some((kind, index)) = asked.split_once(':')
            && let Ok(index) = index.parse()
        {
            match kind {
                "lose" => faults.lose_at_submission(index),
                "time_out" => faults.time_out_at_submission(index),
                "refuse" => faults.refuse_allocation(index),
                _ => {}
            }
        }
        faults
    }

    /// The device is lost at the submission `index` from now, which does not run.
    pub fn lose_at_submission(&self, index: u64) {
        self.submissions.set(index);
    }

    /// The wait for the submission `index` from now gives up at once.
    pub fn time_out_at_submission(&self, index: u64) {
        self.waits.set(index);
    }

    /// The allocation `index` from now is refused.
    pub fn refuse_allocation(&self, index: u64) {
        self.allocations.set(index);
    }

    /// Lets everything pass again.
    pub fn clear(&self) {
        self.submissions.set(NEVER);
        self.waits.set(NEVER);
        self.allocations.set(NEVER);
    }

    pub(crate) fn submission_fails(&self) -> bool {
        self.submissions.strikes()
    }

    pub(crate) fn wait_fails(&self) -> bool {
        self.waits.strikes()
    }

    pub(crate) fn allocation_fails(&self) -> bool {
        self.allocations.strikes()
    }
}

#[derive(Debug)]
struct Countdown(AtomicU64);

impl Countdown {
    fn new() -> Self {
        Countdown(AtomicU64::new(NEVER))
    }

    fn set(&self, index: u64) {
        self.0.store(index, Ordering::Relaxed);
    }

    /// Whether this is the one; it strikes once.
    fn strikes(&self) -> bool {
        let next = |left: u64| (left != NEVER).then(|| left.checked_sub(1).unwrap_or(NEVER));
        self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, next) == Ok(0)
    }
}
