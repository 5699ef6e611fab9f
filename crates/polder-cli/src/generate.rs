//! `polder generate`.

use crate::args::{Family, GenerateArgs};
use crate::failure::Failure;
use crate::job::{Job, WriteTo, format_of, usage};
use polder::Pslg;
use polder_io::generate as make;
use polder_io::{Input, InputFormat};
use std::process::ExitCode;

pub(crate) fn generate(job: &Job, args: &GenerateArgs) -> Result<ExitCode, Failure> {
    let to = format_of(&args.output, args.to, InputFormat::of, "--to", "node, poly or pslg");
    let n = args.points;
    let segments = args.segments.unwrap_or(n / 10);
    let most = Pslg::MAX_POINTS / 2;
    if n > Pslg::MAX_POINTS || segments > most {
        usage(&format!("at most {} points and {most} segments can be made", Pslg::MAX_POINTS));
    }
    if args.width == Some(0) {
        usage("a lattice is at least 1 wide");
    }
    job.stage("generating");
    let pslg = family(args, n, segments);
    if to == InputFormat::Node && !pslg.constraints().is_empty() {
        usage("a .node file holds no segments; choose .poly or .pslg");
    }
    let input = Input::new(pslg, 1);
    let write: Box<WriteTo> = match to {
        InputFormat::Node => Box::new(|out| polder_io::write_node(out, &input)),
        InputFormat::Poly => Box::new(|out| polder_io::write_poly(out, &input)),
        InputFormat::Pslg => Box::new(|out| polder_io::write_pslg(out, &input.pslg)),
        other => return Err(Failure::new("unsupported", format!("{other:?} cannot be written"))),
    };
    job.write(&[(args.output.clone(), &write)])?;
    job.done();
    job.say(&format!("polder: {} points, {} segments", input.pslg.points().len(), input.pslg.constraints().len()));
    Ok(ExitCode::SUCCESS)
}

fn family(args: &GenerateArgs, n: usize, segments: usize) -> Pslg {
    let seed = args.seed;
    match args.family {
        Family::Uniform => make::uniform(n, seed),
        Family::Gaussian => make::gaussian(n, seed),
        Family::Clusters => make::clusters(n, args.clusters, args.sigma, seed),
        Family::Exponential => make::exponential(n, seed),
        Family::Circle => make::circle(n, seed),
        Family::Cocircular => make::cocircular(n, seed),
        Family::Concentric => make::concentric(n, args.circles, seed),
        Family::Lattice => {
            let width = args.width.unwrap_or(n.isqrt()).max(1);
            make::lattice(width, n / width)
        }
        Family::Collinear => make::collinear(n, seed),
        Family::NearCollinear => make::near_collinear(n, args.ulps, seed),
        Family::Huge => make::huge(n, seed),
        Family::Tiny => make::tiny(n, seed),
        Family::Mixed => make::mixed_magnitudes(n, seed),
        Family::Segments => make::segments(n, segments, seed),
        Family::Crossing => make::crossing_segments(n, segments, 0.1, seed),
        Family::Spiral => make::spiral(n),
        Family::Comb => make::comb(n),
        Family::Fan => make::fan(n / 2, seed),
    }
}
