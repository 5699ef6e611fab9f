//! The constrained Delaunay triangulation: exact, canonical, fast
#![forbid(unsafe_code)]
