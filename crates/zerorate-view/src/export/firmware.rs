//! Fills the templates of the C header and the Rust module.

use super::codes::{Codes, Integer};
use super::layout::Layout;
use super::prefix::Prefix;
use super::{Export, InvalidOptions, warnings};
use anyhow::{Context, Result, bail, ensure};
use zerorate::calibration::{CalibratedAxis, Notes};
use zerorate::{
    Calibration, Correction, CurveForm, IntegerCorrection, IntegerCurve, RowIndex, Scale, TableRow, Validity,
};

/// The keys of a template, each with the text that replaces `@KEY@`.
type Entries = Vec<(&'static str, String)>;

/// The templates for a language, and the form of values in it.
struct Language {
    /// The template for the only axis of an ADIS16130 with a linear correction.
    one: &'static str,
    /// The templates for any sensor: `common` is written once, and `axis` once for each axis.
    common: &'static str,
    axis: &'static str,
    /// The templates of the functions that correct raw codes: for a linear correction, and for a curve.
    integer: [&'static str; 2],
    /// The start of each line of the head comment.
    margin: &'static str,
    /// The names of the integer types for 32-bit codes, signed and unsigned.
    integers: [&'static str; 2],
    /// Writes a 64-bit integer constant.
    constant: fn(i64) -> String,
    function_case: fn(&str) -> String,
    /// Number of initial characters by which every compiler of the language tells names apart.
    significant: usize,
}

const C: Language = Language {
    one: include_str!("calibration.h.in"),
    common: include_str!("axes.h.in"),
    axis: include_str!("axis.h.in"),
    integer: [include_str!("line.h.in"), include_str!("curve.h.in")],
    margin: " *",
    integers: ["int32_t", "uint32_t"],
    constant: |code| format!("INT64_C({code})"),
    function_case: str::to_owned,
    significant: 63, // C99, 5.2.4.1: names without external linkage, as all of the header's are
};

const RUST: Language = Language {
    one: include_str!("calibration.rs.in"),
    common: include_str!("axes.rs.in"),
    axis: include_str!("axis.rs.in"),
    integer: [include_str!("line.rs.in"), include_str!("curve.rs.in")],
    margin: "//",
    integers: ["i32", "u32"],
    constant: |code| code.to_string(),
    function_case: str::to_ascii_lowercase,
    significant: usize::MAX,
};

/// The longest name of an axis in the templates, without its prefix.
const LONGEST_NAME: &str = "table_lookup_udps";

/// The C header. Without a prefix, its names begin with `zerorate`.
pub(super) fn c(export: &Export, prefix: Option<&Prefix>) -> Result<String> {
    let functions = prefix.map_or("zerorate_".to_owned(), Prefix::of_functions);
    let constants = prefix.map_or("ZERORATE_".to_owned(), Prefix::of_constants);
    written(&C, export, functions, constants)
}

/// The Rust module. Without a prefix, the modules of all sensors have the same names inside.
pub(super) fn rust(export: &Export, prefix: Option<&Prefix>) -> Result<String> {
    let functions = prefix.map_or_else(String::new, Prefix::of_functions_in_rust);
    let constants = prefix.map_or_else(String::new, Prefix::of_constants);
    written(&RUST, export, functions, constants)
}

fn written(language: &Language, export: &Export, functions: String, constants: String) -> Result<String> {
    let axes: Vec<AxisCodes> =
        export.calibration.axes.iter().map(|axis| AxisCodes::new(export, axis)).collect::<Result<_>>()?;
    let names = names(&axes)?;
    let first = axes.first().context("the calibration has no axis")?;
    let common = [origin(export), formula(export), range(&export.layout, &first.codes.temp), layout(export, &axes)?];
    let common = [vec![("f", functions.clone()), ("C", constants.clone())], common.concat()].concat();
    let plain = export.calibration.is_plain();
    if plain && matches!(first.codes.integer, Integer::Line(..)) {
        return Ok(fill(language.one, &[common, first.entries(language, &export.tables[0])?].concat()));
    }
    let mut each = String::new();
    for ((axis, name), rows) in axes.iter().zip(names).zip(&export.tables) {
        let own = match plain {
            true => [functions.clone(), constants.clone()],
            false => {
                let function = format!("{functions}{}_", (language.function_case)(&name));
                [function, format!("{constants}{}_", name.to_ascii_uppercase())]
            }
        };
        ensure!(
            own[0].len() + LONGEST_NAME.len() <= language.significant,
            "{}{LONGEST_NAME} has more than the {} characters by which C tells names apart: choose a shorter prefix, \
             or rename axis {} in the calibration",
            own[0],
            language.significant,
            axis.axis.name
        );
        let integer = language.integer[usize::from(matches!(axis.codes.integer, Integer::Curve(..)))];
        let own = ["INTEGER", "a", "A"].into_iter().zip([vec![integer.to_owned()], own.to_vec()].concat()).collect();
        let typed = axis.codes.typed(language, plain);
        let entries = [own, axis.entries(language, rows)?, typed, common.clone()].concat();
        each += &fill(language.axis, &entries);
    }
    let names = export.calibration.axes.iter().map(|axis| axis.name.as_str()).collect::<Vec<_>>().join(", ");
    let names = if axes.len() == 1 { format!("axis {names}") } else { format!("axes {names}") };
    let last = vec![("NAMES", names), ("EACH_AXIS", each.trim_end().to_owned())];
    Ok(fill(language.common, &[common, first.codes.typed(language, plain), last].concat()))
}

/// Replaces each `@KEY@` of the template, entry by entry. The text of an entry may contain keys of later entries.
fn fill(template: &str, entries: &[(&'static str, String)]) -> String {
    entries.iter().fold(template.to_owned(), |text, (key, value)| text.replace(&format!("@{key}@"), value))
}

/// Makes an identifier of each axis name. Returns an error if two axes get the same identifier.
fn names(axes: &[AxisCodes]) -> Result<Vec<String>> {
    let mut names: Vec<String> = Vec::new();
    for AxisCodes { axis, .. } in axes {
        let words = axis.name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
        let word = words.collect::<Vec<_>>().join("_");
        let named = word.starts_with(|c: char| c.is_ascii_alphabetic());
        let name = if named { word } else { format!("axis_{word}") };
        let same = names.iter().position(|other| other.eq_ignore_ascii_case(&name));
        if let Some(other) = same {
            bail!(
                "axes {} and {} both become {name} in C and Rust: rename one in the calibration",
                axes[other].axis.name,
                axis.name
            );
        }
        names.push(name);
    }
    Ok(names)
}

struct AxisCodes<'a> {
    axis: &'a CalibratedAxis,
    codes: Codes,
    step_c: f64,
    span_c: f64,
}

impl<'a> AxisCodes<'a> {
    fn new(export: &Export, axis: &'a CalibratedAxis) -> Result<Self> {
        let name = &axis.name;
        let codes = Codes::of(&export.calibration, axis)?.with_context(|| {
            format!(
                "C and Rust correct codes, and the calibration does not state the scale of the codes of axis {name}. \
                 Add [axis.rate] and [temperature] to the file (docs/formats/calibration.md), or take the form csv"
            )
        })?;
        Ok(Self { axis, codes, step_c: export.layout.step_c, span_c: export.layout.span_c })
    }

    fn entries(&self, language: &Language, rows: &[TableRow]) -> Result<Entries> {
        let Self { axis, codes, step_c, span_c } = self;
        let correction = axis.correction;
        let index = RowIndex::new(rows.len(), *step_c, correction.t3_c, &codes.temp);
        let rows: Result<Vec<i32>> = rows.iter().map(|row| millionths(row.correction_dps)).collect();
        let integer = match &codes.integer {
            Integer::Line(line, form) => of_line(line, form.q),
            Integer::Curve(curve, form) => of_curve(curve, form, &codes.temp),
        };
        let entries = vec![
            ("AXIS", axis.name.clone()),
            ("PBC", correction.pbc_dps.to_string()),
            ("BTC", correction.btc_dps_per_c.to_string()),
            ("T3", correction.t3_c.to_string()),
            ("PBC_UDPS", millionths(correction.pbc_dps)?.to_string()),
            ("TERMS", terms(&correction, language.margin)),
            ("DISTANCE", distance(&correction).to_owned()),
            ("T3_CODE", codes.integer.t3_code().to_string()),
            ("MIDDLE_Q", index.middle_q.to_string()),
            ("LSB_PER_DPS", codes.rate.lsb_per_unit.to_string()),
            ("RATE_ZERO", codes.rate.zero_code.to_string()),
            ("RATE_CODES", in_words(&codes.rate)),
            ("STEP_DPS", format!("{:.5}", correction.steepest_dps_per_c(*span_c) * step_c / 2.0)),
            ("TABLE", lines(&rows?)),
        ];
        Ok([integer, entries].concat())
    }
}

fn of_line(line: &IntegerCorrection, q: u32) -> Entries {
    let &IntegerCorrection { offset_q, slope_q, .. } = line;
    vec![("OFFSET_Q", offset_q.to_string()), ("SLOPE_Q", slope_q.to_string()), ("Q", q.to_string())]
}

fn of_curve(curve: &IntegerCurve, form: &CurveForm, temp: &Scale) -> Entries {
    let [t0, t1, t2, t3] = curve.terms.map(|term| term.to_string());
    let (first, last) = form.reach();
    vec![
        ("TERM_0", t0),
        ("TERM_1", t1),
        ("TERM_2", t2),
        ("TERM_3", t3),
        ("FRACTION", curve.fraction.to_string()),
        ("BOUND", format!("{:.2}", curve.bound_codes())),
        ("TEMP_SHIFT", form.temp_shift.to_string()),
        ("REACH_FIRST", first.to_string()),
        ("REACH_LAST", last.to_string()),
        ("REACH_C", format!("{:.0}", (last as f64 / temp.lsb_per_unit).floor())),
    ]
}

/// The lines after T3 in the head comment that state the higher terms; empty for a linear correction.
fn terms(correction: &Correction, margin: &str) -> String {
    let Correction { btc2_dps_per_c2, btc3_dps_per_c3, .. } = correction;
    match correction.is_line() {
        true => String::new(),
        false => format!(
            "\n{margin}   BTC2 = {btc2_dps_per_c2:?} deg/s per (deg C)^2\n{margin}   \
             BTC3 = {btc3_dps_per_c3:?} deg/s per (deg C)^3"
        ),
    }
}

/// Describes the error of the last table row if it is used beyond the table.
fn distance(correction: &Correction) -> &'static str {
    if correction.is_line() { "BTC times the distance to it" } else { "what the curve does on the way to it" }
}

/// The entries that describe the formula of the correction and the formula of a table row.
fn formula(export: &Export) -> Entries {
    let lines = export.calibration.axes.iter().all(|axis| axis.correction.is_line());
    let [of, each, row_of] = match lines {
        true => ["(Analog Devices AN-1042)", "Both", "(TEMP - T3) * BTC"],
        false => [
            "(of AN-1042 by Analog Devices, with two terms more)",
            "All",
            "d * (BTC + d * (BTC2 + d * BTC3)), d = TEMP - T3",
        ],
    };
    [("FORMULA_OF", of), ("EACH", each), ("ROW_OF", row_of)].map(|(key, text)| (key, text.to_owned())).to_vec()
}

impl Codes {
    /// The integer types and the constants of the codes.
    ///
    /// With `plain`, the types are unsigned as in the linear export of an ADIS16130.
    fn typed(&self, language: &Language, plain: bool) -> Entries {
        let integer = |scale: &Scale| {
            let fits = scale.codes().1 <= i64::from(i32::MAX);
            language.integers[usize::from(plain || !fits)].to_owned()
        };
        let (rate_codes, temp_codes) = (self.rate.codes(), self.temp.codes());
        let constant = |code| (language.constant)(code);
        vec![
            ("RATE_T", integer(&self.rate)),
            ("TEMP_T", integer(&self.temp)),
            ("RATE_FIRST", constant(rate_codes.0)),
            ("RATE_LAST", constant(rate_codes.1)),
            ("TEMP_FIRST", constant(temp_codes.0)),
            ("TEMP_LAST", constant(temp_codes.1)),
        ]
    }
}

/// The origin of the calibration, for the head comment.
fn origin(export: &Export) -> Entries {
    let calibration = &export.calibration;
    let text = |value: &Option<String>| value.as_deref().map_or("not stated".to_owned(), comment);
    vec![
        ("SOFTWARE", zerorate::SOFTWARE.to_owned()),
        ("PART", comment(&calibration.part)),
        ("SERIAL", text(&calibration.serial)),
        ("CREATED", text(&calibration.created)),
        ("METHOD", text(&calibration.method) + &warned(calibration)),
        ("CIRCUMSTANCES", circumstances(calibration)),
        ("ID", calibration.id()),
    ]
}

/// The codes of the calibration's warnings, except the standing ones.
fn warned(calibration: &Calibration) -> String {
    let warnings = warnings(calibration);
    let codes: Vec<String> = warnings.iter().filter_map(|line| Some(comment(line.split_once(": ")?.0))).collect();
    if codes.is_empty() { String::new() } else { format!(", warned of {}", codes.join(", ")) }
}

fn circumstances(calibration: &Calibration) -> String {
    let Notes { supply, ambient, operator, host } = &calibration.notes;
    let stated = [
        ("device", &calibration.device),
        ("computer", host),
        ("operator", operator),
        ("supply", supply),
        ("surroundings", ambient),
    ];
    let stated = stated.into_iter().filter_map(|(name, value)| Some(format!("{name} {}", comment(value.as_ref()?))));
    let stated: Vec<String> = stated.collect();
    if stated.is_empty() { "not stated".to_owned() } else { stated.join(", ") }
}

/// An upper bound of the middle row's index in any table, times 2³².
const MIDDLE_MOST: i64 = 1 << 50;

/// The entries for step, span and number of rows, which the tables of all axes share. Returns an error if the step is
/// too fine for the integers of the firmware, or step or span is not a whole number of millionths of a °C.
fn layout(export: &Export, axes: &[AxisCodes]) -> Result<Entries> {
    let Export { layout, tables, .. } = export;
    let (rows, temp) = (tables[0].len(), &axes[0].codes.temp);
    let index = RowIndex::new(rows, layout.step_c, axes[0].axis.correction.t3_c, temp);
    let fits = i128::from(index.rows_per_code_q) * (temp.span() as i128 + 1) < i128::from(i64::MAX - MIDDLE_MOST);
    let fine =
        || InvalidOptions(format!("a step of {} °C is far finer than a code of the temperature", layout.step_c));
    ensure!(fits, fine());
    Ok(vec![
        ("STEP_C", layout.step_c.to_string()),
        ("SPAN_C", layout.span_c.to_string()),
        ("STEP_UC", whole_millionths("the step", layout.step_c)?.to_string()),
        ("SPAN_UC", whole_millionths("the span", layout.span_c)?.to_string()),
        ("ROWS_PER_CODE_Q", index.rows_per_code_q.to_string()),
        ("ROW_Q", RowIndex::Q.to_string()),
        ("ROWS", rows.to_string()),
        ("BYTES", (4 * rows).to_string()),
    ])
}

/// The temperature range in which the corrections are valid (in words, in °C and as codes), and the scale of the
/// codes.
fn range(Layout { valid, stated, .. }: &Layout, temp: &Scale) -> Entries {
    let Validity { temp_min_c, temp_max_c, margin_c } = *valid;
    let (first, last) = temp.codes();
    // round inward: no code beyond the range counts as inside
    let least = (temp.code(temp_min_c - margin_c).ceil() as i64).clamp(first, last);
    let most = (temp.code(temp_max_c + margin_c).floor() as i64).clamp(first, last);
    let whence = if *stated { "seen while measuring" } else { "assumed, the calibration states none" };
    vec![
        ("VALID", format!("{temp_min_c:.1} to {temp_max_c:.1} deg C, {whence}")),
        ("TEMP_MIN_C", format!("{temp_min_c:?}")),
        ("TEMP_MAX_C", format!("{temp_max_c:?}")),
        ("TEMP_MIN_CODE", temp.nearest_code(temp_min_c).to_string()),
        ("TEMP_MAX_CODE", temp.nearest_code(temp_max_c).to_string()),
        ("TEMP_LEAST_CODE", least.to_string()),
        ("TEMP_MOST_CODE", most.max(least).to_string()),
        ("MARGIN_C", margin_c.to_string()),
        ("MARGIN_CODE", (margin_c * temp.lsb_per_unit).round().to_string()),
        ("LSB_PER_C", temp.lsb_per_unit.to_string()),
        ("TEMP_ZERO", temp.zero_code.to_string()),
        ("ZERO_C", temp.zero_value.to_string()),
        ("TEMP_CODES", in_words(temp)),
    ]
}

fn in_words(scale: &Scale) -> String {
    let (first, last) = scale.codes();
    let coding = if scale.signed { "two's complement" } else { "without a sign" };
    format!("{first} to {last}, {} bits, {coding}", scale.width_bits)
}

/// The value in millionths of its unit, rounded to the nearest integer.
fn millionths(value: f64) -> Result<i32> {
    let scaled = (value * 1e6).round();
    ensure!(scaled.abs() <= f64::from(i32::MAX), "{value} does not fit 32 bits in millionths: choose a smaller span");
    Ok(scaled as i32)
}

fn whole_millionths(what: &str, value: f64) -> Result<i32> {
    let whole = millionths(value)?;
    ensure!(
        (value * 1e6 - f64::from(whole)).abs() < 1e-6,
        InvalidOptions(format!("{what} {value} is not a whole number of millionths of a degree"))
    );
    Ok(whole)
}

fn lines(numbers: &[i32]) -> String {
    let line = |numbers: &[i32]| {
        let numbers: Vec<String> = numbers.iter().map(i32::to_string).collect();
        format!("    {},", numbers.join(", "))
    };
    numbers.chunks(8).map(line).collect::<Vec<_>>().join("\n")
}

/// Replaces characters of a calibration's text that could end a comment or confuse a compiler.
pub(super) fn comment(text: &str) -> String {
    let plain =
        |c: char| if c.is_ascii_graphic() && !matches!(c, '@' | '*' | '\\' | '?') || c == ' ' { c } else { '.' };
    text.chars().map(plain).collect()
}
