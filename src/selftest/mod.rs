//! Built-in scenes that show that a machine computes the same bits as all others.
//!
//! Each scene runs some hundred ticks and returns a digest of the [state hash](crate::World::state_hash) of every tick; scenes of
//! the narrow phase and of the solver without a world, of the bits of bodies and impulses. Two builds agree if their digests do, and
//! [`golden`] has the digests that every build must return. A digest shows that a result changed, not that it was right. So each scene
//! also checks, in integers, that the event it is meant for happened (a body slept, left the allowed range, wrapped), and what the result
//! was: against a closed form, a conserved quantity, its mirror image, or the same motion computed in another way.
//!
//! ```
//! use umbra_physics::selftest;
//!
//! let scene = &selftest::scenes()[0];
//! let outcome = scene.run()?;
//! // Send it to the other players, or compare it with the outcome that this version must return:
//! assert_eq!(Some(outcome), scene.golden());
//! # Ok::<(), selftest::Failure>(())
//! ```

mod bodies;
mod changes;
mod collisions;
mod contact_bodies;
mod contacts;
mod crowds;
mod envelope;
mod failure;
mod fields;
mod files;
mod golden;
mod held;
mod joints;
mod motion;
mod springs;
mod trial;

pub use failure::{Failure, Problem};
pub use golden::{Golden, golden};

/// Scalars of tests, which round wrongly, have no contacts.
#[doc(hidden)]
use crate::codec::{self, Encoder as _, StateHasher, Write as _};
use crate::integrate::Integrator;
use trial::{Played, Trial};

/// A scene of the self-test.
#[derive(Clone, Copy, Debug)]
pub struct Scene {
    name: &'static str,
    about: &'static str,
    play: fn(&mut Trial) -> Played,
}

/// Outcome of a scene, or of all scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Outcome {
    /// The number of ticks whose states are in the digest.
    pub ticks: u64,
    /// XXH3, 64 bits, over the state of every tick; of all scenes, over their names and outcomes in order.
    pub digest: u64,
}

impl Scene {
    /// Name of the scene: lower case, one word.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// Purpose of the scene in one line.
    #[must_use]
    pub const fn about(&self) -> &'static str {
        self.about
    }

    /// Runs the scene.
    ///
    /// # Errors
    /// [`Failure`] if a call was refused, if the event the scene is meant for did not happen, or if the result is wrong.
    pub fn run(&self) -> Result<Outcome, Failure> {
        let mut trial = Trial::new();
        let played = (self.play)(&mut trial);
        let outcome = trial.outcome();
        match played {
            Ok(()) => Ok(outcome),
            Err(problem) => Err(Failure { scene: self.name, tick: outcome.ticks, problem }),
        }
    }

    /// Expected outcome; `None` if the list has no such scene.
    #[must_use]
    pub fn golden(&self) -> Option<Outcome> {
        golden().scene(self.name)
    }
}

/// Runs all scenes, in order.
///
/// # Errors
/// [`Failure`] of the first scene that fails.
pub fn run() -> Result<Outcome, Failure> {
    scenes()
        .iter()
        .map(|scene| Ok((scene.name, scene.run()?)))
        .collect::<Result<Total, _>>()
        .map(|total| total.outcome())
}

/// The combined outcome of scenes in order, as [`run`] returns it for all scenes.
///
/// ```
/// use umbra_physics::selftest::{Outcome, Total, scenes};
/// let outcome: Outcome = scenes()[0].run()?;
/// let total: Total = [(scenes()[0].name(), outcome)].into_iter().collect();
/// assert_eq!(total.outcome().ticks, outcome.ticks);
/// # Ok::<(), umbra_physics::selftest::Failure>(())
/// ```
pub struct Total {
    ticks: u64,
    digest: StateHasher,
}

impl Total {
    /// The combined outcome.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        Outcome { ticks: self.ticks, digest: self.digest.finish() }
    }
}

impl FromIterator<(&'static str, Outcome)> for Total {
    fn from_iter<I: IntoIterator<Item = (&'static str, Outcome)>>(outcomes: I) -> Self {
        let mut total = Self { ticks: 0, digest: StateHasher::new() };
        for (name, outcome) in outcomes {
            codec::count(&mut total.digest, name.len());
            total.digest.bytes(name.as_bytes());
            outcome.ticks.write(&mut total.digest);
            outcome.digest.write(&mut total.digest);
            total.ticks += outcome.ticks;
        }
        total
    }
}

/// All scenes of the self-test.
#[must_use]
pub const fn scenes() -> &'static [Scene] {
    SCENES
}

/// The scenes as a table: name, function, purpose.
macro_rules! scenes {
    ($($name:ident: $play:expr, $about:literal;)*) => {
        const SCENES: &[Scene] = &[$(Scene { name: stringify!($name), about: $about, play: $play }),*];
    };
}

scenes! {
    free_fall: motion::free_fall, "every mass from 2^-16 to 2^24 kg falls ½·g·t² in the same bits";
    time_steps: motion::time_steps, "1/60, 1001/60000 and 1/100 s by turns: time and fall stay exact";
    integrators_in_turn: motion::integrators_in_turn, "all five on one flight: each its own sum of a constant force";
    damping: motion::damping, "of the world and of bodies: what is left after each second is a power of it";
    strong_damping: motion::strong_damping, "of the world and of bodies, by rates to 600/s: what is left is e^-c·t";
    gravity_scales: motion::gravity_scales, "from −16 to 16, gravity and scale changed on the way, exact to the ulp";
    many_turns: motion::many_turns, "angles that wrap millions of times, either way, end where ω·t does";
    orbit_explicit_euler: |t| motion::orbit(t, Integrator::ExplicitEuler), "Kepler, of order 1, gains energy";
    orbit_symplectic_euler: |t| motion::orbit(t, Integrator::SymplecticEuler), "Kepler, of order 1, keeps r × v";
    orbit_velocity_verlet: |t| motion::orbit(t, Integrator::VelocityVerlet), "Kepler, of order 2, keeps r × v";
    orbit_published_verlet: |t| motion::orbit(t, Integrator::PublishedVerlet), "Kepler, of order 1, velocity lags";
    orbit_yoshida4: |t| motion::orbit(t, Integrator::Yoshida4), "Kepler, of order 4, keeps r × v";
    attractor_pair: fields::attractor_pair, "two carry softened attractors: each the exact point image of the other";
    three_bodies: fields::three_bodies, "chaos of three unlike masses: momentum stays";
    drag_linear: fields::drag_linear, "drag against wind: e^-αt of the velocity through the air is left";
    drag_quadratic: fields::drag_quadratic, "1/(1 + β·u·t) of it is left, tick by tick";
    drag_stiff: fields::drag_stiff, "too stiff for Yoshida's step back: acts around the whole step, and is as exact";
    thruster: fields::thruster, "a thrust off centre that turns with its body: ω = α·t";
    zones: fields::zones, "a disc and a box, their edges, and the way out";
    magnet: fields::magnet, "a custom force of velocity: a circle at constant speed";
    custom_force_error: fields::custom_force_error, "a custom force that gives up: quarantined at that very tick";
    groups: fields::groups, "fields act on their groups alone, and on who joins them on the way";
    spring_to_anchor: springs::to_anchor, "ω·dt = 1: a period of six steps, exactly";
    spring_pair: springs::pair, "between points of two bodies, with a damper: momentum stays, energy goes";
    spring_net: springs::net, "a net let go: its halves are mirror images to the bit";
    shapes: bodies::shapes, "every shape turns as its moment of inertia says";
    kinds: bodies::kinds, "static, kinematic, dynamic, and from one to the other";
    pushes: bodies::pushes, "forces, torques, impulses at points in both frames do the same";
    locks: held::locks, "each combination of axes: still to the bit, the others as if nothing was locked";
    caps: held::caps, "speeds after a step at most the cap, in their direction";
    disabled: held::disabled, "out as it is, what is attached inert; and back";
    goals: held::goals, "moved over a step to a place and an angle, to the bit, by every integrator and rate";
    sleep: bodies::sleep, "sleepers, alone and in an island, woken in every way: no bit of motion differs";
    quarantine: bodies::quarantine, "out of the envelope by velocity, place, spin, field; put back, released";
    recycling: changes::recycling, "slots taken again and again: old handles stay dead, bystanders change no bit";
    setters: changes::setters, "every command there is; then as a world that was made so from the start";
    going_back: changes::going_back, "rollback to a copy, in its own memory and another's";
    looking_ahead: changes::looking_ahead, "one body and what it depends on, alone, goes where the world goes";
    recording: files::recording, "two players' inputs, dice and a blob, recorded: the file's bytes, and its run once more";
    snapshots: files::snapshots, "as bytes and back, with the dump of a tick: the same bytes, the same future";
    there_and_back: files::there_and_back, "springs and forces at points: a hundred steps undone, hash by hash";
    extreme_masses: envelope::extreme_masses, "15 mg and 16,777 t pushed, struck and joined";
    edge_of_the_envelope: envelope::edge, "places and speeds at the last ulp inside, and the first outside";
    largest_numbers: envelope::largest_numbers, "the strongest gravity, forces and attractors that are admitted";
    wide_blocks: crowds::wide_blocks, "300 bodies alike, by every integrator: each as if it were alone";
    mixed_blocks: crowds::mixed_blocks, "400 of all kinds, some in fields: each as if its neighbours were not there";
    nine_thousand: crowds::nine_thousand, "enough for all cores; some leave, some sleep, none disturbs another";
    loads: collisions::loads, "towers of light boxes under heavy ones, in finer sub-steps, beside their mirror image";
    piles: collisions::piles, "bodies of all shapes and materials in a pile, beside its mirror image";
    impacts: collisions::impacts, "bounces and impacts as their closed forms say, by every integrator; misses change no bit";
    cloud: collisions::cloud, "bodies of all shapes fall together in free flight: momentum stays";
    changing_colliders: collisions::changing_colliders, "colliders, filters, kinds and settings change in a pile, restored from bytes";
    touched: collisions::touched, "sleepers are woken by touch, crowds are quarantined: no bit depends on who slept";
    belts: collisions::belts, "boxes on moving surfaces, with friction by every rule: the closed form, and a mirror image";
    compounds: collisions::compounds, "compounds in a pile: as bodies with a collider for each part, and a mirror image";
    chains: collisions::chains, "a ball over seams as over one segment; a crowd on hills of 400 segments, its mirror image, and a cave";
    joined_chains: joints::chains, "a chain, a bridge with motors against limits, a beam of welds, a net of rods: a mirror image";
    joined_ragdolls: joints::ragdolls, "ragdolls land on crates: all limbs take part in impacts, as their mirror images do";
    joined_machines: joints::machines, "a car on springs drives over crates, a lift reaches its end: a mirror image";
    contacts_pile: contacts::pile, "boxes, discs and a wedge come to rest between walls: a mirror image of itself";
    contacts_cluster: contacts::cluster, "bodies meet in free flight: impulses are equal and opposite";
    contacts_extremes: contacts::extremes, "1 kg and 2^24, shots, needles, what turns and rises: mirror image, and in any order";
}

impl<S: crate::scalar::Scalar> crate::world::World<S> {
    /// Does without continuous collision in this copy of the world, for the twins of tests: without the ends of the paths of fast bodies,
    /// and without contacts that are found ahead of time.
    #[doc(hidden)]
    pub fn do_without_continuous_collision(&mut self, ends: bool, speculation: bool) {
        self.workspace.do_without(ends, speculation);
    }

    /// Gives each thread at least so many free bodies of this copy of the world in a step, but a block, and islands with so many contacts, where a
    /// joint counts as 16: tests share out small worlds.
    #[cfg(feature = "parallel")]
    #[doc(hidden)]
    pub fn share_work(&mut self, least: usize) {
        self.workspace.share(least);
    }
}

#[cfg(test)]
mod tests {
    use alloc::string::ToString as _;

    use super::trial::{happened, near, refused, same, there};
    use super::*;
    use crate::error::{Error, Quantity};
    use crate::fx::Fx;

    fn failing(play: fn(&mut Trial) -> Played) -> Problem {
        let scene = Scene { name: "none", about: "", play };
        assert_eq!(scene.golden(), None);
        let failure = scene.run().expect_err("it fails");
        assert!(failure.to_string().starts_with("none after 0 ticks: "), "{failure}");
        failure.problem
    }

    #[test]
    fn each_check_can_fail() {
        assert_eq!(failing(|_| happened("rain", false)), Problem::DidNotHappen { what: "rain" });
        assert_eq!(failing(|_| there::<()>("rain", None)), Problem::DidNotHappen { what: "rain" });
        assert_eq!(failing(|_| same("twins", &1, &2)), Problem::Differs { what: "twins" });
        assert_eq!(failing(|_| Ok(Err(Error::Full)?)), Problem::Refused(Error::Full));
        let wrong = Problem::Wrong { what: "way", found: -3, expected: 1, bound: 3 };
        assert_eq!(failing(|_| near("way", -3, 1, 3)), wrong);
        assert_eq!(near("way", -3, 1, 4), Ok(()));
        // Another reason is not the reason; neither is none.
        let refusal = || Err::<(), _>(Error::OutOfRange { quantity: Quantity::Mass { value: Fx::ZERO } });
        assert_eq!(failing(|_| refused("a call", Ok(()), Error::Full)), Problem::DidNotHappen { what: "a call" });
        assert!(
            refused("a call", refusal(), Error::Full).is_err()
                && refused("a call", Err::<(), _>(Error::Full), Error::Full).is_ok()
        );
    }

    #[test]
    fn the_total_depends_on_names_order_and_outcomes() {
        let total = |outcomes: [(&'static str, u64, u64); 2]| {
            let outcomes = outcomes.map(|(name, ticks, digest)| (name, Outcome { ticks, digest }));
            outcomes.into_iter().collect::<Total>().outcome().digest
        };
        let expected = total([("a", 1, 2), ("b", 3, 4)]);
        for changed in [
            [("b", 3, 4), ("a", 1, 2)],
            [("a", 1, 2), ("c", 3, 4)],
            [("a", 1, 2), ("b", 3, 5)],
            [("a", 2, 2), ("b", 3, 4)],
        ] {
            assert_ne!(total(changed), expected, "{changed:?}");
        }
    }
}
