//! An attractor's acceleration is the exact one, rounded, from an ulp away to the other end of the envelope.

#[path = "support/random.rs"]
mod random;
#[path = "support/real.rs"]
mod real;

use random::SplitMix;
use real::{Real, exact, factor, ratio, to_f64, units};
use umbra_physics::scalar::internals::Forces;
use umbra_physics::{
    BodyDef, End, FieldKind, Fx, FxFactor, FxWide, Integrator, SpringConstants, TimeStep, Vec2, World, WorldDef, fx,
};

/// mu·d / (d² + s²)^(3/2).
fn attraction(mu: FxFactor, d: (Fx, Fx), softening: Fx) -> [Real; 2] {
    let (x, y, s) = (exact(d.0), exact(d.1), exact(softening));
    let square = &x * &x + &y * &y + &s * &s;
    let share = factor(mu) / (&square * square.sqrt());
    [x * &share, y * share]
}

fn offset(d: (Fx, Fx)) -> Vec2<FxWide> {
    Vec2::from(d).map(FxWide::from)
}

/// The largest distances from the exact value: in ulps of `Fx` once rounded to it, in units of 2^-64 without.
#[derive(Clone, Copy, Default, Debug)]
struct Worst {
    public: f64,
    kept: f64,
}

impl Worst {
    fn look(&mut self, mu: FxFactor, d: (Fx, Fx), softening: Fx) -> bool {
        let Some(Vec2 { x, y }) = Fx::attraction(mu, offset(d), softening) else { return false };
        for (kept, exact_value) in [x, y].into_iter().zip(attraction(mu, d, softening)) {
            if let Some(public) = kept.to_scalar() {
                let off = to_f64(&((exact(public) - &exact_value) << 32)).abs();
                assert!(off <= 0.51, "{off} ulps at {d:?} with mu {mu:?} and softening {softening}");
                self.public = self.public.max(off);
            }
            // What a kick may add is below 2^21 m/s, at 10,000 steps a second from accelerations below 2^35.3 m/s².
            let magnitude = to_f64(&exact_value).abs();
            let off = to_f64(&((units(kept.to_bits(), 64) - &exact_value) << 64)).abs();
            let allowed = 0.51 + magnitude * 2f64.powi(64 - 90);
            assert!(off <= allowed, "{off} of 2^-64 at {d:?} with mu {mu:?} and softening {softening}");
            if magnitude < 2f64.powi(20) {
                self.kept = self.kept.max(off);
            }
        }
        true
    }
}

#[test]
fn attraction_is_within_half_an_ulp_from_an_ulp_to_the_edge() {
    let mut worst = Worst::default();
    let mut looked = 0;
    // Powers of two from an ulp to 2^30 m and their neighbours, along an axis, across, and at odd angles.
    for exponent in 0..=62 {
        for offset in [-1, 0, 1] {
            let r = (1i64 << exponent) + offset;
            for (x, y) in [(r, 0), (0, -r), (r, r), (-r, r / 2), (r, 1), (r / 3, -r)] {
                if x == 0 && y == 0 {
                    continue;
                }
                // From what gives a few ulps of acceleration at this distance to what gives more than a kick may add.
                let at = f64::from(exponent) - 32.0;
                for strength in [-30, -8, 0, 8, 16, 25, 34] {
                    let log = (2.0 * at) as i32 + strength;
                    if log > 64 {
                        continue;
                    }
                    let mantissa = FxFactor::from_ratio(0x1234_5678_9abc_def1, 0x0fed_cba9_8765_4321);
                    let mu = mantissa.times(power(log));
                    looked += u32::from(worst.look(mu, (Fx::from_bits(x), Fx::from_bits(y)), Fx::ZERO));
                }
            }
        }
    }
    assert!(looked > 5_000, "{looked} fitted");
    println!("{looked} cases: {worst:.5?}");
}

/// 2^exponent.
fn power(exponent: i32) -> FxFactor {
    let magnitude = |e: u32| FxFactor::from_ratio(1 << (e / 2), 1).times(FxFactor::from_ratio(1 << (e - e / 2), 1));
    if exponent >= 0 { magnitude(exponent as u32) } else { FxFactor::ONE.over(magnitude(exponent.unsigned_abs())) }
}

#[test]
fn attraction_is_within_half_an_ulp_at_random() {
    let mut random = SplitMix::seeded(1);
    let (mut worst, mut looked) = (Worst::default(), 0);
    let cases = crate::seeds::times(30_000);
    for _ in 0..cases {
        let d = (Fx::from_bits(random.of_bits(62)), Fx::from_bits(random.of_bits(62)));
        let softening = if random.next() & 1 == 0 { Fx::ZERO } else { Fx::from_bits(random.of_bits(44).abs()) };
        let largest = d.0.to_bits().unsigned_abs().max(d.1.to_bits().unsigned_abs());
        if largest == 0 {
            continue;
        }
        let log = 2 * (largest.ilog2() as i32 - 32) + (random.next() % 64) as i32 - 30;
        let mu = FxFactor::from_ratio(random.next() | 1, random.next() | 1);
        looked += u32::from(log <= 60 && worst.look(mu.times(power(log)), d, softening));
    }
    assert!(looked > cases / 2, "{looked} of {cases} fitted");
    println!("{looked} cases: {worst:.5?}");
}

#[test]
fn attraction_at_the_centre_is_zero() {
    let zero = Vec2::<FxWide>::default();
    assert_eq!(Fx::attraction(FxFactor::ONE, zero, Fx::ZERO), Some(zero));
    assert_eq!(Fx::attraction(FxFactor::ONE, zero, fx!(1)), Some(zero));
}

#[test]
fn a_world_kicks_by_the_exact_attraction() {
    for (x, y, mu) in [
        (Fx::from_bits(1), fx!(0), FxFactor::from_ratio(1, 1 << 62)),
        (fx!(0.001), fx!(-0.002), FxFactor::from_ratio(1, 1000)),
        (fx!(3), fx!(4), FxFactor::from_ratio(100, 1)),
        // The Earth's, from a geostationary orbit.
        (fx!(42164000), fx!(0), FxFactor::from_ratio(398_600_441_800_000, 1)),
        (fx!(1073741823), fx!(-1073741824), power(63)),
    ] {
        let def = WorldDef {
            time_step: TimeStep::hz(64),
            integrator: Integrator::SymplecticEuler,
            sleep_after: None,
            ..WorldDef::default()
        };
        let mut world = World::new(def).expect("a fair definition");
        let body = world.add_body(BodyDef { position: Vec2::new(x, y), ..BodyDef::dynamic() }).expect("a fair body");
        let centre = End::World(Vec2::ZERO);
        world.add_field(FieldKind::Attractor { centre, mu, softening: Fx::ZERO }).expect("a fair field");
        world.step();
        let velocity = world.body(body).expect("it is there").velocity_exact();
        for (v, a) in [velocity.x, velocity.y].into_iter().zip(attraction(mu, (-x, -y), Fx::ZERO)) {
            // Half a unit of 2^-64 m/s² over 1/64 s, and half a unit of the accumulator.
            let off = to_f64(&((units(v.to_bits(), 96) - &a * ratio(1, 64)) << 64)).abs();
            assert!(off <= 0.51 / 64.0 + to_f64(&a).abs() * 2f64.powi(64 - 90) / 64.0, "{off} at ({x}, {y})");
        }
    }
}

/// (stiffness·(length − rest) + damping·d length/dt) · d / length.
fn tension(d: (Fx, Fx), v: (Fx, Fx), spring: &SpringConstants<Fx>) -> [Real; 2] {
    let (x, y) = (exact(d.0), exact(d.1));
    let length = (&x * &x + &y * &y).sqrt();
    let rate = (&x * exact(v.0) + &y * exact(v.1)) / &length;
    let pull = exact(spring.stiffness) * (&length - exact(spring.rest)) + exact(spring.damping) * rate;
    [&pull * x / &length, &pull * y / &length]
}

#[test]
fn a_springs_force_is_exact_however_short_it_is() {
    let mut random = SplitMix::seeded(2);
    let (mut worst, mut looked) = (0.0f64, 0);
    let cases = crate::seeds::times(30_000);
    for _ in 0..cases {
        let mut number = |bits| Fx::from_bits(random.of_bits(bits));
        let (d, v) = ((number(62), number(62)), (number(50), number(50)));
        let spring = SpringConstants { rest: number(44).abs(), stiffness: number(52).abs(), damping: number(46).abs() };
        if d == (Fx::ZERO, Fx::ZERO) {
            continue;
        }
        let Some(Vec2 { x, y }) = Fx::tension(offset(d), offset(v), &spring) else { continue };
        looked += 1;
        for (force, right) in [x, y].into_iter().zip(tension(d, v, &spring)) {
            let off = to_f64(&((units(force.to_bits(), 64) - &right) << 64)).abs();
            // The length and its rate are rounded once each, to 2^-64 m and m/s; the tension twice, its part once.
            let allowed = 0.501 * (to_f64(&exact(spring.stiffness)) + to_f64(&exact(spring.damping))) + 1.5;
            worst = worst.max(off / allowed);
            assert!(off <= allowed, "{off} of 2^-64 N, {allowed} allowed, at {d:?}, {v:?} with {spring:?}");
        }
    }
    assert!(looked > cases / 2, "{looked} of {cases} fitted");
    println!("{looked} cases: {worst:.3} of what is allowed");
}
