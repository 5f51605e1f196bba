//! Tests of the plots by the content of their XML.

use super::*;
use roxmltree::{Document, Node};
use zerorate_allan::Envelope;

/// A curve with the deviations of white noise over five decades of averaging time.
fn white(label: &str) -> Curve {
    let point = |k: i32| {
        let tau_s = 10f64.powi(k);
        let dev = 0.01 / tau_s.sqrt();
        Point { tau_s, dev, lo: 0.9 * dev, hi: 1.2 * dev }
    };
    Curve { label: label.to_owned(), points: (-2..=3).map(point).collect(), ..Curve::default() }
}

pub(super) fn fitted() -> Curve {
    let law = |label: &str, at_1s, slope| PowerLaw { label: label.to_owned(), at_1s, slope };
    let laws =
        vec![law("N = 0.6 °/√h", 0.01, -0.5), law("B = 3.8 °/h", 7e-4, 0.0), law("K = 2·10⁻⁵ °/s/√s", 1e-5, 0.5)];
    let model = white("").points;
    Curve { laws, model, minimum: Some(Minimum { tau_s: 1000.0, dev: 0.01 / 1000f64.sqrt() }), ..white("unit.arrows") }
}

fn texts(svg: &str) -> Vec<String> {
    let xml = Document::parse(svg).expect("well-formed XML");
    // a halo repeats its text, and is left out here
    let is_halo = |node: &Node<'_, '_>| node.attribute("aria-hidden").is_some();
    let texts = xml.descendants().filter(|node| node.has_tag_name("text") && !is_halo(node));
    texts.filter_map(|node| node.text()).map(|text| text.trim().to_owned()).collect()
}

fn assert_has(found: &[String], all: &[&str]) {
    for expected in all {
        assert!(found.iter().any(|text| text == expected), "{expected} in {found:?}");
    }
}

fn attribute(svg: &str, tag: &str, name: &str) -> Vec<f64> {
    let xml = Document::parse(svg).unwrap();
    let nodes = xml.descendants().filter(|node| node.has_tag_name(tag));
    nodes.filter_map(|node| node.attribute(name)?.parse().ok()).collect()
}

#[test]
fn all_labels_are_text() {
    let (title, subtitle) = (Some("A title".into()), Some("a line".into()));
    let options = Options { title, subtitle, marks: an1042(), ..Options::default() };
    let found = texts(&allan(&[fitted()], &options));
    let expected = [
        "A title",
        "a line",
        "averaging time τ, s",
        "Allan deviation, °/s",
        "Allan deviation, °/h",
        "AN-1042: 10 s",
        "AN-1042: 150 s",
        "N = 0.6 °/√h",
        "B = 3.8 °/h",
        "K = 2·10⁻⁵ °/s/√s",
        "minimum 1.14 °/h at 1000 s",
        "0.01",
        "1000",
        "fit",
    ];
    assert_has(&found, &expected);
}

/// In a plot of 960 × 640 without headings, the frame starts at the pixel (92, 40) and is 772 wide and 532 high. The
/// horizontal axis has five decades, τ = 0.01 … 1000 s. The deviations with their intervals, 2.85e-4 … 0.12, give a
/// vertical axis of three decades, 2e-4 … 0.2.
#[test]
fn points_are_where_their_logarithms_are() {
    let svg = allan(&[white("w")], &Options::default());
    let (x, y) = (attribute(&svg, "circle", "cx"), attribute(&svg, "circle", "cy"));
    assert_eq!(x.len(), 6);
    for (k, (x, y)) in x.into_iter().zip(y).enumerate() {
        let expected_x = 92.0 + 772.0 / 5.0 * k as f64;
        // the point is log10(0.2 / dev) decades below the upper end, with dev = 0.1, 0.0316 …
        let expected_y = 40.0 + 532.0 / 3.0 * (2f64.log10() + 0.5 * k as f64);
        assert!(
            (x - expected_x).abs() < 0.01 && (y - expected_y).abs() < 0.01,
            "{k}: {x} {y}, {expected_x} {expected_y}"
        );
    }
}

#[test]
fn only_degrees_per_second_have_a_scale_per_hour() {
    let found = texts(&allan(&[white("w")], &Options { unit: "LSB".into(), ..Options::default() }));
    assert!(found.contains(&"Allan deviation, LSB".to_owned()));
    assert!(!found.iter().any(|text| text.contains("°/h")), "{found:?}");
}

/// The contrast as WCAG 2.2 defines it.
#[test]
fn each_colour_has_a_contrast_of_3_on_white() {
    for colour in super::allan::COLOURS {
        let linear = |at: usize| {
            let share = f64::from(u8::from_str_radix(&colour[at..at + 2], 16).unwrap()) / 255.0;
            if share <= 0.04045 { share / 12.92 } else { ((share + 0.055) / 1.055).powf(2.4) }
        };
        let luminance = 0.2126 * linear(1) + 0.7152 * linear(3) + 0.0722 * linear(5);
        assert!(1.05 / (luminance + 0.05) >= 3.0, "{colour}");
    }
}

#[test]
fn several_curves_have_a_legend_with_names_as_they_are() {
    let hostile = "<script>&\"'.csv";
    let found = texts(&allan(&[white("a.csv"), white(hostile), fitted()], &Options::default()));
    assert_has(&found, &["a.csv", hostile, "unit.arrows"]);
    assert!(!found.iter().any(|text| text.starts_with("N =")), "labels of one fit among three curves");
}

#[test]
fn names_that_xml_cannot_hold_are_replaced() {
    let found = texts(&allan(&[white("a\u{1b}[31m\n.csv"), white("b\u{0}\u{ffff}")], &Options::default()));
    assert!(found.contains(&"a\u{fffd}[31m\u{fffd}.csv".to_owned()), "{found:?}");
    assert!(found.contains(&"b\u{fffd}\u{fffd}".to_owned()), "{found:?}");
}

#[test]
fn marks_off_the_axis_are_left_out() {
    let mut short = white("short");
    short.points.truncate(3);
    let found = texts(&allan(&[short], &Options { marks: an1042(), ..Options::default() }));
    assert!(!found.iter().any(|text| text.contains("AN-1042")), "{found:?}");
}

#[test]
fn points_without_a_logarithm_are_left_out() {
    let strange = [
        (0.0, 1.0, 1.0, 1.0),
        (1.0, f64::NAN, 1.0, 1.0),
        (1.0, 0.0, 0.0, 0.0),
        (f64::INFINITY, 1.0, 1.0, 1.0),
        (2.0, 1e-3, 0.0, f64::INFINITY),
        (1.0, 2e-3, f64::NAN, f64::NAN),
    ];
    let points = strange.map(|(tau_s, dev, lo, hi)| Point { tau_s, dev, lo, hi }).to_vec();
    let laws = [0.0, f64::NAN, 1e-3].map(|at_1s| PowerLaw { label: String::new(), at_1s, slope: -0.5 }).to_vec();
    let minimum = Some(Minimum { tau_s: 0.0, dev: f64::NAN });
    let model = points.clone();
    for curves in [vec![Curve { points, model, laws, minimum, ..Curve::default() }], vec![Curve::default()], vec![]] {
        let svg = allan(&curves, &Options::default());
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        Document::parse(&svg).unwrap();
    }
}

#[test]
fn the_correction_is_drawn_over_its_span() {
    let point = |temp_c: f64| CorrectionPoint { temp_c, correction_dps: -0.04 * (temp_c - 30.0), half_dps: 0.01 };
    let points = [20.0, 30.0, 40.0].map(point).to_vec();
    let svg = correction(&CorrectionCurve { points, means: Vec::new(), t3_c: 30.0, valid_c: Some((25.0, 35.0)) });
    let found = texts(&svg);
    assert_has(&found, &["temperature, °C", "correction, °/s", "T3", "measured here", "20", "40"]);
    // the axis from 20 to 40 °C is 832 pixels wide from pixel 100 on, so 25 to 35 °C starts at 308 and is 416 wide
    assert!(
        attribute(&svg, "rect", "x").contains(&308.0) && attribute(&svg, "rect", "width").contains(&416.0),
        "{svg}"
    );
}

/// Two plots in one page have different names for their clip paths, unless their frames have the same position.
#[test]
fn frames_of_one_page_have_names_of_their_own() {
    let ids = |svg: &str| {
        let xml = Document::parse(svg).unwrap();
        let paths = xml.descendants().filter(|node| node.has_tag_name("clipPath"));
        let ids: Vec<String> = paths.filter_map(|node| node.attribute("id")).map(str::to_owned).collect();
        ids.iter().for_each(|id| assert!(svg.contains(&format!("url(#{id})")), "{id}"));
        ids
    };
    let one = ids(&allan(&[white("w")], &Options::default()));
    let titled = Options { title: Some("t".into()), ..Options::default() };
    assert_ne!(one, ids(&allan(&[white("w")], &titled)));
    let three = ids(&allan_multiples(&[white("x"), white("y"), white("z"), white("w")], &titled));
    assert_eq!(three.iter().collect::<std::collections::BTreeSet<_>>().len(), 4);
}

#[test]
fn axes_side_by_side_have_their_coefficients() {
    let remarked = Curve { remarks: vec!["rejected".into()], ..white("z") };
    let curves = [fitted(), Curve { label: "gyro <y>".into(), ..fitted() }, remarked, Curve::default()];
    let found = texts(&allan_multiples(&curves, &Options { marks: an1042(), ..Options::default() }));
    assert_eq!(found.iter().filter(|text| *text == "N = 0.6 °/√h").count(), 2);
    assert_has(&found, &["unit.arrows", "gyro <y>", "z", "rejected", "averaging time τ, s", "Allan deviation, °/s"]);
    Document::parse(&allan_multiples(&[], &Options::default())).unwrap();
}

#[test]
fn a_coefficient_has_its_colour_without_the_others() {
    let whole = fitted();
    let k = whole.laws.iter().position(|law| law.slope == 0.5).unwrap();
    let alone = Curve { laws: vec![whole.laws[k].clone()], ..whole.clone() };
    let colour = whole.laws[k].colour();
    assert!(whole.laws.iter().enumerate().all(|(index, law)| index == k || law.colour() != colour));
    for svg in
        [allan(std::slice::from_ref(&alone), &Options::default()), allan_multiples(&[alone], &Options::default())]
    {
        assert!(svg.contains(colour), "{colour}");
    }
}

#[test]
fn a_record_of_any_length_is_its_envelope() {
    let mut samples: Vec<f64> = (0..100_000).map(|i| f64::from(i % 10) - 4.5).collect();
    samples[50_050] = 99.0;
    samples[60_000..70_000].fill(f64::NAN);
    let envelope = Envelope::new(&samples, 100.0);
    assert_eq!((envelope.span_s, envelope.stretches.len()), (1000.0, 840));
    assert_eq!(envelope.stretches[0], Some((-4.5, 4.5)));
    assert_eq!(envelope.stretches.iter().flatten().filter(|(_, high)| *high == 99.0).count(), 1);
    assert!(envelope.stretches.iter().filter(|stretch| stretch.is_none()).count() > 80);
    let signal = Signal { label: "a<b".into(), envelope, marks_s: vec![300.0] };
    let svg = signals("The record", &[signal.clone(), signal], "°/s");
    let found = texts(&svg);
    assert_has(&found, &["time, min", "deviation from the mean, °/s", "15"]);
    assert!(found.iter().any(|text| text.starts_with("a<b, mean 0.00")) && svg.len() < 60_000, "{}", svg.len());
    // one band before the missing samples, and one after them
    let xml = Document::parse(&svg).unwrap();
    let bands = xml.descendants().filter_map(|node| node.attribute("d")).filter(|d| d.matches('M').count() == 2);
    assert_eq!(bands.count(), 2);
    for empty in [Envelope::default(), Envelope::new(&[f64::NAN], 1.0), Envelope::new(&[1.0], 1.0)] {
        let svg = signals("", &[Signal { envelope: empty, ..Signal::default() }], "°/s");
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
}

#[test]
fn each_tone_of_a_spectrum_is_labelled_once() {
    let point = |k: i32| (10f64.powf(f64::from(k) / 50.0), if k == 50 { 1.0 } else { 0.01 });
    let points: Vec<(f64, f64)> = (-100..100).map(point).collect();
    let tone = |frequency_hz, rms, label: &str| Tone { frequency_hz, rms, label: label.into() };
    let tones =
        vec![tone(10.0, 0.5, "10.0 Hz, 0.5 °/s rms"), tone(10.4, 0.01, "its foot"), tone(50.0, 0.1, "50.0 Hz")];
    let model = vec![(0.01, 0.01), (1.0, 0.01), (0.0, f64::NAN)];
    let svg = spectra("Spectrum", &[Spectrum { label: "x".into(), points, model, tones }], "°/s/√Hz");
    let found = texts(&svg);
    assert_has(&found, &["10.0 Hz, 0.5 °/s rms", "50.0 Hz", "frequency, Hz", "density, °/s/√Hz", "x"]);
    assert!(!found.iter().any(|text| text == "its foot") && !svg.contains("NaN"));
    assert_eq!(attribute(&svg, "circle", "r").len(), 2);
    Document::parse(&spectra("", &[Spectrum::default()], "")).unwrap();
}

#[test]
fn lines_share_a_scale_and_are_named_once() {
    let panel = |label: &str, lines| Panel { label: label.to_owned(), lines };
    let drawn = Lines {
        title: "Residual".to_owned(),
        names: vec!["one".to_owned(), "two".to_owned()],
        x_name: "share, %".to_owned(),
        y_name: "residual, °/h".to_owned(),
        is_log: true,
        rule: Some(20.0),
        panels: vec![
            panel("first", vec![vec![(0.0, 10.0), (100.0, 100.0)], vec![]]),
            panel("second", vec![vec![(0.0, 10.0), (50.0, 0.0), (100.0, 1000.0)], vec![(0.0, 10.0), (100.0, 10.0)]]),
        ],
    };
    let svg = lines(&drawn);
    let found = texts(&svg);
    for once in ["Residual", "one", "two", "first", "second", "share, %", "residual, °/h"] {
        assert_eq!(found.iter().filter(|text| *text == once).count(), 1, "{once} in {found:?}");
    }
    let xml = Document::parse(&svg).unwrap();
    let ways: Vec<&str> =
        xml.descendants().filter_map(|node| node.attribute("d")).filter(|way| way.len() > 5).collect();
    // values without a logarithm and lines without points are left out
    assert_eq!(ways.iter().map(|way| way.matches('L').count()).collect::<Vec<_>>(), [1, 1, 1], "{ways:?}");
    let dashed = xml.descendants().filter(|node| node.attribute("stroke-dasharray").is_some()).count();
    assert_eq!(dashed, 2, "the rule in each panel");
}
