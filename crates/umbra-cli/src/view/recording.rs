//! The data that the page shows of a run, gathered while it goes on.

use std::collections::BTreeMap;

use umbra_physics::{
    Activity, BodyId, BodyKind, BodyRef, ColliderDef, FieldId, ForceField, Fx, JointDef, JointId, TimeStep, World,
};

use super::events::{Events, What};
use super::track::{Sample, Track};
use super::{contacts, drawing, encounters, joints};
use crate::jumps::Jumps;

/// The limits of a page.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Budget {
    /// Bytes of the page, about.
    pub(crate) bytes: usize,
    /// Bodies times ticks: a browser has 48 bytes for each.
    pub(crate) samples: u64,
}

impl Default for Budget {
    /// 20 MB, which a browser makes 150 MB of at most.
    fn default() -> Self {
        Self { bytes: 20_000_000, samples: 3_000_000 }
    }
}

/// Fewer frames than this are not thinned any further.
const FEWEST: u64 = 32;

/// A run on its way to a page. All bodies, inputs and hashes are seen each tick; how bodies move is kept each so many
/// ticks, twice as many whenever the page would be too large.
#[derive(Clone, Debug)]
pub(crate) struct Recording {
    budget: Budget,
    /// The integrator at the start.
    pub(super) integrator: &'static str,
    pub(super) start: u64,
    /// The last tick seen.
    pub(super) last: u64,
    /// Ticks from a frame to the next.
    pub(super) stride: u64,
    /// The state hash of each frame; all but the last are a stride apart.
    pub(super) hashes: Vec<u64>,
    pub(super) clock: Vec<Span>,
    pub(super) lives: Vec<Life>,
    /// The bodies that are there, by slot.
    alive: Vec<Option<usize>>,
    jumps: Jumps,
    pub(super) fields: Vec<Placed>,
    fields_there: BTreeMap<FieldId, (ForceField<Fx>, usize)>,
    /// Joints that are drawn.
    pub(super) joints: Vec<Placed>,
    joints_there: BTreeMap<JointId, usize>,
    /// The joints of the last world, each with its definition, and true if it is broken: what their drawing follows from.
    joint_states: Vec<(JointId, JointDef, bool)>,
    /// Each with what it is drawn as.
    pub(super) shapes: Vec<(Vec<ColliderDef>, serde_json::Value)>,
    shape_numbers: BTreeMap<String, usize>,
    pub(super) events: Events,
    /// The contacts of each frame as bytes; None if they are not recorded.
    pub(super) contacts: Option<Vec<Vec<u8>>>,
}

/// Ticks with the same time step.
#[derive(Clone, Debug)]
pub(super) struct Span {
    pub(super) tick: u64,
    /// The time at that tick, s.
    pub(super) time: (u128, u128),
    pub(super) step: TimeStep,
}

/// A body from when it was added to when it was removed.
#[derive(Clone, Debug)]
pub(super) struct Life {
    pub(super) id: BodyId,
    pub(super) name: String,
    /// The first and the last tick it was seen at.
    pub(super) from: u64,
    pub(super) to: u64,
    /// The frame at which its track begins.
    pub(super) first: u64,
    pub(super) track: Track,
    pub(super) looks: Vec<(u64, Look)>,
    /// The ticks at which it was elsewhere, as a call put it there.
    pub(super) jumps: Vec<u64>,
}

/// The properties of a body that no step changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Look {
    pub(super) kind: BodyKind,
    pub(super) activity: Activity,
    /// An index among the shapes.
    pub(super) shape: Option<usize>,
    pub(super) key: u64,
    pub(super) mass: Option<Fx>,
}

/// A force field or a joint that is drawn, from when it was added, or put in another's place, to when it went.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    pub(super) from: u64,
    /// The last tick it was seen at.
    pub(super) to: u64,
    pub(super) drawing: Option<serde_json::Value>,
}

impl Recording {
    pub(crate) fn new(budget: Budget) -> Self {
        Self {
            budget,
            integrator: "",
            start: 0,
            last: 0,
            stride: 1,
            hashes: Vec::new(),
            clock: Vec::new(),
            lives: Vec::new(),
            alive: Vec::new(),
            jumps: Jumps::default(),
            fields: Vec::new(),
            fields_there: BTreeMap::new(),
            joints: Vec::new(),
            joints_there: BTreeMap::new(),
            joint_states: Vec::new(),
            shapes: Vec::new(),
            shape_numbers: BTreeMap::new(),
            events: Events::default(),
            contacts: None,
        }
    }

    /// Records contacts as well.
    pub(crate) fn with_contacts(self, has_contacts: bool) -> Self {
        Self { contacts: has_contacts.then(Vec::new), ..self }
    }

    /// Takes in the world at its start, and then after each step. `name` is asked once for each body. A recorded hash that
    /// differs from the world's is an event.
    pub(crate) fn see(&mut self, world: &World<Fx>, recorded: Option<u64>, name: impl Fn(BodyId) -> String) {
        let tick = world.tick();
        if self.clock.is_empty() {
            (self.start, self.integrator) = (tick, world.def().integrator.name());
        }
        let is_frame = (tick - self.start) % self.stride == 0;
        self.see_clock(world);
        for body in world.bodies() {
            let life = self.see_body(world, &body, tick, &name);
            if is_frame {
                self.sample(life, &body);
            }
        }
        for body in self.jumps.see(world) {
            if let Some(life) = known_life(&self.alive, &self.lives, body) {
                self.lives[life].jumps.push(tick);
            }
        }
        self.see_gone(tick);
        self.see_fields(world);
        self.see_joints(world);
        for fault in world.last_report().faults {
            if let Some(&Some(life)) = self.alive.get(fault.body.parts().0 as usize) {
                self.events.tell(tick, What::Quarantined, Some(life), fault.cause.to_string());
            }
        }
        self.see_encounters(world);
        let hash = if is_frame || recorded.is_some() { world.state_hash() } else { 0 };
        if let Some(recorded) = recorded.filter(|&recorded| recorded != hash) {
            self.events.diverge(tick, format!("recorded with another state hash, first {recorded:016x}"));
        }
        self.last = tick;
        if is_frame {
            self.hashes.push(hash);
            self.see_contacts(world);
            while self.is_too_much() {
                self.thin();
            }
        }
    }

    /// Notes what is done before the step from this tick to the next, and about what. The same topic again soon after goes on.
    pub(crate) fn input(&mut self, tick: u64, topic: String, text: String) {
        self.events.input(tick, topic, text);
    }

    /// Takes in the last world once more, so that the run's end is a frame.
    pub(crate) fn finish(&mut self, world: &World<Fx>) {
        if (self.last - self.start) % self.stride == 0 {
            return;
        }
        for body in world.bodies() {
            if let Some(&Some(life)) = self.alive.get(body.id().parts().0 as usize) {
                self.sample(life, &body);
            }
        }
        self.hashes.push(world.state_hash());
        self.see_contacts(world);
    }

    /// The encounters of the last step; what was there at the start of the run is not of it.
    fn see_encounters(&mut self, world: &World<Fx>) {
        if world.tick() == self.start {
            return;
        }
        let Self { alive, lives, events, .. } = self;
        let life = |body| known_life(alive, lives, body).or_else(|| lives.iter().rposition(|life| life.id == body));
        encounters::tell(&world.last_report(), events, life);
    }

    fn see_contacts(&mut self, world: &World<Fx>) {
        if let Some(frames) = &mut self.contacts {
            let life = |body| known_life(&self.alive, &self.lives, body);
            frames.push(contacts::frame(world, life));
        }
    }

    fn see_clock(&mut self, world: &World<Fx>) {
        let step = world.def().time_step;
        if self.clock.last().is_some_and(|span| span.step == step) {
            return;
        }
        // What changed the step did so at the tick before; what the time is now has this step in it.
        let (now, (num, den)) = (world.elapsed(), step.seconds());
        let (num, den) = (u128::from(num), u128::from(den));
        let (tick, time) = match self.clock.is_empty() {
            true => (world.tick(), (now.num, now.den)),
            // A ratio that does not fit is for show alone.
            false => {
                let top = now.num.saturating_mul(den).saturating_sub(num.saturating_mul(now.den));
                (self.last, (top, now.den.saturating_mul(den)))
            }
        };
        self.clock.push(Span { tick, time, step });
    }

    /// The life of a body that is there.
    fn see_body(
        &mut self,
        world: &World<Fx>,
        body: &BodyRef<'_>,
        tick: u64,
        name: &impl Fn(BodyId) -> String,
    ) -> usize {
        let id = body.id();
        let slot = id.parts().0 as usize;
        if self.alive.len() <= slot {
            self.alive.resize(slot + 1, None);
        }
        let known = self.alive[slot].filter(|&life| self.lives[life].id == id);
        let life = known.unwrap_or_else(|| {
            if let Some(before) = self.alive[slot] {
                self.events.tell(tick, What::Removed, Some(before), String::new());
            }
            let first = (tick - self.start).div_ceil(self.stride);
            let (name, track, looks) = (name(id), Track::default(), Vec::new());
            self.lives.push(Life { id, name, from: tick, to: tick, first, track, looks, jumps: Vec::new() });
            self.alive[slot] = Some(self.lives.len() - 1);
            if tick > self.start {
                self.events.tell(tick, What::Added, Some(self.lives.len() - 1), String::new());
            }
            self.lives.len() - 1
        });
        self.lives[life].to = tick;
        let shape = self.shape_number(life, world, body);
        let look = Look { kind: body.kind(), activity: body.activity(), shape, key: body.key(), mass: body.mass() };
        let before = self.lives[life].looks.last().map(|(_, look)| *look);
        if before != Some(look) {
            self.lives[life].looks.push((tick, look));
            let what = match (before.map(|before| before.activity), look.activity) {
                (Some(Activity::Awake), Activity::Asleep) => Some(What::Slept),
                (Some(Activity::Asleep), Activity::Awake) => Some(What::Woke),
                (Some(Activity::Quarantined), Activity::Awake | Activity::Asleep) => Some(What::Released),
                (Some(Activity::Disabled), Activity::Awake | Activity::Asleep) => Some(What::Enabled),
                (Some(before), Activity::Disabled) if before != Activity::Disabled => Some(What::Disabled),
                // The report has those that were quarantined, with the cause.
                _ => None,
            };
            if let Some(what) = what {
                self.events.tell(tick, what, Some(life), String::new());
            }
        }
        life
    }

    fn shape_number(&mut self, life: usize, world: &World<Fx>, body: &BodyRef<'_>) -> Option<usize> {
        let colliders = || {
            let colliders_of_body = world.colliders_of(body.id()).into_iter().flatten();
            colliders_of_body.filter_map(|collider| world.collider(collider).ok())
        };
        let before = self.lives[life].looks.last().and_then(|(_, look)| look.shape);
        if before.is_some_and(|before| self.shapes[before].0.iter().eq(colliders())) {
            return before;
        }
        let defs: Vec<ColliderDef> = colliders().cloned().collect();
        let drawn = drawing::outline(body.id(), &defs)?;
        let number = *self.shape_numbers.entry(drawn.to_string()).or_insert_with(|| {
            self.shapes.push((defs, drawn));
            self.shapes.len() - 1
        });
        Some(number)
    }

    fn sample(&mut self, life: usize, body: &BodyRef<'_>) {
        let (at, v) = (body.position(), body.velocity());
        let values: [Fx; 6] = [at.x, at.y, body.angle(), v.x, v.y, body.angular_velocity()];
        self.lives[life].track.push(values.map(Fx::to_bits));
    }

    fn see_gone(&mut self, tick: u64) {
        for slot in 0..self.alive.len() {
            if let Some(life) = self.alive[slot].filter(|&life| self.lives[life].to != tick) {
                self.alive[slot] = None;
                self.events.tell(tick, What::Removed, Some(life), String::new());
            }
        }
    }

    fn see_fields(&mut self, world: &World<Fx>) {
        let (tick, mut gone) = (world.tick(), std::mem::take(&mut self.fields_there));
        for (id, field) in world.fields() {
            let known = gone.remove(&id).filter(|(known, _)| known == field);
            let number = known.map_or_else(
                || {
                    let drawing = drawing::field(field, |body| known_life(&self.alive, &self.lives, body));
                    self.fields.push(Placed { from: tick, to: tick, drawing });
                    self.fields.len() - 1
                },
                |(_, number)| number,
            );
            self.fields[number].to = tick;
            self.fields_there.insert(id, (*field, number));
        }
    }

    fn see_joints(&mut self, world: &World<Fx>) {
        let tick = world.tick();
        let states: Vec<_> = world.joints().map(|joint| (joint.id(), *joint.def(), joint.is_broken())).collect();
        if states != self.joint_states {
            self.joint_states = states;
            let before = std::mem::take(&mut self.joints_there);
            for (id, drawing) in joints::drawings(world, |body| known_life(&self.alive, &self.lives, body)) {
                let drawing = Some(drawing);
                let known = before.get(&id).copied().filter(|&number| self.joints[number].drawing == drawing);
                let number = known.unwrap_or_else(|| {
                    self.joints.push(Placed { from: tick, to: tick, drawing });
                    self.joints.len() - 1
                });
                self.joints_there.insert(id, number);
            }
        }
        for &number in self.joints_there.values() {
            self.joints[number].to = tick;
        }
    }

    fn is_too_much(&self) -> bool {
        if self.hashes.len() as u64 <= FEWEST {
            return false;
        }
        let contacts: usize = self.contacts.iter().flatten().map(Vec::len).sum();
        let (mut bytes, mut samples) = (8 * self.hashes.len() + contacts, 0);
        // What the text takes, about.
        let mut text = 16_000 + 100 * (self.events.told.len() + self.fields.len());
        text += 300 * (self.shapes.len() + self.joints.len());
        for life in &self.lives {
            bytes += life.track.size();
            samples += life.track.count();
            text += 60 + life.name.len() + 40 * life.looks.len() + 8 * life.jumps.len();
        }
        text + bytes / 3 * 4 > self.budget.bytes || samples > self.budget.samples
    }

    /// Keeps every other frame.
    fn thin(&mut self) {
        self.stride *= 2;
        self.hashes = self.hashes.iter().copied().step_by(2).collect();
        if let Some(frames) = &mut self.contacts {
            *frames = std::mem::take(frames).into_iter().step_by(2).collect();
        }
        for life in &mut self.lives {
            let odd = (life.first % 2) as usize;
            let mut track = Track::default();
            life.track.samples().skip(odd).step_by(2).for_each(|sample: Sample| track.push(sample));
            life.track = track;
            life.first = life.first.div_ceil(2);
        }
    }
}

/// The number under which the page knows a body that is there.
fn known_life(alive: &[Option<usize>], lives: &[Life], body: BodyId) -> Option<usize> {
    let life = alive.get(body.parts().0 as usize).copied().flatten()?;
    (lives[life].id == body).then_some(life)
}

#[cfg(test)]
mod tests;
