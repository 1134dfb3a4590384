//! The checks themselves, one for each oracle.

#[cfg(feature = "parallel")]
use std::cell::Cell;
use std::collections::BTreeMap;
use std::sync::Arc;

use super::bystanders::{Bystanders, MOST};
use super::drivers::{Asking, Detours, Inspector, Noting, Pairing, Seen, Undoing, unlike};
use super::energy::EnergyBound;
use super::game::{ByTick, Course, Likeness, Subject};
use super::{Handles, Oracle, Verdict, Violation};
use umbra_physics::{
    BodyId, Created, CustomForce, Difference, FieldId, ForceField, Owner, Random, RecordOptions, Recorder, Replay,
    Snapshot, Stepper, Symmetry, World,
};

/// A run that is judged.
pub(super) struct Trial<'a, S: Subject> {
    oracle: Oracle,
    subject: &'a S,
    course: &'a Course<S::Input>,
    inputs: ByTick<S::Input>,
}

type Judged = Result<Verdict, Box<Violation>>;

const fn inapplicable(why: &'static str) -> Judged {
    Ok(Verdict::Inapplicable { why })
}

const REFUSED: &str = "the world is refused";

/// A match on its way.
struct Match<S: Subject> {
    game: S::Match,
    world: World,
}

impl<'a, S: Subject> Trial<'a, S> {
    pub(super) fn new(oracle: Oracle, subject: &'a S, course: &'a Course<S::Input>) -> Self {
        Self { oracle, subject, course, inputs: course.by_tick() }
    }

    pub(super) fn judge(&self) -> Judged {
        match self.oracle {
            Oracle::Repeat => self.beside(&self.inputs, Likeness::State, "a second match", &mut ()),
            Oracle::Refusal => {
                self.beside(&self.inputs, Likeness::State, "a match that asks first", &mut Asking::default())
            }
            Oracle::Record => self.record(),
            Oracle::Restore => self.restore(),
            Oracle::Order => self.order(),
            Oracle::Bystanders => self.bystanders(),
            Oracle::Mirror => self.images(Symmetry::mirrors),
            Oracle::Turn => self.images(|symmetry| !symmetry.mirrors() && !symmetry.is_shift()),
            Oracle::Shift => self.images(Symmetry::is_shift),
            Oracle::Reverse => {
                self.beside(&self.inputs, Likeness::State, "a match with each step undone", &mut Undoing::default())
            }
            Oracle::Paths => {
                self.beside(&self.inputs, Likeness::State, "a match by other ways", &mut Detours::default())
            }
            Oracle::Threads => self.threads(),
            Oracle::Energy => self.energy(),
        }
    }

    fn begin(&self) -> Option<Match<S>> {
        let (game, world) = self.subject.begin()?;
        Some(Match { game, world })
    }

    fn inputs_of(inputs: &ByTick<S::Input>, tick: u64) -> &[S::Input] {
        inputs.get(&tick).map_or(&[], |inputs| inputs)
    }

    fn tick(&self, run: &mut Match<S>, tick: u64, driver: &mut dyn Stepper) {
        self.subject.tick(&mut run.game, &mut run.world, Self::inputs_of(&self.inputs, tick), driver);
    }

    fn violation(&self, tick: u64, fault: Seen) -> Box<Violation> {
        let Seen { beside, difference } = fault;
        Box::new(Violation { oracle: self.oracle, tick, beside, difference })
    }

    /// Turns a fault that was seen into a violation.
    fn clear(&self, tick: u64, fault: Option<Seen>) -> Result<(), Box<Violation>> {
        fault.map_or(Ok(()), |fault| Err(self.violation(tick, fault)))
    }

    /// Two matches side by side, the second with its own inputs and driver.
    fn beside<D: Inspector>(
        &self,
        inputs: &ByTick<S::Input>,
        likeness: Likeness,
        beside: &'static str,
        driver: &mut D,
    ) -> Judged {
        let (Some(mut run), Some(mut twin)) = (self.begin(), self.begin()) else {
            return inapplicable(REFUSED);
        };
        let compare = |run: &World, twin: &World| match likeness {
            Likeness::State => unlike(beside, run, twin),
            Likeness::Motion => moves_unlike(beside, run, twin),
        };
        self.clear(0, compare(&run.world, &twin.world))?;
        for tick in 0..self.course.ticks {
            self.tick(&mut run, tick, &mut ());
            self.subject.tick(&mut twin.game, &mut twin.world, Self::inputs_of(inputs, tick), driver);
            self.clear(tick, driver.seen())?;
            self.clear(tick, compare(&run.world, &twin.world))?;
        }
        driver.idle().map_or_else(|| self.held(), inapplicable)
    }

    /// The verdict on a run that was compared after every tick.
    fn held(&self) -> Judged {
        if self.course.ticks == 0 { inapplicable("the run has no ticks") } else { Ok(Verdict::Held) }
    }

    fn record(&self) -> Judged {
        let Some(mut run) = self.begin() else { return inapplicable(REFUSED) };
        let file = record(self.subject, self.course);
        let replay = Replay::from_bytes(&file, &custom_forces(&run.world));
        let Ok(replay) = replay else {
            return Err(self.violation(0, Seen { beside: "a recording that cannot be read", difference: None }));
        };
        let mut playback = replay.play();
        for tick in 0..self.course.ticks {
            self.tick(&mut run, tick, &mut ());
            // Whether it goes as recorded is seen in the worlds as well, and there in what.
            let played = playback.step();
            self.clear(tick, unlike("its recording, played", &run.world, playback.world()))?;
            if !matches!(played, Ok(true)) {
                return Err(self.violation(tick, Seen { beside: "a recording that ends too soon", difference: None }));
            }
        }
        self.held()
    }

    fn restore(&self) -> Judged {
        let Some(mut run) = self.begin() else { return inapplicable(REFUSED) };
        let mut has_compared = self.course.ticks == 0;
        for tick in 0..self.course.ticks {
            let snapshot = run.world.snapshot();
            let read = Snapshot::from_bytes(&snapshot.to_bytes(), &custom_forces(&run.world));
            let Ok(read) = read else {
                return Err(self.violation(tick, Seen { beside: "a snapshot that cannot be read", difference: None }));
            };
            let mut copies = Vec::new();
            for (beside, snapshot) in
                [("a new match on a snapshot", &snapshot), ("a new match on a snapshot in bytes", &read)]
            {
                let Some(mut copy) = self.begin() else { continue };
                copy.world.restore(snapshot);
                self.tick(&mut copy, tick, &mut ());
                copies.push((beside, copy.world));
            }
            self.tick(&mut run, tick, &mut ());
            for (beside, copy) in copies {
                self.clear(tick, unlike(beside, &run.world, &copy))?;
                has_compared = true;
            }
        }
        if has_compared { self.held() } else { inapplicable("no match goes on from a snapshot") }
    }

    fn order(&self) -> Judged {
        let reversed: &mut dyn FnMut(&mut [usize]) = &mut |places: &mut [usize]| places.reverse();
        let shuffled: &mut dyn FnMut(&mut [usize]) =
            &mut |places: &mut [usize]| Random::seeded(places.len() as u64).shuffle(places);
        let mut verdict = Verdict::Inapplicable { why: "there is but one order" };
        for turn in [reversed, shuffled] {
            let mut turned = false;
            let (course, likeness) = self.subject.reordered(self.course, &mut |places| {
                turned |= places.len() > 1;
                turn(places);
            });
            if turned {
                verdict = self.beside(&course.by_tick(), likeness, "a match in another order", &mut ())?;
            }
        }
        Ok(verdict)
    }

    fn images(&self, is_meant: impl Fn(&Symmetry) -> bool) -> Judged {
        let mut symmetries = self.subject.symmetries();
        symmetries.retain(is_meant);
        if symmetries.is_empty() {
            return inapplicable("it has no such symmetry");
        }
        let mut has_compared = false;
        for symmetry in symmetries {
            has_compared |= self.image(&symmetry)?;
        }
        if has_compared { Ok(Verdict::Held) } else { inapplicable("the start or the first inputs have no image") }
    }

    /// Returns whether there was anything to compare.
    fn image(&self, symmetry: &Symmetry) -> Result<bool, Box<Violation>> {
        let (Some(mut run), Some(mut twin)) = (self.begin(), self.begin()) else { return Ok(false) };
        let Some(world) = symmetry.world(&run.world) else { return Ok(false) };
        twin.world = world;
        for tick in 0..self.course.ticks {
            let images = Self::inputs_of(&self.inputs, tick).iter().map(|input| self.subject.image(input, symmetry));
            let Some(images) = images.collect::<Option<Vec<S::Input>>>() else { return Ok(tick > 0) };
            self.tick(&mut run, tick, &mut ());
            self.subject.tick(&mut twin.game, &mut twin.world, &images, &mut ());
            let Some(mut image) = symmetry.world(&run.world) else { return Ok(tick > 0) };
            // The game's own, and mirrored only as it sees fit.
            *image.random_mut() = *twin.world.random();
            // A world holds it already: it is not too long.
            _ = image.set_blob(twin.world.blob());
            self.clear(tick, unlike(symmetry.name(), &image, &twin.world))?;
        }
        Ok(self.course.ticks > 0)
    }

    fn bystanders(&self) -> Judged {
        let force_groups = self.subject.bystander_groups();
        let mut verdict = Verdict::Held;
        for count in [1, 6, MOST] {
            let enter = |world: &mut World| Bystanders::enter(world, count, force_groups);
            // It held if it did among each number of them.
            verdict = verdict.max(self.among("a match with bystanders", enter, || ())?);
        }
        Ok(verdict)
    }

    #[cfg(feature = "parallel")]
    fn threads(&self) -> Judged {
        let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(2).build() else {
            return inapplicable("there are no threads");
        };
        let has_shared = Cell::new(false);
        let driver = || super::drivers::OnThreads { pool: &pool, has_shared: &has_shared };
        match self.among("a match on two threads", Bystanders::throng, driver)? {
            Verdict::Held if !has_shared.get() => inapplicable("under PublishedVerlet a step uses one thread"),
            verdict => Ok(verdict),
        }
    }

    #[cfg(not(feature = "parallel"))]
    #[allow(clippy::unused_self, reason = "with threads it needs it")]
    fn threads(&self) -> Judged {
        inapplicable("the feature `parallel` is off")
    }

    fn energy(&self) -> Judged {
        let Some(mut run) = self.begin() else { return inapplicable(REFUSED) };
        let mut driver = EnergyBound::default();
        for tick in 0..self.course.ticks {
            self.tick(&mut run, tick, &mut driver);
            self.clear(tick, driver.seen())?;
        }
        driver.idle().map_or_else(|| self.held(), inapplicable)
    }

    /// A match beside one with bystanders in it.
    fn among<D: Stepper>(
        &self,
        beside: &'static str,
        enter: impl FnOnce(&mut World) -> Option<Bystanders>,
        driver: impl Fn() -> D,
    ) -> Judged {
        let (Some(mut run), Some(mut twin)) = (self.begin(), self.begin()) else {
            return inapplicable(REFUSED);
        };
        let mut handles = Handles::default();
        let bodies: Vec<BodyId> = run.world.bodies().map(|body| body.id()).collect();
        bodies.into_iter().for_each(|body| handles.pair(Created::Body(body), Created::Body(body)));
        run.world.fields().for_each(|(field, _)| handles.pair(Created::ForceField(field), Created::ForceField(field)));
        run.world.colliders().for_each(|(id, _)| handles.pair(Created::Collider(id), Created::Collider(id)));
        run.world.joints().for_each(|joint| handles.pair(Created::Joint(joint.id()), Created::Joint(joint.id())));
        let Some(mut bystanders) = enter(&mut twin.world) else {
            return inapplicable("the world has no room for bystanders");
        };
        for tick in 0..self.course.ticks {
            let inputs = Self::inputs_of(&self.inputs, tick);
            let mut noting = Noting::default();
            self.subject.tick(&mut run.game, &mut run.world, inputs, &mut noting);
            // Those in commands are renamed as they come, as they may be of this very tick.
            let renamed =
                |input| if S::IS_COMMANDS { S::Input::clone(input) } else { self.subject.renamed(input, &handles) };
            let inputs: Vec<S::Input> = inputs.iter().map(renamed).collect();
            let mut pairing = Pairing {
                handles: &mut handles,
                made: noting.made.into_iter(),
                translates: S::IS_COMMANDS,
                inner: driver(),
            };
            self.subject.tick(&mut twin.game, &mut twin.world, &inputs, &mut pairing);
            if run.world.bodies().any(|body| !handles.knows(body.id())) {
                return inapplicable("a body was added past the driver");
            }
            if run.world.fields().any(|(field, _)| !handles.knows_field(field)) {
                return inapplicable("a field was added past the driver");
            }
            if run.world.colliders().any(|(collider, _)| !handles.knows_collider(collider)) {
                return inapplicable("a collider was added past the driver");
            }
            if run.world.joints().any(|joint| !handles.knows_joint(joint.id())) {
                return inapplicable("a joint was added past the driver");
            }
            if run.world.def().contacts.max_pairs < super::bystanders::PAIRS {
                return inapplicable("the world has no room for pairs of bystanders");
            }
            self.clear(tick, self.disturbed(beside, &run.world, &twin.world, &bystanders, &handles))?;
            bystanders.pass(&mut twin.world);
        }
        self.held()
    }

    /// Compares the bodies and fields of a run with those of one among bystanders.
    fn disturbed(
        &self,
        beside: &'static str,
        run: &World,
        twin: &World,
        bystanders: &Bystanders,
        handles: &Handles,
    ) -> Option<Seen> {
        for body in run.bodies() {
            let counterpart = twin.body(handles.body(body.id()));
            if counterpart.is_ok_and(|counterpart| counterpart.physics_hash() == body.physics_hash()) {
                continue;
            }
            return Some(Seen {
                beside,
                difference: counterpart.ok().and_then(|counterpart| body.first_difference(&counterpart)),
            });
        }
        for (id, field) in run.fields() {
            let meant = field.map_bodies(|body| Some(handles.body(body))).unwrap_or(*field);
            let counterpart = handles.field(id);
            if twin.field(counterpart) != Ok(&meant) {
                return Some(Seen { beside, difference: field_difference(id, meant, twin, counterpart) });
            }
        }
        for (id, def) in run.colliders() {
            if twin.collider(handles.collider(id)) != Ok(def) {
                return Some(Seen { beside, difference: None });
            }
        }
        let is_same = twin.body_count() == run.body_count() + bystanders.count()
            && twin.fields().count() == run.fields().count() + bystanders.field_count()
            && twin.collider_count() == run.collider_count() + bystanders.collider_count()
            && (run.def(), run.random(), run.blob()) == (twin.def(), twin.random(), twin.blob());
        (!is_same).then_some(Seen { beside, difference: None })
    }
}

/// The first value in which the field of a handle in a world is not the one that is meant; `None` if the world has none there.
fn field_difference(id: FieldId, meant: ForceField, world: &World, field: FieldId) -> Option<Difference> {
    let mut expected = world.clone();
    expected.set_field(field, meant).ok()?;
    let is_of_it = |difference: &Difference| difference.owner == Owner::ForceField(field);
    let difference = expected.differences(world).into_iter().find(is_of_it)?;
    Some(Difference { owner: Owner::ForceField(id), ..difference })
}

/// The custom forces that may act in a world.
fn custom_forces(world: &World) -> Vec<Arc<dyn CustomForce>> {
    world.custom_forces().cloned().collect()
}

/// A match as a replay: nothing if its world is refused.
pub(super) fn record<S: Subject>(subject: &S, course: &Course<S::Input>) -> Vec<u8> {
    let Some((mut game, mut world)) = subject.begin() else { return Vec::new() };
    let mut recorder = Recorder::new(&world, RecordOptions::default());
    let inputs = course.by_tick();
    for tick in 0..course.ticks {
        let inputs = inputs.get(&tick).map_or(&[][..], |inputs| inputs);
        subject.tick(&mut game, &mut world, inputs, &mut recorder);
    }
    recorder.finish(&world)
}

/// Compares the bodies of two worlds by their keys.
fn moves_unlike(beside: &'static str, left: &World, right: &World) -> Option<Seen> {
    if left.physics_hash() == right.physics_hash() {
        return None;
    }
    // Bodies that the other has as well are put aside; of the rest, those of one key belong together.
    let digests = |world: &World| -> BTreeMap<(u64, u64), BodyId> {
        world.bodies().map(|body| ((body.key(), body.physics_hash()), body.id())).collect()
    };
    let (mut left_digests, mut right_digests) = (digests(left), digests(right));
    let both: Vec<(u64, u64)> =
        left_digests.keys().filter(|digest| right_digests.contains_key(digest)).copied().collect();
    for digest in both {
        left_digests.remove(&digest);
        right_digests.remove(&digest);
    }
    let difference: Option<Difference> = left_digests.iter().find_map(|((key, _), body)| {
        let (_, right_body) = right_digests.iter().find(|((right_key, _), _)| right_key == key)?;
        left.body(*body).ok()?.first_difference(&right.body(*right_body).ok()?)
    });
    Some(Seen { beside, difference })
}
