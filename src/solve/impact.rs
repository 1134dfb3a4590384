//! Impacts: what meets at speed within a sub-step, solved at its moment, before the passes of the sub-step.
//!
//! A point has an *impact* in a sub-step if the free flights of its bodies, with all corrections so far, bring it to the surface
//! in it, faster than the threshold: at the moment τ of the sub-step with u² = u0² − 2·a·g, for the velocity u0 and the gap g at the
//! beginning, and the acceleration a of the flight. Impacts that come one after the other are so solved one after the other. Those of
//! a sub-step, and all points of their island that touch, are solved together:
//!
//! 1. *Compression*: impulses that leave no point closing, with friction in the same cone, to convergence. Contacts that push share their
//!    bodies (Jacobi with mass splitting over these alone), so that no order matters.
//! 2. *Expansion*: each point that had a shock returns e of its impulse (Poisson). All are scaled by the largest factor up to 1 for which the work
//!    of all impulses, Σ J·(r before + r after)/2, is not positive: that is the change of the kinetic energy of all bodies of the island.
//! 3. What closes now, and friction in the larger cone, once more as in 1, with these impulses as lower bounds.
//!
//! The impulses move bodies from τ on. They are no part of what the next sub-step starts from.

use alloc::vec::Vec;

use super::contact::Group;
use super::motion::Vector;
use super::number::shifted;
use super::unit::Clock;
use super::{Contact, Place, STILL, Solver, SolverOptions};
use crate::fx;
use crate::kernel::simd::Lanes;

/// Bits after the point of velocities here.
const FRACTION: i32 = 16;
/// Bits after the point of velocities of bodies.
const FINE: i32 = 30;
/// The most iterations of a compression.
const ITERATIONS: u32 = 100;
/// One, as a moment of a sub-step or a factor.
const ONE: i128 = 1 << 30;

/// What a contact needs beside its group.
#[derive(Clone, Copy, Debug)]
struct Limit {
    island: u32,
    count: usize,
    /// The threshold, in units of velocity.
    threshold: i64,
    /// In 2^-32.
    restitution: i64,
    /// The gap up to which points touch, in units.
    touch: i64,
}

/// A contact in an impact.
#[derive(Clone, Debug)]
struct Hit {
    place: usize,
    rows: [usize; 2],
    /// By point: it takes part.
    takes_part: [bool; 2],
    /// By point: the moment of its impact in 2^-30; `None` if it only touches.
    moment: [Option<i128>; 2],
    /// By point: it may bounce. What overlapped at the start does not, unless it closed at speed then: it was pushed out.
    bounces: [bool; 2],
    /// By row: what the free flight adds to the velocity up to the impact.
    offset: [i128; 3],
    /// By side, [row][impulse], in 2^-30.
    matrix: [[[i128; 3]; 3]; 2],
    before: [i128; 3],
    least: [i128; 2],
    impulses: [i128; 3],
    /// Those of the iteration before, and those that this one starts from.
    last: [i128; 3],
    from: [i128; 3],
    /// In 2^-26.
    friction: i128,
}

#[derive(Clone, Debug, Default)]
pub(super) struct Impacts {
    limits: Vec<Limit>,
    hits: Vec<Hit>,
    /// By row.
    velocity: Vec<[i128; 3]>,
    counts: Vec<i128>,
    moved: Vec<[i128; 3]>,
    struck: Vec<[i128; 3]>,
    /// The islands with impacts, and all their contacts, by island.
    islands: Vec<u32>,
    members: Vec<(u32, usize)>,
}

/// The velocity or the displacement along the three rows of a contact, in units of what is given; rounded, the third row oddly.
fn along(group: &Group, lane: usize, a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
    let [nx, ny] = group.normal[lane].map(i128::from);
    let d = [b[0] - a[0], b[1] - a[1]];
    let of = |row: usize, linear: i128| {
        let [ka, kb] = group.arms[row][lane].map(i128::from);
        linear + kb * b[2] - ka * a[2]
    };
    let normal = nx * d[0] + ny * d[1];
    [(of(0, normal) + (1 << 29)) >> 30, (of(1, normal) + (1 << 29)) >> 30, shifted(of(2, ny * d[0] - nx * d[1]), 30)]
}

/// The change of velocity of a body by the impulses of a contact, in 2^-30.
fn gain(group: &Group, lane: usize, side: usize, [p1, p2, t]: [i128; 3]) -> [i128; 3] {
    let linear = if side == 0 { &group.linear_a } else { &group.linear_b };
    let of = |k: usize| i128::from(linear[0][lane][k]) * (p1 + p2) + i128::from(linear[1][lane][k]) * t;
    let turn = |row: usize| i128::from(group.angular[row][lane][side]);
    [of(0), of(1), (turn(0) * p1 + turn(1) * p2 + turn(2) * t) << group.angular_shift[lane]]
}

fn wide(v: Vector) -> [i128; 3] {
    [v[0].into(), v[1].into(), v[2].into()]
}

/// num/den to nearest, halves away from zero.
fn quotient(num: i128, den: i128) -> i128 {
    let size = (num.abs() + den.abs() / 2) / den.abs();
    if (num < 0) == (den < 0) { size } else { -size }
}

impl Hit {
    /// The matrix for these shares.
    fn shared(&self, shares: [i128; 2]) -> [[i128; 3]; 3] {
        let mut sum = [[0; 3]; 3];
        for (side, share) in shares.into_iter().enumerate() {
            for i in 0..3 {
                for j in 0..3 {
                    sum[i][j] += share * self.matrix[side][i][j];
                }
            }
        }
        sum
    }

    /// The changes of impulses that bring these velocities, in 2^-FRACTION, to zero or leave them positive.
    fn change(&self, r: [i128; 3], shares: [i128; 2]) -> [i128; 3] {
        let k = self.shared(shares);
        // −Δr/K: r in 2^-16, K in 2^-30.
        let over = |r: i128, k: i128| if k <= 0 { 0 } else { -quotient(r << (30 - FRACTION), k) };
        let (own, least) = (self.from, self.least);
        let alone = |i: usize, r: i128| (own[i] + over(r, k[i][i])).max(least[i]) - own[i];
        let normal = match self.takes_part {
            [true, true] => {
                let det = k[0][0] * k[1][1] - k[0][1] * k[1][0];
                if det <= (k[0][0] * k[1][1]) >> 20 {
                    // Both points are as good as one.
                    [alone(0, r[0] / 2), alone(1, r[1] / 2)]
                } else {
                    let x = [
                        -quotient((k[1][1] * r[0] - k[0][1] * r[1]) << (30 - FRACTION), det),
                        -quotient((k[0][0] * r[1] - k[1][0] * r[0]) << (30 - FRACTION), det),
                    ];
                    let is_low = [0, 1].map(|i| own[i] + x[i] < least[i]);
                    let low = [0, 1].map(|i| least[i] - own[i]);
                    let beside = |i: usize, j: usize| alone(i, r[i] + ((k[i][j] * low[j]) >> (30 - FRACTION)));
                    match is_low {
                        [false, false] => x,
                        [false, true] => [beside(0, 1), low[1]],
                        [true, false] => [low[0], beside(1, 0)],
                        [true, true] => [beside(0, 1), beside(1, 0)],
                    }
                }
            }
            [true, false] => [alone(0, r[0]), 0],
            [false, true] => [0, alone(1, r[1])],
            _ => [0, 0],
        };
        let coupled = k[2][0] * normal[0] + k[2][1] * normal[1];
        let slip = r[2] + shifted(coupled, 30 - FRACTION);
        let limit = (self.friction * (own[0] + normal[0] + own[1] + normal[1])) >> 26;
        let friction = (own[2] + over(slip, k[2][2])).clamp(-limit, limit) - own[2];
        [normal[0], normal[1], friction]
    }
}

impl Solver {
    /// Notes what impacts need of the contacts.
    pub(super) fn set_impacts(&mut self, clock: &Clock, options: &SolverOptions, contacts: &[Contact]) {
        self.impacts.limits.clear();
        for place in &self.places {
            let contact = &contacts[place.contact as usize];
            let mover = self.graph.mover(contact.bodies).unwrap_or_default();
            let unit = self.unit_of[mover as usize];
            let threshold = (shifted(options.restitution_speed.to_bits().into(), 32 + unit) as i64).max(1);
            let touch = clock.length_within(fx!(0.001), unit, 1 << 29).into();
            self.impacts.limits.push(Limit {
                island: self.graph.island_of(mover).unwrap_or_default(),
                count: contact.count,
                threshold,
                restitution: contact.restitution.to_bits(),
                touch,
            });
            let group = &mut self.groups[place.group as usize];
            group.threshold[place.lane as usize] = [threshold.min(1 << 28) as i32; 2];
        }
    }

    /// The velocity of a body at the beginning of sub-step `k` of `n`, before its contacts, in 2^-FINE.
    fn velocity_before(&self, row: usize, k: u32, n: u32) -> [i128; 3] {
        if row == STILL as usize {
            return [0; 3];
        }
        let flight = self.rows.flight(row as u32);
        let (before, rest) = self.rows.before(row as u32);
        [0, 1, 2].map(|i| {
            let flown = (i128::from(flight.change[i]) * i128::from(k - 1)) << FINE;
            ((i128::from(flight.start[i]) + i128::from(before[i])) << FINE)
                + quotient(flown, n.into())
                + i128::from(rest[i])
        })
    }

    /// The impact of the points of a contact in a sub-step, if it has one, or if a point touches.
    fn look(&self, at: usize, k: u32, n: u32) -> Option<(bool, Hit)> {
        let (place, limit) = (&self.places[at], &self.impacts.limits[at]);
        let (group, lane) = (&self.groups[place.group as usize], place.lane as usize);
        let rows = [group.a[lane] as usize, group.b[lane] as usize];
        let [va, vb] = rows.map(|row| self.velocity_before(row, k, n));
        let r = along(group, lane, va, vb).map(|r| shifted(r, FINE - FRACTION));
        let [ca, cb] = rows.map(|row| wide(self.rows.flight(row as u32).change).map(|c| c << FRACTION));
        // By sub-step.
        let a = along(group, lane, ca, cb).map(|a| quotient(a, n.into()));
        let mut hit = Hit {
            place: at,
            rows,
            takes_part: [false; 2],
            moment: [None; 2],
            bounces: [true; 2],
            offset: [0; 3],
            matrix: [[[0; 3]; 3]; 2],
            before: [0; 3],
            least: [0; 2],
            impulses: [0; 3],
            last: [0; 3],
            from: [0; 3],
            friction: group.friction[lane][1].into(),
        };
        let [sa, sb] = rows.map(|row| wide(self.rows.flight(row as u32).start));
        let closing = along(group, lane, sa, sb);
        let mut is_impact = false;
        for i in 0..limit.count {
            hit.bounces[i] =
                closing[i] < -i128::from(limit.threshold) || i64::from(group.separation[lane][i]) > -4 * limit.touch;
            // The true gap: the solver's flight is ahead of it.
            let gap = (i128::from(group.separation_now[lane][i]) << FRACTION) - a[i] * i128::from(k - 1) / 2;
            let threshold = i128::from(limit.threshold) << FRACTION;
            hit.takes_part[i] = gap <= i128::from(limit.touch) << FRACTION;
            if r[i] >= 0 {
                continue;
            }
            let (speed, moment) = if gap <= 0 {
                (-r[i], 0)
            } else {
                let square = r[i] * r[i] - 2 * a[i] * gap;
                if square <= 0 {
                    continue;
                }
                let speed = square.unsigned_abs().isqrt() as i128;
                let moment = ((2 * gap) << 30) / (speed - r[i]);
                if moment > ONE {
                    continue;
                }
                (speed, moment)
            };
            if speed > threshold {
                hit.takes_part[i] = true;
                hit.moment[i] = Some(moment);
                hit.offset[i] = -speed - r[i];
                is_impact = true;
            }
        }
        hit.takes_part.contains(&true).then_some((is_impact, hit))
    }

    /// Solves the impacts of sub-step `k` of `n`.
    pub(super) fn solve_impacts<L: Lanes>(&mut self, k: u32, n: u32, lanes: L) {
        let mut own = core::mem::take(&mut self.impacts);
        own.islands.clear();
        self.impacts.limits = core::mem::take(&mut own.limits);
        for at in 0..self.places.len() {
            if self.closes(at, k, n) && self.look(at, k, n).is_some_and(|(is_impact, _)| is_impact) {
                own.islands.push(self.impacts.limits[at].island);
            }
        }
        own.islands.sort_unstable();
        own.islands.dedup();
        if !own.islands.is_empty() {
            own.members.clear();
            for (at, limit) in self.impacts.limits.iter().enumerate() {
                if own.islands.binary_search(&limit.island).is_ok() {
                    own.members.push((limit.island, at));
                }
            }
            own.members.sort_unstable();
            let count = self.rows.rows.len();
            own.velocity.resize(count, [0; 3]);
            own.counts.resize(count, 0);
            own.moved.resize(count, [0; 3]);
            own.struck.resize(count, [0; 3]);
            let members = core::mem::take(&mut own.members);
            for island in members.chunk_by(|a, b| a.0 == b.0) {
                own.hits.clear();
                own.hits.extend(island.iter().filter_map(|&(_, at)| self.look(at, k, n).map(|(_, hit)| hit)));
                self.solve_island(&mut own, k, n, lanes);
                for &(_, at) in island {
                    self.renew_separation(at);
                }
            }
            own.members = members;
        }
        own.limits = core::mem::take(&mut self.impacts.limits);
        self.impacts = own;
    }

    /// A quick test: false if no point of a contact may have an impact.
    fn closes(&self, at: usize, k: u32, n: u32) -> bool {
        let (place, limit) = (&self.places[at], &self.impacts.limits[at]);
        let (group, lane) = (&self.groups[place.group as usize], place.lane as usize);
        let [a, b] = [group.a[lane], group.b[lane]].map(|row| {
            let (flight, (before, _)) = (self.rows.flight(row), self.rows.before(row));
            [0, 1, 2].map(|i| {
                let flown = i64::from(flight.change[i]) * i64::from(k - 1) / i64::from(n);
                i64::from(flight.start[i]) + i64::from(before[i]) + flown
            })
        });
        let [nx, ny] = group.normal[lane].map(i64::from);
        let linear = nx * (b[0] - a[0]) + ny * (b[1] - a[1]);
        (0..limit.count).any(|i| {
            let [ka, kb] = group.arms[i][lane].map(i64::from);
            (linear + kb * b[2] - ka * a[2]) >> 30 < -limit.threshold / 2
        })
    }

    fn of<'a>(&'a self, hit: &Hit) -> (&'a Place, &'a Group, usize) {
        let place = &self.places[hit.place];
        (place, &self.groups[place.group as usize], place.lane as usize)
    }

    fn velocities(&self, own: &Impacts, hit: &Hit) -> [i128; 3] {
        let (_, group, lane) = self.of(hit);
        let [a, b] = hit.rows.map(|row| own.velocity[row]);
        let r = along(group, lane, a, b).map(|r| shifted(r, FINE - FRACTION));
        [0, 1, 2].map(|i| r[i] + hit.offset[i])
    }

    /// Iterates until nothing closes: accelerated, and begun anew where the acceleration leads astray.
    fn compress(&self, own: &mut Impacts) {
        let mut hits = core::mem::take(&mut own.hits);
        let mut active: Vec<(usize, [i128; 3])> = Vec::new();
        hits.iter_mut().for_each(|hit| hit.last = hit.impulses);
        let mut since = 0_i128;
        for _ in 0..ITERATIONS {
            // Ahead by (since − 1)/(since + 2) of the last change.
            for hit in &mut hits {
                hit.from = hit.impulses;
                if since > 1 {
                    let ahead = [0, 1, 2].map(|i| quotient((hit.impulses[i] - hit.last[i]) * (since - 1), since + 2));
                    (0..3).for_each(|i| hit.from[i] += ahead[i]);
                    for i in 0..2 {
                        hit.from[i] = hit.from[i].max(hit.least[i]);
                    }
                }
                let ahead = [0, 1, 2].map(|i| hit.from[i] - hit.impulses[i]);
                (hit.last, hit.impulses) = (hit.impulses, hit.from);
                if ahead != [0; 3] {
                    self.push_rows(own, hit, ahead);
                }
            }
            hits.iter().for_each(|hit| hit.rows.iter().for_each(|&row| own.counts[row] = 0));
            active.clear();
            for (index, hit) in hits.iter().enumerate() {
                let r = self.velocities(own, hit);
                let is_active = |i: usize| hit.takes_part[i] && (r[i] < -1 || hit.from[i] > hit.least[i]);
                if is_active(0) || is_active(1) || hit.from[0] + hit.from[1] > 0 || hit.from[2] != 0 {
                    active.push((index, r));
                    hit.rows.iter().for_each(|&row| own.counts[row] += 1);
                }
            }
            let (mut most, mut astray) = (0, 0);
            // All changes follow from the same velocities.
            for (index, r) in &mut active {
                let hit = &mut hits[*index];
                let change = hit.change(*r, hit.rows.map(|row| own.counts[row]));
                for i in 0..3 {
                    hit.impulses[i] = hit.from[i] + change[i];
                    let moved = hit.impulses[i] - hit.last[i];
                    astray += r[i] * moved;
                    most = most.max(moved.abs()).max(change[i].abs());
                }
                *r = change;
            }
            for (index, change) in &active {
                self.push_rows(own, &hits[*index], *change);
            }
            since = if astray > 0 { 0 } else { since + 1 };
            let largest = hits.iter().flat_map(|hit| hit.impulses).map(i128::abs).max().unwrap_or(0);
            if most <= (largest >> 20).max(2) {
                break;
            }
        }
        own.hits = hits;
    }

    fn push_rows(&self, own: &mut Impacts, hit: &Hit, impulses: [i128; 3]) {
        let (_, group, lane) = self.of(hit);
        for (side, &row) in hit.rows.iter().enumerate() {
            let by = gain(group, lane, side, impulses);
            (0..3).for_each(|i| own.velocity[row][i] += by[i]);
        }
    }

    fn solve_island<L: Lanes>(&mut self, own: &mut Impacts, k: u32, n: u32, lanes: L) {
        let mut hits = core::mem::take(&mut own.hits);
        for hit in &mut hits {
            for row in hit.rows {
                own.velocity[row] = self.velocity_before(row, k, n);
                own.moved[row] = [0; 3];
                own.struck[row] = [0; 3];
            }
            let (_, group, lane) = self.of(hit);
            for side in 0..2 {
                for j in 0..3 {
                    let mut unit = [0; 3];
                    unit[j] = 1;
                    let by = gain(group, lane, side, unit);
                    let on = if side == 0 { along(group, lane, by, [0; 3]) } else { along(group, lane, [0; 3], by) };
                    (0..3).for_each(|i| hit.matrix[side][i][j] = on[i]);
                }
            }
        }
        for hit in &mut hits {
            hit.before = self.velocities(own, hit);
        }
        own.hits = hits;
        self.compress(own);
        self.expand(own);
        self.compress(own);
        // Points that only touch are pushed when the others meet: at the mean moment of their impulses.
        let (mut sum, mut total) = (0, 0);
        for hit in &own.hits {
            for i in 0..2 {
                if let Some(moment) = hit.moment[i] {
                    sum += (moment >> 10) * hit.impulses[i];
                    total += hit.impulses[i];
                }
            }
        }
        let mean = if total > 0 { (sum / total) << 10 } else { 0 };
        let hits = core::mem::take(&mut own.hits);
        for hit in &hits {
            if hit.impulses == [0; 3] {
                continue;
            }
            let place = &self.places[hit.place];
            let (group, lane) = (&mut self.groups[place.group as usize], place.lane as usize);
            let moments = [0, 1].map(|i| hit.moment[i].unwrap_or(mean));
            let [p1, p2, t] = hit.impulses;
            let late = [
                shifted(p1 * moments[0], 30),
                shifted(p2 * moments[1], 30),
                if p1 + p2 > 0 {
                    quotient(t * ((p1 * moments[0] + p2 * moments[1]) >> 10), (p1 + p2) << 20)
                } else {
                    0
                },
            ];
            for i in 0..3 {
                group.applied[i][lane] += hit.impulses[i] as i64;
                group.struck[i][lane] += hit.impulses[i] as i64;
                group.weighted[i][lane] -= late[i] as i64;
            }
            for side in 0..2 {
                let (by, moved) = (gain(group, lane, side, hit.impulses), gain(group, lane, side, late));
                let row = hit.rows[side];
                (0..3).for_each(|i| {
                    own.struck[row][i] += by[i];
                    own.moved[row][i] += moved[i];
                });
            }
        }
        for hit in &hits {
            for row in hit.rows {
                let (by, moved) = (own.struck[row], own.moved[row]);
                (own.struck[row], own.moved[row]) = ([0; 3], [0; 3]);
                if row != STILL as usize && (by != [0; 3] || moved != [0; 3]) {
                    self.rows.strike(
                        lanes,
                        row as u32,
                        by.map(|part| part as i64),
                        moved.map(|part| shifted(part, FINE)),
                    );
                }
            }
        }
        own.hits = hits;
    }

    /// Returns a share of the impulses, as far as that adds no energy.
    fn expand(&self, own: &mut Impacts) {
        let mut hits = core::mem::take(&mut own.hits);
        let mut returned: Vec<[i128; 2]> = Vec::new();
        let (mut constant, mut linear, mut square) = (0_i128, 0_i128, 0_i128);
        let mut after: Vec<[i128; 3]> = Vec::new();
        for hit in &hits {
            let limit = &self.impacts.limits[hit.place];
            let threshold = i128::from(limit.threshold) << 30;
            let own_r = self.velocities(own, hit);
            let by = [0, 1].map(|i| {
                let own_change = (hit.matrix[0][i][i] + hit.matrix[1][i][i]) * hit.impulses[i];
                let is_shock = hit.moment[i].is_some() || own_change > threshold;
                if is_shock && hit.bounces[i] { (hit.impulses[i] * i128::from(limit.restitution)) >> 32 } else { 0 }
            });
            for i in 0..3 {
                constant += hit.impulses[i] * (hit.before[i] + own_r[i]);
            }
            for i in 0..2 {
                linear += by[i] * (hit.before[i] + own_r[i]);
            }
            returned.push(by);
            after.push(own_r);
        }
        for (hit, by) in hits.iter().zip(&returned) {
            self.push_rows(own, hit, [by[0], by[1], 0]);
        }
        for ((hit, by), after) in hits.iter().zip(&returned).zip(&after) {
            let r = self.velocities(own, hit);
            for i in 0..3 {
                linear += hit.impulses[i] * (r[i] - after[i]);
            }
            for i in 0..2 {
                square += by[i] * (r[i] - after[i]);
            }
        }
        // What rounding adds is no energy.
        constant -= hits.iter().map(|hit| hit.impulses.iter().map(|j| j.abs() * 4).sum::<i128>()).sum::<i128>();
        let adds =
            |factor: i128| constant + ((linear * factor) >> 30) + ((((square * factor) >> 30) * factor) >> 30) > 0;
        let mut factor = ONE;
        if adds(ONE) {
            let (mut least, mut most) = (0, ONE);
            while most - least > 1 {
                let middle = (least + most) / 2;
                if adds(middle) { most = middle } else { least = middle }
            }
            factor = least;
        }
        for (hit, by) in hits.iter_mut().zip(&returned) {
            let given = by.map(|by| (by * factor) >> 30);
            self.push_rows(own, hit, [given[0] - by[0], given[1] - by[1], 0]);
            for i in 0..2 {
                hit.impulses[i] += given[i];
                hit.least[i] = hit.impulses[i];
            }
        }
        own.hits = hits;
    }

    /// Finds the separations of a contact where its bodies are.
    fn renew_separation(&mut self, at: usize) {
        let place = &self.places[at];
        let (group, lane) = (&mut self.groups[place.group as usize], place.lane as usize);
        let [a, b] = [group.a[lane], group.b[lane]].map(|row| wide(self.rows.displacement(row)));
        let moved = along(group, lane, a, b);
        for i in 0..2 {
            group.separation_now[lane][i] = group.separation[lane][i] + moved[i] as i32;
        }
    }
}
