//! The part on contacts: problems in which bodies meet, their orders and where these end.

use umbra_physics::Integrator;

use super::SCALARS;
use super::conclude::link;
use super::data::{Report, Results};
use super::page::{rounded, section as problem_section, table};

const ABOUT: &str = "<p>Motions along a plane with a formula: impacts, friction at its limit and below it. Contacts are claimed to be of \
    order 1, with every integrator. Three things limit them to that:</p>\n<ul>\n\
    <li><strong>Impacts.</strong> A body that meets another one within a step stops there in the sub-step in which they meet. It bounces \
    once a step, at its end: the rest of the step is not flown. Where in the step they meet is chance, so that the error is a saw below a \
    line of order 1.</li>\n\
    <li><strong>Arms.</strong> A contact is found at the start of a step and keeps its point, in the middle of the gap that is still open \
    there. At an impact friction acts on an arm that is too long by half of the gap: by up to half of the way of a step.</li>\n\
    <li><strong>Sub-steps.</strong> Impulses move bodies as semi-implicit Euler does, with the sub-step (a fifth of a step). Of the free \
    flight only the part that impulses cancel is put right, so that bodies at rest stay where they are.</li>\n</ul>\n\
    <p>A disc that rolls without slip has none of these. The order ends where rounding is as large: in fx the solver \
    has velocities in multiples of 2⁻²² m/s (coarser for bodies that are faster than 3 m/s), and what friction may take in a sub-step of \
    h seconds, μ·g·h, is a whole number of such units: the error grows with the number of steps.</p>\n";

/// The problems with contacts, and a table of their orders; nothing if there are none.
pub(super) fn section(report: &Report) -> String {
    if report.contacts.is_empty() {
        return String::new();
    }
    let problems: String = report.contacts.iter().map(problem_section).collect();
    format!(
        "<section id=\"contacts\"><h2>Contacts</h2>\n{ABOUT}<p>With velocity Verlet:</p>\n{}</section>\n{problems}",
        orders(&report.contacts)
    )
}

fn orders(contacts: &[Results]) -> String {
    const VERLET: Integrator = Integrator::VelocityVerlet;
    let mut head = vec!["problem".to_owned(), "slope".to_owned(), "between".to_owned()];
    head.extend(SCALARS.map(|scalar| format!("least error<br>in {scalar}")));
    head.extend(["fx errs twice<br>as much as f64 from", "f32 from"].map(str::to_owned));
    let row = |results: &Results| {
        let order = results.line(VERLET, "fx").and_then(|line| line.order);
        let slope = order.map_or("–".to_owned(), |order| format!("{:.2}", order.slope));
        let between = order.map_or("–".to_owned(), |order| format!("{}/s and {}/s", order.from_rate, order.to_rate));
        let least = |scalar| {
            let errors =
                results.line(VERLET, scalar).into_iter().flat_map(|line| &line.runs).filter_map(|run| run.error);
            errors
                .min_by(f64::total_cmp)
                .map_or("–".to_owned(), |error| format!("{} {}", rounded(error), results.unit))
        };
        let end = |scalar| results.end_of(scalar, VERLET).map_or("–".to_owned(), |rate| format!("{rate}/s"));
        [link(results), slope, between].into_iter().chain(SCALARS.map(least)).chain(["fx", "f32"].map(end)).collect()
    };
    table(&head, contacts.iter().map(row))
}
