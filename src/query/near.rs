//! The point of a core that is nearest to the origin.

use core::cmp::Ordering;

use super::{Core, Point, cross, dot, edge, outward};
use crate::kernel::sqrt::{over_root, root_fine};
use crate::kernel::wide::{div_256, mul_128};

/// The part of a core that is nearest to the origin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Near {
    /// The origin is in the core.
    Inside,
    /// The inner of an edge, by the number of its first corner.
    Edge(usize),
    Corner(usize),
}

/// The part of the core of a shape, without its radius, that is nearest to the origin. Exact; it is one part alone.
pub(crate) fn nearest(corners: &[Point]) -> Near {
    let corner = |i: usize| if corners[i] == [0; 2] { Near::Inside } else { Near::Corner(i) };
    let count = corners.len();
    if count == 1 {
        return corner(0);
    }
    // Where the origin is along an edge: products are below 2^105.
    let along = |i: usize| {
        let e = edge(corners, i);
        (-dot(corners[i], e), dot(e, e))
    };
    if count == 2 {
        return match along(0) {
            (way, _) if way <= 0 => corner(0),
            (way, whole) if way >= whole => corner(1),
            _ => match cross(corners[0], edge(corners, 0)) {
                0 => Near::Inside,
                // To the right of the edge, or to the right of the way back.
                side => Near::Edge(usize::from(side > 0)),
            },
        };
    }
    let mut is_outside = false;
    for i in 0..count {
        if cross(corners[i], edge(corners, i)) < 0 {
            is_outside = true;
            let (way, whole) = along(i);
            if 0 < way && way < whole {
                return Near::Edge(i);
            }
        }
    }
    if !is_outside {
        return Near::Inside;
    }
    // The origin is beyond the end of one edge and before the start of the next.
    let is_nearest = |&i: &usize| {
        let (before, whole) = along(if i > 0 { i - 1 } else { count - 1 });
        along(i).0 <= 0 && before >= whole
    };
    (0..count).find(is_nearest).map_or(Near::Inside, corner)
}

/// Returns true if the origin is in a shape or on its surface. Exact.
pub(crate) fn contains(core: &Core) -> bool {
    let corners = core.corners();
    // Mostly it is not even in the box.
    let is_beside = |k: usize| {
        corners.iter().all(|corner| corner[k] > core.radius) || corners.iter().all(|corner| corner[k] < -core.radius)
    };
    if is_beside(0) || is_beside(1) {
        return false;
    }
    match nearest(corners) {
        Near::Inside => true,
        feature => order_of_distance(core, feature) != Ordering::Greater,
    }
}

/// The distance of the origin, which is not in the core, from its nearest part, compared with the radius. Exact.
pub(super) fn order_of_distance(core: &Core, feature: Near) -> Ordering {
    let corners = core.corners();
    let square = u128::from(core.radius.unsigned_abs()).pow(2);
    match feature {
        Near::Inside => Ordering::Less,
        // Below 2^109.
        Near::Corner(i) => (dot(corners[i], corners[i]) as u128).cmp(&square),
        Near::Edge(i) => {
            let e = edge(corners, i);
            // The distance times the length: below 2^105, so that its square has 256 bits. A radius is below 2^46.
            let away = cross(corners[i], e).unsigned_abs();
            mul_128(away, away).cmp(&mul_128(square, dot(e, e) as u128))
        }
    }
}

/// Bits of a distance after an ulp.
pub(crate) const FRACTION: u32 = 16;

/// The distance of the origin from the surface of a shape in units of 2^-16 ulp, that is 2^-48 m; 0 in it. *Error* ½ unit and 2^-9.
/// Below 2^71.
pub(crate) fn distance(core: &Core, feature: Near) -> u128 {
    let corners = core.corners();
    let from_core = match feature {
        Near::Inside => return 0,
        Near::Corner(i) => {
            let (root, up) = root_of(dot(corners[i], corners[i]) as u128);
            // Between 2^95 and 2^96, so that half a unit can be added.
            (root + (1 << (up - FRACTION - 1))) >> (up - FRACTION)
        }
        Near::Edge(i) => {
            let e = edge(corners, i);
            let away = cross(corners[i], e).unsigned_abs();
            let (root, up) = root_of(dot(e, e) as u128);
            // Times 2^(up + 16), at most 2^112: the product is below 2^217, and its quotient by a root of 2^95 or more below 2^123.
            let left = up + FRACTION;
            let (quotient, rest) = div_256(away >> (128 - left), away << left, root);
            quotient + u128::from(rest >= root - rest)
        }
    };
    from_core.saturating_sub((core.radius as u128) << FRACTION)
}

/// √x in units of 2^-up, from 2^95 to 2^96, within 0.501 of a unit, and `up`, from 32 to 95. *Domain* 0 < x < 2^127.
pub(super) fn root_of(x: u128) -> (u128, u32) {
    let even = x.leading_zeros() & !1;
    (root_fine(x << even), 32 + even / 2)
}

/// The point of the surface of a shape that is nearest to the origin, ulps, and the vector from it towards the origin, of any
/// length; the origin itself and zero if it is in the shape. *Error* of the point ½ ulp and 2^-7 in each component. Odd.
pub(crate) fn point(core: &Core, feature: Near, distance: u128) -> (Point, Point) {
    let corners = core.corners();
    let (towards, square) = match feature {
        Near::Inside => return ([0; 2], [0; 2]),
        Near::Corner(i) if core.radius == 0 => return (corners[i], corners[i].map(|part| -part)),
        Near::Corner(i) => (corners[i].map(|part| -part), dot(corners[i], corners[i])),
        Near::Edge(i) => {
            let e = edge(corners, i);
            (outward(e), dot(e, e))
        }
    };
    if distance == 0 {
        return ([0; 2], [0; 2]);
    }
    // In units of 2^-7 ulp, below 2^62.
    let whole = (distance >> (FRACTION - 7)) as u64;
    let part = |c: i64| {
        let size = over_root(c.unsigned_abs(), whole, square as u128);
        let ulps = ((size + (1 << 6)) >> 7) as i64;
        if c > 0 { -ulps } else { ulps }
    };
    (towards.map(part), towards)
}
