//! The closing section: what follows for a choice, in numbers of this run.

use std::fmt::Write as _;

use umbra_physics::Integrator;

use super::SCALARS;
use super::analysis::median;
use super::data::{Report, Results};
use super::page::{rounded, spent, spoken, table};

/// Errors somebody may need, m or rad.
const NEEDS: [(f64, &str); 4] = [(1e-2, "1 cm"), (1e-4, "0.1 mm"), (1e-6, "1 µm"), (1e-9, "1 nm")];

pub(super) fn conclusions(report: &Report) -> String {
    let mut section = String::from("<section id=\"conclude\"><h2>What to conclude</h2>\n");
    section += &which_integrator(&report.problems);
    section += &what_fixed_point_costs(&report.problems);
    section += &where_scalars_stop(&report.problems);
    section + "</section>\n"
}

fn which_integrator(problems: &[Results]) -> String {
    let mut head = vec!["problem".to_owned()];
    head.extend(NEEDS.map(|(_, name)| format!("to {name}")));
    let row = |results: &Results| {
        let cell = |(need, _): (f64, &str)| {
            results.cheapest("fx", need).map_or("–".to_owned(), |(integrator, run)| {
                format!("{}<br>{}/s, {}", spoken(integrator), run.rate, spent(run.cost))
            })
        };
        [link(results)].into_iter().chain(NEEDS.map(cell)).collect()
    };
    let mut text = String::from("<h3>Which integrator, at which step</h3>\n<ul>\n");
    for (need, name) in NEEDS {
        let _ = writeln!(text, "<li>To {name}: {}.</li>", winners(problems, need));
    }
    let never: Vec<String> =
        Integrator::ALL.into_iter().filter(|integrator| !ever_cheapest(problems, *integrator)).map(spoken).collect();
    if !never.is_empty() {
        let _ = writeln!(text, "<li>Never the cheapest: {}.</li>", never.join(", "));
    }
    let dearer = problems.iter().filter_map(|results| {
        let last = |integrator| Some(results.line(integrator, "fx")?.runs.last()?.cost);
        Some(last(Integrator::Yoshida4)? / last(Integrator::VelocityVerlet)?)
    });
    if let Some(dearer) = median(dearer.collect()) {
        let _ = writeln!(
            text,
            "<li>A step of Yoshida4 takes {dearer:.1} times as long as one of velocity Verlet in fx (median). It pays for \
             itself below the error at which their lines cross.</li>"
        );
    }
    text += "</ul>\n<p>The cheapest run in fx that errs by no more, with its steps a second and its time to a simulated second (m, or rad for the spin; only the steps that were tried; – where none is good enough):</p>\n";
    text + &table(&head, problems.iter().map(row))
}

/// The integrators that are the cheapest in fx for an error, one for each problem where one is good enough.
fn cheapest(problems: &[Results], need: f64) -> impl Iterator<Item = Integrator> + '_ {
    problems.iter().filter_map(move |results| Some(results.cheapest("fx", need)?.0))
}

fn ever_cheapest(problems: &[Results], integrator: Integrator) -> bool {
    NEEDS.into_iter().any(|(need, _)| cheapest(problems, need).any(|winner| winner == integrator))
}

/// Says how often each integrator is the cheapest in fx for an error.
fn winners(problems: &[Results], need: f64) -> String {
    let count = |integrator| (cheapest(problems, need).filter(|&winner| winner == integrator).count(), integrator);
    let mut counted = Integrator::ALL.map(count);
    counted.sort_by_key(|(count, _)| core::cmp::Reverse(*count));
    let won = counted.iter().filter(|(count, _)| *count > 0);
    let mut parts: Vec<String> = won.map(|(count, winner)| format!("{} in {count}", spoken(*winner))).collect();
    let missing = problems.len() - cheapest(problems, need).count();
    if missing > 0 {
        parts.push(format!("none good enough in {missing}"));
    }
    format!("{} of {} problems", parts.join(", "), problems.len())
}

pub(super) fn link(results: &Results) -> String {
    format!("<a href=\"#{}\">{}</a>", results.name, results.title)
}

fn what_fixed_point_costs(problems: &[Results]) -> String {
    let all = |beside| median(problems.iter().flat_map(|results| results.cost_of_fixed_point(beside)).collect());
    let mut text = String::from("<h3>What fixed point costs</h3>\n");
    if let (Some(double), Some(single)) = (all("f64"), all("f32")) {
        let _ = writeln!(
            text,
            "<p>A step in fx takes {double:.1} times as long as in f64 and {single:.1} times as long as in f32 (median over problems and integrators). What it buys is not accuracy but agreement: the same bits on every machine.</p>"
        );
    }
    let head = ["problem", "to f64, median", "to f64, most", "to f32, median"].map(str::to_owned);
    let ratio = |ratio: Option<f64>| ratio.map_or("–".to_owned(), |ratio| format!("{ratio:.1}"));
    let row = |results: &Results| {
        let double = results.cost_of_fixed_point("f64");
        let largest = double.iter().copied().max_by(f64::total_cmp);
        vec![link(results), ratio(median(double)), ratio(largest), ratio(median(results.cost_of_fixed_point("f32")))]
    };
    text + &table(&head, problems.iter().map(row))
}

fn where_scalars_stop(problems: &[Results]) -> String {
    let mut head = vec!["problem".to_owned()];
    head.extend(SCALARS.map(|scalar| format!("least error<br>in {scalar}")));
    head.push("velocity Verlet in f32<br>errs twice as much as in f64 from".to_owned());
    head.push("Yoshida4 from".to_owned());
    let end = |results: &Results, integrator| {
        results.end_of("f32", integrator).map_or("–".to_owned(), |rate| format!("{rate}/s"))
    };
    let row = |results: &Results| {
        let least = |scalar| {
            let least = results.least(scalar);
            least.map_or("–".to_owned(), |error| format!("{} {}", rounded(error), results.unit))
        };
        let ends = [Integrator::VelocityVerlet, Integrator::Yoshida4].map(|integrator| end(results, integrator));
        [link(results)].into_iter().chain(SCALARS.map(least)).chain(ends).collect()
    };
    let reached = |scalar: &str| median(problems.iter().filter_map(|results| results.least(scalar)).collect());
    let mut text = String::from("<h3>Where each scalar stops</h3>\n");
    if let [Some(fixed), Some(double), Some(single)] = SCALARS.map(reached) {
        let _ = writeln!(
            text,
            "<p>The least error with any integrator and step is {} in fx, {} in f64 and {} in f32 (median over problems, m or rad). In f32 a finer step soon makes things worse: each step rounds, and there are more of them. fx carries the remainders of positions and velocities from step to step, so that its rounding comes only from what forces and drift read, 2⁻³² m and m/s.</p>",
            rounded(fixed),
            rounded(double),
            rounded(single)
        );
    }
    text + &table(&head, problems.iter().map(row))
}
