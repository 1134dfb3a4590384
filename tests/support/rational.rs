//! Plane geometry in exact rationals: the reference of distances.

use core::cmp::Ordering;

use dashu_int::IBig;

pub(crate) type Vector = [IBig; 2];

/// num / den, den > 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Ratio(pub(crate) IBig, pub(crate) IBig);

impl Ratio {
    pub(crate) fn cmp(&self, other: &Self) -> Ordering {
        (&self.0 * &other.1).cmp(&(&other.0 * &self.1))
    }
}

pub(crate) fn minus(a: &Vector, b: &Vector) -> Vector {
    [&a[0] - &b[0], &a[1] - &b[1]]
}

pub(crate) fn cross(a: &Vector, b: &Vector) -> IBig {
    &a[0] * &b[1] - &a[1] * &b[0]
}

pub(crate) fn dot(a: &Vector, b: &Vector) -> IBig {
    &a[0] * &b[0] + &a[1] * &b[1]
}

/// The square of the distance of a point from a segment.
pub(crate) fn square_from_segment(p: &Vector, a: &Vector, b: &Vector) -> Ratio {
    let (e, w) = (minus(b, a), minus(p, a));
    let (way, whole) = (dot(&w, &e), dot(&e, &e));
    if way <= IBig::ZERO {
        Ratio(dot(&w, &w), IBig::ONE)
    } else if way >= whole {
        let w = minus(p, b);
        Ratio(dot(&w, &w), IBig::ONE)
    } else {
        let c = cross(&w, &e);
        Ratio(&c * &c, whole)
    }
}
