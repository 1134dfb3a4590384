//! Energy over long runs: the symplectic integrators keep it as well as in f64, and what does not keep it is noticed.

use umbra_physics::scalar::{Factor, ToF64};
use umbra_physics::{
    Attachment, BodyDef, BodyId, Damping, End, FieldKind, Fx, FxFactor, Integrator, Scalar, SpringConstants, TimeStep,
    Vec2, World, WorldDef, fx,
};

/// A power of two, so that the damping control is one ulp of a second's damping.
const RATE: u32 = 256;

/// Periodic motions.
#[derive(Clone, Copy, Debug)]
enum Scene {
    /// x″ = −ω²x with ω = 8 rad/s from 10 m: 201 steps a period.
    Oscillator,
    /// About a mass, e = 0.6, half axis 10 m, a mean motion of 3 rad/s: 536 steps a period.
    Ellipse,
}

impl Scene {
    /// Steps a period.
    fn period(self) -> f64 {
        f64::from(RATE) * core::f64::consts::TAU / if matches!(self, Self::Oscillator) { 8.0 } else { 3.0 }
    }

    fn world<S: Scalar>(self, integrator: Integrator, kept: Fx) -> (World<S>, BodyId) {
        let number = S::from_fx;
        let def = WorldDef {
            time_step: TimeStep::hz(RATE),
            integrator,
            linear_damping: Damping::kept_per_second(number(kept)),
            sleep_after: None,
            ..WorldDef::default()
        };
        let mut world = World::with_scalar(def).expect("a fair definition");
        let origin = End::World(Vec2::ZERO);
        let (from, speed) = match self {
            Self::Oscillator => (fx!(10), fx!(30)),
            // 0.4 of the half axis, and n·a·√((1 + e)/(1 − e)) = 3·10·2.
            Self::Ellipse => (fx!(4), fx!(60)),
        };
        let (position, velocity) = (Vec2::new(number(from), S::ZERO), Vec2::new(S::ZERO, number(speed)));
        let body = world.add_body(BodyDef { position, velocity, ..BodyDef::dynamic() }).expect("a fair body");
        let field = match self {
            Self::Oscillator => FieldKind::Spring {
                near: Attachment { body, point: Vec2::ZERO },
                far: origin,
                spring: SpringConstants { rest: S::ZERO, stiffness: number(fx!(64)), damping: S::ZERO },
            },
            Self::Ellipse => {
                FieldKind::Attractor { centre: origin, mu: S::Factor::from_ratio(9000, 1), softening: S::ZERO }
            }
        };
        world.add_field(field).expect("a fair field");
        (world, body)
    }

    /// Energy per mass, from positions and velocities with all their bits.
    fn energy(self, [x, y, vx, vy]: [f64; 4]) -> f64 {
        let potential = match self {
            Self::Oscillator => 32.0 * (x * x + y * y),
            Self::Ellipse => -9000.0 / x.hypot(y),
        };
        (vx * vx + vy * vy) / 2.0 + potential
    }

    /// Relative difference of the mean energy of the last tenth of the periods to that of the first.
    fn drift<S: Scalar<Accumulator: ToF64>>(self, integrator: Integrator, kept: Fx, steps: u32) -> f64 {
        let (mut world, body) = self.world::<S>(integrator, kept);
        // Whole periods, so that the energy's swing within one cancels.
        let periods = (f64::from(steps) / self.period()).floor();
        let tenth = ((periods / 10.0).floor() * self.period()).round() as u32;
        let steps = (periods * self.period()).round() as u32;
        let (mut first, mut last) = (0.0, 0.0);
        for step in 0..steps {
            assert!(world.step().faults.is_empty());
            if step < tenth || step >= steps - tenth {
                let body = world.body(body).expect("it is there");
                let (x, v) = (body.position_exact(), body.velocity_exact());
                let energy = self.energy([x.x, x.y, v.x, v.y].map(|a| a.to_f64()));
                *(if step < tenth { &mut first } else { &mut last }) += energy / f64::from(tenth);
            }
        }
        (last - first) / first.abs()
    }
}

const ALLOWED: f64 = 1e-8;

/// Relative change by a scheme beyond the change by `control` at the same time step in f64.
fn excess(scene: Scene, integrator: Integrator, kept: Fx, control: Integrator, steps: u32) -> f64 {
    let (fixed, float) = (scene.drift::<Fx>(integrator, kept, steps), scene.drift::<f64>(control, Fx::ONE, steps));
    let excess = fixed - float;
    println!("{scene:?}, {}, {kept} a second: {excess:.1e} over {float:.1e} in f64", integrator.name());
    excess.abs()
}

fn steps() -> u32 {
    crate::seeds::times(100_000)
}

#[test]
fn energy_is_kept_as_in_f64() {
    use Integrator::{SymplecticEuler, VelocityVerlet, Yoshida4};
    for scene in [Scene::Oscillator, Scene::Ellipse] {
        for integrator in [SymplecticEuler, VelocityVerlet, Yoshida4] {
            let excess = excess(scene, integrator, Fx::ONE, integrator, steps());
            assert!(excess <= ALLOWED, "{scene:?}, {}: {excess:e} more than f64", integrator.name());
        }
    }
}

#[test]
fn explicit_euler_fails_the_test_of_energy() {
    for scene in [Scene::Oscillator, Scene::Ellipse] {
        let excess = excess(scene, Integrator::ExplicitEuler, Fx::ONE, Integrator::VelocityVerlet, 6_000);
        assert!(excess > ALLOWED, "{scene:?}: {excess:e}");
        // Not by what its windows cut off, but by what it gains: the oscillator's amplitude grows by √(1 + ω²dt²) a step.
        assert!(excess > 0.1, "{scene:?}: {excess:e}");
    }
}

#[test]
fn a_velocity_scaled_by_a_2_to_the_40th_a_step_fails_the_test_of_energy() {
    // (1 − 2^-32)^(1/256) = 1 − 2^-40, over a million steps. In a tenth of the steps ten times as much is lost in each.
    let kept = Fx::from_bits((1 << 32) - 1_000_000 / i64::from(steps()));
    for scene in [Scene::Oscillator, Scene::Ellipse] {
        let excess = excess(scene, Integrator::VelocityVerlet, kept, Integrator::VelocityVerlet, steps());
        assert!(excess > ALLOWED, "{scene:?}: {excess:e}");
    }
}

/// The largest relative change of the energy on a circle of 10 m about GM = 100 at 100 steps a second.
fn worst_on_a_circle(orbits: u32) -> f64 {
    let def = WorldDef { time_step: TimeStep::hz(100), sleep_after: None, ..WorldDef::default() };
    let mut world = World::new(def).expect("a fair definition");
    let speed = fx!(10).sqrt();
    let (position, velocity) = (Vec2::new(fx!(10), Fx::ZERO), Vec2::new(Fx::ZERO, speed));
    let body = world.add_body(BodyDef { position, velocity, ..BodyDef::dynamic() }).expect("a fair body");
    let mu = FxFactor::from_ratio(100, 1);
    let centre = End::World(Vec2::ZERO);
    world.add_field(FieldKind::Attractor { centre, mu, softening: Fx::ZERO }).expect("a fair field");
    let energy = |world: &World| {
        let body = world.body(body).expect("it is there");
        let (x, v) = (body.position_exact().map(|x| x.to_f64()), body.velocity_exact().map(|v| v.to_f64()));
        (v.x * v.x + v.y * v.y) / 2.0 - 100.0 / x.x.hypot(x.y)
    };
    let start = energy(&world);
    // A period is 2π·√(r³/GM) = 19.87 s.
    let worst = (0..orbits * 1987).map(|_| {
        world.step();
        ((energy(&world) - start) / start).abs()
    });
    let worst = worst.fold(0.0, f64::max);
    let reported = world.energy().expect("it fits").to_f64();
    assert!((reported - energy(&world)).abs() < 1e-8, "the world's own sum is {reported}");
    println!("{orbits} orbits: {worst:.1e}");
    worst
}

#[test]
fn a_circular_orbit_keeps_its_energy() {
    assert!(worst_on_a_circle(crate::seeds::times(10)) < 1e-9);
}
