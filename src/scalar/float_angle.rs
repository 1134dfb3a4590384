//! Angles of floats in radians, kept within one turn: of drawings, and of worlds of floats.

use core::cmp::Ordering;

/// A float that is an angle.
pub(crate) trait FloatAngle: Copy {
    /// The angle of this number of radians, in [0, 2π).
    fn wrapped(self) -> Self;

    /// The angle turned by this number of radians.
    fn turned_by(self, radians: Self) -> Self;

    /// The shortest way to another angle, between −π and π; zero for half a turn, where both ways are as long.
    fn shortest_way_to(self, goal: Self) -> Self;

    /// Sine and cosine.
    fn sine_cosine(self) -> (Self, Self);
}

macro_rules! float_angle {
    ($float:ident, $sin:ident, $cos:ident) => {
        impl FloatAngle for $float {
            fn wrapped(self) -> Self {
                let rest = self % core::$float::consts::TAU;
                let angle = if rest < 0.0 { rest + core::$float::consts::TAU } else { rest };
                // A tiny negative one rounds up to the whole turn.
                if angle < core::$float::consts::TAU { angle } else { 0.0 }
            }

            fn turned_by(self, radians: Self) -> Self {
                (self + radians).wrapped()
            }

            fn shortest_way_to(self, goal: Self) -> Self {
                let way = (goal - self).wrapped();
                match way.partial_cmp(&core::$float::consts::PI) {
                    Some(Ordering::Greater) => way - core::$float::consts::TAU,
                    Some(Ordering::Equal) => 0.0,
                    _ => way,
                }
            }

            fn sine_cosine(self) -> (Self, Self) {
                (libm::$sin(self), libm::$cos(self))
            }
        }
    };
}

float_angle!(f64, sin, cos);
float_angle!(f32, sinf, cosf);
