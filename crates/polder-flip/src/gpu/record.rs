//! What is appended to a recording, in order.

use super::{Buffers, EdgeList, Mesh, Stage, Tally};
use crate::kernels::*;
use crate::reference::round_bound;
use polder_vulkan::{Error, Recording};

const NONE: u32 = u32::MAX;

/// Wide rounds between two tails.
const WIDE: usize = 6;
/// Fewer active edges than these are left to the tail, which keeps them up to four times as many.
const FEW: u32 = 1024;
/// Rounds of one tail, and tests: so that no dispatch takes long.
const TAIL_ROUNDS: u32 = 4096;
const TAIL_TESTS: u32 = 1 << 21;
/// Of closing a hull: wide rounds, and tails.
const HULL_WIDE: usize = 3;
const HULL_TAILS: usize = 2;

/// Which edges may be flipped.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Scope {
    All = 0,
    Hull = 1,
}

/// Where the edges of a round come from.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Source {
    /// All edges of the mesh.
    Mesh,
    /// The list, in which edges may repeat.
    AnyList,
    /// The list as the round before left it, if it holds so many.
    Handed { least: u32 },
}

/// All that a round works on.
#[derive(Clone, Copy)]
struct Round<'a> {
    mesh: &'a Mesh,
    buffers: &'a Buffers,
    list: &'a EdgeList,
    /// Another list that the edges handed on are appended to.
    also: Option<&'a EdgeList>,
    tally: &'a Tally,
    scope: Scope,
}

impl Stage {
    /// To be recorded once before rounds over these buffers.
    pub fn record_start(&self, recording: &mut Recording, buffers: &Buffers) {
        recording.fill(buffers.claims.view(), NONE);
        recording.fill(buffers.stamps.view(), 0);
        recording.fill(buffers.listed.view(), 0);
        recording.fill(buffers.words.view(), 0);
    }

    /// Flips until no edge is illegal, as [`reference::flip`](crate::reference::flip) does; [`Stage::record_start`] is part
    /// of it. Adds to the tally.
    ///
    /// # Errors
    ///
    /// If the buffers are for fewer slots.
    pub fn record_flip(
        &self,
        recording: &mut Recording,
        mesh: &Mesh,
        buffers: &Buffers,
        tally: &Tally,
    ) -> Result<(), Error> {
        buffers.fit(mesh, "flip")?;
        self.record_start(recording, buffers);
        let list = &buffers.list;
        list.record_clear(recording);
        let round = Round { mesh, buffers, list, also: None, tally, scope: Scope::All };
        self.record_wide(recording, round, Source::Mesh);
        let bound = u32::try_from(round_bound(mesh.capacity())).unwrap_or(u32::MAX);
        recording.repeat_ahead("flip", list.count(), bound, 1, 1, |body| {
            for _ in 0..WIDE {
                self.record_wide(body, round, Source::Handed { least: FEW });
            }
            self.record_tail(body, round, FEW);
        });
        Ok(())
    }

    /// Exactly one round over a list, as [`reference::flip_round`](crate::reference::flip_round) does; the list then holds
    /// the edges of the next round. Adds to the tally, a round only if the list was not empty.
    ///
    /// # Errors
    ///
    /// If the buffers are for fewer slots.
    pub fn record_round(
        &self,
        recording: &mut Recording,
        mesh: &Mesh,
        buffers: &Buffers,
        list: &EdgeList,
        tally: &Tally,
    ) -> Result<(), Error> {
        buffers.fit(mesh, "flip round")?;
        let round = Round { mesh, buffers, list, also: None, tally, scope: Scope::All };
        self.record_wide(recording, round, Source::AnyList);
        Ok(())
    }

    /// Ghost flips alone until the hull is nowhere strictly reflex, over a list, or over all ghost edges and
    /// [`Buffers::list`]. The edges that each round hands on are appended to `also`.
    ///
    /// The host waits for nothing; afterwards the list is empty, but for a hull that needs more rounds than one dispatch
    /// may take.
    ///
    /// # Errors
    ///
    /// If the buffers are for fewer slots.
    pub fn record_close_hull(
        &self,
        recording: &mut Recording,
        mesh: &Mesh,
        buffers: &Buffers,
        list: Option<&EdgeList>,
        also: Option<&EdgeList>,
        tally: &Tally,
    ) -> Result<(), Error> {
        buffers.fit(mesh, "close hull")?;
        let round = Round { mesh, buffers, list: list.unwrap_or(&buffers.list), also, tally, scope: Scope::Hull };
        if list.is_none() {
            round.list.record_clear(recording);
        }
        self.record_wide(recording, round, if list.is_none() { Source::Mesh } else { Source::AnyList });
        if list.is_none() {
            for _ in 0..HULL_WIDE {
                self.record_wide(recording, round, Source::Handed { least: FEW });
            }
        }
        for _ in 0..HULL_TAILS {
            self.record_tail(recording, round, NONE);
        }
        Ok(())
    }

    fn record_wide(&self, recording: &mut Recording, round: Round<'_>, source: Source) {
        let Round { mesh, buffers, list, also, tally, scope } = round;
        let (triangles, links, positions) = (mesh.corners(), mesh.twins(), mesh.positions().cast());
        let (claims, stamps, words) = (buffers.claims.view(), buffers.stamps.view(), buffers.words.view());
        let (illegal, deferred) = (buffers.illegal.view(), buffers.deferred.view());
        let listed = (source == Source::AnyList).then(|| buffers.listed.view());
        let arguments = TestEdgesArgs {
            triangles,
            links,
            positions,
            edges: (source != Source::Mesh).then(|| list.edges()),
            edge_count: (source != Source::Mesh).then(|| list.count()),
            listed,
            claims,
            illegal,
            deferred,
            words,
            report: tally.words(),
            slots: mesh.slots(),
            limit: list.limit(),
            least: if let Source::Handed { least } = source { least } else { 0 },
            scope: scope as u32,
            again: 0,
        };
        recording.dispatch(&self.test_edges.first, self.groups, &arguments);
        if let Some(exact) = &self.test_edges.rest {
            let arguments = TestEdgesArgs {
                edges: Some(deferred),
                edge_count: None,
                listed: None,
                limit: deferred.len() as u32,
                again: 1,
                ..arguments
            };
            recording.dispatch(exact, self.exact_groups, &arguments);
        }
        let arguments = FlipEdgesArgs {
            triangles,
            links,
            claims,
            stamps,
            illegal,
            edge_count: list.count(),
            edges: listed.map(|_| list.edges()),
            listed,
            words,
            report: tally.words(),
            limit: illegal.len() as u32,
        };
        recording.dispatch(&self.flip_edges, self.groups, &arguments);
        let arguments = RelinkEdgesArgs {
            triangles,
            links,
            claims,
            stamps,
            illegal,
            edges: list.edges(),
            edge_count: list.count(),
            also: also.map(EdgeList::edges),
            also_count: also.map(EdgeList::count),
            words,
            also_limit: also.map_or(0, EdgeList::limit),
        };
        recording.dispatch(&self.relink_edges, self.groups, &arguments);
    }

    fn record_tail(&self, recording: &mut Recording, round: Round<'_>, least: u32) {
        let Round { mesh, buffers, list, also, tally, scope } = round;
        let arguments = FlipTailArgs {
            triangles: mesh.corners(),
            links: mesh.twins(),
            positions: mesh.positions().cast(),
            edges: list.edges(),
            edge_count: list.count(),
            also: also.map(EdgeList::edges),
            also_count: also.map(EdgeList::count),
            illegal: buffers.illegal.view(),
            claims: buffers.claims.view(),
            stamps: buffers.stamps.view(),
            words: buffers.words.view(),
            report: tally.words(),
            scope: scope as u32,
            least,
            most: TAIL_ROUNDS,
            most_tests: TAIL_TESTS,
            also_limit: also.map_or(0, EdgeList::limit),
        };
        recording.dispatch(&self.flip_tail, [1, 1, 1], &arguments);
    }
}
