//! Options for the method, the durations and the limits of a calibration. The core defines most defaults.

use crate::commands::earth::EarthArgs;
use crate::exit::Usage;
use anyhow::{Result, ensure};
use clap::{Args, ValueEnum};
use zerorate::{Method, Plan};
use zerorate_jobs::calibrate::settle_s;
use zerorate_view::duration::Seconds;

#[derive(Args, Debug)]
#[command(next_help_heading = "Procedure")]
pub struct PlanArgs {
    /// How to find the bias over temperature.
    #[arg(long, value_enum, default_value = "an1042")]
    method: MethodArg,

    /// End the recording early at this standard uncertainty of the correction, °/h [default: the whole time].
    ///
    /// For the methods warmup and cycle. The uncertainty is the rms over the temperatures seen, and the temperature
    /// must have settled as well.
    #[arg(long, value_name = "DPH")]
    target_dph: Option<f64>,

    /// Length of the two averages of rate and temperature, steps 4 and 6.
    #[arg(long, value_name = "TIME", default_value_t = Seconds(Plan::default().average_s))]
    average: Seconds,

    /// Warm-up between them, step 5.
    #[arg(long, value_name = "TIME", default_value_t = Seconds(Plan::default().warmup_s))]
    warmup: Seconds,

    /// Settling to thermal balance, step 7 [default: 40m].
    ///
    /// For the methods warmup and cycle all these times add up to the length of the recording. Without this option
    /// they use the whole of a capture.
    #[arg(long, value_name = "TIME")]
    settle: Option<Seconds>,

    /// Length of the average that gives PBC, step 8. One second of temperature follows it.
    #[arg(long, value_name = "TIME", default_value_t = Seconds(Plan::default().offset_s))]
    offset: Seconds,

    /// Largest share of lost samples in an average, 0 … 1. Above it the measurement is refused.
    #[arg(long, value_name = "F", default_value_t = Plan::default().max_lost)]
    max_lost: f64,

    /// Largest standard uncertainty of BTC, °/s/°C. Above it the measurement is refused.
    #[arg(long, value_name = "U", default_value_t = Plan::default().max_u_btc_dps_per_c)]
    max_u_btc: f64,

    #[command(flatten)]
    earth: EarthArgs,

    /// Assume that the bias is a straight line over temperature: the uncertainty then ignores curvature and
    /// hysteresis.
    #[arg(long)]
    assume_linear: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum MethodArg {
    /// Two temperatures by self-heating and the line through them, as in AN-1042.
    An1042,
    /// A curve fitted to every sample of a recording of the same length.
    Warmup,
    /// The same curve while the sensor is heated and cooled, by hand or by a chamber.
    Cycle,
}

/// A line with the durations of AN-1042's steps, so that the user notices a wrong unit. `None` for the other methods.
pub fn durations(plan: &Plan) -> Option<String> {
    let [average, warmup, settle, offset] = [plan.average_s, plan.warmup_s, plan.settle_s, plan.offset_s].map(Seconds);
    (plan.method == Method::An1042).then(|| {
        let total = Seconds(plan.total_s());
        format!("averages of {average}, warm-up {warmup}, settling {settle}, offset average {offset}: {total} in all")
    })
}

impl PlanArgs {
    /// The plan of the measurement. Without `--settle`, the methods `warmup` and `cycle` use the whole of a recording.
    ///
    /// # Errors
    /// Returns a usage error for a target of the method `an1042`, which always takes its whole time.
    pub fn plan(&self, recorded: bool) -> Result<Plan> {
        let method = match self.method {
            MethodArg::An1042 => Method::An1042,
            MethodArg::Warmup => Method::Warmup,
            MethodArg::Cycle => Method::Cycle,
        };
        ensure!(
            self.target_dph.is_none() || method != Method::An1042,
            Usage("--target-dph is for --method warmup or cycle".to_owned())
        );
        Ok(Plan {
            method,
            target_dps: self.target_dph.map(|dph| dph / 3600.0),
            average_s: self.average.0,
            warmup_s: self.warmup.0,
            settle_s: self.settle.map_or_else(|| settle_s(method, recorded), |settle| settle.0),
            offset_s: self.offset.0,
            max_lost: self.max_lost,
            max_u_btc_dps_per_c: self.max_u_btc,
            earth_dps: self.earth.dps(),
            assume_linear: self.assume_linear,
            ..Plan::default()
        })
    }
}
