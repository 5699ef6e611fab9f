//! From vectors to pixels.

use crate::failure::Failure;
use resvg::{tiny_skia, usvg};

/// Pixels that a side of a picture may have.
const MOST: u32 = 16_384;

/// A picture as PNG, `size` pixels along its longer side.
pub(super) fn png(svg: &[u8], size: u32) -> Result<Vec<u8>, Failure> {
    let internal = |what: &str| Failure::new("internal", format!("the picture cannot be drawn: {what}"));
    if !(1..=MOST).contains(&size) {
        crate::job::usage(&format!("--size must be from 1 to {MOST}"));
    }
    let tree = usvg::Tree::from_data(svg, &usvg::Options::default()).map_err(|e| internal(&e.to_string()))?;
    let scale = size as f32 / tree.size().width().max(tree.size().height());
    let side = |x: f32| ((x * scale).round() as u32).max(1);
    let (width, height) = (side(tree.size().width()), side(tree.size().height()));
    let mut pixels = tiny_skia::Pixmap::new(width, height).ok_or_else(|| internal("no memory"))?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(scale, scale), &mut pixels.as_mut());
    pixels.encode_png().map_err(|e| internal(&e.to_string()))
}
