//! Impacts beside their closed forms: energies, speeds and spins.

mod scenes;
mod times;

use std::f64::consts::TAU;

use umbra_physics::scalar::ToF64;
use umbra_physics::{BodyDef, Error, Fx, World, fx};

use super::rows::{Length, Played, Promise, Row, measure, played};
use super::run::{Run, State};
use crate::chart::{Axis, Chart, Line, Look, Scale};

pub(super) static ROWS: [Row; 8] = [
    Row {
        name: "ghosts",
        title: "Discs past a corner",
        about: "Sixteen discs pass the corner of a block at 1 cm to 1 m, with 5 to 300 m/s. They touch nothing and exchange nothing.",
        view: Some([(-4.5, -2.5), (3.0, 4.0)]),
        play: ghosts,
    },
    Row {
        name: "bounces",
        title: "Bounces beside a floor",
        about: "A hundred discs slide on a floor against a wall, each at another moment of a step. Each comes back with e times its speed.",
        view: Some([(-0.5, -0.5), (6.5, 3.0)]),
        play: bounces,
    },
    Row {
        name: "gas",
        title: "Gas of 40 elastic discs",
        about: "Discs with restitution 1 and without friction in a room. The chart shows the energy of each of the runs over time.",
        view: None,
        play: gas,
    },
    Row {
        name: "row",
        title: "Disc into a row with gaps",
        about: "A disc runs into six at rest, all with restitution 1, with gaps of 1 to 30 cm and 3 to 30 m/s. The last one leaves with its speed, the others rest.",
        view: None,
        play: row,
    },
    Row {
        name: "overhang",
        title: "Crate on an overhang",
        about: "A crate falls on one that lies 0.3 m aside on a fixed one. After the plastic impact of 3.16 m/s both spin with 0.055 rad/s. A stack stands it from 0.5 m.",
        view: Some([(-4.0, -0.5), (4.0, 5.0)]),
        play: overhang,
    },
    Row {
        name: "half_pipe",
        title: "Ball in a half pipe",
        about: "A ball swings in half a circle of 30 to 240 segments, with and without friction. It never rises above its start.",
        view: Some([(-3.5, -0.5), (3.5, 3.5)]),
        play: half_pipe,
    },
    Row {
        name: "corridor",
        title: "Ball in a corridor that is too narrow",
        about: "A ball of 1.01 m flies across a corridor of 1 m, with restitutions up to 0.9. It comes to rest in the middle.",
        view: Some([(-3.0, -1.0), (3.0, 2.0)]),
        play: corridor,
    },
    Row {
        name: "time_error",
        title: "Time against error",
        about: "Five bounces of a disc from 10 m, and a gas: the relative error of the height and of the energy against CPU time, for 30 to 480 steps a second and 1 to 10 sub-steps. The times differ from run to run.",
        view: None,
        play: times::play,
    },
];

/// The largest of a measure of many cases.
fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, f64::max)
}

/// The relative difference of a value from what it should be.
fn off(value: f64, exact: f64) -> f64 {
    (value / exact - 1.0).abs()
}

/// The number of bodies that do not move as they did at first.
fn changed(run: &Run) -> usize {
    let is_changed = |(start, now): (&State, &State)| start.velocity != now.velocity || start.spin != now.spin;
    run.start.iter().zip(&run.now).filter(|states| is_changed(*states)).count()
}

fn ghosts(length: Length) -> Result<Played, Error> {
    let bullet = BodyDef { bullet: true, ..BodyDef::dynamic() };
    let mut counts = [0; 3];
    for (count, block) in counts.iter_mut().zip([BodyDef::fixed(), BodyDef::dynamic(), bullet]) {
        let mut run = Run::new(&scenes::ghosts(block)?, length.substeps)?;
        run.step(30);
        *count = changed(&run);
    }
    let count = |name, about, count: usize| measure(name, about, "bodies", count as f64).promised(Promise::Zero);
    let measures = vec![
        count("deflected_fixed", "deflected by a fixed block", counts[0]),
        count("deflected_dynamic", "by or with one that moves freely", counts[1]),
        count("deflected_bullet", "by or with one that is a bullet", counts[2]),
    ];
    // The picture shows the discs beside the corner.
    let mut run = Run::new(&scenes::ghosts(BodyDef::fixed())?, length.substeps)?;
    run.step(8);
    Ok(Played { length: "0.5 s".to_owned(), ..played(run, measures) })
}

fn bounces(length: Length) -> Result<Played, Error> {
    let mut worst = 0.0_f64;
    let mut lost = 0;
    let mut run = Run::new(&scenes::bounces(fx!(3), fx!(1))?, length.substeps)?;
    // The number of steps is that in which the slowest disc comes back.
    for (speed, ticks) in [(fx!(1.5), 92), (fx!(20), 10), (fx!(3), 48)] {
        for restitution in [fx!(1), fx!(0.5), fx!(0.8)] {
            run = Run::new(&scenes::bounces(speed, restitution)?, length.substeps)?;
            run.step(ticks);
            let expected = -(speed.to_f64() * restitution.to_f64());
            worst = worst.max(largest(run.now.iter().map(|disc| off(disc.velocity[0], expected))));
            lost += run.now.iter().filter(|disc| disc.velocity[0] > 0.5 * expected).count();
        }
    }
    let measures = vec![
        measure("speed_err", "largest relative error of the speed", "", worst).promised(Promise::AtMost(1e-3)),
        measure("lost", "bounces of less than half the speed, of 900", "bounces", lost as f64).promised(Promise::Zero),
    ];
    Ok(Played { length: "900 bounces".to_owned(), ..played(run, measures) })
}

/// The relative change of the energy of a gas in each second.
fn drifts(run: &mut Run, seconds: u64) -> Vec<(f64, f64)> {
    let start = run.kinetic();
    let mut drifts = vec![(0.0, 0.0)];
    for second in 1..=seconds {
        run.step(60);
        drifts.push((second as f64, run.kinetic() / start - 1.0));
    }
    drifts
}

fn gas(length: Length) -> Result<Played, Error> {
    let count = if length.quick { 2 } else { 20 };
    let (mut lines, mut run) = (Vec::new(), Run::new(&scenes::gas(0)?, length.substeps)?);
    for seed in 0..count {
        run = Run::new(&scenes::gas(seed)?, length.substeps)?;
        let points = drifts(&mut run, 120);
        lines.push(Line {
            name: format!("gas {seed}"),
            look: Look { colour: seed as usize % crate::chart::COLOURS, stroke: 0, marks: false },
            points,
        });
    }
    let worst =
        |seconds: usize| largest(lines.iter().flat_map(|line| &line.points[..=seconds]).map(|(_, off)| off.abs()));
    let measures = vec![
        measure("energy_err_20s", "largest change of the energy in 20 s", "", worst(20))
            .promised(Promise::AtMost(0.01)),
        measure("energy_err_2min", "in 2 minutes", "", worst(120)).promised(Promise::AtMost(0.05)),
    ];
    let largest = worst(120).max(1e-9);
    let chart = Chart {
        x: Axis { label: "time, s", scale: Scale::Linear(0.0, 120.0) },
        y: Axis { label: "relative change of the energy", scale: Scale::Linear(-1.2 * largest, 1.2 * largest) },
        lines,
    };
    Ok(Played { length: format!("{count} gases, 120 s each"), charts: chart.inline(), ..played(run, measures) })
}

fn row(length: Length) -> Result<Played, Error> {
    let [mut last_off, mut others, mut energy_off] = [0.0_f64; 3];
    let mut passed = 0;
    let mut run = Run::new(&scenes::row(fx!(0.3), 3)?, length.substeps)?;
    for speed in [30, 10, 3] {
        let share = 1.0 / f64::from(speed);
        for gap in [fx!(0.01), fx!(0.03), fx!(0.1), fx!(0.3)] {
            run = Run::new(&scenes::row(gap, speed)?, length.substeps)?;
            let energy = run.kinetic();
            // The time in which the impact reaches the end of the row, and some steps.
            run.step((60.0 * (4.0 + 6.0 * gap.to_f64()) * share) as u64 + 6);
            if let Some((leaving, resting)) = run.now.split_last() {
                last_off = last_off.max(off(leaving.velocity[0] * share, 1.0));
                others = others.max(largest(resting.iter().map(|disc| disc.speed() * share)));
            }
            energy_off = energy_off.max(off(run.kinetic(), energy));
            passed += run.now.windows(2).filter(|pair| pair[0].at[0] >= pair[1].at[0]).count();
        }
    }
    let bar = Promise::AtMost(0.05 / 3.0);
    let measures = vec![
        measure("last_err", "relative error of the speed of the last one", "", last_off).promised(bar),
        measure("others", "largest speed of the others, as a share", "", others).promised(bar),
        measure("energy_err", "relative change of the energy", "", energy_off).promised(Promise::AtMost(1e-3)),
        measure("passed", "discs that passed their neighbour", "discs", passed as f64).promised(Promise::Zero),
    ];
    Ok(Played { length: "12 rows".to_owned(), ..played(run, measures) })
}

/// Returns true as long as the last body touches nothing.
fn is_falling(world: &World) -> bool {
    let last = world.bodies().last().map(|body| body.id());
    world.contacts().all(|contact| contact.bodies.iter().all(|body| Some(*body) != last))
}

fn overhang(length: Length) -> Result<Played, Error> {
    let mut spin = 0.0_f64;
    for phase in 0..12 {
        let mut run = Run::new(&scenes::overhang(fx!(0.5) - Fx::from(phase) * fx!(0.004))?, length.substeps)?;
        while is_falling(&run.world) && run.world.tick() < 30 {
            run.step(1);
        }
        spin = spin.max(largest(run.now.iter().map(|body| body.spin.abs())));
    }
    let [mut tilt, mut fallen] = [0.0_f64; 2];
    let mut stack = Run::new(&scenes::stack(fx!(0))?, length.substeps)?;
    for step in 1..=20 {
        stack = Run::new(&scenes::stack(Fx::from(step) * fx!(0.025))?, length.substeps)?;
        stack.step(180);
        tilt = tilt.max(largest(stack.path.iter().map(|state| state.angle.min(TAU - state.angle))));
        let height = stack.now.last().map_or(0.0, |last| last.at[1]);
        fallen += f64::from((height - 3.5).abs() > 0.03);
    }
    let measures = vec![
        measure("spin", "largest spin after the impact", "rad/s", spin).promised(Promise::AtMost(0.1)),
        measure("tilt", "largest tilt on a stack, 20 drops of up to 0.5 m", "rad", tilt).promised(Promise::AtMost(0.1)),
        measure("fallen", "stacks that fell", "stacks", fallen).promised(Promise::Zero),
    ];
    Ok(Played { length: "3 s each".to_owned(), ..played(stack, measures) })
}

fn half_pipe(length: Length) -> Result<Played, Error> {
    let seconds = if length.quick { 10 } else { 60 };
    let [mut rise, mut kept] = [0.0, 1.0];
    let mut run = Run::new(&scenes::half_pipe(30, fx!(0))?, length.substeps)?;
    for segments in [240, 120, 60, 30] {
        for friction in [fx!(0), fx!(0.6)] {
            run = Run::new(&scenes::half_pipe(segments, friction)?, length.substeps)?;
            run.step(60 * seconds);
            let start = run.path[0].at[1];
            let highest = |path: &[State]| largest(path.iter().map(|state| state.at[1]));
            rise = largest([rise, highest(&run.path) - start]);
            // From the lowest place of the centre, 0.25 m, in the last three seconds.
            if segments == 240 && friction == Fx::ZERO {
                kept = (highest(&run.path[(60 * seconds - 180) as usize..]) - 0.25) / (start - 0.25);
            }
        }
    }
    let measures = vec![
        measure("rise", "highest above the start", "m", rise).promised(Promise::AtMost(0.0)),
        measure("kept", "share of the height at the end, 240 segments, no friction", "", kept),
    ];
    Ok(played(run, measures))
}

fn corridor(length: Length) -> Result<Played, Error> {
    let [mut speed, mut aside] = [0.0_f64; 2];
    let mut run = Run::new(&scenes::corridor(1, fx!(0))?, length.substeps)?;
    for restitution in [fx!(0), fx!(0.3), fx!(0.5), fx!(0.9)] {
        for start in [1, 5, 20] {
            run = Run::new(&scenes::corridor(start, restitution)?, length.substeps)?;
            run.step(60);
            speed = speed.max(run.largest_speed());
            aside = aside.max(largest(run.now.iter().map(|ball| (ball.at[1] - 0.5).abs())));
        }
    }
    let measures = vec![
        measure("speed", "largest speed after 1 s", "m/s", speed).promised(Promise::AtMost(0.05)),
        measure("aside", "distance from the middle", "m", aside).promised(Promise::AtMost(6e-3)),
    ];
    Ok(played(run, measures))
}
