//! Fewer points for the same line.
//!
//! *Source* Douglas, Peucker, Cartographica 10, 112 (1973).

use super::{Point, length};

/// The points of a line without those that are within `tolerance` of it anyway.
pub(super) fn simplify(points: &[Point], tolerance: f64) -> Vec<Point> {
    let Some(last) = points.len().checked_sub(1) else { return Vec::new() };
    let mut kept = vec![false; points.len()];
    (kept[0], kept[last]) = (true, true);
    // Pieces that are still to be looked at: a stack of our own, as a spiral may halve badly.
    let mut pieces = vec![(0, last)];
    while let Some((from, to)) = pieces.pop() {
        let distances = (from + 1..to).map(|i| (i, distance(points[i], points[from], points[to])));
        if let Some((far, distance)) = distances.max_by(|a, b| a.1.total_cmp(&b.1)) {
            if distance > tolerance {
                kept[far] = true;
                pieces.extend([(from, far), (far, to)]);
            }
        }
    }
    points.iter().zip(kept).filter_map(|(&point, kept)| kept.then_some(point)).collect()
}

/// From a point to the piece of line from `a` to `b`.
fn distance(p: Point, a: Point, b: Point) -> f64 {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let (x, y) = (p.0 - a.0, p.1 - a.1);
    let square = dx * dx + dy * dy;
    let along = if square > 0.0 { ((x * dx + y * dy) / square).clamp(0.0, 1.0) } else { 0.0 };
    length((x - along * dx, y - along * dy))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_lines_keep_their_ends_and_corners_stay() {
        let line: Vec<Point> = (0..100).map(|i| (f64::from(i), 2.0 * f64::from(i))).collect();
        assert_eq!(simplify(&line, 1e-9), [line[0], line[99]]);
        assert_eq!(simplify(&[(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)], 0.5).len(), 3);
        assert_eq!(simplify(&[], 0.5), []);
        // There and back: the turning point is far from the piece between the equal ends.
        assert_eq!(simplify(&[(0.0, 0.0), (5.0, 0.0), (0.0, 0.0)], 0.5).len(), 3);
    }
}
