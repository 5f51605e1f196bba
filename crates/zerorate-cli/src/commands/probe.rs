//! `zerorate probe`: checks that a sensor responds, is wired correctly and delivers plausible samples.

use crate::device::{DeviceArgs, SamplingArgs};
use crate::output::{Outputs, print_json, print_lines, warn};
use crate::progress::Meter;
use crate::wording::flag;
use anyhow::Result;
use clap::Args;
use zerorate_jobs::probe::{AxisFindings, Findings, SelfTestResult, probe};
use zerorate_view::duration::{self, Seconds};

/// Check that the sensor responds, is wired correctly and delivers samples
///
/// probe resets and initialises the sensor, reads every written register back, and then reads samples. It measures
/// their rate, the noise, the temperature and the number of lost samples, and says what to check where something is
/// wrong. On an SPI bus it also tries faster clocks, and proposes what to leave out if the host cannot read all
/// samples. On a replay it checks the samples only.
#[derive(Args, Debug)]
pub struct ProbeArgs {
    #[command(flatten)]
    pub device: DeviceArgs,

    #[command(flatten)]
    sampling: SamplingArgs,

    /// Time to read samples: 5s, 1m, or seconds.
    #[arg(long, value_name = "TIME", default_value = "5s", value_parser = duration::above_zero)]
    duration: Seconds,

    /// Also measure by how much the self-test shifts the rate.
    ///
    /// For spi: devices GPIO is the line of the self-test pins (1-7 and 9 of the part), as in gpiochip0:17. The twin
    /// and bridges have their own line. The result is not judged, since its proper size is not published (F-11). The
    /// pin is released at the end, also after Ctrl-C.
    #[arg(long, value_name = "GPIO", num_args = 0..=1, default_missing_value = "")]
    self_test: Option<String>,

    /// Print the findings as one JSON object.
    #[arg(long)]
    json: bool,
}

pub fn run(args: &ProbeArgs) -> Result<()> {
    let setup = args.device.setup(args.sampling, &mut Outputs::without_force())?;
    let acquisition = args.device.open(setup)?;
    let meter = Meter::new(args.duration.0);
    let mut see = |elapsed_s| meter.show(elapsed_s, "reading samples".to_owned());
    let findings = probe(acquisition, args.duration, args.self_test.as_deref(), flag, &mut see)?;
    drop(meter);
    if args.json {
        return print_json(&findings);
    }
    let printed = print_lines(&text(&findings));
    warn(&findings.warnings);
    printed
}

fn text(findings: &Findings) -> String {
    let part = findings.revision.map_or(String::new(), |revision| {
        format!("  part          answers, revision {revision:02X}h; every register written reads back\n")
    });
    format!(
        "{}\n{part}{}{}{}  data ready    {:.1} Hz\n  samples       {:.1} a second: {} in {}, {} lost, longest gap \
         {:.3} ms\n{}  temperature   {}\n",
        findings.device,
        framing_text(findings),
        bus_text(findings),
        self_test_text(findings),
        findings.rdy_hz,
        findings.rate_hz,
        findings.samples,
        Seconds(findings.duration_s),
        findings.lost_samples,
        findings.longest_gap_ms,
        findings.only.iter().chain(&findings.axes).map(axis_text).collect::<String>(),
        shown(findings.temp_c, "°C"),
    )
}

fn shown(value: Option<f64>, unit: &str) -> String {
    value.map_or("not measured".to_owned(), |value| format!("{value:.4} {unit}"))
}

fn axis_text(axis: &AxisFindings) -> String {
    let typical = axis.typical_white_dps_per_rt_hz.map_or(String::new(), |typical| format!(" (typical {typical})"));
    let white = shown(axis.white_dps_per_rt_hz, "°/s/√Hz");
    let name = axis.name.as_ref().map_or(String::new(), |name| format!("  axis          {name}\n"));
    format!("{name}  rate          {:+.4} °/s on average\n  white noise   {white}{typical}\n", axis.rate_dps)
}

fn framing_text(findings: &Findings) -> &'static str {
    match findings.framing {
        Some("byte") => "  framing       byte: CS rises between all bytes, as the note has it (F-22)\n",
        Some(_) => {
            "  framing       command: CS stays low for a whole command (F-22); framing=byte in the address is the \
             note's\n"
        }
        None => "",
    }
}

fn self_test_text(findings: &Findings) -> String {
    findings.self_test.map_or(String::new(), |SelfTestResult { shift_dps, u_dps, samples }| {
        format!(
            "  self-test     shifts the rate by {shift_dps:+.4} °/s, u = {u_dps:.4} ({samples} samples without \
             and with; its proper size is not published, F-11)\n"
        )
    })
}

fn bus_text(findings: &Findings) -> String {
    let Some(sclk_hz) = findings.sclk_hz else { return String::new() };
    let read = findings.read_us.map_or(String::new(), |read_us| format!(", {read_us:.0} µs a read"));
    let mhz = |hz: u32| f64::from(hz) * 1e-6;
    let fastest = findings
        .fastest_clean_sclk_hz
        .map_or("at none of the clocks tried".to_owned(), |hz| format!("up to {} MHz", mhz(hz)));
    let proposal = findings.proposal.as_ref().map_or(String::new(), |options| format!("; try {options}"));
    format!(
        "  SPI           {} MHz{read}; reads back {fastest}\n  host          takes {:.1} % of the \
         samples{proposal}\n",
        mhz(sclk_hz),
        findings.taken * 100.0
    )
}
