//! Points that all lie on one line have no triangle, but duplicates among them are still told.
//!
//! Two different points of a line differ in x, or, on a vertical line, in y. So that coordinate alone sorts them, and equal
//! ones stay in the order of their indices.
//!
//! A constraint among them runs through all vertices between its ends.

use glam::DVec2;

/// By what points on a line differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// On a line that is not vertical.
    X = 0,
    /// On a vertical line.
    Y = 1,
}

/// For each point the lowest index of the points equal to it; and how many different ones there are.
pub fn line(points: &[DVec2], axis: Axis) -> (Vec<u32>, u32) {
    let (keys, mut values) = line_keys(points, axis);
    values.sort_by_key(|&i| keys[i as usize]);
    let sorted: Vec<u64> = values.iter().map(|&i| keys[i as usize]).collect();
    let flags = line_heads(&sorted);
    let mut heads = Vec::new();
    let mut ranks = Vec::new();
    for (&flag, &value) in flags.iter().zip(&values) {
        ranks.push(heads.len() as u32);
        heads.extend((flag == 1).then_some(value));
    }
    (line_names(&values, &flags, &ranks, &heads), heads.len() as u32)
}

/// An integer for each coordinate, in the order of the numbers, -0.0 as 0.0; and the indices.
pub fn line_keys(points: &[DVec2], axis: Axis) -> (Vec<u64>, Vec<u32>) {
    let key = |p: &DVec2| {
        let bits = (p[axis as usize] + 0.0).to_bits();
        if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
    };
    (points.iter().map(key).collect(), (0..points.len() as u32).collect())
}

/// A one for each sorted key that differs from the one before.
pub fn line_heads(keys: &[u64]) -> Vec<u32> {
    (0..keys.len()).map(|p| u32::from(p == 0 || keys[p] != keys[p - 1])).collect()
}

/// The representative of each point: the first of its run of equal keys.
pub fn line_names(values: &[u32], flags: &[u32], ranks: &[u32], heads: &[u32]) -> Vec<u32> {
    let mut representatives = vec![0; values.len()];
    for p in 0..values.len() {
        representatives[values[p] as usize] = heads[(ranks[p] + flags[p] - 1) as usize];
    }
    representatives
}

/// For each point how many different points lie before it on the line.
pub fn line_places(values: &[u32], flags: &[u32], ranks: &[u32]) -> Vec<u32> {
    let mut places = vec![0; values.len()];
    for p in 0..values.len() {
        places[values[p] as usize] = ranks[p] + flags[p] - 1;
    }
    places
}

/// How many vertices each constraint runs through, its ends included; the sum; how many run through more than two.
pub fn line_lengths(ends: &[[u32; 2]], places: &[u32]) -> (Vec<u32>, u64, u32) {
    let length = |[a, b]: &[u32; 2]| places[*a as usize].abs_diff(places[*b as usize]) + 1;
    let lengths: Vec<u32> = ends.iter().map(length).collect();
    let through = lengths.iter().filter(|&&length| length > 2).count() as u32;
    let sum = lengths.iter().map(|&length| u64::from(length)).sum();
    (lengths, sum, through)
}

/// The vertices along each constraint, one chain behind the other. `heads` are the vertices along the line.
pub fn line_chains(ends: &[[u32; 2]], places: &[u32], heads: &[u32]) -> Vec<u32> {
    let mut chains = Vec::new();
    for ends in ends {
        let [from, to] = ends.map(|v| places[v as usize] as usize);
        if from <= to {
            chains.extend_from_slice(&heads[from..=to]);
        } else {
            chains.extend(heads[to..=from].iter().rev());
        }
    }
    chains
}
