//! Motions with a formula, for a world with one body that moves.

use umbra_physics::{FieldKind, Fx, World};

use super::{Exact, Real, plane, real, to_f64};

/// A closed formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Closed {
    /// Constant gravity and the world's damping.
    DampedFall,
    /// A spring without length at the origin.
    Oscillator,
    /// An ellipse about an attractor at the origin.
    Kepler,
    /// A constant torque, N·m; the angle, rad.
    Spin(Fx),
    /// A block that slides along a plane until friction stops it.
    Slide,
    /// A disc that falls to a plane, bounces or slides, and rolls.
    Disc,
}

/// Computes where the body is after so many seconds, with so many bits; `None` if the formula does not apply to the world.
pub(crate) fn closed(formula: Closed, world: &World, seconds: u32, bits: usize) -> Option<Vec<Real>> {
    let body = world.bodies().next()?;
    let wide = |value: Real| value.with_precision(bits).value();
    let time = wide(real(seconds.into()));
    let (x, v) = (body.position(), body.velocity());
    let (x, v) = ([x.x, x.y].map(|x| wide(x.exact())), [v.x, v.y].map(|v| wide(v.exact())));
    let law = world.fields().next().map(|(_, field)| field.kind);
    Some(match (formula, law) {
        (Closed::DampedFall, None) => {
            let damping = world.def().linear_damping;
            let rate =
                damping.strong_rate().map_or_else(|| -wide(damping.kept().exact()).ln(), |rate| wide(rate.exact()));
            let g = [world.def().gravity.x, world.def().gravity.y].map(Exact::exact);
            (0..2).map(|i| fallen(&x[i], &v[i], &g[i], &rate, &time)).collect()
        }
        (Closed::Oscillator, Some(FieldKind::Spring { spring, .. })) => {
            let rate = (wide(spring.stiffness.exact()) / body.mass()?.exact()).sqrt();
            let (sin, cos) = (&rate * &time).sin_cos();
            (0..2).map(|i| &x[i] * &cos + &v[i] / &rate * &sin).collect()
        }
        (Closed::Kepler, Some(FieldKind::Attractor { mu, .. })) => orbit(&x, &v, &wide(mu.exact()), &time),
        (Closed::Spin(torque), None) => {
            let gained = wide(torque.exact()) / body.inertia()?.exact();
            let turned = (wide(body.angular_velocity().exact()) + ((gained * &time) >> 1)) * &time;
            vec![wide(body.angle_exact().exact()) + turned]
        }
        (Closed::Slide, None) => plane::slide(world, &time, bits)?,
        (Closed::Disc, None) => plane::disc(world, &time, bits)?,
        _ => return None,
    })
}

/// x″ = g − rate·x′.
fn fallen(x: &Real, v: &Real, g: &Real, rate: &Real, time: &Real) -> Real {
    let terminal = g / rate;
    let lost = (real(1) - (-(rate * time)).exp()) / rate;
    x + &terminal * time + (v - &terminal) * lost
}

/// Solves the Kepler problem by Lagrange's coefficients, from the change of the eccentric anomaly: circles need no case of their own.
///
/// *Source* Battin, An Introduction to the Mathematics and Methods of Astrodynamics, 1999, section 4.3.
fn orbit(x: &[Real; 2], v: &[Real; 2], mu: &Real, time: &Real) -> Vec<Real> {
    let r = (x[0].sqr() + x[1].sqr()).sqrt();
    let half_axis = real(1) / (real(2) / &r - (v[0].sqr() + v[1].sqr()) / mu);
    let motion = (mu / &half_axis).sqrt() / &half_axis;
    let outward = (&x[0] * &v[0] + &x[1] * &v[1]) / (mu * &half_axis).sqrt();
    let (anomaly, sin, cos) = kepler(&(&motion * time), &outward, &(real(1) - &r / &half_axis));
    let f = real(1) - &half_axis / &r * (real(1) - cos);
    let g = time - (anomaly - sin) / motion;
    (0..2).map(|i| &f * &x[i] + &g * &v[i]).collect()
}

/// Solves z + p·(1 − cos z) − q·sin z = m for z, and gives its sine and cosine, by Newton's rule from a solution in f64.
fn kepler(m: &Real, p: &Real, q: &Real) -> (Real, Real, Real) {
    let (pf, qf, mf) = (to_f64(p), to_f64(q), to_f64(m));
    // The left side grows with z, and is within |p| + |p| + |q| ≤ 3 of it.
    let (mut low, mut high) = (mf - 3.0, mf + 3.0);
    for _ in 0..60 {
        let z = f64::midpoint(low, high);
        if z + pf * (1.0 - z.cos()) - qf * z.sin() < mf { low = z } else { high = z }
    }
    let mut z = low.exact().with_precision(m.precision()).value();
    // 1e-14 or so, squared four times: below 2^-192 even where the ellipse is thin.
    for _ in 0..4 {
        let (sin, cos) = z.sin_cos();
        let off = &z + p * (real(1) - &cos) - q * &sin - m;
        z -= off / (real(1) + p * sin - q * cos);
    }
    let (sin, cos) = z.sin_cos();
    (z, sin, cos)
}

#[cfg(test)]
mod tests {
    use umbra_physics::fx;
    use umbra_scene::Scene;

    use super::super::{BITS, Equations, MORE_BITS, solve};
    use super::*;

    fn world(text: &str) -> World {
        Scene::parse(text).expect("a scene").build().expect("a world")
    }

    const ORBIT: &str = r#"{"bodies": [{"name": "a", "position": [3, -1], "velocity": [0.5, 2]}],
        "fields": [{"attractor": {"at": [0, 0], "mu": 11}}]}"#;
    const TIED: &str = r#"{"bodies": [{"name": "a", "mass": 3, "position": [3, -1], "velocity": [0.5, 2]}],
        "fields": [{"spring": {"from": "a", "to": [0, 0], "stiffness": 7}}]}"#;
    const FALLING: &str = r#"{"gravity": [1, -9.81], "damping": {"linear": {"kept_per_second": 0.25}},
        "bodies": [{"name": "a", "position": [3, -1], "velocity": [0.5, 2]}]}"#;

    #[test]
    fn formulas_solve_the_equations_of_motion() {
        for (formula, text) in [(Closed::Kepler, ORBIT), (Closed::Oscillator, TIED), (Closed::DampedFall, FALLING)] {
            let world = world(text);
            let equations = Equations::of(&world).expect("a force it knows");
            let body = world.bodies().next().expect("one body");
            let (x, v) = (body.position(), body.velocity());
            let mut state: Vec<Real> = [x.x, x.y, v.x, v.y].map(Exact::exact).into();
            solve(&equations, &mut state, &(real(1) / real(32)), 5 * 32);
            let values = closed(formula, &world, 5, MORE_BITS).expect("a scene of its kind");
            for (solved, value) in state.iter().zip(&values) {
                // The solution errs by some 1e-25.
                assert!(to_f64(&(solved - value)).abs() < 1e-20, "{formula:?}: {solved} for {value}");
            }
        }
    }

    #[test]
    fn formulas_give_what_other_means_give() {
        let at = |formula, text: &str, seconds| {
            let values = closed(formula, &world(text), seconds, BITS).expect("a scene of its kind");
            values.iter().map(to_f64).collect::<Vec<_>>()
        };
        let circle = r#"{"bodies": [{"name": "a", "position": [10, 0], "velocity": [0, 10]}],
            "fields": [{"attractor": {"at": [0, 0], "mu": 1000}}]}"#;
        let place = at(Closed::Kepler, circle, 10);
        assert!((place[0] - 10.0 * 10f64.cos()).abs() < 1e-14 && (place[1] - 10.0 * 10f64.sin()).abs() < 1e-14);
        // A quarter of it is left after a second: half a second leaves a half. From rest towards g/ln 4.
        let dropped =
            r#"{"gravity": [0, -8], "damping": {"linear": {"kept_per_second": 0.25}}, "bodies": [{"name": "a"}]}"#;
        let (place, rate) = (at(Closed::DampedFall, dropped, 1), 4f64.ln());
        assert!((place[1] + 8.0 / rate * (1.0 - 0.75 / rate)).abs() < 1e-14);
        let wheel = r#"{"bodies": [{"name": "a", "mass": 1, "inertia": 0.25, "angular_velocity": 1}]}"#;
        assert_eq!(at(Closed::Spin(fx!(0.125)), wheel, 10), [35.0]);
    }

    #[test]
    fn a_world_of_another_kind_has_no_formula() {
        for (formula, text) in [(Closed::Kepler, TIED), (Closed::Oscillator, FALLING), (Closed::DampedFall, ORBIT)] {
            assert_eq!(closed(formula, &world(text), 1, BITS), None, "{formula:?}");
        }
    }
}
