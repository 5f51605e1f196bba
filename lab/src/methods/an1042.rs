//! A short form of AN-1042 on means over 0.1 s: steps 4, 6, 8 and 9 of F-51, without the real procedure's checks.

use super::unit::{MEAN_S, Recording};
use crate::trial::Rig;
use adis16130_twin::{Mean, Spec};
use anyhow::{Context, ensure};
use zerorate::{Action, Axis, Correction, Event, Plan, Procedure, Reading};

pub fn fit(recording: &Recording) -> Correction {
    let plan = Plan::default();
    let second_s = plan.average_s + plan.warmup_s;
    let offset_s = second_s + plan.average_s + plan.settle_s;
    let (first, second) =
        (recording.window(0.0, plan.average_s), recording.window(second_s, second_s + plan.average_s));
    let offset = recording.window(offset_s, offset_s + plan.offset_s);
    let t3_c = recording.window(offset_s + plan.offset_s, f64::INFINITY).temp_c;
    let btc_dps_per_c = -(second.rate_dps - first.rate_dps) / (second.temp_c - first.temp_c);
    Correction::line(-offset.rate_dps, btc_dps_per_c, t3_c)
}

/// The results of the short form minus those of the real procedure, at its T3, for the same samples of the twin.
#[derive(Clone, Copy, Debug)]
pub struct Difference {
    pub pbc_dps: f64,
    pub btc_dps_per_c: f64,
}

/// Runs the real procedure of 53 minutes on the twin, through bus and driver, and the short form on the same samples.
pub fn held_against_the_procedure(spec: Spec) -> anyhow::Result<Difference> {
    let mut rig = Rig::new(spec);
    let mut procedure = Procedure::new(&Axis::ADIS16130, Plan::default())?;
    let mut sums = Sums::default();
    loop {
        match procedure.next() {
            Action::Initialise => {
                let t_ns = rig.initialise()?;
                sums.start_ns = t_ns;
                procedure.handle(Event::Initialised { t_ns })?;
            }
            Action::Read => {
                let sample = rig.read()?;
                let reading = Reading::from(&sample);
                sums.push(sample.t_ns, &reading)?;
                procedure.handle(Event::Reading(&reading))?;
            }
            Action::Done => break,
        }
    }
    let short = fit(&Recording { means: sums.means()?, truth: rig.twin.truth() });
    let real = procedure.finish()?.correction;
    Ok(Difference {
        pbc_dps: short.at(real.t3_c) - real.pbc_dps,
        btc_dps_per_c: short.btc_dps_per_c - real.btc_dps_per_c,
    })
}

/// Sums over intervals of 0.1 s.
#[derive(Default)]
struct Sums {
    start_ns: u64,
    /// For each interval: sum of the rates, °/s, sum of the temperatures, °C, and number of samples.
    all: Vec<(f64, f64, u32)>,
}

impl Sums {
    fn push(&mut self, t_ns: u64, reading: &Reading) -> anyhow::Result<()> {
        let axis = Axis::ADIS16130;
        let temp = reading.temp.context("a sample without temperature")?;
        let index = ((t_ns - self.start_ns) as f64 * 1e-9 / MEAN_S) as usize;
        if index >= self.all.len() {
            self.all.resize(index + 1, (0.0, 0.0, 0));
        }
        let (rate_dps, temp_c, count) = &mut self.all[index];
        *rate_dps += axis.rate.value(reading.rate.into());
        *temp_c += axis.temp.value(temp.into());
        *count += 1;
        Ok(())
    }

    fn means(&self) -> anyhow::Result<Vec<Mean>> {
        ensure!(self.all.iter().all(|(.., count)| *count > 0), "0.1 s without a sample");
        let mean = |(index, (rate_dps, temp_c, count)): (usize, &(f64, f64, u32))| Mean {
            start_s: index as f64 * MEAN_S,
            length_s: MEAN_S,
            rate_dps: rate_dps / f64::from(*count),
            temp_c: temp_c / f64::from(*count),
        };
        Ok(self.all.iter().enumerate().map(mean).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::super::unit::Kind;
    use super::*;

    /// Without noise, two temperatures determine a linear unit at all temperatures. The error comes from the change of
    /// temperature between the middle of step 8 and T3: some 0.005 °C in still air.
    #[test]
    fn a_quiet_line_is_found() {
        let spec = Spec { noise: false, ambient_wander_c: 0.0, ..Kind::Linear.spec(3, 0.0) };
        let recording = Recording::warm_up(&spec, crate::trial::HOUR_S);
        let found = fit(&recording);
        for temp_c in recording.temps_c() {
            assert!((found.at(temp_c) + recording.truth.bias_dps(temp_c)).abs() < 3e-4, "{temp_c}: {found:?}");
        }
    }
}
