//! The path of a body over a tick: pieces of constant velocity.

use crate::kernel::trig::sin_cos_turn;
use crate::scalar::Turn;

/// The end of a tick. Moments are in units of 2^-62 of a tick.
pub(crate) const END: u64 = 1 << 62;

/// `whole · part / 2^62`, to nearest, halves away from zero. *Domain* |whole| < 2^64.5: products are below 2^126.5.
fn part_of(whole: i128, part: u64) -> i128 {
    let size = (whole.unsigned_abs() * u128::from(part) + (1 << 61)) >> 62;
    if whole < 0 { -(size as i128) } else { size as i128 }
}

/// A motion at constant velocities from a moment on: of a body around its centre of mass, or of a body that a carrier takes along,
/// around the carrier's centre.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Leg {
    pub(super) from: u64,
    /// The centre of the rotation at `from`, ulps.
    centre: [i64; 2],
    /// The displacement of the centre in a tick, ulps: below 2^64.
    pub(super) way: [i128; 2],
    angle: Turn,
    /// The rotation in a tick, 2^-64 turns: below 2^82.
    pub(super) spin: i128,
    /// The centre of mass at `from`, relative to the centre of the rotation, ulps.
    arm: [i64; 2],
}

impl Leg {
    /// The motion over a tick from a pose. *Domain* centres within 2^31 m, a rotation below 2^18 turns.
    pub(crate) fn new(centre: [i64; 2], way: [i128; 2], angle: Turn, spin: i128) -> Self {
        Self { from: 0, centre, way, angle, spin, arm: [0; 2] }
    }

    /// The centre of the rotation at a moment.
    pub(super) fn centre(&self, at: u64) -> [i64; 2] {
        let passed = at - self.from;
        [0, 1].map(|k| self.centre[k].saturating_add(part_of(self.way[k], passed) as i64))
    }

    /// The rotation up to a moment, without whole turns.
    fn turned(&self, at: u64) -> u64 {
        let passed = at - self.from;
        let size = self.spin.unsigned_abs();
        // Turns times a moment in units of 2^-62 turns, below 2^80; the rest is below 2^64.
        let whole = ((size >> 64) * u128::from(passed)) << 2;
        let rest = part_of((size & u128::from(u64::MAX)) as i128, passed) as u128;
        let turned = (whole + rest) as u64;
        if self.spin < 0 { turned.wrapping_neg() } else { turned }
    }

    pub(super) fn angle(&self, at: u64) -> Turn {
        Turn::from_bits(self.angle.to_bits().wrapping_add(self.turned(at)))
    }

    /// The centre of mass at a moment, relative to the centre of the rotation.
    pub(super) fn arm(&self, at: u64) -> [i64; 2] {
        if self.arm == [0; 2] {
            return self.arm;
        }
        let (sin, cos) = sin_cos_turn(self.turned(at));
        super::form::turned(self.arm, sin, cos)
    }

    /// The centre of mass and the angle at a moment.
    pub(crate) fn pose(&self, at: u64) -> ([i64; 2], Turn) {
        let (centre, arm) = (self.centre(at), self.arm(at));
        ([0, 1].map(|k| centre[k].saturating_add(arm[k])), self.angle(at))
    }

    /// The body at rest from a moment on, where it is then.
    fn still(&self, from: u64) -> Self {
        let (centre, angle) = self.pose(from);
        Self { from, centre, way: [0; 2], angle, spin: 0, arm: [0; 2] }
    }

    /// The motion of the body that a carrier takes along from a moment on.
    fn carried(&self, carrier: &Self, from: u64) -> Self {
        let (position, angle) = self.pose(from);
        let centre = carrier.centre(from);
        let arm = [0, 1].map(|k| position[k].saturating_sub(centre[k]));
        Self { from, centre, angle, arm, ..*carrier }
    }

    pub(crate) fn moves(&self) -> bool {
        self.way != [0; 2] || self.turns()
    }

    pub(crate) fn turns(&self) -> bool {
        self.spin != 0
    }

    /// A bound of the way of a point within `reach` of the centre, ulps.
    pub(crate) fn farthest(&self, reach: i64) -> i64 {
        let straight = self.way.iter().map(|way| way.unsigned_abs()).sum::<u128>();
        // No point moves farther by a rotation than twice its distance from the centre; 2π is below 7.
        let turns = u128::from(((self.spin.unsigned_abs() >> 32) + 1).min(1 << 32) as u64);
        let round =
            (((7 * turns * u128::from(reach.unsigned_abs())) >> 32) + 1).min(2 * u128::from(reach.unsigned_abs()));
        (straight + round).min(1 << 62) as i64
    }

    /// Returns true if the centres of mass on two paths of one piece stay farther apart than `reach`: a bound that may miss some.
    pub(crate) fn stays_apart(&self, leg: &Self, reach: i64) -> bool {
        if self.arm != [0; 2] || leg.arm != [0; 2] {
            return false;
        }
        let offset = [0, 1].map(|k| i128::from(leg.centre[k]) - i128::from(self.centre[k]));
        let way = [0, 1].map(|k| leg.way[k] - self.way[k]);
        let largest = offset.iter().chain(&way).map(|part| part.unsigned_abs()).max().unwrap_or(0);
        let down = (128 - largest.leading_zeros()).saturating_sub(30);
        // Towards zero: alike in a mirror image.
        let scaled = |part: i128| (part.unsigned_abs() >> down) as i64 * part.signum() as i64;
        passes_beyond(offset.map(scaled), way.map(scaled), (reach >> down).saturating_add(4))
    }
}

/// Returns true if a point at an offset from the origin stays farther from it than `reach` on a straight way.
///
/// # Ranges
/// *Domain* components below 2^30. Sums of two products are below 2^61, their squares below 2^122; where the end of the way is nearest, it is
/// no farther than the beginning.
#[inline(always)]
pub(crate) fn passes_beyond([x, y]: [i64; 2], [vx, vy]: [i64; 2], reach: i64) -> bool {
    let square_of_reach = reach.saturating_mul(reach);
    let (dot, square) = (x * vx + y * vy, vx * vx + vy * vy);
    if dot >= 0 {
        return x * x + y * y > square_of_reach;
    }
    if dot + square <= 0 {
        let (x, y) = (x + vx, y + vy);
        return x * x + y * y > square_of_reach;
    }
    let cross = i128::from(x * vy - y * vx);
    cross * cross > i128::from(square_of_reach) * i128::from(square)
}

/// The piece of a path at a moment, and the moment at which it ends.
pub(super) fn leg(legs: &[Leg], at: u64) -> (&Leg, u64) {
    let next = legs.iter().position(|leg| leg.from > at).unwrap_or(legs.len());
    let until = legs.get(next).map_or(END, |next| next.from);
    (&legs[next.saturating_sub(1)], until)
}

/// A box of the centres of the rotation and the arms over the tick: low and high ends.
pub(crate) fn ends(legs: &[Leg]) -> ([i64; 2], [i64; 2]) {
    let (mut low, mut high) = ([i64::MAX; 2], [i64::MIN; 2]);
    for (i, leg) in legs.iter().enumerate() {
        let until = legs.get(i + 1).map_or(END, |next| next.from);
        let arm = leg.arm[0].saturating_abs().saturating_add(leg.arm[1].saturating_abs());
        for centre in [leg.centre, leg.centre(until)] {
            low = [0, 1].map(|k| low[k].min(centre[k].saturating_sub(arm)));
            high = [0, 1].map(|k| high[k].max(centre[k].saturating_add(arm)));
        }
    }
    (low, high)
}

/// The most pieces of a path: its own, at rest, carried along, at rest.
const LEGS: usize = 12;

/// The path of a body over a tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Path {
    legs: [Leg; LEGS],
    count: usize,
}

impl Path {
    pub(crate) fn new(leg: Leg) -> Self {
        Self { legs: [leg; LEGS], count: 1 }
    }

    pub(crate) fn legs(&self) -> &[Leg] {
        &self.legs[..self.count]
    }

    /// The piece at a moment.
    fn leg(&self, at: u64) -> &Leg {
        leg(self.legs(), at).0
    }

    /// The last piece.
    pub(crate) fn last(&self) -> &Leg {
        &self.legs[self.count - 1]
    }

    /// The number of pieces.
    pub(crate) fn len(&self) -> usize {
        self.count
    }

    pub(crate) fn moves(&self) -> bool {
        self.legs().iter().any(Leg::moves)
    }

    /// Cuts the path off at a moment and goes on with a piece. Without room for it, the path stays.
    fn go_on(&mut self, at: u64, leg: Leg) {
        while self.count > 1 && self.last().from >= at {
            self.count -= 1;
        }
        if self.count < LEGS {
            self.legs[self.count] = leg;
            self.count += 1;
        }
    }

    /// Stops the body at a moment.
    pub(crate) fn stop(&mut self, at: u64) {
        let leg = *self.leg(at);
        if leg.moves() {
            self.go_on(at, leg.still(at));
        } else {
            self.count = self.legs().iter().take_while(|leg| leg.from <= at).count();
        }
    }

    /// The moment at which the body stops on its own path, if that is all that happens to it.
    pub(crate) fn stopped_at(&self) -> Option<u64> {
        match self.legs() {
            [_, still] if !still.moves() => Some(still.from),
            _ => None,
        }
    }

    /// Returns true if the body stands still from a moment on.
    pub(crate) fn stands_from(&self, at: u64) -> bool {
        self.last().from <= at && !self.last().moves()
    }

    pub(crate) fn differs(&self, path: &Self) -> bool {
        self.legs() != path.legs()
    }

    /// The piece in which a carrier takes this body along from a moment on.
    pub(crate) fn carried(&self, carrier: &Self, at: u64) -> Leg {
        self.leg(at).carried(carrier.leg(at), at)
    }

    /// Goes on with a piece from a moment.
    pub(crate) fn carry(&mut self, at: u64, leg: Leg) {
        self.go_on(at, leg);
    }
}
