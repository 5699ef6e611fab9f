//! Stages 2 to 4: dualize the digital Voronoi diagram, shift its sites, insert missing points
#![forbid(unsafe_code)]
