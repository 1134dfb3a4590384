//! The values of random commands, by the roles that they have in commands.

use umbra_physics::{
    ApplyOptions, Attachment, BodyDef, BodyId, BodyKind, ColliderDef, ColliderId, CommandSource, ContactSettings,
    Damping, Distance, End, Exclusion, Explosion, FieldId, ForceField, ForceOrImpulse, Frame, Fx, Gear, Integrator,
    JointDef, JointId, JointKind, JointLimits, JointMotor, JointSpring, Locks, Mass, MaterialPair, Motor, PlanarMotor,
    PlanarSpring, Prismatic, Pulley, Random, Revolute, Shape, TimeStep, Vec2, Weld, Wheel, WorldDef, fx, limits,
};

use super::{Choices, Generator};

/// Angles far beyond whole turns.
pub(super) const ANGLE: Fx = Fx::MAX;

impl<C: Choices + ?Sized> Generator<'_, C> {
    /// Half of the time none.
    fn joint_limits(&mut self) -> Option<JointLimits> {
        let has_limits = self.choices.one_in(2);
        let [first, second] = [(); 2].map(|()| self.signed(fx!(2), limits::JOINT_ANGLE));
        has_limits.then_some(JointLimits { lower: first.min(second), upper: first.max(second) })
    }

    /// Of a wild taste now and then none.
    fn strands(&mut self) -> u8 {
        if self.is_wild() { 0 } else { 1 + self.choices.choose(3) as u8 }
    }

    fn teeth(&mut self) -> i16 {
        let teeth = 1 + self.choices.choose(40) as i16;
        if self.is_wild() {
            0
        } else if self.choices.one_in(4) {
            -teeth
        } else {
            teeth
        }
    }

    fn planar_spring(&mut self) -> PlanarSpring {
        let [x, y] = [(); 2].map(|()| self.signed(fx!(8), limits::JOINT_LENGTH));
        PlanarSpring {
            hertz: self.number([fx!(0), fx!(6)], [fx!(0), fx!(1_000_000)]),
            damping_ratio: self.number([fx!(0), fx!(1)], [fx!(0), fx!(1024)]),
            rest: Vec2::new(x, y),
            max_force: if self.choices.one_in(3) { None } else { Some(self.not_negative(fx!(50), Fx::MAX)) },
        }
    }

    fn planar_motor(&mut self) -> PlanarMotor {
        let [x, y] = [(); 2].map(|()| self.signed(fx!(8), limits::SPEED));
        PlanarMotor { velocity: Vec2::new(x, y), max_force: self.not_negative(fx!(50), Fx::MAX) }
    }
}

impl<C: Choices + ?Sized> CommandSource for Generator<'_, C> {
    /// One of the bodies; of a wild taste, now and then one that never was.
    fn body(&mut self) -> BodyId {
        if self.bodies.is_empty() || self.is_wild() {
            return BodyId::from_parts(self.choices.choose(8) as u32, self.choices.choose(3) as u32);
        }
        self.bodies[self.choices.choose(self.bodies.len() as u64) as usize]
    }

    fn field(&mut self) -> FieldId {
        if self.fields.is_empty() || self.is_wild() {
            return FieldId::from_parts(self.choices.choose(8) as u32, self.choices.choose(3) as u32);
        }
        self.fields[self.choices.choose(self.fields.len() as u64) as usize]
    }

    fn collider(&mut self) -> ColliderId {
        if self.colliders.is_empty() || self.is_wild() {
            return ColliderId::from_parts(self.choices.choose(8) as u32, self.choices.choose(3) as u32);
        }
        self.colliders[self.choices.choose(self.colliders.len() as u64) as usize]
    }

    fn joint(&mut self) -> JointId {
        if self.joints.is_empty() || self.is_wild() {
            return JointId::from_parts(self.choices.choose(8) as u32, self.choices.choose(3) as u32);
        }
        self.joints[self.choices.choose(self.joints.len() as u64) as usize]
    }

    /// A joint of two bodies, or of a body and the world, mostly of bodies beside each other in the list. Where a step must be undone it is
    /// disabled; a smooth taste has joints of a body with itself alone, which worlds of floats refuse as other worlds do.
    fn joint_def(&mut self) -> JointDef {
        let first = self.body();
        if self.taste.smooth {
            return JointDef::new([End::Body(Attachment::centre(first)); 2], JointKind::default());
        }
        let next = self.bodies.iter().position(|&body| body == first).and_then(|at| self.bodies.get(at + 1)).copied();
        let second = match next {
            Some(next) if !self.choices.one_in(3) => Some(next),
            _ if self.choices.one_in(2) => None,
            _ => Some(self.body()),
        };
        let mut end = |body: Option<BodyId>| match body {
            Some(body) => End::Body(Attachment { body, point: self.local() }),
            None => End::World(self.position()),
        };
        let ends = [end(Some(first)), end(second)];
        let is_swapped = self.choices.one_in(4);
        let angles = [self.signed(fx!(7), ANGLE), self.signed(fx!(7), ANGLE)];
        let (collide_connected, enabled, break_force) = (self.choices.one_in(3), self.enabled(), self.break_force());
        JointDef {
            angles,
            collide_connected,
            enabled,
            break_force,
            break_torque: break_force.filter(|_| collide_connected),
            events: self.choices.one_in(2),
            key: self.choices.choose(16),
            ..JointDef::new(if is_swapped { [ends[1], ends[0]] } else { ends }, self.joint_kind())
        }
    }

    fn optional_joint_motor(&mut self) -> Option<JointMotor> {
        let has_motor = self.choices.choose(4) > 0;
        has_motor.then(|| JointMotor {
            speed: self.number([fx!(-8), fx!(8)], [-limits::ANGULAR_SPEED, limits::ANGULAR_SPEED]),
            max_force: self.number([fx!(0), fx!(50)], [fx!(0), Fx::MAX]),
        })
    }

    fn joint_kind(&mut self) -> JointKind {
        let spring = |source: &mut Self| {
            let hertz = source.number([fx!(0), fx!(6)], [fx!(0), fx!(1_000_000)]);
            let damping_ratio = source.number([fx!(0), fx!(1)], [fx!(0), fx!(1024)]);
            let rest = source.signed(fx!(2), limits::JOINT_ANGLE);
            let max_force = if source.choices.one_in(2) { None } else { Some(source.not_negative(fx!(50), Fx::MAX)) };
            JointSpring { hertz, damping_ratio, rest, max_force }
        };
        let friction = self.not_negative(fx!(2), Fx::MAX);
        match self.choices.choose(12) {
            0..2 => JointKind::default(),
            2 => {
                let spring = if self.choices.one_in(2) { Some(spring(self)) } else { None };
                JointKind::Weld(Weld { spring })
            }
            3..6 => JointKind::Revolute(Revolute {
                limits: self.joint_limits(),
                motor: self.optional_joint_motor(),
                spring: if self.choices.one_in(3) { Some(spring(self)) } else { None },
                friction,
                ratchet: None,
            }),
            6 => JointKind::Prismatic(Prismatic {
                limits: self.joint_limits(),
                motor: self.optional_joint_motor(),
                spring: if self.choices.one_in(3) { Some(spring(self)) } else { None },
                friction,
            }),
            7 => JointKind::Wheel(Wheel {
                limits: self.joint_limits(),
                motor: self.optional_joint_motor(),
                spring: if self.choices.one_in(2) { Some(spring(self)) } else { None },
                friction,
            }),
            8 => JointKind::Motor(Motor {
                spring: if self.choices.one_in(3) { None } else { Some(self.planar_spring()) },
                motor: if self.choices.one_in(2) { None } else { Some(self.planar_motor()) },
                angular_spring: if self.choices.one_in(3) { Some(spring(self)) } else { None },
                angular_motor: self.optional_joint_motor(),
            }),
            9 => match self.choices.choose(3) {
                0 => JointKind::Gear(Gear { teeth: [self.teeth(), self.teeth()] }),
                1 => JointKind::Pulley(Pulley {
                    grounds: [self.position(), self.position()],
                    strands: [self.strands(), self.strands()],
                    length: self.number([fx!(4), fx!(30)], [limits::SIZE_MIN, limits::JOINT_LENGTH]),
                }),
                _ => {
                    let motor = self.optional_joint_motor();
                    let ratchet = Some(self.teeth());
                    JointKind::Revolute(Revolute { motor, friction, ratchet, ..Revolute::default() })
                }
            },
            10 => {
                let size =
                    |value: Fx| value.checked_abs().unwrap_or(Fx::MAX).clamp(limits::SIZE_MIN, limits::JOINT_LENGTH);
                let limits = self.joint_limits().map(|JointLimits { lower, upper }| {
                    let [first, second] = [size(lower), size(upper)];
                    JointLimits { lower: first.min(second), upper: first.max(second) }
                });
                let spring = if self.choices.one_in(2) { Some(spring(self)) } else { None };
                let spring = spring.map(|spring| JointSpring { rest: size(spring.rest), ..spring });
                JointKind::Distance(Distance { limits, motor: self.optional_joint_motor(), spring, friction })
            }
            _ => {
                let length = self.number([fx!(0.25), fx!(8)], [limits::SIZE_MIN, limits::JOINT_LENGTH]);
                JointKind::Distance(Distance::rod(length))
            }
        }
    }

    /// Mostly none.
    fn break_force(&mut self) -> Option<Fx> {
        if self.choices.one_in(3) { Some(self.not_negative(fx!(200), Fx::MAX)) } else { None }
    }

    fn enabled(&mut self) -> bool {
        !self.choices.one_in(6) && !self.taste.reversible
    }

    /// The definition of a collider, half of them in the middle of the body.
    fn collider_def(&mut self) -> ColliderDef {
        let shape = self.shape();
        let is_central = self.choices.one_in(2);
        let (position, angle) =
            if is_central { (Vec2::ZERO, Fx::ZERO) } else { (self.local(), self.signed(fx!(7), ANGLE)) };
        let key = self.choices.choose(16);
        let position_of = |shape| ColliderDef { position, angle, key, user_data: key, ..ColliderDef::new(shape) };
        let collider = shape.or_else(|| Shape::circle(fx!(0.5)).ok()).map(position_of);
        ColliderDef {
            density: self.number([fx!(0.5), fx!(4)], [Fx::ZERO, Fx::MAX]),
            material: self.material(),
            filter: self.filter(),
            one_way: self.one_way(),
            // Of the key, so that no file of the corpora means something else.
            sensor: key % 8 == 7,
            contact_events: key % 2 == 0,
            hit_events: key % 4 == 1,
            ..collider.unwrap_or_else(|| unreachable!("half a metre is a radius"))
        }
    }

    /// The number of a material: 0 is none.
    fn material(&mut self) -> u32 {
        let few = self.choices.choose(4) as u32;
        if self.is_wild() { few } else { few.max(1) }
    }

    fn optional_material_pair(&mut self) -> Option<MaterialPair> {
        let is_taken_back = self.choices.one_in(4);
        let usual = [Fx::ZERO, fx!(1)];
        let pair = MaterialPair {
            friction: self.number(usual, [Fx::ZERO, limits::FRICTION]),
            restitution: self.number(usual, usual),
            rolling_resistance: self.number(usual, usual),
        };
        (!is_taken_back).then_some(pair)
    }

    fn contact_settings(&mut self) -> ContactSettings {
        let standard: ContactSettings = ContactSettings::default();
        let speed = [Fx::ZERO, fx!(1024)];
        // Few pairs are too few for some.
        let is_short = self.is_wild();
        let count = |draw: u64, all: u32| if is_short { 1 + draw as u32 } else { all };
        ContactSettings {
            hit_speed: standard.hit_speed,
            substeps: if self.choices.one_in(2) { standard.substeps } else { 1 + self.choices.choose(8) as u32 },
            push_speed: self.number([fx!(1), fx!(4)], speed),
            restitution_speed: self.number([fx!(0.5), fx!(2)], speed),
            sleep_speed: self.number([fx!(0), fx!(1)], speed),
            max_pairs: count(self.choices.choose(32), standard.max_pairs),
            max_pairs_per_collider: count(self.choices.choose(8), standard.max_pairs_per_collider),
        }
    }

    fn exclusion(&mut self) -> Exclusion {
        if self.choices.one_in(2) { Exclusion::Always } else { Exclusion::UntilApart }
    }

    /// The definition of a body. A third of them rest, to fall asleep.
    fn body_def(&mut self) -> BodyDef {
        let (kind, locks) = (self.kind(), self.locks());
        let is_wild = self.is_wild();
        let is_resting = self.choices.one_in(3);
        let is_still = is_resting || kind == BodyKind::Static && !is_wild;
        let free = |value: Fx, is_locked: bool| if is_locked && !is_wild { Fx::ZERO } else { value };
        let (velocity, angular_velocity) =
            if is_still { (Vec2::ZERO, Fx::ZERO) } else { (self.velocity(), self.angular_velocity()) };
        let ghost = self.ghost();
        let mass = self.mass();
        let key = self.choices.choose(16);
        let mut colliders = self.colliders();
        colliders.extend(ghost);
        BodyDef {
            kind,
            position: self.position(),
            angle: self.angle(),
            velocity: Vec2::new(free(velocity.x, locks.x), free(velocity.y, locks.y)),
            angular_velocity: free(angular_velocity, locks.rotation),
            colliders,
            mass,
            gravity_scale: if is_resting { Fx::ZERO } else { self.gravity_scale() },
            linear_damping: self.body_damping(),
            angular_damping: self.body_damping(),
            max_speed: self.max_speed(),
            max_angular_speed: self.max_angular_speed(),
            locks,
            dominance: self.dominance(),
            bullet: self.bullet(),
            force_groups: self.force_groups(),
            key,
            user_data: key,
        }
    }

    fn force_field(&mut self) -> ForceField {
        let kind = self.field_kind();
        ForceField { kind, force_groups: if self.choices.one_in(2) { self.force_groups() } else { u32::MAX } }
    }

    fn force_or_impulse(&mut self) -> ForceOrImpulse {
        let point = if self.choices.one_in(2) { Some(self.vector(fx!(20), Fx::MAX)) } else { None };
        match self.choices.choose(if self.taste.reversible { 3 } else { 5 }) {
            0 | 1 => ForceOrImpulse::Force { force: self.vector(fx!(20), Fx::MAX), point },
            2 => ForceOrImpulse::Torque(self.signed(fx!(5), Fx::MAX)),
            3 => ForceOrImpulse::Impulse { impulse: self.vector(fx!(1), Fx::MAX), point },
            _ => ForceOrImpulse::AngularImpulse(self.signed(fx!(1), Fx::MAX)),
        }
    }

    fn apply_options(&mut self) -> ApplyOptions {
        let frame = if self.choices.one_in(3) { Frame::Body } else { Frame::World };
        ApplyOptions { frame, wake: !self.choices.one_in(4) }
    }

    fn explosion(&mut self) -> Explosion {
        Explosion {
            position: self.vector(fx!(20), limits::POSITION),
            radius: self.number([fx!(0), fx!(8)], [Fx::DELTA, fx!(5000)]),
            falloff: self.number([fx!(0), fx!(20)], [Fx::DELTA, fx!(5000)]),
            impulse: self.signed(fx!(8), fx!(70000)),
            mask: if self.choices.one_in(3) { self.choices.choose(8) as u32 } else { !0 },
        }
    }

    fn position(&mut self) -> Vec2 {
        self.vector(fx!(20), limits::POSITION)
    }

    fn angle(&mut self) -> Fx {
        self.signed(fx!(9), ANGLE)
    }

    fn velocity(&mut self) -> Vec2 {
        self.vector(fx!(3), limits::SPEED)
    }

    fn angular_velocity(&mut self) -> Fx {
        self.signed(fx!(3), limits::ANGULAR_SPEED)
    }

    fn mass(&mut self) -> Mass {
        let usual = [fx!(0.25), fx!(4)];
        let mut kilograms = || self.number(usual, [limits::MASS_MIN, limits::MASS_MAX]);
        let mass = kilograms();
        match self.choices.choose(8) {
            0 if !self.taste.smooth => Mass::FromColliders,
            1..3 => Mass::Kilograms(Fx::ONE),
            3..5 => Mass::Kilograms(mass),
            5..7 => Mass::Explicit { mass, inertia: self.number(usual, [Fx::DELTA, Fx::MAX]) },
            _ if self.taste.smooth => Mass::Kilograms(mass),
            _ => Mass::FromColliders,
        }
    }

    fn kind(&mut self) -> BodyKind {
        match self.choices.choose(10) {
            8 => BodyKind::Kinematic,
            9 => BodyKind::Static,
            _ => BodyKind::Dynamic,
        }
    }

    fn gravity_scale(&mut self) -> Fx {
        match self.choices.one_in(2) {
            true => self.number([fx!(-1), fx!(2)], [-limits::GRAVITY_SCALE, limits::GRAVITY_SCALE]),
            false => Fx::ONE,
        }
    }

    fn body_damping(&mut self) -> Option<Damping> {
        if self.choices.one_in(3) { Some(self.damping()) } else { None }
    }

    fn max_speed(&mut self) -> Option<Fx> {
        let is_capped = !self.taste.reversible && self.choices.one_in(7);
        if is_capped { Some(self.not_negative(fx!(4), limits::SPEED)) } else { None }
    }

    fn max_angular_speed(&mut self) -> Option<Fx> {
        let is_capped = !self.taste.reversible && self.choices.one_in(7);
        if is_capped { Some(self.not_negative(fx!(4), limits::ANGULAR_SPEED)) } else { None }
    }

    /// Mostly that of all others.
    fn dominance(&mut self) -> i32 {
        if self.choices.one_in(4) { self.choices.choose(5) as i32 - 2 } else { 0 }
    }

    fn bullet(&mut self) -> bool {
        self.choices.one_in(4)
    }

    fn force_groups(&mut self) -> u32 {
        if self.choices.one_in(3) { self.choices.draw(32) as u32 } else { 1 }
    }

    fn key(&mut self) -> u64 {
        if self.choices.one_in(2) { self.choices.choose(16) } else { self.choices.draw(64) }
    }

    fn user_data(&mut self) -> u64 {
        self.choices.draw(64)
    }

    /// Mostly none.
    fn locks(&mut self) -> Locks {
        let bits = if self.choices.one_in(6) { self.choices.draw(3) } else { 0 };
        Locks { x: bits & 1 != 0, y: bits & 2 != 0, rotation: bits & 4 != 0 }
    }

    fn time_step(&mut self) -> TimeStep {
        const RATES: [(u32, u32); 10] = [
            (1, 60),
            (1, 60),
            (1, 64),
            (1, 144),
            (1001, 60_000),
            (1, 100),
            (1, 50),
            // Steps of a second and of a tenth of a millisecond.
            (1, 7),
            (1, 1),
            (1, 10_000),
        ];
        if self.is_wild() {
            return TimeStep::ratio(self.choices.draw(32) as u32, self.choices.draw(32) as u32);
        }
        if !self.taste.smooth && self.choices.one_in(6) {
            let (num, den) = (1 + self.choices.choose(500), 500 + self.choices.choose(59_501));
            let time_step = TimeStep::ratio(num as u32, den as u32);
            let def: WorldDef = WorldDef { time_step, ..WorldDef::default() };
            return if def.check().is_ok() { time_step } else { TimeStep::hz(60) };
        }
        let rates = if self.taste.smooth { &RATES[..7] } else { &RATES };
        let (num, den) = rates[self.choices.choose(rates.len() as u64) as usize];
        TimeStep::ratio(num, den)
    }

    fn gravity(&mut self) -> Vec2 {
        self.vector(fx!(12), limits::GRAVITY)
    }

    fn integrator(&mut self) -> Integrator {
        let all =
            Integrator::ALL.into_iter().filter(|integrator| !self.taste.reversible || integrator.inverse().is_some());
        let all: Vec<Integrator> = all.collect();
        all[self.choices.choose(all.len() as u64) as usize]
    }

    fn damping(&mut self) -> Damping {
        if self.taste.reversible {
            return Damping::NONE;
        }
        let kept = match self.choices.choose(8) {
            0..5 => Fx::ONE,
            5 if !self.taste.smooth && self.choices.one_in(2) => Fx::ZERO,
            7 if !self.taste.smooth => return Damping::rate(self.number([fx!(1), fx!(100)], [Fx::ZERO, Fx::MAX])),
            // Below −4 a share is written as −4: refused as well, but another command.
            _ => self.number([fx!(0.5), fx!(1)], [Fx::ZERO, Fx::ONE]).max(fx!(-4)),
        };
        Damping::kept_per_second(kept)
    }

    fn sleep_after(&mut self) -> Option<u32> {
        if self.taste.reversible || self.taste.smooth {
            return None;
        }
        let ticks = [None, Some(1), Some(3), Some(4), Some(30)];
        if self.is_wild() { Some(self.choices.draw(32) as u32 & 1) } else { ticks[self.choices.choose(5) as usize] }
    }

    fn random(&mut self) -> Random {
        Random::seeded(self.choices.draw(64))
    }

    fn blob(&mut self) -> Vec<u8> {
        vec![self.choices.draw(8) as u8; self.choices.choose(9) as usize]
    }
}
