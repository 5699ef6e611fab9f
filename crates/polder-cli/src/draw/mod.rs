//! `polder draw`: one stage as a picture.

mod meshes;
mod pixels;
mod raster;

use crate::args::{DrawArgs, Stage};
use crate::failure::Failure;
use crate::job::{DASH, Job, WriteTo, usage};
use polder::{Options, Stages};
use polder_io::svg::{Frame, Picture};
use polder_mesh::Pslg;
use std::path::Path;
use std::process::ExitCode;

/// The longer side of a picture, in its own units, and its margin.
const SIDE: f64 = 1000.0;
const MARGIN: f64 = 24.0;

pub(crate) fn draw(job: &Job, args: &DrawArgs) -> Result<ExitCode, Failure> {
    let extension = args.output.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    let is_png = match extension.as_deref() {
        Some("svg") => false,
        Some("png") => true,
        _ if args.output == Path::new(DASH) => false,
        _ => usage("the picture must be an .svg or .png file"),
    };
    if args.domain && args.stage != Stage::Final {
        usage("--domain is for the final triangulation");
    }
    let input = job.read(&args.input)?;
    let options = Options {
        grid: args.grid,
        progress: Some(job.progress()),
        cancel: Some(job.cancel.clone()),
        ..Options::default()
    };
    let failure = |error| Failure::of_library(error, input.first);
    let mut svg = Vec::new();
    let drawn = if args.stage == Stage::Final {
        let mut output = polder::triangulate(&input.pslg, &options).map_err(failure)?;
        if args.domain {
            crate::triangulate::keep_domain(job, &input, &mut output)?;
        }
        polder_io::svg::write_svg(&mut svg, input.pslg.points(), &output.triangulation)
    } else {
        job.stage("triangulating");
        let stages = polder::stages(&input.pslg, &options).map_err(failure)?;
        let (picture, title) = match &stages {
            Some(stages) => picture(args.stage, &input.pslg, stages),
            None => (Picture::new(Frame::fit(&[], SIDE, MARGIN)), "no points".into()),
        };
        picture.write(&mut svg, &title)
    };
    drawn.map_err(|e| Failure::io(&args.output, &e))?;

    job.stage("drawing");
    let bytes = if is_png { raster::png(&svg, args.size)? } else { svg };
    let write: Box<WriteTo> = Box::new(|out| out.write_all(&bytes));
    job.write(&[(args.output.clone(), &write)])?;
    Ok(ExitCode::SUCCESS)
}

fn picture(stage: Stage, pslg: &Pslg, stages: &Stages) -> (Picture, String) {
    match stage {
        Stage::Voronoi => pixels::voronoi(pslg, stages),
        Stage::Dualized => pixels::dualized(stages),
        Stage::Shifted => meshes::shifted(stages),
        Stage::Inserted => meshes::inserted(stages),
        Stage::Constrained | Stage::Final => meshes::constrained(stages),
    }
}
