//! Runs that can be checked: those of a game, and of a script.

use std::collections::BTreeMap;

use super::{Handles, Script};
use umbra_physics::{
    Command, Created, FieldKind, ForceField, ForceOrImpulse, Fx, Stepper, Symmetry, Vec2, World, WorldDef, fx,
};

/// A game whose ticks are to be checked.
///
/// All of a game's state is meant to be in its world: user data, [`World::random_mut`], [`World::set_blob`]. A value of this
/// type is a match that has not begun; oracles clone it, begin it, and find what a match keeps beside its world.
///
/// All that a tick does to the world goes through the driver, as `SceneRun::advance_by` of `umbra-scene`
/// does it: commands, and one step. Otherwise oracles cannot see to it; the world's generator and blob are free. In the
/// game itself the driver is `&mut ()`, or a [`Recorder`](umbra_physics::Recorder).
pub trait Game: Clone {
    /// An input: what a player does in a tick.
    type Input: Clone;

    /// Begins a match: the world before its first tick. Handles may be kept, as they are the same in every match.
    fn start(&mut self) -> World;

    /// Makes a tick, with the inputs of all players in whatever order they arrived.
    fn tick(&mut self, world: &mut World, inputs: &[Self::Input], driver: &mut dyn Stepper);

    /// The symmetries that the game has, for [`Oracle::Mirror`](super::Oracle::Mirror), `Turn` and `Shift`: none, unless it
    /// says so.
    fn symmetries(&self) -> Vec<Symmetry> {
        Vec::new()
    }

    /// Returns the image of an input in a match that is the image of this one; `None` if it has none.
    fn image(&self, input: &Self::Input, symmetry: &Symmetry) -> Option<Self::Input> {
        let _ = (input, symmetry);
        None
    }

    /// Returns the input for a match whose bodies and fields have other handles. Only inputs that name handles change.
    fn renamed(&self, input: &Self::Input, handles: &Handles) -> Self::Input {
        let _ = handles;
        input.clone()
    }

    /// The groups that bystanders are in, for [`Oracle::Bystanders`](super::Oracle::Bystanders): none, unless it says so. Fields
    /// act on bystanders in their groups. Colliders of bystanders are in category 31 and meet that alone: no other may be in it.
    fn bystander_groups(&self) -> u32 {
        0
    }
}

/// The inputs of a run by tick, and how many ticks it makes.
///
/// ```
/// use umbra_oracles::{Course, Game, Handles, Oracle, Verdict, shrink};
/// use umbra_physics::{Command, Stepper, World, WorldDef};
///
/// /// A game whose inputs are the commands themselves. They name bodies: a match with bystanders has others.
/// #[derive(Clone)]
/// struct Plain;
///
/// impl Game for Plain {
///     type Input = Command;
///
///     fn start(&mut self) -> World {
///         World::new(WorldDef::default()).unwrap()
///     }
///
///     fn tick(&mut self, world: &mut World, inputs: &[Command], driver: &mut dyn Stepper) {
///         for command in inputs {
///             let _ = driver.execute(world, command);
///         }
///         driver.step(world);
///     }
///
///     fn renamed(&self, input: &Command, handles: &Handles) -> Command {
///         handles.command(input)
///     }
/// }
///
/// let course = Course { inputs: vec![(3, Command::AddBody(umbra_physics::BodyDef::dynamic()))], ticks: 10 };
/// assert_eq!(Oracle::Repeat.judge(&Plain, &course), Ok(Verdict::Held));
/// assert!(shrink(&Plain, &course, Oracle::Repeat, 100).is_none()); // nothing is wrong with it
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Course<I> {
    /// The inputs, each at its tick; ticks may stand in any order, and those from `ticks` on are never come to.
    pub inputs: Vec<(u64, I)>,
    /// The number of ticks.
    pub ticks: u64,
}

/// Inputs by tick, to look up.
pub(super) type ByTick<I> = BTreeMap<u64, Vec<I>>;

impl<I: Clone> Course<I> {
    pub(super) fn by_tick(&self) -> ByTick<I> {
        let mut ticks = ByTick::new();
        for (tick, input) in self.inputs.iter().filter(|(tick, _)| *tick < self.ticks) {
            ticks.entry(*tick).or_insert_with(Vec::new).push(input.clone());
        }
        ticks
    }

    /// The places of the inputs in the list, by tick.
    pub(super) fn order(&self) -> Vec<(u64, usize)> {
        let mut order: Vec<(u64, usize)> = self.inputs.iter().enumerate().map(|(i, (tick, _))| (*tick, i)).collect();
        order.sort_by_key(|(tick, _)| *tick);
        order
    }
}

/// The part of the state in which a run in another order has to be the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Likeness {
    /// All of the state.
    State,
    /// The motion of the bodies, whatever their handles.
    Motion,
}

/// A game or a script, as oracles see it.
pub(super) trait Subject {
    type Input: Clone;
    /// A match that has begun.
    type Match;
    /// The bodies, fields and colliders that inputs make, by the places of the inputs in the list.
    type Made;
    /// True if inputs are the commands themselves, so that handles in them may be of the same tick.
    const IS_COMMANDS: bool;

    /// A match and its world; none of a world that is refused.
    fn begin(&self) -> Option<(Self::Match, World)>;
    fn tick(&self, game: &mut Self::Match, world: &mut World, inputs: &[Self::Input], driver: &mut dyn Stepper);
    fn symmetries(&self) -> Vec<Symmetry>;
    fn image(&self, input: &Self::Input, symmetry: &Symmetry) -> Option<Self::Input>;
    fn renamed(&self, input: &Self::Input, handles: &Handles) -> Self::Input;
    fn bystander_groups(&self) -> u32;
    /// Returns what inputs make, for [`arranged`](Self::arranged).
    fn made(&self, course: &Course<Self::Input>) -> Self::Made;
    /// The inputs at other ticks and in another order, by their places in the list.
    fn arranged(
        &self,
        course: &Course<Self::Input>,
        created: &Self::Made,
        order: Vec<(u64, usize)>,
        ticks: u64,
    ) -> Course<Self::Input>;
    /// Returns the inputs in another order, which `turn` makes of lists of places, and what has to be the same then.
    fn reordered(
        &self,
        course: &Course<Self::Input>,
        turn: &mut dyn FnMut(&mut [usize]),
    ) -> (Course<Self::Input>, Likeness);
}

/// A game as it is judged.
pub(super) struct Played<'a, G>(pub(super) &'a G);

impl<G: Game> Subject for Played<'_, G> {
    type Input = G::Input;
    type Match = G;
    type Made = ();
    const IS_COMMANDS: bool = false;

    fn begin(&self) -> Option<(G, World)> {
        let mut game = self.0.clone();
        let world = game.start();
        Some((game, world))
    }

    fn tick(&self, game: &mut G, world: &mut World, inputs: &[G::Input], driver: &mut dyn Stepper) {
        game.tick(world, inputs, driver);
    }

    fn symmetries(&self) -> Vec<Symmetry> {
        self.0.symmetries()
    }

    fn image(&self, input: &G::Input, symmetry: &Symmetry) -> Option<G::Input> {
        self.0.image(input, symmetry)
    }

    fn renamed(&self, input: &G::Input, handles: &Handles) -> G::Input {
        self.0.renamed(input, handles)
    }

    fn bystander_groups(&self) -> u32 {
        self.0.bystander_groups()
    }

    fn made(&self, _: &Course<G::Input>) {}

    fn arranged(&self, course: &Course<G::Input>, (): &(), order: Vec<(u64, usize)>, ticks: u64) -> Course<G::Input> {
        Course { inputs: order.into_iter().map(|(tick, i)| (tick, course.inputs[i].1.clone())).collect(), ticks }
    }

    /// The inputs of each tick among themselves.
    fn reordered(&self, course: &Course<G::Input>, turn: &mut dyn FnMut(&mut [usize])) -> (Course<G::Input>, Likeness) {
        let order = course.order();
        let turned = order.chunk_by(|a, b| a.0 == b.0).flat_map(|tick| {
            let mut places: Vec<usize> = tick.iter().map(|(_, i)| *i).collect();
            turn(&mut places);
            tick.iter().map(|(tick, _)| *tick).zip(places).collect::<Vec<_>>()
        });
        (self.arranged(course, &(), turned.collect(), course.ticks), Likeness::State)
    }
}

/// A script as it is judged.
pub(super) struct Commands(pub(super) WorldDef);

impl Subject for Commands {
    type Input = Command;
    type Match = ();
    type Made = BTreeMap<usize, Vec<Created>>;
    const IS_COMMANDS: bool = true;

    fn begin(&self) -> Option<((), World)> {
        World::new(self.0).ok().map(|world| ((), world))
    }

    fn tick(&self, (): &mut (), world: &mut World, inputs: &[Command], driver: &mut dyn Stepper) {
        for command in inputs {
            // What is refused is refused in every run alike.
            _ = driver.execute(world, command);
        }
        driver.step(world);
    }

    /// Every kind, about the origin, where nothing is too far out, and about a point between ulps of two.
    fn symmetries(&self) -> Vec<Symmetry> {
        let ulp = Fx::DELTA;
        let c = fx!(3.25) + ulp;
        let centre = Vec2::new(c, fx!(-1) + ulp + ulp + ulp);
        let about = |symmetry: Symmetry| symmetry.about(centre);
        let kinds = [Symmetry::MIRROR, Symmetry::FLIP, Symmetry::DIAGONAL, Symmetry::TURN];
        let length = |metres: i64, ulps: i64| Fx::from_bits((metres << 32) + ulps);
        let shift = Symmetry::shift(Vec2::new(length(1_000, 2), length(-777, -4)));
        kinds.into_iter().chain(kinds.into_iter().filter_map(about)).chain(shift).collect()
    }

    fn image(&self, command: &Command, symmetry: &Symmetry) -> Option<Command> {
        match command {
            // No custom force is registered here: the field is refused, and so is its image.
            Command::AddField(field) | Command::SetField { field, .. }
                if matches!(field.kind, FieldKind::Custom { .. }) =>
            {
                Some(command.clone())
            }
            command => symmetry.command(command),
        }
    }

    fn renamed(&self, command: &Command, handles: &Handles) -> Command {
        handles.command(command)
    }

    fn bystander_groups(&self) -> u32 {
        // Nobody looks at them, so fields may act on them.
        u32::MAX
    }

    fn made(&self, course: &Course<Command>) -> Self::Made {
        self.script(course).made()
    }

    fn arranged(
        &self,
        course: &Course<Command>,
        created: &Self::Made,
        order: Vec<(u64, usize)>,
        ticks: u64,
    ) -> Course<Command> {
        let Script { commands, ticks, .. } = self.script(course).arranged(created, order, ticks);
        Course { inputs: commands, ticks }
    }

    /// Bodies that are added one after the other among themselves, and so fields, but for drags, which act in order; forces and
    /// torques, but for those that a sleeping body does not feel. Where a field is made a drag later all keep their order.
    fn reordered(&self, course: &Course<Command>, turn: &mut dyn FnMut(&mut [usize])) -> (Course<Command>, Likeness) {
        let is_drag = |field: &ForceField| matches!(field.kind, FieldKind::Drag { .. } | FieldKind::Buoyancy { .. });
        let made_drag = |command: &Command| matches!(command, Command::SetField { field, .. } if is_drag(field));
        let keep_order = course.inputs.iter().any(|(_, command)| made_drag(command));
        let kind =
            |place: usize| match &course.inputs[place].1 {
                Command::AddBody(_) => 1,
                Command::AddField(field) if !keep_order && !is_drag(field) => 2,
                Command::Apply {
                    action: ForceOrImpulse::Force { .. } | ForceOrImpulse::Torque(_), options, ..
                } if options.wake => 3,
                _ => 0,
            };
        let mut order = course.order();
        for run in order.chunk_by_mut(|a, b| a.0 == b.0 && kind(a.1) == kind(b.1)).filter(|run| kind(run[0].1) > 0) {
            let mut places: Vec<usize> = run.iter().map(|(_, place)| *place).collect();
            turn(&mut places);
            run.iter_mut().zip(places).for_each(|((_, place), turned)| *place = turned);
        }
        (self.arranged(course, &self.made(course), order, course.ticks), Likeness::Motion)
    }
}

impl Commands {
    pub(super) fn script(&self, course: &Course<Command>) -> Script {
        Script { world: self.0, commands: course.inputs.clone(), ticks: course.ticks }
    }
}
