//! Constraints cut at vertices on the device, against the reference.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod constrain_support;
mod vulkan_support;

use constrain_support::grid;
use glam::DVec2;
use polder_constrain::gpu::pieces::Grid;
use polder_constrain::gpu::walk::{Buffers, Counts, Input, Names, Read, Stage};
use polder_constrain::{ConstrainError, Walk, reference};
use polder_flip::gpu::{Arithmetic, Mesh};
use polder_io::generate;
use polder_mesh::{GhostMesh, Pslg};
use polder_tests::families;
use vulkan_support::Gpu;

/// A device, and the stage by both arithmetics.
fn stages() -> (Gpu, [Stage; 2]) {
    let gpu = Gpu::open();
    let stages = [Arithmetic::Filtered, Arithmetic::Integers];
    let stages = stages.map(|arithmetic| Stage::with_arithmetic(&gpu.device, arithmetic).unwrap());
    (gpu, stages)
}

/// What stages 1 to 4 leave of an input, and how the reference cuts its constraints.
struct Case {
    mesh: GhostMesh,
    positions: Vec<DVec2>,
    constraints: Vec<[u32; 2]>,
    order: Vec<u32>,
    vertex_of: Vec<u32>,
    expected: Walk,
}

impl Case {
    fn new(pslg: &Pslg) -> Self {
        let phases = polder_dualize::reference::triangulate(pslg.points(), &Default::default()).unwrap();
        let order = phases.voronoi.sites.order.clone();
        let positions = phases.positions(pslg.points());
        let (mesh, vertex_of) = (phases.inserted.mesh, phases.inserted.vertex_of);
        let mut vertices = vec![0; order.len()];
        order.iter().zip(&vertex_of).for_each(|(&input, &v)| vertices[input as usize] = v);
        let ends: Vec<[u32; 2]> = pslg.constraints().iter().map(|c| c.map(|end| vertices[end as usize])).collect();
        let expected = reference::walk(&mesh, &positions, &ends).unwrap();
        Self { mesh, positions, constraints: pslg.constraints().to_vec(), order, vertex_of, expected }
    }
}

/// On the device.
struct On {
    buffers: Buffers,
    read: Read,
    recording: polder_vulkan::Recording,
}

fn record(gpu: &mut Gpu, stage: &Stage, case: &Case, stops: usize, grid: Option<Grid>) -> On {
    let vertices = case.positions.len();
    let mesh = Mesh::new(&gpu.device, vertices).unwrap();
    mesh.upload(&mut gpu.engine, &case.mesh, &case.positions).unwrap();
    let buffers = stage.buffers(vertices, case.constraints.len(), stops).unwrap();
    let (constraints, order) = (gpu.buffer(&case.constraints), gpu.buffer(&case.order));
    let vertex_of = gpu.buffer(&case.vertex_of);
    let names = Some(Names { order: order.view(), vertex_of: vertex_of.view() });
    let mut recording = gpu.recording();
    let input = Input { constraints: constraints.view(), names, grid };
    let read = stage.record(&mut recording, &mesh, &buffers, input).unwrap();
    On { buffers, read, recording }
}

impl On {
    fn result(&self, gpu: &mut Gpu) -> Result<Counts, ConstrainError> {
        self.read.result(&gpu.run(&self.recording))
    }

    fn assert(&self, gpu: &mut Gpu, name: &str, case: &Case) {
        let counts = self.result(gpu).unwrap_or_else(|error| panic!("{name}: {error}"));
        let expected = &case.expected.chains;
        let chained: usize = expected.iter().map(<[u32]>::len).sum();
        assert_eq!(counts.chained, chained as u64, "{name}");
        assert_eq!(counts.sub_constraints, (chained - case.constraints.len()) as u64, "{name}");
        let offsets = gpu.fetch(self.buffers.offsets().unwrap());
        let chains = gpu.fetch(self.buffers.chains());
        let sub_constraints = gpu.fetch(self.buffers.sub_constraints());
        for (c, chain) in expected.iter().enumerate() {
            let (from, to) = (offsets[c] as usize, offsets[c + 1] as usize);
            assert_eq!(&chains[from..to], chain, "{name}: chain {c}");
            let pairs = chain.windows(2).map(|pair| [pair[0].min(pair[1]), pair[0].max(pair[1])]);
            let found = &sub_constraints[from - c..from - c + chain.len() - 1];
            assert!(pairs.eq(found.iter().copied()), "{name}: sub-constraints of {c}");
        }
        assert_eq!(offsets[case.constraints.len()] as usize, chained, "{name}");
    }
}

fn assert_walked(gpu: &mut Gpu, stage: &Stage, name: &str, case: &Case) {
    let chained: usize = case.expected.chains.iter().map(<[u32]>::len).sum();
    let room = Stage::usual_stops(case.constraints.len()).max(2 * chained);
    let grid = grid(&case.positions);
    // Whole, in pieces, and in pieces of a triangle or so; of few constraints, lest they be millions.
    let short = case.positions.len() * case.constraints.len() < 30_000;
    let grids = [None, Some(grid), Some(grid.with_piece_length(64)), Some(grid.with_piece_length(1))];
    for grid in grids.into_iter().take(if short { 4 } else { 2 }) {
        record(gpu, stage, case, room, grid).assert(gpu, name, case);
    }
}

#[test]
fn every_family() {
    let (mut gpu, stages) = stages();
    for (n, seed) in [(8, 1), (60, 2), (700, 3), (3000, 4)] {
        for (name, pslg) in families(n, seed) {
            let case = Case::new(&pslg);
            for stage in &stages {
                assert_walked(&mut gpu, stage, name, &case);
            }
        }
    }
}

/// Constraints between any points, which cross, touch and overlap.
#[test]
fn any_constraints() {
    let (mut gpu, stages) = stages();
    for (turn, (name, pslg)) in families(400, 5).into_iter().enumerate() {
        let points = pslg.points().to_vec();
        let n = points.len() as u32;
        let picks = vulkan_support::words(turn as u64, 1200);
        let constraints = picks.chunks(2).map(|pair| [pair[0] % n, pair[1] % n]).collect();
        let case = Case::new(&Pslg::new(points, constraints).unwrap());
        assert_walked(&mut gpu, &stages[turn % 2], name, &case);
    }
}

#[test]
fn no_constraint_and_one_workgroup_and_its_neighbors() {
    let (mut gpu, stages) = stages();
    for count in [0, 1, 2, 3, 255, 256, 257, 511, 512, 513] {
        let pslg = generate::segments(2 * count + 10, count, count as u64);
        assert_walked(&mut gpu, &stages[count % 2], "segments", &Case::new(&pslg));
    }
}

#[test]
fn one_point_and_two() {
    let (mut gpu, [stage, _]) = stages();
    let p = DVec2::new(0.5, -1.0);
    for points in [vec![p], vec![p; 2], vec![p, -p], vec![p, -p, p]] {
        let last = points.len() as u32 - 1;
        let pslg = Pslg::new(points, vec![[0, last], [last, 0], [0, 0]]).unwrap();
        assert_walked(&mut gpu, &stage, "few points", &Case::new(&pslg));
    }
}

/// Walks that need many dispatches give what one dispatch gives.
#[test]
fn walks_go_on() {
    let gpu = Gpu::open();
    let mut stage = Stage::new(&gpu.device).unwrap();
    let mut gpu = gpu;
    for (most, n) in [(2, 60), (3, 300), (17, 2000)] {
        stage.set_most_steps(most);
        for (name, pslg) in families(n, 6) {
            assert_walked(&mut gpu, &stage, name, &Case::new(&pslg));
        }
    }
}

/// Four hundred constraints through one vertex, and one through all triangles of a strip.
#[test]
fn many_through_one_vertex_and_one_through_many_triangles() {
    let (mut gpu, [stage, _]) = stages();
    let mut points = vec![DVec2::ZERO];
    for i in 0..400 {
        let (y, x) = (std::f64::consts::PI * (f64::from(i) + 0.5) / 400.0).sin_cos();
        points.extend([DVec2::new(x, y), DVec2::new(-x, -y)]);
    }
    let diameters = (0..400).map(|i| [2 * i + 1, 2 * i + 2]).collect();
    let case = Case::new(&Pslg::new(points, diameters).unwrap());
    assert!(case.expected.chains.iter().all(|chain| chain.len() == 3));
    assert_walked(&mut gpu, &stage, "diameters", &case);

    let strip = generate::lattice(2000, 2).points().to_vec();
    let case = Case::new(&Pslg::new(strip, vec![[0, 3999]]).unwrap());
    assert!(case.expected.crossed_edges[0] > 3900);
    assert_walked(&mut gpu, &stage, "strip", &case);
}

/// One constraint through very many vertices begins again from some of these: else its walk would take hundreds of rounds.
#[test]
fn walks_through_many_vertices_begin_again() {
    let (mut gpu, stages) = stages();
    for (turn, count) in [300, 5000, 20_000].into_iter().enumerate() {
        let case = Case::new(&generate::through_vertices(count, turn as u64));
        assert_eq!(case.expected.chains.get(0).len(), count + 2);
        let stage = &stages[turn % 2];
        assert_walked(&mut gpu, stage, "through vertices", &case);
        let on = record(&mut gpu, stage, &case, 2 * count + 9, Some(grid(&case.positions)));
        let rounds = gpu.run(&on.recording).rounds;
        assert!(rounds.iter().all(|&(name, rounds)| name != "walk" || rounds < 9), "{rounds:?}");
    }
    // Several, and others among them; not worth it for rows of twenty.
    for (points, constraints) in [(3000, 5), (1500, 40)] {
        let points = generate::lattice(points, 20).points().to_vec();
        let along = |i: u32, count: u32| [i % 20 * count, (i % 20 + 1) * count - 1];
        let count = points.len() as u32 / 20;
        let rows = (0..constraints).map(|i| along(i, count)).chain([[0, count + 1], [7, 3 * count + 2]]);
        let case = Case::new(&Pslg::new(points, rows.collect()).unwrap());
        assert_walked(&mut gpu, &stages[1], "rows", &case);
    }
}

#[test]
fn a_recording_serves_again_and_buffers_for_other_numbers_are_refused() {
    let (mut gpu, [stage, _]) = stages();
    let case = Case::new(&generate::segments(600, 120, 8));
    let grid = Some(grid(&case.positions).with_piece_length(64));
    let on = record(&mut gpu, &stage, &case, 100, grid);
    for _ in 0..3 {
        on.assert(&mut gpu, "segments", &case);
    }
    let vertices = case.positions.len();
    let mesh = Mesh::new(&gpu.device, vertices).unwrap();
    let constraints = gpu.buffer(&case.constraints);
    for (vertices, count) in [(vertices - 1, 120), (vertices, 119), (vertices, 121)] {
        let buffers = stage.buffers(vertices, count, 100).unwrap();
        let mut recording = gpu.recording();
        let input = Input { constraints: constraints.view(), names: None, grid };
        assert!(stage.record(&mut recording, &mesh, &buffers, input).is_err());
        assert!(recording.is_empty());
    }
}

#[test]
fn too_little_room_says_how_much_is_needed() {
    let (mut gpu, [stage, _]) = stages();
    let points = generate::lattice(40, 40).points().to_vec();
    let constraints = (0..40).map(|y| [40 * y, 40 * y + 39]).chain([[0, 1599]]).collect();
    let case = Case::new(&Pslg::new(points, constraints).unwrap());
    let needed = 41 * 38;
    for room in [0, 1, needed as usize - 1] {
        let error = record(&mut gpu, &stage, &case, room, None).result(&mut gpu).unwrap_err();
        assert_eq!(error, ConstrainError::TooManyStops { needed, room: room as u32 });
    }
    record(&mut gpu, &stage, &case, needed as usize, None).assert(&mut gpu, "lattice", &case);
}

#[test]
fn a_hull_that_is_not_convex_loses_the_walk() {
    let (mut gpu, stages) = stages();
    let positions: Vec<DVec2> = [(0.0, 0.0), (4.0, 0.0), (0.0, 4.0)].map(DVec2::from).to_vec();
    let mesh = polder_flip::reference::chain(&[0, 1, 2]);
    let constraints = vec![[0, 1], [0, 2]];
    let own = vec![0, 1, 2];
    let case = Case { mesh, positions, constraints, order: own.clone(), vertex_of: own, expected: Walk::default() };
    for stage in &stages {
        let error = record(&mut gpu, stage, &case, 9, None).result(&mut gpu).unwrap_err();
        assert_eq!(error, ConstrainError::WalkLost { constraint: 1 });
    }
}
