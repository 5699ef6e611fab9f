use glam::DVec2;

/// Maps the plane onto a picture: a bounding box fitted into a frame, y upwards.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Width of the picture.
    pub width: f64,
    /// Height of the picture.
    pub height: f64,
    min: DVec2,
    /// A power of two by which coordinates are multiplied first, so that differences neither overflow nor vanish.
    first: f64,
    scale: f64,
    margin: DVec2,
}

impl Frame {
    /// A picture of `side` units along its longer side that shows all points with `margin` around them, and at least
    /// a strip of one twelfth of that where they lie on a line.
    pub fn fit(points: &[DVec2], side: f64, margin: f64) -> Self {
        let (mut min, mut max) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for &p in points {
            min = min.min(p);
            max = max.max(p);
        }
        if points.is_empty() {
            (min, max) = (DVec2::ZERO, DVec2::ONE);
        }
        let first = if min.abs().max(max.abs()).max_element() > 1e300 {
            0.25
        } else if (max - min).max_element() < 1e-280 {
            f64::from_bits((1023 + 600) << 52)
        } else {
            1.0
        };
        let extent = max * first - min * first;
        let inner = side - 2.0 * margin;
        let longest = extent.max_element();
        let scale = if longest > 0.0 { inner / longest } else { 1.0 };
        let size = extent * scale;
        let full = size.max(DVec2::splat(inner / 12.0));
        Self {
            width: full.x + 2.0 * margin,
            height: full.y + 2.0 * margin,
            min: min * first,
            first,
            scale,
            margin: (full - size) / 2.0 + margin,
        }
    }

    /// Where a point is in the picture.
    pub fn map(&self, p: DVec2) -> DVec2 {
        let d = (p * self.first - self.min) * self.scale;
        DVec2::new(self.margin.x + d.x, self.height - self.margin.y - d.y)
    }
}
