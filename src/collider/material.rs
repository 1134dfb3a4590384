//! Surfaces, and how two of them that touch become one.

use crate::codec::{codec_enum, codec_struct};
use crate::error::{Error, Quantity};
use crate::fx::Fx;
use crate::limits;
use crate::scalar::Scalar;

/// The rule by which the coefficients of two surfaces that touch become one.
///
/// Where the two surfaces have different rules, the later one in the list of variants below counts: `Maximum` before all others.
///
/// ```
/// use umbra_physics::{Material, MixRule, fx};
///
/// // Ice is slippery whatever stands on it.
/// let ice: Material = Material { friction: fx!(0.02), friction_rule: MixRule::Minimum, ..Material::default() };
/// assert_eq!(ice.friction_rule.max(Material::<f64>::default().friction_rule), MixRule::Minimum);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum MixRule {
    /// The geometric mean for friction, the larger one for restitution.
    #[default]
    Standard,
    /// The geometric mean √(a·b), rounded to nearest.
    GeometricMean,
    /// The mean (a + b)/2, rounded to nearest, halves up.
    Mean,
    /// The smaller one.
    Minimum,
    /// The product a·b, rounded to nearest, halves up; of friction at most [`limits::FRICTION`].
    Product,
    /// The larger one.
    Maximum,
}

codec_enum!(MixRule, "the number of a mix rule", {
    0 => Standard,
    1 => GeometricMean,
    2 => Mean,
    3 => Minimum,
    4 => Product,
    5 => Maximum,
});

impl MixRule {
    /// All rules, in their order.
    pub const ALL: [Self; 6] =
        [Self::Standard, Self::GeometricMean, Self::Mean, Self::Minimum, Self::Product, Self::Maximum];

    /// Name in scenes.
    ///
    /// ```
    /// use umbra_physics::MixRule;
    ///
    /// let names = MixRule::ALL.map(MixRule::name);
    /// assert_eq!(names, ["standard", "geometric_mean", "mean", "minimum", "product", "maximum"]);
    /// ```
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Standard => "standard",
            Self::GeometricMean => "geometric_mean",
            Self::Mean => "mean",
            Self::Minimum => "minimum",
            Self::Product => "product",
            Self::Maximum => "maximum",
        }
    }
}

/// The surface of a collider.
///
/// ```
/// use umbra_physics::{Material, MixRule, fx};
///
/// let ice = Material { friction: fx!(0.02), ..Material::default() };
/// let rubber: Material = Material { friction: fx!(1), restitution: fx!(0.8), ..Material::default() };
/// assert!(ice.friction < Material::default().friction && rubber.restitution > fx!(0));
///
/// // A ball on grass loses two thirds of 0.05·g in each second.
/// let grass: Material = Material { rolling_resistance: fx!(0.05), ..Material::default() };
/// assert!(grass.rolling_resistance > ice.rolling_resistance);
///
/// // A conveyor belt: the top of the box moves to the right, its surface clockwise.
/// let belt = Material { surface_speed: fx!(-2), friction_rule: MixRule::Maximum, ..rubber };
/// assert_eq!(belt.friction, rubber.friction);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Material<S = Fx> {
    /// The coefficient of friction μ, 0 to [`limits::FRICTION`] = 32: a contact with the normal force F resists sliding with up to μ·F.
    pub friction: S,
    /// The coefficient of restitution, 0 to 1: bodies part after an impact at this share of their approach speed. 0 for no bounce. Slow
    /// impacts, below [`ContactSettings::restitution_speed`](crate::ContactSettings::restitution_speed), do not bounce.
    pub restitution: S,
    /// The coefficient of rolling resistance c, 0 to 1: a contact with one point and the normal force F resists rolling with a torque of up
    /// to c·R·F. R is the radius of the disc, of the end of the capsule or of the rounded corner that touches; where both surfaces are
    /// round, the smaller one. Of the coefficients of two surfaces the larger one counts. A contact with two points does not roll.
    pub rolling_resistance: S,
    /// The speed at which the surface moves around the shape, counter-clockwise, within ±2^10 m/s: a conveyor belt. It pulls by friction,
    /// and moves no body by itself. The top of a belt moves to the left if the speed is positive.
    pub surface_speed: S,
    /// The rule by which the friction of two surfaces is mixed.
    pub friction_rule: MixRule,
    /// The rule by which the restitution of two surfaces is mixed.
    pub restitution_rule: MixRule,
    /// The number of the material, by which [`World::set_material_pair`](crate::World::set_material_pair) gives coefficients to two
    /// materials together. 0 for a material without a number.
    pub id: u32,
}

codec_struct!(Material {
    friction,
    restitution,
    rolling_resistance,
    surface_speed,
    friction_rule,
    restitution_rule,
    id
});

/// The coefficients of contacts of two materials, which replace the ones mixed from both: see
/// [`World::set_material_pair`](crate::World::set_material_pair).
///
/// ```
/// use umbra_physics::{MaterialPair, fx};
///
/// // Skates on ice, whatever either of them is on other surfaces.
/// let skates_on_ice: MaterialPair = MaterialPair { friction: fx!(0.01), ..MaterialPair::default() };
/// assert_eq!(skates_on_ice.restitution, fx!(0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct MaterialPair<S = Fx> {
    /// The coefficient of friction, 0 to [`limits::FRICTION`].
    pub friction: S,
    /// The coefficient of restitution, 0 to 1.
    pub restitution: S,
    /// The coefficient of rolling resistance, 0 to 1.
    pub rolling_resistance: S,
}

codec_struct!(MaterialPair { friction, restitution, rolling_resistance });

impl<S: Scalar> Default for MaterialPair<S> {
    /// The coefficients of [`Material::default`].
    fn default() -> Self {
        let Material { friction, restitution, rolling_resistance, .. } = Material::default();
        Self { friction, restitution, rolling_resistance }
    }
}

impl<S: Scalar> MaterialPair<S> {
    /// Refuses a coefficient out of range.
    pub(crate) fn check(&self) -> Result<(), Error> {
        within(self.friction, [Fx::ZERO, limits::FRICTION], Quantity::Friction)?;
        within(self.restitution, [Fx::ZERO, Fx::ONE], Quantity::Restitution)?;
        within(self.rolling_resistance, [Fx::ZERO, Fx::ONE], Quantity::RollingResistance)
    }
}

fn within<S: Scalar>(value: S, [min, max]: [Fx; 2], quantity: Quantity) -> Result<(), Error> {
    let is_within = value >= S::from_fx(min) && value <= S::from_fx(max);
    if is_within { Ok(()) } else { Err(Error::OutOfRange { quantity }) }
}

impl<S: Scalar> Default for Material<S> {
    /// Friction 0.6, like wood on wood, no restitution, no rolling resistance, and a surface that stands still on its body.
    fn default() -> Self {
        Self {
            friction: S::from_fx(crate::fx!(0.6)),
            restitution: S::ZERO,
            rolling_resistance: S::ZERO,
            surface_speed: S::ZERO,
            friction_rule: MixRule::Standard,
            restitution_rule: MixRule::Standard,
            id: 0,
        }
    }
}

impl<S: Scalar> Material<S> {
    /// Refuses a coefficient or a speed out of range.
    pub(super) fn check(&self) -> Result<(), Error> {
        let Self { friction, restitution, rolling_resistance, .. } = *self;
        MaterialPair { friction, restitution, rolling_resistance }.check()?;
        within(self.surface_speed, [-limits::SURFACE_SPEED, limits::SURFACE_SPEED], Quantity::SurfaceSpeed)
    }
}

impl Material {
    /// The coefficients of the contact of two surfaces, by their rules.
    pub(crate) fn mixed(&self, rhs: &Self) -> MaterialPair {
        let [friction, restitution] = self.rules(rhs);
        MaterialPair {
            friction: mixed(friction, self.friction, rhs.friction),
            restitution: mixed(restitution, self.restitution, rhs.restitution),
            rolling_resistance: self.rolling_resistance.max(rhs.rolling_resistance),
        }
    }

    /// The velocity that a second body takes up against this one's along the tangent (n.y, −n.x) of a contact with the normal n from this
    /// surface to the other, m/s: within 2^11.
    pub(crate) fn surface_speed_against(&self, rhs: &Self) -> Fx {
        // Counter-clockwise is against the tangent on this surface, and along it on the other.
        -(self.surface_speed + rhs.surface_speed)
    }

    /// The rules for friction and restitution with another surface, which are not [`MixRule::Standard`].
    fn rules(&self, rhs: &Self) -> [MixRule; 2] {
        let [friction, restitution] =
            [self.friction_rule.max(rhs.friction_rule), self.restitution_rule.max(rhs.restitution_rule)];
        [
            friction.max(MixRule::GeometricMean),
            if restitution == MixRule::Standard { MixRule::Maximum } else { restitution },
        ]
    }
}

/// Two coefficients as one. *Domain* from 0 to 32.
fn mixed(rule: MixRule, a: Fx, b: Fx) -> Fx {
    let bits = [a, b].map(|coefficient| u128::from(coefficient.to_bits().unsigned_abs()));
    match rule {
        MixRule::Minimum => a.min(b),
        MixRule::Maximum => a.max(b),
        MixRule::Mean => Fx::from_bits(((bits[0] + bits[1] + 1) >> 1) as i64),
        // Below 2^74.
        MixRule::Product => Fx::from_bits(((bits[0] * bits[1] + (1 << 31)) >> 32) as i64).min(limits::FRICTION),
        MixRule::GeometricMean | MixRule::Standard => geometric_mean(a, b),
    }
}

/// The geometric mean of two coefficients, rounded to nearest.
fn geometric_mean(a: Fx, b: Fx) -> Fx {
    if a == b {
        return a;
    }
    let product = u128::from(a.to_bits().unsigned_abs()) * u128::from(b.to_bits().unsigned_abs());
    let root = product.isqrt();
    // The middle between root and root + 1 has the square root² + root + 1/4.
    Fx::from_bits((root + u128::from(product - root * root > root)) as i64)
}
