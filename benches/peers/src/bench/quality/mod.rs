//! Quality of what stands, rests, slides and bounces, measured alike for all engines.

mod run;

use super::{Engines, Opt};
use crate::engine::Engine;
use crate::report::Report;
use crate::scene::{self, Scene};
use run::{Run, ticks};

/// A scene with what is measured of it.
struct Case {
    name: &'static str,
    scene: fn() -> Scene,
    /// Duration of the run and of the quick one, s.
    seconds: [f64; 2],
    /// Times whose states are kept, s.
    keep: &'static [f64],
    measure: fn(&Run, &mut Rows),
}

const MINUTES: [f64; 2] = [600.0, 20.0];

const CASES: &[Case] = &[
    Case {
        name: "pyramid40",
        scene: || scene::pyramid_on_grid(40),
        seconds: [10.0, 5.0],
        keep: &[5.0, 10.0],
        measure: tower,
    },
    Case { name: "tower20", scene: || scene::tower(20, 1.0), seconds: [3600.0, 20.0], keep: &[10.0], measure: tower },
    Case { name: "tower_100x", scene: || scene::tower(10, 100.0), seconds: [10.0, 5.0], keep: &[10.0], measure: tower },
    Case {
        name: "tower_1000x",
        scene: || scene::tower(5, 1000.0),
        seconds: [10.0, 5.0],
        keep: &[10.0],
        measure: tower,
    },
    Case { name: "belt", scene: scene::belt, seconds: [40.0, 15.0], keep: &[10.0, 40.0], measure: pile },
    Case { name: "mixed", scene: || scene::mixed(500), seconds: [25.0, 8.0], keep: &[5.0, 25.0], measure: pile },
    Case { name: "arch", scene: || scene::arch(15, 5.0, 6.0), seconds: MINUTES, keep: &[60.0, 600.0], measure: stones },
    Case {
        name: "thin_arch",
        scene: || scene::arch(25, 5.0, 5.75),
        seconds: MINUTES,
        keep: &[60.0, 600.0],
        measure: stones,
    },
    Case { name: "cards", scene: || scene::cards(8), seconds: MINUTES, keep: &[60.0, 600.0], measure: stones },
    Case { name: "hopper", scene: || scene::hopper(400), seconds: [40.0, 10.0], keep: &[10.0, 40.0], measure: hopper },
    Case { name: "break", scene: || scene::billiards(0.0), seconds: [3.0, 3.0], keep: &[], measure: energy },
    Case { name: "break_2mm", scene: || scene::billiards(0.002), seconds: [3.0, 3.0], keep: &[], measure: energy },
    Case { name: "flat_drop", scene: scene::flat_drop, seconds: [10.0, 10.0], keep: &[], measure: flat_drop },
    Case { name: "slope_below", scene: || scene::slope(-1e-3), seconds: [10.0, 10.0], keep: &[], measure: slope },
    Case { name: "slope_above", scene: || scene::slope(1e-3), seconds: [10.0, 10.0], keep: &[], measure: slope },
    Case { name: "bounce", scene: scene::bounce, seconds: [30.0, 30.0], keep: &[], measure: bounce },
    Case { name: "hang100", scene: || scene::hanging(100, 1.0), seconds: [60.0, 5.0], keep: &[], measure: chain },
    Case {
        name: "hang100_100x",
        scene: || scene::hanging(100, 100.0),
        seconds: [60.0, 5.0],
        keep: &[],
        measure: chain,
    },
    Case { name: "hang400", scene: || scene::hanging(400, 1.0), seconds: [600.0, 5.0], keep: &[], measure: chain },
    Case {
        name: "net",
        scene: || scene::net(20, false),
        seconds: [60.0, 5.0],
        keep: &[5.0, 20.0, 60.0],
        measure: joints_at_rest,
    },
    Case {
        name: "net_pins",
        scene: || scene::net(20, true),
        seconds: [60.0, 5.0],
        keep: &[5.0, 20.0, 60.0],
        measure: joints_at_rest,
    },
    Case { name: "ropes", scene: scene::ropes, seconds: [20.0, 5.0], keep: &[5.0, 20.0], measure: joints_at_rest },
    Case {
        name: "bridge",
        scene: || scene::bridge(30, 20.0),
        seconds: [30.0, 5.0],
        keep: &[5.0, 30.0],
        measure: joints_at_rest,
    },
    Case {
        name: "bridge_160x",
        scene: || scene::bridge(30, 1000.0),
        seconds: [30.0, 5.0],
        keep: &[5.0, 30.0],
        measure: joints_at_rest,
    },
    Case { name: "pendulum", scene: scene::pendulum, seconds: [1000.0, 100.0], keep: &[], measure: pendulum },
];

/// The names of the scenes, for `--scene quality:NAME`.
pub fn names() -> impl Iterator<Item = &'static str> {
    CASES.iter().map(|c| c.name)
}

pub fn quality(rep: &mut Report, engines: Engines, opt: &Opt) {
    let chosen = |c: &&Case| opt.parts.is_empty() || opt.parts.iter().any(|p| p == c.name);
    for case in CASES.iter().filter(chosen) {
        let s = Scene { name: case.name.into(), ..(case.scene)() };
        for e in engines {
            match e.refuse(&s) {
                Some(why) => rep.skip(e.id(), &s.name, s.n, &why),
                None => run_case(rep, *e, case, &s, opt.quick),
            }
        }
    }
}

fn run_case(rep: &mut Report, e: &dyn Engine, case: &Case, s: &Scene, quick: bool) {
    let keep: Vec<usize> = case.keep.iter().map(|&t| ticks(s, t)).collect();
    let run = Run::new(e, s.clone(), ticks(s, case.seconds[usize::from(quick)]), &keep);
    let mut rows = Rows(Vec::new());
    (case.measure)(&run, &mut rows);
    if s.contacts {
        rows.add("overlap_worst", "m", run.worst_overlap);
        rows.add("overlap_end", "m", run.end_overlap);
    }
    if s.symmetry.is_some() {
        rows.add("asymmetry", "m", run.asymmetry);
    }
    let length = format!("{} s", run.ticks as f64 * s.dt);
    for (name, unit, value) in rows.0 {
        rep.one(e.id(), &s.name, s.n, &name, unit, value, length.clone());
    }
    for twin in &run.twins {
        let (equal, note) = match twin.differs {
            Some(tick) => (0.0, format!("differs at tick {tick}")),
            None => (1.0, format!("{} ticks", twin.ticks)),
        };
        rep.one(e.id(), &s.name, s.n, twin.name, "bool", equal, note);
    }
    rep.one(e.id(), &s.name, s.n, "step_mean", "us", run.mean_step_us, length);
}

/// Measures of a run: name, unit, value.
struct Rows(Vec<(String, &'static str, f64)>);

impl Rows {
    fn add(&mut self, name: impl Into<String>, unit: &'static str, value: f64) {
        self.0.push((name.into(), unit, value));
    }

    /// The largest speeds at the ticks kept, and the first tick since when all bodies rest.
    fn rest(&mut self, run: &Run) {
        for kept in &run.kept {
            self.add(format!("max_speed@{}", kept.tick), "m/s", kept.largest_speed);
        }
        self.add("rest_after", "ticks", run.rest_after.map_or(f64::INFINITY, |t| t as f64));
    }
}

/// The bodies that can move, by index.
fn movers(s: &Scene) -> impl Iterator<Item = usize> {
    (0..s.bodies.len()).filter(|&i| s.bodies[i].kind == scene::Kind::Dynamic)
}

/// The largest of a measure over all bodies that can move.
fn most(run: &Run, measure: impl Fn(usize) -> f64) -> f64 {
    movers(&run.scene).map(measure).fold(0.0, super::geometry::largest)
}

fn tower(run: &Run, rows: &mut Rows) {
    let (start, end) = (&run.start, &run.end().states);
    let top = end.len() - 1;
    rows.add("top_sink", "m", start[top].y - end[top].y);
    rows.add("top_shift", "m", (end[top].x - start[top].x).abs());
    rows.add("largest_shift", "m", most(run, |i| (end[i].x - start[i].x).abs()));
    rows.add("largest_tilt", "rad", most(run, |i| (end[i].angle - start[i].angle).abs()));
    rows.rest(run);
}

fn pile(run: &Run, rows: &mut Rows) {
    rows.rest(run);
}

/// Structures that stand for minutes: how far they moved, and whether they still creep.
fn stones(run: &Run, rows: &mut Rows) {
    let end = &run.end().states;
    let moved = |from: &[crate::engine::State], i: usize| (end[i].x - from[i].x).hypot(end[i].y - from[i].y);
    rows.add("largest_shift", "m", most(run, |i| moved(&run.start, i)));
    if let Some(minute) = run.after(60.0).filter(|k| k.tick < run.ticks) {
        rows.add("creep_after_60s", "m", most(run, |i| moved(&minute.states, i)));
    }
    rows.rest(run);
}

fn hopper(run: &Run, rows: &mut Rows) {
    for kept in &run.kept {
        let through = movers(&run.scene).filter(|&i| kept.states[i].y < 10.0).count();
        rows.add(format!("through@{}", kept.tick), "discs", through as f64);
    }
    rows.rest(run);
}

fn energy(run: &Run, rows: &mut Rows) {
    let share = |e: f64| e / run.kinetic[0];
    rows.add("energy_left", "1", share(run.kinetic[run.ticks]));
    rows.add("energy_most", "1", share(run.kinetic.iter().copied().fold(0.0, super::geometry::largest)));
}

fn flat_drop(run: &Run, rows: &mut Rows) {
    let rises = run.path.iter().position(|q| q.vy > 0.0).unwrap_or(run.ticks);
    let top = run.path[rises..].iter().map(|q| q.y - 0.5).fold(0.0, f64::max);
    rows.add("bounce_height", "m", top);
    let farthest = |f: fn(&crate::engine::State) -> f64| run.path.iter().map(f).fold(0.0, super::geometry::largest);
    rows.add("sideways", "m", farthest(|q| q.x.abs()));
    rows.add("tilt", "rad", farthest(|q| q.angle.abs()));
}

/// The mean acceleration between 5 s and 10 s, beside the law of friction. Before, a box that
/// holds still loses the speed of its first contact.
fn slope(run: &Run, rows: &mut Rows) {
    let (Some(a), Some(b)) = (run.last_body(5.0), run.last_body(10.0)) else { return };
    let law = scene::slope_acceleration(&run.scene);
    let measured = (b.vx.hypot(b.vy) - a.vx.hypot(a.vy)) / 5.0;
    rows.add("moved", "m", (b.x - a.x).hypot(b.y - a.y));
    rows.add("acceleration", "m/s2", measured);
    if law > 0.0 {
        rows.add("acceleration_err", "1", measured / law - 1.0);
    }
}

/// Heights of the flights after each bounce, beside e^2n h.
fn bounce(run: &Run, rows: &mut Rows) {
    let gravity = -run.scene.gravity[1];
    let (e, h) = (run.scene.bodies[0].restitution, run.path[0].y - 0.5);
    // The energy height at the tick that is nearest to the top of the flight.
    let mut tops = Vec::new();
    let mut rising = false;
    for q in &run.path {
        if q.vy > 0.0 {
            let height = q.y - 0.5 + q.vy * q.vy / (2.0 * gravity);
            if rising {
                *tops.last_mut().expect("a flight has begun") = height;
            } else {
                tops.push(height);
            }
        }
        rising = q.vy > 0.0;
    }
    for n in [1, 5, 10, 21] {
        let law = h * e.powi(2 * n as i32);
        let top = tops.get(n - 1).copied().unwrap_or(0.0);
        rows.add(format!("height_err_{n}"), "1", top / law - 1.0);
    }
}

fn chain(run: &Run, rows: &mut Rows) {
    let last = run.start.len() - 1;
    rows.add("stretch", "m", run.start[last].y - run.end().states[last].y);
    joints_at_rest(run, rows);
}

fn joints_at_rest(run: &Run, rows: &mut Rows) {
    rows.add("worst_joint_gap", "m", run.worst_gap);
    rows.rest(run);
}

/// The change of energy, as a share of m g l.
fn pendulum(run: &Run, rows: &mut Rows) {
    let gravity = -run.scene.gravity[1];
    let (mass, _) = run.scene.bodies[1].mass_inertia();
    let scale = mass * gravity * run.start[1].x;
    for seconds in [10.0, 100.0, 1000.0] {
        if let Some(q) = run.last_body(seconds) {
            let change = run.kinetic[ticks(&run.scene, seconds)] + mass * gravity * (q.y - run.start[1].y);
            rows.add(format!("energy_change@{seconds}s"), "mgl", change / scale);
        }
    }
    rows.add("worst_joint_gap", "m", run.worst_gap);
}

#[cfg(test)]
mod tests {
    use super::CASES;
    use crate::scene::{Body, Shape, mirrored, shuffled};

    fn numbers(b: &Body) -> Vec<f64> {
        let mut v = vec![b.x, b.y, b.angle, b.vx, b.vy, b.w];
        match b.shape {
            Shape::None { .. } => {}
            Shape::Circle { r } => v.push(r),
            Shape::Box { hx, hy } => v.extend([hx, hy]),
            Shape::Capsule { half: [x, y], r } => v.extend([x, y, r]),
            Shape::Frame { hx, hy, wall } => v.extend([hx, hy, wall]),
            Shape::Polygon(c) => v.extend(c.as_slice().iter().flatten()),
        }
        v
    }

    #[test]
    fn coordinates_and_sizes_are_multiples_of_a_power_of_two() {
        for case in CASES {
            let scene = (case.scene)();
            let all = scene.bodies.iter().flat_map(numbers);
            let off = all.filter(|v| (v * f64::from(1 << 20)).fract() != 0.0).count();
            assert_eq!(off, 0, "{}", case.name);
        }
    }

    #[test]
    fn twins_map_back_to_the_scene() {
        for case in CASES {
            let scene = (case.scene)();
            assert_eq!(mirrored(&mirrored(&scene)).bodies, scene.bodies, "{}", case.name);
            let (twin, original) = shuffled(&scene, 1);
            let back = original.iter().map(|&i| scene.bodies[i]);
            assert!(twin.bodies.iter().copied().eq(back), "{}", case.name);
            let mut indices = original.clone();
            indices.sort_unstable();
            assert!(indices.into_iter().eq(0..scene.bodies.len()), "{}", case.name);
            let ends =
                |j: &crate::scene::Joint, order: &[usize]| (order[j.a], order[j.b], j.x.to_bits(), j.y.to_bits());
            let same: Vec<usize> = (0..scene.bodies.len()).collect();
            let mut moved: Vec<_> = twin.joints.iter().map(|j| ends(j, &original)).collect();
            let mut kept: Vec<_> = scene.joints.iter().map(|j| ends(j, &same)).collect();
            moved.sort_unstable();
            kept.sort_unstable();
            assert_eq!(moved, kept, "{}", case.name);
        }
    }
}
