//! Readable forms of what the stage gives, for tests and for people. They are stable: tests may compare them.

use crate::{Counts, Diagram, GridMapping, Sites, UNCOLORED};
use std::fmt;

const LETTERS: &[u8; 62] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789";

/// The text form of a [`Diagram`].
///
/// One line for each row of pixels, the highest row first, so that it reads like the plane. Each pixel is its color,
/// followed by one mark: `*` if it is a site's own (known to [`Diagram::letters`] only), `'` if it is debris, a blank
/// otherwise; blanks at the end of a line are left out. Colors are written with the digits `A..Z a..z 0..9`, 62 of
/// them, as many as the largest color needs, so up to 62 sites have one letter each: site 0 is `A`. Pixels without a
/// color are dots.
pub struct Letters<'a> {
    diagram: &'a Diagram,
    sites: &'a [[u16; 2]],
}

impl Diagram {
    /// The text form with the sites marked.
    pub fn letters<'a>(&'a self, sites: &'a Sites) -> Letters<'a> {
        Letters { diagram: self, sites: &sites.pixels[..sites.count] }
    }
}

impl fmt::Display for Diagram {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Letters { diagram: self, sites: &[] }.fmt(f)
    }
}

impl fmt::Display for Letters<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let diagram = self.diagram;
        let largest = diagram.colors.iter().copied().filter(|&color| color != UNCOLORED).max().unwrap_or(0);
        let digits = (1..6).find(|&n| u64::from(largest) < 62_u64.pow(n)).unwrap_or(6);
        let mut line = String::new();
        for y in (0..diagram.height.min(crate::MAX_SIDE) as u16).rev() {
            line.clear();
            for x in 0..diagram.width.min(crate::MAX_SIDE) as u16 {
                let index = diagram.index([x, y]);
                let color = diagram.colors.get(index).copied().unwrap_or(UNCOLORED);
                for place in (0..digits).rev() {
                    let digit = (u64::from(color) / 62_u64.pow(place) % 62) as usize;
                    line.push(if color == UNCOLORED { '.' } else { char::from(LETTERS[digit]) });
                }
                line.push(if diagram.debris.binary_search(&(index as u32)).is_ok() {
                    '\''
                } else if color != UNCOLORED && self.sites.get(color as usize) == Some(&[x, y]) {
                    '*'
                } else {
                    ' '
                });
            }
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }
}

/// One line: the size in pixels, and in powers of two the side of a pixel and the lower left corner of the grid.
impl fmt::Display for GridMapping {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([width, height], [x, y]) = (self.size(), self.translation());
        let ([side, high], [exponent, exponent_y]) = (self.sides(), self.exponents());
        if self.is_square() {
            write!(f, "{width} x {height} pixels of side {side} * 2^{exponent}, from ({x}, {y}) * 2^{exponent}")
        } else {
            write!(f, "{width} x {height} pixels, {side} * 2^{exponent} wide and {high} * 2^{exponent_y} high, ")?;
            write!(f, "from ({x} * 2^{exponent}, {y} * 2^{exponent_y})")
        }
    }
}

/// One line a point, in the new order: `site 3: point 17, pixel 4 5`, then `missing 9: point 2, pixel 4 5`.
impl fmt::Display for Sites {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (number, (point, [x, y])) in self.order.iter().zip(&self.pixels).enumerate() {
            let kind = if number < self.count { "site" } else { "missing" };
            writeln!(f, "{kind} {number}: point {point}, pixel {x} {y}")?;
        }
        Ok(())
    }
}

/// One line.
impl fmt::Display for Counts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { points, pixels, sites, missing, debris } = self;
        write!(f, "{points} points on {pixels} pixels: {sites} sites, {missing} missing; {debris} pixels of debris")
    }
}
