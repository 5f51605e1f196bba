//! Plot of the Allan deviation over the averaging time, log-log.

use super::axes::{self, Axis, number};
use super::canvas::{self, Anchor, Area, Frame, INK, SMALL, label, line, shortened, stroke, with_unit};
use super::curve::Scales;
use super::label::{Labels, Position, densely};
use svg::Document;
use svg::node::element::Group;

/// The deviations of one record.
#[derive(Clone, Debug, Default)]
pub struct Curve {
    /// The record's name, usually the name of its file.
    pub label: String,
    /// The deviations by averaging time. Values at or below zero are not drawn.
    pub points: Vec<Point>,
    /// The fitted deviations with the band in which this record's deviations are expected; empty without a fit.
    pub model: Vec<Point>,
    /// The band in which the deviations of another record are expected; empty without a prediction.
    pub predicted: Vec<Point>,
    /// The fitted noise coefficients, one line each; empty without a fit.
    pub laws: Vec<PowerLaw>,
    /// The lowest deviation, which is marked with a ring; `None` to mark none.
    pub minimum: Option<Minimum>,
    /// Remarks on the fit, shown only in plots of several axes.
    pub remarks: Vec<String>,
}

/// An averaging time, with the deviation and its interval in [`Options::unit`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Averaging time, s.
    pub tau_s: f64,
    /// The deviation at this averaging time.
    pub dev: f64,
    /// Lower end of the deviation's interval.
    pub lo: f64,
    /// Upper end of the deviation's interval.
    pub hi: f64,
}

/// A power law: dev(τ) = `at_1s` · (τ / 1 s)^`slope`.
///
/// `at_1s` is N at slope −1/2, 0.664 B at 0, K/√3 at 1/2, √3 Q at −1 and R/√2 at 1 (IEEE Std 952-1997, annex C.1).
#[derive(Clone, Debug, PartialEq)]
pub struct PowerLaw {
    /// The label beside the line, such as `N = 0.557 °/√h`.
    pub label: String,
    /// Deviation at an averaging time of 1 s.
    pub at_1s: f64,
    /// The exponent of the averaging time.
    pub slope: f64,
}

impl PowerLaw {
    pub(super) fn colour(&self) -> &'static str {
        LAW_COLOURS.into_iter().find(|(slope, _)| *slope == self.slope).map_or(OTHER_LAW, |(_, colour)| colour)
    }

    /// The deviation at an averaging time.
    pub fn dev(&self, tau_s: f64) -> f64 {
        self.at_1s * tau_s.powf(self.slope)
    }
}

/// The lowest point of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Minimum {
    /// Averaging time, s.
    pub tau_s: f64,
    /// Deviation at this averaging time.
    pub dev: f64,
}

/// A vertical line at an averaging time of interest.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Averaging time, s.
    pub tau_s: f64,
    /// The text above the line.
    pub label: String,
}

/// Texts, marks and size of the picture.
#[derive(Clone, Debug)]
pub struct Options {
    /// The heading.
    pub title: Option<String>,
    /// The text below the heading, of up to two lines.
    pub subtitle: Option<String>,
    /// The label of the vertical axis.
    pub quantity: String,
    /// Unit of the vertical axis. With °/s, the right side has a second scale in °/h.
    pub unit: String,
    /// Vertical lines at averaging times of interest.
    pub marks: Vec<Mark>,
    /// Width and height in pixels.
    pub size: (u32, u32),
}

/// Marks at the averaging times that AN-1042 uses for an ADIS16130 (F-51).
pub fn an1042() -> Vec<Mark> {
    let mark = |tau_s: f64| Mark { tau_s, label: format!("AN-1042: {tau_s} s") };
    vec![mark(10.0), mark(150.0)]
}

impl Default for Options {
    /// Options for a deviation in °/s, with no averaging time marked.
    fn default() -> Self {
        Self {
            title: None,
            subtitle: None,
            quantity: "Allan deviation".to_owned(),
            unit: "°/s".to_owned(),
            marks: Vec::new(),
            size: (960, 640),
        }
    }
}

/// Colours that colour-blind readers can distinguish, each with a contrast of at least 3:1 on white: those of Okabe
/// and Ito that have it, then wine and indigo of Tol's muted scheme.
pub const COLOURS: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#000000", "#882255", "#332288"];
/// Dash patterns of the curves. After as many curves as there are colours, the next pattern is used.
const DASHES: [&str; 4] = ["none", "8 4", "2 3", "8 3 2 3"];
/// Colours of the fitted coefficients by slope, the same in all plots. They are dark enough for text.
const LAW_COLOURS: [(f64, &str); 4] = [(-0.5, "#c04a00"), (0.0, "#00785a"), (0.5, "#9a3f75"), (-1.0, "#7d6000")];
/// The colour of lines with any other slope.
const OTHER_LAW: &str = "#555555";
/// Largest extent of the vertical axis beyond the deviations to show a band, decades.
const BAND_DECADES: f64 = 0.7;
/// The vertical axis is extended down to 0.7 times the line of the fitted bias instability B, unless that is more
/// than this factor below the smallest deviation.
const FLOOR_DEPTH: f64 = 30.0;
/// Distance from a curve, in pixels, at which a label is not mistaken for that curve's label.
const APART: f64 = 60.0;
const PER_HOUR: f64 = 3600.0;

/// Draws the plot as SVG.
///
/// A single curve has labels for its coefficients and its minimum. Several curves have a legend and their fitted
/// curves, but no coefficients.
pub fn allan(curves: &[Curve], options: &Options) -> String {
    let curves: Vec<Curve> = curves.iter().map(drawable).collect();
    let hourly = options.unit == "°/s";
    let area = Area {
        left: 92.0,
        right: f64::from(options.size.0) - if hourly { 96.0 } else { 28.0 },
        top: if options.title.is_some() || options.subtitle.is_some() { 86.0 } else { 40.0 },
        bottom: f64::from(options.size.1) - 68.0,
    };
    let (x, y) = ranges(&curves);
    let scales =
        Scales { x: Axis::log(x.0, x.1, (area.left, area.right)), y: Axis::log(y.0, y.1, (area.bottom, area.top)) };
    let picture = Picture { curves, options, area, scales };
    let mut page = picture.base();
    if hourly {
        let per_hour = picture.scales.y.in_unit(PER_HOUR);
        page = page.add(canvas::right_scale(&area, &per_hour, &format!("{}, °/h", options.quantity)));
    }
    page.add(picture.marks()).add(picture.lines()).add(picture.lettering()).to_string()
}

/// The curve sorted by averaging time, without points that a logarithmic axis cannot show.
pub fn drawable(curve: &Curve) -> Curve {
    let known = |tau_s: f64, dev: f64| [tau_s, dev].iter().all(|value| value.is_normal() && *value > 0.0);
    let bounded = |point: &Point| Point {
        lo: if point.lo > 0.0 { point.lo } else { 0.0 },
        hi: if point.hi.is_nan() { point.dev } else { point.hi },
        ..*point
    };
    let sorted = |points: &[Point]| {
        let mut points: Vec<Point> =
            points.iter().filter(|point| known(point.tau_s, point.dev)).map(bounded).collect();
        points.sort_by(|a, b| a.tau_s.total_cmp(&b.tau_s));
        points
    };
    let [points, model, predicted] = [&curve.points, &curve.model, &curve.predicted].map(|points| sorted(points));
    let laws = curve.laws.iter().filter(|law| known(1.0, law.at_1s) && law.slope.is_finite()).cloned().collect();
    let minimum = curve.minimum.filter(|lowest| known(lowest.tau_s, lowest.dev));
    Curve { label: curve.label.clone(), points, model, predicted, laws, minimum, remarks: curve.remarks.clone() }
}

/// The ranges of averaging times and deviations to show; from 1 to 1 if there are none.
pub fn ranges(curves: &[Curve]) -> ((f64, f64), (f64, f64)) {
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let devs = axes::range(points().map(|point| point.dev)).unwrap_or((1.0, 1.0));
    let beyond = 10f64.powf(BAND_DECADES);
    let floors = curves.iter().flat_map(|curve| &curve.laws).filter(|law| law.slope == 0.0).map(|law| 0.7 * law.at_1s);
    let floor = floors.filter(|floor| *floor > devs.0 / FLOOR_DEPTH).fold(devs.0, f64::min);
    let low = points().map(|point| point.lo.max(devs.0 / beyond)).fold(floor, f64::min);
    let high = points().map(|point| point.hi.min(devs.1 * beyond)).fold(devs.1, f64::max);
    (axes::range(points().map(|point| point.tau_s)).unwrap_or((1.0, 1.0)), (low, high))
}

struct Picture<'a> {
    curves: Vec<Curve>,
    options: &'a Options,
    area: Area,
    scales: Scales,
}

impl Picture<'_> {
    fn base(&self) -> Document {
        let Options { title, subtitle, quantity, unit, size, .. } = self.options;
        let y_name = with_unit(quantity, unit);
        let frame = Frame {
            area: self.area,
            x: &self.scales.x,
            y: &self.scales.y,
            x_name: Some("averaging time τ, s"),
            y_name: Some(&y_name),
        };
        let names: Vec<&str> = self.curves.iter().map(|curve| curve.label.as_str()).collect();
        let room = self.area.right - self.area.left;
        canvas::paper(*size, &format!("{quantity} of {}", names.join(", ")))
            .add(canvas::headings(self.area.left, title.as_deref(), subtitle.as_deref(), room))
            .add(frame.draw())
    }

    fn visible_marks(&self) -> impl Iterator<Item = &Mark> {
        self.options.marks.iter().filter(|mark| self.scales.x.covers(mark.tau_s))
    }

    /// Vertical lines with their labels above the frame, side by side. A label that does not fit is left out.
    fn marks(&self) -> Group {
        let mut group = Group::new();
        let mut free_from = self.area.left;
        for mark in self.visible_marks() {
            let x = self.scales.x.at(mark.tau_s);
            let rule = line((x, self.area.top), (x, self.area.bottom));
            group = group.add(rule.set("stroke", "#777777").set("stroke-dasharray", "5 4"));
            let half = 0.5 * canvas::width(&mark.label, SMALL);
            let middle = x.min(self.area.right - half).max(free_from + half);
            if middle + half <= self.area.right + 1.0 {
                free_from = middle + half + 6.0;
                let name = canvas::text(&mark.label, (middle, self.area.top - 8.0), Anchor::Middle);
                group = group.add(name.set("fill", "#555555"));
            }
        }
        group
    }

    fn lines(&self) -> Group {
        let mut group = canvas::clipped(&self.area);
        for (curve, (colour, _)) in self.curves.iter().zip(styles()) {
            let model = self.scales.band(&curve.predicted, self.model_style(colour).0);
            group = group.add(self.scales.band(&curve.points, colour)).add(model);
        }
        if let [only] = &self.curves[..] {
            group = group.add(self.scales.edges(&only.model, INK));
            for law in &only.laws {
                let line = stroke(canvas::path(self.scales.law(law)), law.colour(), 1.4);
                group = group.add(line.set("stroke-dasharray", "7 4"));
            }
        }
        for (curve, (colour, _)) in self.curves.iter().zip(styles()) {
            let (colour, dash) = self.model_style(colour);
            let model = stroke(canvas::path(self.scales.model(curve)), colour, 1.6);
            group = group.add(model.set("stroke-dasharray", dash));
        }
        // this group is not clipped, so that a dot on the frame is drawn whole
        let mut group = Group::new().add(group);
        for (curve, (colour, dash)) in self.curves.iter().zip(styles()) {
            group = group.add(self.scales.line(curve, colour, dash));
            if let Some(Minimum { tau_s, dev }) = curve.minimum {
                group = group.add(self.scales.ring(tau_s, dev, self.model_style(colour).0));
            }
        }
        group
    }

    /// Colour and dash pattern of a model. With several curves, each model has the colour of its curve.
    fn model_style(&self, of_curve: &'static str) -> (&'static str, &'static str) {
        if self.curves.len() > 1 { (of_curve, "7 3") } else { (INK, "none") }
    }

    fn lettering(&self) -> Group {
        let mut labels = Labels::new(self.area);
        for curve in &self.curves {
            labels.avoid(&self.scales.track(curve));
        }
        match &self.curves[..] {
            [] => Group::new(),
            [only] => self.direct_labels(only, labels),
            several => legend(several, &labels),
        }
    }

    fn direct_labels(&self, curve: &Curve, mut labels: Labels) -> Group {
        let total = self.scales.model(curve);
        labels.avoid(&total);
        let laws: Vec<Vec<(f64, f64)>> = curve.laws.iter().map(|law| self.scales.law(law)).collect();
        laws.iter().for_each(|law| labels.avoid(law));
        for mark in self.visible_marks() {
            let x = self.scales.x.at(mark.tau_s);
            labels.avoid(&[(x, self.area.top), (x, self.area.bottom)]);
        }
        let minimum = curve
            .minimum
            .map(|lowest| (self.minimum_text(lowest), around(self.scales.at(lowest.tau_s, lowest.dev)), INK));
        let beside_law =
            |(law, line): (&PowerLaw, &Vec<_>)| (law.label.clone(), self.along(line, curve), law.colour());
        let laws = curve.laws.iter().zip(&laws).map(beside_law);
        let fit = (!total.is_empty()).then(|| ("fit".to_owned(), self.along(&total, curve), INK));
        minimum.into_iter().chain(laws).chain(fit).fold(Group::new(), |group, (text, candidates, colour)| match labels
            .place(&text, candidates)
        {
            Some((at, anchor)) => group.add(label(&text, at, anchor, colour)),
            None => group,
        })
    }

    fn minimum_text(&self, Minimum { tau_s, dev }: Minimum) -> String {
        let (value, unit) = match self.options.unit.as_str() {
            "°/s" => (dev * PER_HOUR, "°/h"),
            unit => (dev, unit),
        };
        format!("minimum {} {unit} at {} s", number(value), number(tau_s))
    }

    /// Label positions along a line, the best first: the positions at least `APART` from the curve, nearest first,
    /// then the closer positions, farthest first.
    fn along(&self, line: &[(f64, f64)], curve: &Curve) -> Vec<Position> {
        let track = densely(&self.scales.track(curve));
        let far = |(x, y): (f64, f64)| track.iter().map(|(a, b)| (x - a).hypot(y - b)).fold(f64::MAX, f64::min);
        let mut spots: Vec<(f64, (f64, f64))> =
            line.iter().filter(|spot| self.area.contains(**spot)).map(|spot| (far(*spot), *spot)).collect();
        spots.sort_by(|(a, _), (b, _)| b.min(APART).total_cmp(&a.min(APART)).then(a.total_cmp(b)));
        spots.into_iter().flat_map(|(_, spot)| beside(spot)).collect()
    }
}

fn styles() -> impl Iterator<Item = (&'static str, &'static str)> {
    DASHES.into_iter().cycle().flat_map(|dash| COLOURS.into_iter().map(move |colour| (colour, dash)))
}

/// Label positions around a point, the nearest first.
pub fn around((x, y): (f64, f64)) -> Vec<Position> {
    let ring = |away: f64| {
        [
            ((x, y + away + SMALL), Anchor::Middle),
            ((x, y - away), Anchor::Middle),
            ((x - away, y + away + SMALL), Anchor::End),
            ((x + away, y + away + SMALL), Anchor::Start),
            ((x + away, y - away), Anchor::Start),
            ((x - away, y - away), Anchor::End),
        ]
    };
    [16.0, 32.0, 56.0, 88.0, 128.0].into_iter().flat_map(ring).collect()
}

fn beside((x, y): (f64, f64)) -> [Position; 4] {
    [
        ((x + 8.0, y - 8.0), Anchor::Start),
        ((x - 8.0, y + 8.0 + SMALL), Anchor::End),
        ((x - 8.0, y - 8.0), Anchor::End),
        ((x + 8.0, y + 8.0 + SMALL), Anchor::Start),
    ]
}

fn legend(curves: &[Curve], labels: &Labels) -> Group {
    let names: Vec<String> = curves.iter().map(|curve| shortened(&curve.label, 44)).collect();
    let widest = names.iter().map(|name| canvas::width(name, SMALL)).fold(0.0, f64::max);
    let row = 20.0;
    let place = labels.corner((widest + 60.0, row * names.len() as f64 + 10.0));
    let paper = canvas::rectangle(&place).set("fill", "white").set("fill-opacity", 0.9).set("stroke", "#cccccc");
    let mut group = Group::new().add(paper);
    for (k, (name, (colour, dash))) in names.iter().zip(styles()).enumerate() {
        let y = place.top + 5.0 + row * (k as f64 + 0.5);
        let sample = line((place.left + 10.0, y), (place.left + 40.0, y));
        group = group
            .add(sample.set("stroke", colour).set("stroke-width", 2.5).set("stroke-dasharray", dash))
            .add(canvas::text(name, (place.left + 48.0, y + 4.5), Anchor::Start));
    }
    group
}
