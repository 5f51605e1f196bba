//! Formats the result of a measurement in a chamber for people.

use crate::commands::calibrate::remarks;
use anyhow::Result;
use std::path::Path;
use zerorate::Uncertainty;
use zerorate_jobs::calibrate::POINTS;
use zerorate_jobs::chamber::{AxisReport, ChamberReport, ChamberResults};
use zerorate_view::PlusMinus;
use zerorate_view::duration::Seconds;
use zerorate_view::plot::number;
use zerorate_view::report::{ChamberPage, Fact, chamber_page};

/// `file` is the path of the calibration, if it was saved.
pub fn text(report: &ChamberReport, file: Option<&Path>) -> String {
    let mut text = format!(
        "{}Calibration {} of {}, {}\n{} samples in {}, {} lost, part between {:.1} and {:.1} °C\n",
        if report.simulated { "SIMULATED: " } else { "" },
        report.calibration_id,
        report.device.as_deref().unwrap_or_default(),
        report.plan,
        report.samples,
        Seconds(report.duration_s.round()),
        report.lost_samples,
        report.temp_min_c,
        report.temp_max_c,
    );
    for axis in report.all() {
        text += &axis_text(axis, report.axes.len() > 1);
    }
    text += "± is the 95 % interval; outside these temperatures the correction is an extrapolation\n";
    text += &remarks(&report.remarks);
    match file.map(Path::display) {
        Some(file) => text + &format!("\nWritten to {file}. Next: zerorate report {file} -o report.html\n"),
        None => text + "\nNothing was saved: give -o unit.toml to keep the calibration.\n",
    }
}

pub fn page(results: &ChamberResults) -> Result<String> {
    let ChamberResults { report, calibration, record, outcomes } = results;
    let title = format!("{} in a chamber: {}", calibration.part, report.plan);
    let warnings: Vec<String> = report.warnings.iter().chain(&report.remarks).map(ToString::to_string).collect();
    let facts = report.all().map(facts).collect();
    chamber_page(ChamberPage { title: &title, calibration, record, outcomes, warnings: &warnings, facts })
}

/// Expanded uncertainty of the curve (95 %): rms over [`POINTS`] temperatures of the measured span, °/s.
fn u_dps(axis: &AxisReport) -> f64 {
    let squares: f64 = axis.curve.iter().filter_map(|point| point.u_dps).map(|u_dps| u_dps * u_dps).sum();
    Uncertainty::FACTOR * (squares / f64::from(POINTS)).sqrt()
}

/// Difference from the twin's true curve: rms over the same temperatures as [`u_dps`], °/s. `None` without a twin.
fn off_dps(axis: &AxisReport) -> Option<f64> {
    let truth = &axis.truth.as_ref()?.curve;
    let off = axis.curve.iter().zip(truth).map(|(one, other)| one.correction_dps - other.correction_dps);
    Some((off.map(|off| off * off).sum::<f64>() / f64::from(POINTS)).sqrt())
}

fn facts(axis: &AxisReport) -> Vec<Fact> {
    let factor = Uncertainty::FACTOR;
    let mut facts = vec![
        Fact::new(
            "PBC",
            format!(
                "{} °/s at T3 = {:.2} °C",
                PlusMinus { value: axis.pbc_dps, half: factor * axis.u_pbc_dps },
                axis.t3_c
            ),
        ),
        Fact::new(
            "BTC",
            format!("{} °/s/°C", PlusMinus { value: axis.btc_dps_per_c, half: factor * axis.u_btc_dps_per_c }),
        ),
    ];
    if axis.order > 1 {
        facts.push(Fact::new(
            "BTC2",
            format!("{:+.3e} ± {:.1e} °/s/°C²", axis.btc2_dps_per_c2, factor * axis.u_btc2_dps_per_c2),
        ));
    }
    if axis.order > 2 {
        facts.push(Fact::new(
            "BTC3",
            format!("{:+.3e} ± {:.1e} °/s/°C³", axis.btc3_dps_per_c3, factor * axis.u_btc3_dps_per_c3),
        ));
    }
    let weight = 100.0 * axis.order_weights.get(axis.order).copied().unwrap_or_default();
    facts.push(Fact::new("order", format!("{} (probability {weight:.0} %)", axis.order)));
    facts.push(Fact::new("known to", format!("±{} °/s, rms over the temperatures seen", number(u_dps(axis)))));
    facts.push(Fact::new("lag", format!("{:.0} s", axis.lag_s)));
    let apart = axis.branches.as_ref().map_or_else(
        || "not seen: no temperature was passed in both directions".to_owned(),
        |one| {
            let width = PlusMinus { value: one.half_width_dps, half: factor * one.u_dps };
            format!("{width} °/s, half of cooling less warming, {:.0} to {:.0} °C", one.temp_min_c, one.temp_max_c)
        },
    );
    facts.push(Fact::new("loop", apart));
    facts.extend(off_dps(axis).map(|off_dps| Fact::new("twin's truth", format!("{} °/s off, rms", number(off_dps)))));
    facts
}

fn axis_text(axis: &AxisReport, named: bool) -> String {
    let mut text = if named { format!("\naxis {}\n", axis.name) } else { "\n".to_owned() };
    for Fact { name, value } in facts(axis) {
        text += &format!("  {name:12} {value}\n");
    }
    text += "\n  step   set, °C  part, °C    rate, °/s  corrected, °/s  drift, °C/min\n";
    for point in &axis.points {
        let settled = if point.settled { "" } else { "  not settled" };
        text += &format!(
            "  {:4} {:9.1} {:9.3} {:+12.5} {:+15.5} {:+14.4}{settled}\n",
            point.step, point.set_c, point.temp_c, point.rate_dps, point.residual_dps, point.drift_c_per_min
        );
    }
    text + "\n"
}
