//! Scenes of boxes that are made up, and their pairs by comparison of each two.

use alloc::sync::Arc;
use alloc::vec::Vec;

use crate::collide::broad::{BroadPhase, PairLimits, Proxy, RestingTrees, Statics};
use crate::collider::Filter;
use crate::fx::Fx;
use crate::math::{Random, Vec2};
use crate::shape::Aabb;

pub(super) const NO_LIMITS: PairLimits =
    PairLimits { pairs: usize::MAX, per_collider: usize::MAX, overlaps: usize::MAX };

/// One metre in ulps.
pub(super) const METRE: i64 = 1 << 32;

/// A box from its corners in ulps.
pub(super) fn bounds(min: [i64; 2], max: [i64; 2]) -> Aabb<Fx> {
    let point = |[x, y]: [i64; 2]| Vec2::new(Fx::from_bits(x), Fx::from_bits(y));
    Aabb { min: point(min), max: point(max) }
}

pub(super) fn proxy(collider: u32, min: [i64; 2], max: [i64; 2]) -> Proxy {
    Proxy { collider, body: collider, bounds: bounds(min, max), filter: Filter::default(), digest: 0 }
}

/// The pairs by their definition.
pub(super) fn all_pairs(statics: &[Proxy], movers: &[Proxy]) -> Vec<[u32; 2]> {
    all_where(statics, movers, |a, b| a.body != b.body && a.filter.agrees(b.filter))
}

/// The overlaps that count, by their definition: pairs are among them.
pub(super) fn all_overlaps(statics: &[Proxy], movers: &[Proxy]) -> Vec<[u32; 2]> {
    let sees = |a: &Proxy, b: &Proxy| a.filter.mask & b.filter.category != 0;
    let is_any = |a: &Proxy, b: &Proxy| {
        let empty = |filter: Filter| filter.group <= 0 && filter.category == 0 && filter.mask == 0;
        (a.filter.group > 0 || b.filter.group > 0) && !empty(a.filter) && !empty(b.filter)
    };
    all_where(statics, movers, |a, b| sees(a, b) || sees(b, a) || is_any(a, b))
}

/// Overlapping boxes, of which one moves, for which something is true.
fn all_where(statics: &[Proxy], movers: &[Proxy], counts: impl Fn(&Proxy, &Proxy) -> bool) -> Vec<[u32; 2]> {
    let mut pairs = Vec::new();
    for (i, a) in movers.iter().enumerate() {
        for b in movers[i + 1..].iter().chain(statics) {
            if a.bounds.overlaps(b.bounds) && counts(a, b) {
                pairs.push([a.collider.min(b.collider), a.collider.max(b.collider)]);
            }
        }
    }
    pairs.sort_unstable();
    pairs
}

/// The pairs that a broad phase finds.
pub(super) fn updated_pairs(broad: &mut BroadPhase, statics: &Arc<Statics>, movers: &[Proxy]) -> Vec<[u32; 2]> {
    broad.update(&RestingTrees::of(statics), movers, &NO_LIMITS);
    assert!(broad.above_cap().is_empty());
    broad.pairs().to_vec()
}

/// The arrangement of the boxes of a scene.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    /// A few dense heaps.
    Clusters,
    /// All along one line, many with one coordinate.
    Line,
    /// Cells of a grid: neighbours have an edge or a corner in common, exactly.
    Grid,
    /// Sides from an ulp to a thousand kilometres.
    Sizes,
    /// At the ends of the range of `Fx`.
    Ends,
    /// Almost all at one place.
    Heap,
}

pub(super) const KINDS: [Kind; 6] = [Kind::Clusters, Kind::Line, Kind::Grid, Kind::Sizes, Kind::Ends, Kind::Heap];

impl Kind {
    pub(super) fn bounds(self, random: &mut Random) -> Aabb<Fx> {
        let two = |random: &mut Random, range: i64| [0; 2].map(|_| random.integer(-range..=range));
        let (centre, half) = match self {
            Kind::Clusters => {
                let heap = random.integer(-2..=2) * 50 * METRE;
                (two(random, 3 * METRE).map(|c| c + heap), two(random, METRE).map(i64::abs))
            }
            Kind::Line => ([random.integer(-40..=40) * METRE, random.integer(0..=1)], [METRE; 2]),
            Kind::Grid => (two(random, 6).map(|c| 2 * c * METRE), [METRE; 2]),
            Kind::Sizes => {
                let size = two(random, 26).map(|log| 1_i64 << (26 + log));
                (two(random, 200 * METRE), size)
            }
            Kind::Ends => {
                let end = two(random, 1).map(|side| side * (i64::MAX - 2 * METRE));
                (end, two(random, 2 * METRE).map(i64::abs))
            }
            Kind::Heap => (two(random, METRE / 4), [METRE; 2]),
        };
        bounds([0, 1].map(|k| centre[k] - half[k]), [0, 1].map(|k| centre[k] + half[k]))
    }
}

pub(super) fn filter(random: &mut Random) -> Filter {
    match random.below(4) {
        0 => Filter {
            category: 1 << random.below(3),
            mask: random.below(8) as u32,
            group: random.integer(-2..=2) as i32,
        },
        1 => Filter { group: random.integer(-1..=1) as i32, ..Filter::default() },
        _ => Filter::default(),
    }
}
