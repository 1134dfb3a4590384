//! Test oracles for games built on `umbra-physics`. [`fuzz`] plays your game with random inputs until a check fails, then shrinks the
//! match to a minimal failing one and records a replay of it.
//!
//! An [`Oracle`] is a property that holds for every run, whatever its result: the same inputs lead to the same bits, a copy has the same
//! future, bystanders change nothing. A [`Game`] is a type with two calls, one that begins a match and one that makes a tick. A [`Script`]
//! is a list of commands on a fresh world, checked in the same way.
//!
//! ```
//! use umbra_oracles::{Fuzz, Game, Oracle, fuzz};
//! use umbra_physics::{ForceOrImpulse, BodyDef, BodyId, Command, Stepper, ApplyOptions, World, WorldDef, vec2};
//!
//! /// Two ships, and an engine that fires every other time a player presses the button.
//! #[derive(Clone, Default)]
//! struct Ships {
//!     bodies: Vec<BodyId>,
//!     pressed: u32, // beside the world: a copy of the world does not take it along
//! }
//!
//! impl Game for Ships {
//!     type Input = usize;
//!
//!     fn start(&mut self) -> World {
//!         let mut world = World::new(WorldDef::default()).unwrap();
//!         self.bodies = (0..2).map(|_| world.add_body(BodyDef::dynamic()).unwrap()).collect();
//!         world
//!     }
//!
//!     fn tick(&mut self, world: &mut World, inputs: &[usize], driver: &mut dyn Stepper) {
//!         for &player in inputs {
//!             self.pressed += 1;
//!             if self.pressed % 2 == 0 {
//!                 let action = ForceOrImpulse::Impulse { impulse: vec2(0, 1), point: None };
//!                 let fire = Command::Apply { body: self.bodies[player], action, options: ApplyOptions::default() };
//!                 driver.execute(world, &fire).unwrap();
//!             }
//!         }
//!         driver.step(world);
//!     }
//! }
//!
//! let options = Fuzz { oracles: &[Oracle::Repeat, Oracle::Restore], ..Fuzz::default() };
//! let found = fuzz(&Ships::default(), &options, |random, _tick| match random.below(8) {
//!     player @ 0..2 => vec![player as usize],
//!     _ => vec![],
//! });
//! let found = found.found.expect("the count of presses is no part of the world");
//! assert_eq!(found.violation.oracle, Oracle::Restore);
//! // Pressed twice, the second time in a match that goes on from a snapshot.
//! assert_eq!(found.course.inputs.len(), 2);
//! ```

#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod bystanders;
mod commands;
mod drivers;
mod energy;
mod fuzz;
mod game;
mod handles;
mod script;
mod shrink;
mod sleepers;
mod trial;

use std::fmt;

use umbra_physics::Difference;

pub use commands::{Choices, Generator, Taste};
pub use fuzz::{Campaign, Fuzz, fuzz};
pub use game::{Course, Game};
pub use handles::{Handles, rename};
pub use script::Script;
pub use shrink::{Counterexample, shrink};
pub use sleepers::nears_sleeper;

use game::Played;
use trial::Trial;

/// A property that every run has, whatever its result.
///
/// Where states have to be equal, their hashes are compared after every tick: [`World::state_hash`](umbra_physics::World::state_hash).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Oracle {
    /// A second match with the same inputs has the same states. It finds clocks, hash maps and data that matches share.
    Repeat,
    /// A command is refused if [`check`](umbra_physics::World::check) says so, for the same reason, and then changes nothing.
    Refusal,
    /// A recording of all that the driver was given plays to the same states. It finds changes made past the driver.
    Record,
    /// A new match on a copy of the world, by way of a snapshot and of its bytes, makes the same of each tick. It finds state
    /// beside the world.
    Restore,
    /// The inputs of a tick lead to the same state in whatever order they arrive. Of a script, bodies that are added one
    /// after the other, and so fields other than drags, forces and torques, lead to the same
    /// [motion](umbra_physics::World::physics_hash) in any order.
    Order,
    /// Bodies that interact with nothing, up to 17, change no bit of the others, of what was applied to them, or of what the
    /// game keeps in the world; they come and go, sleep, hang on springs, leave the envelope. Bystanders have keys from 2^63
    /// on; a game has to know its own bodies, as bystanders are among [`World::bodies`](umbra_physics::World::bodies).
    Bystanders,
    /// In a match that is the mirror image all stays so, to the bit: if the game has a symmetry that mirrors, for as long as
    /// inputs have images.
    Mirror,
    /// In a match turned by a quarter all stays so, to the bit, under the same conditions.
    Turn,
    /// In a match that is shifted by an even number of ulps along each axis all stays so, to the bit, for as long as no body
    /// is more than 2^29 m out.
    Shift,
    /// A step that is undone leads to the state before it and on to the one after it, and one that cannot be undone leaves
    /// the world as it was.
    Reverse,
    /// A step that is traced, which takes all bodies stage by stage, leads to the same state, and a step with all bodies awake
    /// moves them in the same way; the latter is checked of steps that no awake body begins or ends [near a sleeper](nears_sleeper), while no body
    /// sleeps that a command has put to sleep.
    Paths,
    /// On two threads, with as many bystanders as make a step use them, the bodies move as on one: with the feature
    /// `parallel`, and unless all steps are of [`PublishedVerlet`](umbra_physics::Integrator::PublishedVerlet), which uses one
    /// thread.
    Threads,
    /// The [energy](umbra_physics::World::energy) of a world that nobody acts on never exceeds that after the last input by more
    /// than a thousandth of its kinetic and of its potential part, what lifts all bodies by 5 mm, the roundings of the solver
    /// (4 µm/s of each body), and what a wedge leaves of the speed of pushing out (a 64th of
    /// [`push_speed`](umbra_physics::ContactSettings::push_speed) of each body). A command that is carried out is an input, and so is
    /// a force until the end of its step. It finds impacts, and changes past the driver, that add energy.
    ///
    /// Worlds are judged that nothing else gives energy to: no kinematic body moves, no collider has a
    /// [`surface_speed`](umbra_physics::Material::surface_speed), all dynamic bodies have the same
    /// [`dominance`](umbra_physics::BodyDef::dominance), there is no force field but drag without wind, no joint has a spring or a
    /// motor with a speed, a step is at most a thirtieth of a second, and the integrator is `VelocityVerlet`, `Yoshida4` or `SymplecticEuler`: the others gain energy in
    /// free flight. Damping, largest speeds and sleep only take energy. Where bodies overlap by more than 5 mm after the last
    /// input, pushing them out may lift them by more: steps are judged from the first one on that starts without such an overlap.
    /// A body that leaves the envelope is a new start, too.
    Energy,
}

impl Oracle {
    /// All oracles. The ones that find most come first.
    pub const ALL: [Self; 13] = [
        Self::Repeat,
        Self::Refusal,
        Self::Record,
        Self::Restore,
        Self::Order,
        Self::Bystanders,
        Self::Mirror,
        Self::Turn,
        Self::Shift,
        Self::Reverse,
        Self::Paths,
        Self::Threads,
        Self::Energy,
    ];

    /// The name: one word in lower case.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Repeat => "repeat",
            Self::Refusal => "refusal",
            Self::Record => "record",
            Self::Restore => "restore",
            Self::Order => "order",
            Self::Bystanders => "bystanders",
            Self::Mirror => "mirror",
            Self::Turn => "turn",
            Self::Shift => "shift",
            Self::Reverse => "reverse",
            Self::Paths => "paths",
            Self::Threads => "threads",
            Self::Energy => "energy",
        }
    }

    /// Checks a match of a game.
    ///
    /// # Errors
    /// The first [`Violation`].
    pub fn judge<G: Game>(self, game: &G, course: &Course<G::Input>) -> Result<Verdict, Box<Violation>> {
        Trial::new(self, &Played(game), course).judge()
    }
}

impl fmt::Display for Oracle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The result of a check that found nothing wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Verdict {
    /// The property holds.
    Held,
    /// The run has nothing that the oracle could check.
    Inapplicable {
        /// The reason.
        why: &'static str,
    },
}

/// A failed check: a run that breaks the property of an oracle.
///
/// ```
/// use umbra_oracles::{Oracle, Script, Verdict, Violation};
/// use umbra_physics::{BodyDef, Command, WorldDef};
///
/// let script =
///     Script { world: WorldDef::default(), commands: vec![(0, Command::AddBody(BodyDef::dynamic()))], ticks: 5 };
/// let said = |violation: Box<Violation>| format!("{violation} [E{}]", violation.code());
/// for oracle in Oracle::ALL {
///     match script.judge(oracle).map_err(said)? {
///         Verdict::Held => println!("{}: held", oracle.name()),
///         Verdict::Inapplicable { why } => println!("{oracle}: nothing to judge, {why}"),
///         _ => {}
///     }
/// }
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Violation {
    /// The oracle that found it.
    pub oracle: Oracle,
    /// The tick of the run that was being made: 0 is the first.
    pub tick: u64,
    /// The run that this one was compared with, or the fault seen in it.
    pub beside: &'static str,
    /// The first value that differs: on the left as it is in the run, or has to be, on the right as it is in the other.
    /// None where there is no such value: a file that cannot be read, say.
    pub difference: Option<Difference>,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { oracle, tick, beside, difference } = self;
        write!(f, "{oracle}, tick {tick}, {beside}")?;
        difference.as_ref().map_or(Ok(()), |difference| write!(f, ": {difference:#}"))
    }
}

impl Violation {
    /// The number by which `docs/errors.md` lists it. It is the same in every version, and no other error has it.
    #[must_use]
    pub const fn code(&self) -> u16 {
        620
    }
}

impl core::error::Error for Violation {}
