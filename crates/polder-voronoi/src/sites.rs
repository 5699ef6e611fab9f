use crate::{MAX_SIDE, VoronoiError};

/// Which points own a pixel, and all points in a new order.
///
/// Later stages work in this *renumbering*, so that points close in the plane are close in memory: number `i` stands
/// for the input point `order[i]`. First come the `count` *sites*, in the order of their pixels, row by row; then the
/// *missing points*, in the order of their pixels too, those of one pixel by input index.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sites {
    /// Width and height of the grid, each between 1 and [`MAX_SIDE`].
    pub size: [u32; 2],
    /// The input index of each point in the new order.
    pub order: Vec<u32>,
    /// How many of them are sites, at least one. A site's color is its number in the new order, below `count`.
    pub count: usize,
    /// The pixel of each point in the new order, those of sites all different.
    pub pixels: Vec<[u16; 2]>,
}

impl Sites {
    /// How many points do not own their pixel.
    pub fn missing(&self) -> usize {
        self.order.len() - self.count
    }

    /// Whether the parts fit together: the size, the lengths, every pixel in the grid, sites in strictly ascending
    /// pixel order, missing points in ascending order.
    pub fn check(&self) -> Result<(), VoronoiError> {
        let fault = |what, index| Err(VoronoiError::Mismatch { what, index });
        if let Some(&side) = self.size.iter().find(|side| !(1..=MAX_SIDE).contains(*side)) {
            return Err(VoronoiError::GridSide { side, limit: MAX_SIDE });
        }
        if self.count == 0 {
            return Err(VoronoiError::NoPoints);
        }
        if self.order.len() != self.pixels.len() || self.count > self.order.len() {
            return fault("numbers of points that differ", self.count);
        }
        let outside = |&[x, y]: &[u16; 2]| u32::from(x) >= self.size[0] || u32::from(y) >= self.size[1];
        if let Some(index) = self.pixels.iter().position(outside) {
            return fault("a point outside the grid", index);
        }
        let rows_first = |i: usize| [self.pixels[i][1], self.pixels[i][0]];
        if let Some(index) = (1..self.count).find(|&i| rows_first(i - 1) >= rows_first(i)) {
            return fault("sites out of order", index);
        }
        let missing_first = |i: usize| (rows_first(i), self.order[i]);
        match (self.count + 1..self.pixels.len()).find(|&i| missing_first(i - 1) >= missing_first(i)) {
            Some(index) => fault("missing points out of order", index),
            None => Ok(()),
        }
    }
}
