//! From SVG to PNG, the same on every machine: with no other font than the one in here.

use anyhow::Result;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};
use std::sync::Arc;

/// Inter, Latin, Greek, Cyrillic and a few signs of mathematics; its licence stands beside it.
const FONT: &[u8] = include_bytes!("../../assets/inter/Inter-subset.otf");
const FAMILY: &str = "Inter";
/// Pixels of the PNG for each pixel of the SVG.
const SCALE: f32 = 2.0;

/// A picture as PNG, twice as wide and high as the SVG states. Characters beyond Latin, Greek and Cyrillic stay blank.
///
/// # Errors
/// A text that is no SVG, or one without a size.
pub fn png(svg: &str) -> Result<Vec<u8>> {
    let mut options = Options { font_family: FAMILY.to_owned(), ..Options::default() };
    let fonts = Arc::make_mut(&mut options.fontdb);
    fonts.load_font_data(FONT.to_vec());
    fonts.set_sans_serif_family(FAMILY);
    let tree = Tree::from_str(svg, &options)?;
    let size = tree.size().to_int_size().scale_by(SCALE);
    let pixels = size.and_then(|size| Pixmap::new(size.width(), size.height()));
    let mut pixels = pixels.ok_or_else(|| anyhow::anyhow!("the picture has no size"))?;
    resvg::render(&tree, Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
    Ok(pixels.encode_png()?)
}
