//! The outcomes that every build is to have.

use core::fmt;

use super::Outcome;

/// The outcomes of all scenes under a physics version, as text: a line a scene, so that what changed shows in a diff.
///
/// [`Golden::write`] writes what [`Golden::parse`] reads.
///
/// ```
/// use umbra_physics::PHYSICS_VERSION;
/// use umbra_physics::selftest::{Golden, golden, scenes};
///
/// let ours: Golden = golden();
/// assert_eq!((ours.physics_version(), ours.scenes().count()), (Some(PHYSICS_VERSION), scenes().len()));
/// assert!(scenes().iter().all(|scene| ours.scene(scene.name()).is_some()));
///
/// // What another machine found, as text, and here again.
/// let mut sent = String::new();
/// Golden::write(&mut sent, PHYSICS_VERSION, ours.scenes(), ours.all().unwrap())?;
/// let theirs = Golden::parse(&sent);
/// assert_eq!(theirs.all(), ours.all());
/// # Ok::<(), std::fmt::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Golden<'t> {
    text: &'t str,
}

/// The list of this physics version, made together with it.
#[must_use]
pub const fn golden() -> Golden<'static> {
    Golden { text: include_str!("golden.txt") }
}

/// The name under which the list has the outcome of all scenes together.
const ALL: &str = "all";

impl<'t> Golden<'t> {
    /// A list from its text, such as another machine sent. Other lines are skipped.
    #[must_use]
    pub const fn parse(text: &'t str) -> Self {
        Self { text }
    }

    /// The [physics version](crate::PHYSICS_VERSION) it was made under.
    #[must_use]
    pub fn physics_version(&self) -> Option<u32> {
        self.lines().find_map(|mut words| (words.next()? == "physics_version").then(|| words.next()?.parse().ok())?)
    }

    /// Expected outcome of a scene.
    #[must_use]
    pub fn scene(&self, name: &str) -> Option<Outcome> {
        self.scenes().find(|(scene, _)| *scene == name).map(|(_, outcome)| outcome)
    }

    /// Expected outcome of all scenes together, as returned by [`run`](super::run).
    #[must_use]
    pub fn all(&self) -> Option<Outcome> {
        self.outcomes().find(|(name, _)| *name == ALL).map(|(_, outcome)| outcome)
    }

    /// The scenes, in the order of the list.
    pub fn scenes(&self) -> impl Iterator<Item = (&'t str, Outcome)> {
        self.outcomes().filter(|(name, _)| *name != ALL)
    }

    fn outcomes(&self) -> impl Iterator<Item = (&'t str, Outcome)> {
        self.lines().filter_map(|mut words| {
            let (name, ticks, digest) = (words.next()?, words.next()?, words.next()?);
            Some((name, Outcome { ticks: ticks.parse().ok()?, digest: u64::from_str_radix(digest, 16).ok()? }))
        })
    }

    fn lines(&self) -> impl Iterator<Item = impl Iterator<Item = &'t str>> {
        self.text.lines().filter(|line| !line.starts_with('#')).map(str::split_whitespace)
    }

    /// Writes the text of a list: what a bless writes into the sources.
    ///
    /// # Errors
    /// An error of the writer.
    pub fn write<'a>(
        to: &mut impl fmt::Write,
        physics_version: u32,
        scenes: impl IntoIterator<Item = (&'a str, Outcome)>,
        all: Outcome,
    ) -> fmt::Result {
        writeln!(
            to,
            "# Scene, ticks, digest: src/selftest/mod.rs says what each is. They change with the physics version alone."
        )?;
        writeln!(to, "# Written by: UMBRA_BLESS=1 cargo test --release --all-features --test engine golden")?;
        writeln!(to, "physics_version {physics_version}")?;
        for (name, Outcome { ticks, digest }) in scenes.into_iter().chain([(ALL, all)]) {
            writeln!(to, "{name:<24} {ticks:>6} {digest:016x}")?;
        }
        Ok(())
    }
}
