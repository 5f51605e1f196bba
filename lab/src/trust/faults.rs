//! The part fails at a random moment of a calibration.

use super::bench::{Bench, Folder, Run, SHORT, SHORT_S, random};
use super::{Class, Verdict};
use anyhow::{Context, Result};
use rand::RngExt;
use serde_json::Value;

/// A fault of the twin, and the texts by which a user can recognise it.
pub struct Fault {
    pub name: &'static str,
    pub keys: &'static str,
    /// Texts of the true cause. The error must contain one of them.
    pub causes: &'static [&'static str],
}

pub const FAULTS: [Fault; 9] = [
    Fault { name: "sdo_low", keys: "", causes: &["stuck at zeros"] },
    Fault { name: "sdo_high", keys: "", causes: &["stuck at ones"] },
    Fault { name: "frozen", keys: "", causes: &["frozen"] },
    Fault { name: "rdy_lost", keys: "", causes: &["data ready"] },
    Fault { name: "rdy_stutter", keys: "", causes: &["RDY", "data ready"] },
    Fault { name: "bit_errors", keys: ",bit_error_rate=1e-5", causes: &["bit error", "carries errors", "impossible"] },
    Fault { name: "brownout", keys: "", causes: &["lost its configuration"] },
    Fault { name: "unplug", keys: "", causes: &["unplugged"] },
    Fault { name: "none", keys: "", causes: &[] },
];

/// The fault whose name is the last word of a class's name.
pub fn fault_of(class: &str) -> Result<&'static Fault> {
    let name = class.rsplit(' ').next().unwrap_or_default();
    FAULTS.iter().find(|fault| fault.name == name).with_context(|| format!("no fault {name}"))
}

const fn class(name: &'static str, what: &'static str) -> Class {
    Class { name, what, quick: 4, run: calibrate }
}

pub const CLASSES: &[Class] = &[
    class("calibrate none", "nothing breaks: how often is a good unit refused or off?"),
    class("calibrate sdo_low", "SDO falls to 0"),
    class("calibrate sdo_high", "SDO rises to 1"),
    class("calibrate frozen", "the data registers stop"),
    class("calibrate rdy_lost", "the RDY line breaks"),
    class("calibrate rdy_stutter", "edges of RDY are missing"),
    class("calibrate bit_errors", "one bit in 100 000 flips, in both directions"),
    class("calibrate brownout", "the supply dips, and the registers reset"),
    class("calibrate unplug", "the cable is pulled"),
];

/// A result is wrong if a value is off by more standard uncertainties than this, as 1 of 16 000 is without a fault.
pub const WRONG_U: f64 = 4.0;

fn calibrate(bench: &Bench, class: &'static str, seed: u64) -> Result<Verdict> {
    let fault = fault_of(class)?;
    let at_s = random(class, seed).random_range(0.0..SHORT_S);
    let Fault { name, keys, causes } = fault;
    let device = format!("twin:seed={seed},fault={name},fault_at_s={at_s:.3}{keys}");
    let folder = Folder::new(&format!("{name}-{seed}"))?;
    let file = folder.file("unit.toml");
    let run = bench.run(&[&["calibrate", "--device", &device, "-o", &file, "--json"], &SHORT[..]].concat())?;
    if run.code == Some(0) {
        return judge(&run);
    }
    Ok(match (run.refusal(causes), folder.names()?.as_slice()) {
        (verdict @ (Verdict::Refused | Verdict::Misjudged(_)), []) => verdict,
        (Verdict::Refused | Verdict::Misjudged(_), left) => Verdict::Silent(format!("refused, but it left {left:?}")),
        (verdict, _) => verdict,
    })
}

/// Codes of warnings that do not count, because they do not say that a value may be wrong.
const ALWAYS: [&str; 2] = ["short-average", "lost-samples"];

pub fn judge(run: &Run) -> Result<Verdict> {
    let result = run.json()?;
    let number = |value: &Value| value.as_f64().context("a number");
    let mut worst: f64 = 0.0;
    for (value, u) in [("pbc_dps", "u_pbc_dps"), ("btc_dps_per_c", "u_btc_dps_per_c")] {
        let error = number(&result[value])? - number(&result["truth"][value])?;
        worst = worst.max((error / number(&result[u])?).abs());
    }
    if worst <= WRONG_U {
        return Ok(Verdict::Right);
    }
    let warnings = result["warnings"].as_array().context("warnings")?;
    let mut texts = warnings.iter().filter_map(Value::as_str);
    let is_told = texts.any(|text| !ALWAYS.iter().any(|code| text.starts_with(code)));
    Ok(if is_told { Verdict::Warned } else { Verdict::Silent(format!("off by {worst:.1} u: {result}")) })
}
