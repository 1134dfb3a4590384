//! A contact in an impact: its points, its matrix, and the velocities along its rows.

use super::super::Contact;
use super::super::bodies::BodyRows;
use super::super::group::Group;
use super::super::groups::{ContactGroups, Place};
use super::super::motion::{Rows, Vector};
use super::super::number::{lowered, product, shifted};
use super::jacobian::{Elements, Jacobian, NormalRows, coarsened};
use super::{AT_ONCE, FRACTION, Impacts, LATEST, NEAR, NONE, ONE, Struck, SubStep, TOUCH};

/// Bits of a word.
pub(super) const WORD: i32 = 64;

/// The inverse of the matrix of a contact for its shares: factors of velocities, and the bits by which all products with them are shifted
/// down. These are 64 wherever the factors, moved up, stay below 2^62: then the upper word of a product is the result.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Inverse {
    /// Elements 11, 12 and 22 of the inverse; `None` where both points are as good as one, or only one takes part.
    pub(super) block: Option<[i64; 3]>,
    /// 1 over elements 11, 22 and tt; zero for a row that moves nothing.
    pub(super) alone: [i64; 3],
    pub(super) down: i32,
}

impl Inverse {
    /// The inverse for products that are shifted down by 64 bits, if the factors stay below 2^62.
    fn raised(self) -> Self {
        let up = WORD - self.down;
        let factors = self.block.unwrap_or_default().into_iter().chain(self.alone);
        let sizes = factors.fold(0, |sizes, factor| sizes | factor.unsigned_abs());
        if up < 0 || (sizes.leading_zeros() as i32) < up + 2 {
            return self;
        }
        Self {
            block: self.block.map(|block| block.map(|factor| factor << up)),
            alone: self.alone.map(|factor| factor << up),
            down: WORD,
        }
    }
}

/// A contact in an impact: in the rounds of a sub-step in place of its lane.
#[derive(Clone, Debug)]
pub(super) struct Shock {
    pub(super) place: u32,
    pub(super) island: u32,
    /// The rows of both bodies, and their indices among the bodies of the impact.
    pub(super) rows: [u32; 2],
    pub(super) bodies: [u32; 2],
    /// By point: true if it takes part.
    pub(super) joined: [bool; 2],
    /// By point: the moment of its impact in the sub-step, in 2^-30; `None` if it only touches.
    pub(super) moments: [Option<i64>; 2],
    /// By point: the speed of its impact.
    pub(super) speeds: [i64; 2],
    /// The time after an impact of one of its bodies within which both are one impact, in 2^-30.
    pub(super) window: i64,
    /// By point: the velocity that the flight adds up to the impact.
    pub(super) gained: [i64; 2],
    /// By point: true if it may bounce. A point that overlapped at the start of the step without closing was pushed out.
    pub(super) bounces: [bool; 2],
    /// In 2^-32.
    pub(super) restitution: i64,
    /// The coefficient of friction in 2^-26, and the velocity of the surfaces against each other.
    pub(super) friction: i64,
    pub(super) surface: i64,
    /// log2 of the unit of impulses.
    pub(super) exponent: i32,
    pub(super) jacobian: Jacobian,
    pub(super) elements: [Elements; 2],
    /// True for elements of a body with all that is joined to it, by its response.
    pub(super) has_response: [bool; 2],
    /// In 2^-22.
    pub(super) matrix: [i64; 6],
    pub(super) inverse: Inverse,
    pub(super) shares: [i64; 2],
    /// Impulses below it are [free](Jacobian::free_bits) for the shares of both bodies.
    pub(super) free: u64,
    /// Velocities along the rows before the impact.
    pub(super) before: [i64; 3],
    /// Lower bounds of the normal impulses.
    pub(super) lower_bounds: [i64; 2],
    /// Impulses now, at the beginning of the compression, before the last iteration, and where this iteration starts.
    pub(super) impulses: [i64; 3],
    pub(super) begun: [i64; 3],
    pub(super) limit: i64,
    pub(super) last: [i64; 3],
    pub(super) from: [i64; 3],
    /// Impulses that surely do no work.
    pub(super) workless: [i64; 3],
    /// Impulses to add as far as they do no work, and the velocities along the rows without them.
    pub(super) extra: [i64; 3],
    pub(super) after: [i64; 3],
}

impl Shock {
    /// The impact of a contact in a sub-step, if it has one.
    pub(super) fn find(
        impacts: &mut Impacts,
        substep: SubStep<'_>,
        bodies: &BodyRows,
        groups: &ContactGroups,
        place: u32,
    ) -> Option<Self> {
        let (&Place { contact, .. }, group, lane) = groups.lane_of(place);
        let rows = [group.a[lane], group.b[lane]];
        if is_slow(&bodies.rows, group, lane, substep) {
            return None;
        }
        let jacobian = Jacobian::of(group, lane);
        let before = impacts.velocities.along(&bodies.rows, group, lane, substep);
        let threshold = i64::from(group.surface[lane][1]) << FRACTION;
        let [change_a, change_b] = rows.map(|row| wide(bodies.rows.flight(row).change).map(|part| part << FRACTION));
        let change = jacobian.along(change_a, change_b, 0);
        // Nothing is so fast within the step.
        if (0..2).all(|i| before[i] - change[i].abs() >= -threshold) {
            return None;
        }
        let earliest = rows.map(|row| impacts.moment_of(row)).into_iter().max().unwrap_or(0);
        let contact = &substep.contacts[contact as usize];
        let [support_a, support_b] = rows.map(|row| bodies.rows.support(row, substep.n).map(|part| part << FRACTION));
        let support = jacobian.along(support_a, support_b, 0);
        let accelerations =
            [0, 1].map(|i: usize| quotient(change[i].into(), substep.n.into()) + i128::from(support[i]));
        let point_impacts = [0, 1].map(|i: usize| {
            let gap = gap(group.separation_now[lane][i], accelerations[i], substep);
            let impact =
                if i < contact.count { impact(before[i].into(), accelerations[i], gap, earliest) } else { None };
            impact.filter(|(_, speed)| *speed > threshold)
        });
        let first = point_impacts.iter().flatten().map(|(moment, _)| *moment).min()?;
        let mut shock = Self::new(substep, bodies, groups, place, before, first);
        for i in 0..contact.count {
            match point_impacts[i] {
                Some((moment, speed)) => {
                    (shock.joined[i], shock.moments[i], shock.speeds[i]) = (true, Some(moment), speed);
                    shock.gained[i] = -speed - before[i];
                }
                None => shock.gained[i] = ((accelerations[i] * i128::from(first)) >> 30) as i64,
            }
        }
        let fastest = i128::from(shock.speeds[0].max(shock.speeds[1]));
        let way = (NEAR * i128::from(touch(substep, bodies, contact))) << (30 + FRACTION);
        shock.window = (way / fastest).min(AT_ONCE.into()) as i64;
        Some(shock)
    }

    /// A contact with these velocities along its rows. The points that touch at this moment take part.
    pub(super) fn new(
        substep: SubStep<'_>,
        bodies: &BodyRows,
        groups: &ContactGroups,
        place: u32,
        before: [i64; 3],
        moment: i64,
    ) -> Self {
        let (&Place { contact, exponent, .. }, group, lane) = groups.lane_of(place);
        let contact = &substep.contacts[contact as usize];
        let mover = substep.graph.mover(contact.bodies).unwrap_or_default();
        let touch = touch(substep, bodies, contact);
        let rows = [group.a[lane], group.b[lane]];
        let [start_a, start_b] = rows.map(|row| wide(bodies.rows.flight(row).start));
        let jacobian = Jacobian::of(group, lane);
        let closing = jacobian.along(start_a, start_b, 0);
        let threshold = i64::from(group.surface[lane][1]);
        let bounces = |i: usize| closing[i] < -threshold || group.separation[lane][i] > -4 * touch;
        Self {
            place,
            island: substep.graph.island_of(mover).unwrap_or_default(),
            rows,
            bodies: [NONE; 2],
            joined: touching(group, lane, contact, before, moment, touch),
            moments: [None; 2],
            speeds: [0; 2],
            window: 0,
            gained: [0; 2],
            bounces: [bounces(0), bounces(1)],
            restitution: contact.restitution.to_bits(),
            friction: group.friction[lane][1].into(),
            surface: i64::from(group.surface[lane][0]) << FRACTION,
            exponent,
            jacobian,
            elements: [0, 1].map(|side| jacobian.elements(side)),
            has_response: [false; 2],
            matrix: [0; 6],
            inverse: Inverse::default(),
            shares: [0; 2],
            free: 0,
            before,
            lower_bounds: [0; 2],
            impulses: [0; 3],
            begun: [0; 3],
            limit: 0,
            last: [0; 3],
            from: [0; 3],
            workless: [0; 3],
            extra: [0; 3],
            after: [0; 3],
        }
    }

    /// The moment of its first impact.
    pub(super) fn moment(&self) -> i64 {
        self.moments.into_iter().flatten().min().unwrap_or(ONE)
    }

    /// Returns true if its impulses move the body.
    pub(super) fn is_movable(&self, side: usize) -> bool {
        let [k11, _, k22, _, _, ktt] = self.elements[side];
        k11 | k22 | ktt != 0
    }

    /// Finds the matrix and its inverse for the shares of both bodies.
    ///
    /// # Ranges
    /// Elements are below 2^46, shares below 2^22. They are brought to 31 bits: products are below 2^62, the determinant is above 2^-20
    /// of the product of the diagonal, 2^40 at least where the larger element has 31 bits and the smaller one as many as it needs to
    /// count, and quotients of 2^92 by it below 2^52.
    pub(super) fn set_shares(&mut self, shares: [i64; 2]) {
        if shares == self.shares {
            return;
        }
        self.shares = shares;
        let free_bits = [0, 1].map(|side| self.jacobian.free_bits(side, shares[side]));
        self.free = 1 << free_bits[0].min(free_bits[1]).max(0);
        let [elements_a, elements_b] = &self.elements;
        let mut matrix = [0; 6];
        for (i, element) in matrix.iter_mut().enumerate() {
            *element = product(shares[0], elements_a[i]) + product(shares[1], elements_b[i]);
            self.matrix[i] = lowered(*element, 8) as i64;
        }
        let largest = matrix[0].max(matrix[2]).max(matrix[5]).max(1);
        let down = 128 - largest.leading_zeros() as i32 - 31;
        let scaled = |i: usize| shifted(matrix[i], down) as i64;
        let (k11, k12, k22, ktt) = (scaled(0), scaled(1), scaled(2), scaled(5));
        let ratio = |num: i64, den: i64| if den <= 0 { 0 } else { ((i128::from(num) << 61) / i128::from(den)) as i64 };
        let has_both = self.joined == [true; 2];
        let inverted = |k: i64| if k <= 0 { 0 } else { (1 << 61) / k };
        let determinant = k11 * k22 - k12 * k12;
        let is_regular = determinant > (k11 * k22) >> 20;
        self.inverse = Inverse {
            block: (has_both && is_regular)
                .then(|| [ratio(k22, determinant), ratio(-k12, determinant), ratio(k11, determinant)]),
            alone: [inverted(k11), inverted(k22), inverted(ktt)],
            down: 61 + FRACTION - 30 + down,
        }
        .raised();
    }

    /// The velocities along the rows, with the part that the flight adds up to the moments, less the velocity of the surfaces. That of a
    /// second point that takes no part is any.
    pub(super) fn velocities(&self, struck: &[Struck], coarse: i32) -> [i64; 3] {
        let [first, second] = self.normal_velocities(struck, coarse);
        [first, second, self.slip(struck, coarse)]
    }

    /// The normal rows of [`velocities`](Self::velocities).
    #[inline(always)]
    pub(super) fn normal_velocities(&self, struck: &[Struck], coarse: i32) -> [i64; 2] {
        let [a, b] = self.bodies.map(|body| struck[body as usize].velocity);
        let [first, second] = self.jacobian.normal_velocities(a, b, coarse, self.joined[1]);
        [first + self.gained[0], second + self.gained[1]]
    }

    /// The friction row of [`velocities`](Self::velocities).
    #[inline(always)]
    pub(super) fn slip(&self, struck: &[Struck], coarse: i32) -> i64 {
        let [a, b] = self.bodies.map(|body| struck[body as usize].velocity);
        self.jacobian.slip(a, b, coarse) - self.surface
    }

    /// Applies changes of its impulses to its bodies.
    pub(super) fn push(&self, struck: &mut [Struck], coarse: i32, impulses: [i64; 3]) {
        let sizes = impulses[0].unsigned_abs() | impulses[1].unsigned_abs() | impulses[2].unsigned_abs();
        let are_free = sizes < self.free && coarse == 0;
        for (side, &body) in self.bodies.iter().enumerate() {
            let struck = &mut struck[body as usize];
            let change = if are_free {
                self.jacobian.free_gain(side, impulses)
            } else {
                self.jacobian.gain(side, impulses, struck.share, coarse)
            };
            (0..3).for_each(|i| struck.velocity[i] += change[i]);
        }
    }

    /// The velocities before the impact, as [`velocities`](Self::velocities) has them.
    pub(super) fn relative_before(&self) -> [i64; 3] {
        [self.before[0] + self.gained[0], self.before[1] + self.gained[1], self.before[2] - self.surface]
    }

    /// The impulses that its points return, also points that were at rest: every point that an impact passes through returns its share.
    pub(super) fn returned(&self) -> [i64; 3] {
        let [first, second] = [0, 1].map(|point| {
            // Rounded down: below 2^60 · 2^32.
            let share = (i128::from(self.impulses[point]) * i128::from(self.restitution)) >> 32;
            if self.bounces[point] { share as i64 } else { 0 }
        });
        [first, second, 0]
    }

    /// Impulses times their moments. Points that only touched are pushed at the mean moment.
    pub(super) fn late(&self, mean: i64) -> [i64; 3] {
        let moments = self.moments.map(|moment| i128::from(moment.unwrap_or(mean)));
        let [first, second, tangent] = self.impulses.map(i128::from);
        let sum = first + second;
        let weighted = first * moments[0] + second * moments[1];
        let moment = if sum > 0 { weighted / sum } else { 0 };
        [
            shifted(first * moments[0], 30) as i64,
            shifted(second * moments[1], 30) as i64,
            shifted(tangent * moment, 30) as i64,
        ]
    }
}

/// num/den to nearest, halves away from zero. *Domain* den is positive.
pub(super) fn quotient(num: i128, den: i128) -> i128 {
    let size = (num.abs() + den / 2) / den;
    if num < 0 { -size } else { size }
}

/// A vector with wide components, without the fourth one.
pub(super) fn wide(vector: Vector) -> [i64; 3] {
    [vector[0].into(), vector[1].into(), vector[2].into()]
}

/// Returns true if no point of a contact can be faster than the threshold of impacts in a step: in words, with room for rounding.
///
/// # Ranges
/// Velocities times sub-steps are below 2^36, and factors are taken with 22 bits: sums of four products are below 2^60.
fn is_slow(rows: &Rows, group: &Group, lane: usize, substep: SubStep<'_>) -> bool {
    let n = i64::from(substep.n);
    let passed = i64::from(substep.k - 1);
    let [row_a, row_b] = [group.a[lane], group.b[lane]];
    let ([start_a, change_a], [start_b, change_b]) = (motion(rows, row_a, n, passed), motion(rows, row_b, n, passed));
    let [nx, ny] = group.normal[lane].map(|part| i64::from(part) >> 8);
    let threshold = i64::from(group.surface[lane][1]) * n;
    // Truncated factors are off by up to 2^-22 each.
    let rounding = ((size(start_a) + size(change_a) + size(start_b) + size(change_b)) >> 21) + 4 * n;
    let straight = nx * (start_b[0] - start_a[0]) + ny * (start_b[1] - start_a[1]);
    let straight_change = nx * (change_b[0] - change_a[0]) + ny * (change_b[1] - change_a[1]);
    for point in 0..2 {
        let [arm_a, arm_b] = group.arms[point][lane].map(|arm| i64::from(arm) >> 8);
        let start = (straight + arm_b * start_b[2] - arm_a * start_a[2]) >> 22;
        let change = (straight_change + arm_b * change_b[2] - arm_a * change_a[2]) >> 22;
        if start - change.abs() - rounding < -threshold {
            return false;
        }
    }
    true
}

/// The velocity of a body at the beginning of a sub-step, after `passed` others, and its change in the step: both times `n`.
#[inline(always)]
fn motion(rows: &Rows, row: u32, n: i64, passed: i64) -> [[i64; 3]; 2] {
    let flight = rows.flight(row);
    let (before, _) = rows.before(row);
    let (mut start, mut change) = ([0; 3], [0; 3]);
    for i in 0..3 {
        let whole = i64::from(flight.change[i]);
        start[i] = (i64::from(flight.start[i]) + i64::from(before[i])) * n + whole * passed;
        change[i] = whole * n;
    }
    [start, change]
}

/// A contact beside the shocks.
pub(super) enum Beside {
    /// It does not touch at their moment.
    Apart,
    /// It does not close, or not fast enough to count.
    Slow,
    /// It joins them. The velocities along its rows before it does.
    Closing([i64; 3]),
}

/// How a contact stands beside the shocks, of which the slowest that counts closes at a speed.
#[inline(always)]
pub(super) fn beside(
    impacts: &mut Impacts,
    substep: SubStep<'_>,
    bodies: &BodyRows,
    groups: &ContactGroups,
    contact_rows: &NormalRows,
    slowest: i64,
) -> Beside {
    let NormalRows { place, rows, .. } = *contact_rows;
    let Impacts { velocities, struck, struck_of, coarse, moment, .. } = impacts;
    let mut body_velocities = [[0; 3]; 2];
    for (velocity, row) in body_velocities.iter_mut().zip(rows) {
        *velocity = match struck_of[row as usize] {
            body if body != NONE && struck[body as usize].is_in_set => struck[body as usize].velocity,
            _ => coarsened(velocities.at(&bodies.rows, row, substep), *coarse),
        };
    }
    let is_closing = contact_rows.close_faster(body_velocities, *coarse, slowest);
    if is_closing == [false; 2] {
        return Beside::Slow;
    }
    let (&Place { contact, .. }, group, lane) = groups.lane_of(place);
    let before = velocities.along(&bodies.rows, group, lane, substep);
    let contact = &substep.contacts[contact as usize];
    let touches = touching(group, lane, contact, before, *moment, touch(substep, bodies, contact));
    match touches {
        [false, false] => Beside::Apart,
        [first, second] if first && is_closing[0] || second && is_closing[1] => Beside::Closing(before),
        _ => Beside::Slow,
    }
}

/// By point: true if it touches at a moment, for velocities along the rows at the beginning of the sub-step.
fn touching(group: &Group, lane: usize, contact: &Contact, before: [i64; 3], moment: i64, touch: i32) -> [bool; 2] {
    [0, 1].map(|point: usize| {
        let moved = ((i128::from(before[point]) * i128::from(moment)) >> (30 + FRACTION)) as i64;
        point < contact.count && i64::from(group.separation_now[lane][point]) + moved <= i64::from(touch)
    })
}

/// The gap of a point at the beginning of a sub-step, in 2^-[`FRACTION`]. The flight of the solver, which is semi-implicit, is ahead.
fn gap(separation: i32, acceleration: i128, substep: SubStep<'_>) -> i128 {
    (i128::from(separation) << FRACTION) - acceleration * i128::from(substep.k - 1) / 2
}

/// [`TOUCH`] in the units of displacements of a contact.
fn touch(substep: SubStep<'_>, bodies: &BodyRows, contact: &Contact) -> i32 {
    let mover = substep.graph.mover(contact.bodies).unwrap_or_default();
    substep.clock.length_within(TOUCH, bodies.bodies[mover as usize].unit, 1 << 29)
}

/// The sum of the magnitudes of the components.
fn size([x, y, angular]: [i64; 3]) -> i64 {
    x.abs() + y.abs() + angular.abs()
}

/// The moment, from `earliest` to [`LATEST`], at which a point reaches the surface, and its speed then. `None` if it does not. The velocity
/// and the gap are at the beginning of the sub-step, the acceleration is by sub-step; all are in one unit.
fn impact(velocity: i128, acceleration: i128, gap: i128, earliest: i64) -> Option<(i64, i64)> {
    let moved = (velocity * i128::from(earliest)) >> 30;
    if gap + moved <= 0 {
        return (velocity < 0).then_some((earliest, -velocity as i64));
    }
    // It has come out of an overlap since the beginning.
    if gap <= 0 {
        return None;
    }
    // Below 2^94.
    let square = velocity * velocity - 2 * acceleration * gap;
    if square <= 0 {
        return None;
    }
    let speed = square.unsigned_abs().isqrt() as i128;
    if speed - velocity <= 0 || speed <= 0 {
        return None;
    }
    let moment = ((2 * gap) << 30) / (speed - velocity);
    (moment <= i128::from(LATEST)).then_some((moment.max(earliest.into()) as i64, speed as i64))
}
