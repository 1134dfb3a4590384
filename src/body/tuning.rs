//! What bodies share: gravity scale, damping, caps and locks, and the factors that follow from them and the time step.

use alloc::collections::BTreeMap;
use alloc::vec::Vec;

use super::columns::push;
use crate::math::Vec2;
use crate::scalar::{Accumulator, Factor, Scalar, Span, fx::Fx};

/// The most spans an integrator's stages name.
pub(crate) const SPANS: usize = 4;

/// Over so many steps the falls of a gentle tuning stay below half the limit of speeds.
pub(crate) const GENTLE_STEPS: u8 = 32;

/// What the factors are made from besides the body's own numbers.
#[derive(Clone, Copy)]
pub(crate) struct Climate<'a, S> {
    pub(crate) gravity: Vec2<S>,
    pub(crate) linear_damping: S,
    pub(crate) angular_damping: S,
    /// The spans of the integrator's stages.
    pub(crate) spans: &'a [Span],
}

/// The factors of the bodies that have the same gravity scale, damping, caps and locks. All of it is derived.
#[derive(Clone, Debug)]
pub(crate) struct Tuning<S: Scalar> {
    pub(crate) key: Key<S>,
    users: u32,
    /// Gravity as it feels it, m/s²: none along a locked axis.
    pub(crate) gravity: Vec2<S::Wide>,
    /// The velocity gained from it, by span.
    pub(crate) fall: [Vec2<S::Accumulator>; SPANS],
    /// What is left of the velocities, by span.
    pub(crate) linear: [S::Factor; SPANS],
    pub(crate) angular: [S::Factor; SPANS],
    pub(crate) is_damped: bool,
    /// Whether no factor is above 1: one is where damping runs backwards.
    pub(crate) decays: bool,
    /// Whether moreover the falls of [`GENTLE_STEPS`] steps are small beside the limit of speeds.
    pub(crate) is_gentle: bool,
}

/// What a body has of its own that its factors are made from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Key<S> {
    pub(crate) dynamic: bool,
    pub(crate) gravity_scale: S,
    pub(crate) linear: Option<S>,
    pub(crate) angular: Option<S>,
    /// The largest speed and angular speed after a step.
    pub(crate) most: [Option<S>; 2],
    /// Whether it is locked along x, and along y.
    pub(crate) still: [bool; 2],
}

type KeyBits = (bool, i64, [Option<i64>; 4], [bool; 2]);

impl<S: Scalar> Key<S> {
    fn bits(&self) -> KeyBits {
        let [speed, spin] = self.most;
        let own = [self.linear, self.angular, speed, spin].map(|own| own.map(S::to_bits));
        (self.dynamic, self.gravity_scale.to_bits(), own, self.still)
    }

    /// Whether a step may have to slow it down.
    pub(crate) fn is_capped(&self) -> bool {
        self.dynamic && self.most != [None; 2]
    }
}

impl<S: Scalar> Tuning<S> {
    fn new(key: Key<S>, climate: &Climate<'_, S>) -> Self {
        let none = S::Accumulator::default();
        let mut tuning = Self {
            key,
            users: 0,
            gravity: Vec2::default(),
            fall: [Vec2::new(none, none); SPANS],
            linear: [S::Factor::ONE; SPANS],
            angular: [S::Factor::ONE; SPANS],
            is_damped: false,
            decays: true,
            is_gentle: true,
        };
        if !key.dynamic {
            return tuning;
        }
        let felt = |g: S, still| if still { S::Wide::default() } else { g.product(key.gravity_scale) };
        tuning.gravity = Vec2::new(felt(climate.gravity.x, key.still[0]), felt(climate.gravity.y, key.still[1]));
        for (i, &span) in climate.spans.iter().enumerate() {
            let seconds = S::seconds(span);
            // Gravity and its scale are limited so that no span's kick reaches the limit of kicks.
            let fall = |g| S::kick(g, seconds).unwrap_or_default();
            let fall = tuning.gravity.map(fall);
            tuning.fall[i] = if span.is_negative() { fall.map(Accumulator::negated) } else { fall };
            tuning.linear[i] = S::decay(key.linear.unwrap_or(climate.linear_damping), span);
            tuning.angular[i] = S::decay(key.angular.unwrap_or(climate.angular_damping), span);
        }
        let mut factors = tuning.linear.iter().chain(&tuning.angular);
        tuning.is_damped = factors.clone().any(|f| *f != S::Factor::ONE);
        tuning.decays = factors.all(|f| *f <= S::Factor::ONE);
        // A step has at most six kicks: 32·6·2^11 is below 2^19, half of the limit.
        let small = S::from_fx(Fx::from_int(1 << 11));
        tuning.is_gentle =
            tuning.decays && tuning.fall.iter().all(|fall| [fall.x, fall.y].iter().all(|f| f.is_within(small)));
        tuning
    }
}

/// The tunings in use. Which index one has is no state: it changes no bit of what follows.
#[derive(Debug)]
pub(crate) struct Tunings<S: Scalar> {
    rows: Vec<Tuning<S>>,
    index: BTreeMap<KeyBits, u32>,
    free: Vec<u32>,
    /// How many of those in use are capped.
    capped: u32,
}

clone_by_field!(Tunings { rows, index, free, capped });

impl<S: Scalar> Default for Tunings<S> {
    fn default() -> Self {
        Self { rows: Vec::new(), index: BTreeMap::new(), free: Vec::new(), capped: 0 }
    }
}

impl<S: Scalar> Tunings<S> {
    pub(crate) fn rows(&self) -> &[Tuning<S>] {
        &self.rows
    }

    /// Those that a body has.
    pub(crate) fn used(&self) -> impl Iterator<Item = &Tuning<S>> {
        self.rows.iter().filter(|row| row.users > 0)
    }

    /// Whether a step may have to slow down a body.
    pub(crate) fn any_capped(&self) -> bool {
        self.capped > 0
    }

    /// The index for a body like this; it is given back by [`release`](Self::release).
    pub(crate) fn acquire(&mut self, key: Key<S>, climate: &Climate<'_, S>) -> u32 {
        let index = *self.index.entry(key.bits()).or_insert_with(|| {
            let row = Tuning::new(key, climate);
            self.capped += u32::from(key.is_capped());
            if let Some(free) = self.free.pop() {
                self.rows[free as usize] = row;
                free
            } else {
                push(&mut self.rows, row);
                (self.rows.len() - 1) as u32
            }
        });
        self.rows[index as usize].users += 1;
        index
    }

    pub(crate) fn release(&mut self, index: u32) {
        let row = &mut self.rows[index as usize];
        row.users -= 1;
        if row.users == 0 {
            self.capped -= u32::from(row.key.is_capped());
            self.index.remove(&row.key.bits());
            self.free.push(index);
        }
    }

    /// Makes all factors anew, but of rows nobody has: those may have a damping that the integrator refuses.
    pub(crate) fn refresh(&mut self, climate: &Climate<'_, S>) {
        for row in self.rows.iter_mut().filter(|row| row.users > 0) {
            let users = row.users;
            *row = Tuning::new(row.key, climate);
            row.users = users;
        }
    }
}
