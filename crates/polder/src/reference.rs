//! The backend that runs the stages' references.

use crate::report::Stopwatch;
use crate::{Error, Options, Output, Report, stages};
use polder_mesh::{Chains, Parts, Pslg, Triangulation};

pub(crate) fn triangulate(pslg: &Pslg, options: &Options) -> Result<Output, Error> {
    let mut watch = Stopwatch::start();
    let triangulation = match stages::run(pslg, options, &mut watch)? {
        Some(stages) => stages.triangulation,
        None => {
            Triangulation::from_slots(0, |_| None, Parts { representatives: Vec::new(), chains: Chains::default() })
        }
    };
    let mut report = Report::of(pslg, &triangulation, watch);
    report.backend = "reference";
    report.way = "digital Voronoi diagram, dualized, shifted, missing points inserted, constraints by flips, flips";
    report.why = "asked for".into();
    report.threads = 1;
    Ok(Output { triangulation, report })
}
