//! The one total order that settles every tie of this stage.

use crate::Diagram;

/// A pixel paired with a site, in an order: by squared distance, then the site's x and y, then the pixel's x and y.
///
/// The order agrees with the distance between pixel centers and no two pairs are equal in it, which is all that
/// \[CET\] asks of a tie-breaking rule. Sides of at most 32768 pixels keep squared distances below 2^31.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Key {
    /// Squared distance in the upper half, packed site in the lower half.
    high: u64,
    /// Packed pixel.
    low: u32,
}

impl Key {
    /// Greater than the key of any pair.
    pub const MAX: Self = Self { high: u64::MAX, low: u32::MAX };

    /// The key of a pixel with a site.
    pub fn of(pixel: [u16; 2], site: [u16; 2]) -> Self {
        Self { high: u64::from(squared_distance(pixel, site)) << 32 | u64::from(pack(site)), low: pack(pixel) }
    }

    /// The squared distance between the pixel and the site.
    pub fn squared_distance(self) -> u32 {
        (self.high >> 32) as u32
    }
}

/// Two 16-bit coordinates in one word, ordered by x and then by y.
pub(crate) fn pack([x, y]: [u16; 2]) -> u32 {
    u32::from(x) << 16 | u32::from(y)
}

pub(crate) fn squared_distance(a: [u16; 2], b: [u16; 2]) -> u32 {
    let x = u32::from(a[0].abs_diff(b[0]));
    let y = u32::from(a[1].abs_diff(b[1]));
    x * x + y * y
}

/// The pixels that share a side or a corner with pixel `[x, y]`, row by row.
pub(crate) fn neighbors(diagram: &Diagram, [x, y]: [u16; 2]) -> impl Iterator<Item = [u16; 2]> {
    let (width, height) = (diagram.width as i32, diagram.height as i32);
    let (x, y) = (i32::from(x), i32::from(y));
    const AROUND: [(i32, i32); 8] = [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)];
    AROUND
        .into_iter()
        .map(move |(dx, dy)| (x + dx, y + dy))
        .filter_map(move |(x, y)| (x >= 0 && y >= 0 && x < width && y < height).then_some([x as u16, y as u16]))
}
