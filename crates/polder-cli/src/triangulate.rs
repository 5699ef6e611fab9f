//! `polder triangulate` and `polder digest`.

use crate::args::{CrossingChoice, DigestArgs, TriangulateArgs, WayArgs};
use crate::failure::Failure;
use crate::job::{DASH, Job, WriteTo, format_of, usage};
use crate::verify::named_mesh;
use polder::vulkan::Selection;
use polder::{CrossingPolicy, Options, Output, Pslg, Triangulation};
use polder_io::{Input, MeshFormat};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

pub(crate) fn triangulate(job: &Job, args: &TriangulateArgs) -> Result<ExitCode, Failure> {
    let to = format_of(&args.output, args.to, MeshFormat::of, "--to", "ele, tri, obj, ply, vtk or svg");
    let beside = args.neigh || args.edge || args.node;
    if beside && (to != MeshFormat::Ele || args.output == Path::new(DASH)) {
        usage("--neigh, --edge and --node stand beside an .ele file");
    }
    let input = job.read(&args.input)?;
    if !args.domain && input.has_holes_or_closed_outline() {
        job.say("polder: the whole convex hull is triangulated; --domain keeps to outlines and holes");
    }
    let crossings = match args.crossings {
        CrossingChoice::Error => CrossingPolicy::Error,
        CrossingChoice::Split => CrossingPolicy::Split,
    };
    let options = Options { crossings, max_added_vertices: args.max_added, ..Options::default() };
    let mut output = compute_with(job, &input, &args.way, options)?;
    if args.domain {
        keep_domain(job, &input, &mut output)?;
    }
    let Output { triangulation, report } = output;

    let input = with_added(input, &triangulation)?;
    if !triangulation.added().is_empty() && to == MeshFormat::Ele && !args.node {
        job.say("polder: points were added where segments cross; --node writes all points beside the .ele");
    }
    let points = input.pslg.points();
    let main: Box<WriteTo> = match to {
        MeshFormat::Ele => Box::new(|out| polder_io::write_ele(out, &triangulation, input.first)),
        MeshFormat::Tri => Box::new(|out| polder_io::write_tri(out, triangulation.triangles())),
        MeshFormat::Obj => Box::new(|out| polder_io::write_obj(out, points, &triangulation)),
        MeshFormat::Ply => Box::new(|out| polder_io::write_ply(out, points, &triangulation)),
        MeshFormat::Vtk => Box::new(|out| polder_io::write_vtk(out, points, &triangulation)),
        MeshFormat::Svg => Box::new(|out| polder_io::svg::write_svg(out, points, &triangulation)),
        other => return Err(Failure::new("unsupported", format!("{other:?} cannot be written"))),
    };
    let neigh: Box<WriteTo> = Box::new(|out| polder_io::write_neigh(out, &triangulation, input.first));
    let edge: Box<WriteTo> = Box::new(|out| polder_io::write_edge(out, &triangulation, &input));
    let node: Box<WriteTo> = Box::new(|out| polder_io::write_node(out, &input));
    let mut files: Vec<(PathBuf, &WriteTo<'_>)> = Vec::new();
    for (asked, extension, write) in
        [(args.neigh, "neigh", &neigh), (args.edge, "edge", &edge), (args.node, "node", &node)]
    {
        if asked {
            files.push((args.output.with_extension(extension), write));
        }
    }
    // Last, so that who sees it finds the others beside it.
    files.push((args.output.clone(), &main));
    refuse_overwriting_input(&args.input.input, &files);
    job.write(&files)?;
    job.done();

    if args.report.is_some() {
        let line = crate::json(&report)?;
        if args.output == Path::new(DASH) { eprintln!("{line}") } else { crate::print(&line)? }
    } else {
        job.say(&summary(&report));
    }
    Ok(ExitCode::SUCCESS)
}

/// Takes away the exterior and the holes.
pub(crate) fn keep_domain(job: &Job, input: &Input, output: &mut Output) -> Result<(), Failure> {
    job.stage("keeping the domain");
    let domain = polder::regions::domain(input.pslg.points(), &output.triangulation, &input.holes);
    let domain = domain.map_err(|error| Failure::of_domain(error, input.first))?;
    for (i, hole) in domain.holes.iter().enumerate() {
        let nothing = match hole {
            None => "lies in no triangle",
            Some(region) if domain.regions.depth(*region) == 0 => "lies outside all outlines",
            Some(_) => continue,
        };
        job.say(&format!("polder: hole {} {nothing}", i as u64 + u64::from(input.first)));
    }
    if domain.triangles.is_empty() && !output.triangulation.triangles().is_empty() {
        job.say("polder: no segments close an outline, so nothing is left");
    }
    output.triangulation = domain.triangulation;
    output.report.triangles = domain.triangles.len();
    output.report.constraints.constrained_edges = output.triangulation.edges().filter(|e| e.constrained).count();
    Ok(())
}

/// One sentence on what came out.
fn summary(report: &polder::Report) -> String {
    let counted = |count: usize, [one, many]: [&str; 2]| format!("{count} {}", if count == 1 { one } else { many });
    let mut parts = vec![
        counted(report.triangles, ["triangle", "triangles"]),
        counted(report.points.vertices, ["vertex", "vertices"]),
        counted(report.constraints.constrained_edges, ["constrained edge", "constrained edges"]),
    ];
    for (count, what) in [
        (report.points.duplicates, ["duplicate point", "duplicate points"]),
        (report.points.added, ["point added where segments cross", "points added where segments cross"]),
        (report.constraints.repeated.len(), ["repeated segment", "repeated segments"]),
        (report.constraints.zero_length.len(), ["segment of no length", "segments of no length"]),
    ] {
        if count > 0 {
            parts.push(counted(count, what));
        }
    }
    let time = match report.seconds {
        s if s < 1.0 => format!("{:.1} ms", 1e3 * s),
        s => format!("{s:.2} s"),
    };
    let device = report.device.as_ref().map_or_else(String::new, |device| format!(" on {}", device.name));
    format!("polder: {} in {time} ({}{device}: {})", parts.join(", "), report.backend, report.why)
}

/// A .node written beside an .ele must not replace the .node that is the input.
fn refuse_overwriting_input(input: &Path, files: &[(PathBuf, &WriteTo<'_>)]) {
    let real = |path: &Path| std::fs::canonicalize(path).ok();
    let inputs = [real(input), real(&input.with_extension("node"))];
    let clash = files.iter().find(|(path, _)| real(path).is_some_and(|path| inputs.contains(&Some(path))));
    if let Some((path, _)) = clash.filter(|_| input != Path::new(DASH)) {
        usage(&format!("{} would replace the input", path.display()));
    }
}

/// The input with the added vertices among its points; their attributes and markers are zero.
fn with_added(mut input: Input, triangulation: &Triangulation) -> Result<Input, Failure> {
    let added = triangulation.added();
    if added.is_empty() {
        return Ok(input);
    }
    let (mut points, constraints) = input.pslg.into_parts();
    points.extend(added.iter().map(|vertex| vertex.position));
    input.attributes.resize(points.len() * input.attributes_per_point, 0.0);
    if let Some(markers) = &mut input.point_markers {
        markers.resize(points.len(), 0);
    }
    input.pslg = Pslg::new(points, constraints).map_err(|e| Failure::of_library(e.into(), input.first))?;
    Ok(input)
}

/// Triangulates with the bar and the cancel flag at work; segments that cross are an error.
pub(crate) fn compute(job: &Job, input: &Input, way: &WayArgs) -> Result<Output, Failure> {
    compute_with(job, input, way, Options::default())
}

fn compute_with(job: &Job, input: &Input, way: &WayArgs, options: Options) -> Result<Output, Failure> {
    let options = Options {
        backend: way.backend.backend(),
        threads: way.threads.into(),
        grid: way.grid,
        max_crossings: way.max_crossings,
        device: way.device.as_deref().map_or_else(Selection::default, Selection::parse),
        progress: Some(job.progress()),
        cancel: Some(job.cancel.clone()),
        ..options
    };
    job.stage("triangulating");
    polder::triangulate(&input.pslg, &options).map_err(|error| Failure::of_library(error, input.first))
}

pub(crate) fn digest(job: &Job, args: &DigestArgs) -> Result<ExitCode, Failure> {
    let input = job.read(&args.input)?;
    let digest = match &args.mesh {
        None => compute(job, &input, &args.way)?.triangulation.digest(),
        Some(path) => {
            let mesh = named_mesh(job, &input, path, args.mesh_from)?
                .map_err(|message| Failure::new("malformed_file", message))?;
            let points = input.pslg.points();
            let lowest = polder_io::lowest_equal(points);
            let mut triangles = mesh.triangles;
            for corner in triangles.iter_mut().flatten() {
                *corner = lowest.get(*corner as usize).copied().unwrap_or(*corner);
            }
            let mesh = Triangulation::from_triangles(points.len(), &triangles);
            mesh.map_err(|e| Failure::new("malformed_file", format!("{}: {e}", path.display())))?.digest()
        }
    };
    job.done();
    crate::print(&digest.to_string())?;
    Ok(ExitCode::SUCCESS)
}
