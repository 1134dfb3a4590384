//! Traits that a peer implements to be measured. A further engine is one file in
//! `engines/` that implements these two traits, plus one line in `engines/mod.rs`.

use crate::scene::{Ray, Scene};
use std::any::Any;

/// A static description, printed at the head of every run.
pub struct Info {
    pub version: String,
    pub number: &'static str,
    pub build: String,
    pub solver: String,
    /// Velocity left of v0 after `steps` steps of `dt` at damping `c` under the
    /// engine's documented law, evaluated in f64.
    pub damping_law: &'static str,
    pub damped: fn(v0: f64, c: f64, dt: f64, steps: u32, substeps: u32) -> f64,
    pub default_substeps: u32,
    /// size_of the engine's public body struct, if it has one.
    pub body_struct_bytes: Option<usize>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    pub x: f64,
    pub y: f64,
    pub angle: f64,
    pub vx: f64,
    pub vy: f64,
    pub w: f64,
}

pub struct Snapshot {
    /// Serialized size; `None` for an in-memory clone (the harness then measures
    /// the growth of the heap).
    pub bytes: Option<usize>,
    pub data: Box<dyn Any>,
}

/// Parts of a step that engines have in common; the README says which stages of each engine they hold.
pub const PARTS: [&str; 9] =
    ["pairs", "manifolds", "set-up", "passes", "impacts", "store", "continuous", "bodies", "events"];

pub trait Engine {
    fn id(&self) -> &'static str;
    fn info(&self) -> Info;
    /// A reason not to try this scene at all (for example an O(n^2) broad phase).
    fn refuse(&self, _scene: &Scene) -> Option<String> {
        None
    }
    /// Returns true if `build` makes a `scene.field` that is not pushed.
    fn has_fields(&self) -> bool {
        false
    }
    fn build(&self, scene: &Scene) -> Box<dyn World>;
}

pub trait World {
    /// One step of `scene.dt`.
    fn step(&mut self);
    /// All bodies, fixed ones too.
    fn body_count(&self) -> usize;
    /// State of body `i`, `i` being its index in `scene.bodies`.
    fn state(&self, i: usize) -> State;
    /// A hash of the exact bits of every pose and velocity.
    fn hash(&self) -> u64;
    /// Force at the centre of mass of body `i` for the next step only.
    fn push(&mut self, i: usize, fx: f64, fy: f64);
    /// Gives body `i` a velocity (x, y, angular), and wakes it.
    fn set_velocity(&mut self, _i: usize, _velocity: [f64; 3]) {
        unreachable!("the engine refuses scenes with kicks")
    }
    /// Number of dynamic bodies awake.
    fn awake(&self) -> Option<usize>;
    /// Number of contact points the solver works on.
    fn contact_points(&self) -> Option<usize>;
    /// The time that each stage of the solver's passes took in the last step, summed over the
    /// substeps, us: warm start, solve, relax, and the integration of velocities and
    /// positions. Empty if the engine does not measure them.
    fn pass_times(&self) -> Vec<(&'static str, f64)> {
        Vec::new()
    }
    /// The time that the last step took in each of the [`PARTS`] of a step, µs; `None` if the engine does not measure them all.
    fn part_times(&self) -> Option<[f64; PARTS.len()]> {
        None
    }
    /// Finds the first collider on each ray, and writes the fraction of the ray at which it is hit, 2 where nothing is. Returns false if
    /// the engine casts no rays.
    fn cast_rays(&mut self, _rays: &[Ray], _fractions: &mut [f64]) -> bool {
        false
    }
    /// Names of the ways this engine can be snapshotted.
    fn snapshot_kinds(&self) -> &'static [&'static str] {
        &[]
    }
    fn snapshot(&mut self, _kind: usize) -> Snapshot {
        unreachable!()
    }
    fn restore(&mut self, _kind: usize, _snap: &Snapshot) {
        unreachable!()
    }
}

/// Order-dependent 64-bit hash of exact bits.
pub struct Hash(u64);

impl Hash {
    pub fn new() -> Self {
        Hash(0xcbf2_9ce4_8422_2325)
    }
    pub fn word(&mut self, w: u64) {
        let x = (self.0 ^ w).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 = x ^ (x >> 29);
    }
    pub fn finish(self) -> u64 {
        self.0
    }
}

/// Version of a dependency as locked.
pub fn locked_version(name: &str) -> String {
    let lock = include_str!("../Cargo.lock");
    let key = format!("name = \"{name}\"\nversion = \"");
    match lock.find(&key) {
        Some(p) => lock[p + key.len()..].split('"').next().unwrap_or("?").to_string(),
        None => "?".to_string(),
    }
}
