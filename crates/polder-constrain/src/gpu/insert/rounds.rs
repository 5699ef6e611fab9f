//! The dispatches of an outer round.

use super::{Buffers, FEW, Input, Rounds, Stage, Word};
use crate::gpu::pieces::Walkers;
use crate::kernels::*;
use crate::reference::{HUB, HUB_WALK, LONG_CHAIN, MOST_SPOKES, MOST_TIMES, USUAL_ROUNDS};
use polder_flip::gpu::Mesh;
use polder_vulkan::{Error, Recording};

impl Stage {
    /// Steps 1 to 6.
    pub(super) fn record_outer(
        &self,
        recording: &mut Recording,
        mesh: &Mesh,
        buffers: &Buffers,
        input: Input<'_>,
        Rounds { inner, longest, least, .. }: Rounds,
    ) -> Result<(), Error> {
        let groups = [self.pace.groups, 1, 1];
        let (triangles, links, positions) = (mesh.corners(), mesh.twins(), mesh.positions().cast());
        let (state, words) = (buffers.state.view().cast(), buffers.words.view());
        let Input { spokes, degrees, .. } = input;
        let (walkers, admitted, lost) = (buffers.walkers.view(), buffers.admitted.view(), buffers.lost.view());
        let (firsts, runs, piece_walked) = (buffers.firsts.view(), buffers.runs.view(), buffers.piece_walked.view());
        let list = input.pieces.map_or(&buffers.no_pieces, |(_, list)| list);
        let (pieces, piece_count, piece_limit) = (list.pieces(), list.count(), list.pieces().len() as u32);
        let sub_constraints = input.sub_constraints.cast();
        let [even_pairs, odd_pairs] = buffers.pairs.each_ref().map(|pairs| pairs.view().cast());
        let counts = buffers.counts(mesh.vertices())?;
        let limit = input.sub_constraints.len() as u32;
        let most = (3 * mesh.capacity()) as u32;
        let arguments = ListWalkersArgs {
            triangles,
            links,
            sub_constraints,
            counter: input.count,
            spokes,
            degrees,
            walkers,
            lost,
            counts,
            words,
            limit,
            most,
            crowd: HUB,
        };
        recording.dispatch(&self.list, groups, &arguments);
        let arguments = DepartWalksArgs {
            triangles,
            links,
            positions,
            sub_constraints,
            spokes,
            degrees,
            counts,
            walkers,
            firsts,
            lost,
            state,
            words,
            most,
            crowd: HUB,
            most_spokes: MOST_SPOKES,
            longest,
            least,
        };
        recording.dispatch(&self.depart, groups, &arguments);
        let arguments = AdmitWalksArgs { walkers, firsts, admitted, lost, state, words };
        recording.dispatch(&self.admit, groups, &arguments);
        if let Some((grid, list)) = input.pieces {
            let listed = buffers.words.slice(Word::Admitted as usize..Word::Admitted as usize + 1)?;
            let walkers = Walkers {
                ends: input.sub_constraints,
                list: admitted,
                listed,
                runs,
                spokes,
                degrees,
                known: Some(lost),
            };
            self.pieces.record(recording, mesh, &walkers, grid, list);
        }
        let arguments = MarkChainsArgs {
            triangles,
            links,
            positions,
            sub_constraints,
            walkers: admitted,
            firsts,
            runs,
            pieces,
            piece_count,
            piece_walked,
            lost,
            state,
            words,
            stride: buffers.slots as u32,
            piece_limit,
            hub_walk: HUB_WALK,
        };
        recording.dispatch(&self.mark, groups, &arguments);
        let arguments = RebuildChainsArgs {
            triangles,
            links,
            positions,
            walkers: admitted,
            runs,
            pieces: pieces.cast(),
            piece_count,
            piece_walked,
            lost,
            state,
            spokes,
            degrees,
            words,
            piece_limit,
        };
        recording.dispatch(&self.rebuild, groups, &arguments);
        let arguments = ConfigurePairsArgs {
            triangles,
            links,
            positions,
            state,
            lost,
            even_pairs,
            odd_pairs,
            words,
            slots: mesh.capacity() as u32,
        };
        recording.dispatch(&self.configure, groups, &arguments);
        for _ in 0..inner {
            let least = FEW;
            recording.dispatch(
                &self.flip,
                groups,
                &FlipPairsArgs { triangles, links, state, even_pairs, odd_pairs, spokes, degrees, words, least },
            );
            recording.dispatch(
                &self.advance,
                groups,
                &AdvancePairsArgs { triangles, links, positions, state, even_pairs, odd_pairs, words },
            );
        }
        let arguments = PairTailArgs {
            triangles,
            links,
            positions,
            state,
            even_pairs,
            odd_pairs,
            spokes,
            degrees,
            counter: input.count,
            words,
            limit,
            least: FEW,
            most: self.pace.rounds,
            most_pairs: self.pace.pairs,
            inner,
            long_chain: LONG_CHAIN as u32,
            most_times: MOST_TIMES,
            usual_rounds: USUAL_ROUNDS as u32,
        };
        recording.dispatch(&self.tail, [1, 1, 1], &arguments);
        Ok(())
    }
}
