//! Worlds, their steps, and what is read of them as a whole.

use std::ffi::c_char;
use std::mem::MaybeUninit;

use umbra_physics::{
    BodyId, Command, Created, Damping, FieldId, Fx, Input, InputResult, Inputs, Integrator, Labels, Recorder,
    StepReport, TimeStep, World, WorldDef,
};
use umbra_scene::Scene;

use crate::UMBRA_NO_HANDLE;
use crate::collider::collider_word;
use crate::joint::joint_word;
use crate::memory::{fill, given, slice, text, write_text};
use crate::number::{UmbraFx, UmbraUint128, UmbraVec2};
use crate::run::{ReplayPlay, ScenePlay};
use crate::status::{Refusal, Result, UMBRA_ERROR_BUSY, UMBRA_ERROR_END, UMBRA_OK, UmbraStatus, guard};

/// Integrator of a world: one of the five values below.
pub type UmbraIntegrator = u32;

/// Order 1; gains energy. For comparison.
pub const UMBRA_EXPLICIT_EULER: UmbraIntegrator = 0;
/// Order 1, symplectic.
pub const UMBRA_SYMPLECTIC_EULER: UmbraIntegrator = 1;
/// Order 2, symplectic, reversible. The one to begin with.
pub const UMBRA_VELOCITY_VERLET: UmbraIntegrator = 2;
/// The four stages of UMBRA as published. Order 1.
pub const UMBRA_PUBLISHED_VERLET: UmbraIntegrator = 3;
/// Order 4, symplectic, reversible.
pub const UMBRA_YOSHIDA4: UmbraIntegrator = 4;

const INTEGRATORS: [Integrator; 5] = [
    Integrator::ExplicitEuler,
    Integrator::SymplecticEuler,
    Integrator::VelocityVerlet,
    Integrator::PublishedVerlet,
    Integrator::Yoshida4,
];

/// In place of a number of ticks: bodies never fall asleep.
pub const UMBRA_NEVER: u32 = 0;

/// Definition of a world; `umbra_world_def_default` fills it in.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraWorldDef {
    /// A step takes step_num / step_den seconds, from 1 to 10,000 steps a second: 1 and 60.
    pub step_num: u32,
    /// See `step_num`.
    pub step_den: u32,
    /// Integrator; default `UMBRA_VELOCITY_VERLET`.
    pub integrator: UmbraIntegrator,
    /// The number of ticks at rest after which a body falls asleep, or `UMBRA_NEVER`: 30.
    pub sleep_after: u32,
    /// Gravity, m/s²: none.
    pub gravity: UmbraVec2,
    /// Damping of bodies without their own: the share of a velocity that is left after a second, from 0 (stops at once) to `UMBRA_ONE`
    /// (none). This is not the damping of Box2D, which is a rate: `umbra_kept_at_rate` makes one from it. Default `UMBRA_ONE`.
    pub linear_kept_per_second: UmbraFx,
    /// Damping of bodies without their own: the share of an angular velocity that is left after a second; default `UMBRA_ONE`.
    pub angular_kept_per_second: UmbraFx,
}

/// Summary of a step in numbers; `umbra_world_faults` and similar functions list the bodies.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraReport {
    /// The tick the world is at now.
    pub tick: u64,
    /// Number of bodies quarantined.
    pub faults: u64,
    /// Number of bodies that fell asleep.
    pub fell_asleep: u64,
    /// Number of bodies woken by calls since the step before.
    pub woke: u64,
    /// With Yoshida4, how many bodies had a drag too stiff for its backward sub-step, which acted around the whole step instead.
    pub drag_outside: u32,
    /// 0.
    pub reserved: u32,
    /// Number of contacts that ended: `umbra_world_contacts_ended`.
    pub contacts_ended: u64,
    /// Number of contacts that began: `umbra_world_contacts_began`.
    pub contacts_began: u64,
    /// Number of hits: `umbra_world_contact_hits`.
    pub hits: u64,
    /// Number of colliders that left a sensor: `umbra_world_sensors_left`.
    pub sensors_left: u64,
    /// Number of colliders that entered a sensor: `umbra_world_sensors_entered`.
    pub sensors_entered: u64,
}

/// A body that was quarantined in a step, and why.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraFault {
    /// The body.
    pub body: u64,
    /// The field whose force did not fit, or `UMBRA_NO_HANDLE`.
    pub field: u64,
    /// 201 to 207.
    pub cause: UmbraStatus,
    /// 0.
    pub reserved: u32,
}

/// Result of a command: nothing, a body, a field, a collider, or a joint.
pub type UmbraCreatedKind = u32;

/// Nothing new.
pub const UMBRA_CREATED_NOTHING: UmbraCreatedKind = 0;
/// A body.
pub const UMBRA_CREATED_BODY: UmbraCreatedKind = 1;
/// A force field.
pub const UMBRA_CREATED_FIELD: UmbraCreatedKind = 2;
/// A collider.
pub const UMBRA_CREATED_COLLIDER: UmbraCreatedKind = 3;
/// A joint.
pub const UMBRA_CREATED_JOINT: UmbraCreatedKind = 4;

/// Result of an input.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UmbraInputResult {
    /// The player.
    pub player: u32,
    /// Sequence of the input among the inputs of this player.
    pub sequence: u32,
    /// `UMBRA_OK`, or why it was refused: then it changed nothing.
    pub status: UmbraStatus,
    /// Body, field, collider or joint that the input created.
    pub created: UmbraCreatedKind,
    /// The handle of the created thing, or `UMBRA_NO_HANDLE`.
    pub handle: u64,
}

/// The inputs of one tick, by player and sequence.
#[derive(Default)]
pub struct UmbraInputs {
    inputs: Inputs,
}

/// A world.
pub struct UmbraWorld {
    state: State,
    recorder: Option<Recorder>,
    outcomes: Vec<InputResult>,
}

/// The owner of the changes to a world.
enum State {
    /// The caller.
    Own(World),
    /// A scene.
    Scene(ScenePlay),
    /// A replay.
    Replay(ReplayPlay),
    /// Nobody: calls are written down, and the world stays empty.
    Draft(World, Vec<u8>),
}

fn run_by_a_scene() -> Refusal {
    Refusal::own(UMBRA_ERROR_BUSY, "a scene runs this world")
}

fn run_by_a_replay() -> Refusal {
    Refusal::own(UMBRA_ERROR_BUSY, "a replay runs this world")
}

impl UmbraWorld {
    pub(crate) const fn new(world: World) -> Self {
        Self { state: State::Own(world), recorder: None, outcomes: Vec::new() }
    }

    pub(crate) fn boxed(world: World) -> Option<Box<Self>> {
        Some(Box::new(Self::new(world)))
    }

    pub(crate) fn world(&self) -> &World {
        match &self.state {
            State::Own(world) | State::Draft(world, _) => world,
            State::Scene(play) => play.run.world(),
            State::Replay(play) => play.playback.world(),
        }
    }

    /// The replay that runs this world.
    pub(crate) fn replay(&self) -> Result<&ReplayPlay> {
        match &self.state {
            State::Replay(play) => Ok(play),
            _ => Err(Refusal::bad("no replay runs this world")),
        }
    }

    pub(crate) fn replay_mut(&mut self) -> Result<&mut ReplayPlay> {
        match &mut self.state {
            State::Replay(play) => Ok(play),
            _ => Err(Refusal::bad("no replay runs this world")),
        }
    }

    /// A world that a replay runs.
    pub(crate) const fn replayed(play: ReplayPlay) -> Self {
        Self { state: State::Replay(play), recorder: None, outcomes: Vec::new() }
    }

    /// The name of a body, without a list of all names where a scene runs the world.
    pub(crate) fn body_name(&self, body: BodyId) -> Result<Option<String>> {
        match &self.state {
            State::Scene(play) => Ok(Some(play.run.name(body).to_owned())),
            _ => Ok(self.named()?.body(body).map(str::to_owned)),
        }
    }

    /// The world and its recorder, unless a scene or a replay runs it.
    fn parts(&mut self) -> Result<(&mut World, &mut Option<Recorder>, &mut Vec<InputResult>)> {
        match &mut self.state {
            State::Own(world) => Ok((world, &mut self.recorder, &mut self.outcomes)),
            State::Scene(_) => Err(run_by_a_scene()),
            State::Replay(_) => Err(run_by_a_replay()),
            State::Draft(..) => Err(Refusal::own(UMBRA_ERROR_BUSY, "a draft is no world")),
        }
    }

    /// To change what the recorder sees by itself.
    pub(crate) fn own(&mut self) -> Result<&mut World> {
        self.parts().map(|(world, ..)| world)
    }

    /// To change in a way that no recording has.
    pub(crate) fn unrecorded(&mut self) -> Result<&mut World> {
        match self.parts()? {
            (world, None, _) => Ok(world),
            _ => Err(Refusal::own(UMBRA_ERROR_BUSY, "this world is being recorded")),
        }
    }

    /// The names of a scene or of a replay.
    pub(crate) fn labels(&self) -> Option<Labels> {
        match &self.state {
            State::Scene(play) => Some(play.run.labels()),
            State::Replay(play) => Some(play.replay().labels().clone()),
            State::Own(_) | State::Draft(..) => None,
        }
    }

    /// The names, where there can be some.
    pub(crate) fn named(&self) -> Result<Labels> {
        self.labels().ok_or_else(|| Refusal::bad("no scene or replay runs this world"))
    }

    pub(crate) const fn recorder(&mut self) -> &mut Option<Recorder> {
        &mut self.recorder
    }

    /// Every change goes this way, so that none is missing in a recording.
    pub(crate) fn execute(&mut self, command: &Command) -> Result<Created> {
        if let State::Draft(_, bytes) = &mut self.state {
            *bytes = command.to_bytes();
            return Ok(Created::Nothing);
        }
        let (world, recorder, _) = self.parts()?;
        Ok(match recorder {
            Some(recorder) => recorder.execute(world, command)?,
            None => world.execute(command)?,
        })
    }

    /// The answer that [`execute`](Self::execute) would give.
    pub(crate) fn check(&self, command: &Command) -> Result {
        match &self.state {
            State::Own(world) => Ok(world.check(command)?),
            State::Scene(_) => Err(run_by_a_scene()),
            State::Replay(_) => Err(run_by_a_replay()),
            State::Draft(..) => Ok(()),
        }
    }

    /// Outcomes are those of a step that this world has no more.
    pub(crate) fn forget_outcomes(&mut self) {
        self.outcomes.clear();
    }

    pub(crate) fn draft() -> Result<Self> {
        let state = State::Draft(World::new(WorldDef::default())?, Vec::new());
        Ok(Self { state, recorder: None, outcomes: Vec::new() })
    }

    /// The bytes of the last command written down, if it is for that.
    pub(crate) fn drafted(&self) -> Result<&[u8]> {
        match &self.state {
            State::Draft(_, bytes) => Ok(bytes),
            _ => Err(Refusal::bad("the world is no draft")),
        }
    }

    fn step(&mut self, inputs: &Inputs) -> Result {
        if let State::Replay(play) = &mut self.state {
            if !inputs.is_empty() {
                return Err(run_by_a_replay());
            }
            if play.is_at_end() {
                return Err(Refusal::own(UMBRA_ERROR_END, "the replay has no more ticks"));
            }
            let played = play.playback.step();
            self.outcomes.clear();
            self.outcomes.extend_from_slice(play.playback.outcomes());
            return Ok(played.map(drop)?);
        }
        self.outcomes.clear();
        if let State::Scene(play) = &mut self.state {
            if !inputs.is_empty() {
                return Err(run_by_a_scene());
            }
            match &mut self.recorder {
                Some(recorder) => play.run.advance_by(recorder)?,
                None => play.run.advance()?,
            };
            return Ok(());
        }
        let (world, recorder, outcomes) = self.parts()?;
        if let Some(recorder) = recorder {
            recorder.step(world, inputs);
            outcomes.extend_from_slice(recorder.outcomes());
        } else {
            if !inputs.is_empty() {
                *outcomes = world.carry_out(inputs);
            }
            world.step();
        }
        Ok(())
    }
}

/// Carries out what a function stands for.
pub(crate) fn change(world: Option<&mut UmbraWorld>, command: Command) -> UmbraStatus {
    change_by(world, || Ok(command))
}

/// Carries out the command that `command` makes of the arguments, unless it refuses them.
pub(crate) fn change_by(world: Option<&mut UmbraWorld>, command: impl FnOnce() -> Result<Command>) -> UmbraStatus {
    guard(|| {
        let world = given(world)?;
        world.execute(&command()?).map(drop)
    })
}

/// Hands on what a look at a world gives.
pub(crate) fn look<'a, T>(
    world: Option<&'a UmbraWorld>,
    place: Option<&mut MaybeUninit<T>>,
    at: impl FnOnce(&'a World) -> Result<T>,
) -> UmbraStatus {
    guard(|| {
        let (world, place) = (given(world)?, given(place)?);
        place.write(at(world.world())?);
        Ok(())
    })
}

/// Hands on a list of bodies of the last step's.
///
/// # Safety
/// As [`fill`].
unsafe fn reported(
    world: Option<&UmbraWorld>,
    bodies: *mut u64,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
    select: impl for<'a> FnOnce(&StepReport<'a>) -> &'a [BodyId],
) -> UmbraStatus {
    guard(|| {
        let rows = select(&given(world)?.world().last_report()).iter().copied().map(body_word);
        // SAFETY: as the caller promises.
        unsafe { fill(rows, bodies, capacity, count) }
    })
}

/// A handle as one word: the generation above the slot, so that its bytes are those of the formats.
pub(crate) const fn word(slot: u32, generation: u32) -> u64 {
    (generation as u64) << 32 | slot as u64
}

pub(crate) const fn body_word(body: BodyId) -> u64 {
    let (slot, generation) = body.parts();
    word(slot, generation)
}

pub(crate) const fn field_word(field: FieldId) -> u64 {
    let (slot, generation) = field.parts();
    word(slot, generation)
}

pub(crate) const fn body_id(word: u64) -> BodyId {
    BodyId::from_parts(word as u32, (word >> 32) as u32)
}

pub(crate) const fn field_id(word: u64) -> FieldId {
    FieldId::from_parts(word as u32, (word >> 32) as u32)
}

pub(crate) fn created(created: Created) -> (UmbraCreatedKind, u64) {
    match created {
        Created::Body(body) => (UMBRA_CREATED_BODY, body_word(body)),
        Created::ForceField(field) => (UMBRA_CREATED_FIELD, field_word(field)),
        Created::Collider(collider) => (UMBRA_CREATED_COLLIDER, collider_word(collider)),
        Created::Joint(joint) => (UMBRA_CREATED_JOINT, joint_word(joint)),
        _ => (UMBRA_CREATED_NOTHING, UMBRA_NO_HANDLE),
    }
}

pub(crate) fn integrator(number: UmbraIntegrator) -> Result<Integrator> {
    let known = INTEGRATORS.get(number as usize).copied();
    known.ok_or_else(|| Refusal::bad("no integrator has this number"))
}

pub(crate) fn sleep_after(ticks: u32) -> Option<u32> {
    (ticks != UMBRA_NEVER).then_some(ticks)
}

/// Fills in a definition: 60 steps a second by velocity Verlet, no gravity, no damping, asleep after half a second at rest.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_def_default(def: Option<&mut MaybeUninit<UmbraWorldDef>>) -> UmbraStatus {
    guard(|| {
        given(def)?.write(as_def(&WorldDef::default()));
        Ok(())
    })
}

fn as_def(def: &WorldDef) -> UmbraWorldDef {
    let (step_num, step_den) = def.time_step.seconds();
    let number = INTEGRATORS.iter().position(|&integrator| integrator == def.integrator);
    UmbraWorldDef {
        step_num,
        step_den,
        integrator: number.map_or(u32::MAX, |number| number as u32),
        sleep_after: def.sleep_after.unwrap_or(UMBRA_NEVER),
        gravity: def.gravity.into(),
        linear_kept_per_second: def.linear_damping.number().to_bits(),
        angular_kept_per_second: def.angular_damping.number().to_bits(),
    }
}

/// An empty world. It is the caller's, as is everything that a function gives through a pointer to a pointer, until it is
/// handed to `umbra_world_free`.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_new(
    def: Option<&UmbraWorldDef>,
    world: Option<&mut MaybeUninit<Option<Box<UmbraWorld>>>>,
) -> UmbraStatus {
    guard(|| {
        let (def, place) = (given(def)?, given(world)?);
        let def = WorldDef {
            time_step: TimeStep::ratio(def.step_num, def.step_den),
            gravity: def.gravity.into(),
            integrator: integrator(def.integrator)?,
            linear_damping: Damping::from_number(Fx::from_bits(def.linear_kept_per_second)),
            angular_damping: Damping::from_number(Fx::from_bits(def.angular_kept_per_second)),
            sleep_after: sleep_after(def.sleep_after),
            ..WorldDef::default()
        };
        place.write(UmbraWorld::boxed(World::new(def)?));
        Ok(())
    })
}

/// The world of a scene (`docs/scene.md`), which a JSON text of `length` bytes describes. Its steps do what the scene has for
/// their ticks; the scene alone changes it, until `umbra_world_leave_scene`. It may have at most `most` bodies, as many fields,
/// and as many things that its inputs do, as a short text can ask for many; 131072 is a good number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_from_scene(
    json: *const c_char,
    length: usize,
    most: u32,
    world: Option<&mut MaybeUninit<Option<Box<UmbraWorld>>>>,
) -> UmbraStatus {
    guard(|| {
        // SAFETY: as the caller promises.
        let json = unsafe { text(json, length) }?;
        let place = given(world)?;
        let play = ScenePlay::new(Scene::parse_within(json, most)?)?;
        let world = UmbraWorld { state: State::Scene(play), recorder: None, outcomes: Vec::new() };
        place.write(Some(Box::new(world)));
        Ok(())
    })
}

/// Ends the scene or the replay that runs a world: the world stays as it is, and the caller may change it. Of other worlds nothing changes.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_leave_scene(world: Option<&mut UmbraWorld>) -> UmbraStatus {
    guard(|| {
        let world = given(world)?;
        if let State::Scene(_) | State::Replay(_) = &world.state {
            world.state = State::Own(world.world().clone());
        }
        Ok(())
    })
}

/// A world with the same state and future, which shares what no step changes, and with the same scene or replay. It is not recorded.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_clone(
    world: Option<&UmbraWorld>,
    copy: Option<&mut MaybeUninit<Option<Box<UmbraWorld>>>>,
) -> UmbraStatus {
    guard(|| {
        let (world, place) = (given(world)?, given(copy)?);
        let state = match &world.state {
            State::Own(world) => State::Own(world.clone()),
            State::Scene(play) => State::Scene(play.clone()),
            State::Replay(play) => State::Replay(play.clone()),
            State::Draft(world, bytes) => State::Draft(world.clone(), bytes.clone()),
        };
        place.write(Some(Box::new(UmbraWorld { state, recorder: None, outcomes: world.outcomes.clone() })));
        Ok(())
    })
}

/// Frees a world. Null is ignored.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_free(world: Option<Box<UmbraWorld>>) {
    drop(world);
}

/// Definition of the world, with all changes since.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_def(
    world: Option<&UmbraWorld>,
    def: Option<&mut MaybeUninit<UmbraWorldDef>>,
) -> UmbraStatus {
    look(world, def, |world| Ok(as_def(world.def())))
}

/// Moves a world on by a tick. A scene can be refused: what it does in this tick before that is done, and the step is not
/// made. So can a replay: see `umbra_world_from_replay`.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_step(world: Option<&mut UmbraWorld>) -> UmbraStatus {
    guard(|| given(world)?.step(&Inputs::new()))
}

/// Carries out the inputs of a tick, by player and then by sequence, and moves the world on. An input that is refused changes
/// nothing and stops no other: `umbra_world_outcomes` has what became of each.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_step_inputs(world: Option<&mut UmbraWorld>, inputs: Option<&UmbraInputs>) -> UmbraStatus {
    guard(|| given(world)?.step(&given(inputs)?.inputs))
}

/// Results of the inputs of the last step, in their order.
///
/// Lists go into a buffer with room for `capacity` entries. `count`, which may be null, is given the number of entries, also if
/// the buffer is too small; a `capacity` of 0 asks for the number alone.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_outcomes(
    world: Option<&UmbraWorld>,
    outcomes: *mut UmbraInputResult,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let rows = given(world)?.outcomes.iter().map(|&InputResult { player, sequence, result }| {
            let (created, handle) = self::created(result.unwrap_or(Created::Nothing));
            let status = result.map_or_else(|error| error.code().into(), |_| UMBRA_OK);
            UmbraInputResult { player, sequence, status, created, handle }
        });
        // SAFETY: as the caller promises.
        unsafe { fill(rows, outcomes, capacity, count) }
    })
}

/// No inputs.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_inputs_new(inputs: Option<&mut MaybeUninit<Option<Box<UmbraInputs>>>>) -> UmbraStatus {
    guard(|| {
        given(inputs)?.write(Some(Box::default()));
        Ok(())
    })
}

/// Adds a command of a player's, as the bytes of `docs/formats.md`, in its place: in whatever order they arrive.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_inputs_insert(
    inputs: Option<&mut UmbraInputs>,
    player: u32,
    sequence: u32,
    command: *const u8,
    length: usize,
) -> UmbraStatus {
    guard(|| {
        // SAFETY: as the caller promises.
        let bytes = unsafe { slice(command, length) }?;
        let command = Command::from_bytes(bytes)?;
        Ok(given(inputs)?.inputs.insert(Input { player, sequence, command })?)
    })
}

/// Puts `count` commands, with sequences from 0, in the place of all inputs of a player: what a peer does with a packet, which may
/// come again. `commands` has the bytes of one after the other, `lengths` how many each has. `changed`, which may be null, is
/// given 1, or 0 if the player had just these.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_inputs_replace(
    inputs: Option<&mut UmbraInputs>,
    player: u32,
    commands: *const u8,
    lengths: *const usize,
    count: usize,
    changed: Option<&mut MaybeUninit<u32>>,
) -> UmbraStatus {
    guard(|| {
        // SAFETY: as the caller promises.
        let lengths = unsafe { slice(lengths, count) }?;
        let all = lengths.iter().try_fold(0usize, |all, &length| all.checked_add(length));
        // SAFETY: as the caller promises.
        let mut rest = unsafe { slice(commands, all.unwrap_or(usize::MAX)) }?;
        let commands = lengths.iter().map(|&length| {
            let (bytes, others) = rest.split_at(length);
            rest = others;
            Ok(Command::from_bytes(bytes)?)
        });
        let commands = commands.collect::<Result<Vec<Command>>>()?;
        let is_changed = given(inputs)?.inputs.replace(player, commands);
        if let Some(place) = changed {
            place.write(is_changed.into());
        }
        Ok(())
    })
}

/// Removes all, for those of another tick.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_inputs_clear(inputs: Option<&mut UmbraInputs>) -> UmbraStatus {
    guard(|| {
        given(inputs)?.inputs.clear();
        Ok(())
    })
}

/// Frees inputs. Null is ignored.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_inputs_free(inputs: Option<Box<UmbraInputs>>) {
    drop(inputs);
}

/// Summary of the last step.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_report(
    world: Option<&UmbraWorld>,
    report: Option<&mut MaybeUninit<UmbraReport>>,
) -> UmbraStatus {
    look(world, report, |world| {
        let last = world.last_report();
        Ok(UmbraReport {
            tick: last.tick,
            faults: last.faults.len() as u64,
            fell_asleep: last.fell_asleep.len() as u64,
            woke: last.woke.len() as u64,
            drag_outside: last.drag_outside,
            reserved: 0,
            contacts_ended: last.contacts_ended.len() as u64,
            contacts_began: last.contacts_began.len() as u64,
            hits: last.hits.len() as u64,
            sensors_left: last.sensors_left.len() as u64,
            sensors_entered: last.sensors_entered.len() as u64,
        })
    })
}

/// The bodies that the last step quarantined, in the order of their slots; a list as `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_faults(
    world: Option<&UmbraWorld>,
    faults: *mut UmbraFault,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    use umbra_physics::Cause;
    guard(|| {
        let rows = given(world)?.world().last_report().faults.iter().map(|fault| UmbraFault {
            body: body_word(fault.body),
            field: match fault.cause {
                Cause::Field { field } | Cause::CustomForce { field, .. } => field_word(field),
                _ => UMBRA_NO_HANDLE,
            },
            cause: fault.code().into(),
            reserved: 0,
        });
        // SAFETY: as the caller promises.
        unsafe { fill(rows, faults, capacity, count) }
    })
}

/// The bodies that fell asleep in the last step, in the order of their slots; a list as `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_fell_asleep(
    world: Option<&UmbraWorld>,
    bodies: *mut u64,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    // SAFETY: as the caller promises.
    unsafe { reported(world, bodies, capacity, count, |report| report.fell_asleep) }
}

/// The bodies that calls before the last step woke, in the order of the calls; a list as `umbra_world_outcomes` gives it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_woke(
    world: Option<&UmbraWorld>,
    bodies: *mut u64,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    // SAFETY: as the caller promises.
    unsafe { reported(world, bodies, capacity, count, |report| report.woke) }
}

/// The number of steps made.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_tick(world: Option<&UmbraWorld>, tick: Option<&mut MaybeUninit<u64>>) -> UmbraStatus {
    look(world, tick, |world| Ok(world.tick()))
}

/// The time simulated in seconds, an exact ratio in lowest terms.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_elapsed(
    world: Option<&UmbraWorld>,
    num: Option<&mut MaybeUninit<UmbraUint128>>,
    den: Option<&mut MaybeUninit<UmbraUint128>>,
) -> UmbraStatus {
    guard(|| {
        let (elapsed, num, den) = (given(world)?.world().elapsed(), given(num)?, given(den)?);
        num.write(elapsed.num.into());
        den.write(elapsed.den.into());
        Ok(())
    })
}

/// A hash of all that the future of a world depends on, handles included: what peers compare.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_state_hash(
    world: Option<&UmbraWorld>,
    hash: Option<&mut MaybeUninit<u64>>,
) -> UmbraStatus {
    look(world, hash, |world| Ok(world.state_hash()))
}

/// A hash of the motion alone, bodies by their keys: for worlds that were built in another order.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_physics_hash(
    world: Option<&UmbraWorld>,
    hash: Option<&mut MaybeUninit<u64>>,
) -> UmbraStatus {
    look(world, hash, |world| Ok(world.physics_hash()))
}

/// The first value in which two worlds differ, with both values, as in `body 3, position.x: 1 and 2 m (differ by 1 m)`; empty
/// if they do not. Text as `umbra_last_message` gives it. It is for finding out what went wrong, and takes its time.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbra_world_first_difference(
    left: Option<&UmbraWorld>,
    right: Option<&UmbraWorld>,
    buffer: *mut c_char,
    capacity: usize,
    length: Option<&mut MaybeUninit<usize>>,
) -> UmbraStatus {
    guard(|| {
        let first = given(left)?.world().first_difference(given(right)?.world());
        let text = first.map_or_else(String::new, |first| format!("{first:#}"));
        // SAFETY: as the caller promises.
        unsafe { write_text(&text, buffer, capacity, length) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rules for threads that the header states.
    #[test]
    fn worlds_go_from_thread_to_thread_and_are_read_by_several() {
        const fn may<T: Send + Sync>() {}
        const { may::<UmbraWorld>() }
        const { may::<UmbraInputs>() }
        const { may::<crate::UmbraShape>() }
        const { may::<crate::UmbraSnapshot>() }
        const { may::<crate::UmbraBytes>() }
        const { may::<crate::UmbraMovement>() }
        const { may::<crate::UmbraAppliedForces>() }
        const { may::<crate::UmbraDrawing>() }
    }
}
