//! Commands from the bytes of an input: the generator of the oracles, with bytes for choices.

use std::ops::{Deref, DerefMut};
use std::sync::Arc;

use arbitrary::{Arbitrary, Result, Unstructured};
use umbra_oracles::{Choices, Generator, Taste};
use umbra_physics::{
    BodyId, BodyState, ColliderId, Command, Created, CustomForce, CustomForceError, Dependence, FieldId, ForceTorque,
    JointId, Scalar, Vec2, World, WorldDef, fx,
};

/// The bytes of an input. After its end all choices are zero.
pub struct Bytes<'a>(Unstructured<'a>);

impl<'a> Deref for Bytes<'a> {
    type Target = Unstructured<'a>;

    fn deref(&self) -> &Unstructured<'a> {
        &self.0
    }
}

impl DerefMut for Bytes<'_> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.0
    }
}

impl Choices for Bytes<'_> {
    fn draw(&mut self, bits: u32) -> u64 {
        let mut bytes = [0; 8];
        let count = bits.div_ceil(8) as usize;
        // It never fails: what is missing is zero.
        _ = self.0.fill_buffer(&mut bytes[..count]);
        u64::from_le_bytes(bytes) & (u64::MAX >> (64 - bits))
    }
}

/// Writes commands that name what was [made](Author::made).
pub struct Author<'a> {
    pub input: Bytes<'a>,
    pub taste: Taste,
    bodies: Vec<BodyId>,
    fields: Vec<FieldId>,
    colliders: Vec<ColliderId>,
    joints: Vec<JointId>,
}

/// Values at limits and beyond them, as many as commands of a dozen numbers bear.
pub const WILD: Taste = Taste { near: 16, wild: 16, ..Taste::WILD };

impl<'a> Author<'a> {
    /// An author who knows no restraint.
    pub fn new(data: &'a [u8]) -> Self {
        Self::of_taste(data, WILD)
    }

    pub fn of_taste(data: &'a [u8], taste: Taste) -> Self {
        Self {
            input: Bytes(Unstructured::new(data)),
            taste,
            bodies: Vec::new(),
            fields: Vec::new(),
            colliders: Vec::new(),
            joints: Vec::new(),
        }
    }

    pub fn any<T: Arbitrary<'a>>(&mut self) -> Result<T> {
        self.input.arbitrary()
    }

    pub fn generator(&mut self) -> Generator<'_, Bytes<'a>> {
        let generator = Generator::new(&mut self.input, self.taste, &self.bodies, &self.fields);
        generator.with_colliders(&self.colliders).with_joints(&self.joints)
    }

    /// A command of any kind.
    pub fn command(&mut self) -> Command {
        self.generator().command()
    }

    /// The definition of a world, which may be refused.
    pub fn world(&mut self) -> WorldDef {
        self.generator().world()
    }

    /// Takes note of what a command made in a world, for the commands to come.
    pub fn made<S: Scalar>(&mut self, world: &World<S>, created: Created) {
        match created {
            Created::Body(body) => {
                self.bodies.push(body);
                self.colliders.extend(world.colliders_of(body).into_iter().flatten());
            }
            Created::Collider(collider) => self.colliders.push(collider),
            Created::Joint(joint) => self.joints.push(joint),
            Created::ForceField(field) => self.fields.push(field),
            _ => {}
        }
    }
}

/// A custom force that every symmetry of a world leaves as it is: against the velocity, and none from a speed on.
struct Brake;

impl<S: Scalar> CustomForce<S> for Brake {
    fn id(&self) -> u64 {
        0
    }

    fn version(&self) -> u32 {
        1
    }

    fn depends_on(&self) -> Dependence {
        Dependence::Velocity
    }

    fn push(&self, body: &BodyState<S>) -> std::result::Result<ForceTorque<S>, CustomForceError> {
        let limit = S::from_fx(fx!(1000));
        let Vec2 { x, y } = body.velocity;
        if [x, y, body.angular_velocity].iter().any(|v| *v > limit || -*v > limit) {
            return Err(CustomForceError { code: 7 });
        }
        Ok(ForceTorque { force: Vec2::new(-x, -y), torque: -body.angular_velocity })
    }
}

/// A custom force upwards, which is the same everywhere and in a mirror beside it.
struct Lift;

impl<S: Scalar> CustomForce<S> for Lift {
    fn id(&self) -> u64 {
        1
    }

    fn version(&self) -> u32 {
        3
    }

    fn depends_on(&self) -> Dependence {
        Dependence::Nothing
    }

    fn push(&self, body: &BodyState<S>) -> std::result::Result<ForceTorque<S>, CustomForceError> {
        Ok(ForceTorque { force: Vec2::new(S::ZERO, body.mass), torque: S::ZERO })
    }
}

/// The custom forces that worlds here have.
pub fn custom_forces<S: Scalar>() -> [Arc<dyn CustomForce<S>>; 2] {
    [Arc::new(Brake), Arc::new(Lift)]
}

/// A world with these custom forces, or none if its definition is refused.
pub fn world<S: Scalar>(def: WorldDef<S>) -> Option<World<S>> {
    let mut world = World::with_scalar(def).ok()?;
    for force in custom_forces() {
        world.register_custom_force(force).expect("each is registered once");
    }
    Some(world)
}
