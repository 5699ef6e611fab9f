//! What is appended to a recording, in order.

use super::buffers::{Buffers, Planned, Word};
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
/// Workgroups of kernels that stride over lists whose lengths the device knows.
const WIDE: [u32; 3] = [256, 1, 1];
/// Invocations of a workgroup of the rows' kernels, which take a row each.
pub(super) const ROWS: u32 = 64;

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
        let limit = count as u32;
        let (pixels, keys, missing) = (buffers.a.view(), buffers.b.view(), buffers.missing.view());
        let (bits, ranks) = (buffers.site_bits.view(), buffers.site_ranks.view());
        let (lost, lost_ranks) = (buffers.lost.view(), buffers.lost_ranks.view());
        let (order, order_pixels) = (buffers.order.view(), buffers.pixels.view().cast::<u32>());
        let (sites, counter) = (buffers.word(Word::Sites)?, buffers.word(Word::Missing)?);
        let groups = groups_for(count, WORKGROUP);

        recording.fill(bits, 0);
        recording.fill(lost, 0);
        recording.fill(order, NONE);
        let [translation_x, translation_y] = mapping.translation();
        let ([exponent_x, exponent_y], [side_x, side_y]) = (mapping.exponents(), mapping.sides());
        let arguments = MapPointsArgs {
            points: points.cast::<u64>(),
            pixels,
            bits,
            translation_x,
            translation_y,
            exponent_x,
            exponent_y,
            side_x,
            side_y,
            width,
            height,
            count: limit,
        };
        recording.dispatch(&self.map_points, groups, &arguments);
        self.record_ranks(recording, buffers, bits, ranks, sites);
        let arguments = ElectSitesArgs { pixels, bits, ranks, order, lost, width, count: limit };
        recording.dispatch(&self.elect_sites, groups, &arguments);
        let arguments = ListSitesArgs { bits, ranks, order_pixels, width, height };
        recording.dispatch(&self.list_sites, groups_for(bits.len(), WORKGROUP), &arguments);

        self.record_ranks(recording, buffers, lost, lost_ranks, counter);
        let arguments = ListMissingArgs { lost, lost_ranks, pixels, bits, ranks, missing, keys, width, count: limit };
        recording.dispatch(&self.list_missing, groups, &arguments);
        let missing_count = Count::on_device(counter, count);
        let most_sites = count.min(width as usize * height as usize) as u32;
        buffers.sort.record(recording, missing_count, keys, Some(missing), 32 - (most_sites - 1).leading_zeros());
        let arguments =
            NumberMissingArgs { pixels, missing, sites, order, order_pixels, counter: Some(counter), limit };
        recording.dispatch(&self.number_missing, groups, &arguments);
        Ok(())
    }

    /// How many bits stand before each word of some, and in all.
    fn record_ranks(
        &self,
        recording: &mut Recording,
        buffers: &Buffers,
        words: View<'_, u32>,
        ranks: View<'_, u32>,
        total: View<'_, u32>,
    ) {
        let arguments = CountBitsArgs { words, counts: ranks, count: words.len() as u32 };
        recording.dispatch(&self.count_bits, groups_for(words.len(), WORKGROUP), &arguments);
        buffers.scan.record(recording, words.len(), ranks, ranks, Some(total));
    }

    /// Colors every pixel by its nearest site, as [`reference::color`](crate::reference::color) does, and marks the first
    /// debris. Reads the bits and ranks of the sites, and their pixels, at least one.
    ///
    /// # Errors
    ///
    /// None that its arguments can cause.
    pub fn record_color(&self, recording: &mut Recording, buffers: &Buffers) -> Result<(), Error> {
        let [width, height] = buffers.size;
        let (bits, ranks, colors) = (buffers.site_bits.view(), buffers.site_ranks.view(), buffers.colors.view());
        let (debris_bits, any_debris) = (buffers.debris_bits()?, buffers.word(Word::AnyDebris)?);
        let (left, left_count, wanted) = (buffers.left.view(), buffers.word(Word::Left)?, buffers.wanted.view());

        recording.fill(buffers.counts.slice(Word::Debris as usize..buffers.counts.len())?, 0);
        recording.fill(buffers.debris_bits.view(), 0);
        recording.fill(wanted, 0);
        let arguments =
            ColorTilesArgs { bits, ranks, colors, debris_bits, any_debris, left, left_count, wanted, width, height };
        recording.dispatch(&self.color_tiles, groups_for(left.len(), 1), &arguments);
        self.record_bands(recording, buffers)?;
        let sites = buffers.pixels.view().cast::<u32>();
        let arguments = MarkDebrisArgs { colors, sites, left, left_count, debris_bits, any_debris, width, height };
        recording.dispatch_indirect(&self.mark_debris, buffers.groups(Planned::Tiles)?, &arguments);
        Ok(())
    }

    /// Colors the tiles that are left.
    fn record_bands(&self, recording: &mut Recording, buffers: &Buffers) -> Result<(), Error> {
        let [width, height] = buffers.size;
        let (bits, ranks, colors) = (buffers.site_bits.view(), buffers.site_ranks.view(), buffers.colors.view());
        let (left, left_count, wanted) = (buffers.left.view(), buffers.word(Word::Left)?, buffers.wanted.view());
        let (nearest, entries) = (buffers.a.view(), buffers.b.view());
        let (ends, live, starts) = (buffers.ends.view(), buffers.live.view(), buffers.starts.view());
        let (rows, columns) = (self.tuning.rows, self.tuning.columns);
        let (bands, stacks) = (height.div_ceil(rows), width.div_ceil(columns));
        // Merged in two turns of about as many bands each.
        let group = stacks.isqrt().max(1);
        let fills = width.div_ceil(2) as usize * bands as usize;
        let arguments = PlanBandsArgs {
            left_count,
            groups: buffers.all_groups()?,
            column_groups: ends.len().div_ceil(WORKGROUP as usize) as u32,
            fill_groups: fills.div_ceil(WORKGROUP as usize) as u32,
            stack_groups: height.div_ceil(self.tuning.row_lanes) * stacks,
            merge_groups: (height as usize * stacks.div_ceil(group) as usize).div_ceil(ROWS as usize) as u32,
            row_groups: height.div_ceil(ROWS),
        };
        recording.dispatch(&self.plan_bands, [1, 1, 1], &arguments);
        let arguments = ColumnEndsArgs { bits, ends, width, height, band: rows };
        recording.dispatch_indirect(&self.column_ends, buffers.groups(Planned::ColumnEnds)?, &arguments);
        let arguments = ColumnFillArgs { bits, ends, wanted, nearest, width, height, band: rows };
        recording.dispatch_indirect(&self.column_fill, buffers.groups(Planned::ColumnFill)?, &arguments);
        let arguments = RowStacksArgs { nearest, wanted, entries, live, width, height };
        recording.dispatch_indirect(&self.row_stacks, buffers.groups(Planned::RowStacks)?, &arguments);
        let (unit, band) = (1, columns);
        let arguments = RowMergeArgs { nearest, wanted, entries, live, starts, width, height, band, unit, group };
        if group < stacks {
            recording.dispatch_indirect(&self.row_merge, buffers.groups(Planned::MergeGroups)?, &arguments);
        }
        let unit = if group < stacks { group } else { 1 };
        let arguments = RowMergeArgs { unit, group: stacks, ..arguments };
        recording.dispatch_indirect(&self.row_merge, buffers.groups(Planned::MergeRows)?, &arguments);
        let arguments = ColorPixelsArgs {
            bits,
            ranks,
            nearest,
            entries,
            live,
            starts,
            left,
            left_count,
            colors,
            width,
            height,
            band: columns,
        };
        recording.dispatch_indirect(&self.color_pixels, buffers.groups(Planned::Tiles)?, &arguments);
        Ok(())
    }

    /// Finds the rest of the debris and recolors it, as [`reference::debris`](crate::reference::debris) and
    /// [`reference::recolor`](crate::reference::recolor) do. Follows [`Stage::record_color`].
    ///
    /// # Errors
    ///
    /// None that its arguments can cause.
    pub fn record_repair(&self, recording: &mut Recording, buffers: &Buffers) -> Result<(), Error> {
        let [width, height] = buffers.size;
        let (count, unfinished) = (buffers.word(Word::Debris)?, buffers.word(Word::Unfinished)?);
        let (colors, sites) = (buffers.colors.view(), buffers.pixels.view().cast::<u32>());
        let (list, other_list, debris_bits) = (buffers.a.view(), buffers.b.view(), buffers.debris_bits()?);
        let (listed_bits, other_bits) = (buffers.bits_of_debris(1)?, buffers.bits_of_debris(2)?);
        let any_debris = buffers.word(Word::AnyDebris)?;
        let words = debris_bits.len() as u32;
        let marked = buffers.word(Word::Progress)?;
        let arguments = ListDebrisArgs { any_debris, debris_bits, colors, list, count: marked, words };
        recording.dispatch(&self.list_debris, groups_for(words as usize, WORKGROUP), &arguments);
        // Most work is in the first turns, which all workgroups share.
        for turn in 1..=3 {
            let counts = buffers.progress()?;
            let arguments = SpreadDebrisArgs { colors, sites, list, debris_bits, counts, turn, width, height };
            recording.dispatch(&self.spread_debris, WIDE, &arguments);
        }
        let arguments = RepairArgs {
            colors,
            sites,
            list,
            other_list,
            debris_bits,
            listed_bits,
            other_bits,
            progress: buffers.progress()?,
            progressed: buffers.progress()?,
            count,
            unfinished,
            width,
            height,
            recolors: 0,
        };
        recording.dispatch(&self.repair, [1, 1, 1], &arguments);
        let (phase, once, twice) =
            (buffers.word(Word::Phase)?, buffers.word(Word::ListedOnce)?, buffers.word(Word::Listed)?);
        let turn = RecolorDebrisArgs {
            colors,
            sites,
            list,
            count,
            next_list: other_list,
            next_count: once,
            debris_bits,
            listed_bits,
            next_bits: other_bits,
            phase,
            width,
            height,
        };
        recording.dispatch(&self.recolor_debris, WIDE, &turn);
        let turn = RecolorDebrisArgs {
            list: other_list,
            count: once,
            next_list: list,
            next_count: twice,
            listed_bits: other_bits,
            next_bits: listed_bits,
            ..turn
        };
        recording.dispatch(&self.recolor_debris, WIDE, &turn);
        // Each round that finds debris finds a pixel; m pixels are settled after m (m + 1) rounds.
        let pixel_count = width * height;
        let bound = pixel_count.saturating_mul(pixel_count.saturating_add(2)).saturating_add(1);
        let arguments = RepairArgs { recolors: 1, ..arguments };
        recording.repeat_ahead("repairing debris", unfinished, bound, 1, 1, |round| {
            round.dispatch(&self.repair, [1, 1, 1], &arguments);
        });
        Ok(())
    }
}
