//! Any commands on any world, beside runs that have to go the same way.
//!
//! An input is how its images are made, the world's definition, and commands with the steps after each. Its first byte may
//! ask for a crowd instead: as many bodies as it takes for a step to go side by side on several threads.

use std::sync::LazyLock;

use arbitrary::Result;
use rayon::{ThreadPool, ThreadPoolBuilder};
use umbra_physics::{
    Activity, AppliedForce, BodyDef, BodyRef, Command, FieldKind, ForceField, Fx, Random, Region, Snapshot, StepReport,
    Vec2, World, fx, step_all,
};

use super::author::{self, Author, Image};

/// The target.
pub fn run(data: &[u8]) {
    _ = match data {
        [0xff, rest @ ..] => crowd(rest),
        [_, rest @ ..] => play(rest),
        [] => Ok(()),
    };
}

/// The most commands and steps of an input: what breaks breaks early.
const COMMANDS: usize = 48;
const STEPS: usize = 96;

fn play(data: &[u8]) -> Result<()> {
    let mut author = Author::<Fx>::new(data, Image::default());
    let shift = shift(&mut author)?;
    let def = author.world()?;
    let Some(mut world) = author::world(def) else {
        assert!(def.check().is_err(), "{def:?}");
        return Ok(());
    };
    let mut company = Company {
        saved: world.clone(),
        sleepless: Sleepless::of(&world),
        images: [
            Reflection::new(data, Image { is_mirrored: true, shift: Vec2::ZERO })?,
            Reflection::new(data, Image { is_mirrored: false, shift })?,
            Reflection::new(data, Image { is_mirrored: true, shift })?,
        ],
    };
    let mut left = STEPS;
    for _ in 0..COMMANDS {
        if author.input.is_empty() {
            break;
        }
        let command = author.command()?;
        company.execute(&mut world, &mut author, &command)?;
        let steps = author.any::<u8>()?;
        company.images.iter_mut().flatten().for_each(|image| _ = image.author.any::<u8>());
        if steps & 0x30 == 0x30 {
            company.saved = reread(&world);
        }
        for _ in 0..usize::from(steps & 0xf).saturating_sub(11).min(left) {
            company.step(&mut world, &author);
            left -= 1;
        }
    }
    Ok(())
}

fn shift<S: umbra_physics::Scalar>(author: &mut Author<'_, S>) -> Result<Vec2> {
    // Even, and less than 2^24 m.
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
    assert!(world.differences(&read).is_empty());
    read
}

/// Runs beside a world that do the same, and have to go the same way.
struct Company<'a> {
    /// One that was written and read now and then.
    saved: World,
    /// One in which nobody sleeps.
    sleepless: Sleepless,
    /// Mirrored and shifted.
    images: [Option<Reflection<'a>>; 3],
}

impl Company<'_> {
    fn execute(&mut self, world: &mut World, author: &mut Author<'_>, command: &Command) -> Result<()> {
        let before = world.state_hash();
        let bytes = command.to_bytes();
        assert_eq!(Command::from_bytes(&bytes).as_ref(), Ok(command), "its own bytes");
        let expected = world.check(command).err();
        let is_felt = self.sleepless.feels(world, command);
        let done = world.execute(command);
        if is_felt {
            assert_eq!(self.sleepless.0.execute(command), done, "where nobody sleeps: {command:?}");
        }
        assert_eq!(done.err(), expected, "what was foreseen: {command:?}");
        if done.is_err() {
            assert_eq!(world.state_hash(), before, "refused, and yet it changed the world: {command:?}");
        }
        assert_eq!(self.saved.execute(command), done, "{command:?}");
        self.leave_behind(author, world);
        for image in self.images.iter_mut().flatten() {
            let command = image.author.command()?;
            let there = image.world.execute(&command);
            assert_eq!(there, done, "as {:?}: {command:?}", image.image);
            there.into_iter().for_each(|made| image.author.made(made));
        }
        done.into_iter().for_each(|made| author.made(made));
        Ok(())
    }

    /// Parts with the images that cannot go on.
    fn leave_behind(&mut self, author: &Author<'_>, world: &World) {
        self.images.iter_mut().for_each(|image| drop(image.take_if(|image| image.is_too_far(author, world))));
    }

    fn step(&mut self, world: &mut World, author: &Author<'_>) {
        let before = world.state_hash();
        let mut staged = stage_by_stage(world);
        let mut alone = world.bodies().last().map(|body| (body.id(), world.preview(body.id())));
        let mut traced = world.clone();
        let applied = world.step().applied.to_vec();
        let after = world.state_hash();

        staged.step();
        assert_moved_alike(world, &staged);
        traced.step_traced();
        assert_eq!(traced.state_hash(), after, "a step looked into");
        if let Some((id, ahead)) = &mut alone {
            let ahead = ahead.as_mut().expect("it is there");
            ahead.step();
            let (here, there) = (world.body(*id).expect("it is there"), ahead.body().expect("it is there"));
            assert_eq!(Motion::of(&here), Motion::of(&there), "a body by itself");
        }
        self.saved.step();
        assert_eq!(self.saved.state_hash(), after, "read from bytes");
        self.sleepless.0.step();
        assert_moved_alike(world, &self.sleepless.0);
        for image in self.images.iter_mut().flatten() {
            image.world.step();
            image.assert_is_image(world);
        }
        self.leave_behind(author, world);
        there_and_back(&mut traced, before, after, &applied);
        _ = (world.energy(), world.momentum(), world.angular_momentum(), world.elapsed(), world.physics_hash());
    }
}

/// The same world, its bodies taken through the step stage by stage, for a field that acts on nobody; all awake.
fn stage_by_stage(world: &World) -> World {
    let mut world = world.clone();
    let region = Region::Disc { centre: Vec2::ZERO, radius: Fx::ONE };
    world
        .add_field(ForceField { kind: FieldKind::Zone { region, acceleration: Vec2::X }, groups: 0 })
        .expect("there is room");
    world
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

/// What a step changes of a body.
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
            position: [position.x, position.y].map(umbra_physics::FxAccumulator::to_bits),
            velocity: [velocity.x, velocity.y].map(umbra_physics::FxAccumulator::to_bits),
            spin: body.angular_velocity_exact().to_bits(),
            angle: body.angle_exact().to_bits(),
            is_quarantined: body.activity() == Activity::Quarantined,
        }
    }

    fn seen(self, image: &Image) -> Self {
        let mut seen = self;
        if image.is_mirrored {
            seen.position[0] = -seen.position[0];
            seen.velocity[0] = -seen.velocity[0];
            seen.spin = -seen.spin;
            seen.angle = seen.angle.wrapping_neg();
        }
        for (own, shift) in seen.position.iter_mut().zip([image.shift.x, image.shift.y]) {
            *own += i128::from(shift.to_bits()) << 64;
        }
        seen
    }
}

/// Which of them sleep is left out: it changes no bit of the rest.
fn assert_moved_alike(world: &World, other: &World) {
    assert_eq!(world.body_count(), other.body_count());
    for (here, there) in world.bodies().zip(other.bodies()) {
        assert_eq!(Motion::of(&here), Motion::of(&there), "{}", here.id());
    }
    let (here, there) = (world.last_report(), other.last_report());
    assert_eq!((here.faults, here.drag_outside), (there.faults, there.drag_outside));
}

/// The same run where no body ever sleeps.
struct Sleepless(World);

impl Sleepless {
    fn of(world: &World) -> Self {
        let mut world = world.clone();
        world.set_sleep_after(None).expect("never is a fair answer");
        Self(world)
    }

    /// Whether what is about to be done to the world is done here too.
    fn feels(&self, world: &World, command: &Command) -> bool {
        match command {
            Command::SetSleepAfter(_) => false,
            // A sleeping body does not feel what does not wake it.
            Command::Apply { body, manner, .. } if !manner.wake => {
                world.body(*body).is_ok_and(|body| body.activity() != Activity::Asleep)
            }
            _ => true,
        }
    }
}

/// A run that is the image of another.
struct Reflection<'a> {
    image: Image,
    author: Author<'a>,
    world: World,
}

impl<'a> Reflection<'a> {
    fn new(data: &'a [u8], image: Image) -> Result<Option<Self>> {
        let mut author = Author::new(data, image);
        shift(&mut author)?;
        let world = author::world(author.world()?).expect("what is refused is so in the image");
        Ok(Some(Self { image, author, world }))
    }

    /// Whether an image may come to the edge of the envelope sooner or later than the world. Mirrored at the middle it
    /// does not.
    fn is_too_far(&self, author: &Author<'_>, world: &World) -> bool {
        // A body moves by less than 2^27 m a step: what it has to spare here, two shifts and it do not use up.
        let far = |x: Fx| x.to_bits().unsigned_abs() > 1 << (32 + 28);
        let is_far = || world.bodies().any(|body| far(body.position().x) || far(body.position().y));
        self.image.shift != Vec2::ZERO && (author.farthest > 1 << (32 + 28) || is_far())
    }

    fn assert_is_image(&self, world: &World) {
        for (here, there) in world.bodies().zip(self.world.bodies()) {
            assert_eq!(Motion::of(&here).seen(&self.image), Motion::of(&there), "{} as {:?}", here.id(), self.image);
            assert_eq!(here.activity(), there.activity());
        }
        let told = |StepReport { faults, fell_asleep, woke, drag_outside, .. }| {
            (faults.to_vec(), fell_asleep.to_vec(), woke.to_vec(), drag_outside)
        };
        assert_eq!(told(world.last_report()), told(self.world.last_report()), "as {:?}", self.image);
    }
}

static POOLS: LazyLock<[ThreadPool; 2]> =
    LazyLock::new(|| [1, 2].map(|count| ThreadPoolBuilder::new().num_threads(count).build().expect("threads")));

/// Enough bodies for a step to go side by side: 64 blocks of 128, and some.
const CROWD: u64 = 8_192;

/// Two threads do what one does.
fn crowd(data: &[u8]) -> Result<()> {
    let mut author = Author::<Fx>::new(data, Image::default());
    let Some(mut world) = author::world(author.world()?) else { return Ok(()) };
    let mut random = Random::seeded(author.any()?);
    // A few kinds of bodies, one of them as the input says; the others differ in where they are and how they move.
    let special = author.body()?;
    let every = u64::from(author.any::<u8>()?) + 1;
    for i in 0..CROWD + u64::from(author.any::<u8>()?) {
        let mut number = |size: Fx| random.number(-size..=size);
        let (position, velocity) =
            (Vec2::new(number(fx!(99)), number(fx!(99))), Vec2::new(number(fx!(3)), number(fx!(3))));
        let def = BodyDef { position, velocity, angular_velocity: number(fx!(1)), ..BodyDef::dynamic() };
        let made = if i % every == 0 { world.add_body(special.clone()) } else { world.add_body(def) };
        if let Ok(body) = made {
            author.made(umbra_physics::Created::Body(body));
        }
    }
    let mut others = [world.clone(), world.clone()];
    for _ in 0..8 {
        if author.input.is_empty() {
            break;
        }
        let command = author.command()?;
        let done = POOLS[0].install(|| world.execute(&command));
        for other in &mut others {
            assert_eq!(POOLS[1].install(|| other.execute(&command)), done);
        }
        done.into_iter().for_each(|made| author.made(made));
        POOLS[0].install(|| _ = world.step());
        POOLS[1].install(|| step_all(&mut others));
        for other in &others {
            assert_eq!(other.state_hash(), world.state_hash(), "on two threads");
            assert_eq!(other.last_report(), world.last_report());
        }
    }
    Ok(())
}
