//! Plots as files, SVG or PNG.

use crate::exit::Usage;
use crate::output::{Outputs, StagedOutput};
use anyhow::Result;
use std::path::{Path, PathBuf};
#[cfg(feature = "png")]
use zerorate_view::plot;

#[derive(Clone, Copy, Debug)]
pub enum Kind {
    Svg,
    #[cfg(feature = "png")]
    Png,
}

impl Kind {
    /// The format by the file extension; `None` for an extension that is not of a plot.
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

/// The requested plots. Their files are claimed before the logs are read, which may take long.
pub struct Pictures(Vec<(Kind, StagedOutput)>);

impl Pictures {
    /// Claims a file for each path, whose extension states the format of the plot.
    pub fn claim(paths: &[PathBuf], outputs: &mut Outputs) -> Result<Self> {
        let kind = |path: &PathBuf| {
            let other = || Usage(format!("{}: a picture must end in .svg or .png", path.display()));
            Kind::of(path)?.ok_or_else(other)
        };
        let kinds = paths.iter().map(kind).collect::<Result<Vec<_>, _>>()?;
        let files = paths.iter().map(|path| outputs.derived(path)).collect::<Result<Vec<_>, _>>()?;
        Ok(Self(kinds.into_iter().zip(files).collect()))
    }

    pub fn write(self, svg: impl FnOnce() -> String) -> Result<()> {
        let svg = if self.0.is_empty() { String::new() } else { svg() };
        self.0.into_iter().try_for_each(|(kind, file)| write(kind, file, &svg))
    }
}

pub fn write(kind: Kind, file: StagedOutput, svg: &str) -> Result<()> {
    match kind {
        Kind::Svg => Ok(file.fill(svg.as_bytes())?),
        #[cfg(feature = "png")]
        Kind::Png => Ok(file.fill(&plot::png(svg)?)?),
    }
}
