//! What later stages need of this one.

use super::buffers::{Buffers, Word};
use polder_vulkan::{Buffer, Error, View};

/// The results alone, after [`Buffers::into_results`]: 8 bytes a point and 4 a pixel.
#[derive(Debug)]
pub struct Results {
    size: [u32; 2],
    order: Buffer<u32>,
    pixels: Buffer<[u16; 2]>,
    colors: Buffer<u32>,
    counts: Buffer<u32>,
}

impl Buffers {
    /// Gives all scratch memory back; what a submission still uses of it lives until that is done.
    pub fn into_results(self) -> Results {
        let Buffers { size, order, pixels, colors, counts, .. } = self;
        Results { size, order, pixels, colors, counts }
    }
}

impl Results {
    /// Width and height of the grid.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// As [`Buffers::order`].
    pub fn order(&self) -> View<'_, u32> {
        self.order.view()
    }

    /// As [`Buffers::pixels`].
    pub fn pixels(&self) -> View<'_, [u16; 2]> {
        self.pixels.view()
    }

    /// As [`Buffers::colors`].
    pub fn colors(&self) -> View<'_, u32> {
        self.colors.view()
    }

    /// As [`Buffers::site_count`].
    pub fn site_count(&self) -> Result<View<'_, u32>, Error> {
        self.counts.slice(Word::Sites as usize..Word::Sites as usize + 1)
    }
}
