//! Finding debris: what a Euclidean coloring cuts off from its site (\[CET\] section 2).
//!
//! A pixel is debris if no chain of pixels of its color, neighbor to neighbor and each closer to the site in the order
//! of [`Key`], leads to the site. In rounds:
//!
//! 1. Mark every pixel, sites apart, that has no closer neighbor of its own color.
//! 2. Drop the marked pixels: they lose their color.
//! 3. Repeat until none is marked. From the second round on only neighbors of dropped pixels are looked at.
//!
//! Departure: \[CET\] defines debris as what is not in the site's component, and \[QCT\] finds it on the CPU. In a
//! Euclidean coloring the two are the same, by the proof of \[CET\]'s Bulk Lemma; the rounds need no components.

use crate::order::{Key, neighbors};
use crate::{Diagram, Sites, UNCOLORED, VoronoiError};

/// Takes the color from all debris of a Euclidean coloring and lists it in [`Diagram::debris`]. Returns the number of
/// rounds, the last one of which finds nothing.
///
/// # Errors
///
/// Those of [`Sites::check`] and [`Diagram::check`], and if the diagram has uncolored pixels already.
/// [`VoronoiError::BoundExceeded`] never, unless this crate has a bug: each round but the last drops a pixel.
pub fn debris(diagram: &mut Diagram, sites: &Sites) -> Result<u64, VoronoiError> {
    sites.check()?;
    diagram.check(sites)?;
    if let Some(index) = diagram.colors.iter().position(|&color| color == UNCOLORED) {
        return Err(VoronoiError::Mismatch { what: "a pixel without a color", index });
    }
    let mut marked: Vec<u32> = Vec::new();
    for index in 0..diagram.colors.len() {
        if !has_closer(diagram, sites, index) {
            marked.push(index as u32);
        }
    }
    let mut all: Vec<u32> = Vec::new();
    let bound = diagram.colors.len() as u64 + 1;
    for round in 1..=bound {
        if marked.is_empty() {
            all.sort_unstable();
            diagram.debris = all;
            return Ok(round);
        }
        let mut candidates: Vec<u32> = Vec::new();
        for &index in &marked {
            let pixel = diagram.pixel(index as usize);
            let color = diagram.colors[index as usize];
            let same = neighbors(diagram, pixel).map(|p| diagram.index(p)).filter(|&i| diagram.colors[i] == color);
            candidates.extend(same.map(|index| index as u32));
        }
        for &index in &marked {
            diagram.colors[index as usize] = UNCOLORED;
        }
        all.append(&mut marked);
        candidates.sort_unstable();
        candidates.dedup();
        candidates.retain(|&index| {
            diagram.colors[index as usize] != UNCOLORED && !has_closer(diagram, sites, index as usize)
        });
        marked = candidates;
    }
    Err(VoronoiError::BoundExceeded { step: "finding debris", bound })
}

/// Whether a colored pixel is its site's own or has a neighbor of its color that is closer to the site.
pub(super) fn has_closer(diagram: &Diagram, sites: &Sites, index: usize) -> bool {
    let color = diagram.colors[index];
    let pixel = diagram.pixel(index);
    let site = sites.pixels[color as usize];
    // Straight or diagonally toward the site: always closer, and nearly always of the same color.
    let step = |from: u16, to: u16| match from.cmp(&to) {
        std::cmp::Ordering::Less => from + 1,
        std::cmp::Ordering::Equal => from,
        std::cmp::Ordering::Greater => from - 1,
    };
    let toward = [step(pixel[0], site[0]), step(pixel[1], site[1])];
    if diagram.color(toward) == color {
        return true;
    }
    let key = Key::of(pixel, site);
    neighbors(diagram, pixel).any(|p| diagram.color(p) == color && Key::of(p, site) < key)
}
