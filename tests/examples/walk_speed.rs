//! How fast constraints are cut at vertices on a device: medians of ten, by timestamps, after chains were held against the
//! reference. `walk_speed [family:points:constraints]...`, say `segments:1000000:100000`; `POLDER_DEVICE` names the device.
//! Meshes are what stages 1 to 4 leave on the device.

mod speed;

use glam::DVec2;
use polder_constrain::gpu::pieces::Grid;
use polder_constrain::gpu::walk::{Input, Names, Stage};
use polder_constrain::reference;
use polder_dualize::gpu::{dualize, insert, shift, to_insert};
use polder_flip::gpu::{self as flips, Arithmetic, Mesh, Tally};
use polder_io::generate;
use polder_mesh::Pslg;
use polder_voronoi::{GridMapping, Options};
use polder_vulkan::{Buffer, Device, Engine, Recording, RunOptions};
use speed::{Failure, uploaded};
use std::time::Instant;

fn main() -> Result<(), Failure> {
    speed::each("segments:20000:2000", prepare, measure)
}

struct Case {
    title: String,
    pslg: Pslg,
}

fn prepare(case: &str) -> Result<Case, Failure> {
    Ok(Case { title: case.to_owned(), pslg: input(case).ok_or("a case is family:points:constraints")? })
}

fn input(case: &str) -> Option<Pslg> {
    let mut parts = case.split(':');
    let family = parts.next()?;
    let mut number = || parts.next()?.parse::<usize>().ok();
    let (points, constraints) = (number()?, number()?);
    Some(match family {
        "segments" => generate::segments(points, constraints, 1),
        "crossing" => generate::crossing_segments(points, constraints, 0.3, 1),
        "fan" => generate::fan(constraints, 1),
        "through" => generate::through_vertices(constraints, 1),
        "diameters" => diameters(constraints),
        "rows" => rows(points, constraints),
        "strip" => strip(points),
        _ => return None,
    })
}

/// Constraints through one vertex.
fn diameters(count: usize) -> Pslg {
    let mut points = vec![DVec2::ZERO];
    for i in 0..count {
        let (y, x) = (std::f64::consts::PI * (i as f64 + 0.5) / count as f64).sin_cos();
        points.extend([DVec2::new(x, y), DVec2::new(-x, -y)]);
    }
    let constraints = (0..count as u32).map(|i| [2 * i + 1, 2 * i + 2]).collect();
    Pslg::new(points, constraints).unwrap_or_default()
}

/// Constraints along whole rows of a lattice.
fn rows(points: usize, constraints: usize) -> Pslg {
    let side = points.isqrt();
    let at = |y: usize, x: usize| (y % side * side + x) as u32;
    let constraints = (0..constraints).map(|y| [at(y, 0), at(y, side - 1)]).collect();
    Pslg::new(generate::lattice(side, side).points().to_vec(), constraints).unwrap_or_default()
}

/// One constraint through all triangles of a strip.
fn strip(points: usize) -> Pslg {
    let points = generate::lattice(points / 2, 2).points().to_vec();
    let last = (points.len() as u32).saturating_sub(1);
    Pslg::new(points, vec![[0, last]]).unwrap_or_default()
}

/// What stages 1 to 4 leave.
struct Start {
    mesh: Mesh,
    order: Vec<u32>,
    vertex_of: Vec<u32>,
}

fn start(device: &Device, engine: &mut Engine, points: &[DVec2]) -> Result<Start, Failure> {
    let count = points.len();
    let arithmetic = Arithmetic::of(device)?;
    let mapping = GridMapping::fit(points, &Options::default())?;
    let size = mapping.size();
    let voronoi = polder_voronoi::gpu::Stage::new(device)?;
    let (dualize, shift) = (dualize::Stage::new(device)?, shift::Stage::new(device, arithmetic)?);
    let (to_insert, insert) = (to_insert::Stage::new(device)?, insert::Stage::new(device)?);
    let flips = flips::Stage::new(device)?;
    let mesh = Mesh::new(device, count)?;
    let grid = voronoi.buffers(count, size)?;
    let dual = dualize.buffers(size)?;
    let shifted = shift.buffers(count)?;
    let new = to_insert::Buffers::new(device, count)?;
    let inserted = insert.buffers(count, mesh.capacity())?;
    let flip = flips.buffers(mesh.capacity())?;
    let tally = Tally::new(device)?;
    let uploaded = Buffer::new(device, "points", count)?;
    engine.upload(uploaded.view(), points)?;

    let mut recording = Recording::new(device);
    voronoi.record(&mut recording, &mapping, uploaded.view(), &grid)?;
    let (order, pixels, colors, sites) = (grid.order(), grid.pixels(), grid.colors(), grid.site_count()?);
    let input = dualize::Input { size, colors, pixels, sites };
    dualize.record(&mut recording, input, &mesh, &dual)?;
    let input = shift::Input { mapping: &mapping, points: uploaded.view(), order, pixels, sites };
    flips.record_start(&mut recording, &flip);
    tally.record_clear(&mut recording);
    let with = shift::Flips { stage: &flips, buffers: &flip, tally: &tally };
    shift.record(&mut recording, input, &mesh, with, &shifted)?;
    let input = to_insert::Input { width: size[0], colors, pixels, sites };
    to_insert.record(&mut recording, input, &shifted, &new)?;
    let input = insert::Input {
        points: new.points(),
        starts: new.starts(),
        count: Some(new.count()?),
        sites,
        freed: shifted.freed(),
    };
    let read = insert.record(&mut recording, &mesh, (&flips, &flip), &inserted, input)?;
    read.result(&engine.run(&recording, &RunOptions::default())?)?;
    let (order, vertex_of) = (engine.download_vec(order)?, engine.download_vec(inserted.vertex_of())?);
    Ok(Start { mesh, order, vertex_of })
}

fn measure(device: &Device, case: Case) -> Result<(), Failure> {
    let Case { title, pslg } = &case;
    let mut engine = Engine::new(device)?;
    let Start { mesh, order, vertex_of } = start(device, &mut engine, pslg.points())?;
    let count = pslg.constraints().len();
    println!("{title}: {} points, {count} constraints", pslg.points().len());
    let vertices = reference::kernels::name_points(&order, &vertex_of);
    let ends = reference::kernels::name_ends(&vertices, pslg.constraints());
    let positions: Vec<DVec2> = order.iter().map(|&i| pslg.points()[i as usize]).collect();
    let clock = Instant::now();
    let expected = reference::walk(&mesh.download(&mut engine)?, &positions, &ends)?;
    let seconds = clock.elapsed().as_secs_f64();
    let longest = expected.crossed_edges.iter().max().copied().unwrap_or(0);
    let chained: usize = expected.chains.iter().map(<[u32]>::len).sum();
    let intersections = expected.intersections();
    println!(
        "  reference {seconds:.2} s; {intersections} intersections, {longest} edges crossed at most, {chained} vertices"
    );

    let stage = Stage::new(device)?;
    let buffers = stage.buffers(positions.len(), count, Stage::usual_stops(count).max(chained))?;
    let constraints = uploaded(device, &mut engine, pslg.constraints())?;
    let (order, vertex_of) = (uploaded(device, &mut engine, &order)?, uploaded(device, &mut engine, &vertex_of)?);
    let names = Some(Names { order: order.view(), vertex_of: vertex_of.view() });
    let corner = |f: fn(DVec2, DVec2) -> DVec2| positions.iter().copied().reduce(f).unwrap_or_default();
    let grid = Grid::over(corner(DVec2::min), corner(DVec2::max), positions.len());
    println!("  {counts} bytes", counts = memory(positions.len(), count));
    let length = grid.piece_length();
    let other = |length| Some(grid.with_piece_length(length));
    for grid in [Some(grid), other(length / 2), other(length / 4), other(2 * length), None] {
        let mut recording = Recording::new(device);
        let input = Input { constraints: constraints.view(), names, grid };
        let read = stage.record(&mut recording, &mesh, &buffers, input)?;
        let report = engine.run(&recording, &RunOptions::default())?;
        let counts = read.result(&report)?;
        let chains = engine.download_vec(buffers.chains())?;
        let equal = expected.chains.iter().flatten().eq(chains[..counts.chained as usize].iter());
        println!(
            "  {}: chains are equal: {equal}; {counts:?}",
            grid.map_or("whole".to_owned(), |grid| format!("pieces of {}", grid.piece_length()))
        );
        if grid.is_some() {
            let pieces = engine.download_vec(buffers.pieces().pieces())?;
            let room = pieces.len().min(engine.download_vec(buffers.pieces().count())?[0] as usize);
            let found = pieces[..room].iter().filter(|piece| piece[2] != u32::MAX).count();
            println!("  {room} later pieces, {found} of them have a beginning");
        }
        speed::time(&mut engine, None, &recording)?;
    }
    Ok(())
}

fn memory(vertices: usize, constraints: usize) -> u64 {
    Stage::estimate(vertices, constraints, Stage::usual_stops(constraints)).bytes()
}
