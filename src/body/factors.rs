//! The factors of a step that bodies share: they follow from gravity scale, damping, speed caps, locks and the time step.

use super::Damping;
use super::rows::{Keyed, SharedRows, mix};
use crate::fx::Fx;
use crate::math::Vec2;
use crate::scalar::{Accumulator, Factor, Scalar, Span};

/// The largest number of spans in the stages of an integrator.
pub(crate) const SPANS: usize = 4;

/// The number of steps over which bounded factors change a speed by less than half the limit of speeds.
pub(crate) const BOUNDED_STEPS: u8 = 32;

/// The parameters of the world that the factors are made from.
pub(crate) struct WorldFactors<'a, S: Scalar> {
    gravity: Vec2<S>,
    /// The spans of the integrator's stages, how long each is in seconds, and whether bodies are damped over it.
    spans: &'a [Span],
    seconds: [S::Factor; SPANS],
    damps: [bool; SPANS],
    /// The factors of damping of a body without its own damping, by span.
    linear: [S::Factor; SPANS],
    angular: [S::Factor; SPANS],
}

impl<'a, S: Scalar> WorldFactors<'a, S> {
    pub(crate) fn new(gravity: Vec2<S>, damping: [Damping<S>; 2], spans: &'a [Span], damps: [bool; SPANS]) -> Self {
        let unit = [S::Factor::ONE; SPANS];
        let mut seconds = unit;
        spans.iter().zip(&mut seconds).for_each(|(&span, seconds)| *seconds = S::seconds(span));
        let world_factors = Self { gravity, spans, seconds, damps, linear: unit, angular: unit };
        let [linear, angular] = damping.map(|damping| world_factors.decays(S::decay_rate(damping.decay())));
        Self { linear, angular, ..world_factors }
    }

    /// The factors of a velocity that decays at a rate, by span.
    fn decays(&self, rate: S::DecayRate) -> [S::Factor; SPANS] {
        let mut decays = [S::Factor::ONE; SPANS];
        for (i, &span) in self.spans.iter().enumerate().filter(|(i, _)| self.damps[*i]) {
            decays[i] = S::decay_over(rate, span);
        }
        decays
    }
}

/// The factors of the bodies with the same gravity scale, damping, caps and locks of x and y. All of it is derived.
#[derive(Clone, Debug)]
pub(crate) struct StepFactors<S: Scalar> {
    pub(crate) key: Key<S>,
    /// The [`FactorTable::version`] the factors were made at. Before that they are neutral: nothing acts on the body.
    version: u64,
    /// The decay rates of the body's own dampings, once they have been made. They do not depend on the time step.
    rates: Option<[Option<S::DecayRate>; 2]>,
    /// The gravity that acts on the body, m/s²: zero along a locked axis.
    pub(crate) gravity: Vec2<S::Wide>,
    /// The change of velocity by gravity over a span, by span.
    pub(crate) gravity_delta_v: [Vec2<S::Accumulator>; SPANS],
    /// The fraction of the velocities that is left, by span.
    pub(crate) linear: [S::Factor; SPANS],
    pub(crate) angular: [S::Factor; SPANS],
    pub(crate) is_damped: bool,
    /// True if no factor is above 1; factors above 1 occur where damping runs backwards.
    pub(crate) decays: bool,
    /// True if moreover gravity changes a speed by less than half the limit of speeds in [`BOUNDED_STEPS`] steps.
    pub(crate) is_bounded: bool,
}

/// The properties of a body that its factors are made from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Key<S> {
    pub(crate) dynamic: bool,
    pub(crate) gravity_scale: S,
    pub(crate) linear: Option<Damping<S>>,
    pub(crate) angular: Option<Damping<S>>,
    /// The largest speed and angular speed after a step.
    pub(crate) most: [Option<S>; 2],
    /// Locks of the body along x, and along y.
    pub(crate) still: [bool; 2],
}

/// Keys are equal if their bits are: the sign of a zero is state in floats.
impl<S: Scalar> PartialEq for Key<S> {
    fn eq(&self, other: &Self) -> bool {
        self.bits() == other.bits()
    }
}

impl<S: Scalar> Key<S> {
    fn bits(&self) -> [u64; 6] {
        let [linear, angular] = [self.linear, self.angular].map(|damping| damping.map(Damping::number));
        let options = [linear, angular, self.most[0], self.most[1]];
        let flags =
            [self.dynamic, self.still[0], self.still[1]].into_iter().chain(options.map(|option| option.is_some()));
        let flags = flags.fold(0, |flags, flag| flags << 1 | u64::from(flag));
        let [linear, angular, speed, angular_speed] =
            options.map(|option| option.map_or(0, |option| option.to_bits() as u64));
        [flags, self.gravity_scale.to_bits() as u64, linear, angular, speed, angular_speed]
    }

    /// Returns true if a step may have to slow the body down to its speed limit.
    pub(crate) fn is_capped(&self) -> bool {
        self.dynamic && self.most != [None; 2]
    }

    /// Returns true if the velocities of the body decay in a world with this damping.
    pub(crate) fn is_damped(&self, linear: Damping<S>, angular: Damping<S>) -> bool {
        self.dynamic
            && (self.linear.unwrap_or(linear) != Damping::NONE || self.angular.unwrap_or(angular) != Damping::NONE)
    }

    /// Returns true if the body's own damping stops it at once.
    fn stops(&self) -> bool {
        [self.linear, self.angular].into_iter().flatten().any(Damping::stops)
    }
}

impl<S: Scalar> Keyed for StepFactors<S> {
    type Key = Key<S>;

    fn key(&self) -> Key<S> {
        self.key
    }

    fn hash(key: &Key<S>) -> u64 {
        key.bits().into_iter().fold(0, mix)
    }
}

impl<S: Scalar> StepFactors<S> {
    /// The factors of a body that nothing acts on.
    fn neutral(key: Key<S>) -> Self {
        let none = S::Accumulator::default();
        Self {
            key,
            version: 0,
            rates: None,
            gravity: Vec2::default(),
            gravity_delta_v: [Vec2::new(none, none); SPANS],
            linear: [S::Factor::ONE; SPANS],
            angular: [S::Factor::ONE; SPANS],
            is_damped: false,
            decays: true,
            is_bounded: true,
        }
    }

    /// Makes the factors anew.
    fn make(&mut self, world_factors: &WorldFactors<'_, S>) {
        let key = self.key;
        let rates = *self.rates.get_or_insert_with(|| {
            [key.linear, key.angular].map(|damping| damping.map(|damping| S::decay_rate(damping.decay())))
        });
        *self = Self { version: self.version, rates: self.rates, ..Self::neutral(key) };
        if !key.dynamic {
            return;
        }
        let felt = |g: S, still| if still { S::Wide::default() } else { g.product(key.gravity_scale) };
        self.gravity =
            Vec2::new(felt(world_factors.gravity.x, key.still[0]), felt(world_factors.gravity.y, key.still[1]));
        for (i, &span) in world_factors.spans.iter().enumerate() {
            // Gravity and its scale are limited so that no span's kick reaches the limit of kicks.
            let delta_v = self.gravity.map(|g| S::kick(g, world_factors.seconds[i]).unwrap_or_default());
            self.gravity_delta_v[i] = if span.is_negative() { delta_v.map(Accumulator::negated) } else { delta_v };
        }
        self.linear = rates[0].map_or(world_factors.linear, |rate| world_factors.decays(rate));
        self.angular = rates[1].map_or(world_factors.angular, |rate| world_factors.decays(rate));
        let mut factors = self.linear.iter().chain(&self.angular);
        self.is_damped = factors.clone().any(|f| *f != S::Factor::ONE);
        self.decays = factors.all(|f| *f <= S::Factor::ONE);
        // A step has at most six kicks: 32·6·2^11 is below 2^19, half of the limit.
        let small = S::from_fx(Fx::from_int(1 << 11));
        self.is_bounded =
            self.decays && self.gravity_delta_v.iter().all(|v| v.x.is_within(small) && v.y.is_within(small));
    }
}

/// The factors in use.
///
/// Factors take long to make, and one call may change the factors of all bodies. So calls only note the change, and the next
/// step makes the factors of the bodies that it moves, once.
#[derive(Debug)]
pub(crate) struct FactorTable<S: Scalar> {
    shared: SharedRows<StepFactors<S>>,
    /// Counts from 1 on how often the parameters of the world have changed.
    version: u64,
    /// True if a row may have to be made before the next step.
    is_stale: bool,
    /// The number of rows in use with a cap.
    capped: u32,
    /// The number of rows in use whose own damping stops the bodies at once.
    stopping: u32,
}

clone_by_field!(FactorTable { shared, version, is_stale, capped, stopping });

impl<S: Scalar> Default for FactorTable<S> {
    fn default() -> Self {
        Self { shared: SharedRows::default(), version: 1, is_stale: false, capped: 0, stopping: 0 }
    }
}

impl<S: Scalar> FactorTable<S> {
    /// The rows. Their keys are always up to date, the factors of moving bodies after [`update`](Self::update).
    pub(crate) fn rows(&self) -> &[StepFactors<S>] {
        self.shared.all()
    }

    /// The keys of the rows in use.
    pub(crate) fn used(&self) -> impl Iterator<Item = &Key<S>> {
        self.shared.used().map(|row| &row.key)
    }

    /// Returns true if a step may have to slow down a body.
    pub(crate) fn any_capped(&self) -> bool {
        self.capped > 0
    }

    /// Returns true if the own damping of a body stops it at once.
    pub(crate) fn any_stopping(&self) -> bool {
        self.stopping > 0
    }

    /// The index of the row of a key. [`release`](Self::release) gives it back.
    pub(crate) fn acquire(&mut self, key: Key<S>) -> u32 {
        let index = self.shared.acquire(key, |key| {
            self.capped += u32::from(key.is_capped());
            self.stopping += u32::from(key.stops());
            StepFactors::neutral(key)
        });
        // A row of bodies that do not move may not have been made since the parameters of the world changed.
        self.is_stale |= self.rows()[index as usize].version != self.version;
        index
    }

    pub(crate) fn release(&mut self, index: u32) {
        let key = self.rows()[index as usize].key;
        if self.shared.release(index) {
            self.capped -= u32::from(key.is_capped());
            self.stopping -= u32::from(key.stops());
        }
    }

    /// Notes that the parameters of the world have changed.
    pub(crate) fn change_all(&mut self) {
        self.version += 1;
        self.is_stale = true;
    }

    /// Returns true if factors of these rows may have to be made before the next step; `any_come` says whether there are others
    /// than before the last one.
    pub(crate) fn is_stale(&self, indices: &[u32], any_come: bool) -> bool {
        let is_old = |index: &u32| self.rows()[*index as usize].version != self.version;
        self.is_stale || (any_come && indices.iter().any(is_old))
    }

    /// Returns true if the factors of a row are up to date, or will be made before the next step.
    pub(crate) fn is_made(&self, index: u32) -> bool {
        self.is_stale || self.rows()[index as usize].version == self.version
    }

    /// Has the factors of all rows made before the next step that are not up to date.
    pub(crate) fn set_stale(&mut self) {
        self.is_stale = true;
    }

    /// Makes the factors of those of these rows that are not up to date.
    pub(crate) fn update(&mut self, world_factors: &WorldFactors<'_, S>, indices: &[u32]) {
        self.is_stale = false;
        for &index in indices {
            let row = self.shared.row_mut(index);
            if core::mem::replace(&mut row.version, self.version) != self.version {
                row.make(world_factors);
            }
        }
    }
}
