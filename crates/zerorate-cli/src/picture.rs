//! The forms of a picture.

use crate::exit::Usage;
use crate::output::StagedOutput;
use anyhow::Result;
use std::path::Path;
#[cfg(feature = "png")]
use zerorate_view::plot;

/// The form of a picture.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    Svg,
    #[cfg(feature = "png")]
    Png,
}

impl Kind {
    /// The form that the name states; none where it is not the name of a picture.
    ///
    /// # Errors
    /// Returns an error if the form is not built in.
    pub fn of(path: &Path) -> Result<Option<Self>, Usage> {
        match path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("svg") => Ok(Some(Self::Svg)),
            #[cfg(feature = "png")]
            Some("png") => Ok(Some(Self::Png)),
            #[cfg(not(feature = "png"))]
            Some("png") => {
                let missing = zerorate_input::NotBuiltIn { what: "PNG", feature: "png" };
                Err(Usage(format!("{}: {missing}", path.display())))
            }
            _ => Ok(None),
        }
    }
}

/// Writes a picture in its form.
pub fn write(kind: Kind, file: StagedOutput, svg: &str) -> Result<()> {
    match kind {
        Kind::Svg => Ok(file.fill(svg.as_bytes())?),
        #[cfg(feature = "png")]
        Kind::Png => Ok(file.fill(&plot::png(svg)?)?),
    }
}
