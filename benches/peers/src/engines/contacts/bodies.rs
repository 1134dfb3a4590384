//! Bodies and their free flight: the library's velocity Verlet under constant gravity.

use crate::engine::State;
use crate::scene;
use umbra_physics::collide::{Pose, radius_bound};
use umbra_physics::scalar::internals::{Motion as _, Span, Weight};
use umbra_physics::scalar::{Accumulator as _, Angle as _, ToF64};
use umbra_physics::solve::{Correction, Flight, Velocity};
use umbra_physics::{Fx, FxAccumulator, FxFactor, FxWide, Outline, TimeStep, Turn, Vec2};

use crate::engines::umbra::{Number, shape, vector};

/// The factors of a step.
pub struct Timing {
    /// The change of velocity by gravity in half a step.
    half_kick: Vec2<FxAccumulator>,
    seconds: FxFactor,
    /// From an angular velocity to the part of a turn that is passed.
    turn: FxFactor,
}

impl Timing {
    pub fn new(time_step: TimeStep, [x, y]: [Fx; 2]) -> Self {
        let span = |half| Span { ratio: time_step.seconds(), weight: Weight::Whole, half };
        let kick = |g| Fx::kick(FxWide::from_scalar(g), Fx::seconds(span(true))).expect("gravity within the limits");
        Self {
            half_kick: Vec2::new(kick(x), kick(y)),
            seconds: Fx::seconds(span(false)),
            turn: Turn::drift_factor(span(false)),
        }
    }
}

pub struct Body {
    pub is_dynamic: bool,
    pub position: Vec2<FxAccumulator>,
    pub angle: Turn,
    pub velocity: Vec2<FxAccumulator>,
    pub angular_velocity: FxAccumulator,
    /// `None` for a body without shape.
    pub outline: Option<Outline>,
    /// The largest distance of a point of the outline, or of an anchor, from the centre of mass.
    pub radius: Fx,
    pub friction: Fx,
    pub restitution: Fx,
    pub surface_speed: Fx,
    /// The centre of mass in the scene's coordinates of the body.
    shift: Vec2,
    mass: Fx,
    inverse_mass: FxFactor,
    inverse_inertia: FxFactor,
}

/// a + b in the components.
fn sum(a: Vec2<FxAccumulator>, b: Vec2<FxAccumulator>) -> Vec2<FxAccumulator> {
    Vec2::new(a.x.plus(b.x), a.y.plus(b.y))
}

impl Body {
    pub fn new(b: &scene::Body) -> Self {
        let shape = shape::<Fx>(b);
        let outline = shape.as_ref().map(|shape| shape.outlines()[0].clone());
        let shift = shape.as_ref().map_or(Vec2::ZERO, |shape| shape.shift());
        let is_dynamic = b.kind == scene::Kind::Dynamic;
        let angle = Turn::from_radians(Fx::number(b.angle));
        let turned = |v| angle.rotate(v).expect("a shape within the limits");
        let position = {
            let (at, shift) = (vector::<Fx>(b.x, b.y), turned(shift));
            // From 2^-64 to 2^-96.
            let place = |at: Fx, shift: FxWide| {
                FxAccumulator::from_scalar(at).plus(FxAccumulator::from_bits(shift.to_bits() << 32))
            };
            Vec2::new(place(at.x, shift.x), place(at.y, shift.y))
        };
        let (mass, inertia) = b.mass_inertia();
        let gyration = (inertia / mass).sqrt();
        let radius = outline.as_ref().map_or(Fx::number(gyration), radius_bound);
        let (mass, inertia) = if let (None, true) = (&shape, is_dynamic) {
            (Fx::number(mass), FxFactor::from_scalar(Fx::number(inertia)))
        } else if let (Some(shape), true) = (&shape, is_dynamic) {
            let mass = FxFactor::from_scalar(Fx::number(b.density)).times(shape.measure()).to_scalar();
            let mass = mass.expect("a mass within the limits");
            (mass, FxFactor::from_scalar(mass).times(shape.gyration()))
        } else {
            (Fx::ZERO, FxFactor::ZERO)
        };
        let inverse = |f: FxFactor| if f.is_zero() { f } else { FxFactor::ONE.over(f) };
        Self {
            is_dynamic,
            position,
            angle,
            velocity: vector::<Fx>(b.vx, b.vy).map(FxAccumulator::from_scalar),
            angular_velocity: FxAccumulator::from_scalar(Fx::number(b.w)),
            outline,
            radius,
            friction: Fx::number(b.friction),
            restitution: Fx::number(b.restitution),
            surface_speed: Fx::number(b.surface_speed),
            shift,
            mass,
            inverse_mass: inverse(FxFactor::from_scalar(mass)),
            inverse_inertia: inverse(inertia),
        }
    }

    /// A point in the scene's coordinates of the body, from the centre of mass. The radius is made to hold it.
    pub fn anchor(&mut self, [x, y]: [f64; 2]) -> Vec2 {
        let point = vector::<Fx>(x - self.shift.x.to_f64(), y - self.shift.y.to_f64());
        let reach = Fx::number(point.x.to_f64().hypot(point.y.to_f64()) + 1e-6);
        self.radius = self.radius.max(reach);
        point
    }

    /// A vector in the frame of the body in world axes.
    pub fn turned(&self, v: Vec2) -> Vec2 {
        let turned = self.angle.rotate(v).expect("an anchor within the limits");
        turned.map(|c| c.to_scalar().expect("an anchor within the limits"))
    }

    pub fn pose(&self) -> Pose {
        Pose::new(self.position.map(FxAccumulator::value), self.angle)
    }

    fn public_velocity(&self) -> Velocity {
        let linear = self.velocity.map(FxAccumulator::value);
        Velocity { linear, angular: self.angular_velocity.value() }
    }

    /// Takes the body through its free flight.
    pub fn fly(&mut self, timing: &Timing) -> Flight {
        let (position, start) = (self.position.map(FxAccumulator::value), self.public_velocity());
        let (mut displacement, mut rotation) = (Vec2::default(), FxAccumulator::default());
        if self.is_dynamic {
            self.velocity = sum(self.velocity, timing.half_kick);
            displacement = self.velocity.map(|v| v.value().drift(timing.seconds));
            rotation = self.angular_velocity.value().drift(timing.seconds);
            self.position = sum(self.position, displacement);
            self.angle = self.angle.drifted(self.angular_velocity.value(), timing.turn, false);
            self.velocity = sum(self.velocity, timing.half_kick);
        }
        Flight {
            position,
            start,
            end: self.public_velocity(),
            displacement: displacement.map(FxAccumulator::value),
            rotation: rotation.value(),
            mass: self.mass,
            inverse_mass: Vec2::new(self.inverse_mass, self.inverse_mass),
            inverse_inertia: self.inverse_inertia,
            radius: self.radius,
            leader: None,
        }
    }

    /// Adds what contacts changed.
    pub fn correct(&mut self, correction: &Correction) {
        self.velocity = sum(self.velocity, correction.velocity);
        self.position = sum(self.position, correction.displacement);
        self.angular_velocity = self.angular_velocity.plus(correction.angular_velocity);
        self.angle = self.angle.turned(correction.rotation);
    }

    /// The state of the scene's body, whose position differs from the centre of mass by rounding.
    pub fn state(&self) -> State {
        let angle = Fx::radians(self.angle);
        let (sin, cos) = angle.sin_cos();
        let (sx, sy) = (self.shift.x.to_f64(), self.shift.y.to_f64());
        State {
            x: self.position.x.to_f64() - (cos * sx - sin * sy),
            y: self.position.y.to_f64() - (sin * sx + cos * sy),
            angle,
            vx: self.velocity.x.to_f64(),
            vy: self.velocity.y.to_f64(),
            w: self.angular_velocity.to_f64(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbra_physics::{BodyDef, ColliderDef, World, WorldDef};

    #[test]
    fn the_free_flight_has_the_bits_of_the_world() {
        let scene_body = scene::Body {
            vx: 3.25,
            vy: 7.5,
            w: -2.0,
            angle: 0.3,
            ..scene::Body::dynamic(0.1, -0.7, scene::Shape::Box { hx: 0.3, hy: 0.2 })
        };
        let gravity = [0.3, -9.81].map(Fx::number);
        let mut world = World::new(WorldDef {
            gravity: Vec2::new(gravity[0], gravity[1]),
            time_step: TimeStep::hz(60),
            ..WorldDef::default()
        })
        .unwrap();
        let mut body = Body::new(&scene_body);
        let def = BodyDef {
            position: vector(scene_body.x, scene_body.y),
            angle: Fx::number(scene_body.angle),
            velocity: vector(scene_body.vx, scene_body.vy),
            angular_velocity: Fx::number(scene_body.w),
            colliders: shape(&scene_body).map(ColliderDef::ghost).into_iter().collect(),
            ..BodyDef::dynamic()
        };
        let id = world.add_body(def).unwrap();
        let timing = Timing::new(TimeStep::hz(60), gravity);
        for tick in 0..100 {
            world.step();
            body.fly(&timing);
            let actual = world.body(id).unwrap();
            assert_eq!(actual.position_exact(), body.position, "{tick}");
            assert_eq!(actual.velocity_exact(), body.velocity, "{tick}");
            assert_eq!(actual.angle_exact(), body.angle, "{tick}");
        }
    }
}
