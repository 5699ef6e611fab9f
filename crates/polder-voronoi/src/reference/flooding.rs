//! Plain flooding with one priority queue: \[CET\] section 2. For tests: it is the definition that the
//! other steps are held against, and takes a few hundred times as long.
//!
//! 1. The queue starts with every site's own pixel paired with the site.
//! 2. Take the first pair, in the order of [`Key`]. If its pixel has no color yet, give it the pair's color, and put
//!    each neighbor of it, paired with the same color, into the queue.
//! 3. Repeat until the queue is empty.

use crate::order::{Key, neighbors};
use crate::{Diagram, Sites, UNCOLORED, VoronoiError};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The diagram by flooding, and the order in which its pixels were colored (as indices).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flooding {
    /// The diagram. It has no debris.
    pub diagram: Diagram,
    /// Every pixel once, the first colored first.
    pub colored: Vec<u32>,
}

/// Floods the grid from the sites.
///
/// # Errors
///
/// Those of [`Sites::check`].
pub fn flood(sites: &Sites) -> Result<Flooding, VoronoiError> {
    sites.check()?;
    let [width, height] = sites.size;
    let size = width as usize * height as usize;
    let mut diagram = Diagram { width, height, colors: vec![UNCOLORED; size], debris: Vec::new() };
    let mut colored = Vec::with_capacity(size);
    let own = sites.pixels[..sites.count].iter().enumerate();
    let mut queue: BinaryHeap<_> =
        own.map(|(site, &pixel)| Reverse((Key::of(pixel, pixel), site as u32, pixel))).collect();
    while let Some(Reverse((_, color, pixel))) = queue.pop() {
        let index = diagram.index(pixel);
        if diagram.colors[index] != UNCOLORED {
            continue;
        }
        diagram.colors[index] = color;
        colored.push(index as u32);
        let site = sites.pixels[color as usize];
        queue.extend(neighbors(&diagram, pixel).map(|p| Reverse((Key::of(p, site), color, p))));
    }
    Ok(Flooding { diagram, colored })
}
