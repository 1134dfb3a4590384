//! Energy and momentum of a world. *Error* of each term 2^-61 relative, then rounded to 2^-64 of its unit.

use super::World;
use crate::body::{Activity, BodyKind};
use crate::error::{Error, Quantity};
use crate::force::{Attachment, End, Law, Scene};
use crate::math::Vec2;
use crate::scalar::{Accumulator, Factor, Scalar, Wide};

const TOO_LARGE: Error = Error::OutOfRange { quantity: Quantity::Total };

impl<S: Scalar> World<S> {
    /// The kinetic energy of the dynamic bodies, ½mv² + ½Iω², J.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Total`] beyond 2^63 J.
    pub fn kinetic_energy(&self) -> Result<S::Wide, Error> {
        let half = S::Factor::from_ratio(1, 2);
        self.sum(|i| {
            let (motion, properties) = (&self.bodies.columns.motion, &self.bodies.columns.card[i].properties);
            let square = |v: S::Accumulator| {
                let v = S::Factor::from_scalar(v.value());
                v.times(v)
            };
            let moving = square(motion.velocity[i].x).plus(square(motion.velocity[i].y));
            let turning = square(motion.spin[i]).times(properties.inertia);
            let twice = moving.times(S::Factor::from_scalar(properties.mass)).plus(turning);
            S::Wide::from_factor(twice.times(half), false)
        })
    }

    /// The potential energy of the dynamic bodies in gravity (zero at y = 0 and x = 0), attractors (zero far away) and
    /// springs, J. Zones, thrusts and laws of the user's own have none. Of an attractor that a dynamic body carries half is
    /// counted: two that attract each other by G·m have it twice.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Total`] beyond 2^63 J.
    pub fn potential_energy(&self) -> Result<S::Wide, Error> {
        let mut total = self.sum(|i| {
            let columns = &self.bodies.columns;
            let mass = S::Factor::from_scalar(columns.card[i].properties.mass);
            let gravity = self.tunings.rows()[columns.tuning[i] as usize].gravity;
            let at = columns.motion.position[i];
            let height = |g: S::Wide, x: S::Accumulator| {
                let x = x.value();
                let energy = S::Factor::from_wide(g).times(S::Factor::from_scalar(x)).times(mass);
                // Against the field is uphill.
                S::Wide::from_factor(energy, g.is_negative() == (x < S::ZERO))
            };
            height(gravity.x, at.x)?.plus(height(gravity.y, at.y)?)
        })?;
        let scene = Scene { bodies: &self.bodies, fields: &self.fields, laws: &self.laws };
        let half = S::Factor::from_ratio(1, 2);
        for (_, field) in self.fields.iter() {
            match &field.law {
                Law::Spring { near, far, spring } => {
                    let Some(offset) = scene.offset_between(&End::Body(*near), far) else { continue };
                    let (length, rest) = (S::length(offset, S::ZERO), S::Factor::from_scalar(spring.rest));
                    // One of the two differences is zero.
                    let stretch = length.minus(rest).plus(rest.minus(length));
                    let energy = stretch.times(stretch).times(S::Factor::from_scalar(spring.stiffness)).times(half);
                    let energy = S::Wide::from_factor(energy, false).ok_or(TOO_LARGE)?;
                    total = total.plus(energy).ok_or(TOO_LARGE)?;
                }
                Law::Attractor { centre, mu, softening } => {
                    let carrier = match centre {
                        End::Body(at) => self.bodies.find(at.body).ok(),
                        End::World(_) => None,
                    };
                    let mutual = carrier.is_some_and(|i| self.bodies.columns.card[i].kind == BodyKind::Dynamic);
                    let mu = if mutual { mu.times(half) } else { *mu };
                    let energy = self.sum(|i| {
                        let card = &self.bodies.columns.card[i];
                        if carrier == Some(i) || card.groups & field.groups == 0 {
                            return Some(S::Wide::default());
                        }
                        let own = End::Body(Attachment::centre(self.bodies.id(i)));
                        let Some(offset) = scene.offset_between(&own, centre) else { return Some(S::Wide::default()) };
                        let distance = S::length(offset, *softening);
                        if distance.is_zero() {
                            return None;
                        }
                        let energy = mu.times(S::Factor::from_scalar(card.properties.mass)).over(distance);
                        S::Wide::from_factor(energy, true)
                    })?;
                    total = total.plus(energy).ok_or(TOO_LARGE)?;
                }
                Law::Drag { .. } | Law::Thrust { .. } | Law::Zone { .. } | Law::Custom { .. } => {}
            }
        }
        Ok(total)
    }

    /// Kinetic and potential energy together, J.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Total`] beyond 2^63 J.
    pub fn energy(&self) -> Result<S::Wide, Error> {
        self.kinetic_energy()?.plus(self.potential_energy()?).ok_or(TOO_LARGE)
    }

    /// The momentum of the dynamic bodies, Σ m·v, kg·m/s; exact for the public velocities.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Total`] beyond 2^63.
    pub fn momentum(&self) -> Result<Vec2<S::Wide>, Error> {
        let columns = &self.bodies.columns;
        let component = |pick: fn(Vec2<S::Accumulator>) -> S::Accumulator| {
            self.sum(|i| Some(columns.card[i].properties.mass.product(pick(columns.motion.velocity[i]).value())))
        };
        Ok(Vec2::new(component(|v| v.x)?, component(|v| v.y)?))
    }

    /// The angular momentum of the dynamic bodies about the origin of the world, Σ m·(x × v) + I·ω, kg·m²/s.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with [`Quantity::Total`] beyond 2^63.
    pub fn angular_momentum(&self) -> Result<S::Wide, Error> {
        self.sum(|i| {
            let (motion, properties) = (&self.bodies.columns.motion, &self.bodies.columns.card[i].properties);
            let (x, v) = (motion.position[i].map(Accumulator::value), motion.velocity[i].map(Accumulator::value));
            let spin = motion.spin[i].value();
            let orbital = x.cross(v)?.times(S::Factor::from_scalar(properties.mass))?;
            let own = properties.inertia.times(S::Factor::from_scalar(spin));
            orbital.plus(S::Wide::from_factor(own, spin < S::ZERO)?)
        })
    }

    /// A sum over the dynamic bodies that take part, in the order of their slots.
    fn sum(&self, term: impl Fn(usize) -> Option<S::Wide>) -> Result<S::Wide, Error> {
        let counts = |&i: &usize| {
            let card = &self.bodies.columns.card[i];
            card.kind == BodyKind::Dynamic && card.activity != Activity::Quarantined
        };
        let mut terms = self.bodies.in_order().filter(counts);
        terms.try_fold(S::Wide::default(), |sum, i| sum.plus(term(i)?)).ok_or(TOO_LARGE)
    }
}
