//! The numbers by which insertion proceeds, and what they were chosen by.

use super::keys::OWNER_BITS;

/// Inner rounds to an outer one.
///
/// Of 100,000 constraints of all lengths among 1,000,000 points (the triangulation of stage 4, 726,223 intersections):
///
/// | inner rounds at most | outer rounds | inner rounds, all | triangles walked | flips |
/// |---|---|---|---|---|
/// | 1 | 35 | 35 | 1,032,473 | 695,154 |
/// | 3 | 12 | 35 | 845,984 | 695,417 |
/// | 5 | 7 | 35 | 814,490 | 695,783 |
/// | 8 | 5 | 39 | 800,761 | 696,036 |
/// | 12 | 5 | 51 | 795,858 | 696,178 |
/// | no limit | 4 | 90 | 794,357 | 696,205 |
///
/// An outer round walks, which is the part that is hard to divide among threads: 8 has nearly the fewest of them, and
/// nearly the fewest rounds in all. On one thread 2 to 8 take the same time.
///
/// Where chains are long, they are so many times more: by one for each [`LONG_CHAIN`] triangles that the walks of the outer
/// round crossed on average, or by one for each [`USUAL_ROUNDS`] outer rounds before, up to [`MOST_TIMES`]. Of 40,000
/// constraints from one vertex 8 rounds at most took 103 outer rounds, 813 inner ones and 10,137,780 triangles; no limit 28,
/// 2,888 and 2,773,847; and this rule 45, 966 and 4,452,518.
pub const INNER_ROUNDS: u32 = 8;
/// See [`INNER_ROUNDS`].
pub const LONG_CHAIN: u64 = 64;
/// See [`INNER_ROUNDS`].
pub const MOST_TIMES: u32 = 8;
/// See [`INNER_ROUNDS`].
pub const USUAL_ROUNDS: u64 = 8;

/// Chains of at most so many triangles are rebuilt.
///
/// Of 100,000 constraints of all lengths among 1,000,000 points, as above but for rounds of insertion that have changed since
/// (731,245 intersections):
///
/// | longest rebuilt | rebuilt | flips | outer rounds | inner rounds, all | triangles walked | flips after |
/// |---|---|---|---|---|---|---|
/// | none | 0 | 705,437 | 4 | 38 | 809,949 | 428,677 |
/// | 14 | 79,547 | 314,191 | 5 | 39 | 841,838 | 458,568 |
/// | 30 | 86,384 | 167,094 | 5 | 43 | 874,961 | 473,149 |
/// | 62 | 88,032 | 84,389 | 6 | 43 | 905,958 | 481,084 |
/// | 126 | 88,404 | 45,142 | 6 | 43 | 925,476 | 484,957 |
/// | any | 88,545 | 0 | 6 | 0 | 962,352 | 488,960 |
///
/// One thread rebuilds a chain, so that none may be long: six of a million constraints have more than 2,000.
pub const LONGEST_REBUILT: u32 = 62;
/// And only if so many sub-constraints are no edges before the first flip. On a GPU fewer keep few threads busy: then rounds of
/// flips, each of them short, end sooner than the longest chain. On an NVIDIA H200 insertion took 3.0 ms by flips alone and
/// 3.7 ms so with 100,000 constraints of all lengths among a million points, 17.1 and 12.0 with ten times as many of both, and
/// 4.2 and 2.2 with 500,000 short ones among ten million points.
pub const LEAST_REBUILT: u32 = 250_000;

/// A vertex where so many sub-constraints end is a *hub*, if they are no edges before the first flip,
pub const HUB: u32 = 16;
/// and it has no more edges than these then: else they hardly meet, and to find where they leave it would take long.
pub const MOST_SPOKES: u32 = 256;

/// A first walk from a hub claims no more triangles than these, later ones more and more. Chains are longest when few can be
/// inserted, and what these few flip shortens all others: to walk a part at first takes no more rounds. Of 100,000 constraints
/// from one vertex the longest walks of all rounds crossed 14,400 triangles together, without this rule 25,642.
pub const HUB_WALK: u32 = 128;

/// Triangles that a walk from a hub claims at most, when it has walked so often before.
pub(super) fn hub_walk(walks: u32) -> u64 {
    (u64::from(HUB_WALK) * (4 + u64::from(walks)) / 4) << (walks / 16).min(20)
}

/// So many sub-constraints can be told apart in the word of a triangle.
pub const MOST_SUB_CONSTRAINTS: usize = 1 << OWNER_BITS;
