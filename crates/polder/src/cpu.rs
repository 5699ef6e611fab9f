//! The CPU backend: points, then constraints, then the canonical order.

use crate::error::too_many_chain_vertices;
use crate::report::Stopwatch;
use crate::{Error, Options, Output, Report};
use polder_cpu::{CpuError, Delaunay};
use polder_mesh::Pslg;

/// More threads than this are a mistake, and would only get into each other's way.
const MAX_THREADS: usize = 1024;

/// Triangulates on the CPU, in a pool of threads of its own where the caller asks for a number of them.
pub(crate) fn triangulate(pslg: &Pslg, options: &Options) -> Result<Output, Error> {
    in_pool(options, || run(pslg, options))
}

/// The error that names the constraints that cross; for backends that have met one.
pub(crate) fn crossings(pslg: &Pslg, options: &Options) -> Result<Error, Error> {
    if options.max_crossings == 0 {
        return Ok(Error::CrossingConstraints { pairs: Vec::new(), truncated: true });
    }
    match in_pool(options, || named_crossings(pslg, options))? {
        Error::CrossingConstraints { pairs, truncated: false } if pairs.is_empty() => {
            let what = "a constraint was stopped, but none cross".to_owned();
            Err(Error::Internal { stage: "constrain", what })
        }
        named => Ok(named),
    }
}

/// Runs some work on as many threads as the caller asks for.
pub(crate) fn in_pool<T: Send>(options: &Options, work: impl FnOnce() -> Result<T, Error> + Send) -> Result<T, Error> {
    if options.threads == 0 {
        return work();
    }
    if options.threads > MAX_THREADS {
        let what = format!("{} threads: at most {MAX_THREADS} are possible", options.threads);
        return Err(Error::Unsupported { what });
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads).build();
    let pool = pool.map_err(|e| Error::Unsupported { what: format!("{} threads: {e}", options.threads) })?;
    pool.install(work)
}

fn run(pslg: &Pslg, options: &Options) -> Result<Output, Error> {
    let monitor = options.monitor();
    let mut watch = Stopwatch::start();
    let mut delaunay = Delaunay::new(pslg.points(), monitor).map_err(typed)?;
    watch.stage("delaunay", [("vertices", delaunay.vertices() as u64)]);

    let (chains, counts) = match delaunay.constrain(pslg.constraints(), monitor) {
        Err(CpuError::Crossing { .. }) => {
            drop(delaunay);
            return Err(named_crossings(pslg, options)?);
        }
        other => other.map_err(typed)?,
    };
    watch.stage("constrain", [("crossed_triangles", counts.crossed_triangles), ("flips", counts.flips)]);

    let triangulation = delaunay.finish(chains);
    watch.stage("canonical_order", []);
    let mut report = Report::of(pslg, &triangulation, watch);
    report.backend = "cpu";
    report.way = "divide and conquer, then constraints one by one";
    report.threads = rayon::current_num_threads();
    report.why = "asked for".into();
    Ok(Output { triangulation, report })
}

/// Names all crossings: those that an insertion meets are not all there are, since two constraints that a third one
/// stops never meet. So the constraints walk the mesh of the points alone.
fn named_crossings(pslg: &Pslg, options: &Options) -> Result<Error, Error> {
    use polder_constrain::reference::{crossings, walk};

    let delaunay = Delaunay::new(pslg.points(), options.monitor()).map_err(typed)?;
    let ends = delaunay.vertices_of(pslg.constraints()).map_err(typed)?;
    let (mesh, positions, _) = delaunay.to_ghost_mesh();
    drop(delaunay);
    let walk = walk(&mesh, &positions, &ends)?;
    Ok(crate::stages::crossing(crossings(&mesh, &positions, &walk, options.max_crossings)?))
}

pub(crate) fn typed(error: CpuError) -> Error {
    match error {
        CpuError::Cancelled(cancelled) => cancelled.into(),
        CpuError::TooLarge { .. } => too_many_chain_vertices(),
        other => Error::Internal { stage: "cpu", what: other.to_string() },
    }
}
