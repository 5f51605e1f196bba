//! `zerorate help`: the help of a command, or of a topic that several commands share.

use crate::output::print;
use anyhow::Result;
use clap::Args;

/// Print the help of a command, or on a topic: device
#[derive(Args, Debug)]
pub struct HelpArgs {
    /// A command, or the topic device [default: list all commands].
    #[arg(value_name = "COMMAND|TOPIC")]
    about: Option<String>,
}

/// `root` is the command `zerorate`.
pub fn run(args: &HelpArgs, root: clap::Command) -> Result<()> {
    match args.about.as_deref() {
        Some("device") => print(DEVICE),
        // clap prints the help and exits
        about => {
            drop(root.get_matches_from(["zerorate"].into_iter().chain(about).chain(["--help"])));
            Ok(())
        }
    }
}

pub const DEVICE: &str = "\
What --device takes: an address, with options behind ? and & (for twin: they are keys).

  twin:                   a simulated ADIS16130; this is the default
  twin:KEY=VALUE,…        the same with other properties: `zerorate twin` lists the keys. axes=3 makes three
                          of them on one clock, the axes of one part, with consecutive seeds
  replay:FILE             a capture, or with --part a log of that part (docs/formats/part.md)
  spi:/dev/spidevB.C?rdy=gpiochipN:LINE
                          a sensor on an SPI bus of this machine, with its data-ready line (Linux)
  iio:iio:deviceN         any gyroscope that a driver of the Linux kernel reads: through its buffer where it
                          has one, otherwise polled 100 times a second
  bridge:/dev/ttyACM0     a sensor behind a microcontroller (firmware/bridge)
  tcp:HOST:PORT           the same over a socket

Options:

  hz=SCLK                 SPI clock (spi:, bridge:, tcp:); for iio: the polls per second
  mclk=HZ                 master clock of the converter (spi:, bridge:, tcp:)
  baud=N                  speed of the serial port (bridge:)
  framing=command|byte    how CS frames the bytes (all but replay: and iio:)
  width=24|16             conversion words, as are fw=RATE[:TEMP] and chop=0|1 (all but replay: and iio:)
  edge=falling|rising     edge of RDY, rising behind an inverter (all but replay: and iio:)
  divided=N               a counter in the line passes every N-th edge of RDY: tip 2 of AN-1042
                          (all but replay: and iio:)
  roa=10nf                the bandwidth, where a capacitor changes it (all but replay:)
  bandwidth_hz=HZ         the same as a number (all but replay: and twin:)

Examples:

  zerorate probe --device twin:seed=7,bias_dps=0.8
  zerorate probe --device 'spi:/dev/spidev0.0?rdy=gpiochip0:25&width=16'
  zerorate calibrate --device replay:unit.arrows
";

#[cfg(test)]
mod tests {
    use super::DEVICE;
    use zerorate_host::KINDS;

    #[test]
    fn the_topic_names_every_kind_of_device() {
        for kind in KINDS {
            assert!(DEVICE.contains(&format!("\n  {}:", kind.name)), "{}", kind.name);
        }
    }
}
