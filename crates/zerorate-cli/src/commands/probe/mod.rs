//! `zerorate probe`: is there a part, is it wired right, and do its samples look like those of one?

use crate::device::{DeviceArgs, SamplingArgs};
use crate::interrupt;
use crate::output::{Outputs, print_json, print_lines, warn};
use crate::progress::Meter;
use crate::proposal::proposal;
use crate::wording::{coded, flag};
use adis16130::{Framing, SelfTest};
use anyhow::{Result, ensure};
use clap::Args;
use serde::Serialize;
use zerorate::{Axis, Checkup, Limits, NamedAxis, Say};
use zerorate_host::Bus;
use zerorate_jobs::Acquisition;
use zerorate_view::duration::{self, Seconds};

/// Looks whether a part answers, is wired right and delivers.
///
/// Resets the part, initialises it, reads every written register back, then reads samples and measures their rate, the
/// noise, the temperature and how many were lost. Says what to check where something is wrong. On an SPI bus it also
/// tries faster and faster clocks, and proposes what to leave out if the host cannot take all samples. On a replay
/// only the samples are looked at.
#[derive(Args, Debug)]
pub struct ProbeArgs {
    #[command(flatten)]
    pub device: DeviceArgs,

    #[command(flatten)]
    sampling: SamplingArgs,

    /// How long to read samples: 5s, 1m, or seconds.
    #[arg(long, value_name = "TIME", default_value = "5s", value_parser = duration::above_zero)]
    duration: Seconds,

    /// Also measure what the self-test does to the rate: GPIO is the line that the self-test pins (1-7 and 9 of the
    /// part) are on, as in gpiochip0:17, for spi: devices; the twin and bridges have their own. Nothing is judged by
    /// the result, since nobody published the proper size (F-11). The pin is released at the end, also after Ctrl-C.
    #[arg(long, value_name = "GPIO", num_args = 0..=1, default_missing_value = "")]
    self_test: Option<String>,

    /// Print the findings as one JSON object.
    #[arg(long)]
    json: bool,
}

/// What was found.
#[derive(Serialize)]
struct Findings {
    device: String,
    /// The register; a replay has none.
    revision: Option<u8>,
    /// How CS frames the bytes (F-22): byte or command; none where that is not in our hands.
    framing: Option<&'static str>,
    self_test: Option<SelfTested>,
    /// On an SPI bus.
    sclk_hz: Option<u32>,
    /// The fastest of the clocks tried at which the configuration reads back right.
    fastest_clean_sclk_hz: Option<u32>,
    read_us: Option<f64>,
    /// Share of the samples that the host took.
    taken: f64,
    /// Options that would lose fewer.
    proposal: Option<String>,
    rdy_hz: f64,
    rate_hz: f64,
    samples: u64,
    lost_samples: u64,
    longest_gap_ms: f64,
    duration_s: f64,
    /// Of a part with one axis; else it stands in `axes`.
    #[serde(flatten)]
    only: Option<AxisFindings>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    axes: Vec<AxisFindings>,
    temp_c: Option<f64>,
    warnings: Vec<String>,
}

/// What was found of an axis.
#[derive(Serialize)]
struct AxisFindings {
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    rate_dps: f64,
    white_dps_per_rt_hz: Option<f64>,
    #[serde(skip)]
    typical_white_dps_per_rt_hz: Option<f64>,
}

/// What the self-test did to the rate.
#[derive(Clone, Copy, Serialize)]
struct SelfTested {
    shift_dps: f32,
    /// Standard uncertainty.
    u_dps: f32,
    /// With the self-test, and as many without.
    samples: u32,
}

pub fn run(args: &ProbeArgs) -> Result<()> {
    let setup = args.device.setup(args.sampling, &mut Outputs::without_force())?;
    let mut acquisition = args.device.open(setup)?;
    let revision = acquisition.initialise()?;
    let bus = acquisition.try_bus()?;
    let self_test = match &args.self_test {
        None => None,
        Some(gpio) => {
            let SelfTest { shift_dps, u_dps, n } = acquisition.self_test(gpio)?;
            Some(SelfTested { shift_dps, u_dps, samples: n })
        }
    };
    let checkups = read(&mut acquisition, args.duration)?;
    ensure!(acquisition.tally().samples > 0, "no samples were read");
    let findings = Findings { self_test, ..Findings::new(acquisition, revision, bus, &checkups) };
    if args.json {
        return print_json(&findings);
    }
    warn(&findings.warnings);
    print_lines(&findings.text())
}

/// Reads samples for so long.
fn read(acquisition: &mut Acquisition, duration: Seconds) -> Result<Vec<Checkup>> {
    let meter = Meter::new(duration.0);
    let mut checkups = vec![Checkup::default(); acquisition.part().axes.len()];
    let mut judged = Vec::new();
    let mut first_ns = None;
    while acquisition.next_judged(&mut judged)? {
        checkups.iter_mut().zip(&judged).for_each(|(checkup, judged)| checkup.push(judged));
        let t_ns = judged.first().map_or(0, |first| first.reading.t_ns);
        let elapsed_ns = t_ns - *first_ns.get_or_insert(t_ns);
        if elapsed_ns >= duration.nanos() {
            break;
        }
        if acquisition.is_time_to_show() {
            meter.show(elapsed_ns as f64 * 1e-9, "reading samples".to_owned());
        }
    }
    ensure!(!interrupt::asked(), "interrupted");
    Ok(checkups)
}

impl Findings {
    fn new(mut acquisition: Acquisition, revision: Option<u8>, bus: Option<Bus>, checkups: &[Checkup]) -> Self {
        let of_the_samples = acquisition.warnings(flag);
        let tally = *acquisition.tally();
        let facts = acquisition.facts();
        let frozen = acquisition.healths().map(|health| health.frozen_at_end().is_some());
        let several = checkups.len() > 1;
        let named = facts.part.axes.iter().zip(checkups).zip(frozen);
        let mut axes: Vec<AxisFindings> = named
            .map(|((named, checkup), frozen)| AxisFindings::new(several, named, checkup, tally.rate_hz(), frozen))
            .collect();
        let first = checkups.first().zip(facts.part.axes.first());
        let of_the_part = first.map(|(first, _)| first.warnings(&tally, facts.rate_hz, &Limits::default()));
        let of_the_part: Vec<String> = of_the_part.iter().flatten().map(coded).collect();
        let of_the_noise: Vec<String> =
            axes.iter().zip(&*facts.part.axes).filter_map(|(found, named)| found.noise_warning(&named.axis)).collect();
        let temp_c = first.and_then(|(first, named)| first.temp_c(&named.axis));
        let taken = tally.samples as f64 / (tally.samples + tally.lost) as f64;
        Self {
            device: facts.name.clone(),
            revision,
            framing: facts.framing.map(|framing| match framing {
                Framing::PerByte => "byte",
                Framing::Command => "command",
            }),
            self_test: None,
            sclk_hz: bus.map(|bus| bus.sclk_hz),
            fastest_clean_sclk_hz: bus.and_then(|bus| bus.fastest_clean_hz),
            read_us: bus.and_then(|bus| bus.read_s).map(|read_s| read_s * 1e6),
            taken,
            proposal: bus.and_then(|bus| bus.read_s).and_then(|read_s| proposal(taken, read_s, facts.mclk_hz)),
            rdy_hz: tally.rdy_hz(),
            rate_hz: tally.rate_hz(),
            samples: tally.samples,
            lost_samples: tally.lost,
            longest_gap_ms: tally.longest_gap_ms(),
            duration_s: tally.duration_s(),
            only: if several { None } else { axes.pop() },
            axes,
            temp_c,
            warnings: of_the_samples.into_iter().chain(of_the_noise).chain(of_the_part).collect(),
        }
    }

    fn text(&self) -> String {
        let part = self.revision.map_or(String::new(), |revision| {
            format!("  part          answers, revision {revision:02X}h; every register written reads back\n")
        });
        format!(
            "{}\n{part}{}{}{}  data ready    {:.1} Hz\n  samples       {:.1} a second: {} in {}, {} lost, longest gap \
             {:.3} ms\n{}  temperature   {}\n",
            self.device,
            self.framing_text(),
            self.bus_text(),
            self.self_test_text(),
            self.rdy_hz,
            self.rate_hz,
            self.samples,
            Seconds(self.duration_s),
            self.lost_samples,
            self.longest_gap_ms,
            self.only.iter().chain(&self.axes).map(AxisFindings::text).collect::<String>(),
            shown(self.temp_c, "°C"),
        )
    }
}

/// A value that may not have been measured.
fn shown(value: Option<f64>, unit: &str) -> String {
    value.map_or("not measured".to_owned(), |value| format!("{value:.4} {unit}"))
}

impl AxisFindings {
    fn new(several: bool, named: &NamedAxis, checkup: &Checkup, rate_hz: f64, is_frozen: bool) -> Self {
        Self {
            name: several.then(|| named.name.to_string()),
            rate_dps: checkup.rate_dps(&named.axis).unwrap_or_default(),
            white_dps_per_rt_hz: checkup.white_dps_per_rt_hz(&named.axis, rate_hz).filter(|_| !is_frozen),
            typical_white_dps_per_rt_hz: named.axis.noise.map(|noise| noise.white_dps_per_rt_hz),
        }
    }

    fn noise_warning(&self, axis: &Axis) -> Option<String> {
        let warning = Checkup::noise_warning(axis, self.white_dps_per_rt_hz?, &Limits::default())?;
        Some(match &self.name {
            Some(name) => format!("{}: axis {name}: {}", warning.code(), warning.with(flag)),
            None => coded(&warning),
        })
    }

    fn text(&self) -> String {
        let typical =
            self.typical_white_dps_per_rt_hz.map_or(String::new(), |typical| format!(" (typical {typical})"));
        let white = shown(self.white_dps_per_rt_hz, "°/s/√Hz");
        let name = self.name.as_ref().map_or(String::new(), |name| format!("  axis          {name}\n"));
        format!("{name}  rate          {:+.4} °/s on average\n  white noise   {white}{typical}\n", self.rate_dps)
    }
}

impl Findings {
    fn framing_text(&self) -> &'static str {
        match self.framing {
            Some("byte") => "  framing       byte: CS rises between all bytes, as the note has it (F-22)\n",
            Some(_) => {
                "  framing       command: CS stays low for a whole command (F-22); framing=byte in the address is the \
                 note's\n"
            }
            None => "",
        }
    }

    fn self_test_text(&self) -> String {
        self.self_test.map_or(String::new(), |SelfTested { shift_dps, u_dps, samples }| {
            format!(
                "  self-test     shifts the rate by {shift_dps:+.4} °/s, u = {u_dps:.4} ({samples} samples without \
                 and with; its proper size is not published, F-11)\n"
            )
        })
    }

    fn bus_text(&self) -> String {
        let Some(sclk_hz) = self.sclk_hz else { return String::new() };
        let read = self.read_us.map_or(String::new(), |read_us| format!(", {read_us:.0} µs a read"));
        let mhz = |hz: u32| f64::from(hz) * 1e-6;
        let fastest = self
            .fastest_clean_sclk_hz
            .map_or("at none of the clocks tried".to_owned(), |hz| format!("up to {} MHz", mhz(hz)));
        let proposal = self.proposal.as_ref().map_or(String::new(), |options| format!("; try {options}"));
        format!(
            "  SPI           {} MHz{read}; reads back {fastest}\n  host          takes {:.1} % of the \
             samples{proposal}\n",
            mhz(sclk_hz),
            self.taken * 100.0
        )
    }
}
