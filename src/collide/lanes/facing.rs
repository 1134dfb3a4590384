//! The edges of two boxes that face each other along a direction.

use super::direction::{Along, Direction, Rectangle, Unit, Units};
use super::vector::{Corner, Vector, choose, cross, not, opposite};
use crate::kernel::simd::Lanes;

/// The edge of a box that faces along a direction, and the places across it of the corners that are farthest out, from the least to the
/// largest.
pub(super) struct Edge<L: Lanes> {
    pub(super) corners: [Corner<L>; 2],
    pub(super) support: [L::Wide; 2],
    pub(super) undecided: L::Mask,
}

/// The edge that faces along `w`, for the components of the first two corners along `w` and across it: corners count as equally far within
/// the slack.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn facing_edge<L: Lanes>(
    lanes: L,
    w: Vector<L>,
    normals: [Vector<L>; 2],
    heights: [L::Wide; 2],
    places: [L::Wide; 2],
    slack: L::Wide,
) -> Edge<L> {
    let zero = lanes.all(0);
    // Of each two opposite corners the higher one.
    let (is_third, is_fourth) = (lanes.greater(zero, heights[0]), lanes.greater(zero, heights[1]));
    let (first_height, second_height) = (lanes.magnitude(heights[0]), lanes.magnitude(heights[1]));
    let is_even = lanes.greater(first_height, lanes.add(second_height, slack));
    let is_odd = lanes.greater(second_height, lanes.add(first_height, slack));
    let is_corner = lanes.either(is_even, is_odd);
    // A lower one may be as high within rounding.
    let is_flat = not(lanes, lanes.greater(lanes.add(first_height, second_height), slack));
    // Both: the odd one follows the even one if both are of the first two or of the last two.
    let is_odd_first = lanes.unlike(is_third, is_fourth);
    let start = Corner { is_odd: is_odd_first, is_opposite: is_fourth };
    let end = Corner { is_odd: not(lanes, is_odd_first), is_opposite: is_third };
    // One: the edge before or after the corner.
    let corner = Corner { is_odd, is_opposite: choose(lanes, is_odd, is_fourth, is_third) };
    let (previous, next) = (corner.previous(lanes), corner.next(lanes));
    let sum_of_crosses =
        lanes.add(cross(lanes, w, previous.vector(lanes, normals)), cross(lanes, w, corner.vector(lanes, normals)));
    let is_previous = lanes.greater(sum_of_crosses, zero);
    let corners = [
        previous.or(lanes, is_previous, corner).or(lanes, is_corner, start),
        corner.or(lanes, is_previous, next).or(lanes, is_corner, end),
    ];
    let is_in_order = lanes.greater(corners[1].of(lanes, places), corners[0].of(lanes, places));
    let (even_place, odd_place) = (lanes.negated(is_third, places[0]), lanes.negated(is_fourth, places[1]));
    let (even_end, odd_end) =
        (lanes.select(is_odd, odd_place, even_place), lanes.select(is_even, even_place, odd_place));
    let is_level = choose(lanes, is_corner, lanes.equal(sum_of_crosses, zero), is_flat);
    Edge {
        corners,
        support: [lanes.smaller(even_end, odd_end), lanes.larger(even_end, odd_end)],
        undecided: lanes.either(is_level, not(lanes, is_in_order)),
    }
}

/// The ends of an edge in order of place.
pub(super) struct Ends<L: Lanes> {
    /// Relative to the position of the body, ulps.
    pub(super) corners: [Vector<L>; 2],
    pub(super) places: [L::Wide; 2],
    pub(super) numbers: [L::Wide; 2],
}

/// Two edges that face each other.
pub(super) struct Facing<L: Lanes> {
    pub(super) n: Vector<L>,
    pub(super) a: Ends<L>,
    pub(super) b: Ends<L>,
    pub(super) undecided: L::Mask,
}

/// The ends of an edge of a box by its corners.
#[cfg_attr(not(debug_assertions), inline(always))]
fn ends<L: Lanes>(lanes: L, rectangle: &Rectangle<L>, corners: [Corner<L>; 2], places: [L::Wide; 2]) -> Ends<L> {
    Ends {
        corners: [corners[0].vector(lanes, rectangle.corners), corners[1].vector(lanes, rectangle.corners)],
        places,
        numbers: [corners[0].number(lanes), corners[1].number(lanes)],
    }
}

#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn find_facing<L: Lanes>(
    lanes: L,
    a: &Rectangle<L>,
    b: &Rectangle<L>,
    units: &Units<L>,
    unit: &Unit<L>,
    direction: Direction<L>,
) -> Facing<L> {
    let Direction { n, along, undecided, .. } = direction;
    let zero = lanes.all(0);
    let across = Along::new(lanes, [lanes.sub(zero, n[1]), n[0]], units);
    let three = lanes.raised_by(lanes.all(3), unit.k);
    let slack_a = unit.length(lanes, lanes.add(three, lanes.floored::<29>(a.extent)));
    let slack_b = unit.length(lanes, lanes.add(three, lanes.floored::<29>(b.extent)));
    let (down_b, back_b) = (opposite(lanes, along.b), opposite(lanes, across.b));
    let edge_a = facing_edge(lanes, n, a.normals, along.a, across.a, slack_a);
    let edge_b = facing_edge(lanes, opposite(lanes, n), b.normals, down_b, back_b, slack_b);
    // Far corners next to each other have the direction between them.
    let separation = lanes.sub(lanes.sub(along.offset, lanes.largest(along.b)), lanes.largest(along.a));
    let far = unit.length(lanes, lanes.floored::<11>(lanes.smaller(a.extent, b.extent)));
    let is_far = lanes.both(lanes.greater(separation, zero), lanes.greater(separation, far));
    let support_b = [lanes.sub(across.offset, edge_b.support[1]), lanes.sub(across.offset, edge_b.support[0])];
    let are_beside =
        lanes.either(lanes.greater(edge_a.support[0], support_b[1]), lanes.greater(support_b[0], edge_a.support[1]));
    let (ends_a, ends_b) = (edge_a.corners, [edge_b.corners[1], edge_b.corners[0]]);
    let places_a = [ends_a[0].of(lanes, across.a), ends_a[1].of(lanes, across.a)];
    let places_b = [
        lanes.add(across.offset, ends_b[0].of(lanes, across.b)),
        lanes.add(across.offset, ends_b[1].of(lanes, across.b)),
    ];
    let is_facing = lanes.greater(lanes.smaller(places_a[1], places_b[1]), lanes.larger(places_a[0], places_b[0]));
    let undecided = lanes.either(undecided, lanes.either(edge_a.undecided, edge_b.undecided));
    let undecided = lanes.either(undecided, lanes.both(is_far, are_beside));
    Facing {
        n,
        a: ends(lanes, a, ends_a, places_a),
        b: ends(lanes, b, ends_b, places_b),
        undecided: lanes.either(undecided, not(lanes, is_facing)),
    }
}
