//! Expansion: impacts return a share of their impulses, as far as all impulses together do no work.
//!
//! Reads: the shocks of a set, compressed. Writes: their impulses; then strikes, sums of joints, the impulses and separations of their contacts, and the
//! rows of their bodies.

use super::super::bodies::{BodyRows, STILL};
use super::super::groups::ContactGroups;
use super::super::joint::Joints;
use super::super::motion::Rows;
use super::super::number::shifted;
use super::compress::compress;
use super::jacobian::{Jacobian, coarsened};
use super::shock::{Shock, wide};
use super::{COARSER, FINE, FRACTION, Impacts, ONE, Strike, Struck, SubStep};
use crate::kernel::simd::Lanes;

/// The rounding of a velocity of a body by all iterations, in its units.
const ROUNDING: u64 = 1 << 16;

/// The attempts at a set without limits that pull: then rows are free, whatever limits they are at.
const ATTEMPTS: u32 = 4;

/// Bits of a share of impulses.
const SHARE: u32 = 20;

/// Twice the work of impulses J + s·K as a polynomial of the share s, in units of the impulses of the largest exponent times 2^-16 of
/// velocities.
///
/// # Ranges
/// Impulses are below 2^47 and velocities below 2^47 in 2^-16, or coarser units: products below 2^94, sums over 2^12 shocks below 2^108,
/// times a share below 2^127.
#[derive(Clone, Copy, Debug, Default)]
struct Work {
    constant: i128,
    linear: i128,
    square: i128,
}

impl Work {
    fn is_gain(&self, share: i128) -> bool {
        let linear = (self.linear * share) >> SHARE;
        let square = (((self.square * share) >> SHARE) * share) >> SHARE;
        self.constant + linear + square > 0
    }

    /// The largest share up to 1 without a gain.
    fn largest_share(&self) -> i128 {
        let mut lowest = 0;
        let mut gaining = 1 << SHARE;
        if !self.is_gain(gaining) {
            return gaining;
        }
        while gaining - lowest > 1 {
            let middle = (lowest + gaining) / 2;
            if self.is_gain(middle) { gaining = middle } else { lowest = middle }
        }
        lowest
    }
}

/// Σ impulse · velocity over the rows, in units of the largest exponent and of coarse velocities, rounded up.
#[inline(always)]
fn work(impulses: [i64; 3], velocities: [i64; 3], down: i32, coarse: i32) -> i128 {
    let velocities = coarsened(velocities, coarse);
    let product = |row: usize| i128::from(impulses[row]) * i128::from(velocities[row]);
    -(-(product(0) + product(1) + product(2)) >> down.clamp(0, 126))
}

/// The sum of two velocities by row.
fn sum(a: [i64; 3], b: [i64; 3]) -> [i64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// The difference of two impulses or velocities by row.
fn difference(a: [i64; 3], b: [i64; 3]) -> [i64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Solves the shocks of a set, by coarser velocities where velocities of bodies do not hold the changes by impulses. Where coarser ones do
/// not either, there is no impact, and the passes stop the bodies.
pub(super) fn solve_shocks(
    impacts: &mut Impacts,
    substep: SubStep<'_>,
    bodies: &BodyRows,
    groups: &ContactGroups,
    joints: &mut Joints,
) {
    solve_pushing(impacts, substep, bodies, groups, joints);
    if is_cut_off(impacts, joints) {
        impacts.coarse = COARSER;
        for &body in &impacts.set {
            let struck = &mut impacts.struck[body as usize];
            struck.start = coarsened(struck.start, COARSER);
        }
        take_all_back(impacts, joints);
        solve_pushing(impacts, substep, bodies, groups, joints);
        if is_cut_off(impacts, joints) {
            take_all_back(impacts, joints);
        }
    }
}

/// [`solve_set`] until no limit of a joint pulls.
fn solve_pushing(
    impacts: &mut Impacts,
    substep: SubStep<'_>,
    bodies: &BodyRows,
    groups: &ContactGroups,
    joints: &mut Joints,
) {
    for attempt in 1.. {
        solve_set(impacts, substep, bodies, groups, joints);
        if impacts.is_cut || !impacts.assemblies.bar_stops(joints, attempt == ATTEMPTS) {
            return;
        }
        take_all_back(impacts, joints);
    }
}

/// Compression, expansion, and compression of the contacts that the expansion closes.
fn solve_set(
    impacts: &mut Impacts,
    substep: SubStep<'_>,
    bodies: &BodyRows,
    groups: &ContactGroups,
    joints: &mut Joints,
) {
    let fastest = impacts.shocks.iter().flat_map(|shock| shock.speeds).max().unwrap_or(0);
    (impacts.is_clamped, impacts.is_cut) = (false, false);
    impacts.moment = impacts.shocks.iter().map(Shock::moment).min().unwrap_or(0);
    impacts.tolerance = (fastest >> 12).max(1 << (FRACTION - 2));
    impacts.fastest = fastest;
    impacts.exponent = impacts.shocks.iter().map(|shock| shock.exponent).max().unwrap_or(0);
    let is_converged = compress(impacts, substep, bodies, groups, joints, true);
    if impacts.is_cut {
        return;
    }
    if !is_converged {
        take_back_gain(impacts, joints);
    }
    for shock in &mut impacts.shocks {
        shock.workless = shock.impulses;
        shock.extra = shock.returned();
    }
    if impacts.shocks.iter().all(|shock| shock.extra == [0; 3]) {
        return;
    }
    add_within_energy(impacts, joints);
    for shock in &mut impacts.shocks {
        shock.lower_bounds = [shock.impulses[0], shock.impulses[1]];
    }
    compress(impacts, substep, bodies, groups, joints, false);
    // Normal impulses can only take energy away here; friction may not.
    take_back_gain(impacts, joints);
}

/// Takes back a share of the impulses beyond the ones that surely do no work, if all of them do work: friction and a compression that
/// ended early may.
fn take_back_gain(impacts: &mut Impacts, joints: &mut Joints) {
    let Impacts { shocks, struck, coarse, .. } = impacts;
    for shock in shocks {
        shock.extra = difference(shock.impulses, shock.workless);
        shock.push(struck, *coarse, shock.extra.map(|impulse| -impulse));
        shock.impulses = shock.workless;
    }
    impacts.answer_fully(joints);
    add_within_energy(impacts, joints);
}

/// Adds a share of `extra` to the impulses of the shocks: the largest one up to 1 with which all of them do no work.
fn add_within_energy(impacts: &mut Impacts, joints: &mut Joints) {
    let Impacts { shocks, struck, exponent, coarse, .. } = impacts;
    let mut total = Work::default();
    for shock in shocks.iter_mut() {
        shock.after = shock.velocities(struck, *coarse);
        let down = *exponent - shock.exponent;
        let velocities = sum(shock.relative_before(), shock.after);
        total.constant += work(shock.impulses, velocities, down, *coarse);
        total.linear += work(shock.extra, velocities, down, *coarse);
    }
    for shock in shocks.iter() {
        shock.push(struck, *coarse, shock.extra);
    }
    impacts.answer_fully(joints);
    let Impacts { shocks, struck, exponent, coarse, .. } = impacts;
    for shock in shocks.iter() {
        let down = *exponent - shock.exponent;
        let change = difference(shock.velocities(struck, *coarse), shock.after);
        total.linear += work(shock.impulses, change, down, *coarse);
        total.square += work(shock.extra, change, down, *coarse);
        // Rounding of velocities, by up to four units, is no gain.
        let rounding = (0..3).map(|row| i128::from(shock.impulses[row].abs() + shock.extra[row].abs()) * 4);
        total.constant -= rounding.sum::<i128>() >> down.clamp(0, 126);
    }
    let share = total.largest_share();
    for shock in shocks.iter_mut() {
        let added = shock.extra.map(|impulse| shifted(i128::from(impulse) * share, SHARE as i32) as i64);
        if share < 1 << SHARE {
            shock.push(struck, *coarse, difference(added, shock.extra));
        }
        shock.impulses = sum(shock.impulses, added);
    }
    if share < 1 << SHARE {
        impacts.answer_fully(joints);
    }
}

/// Returns true if the velocity of a body is not the one that the impulses of the shocks give it. Without limits it is, but for the
/// rounding of coarse ones.
fn is_cut_off(impacts: &mut Impacts, joints: &Joints) -> bool {
    for &body in &impacts.set {
        let struck = &mut impacts.struck[body as usize];
        struck.begun = struck.start;
    }
    for shock in &impacts.shocks {
        for (side, &body) in shock.bodies.iter().enumerate() {
            let change = shock.jacobian.gain(side, shock.impulses, 1, impacts.coarse);
            let begun = &mut impacts.struck[body as usize].begun;
            (0..3).for_each(|axis| begun[axis] = begun[axis].wrapping_add(change[axis]));
        }
    }
    if impacts.is_cut || impacts.are_joints_cut(joints) {
        return true;
    }
    let Impacts { struck, struck_of, assemblies, .. } = impacts;
    assemblies.add_gains(struck, struck_of, joints);
    impacts.set.iter().any(|&body| {
        let Struck { begun, velocity, .. } = &impacts.struck[body as usize];
        (0..3).any(|axis| begun[axis].abs_diff(velocity[axis]) > ROUNDING)
    })
}

/// Takes all impulses of the shocks back.
fn take_all_back(impacts: &mut Impacts, joints: &mut Joints) {
    impacts.assemblies.begin_again(joints);
    for shock in &mut impacts.shocks {
        (shock.impulses, shock.lower_bounds, shock.workless) = ([0; 3], [0; 2], [0; 3]);
    }
    for &body in &impacts.set {
        let struck = &mut impacts.struck[body as usize];
        struck.velocity = struck.start;
    }
}

/// Applies the impulses of a round to the bodies and to the sums of their contacts, and lists the contacts to look at again.
pub(super) fn strike<L: Lanes>(
    impacts: &mut Impacts,
    bodies: &mut BodyRows,
    groups: &mut ContactGroups,
    joints: &mut Joints,
    lanes: L,
) {
    let mean = mean_moment(impacts);
    let Impacts { shocks, struck, struck_of, set, strikes, is_joined, coarse, velocities, assemblies, .. } = impacts;
    for shock in shocks.iter() {
        is_joined[shock.place as usize] = false;
        if shock.impulses == [0; 3] {
            continue;
        }
        let place = &groups.places[shock.place as usize];
        let (group, lane) = (&mut groups.groups[place.group as usize], place.lane as usize);
        let late = shock.late(mean);
        for (row, late) in late.iter().enumerate() {
            group.applied[row][lane] += shock.impulses[row];
            group.weighted[row][lane] -= late;
        }
        let moment = shock.moments.into_iter().flatten().max().unwrap_or(mean);
        for (side, &body) in shock.bodies.iter().enumerate() {
            let back = shock.jacobian.gain(side, late, 1, *coarse);
            let struck = &mut struck[body as usize];
            (0..3).for_each(|axis| struck.back[axis] += i128::from(back[axis]) << *coarse);
            // Impacts of other bodies at one that cannot be moved are none of its own.
            if shock.is_movable(side) {
                struck.moment = struck.moment.max(moment);
            }
        }
        let speeds = shock.speeds.map(|speed| speed >> FRACTION);
        strikes.push(Strike { place: shock.place, impulses: shock.impulses, speeds });
    }
    assemblies.strike(struck, struck_of, *coarse, joints);
    for body in set.iter() {
        let struck = &mut struck[*body as usize];
        let back = core::mem::take(&mut struck.back);
        struck.is_in_set = false;
        if struck.has_changed() && struck.row != STILL {
            let limit = (1 << 60) >> *coarse;
            let change = [0, 1, 2].map(|axis| struck.velocity[axis] - struck.start[axis]);
            let change = change.map(|part| part.clamp(-limit, limit) << *coarse);
            bodies.rows.strike(lanes, struck.row, change, back.map(|way| shifted(way, FINE)));
            velocities.forget(struck.row);
        }
    }
    for index in 0..impacts.set.len() {
        let struck = impacts.struck[impacts.set[index] as usize];
        if struck.has_changed() && struck.row != STILL {
            for at in impacts.index.places_of(struck.row) {
                let place = impacts.index.places[at];
                renew_separation(&bodies.rows, groups, place);
                // More rounds would not help bodies that have no way to go.
                if !impacts.is_clamped {
                    impacts.pending.push(place);
                }
            }
        }
    }
}

/// Finds the separations of a contact where its bodies are.
pub(super) fn renew_separation(rows: &Rows, groups: &mut ContactGroups, place: u32) {
    let place = &groups.places[place as usize];
    let (group, lane) = (&mut groups.groups[place.group as usize], place.lane as usize);
    let [a, b] = [group.a[lane], group.b[lane]].map(|row| wide(rows.displacement(row)));
    let [first, second, _] = Jacobian::of(group, lane).along(a, b, 0);
    for (point, moved) in [first, second].into_iter().enumerate() {
        group.separation_now[lane][point] = group.separation[lane][point] + moved as i32;
    }
}

/// The mean of the moments of the shocks, by their impulses.
fn mean_moment(impacts: &Impacts) -> i64 {
    let (mut sum, mut total) = (0_i128, 0_i128);
    for shock in &impacts.shocks {
        let down = (impacts.exponent - shock.exponent).clamp(0, 126);
        for point in 0..2 {
            if let Some(moment) = shock.moments[point] {
                sum += (i128::from(shock.impulses[point]) * i128::from(moment)) >> down;
                total += i128::from(shock.impulses[point]) >> down;
            }
        }
    }
    if total > 0 { (sum / total).clamp(0, ONE.into()) as i64 } else { 0 }
}
