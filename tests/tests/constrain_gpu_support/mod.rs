//! Meshes some rounds into an insertion, for the tests of its kernels.
#![allow(dead_code, unreachable_pub, clippy::unwrap_used, reason = "tests; each file uses a part")]

use crate::constrain_support::Start;
use crate::vulkan_support::Gpu;
use glam::DVec2;
use polder_constrain::reference;
use polder_constrain::reference::kernels::{self, Begun, Departed, Marked, Scratch};
use polder_flip::gpu::Mesh;
use polder_mesh::{GhostMesh, Pslg};
use polder_tests::families;
use polder_vulkan::{Buffer, Kernel, Shader};

pub const NONE: u32 = u32::MAX;
/// Integers behind the f64 filter.
pub const EXACT: &[(&str, u32)] = &[("ARITHMETIC", 1)];
/// Places of words, as in `insert.glsl`.
pub const INSERTED: usize = 1;
pub const REBUILT: usize = 39;
pub const LONGEST: usize = 40;
pub const GOES_ON: usize = 3;
pub const INNER_LIMIT: usize = 4;
pub const OUTER: usize = 2;
pub const WALKERS: usize = 7;
pub const MARKED: usize = 6;
pub const LOSERS: usize = 9;
pub const WAITED: usize = 10;
pub const CANDIDATES: usize = 12;
pub const TAKEN: usize = 14;
pub const ROUND: usize = 15;
pub const ROUND_NOW: usize = 16;
pub const INNER: usize = 17;
pub const EDGES_ALREADY: usize = 20;
pub const WALKED: usize = 24;
pub const INNER_ROUNDS: usize = 27;
pub const ADMITTED: usize = 8;
pub const HUBS: usize = 21;
pub const STOLEN: usize = 11;
pub const HELD: usize = 19;
pub const HELD_ROUND: usize = 38;
/// What stands in `lost`, and in `firsts`.
pub const LOSES: u32 = 1;
pub const AT_HUB: u32 = 2;
pub const BARRED: u32 = 4;
pub const LONG: u32 = 8;
pub const PARTIAL_WALKS: usize = 41;
pub const DONE: u32 = NONE - 15;
pub const REVERSED: u32 = 1 << 31;
pub const FLIPS: usize = 28;
pub const DEPART_FAULT: usize = 36;

/// A mesh some rounds into an insertion, and all that is kept.
#[derive(Clone)]
pub struct Case {
    pub name: &'static str,
    pub start: Start,
    pub subs: Vec<[u32; 2]>,
    pub spokes: Vec<u32>,
    pub degrees: Vec<u32>,
    pub scratch: Scratch,
    pub begun: Vec<Begun>,
    /// The triangles of the longest chain that is rebuilt.
    pub longest: u32,
    /// Those that are to depart.
    pub takes: Vec<u32>,
    /// Pairs left from the rounds before.
    pub pairs: Vec<[u32; 2]>,
}

impl Case {
    /// All of those that are to walk, with what is counted at vertices in the first round.
    pub fn list(&mut self) -> (Vec<u32>, Option<Vec<u32>>, u32) {
        let takes = std::mem::take(&mut self.takes);
        if !self.is_first() {
            for (s, begun) in (0..).zip(&mut self.begun) {
                begun.low = if takes.contains(&s) { 0 } else { begun.low };
                begun.done |= !takes.contains(&s) && !begun.by_flips();
            }
            return (takes, None, 0);
        }
        let Start { mesh, positions, .. } = &mut self.start;
        let (walkers, inserted, counts) = kernels::list_walkers(mesh, positions, &self.subs, &takes, &self.spokes);
        for (s, begun) in (0..).zip(&mut self.begun) {
            begun.done = !walkers.contains(&s);
        }
        (walkers, Some(counts), inserted)
    }

    pub fn is_first(&self) -> bool {
        self.scratch.round == 0
    }

    pub fn depart(&mut self, walkers: &[u32], counts: Option<&[u32]>) -> Departed {
        let Self { start, subs, scratch, begun, spokes, degrees, .. } = self;
        let Start { mesh, positions, .. } = start;
        kernels::depart_walks(mesh, positions, subs, (walkers, counts), begun, [spokes, degrees], scratch)
    }

    /// Those that walk, and all that departures and walks led to.
    pub fn walk(&mut self) -> (Vec<u32>, Marked) {
        let (walkers, counts, _) = self.list();
        let Departed { walkers, marked: mut all, .. } = self.depart(&walkers, counts.as_deref());
        let [admitted, barred] = kernels::admit_walks(&walkers, &self.begun, &self.scratch);
        let marked = self.mark(&admitted);
        all.triangles.extend(marked.triangles);
        all.losers.extend(marked.losers.into_iter().chain(barred));
        all.losers.sort_unstable();
        all.losers.dedup();
        all.stolen |= marked.stolen;
        all.fault = marked.fault;
        self.scratch.held = if all.stolen { self.pairs.len() } else { 0 };
        (admitted, all)
    }

    /// What stands in `firsts`.
    pub fn firsts(&self) -> Vec<u32> {
        let word = |b: &Begun| b.first | if b.reversed { REVERSED } else { 0 };
        let none = self.begun.is_empty().then_some(7);
        self.begun.iter().map(word).chain(none).collect()
    }

    /// What stands in `lost`, with these losers and those that do not walk.
    pub fn known(&self, losers: &[u32], barred: &[u32]) -> Vec<u32> {
        let flag = |yes: bool, flag: u32| if yes { flag } else { 0 };
        let word =
            |b: &Begun| flag(b.at_hub, AT_HUB) | flag(b.long, LONG) | if b.at_hub { b.walks << 4 } else { b.low << 4 };
        let mut known: Vec<u32> = self.begun.iter().map(|b| if b.done { DONE } else { word(b) }).collect();
        known.resize(known.len().max(1), 0);
        losers.iter().for_each(|&s| known[s as usize] |= LOSES);
        barred.iter().for_each(|&s| known[s as usize] |= BARRED);
        known
    }

    /// The pairs held during walks in which triangles get other owners.
    fn walk_on(&mut self) -> usize {
        self.walk();
        self.scratch.held
    }

    pub fn mark(&mut self, walkers: &[u32]) -> Marked {
        let Self { start, subs, scratch, begun, .. } = self;
        kernels::mark_chains(&start.mesh, &start.positions, subs, walkers, (begun, self.longest), scratch)
    }

    /// How many chains were rebuilt.
    pub fn rebuild(&mut self, walkers: &[u32], losers: &[u32]) -> u32 {
        let Self { start, begun, scratch, spokes, degrees, .. } = self;
        let Start { mesh, positions, .. } = start;
        kernels::rebuild_chains(mesh, positions, [walkers, losers], begun, scratch, [spokes, degrees]).unwrap()
    }

    pub fn configure(&mut self, marked: &[u32]) {
        let Self { start, begun, scratch, .. } = self;
        let found = kernels::configure_pairs(&start.mesh, &start.positions, marked, begun, scratch);
        self.pairs.extend(found);
    }

    pub fn flip(&mut self) -> [u64; 4] {
        let spokes = [&mut self.spokes[..], &mut self.degrees];
        kernels::flip_pairs(&mut self.start.mesh, &mut self.scratch, &mut self.pairs, spokes)
    }

    pub fn advance(&mut self) {
        let Self { start, scratch, pairs, .. } = self;
        self.pairs = kernels::advance_pairs(&mut start.mesh, &start.positions, pairs, scratch);
    }

    /// An outer round with two inner ones.
    pub fn round(&mut self) {
        let (walkers, marked) = self.walk();
        assert_eq!(marked.fault, None);
        self.rebuild(&walkers, &marked.losers);
        self.takes = marked.losers;
        self.configure(&marked.triangles);
        for _ in 0..2 {
            self.flip();
            self.advance();
        }
        self.scratch.round += 2;
    }
}

/// One point at the end of a corridor and constraints from there to its other end, far longer than walks from hubs at first;
/// and one along a wall.
fn corridor() -> Pslg {
    let walls = (1..200).flat_map(|i| [-1.0, 1.0].map(|y| DVec2::new(f64::from(i), y)));
    let ends = (0..24).map(|i| DVec2::new(212.0, f64::from(2 * i - 23) / 32.0));
    let points: Vec<_> = ends.chain([DVec2::ZERO]).chain(walls).collect();
    let constraints = [[25, 27]].into_iter().chain((0..24).map(|i| [24, i]));
    Pslg::new(points, constraints.collect()).unwrap()
}

/// The families before the first outer round, and after one and two; and fans after more of them.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let starts = families(400, 9).into_iter().enumerate().map(|(turn, (name, pslg))| (turn % 3, name, pslg));
    let fans = [(3, 220), (4, 260), (6, 340), (9, 460)];
    let fans = fans.map(|(rounds, k)| (rounds, "fan", polder_io::generate::fan(k, 3)));
    for (rounds, name, pslg) in starts.chain(fans).chain([0, 1].map(|rounds| (rounds, "corridor", corridor()))) {
        let start = Start::stage_4(&pslg);
        let walk = reference::walk(&start.mesh, &start.positions, &start.constraints).unwrap();
        if !reference::crossings(&start.mesh, &start.positions, &walk, 1).unwrap().pairs.is_empty() {
            continue;
        }
        let subs = walk.sub_constraints;
        let (spokes, degrees) = kernels::find_spokes(&start.mesh, start.positions.len());
        let scratch = Scratch::new(start.mesh.slots());
        let takes = (0..subs.len() as u32).collect();
        let begun = vec![Begun::default(); subs.len()];
        let case = Case { name, start, subs, spokes, degrees, scratch, begun, longest: 0, takes, pairs: Vec::new() };
        for longest in [0, 4] {
            let mut case = Case { longest, ..case.clone() };
            for _ in 0..rounds {
                case.round();
            }
            cases.push(case);
        }
    }
    assert!(cases.len() > 5 && cases.iter().any(|case| !case.pairs.is_empty()));
    assert!(
        cases.iter().filter(|case| Case::clone(case).walk_on() > 0).count() > 2,
        "none in which triangles change owners"
    );
    cases
}

/// A case on the device.
pub struct On {
    pub mesh: Mesh,
    pub stride: usize,
    pub subs: Buffer<[u32; 2]>,
    pub spokes: Buffer<u32>,
    pub degrees: Buffer<u32>,
    pub walkers: Buffer<u32>,
    pub admitted: Buffer<u32>,
    pub firsts: Buffer<u32>,
    pub runs: Buffer<u32>,
    pub pieces: Buffer<[u32; 4]>,
    pub piece_count: Buffer<u32>,
    pub piece_walked: Buffer<u32>,
    pub lost: Buffer<u32>,
    pub counts: Buffer<u32>,
    pub state: Buffer<[u32; 4]>,
    pub pairs: [Buffer<[u32; 2]>; 2],
    pub words: Buffer<u32>,
}

impl On {
    /// With its claims and pairs as those of rounds of this parity.
    pub fn new(gpu: &mut Gpu, case: &Case, words: &[(usize, u32)]) -> Self {
        let parity = case.scratch.round as usize & 1;
        let slots = case.start.mesh.slots();
        let stride = slots;
        let mesh = Mesh::with_slots(&gpu.device, case.start.positions.len(), slots).unwrap();
        mesh.upload(&mut gpu.engine, &case.start.mesh, &case.start.positions).unwrap();
        let mut all = [0; 44];
        all[LONGEST] = case.longest;
        all[ROUND] = case.scratch.round;
        all[CANDIDATES + parity] = case.pairs.len() as u32;
        all[DEPART_FAULT] = NONE;
        all[DEPART_FAULT + 1] = NONE;
        if case.scratch.held > 0 {
            (all[STOLEN], all[HELD], all[HELD_ROUND]) = (1, case.scratch.held as u32, case.scratch.round);
        }
        words.iter().for_each(|&(place, word)| all[place] = word);
        let mut pairs = [vec![[7; 2]; stride], vec![[7; 2]; stride]];
        pairs[parity][..case.pairs.len()].copy_from_slice(&case.pairs);
        let Scratch { owner, claims, stamps, .. } = &case.scratch;
        let one = |t: usize| {
            let claims = if parity == 0 { [claims[t], NONE] } else { [NONE, claims[t]] };
            [claims[0], claims[1], !stamps[t], owner[t]]
        };
        let state: Vec<[u32; 4]> = (0..slots).map(one).collect();
        let room = case.subs.len().max(1);
        Self {
            mesh,
            stride,
            subs: gpu.buffer(&[case.subs.clone(), vec![[0; 2]]].concat()[..room]),
            spokes: gpu.buffer(&case.spokes),
            degrees: gpu.buffer(&case.degrees),
            walkers: gpu.buffer(&vec![7; room]),
            admitted: gpu.buffer(&vec![7; room]),
            firsts: gpu.buffer(&case.firsts()),
            runs: gpu.buffer(&vec![NONE; room]),
            pieces: gpu.buffer(&[[7; 4]]),
            piece_count: gpu.buffer(&[0]),
            piece_walked: gpu.buffer(&[7]),
            lost: gpu.buffer(&case.known(&[], &[])),
            counts: gpu.buffer(&vec![0; case.start.positions.len().max(1)]),
            state: gpu.buffer(&state),
            pairs: pairs.map(|pairs| gpu.buffer(&pairs)),
            words: gpu.buffer(&all),
        }
    }

    pub fn word(&self, gpu: &mut Gpu, word: usize) -> u32 {
        gpu.fetch(self.words.view())[word]
    }

    pub fn flips(&self, gpu: &mut Gpu) -> [u64; 4] {
        let words = gpu.fetch(self.words.view());
        [words[FLIPS], words[FLIPS + 2], words[FLIPS + 4], words[INSERTED]].map(u64::from)
    }

    /// The pairs of rounds of a parity, in order.
    pub fn pairs(&self, gpu: &mut Gpu, parity: usize) -> Vec<[u32; 2]> {
        let count = self.word(gpu, CANDIDATES + parity) as usize;
        sorted(&gpu.fetch(self.pairs[parity].view())[..count])
    }

    pub fn mesh(&self, gpu: &mut Gpu) -> GhostMesh {
        self.mesh.download(&mut gpu.engine).unwrap()
    }

    /// Whether all is as expected after rounds that left claims of this parity; the other claims are given back.
    pub fn assert_state(&self, gpu: &mut Gpu, case: &Case, parity: usize) {
        let (state, name) = (gpu.fetch(self.state.view()), case.name);
        let is = |k: usize, expected: &dyn Fn(usize) -> u32| (0..state.len()).all(|t| state[t][k] == expected(t));
        let Scratch { owner, claims, stamps, .. } = &case.scratch;
        assert!(is(3, &|t| owner[t]), "{name}: owners");
        assert!(is(parity, &|t| claims[t]), "{name}: claims");
        assert!(is(1 - parity, &|_| NONE), "{name}: other claims");
        assert!(is(2, &|t| !stamps[t]), "{name}: stamps");
        assert!(self.mesh(gpu) == case.start.mesh, "{name}: mesh");
    }

    pub fn assert_spokes(&self, gpu: &mut Gpu, case: &Case) {
        assert!(gpu.fetch(self.degrees.view()) == case.degrees, "{}", case.name);
        for (v, &h) in gpu.fetch(self.spokes.view()).iter().enumerate() {
            assert_eq!(h == NONE, case.spokes[v] == NONE, "{}: {v}", case.name);
            assert!(h == NONE || case.start.mesh.origin(h) == v as u32, "{}: {v}", case.name);
        }
    }
}

pub fn run<S: Shader>(gpu: &mut Gpu, constants: &[(&'static str, u32)], groups: u32, arguments: &S::Args<'_>) {
    let kernel = Kernel::<S>::new(&gpu.device, constants).unwrap();
    let mut recording = gpu.recording();
    recording.dispatch(&kernel, [groups, 1, 1], arguments);
    gpu.run(&recording);
}

pub fn sorted<T: Ord + Clone>(list: &[T]) -> Vec<T> {
    let mut list = list.to_vec();
    list.sort_unstable();
    list
}
