//! Line charts as SVG that follows the light or the dark style of what shows it.

use std::fmt::Write as _;

use umbra_cli::picture::ticks;
use umbra_cli::text::markup;

/// The look of charts, for a page or for a file of one.
pub(crate) const STYLE: &str = include_str!("chart.css");
/// The number of colours and of strokes in the style sheet.
pub(crate) const COLOURS: usize = 7;
pub(crate) const STROKES: usize = 3;

/// A chart in px: the plot and the room around it.
const PLOT: (f64, f64) = (480.0, 330.0);
const LEFT: f64 = 66.0;
const TOP: f64 = 12.0;
const RIGHT: f64 = 16.0;
const BELOW: f64 = 46.0;
/// The room for a legend on the right, and for the title of a file above.
const LEGEND: f64 = 190.0;
const TITLE: f64 = 32.0;

/// An axis of a plot.
#[derive(Clone, Copy)]
pub(crate) struct Axis<'a> {
    pub(crate) label: &'a str,
    pub(crate) scale: Scale,
}

/// The range and spacing of an axis.
#[derive(Clone, Copy)]
pub(crate) enum Scale {
    /// The values themselves.
    Linear(f64, f64),
    /// Powers of ten, given by the exponents.
    Log(f64, f64),
}

/// The look of a line: a colour and a stroke, by number.
#[derive(Clone, Copy)]
pub(crate) struct Look {
    pub(crate) colour: usize,
    pub(crate) stroke: usize,
    /// True if its points are marked, each stroke with a mark of its own.
    pub(crate) marks: bool,
}

pub(crate) struct Line {
    pub(crate) name: String,
    pub(crate) look: Look,
    pub(crate) points: Vec<(f64, f64)>,
}

pub(crate) struct Chart<'a> {
    pub(crate) x: Axis<'a>,
    pub(crate) y: Axis<'a>,
    pub(crate) lines: Vec<Line>,
}

impl Scale {
    /// Powers of ten around all positive values, none of them beyond `max`.
    pub(crate) fn log(values: impl Iterator<Item = f64>, max: f64) -> Self {
        let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.filter(|value| *value > 0.0).map(|value| value.min(max).log10()) {
            (from, to) = (from.min(value), to.max(value));
        }
        if from > to {
            return Self::Log(-1.0, 1.0);
        }
        let margin = 0.2 + 0.02 * (to - from);
        Self::Log(from - margin, to + margin)
    }

    /// Returns the place of a value, 0 to 1 from end to end. Values below a logarithmic scale, and zero, are at its lower end.
    fn share(self, value: f64) -> f64 {
        match self {
            Self::Linear(from, to) => (value - from) / (to - from),
            Self::Log(from, to) => ((value.log10() - from) / (to - from)).max(0.0),
        }
    }

    /// Values to mark, about so many, with their labels.
    fn ticks(self, about: f64) -> Vec<(f64, String)> {
        match self {
            Self::Linear(from, to) => ticks(from, to, (to - from) / about),
            Self::Log(from, to) => {
                let each = ((to - from) / about).ceil() as i32;
                let decades = from.ceil() as i32..=to.floor() as i32;
                let label = |decade: i32| if decade % each == 0 { power_of_ten(decade) } else { String::new() };
                decades.map(|decade| (10f64.powi(decade), label(decade))).collect()
            }
        }
    }
}

/// Writes a power of ten: 10⁻³.
pub(crate) fn power_of_ten(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised = exponent.to_string();
    let raised = raised.chars().map(|c| c.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize]));
    core::iter::once("10".to_owned()).chain(raised.map(String::from)).collect()
}

/// The marks of all looks: once in a document.
pub(crate) fn marks() -> String {
    let mut defs = String::from("<defs>");
    for (colour, stroke) in (0..COLOURS).flat_map(|colour| (0..STROKES).map(move |stroke| (colour, stroke))) {
        let shape = match stroke {
            0 => r#"<circle cx="5" cy="5" r="3.4"/>"#,
            1 => r#"<path d="M1.6 1.6h6.8v6.8h-6.8z"/>"#,
            _ => r#"<path d="M5 1 9 8.4H1z"/>"#,
        };
        let _ = write!(
            defs,
            r#"<marker id="m{colour}{stroke}" class="mark c{colour} k{stroke}" viewBox="0 0 10 10" refX="5" refY="5" markerWidth="7" markerHeight="7" markerUnits="userSpaceOnUse">{shape}</marker>"#
        );
    }
    defs + "</defs>"
}

/// A stroke with its mark, for legends in the text of a page.
pub(crate) fn sample(look: Look) -> String {
    format!(r#"<svg class="sample" viewBox="0 0 44 12" width="44" height="12">{}</svg>"#, swatch(look, 2.0, 6.0))
}

fn swatch(look: Look, x: f64, y: f64) -> String {
    format!(r#"<polyline {} points="{x},{y} {},{y}"/>"#, attributes(look), x + 40.0)
}

fn attributes(Look { colour, stroke, marks }: Look) -> String {
    let mark = if marks { format!(r#" style="marker:url(#m{colour}{stroke})""#) } else { String::new() };
    format!(r#"class="line c{colour} k{stroke}"{mark}"#)
}

impl Chart<'_> {
    /// The chart for a page that has the style and the marks.
    pub(crate) fn inline(&self) -> String {
        let (width, height) = (LEFT + PLOT.0 + RIGHT, TOP + PLOT.1 + BELOW);
        let label = format!("{} against {}", self.y.label, self.x.label);
        format!(
            r#"<svg class="chart" viewBox="0 0 {width} {height}" role="img" aria-label="{}">{}</svg>"#,
            markup(&label),
            self.body(LEFT, TOP)
        )
    }

    /// The chart as a file, with a title and a legend of these looks.
    pub(crate) fn file(&self, title: &str, legend: &[(Look, &str)]) -> String {
        let (top, right) = (TOP + TITLE, LEFT + PLOT.0);
        let (width, height) = (right + LEGEND, top + PLOT.1 + BELOW);
        let mut svg = format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" class="chart" width="{width}" height="{height}" viewBox="0 0 {width} {height}"><style>{STYLE}</style>{}<rect class="paper" width="{width}" height="{height}"/><text class="title" x="{LEFT}" y="26">{}</text>"#,
            marks(),
            markup(title)
        );
        for (line, (look, text)) in legend.iter().enumerate() {
            let y = top + 12.0 + 20.0 * line as f64;
            let _ = write!(
                svg,
                r#"{}<text x="{}" y="{}">{}</text>"#,
                swatch(*look, right + 16.0, y),
                right + 64.0,
                y + 4.0,
                markup(text)
            );
        }
        svg + &self.body(LEFT, top) + "</svg>\n"
    }

    fn body(&self, left: f64, top: f64) -> String {
        let (width, height) = PLOT;
        let mut svg = self.grid(left, top);
        // What leaves the plot is cut off by the inner picture's edge.
        let _ = write!(svg, r#"<svg class="plot" x="{left}" y="{top}" width="{width}" height="{height}">"#);
        for line in &self.lines {
            let point = |(x, y): &(f64, f64)| {
                let (x, y) = (self.x.scale.share(*x) * width, (1.0 - self.y.scale.share(*y)) * height);
                // Half a million px away is beyond any edge.
                format!("{:.1},{:.1}", x.clamp(-5e5, 5e5), y.clamp(-5e5, 5e5))
            };
            let points = line.points.iter().map(point).collect::<Vec<_>>().join(" ");
            let _ = write!(
                svg,
                r#"<polyline {} points="{points}"><title>{}</title></polyline>"#,
                attributes(line.look),
                markup(&line.name)
            );
        }
        svg + "</svg>"
    }

    fn grid(&self, left: f64, top: f64) -> String {
        let (width, height) = PLOT;
        let (right, bottom) = (left + width, top + height);
        let mut svg = String::new();
        for (value, label) in self.x.scale.ticks(8.0) {
            let x = left + self.x.scale.share(value) * width;
            let _ = write!(svg, r#"<path class="grid" d="M{x:.1} {top}V{bottom}"/>"#);
            let _ = write!(svg, r#"<text class="middle" x="{x:.1}" y="{}">{label}</text>"#, bottom + 16.0);
        }
        for (value, label) in self.y.scale.ticks(10.0) {
            let y = bottom - self.y.scale.share(value) * height;
            let _ = write!(svg, r#"<path class="grid" d="M{left} {y:.1}H{right}"/>"#);
            let _ = write!(svg, r#"<text class="end" x="{}" y="{:.1}">{label}</text>"#, left - 7.0, y + 4.0);
        }
        let (middle, centre) = (left + width / 2.0, top + height / 2.0);
        let _ = write!(
            svg,
            r#"<rect class="frame" x="{left}" y="{top}" width="{width}" height="{height}"/><text class="axis middle" x="{middle}" y="{}">{}</text><text class="axis middle" transform="translate(16 {centre}) rotate(-90)">{}</text>"#,
            bottom + 38.0,
            markup(self.x.label),
            markup(self.y.label)
        );
        svg
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_lies_at_the_lower_end_of_a_logarithmic_scale() {
        let scale = Scale::Log(-3.0, 1.0);
        assert_eq!([0.0, 1e-9, 1e-3, 0.1, 10.0].map(|value| scale.share(value)), [0.0, 0.0, 0.0, 0.5, 1.0]);
    }

    #[test]
    fn ticks_are_round() {
        let labels = |scale: Scale, about| scale.ticks(about).into_iter().map(|(_, label)| label).collect::<Vec<_>>();
        assert_eq!(labels(Scale::Linear(0.0, 40.0), 8.0), ["0", "5", "10", "15", "20", "25", "30", "35", "40"]);
        assert_eq!(labels(Scale::Log(-3.2, 0.4), 8.0), ["10⁻³", "10⁻²", "10⁻¹", "10⁰"]);
        assert_eq!(labels(Scale::Log(-4.5, 0.0), 3.0), ["10⁻⁴", "", "10⁻²", "", "10⁰"]);
    }
}
