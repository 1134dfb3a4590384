//! The solver in floats: TGS soft on top of the free flight, with the formulas and the limits of the solver in integers, in plain
//! quantities: m, m/s, N·s. Worlds of floats compare with it; in tests it rounds as the solver in integers does, and is its twin.
//!
//! - `body`: bodies through the sub-steps.
//! - `rows`: contacts, their matrices, and impulses after a pass.
//! - `joints`: joints, which are solved before the contacts.
//! - `bounce`: restitution, once a step.
//! - `rounding`: errors of rounding, for tests.

mod body;
mod bounce;
mod joints;
pub(super) mod rounding;
mod rows;
#[cfg(test)]
mod tests;

use alloc::vec::Vec;

use self::body::Body;
use self::bounce::Bounces;
use self::joints::Joints;
use self::rounding::Rounding;
use self::rows::Rows;
use super::apply::Path;
use super::graph::graph_start;
use super::joint::find_paths;
use super::{Contact, ContactImpact, ContactSolver, Correction, Flight, Graph, Impulses, Joint, PHASES, SolverOptions};
use crate::math::TimeStep;
use crate::scalar::ToF64 as _;
#[cfg(feature = "timers")]
use crate::timers::Timers;
use crate::timers::{counted, timed};

/// Two numbers: of two points, or a vector in the plane.
type Pair = [f64; 2];
/// Components x, y and angular.
type Vector = [f64; 3];

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A value within ±limit.
fn within(value: f64, limit: f64) -> f64 {
    value.min(limit).max(-limit)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pass {
    WarmStart,
    Solve,
    Relax,
    /// Rigid contacts once more, and friction that does not grow.
    RelaxAgain,
}

/// The sub-steps of a step.
#[derive(Clone, Copy, Debug)]
struct Clock {
    /// The length of a sub-step, s.
    length: f64,
    substeps: u32,
}

impl Clock {
    fn new(time_step: TimeStep, substeps: u32) -> Self {
        let (num, den) = time_step.seconds();
        Self { length: f64::from(num) / f64::from(den) / f64::from(substeps), substeps }
    }

    fn count(&self) -> f64 {
        self.substeps.into()
    }
}

/// The buffers of the solver. Results do not depend on earlier steps.
#[derive(Debug, Default)]
pub struct FloatSolver {
    graph: Graph,
    bodies: Vec<Body>,
    phases: [Vec<Rows>; PHASES],
    /// The bodies with contacts, by phase.
    touched: [Vec<u32>; PHASES],
    /// The bodies whose rolling contacts resist, by phase.
    rolling: [Vec<u32>; PHASES],
    /// The number of contacts of a phase, by body.
    shares: Vec<u32>,
    joints: Joints,
    /// Paths by body; empty without joints.
    paths: Vec<Path>,
    /// True for islands that a fixed body holds.
    held: Vec<bool>,
    bounces: Bounces,
    /// Bodies with their leaders.
    followers: Vec<[u32; 2]>,
    pub(super) rounding: Rounding,
    #[cfg(feature = "timers")]
    timers: Timers,
}

impl ContactSolver for FloatSolver {
    fn solve(
        &mut self,
        time_step: TimeStep,
        options: &SolverOptions,
        flights: &[Flight],
        joints: &mut [Joint],
        contacts: &mut [Contact],
        corrections: &mut Vec<Correction>,
    ) {
        let clock = Clock::new(time_step, options.substeps);
        self.prepare(clock, options, flights, joints, contacts);
        timed!(self, passes, self.run_passes(clock, options, joints));
        let threshold = options.restitution_speed.to_f64();
        let Self { bounces, graph, bodies, joints: rows, phases, .. } = self;
        timed!(self, impacts, bounces.run(clock, threshold, graph, flights, bodies, rows, phases));
        timed!(self, apply, self.apply(joints, contacts));
        corrections.clear();
        corrections.extend(self.bodies.iter().map(|body| body.correction(clock.length)));
        counted!(self, islands, self.graph.islands());
    }

    #[cfg(feature = "timers")]
    fn take_timers(&mut self) -> Timers {
        core::mem::take(&mut self.timers)
    }

    fn totals(&self) -> impl Iterator<Item = (u32, [i64; 2], i32)> + '_ {
        self.phases.iter().flatten().map(|rows| {
            let Impulses { values: [first, second, _], exponent } = in_units(rows.applied);
            (rows.contact, [first, second], exponent)
        })
    }

    fn joint_totals(&self) -> impl Iterator<Item = (u32, [i128; 3])> + '_ {
        // In 2^-32 N·s: values beyond the range are cut off, and no number counts as zero.
        self.joints
            .totals()
            .map(|(joint, totals)| (joint, totals.map(|total| libm::rint(libm::scalbn(total, 32)) as i128)))
    }

    /// None: bounces are found once a step, in the impulses of all passes.
    fn impacts<'a>(&'a self, _: &'a [Contact]) -> impl Iterator<Item = ContactImpact> + 'a {
        core::iter::empty()
    }
}

impl FloatSolver {
    /// Finds phases, and makes the rows of contacts.
    fn prepare(
        &mut self,
        clock: Clock,
        options: &SolverOptions,
        flights: &[Flight],
        joints: &[Joint],
        contacts: &[Contact],
    ) {
        let joint_links = joints.iter().map(|joint| joint.bodies);
        let links = joint_links.chain(contacts.iter().map(|contact| contact.bodies));
        let is_fixed = |body: u32| flights[body as usize].is_fixed();
        self.graph.build(is_fixed, flights.len(), links, |members, queue| graph_start(flights, members, queue));
        self.bodies.clear();
        for (index, flight) in flights.iter().enumerate() {
            let units = self.rounding.body(index);
            self.bodies.push(Body::new(flight, units, clock, &mut self.rounding));
        }
        find_paths(flights, joints, contacts, &self.graph, &mut self.held, &mut self.paths);
        for (body, &path) in self.bodies.iter_mut().zip(&self.paths) {
            body.set_path(path);
        }
        self.joints.set(clock, flights, joints, contacts, &self.graph, &self.bodies);
        self.followers.clear();
        self.followers.extend((0..).zip(flights).filter_map(|(body, flight)| Some([body, flight.leader?])));
        for phase in 0..PHASES {
            self.phases[phase].clear();
            self.count_shares(phase, contacts);
            for (index, contact) in (0..).zip(contacts) {
                if self.graph.phase(contact.bodies) == phase {
                    let bodies = contact.bodies.map(|body| &self.bodies[body as usize]);
                    let shares = contact.bodies.map(|body| f64::from(self.shares[body as usize]));
                    let rows = Rows::new(index, contact, bodies, shares, options, &mut self.rounding);
                    self.phases[phase].extend(rows);
                }
            }
            self.share_rolls(phase);
        }
    }

    /// Counts the contacts of a phase by body.
    fn count_shares(&mut self, phase: usize, contacts: &[Contact]) {
        let in_phase = contacts.iter().filter(|contact| self.graph.phase(contact.bodies) == phase);
        count(
            in_phase.flat_map(|contact| contact.bodies),
            self.bodies.len(),
            &mut self.shares,
            &mut self.touched[phase],
        );
    }

    /// Shares the rolling resistance of a phase among the contacts of each body.
    fn share_rolls(&mut self, phase: usize) {
        let rolling = self.phases[phase].iter().filter(|rows| rows.roll.resists());
        count(rolling.flat_map(|rows| rows.bodies), self.bodies.len(), &mut self.shares, &mut self.rolling[phase]);
        for rows in self.phases[phase].iter_mut().filter(|rows| rows.roll.resists()) {
            let shares = rows.bodies.map(|body| f64::from(self.shares[body as usize]));
            rows.share_roll(rows.bodies.map(|body| &self.bodies[body as usize]), shares);
        }
    }

    /// The passes of all sub-steps, and the motion of bodies between them.
    fn run_passes(&mut self, clock: Clock, options: &SolverOptions, joints: &[Joint]) {
        for k in 1..=clock.substeps {
            self.joints.begin(&self.bodies, joints, clock, k == 1);
            self.bodies.iter_mut().for_each(|body| body.begin(k, clock.substeps, &mut self.rounding));
            self.follow();
            if k == 1 {
                self.pass(clock.length, Pass::WarmStart);
            }
            self.joints.warm_start(&mut self.bodies);
            for _ in 0..options.joint_rounds {
                self.joints.solve(&mut self.bodies, clock);
                self.follow();
                self.pass(clock.length, Pass::Solve);
            }
            self.bodies.iter_mut().for_each(|body| body.advance(clock.length));
            self.follow();
            self.joints.relax(&mut self.bodies, clock, f64::from(k) / clock.count());
            self.follow();
            self.pass(clock.length, Pass::Relax);
            for _ in 1..options.relax_passes {
                self.pass(clock.length, Pass::RelaxAgain);
            }
        }
    }

    /// A pass over the contacts of all phases. Contacts of a phase do not see each other.
    fn pass(&mut self, substep: f64, pass: Pass) {
        let Self { bodies, rounding, .. } = self;
        for phase in 0..PHASES {
            for rows in &mut self.phases[phase] {
                rows.run(bodies, substep, pass, rounding);
            }
            self.touched[phase].iter().for_each(|&body| bodies[body as usize].take_gain(rounding));
            if pass != Pass::Solve {
                for rows in self.phases[phase].iter_mut().filter(|rows| rows.roll.resists()) {
                    rows.run_roll(bodies, pass, rounding);
                }
                self.rolling[phase].iter().for_each(|&body| bodies[body as usize].take_gain(rounding));
            }
            follow(&self.followers, bodies);
        }
    }

    /// Sets followers to the motion of their leaders.
    fn follow(&mut self) {
        follow(&self.followers, &mut self.bodies);
    }

    /// Writes the impulses of joints and contacts and adds the sums of bodies.
    fn apply(&mut self, joints: &mut [Joint], contacts: &mut [Contact]) {
        self.joints.apply(joints, &mut self.bodies);
        contacts.iter_mut().for_each(|contact| contact.impulses = Impulses::default());
        for rows in self.phases.iter().flatten() {
            // A contact that bounced starts with a smaller normal impulse.
            let roll = within(rows.roll.impulse, rows.roll_limit());
            let [first, second, tangent] = rows.impulses;
            contacts[rows.contact as usize].impulses =
                in_units([first, if rows.is_double { second } else { roll }, tangent]);
            let (applied, weighted) = (rows.on_bodies(rows.applied), rows.on_bodies(rows.weighted));
            let turns = [rows.roll.turns(rows.roll.applied), rows.roll.turns(rows.roll.weighted)];
            for (side, body) in rows.bodies.into_iter().enumerate() {
                let body = &mut self.bodies[body as usize];
                (0..3).for_each(|c| body.applied[c] += applied[side][c]);
                (0..3).for_each(|c| body.weighted[c] += weighted[side][c]);
                body.applied[2] += turns[0][side];
                body.weighted[2] += turns[1][side];
            }
        }
    }
}

/// Counts how often each body is named, and lists each named body once.
fn count(named: impl Iterator<Item = u32>, bodies: usize, shares: &mut Vec<u32>, list: &mut Vec<u32>) {
    list.clear();
    shares.clear();
    shares.resize(bodies, 0);
    for body in named {
        shares[body as usize] += 1;
        if shares[body as usize] == 1 {
            list.push(body);
        }
    }
}

fn follow(followers: &[[u32; 2]], bodies: &mut [Body]) {
    for &[body, leader] in followers {
        let motion = bodies[leader as usize].clone();
        bodies[body as usize].follow(&motion);
    }
}

/// Impulses in N·s.
fn newton_seconds(impulses: Impulses) -> Vector {
    impulses.values.map(|value| libm::scalbn(value as f64, impulses.exponent))
}

/// Impulses in N·s as multiples of a power of two of which the largest has 62 bits. An impulse that is not finite counts as zero.
fn in_units(impulses: Vector) -> Impulses {
    let finite = impulses.map(|impulse| if impulse.is_finite() { impulse } else { 0.0 });
    let largest = finite.into_iter().fold(0.0, |largest: f64, impulse| largest.max(impulse.abs()));
    if largest == 0.0 {
        return Impulses::default();
    }
    let (_, above) = libm::frexp(largest);
    // Records keep exponents of eight bits.
    let exponent = (above - 62).clamp(-128, 60);
    let units = |impulse: f64| libm::rint(within(libm::scalbn(impulse, -exponent), rounding::power(62))) as i64;
    Impulses { values: finite.map(units), exponent }
}
