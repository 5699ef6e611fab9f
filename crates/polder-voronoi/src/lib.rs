//! Stage 1: the digital Voronoi diagram of a point set
#![forbid(unsafe_code)]
