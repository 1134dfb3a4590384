//! The integrators: which stages a step has, in which order, and over which part of the time step.
//!
//! | integrator | stages of the free flight | order |
//! |---|---|---|
//! | `ExplicitEuler` | fields, drift, kick, damp | 1, gains energy |
//! | `SymplecticEuler` | fields, kick, drift, damp | 1 |
//! | `VelocityVerlet` | damp ½, kick ½, drift, fields, kick ½, damp ½ | 2 |
//! | `PublishedVerlet` | fields, kick with the mean of the last and this acceleration, drift with v·dt + ½a·dt², damp | 1 |
//! | `Yoshida4` | the stages of Verlet over w₁·dt, w₀·dt, w₁·dt | 4 |
//!
//! Detect, solve, push and clear follow with every integrator. Traces, documentation and timers walk the same lists as the step.
//!
//! - Damping and drag are solved exactly, in the order of the fields. The closing stage of a step runs them in reverse order.
//! - Friction with a ground that is seen from above follows each kick, so that a body at rest that is pushed by less does not drift; that of a
//!   Yoshida4 step, whose middle goes backwards, follows the step.
//! - Forces that depend on position are evaluated once in a Verlet step: the accelerations after the drift serve the opening kick of the
//!   next step too. They are a cache of a function of the state, and no state.
//! - Forces that depend on velocity (spring dampers, custom forces that say so) are evaluated in each kick, and a second time in a closing
//!   kick: the first half is explicit, the second one implicit, together they are the trapezoidal rule.
//! - Forces that the caller applies are constant over their step. They are summed in 192 bits, so that the order of calls does not matter.

mod rules;
mod schedule;

pub(crate) use rules::{
    BlockFactors, cap, damp, drift, fused_kick_drift_kick, fused_kick_drift_kick_each, gravity_delta_v, kick_by, sum,
};
pub(crate) use schedule::{FreeStage, Schedule, split_fused};

use core::fmt;

use crate::body::SPANS;
use crate::codec::codec_enum;
use crate::math::TimeStep;
use crate::scalar::{Angle, Factor, Scalar, Span, Weight};

/// How a world moves from tick to tick.
///
/// ```
/// use umbra_physics::{Integrator, Stage, StageKind};
///
/// let names: Vec<_> = Integrator::ALL.iter().map(|integrator| (integrator.name(), integrator.order())).collect();
/// assert_eq!(names[2], ("velocity_verlet", 2));
/// assert_eq!(Integrator::from_name("yoshida4"), Some(Integrator::Yoshida4));
///
/// // What executes a step walks this list, and so can a program that shows it.
/// let verlet = Integrator::VelocityVerlet;
/// let kinds: Vec<_> = verlet.stages().iter().map(|stage: &Stage| stage.kind.name()).collect();
/// assert_eq!(kinds, ["damp", "kick", "drift", "fields", "kick", "damp", "detect", "solve", "push", "clear"]);
/// assert!(verlet.stages().iter().any(|stage| stage.kind == StageKind::Drift && !stage.mirrored));
/// assert!(verlet.inverse().is_some() && Integrator::ExplicitEuler.inverse().is_none());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Integrator {
    /// The position with the old velocity. Order 1; gains energy. For comparison.
    ExplicitEuler,
    /// The velocity first, then the position with the new one. Order 1, symplectic.
    SymplecticEuler,
    /// Kick, drift, kick. Order 2, symplectic, reversible.
    ///
    /// *Source* Swope, Andersen, Berens, Wilson, J. Chem. Phys. 76, 637 (1982).
    #[default]
    VelocityVerlet,
    /// UMBRA's four stages as its devlog prints them. Its positions are those of `SymplecticEuler` for forces of position,
    /// its velocity lags a step behind. Order 1.
    PublishedVerlet,
    /// Three Verlet steps, the middle one backwards. Order 4, symplectic, reversible.
    ///
    /// *Source* Yoshida, Phys. Lett. A 150, 262 (1990).
    Yoshida4,
}

codec_enum!(Integrator, "the number of an integrator", {
    0 => ExplicitEuler,
    1 => SymplecticEuler,
    2 => VelocityVerlet,
    3 => PublishedVerlet,
    4 => Yoshida4,
});

/// The kind of a stage: the work that it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum StageKind {
    /// Evaluates the force fields at the positions now. Reads positions and angles; writes accelerations.
    Fields,
    /// Lets damping and drag act. Reads and writes velocities.
    Damp,
    /// Accelerations to velocities. Reads forces, accelerations, masses; writes velocities.
    Kick,
    /// Velocities to positions. Reads velocities; writes positions and angles.
    Drift,
    /// Forgets the forces applied over the tick.
    Clear,
    /// Finds the contacts at the start of the step, which the stages before have flown over. Reads colliders, poses, velocities, and the
    /// impulses of the step before; writes the impulses that contacts start from, and wakes sleeping bodies that are touched.
    Detect,
    /// Solves impacts and contacts in sub-steps. Reads contacts, masses and velocities; writes impulses.
    Solve,
    /// Adds to positions, angles and velocities what the impulses change. Caps speeds of bodies that were pushed.
    Push,
}

codec_enum!(StageKind, "the number of a stage kind", { 0 => Fields, 1 => Damp, 2 => Kick, 3 => Drift, 4 => Clear, 5 => Detect, 6 => Solve, 7 => Push });

impl StageKind {
    /// Name in traces, hashes and benches.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fields => "fields",
            Self::Damp => "damp",
            Self::Kick => "kick",
            Self::Drift => "drift",
            Self::Clear => "clear",
            Self::Detect => "detect",
            Self::Solve => "solve",
            Self::Push => "push",
        }
    }
}

/// A stage of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Stage {
    /// The work that it does.
    pub kind: StageKind,
    /// The number of the span of time that it acts over, among those of its integrator: the whole step, its half, or a part of it.
    pub span: usize,
    /// True if the stage mirrors an earlier one: it then runs in reverse order, and forces of velocity are
    /// evaluated a second time.
    pub mirrored: bool,
}

const fn stage(kind: StageKind, span: usize) -> Stage {
    Stage { kind, span, mirrored: false }
}

const fn mirrored(kind: StageKind, span: usize) -> Stage {
    Stage { kind, span, mirrored: true }
}

/// The stages after the free flight, in the list of each integrator.
pub(crate) const AFTER_FLIGHT: [Stage; 4] =
    [stage(StageKind::Detect, 0), stage(StageKind::Solve, 0), stage(StageKind::Push, 0), stage(StageKind::Clear, 0)];

impl fmt::Display for Integrator {
    /// Writes the [name](Self::name).
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl Integrator {
    /// All integrators.
    pub const ALL: [Self; 5] =
        [Self::ExplicitEuler, Self::SymplecticEuler, Self::VelocityVerlet, Self::PublishedVerlet, Self::Yoshida4];

    /// Name in scenes and on the command line; `Display` writes it too.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::ExplicitEuler => "explicit_euler",
            Self::SymplecticEuler => "symplectic_euler",
            Self::VelocityVerlet => "velocity_verlet",
            Self::PublishedVerlet => "published_verlet",
            Self::Yoshida4 => "yoshida4",
        }
    }

    /// The integrator of this name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|integrator| integrator.name() == name)
    }

    /// Order of convergence for forces of position.
    #[must_use]
    pub const fn order(self) -> u32 {
        match self {
            Self::ExplicitEuler | Self::SymplecticEuler | Self::PublishedVerlet => 1,
            Self::VelocityVerlet => 2,
            Self::Yoshida4 => 4,
        }
    }

    /// Returns true if a step begins with evaluating the fields, and all its kicks use the result; otherwise kicks at its
    /// start go with the fields as they were at the end of the step before.
    pub(crate) fn opens_with_fields(self) -> bool {
        self.stages()[0].kind == StageKind::Fields
    }

    /// The spans its stages name: weights of the time step, and whether they are halved.
    #[must_use]
    pub(crate) const fn spans(self) -> &'static [(Weight, bool)] {
        match self {
            Self::Yoshida4 => {
                use Weight::{YoshidaInner, YoshidaOuter};
                &[(YoshidaOuter, false), (YoshidaOuter, true), (YoshidaInner, false), (YoshidaInner, true)]
            }
            _ => &[(Weight::Whole, false), (Weight::Whole, true)],
        }
    }

    /// For each span, true if bodies are damped over it.
    pub(crate) fn damps(self) -> [bool; SPANS] {
        let damps = self.stages().iter().filter(|stage| stage.kind == StageKind::Damp);
        damps.fold([false; SPANS], |mut damps, stage| {
            damps[stage.span] = true;
            damps
        })
    }

    /// The step, in order. Changing a list changes results: see CHANGELOG, "Results changed".
    ///
    /// Of UMBRA's eleven stages, damp to damp are the first four, the free flight; collision and solving, 5 to 10, are detect, solve and
    /// push.
    #[must_use]
    pub const fn stages(self) -> &'static [Stage] {
        use StageKind::{Damp, Drift, Fields, Kick};
        const WHOLE: usize = 0;
        const HALF: usize = 1;
        const INNER: usize = 2;
        const INNER_HALF: usize = 3;
        const fn verlet<const WHOLE: usize, const HALF: usize>() -> [Stage; 6] {
            [
                stage(Damp, HALF),
                stage(Kick, HALF),
                stage(Drift, WHOLE),
                stage(Fields, WHOLE),
                mirrored(Kick, HALF),
                mirrored(Damp, HALF),
            ]
        }
        const OUTER_STEP: [Stage; 6] = verlet::<WHOLE, HALF>();
        const INNER_STEP: [Stage; 6] = verlet::<INNER, INNER_HALF>();
        const fn whole<const N: usize, const M: usize>(flight: [Stage; N]) -> [Stage; M] {
            let mut all = [stage(Damp, WHOLE); M];
            let mut i = 0;
            while i < M {
                all[i] = if i < N { flight[i] } else { AFTER_FLIGHT[i - N] };
                i += 1;
            }
            all
        }
        const VERLET: [Stage; 10] = whole(OUTER_STEP);
        const YOSHIDA: [Stage; 22] = {
            let [a, b, c, d, e, f] = OUTER_STEP;
            let [g, h, i, j, k, l] = INNER_STEP;
            whole([a, b, c, d, e, f, g, h, i, j, k, l, a, b, c, d, e, f])
        };
        const EXPLICIT: [Stage; 8] =
            whole([stage(Fields, WHOLE), stage(Drift, WHOLE), stage(Kick, WHOLE), stage(Damp, WHOLE)]);
        const IN_TURN: [Stage; 8] =
            whole([stage(Fields, WHOLE), stage(Kick, WHOLE), stage(Drift, WHOLE), stage(Damp, WHOLE)]);
        match self {
            Self::ExplicitEuler => &EXPLICIT,
            Self::SymplecticEuler | Self::PublishedVerlet => &IN_TURN,
            Self::VelocityVerlet => &VERLET,
            Self::Yoshida4 => &YOSHIDA,
        }
    }

    /// The stages of the free flight: those before contacts.
    pub(crate) const fn flight(self) -> &'static [Stage] {
        let stages = self.stages();
        stages.split_at(stages.len() - AFTER_FLIGHT.len()).0
    }

    /// The stages that undo a step, each over its span the other way in time; `None` for an integrator that has no inverse:
    /// `ExplicitEuler` drifts by a velocity that its kick has changed, `PublishedVerlet` has forgotten the last acceleration
    /// but one.
    ///
    /// Kicks and drifts are shears: by how much one changes a quantity depends on the other quantity alone, which it leaves
    /// as it is. So each is its own inverse with the opposite sign, if no force depends on a velocity and nothing is damped.
    #[must_use]
    pub const fn inverse(self) -> Option<&'static [Stage]> {
        use StageKind::{Drift, Fields, Kick};
        const IN_TURN: [Stage; 3] = [stage(Drift, 0), stage(Fields, 0), stage(Kick, 0)];
        match self {
            Self::ExplicitEuler | Self::PublishedVerlet => None,
            Self::SymplecticEuler => Some(&IN_TURN),
            // Read from the end the flight is the same. A step with contacts is not undone.
            Self::VelocityVerlet | Self::Yoshida4 => Some(self.flight()),
        }
    }
}

/// The factors of a span. All derived.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Timing<S: Scalar> {
    pub(crate) seconds: S::Factor,
    /// From an angular velocity to the part of a turn that is passed.
    pub(crate) turn: S::Factor,
    pub(crate) negative: bool,
}

/// The factors of an integrator at a time step. All derived.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plan<S: Scalar> {
    pub(crate) spans: [Span; SPANS],
    pub(crate) timing: [Timing<S>; SPANS],
    /// The whole step, halved or not.
    pub(crate) whole: S::Factor,
    pub(crate) half: S::Factor,
    /// Steps a second.
    pub(crate) rate: S::Factor,
    /// ½·dt².
    pub(crate) half_square: S::Factor,
    /// True if the plan undoes steps: time runs the other way in every span.
    pub(crate) backwards: bool,
    made_for: (Integrator, TimeStep),
}

/// Steps a second.
pub(crate) fn rate<S: Scalar>(time_step: TimeStep) -> S::Factor {
    let (num, den) = time_step.seconds();
    S::Factor::from_ratio(den.into(), num.into())
}

impl<S: Scalar> Plan<S> {
    pub(crate) fn new(integrator: Integrator, time_step: TimeStep) -> Self {
        let ratio = time_step.seconds();
        let span = |i: usize| {
            let spans = integrator.spans();
            let (weight, half) = spans[i % spans.len()];
            Span { ratio, weight, half }
        };
        let spans = [span(0), span(1), span(2), span(3)];
        let timing = spans.map(|span| Timing {
            seconds: S::seconds(span),
            turn: <S::Angle as Angle<S>>::drift_factor(span),
            negative: span.is_negative(),
        });
        let whole = |half| S::seconds(Span { ratio, weight: Weight::Whole, half });
        Self {
            spans,
            timing,
            whole: whole(false),
            half: whole(true),
            rate: rate::<S>(time_step),
            half_square: S::half_square_seconds(ratio.0, ratio.1),
            backwards: false,
            made_for: (integrator, time_step),
        }
    }

    /// Makes it anew if it was made for another integrator or time step.
    pub(crate) fn update(&mut self, integrator: Integrator, time_step: TimeStep) {
        if self.made_for != (integrator, time_step) {
            *self = Self::new(integrator, time_step);
        }
    }

    /// The plan of a step backwards in time.
    pub(crate) fn reversed(&self) -> Self {
        let timing = self.timing.map(|timing| Timing { negative: !timing.negative, ..timing });
        Self { timing, backwards: !self.backwards, ..*self }
    }
}
