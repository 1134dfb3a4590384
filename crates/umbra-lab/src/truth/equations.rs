//! The equations of motion of a world whose bodies do not turn, and their solution to any accuracy.

use umbra_physics::{Attachment, BodyId, End, FieldKind, Fx, World};

use super::{Exact, Real, real};

/// A force of the world on bodies that are named by their index.
enum Force {
    /// μ and the square of the softening.
    Attractor {
        centre: Centre,
        mu: Real,
        softening: Real,
    },
    Spring {
        near: usize,
        far: Centre,
        rest: Real,
        stiffness: Real,
        damping: Real,
    },
    Drag {
        linear: Real,
        quadratic: Real,
        wind: [Real; 2],
    },
}

enum Centre {
    Point([Real; 2]),
    Body(usize),
}

/// d/dt of (x, y, v_x, v_y) of each body.
pub(crate) struct Equations {
    mass: Vec<Real>,
    gravity: [Real; 2],
    /// ln of what a second leaves of a velocity.
    damping: Real,
    forces: Vec<Force>,
}

fn length(v: &[Real; 2]) -> Real {
    (&v[0] * &v[0] + &v[1] * &v[1]).sqrt()
}

impl Equations {
    /// Returns the equations of a world of dynamic bodies; `None` if the world has something that they do not describe. They describe
    /// attractors, springs between centres and drag, for bodies that feel gravity and damping as the world has them.
    pub(crate) fn of(world: &World) -> Option<Self> {
        let bodies: Vec<_> = world.bodies().collect();
        let index = |at: &Attachment| {
            let index_of = |id: BodyId| bodies.iter().position(|body| body.id() == id);
            if at.point == umbra_physics::Vec2::ZERO { index_of(at.body) } else { None }
        };
        let centre = |end: &End| match end {
            End::World(at) => Some(Centre::Point([at.x.exact(), at.y.exact()])),
            End::Body(at) => index(at).map(Centre::Body),
        };
        let force = |law: &FieldKind| {
            Some(match law {
                FieldKind::Attractor { centre: at, mu, softening } => {
                    Force::Attractor { centre: centre(at)?, mu: mu.exact(), softening: softening.exact().sqr() }
                }
                FieldKind::Spring { near, far, spring } => Force::Spring {
                    near: index(near)?,
                    far: centre(far)?,
                    rest: spring.rest.exact(),
                    stiffness: spring.stiffness.exact(),
                    damping: spring.damping.exact(),
                },
                FieldKind::Drag { linear, quadratic, wind } => Force::Drag {
                    linear: linear.exact(),
                    quadratic: quadratic.exact(),
                    wind: [wind.x.exact(), wind.y.exact()],
                },
                _ => return None,
            })
        };
        let def = world.def();
        Some(Self {
            mass: bodies.iter().map(|body| body.mass().map(Fx::exact)).collect::<Option<_>>()?,
            gravity: [def.gravity.x.exact(), def.gravity.y.exact()],
            damping: match def.linear_damping.strong_rate() {
                Some(rate) => -rate.exact(),
                None => def.linear_damping.kept().exact().ln(),
            },
            forces: world.fields().map(|(_, field)| force(&field.kind)).collect::<Option<_>>()?,
        })
    }

    fn slope(&self, state: &[Real]) -> Vec<Real> {
        let velocity = |i: usize| [state[4 * i + 2].clone(), state[4 * i + 3].clone()];
        let mut slope: Vec<Real> = (0..self.mass.len())
            .flat_map(|i| {
                let [x, y] = velocity(i);
                let (ax, ay) = (&self.gravity[0] + &self.damping * &x, &self.gravity[1] + &self.damping * &y);
                [x, y, ax, ay]
            })
            .collect();
        for force in &self.forces {
            self.add(force, state, &mut slope);
        }
        slope
    }

    fn add(&self, force: &Force, state: &[Real], slope: &mut [Real]) {
        let mut push = |i: usize, share: &Real, along: &[Real; 2]| {
            slope[4 * i + 2] += share * &along[0];
            slope[4 * i + 3] += share * &along[1];
        };
        let body = |i: usize| &state[4 * i..4 * i + 4];
        // Position and velocity relative to a body's.
        let offset = |i: usize, centre: &Centre| {
            let coordinates = body(i);
            match centre {
                Centre::Point(at) => {
                    ([&at[0] - &coordinates[0], &at[1] - &coordinates[1]], [-&coordinates[2], -&coordinates[3]])
                }
                Centre::Body(partner) => {
                    let at = body(*partner);
                    (
                        [&at[0] - &coordinates[0], &at[1] - &coordinates[1]],
                        [&at[2] - &coordinates[2], &at[3] - &coordinates[3]],
                    )
                }
            }
        };
        match force {
            Force::Attractor { centre, mu, softening } => {
                let carrier = if let Centre::Body(carrier) = centre { Some(*carrier) } else { None };
                for i in (0..self.mass.len()).filter(|&i| Some(i) != carrier) {
                    let (to, _) = offset(i, centre);
                    let square = &to[0] * &to[0] + &to[1] * &to[1] + softening;
                    push(i, &(mu / (&square * square.sqrt())), &to);
                }
            }
            Force::Spring { near, far, rest, stiffness, damping } => {
                let (to, v) = offset(*near, far);
                let stretched = length(&to);
                let rate = (&to[0] * &v[0] + &to[1] * &v[1]) / &stretched;
                let pull = (stiffness * (&stretched - rest) + damping * rate) / stretched;
                push(*near, &(&pull / &self.mass[*near]), &to);
                if let Centre::Body(far) = far {
                    push(*far, &(-pull / &self.mass[*far]), &to);
                }
            }
            Force::Drag { linear, quadratic, wind } => {
                for (i, mass) in self.mass.iter().enumerate() {
                    let v = body(i);
                    let against = [&wind[0] - &v[2], &wind[1] - &v[3]];
                    push(i, &((linear + quadratic * length(&against)) / mass), &against);
                }
            }
        }
    }
}

fn plus(state: &[Real], slope: &[Real], times: &Real) -> Vec<Real> {
    state.iter().zip(slope).map(|(y, f)| y + f * times).collect()
}

/// Moves a state on by `steps` steps of `step` s, by extrapolation of the modified midpoint rule to order 18: a step that
/// is an eighth of the shortest time scale leaves some 1e-20.
///
/// *Source* Gragg, SIAM J. Numer. Anal. 2, 384 (1965); Bulirsch, Stoer, Numer. Math. 8, 1 (1966).
pub(crate) fn solve(equations: &Equations, state: &mut Vec<Real>, step: &Real, steps: u32) {
    const COLUMNS: i64 = 9;
    for _ in 0..steps {
        let first = equations.slope(state);
        let mut row: Vec<Vec<Real>> = Vec::new();
        for k in 1..=COLUMNS {
            let mut entry = midpoint(equations, state, &first, step, 2 * k);
            // Aitken and Neville's table in the square of the substep, row by row.
            for (j, above) in (1..).zip(row.iter_mut()) {
                let square = (k - j) * (k - j);
                let weight = real(square) / real(k * k - square);
                let better = entry.iter().zip(above.iter()).map(|(e, a)| e + (e - a) * &weight).collect();
                *above = core::mem::replace(&mut entry, better);
            }
            row.push(entry);
        }
        *state = row.pop().unwrap_or_default();
    }
}

/// A step by the modified midpoint rule in an even number of substeps, smoothed at its end.
fn midpoint(equations: &Equations, state: &[Real], first: &[Real], step: &Real, substeps: i64) -> Vec<Real> {
    let h = step / real(substeps);
    let twice = &h + &h;
    let (mut before, mut now) = (state.to_vec(), plus(state, first, &h));
    for _ in 1..substeps {
        let next = plus(&before, &equations.slope(&now), &twice);
        (before, now) = (now, next);
    }
    let ahead = plus(&now, &equations.slope(&now), &h);
    before.iter().zip(&ahead).map(|(a, b)| (a + b) >> 1).collect()
}

#[cfg(test)]
mod tests {
    use umbra_scene::Scene;

    use super::super::to_f64;
    use super::*;

    fn equations(text: &str) -> Option<Equations> {
        Equations::of(&Scene::parse(text).expect("a scene").build().expect("a world"))
    }

    #[test]
    fn accelerations_are_those_of_the_laws() {
        let text = r#"{"gravity": [0, -10], "damping": {"linear": {"kept_per_second": 0.5}},
            "bodies": [{"name": "a", "mass": 2}, {"name": "b", "mass": 4}],
            "fields": [{"drag": {"linear": 1, "quadratic": 0.5, "wind": [3, 4]}},
                {"attractor": {"at": "b", "mu": 125, "softening": 3}},
                {"spring": {"from": "a", "to": "b", "rest": 1, "stiffness": 2, "damping": 8}}]}"#;
        // The second is 4 m to the right of the first, and goes away from it at 1 m/s.
        let state = [0, 0, 0, 0, 4, 0, 1, 0].map(real);
        let slope: Vec<f64> = equations(text).expect("known laws").slope(&state).iter().map(to_f64).collect();
        let (first_drag, second_drag) = (1.0 + 0.5 * 5.0, 1.0 + 0.5 * 20f64.sqrt());
        // 125·4/5³ = 4 towards the second; 2·(4 − 1) + 8·1 = 14 N between them.
        let first = [first_drag * 3.0 / 2.0 + 4.0 + 14.0 / 2.0, first_drag * 4.0 / 2.0 - 10.0];
        let second = [second_drag * 2.0 / 4.0 - 14.0 / 4.0 - 2f64.ln(), second_drag * 4.0 / 4.0 - 10.0];
        let expected = [0.0, 0.0, first[0], first[1], 1.0, 0.0, second[0], second[1]];
        for (actual, expected) in slope.iter().zip(expected) {
            assert!((actual - expected).abs() < 1e-14, "{slope:?} for {expected}");
        }
    }

    #[test]
    fn scenes_beyond_the_equations_are_refused() {
        for field in [
            r#"{"thrust": {"at": "a", "force": [1, 0]}}"#,
            r#"{"zone": {"disc": {"centre": [0, 0], "radius": 1}, "acceleration": [1, 0]}}"#,
            r#"{"spring": {"from": {"body": "a", "point": [1, 0]}, "to": [0, 0], "stiffness": 1}}"#,
        ] {
            assert!(
                equations(&format!(r#"{{"bodies": [{{"name": "a"}}], "fields": [{field}]}}"#)).is_none(),
                "{field}"
            );
        }
    }
}
