//! Each kernel of stage 6 that cuts constraints against the reference of its name.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod constrain_support;
mod vulkan_support;

use constrain_support::Start;
use polder_constrain::kernels::*;
use polder_constrain::reference;
use polder_constrain::reference::kernels::{self as expected, Beginning, Piece};
use polder_flip::gpu::{Arithmetic, Mesh};
use polder_mesh::{DELETED, NONE};
use polder_predicates::Sign;
use polder_tests::families;
use polder_vulkan::{Kernel, Shader};
use vulkan_support::Gpu;

/// Places of words, as in `walk.glsl`.
const WORDS: usize = 128;
const WAITING: usize = 0;
const NEXT: usize = 24;
const WALKERS: usize = 7;
const STOPS: usize = 8;
const LOST_WALK: usize = 12;
const SUB_CONSTRAINTS: usize = 16;
const CHAINED: usize = 20;
/// The mark of a walk from the second end to the first.
const REVERSED: u32 = 1 << 31;

fn run<S: Shader>(gpu: &mut Gpu, kernel: &Kernel<S>, items: usize, arguments: &S::Args<'_>) {
    let mut recording = gpu.recording();
    recording.dispatch(kernel, polder_vulkan::groups_for(items, 256), arguments);
    gpu.run(&recording);
}

/// The families at some sizes: meshes of stage 4, and constraints as pairs of their vertices.
fn starts(sizes: &[(usize, u64)]) -> impl Iterator<Item = (&'static str, Start)> {
    let pslgs = sizes.iter().flat_map(|&(n, seed)| families(n, seed));
    pslgs.map(|(name, pslg)| (name, Start::stage_4(&pslg)))
}

fn upload(gpu: &mut Gpu, start: &Start) -> Mesh {
    let mesh = Mesh::new(&gpu.device, start.positions.len()).unwrap();
    mesh.upload(&mut gpu.engine, &start.mesh, &start.positions).unwrap();
    mesh
}

#[test]
fn find_spokes() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<FindSpokes>::new(&gpu.device, &[]).unwrap();
    for (name, start) in starts(&[(8, 1), (200, 2), (1500, 3)]) {
        let vertices = start.positions.len();
        let mesh = upload(&mut gpu, &start);
        let (spokes, degrees) = (gpu.buffer(&vec![NONE; vertices]), gpu.buffer(&vec![0u32; vertices]));
        let arguments = FindSpokesArgs {
            triangles: mesh.corners(),
            slots: mesh.slots(),
            spokes: spokes.view(),
            degrees: degrees.view(),
            limit: mesh.capacity() as u32,
            vertices: vertices as u32,
        };
        run(&mut gpu, &kernel, mesh.capacity(), &arguments);
        let (some, counts) = expected::find_spokes(&start.mesh, vertices);
        assert!(gpu.fetch(degrees.view()) == counts, "{name}: degrees");
        for (v, (&h, &one)) in gpu.fetch(spokes.view()).iter().zip(&some).enumerate() {
            assert_eq!(h == NONE, one == NONE, "{name}: vertex {v}");
            assert!(h == NONE || start.mesh.origin(h) == v as u32, "{name}: half-edge {h} does not leave vertex {v}");
        }
    }
}

#[test]
fn name_points() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<NamePoints>::new(&gpu.device, &[]).unwrap();
    for count in [0usize, 1, 2, 255, 256, 257, 5000] {
        let (order, _) = shuffled(count, 1);
        let (vertex_of, _) = shuffled(count, 2);
        let (a, b, c) = (gpu.buffer(&order), gpu.buffer(&vertex_of), gpu.buffer(&vec![7u32; count]));
        let arguments =
            NamePointsArgs { order: a.view(), vertex_of: b.view(), vertices: c.view(), count: count as u32 };
        run(&mut gpu, &kernel, count, &arguments);
        assert!(gpu.fetch(c.view()) == expected::name_points(&order, &vertex_of), "{count} points");
    }
}

#[test]
fn name_ends() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<NameEnds>::new(&gpu.device, &[]).unwrap();
    for count in [0usize, 1, 2, 255, 256, 257, 5000] {
        let (vertices, picks) = shuffled(900, 3);
        let constraints: Vec<[u32; 2]> = (0..count).map(|c| [picks[c % 900], picks[7 * c % 900]]).collect();
        let (a, b) = (gpu.buffer(&vertices), gpu.buffer(&constraints));
        let c = gpu.buffer(&vec![[7u32; 2]; count]);
        let arguments = NameEndsArgs {
            vertices: a.view(),
            constraints: b.view().cast(),
            ends: c.view().cast(),
            count: count as u32,
            points: 900,
        };
        run(&mut gpu, &kernel, count, &arguments);
        assert!(gpu.fetch(c.view()) == expected::name_ends(&vertices, &constraints), "{count} constraints");
    }
}

/// The numbers below `count` in some order, twice.
fn shuffled(count: usize, seed: u64) -> (Vec<u32>, Vec<u32>) {
    let keys = vulkan_support::words(seed, count);
    let mut list: Vec<u32> = (0..count as u32).collect();
    list.sort_by_key(|&i| keys[i as usize]);
    let first = list.clone();
    list.reverse();
    (first, list)
}

/// Constraints as they are, and as many between any vertices.
fn ends_of(start: &Start, seed: u64) -> Vec<[u32; 2]> {
    let known: Vec<u32> = start.mesh.triangles.iter().flatten().copied().filter(|&v| v < DELETED).collect();
    if known.is_empty() {
        return vec![[0, 0]];
    }
    let picks = vulkan_support::words(seed, 2 * start.constraints.len() + 200);
    let any = picks.chunks(2).map(|pair| [0, 1].map(|k| known[pair[k] as usize % known.len()]));
    start.constraints.iter().copied().chain(any).collect()
}

#[test]
fn find_edges() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<FindEdges>::new(&gpu.device, &[]).unwrap();
    for (name, start) in starts(&[(8, 4), (400, 5)]) {
        let ends = ends_of(&start, 6);
        let (spokes, degrees) = expected::find_spokes(&start.mesh, start.positions.len());
        let wanted = expected::find_edges(&start.mesh, &ends, &spokes, &degrees, 64);
        let mesh = upload(&mut gpu, &start);
        let count = ends.len();
        let on = [&spokes, &degrees].map(|words| gpu.buffer(words));
        let given = gpu.buffer(&ends);
        let out = [count, count + 1, count].map(|len| gpu.buffer(&vec![7u32; len]));
        let mut words = [0; WORDS];
        words[LOST_WALK] = NONE;
        let words = gpu.buffer(&words);
        let arguments = FindEdgesArgs {
            triangles: mesh.corners(),
            links: mesh.twins(),
            ends: given.view().cast(),
            spokes: on[0].view(),
            degrees: on[1].view(),
            met: out[0].view(),
            lengths: out[1].view(),
            list: out[2].view(),
            words: words.view(),
            constraints: count as u32,
        };
        run(&mut gpu, &kernel, count + 1, &arguments);
        let found = gpu.fetch(words.view());
        assert_eq!(found[LOST_WALK], NONE, "{name}");
        let [met, lengths, list] = out.map(|buffer| gpu.fetch(buffer.view()));
        assert!(met.iter().map(|&word| word == REVERSED).eq(wanted.reversed.iter().copied()), "{name}: directions");
        assert!(lengths[..count] == wanted.lengths && lengths[count] == 0, "{name}: lengths");
        let mut list = list[..found[NEXT] as usize].to_vec();
        list.sort_unstable();
        assert!(list == wanted.walkers, "{name}: list");
    }
}

#[test]
fn walk_turn() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<WalkTurn>::new(&gpu.device, &[]).unwrap();
    for (seed, counts) in [[0, 0], [1, 0], [0, 1], [256, 3], [257, 9], [20_000_000, 1000]].into_iter().enumerate() {
        for begins in [true, false] {
            let mut words: Vec<u32> = vulkan_support::words(seed as u64, WORDS);
            words[2] &= 1;
            words[3] &= 0xff;
            words[NEXT] = counts[0];
            let (on, pieces) = (gpu.buffer(&words), gpu.buffer(&[counts[1]]));
            let arguments =
                WalkTurnArgs { words: on.view(), piece_count: pieces.view(), piece_limit: 8, begins: begins.into() };
            run(&mut gpu, &kernel, 1, &arguments);
            expected::walk_turn(&mut words, counts[1].min(8), begins);
            assert_eq!(gpu.fetch(on.view()), words);
        }
    }
}

/// A mesh with constraints that walk, some of them in pieces that begin where the walk comes by, in order or not, or nowhere.
struct Walked {
    ends: Vec<[u32; 2]>,
    spokes: Vec<u32>,
    edges: expected::Edges,
    pieces: Vec<Piece>,
    /// What each item meets.
    met: Vec<Vec<u32>>,
}

/// Where pieces of a walk may begin.
fn beginnings(start: &Start, [from, to]: [u32; 2]) -> Vec<Beginning> {
    let at = |v: u32| start.positions[v as usize];
    let side = |v: u32| polder_predicates::orient2d(at(from), at(to), at(v));
    let mesh = &start.mesh;
    let crosses = |h: u32| {
        let (a, b) = (mesh.origin(h), mesh.destination(h));
        let finite = a < DELETED && b < DELETED;
        finite
            && (side(a), side(b)) == (Sign::Negative, Sign::Positive)
            && polder_predicates::orient2d(at(a), at(b), at(from)) == Sign::Positive
            && polder_predicates::orient2d(at(a), at(b), at(to)) == Sign::Negative
    };
    let edges = (0..3 * mesh.slots() as u32).filter(|&h| crosses(h)).map(Beginning::Crossing);
    let chains = reference::walk(mesh, &start.positions, &[[from, to]]).unwrap().chains;
    let between = &chains.get(0)[1..chains.get(0).len() - 1];
    edges.chain(between.iter().map(|&v| Beginning::AtVertex(v))).collect()
}

fn walked(start: &Start, seed: u64) -> Walked {
    let ends = ends_of(start, seed);
    let (spokes, degrees) = expected::find_spokes(&start.mesh, start.positions.len());
    let edges = expected::find_edges(&start.mesh, &ends, &spokes, &degrees, 64);
    let mut pieces = Vec::new();
    for &c in edges.walkers.iter().take(40) {
        let [a, b] = ends[c as usize];
        let on_way = beginnings(start, if edges.reversed[c as usize] { [b, a] } else { [a, b] });
        let picks = vulkan_support::words(seed + u64::from(c), (c % 5) as usize);
        for (i, &pick) in picks.iter().enumerate() {
            let beginning = on_way.get(pick as usize % (on_way.len() + 1)).copied();
            let (number, count) = (i as u32 + 1, picks.len() as u32 + 1);
            pieces.push(Piece { walker: c, number, count, beginning, last: NONE });
        }
    }
    let met = expected::walk_constraints(&start.mesh, &start.positions, &ends, &spokes, &edges, &mut pieces);
    Walked { ends, spokes, edges, pieces, met }
}

#[test]
fn walk_constraints() {
    let mut gpu = Gpu::open();
    let kernels = [Arithmetic::Filtered, Arithmetic::Integers]
        .map(|arithmetic| arithmetic.kernel::<WalkConstraints>(&gpu.device, &[]).unwrap());
    for (turn, (name, start)) in starts(&[(8, 7), (150, 8)]).enumerate() {
        let wanted = walked(&start, 9 + turn as u64);
        let mesh = upload(&mut gpu, &start);
        let (count, room) = (wanted.ends.len(), wanted.pieces.len());
        let items = (count + room).next_multiple_of(4);
        let piece_limit = (items - count) as u32;
        let begun: Vec<[u32; 4]> = wanted.pieces.iter().map(|piece| Piece { last: NONE, ..*piece }.words()).collect();
        let mut runs = vec![NONE; count];
        for (p, piece) in wanted.pieces.iter().enumerate() {
            runs[piece.walker as usize] = piece.first(p) as u32;
        }
        let directions: Vec<u32> = wanted.edges.reversed.iter().map(|&yes| if yes { REVERSED } else { 0 }).collect();
        let walkers = wanted.edges.walkers.len();
        let mut state = vec![0; 3 * items];
        state[items..items + walkers].copy_from_slice(&wanted.edges.walkers);
        let mut words = [0; WORDS];
        (words[WAITING], words[WALKERS], words[LOST_WALK]) = ((walkers + room) as u32, walkers as u32, NONE);
        let stops = wanted.met.iter().map(Vec::len).sum::<usize>();
        let (ends, spokes, met) = (gpu.buffer(&wanted.ends), gpu.buffer(&wanted.spokes), gpu.buffer(&directions));
        let (lengths, runs, pieces) = (gpu.buffer(&wanted.edges.lengths), gpu.buffer(&runs), gpu.buffer(&begun));
        let (piece_met, stops_on) = (gpu.buffer(&vec![0u32; room]), gpu.buffer(&vec![[7u32; 3]; stops]));
        let (state, words) = (gpu.buffer(&state), gpu.buffer(&words));
        let arguments = WalkConstraintsArgs {
            triangles: mesh.corners(),
            links: mesh.twins(),
            positions: mesh.positions().cast(),
            ends: ends.view().cast(),
            spokes: spokes.view(),
            met: met.view(),
            lengths: lengths.view(),
            runs: runs.view(),
            pieces: pieces.view(),
            piece_met: piece_met.view(),
            stops: stops_on.view().cast(),
            state: state.view(),
            words: words.view(),
            constraints: count as u32,
            piece_limit,
            stop_limit: stops as u32,
            most: 2000,
        };
        run(&mut gpu, &kernels[turn % 2], walkers + room, &arguments);
        let words = gpu.fetch(words.view());
        assert_eq!((words[LOST_WALK], words[NEXT], words[STOPS]), (NONE, 0, stops as u32), "{name}");
        let mut found: Vec<[u32; 3]> = gpu.fetch(stops_on.view());
        found.sort_unstable();
        let all = wanted.met.iter().enumerate();
        let all = all.flat_map(|(item, met)| met.iter().enumerate().map(move |(k, &v)| [item as u32, k as u32, v]));
        assert!(found.iter().copied().eq(all), "{name}: vertices met");
        let counts = wanted.met.iter().map(|met| met.len() as u32);
        let found = gpu.fetch(met.view()).into_iter().map(|word| word & !REVERSED).chain(gpu.fetch(piece_met.view()));
        assert!(found.eq(counts), "{name}: counts");
        let ended: Vec<[u32; 4]> = wanted.pieces.iter().map(Piece::words).collect();
        assert!(gpu.fetch(pieces.view()) == ended, "{name}: pieces");
    }
}

#[test]
fn trim_pieces() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<TrimPieces>::new(&gpu.device, &[]).unwrap();
    for (name, start) in starts(&[(8, 10), (150, 11)]) {
        let Walked { edges, pieces, met, ends, .. } = walked(&start, 12);
        let count = ends.len();
        let mut piece_met: Vec<u32> = met[count..].iter().map(|met| met.len() as u32).collect();
        let mut lengths = edges.lengths.clone();
        for &c in &edges.walkers {
            lengths[c as usize] = met[c as usize].len() as u32 + 2;
        }
        let words_of: Vec<[u32; 4]> = pieces.iter().map(Piece::words).collect();
        let (on_pieces, on_met) = (gpu.buffer(&words_of), gpu.buffer(&piece_met));
        let (on_lengths, room) = (gpu.buffer(&lengths), pieces.len() as u32);
        let piece_count = gpu.buffer(&[room]);
        let arguments = TrimPiecesArgs {
            pieces: on_pieces.view(),
            piece_met: on_met.view(),
            lengths: on_lengths.view(),
            piece_count: piece_count.view(),
            piece_limit: room,
        };
        run(&mut gpu, &kernel, 1, &arguments);
        expected::trim_pieces(&pieces, &mut piece_met, &mut lengths);
        assert!(gpu.fetch(on_met.view()) == piece_met, "{name}: pieces");
        assert!(gpu.fetch(on_lengths.view()) == lengths, "{name}: lengths");
    }
}

/// What is there when all walks have ended: arrays as the device has them, and the chains.
struct Ended {
    ends: Vec<[u32; 2]>,
    met: Vec<u32>,
    offsets: Vec<u32>,
    pieces: Vec<[u32; 4]>,
    before: Vec<u32>,
    stops: Vec<[u32; 3]>,
    words: Vec<u32>,
    chains: Vec<Vec<u32>>,
}

fn ended(start: &Start, seed: u64) -> Ended {
    let Walked { edges, pieces, met, ends, .. } = walked(start, seed);
    let count = ends.len();
    let mut piece_met: Vec<u32> = met[count..].iter().map(|met| met.len() as u32).collect();
    expected::trim_pieces(&pieces, &mut piece_met, &mut vec![0; count]);
    let chains = expected::place_chains(&ends, &edges.reversed, &pieces, &piece_met, &met);
    let uncut = reference::walk(&start.mesh, &start.positions, &ends).unwrap().chains;
    assert!(uncut.iter().eq(chains.iter().map(Vec::as_slice)), "pieces show");
    let sums = |list: &mut dyn Iterator<Item = u32>| {
        list.scan(0, |sum, next| Some(std::mem::replace(sum, *sum + next))).collect::<Vec<u32>>()
    };
    let directions = edges.reversed.iter().map(|&yes| if yes { REVERSED } else { 0 });
    let mut stops: Vec<[u32; 3]> = Vec::new();
    for (item, met) in met.iter().enumerate() {
        stops.extend(met.iter().enumerate().map(|(k, &v)| [item as u32, k as u32, v]));
    }
    stops.reverse();
    let mut words = vec![0; WORDS];
    (words[STOPS], words[LOST_WALK]) = (stops.len() as u32, NONE);
    Ended {
        met: directions.zip(&met).map(|(word, met)| word | met.len() as u32).collect(),
        offsets: sums(&mut chains.iter().map(|chain| chain.len() as u32).chain([0])),
        pieces: pieces.iter().map(Piece::words).collect(),
        before: sums(&mut piece_met.iter().copied()),
        ends,
        stops,
        words,
        chains,
    }
}

#[test]
fn place_chains() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<PlaceChains>::new(&gpu.device, &[]).unwrap();
    for (name, start) in starts(&[(8, 13), (150, 14)]) {
        let ended = ended(&start, 15);
        let wanted = ended.chains.concat();
        for room in [ended.stops.len(), ended.stops.len().wrapping_sub(1)] {
            let (ends, met, offsets) = (gpu.buffer(&ended.ends), gpu.buffer(&ended.met), gpu.buffer(&ended.offsets));
            let (pieces, before, stops) =
                (gpu.buffer(&ended.pieces), gpu.buffer(&ended.before), gpu.buffer(&ended.stops));
            let (words, chains) = (gpu.buffer(&ended.words), gpu.buffer(&vec![7u32; wanted.len()]));
            let arguments = PlaceChainsArgs {
                ends: ends.view().cast(),
                met: met.view(),
                offsets: offsets.view(),
                pieces: pieces.view(),
                before: before.view(),
                stops: stops.view().cast(),
                words: words.view(),
                chains: chains.view(),
                constraints: ended.ends.len() as u32,
                stop_limit: room as u32,
            };
            run(&mut gpu, &kernel, ended.ends.len(), &arguments);
            let words = gpu.fetch(words.view());
            let whole = room as u32 >= ended.stops.len() as u32;
            let count = if whole { wanted.len() } else { 0 };
            assert_eq!(words[CHAINED], count as u32, "{name}");
            assert_eq!(words[SUB_CONSTRAINTS], count.saturating_sub(ended.ends.len()) as u32, "{name}");
            let found = gpu.fetch(chains.view());
            assert!(if whole { found == wanted } else { found.iter().all(|&v| v == 7) }, "{name}: chains");
        }
    }
}

#[test]
fn list_sub_constraints() {
    let mut gpu = Gpu::open();
    let kernel = Kernel::<ListSubConstraints>::new(&gpu.device, &[]).unwrap();
    for (name, start) in starts(&[(8, 16), (150, 17)]) {
        let ended = ended(&start, 18);
        let wanted = expected::list_sub_constraints(&ended.chains);
        let (met, offsets, pieces) = (gpu.buffer(&ended.met), gpu.buffer(&ended.offsets), gpu.buffer(&ended.pieces));
        let (before, stops, words) = (gpu.buffer(&ended.before), gpu.buffer(&ended.stops), gpu.buffer(&ended.words));
        let (chains, out) = (gpu.buffer(&ended.chains.concat()), gpu.buffer(&vec![[7u32; 2]; wanted.len()]));
        let arguments = ListSubConstraintsArgs {
            met: met.view(),
            offsets: offsets.view(),
            pieces: pieces.view(),
            before: before.view(),
            stops: stops.view().cast(),
            words: words.view(),
            chains: chains.view(),
            sub_constraints: out.view().cast(),
            constraints: ended.ends.len() as u32,
            stop_limit: ended.stops.len() as u32,
        };
        run(&mut gpu, &kernel, ended.ends.len(), &arguments);
        assert!(gpu.fetch(out.view()) == wanted, "{name}: sub-constraints");
    }
}
