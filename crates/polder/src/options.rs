use polder_mesh::{Monitor, Progress};
use polder_vulkan::Selection;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Where a triangulation is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Backend {
    /// The fastest one available; the report says which, and why.
    #[default]
    Auto,
    /// The CPU, by the fastest way there: divide and conquer, then constraints one by one.
    Cpu,
    /// A Vulkan device; to be used for more than one call, [`Gpu`](crate::Gpu) keeps it open.
    Vulkan,
    /// The stages' references in order, on one thread of the CPU: slow, and the way to see every stage at work.
    Reference,
}

/// What becomes of constraints that cross where no vertex is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum CrossingPolicy {
    /// They are an error that names all of them.
    #[default]
    Error,
    /// They are cut there: a vertex is added at each crossing, at its position correctly rounded. Pieces may lie a little
    /// beside the constraints that they are of, by at most half a last place of each coordinate in every round, of which one
    /// is the rule; more are needed by lines that cannot be told apart where they cross, and these are brought together. The
    /// CPU does that for every backend, as a stage of its own in the report, and only if constraints cross.
    Split,
}

/// A function that is told how far the work has come.
pub type ProgressFn = Arc<dyn Fn(Progress) + Send + Sync>;

/// How to triangulate. The result does not depend on any of this but [`Options::crossings`].
#[derive(Clone)]
pub struct Options {
    /// Where to compute.
    pub backend: Backend,
    /// Threads of the CPU to use, at most 1024; 0 means as many as there are.
    pub threads: usize,
    /// The longer side of the pixel grid; none lets the number of points decide. The CPU backend uses no grid.
    pub grid: Option<u32>,
    /// The most crossing pairs that an error names.
    pub max_crossings: usize,
    /// What becomes of constraints that cross.
    pub crossings: CrossingPolicy,
    /// The most vertices that are added where constraints cross.
    pub max_added_vertices: usize,
    /// Which Vulkan device to take, where one is taken.
    pub device: Selection,
    /// Whether a Vulkan device times each kernel; that takes a little longer.
    pub timestamps: bool,
    /// Called between rounds, possibly from another thread.
    pub progress: Option<ProgressFn>,
    /// Set it to true to stop: the call returns [`Error::Cancelled`](crate::Error::Cancelled) at the next round.
    pub cancel: Option<Arc<AtomicBool>>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            backend: Backend::Auto,
            threads: 0,
            grid: None,
            max_crossings: 1_000_000,
            crossings: CrossingPolicy::Error,
            max_added_vertices: 10_000_000,
            device: Selection::default(),
            timestamps: false,
            progress: None,
            cancel: None,
        }
    }
}

impl Options {
    /// The defaults with another backend.
    pub fn with_backend(backend: Backend) -> Self {
        Self { backend, ..Self::default() }
    }

    pub(crate) fn monitor(&self) -> Monitor<'_> {
        Monitor {
            progress: self.progress.as_deref().map(|f| f as &(dyn Fn(Progress) + Sync)),
            cancel: self.cancel.as_deref(),
        }
    }
}

impl std::fmt::Debug for Options {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Options")
            .field("backend", &self.backend)
            .field("threads", &self.threads)
            .field("grid", &self.grid)
            .field("max_crossings", &self.max_crossings)
            .field("crossings", &self.crossings)
            .field("max_added_vertices", &self.max_added_vertices)
            .field("device", &self.device)
            .finish_non_exhaustive()
    }
}
