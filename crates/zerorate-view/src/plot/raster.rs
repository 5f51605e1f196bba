//! Converts SVG to PNG with the embedded font only, so the result is the same on every machine.

use anyhow::Result;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};
use std::sync::Arc;

/// The font Inter with Latin, Greek, Cyrillic and a few mathematical signs. Its licence is in the same folder.
const FONT: &[u8] = include_bytes!("../../assets/inter/Inter-subset.otf");
const FAMILY: &str = "Inter";
/// Pixels of the PNG per pixel of the SVG.
const SCALE: f32 = 2.0;

/// Renders a PNG, twice as wide and high as the SVG states. Characters that the font lacks are blank.
///
/// # Errors
/// Returns an error if the text is not an SVG, or the SVG has no size.
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

#[cfg(test)]
mod tests {
    use super::{Pixmap, png};
    use crate::plot::tests::fitted;
    use crate::plot::{Options, allan};

    #[test]
    fn a_png_is_twice_the_size_and_has_ink_and_letters() {
        let options = Options { size: (480, 320), ..Options::default() };
        let image = Pixmap::decode_png(&png(&allan(&[fitted()], &options)).unwrap()).unwrap();
        assert_eq!((image.width(), image.height()), (960, 640));
        let dark = |x0: u32, x1: u32| {
            let within = |index: usize| (x0..x1).contains(&(index as u32 % image.width()));
            image.pixels().iter().enumerate().filter(|(index, pixel)| within(*index) && pixel.red() < 100).count()
        };
        assert!(dark(0, 960) > 2000, "curves");
        assert!(dark(0, 60) > 100, "the name of the left axis, in the font of the program");
        assert!(png("no picture").is_err());
    }
}
