//! A picture of time against error.

use std::error::Error;
use std::path::Path;

use plotters::prelude::*;

use crate::report::Report;

/// Panels: the scene, its metric, and what the picture says of them.
const PANELS: [[&str; 4]; 3] = [
    ["hanging", "gap", "A chain of 100 links that hangs", "widest gap of a joint, m"],
    ["chain", "gap", "A chain of 100 links, let go level", "widest gap of a joint, m"],
    ["pendulum", "energy_drift", "A pendulum", "largest change of energy, of m·g·l"],
];

const COLOURS: [RGBColor; 5] = [
    RGBColor(31, 119, 180),
    RGBColor(214, 39, 40),
    RGBColor(44, 160, 44),
    RGBColor(148, 103, 189),
    RGBColor(127, 127, 127),
];

/// The values of an engine by sub-steps: µs a step, and the error.
fn curve(rep: &Report, engine: &str, scene: &str, metric: &str) -> Vec<(f64, f64)> {
    let value = |metric: String| {
        let row = rep.rows.iter().find(|row| row.engine == engine && row.scene == scene && row.metric == metric);
        row.map(|row| row.value)
    };
    (1..=16)
        .filter_map(|substeps| Some((value(format!("step/{substeps}"))?, value(format!("{metric}/{substeps}"))?)))
        .collect()
}

/// Draws the rows of the scene `joint_errors`, a curve for each engine over its numbers of sub-steps.
pub fn joint_errors(rep: &Report, engines: &[&str], path: &Path) -> Result<(), Box<dyn Error>> {
    let picture = SVGBackend::new(path, (1500, 460)).into_drawing_area();
    picture.fill(&WHITE)?;
    for (area, [scene, metric, title, unit]) in picture.split_evenly((1, PANELS.len())).iter().zip(PANELS) {
        let curves: Vec<(&str, Vec<(f64, f64)>)> = engines
            .iter()
            .map(|engine| (*engine, curve(rep, engine, scene, metric)))
            .filter(|(_, points)| !points.is_empty())
            .collect();
        let points = || curves.iter().flat_map(|(_, points)| points);
        let range = |part: fn(&(f64, f64)) -> f64| {
            let (lowest, highest) = points()
                .map(part)
                .fold((f64::INFINITY, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
            lowest / 1.5..highest * 1.5
        };
        if curves.is_empty() {
            return Err("there are no rows of the scene joint_errors".into());
        }
        let mut chart = ChartBuilder::on(area)
            .caption(title, ("sans-serif", 18))
            .margin(12)
            .x_label_area_size(42)
            .y_label_area_size(70)
            .build_cartesian_2d(range(|point| point.0).log_scale(), range(|point| point.1).log_scale())?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .x_labels(5)
            .x_label_formatter(&|value| format!("{value:.0}"))
            .x_desc("µs a step")
            .y_desc(unit)
            .y_label_formatter(&|value| format!("{value:.0e}"))
            .draw()?;
        for ((engine, points), colour) in curves.iter().zip(COLOURS) {
            let line = LineSeries::new(points.iter().copied(), colour.stroke_width(2)).point_size(3);
            chart
                .draw_series(line)?
                .label(*engine)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], colour.stroke_width(2)));
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .background_style(WHITE.mix(0.8))
            .border_style(BLACK.mix(0.3))
            .draw()?;
    }
    picture.present()?;
    Ok(())
}
