//! Drawings made of the numbers and names in `docs/facts.md`. Items that the facts mark as unverified
//! are dashed and have a "?".

use anyhow::{Context, Result, ensure};
use std::collections::BTreeMap;
use std::fmt::Write;

/// The names of the 24 pins, as F-11 has them.
type Pins = BTreeMap<u8, String>;

/// The drawings, each with the file that it goes to.
pub fn all(facts: &str) -> Result<Vec<(&'static str, String)>> {
    let pins = pins(facts)?;
    Ok(vec![
        ("docs/pictures/connector.svg", connector(&pins)),
        ("docs/pictures/mounting.svg", mounting(facts)?),
        ("docs/pictures/wiring.svg", wiring(&pins)?),
        ("docs/pictures/bandwidth.svg", bandwidth(facts)?),
    ])
}

const BLUE: &str = "#0072b2";
const RED: &str = "#c23b00";
const GREY: &str = "#666";

/// Rows of a table of the facts, cell by cell, that begin with this id.
fn rows<'a>(facts: &'a str, id: &'a str) -> impl Iterator<Item = Vec<&'a str>> {
    let cells = |line: &'a str| line.trim_matches('|').split('|').map(str::trim).collect::<Vec<_>>();
    facts.lines().filter(|line| line.starts_with("| ")).map(cells).filter(move |cells| cells.first() == Some(&id))
}

/// The numbers in a text.
fn numbers(text: &str) -> Vec<f64> {
    text.split(|c: char| !c.is_ascii_digit() && c != '.')
        .filter_map(|word| word.trim_matches('.').parse().ok())
        .collect()
}

/// The value of the fact `id` whose words hold `word`.
fn value(facts: &str, id: &str, word: &str) -> Result<Vec<f64>> {
    let row = rows(facts, id).find(|cells| cells.get(1).is_some_and(|words| words.contains(word)));
    let row = row.with_context(|| format!("{id} says nothing of {word}"))?;
    Ok(numbers(row.get(2).context("a fact without a value")?))
}

fn pins(facts: &str) -> Result<Pins> {
    let mut pins = Pins::new();
    for cells in rows(facts, "F-11") {
        let [_, numbers_of, names, ..] = cells.as_slice() else { continue };
        let numbers: Vec<u8> = numbers(numbers_of).into_iter().map(|number| number as u8).collect();
        let names: Vec<&str> = names.split(", ").collect();
        for (at, pin) in numbers.iter().enumerate() {
            let name = if names.len() == numbers.len() { names[at] } else { names[0] };
            pins.insert(*pin, name.split(" (").next().unwrap_or(name).to_owned());
        }
    }
    ensure!(pins.keys().copied().eq(1..=24), "F-11 names the pins {:?}", pins.keys());
    Ok(pins)
}

fn svg(width: u32, height: u32, title: &str, body: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\" role=\"img\" font-family=\"sans-serif\" font-size=\"13\">\n<title>{title}</title>\n<rect \
         width=\"{width}\" \
         height=\"{height}\" fill=\"#fff\"/>\n{body}</svg>\n"
    )
}

/// Text at a place; `anchor` is start, middle or end.
fn text(at: (f64, f64), anchor: &str, colour: &str, content: &str) -> String {
    let (x, y) = at;
    format!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" fill=\"{colour}\">{content}</text>\n")
}

fn line(from: (f64, f64), to: (f64, f64), style: &str) -> String {
    format!("<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" {style}/>\n", from.0, from.1, to.0, to.1)
}

fn rect(at: (f64, f64), size: (f64, f64), style: &str) -> String {
    let ((x, y), (width, height)) = (at, size);
    format!("<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" {style}/>\n")
}

/// The colour for the purpose of a pin.
fn colour(name: &str) -> &'static str {
    match name {
        "VDD" => "#f4b9a5",
        "GND" => "#c9c9c9",
        "self-test" => "#efe3b0",
        "CS" | "RDY" | "SDO" | "SDI" | "SCLK" => "#b5d5ec",
        _ => "#fff",
    }
}

/// The pins seen from both sides. The second drawing is the mirror image of the first.
fn connector(pins: &Pins) -> String {
    let mut body = text((360.0, 24.0), "middle", "#000", "F-09, F-11: 24 pins, two rows, 1 mm pitch");
    for (left, title, is_mirrored) in [
        (20.0, "connector up: seen onto the connector of the part", false),
        (380.0, "connector down: seen onto your board, the part above it", true),
    ] {
        body += &text((left + 160.0, 52.0), "middle", "#000", title);
        body += &rect((left + 92.0, 62.0), (136.0, 372.0), "fill=\"none\" stroke=\"#000\" stroke-width=\"1.5\"");
        for (pin, name) in pins {
            let is_left = (pin % 2 == 1) != is_mirrored;
            let x = left + if is_left { 100.0 } else { 164.0 };
            let y = 70.0 + 30.0 * f64::from((pin - 1) / 2);
            let fill = colour(name);
            let weight = if *pin == 1 { 2.5 } else { 1.0 };
            let style = format!("fill=\"{fill}\" stroke=\"#000\" stroke-width=\"{weight}\" rx=\"3\"");
            body += &rect((x, y), (56.0, 24.0), &style);
            body += &text((x + 28.0, y + 17.0), "middle", "#000", &pin.to_string());
            let (at, anchor) = if is_left { (left + 84.0, "end") } else { (left + 236.0, "start") };
            body += &text((at, y + 17.0), anchor, "#000", name);
        }
    }
    body += &text(
        (360.0, 458.0),
        "middle",
        RED,
        "? which row is odd and where pin 1 lies: the custom, in no source; check the maker's drawing",
    );
    svg(720, 472, "The 24 pins of the connector, both ways up", &body)
}

fn mounting(facts: &str) -> Result<String> {
    let holes = rows(facts, "F-10").find(|cells| cells[1].contains("centres")).context("F-10 has no hole centres")?;
    let distances = numbers(holes[2]);
    let [across, along] = distances[..] else { anyhow::bail!("F-10: {distances:?} are no two distances") };
    let scale = 7.0;
    let (left, top) = (120.0, 70.0);
    let (width, height) = (across * scale, along * scale);
    let dashed = "fill=\"none\" stroke=\"#666\" stroke-dasharray=\"6 4\"";
    let mut body = text((240.0, 26.0), "middle", "#000", "F-10: four holes, M2 or 2-56 screws, 20 inch-ounces");
    body += &rect((left - 24.0, top - 24.0), (width + 48.0, height + 48.0), dashed);
    for (x, y) in [(left, top), (left + width, top), (left, top + height), (left + width, top + height)] {
        write!(
            body,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"7\" fill=\"none\" stroke=\"{BLUE}\" stroke-width=\"2\"/>"
        )?;
        body += &line((x - 11.0, y), (x + 11.0, y), "stroke=\"#0072b2\"");
        body += &line((x, y - 11.0), (x, y + 11.0), "stroke=\"#0072b2\"");
    }
    let arrows = "stroke=\"#c23b00\" stroke-dasharray=\"6 4\" marker-start=\"url(#a)\" marker-end=\"url(#a)\"";
    body += "<defs><marker id=\"a\" viewBox=\"0 0 10 10\" refX=\"9\" refY=\"5\" markerWidth=\"7\" markerHeight=\"7\" \
        orient=\"auto-start-reverse\"><path d=\"M0 0L10 5L0 10z\" fill=\"#c23b00\"/></marker></defs>\n";
    let (below, beside) = (top + height + 50.0, left - 50.0);
    body += &line((left, below), (left + width, below), arrows);
    body += &text((left + width / 2.0, below - 7.0), "middle", RED, &format!("{across:.1} mm ?"));
    body += &line((beside, top), (beside, top + height), arrows);
    let (x, y) = (beside - 8.0, top + height / 2.0);
    writeln!(
        body,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\" fill=\"{RED}\" transform=\"rotate(-90 {x:.1} \
         {y:.1})\">{along:.1} mm ?</text>"
    )?;
    let middle = left + width / 2.0;
    body += &text((middle, top + height / 2.0 - 10.0), "middle", GREY, "place of the connector");
    body += &text((middle, top + height / 2.0 + 8.0), "middle", GREY, "and outline: not in the facts");
    body += &text((240.0, below + 30.0), "middle", RED, "? not verified: hold it against the maker's drawing first");
    let height = (below + 50.0).ceil() as u32;
    Ok(svg(480, height, "The four mounting holes and their distances, which are not verified", &body))
}

fn wiring(pins: &Pins) -> Result<String> {
    let of = |name: &str| -> Result<String> {
        let all: Vec<String> =
            pins.iter().filter(|(_, known)| *known == name).map(|(pin, _)| pin.to_string()).collect();
        ensure!(!all.is_empty(), "F-11 has no pin {name}");
        Ok(all.join(", "))
    };
    let mut body = text((120.0, 28.0), "middle", "#000", "part: pins of F-11");
    body += &text((360.0, 28.0), "middle", "#000", "5 V ⇄ host's level");
    body += &text((600.0, 28.0), "middle", "#000", "host: roles of F-15");
    body += &rect((30.0, 40.0), (180.0, 330.0), "fill=\"#f6f9fc\" stroke=\"#000\"");
    body += &rect((310.0, 40.0), (100.0, 190.0), "fill=\"#fbf8ec\" stroke=\"#000\" stroke-dasharray=\"6 4\"");
    body += &rect((510.0, 40.0), (180.0, 330.0), "fill=\"#f6f9fc\" stroke=\"#000\"");
    body += "<defs><marker id=\"b\" viewBox=\"0 0 10 10\" refX=\"9\" refY=\"5\" markerWidth=\"8\" markerHeight=\"8\" \
        orient=\"auto-start-reverse\"><path d=\"M0 0L10 5L0 10z\" fill=\"#0072b2\"/></marker></defs>\n";
    let signals = [
        ("CS", "SPISELx", true),
        ("SCLK", "SCLK", true),
        ("SDI", "MOSI", true),
        ("SDO", "MISO", false),
        ("RDY", "interrupt, falling edge", false),
    ];
    for (at, (name, role, is_to_part)) in signals.into_iter().enumerate() {
        let y = 68.0 + 36.0 * at as f64;
        body += &text((200.0, y + 4.0), "end", "#000", &format!("{} {name}", of(name)?));
        body += &text((520.0, y + 4.0), "start", "#000", role);
        let end = if is_to_part { "marker-start" } else { "marker-end" };
        body += &line((212.0, y), (508.0, y), &format!("stroke=\"{BLUE}\" stroke-width=\"1.5\" {end}=\"url(#b)\""));
    }
    body += &text((360.0, 250.0), "middle", RED, "levels: in no source (?), so shift both ways");
    body += &text((200.0, 284.0), "end", "#000", &format!("{} VDD", of("VDD")?));
    body += &line((212.0, 280.0), (300.0, 280.0), "stroke=\"#c23b00\" stroke-width=\"2\"");
    body += &text((308.0, 284.0), "start", RED, "linear +5 V supply (F-01, F-51)");
    body += &text((200.0, 314.0), "end", "#000", &format!("{} GND", of("GND")?));
    body += &line((212.0, 310.0), (508.0, 310.0), "stroke=\"#000\" stroke-width=\"2\"");
    body += &text((520.0, 314.0), "start", "#000", "ground");
    body += &text((200.0, 340.0), "end", "#000", &format!("{} self-test", of("self-test")?));
    body += &line((212.0, 336.0), (508.0, 336.0), &format!("stroke=\"{GREY}\" stroke-dasharray=\"4 4\""));
    body += &text((520.0, 340.0), "start", "#000", "any output, or open");
    body += &text((200.0, 362.0), "end", "#000", &format!("{}, {} ROA1, ROA2", of("ROA1")?, of("ROA2")?));
    body += &line((212.0, 358.0), (300.0, 358.0), &format!("stroke=\"{GREY}\""));
    body += &text((308.0, 362.0), "start", "#000", "0.01 µF for 50 Hz, or open (F-04)");
    Ok(svg(720, 386, "Part, level shifter and host with the lines between them", &body))
}

/// Places on the axes of a picture of densities, both logarithmic.
struct Plot;

impl Plot {
    const X: (f64, f64) = (70.0, 690.0);
    const Y: (f64, f64) = (40.0, 330.0);
    /// Hz.
    const HZ: (f64, f64) = (10.0, 20_000.0);
    /// °/s/√Hz.
    const DENSITY: (f64, f64) = (1e-4, 3e-2);

    fn x(hz: f64) -> f64 {
        let part = (hz / Self::HZ.0).ln() / (Self::HZ.1 / Self::HZ.0).ln();
        Self::X.0 + part * (Self::X.1 - Self::X.0)
    }

    fn y(density: f64) -> f64 {
        let part = (density / Self::DENSITY.0).ln() / (Self::DENSITY.1 / Self::DENSITY.0).ln();
        Self::Y.1 - part * (Self::Y.1 - Self::Y.0)
    }

    /// A curve, as far as it is in the picture.
    fn curve(density: impl Fn(f64) -> f64, colour: &str) -> String {
        let hz = (0..=200).map(|step| Self::HZ.0 * (Self::HZ.1 / Self::HZ.0).powf(f64::from(step) / 200.0));
        let inside = hz.map(|hz| (hz, density(hz))).filter(|(_, density)| *density >= Self::DENSITY.0);
        let points: Vec<String> =
            inside.map(|(hz, density)| format!("{:.1},{:.1}", Self::x(hz), Self::y(density))).collect();
        format!("<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>\n", points.join(" "))
    }
}

fn bandwidth(facts: &str) -> Result<String> {
    let first =
        |id, word| -> Result<f64> { value(facts, id, word)?.first().copied().context("a fact without a number") };
    let density = first("F-02", "noise density")?;
    let poles = value(facts, "F-03", "poles")?;
    let (slow, resonance) = (first("F-04", "bandwidth")?, first("F-07", "mechanical resonance")? * 1e3);
    let sampled = rows(facts, "F-07").find(|cells| cells[1].contains("sampled at")).context("F-07 names no rate")?;
    let full_hz = numbers(sampled[1]).first().copied().context("F-07 names no rate")?;
    let fall = |hz: f64, pole: f64| 1.0 / (1.0 + (hz / pole).powi(2)).sqrt();
    let open = |hz: f64| poles.iter().fold(density, |all, pole| all * fall(hz, *pole));
    let mut body = text((380.0, 24.0), "middle", "#000", "density of the noise, °/s/√Hz (F-02, F-03, F-04)");
    body += &rect((70.0, 40.0), (620.0, 290.0), "fill=\"none\" stroke=\"#000\"");
    for hz in [10.0, 100.0, 1000.0, 10_000.0] {
        body += &line((Plot::x(hz), 330.0), (Plot::x(hz), 40.0), "stroke=\"#ddd\"");
        body += &text((Plot::x(hz), 348.0), "middle", "#000", &format!("{hz} Hz"));
    }
    for density in [1e-4, 1e-3, 1e-2] {
        body += &line((70.0, Plot::y(density)), (690.0, Plot::y(density)), "stroke=\"#ddd\"");
        body += &text((64.0, Plot::y(density) + 4.0), "end", "#000", &format!("{density}"));
    }
    body += &Plot::curve(open, BLUE);
    body += &Plot::curve(|hz| density * fall(hz, slow), "#009e73");
    body += &text((Plot::x(330.0), Plot::y(0.0125)), "start", BLUE, "no capacitor: 300 Hz");
    body += &text((Plot::x(45.0), Plot::y(0.0035)), "end", "#007a5a", "0.01 µF: 50 Hz");
    let divided_hz = 2.0 * full_hz / 51.0;
    let at = |rate_hz: f64| (fold(resonance, rate_hz), rate_hz);
    for ((hz, rate_hz), off, anchor) in [(at(full_hz), "", "end"), (at(divided_hz), " ± 50", "start")] {
        body += &line((Plot::x(hz), 330.0), (Plot::x(hz), 120.0), &format!("stroke=\"{RED}\" stroke-width=\"2\""));
        let label = format!("{hz:.0}{off} Hz at {rate_hz:.0}/s");
        body += &text((Plot::x(hz) + 4.0, 112.0), anchor, RED, &label);
        let half = rate_hz / 2.0;
        let style = format!("stroke=\"{GREY}\" stroke-dasharray=\"4 4\"");
        body += &line((Plot::x(half), 330.0), (Plot::x(half), 290.0), &style);
    }
    let style = format!("stroke=\"{RED}\" stroke-width=\"2\" stroke-dasharray=\"5 4\"");
    body += &line((Plot::x(resonance), 330.0), (Plot::x(resonance), 70.0), &style);
    body += &text((686.0, 62.0), "end", RED, "resonance, about 14.3 kHz");
    let folded =
        "red: where the resonance (F-07) appears among the samples of a nominal part; grey: half of their rate";
    body += &text((380.0, 374.0), "middle", "#000", folded);
    Ok(svg(720, 388, "Bandwidth of the rate, and where the resonance folds to", &body))
}

/// The frequency at which a tone appears among samples at `rate_hz`.
pub fn fold(hz: f64, rate_hz: f64) -> f64 {
    (hz - (hz / rate_hz).round() * rate_hz).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_facts_are_understood() {
        let facts = std::fs::read_to_string("../../docs/facts.md").unwrap();
        let pins = pins(&facts).unwrap();
        let named = [1, 7, 8, 10, 11, 12, 14, 16, 17, 18, 23, 24].map(|pin: u8| pins[&pin].as_str());
        let known =
            ["self-test", "self-test", "CS", "RDY", "VDD", "SDO", "SDI", "SCLK", "GND", "SYNC", "ROA1", "ROA2"];
        assert_eq!(named, known);
        assert!((fold(14_300.0, 5692.6) - 2777.8).abs() < 0.1);
        for (file, drawing) in all(&facts).unwrap() {
            assert!(drawing.starts_with("<svg") && drawing.ends_with("</svg>\n"), "{file}");
        }
    }
}
