//! The energy of a world that nobody acts on.

use super::drivers::{Inspector, Seen};
use umbra_physics::{
    BodyKind, ColliderDef, Command, ContactSettings, Created, Difference, Distance, Error, FieldKind, Fx, FxWide,
    Integrator, JointKind, JointLimits, JointMotor, JointRef, Owner, Prismatic, Revolute, Stepper, TickPhase, Vec2,
    Weld, Wheel, World, fx,
};

/// Where bodies overlap by more at the start, pushing them out may lift them by more than the bound allows, m.
const OVERLAP: Fx = fx!(0.005);
/// The bound allows the energy at the start divided by this.
const SHARE: i128 = 1_000;
/// The bound allows the energy that lifts each body by a metre divided by this.
const LIFT: i128 = 200;
/// The bound allows each body half its mass times (2^-18 m/s)², some units in which the solver has velocities, squared: shifted right by so
/// many bits, a mass in 2^-32 kg is that in 2^-64 J.
const ROUNDING: u32 = 5;
/// The bound allows each body half its mass times `push_speed` divided by this, squared: a body that others wedge out keeps some of that speed.
const WEDGED: i64 = 64;
/// Joints that are farther out of place at the start pull their bodies together, m or rad.
const OUT_OF_PLACE: Fx = fx!(0.001);
/// Contacts are soft over a sub-step. In longer steps than one of this many a second bodies that fall into them come out higher.
const RATE: u32 = 30;

/// Bounds the energy after each step by that after the last input.
#[derive(Default)]
pub(super) struct EnergyBound {
    /// The most energy that the world may have; `None` from an input on until a step starts from a world that qualifies.
    bound: Option<FxWide>,
    seen: Option<Seen>,
    has_judged: bool,
    /// Why the last step that was not judged does not qualify.
    refusal: Option<&'static str>,
}

impl Stepper for EnergyBound {
    fn execute(&mut self, world: &mut World, command: &Command) -> Result<Created, Error> {
        let created = world.execute(command)?;
        self.bound = None;
        Ok(created)
    }

    fn step(&mut self, world: &mut World) {
        let start = self.bound.map_or_else(|| bound(world), Ok);
        let has_overlaps = self.bound.is_none() && start.is_ok() && overlaps(world);
        let (has_applied, has_faults) = {
            let report = world.step();
            (!report.applied.is_empty(), !report.faults.is_empty())
        };
        let start = match start {
            Ok(_) if has_applied => Err("forces are applied in each step"),
            Ok(_) if has_faults => Err("bodies leave the envelope in each step"),
            Ok(_) if has_overlaps => Err("bodies overlap by more than 5 mm"),
            start => start,
        };
        self.bound = start.ok();
        self.refusal = start.err().or(self.refusal);
        let (Some(bound), Ok(energy)) = (self.bound, world.energy()) else { return };
        self.has_judged = true;
        if energy > bound && self.seen.is_none() {
            self.seen = Some(Seen { beside: "energy from nothing", difference: Some(excess(world, bound, energy)) });
        }
    }
}

impl Inspector for EnergyBound {
    fn seen(&mut self) -> Option<Seen> {
        self.seen.take()
    }

    fn idle(&self) -> Option<&'static str> {
        if self.has_judged { None } else { Some(self.refusal.unwrap_or("no step was made by the driver")) }
    }
}

/// The most energy that a world may have in the steps from now on, J, or the reason why it is unknown.
///
/// Energies are those of [`World::kinetic_energy`] and [`World::potential_energy`], in units of 2^-64 J. A weight is below 2^109 units of
/// 2^-64 N, as a mass is at most 2^24 kg, and the product of gravity and its scale below 2^21 m/s², rounded down to 2^-32 m/s².
fn bound(world: &World) -> Result<FxWide, &'static str> {
    const TOO_LARGE: &str = "its energy is out of range";
    qualify(world)?;
    let kinetic = world.kinetic_energy().map_err(|_| TOO_LARGE)?.to_bits();
    let potential = world.potential_energy().map_err(|_| TOO_LARGE)?.to_bits();
    let gravity = i128::from(length(world.def().gravity));
    // Speeds are below 2^47 units of 2^-32 m/s, their squares of 2^-64 below 2^82.
    let kept = i128::from(world.def().contacts.push_speed.to_bits() / WEDGED).pow(2) >> 32;
    let (mut weight, mut leftover) = (0i128, 0i128);
    for body in world.bodies().filter(|body| body.activity().takes_part()) {
        let mass = i128::from(body.mass().unwrap_or(Fx::ZERO).to_bits());
        let acceleration = (gravity * i128::from(body.gravity_scale().to_bits().abs())) >> 32;
        weight = weight.checked_add(mass * acceleration).ok_or(TOO_LARGE)?;
        leftover += (mass >> ROUNDING) + ((mass * kept) >> 33);
    }
    let allowed = kinetic / SHARE + (potential / SHARE).abs() + weight / LIFT + leftover;
    let bound = kinetic.checked_add(potential).and_then(|energy| energy.checked_add(allowed));
    bound.map(FxWide::from_bits).ok_or(TOO_LARGE)
}

/// The length of a vector in units of 2^-32, rounded down. Squares are below 2^97: gravity is at most 2^16 m/s² along each axis.
fn length(vector: Vec2) -> i64 {
    let square = |component: Fx| i128::from(component.to_bits()).pow(2).unsigned_abs();
    (square(vector.x) + square(vector.y)).isqrt() as i64
}

/// Checks that nothing in a world gives energy to bodies but impacts and friction, if these do.
fn qualify(world: &World) -> Result<(), &'static str> {
    let is_exact = |integrator| {
        matches!(integrator, Integrator::VelocityVerlet | Integrator::Yoshida4 | Integrator::SymplecticEuler)
    };
    if !is_exact(world.def().integrator) {
        return Err("its integrator gains energy in free flight");
    }
    let (num, den) = world.def().time_step.seconds();
    if u64::from(num) * u64::from(RATE) > u64::from(den) {
        return Err("its steps are longer than a thirtieth of a second");
    }
    let takes_only = |kind: &FieldKind| match kind {
        FieldKind::Drag { wind, .. } => *wind == Vec2::ZERO,
        FieldKind::Friction { .. } => true,
        _ => false,
    };
    if !world.fields().all(|(_, field)| takes_only(&field.kind)) {
        return Err("its fields do work");
    }
    if world.colliders().any(|(_, def)| def.material.surface_speed != Fx::ZERO) {
        return Err("it has belts");
    }
    for joint in world.joints().filter(JointRef::is_active) {
        if does_work(&joint.def().kind) {
            return Err("its joints have motors or springs");
        }
        if is_out_of_place(&joint) {
            return Err("its joints are out of place");
        }
    }
    let mut dominance = None;
    for body in world.bodies().filter(|body| body.activity().takes_part()) {
        let velocity = body.velocity_exact();
        let parts = [velocity.x, velocity.y, body.angular_velocity_exact()];
        let is_moving = body.goal().is_some() || parts.iter().any(|part| part.to_bits() != 0);
        match body.kind() {
            BodyKind::Kinematic if is_moving => return Err("its kinematic bodies move"),
            BodyKind::Dynamic if *dominance.get_or_insert(body.dominance()) != body.dominance() => {
                return Err("some of its bodies dominate others");
            }
            _ => {}
        }
    }
    Ok(())
}

/// Returns true for a joint that may do work: by a motor that is no brake, or by a spring, whose stiffness changes with the pose.
fn does_work(kind: &JointKind) -> bool {
    let drives = |motor: &Option<JointMotor>| motor.is_some_and(|motor| motor.speed != Fx::ZERO);
    match kind {
        JointKind::Revolute(Revolute { motor, spring, .. })
        | JointKind::Distance(Distance { motor, spring, .. })
        | JointKind::Prismatic(Prismatic { motor, spring, .. })
        | JointKind::Wheel(Wheel { motor, spring, .. }) => drives(motor) || spring.is_some(),
        JointKind::Weld(Weld { spring }) => spring.is_some(),
        JointKind::Gear(_) | JointKind::Pulley(_) => false,
        _ => true,
    }
}

/// Returns true for a joint that pulls its bodies to where it wants them.
fn is_out_of_place(joint: &JointRef<'_>) -> bool {
    let is_beyond = |position: Fx, limits: Option<JointLimits>| {
        limits.is_some_and(|limits| position < limits.lower - OUT_OF_PLACE || position > limits.upper + OUT_OF_PLACE)
    };
    let is_off = |position: Fx| position.abs() > OUT_OF_PLACE;
    let (length, angle, offset) = (joint.length(), joint.angle(), joint.offset());
    match joint.def().kind {
        JointKind::Revolute(Revolute { limits, ratchet, .. }) => {
            let behind =
                joint.stop().zip(ratchet).map(|(stop, teeth)| if teeth > 0 { stop - angle } else { angle - stop });
            is_off(length) || is_beyond(angle, limits) || behind.is_some_and(|behind| behind > OUT_OF_PLACE)
        }
        JointKind::Weld(_) => is_off(length) || is_off(angle),
        JointKind::Distance(Distance { limits, .. }) => is_beyond(length, limits),
        JointKind::Pulley(pulley) => length > pulley.length + OUT_OF_PLACE,
        JointKind::Prismatic(Prismatic { limits, .. }) => {
            is_beyond(offset.x, limits) || is_off(offset.y) || is_off(angle)
        }
        JointKind::Wheel(Wheel { limits, .. }) => is_beyond(offset.x, limits) || is_off(offset.y),
        _ => is_off(angle),
    }
}

/// Returns true if bodies overlap by more than 5 mm.
///
/// A world lists the contacts that pushed, and of colliders with contact events those that overlapped at the start of its last step. So
/// a copy in which nothing moves makes a step with such colliders; what it refuses stays as it is.
fn overlaps(world: &World) -> bool {
    let mut still = world.clone();
    _ = still.set_gravity(Vec2::ZERO);
    _ = still.set_contact_settings(ContactSettings { push_speed: Fx::ZERO, ..world.def().contacts });
    for body in world.bodies().filter(|body| body.kind() == BodyKind::Dynamic) {
        _ = still.set_velocity(body.id(), Vec2::ZERO);
        _ = still.set_angular_velocity(body.id(), Fx::ZERO);
    }
    for (collider, def) in world.colliders() {
        _ = still.set_collider(collider, ColliderDef { contact_events: true, ..def.clone() });
    }
    still.step();
    still.contacts().any(|contact| contact.points().iter().any(|point| point.separation < -OVERLAP))
}

fn excess(world: &World, bound: FxWide, energy: FxWide) -> Difference {
    Difference {
        tick: world.tick(),
        phase: TickPhase::End,
        owner: Owner::World,
        name: None,
        key: 0,
        field: "energy".to_owned(),
        left: Some(bound.to_string()),
        right: Some(energy.to_string()),
    }
}
