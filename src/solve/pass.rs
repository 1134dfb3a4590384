//! The passes over contacts: the loops in which most of the time of a step goes.
//!
//! Contacts come in groups of [`GROUP`] lanes. A pass reads the velocities of both bodies of a contact, changes its
//! impulses and adds the changes of velocity that follow to the *gains* of both bodies; after all groups of a phase the gains are
//! applied. So no contact of a phase sees another one, and as integers add up to the same sum in any order, neither the
//! order of contacts nor the number of lanes or threads changes a bit.
//!
//! Reads: velocities and displacements of bodies. Writes: impulses and separations of contacts, gains and with them velocities of bodies.
//!
//! # Ranges
//! Bounds on the values, in units of the island ([`super::unit`]):
//! - *Velocities* are within ±[`VELOCITY`](super::motion::VELOCITY) = 2^27, displacements within
//!   ±[`DISPLACEMENT`](super::motion::DISPLACEMENT) = 2^28 (clamped in [`super::motion`]), normals within ±2^30 and arms
//!   within ±2^30. The velocity of a row is below (2√2 + 2)·2^27 = 2^29.28: a sum of products below 2^59.3.
//!   The change of the separation is below (2√2 + 2)·2^28 = 2^30.28; with a separation at the start within ±2^29.5
//!   ([`SEPARATION`](super::group::SEPARATION)) it is below 2^31.
//! - *Bias*: from −2^26 (the push) to 2^29 ([`SPECULATIVE`]). *Compliance*: at most a quarter of an impulse that counts as at most 2^31:
//!   2^29. Either one with the velocity of a row is below 2^30.2.
//! - *Inverse matrix*: entries below 2^30, or below 2^31 where the shift is zero, so that a sum of two products is
//!   below 2^62.2, before the shift.
//! - *Slip*: velocities below 2^59.3 and two products with the coupling below 2^58 each: below 2^60.2 before the rounding; less the
//!   velocity of the surface (2^27) below 2^30.4. Times the inverse below 2^31: below 2^61.4.
//! - *Impulses*: at most 2^44 ([`IMPULSE`](super::group::IMPULSE)) at the start and below 2^45 in a step: the change of one in
//!   a pass is within ±2^30, larger ones are cut off and counted, and a step has at most 16·(6 + 65) passes.
//! - *Gains*: in 2^-30, a factor is at most 2^28 over the share of the body. With changes of both normal impulses and of friction
//!   a contact gives below 2^59.6 over the share, so that all contacts of a phase together give below 2^59.6. Gains with a
//!   shift, and gains of a warm start with impulses beyond 2^30, are clamped at 2^61 over the share. The rest that a body carries, at
//!   most 1.5 units = 2^30.6, adds to this.

use super::cut::{cut_friction, cut_normal, warm_start_one};
use super::group::Group;
use super::matrix::{make_one_soft, make_ratios};
use super::motion::Rows;
use crate::kernel::simd::{GROUP, Gathered, Job, Lanes};

/// The largest bias of a contact that is still open: points farther apart do not meet in a sub-step.
pub(super) const SPECULATIVE: i32 = 1 << 29;

/// The velocities that a pass aims at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pass {
    /// Soft contacts push overlaps out.
    Solve,
    /// Rigid contacts and friction; overlaps stay as they are.
    Relax,
    /// Rigid contacts once more, and friction that does not grow: where friction pulls a contact tighter than the normal impulse can part
    /// it, as it may at a body with locks, both would grow with each pass.
    RelaxAgain,
    /// The impulses of the step before.
    WarmStart,
}

/// The aims of [`normal`], as constants for the compiler.
const SOLVE: u8 = 0;
const RELAX: u8 = 1;
const RELAX_AGAIN: u8 = 2;

/// One pass over the groups of a phase. The result is the number of impulses that were cut off.
pub(super) struct PassOver<'a> {
    pub(super) pass: Pass,
    pub(super) groups: &'a mut [Group],
    pub(super) rows: &'a mut Rows,
    /// Rows of the bodies of these contacts that can be moved.
    pub(super) touched: &'a [u32],
}

impl Job for PassOver<'_> {
    type Result = u64;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> u64 {
        let mut cut = 0;
        for group in self.groups {
            for at in (0..group.count).step_by(L::WIDTH) {
                match self.pass {
                    Pass::Solve => cut += normal::<L, SOLVE>(lanes, group, self.rows, at),
                    Pass::Relax => cut += normal::<L, RELAX>(lanes, group, self.rows, at),
                    Pass::RelaxAgain => cut += normal::<L, RELAX_AGAIN>(lanes, group, self.rows, at),
                    Pass::WarmStart => warm_start(lanes, group, self.rows, at),
                }
            }
        }
        cut + self.rows.apply_gains(lanes, self.touched)
    }
}

/// One of four values, for no point, the first, the second, both points pressed: a point with a positive separation is open.
#[inline(always)]
fn choose<L: Lanes>(lanes: L, [s1, s2]: [L::Narrow; 2], values: [L::Narrow; 4]) -> L::Narrow {
    let second_open = lanes.if_positive(s1, values[0], values[1]);
    let second_pressed = lanes.if_positive(s1, values[2], values[3]);
    lanes.if_positive(s2, second_open, second_pressed)
}

/// Elements 11, 12 and 22 of the inverse matrix.
type Elements<N> = [N; 3];

/// The matrix with the points softened that are pressed, and the velocities that both points aim at.
#[cfg_attr(not(debug_assertions), inline(always))]
fn soft<L: Lanes>(
    lanes: L,
    group: &mut Group,
    at: usize,
    separation: [L::Narrow; 2],
    velocities: [L::Narrow; 2],
    impulses: [L::Wide; 2],
) -> (Elements<L::Narrow>, [L::Narrow; 2]) {
    let (rate, deepest) = lanes.pair(&group.push_out, at);
    let (c1, c2) = lanes.pair(&group.compliance, at);
    let [s1, s2] = separation;
    let pressed = [
        pressed_bias(lanes, s1, rate, deepest, c1, impulses[0]),
        pressed_bias(lanes, s2, rate, deepest, c2, impulses[1]),
    ];
    let (both_11, both_22) = lanes.pair(&group.inverse[3], at);
    let (_, both_12) = lanes.pair(&group.inverse_12[1], at);
    if lanes.none_positive(s1, s2) {
        return ([both_11, both_12, both_22], pressed);
    }
    let (none_12, _) = lanes.pair(&group.inverse_12[0], at);
    let (none_11, none_22) = lanes.pair(&group.inverse[0], at);
    let zero = lanes.splat(0);
    let elements = if lanes.none_positive(lanes.if_positive(s2, zero, s1), lanes.if_positive(s1, zero, s2)) {
        // Of each contact both points are pressed, or none.
        [
            lanes.if_positive(s1, none_11, both_11),
            lanes.if_positive(s1, none_12, both_12),
            lanes.if_positive(s1, none_22, both_22),
        ]
    } else {
        if !group.has_one_soft {
            make_one_soft(lanes, group);
        }
        let ((_, first_12), (second_12, _)) =
            (lanes.pair(&group.inverse_12[0], at), lanes.pair(&group.inverse_12[1], at));
        let (first_11, first_22) = lanes.pair(&group.inverse[1], at);
        let (second_11, second_22) = lanes.pair(&group.inverse[2], at);
        [
            choose(lanes, separation, [none_11, first_11, second_11, both_11]),
            choose(lanes, separation, [none_12, first_12, second_12, both_12]),
            choose(lanes, separation, [none_22, first_22, second_22, both_22]),
        ]
    };
    let (_, impact_speed) = lanes.pair(&group.surface, at);
    let open = [open_bias(lanes, s1, velocities[0], impact_speed), open_bias(lanes, s2, velocities[1], impact_speed)];
    (elements, [lanes.if_positive(s1, open[0], pressed[0]), lanes.if_positive(s2, open[1], pressed[1])])
}

/// The matrix without softness.
#[inline(always)]
fn rigid<L: Lanes>(lanes: L, group: &Group, at: usize) -> Elements<L::Narrow> {
    let ((i11, i22), (i12, _)) = (lanes.pair(&group.inverse[0], at), lanes.pair(&group.inverse_12[0], at));
    [i11, i12, i22]
}

/// Element 12 of the matrix over elements 11 and 22.
#[inline(always)]
fn ratios<L: Lanes, const AIM: u8>(lanes: L, group: &mut Group, at: usize) -> (L::Narrow, L::Narrow) {
    if !group.has_ratios {
        make_ratios(lanes, group);
    }
    let ((p12, soft_p12), (p21, soft_p21)) = (lanes.pair(&group.ratio_12, at), lanes.pair(&group.ratio_21, at));
    if AIM != SOLVE {
        return (p12, p21);
    }
    let (s1, s2) = lanes.pair(&group.separation_now, at);
    (lanes.if_positive(s1, p12, soft_p12), lanes.if_positive(s2, p21, soft_p21))
}

/// The velocity, or the displacement, along a row: its linear part, and the angular part by the arms and the turns of both bodies.
#[inline(always)]
pub(super) fn along_row<L: Lanes>(
    lanes: L,
    linear: L::Wide,
    arms: (L::Narrow, L::Narrow),
    turns: (L::Narrow, L::Narrow),
) -> L::Narrow {
    lanes.rounded(lanes.sub(lanes.add(linear, lanes.times(arms.1, turns.1)), lanes.times(arms.0, turns.0)))
}

/// The dot product.
#[inline(always)]
fn dot<L: Lanes>(lanes: L, a: (L::Narrow, L::Narrow), b: (L::Narrow, L::Narrow)) -> L::Wide {
    lanes.add(lanes.times(a.0, b.0), lanes.times(a.1, b.1))
}

/// The velocity that a pressed soft point aims at, to push out, with its compliance.
#[inline(always)]
fn pressed_bias<L: Lanes>(
    lanes: L,
    separation: L::Narrow,
    rate: L::Narrow,
    deepest: L::Narrow,
    compliance: L::Narrow,
    impulse: L::Wide,
) -> L::Narrow {
    let pushed = lanes.times(rate, lanes.at_least(separation, deepest));
    lanes.rounded(lanes.add(pushed, lanes.times(compliance, lanes.capped(impulse))))
}

/// The velocity that an open point aims at: to close. A point that closes at the speed of an impact aims at nothing: its impact comes at
/// its moment.
#[inline(always)]
fn open_bias<L: Lanes>(lanes: L, separation: L::Narrow, velocity: L::Narrow, impact_speed: L::Narrow) -> L::Narrow {
    let limit = lanes.splat(SPECULATIVE);
    // A velocity is below 2^29.3 and the speed at most 2^28.
    let faster = lanes.minus(lanes.minus(lanes.splat(0), impact_speed), velocity);
    lanes.if_positive(faster, limit, lanes.at_most(separation, limit))
}

/// The velocity that a rigid point aims at: to close where it is open.
#[inline(always)]
fn rigid_bias<L: Lanes>(lanes: L, separation: L::Narrow, velocity: L::Narrow, impact_speed: L::Narrow) -> L::Narrow {
    // A point that meets at speed after the impacts of this sub-step has its impact in the next one.
    open_bias(lanes, lanes.at_least(separation, lanes.splat(0)), velocity, impact_speed)
}

/// The impulse of a point beside an open point: it solves its row alone.
#[inline(always)]
fn alone<L: Lanes>(lanes: L, x: L::Wide, ratio: L::Narrow, open_x: L::Wide) -> L::Wide {
    lanes.positive(lanes.add(x, lanes.floored::<28>(lanes.times(ratio, lanes.low(open_x)))))
}

/// The changes of angular velocity of both bodies as gains. Factors beyond a quarter, of bodies that turn far more easily than they
/// move, have a shift.
#[inline(always)]
fn turns<L: Lanes>(lanes: L, group: &Group, at: usize, turns: [L::Wide; 2]) -> [L::Wide; 2] {
    let shift = lanes.wide(&group.angular_shift, at);
    if lanes.is_zero(shift) {
        return turns;
    }
    let [turn_a, turn_b] = turns;
    let limit_a = lanes.floored_by(lanes.wide(&group.gain_limit[0], at), shift);
    let limit_b = lanes.floored_by(lanes.wide(&group.gain_limit[1], at), shift);
    // Without a shift a gain is within the limit.
    [lanes.raised_by(lanes.clamped(turn_a, limit_a), shift), lanes.raised_by(lanes.clamped(turn_b, limit_b), shift)]
}

/// Products of factors, in pairs, with an impulse.
#[inline(always)]
fn pushed<L: Lanes>(lanes: L, factors: (L::Narrow, L::Narrow), impulse: L::Narrow) -> [L::Wide; 2] {
    [lanes.times(factors.0, impulse), lanes.times(factors.1, impulse)]
}

/// The impulses of contacts from the solutions of their linear systems: where one of them pulls, it becomes zero and the other point
/// solves its row alone. The last value is the number of impulses that were cut off.
#[inline(always)]
fn limited<L: Lanes, const AIM: u8>(
    lanes: L,
    group: &mut Group,
    at: usize,
    [x1, x2]: [L::Wide; 2],
) -> (L::Wide, L::Wide, u64) {
    let (p12, p21) = ratios::<L, AIM>(lanes, group, at);
    let (l1, l2) = (lanes.wide(&group.impulses[0], at), lanes.wide(&group.impulses[1], at));
    let n1 = lanes.if_negative(x2, alone(lanes, x1, p12, x2), lanes.positive(x1));
    let n2 = lanes.if_negative(x1, alone(lanes, x2, p21, x1), lanes.positive(x2));
    if !lanes.are_beyond([lanes.sub(n1, l1), lanes.sub(n2, l2)], [x1, x2]) {
        return (n1, n2, 0);
    }
    let [mut m1, mut m2] = [[0; GROUP]; 2];
    lanes.store(&mut m1, 0, x1);
    lanes.store(&mut m2, 0, x2);
    let cut = cut_normal(group, at, L::WIDTH, [&mut m1, &mut m2], p12, p21, lanes);
    (lanes.wide(&m1, 0), lanes.wide(&m2, 0), cut)
}

/// The separations where both bodies are, which stay there up to the next sub-step's solve pass: later passes read them again.
#[inline(always)]
fn separations<L: Lanes>(
    lanes: L,
    group: &mut Group,
    at: usize,
    [a, b]: [&Gathered<L::Narrow>; 2],
) -> (L::Narrow, L::Narrow) {
    let d = (lanes.minus(b.displacement[0], a.displacement[0]), lanes.minus(b.displacement[1], a.displacement[1]));
    let moved = dot(lanes, lanes.pair(&group.normal, at), d);
    let turned = (a.displacement[2], b.displacement[2]);
    let (s1, s2) = lanes.pair(&group.separation, at);
    let s1 = lanes.plus(s1, along_row(lanes, moved, lanes.pair(&group.arms[0], at), turned));
    let s2 = lanes.plus(s2, along_row(lanes, moved, lanes.pair(&group.arms[1], at), turned));
    lanes.put_pair(&mut group.separation_now, at, (s1, s2));
    (s1, s2)
}

/// Both normal rows of contacts as one block; friction after them when they are relaxed.
#[cfg_attr(not(debug_assertions), inline(always))]
fn normal<L: Lanes, const AIM: u8>(lanes: L, group: &mut Group, rows: &mut Rows, at: usize) -> u64 {
    let (a, b) = (lanes.gather(&rows.rows, &group.a, at), lanes.gather(&rows.rows, &group.b, at));
    let n = lanes.pair(&group.normal, at);
    let v = (lanes.minus(b.velocity[0], a.velocity[0]), lanes.minus(b.velocity[1], a.velocity[1]));
    let (arms1, arms2) = (lanes.pair(&group.arms[0], at), lanes.pair(&group.arms[1], at));
    let closing = dot(lanes, n, v);
    let turning = (a.velocity[2], b.velocity[2]);
    let (r1, r2) = (along_row(lanes, closing, arms1, turning), along_row(lanes, closing, arms2, turning));
    let (l1, l2) = (lanes.wide(&group.impulses[0], at), lanes.wide(&group.impulses[1], at));
    let ([i11, i12, i22], [b1, b2]) = if AIM == SOLVE {
        let (s1, s2) = lanes.pair(&group.separation_now, at);
        soft(lanes, group, at, [s1, s2], [r1, r2], [l1, l2])
    } else {
        let (s1, s2) =
            if AIM == RELAX { separations(lanes, group, at, [&a, &b]) } else { lanes.pair(&group.separation_now, at) };
        let (_, impact_speed) = lanes.pair(&group.surface, at);
        let aims = [rigid_bias(lanes, s1, r1, impact_speed), rigid_bias(lanes, s2, r2, impact_speed)];
        (rigid(lanes, group, at), aims)
    };
    let r = (lanes.plus(r1, b1), lanes.plus(r2, b2));
    // The solution of the linear system: most often both points push.
    let shift = lanes.wide(&group.inverse_shift, at);
    let x1 = lanes.sub(l1, lanes.floored_by(dot(lanes, (i11, i12), r), shift));
    let x2 = lanes.sub(l2, lanes.floored_by(dot(lanes, (i12, i22), r), shift));
    let (mut n1, mut n2) = (x1, x2);
    let (mut d1, mut d2) = (lanes.sub(n1, l1), lanes.sub(n2, l2));
    let mut cut = 0;
    if !lanes.are_pushes([x1, x2], [d1, d2]) {
        (n1, n2, cut) = limited::<L, AIM>(lanes, group, at, [x1, x2]);
        (d1, d2) = (lanes.sub(n1, l1), lanes.sub(n2, l2));
    }
    lanes.store(&mut group.impulses[0], at, n1);
    lanes.store(&mut group.impulses[1], at, n2);
    let (d1, d2) = (lanes.low(d1), lanes.low(d2));
    let sum = lanes.plus(d1, d2);
    let [pax, pay] = pushed(lanes, lanes.pair(&group.linear_a[0], at), sum);
    let [pbx, pby] = pushed(lanes, lanes.pair(&group.linear_b[0], at), sum);
    let ((ga1, gb1), (ga2, gb2)) = (lanes.pair(&group.angular[0], at), lanes.pair(&group.angular[1], at));
    let paw = dot(lanes, (ga1, ga2), (d1, d2));
    let pbw = dot(lanes, (gb1, gb2), (d1, d2));
    let mut gains = [[pax, pay, paw], [pbx, pby, pbw]];
    if AIM != SOLVE {
        let slip = lanes.sub(lanes.times(n.1, v.0), lanes.times(n.0, v.1));
        cut += friction::<L, AIM>(lanes, group, at, slip, turning, lanes.add(n1, n2), (d1, d2), &mut gains);
        add_up::<L, AIM>(lanes, group, at, 0, l1, n1);
        add_up::<L, AIM>(lanes, group, at, 1, l2, n2);
    }
    let [[pax, pay, paw], [pbx, pby, pbw]] = gains;
    let [paw, pbw] = turns(lanes, group, at, [paw, pbw]);
    lanes.add_gains(&mut rows.rows, &group.a, at, [pax, pay, paw]);
    lanes.add_gains(&mut rows.rows, &group.b, at, [pbx, pby, pbw]);
    cut
}

/// The friction row of contacts, after both normal rows: adds to the gains (x, y, angular) of both bodies. `slip` is the linear part of the
/// velocity along the tangent (ny, −nx), `turning` the angular velocities, `pressing` the sum of the normal impulses and `changes` their
/// changes in this pass. Returns the number of impulses that were cut off.
#[inline(always)]
fn friction<L: Lanes, const AIM: u8>(
    lanes: L,
    group: &mut Group,
    at: usize,
    slip: L::Wide,
    turning: (L::Narrow, L::Narrow),
    pressing: L::Wide,
    changes: (L::Narrow, L::Narrow),
    gains: &mut [[L::Wide; 3]; 2],
) -> u64 {
    let (kat, kbt) = lanes.pair(&group.arms[2], at);
    let coupling = lanes.pair(&group.coupling, at);
    let (m, mu) = lanes.pair(&group.friction, at);
    let (surface, _) = lanes.pair(&group.surface, at);
    let slip = lanes.sub(lanes.add(slip, lanes.times(kbt, turning.1)), lanes.times(kat, turning.0));
    let slip = lanes.add(slip, dot(lanes, coupling, changes));
    let slip = lanes.minus(lanes.low(lanes.rounded_oddly::<30>(slip)), surface);
    let before = lanes.wide(&group.impulses[2], at);
    let wanted = lanes.sub(before, lanes.rounded_oddly::<27>(lanes.times(m, slip)));
    let mut after = lanes.clamped(wanted, lanes.share(mu, pressing));
    if AIM == RELAX_AGAIN {
        after = lanes.clamped(after, size(lanes, before));
    }
    let mut change = lanes.sub(after, before);
    let mut cut = 0;
    if lanes.is_beyond(change) {
        let mut words = [0; GROUP];
        lanes.store(&mut words, 0, after);
        cut = cut_friction(group, at, L::WIDTH, &mut words);
        after = lanes.wide(&words, 0);
        change = lanes.sub(after, before);
    }
    lanes.store(&mut group.impulses[2], at, after);
    add_up::<L, AIM>(lanes, group, at, 2, before, after);
    let change = lanes.low(change);
    let (gat, gbt) = lanes.pair(&group.angular[2], at);
    for (gains, (factors, turn)) in gains.iter_mut().zip([(&group.linear_a[1], gat), (&group.linear_b[1], gbt)]) {
        let [x, y] = pushed(lanes, lanes.pair(factors, at), change);
        let [along_x, along_y, angular] = *gains;
        *gains = [lanes.add(along_x, x), lanes.add(along_y, y), lanes.add(angular, lanes.times(turn, change))];
    }
    cut
}

/// |a|.
#[inline(always)]
fn size<L: Lanes>(lanes: L, a: L::Wide) -> L::Wide {
    lanes.add(lanes.positive(a), lanes.positive(lanes.sub(lanes.sub(a, a), a)))
}

/// Adds an impulse of a sub-step to the sums: as the solve pass left it, with which the bodies moved, and as the relax pass leaves it. Further
/// relax passes have their impulses [added](super::groups::ContactGroups::add_applied) when all are done.
#[inline(always)]
fn add_up<L: Lanes, const AIM: u8>(lanes: L, group: &mut Group, at: usize, k: usize, before: L::Wide, after: L::Wide) {
    if AIM == RELAX_AGAIN {
        return;
    }
    let (applied, weighted) = (lanes.wide(&group.applied[k], at), lanes.wide(&group.weighted[k], at));
    lanes.store(&mut group.weighted[k], at, lanes.add(weighted, lanes.add(applied, before)));
    lanes.store(&mut group.applied[k], at, lanes.add(applied, after));
}

/// Applies the impulses of the step before.
#[cfg_attr(not(debug_assertions), inline(always))]
fn warm_start<L: Lanes>(lanes: L, group: &mut Group, rows: &mut Rows, at: usize) {
    let (l1, l2) = (lanes.wide(&group.impulses[0], at), lanes.wide(&group.impulses[1], at));
    let sum = lanes.add(l1, l2);
    let along = lanes.wide(&group.impulses[2], at);
    if lanes.are_beyond([sum, along], [l1, l2]) {
        return (at..(at + L::WIDTH).min(group.count)).for_each(|lane| warm_start_one(group, rows, lane));
    }
    let (sum, along, l1, l2) = (lanes.low(sum), lanes.low(along), lanes.low(l1), lanes.low(l2));
    let [x, y] = pushed(lanes, lanes.pair(&group.linear_a[0], at), sum);
    let [tx, ty] = pushed(lanes, lanes.pair(&group.linear_a[1], at), along);
    let [ux, uy] = pushed(lanes, lanes.pair(&group.linear_b[0], at), sum);
    let [vx, vy] = pushed(lanes, lanes.pair(&group.linear_b[1], at), along);
    let ((ga1, gb1), (ga2, gb2)) = (lanes.pair(&group.angular[0], at), lanes.pair(&group.angular[1], at));
    let (gat, gbt) = lanes.pair(&group.angular[2], at);
    let turn_a = lanes.add(dot(lanes, (ga1, ga2), (l1, l2)), lanes.times(gat, along));
    let turn_b = lanes.add(dot(lanes, (gb1, gb2), (l1, l2)), lanes.times(gbt, along));
    let [turn_a, turn_b] = turns(lanes, group, at, [turn_a, turn_b]);
    lanes.add_gains(&mut rows.rows, &group.a, at, [lanes.add(x, tx), lanes.add(y, ty), turn_a]);
    lanes.add_gains(&mut rows.rows, &group.b, at, [lanes.add(ux, vx), lanes.add(uy, vy), turn_b]);
}
