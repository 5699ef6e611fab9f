//! What is appended to a recording, in order.

use super::{Buffers, EdgeList, Mesh, Stage, Tally};
use crate::kernels::*;
use crate::reference::round_bound;
use polder_vulkan::{Error, Kernel, Recording, Shader, View, groups_for};

const NONE: u32 = u32::MAX;
/// Invocations of a workgroup, the same in all kernels.
const WORKGROUP: u32 = 256;

/// Wide rounds between two tails: an even number.
const WIDE: usize = 10;
/// Fewer illegal edges than these are left to the tail, which keeps them up to four times as many.
const FEW: u32 = 256;
/// Wide rounds of closing a hull: an even number.
const HULL_WIDE: usize = 2;

/// Which edges may be flipped.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Scope {
    All = 0,
    Hull = 1,
}

/// How many workgroups a dispatch has.
#[derive(Clone, Copy)]
enum Size<'a> {
    Known([u32; 3]),
    /// By three words on the device.
    Told(View<'a, u32>),
}

fn dispatch<S: Shader>(recording: &mut Recording, kernel: &Kernel<S>, size: Size<'_>, arguments: &S::Args<'_>) {
    match size {
        Size::Known(groups) => recording.dispatch(kernel, groups, arguments),
        Size::Told(groups) => recording.dispatch_indirect(kernel, groups, arguments),
    }
}

/// All that rounds work on.
#[derive(Clone, Copy)]
struct Round<'a> {
    mesh: &'a Mesh,
    buffers: &'a Buffers,
    tally: &'a Tally,
    scope: Scope,
    /// Of kernels that stride, and of tails.
    sizes: [Size<'a>; 2],
}

impl Stage {
    /// To be recorded once before rounds over these buffers, while nothing has noted anything in the mesh: rounds are
    /// numbered from here on, and triangles keep the number of the last one that flipped them.
    pub fn record_start(&self, recording: &mut Recording, buffers: &Buffers) {
        recording.fill(buffers.claims.view(), NONE);
        recording.fill(buffers.listed.view(), 0);
        recording.fill(buffers.words.view(), 0);
    }

    /// Flips until no edge is illegal, as [`reference::flip`](crate::reference::flip) does. Adds to
    /// the tally.
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
        let round = self.round(mesh, buffers, tally, Scope::All);
        self.test_mesh(recording, round, Size::Known(groups_for(mesh.capacity(), WORKGROUP)));
        let bound = u32::try_from(round_bound(mesh.capacity())).unwrap_or(u32::MAX);
        recording.repeat_ahead("flip", buffers.pending()?, bound, 1, 3, |body| {
            for turn in 0..WIDE {
                self.advance(body, round, turn % 2, FEW);
            }
            self.tail(body, round, FEW, self.pace.rounds);
        });
        Ok(())
    }

    /// Tests every edge of the mesh, in as many workgroups as three words say: none, or enough for its slots. What is illegal
    /// waits for [`Stage::record_rounds`]. Adds to the tally.
    ///
    /// # Errors
    ///
    /// If the buffers are for fewer slots.
    pub fn record_test(
        &self,
        recording: &mut Recording,
        mesh: &Mesh,
        buffers: &Buffers,
        tally: &Tally,
        groups: View<'_, u32>,
    ) -> Result<(), Error> {
        buffers.fit(mesh, "flip test")?;
        self.test_mesh(recording, self.round(mesh, buffers, tally, Scope::All), Size::Told(groups));
        Ok(())
    }

    /// Some rounds, as [`reference::flip_round`](crate::reference::flip_round) makes them: over a list in which no edge is
    /// twice, which is emptied, or over what earlier rounds left; the list has to be empty then. Afterwards
    /// [`Buffers::pending`] says how many illegal edges are left: to be recorded again until that is zero. Adds to the tally.
    ///
    /// # Errors
    ///
    /// If the buffers are for fewer slots.
    pub fn record_rounds(
        &self,
        recording: &mut Recording,
        mesh: &Mesh,
        buffers: &Buffers,
        list: &EdgeList,
        tally: &Tally,
    ) -> Result<(), Error> {
        buffers.fit(mesh, "flip rounds")?;
        let round = self.round(mesh, buffers, tally, Scope::All);
        self.test_list(recording, round, list, false);
        self.flip(recording, round, Some((list, false)), 0, FEW);
        self.hand_on(recording, round, 0);
        for turn in 1..WIDE {
            self.advance(recording, round, turn % 2, FEW);
        }
        self.tail(recording, round, FEW, self.pace.rounds);
        Ok(())
    }

    /// Workgroups of kernels that stride over their items.
    pub fn groups(&self) -> u32 {
        self.pace.groups
    }

    /// Exactly one round over a list in which no edge is twice, and none that was freed, as
    /// [`reference::flip_round`](crate::reference::flip_round) does, but that nothing remembers which edges the next round
    /// were to test; the list is emptied. Adds to the tally, a round only if the list was not empty. Two words take a note of
    /// how many edges were tested, and how many of them were illegal.
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
        note: Option<View<'_, u32>>,
    ) -> Result<(), Error> {
        buffers.fit(mesh, "flip round")?;
        let round = self.round(mesh, buffers, tally, Scope::All);
        self.test_list(recording, round, list, false);
        self.flip(recording, round, Some((list, false)), 0, 0);
        let arguments = RelinkEdgesArgs {
            links: mesh.twins(),
            illegal: buffers.illegal(0),
            words: buffers.words.view(),
            note,
            parity: 0,
        };
        dispatch(recording, &self.relink_edges, round.sizes[0], &arguments);
        Ok(())
    }

    /// Ghost flips alone until the hull is nowhere strictly reflex, over a list, which is emptied, or over all ghost edges. A
    /// list comes with the number of wide rounds after its first: few where little is to be done. In it edges may repeat.
    ///
    /// The host waits for nothing. Afterwards [`Buffers::pending`] is zero, but for a hull that needs more rounds than may be
    /// taken without a look.
    ///
    /// # Errors
    ///
    /// If the buffers are for fewer slots.
    pub fn record_close_hull(
        &self,
        recording: &mut Recording,
        mesh: &Mesh,
        buffers: &Buffers,
        list: Option<(&EdgeList, usize)>,
        tally: &Tally,
    ) -> Result<(), Error> {
        buffers.fit(mesh, "close hull")?;
        self.close_hull(recording, self.round(mesh, buffers, tally, Scope::Hull), list);
        Ok(())
    }

    /// The same over a list, with sizes that the device tells, three words each: of kernels that stride ([`Stage::groups`])
    /// and of those of one workgroup; or zero, and nothing is done, also not to what flips have left.
    ///
    /// # Errors
    ///
    /// If the buffers are for fewer slots.
    pub fn record_close_hull_told(
        &self,
        recording: &mut Recording,
        mesh: &Mesh,
        buffers: &Buffers,
        list: (&EdgeList, usize),
        tally: &Tally,
        sizes: [View<'_, u32>; 2],
    ) -> Result<(), Error> {
        buffers.fit(mesh, "close hull")?;
        let round = Round { sizes: sizes.map(Size::Told), ..self.round(mesh, buffers, tally, Scope::Hull) };
        self.close_hull(recording, round, Some(list));
        Ok(())
    }

    fn close_hull(&self, recording: &mut Recording, round: Round<'_>, list: Option<(&EdgeList, usize)>) {
        match list {
            Some((list, wide)) => {
                self.test_list(recording, round, list, true);
                self.flip(recording, round, Some((list, true)), 0, 0);
                self.hand_on(recording, round, 0);
                for turn in 1..=wide {
                    self.advance(recording, round, turn % 2, FEW);
                }
            }
            None => {
                self.test_mesh(recording, round, Size::Known(groups_for(round.mesh.capacity(), WORKGROUP)));
                for turn in 0..HULL_WIDE {
                    self.advance(recording, round, turn % 2, FEW);
                }
            }
        }
        for _ in 0..self.pace.hull_tails {
            self.tail(recording, round, NONE, self.pace.hull_rounds);
        }
    }

    fn round<'a>(&self, mesh: &'a Mesh, buffers: &'a Buffers, tally: &'a Tally, scope: Scope) -> Round<'a> {
        let sizes = [[self.pace.groups, 1, 1], [1, 1, 1]].map(Size::Known);
        Round { mesh, buffers, tally, scope, sizes }
    }

    /// One wide round, from its claims to those of the next, if so many edges are illegal.
    fn advance(&self, recording: &mut Recording, round: Round<'_>, parity: usize, least: u32) {
        self.flip(recording, round, None, parity, least);
        self.hand_on(recording, round, parity);
    }

    /// Every edge, and the claims of the first round.
    fn test_mesh(&self, recording: &mut Recording, round: Round<'_>, size: Size<'_>) {
        let Round { mesh, buffers, tally, scope, .. } = round;
        let arguments = TestMeshArgs {
            triangles: mesh.corners(),
            links: mesh.twins(),
            positions: mesh.positions().cast(),
            claims: buffers.claims.view(),
            illegal: buffers.illegal(0),
            words: buffers.words.view(),
            report: tally.words(),
            slots: mesh.slots(),
            scope: scope as u32,
            parity: 0,
        };
        dispatch(recording, &self.test_mesh, size, &arguments);
    }

    /// A list, in which edges may repeat, and the claims of a round over it.
    fn test_list(&self, recording: &mut Recording, round: Round<'_>, list: &EdgeList, repeats: bool) {
        let Round { mesh, buffers, tally, scope, sizes } = round;
        let arguments = TestEdgesArgs {
            triangles: mesh.corners(),
            links: mesh.twins(),
            positions: mesh.positions().cast(),
            edges: list.edges(),
            edge_count: list.count(),
            listed: repeats.then(|| buffers.listed.view()),
            claims: buffers.claims.view(),
            illegal: buffers.illegal(0),
            words: buffers.words.view(),
            report: tally.words(),
            limit: list.limit(),
            scope: scope as u32,
            parity: 0,
        };
        dispatch(recording, &self.test_edges, sizes[0], &arguments);
    }

    fn flip(
        &self,
        recording: &mut Recording,
        round: Round<'_>,
        list: Option<(&EdgeList, bool)>,
        parity: usize,
        least: u32,
    ) {
        let Round { mesh, buffers, tally, sizes, .. } = round;
        let repeats = list.is_some_and(|(_, repeats)| repeats);
        let list = list.map(|(list, _)| list);
        let arguments = FlipEdgesArgs {
            triangles: mesh.corners(),
            links: mesh.twins(),
            claims: buffers.claims.view(),
            illegal: buffers.illegal(parity),
            edges: list.map(EdgeList::edges),
            edge_count: list.map(EdgeList::count),
            listed: repeats.then(|| buffers.listed.view()),
            words: buffers.words.view(),
            report: tally.words(),
            limit: list.map_or(0, EdgeList::limit),
            least,
            parity: parity as u32,
        };
        dispatch(recording, &self.flip_edges, sizes[0], &arguments);
    }

    fn hand_on(&self, recording: &mut Recording, round: Round<'_>, parity: usize) {
        let Round { mesh, buffers, tally, scope, sizes } = round;
        let arguments = AdvanceEdgesArgs {
            triangles: mesh.corners(),
            links: mesh.twins(),
            positions: mesh.positions().cast(),
            claims: buffers.claims.view(),
            illegal: buffers.illegal(parity),
            next_illegal: buffers.illegal(1 - parity),
            words: buffers.words.view(),
            report: tally.words(),
            scope: scope as u32,
            parity: parity as u32,
        };
        dispatch(recording, &self.advance_edges, sizes[0], &arguments);
    }

    fn tail(&self, recording: &mut Recording, round: Round<'_>, least: u32, most: u32) {
        let Round { mesh, buffers, tally, scope, sizes } = round;
        let arguments = FlipTailArgs {
            triangles: mesh.corners(),
            links: mesh.twins(),
            positions: mesh.positions().cast(),
            claims: buffers.claims.view(),
            illegal_0: buffers.illegal(0),
            illegal_1: buffers.illegal(1),
            words: buffers.words.view(),
            report: tally.words(),
            scope: scope as u32,
            least,
            most,
            most_flips: if scope == Scope::Hull { NONE } else { self.pace.flips },
        };
        dispatch(recording, &self.flip_tail, sizes[1], &arguments);
    }
}
