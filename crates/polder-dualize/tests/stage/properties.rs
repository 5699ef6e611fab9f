//! What [CET] proves of the digital Delaunay triangulation, as checks of bare triangles, and a dualization that does
//! nothing clever.

use polder_mesh::{GHOST, GhostMesh};
use polder_voronoi::{Diagram, Sites};
use std::collections::{BTreeMap, BTreeSet};

/// A site's pixel in integers.
pub(crate) type Pixel = [i64; 2];

pub(crate) fn pixels(sites: &Sites) -> Vec<Pixel> {
    sites.pixels[..sites.count].iter().map(|p| p.map(i64::from)).collect()
}

pub(crate) fn orient([ax, ay]: Pixel, [bx, by]: Pixel, [cx, cy]: Pixel) -> i64 {
    ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)).signum()
}

/// The multiset of triangles, straight from the definition: of every corner inside the grid with four colors two
/// triangles, with three one, unless it is a neck; or necks too, as one who forgets them would have it.
pub(crate) fn triangles(diagram: &Diagram, necks_too: bool) -> Vec<[u32; 3]> {
    let mut out = Vec::new();
    for y in 1..diagram.height as u16 {
        for x in 1..diagram.width as u16 {
            let c = [[x - 1, y - 1], [x, y - 1], [x, y], [x - 1, y]].map(|p| diagram.color(p));
            let mut ring = c.to_vec();
            ring.dedup();
            if ring.len() > 1 && ring.first() == ring.last() {
                ring.pop();
            }
            match ring[..] {
                [i, j, k] => out.push([i, j, k]),
                [i, j, k, l] if i != k && j != l => out.extend([[i, j, k], [i, k, l]]),
                [i, j, k, l] if necks_too && (i != k || j != l) => out.push(if i == k { [i, j, l] } else { [i, j, k] }),
                _ => {}
            }
        }
    }
    out
}

/// Each edge of each triangle once.
fn edges(triangles: &[[u32; 3]]) -> BTreeSet<[u32; 2]> {
    let ends = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]].map(|[u, w]| [u.min(w), u.max(w)]);
    triangles.iter().flat_map(ends).collect()
}

/// No two edges cross: the ends of each on opposite sides of the other.
pub(crate) fn no_crossing(triangles: &[[u32; 3]], at: &[Pixel]) -> Result<(), String> {
    let edges: Vec<_> = edges(triangles).into_iter().collect();
    let side = |[u, w]: [u32; 2], v: u32| orient(at[u as usize], at[w as usize], at[v as usize]);
    for (i, &e) in edges.iter().enumerate() {
        for &f in &edges[..i] {
            if side(e, f[0]) * side(e, f[1]) < 0 && side(f, e[0]) * side(f, e[1]) < 0 {
                return Err(format!("edges {e:?} and {f:?} cross"));
            }
        }
    }
    Ok(())
}

/// Each triangle is counterclockwise, as its pixels lie around the corner.
pub(crate) fn consistent_orientation(triangles: &[[u32; 3]], at: &[Pixel]) -> Result<(), String> {
    let bad = |t: &&[u32; 3]| {
        let [a, b, c] = t.map(|v| at[v as usize]);
        orient(a, b, c) <= 0
    };
    triangles.iter().find(bad).map_or(Ok(()), |t| Err(format!("triangle {t:?} is not counterclockwise")))
}

/// No two triangles are the same, and none contains another.
pub(crate) fn no_nesting(triangles: &[[u32; 3]], at: &[Pixel]) -> Result<(), String> {
    let contains = |t: [u32; 3], v: u32| {
        let [a, b, c] = t.map(|v| at[v as usize]);
        let p = at[v as usize];
        let signs = [orient(a, b, p), orient(b, c, p), orient(c, a, p)];
        orient(a, b, c) != 0 && signs.iter().all(|&s| s * orient(a, b, c) >= 0)
    };
    for (i, &t) in triangles.iter().enumerate() {
        for (j, &u) in triangles.iter().enumerate() {
            if i != j && u.iter().all(|&v| contains(t, v)) {
                return Err(format!("triangle {t:?} contains {u:?}"));
            }
        }
    }
    Ok(())
}

/// Condition I: the vertices are the sites and the ghost.
pub(crate) fn condition_1(mesh: &GhostMesh, sites: usize) -> Result<(), String> {
    let seen: BTreeSet<u32> = mesh.triangles.iter().flatten().copied().collect();
    let wanted: BTreeSet<u32> = (0..sites as u32).chain([GHOST]).collect();
    if seen == wanted { Ok(()) } else { Err(format!("vertices {seen:?} for {sites} sites")) }
}

/// Condition II: a simplicial complex that triangulates the sphere. Every edge, as a pair of vertices, has two
/// triangles; the triangles around each vertex form one ring; and Euler's count is two. Links do not enter.
pub(crate) fn condition_2(triangles: &[[u32; 3]]) -> Result<(), String> {
    let mut across: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    let mut following: BTreeMap<u32, BTreeMap<u32, u32>> = BTreeMap::new();
    for &[a, b, c] in triangles {
        for [u, v, w] in [[a, b, c], [b, c, a], [c, a, b]] {
            *across.entry([u.min(v), u.max(v)]).or_default() += 1;
            if following.entry(u).or_default().insert(v, w).is_some() {
                return Err(format!("two triangles left of the edge from {u} to {v}"));
            }
        }
    }
    if let Some((edge, n)) = across.iter().find(|&(_, &n)| n != 2) {
        return Err(format!("edge {edge:?} has {n} triangles"));
    }
    for (v, ring) in &following {
        let start = *ring.keys().next().unwrap();
        let mut at = start;
        for step in 1..=ring.len() {
            at = *ring.get(&at).ok_or_else(|| format!("the triangles around {v} do not close up"))?;
            if (at == start) != (step == ring.len()) {
                return Err(format!("the triangles around {v} form more than one ring"));
            }
        }
    }
    let euler = following.len() as i64 - across.len() as i64 + triangles.len() as i64;
    if euler == 2 { Ok(()) } else { Err(format!("Euler's count is {euler}")) }
}

/// Condition III: without the ghost, a geometric realization: counterclockwise triangles, edges that do not cross,
/// no vertex inside an edge or a triangle, and together the area of the convex hull.
pub(crate) fn condition_3(finite: &[[u32; 3]], at: &[Pixel]) -> Result<(), String> {
    consistent_orientation(finite, at)?;
    no_crossing(finite, at)?;
    no_nesting(finite, at)?;
    for t in finite {
        let [a, b, c] = t.map(|v| at[v as usize]);
        for (v, &p) in at.iter().enumerate().filter(|(v, _)| !t.contains(&(*v as u32))) {
            if orient(a, b, p) >= 0 && orient(b, c, p) >= 0 && orient(c, a, p) >= 0 {
                return Err(format!("vertex {v} lies in triangle {t:?}"));
            }
        }
    }
    let twice = |a: Pixel, b: Pixel, c: Pixel| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let covered: i64 = finite.iter().map(|t| t.map(|v| at[v as usize])).map(|[a, b, c]| twice(a, b, c)).sum();
    let hull = hull(at);
    let wanted: i64 = hull.windows(2).map(|pair| twice(hull[0], pair[0], pair[1])).sum();
    if covered == wanted { Ok(()) } else { Err(format!("twice the area is {covered}, of the hull {wanted}")) }
}

/// The corners of the convex hull, counterclockwise.
fn hull(at: &[Pixel]) -> Vec<Pixel> {
    let mut sorted = at.to_vec();
    sorted.sort_unstable();
    let half = |points: &mut dyn Iterator<Item = &Pixel>| {
        let mut chain: Vec<Pixel> = Vec::new();
        for &p in points {
            while chain.len() > 1 && orient(chain[chain.len() - 2], chain[chain.len() - 1], p) <= 0 {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut out = half(&mut sorted.iter());
    out.extend(half(&mut sorted.iter().rev()));
    out
}

/// The finite triangles of a mesh.
pub(crate) fn finite(mesh: &GhostMesh) -> Vec<[u32; 3]> {
    mesh.finite().map(|t| mesh.triangles[t]).collect()
}
