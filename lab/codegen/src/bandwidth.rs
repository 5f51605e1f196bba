//! Plots the bandwidth of the ADIS16130 from the numbers in `docs/facts.md`. The drawings of its pins and holes are
//! made by hand. A test compares them with the facts.

use anyhow::{Context, Result};

const BLUE: &str = "#0072b2";
const RED: &str = "#c23b00";
const GREY: &str = "#666";

const HEAD: &str = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 720 388\" width=\"720\" height=\"388\" \
    role=\"img\" font-family=\"sans-serif\" font-size=\"13\">\n<title>Bandwidth of the rate, and where the resonance \
    folds to</title>\n<rect width=\"720\" height=\"388\" fill=\"#fff\"/>\n";

/// The rows of the tables in `facts` whose first cell is `id`. Each row is split into its cells.
fn rows<'a>(facts: &'a str, id: &'a str) -> impl Iterator<Item = Vec<&'a str>> {
    let cells = |line: &'a str| line.trim_matches('|').split('|').map(str::trim).collect::<Vec<_>>();
    facts.lines().filter(|line| line.starts_with("| ")).map(cells).filter(move |cells| cells.first() == Some(&id))
}

fn numbers(text: &str) -> Vec<f64> {
    text.split(|c: char| !c.is_ascii_digit() && c != '.')
        .filter_map(|word| word.trim_matches('.').parse().ok())
        .collect()
}

/// The numbers in the value of the fact `id`, from that row of the fact whose description contains `word`.
fn value(facts: &str, id: &str, word: &str) -> Result<Vec<f64>> {
    let row = rows(facts, id).find(|cells| cells.get(1).is_some_and(|words| words.contains(word)));
    let row = row.with_context(|| format!("{id} says nothing of {word}"))?;
    Ok(numbers(row.get(2).context("a fact without a value")?))
}

/// An SVG text element. `anchor` is its `text-anchor`: start, middle or end.
fn text(at: (f64, f64), anchor: &str, colour: &str, content: &str) -> String {
    let (x, y) = at;
    format!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" fill=\"{colour}\">{content}</text>\n")
}

fn line(from: (f64, f64), to: (f64, f64), style: &str) -> String {
    format!("<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" {style}/>\n", from.0, from.1, to.0, to.1)
}

/// Converts values to pixels in a log-log plot of densities.
struct Plot;

impl Plot {
    const X: (f64, f64) = (70.0, 690.0);
    const Y: (f64, f64) = (40.0, 330.0);
    /// Range of the horizontal axis, Hz.
    const HZ: (f64, f64) = (10.0, 20_000.0);
    /// Range of the vertical axis, °/s/√Hz.
    const DENSITY: (f64, f64) = (1e-4, 3e-2);

    fn x(hz: f64) -> f64 {
        let part = (hz / Self::HZ.0).ln() / (Self::HZ.1 / Self::HZ.0).ln();
        Self::X.0 + part * (Self::X.1 - Self::X.0)
    }

    fn y(density: f64) -> f64 {
        let part = (density / Self::DENSITY.0).ln() / (Self::DENSITY.1 / Self::DENSITY.0).ln();
        Self::Y.1 - part * (Self::Y.1 - Self::Y.0)
    }

    /// Draws a curve without the part below the plot.
    fn curve(density: impl Fn(f64) -> f64, colour: &str) -> String {
        let hz = (0..=200).map(|step| Self::HZ.0 * (Self::HZ.1 / Self::HZ.0).powf(f64::from(step) / 200.0));
        let inside = hz.map(|hz| (hz, density(hz))).filter(|(_, density)| *density >= Self::DENSITY.0);
        let points: Vec<String> =
            inside.map(|(hz, density)| format!("{:.1},{:.1}", Self::x(hz), Self::y(density))).collect();
        format!("<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>\n", points.join(" "))
    }
}

pub fn draw(facts: &str) -> Result<String> {
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
    body += "<rect x=\"70.0\" y=\"40.0\" width=\"620.0\" height=\"290.0\" fill=\"none\" stroke=\"#000\"/>\n";
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
    body += &text((Plot::x(450.0), Plot::y(0.0108)), "start", BLUE, "no capacitor: 300 Hz");
    body += &text((Plot::x(130.0), Plot::y(0.0053)), "start", "#007a5a", "0.01 µF: 50 Hz");
    let divided_hz = 2.0 * full_hz / 51.0;
    let at = |rate_hz: f64| (fold(resonance, rate_hz), rate_hz);
    // the label of the divided rate goes below both curves
    for ((hz, rate_hz), off, top) in [(at(full_hz), "", 120.0), (at(divided_hz), " ± 50", 180.0)] {
        body += &line((Plot::x(hz), 330.0), (Plot::x(hz), top), &format!("stroke=\"{RED}\" stroke-width=\"2\""));
        let label = format!("{hz:.0}{off} Hz at {rate_hz:.0}/s");
        body += &text((Plot::x(hz) - 1.0, top - 8.0), "start", RED, &label);
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
    Ok(format!("{HEAD}{body}</svg>\n"))
}

/// The frequency, Hz, at which a tone of `hz` appears after aliasing, with samples at `rate_hz`.
pub fn fold(hz: f64, rate_hz: f64) -> f64 {
    (hz - (hz / rate_hz).round() * rate_hz).abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::read_to_string;

    /// The pin numbers and pin names in each row of F-11. A row has one name per number, or one name for all its
    /// numbers.
    fn pins(facts: &str) -> Vec<(Vec<f64>, Vec<String>)> {
        let names = |cell: &str| cell.split(", ").map(|name| name.split(" (").next().unwrap().to_owned()).collect();
        let stated = rows(facts, "F-11").map(|cells| (numbers(cells[1]), names(cells[2])));
        stated.filter(|(pins, _): &(Vec<f64>, Vec<String>)| !pins.is_empty()).collect()
    }

    #[test]
    fn the_drawings_kept_by_hand_are_those_of_the_facts() {
        let read = |path: &str| read_to_string(format!("../../docs/{path}")).unwrap();
        let facts = read("facts.md");
        let (connector, wiring) = (read("pictures/connector.svg"), read("pictures/wiring.svg"));
        let texts = connector.split('<').filter_map(|tag| Some(tag.split_once('>')?.1.trim()));
        let words: Vec<&str> = texts.filter(|text| !text.is_empty()).collect();
        let mut drawn = 0;
        for (pins, names) in pins(&facts) {
            for (at, pin) in pins.iter().enumerate() {
                let name = names.get(at).unwrap_or(&names[0]);
                let found = words.windows(2).filter(|pair| pair[0] == pin.to_string() && pair[1] == name).count();
                assert_eq!(found, 2, "pin {pin}, {name}: once from each side");
                drawn += 1;
            }
            let all: Vec<String> = pins.iter().map(f64::to_string).collect();
            let line = format!(">{} {}<", all.join(", "), names.join(", "));
            assert!(names == ["SYNC"] || wiring.contains(&line), "{line}");
        }
        assert_eq!(drawn, 24);
        for distance in value(&facts, "F-10", "centres").unwrap() {
            assert!(read("pictures/mounting.svg").contains(&format!(">{distance:.1} mm ?<")));
        }
    }

    #[test]
    fn a_tone_folds() {
        assert!((fold(14_300.0, 5692.6) - 2777.8).abs() < 0.1);
    }
}
