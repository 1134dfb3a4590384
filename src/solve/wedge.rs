//! Wedges: bodies between others that do not give way and push them out along several normals.
//!
//! Overlaps are pushed out at up to [`push_speed`](super::SolverOptions::push_speed) along each normal. Along two normals at an angle θ that
//! takes a body out between them at that speed over cos(θ/2), which a narrow wedge makes as large as one likes, and which no pass takes
//! back: each row sees the cosine of it alone. So both push by cos(θ/2) less, at least by 2^-7 of the speed: a body that others clamp rests.
//!
//! The limit holds for the fastest of a body's points, by each point of a contact and by both together: pushed across the way that locks
//! leave it, or at a small lever, a body would be thrown. Where bodies give way, further relax passes take the push back
//! (`contact::split`).
//!
//! Reads: normals and separations of contacts. Writes: the deepest overlaps that they push out.

use super::group::Group;
use super::groups::ContactGroups;

/// One, for components of normals and cosines.
const ONE: i64 = 1 << 30;

/// A contact that pushes a body out of one that does not give way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Push {
    row: u32,
    /// The index of the contact's place.
    place: u32,
    /// Towards the body.
    normal: [i64; 2],
}

/// Limits the depths that count as overlaps, by which contacts push out, for bodies in wedges.
pub(super) fn limit_wedges(pushes: &mut [Push], groups: &mut ContactGroups) {
    pushes.sort_unstable_by_key(|push| push.row);
    for body in pushes.chunk_by(|a, b| a.row == b.row) {
        for push in body {
            push.limit(body, groups);
        }
    }
}

impl Push {
    /// The contact of a lane, of whose bodies one is held.
    pub(super) fn new(group: &Group, lane: usize, is_held: [bool; 2], place: u32) -> Self {
        let (row, sign) = if is_held[1] { (group.a[lane], -1) } else { (group.b[lane], 1) };
        Self { row, place, normal: group.normal[lane].map(|part| sign * i64::from(part)) }
    }

    /// Limits the push of a contact by the normal that is most against it, among all pushes of the body.
    ///
    /// # Ranges
    /// Components of normals are within 2^30: a sum of two products is below 2^62.
    fn limit(&self, body: &[Self], groups: &mut ContactGroups) {
        let cosine = |second: &Self| (self.normal[0] * second.normal[0] + self.normal[1] * second.normal[1]) >> 30;
        let smallest_cosine = body.iter().map(cosine).min().unwrap_or(ONE).clamp(-ONE, ONE);
        // cos(θ/2) = √((1 + cos θ)/2), in 2^-30.
        let half = (((((ONE + smallest_cosine) / 2) << 30) as u64).isqrt() as i64).max(ONE >> 7);
        let place = &groups.places[self.place as usize];
        let deepest = &mut groups.groups[place.group as usize].push_out[place.lane as usize][1];
        *deepest = ((i64::from(*deepest) * half) >> 30) as i32;
    }
}
