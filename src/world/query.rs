//! Queries: bodies by handle, by key, and in order; worlds and bodies as text.

use core::fmt;

use super::{BodyRef, World};
use crate::body::InOrder;
use crate::error::Error;
use crate::fx::Fx;
use crate::math::Elapsed;
use crate::scalar::Scalar;
use crate::slots::BodyId;

impl<S: Scalar> World<S> {
    /// A read-only view of a body.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`].
    pub fn body(&self, body: BodyId) -> Result<BodyRef<'_, S>, Error> {
        Ok(BodyRef { world: self, dense: self.bodies.find(body)? })
    }

    /// The bodies in the order of their slots, as `for body in &world` has them.
    pub fn bodies(&self) -> BodyIter<'_, S> {
        BodyIter { world: self, indices: self.bodies.in_order() }
    }

    /// The first body by slot with this [key](BodyRef::key). The call looks through all bodies: keep the handle if you need it
    /// often.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let [red, _, green] = [1, 2, 1].map(|key| world.add_body(BodyDef { key, ..BodyDef::dynamic() }));
    /// let [red, green] = [red?, green?];
    /// assert_eq!(world.body_with_key(1).map(|body| body.id()), Some(red));
    /// assert!(world.bodies_with_key(1).map(|body| body.id()).eq([red, green]));
    /// assert!(world.body_with_key(3).is_none());
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    #[must_use]
    pub fn body_with_key(&self, key: u64) -> Option<BodyRef<'_, S>> {
        self.bodies_with_key(key).next()
    }

    /// The bodies with this [key](BodyRef::key), in the order of their slots. The call looks through all bodies.
    pub fn bodies_with_key(&self, key: u64) -> impl Iterator<Item = BodyRef<'_, S>> {
        self.bodies().filter(move |body| body.key() == key)
    }

    /// The number of bodies.
    #[must_use]
    pub fn body_count(&self) -> usize {
        self.bodies.len()
    }

    /// The number of bodies that a step moves: not static, asleep, quarantined or disabled.
    #[must_use]
    pub fn moving_count(&self) -> usize {
        self.bodies.moving()
    }

    /// The time that this world's steps spent in their parts, and counts of what they did. A clone starts from zero; `clone_from` goes on
    /// counting.
    #[cfg(feature = "timers")]
    #[must_use]
    pub fn timers(&self) -> crate::timers::Timers {
        self.workspace.timers
    }

    /// The simulated time, an exact ratio in seconds, also after changes of the time step.
    #[must_use]
    pub fn elapsed(&self) -> Elapsed {
        // A change of the time step makes sure that the ratio fits for 2^64 steps more.
        self.counted.0.plus(self.tick - self.counted.1, self.def.time_step).unwrap_or(self.counted.0)
    }
}

/// An iterator over the bodies of a world in the order of their slots.
///
/// ```
/// use umbra_physics::{BodyDef, BodyId, BodyIter, World, WorldDef, fx, vec2};
///
/// let mut world = World::new(WorldDef::default())?;
/// for x in [-3, 5, -1] {
///     world.add_body(BodyDef { position: vec2(x, 0), ..BodyDef::default() })?;
/// }
/// let mut left = 0;
/// for body in &world {
///     left += i32::from(body.position().x < fx!(0));
/// }
/// assert_eq!(left, 2);
/// // Handles outlive the borrow: collect them to change the world meanwhile.
/// let bodies: BodyIter<'_> = world.bodies();
/// let all: Vec<BodyId> = bodies.map(|body| body.id()).collect();
/// for body in all {
///     world.remove_body(body)?;
/// }
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct BodyIter<'a, S: Scalar = Fx> {
    world: &'a World<S>,
    indices: InOrder<'a>,
}

impl<'a, S: Scalar> Iterator for BodyIter<'a, S> {
    type Item = BodyRef<'a, S>;

    fn next(&mut self) -> Option<BodyRef<'a, S>> {
        Some(BodyRef { world: self.world, dense: self.indices.next()? })
    }

    fn fold<B, F: FnMut(B, BodyRef<'a, S>) -> B>(self, init: B, mut f: F) -> B {
        self.indices.fold(init, |folded, dense| f(folded, BodyRef { world: self.world, dense }))
    }
}

impl<'a, S: Scalar> IntoIterator for &'a World<S> {
    type Item = BodyRef<'a, S>;
    type IntoIter = BodyIter<'a, S>;

    fn into_iter(self) -> BodyIter<'a, S> {
        self.bodies()
    }
}

impl<S: Scalar> fmt::Debug for World<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("World")
            .field("def", &self.def)
            .field("tick", &self.tick)
            .field("bodies", &self.bodies.len())
            .finish_non_exhaustive()
    }
}

impl<S: Scalar> fmt::Debug for BodyRef<'_, S> {
    /// Writes the handle, the kind and the state of the body, with exact decimals.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("BodyRef")
            .field("id", &self.id())
            .field("kind", &self.kind())
            .field("activity", &self.activity())
            .field("position", &self.position())
            .field("angle", &self.angle())
            .field("velocity", &self.velocity())
            .field("angular_velocity", &self.angular_velocity())
            .field("mass", &self.mass())
            .field("inertia", &self.inertia())
            .finish_non_exhaustive()
    }
}
