//! Compression: the impulses that leave no shock closing.
//!
//! They minimise the kinetic energy over impulses λ ≥ 0 along the normals and |λt| ≤ μ·Σλ along the tangents: the velocity along a row is
//! zero where its impulse pushes, and not negative where it does not. The iteration is projected Jacobi by contacts (a contact's two
//! points are one block), with the mass of a body split among the shocks that share it, and accelerated by Nesterov's momentum, begun anew
//! where it leads uphill. The limits of friction stand still for some iterations, as the problem is convex then. All shocks of an
//! iteration see the same velocities and sums of integers commute, so no order matters.
//!
//! Reads: the shocks of a set; contacts of their bodies. Writes: the impulses of the shocks and the velocities of their bodies, and the
//! contacts that join the set.

use super::super::bodies::BodyRows;
use super::super::groups::ContactGroups;
use super::super::joint::{Joints, StopSpeeds};
use super::super::number::{lowered, product, shifted, shifted_word};
use super::shock::{Beside, Shock, WORD, beside};
use super::{FINE, FRACTION, Impacts, STILL_SPEED, Struck, SubStep};

/// The most iterations, and the fewest of a large set, and of one without a solution: a set of which the largest residual is still above the
/// slowest closing speed that counts has a body that is clamped between others that do not give way, and its impulses would grow with each
/// iteration.
const ITERATIONS: u32 = 128;
const MIN_ITERATIONS: u32 = 8;
/// Iterations times shocks after which a large set is left as it is: the rest is the end of an impact in the middle of a pile.
const WORK: usize = 1 << 9;
/// Sets of fewer shocks converge to the tolerance.
const SMALL: usize = 32;
/// Iterations in which a set grows: an impact runs along a row of bodies by one in each.
const GROWING: u32 = 16;

impl Shock {
    /// Begins a compression from its present impulses.
    fn begin(&mut self) {
        (self.last, self.begun) = (self.impulses, self.impulses);
    }

    /// The impulse of one normal row alone that brings its velocity to zero, at least the lower bound, as a change.
    fn alone(&self, row: usize, velocity: i64) -> i64 {
        let change = self.scaled(self.inverse.alone[row], velocity);
        (self.from[row] + change).max(self.lower_bounds[row]) - self.from[row]
    }

    /// −factor · velocity as an impulse, rounded oddly: velocities in 2^-[`FRACTION`], elements of the matrix in 2^-30.
    ///
    /// # Ranges
    /// A factor is below 2^62, and a velocity too: it is below 2^58 without the changes by other impulses, of at most 2^60 each. So the
    /// upper word of a product is within ±2^60, as the impulse is.
    #[inline(always)]
    fn scaled(&self, factor: i64, velocity: i64) -> i64 {
        let product = product(factor, velocity);
        if self.inverse.down == WORD {
            return -(lowered(product, WORD) as i64);
        }
        limited(shifted(-product, self.inverse.down))
    }

    /// The change of the velocity along one row by an impulse along another one, by their element of the matrix, in 2^-[`FRACTION`].
    fn coupled(&self, element: usize, impulse: i64) -> i64 {
        const DOWN: i32 = 30 - FRACTION - 8;
        match self.matrix[element].checked_mul(impulse) {
            // Below 2^57.
            Some(product) => shifted_word(product, DOWN),
            // Below 2^60 · 2^62 for velocities that saturate; elements are below 2^46 for one body.
            None => limited(lowered(product(self.matrix[element], impulse), DOWN)),
        }
    }

    /// Its impulses with the changes of the normal ones that it would have in the next iteration from them.
    pub(super) fn next_impulses(&mut self, struck: &[Struck], coarse: i32) -> [i64; 3] {
        self.from = self.impulses;
        let [first, second] = self.normal_change(self.normal_velocities(struck, coarse));
        let [first_impulse, second_impulse, tangent] = self.impulses;
        [first_impulse + first, second_impulse + second, tangent]
    }

    /// The changes of the normal impulses that bring these velocities to zero, or leave them positive without an impulse.
    fn normal_change(&self, velocities: [i64; 2]) -> [i64; 2] {
        match self.joined {
            [true, false] => [self.alone(0, velocities[0]), 0],
            [false, true] => [0, self.alone(1, velocities[1])],
            [false, false] => [0, 0],
            [true, true] => match self.inverse.block {
                Some(block) => self.block_change(block, velocities),
                // Both points are as good as one.
                None => [self.alone(0, velocities[0] / 2), self.alone(1, velocities[1] / 2)],
            },
        }
    }

    /// [`normal_change`](Self::normal_change) of two points.
    fn block_change(&self, [i11, i12, i22]: [i64; 3], velocities: [i64; 2]) -> [i64; 2] {
        let change = [
            self.scaled(i11, velocities[0]).saturating_add(self.scaled(i12, velocities[1])),
            self.scaled(i12, velocities[0]).saturating_add(self.scaled(i22, velocities[1])),
        ];
        let lowest = [0, 1].map(|point| self.lower_bounds[point] - self.from[point]);
        let alone_beside =
            |point: usize, lowest: i64| self.alone(point, velocities[point].saturating_add(self.coupled(1, lowest)));
        match [0, 1].map(|point| change[point] < lowest[point]) {
            [false, false] => change,
            [false, true] => [alone_beside(0, lowest[1]), lowest[1]],
            [true, false] => [lowest[0], alone_beside(1, lowest[0])],
            [true, true] => [alone_beside(0, lowest[1]), alone_beside(1, lowest[0])],
        }
    }

    /// The change of the tangential impulse for this slip and these changes of the normal ones.
    fn tangent_change(&self, slip: i64, normal: [i64; 2]) -> i64 {
        let slip = slip.saturating_add(self.coupled(3, normal[0])).saturating_add(self.coupled(4, normal[1]));
        self.held_tangent(slip) - self.from[2]
    }

    /// The tangential impulse within its limit that holds against a slip.
    #[inline(always)]
    fn held_tangent(&self, slip: i64) -> i64 {
        (self.from[2] + self.scaled(self.inverse.alone[2], slip)).clamp(-self.limit, self.limit)
    }

    /// Returns true if the tangential impulse is zero, and stays so.
    fn is_smooth(&self) -> bool {
        self.limit == 0 && self.from[2] == 0
    }

    fn friction_limit(&self, normal: [i64; 2]) -> i64 {
        // Below 2^62 · 2^31.
        let pressing = i128::from(normal[0]) + i128::from(normal[1]);
        ((pressing * i128::from(self.friction)) >> 26).clamp(0, 1 << 61) as i64
    }

    /// By how much the normal velocities miss the goal: all of a closing one, and of an opening one the part that impulses can take back.
    fn normal_residual(&self, velocities: [i64; 2]) -> i64 {
        let normal = |point: usize| match (self.joined[point], velocities[point]) {
            (false, _) => 0,
            (true, velocity @ ..0) => -velocity,
            (true, velocity) => velocity.min(self.coupled([0, 2][point], self.from[point] - self.lower_bounds[point])),
        };
        normal(0).max(normal(1))
    }

    /// The part of a slip that impulses can take back.
    fn slip_residual(&self, slip: i64) -> i64 {
        self.coupled(5, self.held_tangent(slip) - self.from[2]).abs()
    }
}

/// A value within ±2^60.
#[inline(always)]
fn limited(value: i128) -> i64 {
    // Most are within: a comparison of words twice as long costs more than a shift.
    if matches!(value >> 60, 0 | -1) { value as i64 } else { value.clamp(-(1 << 60), 1 << 60) as i64 }
}

/// Takes the last changes of all impulses once more, in part: by (m − 1)/(m + 2) after m iterations.
fn run_ahead(impacts: &mut Impacts, momentum: i64) {
    let Impacts { shocks, struck, coarse, .. } = impacts;
    // In 2^-20.
    let share = (momentum - 1).max(0) * (1 << 20) / (momentum + 2);
    for shock in shocks {
        shock.from = shock.impulses;
        if share > 0 && shock.impulses != shock.last {
            for row in 0..3 {
                // Impulses are below 2^62.
                let last = shock.impulses[row] - shock.last[row];
                shock.from[row] += if last.unsigned_abs() < 1 << 42 {
                    shifted_word(last * share, 20)
                } else {
                    shifted(product(last, share), 20) as i64
                };
            }
            (0..2).for_each(|point| shock.from[point] = shock.from[point].max(shock.lower_bounds[point]));
        }
        (shock.last, shock.impulses) = (shock.impulses, shock.from);
        let change = [0, 1, 2].map(|row| shock.from[row] - shock.last[row]);
        if change != [0; 3] {
            shock.push(struck, *coarse, change);
        }
    }
}

/// One iteration, which may renew the limits of friction. Returns the largest residual before it, and a positive number if the momentum
/// led uphill along the normals.
fn correct(impacts: &mut Impacts, renews: bool) -> (i64, i128) {
    let Impacts { shocks, struck, set, exponent, coarse, .. } = impacts;
    let mut largest = 0;
    let mut uphill = 0_i128;
    // All changes follow from the same velocities.
    for shock in shocks.iter_mut() {
        let velocities = shock.normal_velocities(struck, *coarse);
        if renews {
            shock.limit = shock.friction_limit([shock.from[0], shock.from[1]]);
        }
        largest = largest.max(shock.normal_residual(velocities));
        let change = shock.normal_change(velocities);
        if !shock.is_smooth() {
            let slip = shock.slip(struck, *coarse);
            largest = largest.max(shock.slip_residual(slip));
            shock.impulses[2] = shock.from[2] + shock.tangent_change(slip, change);
        }
        let mut work = 0;
        for point in 0..2 {
            shock.impulses[point] = shock.from[point] + change[point];
            work += product(velocities[point], shock.impulses[point] - shock.last[point]);
        }
        // Coarse velocities are larger.
        let down = *exponent - shock.exponent + *coarse;
        uphill += if down <= 0 { work } else { work >> down.min(126) };
    }
    for shock in shocks.iter() {
        let change = [0, 1, 2].map(|row| shock.impulses[row] - shock.from[row]);
        if change != [0; 3] {
            shock.push(struck, *coarse, change);
        }
    }
    for &body in set.iter() {
        let velocity = &mut struck[body as usize].velocity;
        // Sums of all shocks of a body are below 2^60.
        // Most are far within: one comparison costs less than six.
        if velocity.iter().any(|part| !matches!(part >> 59, 0 | -1)) {
            *velocity = velocity.map(|part| part.clamp(-(1 << 59), 1 << 59));
        }
    }
    (largest, uphill)
}

/// Iterates until no shock closes. Where it `grows`, contacts that touch join as soon as they close.
/// Returns true if it has converged.
pub(super) fn compress(
    impacts: &mut Impacts,
    substep: SubStep<'_>,
    bodies: &BodyRows,
    groups: &ContactGroups,
    joints: &mut Joints,
    grows: bool,
) -> bool {
    impacts.shocks.iter_mut().for_each(Shock::begin);
    set_shares(impacts, joints);
    for &body in &impacts.set {
        let struck = &mut impacts.struck[body as usize];
        struck.begun = struck.velocity;
    }
    impacts.assemblies.set.iter().for_each(|&assembly| joints.mark_impact(assembly as usize));
    match iterate(impacts, substep, bodies, groups, joints, grows) {
        None => return false,
        Some(residual) if residual <= impacts.fastest >> 4 => return residual <= impacts.tolerance,
        Some(_) => impacts.is_clamped = true,
    }
    for shock in &mut impacts.shocks {
        (shock.impulses, shock.last) = (shock.begun, shock.begun);
    }
    for &body in &impacts.set {
        let struck = &mut impacts.struck[body as usize];
        struck.velocity = struck.begun;
    }
    impacts.assemblies.set.iter().for_each(|&assembly| joints.reset_impact(assembly as usize, impacts.coarse));
    impacts.assemblies.list_members(&impacts.struck, &impacts.struck_of);
    for _ in 0..MIN_ITERATIONS {
        impacts.count_work();
        run_ahead(impacts, 0);
        correct(impacts, true);
        impacts.answer_fully(joints);
    }
    false
}

/// The iterations of a compression. Returns the largest residual before the last one; `None` for a large set that is left as it is, and where joints
/// need coarser velocities.
fn iterate(
    impacts: &mut Impacts,
    substep: SubStep<'_>,
    bodies: &BodyRows,
    groups: &ContactGroups,
    joints: &mut Joints,
    grows: bool,
) -> Option<i64> {
    let (mut momentum, mut work, mut largest, mut joint_residual) = (0, 0, 0, 0);
    let (mut has_grown, mut is_answered) = (false, true);
    let mut is_left = false;
    for iteration in 1..=ITERATIONS {
        work += impacts.iteration_work();
        impacts.count_work();
        if iteration > MIN_ITERATIONS && (work > WORK || impacts.is_busy()) {
            is_left = true;
            break;
        }
        run_ahead(impacts, momentum);
        if momentum > 1 {
            joint_residual = impacts.estimate(joints).unwrap_or(joint_residual);
        }
        let (residual, uphill) = correct(impacts, iteration <= 4 || iteration % 8 == 0 || has_grown);
        // The residuals are of the velocities after the last answer of the joints.
        largest = residual.max(joint_residual);
        joint_residual = impacts.estimate(joints).unwrap_or(joint_residual);
        momentum = if uphill > 0 { 0 } else { momentum + 1 };
        // Large sets are less exact.
        let loose = if impacts.shocks.len() < SMALL { 0 } else { iteration / 16 };
        let is_done = largest >> loose <= impacts.tolerance;
        let may_end = is_done && is_answered;
        let may_grow = grows && iteration <= GROWING && (is_done || has_grown || iteration.is_power_of_two());
        // An estimate is near enough to go on from, and no end.
        is_answered = is_done || may_grow || !impacts.assemblies.is_estimated();
        if is_answered && impacts.assemblies.is_estimated() {
            joint_residual = impacts.answer_fully(joints);
        }
        if impacts.is_cut || is_answered && impacts.are_joints_cut(joints) {
            impacts.is_cut = true;
            return None;
        }
        has_grown = may_grow && join_closing(impacts, substep, bodies, groups, joints);
        if may_end && !has_grown {
            break;
        }
    }
    if !is_answered {
        impacts.answer_fully(joints);
    }
    (!is_left).then_some(largest)
}

/// Adds the contacts of the bodies that changed, and that touch and close, to the shocks. Returns true if there was one.
fn join_closing(
    impacts: &mut Impacts,
    substep: SubStep<'_>,
    bodies: &BodyRows,
    groups: &ContactGroups,
    joints: &mut Joints,
) -> bool {
    let before = impacts.shocks.len();
    let slowest = impacts.slowest();
    let mut index = 0;
    // Bodies that join meanwhile have not changed.
    let count = impacts.set.len();
    while index < count {
        let body = impacts.set[index] as usize;
        index += 1;
        let Struck { row, open, .. } = impacts.struck[body];
        if open == 0 || !impacts.struck[body].has_changed() {
            continue;
        }
        let mut at = impacts.index.first_normal_rows(row, groups);
        let mut end = at + open as usize;
        while at < end {
            let contact = impacts.index.normal_rows[at];
            let mut is_open = !impacts.is_joined[contact.place as usize];
            if is_open && !impacts.has_earlier_body(row, &contact) {
                match beside(impacts, substep, bodies, groups, &contact, slowest) {
                    Beside::Slow => {}
                    Beside::Apart => is_open = false,
                    Beside::Closing(before) => {
                        let shock = Shock::new(substep, bodies, groups, contact.place, before, impacts.moment);
                        impacts.join(shock, substep, &bodies.rows, joints);
                        is_open = false;
                    }
                }
            }
            if is_open {
                at += 1;
            } else {
                // The order of contacts does not count.
                end -= 1;
                impacts.index.normal_rows.swap(at, end);
                impacts.struck[body].open -= 1;
            }
        }
    }
    for shock in &mut impacts.shocks[before..] {
        shock.begin();
        impacts.exponent = impacts.exponent.max(shock.exponent);
    }
    if impacts.shocks.len() > before {
        set_shares(impacts, joints);
    }
    impacts.shocks.len() > before
}

/// Finds the matrices of the shocks for the shares of their bodies.
fn set_shares(impacts: &mut Impacts, joints: &mut Joints) {
    let Impacts { shocks, struck, struck_of, assemblies, coarse, fastest, tolerance, .. } = impacts;
    assemblies.give_shares(struck, struck_of);
    // Velocities of bodies have more bits, or fewer if they are coarse.
    let [still, tolerance] = [*fastest >> STILL_SPEED, *tolerance].map(|speed| speed << (FINE - FRACTION));
    let speeds = StopSpeeds::new(still, tolerance >> *coarse, *coarse);
    assemblies.stop_rows(shocks, struck, struck_of, &speeds, joints);
    assemblies.find_responses(shocks, struck, joints);
    assemblies.list_members(struck, struck_of);
    for shock in shocks {
        shock.set_shares(shock.bodies.map(|body| struck[body as usize].share));
    }
}
