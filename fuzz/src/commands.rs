//! Any commands on any world, held to one promise an input: a second run that has to go the same way.
//!
//! The first byte of an input says which promise and how long a run, the second which values, whether bodies lie in a [pile](super::pile)
//! at the start and for how many ticks they fall together before the second run begins. Then come the world's definition, the pile, and
//! commands with the steps after each. After the last command the world goes on for a while.

use arbitrary::Result;
use umbra_oracles::{Taste, nears_sleeper};
use umbra_physics::scalar::{Accumulator, Angle};
use umbra_physics::{
    Activity, AppliedForce, BodyKind, BodyRef, Cause, ColliderDef, Command, ContactSettings, FieldKind, Filter,
    ForceField, Fx, Snapshot, StepReport, Symmetry, Vec2, World, WorldDef, fx,
};

use super::author::{self, Author, WILD};
use super::pile::pile;
use super::tally;

/// The target.
pub fn run(data: &[u8]) {
    if let [promise, taste, rest @ ..] = data {
        let length = if *promise < 240 { SHORT } else { LONG };
        let fall = (taste / 4 % 4 != 0).then_some(usize::from(taste / 16 % 4) * length.fall);
        let taste =
            [Taste { custom_forces: 3, ..Taste::FAIR }, Taste { wild: 0, ..WILD }, WILD, WILD][usize::from(taste % 4)];
        _ = play(*promise, &length, Author::of_taste(rest, taste), fall);
    }
}

/// The length of a run: what breaks breaks early, but not at once.
struct Length {
    commands: usize,
    fewest_steps: usize,
    most_steps: usize,
    /// A third of the most ticks for which a pile falls together.
    fall: usize,
}

/// The length of 15 runs in 16, and of the others.
const SHORT: Length = Length { commands: 12, fewest_steps: 8, most_steps: 12, fall: 2 };
const LONG: Length = Length { commands: 32, fewest_steps: 20, most_steps: 48, fall: 4 };
/// Runs are compared after each so many steps: a comparison costs as much as several steps.
const EVERY: usize = 4;

/// `fall` is the number of ticks for which a pile falls together first; `None` for a world without one.
fn play(promise: u8, length: &Length, mut author: Author<'_>, fall: Option<usize>) -> Result<()> {
    let promise = Promise::new(promise, &mut author)?;
    let def = author.world();
    let mut world = author::world(def).unwrap_or_else(|| {
        assert!(def.check().is_err(), "{def:?}");
        author::world(WorldDef::default()).expect("the usual definition is fair")
    });
    if fall.is_some() {
        pile(&mut author, &mut world)?;
    }
    if matches!(promise, Promise::Sleepless) {
        // Then bodies sleep only where a step would change nothing.
        let contacts = ContactSettings { sleep_speed: Fx::ZERO, ..world.def().contacts };
        world.set_contact_settings(contacts).expect("no speed is a fair one");
    }
    let mut steps = fall.unwrap_or_default();
    for _ in 0..steps {
        world.step();
        tally::count(&world);
    }
    let Some(mut second) = Second::new(promise, &world) else { return Ok(()) };
    'commands: for _ in 0..length.commands {
        if author.input.is_empty() {
            break;
        }
        let command = author.command();
        // Where no body ever sleeps, none is put to sleep.
        if !matches!((promise, &command), (Promise::Sleepless, Command::Sleep(_))) {
            second.execute(&mut world, &mut author, &command);
        }
        for _ in 0..author.any::<u8>()? % 4 {
            if steps == length.most_steps {
                break 'commands;
            }
            second.step(&mut world, steps);
            steps += 1;
        }
    }
    // The last step is one that is compared.
    while steps < length.fewest_steps || steps % EVERY != 0 {
        second.step(&mut world, steps);
        steps += 1;
    }
    second.finish(&world);
    Ok(())
}

/// A promise that a run is held to.
#[derive(Clone, Copy)]
enum Promise {
    /// A world that was written to bytes and read has the same future.
    Restored,
    /// The motion is the same where no body ever sleeps.
    Sleepless,
    /// The image of a run under a symmetry is a run: the images of commands lead to the image of the world.
    Image(Symmetry),
    /// A step that is traced, in which all bodies go stage by stage, leads to the same state.
    Traced,
    /// A body by itself moves as it does among the others.
    Preview,
    /// A step undone leads back to the bit, or changes nothing.
    Reverse,
}

impl Promise {
    fn new(number: u8, author: &mut Author<'_>) -> Result<Self> {
        Ok(match number % 10 {
            0 => Self::Restored,
            1 => Self::Sleepless,
            2 | 3 => Self::Traced,
            4 => Self::Preview,
            5 => Self::Reverse,
            // The custom forces are the same in a mirror beside the world, and where it is shifted.
            6 => Self::Image(Symmetry::MIRROR),
            7 => Self::Image(Symmetry::MIRROR.about(shift(author)?).unwrap_or(Symmetry::MIRROR)),
            8 => Self::Image(Symmetry::shift(shift(author)?).unwrap_or(Symmetry::MIRROR)),
            _ => {
                author.taste.custom_forces = author.taste.custom_forces.min(1);
                let turns = [Symmetry::FLIP, Symmetry::DIAGONAL, Symmetry::TURN];
                let turn = turns[usize::from(author.any::<u8>()? % 3)];
                Self::Image(turn.about(shift(author)?).unwrap_or(turn))
            }
        })
    }
}

impl Promise {
    /// Asserts that the second run is as promised; false where the promise says nothing about it any more.
    fn is_kept(self, world: &World, second: &World) -> bool {
        match self {
            Self::Sleepless if world.def().contacts.sleep_speed > Fx::ZERO => return false,
            Self::Sleepless => {
                tally::count_sleepers(world);
                assert_moved_alike(world, second);
            }
            Self::Image(symmetry) => return is_image(&symmetry, world, second),
            _ => assert_eq!(second.state_hash(), world.state_hash(), "read from bytes"),
        }
        true
    }
}

/// An even number of ulps in each coordinate, less than 2^24 m.
fn shift(author: &mut Author<'_>) -> Result<Vec2> {
    let mut part = || Ok(Fx::from_bits(2 * (author.any::<i64>()? >> (9 + author.any::<u8>()? % 50))));
    Ok(Vec2::new(part()?, part()?))
}

/// A world through the bytes of a snapshot.
fn reread(world: &World) -> World {
    let bytes = world.snapshot().to_bytes();
    let read =
        Snapshot::from_bytes(&bytes, &author::custom_forces()).unwrap_or_else(|error| panic!("its own bytes: {error}"));
    assert_eq!(read.to_bytes(), bytes);
    let read = read.into_world();
    assert_eq!(read.state_hash(), world.state_hash());
    read
}

/// A copy of a world in which no body sleeps.
fn sleepless(world: &World) -> World {
    let mut world = world.clone();
    world.set_sleep_after(None).expect("never is a fair answer");
    world
}

/// A second run that a promise compares with the first.
struct Second {
    promise: Promise,
    /// The world of the second run; `None` once the promise says nothing about it any more.
    world: Option<World>,
    /// The number of commands that were executed.
    commands: usize,
}

impl Second {
    fn new(promise: Promise, world: &World) -> Option<Self> {
        let second = match promise {
            Promise::Restored => Some(reread(world)),
            Promise::Sleepless => Some(sleepless(world)),
            Promise::Image(symmetry) => Some(image(&symmetry, world)?),
            Promise::Traced | Promise::Preview | Promise::Reverse => None,
        };
        Some(Self { promise, world: second, commands: 0 })
    }

    fn execute(&mut self, world: &mut World, author: &mut Author<'_>, command: &Command) {
        assert_eq!(Command::from_bytes(&command.to_bytes()).as_ref(), Ok(command), "its own bytes");
        let expected = world.check(command).err();
        let before = expected.map(|_| world.state_hash());
        let counterpart = self.counterpart(world, command);
        let done = world.execute(command);
        assert_eq!(done.err(), expected, "what was foreseen: {command:?}");
        if let Some(before) = before {
            assert_eq!(world.state_hash(), before, "refused, and yet it changed the world: {command:?}");
        }
        match (&mut self.world, counterpart) {
            (Some(second), Counterpart::Is(counterpart_command)) => {
                assert_eq!(second.execute(&counterpart_command), done, "{command:?}")
            }
            (_, Counterpart::Nothing) => {}
            _ => self.world = None,
        }
        done.into_iter().for_each(|created| author.made(world, created));
        self.commands += 1;
        if matches!(self.promise, Promise::Restored) && self.commands % 3 == 0 {
            self.world = Some(reread(world));
        }
    }

    /// The command in the second run.
    fn counterpart(&self, world: &World, command: &Command) -> Counterpart {
        match (self.promise, command) {
            (Promise::Sleepless, Command::SetSleepAfter(_)) => Counterpart::Nothing,
            // A sleeping body does not feel what does not wake it.
            (Promise::Sleepless, Command::Apply { body, options, .. })
                if !options.wake && world.body(*body).is_ok_and(|body| body.activity() == Activity::Asleep) =>
            {
                Counterpart::Nothing
            }
            (Promise::Image(symmetry), command) => match command {
                Command::AddField(field) | Command::SetField { field, .. }
                    if matches!(field.kind, FieldKind::Custom { .. }) =>
                {
                    Counterpart::Is(Box::new(command.clone()))
                }
                command => {
                    symmetry.command(command).map_or(Counterpart::Unknown, |image| Counterpart::Is(Box::new(image)))
                }
            },
            _ => Counterpart::Is(Box::new(command.clone())),
        }
    }

    fn step(&mut self, world: &mut World, number: usize) {
        let is_compared = number % EVERY == EVERY - 1;
        if let Some(second) = &mut self.world {
            let is_sleepless = matches!(self.promise, Promise::Sleepless);
            let was_near = is_sleepless && nears_sleeper(world);
            world.step();
            tally::count(world);
            second.step();
            if is_sleepless && (was_near || nears_sleeper(world)) {
                // A body that is pushed towards a sleeper by less than the gap makes no contact that would slow it.
                assert_touched_awake(world, second);
                *second = sleepless(world);
                return;
            }
            let says_nothing = matches!(self.promise, Promise::Image(_)) && leaves_alone(world, second);
            if says_nothing || is_compared && !self.promise.is_kept(world, second) {
                self.world = None;
            }
            return;
        }
        match self.promise {
            Promise::Traced if is_compared => {
                let mut traced = world.clone();
                world.step();
                traced.step_traced();
                assert_eq!(traced.state_hash(), world.state_hash(), "a step looked into");
                _ = (world.energy(), world.momentum(), world.angular_momentum(), world.elapsed(), world.physics_hash());
            }
            Promise::Preview if is_compared => preview(world),
            Promise::Reverse if is_compared => {
                let before = world.state_hash();
                let applied = world.step().applied.to_vec();
                let after = world.state_hash();
                there_and_back(world, before, after, &applied);
            }
            _ => _ = world.step(),
        }
        tally::count(world);
    }

    /// Asserts what costs as much as a dozen steps, of one input in four: worlds of one hash have no differences.
    fn finish(&self, world: &World) {
        if let (Promise::Restored, Some(second), 0) = (self.promise, &self.world, self.commands % 4) {
            assert!(world.differences(second).is_empty(), "{:?}", world.differences(second));
        }
    }
}

/// A command in the second run.
enum Counterpart {
    Is(Box<Command>),
    /// The second run does nothing instead.
    Nothing,
    /// There is none: the runs go different ways from here.
    Unknown,
}

/// The world without custom forces, which have no images by themselves.
fn without_custom_forces(world: &World) -> World {
    let mut world = world.clone();
    remove_fields(&mut world, |kind| matches!(kind, FieldKind::Custom { .. }));
    world
}

fn remove_fields(world: &mut World, is_meant: impl Fn(&FieldKind) -> bool) {
    let id_of = |(id, field): (_, &ForceField)| is_meant(&field.kind).then_some(id);
    let ids: Vec<_> = world.fields().filter_map(id_of).collect();
    ids.into_iter().for_each(|id| world.remove_field(id).expect("it is there"));
}

fn image(symmetry: &Symmetry, world: &World) -> Option<World> {
    symmetry.world(&without_custom_forces(world))
}

/// Asserts that the second world is the image of the first; false where there is none any more.
fn is_image(symmetry: &Symmetry, world: &World, second: &World) -> bool {
    let told = |StepReport { faults, fell_asleep, woke, drag_outside, .. }: StepReport<'_>| {
        (faults.to_vec(), fell_asleep.to_vec(), woke.to_vec(), drag_outside)
    };
    assert_eq!(told(world.last_report()), told(second.last_report()), "as {symmetry:?}");
    let Some(expected) = image(symmetry, world) else { return false };
    let second = without_custom_forces(second);
    if expected.state_hash() != second.state_hash() {
        panic!("as {symmetry:?}: {:?}", expected.differences(&second));
    }
    true
}

/// Returns true if a body left the range of positions in one of two runs alone: the image of a run is one within the range, which is not
/// moved along with it.
fn leaves_alone(world: &World, second: &World) -> bool {
    let left = |world: &World| -> Vec<_> {
        world.last_report().faults.iter().filter(|fault| fault.cause == Cause::Position).copied().collect()
    };
    left(world) != left(second)
}

/// A step that is undone leads to the state before it, and on to the one after it; one that cannot be undone changes
/// nothing.
fn there_and_back(world: &mut World, before: u64, after: u64, applied: &[AppliedForce]) {
    if world.step_back(applied).is_ok() {
        assert_eq!(world.state_hash(), before, "a step undone");
        world.step();
    }
    assert_eq!(world.state_hash(), after, "there, back and there again");
}

/// The last body by itself, beside the world in which nothing touches or is joined and no fluid lifts: a preview has no colliders and joints.
fn preview(world: &mut World) {
    // One that sleeps on another one stays where it is in a preview, and falls where nothing touches.
    let is_asleep = |body: BodyRef<'_>| body.activity() == Activity::Asleep;
    if let Some(id) = world.bodies().last().map(|body| body.id()).filter(|_| !world.bodies().any(is_asleep)) {
        let (mut free, mut ahead) = (world.clone(), world.preview(id).expect("it is there"));
        for (collider, _) in world.colliders() {
            let def = world.collider(collider).expect("it is there").clone();
            let filter = Filter { group: -1, ..Filter::default() };
            free.set_collider(collider, ColliderDef { filter, ..def }).expect("it is as it was");
        }
        remove_fields(&mut free, |kind| matches!(kind, FieldKind::Buoyancy { .. }));
        let joints: Vec<_> = free.joints().map(|joint| joint.id()).collect();
        joints.into_iter().for_each(|joint| free.remove_joint(joint).expect("it is there"));
        free.step();
        ahead.step();
        let (actual, expected) = (free.body(id).expect("it is there"), ahead.body().expect("it is there"));
        assert_eq!(Motion::of(&actual), Motion::of(&expected), "a body by itself");
    }
    world.step();
}

/// The quantities of a body that a step changes.
#[derive(Debug, PartialEq)]
struct Motion {
    position: [i128; 2],
    velocity: [i128; 2],
    spin: i128,
    angle: u64,
    is_quarantined: bool,
}

impl Motion {
    fn of(body: &BodyRef<'_>) -> Self {
        let (position, velocity) = (body.position_exact(), body.velocity_exact());
        Self {
            position: [position.x, position.y].map(Accumulator::to_bits),
            velocity: [velocity.x, velocity.y].map(Accumulator::to_bits),
            spin: Accumulator::to_bits(body.angular_velocity_exact()),
            angle: Angle::<Fx>::to_bits(body.angle_exact()),
            is_quarantined: body.activity() == Activity::Quarantined,
        }
    }
}

/// Asserts that no body sleeps that an awake one overlaps, and pushes where none sleeps: touched, it would have woken.
fn assert_touched_awake(world: &World, sleepless: &World) {
    let has =
        |id, activity| world.body(id).is_ok_and(|body| body.kind() == BodyKind::Dynamic && body.activity() == activity);
    for contact in sleepless.contacts() {
        let [a, b] = contact.bodies;
        let one_sleeps =
            has(a, Activity::Asleep) && has(b, Activity::Awake) || has(a, Activity::Awake) && has(b, Activity::Asleep);
        let overlaps = contact.points().iter().any(|point| point.separation < fx!(-0.0001));
        assert!(!(one_sleeps && overlaps), "{a} and {b} touch, and one sleeps: {:?}", contact.points());
    }
}

/// Sleep is left out: it changes no bit of the rest.
fn assert_moved_alike(left: &World, right: &World) {
    assert_eq!(left.body_count(), right.body_count());
    for (a, b) in left.bodies().zip(right.bodies()) {
        assert_eq!(Motion::of(&a), Motion::of(&b), "{}", a.id());
    }
    let (a, b) = (left.last_report(), right.last_report());
    assert_eq!(a.faults, b.faults);
    // A sleeping body is not stepped, and so its drag is not counted.
    if left.bodies().any(|body| body.activity() == Activity::Asleep) {
        assert!(a.drag_outside <= b.drag_outside);
    } else {
        assert_eq!(a.drag_outside, b.drag_outside);
    }
}
