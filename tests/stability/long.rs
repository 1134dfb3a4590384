//! Long runs: energy, momentum and angular momentum over up to ten million steps of velocity Verlet.
//!
//! Velocity Verlet keeps angular momentum, and beside the energy it swings in an energy of its own, but for rounding:
//! drifts and forces come from public velocities and positions, which are within half an ulp of what is carried. Over
//! many steps these errors are as good as independent of each other, and what they add up to walks at random.

use umbra_physics::scalar::ToF64;
use umbra_physics::{Fx, Integrator, fx, vec2};

use crate::seeds::is_short;
use crate::stability::momentum::{Exact, apart, momentum, rounding};
use crate::stability::scene::{Gravity, Scene, Weighed, look};

/// A scene, and what is needed to judge it.
pub(crate) struct Run {
    pub(crate) name: &'static str,
    pub(crate) scene: Scene,
    pub(crate) rate: u32,
    /// The fastest rate in it, rad/s.
    pub(crate) fastest: f64,
    /// True if only the bodies themselves attract.
    pub(crate) is_free: bool,
}

/// 4 kg and 1 kg about each other, e = 0.3 with a half axis of 10 m and a mean motion of 1 rad/s: 1,508 steps a period.
fn orbit() -> Run {
    // From the farthest point, 13 m: √(0.7 / 1.3) of n·a.
    let mut scene = Scene::pair([fx!(4), fx!(1)], fx!(13), fx!(7.3379938571));
    scene.gravity = Some(Gravity { constant: fx!(200), softening: fx!(0) });
    // n·√(1 + e)/(1 − e)^1.5 when nearest.
    Run { name: "orbit", scene, rate: 240, fastest: 1.95, is_free: true }
}

/// ω = 1 rad/s, on an ellipse of 10 by 6 m.
fn oscillator() -> Run {
    let scene = Scene::oscillator(fx!(1), fx!(1), vec2(10, 0), vec2(0, 6));
    Run { name: "oscillator", scene, rate: 240, fastest: 1.0, is_free: false }
}

/// 5 by 5 bodies of 1 and 3 kg. A spring adds at most 2·k/m to the square of a rate; four meet in a body.
fn spring_net() -> Run {
    Run { name: "spring net", scene: Scene::net(5, [fx!(1), fx!(3)]), rate: 240, fastest: 800f64.sqrt(), is_free: true }
}

/// Distance of a run from its start, measured or allowed.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Drift {
    /// J.
    pub(crate) energy: f64,
    /// The energy that velocity Verlet keeps, J.
    pub(crate) shadow: f64,
    /// kg·m²/s.
    pub(crate) angular: f64,
    /// kg·m/s.
    pub(crate) momentum: f64,
}

impl Run {
    /// The farthest that a run of so many steps comes, and what is allowed.
    pub(crate) fn go<S: Exact>(&self, integrator: Integrator, steps: u32) -> [Drift; 2] {
        /// A prime: no period is a multiple of it.
        const EVERY: u32 = 97;
        let mut world = self.scene.world::<S>(self.rate, integrator);
        let weigh = |world: &_| self.scene.weigh(&look::<S>(world));
        let (start, momentum_then) = (weigh(&world), momentum(&self.scene, &world));
        let (mut samples, mut worst) = (vec![start], Drift::default());
        let square = f64::from(self.rate).powi(-2);
        for step in 1..=steps {
            assert!(world.step().faults.is_empty(), "{} in {}, step {step}", self.name, integrator.name());
            if step % EVERY == 0 {
                let now = weigh(&world);
                let energy = now.energy - start.energy;
                let shadow = energy + square * (now.shadow - start.shadow);
                worst.energy = worst.energy.max(energy.abs());
                worst.shadow = worst.shadow.max(shadow.abs());
                worst.angular = worst.angular.max((now.angular_momentum - start.angular_momentum).abs());
                worst.momentum = worst.momentum.max(apart(&momentum(&self.scene, &world), &momentum_then));
                samples.push(now);
            }
        }
        [worst, self.allowed(&samples, steps)]
    }

    /// Bounds on the error of velocity Verlet and of the rounding of `Fx` in a run observed like this.
    fn allowed(&self, samples: &[Weighed], steps: u32) -> Drift {
        let h = 1.0 / f64::from(self.rate);
        let largest = |f: fn(&Weighed) -> f64| samples.iter().map(|w| f(w).abs()).fold(0.0, f64::max);
        // A rounding error is uniform within half an ulp: its variance is a twelfth. Five deviations of the walk.
        let walk = |noise: fn(&Weighed) -> f64| {
            let mean_square = samples.iter().map(|w| noise(w).powi(2)).sum::<f64>() / samples.len() as f64;
            5.0 * h * Fx::DELTA.to_f64() * (f64::from(steps) * mean_square / 12.0).sqrt()
        };
        let swing = h * h * largest(|w| w.shadow);
        // The next term of the series is smaller by (h·ω)².
        let shadow = (h * self.fastest).powi(2) * swing + walk(|w| w.energy_noise);
        Drift {
            energy: 2.0 * swing + shadow,
            shadow,
            angular: walk(|w| w.angular_noise),
            momentum: rounding(&self.scene, self.rate, steps, largest(|w| w.pull)),
        }
    }

    /// Velocity Verlet in fixed point keeps what it should. Angular momentum, and the oscillator's energy, end up about
    /// one deviation off, a fifth of what is allowed.
    pub(crate) fn assert_keeps(&self, steps: u32) {
        let [is, allowed] = self.go::<Fx>(Integrator::VelocityVerlet, steps);
        println!("{}, {steps} steps:\n{is:?} of\n{allowed:?}", self.name);
        assert!(is.energy <= allowed.energy, "{}: energy", self.name);
        assert!(is.shadow <= allowed.shadow, "{}: shadow energy", self.name);
        assert!(is.angular <= allowed.angular, "{}: angular momentum", self.name);
        assert!(!self.is_free || is.momentum <= allowed.momentum, "{}: momentum", self.name);
    }

    /// Singles do not keep it.
    pub(crate) fn assert_f32_fails(&self, steps: u32) {
        let [is, allowed] = self.go::<f32>(Integrator::VelocityVerlet, steps);
        assert!(is.shadow > allowed.shadow, "{}: shadow energy", self.name);
        assert!(is.angular > allowed.angular, "{}: angular momentum", self.name);
    }
}

#[test]
fn orbits_and_springs_keep_what_they_should() {
    // By night ten million steps, of the net one million.
    let steps = |by_day, by_night| if is_short() { by_day } else { by_night };
    for run in [orbit(), oscillator()] {
        run.assert_keeps(steps(100_000, 10_000_000));
    }
    spring_net().assert_keeps(steps(10_000, 1_000_000));
}

#[test]
fn singles_do_not_keep_it() {
    for run in [orbit(), oscillator(), spring_net()] {
        run.assert_f32_fails(3_000);
    }
}

#[test]
fn explicit_euler_does_not_keep_it() {
    for run in [orbit(), oscillator(), spring_net()] {
        let [is, allowed] = run.go::<Fx>(Integrator::ExplicitEuler, 1_000);
        assert!(is.energy > allowed.energy, "{}: energy", run.name);
        assert!(is.shadow > allowed.shadow, "{}: shadow energy", run.name);
        assert!(is.angular > allowed.angular, "{}: angular momentum", run.name);
    }
}
