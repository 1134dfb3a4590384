//! Effective masses of the rows that have laws: with them springs have their frequencies, and rows their stiffness.

use super::{FAR, Joint, JointKind, direction_of, rope_way};
use crate::fx::Fx;
use crate::kernel::sqrt::direction;
use crate::math::Vec2;
use crate::scalar::FxFactor;
use crate::solve::Flight;

/// The square of a component.
fn square(component: Fx) -> FxFactor {
    let size = FxFactor::from_scalar(component.abs());
    size.times(size)
}

/// The square of a number in 2^-bits.
fn square_of_bits(value: i128, bits: i32) -> FxFactor {
    let size = FxFactor::new(value.unsigned_abs(), bits);
    size.times(size)
}

/// The inertia of a body; `None` if it cannot turn.
fn inertia(flight: &Flight) -> Option<FxFactor> {
    (!flight.inverse_inertia.is_zero()).then(|| FxFactor::ONE.over(flight.inverse_inertia))
}

/// The moment of inertia of masses at an arm: motion along x turns an arm along y.
fn moment([mx, my]: [FxFactor; 2], arm: Vec2) -> FxFactor {
    mx.times(square(arm.y)).plus(my.times(square(arm.x)))
}

/// The effective mass of the angle between two bodies that are pinned together at these arms: 1/K in kg·m², for
/// K = (I₁ + I₂ + μ|r₁ − r₂|²)/(I₁·I₂ + μ(I₁·r₂² + I₂·r₁²) + μ²(r₁ × r₂)²) and the reduced mass μ of both. `None` if none can turn.
fn pinned_inertia([first, second]: [&Flight; 2], [a, b]: [Vec2; 2]) -> Option<FxFactor> {
    // A locked axis of both takes part no more: there the pin alone decides.
    let reduced = |sum: FxFactor| if sum.is_zero() { FxFactor::ZERO } else { FxFactor::ONE.over(sum) };
    let mx = reduced(first.inverse_mass.x.plus(second.inverse_mass.x));
    let is_isotropic = [first, second].iter().all(|flight| flight.inverse_mass.x == flight.inverse_mass.y);
    let my = if is_isotropic { mx } else { reduced(first.inverse_mass.y.plus(second.inverse_mass.y)) };
    match [inertia(first), inertia(second)] {
        [None, None] => None,
        [Some(first), None] => Some(first.plus(moment([mx, my], a))),
        [None, Some(second)] => Some(second.plus(moment([mx, my], b))),
        [Some(first), Some(second)] => {
            let apart = Vec2::new(a.x.saturating_sub(b.x), a.y.saturating_sub(b.y));
            let product = |p: Fx, q: Fx| i128::from(p.to_bits()) * i128::from(q.to_bits());
            // Arms are below 2^12.5 m: products in 2^-64 are below 2^90.
            let cross = (product(a.x, b.y) - product(a.y, b.x)).unsigned_abs();
            let cross = FxFactor::new(cross, 64);
            let numerator = first
                .times(second)
                .plus(first.times(moment([mx, my], b)))
                .plus(second.times(moment([mx, my], a)))
                .plus(mx.times(my).times(cross).times(cross));
            Some(numerator.over(first.plus(second).plus(moment([mx, my], apart))))
        }
    }
}

impl Joint {
    /// The effective mass of the angle, kg·m²; `None` if no body can turn.
    pub(in crate::solve) fn effective_inertia(&self, flights: [&Flight; 2]) -> Option<FxFactor> {
        let is_pinned = self.kind.frame_angle().is_none() && !matches!(self.kind, JointKind::Gear { .. });
        if is_pinned {
            return pinned_inertia(flights, self.anchors);
        }
        let [first, second] = self.kind.angle_factors().map(|factor| square_of_bits(factor.into(), 30));
        let sum = first.times(flights[0].inverse_inertia).plus(second.times(flights[1].inverse_inertia));
        (!sum.is_zero()).then(|| FxFactor::ONE.over(sum))
    }

    /// The effective mass of the distance along the axis or the line for the offset of the anchors, in 2^-32 m: kg. `None` if nothing can move. Of a
    /// planar joint it is the mass in the direction in which the bodies resist least, so that springs of both ways pull to one point.
    ///
    /// It is 1/K, for the velocity K along the axis by an impulse. The angle of a slider that is locked takes its part: for the reduced mass μ,
    /// both moments of inertia I, and the offset of the centres with s along the axis and D in all, it is μ(I + μs²)/(I + μD²).
    pub(in crate::solve) fn effective_mass(&self, flights: [&Flight; 2], offset: [i128; 2]) -> Option<FxFactor> {
        let offset = offset.map(|part| part.clamp(-FAR, FAR));
        let [ux, uy] = match self.kind {
            JointKind::Planar { .. } => return self.planar_mass(flights, offset),
            JointKind::Pulley { grounds, .. } => return self.rope_mass(flights, grounds),
            JointKind::Slider { angle } => direction_of(angle),
            _ if offset == [0; 2] => return None,
            _ => direction(offset[0] as i64, offset[1] as i64).0.map(i64::from),
        };
        let [xx, yy] = [ux, uy].map(|part| square_of_bits(part.into(), 30));
        let linear = flights.map(|flight| xx.times(flight.inverse_mass.x).plus(yy.times(flight.inverse_mass.y)));
        let arms = self.anchors.map(|anchor| [anchor.x, anchor.y].map(|part| i128::from(part.to_bits())));
        let is_slider = matches!(self.kind, JointKind::Slider { .. });
        let is_locked =
            is_slider && self.axis.and_then(|axis| axis.limits).is_some_and(|[lower, upper]| lower == upper);
        let mut inverse = linear[0].plus(linear[1]);
        if is_locked {
            if inverse.is_zero() {
                return None;
            }
            let reduced = FxFactor::ONE.over(inverse);
            let [Some(first), Some(second)] = flights.map(inertia) else { return Some(reduced) };
            let inertia = first.plus(second);
            // Below 2^61 and 2^91.
            let [x, y] = [0, 1].map(|i| offset[i] + arms[0][i] - arms[1][i]);
            let along = square_of_bits(i128::from(ux) * x + i128::from(uy) * y, 62);
            let distance = square_of_bits(x, 32).plus(square_of_bits(y, 32));
            let turned = inertia.plus(reduced.times(along)).over(inertia.plus(reduced.times(distance)));
            return Some(reduced.times(turned));
        }
        for (side, flight) in flights.into_iter().enumerate() {
            let reach = |i: usize| arms[side][i] + if is_slider && side == 0 { offset[i] } else { 0 };
            let cross = reach(0) * i128::from(uy) - reach(1) * i128::from(ux);
            inverse = inverse.plus(square_of_bits(cross, 62).times(flight.inverse_inertia));
        }
        (!inverse.is_zero()).then(|| FxFactor::ONE.over(inverse))
    }

    /// The effective mass of a rope over two points, with the factors f of both parts and their directions n: 1/K for
    /// K = f₁²·(1/m₁ + (r₁ × n₁)²/I₁) + f₂²·(1/m₂ + (r₂ × n₂)²/I₂).
    fn rope_mass(&self, flights: [&Flight; 2], grounds: [Vec2; 2]) -> Option<FxFactor> {
        let mut inverse = FxFactor::ZERO;
        for (side, flight) in flights.into_iter().enumerate() {
            let (anchor, factor) = (self.anchors[side], self.kind.rope_factors()[side]);
            let [x, y] = rope_way(flight, anchor, grounds[side]).map(|part| part.clamp(-FAR, FAR) as i64);
            if (x, y) == (0, 0) {
                continue;
            }
            let [ux, uy] = direction(x, y).0.map(i128::from);
            let cross = i128::from(anchor.x.to_bits()) * uy - i128::from(anchor.y.to_bits()) * ux;
            let [xx, yy] = [ux, uy].map(|part| square_of_bits(part, 30));
            let linear = xx.times(flight.inverse_mass.x).plus(yy.times(flight.inverse_mass.y));
            let sum = linear.plus(square_of_bits(cross, 62).times(flight.inverse_inertia));
            inverse = inverse.plus(square_of_bits(factor.into(), 30).times(sum));
        }
        (!inverse.is_zero()).then(|| FxFactor::ONE.over(inverse))
    }

    /// The effective mass of a planar joint: 1/K for K = 1/m₁ + 1/m₂ + r₁²/I₁ + r₂²/I₂ with arms to the second anchor.
    fn planar_mass(&self, flights: [&Flight; 2], offset: [i128; 2]) -> Option<FxFactor> {
        let mut inverse = FxFactor::ZERO;
        for (side, flight) in flights.into_iter().enumerate() {
            let anchor = self.anchors[side];
            let reach = if side == 0 { offset } else { [0; 2] };
            // Below 2^61 each.
            let [x, y] = [i128::from(anchor.x.to_bits()) + reach[0], i128::from(anchor.y.to_bits()) + reach[1]];
            let square = square_of_bits(x, 32).plus(square_of_bits(y, 32));
            let linear = flight.inverse_mass.x.max(flight.inverse_mass.y);
            inverse = inverse.plus(linear).plus(square.times(flight.inverse_inertia));
        }
        (!inverse.is_zero()).then(|| FxFactor::ONE.over(inverse))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::vec2;
    use crate::solve::{Impulses, Velocity};
    use crate::{fx, solve};

    /// A body of this mass and 2 kg·m² at rest.
    fn flight(position: Vec2, mass: i64) -> Flight {
        let still = Velocity { linear: Vec2::ZERO, angular: Fx::ZERO };
        let inverse_mass = FxFactor::from_ratio(1, mass as u64);
        Flight {
            position,
            start: still,
            end: still,
            displacement: Vec2::ZERO,
            rotation: Fx::ZERO,
            mass: Fx::from_bits(mass << 32),
            inverse_mass: Vec2::new(inverse_mass, inverse_mass),
            inverse_inertia: FxFactor::from_ratio(1, 2),
            radius: fx!(2),
            leader: None,
        }
    }

    /// 1/K for K = (1/2)²·(1/3 + 1²/2) + 1/5: an arm across the first part of the rope, and two strands at the second body.
    #[test]
    fn a_rope_meets_both_bodies_by_its_strands() {
        let flights = [flight(vec2(0, 0), 3), flight(vec2(9, 0), 5)];
        let kind = solve::JointKind::Pulley { grounds: [vec2(1, 4), vec2(9, 7)], strands: [1, 2] };
        let anchors = [vec2(1, 0), vec2(0, 1)];
        let impulses = Impulses::default();
        let joint = Joint { bodies: [0, 1], anchors, kind, axis: None, slides: [None; 2], impulses };
        let mass = joint.effective_mass([&flights[0], &flights[1]], [0; 2]).and_then(FxFactor::to_scalar);
        let expected = fx!(120) / 49;
        assert!((mass.expect("a mass") - expected).abs() < fx!(0.00001), "{mass:?} {expected}");
    }
}
