//! `polder verify`.

use crate::args::VerifyArgs;
use crate::failure::Failure;
use crate::job::{DASH, Job, usage};
use polder::verify::{Place, Problem, Verdict};
use polder_io::{Input, MeshFile, MeshFormat};
use serde_json::json;
use std::path::Path;
use std::process::ExitCode;

/// The exit code of a wrong mesh.
const WRONG: u8 = 1;

pub(crate) fn verify(job: &Job, args: &VerifyArgs) -> Result<ExitCode, Failure> {
    if args.input.input == Path::new(DASH) && args.mesh == Path::new(DASH) {
        usage("input and mesh cannot both be standard input");
    }
    let input = job.read(&args.input)?;
    let mesh = match named_mesh(job, &input, &args.mesh, args.mesh_from)? {
        Ok(mesh) => mesh,
        Err(message) => {
            job.done();
            match args.report {
                Some(_) => {
                    crate::print(&crate::json(&json!({ "valid": false, "canonical": false, "message": message }))?)?
                }
                None => crate::print(&format!("not valid: {message}"))?,
            }
            return Ok(ExitCode::from(WRONG));
        }
    };
    job.stage("checking");
    let verdict = polder::verify::check(&input.pslg, &mesh.triangles);
    job.done();
    match args.report {
        Some(_) => crate::print(&crate::json(&verdict)?)?,
        None => crate::print(&told(&verdict, input.first, mesh.first, args))?,
    }
    let right = if args.canonical { verdict.is_canonical() } else { verdict.is_valid() };
    Ok(if right { ExitCode::SUCCESS } else { ExitCode::from(WRONG) })
}

/// Reads a mesh and names its vertices by the input's points; or says which vertex is none of them.
pub(crate) fn named_mesh(
    job: &Job,
    input: &Input,
    path: &Path,
    from: Option<MeshFormat>,
) -> Result<Result<MeshFile, String>, Failure> {
    let mut mesh = job.read_mesh(path, from)?;
    let first = mesh.first as u64;
    if let Some(count) = mesh.vertices.as_ref().map(Vec::len)
        && let Err(vertex) = mesh.name_by_points(input.pslg.points())
    {
        let number = vertex as u64 + first;
        let file = path.display();
        return Ok(Err(format!("vertex {number} of the {count} in {file} equals no point of the input")));
    }
    Ok(Ok(mesh))
}

/// The verdict in the numbers of the files. What only speaks against being canonical is listed if that was demanded,
/// else counted, and left out where worse is to be said.
fn told(verdict: &Verdict, first_point: u32, first_triangle: u32, args: &VerifyArgs) -> String {
    let word = match (verdict.is_valid(), verdict.is_canonical()) {
        (_, true) => "valid and canonical",
        (true, false) => "valid, but not canonical",
        (false, _) => "not valid",
    };
    let mut lines = vec![format!("{}: {word}", args.mesh.display())];
    for &(kind, total) in verdict.totals() {
        if kind.is_harmless() && !args.canonical {
            if verdict.is_valid() {
                lines.push(format!("  {total} x: {}", kind.text()));
            }
            continue;
        }
        let listed: Vec<_> = verdict.problems().iter().filter(|problem| problem.kind == kind).collect();
        for problem in &listed {
            let place = renumbered(problem.place, first_point, first_triangle);
            lines.push(format!("  {}", Problem { kind, place }));
        }
        if total > listed.len() as u64 {
            lines.push(format!("  and {} more like this", total - listed.len() as u64));
        }
    }
    lines.join("\n")
}

fn renumbered(place: Place, p: u32, t: u32) -> Place {
    let point = |v: u32| v.saturating_add(p);
    let triangle = |i: u32| i.saturating_add(t);
    match place {
        Place::Mesh => Place::Mesh,
        Place::Triangle(i) => Place::Triangle(triangle(i)),
        Place::Triangles(pair) => Place::Triangles(pair.map(triangle)),
        Place::Edge { ends, triangle: i } => Place::Edge { ends: ends.map(point), triangle: triangle(i) },
        Place::Point(v) => Place::Point(point(v)),
        Place::Constraint { constraint, vertex } => {
            Place::Constraint { constraint: point(constraint), vertex: point(vertex) }
        }
    }
}
