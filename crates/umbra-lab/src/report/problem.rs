//! The problems: scenes whose motion is known.

use umbra_physics::{BodyRef, Fx, Scalar, World, fx};
use umbra_scene::{Scene, SceneErrors};

use crate::truth::{BITS, Closed, Equations, Exact, MORE_BITS, Real, TAU, closed, real, solve, to_f64};

/// A scene and how its motion is known.
pub(crate) struct Problem {
    /// On the command line and in the data.
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    /// A description: what it is and what to look for.
    pub(crate) about: &'static str,
    /// The time at which the error is read, s: a whole number of steps of any length that is tried.
    pub(crate) seconds: u32,
    /// All its numbers are exact in f32 too: no scalar errs before the first step.
    scene: &'static str,
    known: Known,
}

enum Known {
    Formula(Closed),
    /// A numerical solution in so many steps a second.
    Steps(u32),
}

/// The exact places of the bodies at the end of a problem: (x, y) of each, or an angle.
pub(crate) struct Truth {
    at_end: Vec<Real>,
    /// The distance of the solution from one with twice the steps, or from the formula with half as many bits more, m or rad.
    pub(crate) error: f64,
}

pub(crate) const PROBLEMS: [Problem; 13] = [
    Problem {
        name: "fall-with-drag",
        title: "Fall with drag and wind",
        about: "A shell of 2 kg at 100 m/s, gravity, linear and quadratic drag against a wind. Drag is solved exactly \
                and split around the kick, so the error is that of the splitting.",
        seconds: 5,
        scene: r#"{"gravity": [0, -9.8125], "sleep_after": null,
            "bodies": [{"name": "shell", "mass": 2, "velocity": [60, 80]}],
            "fields": [{"drag": {"linear": 0.5, "quadratic": 0.015625, "wind": [8, 2]}}]}"#,
        known: Known::Steps(4),
    },
    Problem {
        name: "damped-fall",
        title: "Damped fall",
        about: "Gravity, and damping that halves the velocity every second. Both are solved exactly by themselves; what \
                is left is how they are put together.",
        seconds: 5,
        scene: r#"{"gravity": [0, -9.8125], "sleep_after": null, "damping": {"linear": {"kept_per_second": 0.5}},
            "bodies": [{"name": "ball", "velocity": [60, 80]}]}"#,
        known: Known::Formula(Closed::DampedFall),
    },
    Problem {
        name: "oscillator",
        title: "Harmonic oscillator",
        about: "1 kg on a spring of 40 N/m around the origin: ten seconds, ten swings.",
        seconds: 10,
        scene: r#"{"sleep_after": null,
            "bodies": [{"name": "weight", "position": [1, 0.25], "velocity": [-0.5, 2]}],
            "fields": [{"spring": {"from": "weight", "to": [0, 0], "stiffness": 40}}]}"#,
        known: Known::Formula(Closed::Oscillator),
    },
    Problem {
        name: "kepler-circle",
        title: "Kepler, e = 0",
        about: "A circle of 10 m about an attractor, a radian a second, ten seconds. Symplectic Euler and the published \
                scheme start as if half a step beside the circle.",
        seconds: 10,
        scene: r#"{"sleep_after": null, "bodies": [{"name": "planet", "position": [10, 0], "velocity": [0, 10]}],
            "fields": [{"attractor": {"at": [0, 0], "mu": 1000}}]}"#,
        known: Known::Formula(Closed::Kepler),
    },
    Problem {
        name: "kepler-0.6",
        title: "Kepler, e = 0.6",
        about: "An ellipse with a half axis of 10 m from its nearest point, ten seconds: 1.6 times round, past the nearest \
                point once more, where it turns five times as fast as on average.",
        seconds: 10,
        scene: r#"{"sleep_after": null, "bodies": [{"name": "planet", "position": [4, 0], "velocity": [0, 20]}],
            "fields": [{"attractor": {"at": [0, 0], "mu": 1000}}]}"#,
        known: Known::Formula(Closed::Kepler),
    },
    Problem {
        name: "kepler-0.9",
        title: "Kepler, e = 0.9",
        about: "As before on a thin ellipse (e = 0.8999), which passes its nearest point, 1 m, at 44 m/s: forty times \
                as fast as on average. A step of constant length that is fine enough there is too fine elsewhere.",
        seconds: 10,
        scene: r#"{"sleep_after": null, "bodies": [{"name": "comet", "position": [1, 0], "velocity": [0, 44]}],
            "fields": [{"attractor": {"at": [0, 0], "mu": 1019}}]}"#,
        known: Known::Formula(Closed::Kepler),
    },
    Problem {
        name: "spin",
        title: "Spin under a torque",
        about: "A constant torque of 1/8 N·m on 1/4 kg·m². Velocity Verlet and Yoshida's rule are exact for constant \
                forces: what they show is rounding alone.",
        seconds: 10,
        scene: r#"{"sleep_after": null,
            "bodies": [{"name": "wheel", "mass": 1, "inertia": 0.25, "angular_velocity": 1}]}"#,
        known: Known::Formula(Closed::Spin(fx!(0.125))),
    },
    Problem {
        name: "figure-eight",
        title: "Three bodies on a figure eight",
        about: "Three equal masses that attract each other chase along one curve (Moore 1993; Chenciner, Montgomery 2000), \
                1.6 times round. The motion is stable: errors grow with time, not exponentially.",
        seconds: 10,
        scene: r#"{"sleep_after": null, "bodies": [
                {"name": "a", "position": [0.970001220703125, -0.2430877685546875], "velocity": [0.4662017822265625, 0.432373046875]},
                {"name": "b", "position": [-0.970001220703125, 0.2430877685546875], "velocity": [0.4662017822265625, 0.432373046875]},
                {"name": "c", "velocity": [-0.932403564453125, -0.86474609375]}],
            "fields": [{"attractor": {"at": "a", "mu": 1}}, {"attractor": {"at": "b", "mu": 1}},
                {"attractor": {"at": "c", "mu": 1}}]}"#,
        known: Known::Steps(10),
    },
    Problem {
        name: "stiff-pendulum",
        title: "Pendulum on a stiff spring",
        about: "1 kg on a spring of 2 m and 10,000 N/m in gravity: it swings in seconds and rings at 100 rad/s. With \
                steps above 2/100 s the ringing grows without bound in every scheme, in Yoshida's above 1.57/100 s, and \
                the weight leaves the envelope. In explicit Euler it grows at any step: its line is steep where that \
                ends to matter.",
        seconds: 5,
        scene: r#"{"gravity": [0, -10], "sleep_after": null,
            "bodies": [{"name": "bob", "position": [1.25, -1.5625]}],
            "fields": [{"spring": {"from": "bob", "to": [0, 0], "rest": 2, "stiffness": 10000}}]}"#,
        known: Known::Steps(100),
    },
    Problem {
        name: "bouncing-ball",
        title: "Bouncing ball",
        about: "A ball falls 2 m and bounces with e = 3/4: four impacts in three seconds. A bounce happens once a step, and what is \
                left of that step is not flown: the line is a saw, as it is chance when in a step the ball arrives.",
        seconds: 3,
        scene: r#"{"gravity": [0, -10], "sleep_after": null, "bodies": [
                {"name": "ball", "position": [0, 2.5],
                    "colliders": [{"shape": {"circle": {"radius": 0.5}}, "restitution": 0.75}]},
                {"name": "floor", "kind": "static", "position": [0, -1],
                    "colliders": [{"shape": {"rectangle": {"width": 16, "height": 2}}}]}]}"#,
        known: Known::Formula(Closed::Disc),
    },
    Problem {
        name: "sliding-block",
        title: "Block that slides and stops",
        about: "A flat block slides down a slope of 3 in 4 from 2.03 m/s. With μ = 7/8 friction takes 1 m/s² more than the slope \
                gives: it stops after 2.03 seconds and stays. Friction beyond what the slope gives moves the block as semi-implicit \
                Euler does in the sub-steps of the solver.",
        seconds: 3,
        scene: r#"{"gravity": [0, -10], "sleep_after": null, "bodies": [
                {"name": "block", "velocity": [-1.625, -1.21875], "colliders": [{"friction": 0.875, "shape":
                    {"polygon": [[0.40625, 0.5], [-0.59375, -0.25], [-0.40625, -0.5], [0.59375, 0.25]]}}]},
                {"name": "slope", "kind": "static", "position": [0.84375, -1.125], "colliders": [{"friction": 0.875, "shape":
                    {"polygon": [[31.25, 25], [-32.75, -23], [-31.25, -25], [32.75, 23]]}}]}]}"#,
        known: Known::Formula(Closed::Slide),
    },
    Problem {
        name: "rolling-disc",
        title: "Disc that rolls down a slope",
        about: "A disc rolls from rest down a slope of 3 in 4 without slipping, at 2/3 of a slide without friction. Here friction \
                is below its limit and nothing starts or stops: with velocity Verlet and Yoshida's rule the order is 2.",
        seconds: 2,
        scene: r#"{"gravity": [0, -10], "sleep_after": null, "bodies": [
                {"name": "disc", "colliders": [{"friction": 0.5, "shape": {"circle": {"radius": 0.625}}}]},
                {"name": "slope", "kind": "static", "position": [1.125, -1.5], "colliders": [{"friction": 0.5, "shape":
                    {"polygon": [[31.25, 25], [-32.75, -23], [-31.25, -25], [32.75, 23]]}}]}]}"#,
        known: Known::Formula(Closed::Disc),
    },
    Problem {
        name: "landing-disc",
        title: "Spinning disc that lands",
        about: "A disc with a spin of 48 rad/s falls 1 m, slides on the floor with μ = 1/4 and rolls in the end. The impact is where it \
                errs: friction acts at the middle of the gap that is left at the start of the step, farther from the centre than the rim.",
        seconds: 3,
        scene: r#"{"gravity": [0, -10], "sleep_after": null, "bodies": [
                {"name": "disc", "position": [0, 1.375], "angular_velocity": -48,
                    "colliders": [{"friction": 0.25, "shape": {"circle": {"radius": 0.375}}}]},
                {"name": "floor", "kind": "static", "position": [0, -1],
                    "colliders": [{"friction": 0.25, "shape": {"rectangle": {"width": 64, "height": 2}}}]}]}"#,
        known: Known::Formula(Closed::Disc),
    },
];

impl Problem {
    /// The scene, to be started with any scalar, integrator and time step.
    pub(crate) fn scene(&self) -> Result<Scene, SceneErrors> {
        Scene::parse(self.scene)
    }

    /// Returns true if its bodies touch each other.
    pub(crate) fn has_contacts(&self) -> bool {
        matches!(self.known, Known::Formula(Closed::Slide | Closed::Disc))
    }

    /// The torque that is applied at each tick, N·m.
    pub(crate) fn torque(&self) -> Option<Fx> {
        if let Known::Formula(Closed::Spin(torque)) = self.known { Some(torque) } else { None }
    }

    /// The unit of its errors.
    pub(crate) fn unit(&self) -> &'static str {
        if self.torque().is_some() { "rad" } else { "m" }
    }

    /// Computes where its bodies are at its end; `None` if that is not known for such a scene.
    pub(crate) fn truth(&self, start: &World) -> Option<Truth> {
        let (rough, at_end) = match self.known {
            Known::Formula(formula) => {
                let with = |bits| closed(formula, start, self.seconds, bits);
                (with(BITS)?, with(MORE_BITS)?)
            }
            Known::Steps(rate) => {
                let equations = Equations::of(start)?;
                let with = |rate: u32| {
                    let mut state = state(start);
                    solve(&equations, &mut state, &(real(1) / real(rate.into())), self.seconds * rate);
                    positions(&state)
                };
                (with(rate), with(2 * rate))
            }
        };
        let error = self.distance(&rough, &at_end);
        Some(Truth { at_end, error })
    }

    /// The largest distance of a body from the truth, m; of an angle, rad.
    pub(crate) fn error<S: Scalar<Accumulator: Exact, Angle: Exact>>(&self, world: &World<S>, truth: &Truth) -> f64 {
        let coordinates = |body: BodyRef<'_, S>| {
            if self.torque().is_some() {
                return vec![body.angle_exact().exact()];
            }
            let at = body.position_exact();
            vec![at.x.exact(), at.y.exact()]
        };
        let positions: Vec<Real> = world.bodies().flat_map(coordinates).collect();
        self.distance(&positions, &truth.at_end)
    }

    fn distance(&self, a: &[Real], b: &[Real]) -> f64 {
        if self.torque().is_some() {
            let turns = (&a[0] - &b[0]) / &*TAU;
            return to_f64(&((&turns - turns.round()) * &*TAU)).abs();
        }
        largest_distance(a, b)
    }
}

/// The largest distance between points of two lists, (x, y) after (x, y).
pub(crate) fn largest_distance(a: &[Real], b: &[Real]) -> f64 {
    let apart = |(a, b): (&[Real], &[Real])| to_f64(&(&a[0] - &b[0])).hypot(to_f64(&(&a[1] - &b[1])));
    a.chunks(2).zip(b.chunks(2)).map(apart).fold(0.0, f64::max)
}

/// (x, y, v_x, v_y) of each body.
pub(crate) fn state(world: &World) -> Vec<Real> {
    let body_state = |body: BodyRef<'_>| {
        let (x, v) = (body.position_exact(), body.velocity_exact());
        [x.x, x.y, v.x, v.y].map(Exact::exact)
    };
    world.bodies().flat_map(body_state).collect()
}

/// (x, y) of each body of a state.
pub(crate) fn positions(state: &[Real]) -> Vec<Real> {
    state.chunks(4).flat_map(|body| body[..2].to_vec()).collect()
}
