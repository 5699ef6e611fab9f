//! Recoloring debris, so that the diagram becomes that of flooding: [QCT] Appendix A.
//!
//! The *candidates* of an uncolored pixel A are the colors i of its colored neighbors B with (B, i) before (A, i) in
//! the order of [`Key`]; the best one is that with the smallest (A, i). In rounds ([`recolor`]):
//!
//! 1. Every uncolored pixel finds its best candidate.
//! 2. A pixel whose best candidate comes before those of all its uncolored neighbors takes that color.
//! 3. Repeat over the pixels that are left, until none is.
//!
//! Departure: [QCT]'s Algorithm A.1 takes the pixels from one priority queue; it stands here as [`recolor_by_queue`].
//! The rounds give the same colors: the queue colors pixels in ascending order, so what a pixel can still be offered
//! comes after what its neighbors take; a pixel that is a minimum among its neighbors has nothing better to wait for.

use crate::order::{Key, neighbors};
use crate::{Diagram, Sites, UNCOLORED, VoronoiError};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Colors the pixels listed in [`Diagram::debris`] in rounds. Returns the number of rounds.
///
/// # Errors
///
/// Those of [`Sites::check`] and [`Diagram::check`], and a [`VoronoiError::Mismatch`] if there are pixels that no color
/// reaches, which cannot happen after [`crate::reference::debris`].
pub fn recolor(diagram: &mut Diagram, sites: &Sites) -> Result<u64, VoronoiError> {
    sites.check()?;
    diagram.check(sites)?;
    let mut left = diagram.debris.clone();
    left.retain(|&index| diagram.colors[index as usize] == UNCOLORED);
    let bound = left.len() as u64;
    // The best candidate of each pixel of `left`; others are never asked for.
    let mut best = vec![(Key::MAX, UNCOLORED); left.len()];
    let mut slot = Slots::new(&left);
    for round in 0..=bound {
        if left.is_empty() {
            return Ok(round);
        }
        for (best, &index) in best.iter_mut().zip(&left) {
            *best = best_candidate(diagram, sites, index as usize);
        }
        let wins = |(place, &index): (usize, &u32)| {
            let own = best[place].0;
            let pixel = diagram.pixel(index as usize);
            let mut rivals = neighbors(diagram, pixel).filter_map(|p| slot.of(diagram.index(p) as u32));
            own < Key::MAX && rivals.all(|rival| own < best[rival].0)
        };
        let winners: Vec<usize> =
            left.iter().enumerate().filter(|&entry| wins(entry)).map(|(place, _)| place).collect();
        if winners.is_empty() {
            return Err(unreached(left[0]));
        }
        for &place in &winners {
            diagram.colors[left[place] as usize] = best[place].1;
        }
        left.retain(|&index| diagram.colors[index as usize] == UNCOLORED);
        best.truncate(left.len());
        slot = Slots::new(&left);
    }
    Err(VoronoiError::BoundExceeded { step: "recoloring debris", bound })
}

/// Where a pixel stands in an ascending list.
struct Slots(Vec<u32>);

impl Slots {
    fn new(list: &[u32]) -> Self {
        Self(list.to_vec())
    }

    fn of(&self, index: u32) -> Option<usize> {
        self.0.binary_search(&index).ok()
    }
}

/// The best color on offer to an uncolored pixel, with its key, or the largest key where there is none.
fn best_candidate(diagram: &Diagram, sites: &Sites, index: usize) -> (Key, u32) {
    let pixel = diagram.pixel(index);
    let offers = neighbors(diagram, pixel).filter_map(|neighbor| {
        let color = diagram.color(neighbor);
        let site = *sites.pixels.get(color as usize)?;
        let key = Key::of(pixel, site);
        (Key::of(neighbor, site) < key).then_some((key, color))
    });
    offers.min().unwrap_or((Key::MAX, UNCOLORED))
}

/// Colors the pixels listed in [`Diagram::debris`] by [QCT]'s Algorithm A.1. Returns how many pairs the queue took.
///
/// # Errors
///
/// As for [`recolor`].
pub fn recolor_by_queue(diagram: &mut Diagram, sites: &Sites) -> Result<u64, VoronoiError> {
    sites.check()?;
    diagram.check(sites)?;
    let mut queue = BinaryHeap::new();
    let mut pairs = 0;
    for place in 0..diagram.debris.len() {
        let pixel = diagram.pixel(diagram.debris[place] as usize);
        for neighbor in neighbors(diagram, pixel).filter(|&p| diagram.color(p) != UNCOLORED) {
            let color = diagram.color(neighbor);
            let site = sites.pixels[color as usize];
            if Key::of(neighbor, site) < Key::of(pixel, site) {
                queue.push(Reverse((Key::of(pixel, site), color, pixel)));
            }
        }
    }
    while let Some(Reverse((key, color, pixel))) = queue.pop() {
        pairs += 1;
        let index = diagram.index(pixel);
        if diagram.colors[index] != UNCOLORED {
            continue;
        }
        diagram.colors[index] = color;
        for neighbor in neighbors(diagram, pixel).filter(|&p| diagram.color(p) == UNCOLORED) {
            let onward = Key::of(neighbor, sites.pixels[color as usize]);
            if key < onward {
                queue.push(Reverse((onward, color, neighbor)));
            }
        }
    }
    match diagram.debris.iter().find(|&&index| diagram.colors[index as usize] == UNCOLORED) {
        Some(&index) => Err(unreached(index)),
        None => Ok(pairs),
    }
}

fn unreached(index: u32) -> VoronoiError {
    VoronoiError::Mismatch { what: "debris that no color reaches", index: index as usize }
}
