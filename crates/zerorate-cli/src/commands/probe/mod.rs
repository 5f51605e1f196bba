//! `zerorate probe`: is there a part, is it wired right, and do its samples look like those of one?

mod host;

use super::{coded, print_json, print_lines, warn};
use crate::acquire::Acquisition;
use crate::cli::{DeviceArgs, SamplingArgs};
use crate::interrupt;
use crate::progress::Meter;
use adis16130::{Framing, SelfTest};
use anyhow::{Result, ensure};
use clap::Args;
use serde::Serialize;
use zerorate::{Checkup, Limits};
use zerorate_host::Bus;
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
    rate_dps: f64,
    white_dps_per_rt_hz: Option<f64>,
    #[serde(skip)]
    typical_white_dps_per_rt_hz: Option<f64>,
    temp_c: Option<f64>,
    warnings: Vec<String>,
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
    let mut acquisition = Acquisition::open(&args.device, args.sampling)?;
    let revision = acquisition.initialise()?;
    let bus = acquisition.try_bus()?;
    let self_test = match &args.self_test {
        None => None,
        Some(gpio) => {
            let SelfTest { shift_dps, u_dps, n } = acquisition.self_test(gpio)?;
            Some(SelfTested { shift_dps, u_dps, samples: n })
        }
    };
    let checkup = read(&mut acquisition, args.duration)?;
    ensure!(acquisition.tally().samples > 0, "no samples were read");
    let findings = Findings { self_test, ..Findings::new(acquisition, revision, bus, &checkup) };
    if args.json {
        return print_json(&findings);
    }
    warn(&findings.warnings);
    print_lines(&findings.text())
}

/// Reads samples for so long.
fn read(acquisition: &mut Acquisition, duration: Seconds) -> Result<Checkup> {
    let meter = Meter::new(duration.0);
    let mut checkup = Checkup::default();
    let mut first_ns = None;
    while let Some(judged) = acquisition.next_judged()? {
        checkup.push(&judged);
        let t_ns = judged.reading.t_ns;
        let elapsed_ns = t_ns - *first_ns.get_or_insert(t_ns);
        if elapsed_ns >= duration.nanos() {
            break;
        }
        if acquisition.is_time_to_show() {
            meter.show(elapsed_ns as f64 * 1e-9, "reading samples".to_owned());
        }
    }
    ensure!(!interrupt::asked(), "interrupted");
    Ok(checkup)
}

impl Findings {
    fn new(mut acquisition: Acquisition, revision: Option<u8>, bus: Option<Bus>, checkup: &Checkup) -> Self {
        let of_the_samples = acquisition.warnings();
        let tally = *acquisition.tally();
        let is_frozen = acquisition.health().frozen_at_end().is_some();
        let axis = *acquisition.axis();
        let facts = acquisition.facts();
        let white = checkup.white_dps_per_rt_hz(&axis, tally.rate_hz()).filter(|_| !is_frozen);
        let typical_white_dps_per_rt_hz = axis.noise.map(|noise| noise.white_dps_per_rt_hz);
        let of_the_part = checkup.warnings(&axis, &tally, white, facts.rate_hz, &Limits::default());
        let of_the_part: Vec<String> = of_the_part.iter().map(coded).collect();
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
            proposal: bus.and_then(|bus| bus.read_s).and_then(|read_s| host::proposal(taken, read_s, facts.mclk_hz)),
            rdy_hz: tally.rdy_hz(),
            rate_hz: tally.rate_hz(),
            samples: tally.samples,
            lost_samples: tally.lost,
            longest_gap_ms: tally.longest_gap_ms(),
            duration_s: tally.duration_s(),
            rate_dps: checkup.rate_dps(&axis).unwrap_or_default(),
            white_dps_per_rt_hz: white,
            typical_white_dps_per_rt_hz,
            temp_c: checkup.temp_c(&axis),
            warnings: of_the_samples.into_iter().chain(of_the_part).collect(),
        }
    }

    fn text(&self) -> String {
        let shown =
            |value: Option<f64>, unit: &str| value.map_or("not measured".to_owned(), |v| format!("{v:.4} {unit}"));
        let part = self.revision.map_or(String::new(), |revision| {
            format!("  part          answers, revision {revision:02X}h; every register written reads back\n")
        });
        format!(
            "{}\n{part}{}{}{}  data ready    {:.1} Hz\n  samples       {:.1} a second: {} in {}, {} lost, longest gap \
             {:.3} ms\n  \
             rate          {:+.4} °/s on average\n  white noise   {}{}\n  temperature   {}\n",
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
            self.rate_dps,
            shown(self.white_dps_per_rt_hz, "°/s/√Hz"),
            self.typical_white_dps_per_rt_hz.map_or(String::new(), |typical| format!(" (typical {typical})")),
            shown(self.temp_c, "°C"),
        )
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
