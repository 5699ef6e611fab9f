//! Generators of inputs: random, structured and degenerate.
//!
//! Each is a pure function of its arguments, bit for bit the same on every platform: integers from a PCG generator,
//! and no floating-point operation beyond `+ - * / sqrt`. A seed means the same input for ever; a family is renamed
//! rather than changed.
//!
//! | function | what it gives |
//! |---|---|
//! | [`uniform`], [`gaussian`], [`clusters`], [`exponential`] | random points, more and more uneven |
//! | [`circle`], [`concentric`], [`thin_ring`], [`cocircular`] | round ones, the last exactly so |
//! | [`lattice`], [`crowd`] | integer points with ties and duplicates everywhere |
//! | [`collinear`], [`near_collinear`], [`noisy_line`] | on a line, or all but |
//! | [`huge`], [`tiny`], [`subnormal`], [`mixed_magnitudes`] | the far ends of f64 |
//! | [`segments`] | long and short constraints that do not cross, then points on none of them |
//! | [`crossing_segments`] | constraints that cross as they please |
//! | [`spiral`], [`comb`], [`fan`], [`through_vertices`], [`nested_rings`] | constraints by construction |
//!
//! # Panics
//!
//! All of them panic beyond [`Pslg::MAX_POINTS`] points; callers that take sizes from a user check them first.

mod constrained;
mod points;
mod random;
mod round;
mod segments;

pub use constrained::{comb, fan, nested_rings, spiral, through_vertices};
pub use points::{
    clusters, collinear, crowd, exponential, gaussian, huge, lattice, mixed_magnitudes, near_collinear, noisy_line,
    subnormal, tiny, uniform,
};
pub use round::{circle, cocircular, concentric, thin_ring};
pub use segments::{crossing_segments, segments};

use glam::DVec2;
use polder_mesh::{Constraint, Pslg};

fn pslg(points: Vec<DVec2>, constraints: Vec<Constraint>) -> Pslg {
    Pslg::new(points, constraints).expect("generators make finite coordinates and indices in range")
}
