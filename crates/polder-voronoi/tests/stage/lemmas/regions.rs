//! Lemmas of [CET] that speak of whole regions.

use super::Case;
use crate::cases::{pixels, without};
use crate::flooding::cut_off;
use polder_voronoi::reference;

/// Bulk Lemma: what of the Euclidean coloring is connected with its site keeps its color under flooding.
pub(crate) fn bulk(case: &Case) -> Result<(), String> {
    let euclidean = reference::color(&case.sites).unwrap();
    let debris = cut_off(&euclidean, &case.sites);
    for (index, (before, after)) in euclidean.colors.iter().zip(&case.diagram.colors).enumerate() {
        if before != after && debris.binary_search(&(index as u32)).is_err() {
            return Err(format!("bulk pixel {:?} has another color", case.diagram.pixel(index)));
        }
    }
    Ok(())
}

/// Simple Connectedness Lemma: regions are connected and have no holes. Pixels of a region connect at sides and
/// corners; what surrounds it connects at sides only, and with the outside of the grid.
pub(crate) fn simple_connectedness(case: &Case) -> Result<(), String> {
    if let Some(&index) = cut_off(&case.diagram, &case.sites).first() {
        return Err(format!("pixel {:?} is not connected with its site", case.diagram.pixel(index as usize)));
    }
    let (width, height) = (case.sites.size[0] as usize, case.sites.size[1] as usize);
    // A frame of one pixel stands for the outside.
    let framed = |x: usize, y: usize| y * (width + 2) + x;
    for region in 0..case.sites.count as u32 {
        let mut reached = vec![false; (width + 2) * (height + 2)];
        for pixel in pixels(case.sites.size).filter(|&pixel| case.diagram.color(pixel) == region) {
            reached[framed(usize::from(pixel[0]) + 1, usize::from(pixel[1]) + 1)] = true;
        }
        let mut stack = vec![(0_usize, 0_usize)];
        reached[framed(0, 0)] = true;
        while let Some((x, y)) = stack.pop() {
            let sides = [(x.wrapping_sub(1), y), (x + 1, y), (x, y.wrapping_sub(1)), (x, y + 1)];
            for (x, y) in sides.into_iter().filter(|&(x, y)| x < width + 2 && y < height + 2) {
                if !std::mem::replace(&mut reached[framed(x, y)], true) {
                    stack.push((x, y));
                }
            }
        }
        if let Some(hole) = reached.iter().position(|&reached| !reached) {
            let (x, y) = (hole % (width + 2) - 1, hole / (width + 2) - 1);
            return Err(format!("region {region} has a hole at pixel {:?}", [x, y]));
        }
    }
    Ok(())
}

/// The remark after the Bulk Lemma: without one of the sites, the others' regions keep every pixel that is not debris.
pub(crate) fn deleting_a_seed(case: &Case) -> Result<(), String> {
    let removals = if case.sites.count < 2 { 0 } else { case.sites.count.min(12) };
    for removed in 0..removals {
        shrinks_by_debris_alone(case, &Case::new(without(&case.sites, removed)), removed as u32)?;
    }
    Ok(())
}

/// Whether `after`, the case without site `removed`, differs as it may. Tells how many pixels left a region that stays.
pub(crate) fn shrinks_by_debris_alone(before: &Case, after: &Case, removed: u32) -> Result<usize, String> {
    let debris = cut_off(&reference::color(&before.sites).unwrap(), &before.sites);
    let mut lost = 0;
    for (index, (&old, &new)) in before.diagram.colors.iter().zip(&after.diagram.colors).enumerate() {
        let new = new + u32::from(new >= removed);
        if old == removed || old == new {
            continue;
        }
        lost += 1;
        if debris.binary_search(&(index as u32)).is_err() {
            return Err(format!("region {old} lost pixel {:?}, no debris", before.diagram.pixel(index)));
        }
    }
    Ok(lost)
}

/// The remark is about something: regions do shrink.
#[test]
fn deleting_a_seed_does_shrink_regions_somewhere() {
    let lost: usize = (0..40)
        .flat_map(|seed| {
            let case = Case::new(crate::cases::sites(crate::cases::Family::Circle, 80, seed));
            let removals = 0..case.sites.count.min(6);
            removals.map(move |removed| {
                let after = Case::new(without(&case.sites, removed));
                shrinks_by_debris_alone(&case, &after, removed as u32).unwrap()
            })
        })
        .sum();
    assert!(lost > 0);
}
