//! Each kernel of stage 6 that inserts sub-constraints against the reference of its name.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod constrain_support;
mod vulkan_support;

use constrain_support::Start;
use polder_constrain::kernels::*;
use polder_constrain::reference::kernels::{self, Departed, Scratch};
use polder_constrain::{Fault, reference};
use polder_flip::gpu::Mesh;
use polder_mesh::GhostMesh;
use polder_tests::families;
use polder_vulkan::{Buffer, Kernel, Shader};
use vulkan_support::Gpu;

const NONE: u32 = u32::MAX;
/// Integers behind the f64 filter.
const EXACT: &[(&str, u32)] = &[("ARITHMETIC", 1)];
/// Places of words, as in `insert.glsl`.
const INSERTED: usize = 1;
const GOES_ON: usize = 3;
const INNER_LIMIT: usize = 4;
const OUTER: usize = 2;
const WALKERS: usize = 8;
const MARKED: usize = 6;
const LOSERS: usize = 9;
const WAITED: usize = 10;
const CANDIDATES: usize = 12;
const TAKEN: usize = 14;
const ROUND: usize = 15;
const ROUND_NOW: usize = 16;
const INNER: usize = 17;
const EDGES_ALREADY: usize = 20;
const WALKED: usize = 24;
const INNER_ROUNDS: usize = 27;
const FLIPS: usize = 28;
const DEPART_FAULT: usize = 36;

/// A mesh some rounds into an insertion, and all that is kept.
#[derive(Clone)]
struct Case {
    name: &'static str,
    start: Start,
    subs: Vec<[u32; 2]>,
    spokes: Vec<u32>,
    degrees: Vec<u32>,
    scratch: Scratch,
    /// Those that are to depart.
    takes: Vec<u32>,
    /// Pairs left from the rounds before.
    pairs: Vec<[u32; 2]>,
}

impl Case {
    fn depart(&mut self) -> Departed {
        let spokes = [&self.spokes[..], &self.degrees];
        kernels::depart_walks(&mut self.start.mesh, &self.start.positions, &self.subs, self.takes.drain(..), spokes)
    }

    fn mark(&mut self, walkers: &[[u32; 2]]) -> kernels::Marked {
        let Self { start, subs, scratch, .. } = self;
        kernels::mark_chains(&start.mesh, &start.positions, subs, walkers, scratch)
    }

    fn configure(&mut self, marked: &[u32]) {
        let found = kernels::configure_pairs(&self.start.mesh, &self.start.positions, marked, &mut self.scratch);
        self.pairs.extend(found);
    }

    fn flip(&mut self) -> [u64; 4] {
        let spokes = [&mut self.spokes[..], &mut self.degrees];
        kernels::flip_pairs(&mut self.start.mesh, &mut self.scratch, &mut self.pairs, spokes)
    }

    fn advance(&mut self) {
        let Self { start, scratch, pairs, .. } = self;
        self.pairs = kernels::advance_pairs(&mut start.mesh, &start.positions, pairs, scratch);
    }

    /// An outer round with two inner ones.
    fn round(&mut self) {
        let walkers = self.depart().walkers;
        let marked = self.mark(&walkers);
        assert_eq!(marked.fault, None);
        self.takes = marked.losers;
        self.configure(&marked.triangles);
        for _ in 0..2 {
            self.flip();
            self.advance();
        }
        self.scratch.round += 2;
    }
}

/// The families before the first outer round, and after one and two.
fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (turn, (name, pslg)) in families(400, 9).into_iter().enumerate() {
        let start = Start::stage_4(&pslg);
        let walk = reference::walk(&start.mesh, &start.positions, &start.constraints).unwrap();
        if !reference::crossings(&start.mesh, &start.positions, &walk, 1).unwrap().pairs.is_empty() {
            continue;
        }
        let subs = walk.sub_constraints;
        let (spokes, degrees) = kernels::find_spokes(&start.mesh, start.positions.len());
        let scratch = Scratch::new(start.mesh.slots());
        let takes = (0..subs.len() as u32).collect();
        let mut case = Case { name, start, subs, spokes, degrees, scratch, takes, pairs: Vec::new() };
        for _ in 0..turn % 3 {
            case.round();
        }
        cases.push(case);
    }
    assert!(cases.len() > 5 && cases.iter().any(|case| !case.pairs.is_empty()));
    cases
}

/// A case on the device.
struct On {
    mesh: Mesh,
    stride: usize,
    subs: Buffer<[u32; 2]>,
    spokes: Buffer<u32>,
    degrees: Buffer<u32>,
    walkers: Buffer<u32>,
    firsts: Buffer<u32>,
    runs: Buffer<u32>,
    pieces: Buffer<[u32; 4]>,
    piece_count: Buffer<u32>,
    piece_walked: Buffer<u32>,
    lost: Buffer<u32>,
    state: Buffer<[u32; 4]>,
    pairs: Buffer<[u32; 2]>,
    words: Buffer<u32>,
}

impl On {
    /// With its claims and pairs as those of rounds of this parity.
    fn new(gpu: &mut Gpu, case: &Case, words: &[(usize, u32)]) -> Self {
        let parity = case.scratch.round as usize & 1;
        let slots = case.start.mesh.slots();
        let stride = slots;
        let mesh = Mesh::with_slots(&gpu.device, case.start.positions.len(), slots).unwrap();
        mesh.upload(&mut gpu.engine, &case.start.mesh, &case.start.positions).unwrap();
        let mut all = [0; 40];
        all[ROUND] = case.scratch.round;
        all[CANDIDATES + parity] = case.pairs.len() as u32;
        all[DEPART_FAULT] = NONE;
        all[DEPART_FAULT + 1] = NONE;
        words.iter().for_each(|&(place, word)| all[place] = word);
        let mut pairs = vec![[7; 2]; 2 * stride];
        pairs[parity * stride..][..case.pairs.len()].copy_from_slice(&case.pairs);
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
            firsts: gpu.buffer(&vec![7; room]),
            runs: gpu.buffer(&vec![NONE; room]),
            pieces: gpu.buffer(&[[7; 4]]),
            piece_count: gpu.buffer(&[0]),
            piece_walked: gpu.buffer(&[7]),
            lost: gpu.buffer(&vec![0; room]),
            state: gpu.buffer(&state),
            pairs: gpu.buffer(&pairs),
            words: gpu.buffer(&all),
        }
    }

    fn word(&self, gpu: &mut Gpu, word: usize) -> u32 {
        gpu.fetch(self.words.view())[word]
    }

    fn flips(&self, gpu: &mut Gpu) -> [u64; 4] {
        let words = gpu.fetch(self.words.view());
        [words[FLIPS], words[FLIPS + 2], words[FLIPS + 4], words[INSERTED]].map(u64::from)
    }

    /// The pairs of rounds of a parity, in order.
    fn pairs(&self, gpu: &mut Gpu, parity: usize) -> Vec<[u32; 2]> {
        let count = self.word(gpu, CANDIDATES + parity) as usize;
        sorted(&gpu.fetch(self.pairs.view())[parity * self.stride..][..count])
    }

    fn mesh(&self, gpu: &mut Gpu) -> GhostMesh {
        self.mesh.download(&mut gpu.engine).unwrap()
    }

    /// Whether all is as expected after rounds that left claims of this parity; the other claims are given back.
    fn assert_state(&self, gpu: &mut Gpu, case: &Case, parity: usize) {
        let (state, name) = (gpu.fetch(self.state.view()), case.name);
        let is = |k: usize, expected: &dyn Fn(usize) -> u32| (0..state.len()).all(|t| state[t][k] == expected(t));
        let Scratch { owner, claims, stamps, .. } = &case.scratch;
        assert!(is(3, &|t| owner[t]), "{name}: owners");
        assert!(is(parity, &|t| claims[t]), "{name}: claims");
        assert!(is(1 - parity, &|_| NONE), "{name}: other claims");
        assert!(is(2, &|t| !stamps[t]), "{name}: stamps");
        assert!(self.mesh(gpu) == case.start.mesh, "{name}: mesh");
    }

    fn assert_spokes(&self, gpu: &mut Gpu, case: &Case) {
        assert!(gpu.fetch(self.degrees.view()) == case.degrees, "{}", case.name);
        for (v, &h) in gpu.fetch(self.spokes.view()).iter().enumerate() {
            assert_eq!(h == NONE, case.spokes[v] == NONE, "{}: {v}", case.name);
            assert!(h == NONE || case.start.mesh.origin(h) == v as u32, "{}: {v}", case.name);
        }
    }
}

fn run<S: Shader>(gpu: &mut Gpu, constants: &[(&'static str, u32)], groups: u32, arguments: &S::Args<'_>) {
    let kernel = Kernel::<S>::new(&gpu.device, constants).unwrap();
    let mut recording = gpu.recording();
    recording.dispatch(&kernel, [groups, 1, 1], arguments);
    gpu.run(&recording);
}

fn sorted<T: Ord + Clone>(list: &[T]) -> Vec<T> {
    let mut list = list.to_vec();
    list.sort_unstable();
    list
}

#[test]
fn depart_walks() {
    let mut gpu = Gpu::open();
    let mut edges = 0;
    for mut case in cases() {
        let (takes, first) = (case.takes.clone(), case.takes.len() == case.subs.len());
        let words = if first { [(OUTER, 0), (WAITED, 0)] } else { [(OUTER, 2), (WAITED, takes.len() as u32)] };
        let on = On::new(&mut gpu, &case, &words);
        if !first {
            let lost: Vec<u32> = (0..case.subs.len() as u32).map(|s| u32::from(takes.contains(&s))).collect();
            gpu.engine.upload(on.lost.slice(0..lost.len()).unwrap(), &lost).unwrap();
        }
        let room = case.subs.len();
        let arguments = DepartWalksArgs {
            triangles: on.mesh.corners(),
            links: on.mesh.twins(),
            positions: on.mesh.positions().cast(),
            sub_constraints: on.subs.view().cast(),
            counter: None,
            spokes: on.spokes.view(),
            degrees: on.degrees.view(),
            walkers: on.walkers.view(),
            firsts: on.firsts.view(),
            lost: on.lost.view(),
            words: on.words.view(),
            limit: room as u32,
            most: 3 * case.start.mesh.slots() as u32,
        };
        run::<DepartWalks>(&mut gpu, EXACT, 2, &arguments);
        let expected = case.depart();
        assert_eq!(expected.fault, None);
        let count = on.word(&mut gpu, WALKERS) as usize;
        let walkers = sorted(&gpu.fetch(on.walkers.view())[..count]);
        let firsts = gpu.fetch(on.firsts.view());
        let walkers: Vec<[u32; 2]> = walkers.into_iter().map(|s| [s, firsts[s as usize]]).collect();
        assert!(walkers == sorted(&expected.walkers), "{}", case.name);
        assert_eq!(on.word(&mut gpu, INSERTED), expected.inserted);
        assert_eq!(on.word(&mut gpu, EDGES_ALREADY), if first { expected.inserted } else { 0 });
        assert_eq!(on.word(&mut gpu, DEPART_FAULT), NONE);
        assert!(gpu.fetch(on.lost.view()).iter().all(|&lost| lost == 0));
        assert!(on.mesh(&mut gpu) == case.start.mesh, "{}", case.name);
        edges += expected.inserted;
    }
    assert!(edges > 100);
}

#[test]
fn mark_chains() {
    let mut gpu = Gpu::open();
    let (mut lost, mut met) = (0, [0; 2]);
    for mut case in cases() {
        let mut walkers = case.depart().walkers;
        // Half of them, first as they are, then with an edge on their way constrained.
        for blocked in [false, true] {
            let mut case = case.clone();
            if let (true, Some(&[_, h])) = (blocked, walkers.iter().max()) {
                case.start.mesh.set_constrained(h, true);
            }
            walkers.retain(|&[s, _]| !polder_flip::priority(s).is_multiple_of(4) || blocked);
            let on = On::new(&mut gpu, &case, &[(OUTER, 3), (WALKERS, walkers.len() as u32)]);
            let list: Vec<u32> = walkers.iter().map(|w| w[0]).collect();
            gpu.engine.upload(on.walkers.slice(0..list.len()).unwrap(), &list).unwrap();
            let mut firsts = vec![7; case.subs.len()];
            walkers.iter().for_each(|&[s, h]| firsts[s as usize] = h);
            gpu.engine.upload(on.firsts.slice(0..firsts.len()).unwrap(), &firsts).unwrap();
            let arguments = MarkChainsArgs {
                triangles: on.mesh.corners(),
                links: on.mesh.twins(),
                positions: on.mesh.positions().cast(),
                sub_constraints: on.subs.view().cast(),
                degrees: on.degrees.view(),
                walkers: on.walkers.view(),
                firsts: on.firsts.view(),
                runs: on.runs.view(),
                pieces: on.pieces.view(),
                piece_count: on.piece_count.view(),
                piece_walked: on.piece_walked.view(),
                lost: on.lost.view(),
                state: on.state.view().cast(),
                words: on.words.view(),
                stride: on.stride as u32,
                piece_limit: 1,
            };
            run::<MarkChains>(&mut gpu, EXACT, 2, &arguments);
            let expected = case.mark(&walkers);
            let parity = case.scratch.round as usize & 1;
            on.assert_state(&mut gpu, &case, parity);
            assert_eq!(on.word(&mut gpu, MARKED), u32::from(!walkers.is_empty()));
            assert_eq!(u64::from(on.word(&mut gpu, WALKED)), expected.walked);
            assert_eq!(on.word(&mut gpu, LOSERS) as usize, expected.losers.len());
            for (s, &word) in gpu.fetch(on.lost.view()).iter().enumerate() {
                assert_eq!(word != 0, expected.losers.contains(&(s as u32)), "{}: {s}", case.name);
            }
            let fault = match expected.fault {
                None => NONE,
                Some(Fault::Blocked(s)) => s << 2,
                other => panic!("{other:?}"),
            };
            assert_eq!(on.word(&mut gpu, DEPART_FAULT + 1), fault, "{}", case.name);
            met[usize::from(fault == NONE)] += 1;
            lost += expected.losers.len();
        }
    }
    assert!(lost > 50 && met.iter().all(|&n| n > 3), "{lost} {met:?}");
}

#[test]
fn configure_pairs() {
    let mut gpu = Gpu::open();
    let mut pairs = 0;
    for mut case in cases() {
        let walkers = case.depart().walkers;
        let marked = case.mark(&walkers).triangles;
        let on = On::new(&mut gpu, &case, &[(MARKED, 1), (OUTER, case.scratch.round)]);
        let arguments = ConfigurePairsArgs {
            triangles: on.mesh.corners(),
            links: on.mesh.twins(),
            positions: on.mesh.positions().cast(),
            state: on.state.view().cast(),
            pieces: on.pieces.view(),
            piece_count: on.piece_count.view(),
            piece_walked: on.piece_walked.view(),
            pairs: on.pairs.view().cast(),
            words: on.words.view(),
            stride: on.stride as u32,
            slots: case.start.mesh.slots() as u32,
            piece_limit: 1,
        };
        run::<ConfigurePairs>(&mut gpu, EXACT, 2, &arguments);
        case.configure(&marked);
        let parity = case.scratch.round as usize & 1;
        assert!(on.pairs(&mut gpu, parity) == sorted(&case.pairs), "{}", case.name);
        on.assert_state(&mut gpu, &case, parity);
        pairs += case.pairs.len();
        let mut distinct = sorted(&case.pairs);
        distinct.dedup_by_key(|pair| pair[0]);
        assert_eq!(distinct.len(), case.pairs.len(), "{}: a pair twice", case.name);
    }
    assert!(pairs > 200, "{pairs}");
}

/// The cases with pairs to be flipped.
fn with_pairs() -> impl Iterator<Item = Case> {
    cases().into_iter().map(|mut case| {
        let walkers = case.depart().walkers;
        let marked = case.mark(&walkers).triangles;
        case.configure(&marked);
        case
    })
}

#[test]
fn flip_pairs() {
    let mut gpu = Gpu::open();
    let mut flips = [0; 4];
    for mut case in with_pairs() {
        let parity = case.scratch.round as usize & 1;
        let taken = case.pairs.len() as u32;
        for least in [taken + 1, taken] {
            let on = On::new(&mut gpu, &case, &[(INNER_LIMIT, 8)]);
            let arguments = FlipPairsArgs {
                triangles: on.mesh.corners(),
                links: on.mesh.twins(),
                state: on.state.view().cast(),
                pairs: on.pairs.view().cast(),
                spokes: on.spokes.view(),
                degrees: on.degrees.view(),
                words: on.words.view(),
                stride: on.stride as u32,
                least,
            };
            run::<FlipPairs>(&mut gpu, &[], 2, &arguments);
            let mut expected = [0; 4];
            if least == taken {
                expected = case.flip();
                assert_eq!(on.word(&mut gpu, ROUND_NOW), case.scratch.round);
            }
            assert_eq!(on.word(&mut gpu, TAKEN), if least == taken { taken } else { 0 });
            assert_eq!(on.flips(&mut gpu), expected, "{}", case.name);
            assert!(on.pairs(&mut gpu, parity) == sorted(&case.pairs), "{}", case.name);
            on.assert_state(&mut gpu, &case, parity);
            if least == taken {
                on.assert_spokes(&mut gpu, &case);
            }
            flips.iter_mut().zip(expected).for_each(|(sum, n)| *sum += n);
        }
    }
    assert!(flips.iter().all(|&n| n > 0), "{flips:?}");
}

#[test]
fn advance_pairs() {
    let mut gpu = Gpu::open();
    let mut pairs = 0;
    for mut case in with_pairs() {
        let parity = case.scratch.round as usize & 1;
        case.flip();
        let round = case.scratch.round;
        case.scratch.round -= 1;
        let taken = case.pairs.len() as u32;
        let on = On::new(&mut gpu, &case, &[(TAKEN, taken), (ROUND_NOW, round), (INNER, 3)]);
        case.scratch.round += 1;
        let arguments = AdvancePairsArgs {
            triangles: on.mesh.corners(),
            links: on.mesh.twins(),
            positions: on.mesh.positions().cast(),
            state: on.state.view().cast(),
            pairs: on.pairs.view().cast(),
            words: on.words.view(),
            stride: on.stride as u32,
        };
        run::<AdvancePairs>(&mut gpu, EXACT, 2, &arguments);
        case.advance();
        let turned = u32::from(taken != 0);
        assert_eq!(on.word(&mut gpu, ROUND), round - 1 + turned);
        assert_eq!(on.word(&mut gpu, INNER), 3 + turned);
        assert_eq!(on.word(&mut gpu, INNER_ROUNDS), turned);
        assert!(on.pairs(&mut gpu, 1 - parity) == sorted(&case.pairs), "{}", case.name);
        assert_eq!(on.word(&mut gpu, CANDIDATES + parity), 0);
        on.assert_state(&mut gpu, &case, 1 - parity);
        pairs += case.pairs.len();
    }
    assert!(pairs > 100, "{pairs}");
}

#[test]
fn pair_tail() {
    let mut gpu = Gpu::open();
    let (mut rounds_of_all, mut left_of_all, mut went_on) = (0, 0, 0);
    for (turn, mut case) in with_pairs().enumerate() {
        // Where some of the rounds of this outer round are left, and where as many are made as are allowed.
        for limit in [NONE, 8] {
            let mut case = case.clone();
            let (inner, losers, outer) = (5, 2, 4);
            let most = 4 + turn as u32 % 3;
            let least = 100 + 10 * turn as u32;
            let words = [(GOES_ON, 1), (LOSERS, losers), (INNER, inner), (INNER_LIMIT, limit), (OUTER, outer)];
            let on = On::new(&mut gpu, &case, &words);
            let arguments = PairTailArgs {
                triangles: on.mesh.corners(),
                links: on.mesh.twins(),
                positions: on.mesh.positions().cast(),
                state: on.state.view().cast(),
                pairs: on.pairs.view().cast(),
                spokes: on.spokes.view(),
                degrees: on.degrees.view(),
                counter: None,
                words: on.words.view(),
                stride: on.stride as u32,
                limit: case.subs.len() as u32,
                least,
                most,
                most_pairs: NONE,
                inner: 8,
                long_chain: 64,
                most_times: 8,
                usual_rounds: 4,
            };
            run::<PairTail>(&mut gpu, EXACT, 1, &arguments);
            let bounds = [least as usize, most.min(limit - inner) as usize];
            let Case { start, pairs, scratch, spokes, degrees, .. } = &mut case;
            let spokes = [&mut spokes[..], degrees];
            let (left, rounds, flips) =
                kernels::pair_tail(&mut start.mesh, &start.positions, pairs, bounds, scratch, spokes);
            let parity = scratch.round as usize & 1;
            let inner = inner + rounds as u32;
            let goes_on = !left.is_empty() && inner < limit;
            assert_eq!(on.word(&mut gpu, GOES_ON), u32::from(goes_on));
            assert_eq!(on.word(&mut gpu, ROUND), scratch.round + if goes_on { 0 } else { 2 });
            assert_eq!(u64::from(on.word(&mut gpu, INNER_ROUNDS)), rounds);
            let turned = [OUTER, LOSERS, INNER].map(|word| on.word(&mut gpu, word));
            assert_eq!(turned, if goes_on { [outer, losers, inner] } else { [outer + 1, 0, 0] });
            assert_eq!(on.flips(&mut gpu), flips, "{}", case.name);
            assert!(on.pairs(&mut gpu, parity) == sorted(&left), "{}", case.name);
            on.assert_state(&mut gpu, &case, parity);
            on.assert_spokes(&mut gpu, &case);
            rounds_of_all += rounds;
            left_of_all += left.len();
            went_on += u32::from(goes_on);
        }
        case.flip();
    }
    assert!(rounds_of_all > 30 && left_of_all > 10 && went_on > 2, "{rounds_of_all} {left_of_all} {went_on}");
}
