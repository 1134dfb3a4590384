//! Bodies that interact with nothing.

use umbra_physics::{
    Attachment, BodyDef, BodyId, BodyKind, ColliderDef, Damping, End, FieldId, FieldKind, Filter, Fx, Mass, Random,
    Shape, SpringConstants, Vec2, World, fx, vec2,
};

/// The largest number of those that come and go.
pub(super) const MOST: usize = 17;

/// A number of moving bodies from which on a step uses several threads. The library asserts that its own threshold is lower.
#[cfg(feature = "parallel")]
const THRONG: usize = 8_200;

/// The first of their keys.
const KEY: u64 = 1 << 63;

/// The category of their colliders, which meet it alone.
const CATEGORY: u32 = 1 << 31;

/// A number of pairs that they do not use up.
pub(super) const PAIRS: u32 = 1 << 12;

/// Bystanders in a world.
pub(super) struct Bystanders {
    random: Random,
    force_groups: u32,
    here: Vec<BodyId>,
    /// The springs between them.
    springs: Vec<FieldId>,
    /// The number of those that never leave.
    for_good: usize,
    /// The number of bystanders that there have ever been.
    ever: usize,
}

impl Bystanders {
    /// Adds `count` bystanders in these groups; `None` if the world takes fewer.
    pub(super) fn enter(world: &mut World, count: usize, force_groups: u32) -> Option<Self> {
        let random = Random::seeded(count as u64);
        let mut bystanders = Self { random, force_groups, here: Vec::new(), springs: Vec::new(), for_good: 0, ever: 0 };
        (0..count).for_each(|_| bystanders.come(world));
        (bystanders.count() == count).then_some(bystanders)
    }

    /// Adds as many as a step needs to use several threads, even if all other bodies fall asleep or leave: these move for ever. `None`
    /// if the world takes fewer.
    #[cfg(feature = "parallel")]
    pub(super) fn throng(world: &mut World) -> Option<Self> {
        let mut bystanders = Self::enter(world, 0, 0)?;
        while bystanders.for_good < THRONG {
            let position = vec2(0, bystanders.ever as i32);
            let def = BodyDef {
                position,
                velocity: vec2(1, 0),
                key: bystanders.key(),
                force_groups: 0,
                ..BodyDef::kinematic()
            };
            world.add_body(def).ok()?;
            bystanders.for_good += 1;
        }
        Some(bystanders)
    }

    /// The number of bodies in the world that are bystanders.
    pub(super) fn count(&self) -> usize {
        self.for_good + self.here.len()
    }

    /// The number of fields in the world that are theirs.
    pub(super) fn field_count(&self) -> usize {
        self.springs.len()
    }

    /// The number of colliders in the world that are theirs.
    pub(super) fn collider_count(&self) -> usize {
        self.here.len()
    }

    /// The key of the next one.
    fn key(&mut self) -> u64 {
        self.ever += 1;
        KEY + self.ever as u64
    }

    /// Lets bystanders come and go, between two ticks.
    pub(super) fn pass(&mut self, world: &mut World) {
        match self.random.below(4) {
            0 if self.here.len() < MOST => self.come(world),
            1 if !self.here.is_empty() => {
                let gone = self.here.swap_remove(self.random.below(self.here.len() as u64) as usize);
                _ = world.remove_body(gone);
                self.springs.retain(|spring| world.field(*spring).is_ok());
            }
            _ => {}
        }
    }

    /// Adds a bystander, of each kind in turn: one that will sleep, a static one, a heavy one, one that leaves the allowed range in its
    /// first step, a kinematic one, one that is fast and spins. A spring ties each to the one before, unless neither can move, and
    /// their colliders overlap.
    fn come(&mut self, world: &mut World) {
        let number = self.ever;
        let position = vec2(50 + number as i32, -3);
        let base = BodyDef { position, force_groups: self.force_groups, key: self.key(), ..BodyDef::dynamic() };
        let def = match number % 6 {
            0 => BodyDef { gravity_scale: Fx::ZERO, ..base },
            1 => BodyDef { kind: BodyKind::Static, ..base },
            2 => BodyDef {
                velocity: vec2(1, 0),
                linear_damping: Some(Damping::NONE),
                mass: Mass::Kilograms(fx!(77)),
                ..base
            },
            3 => BodyDef { position: vec2(1_073_741_823, 0), velocity: vec2(900_000, 0), ..base },
            4 => BodyDef { kind: BodyKind::Kinematic, velocity: vec2(0, 3), ..base },
            _ => {
                let (velocity, angular_velocity) = (vec2(9_000, 0), fx!(50));
                BodyDef {
                    velocity,
                    angular_velocity,
                    angular_damping: Some(Damping::kept_per_second(fx!(0.1))),
                    ..base
                }
            }
        };
        let Ok(disc) = Shape::circle(fx!(0.6)) else { return };
        let filter = Filter { category: CATEGORY, mask: CATEGORY, group: 0 };
        let Ok(body) = world.add_body(def.with_collider(ColliderDef { filter, ..ColliderDef::new(disc) })) else {
            return;
        };
        if let Some(&last) = self.here.last() {
            let spring = SpringConstants { rest: fx!(1), stiffness: fx!(9), damping: fx!(1) };
            let near = Attachment { body, point: Vec2::ZERO };
            self.springs.extend(world.add_field(FieldKind::Spring {
                near,
                far: End::Body(Attachment::centre(last)),
                spring,
            }));
        }
        self.here.push(body);
    }
}
