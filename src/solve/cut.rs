//! Contacts with a value that is too large for the loops of [`super::pass`], one at a time in wider integers. They are rare, and this way
//! the loops need no wide products.

use super::group::Group;
use super::motion::Rows;
use crate::kernel::simd::{GROUP, Lanes, Pairs};

/// Wanted impulses count up to this: far above any that a pass can reach, and their differences fit.
const WANTED: i128 = 1 << 58;
/// The largest change of an impulse in a pass.
pub(super) const CHANGE: i64 = (1 << 30) - 1;

/// Cuts off changes of normal impulses that are too large for the loop, for some lanes: `solution` is the solution of the linear system,
/// and becomes the impulses. Returns the number of impulses that were cut.
#[cold]
#[inline(never)]
pub(super) fn cut_normal<L: Lanes>(
    group: &Group,
    at: usize,
    width: usize,
    solution: [&mut [i64; GROUP]; 2],
    p12: L::Narrow,
    p21: L::Narrow,
    lanes: L,
) -> u64 {
    let [first, second] = solution;
    let [mut ratio_12, mut ratio_21] = [[0; GROUP]; 2];
    let unit = lanes.splat(1);
    lanes.store(&mut ratio_12, 0, lanes.times(p12, unit));
    lanes.store(&mut ratio_21, 0, lanes.times(p21, unit));
    let mut cut = 0;
    for lane in 0..width {
        let before = [group.impulses[0][at + lane], group.impulses[1][at + lane]];
        let x = [first[lane], second[lane]];
        // Below 2^64.8: the solution is below 2^62.3, a ratio at most 4.
        let alone = |x: i64, ratio: i64, open_x: i64| {
            let wanted = i128::from(x) + ((i128::from(ratio) * i128::from(open_x)) >> 28);
            wanted.clamp(0, WANTED) as i64
        };
        let wanted = [
            if x[1] < 0 { alone(x[0], ratio_12[lane], x[1]) } else { x[0].max(0) },
            if x[0] < 0 { alone(x[1], ratio_21[lane], x[0]) } else { x[1].max(0) },
        ];
        for (k, impulse) in [&mut first[lane], &mut second[lane]].into_iter().enumerate() {
            let change = (wanted[k] - before[k]).clamp(-CHANGE - 1, CHANGE);
            cut += u64::from(change != wanted[k] - before[k]);
            *impulse = before[k] + change;
        }
    }
    cut
}

/// Cuts off changes of friction that are too large, for some lanes. Returns the number of impulses that were cut.
#[cold]
#[inline(never)]
pub(super) fn cut_friction(group: &Group, at: usize, width: usize, wanted: &mut [i64; GROUP]) -> u64 {
    let mut cut = 0;
    for (lane, wanted) in wanted.iter_mut().enumerate().take(width) {
        let before = group.impulses[2][at + lane];
        // The same bound on both sides: friction has no direction of its own.
        let change = (*wanted - before).clamp(-CHANGE, CHANGE);
        cut += u64::from(change != *wanted - before);
        *wanted = before + change;
    }
    cut
}

/// Applies the impulses of the step before, of one contact, of any size.
#[cold]
pub(super) fn warm_start_one(group: &Group, rows: &mut Rows, lane: usize) {
    let [l1, l2, lt] = [0, 1, 2].map(|k| i128::from(group.impulses[k][lane]));
    let times = |fraction: i32, impulse: i128| i128::from(fraction) * impulse;
    // Above the gain of any impulses that the loop over lanes accepts.
    let limits = group.gain_limit.map(|limit| i128::from(limit[lane]));
    let linear = |l: &[Pairs; 2], k: usize, limit: i128| {
        (times(l[0][lane][k], l1 + l2) + times(l[1][lane][k], lt)).clamp(-limit, limit) as i64
    };
    let angular = |k: usize| {
        let limit = limits[k];
        let [g1, g2, gt] = [0, 1, 2].map(|row| group.angular[row][lane][k]);
        let turn = times(g1, l1) + times(g2, l2) + times(gt, lt);
        let shift = group.angular_shift[lane];
        (turn.clamp(-(limit >> shift), limit >> shift) << shift) as i64
    };
    let [gain_a, gain_b] = [(&group.linear_a, 0), (&group.linear_b, 1)]
        .map(|(factors, side)| [linear(factors, 0, limits[side]), linear(factors, 1, limits[side]), angular(side)]);
    for k in 0..3 {
        rows.rows[group.a[lane] as usize].gain[k] += gain_a[k];
        rows.rows[group.b[lane] as usize].gain[k] += gain_b[k];
    }
}
