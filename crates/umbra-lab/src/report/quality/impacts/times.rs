//! Time against error for impacts, by sub-steps and by steps a second.

use umbra_physics::scalar::ToF64;
use umbra_physics::{Error, TimeStep, World};

use super::super::rows::{Length, Played, Promise, measure, played};
use super::super::run::Run;
use super::super::scenes::{Scene, bounce};
use super::{off, scenes};
use crate::chart::{Axis, Chart, Line, Look, Scale, marks, sample};
use crate::cost::cpu_seconds;

const RATES: [u32; 5] = [30, 60, 120, 240, 480];
const SUBSTEPS: [u32; 4] = [1, 2, 5, 10];

/// A problem: a scene, and what its energy should be at the end.
struct Problem {
    title: &'static str,
    scene: Scene,
    seconds: u32,
    /// The energy at the end, J, as a share of that at the start.
    share: f64,
}

impl Problem {
    fn world(&self, rate: u32, substeps: u32) -> Result<World, Error> {
        let def = umbra_physics::WorldDef { time_step: TimeStep::hz(rate), ..self.scene.def };
        Scene { def, bodies: self.scene.bodies.clone(), springs: Vec::new(), mirror: None }.build(substeps)
    }

    /// The relative error of the energy at the end.
    fn error(&self, rate: u32, substeps: u32) -> Result<f64, Error> {
        let mut world = self.world(rate, substeps)?;
        let start = world.energy()?.to_f64() - self.ground(&world);
        (0..self.seconds * rate).for_each(|_| _ = world.step());
        Ok(off(world.energy()?.to_f64() - self.ground(&world), start * self.share))
    }

    /// The energy that the disc has on the ground: its centre is 0.5 m above it. In a gas there is no gravity.
    fn ground(&self, world: &World) -> f64 {
        let mass = world.bodies().filter_map(|body| body.mass()).map(ToF64::to_f64).sum::<f64>();
        0.5 * mass * -world.def().gravity.y.to_f64()
    }

    /// The CPU time to a simulated second, s: of some runs the fastest.
    fn cost(&self, rate: u32, substeps: u32, runs: u32) -> Result<f64, Error> {
        let start = self.world(rate, substeps)?;
        let mut world = start.clone();
        let (mut batch, mut least) = (1, f64::INFINITY);
        for _ in 0..runs {
            let seconds = cpu_seconds(&mut batch, || {
                world.clone_from(&start);
                (0..self.seconds * rate).for_each(|_| _ = world.step());
            });
            least = least.min(seconds / f64::from(self.seconds));
        }
        Ok(least)
    }

    fn chart(&self, runs: u32) -> Result<String, Error> {
        let mut lines = Vec::new();
        for (colour, substeps) in SUBSTEPS.into_iter().enumerate() {
            let mut points = Vec::new();
            for rate in RATES {
                points.push((self.cost(rate, substeps, runs)?, self.error(rate, substeps)?));
            }
            let look = Look { colour, stroke: 0, marks: true };
            lines.push(Line { name: format!("{substeps} sub-steps"), look, points });
        }
        let values = || lines.iter().flat_map(|line| line.points.iter().copied());
        let x = Scale::log(values().map(|(cost, _)| cost), f64::INFINITY);
        let y = Scale::log(values().map(|(_, error)| error), 1.0);
        let chart = Chart {
            x: Axis { label: "CPU time to a simulated second, s", scale: x },
            y: Axis { label: "relative error", scale: y },
            lines,
        };
        Ok(format!("<h4>{}</h4>\n{}\n", self.title, chart.inline()))
    }
}

/// Five bounces of a disc from 10 m with restitution 0.9 end before 11 s.
fn bounces() -> Result<Problem, Error> {
    Ok(Problem { title: "Height after five bounces", scene: bounce()?, seconds: 11, share: 0.9_f64.powi(10) })
}

fn gas(length: Length) -> Result<Problem, Error> {
    let seconds = if length.quick { 2 } else { 20 };
    Ok(Problem { title: "Energy of a gas", scene: scenes::gas(0)?, seconds, share: 1.0 })
}

fn legend() -> String {
    let mut legend = marks().replace("<defs>", "<svg class=\"hidden\"><defs>").replace("</defs>", "</defs></svg>");
    for (colour, substeps) in SUBSTEPS.into_iter().enumerate() {
        legend += &format!("<label>{} {substeps}</label> ", sample(Look { colour, stroke: 0, marks: true }));
    }
    format!("<p class=\"legend\">Sub-steps: {legend}</p>\n")
}

pub(super) fn play(length: Length) -> Result<Played, Error> {
    let problems = [bounces()?, gas(length)?];
    let errors = [problems[0].error(60, length.substeps)?, problems[1].error(60, length.substeps)?];
    let measures = vec![
        measure("bounce_err", "relative error of the height, 60 steps a second", "", errors[0])
            .promised(Promise::AtMost(1e-3)),
        measure("gas_err", "of the energy of the gas", "", errors[1]).promised(Promise::AtMost(0.01)),
    ];
    let mut charts = legend();
    for problem in &problems {
        charts += &problem.chart(if length.quick { 1 } else { 3 })?;
    }
    let length = format!("{} s and {} s", problems[0].seconds, problems[1].seconds);
    let run = Run::new(&problems[1].scene, 5)?;
    Ok(Played { length, charts, ..played(run, measures) })
}
