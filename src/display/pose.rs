//! Poses of bodies in floats.

use crate::math::Vec2;
use crate::scalar::{FloatAngle, Scalar, ToF64};
use crate::world::BodyRef;

/// Position and angle of a body, for drawing.
///
/// An `f32` has 24 bits: 10 km from the origin its spacing is a millimetre. Make a pose
/// [relative to the camera](Self::relative_to) in `f64` before converting it to `f32`.
///
/// ```
/// use umbra_physics::{BodyDef, Fx, Pose, World, WorldDef, vec2};
///
/// let mut world = World::new(WorldDef::default())?;
/// let def = BodyDef { position: vec2(100_000_003, 4), angle: Fx::FRAC_PI_2, ..BodyDef::dynamic() };
/// let body = world.add_body(def)?;
/// let pose = Pose::of(&world.body(body)?);
/// assert_eq!(pose.position, [100_000_003.0, 4.0]);
/// assert_eq!(pose.relative_to([100_000_000.0, 0.0]).to_f32().position, [3.0f32, 4.0]);
/// // A point of the body, in its own axes.
/// let [x, y] = pose.point([1.0, 0.0]);
/// assert!((x - 100_000_003.0).abs() < 1e-7 && (y - 5.0).abs() < 1e-7);
/// # Ok::<(), umbra_physics::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose<T = f64> {
    /// Position of the centre of mass, m.
    pub position: [T; 2],
    /// Angle, rad, in [0, 2π); an `f32` may round up to 2π itself.
    pub angle: T,
}

impl Pose {
    /// At the origin, not turned.
    pub const ORIGIN: Self = Self { position: [0.0; 2], angle: 0.0 };

    /// The pose of a body at the tick of its world.
    #[must_use]
    pub fn of<S: Scalar + ToF64>(body: &BodyRef<'_, S>) -> Self {
        Self { position: body.position().to_f64(), angle: body.angle().to_f64() }
    }

    /// Rounds position and angle to singles.
    #[must_use]
    pub const fn to_f32(self) -> Pose<f32> {
        let Self { position: [x, y], angle } = self;
        Pose { position: [x as f32, y as f32], angle: angle as f32 }
    }

    /// The pose in coordinates whose origin is at this point, m: the position of a camera, for example.
    #[must_use]
    pub fn relative_to(self, [x, y]: [f64; 2]) -> Self {
        Self { position: [self.position[0] - x, self.position[1] - y], angle: self.angle }
    }

    /// World coordinates of a point of the body, m; `at` is in the body's axes, from its centre of mass.
    #[must_use]
    pub fn point(self, at: [f64; 2]) -> [f64; 2] {
        Placed::at(self).point(at)
    }

    /// The way from one pose to another at a share of it from 0 to 1, turned the short way round; exactly half a turn, which
    /// has no short way, is made at once at the end. At the ends it is exactly theirs, and where they are equal it stays.
    ///
    /// ```
    /// use umbra_physics::Pose;
    ///
    /// let end = Pose { position: [2.0, 0.0], angle: 6.0 };
    /// let half = Pose::ORIGIN.between(end, 0.5);
    /// assert_eq!(half.position, [1.0, 0.0]);
    /// assert!((half.angle - 6.1416).abs() < 1e-4); // back by 0.1416, not on by 3
    /// ```
    #[must_use]
    pub fn between(self, end: Self, share: f64) -> Self {
        let position = [0, 1].map(|i| mix(self.position[i], end.position[i], share));
        let way = self.angle.shortest_way_to(end.angle);
        let angle = if share < 1.0 { self.angle.turned_by(way * share) } else { end.angle };
        Self { position, angle }
    }
}

/// From a to b, from the nearer end: exactly a at 0, b at 1.
fn mix(a: f64, b: f64, share: f64) -> f64 {
    if share < 0.5 { a + (b - a) * share } else { b - (b - a) * (1.0 - share) }
}

impl<S: ToF64> Vec2<S> {
    /// The doubles nearest to its components.
    ///
    /// ```
    /// use umbra_physics::{fx, vec2};
    ///
    /// let wind = vec2(3, fx!(-0.5));
    /// assert_eq!(wind.to_f64(), [3.0, -0.5]);
    /// ```
    #[must_use]
    pub fn to_f64(self) -> [f64; 2] {
        [self.x.to_f64(), self.y.to_f64()]
    }
}

/// A pose with its sine and cosine.
#[derive(Clone, Copy)]
pub(super) struct Placed {
    pub(super) pose: Pose,
    sin: f64,
    cos: f64,
}

impl Placed {
    pub(super) fn at(pose: Pose) -> Self {
        let (sin, cos) = pose.angle.sine_cosine();
        Self { pose, sin, cos }
    }

    pub(super) fn turned(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [x * self.cos - y * self.sin, x * self.sin + y * self.cos]
    }

    pub(super) fn point(&self, at: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.turned(at);
        [self.pose.position[0] + x, self.pose.position[1] + y]
    }

    /// The pose of a part of the body.
    pub(super) fn part(&self, at: [f64; 2], angle: f64) -> Self {
        Self::at(Pose { position: self.point(at), angle: self.pose.angle.turned_by(angle) })
    }
}

/// Converts to a matrix of homogeneous coordinates, to multiply column vectors by.
#[cfg(feature = "mint")]
impl From<Pose> for mint::ColumnMatrix3<f64> {
    fn from(pose: Pose) -> Self {
        matrix(pose)
    }
}

/// Converts to a matrix of homogeneous coordinates, to multiply column vectors by.
#[cfg(feature = "mint")]
impl From<Pose<f32>> for mint::ColumnMatrix3<f32> {
    fn from(pose: Pose<f32>) -> Self {
        matrix(pose)
    }
}

#[cfg(feature = "mint")]
fn matrix<T: FloatAngle + core::ops::Neg<Output = T> + From<u8>>(pose: Pose<T>) -> mint::ColumnMatrix3<T> {
    let ((sin, cos), [x, y]) = (pose.angle.sine_cosine(), pose.position);
    let column = |x, y, z| mint::Vector3 { x, y, z };
    let (zero, one) = (T::from(0), T::from(1));
    mint::ColumnMatrix3 { x: column(cos, sin, zero), y: column(-sin, cos, zero), z: column(x, y, one) }
}

/// Position of the body.
#[cfg(feature = "mint")]
impl<T> From<Pose<T>> for mint::Point2<T> {
    fn from(pose: Pose<T>) -> Self {
        pose.position.into()
    }
}
