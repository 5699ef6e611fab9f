//! Stage 5: flips to the constrained Delaunay triangulation
#![forbid(unsafe_code)]
