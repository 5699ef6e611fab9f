//! What is appended to a recording, in order.

use super::buffers::{Buffers, Word};
use super::{CountsRead, Stage};
use crate::GridMapping;
use crate::kernels::*;
use glam::DVec2;
use polder_vulkan::primitives::Count;
use polder_vulkan::{Error, Recording, View, groups_for};

/// What stands where there is nothing.
const NONE: u32 = u32::MAX;
/// Invocations of a workgroup, the same in all kernels.
const WORKGROUP: u32 = 256;
/// Rounds between two looks of the host at a counter.
const BATCH: u32 = 8;

impl Stage {
    /// The whole stage: mapping, coloring, repair. The points must be those, or as many and within the box of those, that
    /// the mapping was fitted to; none may be NaN or infinite.
    ///
    /// # Errors
    ///
    /// If points or mapping are not of the size of the buffers.
    pub fn record(
        &self,
        recording: &mut Recording,
        mapping: &GridMapping,
        points: View<'_, DVec2>,
        buffers: &Buffers,
    ) -> Result<CountsRead, Error> {
        self.record_map(recording, mapping, points, buffers)?;
        self.record_color(recording, buffers)?;
        self.record_repair(recording, buffers)?;
        Ok(buffers.read_counts(recording))
    }

    /// Points to sites: writes order, pixels and their counts, as [`reference::map`](crate::reference::map) does.
    ///
    /// # Errors
    ///
    /// If points or mapping are not of the size of the buffers.
    pub fn record_map(
        &self,
        recording: &mut Recording,
        mapping: &GridMapping,
        points: View<'_, DVec2>,
        buffers: &Buffers,
    ) -> Result<(), Error> {
        let count = buffers.points;
        if mapping.size() != buffers.size || points.len() != count {
            let (size, points) = (mapping.size(), points.len());
            let why = format!("{points} points on {size:?} pixels; buffers for {count} on {:?}", buffers.size);
            return Err(Error::Recording { command: "map_points", why });
        }
        let [width, height] = buffers.size;
        let pixel_count = width as usize * height as usize;
        let limit = count as u32;
        let (pixels, owner, number) = (buffers.point_pixels.view(), buffers.a.view(), buffers.b.view());
        let (order, order_pixels) = (buffers.order.view(), buffers.pixels.view().cast::<u32>());
        let (sites, counter) = (buffers.word(Word::Sites)?, buffers.word(Word::Missing)?);
        let groups = groups_for(count, WORKGROUP);

        recording.fill(owner, NONE);
        recording.fill(number, 0);
        let [translation_x, translation_y] = mapping.translation();
        let arguments = MapPointsArgs {
            points: points.cast::<u64>(),
            pixels,
            owner,
            translation_x,
            translation_y,
            exponent: mapping.exponent(),
            side: mapping.side(),
            width,
            height,
            count: limit,
        };
        recording.dispatch(&self.map_points, groups, &arguments);
        let lost = buffers.lost.view();
        let arguments = ElectSitesArgs { pixels, owner, owned: number, lost, width, count: limit };
        recording.dispatch(&self.elect_sites, groups, &arguments);
        buffers.scan.record(recording, pixel_count, number, number, Some(sites));
        let arguments = NumberSitesArgs { pixels, owner, number, order, order_pixels, width, count: limit };
        recording.dispatch(&self.number_sites, groups, &arguments);

        let (missing, keys) = (buffers.missing.view(), buffers.keys.view());
        buffers.compact_points.record(recording, count, lost, None, missing, counter);
        let arguments = MissingKeysArgs { pixels, missing, keys, counter: Some(counter), limit, width };
        recording.dispatch(&self.missing_keys, groups, &arguments);
        let bits = (pixel_count as u32 - 1).checked_ilog2().map_or(0, |log| log + 1);
        buffers.sort.record(recording, Count::on_device(counter, count), keys, Some(missing), bits);
        let arguments =
            NumberMissingArgs { pixels, missing, sites, order, order_pixels, counter: Some(counter), limit };
        recording.dispatch(&self.number_missing, groups, &arguments);
        Ok(())
    }

    /// Colors every pixel by its nearest site, as [`reference::color`](crate::reference::color) does. Reads the pixels of
    /// the sites, and how many there are, at least one.
    ///
    /// # Errors
    ///
    /// None that its arguments can cause.
    pub fn record_color(&self, recording: &mut Recording, buffers: &Buffers) -> Result<(), Error> {
        let [width, height] = buffers.size;
        let pixel_count = width as usize * height as usize;
        let (grid, nearest, entries) = (buffers.a.view(), buffers.b.view(), buffers.c.view());
        let (ends, live, starts) = (buffers.ends.view(), buffers.live.view(), buffers.starts.view());
        let (rows, columns) = (self.bands.rows, self.bands.columns);

        recording.fill(grid, NONE);
        let arguments = PlaceSitesArgs {
            sites: buffers.pixels.view().cast::<u32>(),
            grid,
            counter: Some(buffers.word(Word::Sites)?),
            limit: buffers.points as u32,
            width,
        };
        recording.dispatch(&self.place_sites, groups_for(buffers.points, WORKGROUP), &arguments);
        let groups = groups_for(buffers.ends.len(), WORKGROUP);
        recording.dispatch(&self.column_ends, groups, &ColumnEndsArgs { grid, ends, width, height, band: rows });
        let arguments = ColumnFillArgs { grid, ends, nearest, width, height, band: rows };
        recording.dispatch(&self.column_fill, groups, &arguments);
        let groups = groups_for(buffers.live.len(), WORKGROUP);
        let arguments = RowStacksArgs { nearest, entries, live, width, height, band: columns };
        recording.dispatch(&self.row_stacks, groups, &arguments);
        let arguments = RowMergeArgs { nearest, entries, live, starts, width, height, band: columns };
        recording.dispatch(&self.row_merge, groups_for(height as usize, WORKGROUP), &arguments);
        let colors = buffers.colors.view();
        let arguments = ColorPixelsArgs { grid, nearest, entries, live, starts, colors, width, height, band: columns };
        recording.dispatch(&self.color_pixels, groups_for(pixel_count, WORKGROUP), &arguments);
        Ok(())
    }

    /// Finds debris and recolors it, as [`reference::debris`](crate::reference::debris) and
    /// [`reference::recolor`](crate::reference::recolor) do.
    ///
    /// # Errors
    ///
    /// None that its arguments can cause.
    pub fn record_repair(&self, recording: &mut Recording, buffers: &Buffers) -> Result<(), Error> {
        self.record_debris(recording, buffers)?;
        self.record_recolor(recording, buffers)
    }

    /// The first half of [`Stage::record_repair`]: debris loses its color and is listed, ascending.
    ///
    /// # Errors
    ///
    /// None that its arguments can cause.
    pub fn record_debris(&self, recording: &mut Recording, buffers: &Buffers) -> Result<(), Error> {
        let [width, height] = buffers.size;
        let pixel_count = width as usize * height as usize;
        let (colors, sites) = (buffers.colors.view(), buffers.pixels.view().cast::<u32>());
        let (state, debris, candidates) = (buffers.a.view(), buffers.b.view(), buffers.c.view());
        let (total, marked) = (buffers.word(Word::Debris)?, buffers.word(Word::Marked)?);
        let count = buffers.word(Word::Candidates)?;
        let (groups, rounds) = (buffers.groups()?, buffers.word(Word::DebrisRounds)?);

        recording.fill(buffers.counts.slice(Word::Debris as usize..buffers.counts.len())?, 0);
        let arguments = MarkDebrisArgs { colors, sites, state, debris, total, marked, width, height };
        recording.dispatch(&self.mark_debris, groups_for(pixel_count, WORKGROUP), &arguments);
        // Each round but the last drops a pixel.
        let bound = pixel_count as u32 + 1;
        recording.repeat("finding debris", marked, bound, BATCH, |round| {
            let arguments =
                AdvanceRoundArgs { counter: marked, groups, zeroed: count, rounds: Some(rounds), items: WORKGROUP };
            round.dispatch(&self.advance_round, [1, 1, 1], &arguments);
            let arguments = DropDebrisArgs { colors, state, debris, total, marked, candidates, count, width, height };
            round.dispatch_indirect(&self.drop_debris, groups, &arguments);
            let arguments = AdvanceRoundArgs { counter: count, groups, zeroed: marked, rounds: None, items: WORKGROUP };
            round.dispatch(&self.advance_round, [1, 1, 1], &arguments);
            let arguments =
                CheckDebrisArgs { colors, sites, state, debris, total, marked, candidates, count, width, height };
            round.dispatch_indirect(&self.check_debris, groups, &arguments);
        });
        buffers.compact_pixels.record(recording, pixel_count, state, None, buffers.debris.view(), total);
        Ok(())
    }

    /// The second half of [`Stage::record_repair`].
    ///
    /// # Errors
    ///
    /// None that its arguments can cause.
    pub fn record_recolor(&self, recording: &mut Recording, buffers: &Buffers) -> Result<(), Error> {
        let [width, height] = buffers.size;
        let (colors, sites) = (buffers.colors.view(), buffers.pixels.view().cast::<u32>());
        let (state, found, debris) = (buffers.a.view(), buffers.b.view(), buffers.debris.view());
        let (count, again) = (buffers.word(Word::Debris)?, buffers.word(Word::Again)?);
        let (groups, rounds) = (buffers.groups()?, buffers.word(Word::RecolorRounds)?);
        recording.copy(count, again);
        // m pixels are settled after m (m + 1) rounds.
        let pixel_count = width * height;
        let bound = pixel_count.saturating_mul(pixel_count.saturating_add(1)).saturating_add(1);
        recording.repeat("recoloring debris", again, bound, BATCH, |round| {
            let arguments =
                AdvanceRoundArgs { counter: again, groups, zeroed: again, rounds: Some(rounds), items: WORKGROUP };
            round.dispatch(&self.advance_round, [1, 1, 1], &arguments);
            let arguments = FindColorArgs { colors, sites, debris, found, count, width, height };
            round.dispatch_indirect(&self.find_color, groups, &arguments);
            let arguments = TakeColorArgs { colors, state, debris, found, count, again, width, height };
            round.dispatch_indirect(&self.take_color, groups, &arguments);
        });
        Ok(())
    }
}
