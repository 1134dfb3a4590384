//! The solver: impulses at contacts, as corrections on top of the free flight of a step.
//!
//! A step is divided into sub-steps. In each, contacts are solved with soft constraints, bodies move, and contacts are relaxed
//! without the softness (TGS soft). [`Solver::solve`] is given the free flight of all bodies by its ends and the contacts at the start
//! poses; it returns the exact impulses of contacts and the corrections of bodies that follow from them.
//!
//! - `graph`: islands, levels and phases.
//! - `unit`: the unit of velocity of an island, and the constants of soft contacts.
//! - `motion`: velocities and displacements through the sub-steps.
//! - `contact`: rows, masses and matrices of contacts.
//! - `joint`: joints, which are solved before the contacts.
//! - `pass`: the loops over contacts.
//! - `restitution`: bouncing, once a step.
//! - `apply`: exact impulses, applied once.

mod apply;
mod contact;
mod graph;
mod joint;
mod motion;
mod number;
mod pass;
mod restitution;
#[cfg(test)]
mod tests;
mod unit;

use alloc::vec::Vec;

use self::apply::Path;
use self::contact::{BodyOf, ContactOf, Group, PointOf};
use self::graph::{Graph, PHASES};
use self::joint::{Common, Joints};
pub use self::joint::{Joint, JointKind};
use self::motion::{Advance, Begin, FlightRow, Rows};
use self::number::{log2_above, shifted};
use self::pass::{Pass, PassOver};
use self::restitution::Bounces;
use self::unit::{Clock, Softness, rim_speed, unit_for};
use crate::fx;
use crate::fx::Fx;
use crate::kernel::simd::{self, GROUP};
use crate::math::{TimeStep, Vec2};
use crate::scalar::{FxAccumulator, FxFactor};

/// Settings of the solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SolverOptions {
    /// Sub-steps of a step, 1 to 8.
    pub substeps: u32,
    /// Frequency of soft contacts over the rate of sub-steps.
    pub frequency: Fx,
    /// Damping ratio of soft contacts.
    pub damping_ratio: Fx,
    /// Frequency of joints over the rate of sub-steps; half of it where a body has several joints in a phase.
    pub joint_frequency: Fx,
    /// Damping ratio of joints; four times it where a body has several joints in a phase.
    pub joint_damping_ratio: Fx,
    /// The largest velocity by which overlaps are pushed out, m/s.
    pub push_speed: Fx,
    /// Bodies bounce where they meet faster than this, m/s.
    pub restitution_speed: Fx,
}

impl Default for SolverOptions {
    fn default() -> Self {
        Self {
            substeps: 5,
            frequency: fx!(0.15625),
            damping_ratio: fx!(10),
            joint_frequency: fx!(0.25),
            joint_damping_ratio: fx!(2),
            push_speed: fx!(3),
            restitution_speed: fx!(1),
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

/// A body and its free flight over the step.
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
    /// kg·m²; zero if infinite.
    pub inertia: FxFactor,
    /// 1/m along x and y, 1/kg.
    pub inverse_mass: Vec2<FxFactor>,
    /// 1/I, 1/(kg·m²).
    pub inverse_inertia: FxFactor,
    /// Largest distance of a point of its colliders, or of an anchor of its joints, from the centre of mass, m; positive.
    pub radius: Fx,
}

impl Flight {
    fn is_fixed(&self) -> bool {
        let zero = |factor: FxFactor| factor.parts().0 == 0;
        zero(self.inverse_mass.x) && zero(self.inverse_mass.y) && zero(self.inverse_inertia)
    }

    /// log2 of the length of the body in the solver.
    fn length(&self) -> i32 {
        log2_above(self.radius)
    }

    /// The largest speed of its free flight, in 2^-32 m/s.
    fn speed(&self) -> u128 {
        let length = self.length();
        let of = |velocity: Velocity| {
            let [x, y] = [velocity.linear.x, velocity.linear.y].map(|v| u128::from(v.to_bits().unsigned_abs()));
            x.max(y).max(rim_speed(velocity.angular, length))
        };
        of(self.start).max(of(self.end))
    }

    /// The flight in units of 2^unit m/s.
    fn row(&self, unit: i32) -> FlightRow {
        let length = self.length();
        let of = |velocity: Velocity| {
            let [x, y] = [velocity.linear.x, velocity.linear.y].map(|v| shifted(v.to_bits().into(), 32 + unit) as i32);
            [x, y, shifted(velocity.angular.to_bits().into(), 32 + unit - length) as i32, 0]
        };
        let (start, end) = (of(self.start), of(self.end));
        FlightRow { start, change: [0, 1, 2, 3].map(|i| end[i] - start[i]) }
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

/// Impulses of a contact or of a joint: multiples of 2^exponent N·s, over the last sub-step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Impulses {
    /// Along the normal, by point; then along the tangent (n.y, −n.x). For joints see [`Joint::impulses`].
    pub values: [i64; 3],
    /// log2 of their unit.
    pub exponent: i32,
}

/// A contact of two bodies, at the start of the step.
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
    /// The coefficient of friction.
    pub friction: Fx,
    /// The coefficient of restitution, 0 to 1.
    pub restitution: Fx,
    /// The velocity of the surfaces against each other along the tangent, m/s.
    pub surface_speed: Fx,
    /// The impulses of the last step, by which the solver starts; then those of this step.
    pub impulses: Impulses,
}

/// The change of a body by all impulses of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Correction {
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
    /// Changes of velocity, displacement or impulse that were cut off at the limits of the solver.
    pub cut: u64,
}

/// The place of a contact in the groups.
#[derive(Clone, Copy, Debug)]
struct Place {
    contact: u32,
    group: u32,
    lane: u32,
    /// log2 of the unit of its impulses, N·s.
    exponent: i32,
}

/// The buffers of the solver. It has no state: results do not depend on what it solved before.
#[derive(Clone, Debug, Default)]
pub struct Solver {
    graph: Graph,
    rows: Rows,
    /// Row by body.
    row_of: Vec<u32>,
    /// log2 of the unit of velocity by body.
    unit_of: Vec<i32>,
    groups: Vec<Group>,
    /// Ends of the phases in `groups`.
    phases: [core::ops::Range<usize>; PHASES],
    /// Rows with contacts, by phase.
    touched: [Vec<u32>; PHASES],
    joints: Joints,
    /// By body; empty without joints.
    paths: Vec<Path>,
    shares: Vec<u32>,
    places: Vec<Place>,
    /// Rows of fixed bodies that move: body, unit, row.
    carriers: Vec<(u32, i32, u32)>,
    bounces: Bounces,
}

/// The row of bodies that neither move nor can be moved.
const STILL: u32 = 0;

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
        let cut = self.run_passes(options.substeps);
        self.finish(time_step, options, flights, joints, contacts, corrections);
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
        let clock = Clock::new(time_step, options.substeps);
        let links = joints.iter().map(|joint| joint.bodies).chain(contacts.iter().map(|contact| contact.bodies));
        let is_fixed = |body: u32| flights[body as usize].is_fixed();
        self.graph.build(is_fixed, flights.len(), links, |members, queue| {
            graph_start(flights, members, queue);
        });
        self.set_rows(&clock, flights, joints);
        let softness = Softness::new(options);
        self.groups.clear();
        self.places.clear();
        self.carriers.clear();
        let common = Common { clock: &clock, softness: &softness, flights };
        self.set_joints(joints, &common);
        for phase in 0..PHASES {
            self.set_phase(phase, &clock, &softness, flights, contacts);
        }
        self.set_paths(joints, contacts, &common);
    }

    /// The last part of [`solve`](Self::solve), after [`run_passes`](Self::run_passes): bouncing, impulses and corrections.
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
        self.bounce(&clock, options, flights, contacts);
        self.apply(&clock, flights, joints, contacts, corrections);
    }

    /// Chooses units and makes the rows of bodies that touch.
    fn set_rows(&mut self, clock: &Clock, flights: &[Flight], joints: &[Joint]) {
        let mut fastest = alloc::vec![0; self.graph.islands];
        for (body, flight) in flights.iter().enumerate() {
            if let Some(island) = self.graph.island_of(body as u32) {
                let fastest: &mut u128 = &mut fastest[island as usize];
                *fastest = (*fastest).max(flight.speed());
            }
        }
        self.fixed_speeds(flights, &mut fastest);
        self.joint_speeds(clock, flights, joints, &mut fastest);
        self.rows.clear();
        self.rows.push(FlightRow::default());
        self.row_of.clear();
        self.unit_of.clear();
        for (body, flight) in flights.iter().enumerate() {
            let (row, unit) = match self.graph.island_of(body as u32) {
                Some(island) => {
                    let unit = unit_for(fastest[island as usize], clock.substeps);
                    (self.rows.push(flight.row(unit)), unit)
                }
                None => (STILL, 0),
            };
            self.row_of.push(row);
            self.unit_of.push(unit);
        }
    }

    /// Fixed bodies that move count in all islands that they touch.
    fn fixed_speeds(&self, flights: &[Flight], fastest: &mut [u128]) {
        for (body, flight) in flights.iter().enumerate() {
            if !flight.is_fixed() {
                continue;
            }
            let speed = flight.speed();
            for other in self.graph.touched_by(body as u32) {
                if let Some(island) = self.graph.island_of(other) {
                    fastest[island as usize] = fastest[island as usize].max(speed);
                }
            }
        }
    }

    /// Puts the contacts of a phase into groups.
    fn set_phase(
        &mut self,
        phase: usize,
        clock: &Clock,
        softness: &Softness,
        flights: &[Flight],
        contacts: &[Contact],
    ) {
        let of_phase = |contact: &&Contact| self.graph.phase(contact.bodies) == phase;
        let links = contacts.iter().filter(of_phase).map(|contact| contact.bodies);
        count_shares(&mut self.shares, &self.row_of, &mut self.touched[phase], links);
        let begin = self.groups.len();
        for (index, contact) in contacts.iter().enumerate() {
            if self.graph.phase(contact.bodies) == phase {
                self.push(begin, index, contact, (clock, softness), flights);
            }
        }
        self.phases[phase] = begin..self.groups.len();
    }

    /// Adds a contact to the groups from `begin` on, with the shares of bodies as they are set.
    fn push(
        &mut self,
        begin: usize,
        index: usize,
        contact: &Contact,
        (clock, softness): (&Clock, &Softness),
        flights: &[Flight],
    ) {
        let Some(mover) = self.graph.mover(contact.bodies) else { return };
        let unit = self.unit_of[mover as usize];
        let points = contact.points.map(|point| PointOf { arms: point.arms, separation: point.separation });
        let of = ContactOf {
            bodies: contact.bodies.map(|body| self.body(body, unit, flights)),
            normal: contact.normal,
            points: &points[..contact.count],
            friction: contact.friction,
            surface: contact.surface_speed,
            impulses: contact.impulses.values,
            exponent: contact.impulses.exponent,
            unit,
        };
        if self.groups.len() == begin || self.groups.last().is_some_and(|group| group.count == GROUP) {
            self.groups.push(Group::empty(STILL));
        }
        let group = self.groups.len() - 1;
        let lane = self.groups[group].count;
        if let Some(exponent) = self.groups[group].push(&of, clock, softness) {
            self.places.push(Place { contact: index as u32, group: group as u32, lane: lane as u32, exponent });
        }
    }

    fn body(&mut self, body: u32, unit: i32, flights: &[Flight]) -> BodyOf {
        let flight = &flights[body as usize];
        let mut row = self.row_of[body as usize];
        if flight.is_fixed() && flight.speed() > 1 {
            // A row for each unit that it is seen in.
            let known = self.carriers.iter().find(|&&(b, u, _)| (b, u) == (body, unit)).map(|&(.., row)| row);
            row = known.unwrap_or_else(|| {
                let row = self.rows.push(flight.row(unit));
                self.carriers.push((body, unit, row));
                row
            });
        }
        BodyOf {
            row,
            inverse_mass: [flight.inverse_mass.x, flight.inverse_mass.y],
            inverse_inertia: flight.inverse_inertia,
            length: flight.length(),
            share: self.shares[body as usize].into(),
        }
    }

    /// Runs all sub-steps. Returns the number of values that were cut off.
    pub fn run_passes(&mut self, substeps: u32) -> u64 {
        let mut cut = 0;
        for k in 1..=substeps {
            simd::run(Begin { rows: &mut self.rows, k, n: substeps });
            if k == 1 {
                for phase in 0..PHASES {
                    cut += self.pass(phase, Pass::WarmStart);
                }
            }
            cut += self.joints.solve(&mut self.rows);
            for phase in 0..PHASES {
                cut += self.pass(phase, Pass::Solve);
            }
            simd::run(Advance { rows: &mut self.rows });
            cut += self.joints.relax(&mut self.rows);
            for phase in 0..PHASES {
                cut += self.pass(phase, Pass::Relax);
            }
        }
        cut
    }

    fn pass(&mut self, phase: usize, pass: Pass) -> u64 {
        let groups = &mut self.groups[self.phases[phase].clone()];
        let rows = &mut self.rows;
        simd::run(PassOver { pass, groups, rows, touched: &self.touched[phase] })
    }
}

/// Counts the joints or contacts of a phase by body, and lists the rows that they can move.
fn count_shares(shares: &mut Vec<u32>, row_of: &[u32], touched: &mut Vec<u32>, links: impl Iterator<Item = [u32; 2]>) {
    shares.clear();
    shares.resize(row_of.len(), 0);
    touched.clear();
    for body in links.flatten() {
        let (count, row) = (&mut shares[body as usize], row_of[body as usize]);
        *count += 1;
        if *count == 1 && row != STILL {
            touched.push(row);
        }
    }
}

/// The bodies at which the levels of an island begin that touches no fixed body: the heaviest ones; among these the nearest to
/// the island's centre of mass.
fn graph_start(flights: &[Flight], members: &[u32], queue: &mut Vec<u32>) {
    let mass = |body: u32| flights[body as usize].mass.to_bits();
    let total: i128 = members.iter().map(|&body| i128::from(mass(body))).sum();
    let Some(heaviest) = members.iter().map(|&body| mass(body)).max() else { return };
    // All masses together have 60 bits.
    let down = (68 - total.leading_zeros() as i32).max(0);
    let weight = |body: u32| i128::from(mass(body) >> down);
    let weights: i128 = members.iter().map(|&body| weight(body)).sum();
    // Offsets from any member: positions differ by less than 2^31.4 m, 2^63.4 units.
    let origin = flights[members[0] as usize].position;
    let offset = |body: u32| {
        let position = flights[body as usize].position;
        [(position.x, origin.x), (position.y, origin.y)].map(|(x, o)| i128::from(x.to_bits()) - i128::from(o.to_bits()))
    };
    let mut sums = [0; 2];
    for &body in members {
        let offset = offset(body);
        (0..2).for_each(|i| sums[i] += weight(body) * offset[i]);
    }
    // From the centre of mass, times the sum of masses: exact, so that ties are ties. Below 2^124.4.
    let from_centre = |body: u32| {
        let offset = offset(body);
        [0, 1].map(|i| (weights * offset[i] - sums[i]).unsigned_abs())
    };
    let heavy = || members.iter().copied().filter(|&body| mass(body) == heaviest);
    let Some(farthest) = heavy().flat_map(from_centre).max() else { return };
    // Down to 62 bits, so that the squares fit.
    let down = (66 - farthest.leading_zeros() as i32).max(0);
    let distance = |body: u32| from_centre(body).map(|d| (d >> down).pow(2)).into_iter().sum::<u128>();
    let Some(nearest) = heavy().map(distance).min() else { return };
    queue.extend(heavy().filter(|&body| distance(body) == nearest));
}
