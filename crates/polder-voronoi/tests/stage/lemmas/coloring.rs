//! Lemmas of [CET] 3.1 that speak of pixels.

use super::Case;
use crate::cases::{neighbors, pixels};
use polder_voronoi::Key;
use std::collections::BTreeSet;

/// Ordered Coloring Lemma: at every step, each colored pixel paired with its color comes before each uncolored pixel
/// paired with a color that it is eligible for. (And, by the definition of flooding, a pixel is eligible for the color
/// that it gets.)
pub(crate) fn ordered_coloring(case: &Case) -> Result<(), String> {
    let size = case.sites.size;
    let mut is_colored = vec![false; case.diagram.colors.len()];
    let mut eligible: BTreeSet<Key> =
        (0..case.sites.count as u32).map(|i| Key::of(case.site(i), case.site(i))).collect();
    let mut last_colored: Option<Key> = None;
    for &index in &case.colored {
        let pixel = case.diagram.pixel(index as usize);
        let key = case.key(pixel);
        if !eligible.contains(&key) {
            return Err(format!("pixel {pixel:?} got a color that it was not eligible for"));
        }
        is_colored[index as usize] = true;
        eligible.remove(&key);
        for neighbor in neighbors(size, pixel) {
            let place = case.diagram.index(neighbor);
            if is_colored[place] {
                eligible.remove(&Key::of(pixel, case.site(case.diagram.color(neighbor))));
            } else {
                eligible.insert(Key::of(neighbor, case.site(case.diagram.color(pixel))));
            }
        }
        last_colored = last_colored.max(Some(key));
        if eligible.first().copied().is_some_and(|first| Some(first) <= last_colored) {
            return Err(format!("after pixel {pixel:?} an uncolored pixel comes before a colored one"));
        }
    }
    if is_colored.contains(&false) { Err("a pixel was never colored".into()) } else { Ok(()) }
}

/// Monotonic Path Lemma: from the site to each pixel of its color there is a path of that color with distances that do
/// not decrease. It is there if every pixel but the site's own has a predecessor, since keys fall along predecessors.
pub(crate) fn monotonic_path(case: &Case) -> Result<(), String> {
    for pixel in pixels(case.sites.size) {
        let site = case.site(case.diagram.color(pixel));
        if pixel != site && case.predecessors(pixel).is_empty() {
            return Err(format!("no path leads from site {site:?} to pixel {pixel:?}"));
        }
    }
    Ok(())
}

/// One Neck Lemma: no square of four pixels has two necks.
pub(crate) fn one_neck(case: &Case) -> Result<(), String> {
    let color = |pixel| case.diagram.color(pixel);
    for [x, y] in pixels(case.sites.size.map(|side| side - 1)) {
        let [a, b, u, v] = [color([x, y]), color([x + 1, y + 1]), color([x + 1, y]), color([x, y + 1])];
        if a == b && u == v && a != u {
            return Err(format!("two necks cross at the upper right corner of pixel {:?}", [x, y]));
        }
    }
    Ok(())
}
