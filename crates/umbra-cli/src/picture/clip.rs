//! Lines and polygons cut at the edge of the picture.

use super::Point;

/// A rectangle along the axes by its lower left and upper right corner.
pub(super) type Window = [Point; 2];

/// The pieces of a line that are inside.
pub(super) fn line(points: &[Point], window: &Window) -> Vec<Vec<Point>> {
    let mut pieces: Vec<Vec<Point>> = Vec::new();
    for pair in points.windows(2) {
        let Some((a, b)) = segment(pair[0], pair[1], window) else { continue };
        match pieces.last_mut() {
            Some(piece) if piece.last() == Some(&a) => piece.push(b),
            _ => pieces.push(vec![a, b]),
        }
    }
    pieces
}

/// The part of a straight piece that is inside.
///
/// *Source* Liang, Barsky, ACM Trans. Graph. 3, 1 (1984).
fn segment(a: Point, b: Point, [min, max]: &Window) -> Option<(Point, Point)> {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let (mut enters, mut leaves) = (0.0f64, 1.0f64);
    let edges = [(-dx, a.0 - min.0), (dx, max.0 - a.0), (-dy, a.1 - min.1), (dy, max.1 - a.1)];
    for (speed, room) in edges {
        if speed == 0.0 {
            if room < 0.0 {
                return None;
            }
        } else if speed < 0.0 {
            enters = enters.max(room / speed);
        } else {
            leaves = leaves.min(room / speed);
        }
    }
    let at = |t: f64| (a.0 + dx * t, a.1 + dy * t);
    // Untouched ends stay the same to the bit, so that pieces join.
    let from = if enters == 0.0 { a } else { at(enters) };
    let to = if leaves == 1.0 { b } else { at(leaves) };
    (enters <= leaves).then_some((from, to))
}

/// The part of a polygon that is inside.
///
/// *Source* Sutherland, Hodgman, Commun. ACM 17, 32 (1974).
pub(super) fn polygon(ring: &[Point], [min, max]: &Window) -> Vec<Point> {
    let mut ring = ring.to_vec();
    // For each edge: how far inside a point is.
    let edges: [&dyn Fn(Point) -> f64; 4] = [&|p| p.0 - min.0, &|p| max.0 - p.0, &|p| p.1 - min.1, &|p| max.1 - p.1];
    for inside in edges {
        let mut cut = Vec::with_capacity(ring.len() + 2);
        for (i, &b) in ring.iter().enumerate() {
            let a = ring[(i + ring.len() - 1) % ring.len()];
            let (depth_a, depth_b) = (inside(a), inside(b));
            if (depth_a >= 0.0) != (depth_b >= 0.0) {
                let t = depth_a / (depth_a - depth_b);
                cut.push((a.0 + (b.0 - a.0) * t, a.1 + (b.1 - a.1) * t));
            }
            if depth_b >= 0.0 {
                cut.push(b);
            }
        }
        ring = cut;
    }
    ring
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINDOW: Window = [(0.0, 0.0), (10.0, 10.0)];

    #[test]
    fn a_line_that_leaves_and_comes_back_is_two_pieces() {
        let line = line(&[(5.0, 5.0), (5.0, 15.0), (7.0, 15.0), (7.0, 5.0)], &WINDOW);
        assert_eq!(line, [[(5.0, 5.0), (5.0, 10.0)], [(7.0, 10.0), (7.0, 5.0)]]);
    }

    #[test]
    fn a_polygon_over_a_corner_keeps_what_is_inside() {
        let square = [(-5.0, -5.0), (5.0, -5.0), (5.0, 5.0), (-5.0, 5.0)];
        let cut = polygon(&square, &WINDOW);
        assert_eq!(cut.len(), 4);
        assert!(cut.iter().all(|p| (0.0..=5.0).contains(&p.0) && (0.0..=5.0).contains(&p.1)));
        assert!(polygon(&square.map(|(x, y)| (x - 20.0, y)), &WINDOW).is_empty());
    }
}
