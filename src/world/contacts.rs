//! Contacts as calls read them.

use super::World;
use crate::collide::{Cores, Pose, collide};
use crate::collider::Collider;
use crate::contact::{ColliderPair, Contact, ContactRecord, MARGIN};
use crate::error::Error;
use crate::scalar::{Accumulator as _, Angle as _, Scalar};
use crate::shape::Geometry;
use crate::slots::BodyId;

impl<S: Scalar> World<S> {
    /// The contacts that carried an impulse at the end of the last step, at the present poses, sorted by the slots of
    /// the colliders. Contacts of colliders with [`contact_events`](crate::ColliderDef::contact_events) are listed also
    /// if they carried an impulse only earlier in the step, or overlapped at its start without one. Contacts whose colliders are apart by
    /// now are left out, whether calls moved them since or they hit each other and flew apart within the step: its events have these.
    ///
    /// A body that has gone over seams of a chain in the step is shown on the segment that it is on now, up to 16 segments farther.
    ///
    /// The list is a function of the state: a restored world has the same.
    pub fn contacts(&self) -> impl Iterator<Item = Contact<S>> {
        self.contacts.iter().filter_map(|record| self.contact(record))
    }

    /// The [contacts](Self::contacts) of a body. *Cost* in proportion to all contacts of the world: to ask for many bodies, go through
    /// [`contacts`](Self::contacts) once.
    ///
    /// # Errors
    /// [`Error::NoSuchBody`].
    ///
    /// ```
    /// use umbra_physics::{BodyDef, Shape, World, WorldDef, fx, vec2};
    ///
    /// let mut world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() })?;
    /// world.add_body(BodyDef::fixed().with_collider(Shape::rectangle(fx!(20), fx!(2))?))?;
    /// let ball = BodyDef { position: vec2(0, fx!(1.5)), ..BodyDef::dynamic().with_collider(Shape::circle(fx!(0.5))?) };
    /// let ball = world.add_body(ball)?;
    /// assert_eq!(world.contacts_of(ball)?.count(), 0);
    /// (0..10).for_each(|_| _ = world.step());
    /// // On the ground: something pushes it upwards.
    /// assert!(world.contacts_of(ball)?.any(|contact| contact.bodies[1] == ball && contact.normal.y > fx!(0.9)));
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn contacts_of(&self, body: BodyId) -> Result<impl Iterator<Item = Contact<S>> + use<'_, S>, Error> {
        self.bodies.find(body)?;
        let is_of = move |slot| self.colliders.at(slot).is_some_and(|collider| collider.body == body);
        let records =
            self.contacts.iter().filter(move |record| record.pair().iter().any(|outline| is_of(outline.slot)));
        Ok(records.filter_map(|record| self.contact(record)))
    }

    /// The sensors with the colliders that overlapped them at the end of the last step, the sensor first; sorted by the slots of the
    /// sensors, then of the others.
    ///
    /// They are state: a restored world has the same. A collider that calls removed or replaced since is not among them.
    ///
    /// ```
    /// use umbra_physics::{BodyDef, ColliderDef, Event, Shape, World, WorldDef, vec2};
    ///
    /// let mut world = World::new(WorldDef::default())?;
    /// let goal = ColliderDef { sensor: true, ..ColliderDef::new(Shape::rectangle(2, 2)?) };
    /// let goal = world.add_body(BodyDef { position: vec2(10, 0), ..BodyDef::fixed().with_collider(goal) })?;
    /// let ball = BodyDef { velocity: vec2(6, 0), ..BodyDef::dynamic().with_collider(Shape::circle(1)?) };
    /// let ball = world.add_body(ball)?;
    /// let enters = |event: &Event| matches!(event, Event::SensorEntered(pair) if pair.bodies == [goal, ball]);
    /// let ticks = (0..120).filter(|_| world.step().into_iter().any(|event| enters(&event)));
    /// assert_eq!(ticks.collect::<Vec<_>>(), [79]); // the ball is at 8, and touches the side of the goal
    /// // It goes through, as if nothing were there.
    /// assert_eq!(world.body(ball)?.position(), vec2(12, 0));
    /// assert_eq!(world.sensor_overlaps().map(|pair| pair.bodies).collect::<Vec<_>>(), [[goal, ball]]);
    /// # Ok::<(), umbra_physics::Error>(())
    /// ```
    pub fn sensor_overlaps(&self) -> impl Iterator<Item = ColliderPair> {
        let pair = |slots| ColliderPair::new(&self.bodies, self.colliders.fixed(), slots);
        self.contacts.overlaps.iter().filter_map(move |overlap| pair(overlap.slots()))
    }

    fn contact(&self, record: &ContactRecord) -> Option<Contact<S>> {
        let pair = record.pair();
        let colliders = self.colliders.fixed();
        let [a, b] = pair.map(|outline| colliders.at(outline.slot));
        let pair_of_colliders = [a?, b?];
        let motion = &self.bodies.columns.motion;
        let pose = |collider: &Collider| {
            let dense = self.bodies.find(collider.body).ok()?;
            let position = motion.position.get(dense).map(|part| part.to_fixed().value());
            Some(Pose::new(position, motion.angle[dense].to_turn()))
        };
        let [first, second] = pair_of_colliders;
        let poses = [pose(first)?, pose(second)?];
        let side = pair_of_colliders.iter().position(|collider| collider.def.shape.is_chain());
        let touch = |parts: [u32; 2]| {
            let outlines = [first.outline(parts[0]), second.outline(parts[1])];
            let [(a, pose_a), (b, pose_b)] = [(&outlines[0].outline, &poses[0]), (&outlines[1].outline, &poses[1])];
            let manifold = collide(a, pose_a, b, pose_b, MARGIN)?;
            let manifold_before = record.manifold_before(&manifold, |corners| {
                // A segment pushes to one side, and as its neighbours leave it.
                if side.is_some() {
                    return None;
                }
                let mut cores = Cores::default();
                let pair = [cores.push(a, pose_a), cores.push(b, pose_b)];
                cores.between_edges(pair, manifold.normal, corners, MARGIN.into())
            });
            Some((parts, manifold_before.unwrap_or(manifold)))
        };
        let parts = pair.map(|outline| outline.part);
        let (parts, manifold) = match (touch(parts), side) {
            (Some(touched), _) => touched,
            (None, Some(side)) => nearest_segment(pair_of_colliders[side], side, parts, touch)?,
            (None, None) => return None,
        };
        let handles = (pair.map(|outline| colliders.id(outline.slot)), pair_of_colliders.map(|collider| collider.body));
        let radii = [0, 1].map(|side| pair_of_colliders[side].outline(parts[side]).outline.radius());
        Some(Contact::new(record, handles, parts, radii, poses[0].position(), &manifold))
    }
}

/// The number of segments to each side of one that a contact is looked for on.
const SEGMENTS: u32 = 16;

/// The contact with the segment of a chain that is next to one in the chain: a body may have gone over seams in the step.
fn nearest_segment<T>(
    chain: &Collider,
    side: usize,
    parts: [u32; 2],
    touch: impl Fn([u32; 2]) -> Option<([u32; 2], T)>,
) -> Option<([u32; 2], T)> {
    let count = chain.def.shape.outlines().len() as u32;
    let is_closed = matches!(chain.def.shape.geometry(), Geometry::Chain { closed: true, .. });
    let at = |part: Option<u32>| {
        let part = part.filter(|part| is_closed || *part < count)?;
        let mut parts = parts;
        parts[side] = part % count;
        touch(parts)
    };
    let part = parts[side];
    (1..=SEGMENTS.min(count)).find_map(|way| {
        let before = if part < way && is_closed { Some(part + count - way) } else { part.checked_sub(way) };
        at(Some(part + way)).or_else(|| at(before))
    })
}
