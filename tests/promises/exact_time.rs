//! P2: time is exact, whatever the steps.

use dashu_int::UBig;
use proptest::collection::vec;
use proptest::prelude::*;
use umbra_oracles::Script;
use umbra_physics::{BodyDef, Command, Elapsed, Error, Fx, Integrator, TimeStep, World, WorldDef, limits};

use crate::promises::check::{Verdict, check_of, config, falsified, there_is};
use crate::promises::plan::FAIR;
use crate::promises::real::{Real, exact, real, to_f64, units};

/// Steps of one length after steps of another.
type Steps = Vec<(TimeStep, u64)>;

fn gcd(mut a: UBig, mut b: UBig) -> UBig {
    while b != UBig::ZERO {
        (a, b) = (b.clone(), a % b);
    }
    a
}

/// num/den and so many steps, over their least common denominator.
fn later((num, den): (&UBig, &UBig), ticks: u64, step: TimeStep) -> (UBig, UBig) {
    let (n, d) = step.seconds();
    let common = den / gcd(den.clone(), d.into()) * UBig::from(d);
    let sum = num * (&common / den) + UBig::from(n) * UBig::from(ticks) * (&common / UBig::from(d));
    (sum, common)
}

/// The elapsed time is the sum of the steps in lowest terms; a step is refused where that is no ratio of 128 bits in 2^64
/// steps' time, and nowhere else.
fn is_the_sum(steps: &Steps) -> Verdict {
    let mut world = World::new(WorldDef::default()).expect("the standard world");
    let (mut num, mut den) = (UBig::ZERO, UBig::ONE);
    for &(step, ticks) in steps {
        let (furthest, common) = later((&num, &den), u64::MAX, step);
        let fits = furthest.bit_len().max(common.bit_len()) <= 128;
        let done = world.set_time_step(step);
        if done != if fits { Ok(()) } else { Err(Error::ElapsedTime) } {
            return Err(format!("{step:?} after {num}/{den}: {done:?}"));
        }
        let step = world.def().time_step;
        for _ in 0..ticks {
            world.step();
            let (sum, common) = later((&num, &den), 1, step);
            let divisor = gcd(sum.clone(), common.clone());
            (num, den) = (sum / &divisor, common / divisor);
            let Elapsed { num: n, den: d } = world.elapsed();
            if (UBig::from(n), UBig::from(d)) != (num.clone(), den.clone()) {
                return Err(format!("{n}/{d} s, not {num}/{den}"));
            }
        }
    }
    Ok(())
}

trait BitLen {
    fn bit_len(&self) -> usize;
}

impl BitLen for UBig {
    fn bit_len(&self) -> usize {
        dashu_int::ops::BitTest::bit_len(self)
    }
}

fn any_step() -> BoxedStrategy<TimeStep> {
    // From one a second to ten thousand; the denominators' common multiple soon is beyond all bounds.
    let ratio = (1u32..=400_000, any::<u64>()).prop_map(|(num, more)| {
        let more = more % (u64::from(num) * 9_999 + 1);
        TimeStep::ratio(num, num + more as u32)
    });
    prop_oneof![4 => (1u32..=10_000).prop_map(TimeStep::hz), 1 => ratio].boxed()
}

#[test]
fn elapsed_time_is_the_sum_of_any_steps() {
    let steps = vec((any_step(), 0u64..20), 0..24);
    let counterexample = falsified(config(40), steps, is_the_sum);
    assert!(counterexample.is_none(), "{counterexample:?}");
}

/// A body thrown in a gravity, and the steps it goes.
#[derive(Clone, Debug)]
struct Fall {
    world: WorldDef,
    body: BodyDef,
    steps: Steps,
}

impl Fall {
    fn script(&self) -> Script {
        let mut commands = vec![(0, Command::AddBody(self.body.clone()))];
        let mut tick = 0;
        for &(step, ticks) in &self.steps {
            commands.push((tick, Command::SetTimeStep(step)));
            tick += ticks;
        }
        Script { world: self.world, commands, ticks: tick }
    }

    /// Farther off its parabola than so many ulps, of a gravity of so many ulps/s² and after so many seconds.
    fn strays(&self, allowed: impl Fn(i128, f64) -> f64) -> Verdict {
        let script = self.script();
        let mut world = script.start().map_err(|error| error.to_string())?;
        let BodyDef { position, velocity, gravity_scale, .. } = self.body;
        let gravity = self.world.gravity;
        for tick in 1..=script.ticks {
            script.advance(&mut world, &mut ());
            if tick % 16 != 0 && tick != script.ticks {
                continue;
            }
            let Elapsed { num, den } = world.elapsed();
            let seconds = units(num, 0) / units(den, 0);
            let place = world.bodies().next().ok_or("it is there")?.position();
            let axes = [(place.x, position.x, velocity.x, gravity.x), (place.y, position.y, velocity.y, gravity.y)];
            for (is, x, v, g) in axes {
                let half: Real = exact(g) * exact(gravity_scale) / real(2);
                let parabola = exact(x) + (exact(v) + half * &seconds) * &seconds;
                let off = to_f64(&((exact(is) - parabola) << 32)).abs();
                let pull = (i128::from(g.to_bits()) * i128::from(gravity_scale.to_bits())) >> 32;
                let allowed = allowed(pull, to_f64(&seconds));
                if off > allowed {
                    return Err(format!("{off} ulps off at tick {tick}, {num}/{den} s, not {allowed} at most"));
                }
            }
        }
        Ok(())
    }
}

/// Falls whose ends are within the envelope.
fn fall(
    integrators: &'static [Integrator],
    scale: BoxedStrategy<Fx>,
    steps: BoxedStrategy<Steps>,
) -> impl Strategy<Value = Fall> {
    let parts = (FAIR.vector(20, limits::POSITION), FAIR.vector(20, limits::SPEED), FAIR.vector(12, limits::GRAVITY));
    (parts, scale, steps, prop::sample::select(integrators))
        .prop_map(|((position, velocity, gravity), gravity_scale, steps, integrator)| Fall {
            world: WorldDef { gravity, integrator, sleep_after: None, ..WorldDef::default() },
            body: BodyDef { position, velocity, gravity_scale, ..BodyDef::dynamic() },
            steps,
        })
        .prop_filter("it leaves the envelope", |fall| {
            let world = fall.script().run().expect("a fair world");
            world.bodies().all(|body| body.activity() == umbra_physics::Activity::Awake)
        })
}

/// The share of the steps of 1/n s that begin or end half an ulp between two velocities, by a gravity of so many ulps/s².
///
/// Half-way through its step k a body has g·(2k + 1)/(2n) ulps/s more than at first: the half of an odd number now and then if
/// two divides g as often as n, and never else.
fn share_of_ties(pull: i128, n: i128) -> f64 {
    let (mut common, mut rest) = (n, pull.abs());
    while rest != 0 {
        (common, rest) = (rest, common % rest);
    }
    if pull.trailing_zeros() == n.trailing_zeros() { common as f64 / n as f64 } else { 0.0 }
}

/// Velocity Verlet is exact for a constant force, but for the velocity's rounding to an ulp in each drift. At 1/n s and a
/// gravity of whole ulps/s² that is a sawtooth about zero, whose sums stay within ⅛ ulp·s; reading adds ½ ulp. Where it goes
/// through a tie, what is carried far below the ulp decides, and not evenly: that may be ½ ulp a second for each of the steps.
#[test]
fn free_fall_at_any_rate_is_within_an_ulp_where_no_velocity_ties() {
    let scale = || prop::sample::select(vec![Fx::ONE, -Fx::ONE, Fx::ZERO, Fx::from(2), Fx::from(16)]).boxed();
    let steps = || ((1u32..=10_000).prop_map(TimeStep::hz), 1u64..400).prop_map(|steps| vec![steps]).boxed();
    let falls = || fall(&[Integrator::VelocityVerlet], scale(), steps());
    let strays = |fall: &Fall| {
        let n = fall.steps[0].0.seconds().1;
        fall.strays(|pull, seconds| 0.65 + 0.5 * seconds * share_of_ties(pull, n.into()))
    };
    check_of("exact-time", 40, falls(), Fall::script, strays);
    let ties = |fall: &Fall| {
        let n = fall.steps[0].0.seconds().1;
        let share = share_of_ties(i128::from(fall.world.gravity.x.to_bits()), n.into());
        share > 0.0
    };
    assert!(there_is(falls(), ties), "no velocity ties");
}

/// With steps of many lengths nothing is periodic: half an ulp for each second that is drifted, forwards and backwards.
#[test]
fn free_fall_in_steps_of_any_lengths_is_within_half_an_ulp_a_second() {
    let steps = || vec((any_step(), 1u64..60), 1..6).boxed();
    let scale = || FAIR.signed(2, limits::GRAVITY_SCALE);
    let verlet = fall(&[Integrator::VelocityVerlet], scale(), steps());
    check_of("exact-steps", 30, verlet, Fall::script, |fall| fall.strays(|_, seconds| 0.51 + 0.5 * seconds));
    // 1.36 s, -1.71 s and 1.36 s in each second.
    let yoshida = fall(&[Integrator::Yoshida4], scale(), steps());
    check_of("exact-steps-yoshida", 30, yoshida, Fall::script, |fall| {
        fall.strays(|_, seconds| 0.51 + 0.5 * 4.43 * seconds)
    });
}

#[test]
fn a_rounded_time_step_would_be_seen() {
    // What a time step rounded to an ulp would do: the parabola of another gravity and another time.
    let rounded = |fall: &Fall| {
        let step = fall.steps[0].0.seconds();
        let ticks = fall.script().ticks as i64;
        let dt = Fx::from_ratio(i64::from(step.0), i64::from(step.1));
        let off = to_f64(&((exact(dt) * real(ticks) - real(ticks) * units(step.0, 0) / units(step.1, 0)) << 32));
        let fastest = to_f64(&exact(fall.body.velocity.x)).abs();
        off.abs() * fastest > 1.0
    };
    let steps = ((1u32..=10_000).prop_map(TimeStep::hz), 1u64..400).prop_map(|steps| vec![steps]).boxed();
    let falls = fall(&[Integrator::VelocityVerlet], Just(Fx::ONE).boxed(), steps);
    assert!(there_is(falls, rounded));
}
