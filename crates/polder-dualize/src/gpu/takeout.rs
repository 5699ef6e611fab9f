//! The last step of stage 3: sites that are still pinned are taken out.

use super::shift::{Input, OUT_ROUNDS, Stage};
use super::shift_buffers::{Buffers, Row, Word};
use crate::kernels::*;
use polder_flip::gpu::Mesh;
use polder_vulkan::{Error, Recording};

impl Stage {
    /// Step 4, after [`Stage::record_pin`] and when the hull is convex.
    ///
    /// # Errors
    ///
    /// As [`Stage::record`].
    pub fn record_take_out(
        &self,
        recording: &mut Recording,
        input: Input<'_>,
        mesh: &Mesh,
        buffers: &Buffers,
    ) -> Result<(), Error> {
        buffers.check(input, mesh)?;
        let (words, state, winners) = (buffers.words.view(), buffers.state.view(), buffers.winners.view());
        let (triangles, links) = (mesh.corners(), mesh.twins());
        let (edge_of, edges) = (buffers.edge_of.view(), buffers.edges.view());
        let bound = buffers.sites as u32;
        recording.repeat_ahead("taking out", buffers.word(Word::OutLeft)?, bound, 1, 3, |body| {
            for round in 0..OUT_ROUNDS {
                let [waiting, second] = buffers.lists(0);
                let waits_for = buffers.freed.view().cast();
                for (turn, waiting, later) in [(0, waiting, second), (1, second, waiting)] {
                    let arguments = TakeoutElectArgs {
                        triangles,
                        links,
                        state,
                        waiting,
                        later,
                        winners,
                        waits_for,
                        words,
                        round,
                        turn,
                    };
                    body.dispatch(&self.elect, self.groups, &arguments);
                }
                let arguments = TakeoutCutArgs {
                    triangles,
                    links,
                    positions: mesh.positions().cast(),
                    state,
                    winners,
                    // Nobody reads it any more in this round.
                    deferred: second,
                    freed: buffers.freed.view().cast(),
                    edge_of,
                    edges,
                    words,
                    round,
                    again: 0,
                };
                if let Some(filter) = &self.cut_by_filter {
                    body.dispatch(filter, self.groups, &arguments);
                    body.dispatch(&self.cut, self.stars, &TakeoutCutArgs { again: 1, ..arguments });
                } else {
                    body.dispatch(&self.cut, self.groups, &arguments);
                }
                let arguments = TakeoutLinkArgs { triangles, links, state, edge_of, edges, words, round };
                body.dispatch(&self.link, self.groups, &arguments);
            }
            self.record_advance(body, mesh, buffers, Row::Out, OUT_ROUNDS);
        });
        let arguments = TakeoutHeirsArgs {
            state,
            all: buffers.all.view(),
            taken: buffers.taken(),
            positions: mesh.positions().cast(),
            points: input.points.cast(),
            order: input.order,
            words,
            sites: input.sites,
            slots: mesh.slots(),
            limit: buffers.sites as u32,
        };
        recording.dispatch(&self.heirs, self.groups, &arguments);
        Ok(())
    }
}
