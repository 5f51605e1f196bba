//! Options for the Earth's rotation on the sensor's axis.

use clap::Args;
use zerorate::EARTH_DPS;

#[derive(Args, Clone, Copy, Debug)]
pub struct EarthArgs {
    /// The component of the Earth's rotation on the axis, °/s, to subtract from the bias [default: as the recording
    /// states it; otherwise it stays part of PBC, and a warning says so]. A recording written with --log states the
    /// value that was used.
    #[arg(long, value_name = "X", help_heading = "Procedure")]
    earth_dps: Option<f64>,

    /// The Earth's rotation to subtract for an axis that points straight up, by the latitude: 0.00418 °/s × sin(DEG),
    /// north positive.
    #[arg(long, value_name = "DEG", conflicts_with = "earth_dps",
          value_parser = latitude, help_heading = "Procedure")]
    latitude: Option<f64>,
}

fn latitude(text: &str) -> Result<f64, String> {
    let degrees: Option<f64> = text.parse().ok();
    degrees.filter(|degrees| (-90.0..=90.0).contains(degrees)).ok_or("give degrees from -90 to 90".to_owned())
}

impl EarthArgs {
    /// The component of the Earth's rotation to subtract, °/s; `None` if no option was given.
    pub fn dps(self) -> Option<f64> {
        self.earth_dps.or(self.latitude.map(|degrees| EARTH_DPS * degrees.to_radians().sin()))
    }
}
