use crate::{Sites, VoronoiError};

/// The color of a pixel that has none (between [`crate::reference::debris`] and [`crate::reference::recolor`]).
pub const UNCOLORED: u32 = u32::MAX;

/// A coloring of the grid: for each pixel the number of a site.
///
/// Shown with `{}` it is a grid of letters, described at [`crate::Letters`]; [`Diagram::letters`] marks the sites too.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Diagram {
    /// Pixels in a row, at most 32768.
    pub width: u32,
    /// Rows, at most 32768.
    pub height: u32,
    /// The site number of pixel `[x, y]` at `y * width + x`, or [`UNCOLORED`].
    pub colors: Vec<u32>,
    /// The pixels, as indices into `colors`, ascending, that the Euclidean coloring cut off from their site. Empty
    /// before [`crate::reference::debris`] has looked for them; kept, for the record, once they are recolored.
    pub debris: Vec<u32>,
}

impl Diagram {
    /// The index of a pixel of the grid in [`Diagram::colors`].
    pub fn index(&self, [x, y]: [u16; 2]) -> usize {
        usize::from(y) * self.width as usize + usize::from(x)
    }

    /// The pixel at an index of [`Diagram::colors`], of which there must be some.
    pub fn pixel(&self, index: usize) -> [u16; 2] {
        let width = self.width as usize;
        [(index % width) as u16, (index / width) as u16]
    }

    /// The color of a pixel.
    ///
    /// # Panics
    ///
    /// If the pixel does not lie in the grid.
    pub fn color(&self, pixel: [u16; 2]) -> u32 {
        self.colors[self.index(pixel)]
    }

    /// Whether the parts fit together: sizes, colors that exist, debris in order and the only pixels without color, each
    /// site in its own color.
    pub fn check(&self, sites: &Sites) -> Result<(), VoronoiError> {
        let fault = |what, index| Err(VoronoiError::Mismatch { what, index });
        if [self.width, self.height] != sites.size || self.colors.len() != self.width as usize * self.height as usize {
            return fault("a diagram that is not of the size of its grid", self.colors.len());
        }
        if let Some(index) = self.colors.iter().position(|&c| c != UNCOLORED && c as usize >= sites.count) {
            return fault("a color that no site has", index);
        }
        if let Some(index) = self.debris.windows(2).position(|pair| pair[0] >= pair[1]) {
            return fault("debris out of order", index);
        }
        if self.debris.last().is_some_and(|&last| last as usize >= self.colors.len()) {
            return fault("debris outside the grid", self.debris.len() - 1);
        }
        // Both lists ascend, so one pass over them finds an uncolored pixel that is not debris.
        let mut debris = self.debris.iter().map(|&index| index as usize).peekable();
        for (index, _) in self.colors.iter().enumerate().filter(|&(_, &color)| color == UNCOLORED) {
            while debris.next_if(|&at| at < index).is_some() {}
            if debris.peek() != Some(&index) {
                return fault("an uncolored pixel that is not debris", index);
            }
        }
        let mut own = sites.pixels[..sites.count].iter().enumerate();
        match own.find(|&(site, &pixel)| self.color(pixel) as usize != site) {
            Some((site, _)) => fault("a site whose pixel has another color", site),
            None => Ok(()),
        }
    }
}

/// What the stage counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Points given.
    pub points: u64,
    /// Pixels of the grid.
    pub pixels: u64,
    /// Points that own their pixel.
    pub sites: u64,
    /// Points that do not.
    pub missing: u64,
    /// Pixels that the Euclidean coloring cut off from their site.
    pub debris: u64,
}
