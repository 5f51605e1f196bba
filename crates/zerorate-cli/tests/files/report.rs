//! The page of a calibration, as a browser gets it.

#[path = "../../../zerorate/tests/core/outcome/mod.rs"]
mod outcome;

use super::Bench;
use zerorate::calibration::{Calibration, Origin};
use zerorate::{Correction, Outcome, Part, Uncertainty};

/// A calibration with every field, and with texts that look like HTML.
fn measured() -> String {
    let whole = outcome::outcome();
    let uncertainty = Uncertainty {
        u_pbc_dps: 0.005,
        u_btc_dps_per_c: 0.001,
        u_curvature_dps_per_c: 0.0008,
        u_t3_c: 0.0005,
        ..whole.uncertainty
    };
    let found = Outcome { correction: Correction::line(-0.25, -0.04, 31.5), uncertainty, ..whole };
    let origin = Origin {
        serial: Some("<script>alert('SN17')</script>".into()),
        created: Some("2026-11-21T10:00:00Z".into()),
        software: "zerorate 0.1.0".into(),
        device: "spi:/dev/spidev0.0?rdy=gpiochip0:25&hz=4000000".into(),
        capture_sha256: "ab".repeat(32),
        ..Origin::default()
    };
    let mut unit = Calibration::new(&Part::ADIS16130, &[found], origin);
    unit.warnings = vec!["3 samples < 4 & lost".into()];
    unit.to_toml()
}

#[test]
fn the_page_says_all_that_the_calibration_knows() {
    let bench = Bench::new();
    bench.write("unit.toml", measured());
    let html = bench.zerorate("report unit.toml").ok();
    for expected in [
        "&#60;script&#62;",
        "2026-11-21T10:00:00Z",
        "an1042",
        "95 % interval",
        // the 95 % intervals −0.25 ± 1.96 × 0.005, −0.04 ± 1.96 × 0.001 and 31.5 ± 1.96 × 0.0005
        "-0.25980 … -0.24020",
        "-0.041960 … -0.038040",
        "+31.4990 … +31.5010",
        "25.10 … 33.20 °C",
        "18051234",
        "3 samples &#60; 4 &#38; lost",
        "52m51s",
        "RBC = RATE + PBC + (TEMP − T3) · BTC",
        "zerorate 0.1.0",
        &"ab".repeat(32),
        "gpiochip0:25&#38;hz=4000000",
        "measured here",
        // the correction at 26 °C: −0.25 − 0.04 · (26 − 31.5)
        "26.00</td><td class=\"number\">-0.030000</td>",
    ] {
        assert!(html.contains(expected), "{expected} in {html}");
    }
}

#[test]
fn the_page_needs_nothing_else_and_obeys_nobody() {
    let bench = Bench::new();
    bench.write("unit.toml", measured());
    let html = bench.zerorate("report unit.toml").ok();
    for forbidden in ["<script", "http:", "https:", "<link", "<img", "@import", "url(h"] {
        let elsewhere = html.replace("http://www.w3.org/2000/svg", "");
        assert!(!elsewhere.contains(forbidden), "{forbidden} in {html}");
    }
    let start = html.find("<svg").unwrap();
    let end = html.find("</svg>").unwrap() + "</svg>".len();
    roxmltree::Document::parse(&html[start..end]).unwrap();
}

#[cfg(feature = "png")]
#[test]
fn a_picture_of_the_page_may_be_a_png() {
    let bench = Bench::new();
    bench.write("unit.toml", measured());
    bench.zerorate("report unit.toml -o unit.PNG").ok();
    assert!(std::fs::read(bench.path("unit.PNG")).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn a_picture_of_the_page_can_be_had_alone() {
    let bench = Bench::new();
    bench.write("unit.toml", measured());
    bench.zerorate("report unit.toml -o unit.svg").ok();
    let svg = bench.text("unit.svg");
    assert!(
        roxmltree::Document::parse(&svg).unwrap().root_element().has_tag_name(("http://www.w3.org/2000/svg", "svg"))
    );
    assert!(bench.zerorate("report unit.toml").ok().contains(svg.trim()), "it is the picture of the page");
    bench.write("axes.toml", super::AXES);
    bench.zerorate("report axes.toml -o axes.svg").fails(2, &["a picture shows one axis"]);
    bench.zerorate("report absent.toml -o axes.svg").fails(1, &["cannot read absent.toml"]);
    assert!(!bench.path("axes.svg").exists());
}

#[test]
fn every_axis_has_its_section() {
    let bench = Bench::new();
    bench.write("unit.toml", super::AXES);
    let html = bench.zerorate("report unit.toml").ok();
    assert_eq!(html.matches("<svg").count(), 3);
    let sections: Vec<&str> = html.split("<h2>Axis ").skip(1).collect();
    for (section, (name, pbc)) in sections.iter().zip([("x", "-0.25000"), ("y", "+0.75000"), ("z", "+0.10000")]) {
        assert!(section.starts_with(name) && section.contains(pbc) && section.contains("<h3>Look-up table</h3>"));
    }
    assert!(html.contains("Calibration of ADIS16405") && sections[1].contains("Warning: y &#60; alone"), "{html}");
}

/// The page of a curve has its terms in the formula, the table and the caption. The page of a line does not.
#[test]
fn the_page_shows_a_curve() {
    let bench = Bench::new();
    let (mut unit, _) = Calibration::parse(&measured()).unwrap();
    bench.write("line.toml", unit.to_toml());
    unit.axes[0].correction.btc2_dps_per_c2 = 0.0005;
    unit.axes[0].correction.btc3_dps_per_c3 = -2e-6;
    bench.write("curve.toml", unit.to_toml());
    let page = |name: &str| {
        assert_eq!(bench.zerorate(&format!("report {name}.toml -o {name}.html")).ok(), "");
        bench.text(&format!("{name}.html"))
    };
    let (line, curve) = (page("line"), page("curve"));
    assert!(line.starts_with("<!DOCTYPE html>") && line.trim_end().ends_with("</html>"), "{line}");
    for expected in [
        "RBC = RATE + PBC + (TEMP − T3) · BTC + (TEMP − T3)² · BTC2 + (TEMP − T3)³ · BTC3",
        "(TEMP − 31.5000 °C)² · (+5.0000e-4 °/s/°C²)",
        "<th>BTC3, cubic term</th><td class=\"text\">°/s/°C³</td><td class=\"number\">-2.0000e-6</td>",
        "All coefficients are added",
        "measured here",
    ] {
        assert!(curve.contains(expected), "{expected} in {curve}");
    }
    assert!(!line.contains("BTC2") && line.contains("Both coefficients are added"), "{line}");
    let path = |page: &str| page.split("<svg").nth(1).and_then(|rest| rest.split("</svg>").next().map(str::len));
    assert_ne!(path(&line), path(&curve), "the picture shows the curve");
}

/// A file name may have control characters, and a page may be shown on a terminal.
#[cfg(unix)]
#[test]
fn no_page_and_no_picture_has_control_characters() {
    let bench = Bench::new();
    let name = "un\u{1b}]0;title\u{7}\u{9b}2Jit.toml";
    bench.write(name, super::calibration(-0.25, -0.04, 24.0));
    bench.write("log\u{1b}[31m.csv", "gz\n".to_owned() + &"1\n2\n1\n3\n2\n1\n2\n3\n".repeat(40));
    for line in [
        format!("report {name} -o a.html"),
        format!("report {name} -o b.svg"),
        "allan log\u{1b}[31m.csv --rate 10 --unit dps --report c.html --plot d.svg".to_owned(),
    ] {
        let run = bench.zerorate(&line).ended_with(0);
        let shown = [run.stdout, run.stderr].concat();
        assert!(!shown.chars().any(|c| c.is_control() && c != '\n'), "{line}: {shown:?}");
    }
    bench.write("printed.html", bench.zerorate(&format!("report {name}")).ok());
    for page in ["a.html", "b.svg", "c.html", "d.svg", "printed.html"] {
        let text = bench.text(page);
        let acts = text.char_indices().find(|(_, c)| c.is_control() && *c != '\n');
        assert!(acts.is_none(), "{page}: {acts:?}");
    }
}
