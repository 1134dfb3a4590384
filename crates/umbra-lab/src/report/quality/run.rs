//! Runs a scene and follows its bodies: their states, rest, overlaps and symmetry.

use umbra_physics::scalar::ToF64;
use umbra_physics::{Activity, BodyId, BodyKind, BodyRef, Error, World};

use super::scenes::{Mirror, Scene};

/// Below this speed all bodies rest, m/s.
const REST: f64 = 0.05;

/// A body at a tick: m, rad, m/s, rad/s.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct State {
    pub(super) at: [f64; 2],
    pub(super) angle: f64,
    pub(super) velocity: [f64; 2],
    pub(super) spin: f64,
}

impl State {
    fn of(body: &BodyRef<'_>) -> Self {
        let (at, velocity) = (body.position_exact(), body.velocity_exact());
        Self {
            at: [at.x.to_f64(), at.y.to_f64()],
            angle: body.angle().to_f64(),
            velocity: [velocity.x.to_f64(), velocity.y.to_f64()],
            spin: body.angular_velocity_exact().to_f64(),
        }
    }

    pub(super) fn speed(&self) -> f64 {
        length(self.velocity)
    }

    pub(super) fn distance(&self, rhs: &Self) -> f64 {
        length([self.at[0] - rhs.at[0], self.at[1] - rhs.at[1]])
    }
}

/// Length of a vector. Its bits are the same on all machines; those of `hypot` need not be.
fn length([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}

/// A body that can move.
struct Mover {
    id: BodyId,
    /// The distance of its farthest point from the centre of mass, m.
    radius: f64,
    /// The mover that is its mirror image, or itself.
    partner: usize,
}

pub(super) struct Run {
    pub(super) world: World,
    pub(super) mirror: Option<Mirror>,
    movers: Vec<Mover>,
    pub(super) start: Vec<State>,
    pub(super) now: Vec<State>,
    /// The path of the last body that moves, from before the first tick on.
    pub(super) path: Vec<State>,
    /// The first tick since when all bodies rest.
    pub(super) rest_after: Option<u64>,
    /// The deepest overlap at the start of a tick so far, m; `None` if it is not measured.
    pub(super) overlap: Option<f64>,
    /// The largest difference of a coordinate or an angle from the mirror image, m or rad: 0 if and only if all bits are equal;
    /// infinite if the scene itself is not its own mirror image.
    pub(super) asymmetry: f64,
}

impl Run {
    pub(super) fn new(scene: &Scene, substeps: u32) -> Result<Self, Error> {
        let world = scene.build(substeps)?;
        let mut movers = Vec::new();
        for body in world.bodies().filter(|body| body.kind() == BodyKind::Dynamic) {
            movers.push(Mover { id: body.id(), radius: radius(&body, &world)?, partner: 0 });
        }
        let images: Vec<_> = movers.iter().map(|mover| exact(&world, mover.id)).collect();
        for (i, mover) in movers.iter_mut().enumerate() {
            let Some(mirror) = scene.mirror else { continue };
            let image = mirrored(mirror, images[i]);
            mover.partner = images.iter().position(|candidate| *candidate == image).unwrap_or(usize::MAX);
        }
        let is_symmetric = movers.iter().all(|mover| mover.partner < images.len());
        let mut run = Self {
            world,
            mirror: scene.mirror.filter(|_| is_symmetric),
            movers,
            start: Vec::new(),
            now: Vec::new(),
            path: Vec::new(),
            rest_after: Some(0),
            overlap: None,
            asymmetry: if is_symmetric { 0.0 } else { f64::INFINITY },
        };
        run.now = run.states();
        run.start = run.now.clone();
        run.path.extend(run.now.last());
        Ok(run)
    }

    fn states(&self) -> Vec<State> {
        self.movers.iter().filter_map(|mover| self.world.body(mover.id).ok()).map(|body| State::of(&body)).collect()
    }

    pub(super) fn step(&mut self, ticks: u64) {
        for _ in 0..ticks {
            self.world.step();
            self.now = self.states();
            self.path.extend(self.now.last());
            if self.largest_speed() >= REST {
                self.rest_after = None;
            } else if self.rest_after.is_none() {
                self.rest_after = Some(self.world.tick());
            }
            if let Some(mirror) = self.mirror {
                self.asymmetry = self.asymmetry.max(self.distance_from_image(mirror));
            }
            self.overlap = self.overlap.map(|deepest| deepest.max(self.deepest()));
        }
    }

    /// The deepest overlap at the start of the last tick, m.
    pub(super) fn deepest(&self) -> f64 {
        let points = self.world.contacts().map(|contact| {
            let points = contact.points().iter();
            points.map(|point| -point.separation.to_f64()).fold(0.0, f64::max)
        });
        points.fold(0.0, f64::max)
    }

    /// The largest speed of a point of a body.
    pub(super) fn largest_speed(&self) -> f64 {
        let speeds = self.now.iter().zip(&self.movers);
        speeds.map(|(state, mover)| state.speed().max(state.spin.abs() * mover.radius)).fold(0.0, f64::max)
    }

    /// The number of bodies that the world quarantined.
    pub(super) fn quarantined(&self) -> usize {
        let bodies = self.movers.iter().filter_map(|mover| self.world.body(mover.id).ok());
        bodies.filter(|body| body.activity() == Activity::Quarantined).count()
    }

    /// The kinetic energy, J.
    pub(super) fn kinetic(&self) -> f64 {
        let bodies = self.movers.iter().filter_map(|mover| self.world.body(mover.id).ok());
        bodies.filter_map(|body| body.kinetic_energy().ok()).map(ToF64::to_f64).sum()
    }

    /// The largest of a measure over all bodies, of their states at two times.
    pub(super) fn most(&self, from: &[State], measure: impl Fn(&State, &State) -> f64) -> f64 {
        from.iter().zip(&self.now).map(|(from, to)| measure(from, to)).fold(0.0, f64::max)
    }

    fn distance_from_image(&self, mirror: Mirror) -> f64 {
        let all: Vec<[i128; 6]> = self.movers.iter().map(|mover| exact(&self.world, mover.id)).collect();
        let apart = |(mover, state): (&Mover, &[i128; 6])| {
            let image = mirrored(mirror, all[mover.partner]);
            // A turn of u64; all others are in units of 2^-96.
            let turn = (state[2] as u64).wrapping_sub(image[2] as u64) as i64;
            let angle = turn.unsigned_abs() as f64 * (core::f64::consts::TAU / 18_446_744_073_709_551_616.0);
            let lengths = [0, 1, 3, 4, 5].map(|i| state[i].abs_diff(image[i]) as f64 / UNITS);
            lengths.into_iter().fold(angle, f64::max)
        };
        self.movers.iter().zip(&all).map(apart).fold(0.0, f64::max)
    }
}

/// 2^96.
const UNITS: f64 = 79_228_162_514_264_337_593_543_950_336.0;

/// The state of a body to the bit: position, angle, velocity, spin.
fn exact(world: &World, id: BodyId) -> [i128; 6] {
    world.body(id).map_or([0; 6], |body| {
        let (at, velocity) = (body.position_exact(), body.velocity_exact());
        let (angle, spin) = (body.angle_exact(), body.angular_velocity_exact());
        [
            at.x.to_bits(),
            at.y.to_bits(),
            i128::from(angle.to_bits()),
            velocity.x.to_bits(),
            velocity.y.to_bits(),
            spin.to_bits(),
        ]
    })
}

fn mirrored(mirror: Mirror, [x, y, angle, vx, vy, spin]: [i128; 6]) -> [i128; 6] {
    let angle = i128::from((angle as u64).wrapping_neg());
    match mirror {
        Mirror::X => [-x, y, angle, -vx, vy, -spin],
        Mirror::Y => [x, -y, angle, vx, -vy, -spin],
    }
}

/// The distance of the farthest corner of a body from its centre of mass, m; of a disc its radius.
fn radius(body: &BodyRef<'_>, world: &World) -> Result<f64, Error> {
    let mut farthest = 0.0_f64;
    for id in world.colliders_of(body.id())? {
        for outline in world.collider(id)?.shape.outlines() {
            let corners = outline.corners().iter().map(|corner| length([corner.x.to_f64(), corner.y.to_f64()]));
            farthest = farthest.max(corners.fold(0.0, f64::max) + outline.radius().to_f64());
        }
    }
    Ok(farthest)
}
