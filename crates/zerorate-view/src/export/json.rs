//! Coefficients and tables as a JSON object.

use super::codes::{self, Codes};
use super::{Export, Layout, tidy, warnings};
use anyhow::Result;
use serde::Serialize;
use zerorate::calibration::CalibratedAxis;
use zerorate::{Calibration, Correction, IntegerCorrection, IntegerCurve, Scale, TableRow};

/// The exported object. The only axis of an ADIS16130 has its `terms` and `derived` here. Other axes are in `axes`,
/// and then the object names the part.
#[derive(Serialize)]
struct Object<'a> {
    calibration_id: String,
    simulated: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    part: Option<&'a str>,
    serial: Option<&'a str>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    warnings: Vec<String>,
    #[serde(flatten)]
    terms: Option<Terms>,
    temp_min_c: Option<f64>,
    temp_max_c: Option<f64>,
    valid: Valid,
    #[serde(flatten)]
    derived: Option<Derived>,
    #[serde(skip_serializing_if = "Option::is_none")]
    axes: Option<Vec<Axis<'a>>>,
}

#[derive(Serialize)]
struct Axis<'a> {
    name: &'a str,
    #[serde(flatten)]
    terms: Terms,
    #[serde(flatten)]
    derived: Derived,
}

#[derive(Serialize)]
struct Terms {
    pbc_dps: f64,
    btc_dps_per_c: f64,
    t3_c: f64,
    #[serde(flatten)]
    curve: Option<Curve>,
}

#[derive(Serialize)]
struct Curve {
    btc2_dps_per_c2: f64,
    btc3_dps_per_c3: f64,
}

#[derive(Serialize)]
struct Derived {
    /// The integer correction; null if the calibration does not state the scale of the codes.
    integer: Option<Integer>,
    table: Table,
}

#[derive(Serialize)]
#[serde(untagged)]
enum Integer {
    Line(Line),
    Curve(CurveFields),
}

/// The fields of [`zerorate::IntegerCorrection`].
#[derive(Serialize)]
struct Line {
    q: u32,
    offset_q: i64,
    slope_q: i32,
    t3_code: i32,
    /// The ranges of the codes. Absent for an ADIS16130, whose ranges are known.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    codes: Option<Ranges>,
}

/// The fields of [`zerorate::IntegerCurve`].
#[derive(Serialize)]
struct CurveFields {
    terms: [i32; 4],
    fraction: u32,
    temp_shift: u32,
    t3_code: i32,
    bound_codes: f64,
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    codes: Option<Ranges>,
}

#[derive(Serialize)]
struct Ranges {
    rate_first_code: i64,
    rate_last_code: i64,
    temp_first_code: i64,
    temp_last_code: i64,
}

#[derive(Serialize)]
struct Valid {
    /// True if the calibration states the range; otherwise it is assumed.
    stated: bool,
    temp_min_c: f64,
    temp_max_c: f64,
    temp_min_code: Option<i64>,
    temp_max_code: Option<i64>,
}

#[derive(Serialize)]
struct Table {
    step_c: f64,
    span_c: f64,
    /// The largest error of a curve's table with the nearest row, °/s. `linear_dps` is the same with linear
    /// interpolation.
    #[serde(skip_serializing_if = "Option::is_none")]
    nearest_dps: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    linear_dps: Option<f64>,
    rows: Vec<LookUpRow>,
}

#[derive(Serialize)]
struct LookUpRow {
    delta_c: f64,
    correction_dps: f64,
}

pub(super) fn text(export: &Export) -> Result<String> {
    let Export { calibration, layout, tables, .. } = export;
    let axes = calibration.axes.iter().zip(tables);
    let mut axes: Vec<Axis> =
        axes.map(|(axis, rows)| self::axis(calibration, axis, layout, rows)).collect::<Result<_>>()?;
    let is_plain = calibration.is_plain();
    let only = is_plain.then(|| axes.remove(0));
    let (terms, derived) = only.map(|axis| (axis.terms, axis.derived)).unzip();
    let object = Object {
        calibration_id: calibration.id(),
        simulated: calibration.is_simulated(),
        part: (!is_plain).then_some(calibration.part.as_str()),
        serial: calibration.serial.as_deref(),
        warnings: warnings(calibration),
        terms,
        temp_min_c: calibration.validity.map(|span| span.temp_min_c),
        temp_max_c: calibration.validity.map(|span| span.temp_max_c),
        valid: valid(layout, calibration.temp.as_ref()),
        derived,
        axes: (!is_plain).then_some(axes),
    };
    Ok(serde_json::to_string_pretty(&object)? + "\n")
}

fn axis<'a>(
    calibration: &Calibration,
    axis: &'a CalibratedAxis,
    layout: &Layout,
    rows: &[TableRow],
) -> Result<Axis<'a>> {
    let codes = Codes::of(calibration, axis)?;
    let &Layout { step_c, span_c, .. } = layout;
    let curved = Some(&axis.correction).filter(|correction| !correction.is_line());
    let row = |row: &TableRow| LookUpRow { delta_c: tidy(row.delta_c), correction_dps: tidy(row.correction_dps) };
    let Correction { pbc_dps, btc_dps_per_c, t3_c, btc2_dps_per_c2, btc3_dps_per_c3 } = axis.correction;
    let curve = curved.map(|_| Curve { btc2_dps_per_c2, btc3_dps_per_c3 });
    let table = Table {
        step_c,
        span_c,
        nearest_dps: curved.map(|curve| tidy(curve.steepest_dps_per_c(span_c) * step_c / 2.0)),
        linear_dps: curved.map(|curve| tidy(curve.bend_dps(step_c, span_c))),
        rows: rows.iter().map(row).collect(),
    };
    let integer = codes.map(|codes| integer(&codes, !calibration.is_plain()));
    Ok(Axis {
        name: &axis.name,
        terms: Terms { pbc_dps, btc_dps_per_c, t3_c, curve },
        derived: Derived { integer, table },
    })
}

fn integer(of: &Codes, with_ranges: bool) -> Integer {
    let (rate, temp) = (of.rate.codes(), of.temp.codes());
    let codes = with_ranges.then_some(Ranges {
        rate_first_code: rate.0,
        rate_last_code: rate.1,
        temp_first_code: temp.0,
        temp_last_code: temp.1,
    });
    match &of.integer {
        codes::Integer::Line(line, form) => {
            let IntegerCorrection { offset_q, slope_q, t3_code } = *line;
            Integer::Line(Line { q: form.q, offset_q, slope_q, t3_code, codes })
        }
        codes::Integer::Curve(curve, form) => {
            let IntegerCurve { terms, t3_code, fraction } = *curve;
            let (temp_shift, bound_codes) = (form.temp_shift, curve.bound_codes());
            Integer::Curve(CurveFields { terms, fraction, temp_shift, t3_code, bound_codes, codes })
        }
    }
}

fn valid(layout: &Layout, temp: Option<&Scale>) -> Valid {
    let valid = layout.valid;
    Valid {
        stated: layout.stated,
        temp_min_c: valid.temp_min_c,
        temp_max_c: valid.temp_max_c,
        temp_min_code: temp.map(|temp| temp.nearest_code(valid.temp_min_c)),
        temp_max_code: temp.map(|temp| temp.nearest_code(valid.temp_max_c)),
    }
}
