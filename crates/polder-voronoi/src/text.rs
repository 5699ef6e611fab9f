use crate::{Diagram, Sites, UNCOLORED};
use std::fmt;

const LETTERS: &[u8; 62] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789";

/// The text form of a [`Diagram`], stable: tests may compare it.
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
        for y in (0..diagram.height as u16).rev() {
            line.clear();
            for x in 0..diagram.width as u16 {
                let index = diagram.index([x, y]);
                let color = diagram.colors[index];
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
