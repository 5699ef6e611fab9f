//! Each kernel of stage 4 against the reference of its name, bit for bit.
#![cfg(feature = "gpu-tests")]
#![allow(clippy::unwrap_used, reason = "tests")]

mod insert_gpu_support;
mod vulkan_support;

use glam::DVec2;
use insert_gpu_support::*;
use polder_dualize::kernels::*;
use polder_dualize::reference::kernels::insert as expected;
use polder_flip::gpu::{Arithmetic, Mesh};
use polder_flip::priority;
use polder_flip::reference::chain;
use polder_mesh::{GhostMesh, NONE};
use polder_tests::point_families;
use vulkan_support::Gpu;

fn has_won(place: u32) -> bool {
    place != NONE && place & expected::WON != 0
}

#[test]
fn insert_begin() {
    let mut gpu = Gpu::open();
    for (name, round) in rounds() {
        let on = round.on(&mut gpu, &[], &words());
        let (count, vertices) = (round.mesh.slots(), round.positions.len());
        let (half_edges, sites) = (gpu.buffer(&vec![NONE; vertices]), gpu.buffer(&[3]));
        let arguments = InsertBeginArgs {
            triangles: on.mesh.corners(),
            slots: on.mesh.slots(),
            half_edges: half_edges.view(),
            vertex_of: on.vertex_of.view(),
            sites: sites.view(),
            words: on.words.view(),
            limit: count as u32,
            vertices: vertices as u32,
        };
        run::<InsertBegin>(&mut gpu, count.max(vertices), &arguments);
        let found = gpu.fetch(half_edges.view());
        for (v, (&h, &wanted)) in found.iter().zip(&round.begun.half_edges).enumerate() {
            // Any half-edge out of the vertex will do.
            let right = if wanted == NONE { h == NONE } else { round.mesh.origin(h) == v as u32 };
            assert!(right, "{name}: {v}");
        }
        assert!(gpu.fetch(on.vertex_of.view()).into_iter().eq(0..vertices as u32), "{name}");
        let words = gpu.fetch(on.words.view());
        assert_eq!((words[CENTER_SLOT], words[CHAIN], words[SITES]), (round.begun.center_slot, 1, 3), "{name}");
    }
}

#[test]
fn insert_wait() {
    let mut gpu = Gpu::open();
    for (name, round) in rounds() {
        let mut before = words();
        before[CENTER_SLOT] = round.begun.center_slot;
        let on = round.on(&mut gpu, &[], &before);
        let [points, starts, half_edges] =
            [&round.new.points, &round.new.starts, &round.begun.half_edges].map(|list| gpu.buffer(list));
        let arguments = InsertWaitArgs {
            triangles: on.mesh.corners(),
            half_edges: half_edges.view(),
            points: points.view(),
            starts: starts.view(),
            counter: None,
            waiting: on.waiting.view(),
            slots: on.mesh.slots(),
            words: on.words.view(),
            limit: on.limit,
            vertices: round.positions.len() as u32,
        };
        run::<InsertWait>(&mut gpu, round.waiting.len(), &arguments);
        assert!(gpu.fetch(on.waiting.view())[..round.waiting.len()] == round.waiting, "{name}");
        let words = gpu.fetch(on.words.view());
        assert_eq!(words[CENTER..CENTER + 3], round.mesh.triangles[round.begun.center_slot as usize], "{name}");
        let waiting = [WAITING, WAITING_STEADY, WAITING_BEHIND].map(|at| words[at]);
        assert_eq!(waiting, [on.limit, on.limit, 0], "{name}");
        assert_eq!([words[ROUND], words[LOST]], [1, NONE], "{name}");
        assert_eq!(words[GROUPS..GROUPS + 3], [on.limit.div_ceil(256), 1, 1], "{name}");
        assert_eq!(gpu.fetch(on.mesh.slots())[0] as usize, round.mesh.slots());
    }
}

#[test]
fn insert_locate() {
    let mut gpu = Gpu::open();
    let (mut edges, mut outside, mut duplicates) = (0, 0, 0);
    for (name, mut round) in rounds() {
        let before = round.claims.clone();
        let wanted = round.locate();
        for arithmetic in [Arithmetic::Filtered, Arithmetic::Integers] {
            let (claims, words) = (std::mem::replace(&mut round.claims, before.clone()), round.words());
            let on = round.on(&mut gpu, &[], &words);
            round.claims = claims;
            let arguments = InsertLocateArgs {
                triangles: on.mesh.corners(),
                links: on.mesh.twins(),
                positions: on.mesh.positions().cast(),
                waiting: on.waiting.view(),
                freed: on.freed.view(),
                places: on.places.view(),
                claims: on.claims.view().cast(),
                vertex_of: on.vertex_of.view(),
                words: on.words.view(),
                limit: on.limit,
                vertices: round.positions.len() as u32,
            };
            let kernel = arithmetic.kernel::<InsertLocate>(&gpu.device, &[]).unwrap();
            run_kernel(&mut gpu, &kernel, round.waiting.len(), &arguments);
            assert!(gpu.fetch(on.places.view()) == wanted.places.as_flattened(), "{name}: places");
            assert!(on.claims(&mut gpu, &round.claims), "{name}: claims");
            let vertex_of = gpu.fetch(on.vertex_of.view());
            assert!(wanted.on_vertices.iter().all(|[point, v]| vertex_of[*point as usize] == *v), "{name}");
            let words = gpu.fetch(on.words.view());
            assert_eq!(words[DUPLICATES] as usize, wanted.on_vertices.len(), "{name}");
            assert_eq!(words[LOST], NONE);
        }
        duplicates += wanted.on_vertices.len();
        edges += wanted.places.iter().filter(|[place, _]| *place != NONE && place & expected::ON_EDGE != 0).count();
        outside += wanted.places.iter().filter(|[place, score]| *place != NONE && *score > 1 << 31).count();
    }
    assert!(edges > 20 && outside > 100 && duplicates > 20, "{edges} on edges, {outside} outside, {duplicates} twice");
}

#[test]
fn insert_claim() {
    let mut gpu = Gpu::open();
    for (name, mut round) in rounds() {
        let mut places = round.locate().places;
        let on = round.on(&mut gpu, &places, &round.words());
        let arguments = InsertClaimArgs {
            links: on.mesh.twins(),
            waiting: on.waiting.view(),
            places: on.places.view(),
            claims: on.claims.view().cast(),
            words: on.words.view(),
            limit: on.limit,
        };
        run::<InsertClaim>(&mut gpu, round.waiting.len(), &arguments);
        round.claim(&mut places);
        assert!(gpu.fetch(on.places.view()) == places.as_flattened(), "{name}: places");
        assert!(on.claims(&mut gpu, &round.claims), "{name}: claims");
    }
}

#[test]
fn insert_graft() {
    let mut gpu = Gpu::open();
    let mut inserted = 0;
    for (name, mut round) in rounds() {
        let mut places = round.locate().places;
        round.claim(&mut places);
        let on = round.on(&mut gpu, &places, &round.words());
        let arguments = InsertGraftArgs {
            triangles: on.mesh.corners(),
            links: on.mesh.twins(),
            waiting: on.waiting.view(),
            freed: on.freed.view(),
            places: on.places.view(),
            claims: on.claims.view().cast(),
            words: on.words.view(),
            limit: on.limit,
        };
        run::<InsertGraft>(&mut gpu, round.waiting.len(), &arguments);
        let mut losers = round.graft(&mut places);
        assert!(on.mesh.download(&mut gpu.engine).unwrap() == round.mesh, "{name}: mesh");
        assert!(gpu.fetch(on.places.view()) == places.as_flattened(), "{name}: places");
        assert!(on.claims(&mut gpu, &round.claims), "{name}: claims");
        let mut found = gpu.fetch(on.waiting.view())[round.waiting.len()..][..losers.len()].to_vec();
        found.sort_unstable();
        losers.sort_unstable();
        assert!(found == losers, "{name}: losers");
        let words = gpu.fetch(on.words.view());
        let won = places.iter().filter(|[place, _]| has_won(*place)).count();
        assert_eq!([words[NEXT] as usize, words[INSERTED] as usize], [losers.len(), won], "{name}");
        inserted += won;
    }
    assert!(inserted > 500, "{inserted}");
}

#[test]
fn insert_relink() {
    let mut gpu = Gpu::open();
    for (name, mut round) in rounds() {
        let mut places = round.locate().places;
        round.claim(&mut places);
        let losers = round.graft(&mut places);
        let mut words = round.words();
        words[NEXT] = losers.len() as u32;
        words[INSERTED] = places.iter().filter(|[place, _]| has_won(*place)).count() as u32;
        let flips = words[NEXT] >= words[INSERTED].div_ceil(16);
        let on = round.on(&mut gpu, &places, &words);
        let room = 6 * round.mesh.slots();
        let (edges, hull_edges) = (gpu.buffer(&vec![0; room]), gpu.buffer(&vec![0; room]));
        let edge_count = gpu.buffer(&[0]);
        let arguments = InsertRelinkArgs {
            triangles: on.mesh.corners(),
            links: on.mesh.twins(),
            places: on.places.view(),
            claims: on.claims.view().cast(),
            edges: edges.view(),
            edge_count: edge_count.view(),
            hull_edges: hull_edges.view(),
            hull_count: on.hull.view(),
            words: on.words.view(),
            edge_limit: room as u32,
            hull_limit: room as u32,
        };
        run::<InsertRelink>(&mut gpu, round.waiting.len(), &arguments);
        let Round { mesh, slots, waiting, claims, .. } = &mut round;
        let wanted = expected::insert_relink(mesh, slots, waiting, &places, claims, 1, flips);
        mesh.check().unwrap();
        assert!(on.mesh.download(&mut gpu.engine).unwrap() == *mesh, "{name}: mesh");
        assert!(on.claims(&mut gpu, claims), "{name}: claims");
        let mut listed: Vec<u32> = wanted[0].iter().map(|&h| h.min(mesh.twin(h))).collect();
        listed.sort_unstable();
        assert!(listed.windows(2).all(|pair| pair[0] < pair[1]), "{name}: an edge twice");
        for (list, count, mut wanted) in
            [(edges, edge_count, wanted[0].clone()), (hull_edges, on.hull, wanted[1].clone())]
        {
            let count = gpu.fetch(count.view())[0] as usize;
            let mut found = gpu.fetch(list.view())[..count].to_vec();
            found.sort_unstable();
            wanted.sort_unstable();
            assert!(found == wanted, "{name}: lists");
        }
        let words = gpu.fetch(on.words.view());
        let turned = [WAITING, NEXT, PARITY, ROUND, FINISHED].map(|at| words[at]);
        assert_eq!(turned, [losers.len() as u32, 0, 1, 2, 0], "{name}");
        assert_eq!(words[GROUPS] as usize, losers.len().div_ceil(256), "{name}");
    }
}

#[test]
fn insert_turn() {
    let mut gpu = Gpu::open();
    const SLOTS: u32 = 1000;
    let mut turn = |before: [u32; WORDS], reflex: u32| {
        let (pending, words) = (gpu.buffer(&[reflex]), gpu.buffer(&before));
        run::<InsertTurn>(&mut gpu, 1, &InsertTurnArgs { reflex: pending.view(), words: words.view(), slots: SLOTS });
        gpu.fetch(words.view())
    };
    let mut fell_behind = 0;
    for (waiting, inserted) in [(0, 900), (1, 3), (400, 800), (400, 802), (60_000, 5), (4_000_000_000, 90_000_000)] {
        let counts = [0_u32, 255, 256, 257, 1875, 30_000, 124_999_999, 4_000_000_000];
        for (edges, slow) in counts.into_iter().flat_map(|edges| [0, 1, 2].map(|slow| (edges, slow))) {
            let bounds = [edges / 16, edges / 2 - edges / 128];
            for illegal in bounds.into_iter().flat_map(|bound| [bound.saturating_sub(1), bound, bound + 1]) {
                let mut before = words();
                [before[WAITING], before[INSERTED], before[SLOW]] = [waiting, inserted, slow];
                [before[TESTED], before[TESTED + 1]] = [edges, illegal];
                before[GROUPS..GROUPS + 3].fill(9);
                before[MESH_GROUPS..MESH_GROUPS + 3].fill(0);
                let found = turn(before, 0);
                let counted = expected::insert_turn(slow, [edges, illegal], waiting, inserted);
                let rounds = if slow < expected::BEHIND { counted } else { slow };
                let behind = rounds >= expected::BEHIND;
                let [just, groups] = [u32::from(behind && slow < expected::BEHIND), 9];
                assert_eq!(found[SLOW], rounds);
                let left = if behind { [0, waiting] } else { [waiting, 0] };
                assert_eq!([WAITING, WAITING_STEADY, WAITING_BEHIND].map(|at| found[at]), [waiting, left[0], left[1]]);
                assert_eq!(found[GROUPS..GROUPS + 3], [groups * (1 - just); 3]);
                assert_eq!(found[MESH_GROUPS..MESH_GROUPS + 3], [just * SLOTS.div_ceil(256), just, just]);
                fell_behind += just;
            }
        }
    }
    assert!(fell_behind > 10, "{fell_behind}");
    // A hull that is not closed, if one was to be closed.
    for (reflex, slow, closed, open) in
        [(0, 0, 0, 0), (1, 0, 0, 1), (3, 0, 0, 1), (3, 2, 0, 0), (3, 2, 1, 1), (0, 2, 1, 0)]
    {
        let mut before = words();
        [before[WAITING], before[SLOW], before[WIDE_GROUPS]] = [17, slow, closed];
        before[GROUPS..GROUPS + 3].fill(1);
        let found = turn(before, reflex);
        let left = 17 * (1 - open);
        let steady = if slow == 0 { [left, 0] } else { [0, left] };
        assert_eq!([found[OPEN_HULL], found[WAITING]], [open, left]);
        assert_eq!([found[WAITING_STEADY], found[WAITING_BEHIND]], steady);
        assert_eq!(found[GROUPS..GROUPS + 3], [1 - open; 3]);
    }
}

#[test]
fn insert_clear() {
    let mut gpu = Gpu::open();
    for (name, mut round) in rounds() {
        let own: Vec<u32> = round.waiting.iter().flat_map(|&[point, _]| round.slots[point as usize]).collect();
        // Whatever was there before.
        for &t in &own {
            round.mesh.triangles[t as usize] = [2, 1, 0];
            round.mesh.links[t as usize] = [1, 2, 3];
        }
        let on = round.on(&mut gpu, &[], &round.words());
        let arguments = InsertClearArgs {
            triangles: on.mesh.corners(),
            links: on.mesh.twins(),
            waiting: on.waiting.view(),
            freed: on.freed.view(),
            words: on.words.view(),
            limit: on.limit,
        };
        run::<InsertClear>(&mut gpu, round.mesh.slots(), &arguments);
        expected::insert_clear(&mut round.mesh, &round.slots, &round.waiting);
        assert!(own.iter().all(|&t| round.mesh.is_deleted(t as usize)), "{name}");
        assert!(on.mesh.download(&mut gpu.engine).unwrap() == round.mesh, "{name}");
    }
}

#[test]
fn insert_resume() {
    let mut gpu = Gpu::open();
    for (waiting, pending) in [(0, 0), (1, 0), (256, 0), (257, 0), (20_000, 0), (20_000, 1), (1, 7), (0, 3)] {
        let mut before = words();
        before[WAITING_BEHIND] = waiting;
        for place in [GROUPS, WIDE_GROUPS, ONE_GROUP] {
            before[place..place + 3].fill(9);
        }
        let (pending_word, words) = (gpu.buffer(&[pending]), gpu.buffer(&before));
        let arguments = InsertResumeArgs { pending: pending_word.view(), words: words.view(), groups: 64 };
        run::<InsertResume>(&mut gpu, 1, &arguments);
        let found = gpu.fetch(words.view());
        let points = expected::insert_resume(waiting, pending);
        let some = u32::from(points > 0);
        assert_eq!(found[GROUPS..GROUPS + 3], [points.div_ceil(256), some, some]);
        assert_eq!(found[WIDE_GROUPS..WIDE_GROUPS + 3], [64 * some, some, some]);
        assert_eq!(found[ONE_GROUP..ONE_GROUP + 3], [some; 3]);
        assert_eq!(found[WAITING_BEHIND], waiting);
    }
}

#[test]
fn insert_ends() {
    let mut gpu = Gpu::open();
    for (name, pslg) in point_families(700, 42) {
        let positions = pslg.points();
        let count = positions.len() as u32;
        for every in [1, 3, 900] {
            // All points of an empty mesh, or some that are vertices.
            let chosen: Vec<u32> = (0..count).filter(|v| v % every == 0).collect();
            let mut before = words();
            before[CHAIN] = u32::from(every > 1);
            let half_edges: Vec<u32> = (0..count).map(|v| if v % every == 0 { v } else { NONE }).collect();
            let mesh = Mesh::new(&gpu.device, positions.len()).unwrap();
            let free = GhostMesh::with_slots(mesh.capacity());
            mesh.upload(&mut gpu.engine, &free, positions).unwrap();
            let (half_edges, words) = (gpu.buffer(&half_edges), gpu.buffer(&before));
            let ends = gpu.buffer(&vec![7; 2 * count.div_ceil(256) as usize]);
            for (items, count, last) in [(count, count, 0), (1, 2 * count.div_ceil(256), 1)] {
                let arguments = InsertEndsArgs {
                    triangles: mesh.corners(),
                    links: mesh.twins(),
                    positions: mesh.positions().cast(),
                    half_edges: half_edges.view(),
                    ends: ends.view(),
                    words: words.view(),
                    count,
                    last,
                };
                run::<InsertEnds>(&mut gpu, items as usize, &arguments);
            }
            let [a, b] = expected::insert_ends(positions, chosen.into_iter());
            let found = gpu.fetch(words.view());
            assert_eq!(found[ENDS..ENDS + 2], [a, b], "{name}, {every}");
            let laid = mesh.download(&mut gpu.engine).unwrap();
            if every == 1 && positions[a as usize] != positions[b as usize] {
                let keeps = if a == 0 { b } else { a };
                let gives = a + b - keeps;
                let pair = |v: u32| if v == 0 { [NONE; 2] } else { [2 * v - 2, 2 * v - 1] };
                assert_eq!([found[SITES], found[GIVEN], found[GIVEN + 1]], [0, pair(gives)[0], pair(gives)[1]]);
                laid.check().unwrap();
                let ghosts = (0..laid.slots() as u32).filter(|&t| laid.is_ghost(t as usize));
                assert!(ghosts.eq(pair(keeps)), "{name}");
            } else {
                assert!(laid == free, "{name}");
            }
        }
    }
}

#[test]
fn insert_apex() {
    let mut gpu = Gpu::open();
    for (name, pslg) in point_families(700, 43) {
        let positions = pslg.points();
        let ends = expected::insert_ends(positions, 0..positions.len() as u32);
        for arithmetic in [Arithmetic::Filtered, Arithmetic::Integers] {
            let mut before = words();
            before[ENDS..ENDS + 2].copy_from_slice(&ends);
            let (words, positions) = (gpu.buffer(&before), gpu.buffer(positions));
            let kernel = arithmetic.kernel(&gpu.device, &[]).unwrap();
            let count = positions.len() as u32;
            let arguments = InsertApexArgs { positions: positions.view().cast(), words: words.view(), count };
            run_kernel::<InsertApex>(&mut gpu, &kernel, 256, &arguments);
            let wanted = expected::insert_apex(pslg.points(), ends);
            assert_eq!(gpu.fetch(words.view())[APEX], wanted, "{name}");
        }
    }
}

#[test]
fn insert_join() {
    let mut gpu = Gpu::open();
    for (vertices, apex) in [(2, 5.0), (2, -5.0), (3, 1.0), (40, 0.25), (300, -9.0)] {
        for reverse in [false, true] {
            let mut order: Vec<u32> = (0..vertices).collect();
            if reverse {
                order.reverse();
            }
            let mut positions: Vec<DVec2> = (0..vertices).map(|i| DVec2::new(f64::from(i), 0.0)).collect();
            positions.push(DVec2::new(1.5, apex));
            let mut wanted = GhostMesh::with_slots(2 * positions.len() - 2);
            let start = chain(&order);
            wanted.triangles[..start.slots()].copy_from_slice(&start.triangles);
            wanted.links[..start.slots()].copy_from_slice(&start.links);
            let mesh = Mesh::new(&gpu.device, positions.len()).unwrap();
            mesh.upload(&mut gpu.engine, &wanted, &positions).unwrap();
            let mut before = words();
            [before[CHAIN], before[APEX], before[ENDS]] = [1, priority(vertices), 0];
            let (words, freed) = (gpu.buffer(&before), gpu.buffer(&[[0_u32; 2]]));
            let kernel = Arithmetic::Filtered.kernel(&gpu.device, &[]).unwrap();
            let arguments = InsertJoinArgs {
                triangles: mesh.corners(),
                links: mesh.twins(),
                positions: mesh.positions().cast(),
                slots: mesh.slots(),
                freed: freed.view(),
                words: words.view(),
            };
            run_kernel::<InsertJoin>(&mut gpu, &kernel, wanted.slots(), &arguments);
            expected::insert_join(&mut wanted, &positions, vertices, [2 * vertices - 2, 2 * vertices - 1]);
            wanted.check().unwrap();
            assert!(mesh.download(&mut gpu.engine).unwrap() == wanted, "{vertices} {apex}");
            let least = wanted.finite().next().unwrap() as u32;
            assert_eq!(gpu.fetch(words.view())[CENTER_SLOT], least);
        }
    }
}
