//! Commands that a match may see: fair ones, and every kind of unfair one.

use umbra_physics::{
    ApplyOptions, Attachment, BodyDef, BodyId, BodyKind, Command, End, FieldId, FieldKind, ForceField, ForceOrImpulse,
    Frame, Fx, FxFactor, Integrator, Locks, Mass, Part, Random, Region, Shape, SpringConstants, TimeStep, Vec2, World,
    fx, limits,
};

use super::random::SplitMix;

/// How many kinds of commands [`Author::any`] writes.
pub(crate) const KINDS: u64 = 33;

/// Writes commands.
pub(crate) struct Author {
    pub(crate) random: SplitMix,
    /// Of so many commands and values one is unfair; none for 0.
    pub(crate) unfair: u64,
}

// Each test takes what it needs.
#[allow(dead_code, reason = "each test that takes this file in uses a part of it")]
impl Author {
    pub(crate) fn one_in(&mut self, count: u64) -> bool {
        self.random.next() % count == 0
    }

    fn is_unfair(&mut self) -> bool {
        self.unfair > 0 && self.one_in(self.unfair)
    }

    /// Between the two, the first included; or an unfair one of any size.
    pub(crate) fn number(&mut self, low: Fx, high: Fx) -> Fx {
        if !self.is_unfair() {
            return Fx::from_bits(self.random.between(low.to_bits(), high.to_bits()));
        }
        let edges = [limits::POSITION, limits::SPEED, limits::SIZE_MAX, limits::SIZE_MIN, limits::MASS_MAX];
        let edge = edges[self.random.next() as usize % edges.len()];
        match self.random.next() % 5 {
            0 => Fx::ZERO,
            1 => edge,
            2 => edge + Fx::DELTA,
            3 => -edge - Fx::DELTA,
            _ => Fx::from_bits(self.random.of_bits(63)),
        }
    }

    pub(crate) fn vector(&mut self, size: Fx) -> Vec2 {
        Vec2::new(self.number(-size, size), self.number(-size, size))
    }

    fn share(&mut self) -> Fx {
        // Half of them damp nothing, and some leave nothing.
        match self.random.next() % 8 {
            0..4 => Fx::ONE,
            4 => Fx::ZERO,
            _ => self.number(fx!(0.5), fx!(1)),
        }
    }

    pub(crate) fn shape(&mut self) -> Option<Shape> {
        let size = |own: &mut Self| own.number(fx!(0.125), fx!(2));
        let shape = match self.random.next() % 7 {
            0 => Shape::circle(size(self)),
            1 => Shape::rectangle(size(self), size(self)),
            2 => Shape::capsule(size(self), size(self)),
            3 => Shape::segment(self.vector(fx!(2)), self.vector(fx!(2))),
            4 => {
                let corner = self.vector(fx!(3));
                Shape::polygon(&[corner, self.vector(fx!(3)), self.vector(fx!(3))])
            }
            5 => {
                let part = |own: &mut Self| {
                    let shape = Shape::rectangle(fx!(1), fx!(0.5)).expect("a fair size");
                    let density = own.number(fx!(0.5), fx!(4));
                    Part { shape, position: own.vector(fx!(2)), angle: own.number(fx!(-7), fx!(7)), density }
                };
                Shape::compound(&[part(self), part(self)])
            }
            _ => return None,
        };
        shape.ok()
    }

    fn mass(&mut self) -> Mass {
        match self.random.next() % 3 {
            0 => Mass::Density(self.number(fx!(0.25), fx!(4))),
            1 => Mass::Kilograms(self.number(fx!(0.25), fx!(4))),
            _ => Mass::Explicit { mass: self.number(fx!(0.25), fx!(4)), inertia: self.number(fx!(0.25), fx!(4)) },
        }
    }

    fn kind(&mut self) -> BodyKind {
        match self.random.next() % 8 {
            0 => BodyKind::Static,
            1 => BodyKind::Kinematic,
            _ => BodyKind::Dynamic,
        }
    }

    /// None for the most part.
    fn locks(&mut self) -> Locks {
        let bits = if self.one_in(4) { self.random.next() } else { 0 };
        Locks { x: bits & 1 == 1, y: bits & 2 == 2, rotation: bits & 4 == 4 }
    }

    /// A largest speed, or none.
    fn most(&mut self) -> Option<Fx> {
        if self.one_in(4) { Some(self.number(fx!(0), fx!(4))) } else { None }
    }

    pub(crate) fn body(&mut self) -> BodyDef {
        let kind = self.kind();
        let still = kind == BodyKind::Static && !self.is_unfair();
        let mut share = || if self.one_in(3) { Some(self.share()) } else { None };
        let (linear_damping, angular_damping) = (share(), share());
        let (locks, is_strict) = (self.locks(), !self.is_unfair());
        let free = |v: Fx, locked: bool| if locked && is_strict { Fx::ZERO } else { v };
        let velocity = self.vector(fx!(3));
        let spin = self.number(fx!(-3), fx!(3));
        BodyDef {
            kind,
            position: self.vector(fx!(20)),
            angle: self.number(fx!(-9), fx!(9)),
            velocity: if still { Vec2::ZERO } else { Vec2::new(free(velocity.x, locks.x), free(velocity.y, locks.y)) },
            angular_velocity: if still { Fx::ZERO } else { free(spin, locks.rotation) },
            shape: self.shape(),
            mass: self.mass(),
            gravity_scale: self.number(fx!(-1), fx!(2)),
            linear_damping,
            angular_damping,
            max_speed: self.most(),
            max_angular_speed: self.most(),
            locks,
            groups: self.random.next() as u32,
            key: self.random.next() % 16,
            user_data: self.random.next(),
        }
    }

    /// A body of the world; or one that it has no more, or never had.
    pub(crate) fn some_body(&mut self, world: &World) -> BodyId {
        let count = world.bodies().count() as u64;
        if count == 0 || self.is_unfair() {
            return BodyId::from_parts((self.random.next() % 8) as u32, (self.random.next() % 3) as u32);
        }
        let index = (self.random.next() % count) as usize;
        world.bodies().nth(index).map_or(BodyId::from_parts(0, 0), |body| body.id())
    }

    fn some_field(&mut self, world: &World) -> FieldId {
        let count = world.fields().count() as u64;
        if count == 0 || self.is_unfair() {
            return FieldId::from_parts((self.random.next() % 8) as u32, (self.random.next() % 3) as u32);
        }
        let index = (self.random.next() % count) as usize;
        world.fields().nth(index).map_or(FieldId::from_parts(0, 0), |(id, _)| id)
    }

    pub(crate) fn field(&mut self, world: &World) -> ForceField {
        let attachment = |own: &mut Self| Attachment { body: own.some_body(world), point: own.vector(fx!(0.5)) };
        let end = |own: &mut Self| {
            if own.one_in(2) { End::World(own.vector(fx!(20))) } else { End::Body(attachment(own)) }
        };
        let kind = match self.random.next() % 7 {
            0 => {
                let mu = FxFactor::from_scalar(self.number(fx!(0), fx!(5)));
                FieldKind::Attractor { centre: end(self), mu, softening: self.number(fx!(0.5), fx!(2)) }
            }
            1 | 2 => {
                let spring = SpringConstants {
                    rest: self.number(fx!(0), fx!(3)),
                    stiffness: self.number(fx!(0), fx!(5)),
                    damping: if self.one_in(2) { Fx::ZERO } else { self.number(fx!(0), fx!(1)) },
                };
                FieldKind::Spring { near: attachment(self), far: end(self), spring }
            }
            3 => {
                let (linear, quadratic) = (self.number(fx!(0), fx!(0.25)), self.number(fx!(0), fx!(0.25)));
                FieldKind::Drag { linear, quadratic, wind: self.vector(fx!(2)) }
            }
            4 => FieldKind::Thrust { at: attachment(self), force: self.vector(fx!(2)) },
            5 => {
                let region = if self.one_in(2) {
                    Region::Disc { centre: self.vector(fx!(9)), radius: self.number(fx!(1), fx!(9)) }
                } else {
                    Region::Box { min: self.vector(fx!(9)), max: self.vector(fx!(9)) }
                };
                FieldKind::Zone { region, acceleration: self.vector(fx!(2)) }
            }
            _ => FieldKind::Custom { id: self.random.next() % 3 },
        };
        ForceField { kind, groups: self.random.next() as u32 }
    }

    pub(crate) fn action(&mut self) -> ForceOrImpulse {
        let mut point = || if self.one_in(2) { Some(self.vector(fx!(20))) } else { None };
        let point = point();
        match self.random.next() % 4 {
            0 => ForceOrImpulse::Force { force: self.vector(fx!(30)), point },
            1 => ForceOrImpulse::Torque(self.number(fx!(-5), fx!(5))),
            2 => ForceOrImpulse::Impulse { impulse: self.vector(fx!(1)), point },
            _ => ForceOrImpulse::AngularImpulse(self.number(fx!(-1), fx!(1))),
        }
    }

    /// Something done to a body.
    pub(crate) fn push(&mut self, world: &World) -> Command {
        let frame = if self.one_in(3) { Frame::Body } else { Frame::World };
        let manner = ApplyOptions { frame, wake: !self.one_in(4) };
        Command::Apply { body: self.some_body(world), action: self.action(), manner }
    }

    /// A command of any kind.
    pub(crate) fn any(&mut self, world: &World) -> Command {
        let kind = self.random.next() % KINDS;
        self.of_kind(kind, world)
    }

    /// A command of the kind with this number.
    pub(crate) fn of_kind(&mut self, kind: u64, world: &World) -> Command {
        let body = self.some_body(world);
        match kind {
            0 => Command::AddBody(self.body()),
            1 => Command::RemoveBody(body),
            2 => self.push(world),
            3 => Command::SetPosition { body, position: self.vector(fx!(20)) },
            4 => Command::SetAngle { body, angle: self.number(fx!(-9), fx!(9)) },
            5 => Command::SetVelocity { body, velocity: self.vector(fx!(3)) },
            6 => Command::SetAngularVelocity { body, velocity: self.number(fx!(-3), fx!(3)) },
            7 => Command::SetMass { body, mass: self.mass() },
            8 => Command::SetShape { body, shape: self.shape() },
            9 => Command::SetKind { body, kind: self.kind() },
            10 => Command::SetGravityScale { body, scale: self.number(fx!(-1), fx!(2)) },
            11 => {
                let mut share = || if self.one_in(2) { Some(self.share()) } else { None };
                Command::SetBodyDamping { body, linear: share(), angular: share() }
            }
            12 => Command::SetGroups { body, groups: self.random.next() as u32 },
            13 => Command::SetKey { body, key: self.random.next() },
            14 => Command::SetUserData { body, user_data: self.random.next() },
            15 => Command::Wake(body),
            16 => Command::Release(body),
            17 => Command::AddField(self.field(world)),
            18 => Command::SetField { id: self.some_field(world), field: self.field(world) },
            19 => Command::RemoveField(self.some_field(world)),
            20 => {
                let any = self.random.next() as u32 % 12_000;
                let (num, den) =
                    if self.is_unfair() { (1, any) } else { [(1, 60), (1001, 60_000), (1, 144)][any as usize % 3] };
                Command::SetTimeStep(TimeStep::ratio(num, den))
            }
            21 => Command::SetGravity(self.vector(fx!(10))),
            22 => {
                let any = self.random.next() as usize % Integrator::ALL.len();
                Command::SetIntegrator(Integrator::ALL[any])
            }
            23 => Command::SetDamping { linear: self.share(), angular: self.share() },
            24 => Command::SetRandom(Random::seeded(self.random.next())),
            // An unfair one takes 16 MB: not here.
            25 => Command::SetBlob(vec![self.random.next() as u8; self.random.next() as usize % 9]),
            26 => Command::ClearForces,
            27 => Command::SetLocks { body, locks: self.locks() },
            28 => Command::SetMaxSpeeds { body, linear: self.most(), angular: self.most() },
            29 => Command::Disable(body),
            30 => Command::Enable(body),
            31 => Command::MoveTo { body, position: self.vector(fx!(20)), angle: self.number(fx!(-9), fx!(9)) },
            _ => {
                let ticks = [None, Some(1), Some(5), Some(if self.is_unfair() { 0 } else { 30 })];
                Command::SetSleepAfter(ticks[self.random.next() as usize % 4])
            }
        }
    }
}
