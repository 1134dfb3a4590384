//! Commands on the engine in fixed point and in f64: alike within what rounding comes to, tick by tick.
//!
//! A force field that means one thing in one build and another in the other shows here, as do factors, levers and signs.
//! Commands are fair: nothing is near a limit, and bodies do not sleep, as a float hardly ever comes to rest.
//!
//! *Bound*, in ulps of 2^-32. Before a tick both worlds are put where the fixed-point one is to the ulp, which f64 holds
//! exactly. With k and c the most by which an acceleration here changes with a place and with a speed ([`Slopes`]), a stage
//! over h that starts with errors of e in place and u in speed adds to the speed at most h·(k·(e + ½) + c·(u + ½)), the
//! halves for public values being rounded, and to the place at most h·(u + ½); stages follow each other as those of the
//! integrator do. What f64 itself rounds is below 2^-9 ulp, and the factors of fixed point are closer; but a velocity that leads
//! to a goal in a step is off by as much as the place is, over h. All that is covered by a last ulp. The bound is taken twice,
//! as what the forces of one stage do to each other is left out.
//!
//! Fixed point sets a velocity whose public value is zero to zero where a damping or a drag acts, so that a damped body comes to
//! rest: each of them takes up to ½ ulp of a speed, in each stage.
//!
//! A largest speed is held by the public velocity, all of which is within √½ ulp of the exact one. To slow down takes no two
//! velocities further apart, but can turn errors of u along both axes into one of √2·u along one.

use std::convert::Infallible;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2, TAU};

use arbitrary::Result;
use umbra_oracles::Taste;
use umbra_physics::scalar::ToF64;
use umbra_physics::{
    Attachment, BodyId, BodyKind, BodyRef, Command, CommandMap, ContactSettings, Damping, End, FieldKind, ForceField,
    Fx, FxFactor, Geometry, Integrator, Scalar, Shape, Vec2, World, WorldDef,
};

use super::author::{self, Author};
use super::tally;

/// The most commands of an input, and ticks between two of them.
const COMMANDS: usize = 32;
const TICKS: u8 = 3;
/// After the last command an input goes on as if it had so many of them.
const FEWEST: usize = 12;
/// Beyond these products of slopes and the time step a step of the integrator says nothing.
const STIFF: f64 = 0.25;
/// Ends of a spring that may come so near in a step turn faster than any bound, m.
const NEAR: f64 = 0.1;

/// The target.
pub fn run(data: &[u8]) {
    _ = play(data);
}

fn play(data: &[u8]) -> Result<()> {
    let mut author = Author::of_taste(data, Taste { smooth: true, custom_forces: 2, ..Taste::FAIR });
    let def = author.world();
    let (Some(mut world), Some(mut float)) = (author::world(def), author::world(in_floats(def))) else {
        panic!("a fair definition is refused: {def:?}");
    };
    let mut error = Error::default();
    for number in 0..COMMANDS {
        let mut ticks = TICKS;
        if !author.input.is_empty() {
            let command = author.command();
            let Ok(float_command) = command.clone().map(&mut InFloats);
            let done = world.execute(&command);
            assert_eq!(done, float.execute(&float_command), "{command:?}");
            if let Ok(created) = done {
                author.made(&world, created);
            }
            if let Command::SetIntegrator(_) = command {
                error = Error::default();
            }
            // It rounds an impulse to the ulp, which turns a light body by many ulps.
            if let Command::Explode(_) = command {
                meet(&mut world, &mut float);
            }
            ticks = author.any::<u8>()? % (TICKS + 1);
        } else if number >= FEWEST {
            break;
        }
        for _ in 0..ticks {
            let before = Snapshot::of(&float);
            let is_safe = world.step().faults.is_empty() & float.step().faults.is_empty();
            tally::count(&world);
            let (outside, float_outside) = (world.last_report().drag_outside, float.last_report().drag_outside);
            if !is_safe || outside != float_outside {
                return Ok(());
            }
            let Some(slopes) = Slopes::over(&before, &float) else {
                // The last acceleration differs by more than is known.
                if float.def().integrator == Integrator::PublishedVerlet {
                    return Ok(());
                }
                // Any other integrator starts anew where both are alike.
                error.settle();
                meet(&mut world, &mut float);
                continue;
            };
            error.step(&slopes, float.def().integrator, before.seconds);
            if float.bodies().any(|body| body.max_speed().is_some()) {
                error.cap();
            }
            error.assert_covers(&world, &float);
        }
        error.settle();
        meet(&mut world, &mut float);
    }
    Ok(())
}

fn in_floats(def: WorldDef) -> WorldDef<f64> {
    let WorldDef { time_step, gravity, integrator, linear_damping, angular_damping, sleep_after, .. } = def;
    let [linear_damping, angular_damping] = [linear_damping, angular_damping]
        .map(|damping| InFloats.damping(damping).unwrap_or_else(|never| match never {}));
    let gravity = gravity.map(f64::from_fx);
    let contacts = ContactSettings::default();
    WorldDef { time_step, gravity, integrator, linear_damping, angular_damping, sleep_after, contacts }
}

/// Converts commands to `f64`.
struct InFloats;

impl CommandMap<Fx, f64> for InFloats {
    type Error = Infallible;

    fn scalar(&mut self, value: Fx) -> std::result::Result<f64, Infallible> {
        Ok(f64::from_fx(value))
    }

    fn factor(&mut self, value: FxFactor) -> std::result::Result<f64, Infallible> {
        let value: Option<Fx> = value.to_scalar();
        Ok(f64::from_fx(value.expect("fair values are small")))
    }

    fn shape(&mut self, shape: Shape) -> std::result::Result<Shape<f64>, Infallible> {
        let float = f64::from_fx;
        let geometry = match *shape.geometry() {
            Geometry::Circle { radius } => Geometry::Circle { radius: float(radius) },
            Geometry::Rectangle { width, height } => Geometry::Rectangle { width: float(width), height: float(height) },
            Geometry::Capsule { length, radius } => Geometry::Capsule { length: float(length), radius: float(radius) },
            ref geometry => panic!("a coarser scalar may see it otherwise: {geometry:?}"),
        };
        Ok(Shape::new(geometry).expect("a fair size"))
    }
}

/// Puts both where the fixed-point one is, to the ulp.
fn meet(world: &mut World, float: &mut World<f64>) {
    let ids: Vec<BodyId> = world.bodies().map(|body| body.id()).collect();
    for body in ids {
        let here = world.body(body).expect("it is there");
        let (position, angle, kind) = (here.position(), here.angle(), here.kind());
        let (velocity, spin) = (here.velocity(), here.angular_velocity());
        let fits = "it is where it was";
        let double = |v: Vec2| v.map(f64::from_fx);
        world.set_position(body, position).expect(fits);
        float.set_position(body, double(position)).expect(fits);
        world.set_angle(body, angle).expect(fits);
        float.set_angle(body, f64::from_fx(angle)).expect(fits);
        if kind != BodyKind::Static {
            world.set_velocity(body, velocity).expect(fits);
            float.set_velocity(body, double(velocity)).expect(fits);
            world.set_angular_velocity(body, spin).expect(fits);
            float.set_angular_velocity(body, f64::from_fx(spin)).expect(fits);
        }
    }
}

/// A world before a step.
struct Snapshot {
    world: World<f64>,
    seconds: f64,
}

impl Snapshot {
    fn of(world: &World<f64>) -> Self {
        let (num, den) = world.def().time_step.seconds();
        Self { world: world.clone(), seconds: f64::from(num) / f64::from(den) }
    }
}

/// By how much an acceleration changes with a place and with a speed, at most: of any body, on its way through a step.
struct Slopes {
    place: f64,
    speed: f64,
    /// The most that dampings and drags take of a speed at once by setting it to zero, ulps.
    stop: f64,
}

/// Effect of a step on one end of a field, with a margin.
struct Way {
    from: [f64; 2],
    to: [f64; 2],
    /// More than it can have strayed from either, with Yoshida's detours.
    reach: f64,
    speed: f64,
    /// Distance of the end from the centre of mass.
    arm: f64,
    /// 1/m and 1/I of its body.
    yields: [f64; 2],
}

fn long(v: [f64; 2]) -> f64 {
    v[0].hypot(v[1])
}

impl Way {
    fn fixed(point: Vec2<f64>) -> Self {
        let at = [point.x, point.y];
        Self { from: at, to: at, reach: 0.0, speed: 0.0, arm: 0.0, yields: [0.0; 2] }
    }

    fn of(before: &Snapshot, after: &World<f64>, at: &Attachment<f64>) -> Option<Self> {
        let [before_body, after_body] = [before.world.body(at.body).ok()?, after.body(at.body).ok()?];
        let point = |body: &BodyRef<'_, f64>| {
            let (sin, cos) = body.angle().sin_cos();
            let Vec2 { x, y } = body.position();
            [x + at.point.x * cos - at.point.y * sin, y + at.point.x * sin + at.point.y * cos]
        };
        let arm = long([at.point.x, at.point.y]);
        let speed = |body: &BodyRef<'_, f64>| {
            let Vec2 { x, y } = body.velocity();
            long([x, y]) + arm * body.angular_velocity().abs()
        };
        // Twice the larger of the two speeds, and some for bodies that turn back in between.
        let speed = 2.0 * speed(&before_body).max(speed(&after_body)) + 1.0;
        let yields = match before_body.kind() {
            BodyKind::Dynamic => [before_body.inverse_mass(), before_body.inverse_inertia()],
            _ => [0.0; 2],
        };
        Some(Self {
            from: point(&before_body),
            to: point(&after_body),
            reach: 4.5 * before.seconds * speed,
            speed,
            arm,
            yields,
        })
    }

    fn end(before: &Snapshot, after: &World<f64>, end: &End<f64>) -> Option<Self> {
        match end {
            End::World(point) => Some(Self::fixed(*point)),
            End::Body(at) => Self::of(before, after, at),
        }
    }

    /// Change of accelerations by a force that changes by `force` for each unit of a place or speed of both ends,
    /// the force itself being at most `max_force`.
    fn felt(&self, force: f64, max_force: f64) -> f64 {
        // The torque's lever turns as well.
        self.yields[0] * force + self.yields[1] * self.arm * (force + max_force)
    }
}

impl Slopes {
    /// `None` if they are too steep for a bound.
    fn over(before: &Snapshot, after: &World<f64>) -> Option<Self> {
        let mut stops = u32::from(is_damped(&before.world));
        let mut slopes: Vec<(BodyId, [f64; 2])> = after.bodies().map(|body| (body.id(), [0.0; 2])).collect();
        let mut add = |body: BodyId, place: f64, speed: f64| {
            if let Some((_, [own_place, own_speed])) = slopes.iter_mut().find(|(id, _)| *id == body) {
                *own_place += place;
                *own_speed += speed;
            }
        };
        for (_, ForceField { kind, .. }) in before.world.fields() {
            match kind {
                FieldKind::Spring { near, far, spring } => {
                    let (a, b) = (Way::of(before, after, near)?, Way::end(before, after, far)?);
                    let length = |a: [f64; 2], b: [f64; 2]| long([a[0] - b[0], a[1] - b[1]]);
                    let (start, end) = (length(a.from, b.from), length(a.to, b.to));
                    let (min, max) = (start.min(end) - a.reach - b.reach, start.max(end) + a.reach + b.reach);
                    if min < NEAR {
                        return None;
                    }
                    let rate = a.speed + b.speed;
                    let force = spring.stiffness * max.max(spring.rest) + spring.damping * rate;
                    // Both ends move and turn with their bodies; a force along the spring turns with it.
                    let moved = 2.0 + a.arm + b.arm;
                    let place = moved * (spring.stiffness + 2.0 * (force + spring.damping * rate) / min);
                    let speed = moved * spring.damping;
                    for (way, body) in [(&a, Some(near.body)), (&b, body_of(far))] {
                        if let Some(body) = body {
                            add(body, way.felt(place, force), way.felt(speed, 0.0));
                        }
                    }
                }
                FieldKind::Attractor { centre, mu, softening } => {
                    let centre = Way::end(before, after, centre)?;
                    for body in before.world.bodies() {
                        // Steepest at the centre, and twice that covers all ways.
                        add(body.id(), (2.0 + centre.arm) * 2.0 * mu / softening.powi(3), 0.0);
                    }
                }
                FieldKind::Thrust { at, force } => {
                    let way = Way::of(before, after, at)?;
                    add(at.body, way.yields[0] * long([force.x, force.y]), 0.0);
                }
                FieldKind::Drag { linear, quadratic, wind } => {
                    stops += 1;
                    for body in before.world.bodies() {
                        let way = Way::of(before, after, &Attachment { body: body.id(), point: Vec2::ZERO })?;
                        let speed = way.speed + long([wind.x, wind.y]);
                        add(body.id(), 0.0, way.yields[0] * (linear + 2.0 * quadratic * speed));
                    }
                }
                FieldKind::Custom { .. } => {
                    for body in before.world.bodies() {
                        add(body.id(), 0.0, body.inverse_mass().max(body.inverse_inertia()));
                    }
                }
                _ => return None,
            }
        }
        let max_slope = |which: usize| slopes.iter().map(|(_, slopes)| slopes[which]).fold(0.0, f64::max);
        let slopes = Self { place: max_slope(0), speed: max_slope(1), stop: 0.5 * f64::from(stops) };
        let h = before.seconds;
        (slopes.place * h * h < STIFF && slopes.speed * h < STIFF).then_some(slopes)
    }
}

/// Returns true if any body is damped.
fn is_damped(world: &World<f64>) -> bool {
    let WorldDef { linear_damping, angular_damping, .. } = world.def();
    let dampings = |body: &BodyRef<'_, f64>| [body.linear_damping(), body.angular_damping()];
    [*linear_damping, *angular_damping].iter().any(|&damping| damping != Damping::NONE)
        || world.bodies().any(|body| dampings(&body).into_iter().flatten().any(|damping| damping != Damping::NONE))
}

fn body_of(end: &End<f64>) -> Option<BodyId> {
    match end {
        End::Body(at) => Some(at.body),
        End::World(_) => None,
    }
}

/// Bounds on the difference of the two builds, in ulps: in places and angles, in speeds; and in the acceleration that
/// `PublishedVerlet` keeps.
#[derive(Clone, Copy, Debug, Default)]
struct Error {
    place: f64,
    speed: f64,
    push: f64,
}

impl Error {
    fn step(&mut self, slopes: &Slopes, integrator: Integrator, seconds: f64) {
        let push = |place: f64, speed: f64| slopes.place * (place + 0.5) + slopes.speed * (speed + 0.5);
        let weights: &[f64] = match integrator {
            Integrator::VelocityVerlet => &[1.0],
            Integrator::Yoshida4 => &[1.3513, 1.7025, 1.3513],
            _ => return self.step_in_turn(slopes, integrator == Integrator::PublishedVerlet, seconds),
        };
        for weight in weights {
            // Kicked over the first half, drifted over the whole, kicked over the second half. Half of the speed backwards in
            // time is what damping makes of it in a second: 2^h.
            let half = 0.5 * weight * seconds;
            let speed = (self.speed + half * push(self.place, self.speed)) * half.exp2() + slopes.stop;
            let place = self.place + 2.0 * half * (speed + 0.5);
            self.speed = (speed + half * push(place, speed)) * half.exp2() + slopes.stop;
            self.place = place;
        }
    }

    /// Kicked by the forces at the start, drifted, and then damped: drags act on the velocity at the end.
    fn step_in_turn(&mut self, slopes: &Slopes, is_published: bool, h: f64) {
        let push = slopes.place * (self.place + 0.5) + slopes.speed * (self.speed + 0.5);
        // By the mean of the last acceleration, which is kept, and the new one, by which it also drifts.
        let (kick, drift) = if is_published { (0.5 * (self.push + push), 0.5 * h * h * push) } else { (push, 0.0) };
        let speed = self.speed + h * kick;
        self.place += h * (speed + 0.5) + drift;
        self.speed = speed + h * slopes.speed * (speed + 0.5) + slopes.stop;
        self.push = if is_published { push } else { 0.0 };
    }

    /// Largest speeds are held at the end of a step.
    fn cap(&mut self) {
        self.speed = SQRT_2 * self.speed + FRAC_1_SQRT_2;
    }

    /// Places and speeds are equal again; the last acceleration is what it was.
    fn settle(&mut self) {
        *self = Self { push: self.push, ..Self::default() };
    }

    fn assert_covers(&self, world: &World, float: &World<f64>) {
        const ULPS: f64 = (1u64 << 32) as f64;
        for (body, float_body) in world.bodies().zip(float.bodies()) {
            let (x, v) = (body.position_exact(), body.velocity_exact());
            let (y, w) = (float_body.position(), float_body.velocity());
            let turn = body.angle_exact().to_f64() - float_body.angle();
            let places = [x.x.to_f64() - y.x, x.y.to_f64() - y.y, turn - TAU * (turn / TAU).round()];
            let spin = body.angular_velocity_exact().to_f64() - float_body.angular_velocity();
            let speeds = [v.x.to_f64() - w.x, v.y.to_f64() - w.y, spin];
            for (off, allowed) in [(places, self.place), (speeds, self.speed)] {
                let off = off.into_iter().map(f64::abs).fold(0.0, f64::max) * ULPS;
                assert!(off <= 2.0 * allowed + 1.0, "{}: {off} ulps of {self:?}, tick {}", body.id(), world.tick());
            }
        }
    }
}
