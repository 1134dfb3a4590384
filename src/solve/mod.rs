//! The solver: impulses at contacts, as corrections on top of the free flight of a step.
//!
//! A step is divided into sub-steps. In each, contacts are solved with soft constraints, bodies move, and contacts are relaxed
//! without the softness (TGS soft). [`Solver::solve`] is given the free flight of all bodies by its ends and the contacts at the start
//! poses; it returns the exact impulses of contacts and the corrections of bodies that follow from them.
//!
//! - The two points of a contact are one block: a 2×2 linear complementarity problem, solved without iterations, with one friction row for
//!   both. Softness is in the diagonal of its matrix, for the points that are pressed.
//! - Contacts of a phase do not see each other (Jacobi), and share the masses of their bodies. There are three phases, by `graph`.
//! - Velocities are multiples of 2^-22 m/s, of more in islands that are faster, and factors have 30 bits; both are held in 32 bits, products
//!   and impulses in 64. Lanes of 64 bits hold both, with the same bits for any number of them.
//! - The unit of the impulses of a contact is a power of two of its own, such that no sum of a phase overflows: `pass` has the proofs. Changes
//!   beyond the range of a pass are cut off, oddly, and counted.
//!
//! A body has four forms, each in place of the one before: its columns in the world, a [`Flight`], a row of `BodyRows` through the
//! sub-steps, and a [`Correction`]. A contact has three: a [`Contact`], a lane of `ContactGroups` and [`Impulses`].
//!
//! The modules, in the order of a step:
//!
//! - `graph`: islands, levels and phases.
//! - `bodies`: units, and rows and masses of bodies; `unit`: the constants that follow from a unit.
//! - `joint`: joints, which are solved before the contacts.
//! - `groups`: the contacts in groups of lanes; `group`: one group; `load`, `batch`, `matrix`: its values, rows, factors and
//!   inverse matrices.
//! - `heavy`: loads for which joints give way, and for which worlds take finer sub-steps.
//! - `push`, `wedge`: limits of pushes, at one contact, and at bodies that several contacts push out.
//! - `follow`: bodies that contacts are not to move.
//! - `substeps`: the order of all that a sub-step does.
//! - `motion`: velocities and displacements through the sub-steps.
//! - `impact`: impacts at their moments, before the passes of a sub-step.
//! - `pass`: the loops over contacts; `cut`: contacts with values that are too large for these loops.
//! - `rolling`: rolling resistance, after the friction of a phase.
//! - `apply`: exact impulses, applied once; `limbs`: their sums.
//! - `contact_solver`: the interface of a solver; `float`: a solver in floats.
//! - `number`, `vectors`: rounding and shifts of integers and of lanes.

mod apply;
mod batch;
mod bodies;
mod contact_solver;
mod cut;
#[cfg(feature = "float")]
mod float;
mod follow;
mod graph;
mod group;
mod groups;
mod heavy;
mod impact;
mod joint;
mod limbs;
mod load;
mod matrix;
mod motion;
mod number;
mod pass;
mod push;
mod rolling;
mod substeps;
#[cfg(test)]
mod tests;
mod unit;
mod vectors;
mod wedge;

use alloc::vec::Vec;

use self::apply::{Apply, ImpulseSums, Path};
use self::bodies::BodyRows;
pub use self::contact_solver::{ContactImpact, ContactSolver};
#[cfg(feature = "float")]
pub use self::float::FloatSolver;
use self::follow::{follow, set_followers};
use self::graph::graph_start;
pub(crate) use self::graph::{Graph, PHASES};
use self::groups::ContactGroups;
pub(crate) use self::heavy::{is_heavy, may_be_heavy};
use self::impact::Impacts;
use self::joint::Joints;
pub use self::joint::{Axis, AxisSpring, Joint, JointKind};
use self::motion::FlightRow;
use self::number::{log2_above, lowered_word};
use self::pass::{Pass, PassOver};
use self::rolling::Rolls;
use self::substeps::SubSteps;
use self::unit::{COARSE, Clock, Softness};
use self::wedge::{Push, limit_wedges};
use crate::fx;
use crate::fx::Fx;
use crate::kernel::simd::{self, Job, Lanes};
use crate::math::{TimeStep, Vec2};
use crate::scalar::{FxAccumulator, FxFactor};
#[cfg(feature = "timers")]
use crate::timers::Timers;
use crate::timers::{counted, timed};

/// Settings of the solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SolverOptions {
    /// Sub-steps of a step, 1 to 16.
    pub substeps: u32,
    /// Frequency of soft contacts over the rate of sub-steps. This and the damping ratio were tuned together: at 0.125 a house
    /// of cards gives way more than Box2D's, at 0.18 a pile of 500 bodies does not come to rest (`docs/contacts.md`).
    pub frequency: Fx,
    /// Damping ratio of soft contacts.
    pub damping_ratio: Fx,
    /// Frequency of joints in loops over the rate of sub-steps.
    pub joint_frequency: Fx,
    /// Damping ratio of joints in loops. Joints in trees have a softness of their own.
    pub joint_damping_ratio: Fx,
    /// The largest velocity by which overlaps are pushed out, m/s.
    pub push_speed: Fx,
    /// Bodies bounce where they meet faster than this, m/s.
    pub restitution_speed: Fx,
    /// Relax passes of a sub-step, 1 to 65.
    pub relax_passes: u32,
    /// Times that joints and contacts are solved in turn in a sub-step, from 1; for worlds whose islands all have both.
    pub joint_rounds: u32,
}

impl Default for SolverOptions {
    fn default() -> Self {
        Self {
            substeps: 5,
            frequency: fx!(0.15625),
            damping_ratio: fx!(10),
            joint_frequency: fx!(0.25),
            joint_damping_ratio: fx!(12),
            push_speed: fx!(3),
            restitution_speed: fx!(1),
            relax_passes: 1,
            joint_rounds: 1,
        }
    }
}

/// A velocity, linear in m/s and angular in rad/s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Velocity {
    /// m/s
    pub linear: Vec2,
    /// rad/s
    pub angular: Fx,
}

/// A body and its free flight over the step, in place of its columns in the world.
#[derive(Clone, Copy, Debug)]
pub struct Flight {
    /// The centre of mass at the start, m.
    pub position: Vec2,
    /// The velocity at the start.
    pub start: Velocity,
    /// The velocity at the end.
    pub end: Velocity,
    /// The displacement, m.
    pub displacement: Vec2,
    /// The angle turned, rad.
    pub rotation: Fx,
    /// kg; not zero for a body that can be moved.
    pub mass: Fx,
    /// 1/m along x and y, 1/kg.
    pub inverse_mass: Vec2<FxFactor>,
    /// 1/I, 1/(kg·m²).
    pub inverse_inertia: FxFactor,
    /// Largest distance of a point of its colliders, or of an anchor of its joints, from the centre of mass, m; positive.
    pub radius: Fx,
    /// The index of the flight that this one follows: it is fixed, and moves as that body does through the sub-steps.
    pub leader: Option<u32>,
}

impl Flight {
    /// Returns true for a body that no impulse changes.
    pub(crate) fn is_fixed(&self) -> bool {
        let is_zero = |factor: FxFactor| factor.parts().0 == 0;
        is_zero(self.inverse_mass.x) && is_zero(self.inverse_mass.y) && is_zero(self.inverse_inertia)
    }

    /// Returns true if the masses and the radius are the same.
    #[inline(always)]
    fn is_alike(&self, flight: &Self) -> bool {
        let measures = |flight: &Self| (flight.inverse_mass, flight.inverse_inertia, flight.radius);
        measures(self) == measures(flight)
    }

    /// log2 of the length of the body in the solver.
    fn length(&self) -> i32 {
        log2_above(self.radius)
    }

    /// Returns true if its free flight has a velocity.
    fn is_moving(&self) -> bool {
        self.start != Velocity::default() || self.end != Velocity::default()
    }

    /// The largest speed of its free flight, in 2^-[`COARSE`] m/s, rounded up.
    #[inline(always)]
    fn speed(&self, length: i32) -> u64 {
        let Self { start, end, .. } = self;
        let larger = |a: Fx, b: Fx| a.to_bits().unsigned_abs().max(b.to_bits().unsigned_abs());
        let linear = larger(start.linear.x, end.linear.x).max(larger(start.linear.y, end.linear.y));
        // At the rim: times 2^length.
        let (angular, down) = (larger(start.angular, end.angular), 32 - COARSE - length);
        let rim = match down {
            0.. => angular >> down.min(63),
            _ if angular.leading_zeros() as i32 + down > 0 => angular << -down,
            _ => u64::MAX >> 1,
        };
        (linear >> (32 - COARSE)).max(rim) + 1
    }

    /// The flight in units of 2^unit m/s, with the length at hand.
    #[inline(always)]
    fn row(&self, unit: i32, length: i32) -> FlightRow {
        let Self { start, end, .. } = self;
        let linear = |v: Fx| lowered_word(v.to_bits(), 32 + unit) as i32;
        let angular = |v: Fx| lowered_word(v.to_bits(), 32 + unit - length) as i32;
        let [x, y, turn] = [linear(start.linear.x), linear(start.linear.y), angular(start.angular)];
        let [end_x, end_y, end_turn] = [linear(end.linear.x), linear(end.linear.y), angular(end.angular)];
        FlightRow { start: [x, y, turn, 0], change: [end_x - x, end_y - y, end_turn - turn, 0] }
    }
}

/// A point of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Point {
    /// From the centre of mass of the first and of the second body, m.
    pub arms: [Vec2; 2],
    /// Negative if the bodies overlap, m.
    pub separation: Fx,
}

/// Impulses of a contact or of a joint: multiples of 2^exponent N·s, over the last sub-step. They are left of the lane of a contact when the
/// sub-steps are done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Impulses {
    /// Impulses along the normal by point, which are not negative; then the one along the tangent (n.y, −n.x). With one point the
    /// second value is rolling resistance: an impulse at the lever [`Contact::rolling_radius`] that turns the second body
    /// counter-clockwise. For joints see [`Joint::impulses`].
    pub values: [i64; 3],
    /// log2 of their unit.
    pub exponent: i32,
}

impl Impulses {
    /// The impulses of the same forces over a sub-step of num/den of the length. Rounded to nearest, halves away from zero, and within
    /// ±2^62 units.
    pub(crate) fn rescaled(self, num: u64, den: u64) -> Self {
        if num == den {
            return self;
        }
        let scaled = |impulse: i64| {
            // Below 2^62 · 2^64: it fits.
            let product = i128::from(impulse) * i128::from(num);
            let rounded = (product.abs() + i128::from(den / 2)) / i128::from(den);
            let size = rounded.min(1 << 62) as i64;
            if impulse < 0 { -size } else { size }
        };
        Self { values: self.values.map(scaled), ..self }
    }
}

/// A contact of two bodies at the start of the step, in place of the manifold of a pair.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Indices of flights.
    pub bodies: [u32; 2],
    /// Unit vector from the first to the second body, in 2^-30.
    pub normal: [i32; 2],
    /// The number of points: 1 or 2.
    pub count: usize,
    /// The points.
    pub points: [Point; 2],
    /// The coefficient of friction; not negative. More than 32 counts as 32.
    pub friction: Fx,
    /// The coefficient of restitution, 0 to 1.
    pub restitution: Fx,
    /// The coefficient of rolling resistance c, 0 to 1: with one point the contact holds against a torque of up to c·R·N, with
    /// the normal force N and the radius R.
    pub rolling_resistance: Fx,
    /// The radius R, m, up to 2^12; not negative.
    pub rolling_radius: Fx,
    /// The velocity of the surfaces against each other along the tangent, m/s.
    pub surface_speed: Fx,
    /// The impulses of the last step, by which the solver starts; then the impulses of this step.
    pub impulses: Impulses,
}

/// The change of a body by all impulses of a step, in place of its row: in metres and seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Correction {
    /// True if the body changes; its contacts set it too where they push others and the changes add up to nothing.
    pub is_pushed: bool,
    /// m/s
    pub velocity: Vec2<FxAccumulator>,
    /// rad/s
    pub angular_velocity: FxAccumulator,
    /// m
    pub displacement: Vec2<FxAccumulator>,
    /// rad
    pub rotation: FxAccumulator,
}

/// Counts of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SolverCounts {
    /// Impulses, velocities and errors of joints that the passes cut off at the limits of the solver.
    pub cut: u64,
}

/// The step that is solved, as all parts are prepared from it.
struct StepInput<'a> {
    clock: &'a Clock,
    softness: &'a Softness,
    flights: &'a [Flight],
    joints: &'a [Joint],
    contacts: &'a [Contact],
}

/// The solver. It has no state: results do not depend on earlier steps, and each part has the memory of its own work.
#[derive(Clone, Debug, Default)]
pub struct Solver {
    graph: Graph,
    bodies: BodyRows,
    groups: ContactGroups,
    joints: Joints,
    /// Paths by body; empty without joints.
    paths: Vec<Path>,
    rolls: Rolls,
    impacts: Impacts,
    /// Contacts that push a body out of one that does not give way.
    pushes: Vec<Push>,
    impulses: ImpulseSums,
    #[cfg(feature = "timers")]
    timers: Timers,
}

impl Solver {
    /// Solves a step: writes impulses to joints and contacts and the corrections of bodies to `corrections`, one for each flight.
    pub fn solve(
        &mut self,
        time_step: TimeStep,
        options: &SolverOptions,
        flights: &[Flight],
        joints: &mut [Joint],
        contacts: &mut [Contact],
        corrections: &mut Vec<Correction>,
    ) -> SolverCounts {
        self.prepare(time_step, options, flights, joints, contacts);
        let cut = timed!(self, passes, self.run_passes(time_step, options, contacts));
        timed!(self, apply, self.finish(time_step, options, flights, joints, contacts, corrections));
        counted!(self, islands, self.graph.islands());
        counted!(self, impacts, self.impacts.strikes.len());
        counted!(self, cut, cut);
        SolverCounts { cut }
    }

    /// The first part of [`solve`](Self::solve): rows, joints and groups.
    pub fn prepare(
        &mut self,
        time_step: TimeStep,
        options: &SolverOptions,
        flights: &[Flight],
        joints: &[Joint],
        contacts: &[Contact],
    ) {
        let Self { graph, bodies, groups, joints: blocks, paths, rolls, impacts, pushes, .. } = self;
        let clock = Clock::new(time_step, options.substeps);
        let softness = Softness::new(options);
        let input = StepInput { clock: &clock, softness: &softness, flights, joints, contacts };
        let joint_links = joints.iter().map(|joint| joint.bodies);
        let links = joint_links.chain(contacts.iter().map(|contact| contact.bodies));
        let is_fixed = |body: u32| flights[body as usize].is_fixed();
        let start = |members: &[u32], queue: &mut Vec<u32>| graph_start(flights, members, queue);
        let is_new_graph = graph.build(is_fixed, flights.len(), links, start);
        bodies.set(&input, graph);
        blocks.set(&input, graph, bodies);
        groups.set(&input, graph, is_new_graph, bodies, pushes);
        limit_wedges(pushes, groups);
        set_followers(bodies, flights);
        rolls.set(&input, graph, bodies, groups);
        blocks.set_paths(&input, graph, paths);
        impacts.clear();
    }

    /// The sub-steps, after [`prepare`](Self::prepare). Returns the number of values that were cut off.
    pub fn run_passes(&mut self, time_step: TimeStep, options: &SolverOptions, contacts: &[Contact]) -> u64 {
        let clock = Clock::new(time_step, options.substeps);
        simd::run(SubSteps { solver: self, clock: &clock, options, contacts })
    }

    /// A pass over the contacts of all phases.
    #[inline(always)]
    fn pass<L: Lanes>(&mut self, pass: Pass, lanes: L) -> u64 {
        let Self { bodies, groups: ContactGroups { groups, phases, shares, .. }, rolls, .. } = self;
        let mut cut = 0;
        for phase in 0..PHASES {
            let phase_groups = &mut groups[phases[phase].clone()];
            cut += PassOver { pass, groups: phase_groups, rows: &mut bodies.rows, touched: &shares.touched[phase] }
                .run(lanes);
            cut += rolls.run(phase, pass, groups, &mut bodies.rows, lanes);
            follow(bodies);
        }
        cut
    }

    /// The last part of [`solve`](Self::solve), after [`run_passes`](Self::run_passes): impulses and corrections.
    pub fn finish(
        &mut self,
        time_step: TimeStep,
        options: &SolverOptions,
        flights: &[Flight],
        joints: &mut [Joint],
        contacts: &mut [Contact],
        corrections: &mut Vec<Correction>,
    ) {
        let clock = Clock::new(time_step, options.substeps);
        let Self { bodies, groups, joints: blocks, paths, rolls, impacts, impulses, .. } = self;
        impacts.sum_strikes();
        let strikes = &impacts.strikes;
        impulses.begin(flights.len(), !(joints.is_empty() && rolls.is_empty() && strikes.is_empty()));
        blocks.apply(flights, joints, &mut impulses.totals);
        let apply =
            Apply { clock: &clock, bodies, groups, rolls, strikes, paths, impulses, flights, contacts, corrections };
        simd::run(apply);
    }
}

impl ContactSolver for Solver {
    fn solve(
        &mut self,
        time_step: TimeStep,
        options: &SolverOptions,
        flights: &[Flight],
        joints: &mut [Joint],
        contacts: &mut [Contact],
        corrections: &mut Vec<Correction>,
    ) {
        self.solve(time_step, options, flights, joints, contacts, corrections);
    }

    #[cfg(feature = "timers")]
    fn take_timers(&mut self) -> Timers {
        let mut timers = core::mem::take(&mut self.timers);
        // Impacts are solved among the passes.
        timers.times.passes = timers.times.passes.saturating_sub(timers.times.impacts);
        timers
    }

    fn totals(&self) -> impl Iterator<Item = (u32, [i64; 2], i32)> + '_ {
        self.groups.totals()
    }

    fn joint_totals(&self) -> impl Iterator<Item = (u32, [i128; 3])> + '_ {
        self.joints.totals()
    }

    fn impacts<'a>(&'a self, contacts: &'a [Contact]) -> impl Iterator<Item = ContactImpact> + 'a {
        self.impacts.list(&self.graph, &self.bodies, &self.groups, contacts)
    }
}
