//! Long walks in pieces: the kernels against the references of their names.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod constrain_support;
mod vulkan_support;

use constrain_support::{Start, grid};
use glam::DVec2;
use polder_constrain::gpu::pieces::{Buffers, Grid, Stage, Walkers};
use polder_constrain::reference::kernels::{self as expected, Beginning};
use polder_flip::gpu::{Arithmetic, Mesh};
use polder_flip::priority;
use polder_mesh::{DELETED, NONE};
use polder_tests::families;
use polder_vulkan::Buffer;
use vulkan_support::Gpu;

/// The length of a piece in 64ths of a cell: short, so that there are many.
const SHORT: u32 = 180;

struct Case {
    start: Start,
    grid: Grid,
    ends: Vec<[u32; 2]>,
    list: Vec<u32>,
    spokes: Vec<u32>,
    degrees: Vec<u32>,
}

impl Case {
    /// A mesh of stage 4 and walkers between any of its vertices, of which some are listed.
    fn new(start: Start, seed: u64) -> Option<Self> {
        let known: Vec<u32> = start.mesh.triangles.iter().flatten().copied().filter(|&v| v < DELETED).collect();
        let any = |word: u32| known[word as usize % known.len()];
        if known.is_empty() {
            return None;
        }
        let ends: Vec<[u32; 2]> =
            vulkan_support::words(seed, 600).chunks(2).map(|pair| [any(pair[0]), any(pair[1])]).collect();
        let list =
            (0..ends.len() as u32).filter(|&i| i % 3 != 1 && ends[i as usize][0] != ends[i as usize][1]).collect();
        let (spokes, degrees) = expected::find_spokes(&start.mesh, start.positions.len());
        let grid = grid(&start.positions).with_piece_length(SHORT);
        Some(Self { start, grid, ends, list, spokes, degrees })
    }

    fn at(&self, v: u32) -> DVec2 {
        self.start.positions[v as usize]
    }
}

fn cases() -> impl Iterator<Item = (&'static str, Case)> {
    let all = [(8, 1), (300, 2), (2000, 3)].into_iter().flat_map(|(n, seed)| families(n, seed));
    all.filter_map(|(name, pslg)| Some((name, Case::new(Start::stage_4(&pslg), 4)?)))
}

struct On {
    mesh: Mesh,
    buffers: Buffers,
    held: [Buffer<u32>; 5],
    ends: Buffer<[u32; 2]>,
}

impl On {
    fn new(gpu: &mut Gpu, case: &Case, room: usize) -> Self {
        let vertices = case.start.positions.len();
        let mesh = Mesh::new(&gpu.device, vertices).unwrap();
        mesh.upload(&mut gpu.engine, &case.start.mesh, &case.start.positions).unwrap();
        let buffers = Buffers::new(&gpu.device, vertices, room).unwrap();
        let runs = vec![7; case.ends.len()];
        let counts = [case.list.len() as u32];
        let held = [&case.list, &counts[..], &runs, &case.spokes, &case.degrees].map(|words| gpu.buffer(words));
        Self { mesh, buffers, held, ends: gpu.buffer(&case.ends) }
    }

    fn walkers(&self) -> Walkers<'_> {
        let [list, listed, runs, spokes, degrees] = self.held.each_ref().map(Buffer::view);
        Walkers { ends: self.ends.view(), list, listed, runs, spokes, degrees, known: None }
    }

    /// Runs all; gives the seeds, where pieces of walkers stand, and the pieces.
    fn run(&self, gpu: &mut Gpu, stage: &Stage, grid: Grid) -> (Vec<[u32; 2]>, Vec<u32>, Vec<[u32; 4]>) {
        let mut recording = gpu.recording();
        let walkers = self.walkers();
        stage.record_seeds(&mut recording, &self.mesh, walkers.spokes, grid, &self.buffers).unwrap();
        stage.record(&mut recording, &self.mesh, &walkers, grid, &self.buffers);
        gpu.run(&recording);
        let count = gpu.fetch(self.buffers.count())[0] as usize;
        let mut pieces = gpu.fetch(self.buffers.pieces());
        pieces.truncate(count);
        (gpu.fetch(self.buffers.seeds()), gpu.fetch(walkers.runs), pieces)
    }
}

#[test]
fn sow_seeds() {
    let mut gpu = Gpu::open();
    let stage = Stage::new(&gpu.device, Arithmetic::Integers).unwrap();
    for (name, case) in cases() {
        let (seeds, _, _) = On::new(&mut gpu, &case, 4096).run(&mut gpu, &stage, case.grid);
        let wanted = expected::sow_seeds(&case.start.positions, &case.spokes, &case.grid);
        assert!(wanted.len() <= (case.start.positions.len() / 2).max(1), "{name}: {} cells", wanted.len());
        for (place, (&seed, &one)) in seeds.iter().flatten().zip(wanted.iter().flatten()).enumerate() {
            assert_eq!(seed == NONE, one == NONE, "{name}: place {place}");
            let belongs = |v: u32| case.grid.cell(case.at(v)) == place / 2 && priority(v) as usize & 1 == place & 1;
            assert!(seed == NONE || belongs(seed) && case.spokes[seed as usize] != NONE, "{name}: place {place}");
        }
    }
}

/// The number that all should have; and each has its share of the room.
#[test]
fn count_pieces() {
    let mut gpu = Gpu::open();
    let stage = Stage::new(&gpu.device, Arithmetic::Integers).unwrap();
    for (name, case) in cases() {
        let on = On::new(&mut gpu, &case, 4);
        on.run(&mut gpu, &stage, case.grid);
        let [_, _, low, high] = gpu.fetch(on.buffers.count())[..] else { panic!() };
        let wanted = expected::count_pieces(&case.start.positions, &case.ends, &case.list, &case.grid);
        assert_eq!(u64::from(low) | u64::from(high) << 32, wanted, "{name}");
    }
}

#[test]
fn plan_pieces() {
    let mut gpu = Gpu::open();
    let stage = Stage::new(&gpu.device, Arithmetic::Integers).unwrap();
    let [mut all, mut fewer] = [0, 0];
    for (name, case) in cases() {
        let plan = |room| expected::plan_pieces(&case.start.positions, &case.ends, &case.list, &case.grid, room);
        let count: u32 = plan(usize::MAX).iter().map(|n| n - 1).sum();
        for room in [count + 1, count, count / 2, count / 9, 1].map(|room| room.max(1) as usize) {
            let wanted = plan(room);
            let later = wanted.iter().map(|n| n - 1).sum::<u32>() as usize;
            assert!(later <= room, "{name}");
            let (_, runs, pieces) = On::new(&mut gpu, &case, room).run(&mut gpu, &stage, case.grid);
            assert_eq!(pieces.len(), later, "{name}");
            for (&walker, &pieces_of) in case.list.iter().zip(&wanted) {
                let run = runs[walker as usize];
                assert_eq!(run == NONE, pieces_of == 1, "{name}: walker {walker}");
                for number in 1..pieces_of {
                    let [of, which, _, last] = pieces[(run + number - 1) as usize];
                    assert_eq!([of, which, last], [walker, number << 16 | pieces_of, NONE], "{name}");
                }
            }
            if room > count as usize { all += later } else { fewer += later }
        }
    }
    assert!(all > 10_000 && fewer > 1000, "{all} and {fewer} pieces");
}

#[test]
fn find_beginnings() {
    let mut gpu = Gpu::open();
    let stages = [Arithmetic::Filtered, Arithmetic::Integers].map(|a| Stage::new(&gpu.device, a).unwrap());
    let [mut found, mut all] = [0, 0];
    for (turn, (name, case)) in cases().enumerate() {
        let room = expected::count_pieces(&case.start.positions, &case.ends, &case.list, &case.grid) as usize + 1;
        let (seeds, _, pieces) = On::new(&mut gpu, &case, room).run(&mut gpu, &stages[turn % 2], case.grid);
        let of_these = [pieces.iter().filter(|piece| piece[2] != NONE).count(), pieces.len()];
        // Where points lie everywhere, nearly every piece has a beginning.
        let uniform = name == "uniform";
        assert!(!uniform || 20 * of_these[0] >= 19 * of_these[1], "{name}: {of_these:?}");
        for [walker, which, beginning, _] in pieces {
            let [a, b] = case.ends[walker as usize];
            let reversed = case.degrees[b as usize] < case.degrees[a as usize];
            let line = if reversed { [b, a] } else { [a, b] };
            let (points, number, count) = (line.map(|v| case.at(v)), which >> 16, which & 0xffff);
            let candidates = case.grid.seeds_near(points, number, count, &seeds);
            let near = |between| case.grid.is_near(points, number, count, between);
            let (mesh, positions) = (&case.start.mesh, &case.start.positions);
            let wanted = expected::find_beginnings(mesh, positions, &case.spokes, line, &candidates, near);
            all += 1;
            if beginning != NONE || wanted.is_none() {
                found += u32::from(beginning != NONE);
                assert_eq!(
                    beginning,
                    wanted.map_or(NONE, Beginning::word),
                    "{name}: piece {} of {walker}",
                    which >> 16
                );
            }
        }
    }
    assert!(found > all / 3, "{found} of {all}");
}
