//! What is appended to a recording, in order.

use super::buffers::{Buffers, Word};
use super::{CountsRead, Stage, WORKGROUP};
use crate::kernels::*;
use polder_flip::gpu::Mesh;
use polder_mesh::NONE;
use polder_vulkan::kernels::DispatchSizeArgs;
use polder_vulkan::{Error, Recording, View, groups_for};

/// A mesh on the device, and whose points its vertices are.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// For each point the vertex that it is or equals.
    pub vertex_of: View<'a, u32>,
    /// For each point its input index.
    pub order: View<'a, u32>,
    /// The vertices along constraints, if there are any.
    pub chains: Option<Chains<'a>>,
}

/// For each constraint the vertices along it, one chain behind the other. The step gives them their names, in place.
#[derive(Clone, Copy, Debug)]
pub struct Chains<'a> {
    /// Where the chain of each constraint begins, and where the last one ends.
    pub starts: View<'a, u32>,
    /// The vertices.
    pub vertices: View<'a, u32>,
    /// How many there are, or less than all of the view; all without.
    pub count: Option<View<'a, u32>>,
}

impl Stage {
    /// The whole step: names, order, output, certificate.
    ///
    /// # Errors
    ///
    /// If the input is not of the size of the buffers.
    pub fn record(&self, recording: &mut Recording, input: &Input<'_>, buffers: &Buffers) -> Result<CountsRead, Error> {
        check(input, buffers)?;
        recording.fill(buffers.counts.view(), 0);
        recording.fill(buffers.counts.slice(Word::Broken as usize..Word::Groups as usize)?, NONE);
        self.record_names(recording, input, buffers)?;
        self.record_order(recording, input, buffers)?;
        if let Some(chains) = &input.chains {
            self.record_chains(recording, chains, buffers)?;
        }
        self.record_check(recording, input, buffers)?;
        Ok(buffers.read_counts(recording))
    }

    fn record_names(&self, recording: &mut Recording, input: &Input<'_>, buffers: &Buffers) -> Result<(), Error> {
        let (vertex_of, order, names) = (input.vertex_of, input.order, buffers.names.view());
        let representatives = buffers.representatives.view();
        let (count, groups) = (buffers.points as u32, groups_for(buffers.points, WORKGROUP));
        recording.dispatch(&self.start_names, groups, &StartNamesArgs { order, names, representatives, count });
        recording.dispatch(&self.elect_names, groups, &ElectNamesArgs { vertex_of, order, names, count });
        let duplicates = buffers.word(Word::Duplicates)?;
        let arguments = NamePointsArgs { vertex_of, order, names, representatives, duplicates, count };
        recording.dispatch(&self.name_points, groups, &arguments);
        Ok(())
    }

    fn record_order(&self, recording: &mut Recording, input: &Input<'_>, buffers: &Buffers) -> Result<(), Error> {
        let (points, slots) = (buffers.points, buffers.slots);
        let (count, limit) = (points as u32, slots as u32);
        let by_slot = groups_for(slots, WORKGROUP);
        let (triangles, names) = (input.mesh.corners(), buffers.names.view());
        let (starts, named_starts) = (buffers.starts.view(), buffers.named_starts.view());
        let (places, list, keys) = (buffers.places.view(), buffers.list.view(), buffers.keys.view());
        let (finite, long) = (buffers.word(Word::Finite)?, buffers.word(Word::Long)?);
        let slot_counter = Some(input.mesh.slots());

        recording.fill(starts, 0);
        let ghosts = buffers.word(Word::Ghosts)?;
        let arguments = CountTrianglesArgs {
            triangles,
            names,
            counts: starts,
            places,
            ghosts,
            counter: slot_counter,
            limit,
            count,
        };
        recording.dispatch(&self.count_triangles, by_slot, &arguments);
        buffers.scan.record(recording, points + 1, starts, starts, Some(finite));
        recording.fill(named_starts, 0);
        let arguments = SpreadCountsArgs { starts, names, named_counts: named_starts, count };
        recording.dispatch(&self.spread_counts, groups_for(points, WORKGROUP), &arguments);
        buffers.scan.record(recording, points, named_starts, named_starts, None);
        let arguments =
            ListTrianglesArgs { triangles, names, places, starts, list, keys, counter: slot_counter, limit };
        recording.dispatch(&self.list_triangles, by_slot, &arguments);

        // Until the end the results' memory is scratch memory.
        let long_lists = buffers.neighbors.view().cast::<u32>();
        let arguments = PlaceTrianglesArgs {
            names,
            starts,
            named_starts,
            list,
            keys,
            places,
            long_lists,
            long_count: long,
            count,
            longest: self.longest,
        };
        recording.dispatch(&self.place_triangles, groups_for(points, WORKGROUP), &arguments);
        let groups = buffers.groups()?;
        let arguments = DispatchSizeArgs { counter: Some(long), groups, limit: count, items: 1 };
        recording.dispatch(&self.dispatch_size, [1, 1, 1], &arguments);
        let halves = buffers.triangles.view().cast::<u32>();
        let middle = slots.next_multiple_of(4);
        let bits = u32::BITS - count.leading_zeros();
        let arguments = SortLongArgs {
            long_lists,
            long_count: long,
            names,
            starts,
            named_starts,
            list,
            keys,
            other_list: halves.slice(0..slots)?,
            other_keys: halves.slice(middle.min(halves.len())..halves.len())?,
            places,
            passes: bits.div_ceil(8) * 2,
        };
        recording.dispatch_indirect(&self.sort_long, groups, &arguments);

        let constrained = buffers.constrained.view();
        recording.fill(constrained, 0);
        let arguments = WriteTrianglesArgs {
            triangles,
            links: input.mesh.twins(),
            names,
            list,
            places,
            sorted: buffers.triangles.view().cast(),
            neighbors: buffers.neighbors.view().cast(),
            constrained,
            counter: Some(finite),
            limit,
            slot_count: input.mesh.slots(),
            slot_limit: limit,
        };
        recording.dispatch(&self.write_triangles, groups_for(3 * slots, WORKGROUP), &arguments);
        Ok(())
    }

    /// Chains in the numbering of the input; what constraints came to is counted.
    fn record_chains(&self, recording: &mut Recording, chains: &Chains<'_>, buffers: &Buffers) -> Result<(), Error> {
        let (constraints, vertices) = (chains.starts.len().saturating_sub(1), chains.vertices.len());
        let arguments = NameChainsArgs {
            names: buffers.names.view(),
            starts: chains.starts,
            chains: chains.vertices,
            through: buffers.word(Word::Through)?,
            counter: chains.count,
            limit: vertices as u32,
            constraints: constraints as u32,
            count: buffers.points as u32,
        };
        recording.dispatch(&self.name_chains, groups_for(vertices.max(constraints), WORKGROUP), &arguments);
        let arguments = CountConstrainedArgs {
            constrained: buffers.constrained.view(),
            neighbors: buffers.neighbors.view().cast(),
            edges: buffers.word(Word::ConstrainedEdges)?,
            counter: Some(buffers.word(Word::Finite)?),
            limit: buffers.slots as u32,
        };
        recording.dispatch(&self.count_constrained, groups_for(buffers.slots.div_ceil(4), WORKGROUP), &arguments);
        Ok(())
    }

    /// The certificate.
    fn record_check(&self, recording: &mut Recording, input: &Input<'_>, buffers: &Buffers) -> Result<(), Error> {
        let arguments = CheckTrianglesArgs {
            triangles: input.mesh.corners(),
            links: input.mesh.twins(),
            positions: input.mesh.positions().cast(),
            minima: buffers.word(Word::Minima)?,
            broken: buffers.word(Word::Broken)?,
            clockwise: buffers.word(Word::Clockwise)?,
            reflex: buffers.word(Word::Reflex)?,
            finite: buffers.word(Word::Finite)?,
            slot_count: input.mesh.slots(),
            limit: buffers.slots as u32,
            vertices: buffers.points as u32,
        };
        recording.dispatch(&self.check_triangles, groups_for(buffers.slots, WORKGROUP), &arguments);
        Ok(())
    }
}

fn check(input: &Input<'_>, buffers: &Buffers) -> Result<(), Error> {
    let (points, slots) = (buffers.points, buffers.slots);
    let sizes = [
        ("positions", input.mesh.vertices(), points),
        ("vertices of points", input.vertex_of.len(), points),
        ("input indices", input.order.len(), points),
        ("slots", input.mesh.capacity(), slots),
    ];
    // Views may be longer; slots are compared as they are.
    let wrong = |(what, len, wanted): &(&str, usize, usize)| len < wanted || *what == "slots" && len != wanted;
    match sizes.into_iter().find(wrong) {
        Some((what, len, wanted)) => {
            let why = format!("{len} {what}; the buffers are for {wanted}");
            Err(Error::Recording { command: "canonical order", why })
        }
        None => Ok(()),
    }
}
