//! The report as one page that needs nothing else.

use std::fmt::Write as _;

use umbra_cli::text::markup;
use umbra_physics::Integrator;

use super::SCALARS;
use super::conclude::conclusions;
use super::contacts;
use super::data::{Machine, Measured, Report, Results};
use super::parting::{Pair, Parting};
use crate::chart::{self, Axis, Chart, Line, Look, Scale, power_of_ten, sample};

pub(super) const STYLE: &str = include_str!("page.css");
/// Errors beyond this are off the charts: m or rad.
const WILD: f64 = 100.0;

pub(super) fn page(report: &Report) -> String {
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width\">\n<title>umbra-physics: time against error</title>\n<style>{}{STYLE}{}</style></head>\n<body><main>\n",
        chart::STYLE,
        filters()
    );
    page += &head(report);
    page += &legend();
    for results in &report.problems {
        page += &section(results);
    }
    if let Some(parting) = &report.parting {
        page += &parted(parting);
    }
    page += &contacts::section(report);
    if !report.problems.is_empty() {
        page += &conclusions(report);
    }
    page + "</main></body></html>\n"
}

/// The diagram of one problem by itself.
pub(super) fn diagram(report: &Report) -> String {
    let named = report.problems.iter().find(|results| results.name == "kepler-0.6");
    let Some(results) = named.or(report.problems.first()).or(report.contacts.first()) else { return String::new() };
    let integrators = Integrator::ALL.iter().enumerate().map(|(colour, integrator)| {
        let look = Look { colour, stroke: 0, marks: false };
        (look, integrator.name())
    });
    let scalars = SCALARS.into_iter().enumerate().map(|(stroke, name)| (scalar_look(stroke), name));
    let legend: Vec<(Look, &str)> = integrators.chain(scalars).collect();
    let title = format!("{}: time against error", results.title);
    with_charts(results, |against_time, _| against_time.file(&title, &legend))
}

fn scalar_look(stroke: usize) -> Look {
    Look { colour: 5, stroke, marks: true }
}

fn head(report: &Report) -> String {
    let Machine { processor, system, optimised } = &report.machine;
    let processor = processor.as_deref().unwrap_or("unknown processor");
    let build = if *optimised { "optimised build" } else { "<strong>a build without optimisation</strong>" };
    let rates = report.rates.first().zip(report.rates.last());
    let range = rates.map_or(String::new(), |(from, to)| format!("{from} to {to}"));
    format!(
        r##"<h1>Time against error</h1>
<p class="lead">What a step costs and what it brings: scenes whose motion is known, run with every integrator and every scalar at
{range} steps a second. <strong>Down and left is better.</strong> <a href="#conclude">What to conclude</a> is at the end.</p>
<dl><dt>Machine</dt><dd>{}, {system}, one thread</dd><dt>Program</dt><dd>umbra-physics {}, {build}</dd>
<dt>Made by</dt><dd><code>{}</code></dd>
<dt>Error</dt><dd>the largest distance of a body from where it should be at the end of the run, from the engine's full state:
with the fractions below 2⁻³² m that fx carries from step to step</dd>
<dt>Time</dt><dd>CPU time of the steps to a simulated second; of several batches the fastest</dd>
<dt>Truth</dt><dd>a formula where there is one, else a solution of order 18, in {} bits or more; no number of a scene is rounded in
any of the scalars</dd></dl>
"##,
        markup(processor),
        report.version,
        markup(&report.command),
        crate::truth::BITS,
    )
}

/// Boxes that take lines out of the charts; they are the legend as well.
fn legend() -> String {
    let mut legend = String::from("<div class=\"legend\">");
    legend += &chart::marks().replace("<defs>", "<svg class=\"hidden\"><defs>").replace("</defs>", "</defs></svg>");
    let mut item = |id: String, look: Look, name: &str| {
        let _ = write!(legend, r#"<label><input type="checkbox" id="{id}" checked>{}{name}</label>"#, sample(look));
    };
    for (colour, integrator) in Integrator::ALL.into_iter().enumerate() {
        item(format!("c{colour}"), Look { colour, stroke: 0, marks: false }, &spoken(integrator));
    }
    for (stroke, scalar) in SCALARS.into_iter().enumerate() {
        item(format!("k{stroke}"), scalar_look(stroke), scalar);
    }
    legend + "</div>\n"
}

fn filters() -> String {
    let colours = (0..Integrator::ALL.len()).map(|i| format!("c{i}"));
    let strokes = (0..SCALARS.len()).map(|i| format!("k{i}"));
    let hide = |class| format!("body:has(#{class}:not(:checked)) .runs .{class} {{ display: none; }}\n");
    colours.chain(strokes).map(hide).collect()
}

/// The name of an integrator in a sentence.
pub(super) fn spoken(integrator: Integrator) -> String {
    integrator.name().replace('_', " ").replace("euler", "Euler").replace("verlet", "Verlet").replace("yo", "Yo")
}

/// 1.9·10⁻³, or what is short without a power.
pub(super) fn rounded(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if (0.01..1000.0).contains(&value) {
        let places = (1.0 - value.log10().floor()).max(0.0) as usize;
        return format!("{value:.places$}");
    }
    let text = format!("{value:.1e}");
    let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
    format!("{digits}·{}", power_of_ten(power.parse().unwrap_or(0)))
}

/// A time that a person can read.
pub(super) fn spent(seconds: f64) -> String {
    let (scale, unit) = match seconds {
        s if s < 1e-6 => (1e9, "ns"),
        s if s < 1e-3 => (1e6, "µs"),
        s if s < 1.0 => (1e3, "ms"),
        _ => (1.0, "s"),
    };
    let value = seconds * scale;
    if value < 10.0 { format!("{value:.1} {unit}") } else { format!("{value:.0} {unit}") }
}

/// A table with a head; what is in the cells is markup.
pub(super) fn table(head: &[String], rows: impl Iterator<Item = Vec<String>>) -> String {
    let row =
        |cells: &[String], tag: &str| cells.iter().map(|cell| format!("<{tag}>{cell}</{tag}>")).collect::<String>();
    let body: String = rows.map(|cells| format!("<tr>{}</tr>\n", row(&cells, "td"))).collect();
    format!("<div class=\"scroll\"><table><tr>{}</tr>\n{body}</table></div>\n", row(head, "th"))
}

pub(super) fn section(results: &Results) -> String {
    let charts = with_charts(results, |time, step| format!("{}{}", time.inline(), step.inline()));
    format!(
        "<section id=\"{}\"><h2>{}</h2>\n<p>{}</p>\n<p>{}</p>\n<div class=\"charts runs\">{charts}</div>\n<details><summary>Tables</summary>\n{}</details></section>\n",
        results.name,
        results.title,
        results.about,
        seen(results),
        tables(results)
    )
}

/// Draws with the two charts of a problem: error against time, error against the time step.
fn with_charts(results: &Results, draw: impl FnOnce(&Chart<'_>, &Chart<'_>) -> String) -> String {
    let points = |x: fn(&Measured) -> f64| -> Vec<Vec<(f64, f64)>> {
        let of_line =
            |line: &super::data::Line| line.runs.iter().filter_map(|run| Some((x(run), run.error?))).collect();
        results.lines.iter().map(of_line).collect()
    };
    let (times, steps) = (points(|run| run.cost), points(|run| 1.0 / f64::from(run.rate)));
    let label = format!("error after {} s in {}", results.seconds, results.unit);
    let y = Axis { label: &label, scale: Scale::log(times.iter().flatten().map(|point| point.1), WILD) };
    let chart = |x, points: &'_ [Vec<(f64, f64)>]| {
        let scale = Scale::log(points.iter().flatten().map(|point| point.0), f64::INFINITY);
        let lines = results.lines.iter().zip(points).enumerate().map(|(i, (line, points))| Line {
            name: format!("{}, {}", line.integrator.name(), line.scalar),
            look: Look { colour: i / SCALARS.len(), stroke: i % SCALARS.len(), marks: true },
            points: points.clone(),
        });
        Chart { x: Axis { label: x, scale }, y, lines: lines.collect() }
    };
    draw(&chart("CPU time to a simulated second, in s", &times), &chart("time step in s", &steps))
}

/// The conclusions in words.
fn seen(results: &Results) -> String {
    let mut words = String::new();
    let order = |integrator: &Integrator| {
        let order = results.line(*integrator, "fx")?.order?;
        Some(format!("{} {:.2}", spoken(*integrator), order.slope))
    };
    let orders: Vec<String> = Integrator::ALL.iter().filter_map(order).collect();
    if !orders.is_empty() {
        let steps = if results.has_contacts { "over all steps" } else { "at the finest steps" };
        let _ = write!(words, "Slopes {steps} where fx and f64 agree: {}. ", orders.join(", "));
    }
    let least = |scalar: &str| Some(format!("{} {} in {scalar}", rounded(results.least(scalar)?), results.unit));
    let least: Vec<String> = SCALARS.into_iter().filter_map(least).collect();
    if !least.is_empty() {
        let _ = write!(words, "Least error: {}. ", least.join(", "));
    }
    let mut ratios = results.cost_of_fixed_point("f64");
    ratios.sort_by(f64::total_cmp);
    if let (Some(from), Some(to)) = (ratios.first(), ratios.last()) {
        let _ = write!(words, "A step takes {from:.1} to {to:.1} times as long in fx as in f64. ");
    }
    let _ = write!(words, "The truth is known to {} {}.", rounded(results.reference_error), results.unit);
    words
}

fn tables(results: &Results) -> String {
    let head = |first: &str| -> Vec<String> {
        let lines = results.lines.iter().map(|line| format!("{}<br>{}", spoken(line.integrator), line.scalar));
        [first.to_owned()].into_iter().chain(lines).collect()
    };
    let rows = |cell: fn(&Measured) -> String| {
        let rates = results.lines.first().map_or(0, |line| line.runs.len());
        (0..rates).map(move |i| {
            let first = results.lines[0].runs[i].rate.to_string();
            [first].into_iter().chain(results.lines.iter().map(|line| cell(&line.runs[i]))).collect()
        })
    };
    let error = |run: &Measured| run.error.map_or("left the envelope".to_owned(), rounded);
    format!(
        "<h3>Error in {}</h3>\n{}<h3>CPU time to a simulated second</h3>\n{}",
        results.unit,
        table(&head("steps a second"), rows(error)),
        table(&head("steps a second"), rows(|run| spent(run.cost)))
    )
}

fn parted(parting: &Parting) -> String {
    const LOOKS: [(usize, usize); 7] = [(2, 0), (0, 0), (1, 2), (2, 1), (5, 2), (0, 1), (4, 1)];
    let lines = parting.pairs.iter().zip(LOOKS).map(|(pair, (colour, stroke))| Line {
        name: pair.name(),
        look: Look { colour, stroke, marks: false },
        points: parting.times.iter().copied().zip(pair.distance.iter().copied()).collect(),
    });
    let lines: Vec<Line> = lines.collect();
    let legend: String = lines.iter().map(|l| format!("<span>{}{}</span>", sample(l.look), l.name)).collect();
    let distances = parting.pairs.iter().flat_map(|pair| pair.distance.iter().copied());
    let end = parting.times.last().copied().unwrap_or(1.0);
    let chart = Chart {
        x: Axis { label: "time in s", scale: Scale::Linear(0.0, end) },
        y: Axis { label: "distance in m", scale: Scale::log(distances, f64::INFINITY) },
        lines,
    };
    let first = |time: Option<f64>| time.map_or("not within the run".to_owned(), |time| format!("{time} s"));
    let row = |pair: &Pair| vec![pair.name(), first(pair.beyond_millimetre), first(pair.beyond_metre)];
    let head = ["between", "1 mm apart", "1 m apart"].map(str::to_owned);
    format!(
        "<section id=\"parting\"><h2>When fx, f64 and f32 part ways</h2>\n<p>Three unequal masses, softened so that none is thrown out by a close encounter: chaotic, so that whatever differs at all grows exponentially until it is as large as the scene. Velocity Verlet at {} steps a second where nothing else is said. A straight line in this chart is exponential growth; a scalar with more bits starts lower and meets the same fate later. Against the truth, fx and f64 are one line: there it is the integrator that errs, not the arithmetic, and Yoshida's rule at the same step gains time. fx differs from the floats in one thing no chart shows: its motion is the same on every machine.</p>\n<div class=\"legend still\">{legend}</div>\n<div class=\"charts\">{}{}</div><p>The truth is known to {} m over the whole run.</p></section>\n",
        parting.rate,
        chart.inline(),
        table(&head, parting.pairs.iter().map(row)),
        rounded(parting.reference_error)
    )
}

impl Pair {
    fn name(&self) -> String {
        format!("{} – {}", self.a, self.b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!([0.0, 0.0194, 12.345, 345.6].map(rounded), ["0", "0.019", "12", "346"]);
        assert_eq!([3.14e-18, 12_345.0].map(rounded), ["3.1·10⁻¹⁸", "1.2·10⁴"]);
        assert_eq!([3.2e-7, 4.25e-5, 0.0123, 2.0].map(spent), ["320 ns", "42 µs", "12 ms", "2.0 s"]);
        assert_eq!(Integrator::ALL.map(spoken)[2..], ["velocity Verlet", "published Verlet", "Yoshida4"]);
    }
}
