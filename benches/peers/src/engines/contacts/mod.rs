//! This engine's contacts before they are part of its world: free flight, narrow phase and solver joined by hand, in integers.

mod bodies;
mod joints;
mod pairs;

use crate::engine::{Engine, Hash, Info, State, World, locked_version};
use crate::scene::{Kind, Scene};
use bodies::{Body, Timing};
use joints::Joints;
use pairs::Pairs;
use std::time::Instant;
use umbra_physics::scalar::internals::VectorSet;
use umbra_physics::solve::{Correction, Flight, Solver, SolverOptions};
use umbra_physics::{Fx, TimeStep};

use super::umbra::{Number, time_step, vectors};

pub struct Contacts {
    id: &'static str,
    options: SolverOptions,
    /// The widest vector instructions that it may use.
    widest: VectorSet,
}

impl Contacts {
    const ID: &str = "umbra-contacts";

    /// With the solver's default options.
    pub fn new() -> Self {
        Self { id: Self::ID, options: SolverOptions::default(), widest: VectorSet::Avx512 }
    }

    /// The engine of an id like `umbra-contacts@substeps=6:frequency=0.125`; `None` for another engine or an unknown option.
    pub fn with_options(id: &str) -> Option<Self> {
        let list = id.strip_prefix(Self::ID)?.strip_prefix('@')?;
        let (mut options, mut widest) = (SolverOptions::default(), VectorSet::Avx512);
        for option in list.split(':') {
            let (name, value) = option.split_once('=')?;
            let number = || Fx::parse(value).ok();
            match name {
                "substeps" => options.substeps = value.parse().ok().filter(|n| (1..=16).contains(n))?,
                "frequency" => options.frequency = number()?,
                "damping" => options.damping_ratio = number()?,
                "joint_frequency" => options.joint_frequency = number()?,
                "joint_damping" => options.joint_damping_ratio = number()?,
                "push" => options.push_speed = number()?,
                "restitution" => options.restitution_speed = number()?,
                "vectors" => widest = vectors(value)?,
                _ => return None,
            }
        }
        // Ids live as long as the program, and there are few.
        Some(Self { id: String::from(id).leak(), options, widest })
    }
}

impl Engine for Contacts {
    fn id(&self) -> &'static str {
        self.id
    }
    fn info(&self) -> Info {
        Info {
            version: format!("umbra-physics {}", locked_version("umbra-physics")),
            number: "I32F32 fixed point, contacts in 32-bit integers",
            build: format!("feature float; vector instructions: {:?}", self.widest.min(VectorSet::used())),
            solver: "velocity Verlet, then soft contacts in parity order as a correction; options of the solver by \
                     umbra-contacts@substeps=N:vectors=SET:frequency=F:damping=D:joint_frequency=F:joint_damping=D:push=P:restitution=R"
                .into(),
            damping_law: "none",
            damped: |v0, _, _, _, _| v0,
            default_substeps: self.options.substeps,
            body_struct_bytes: None,
        }
    }
    fn refuse(&self, scene: &Scene) -> Option<String> {
        let lacks = if scene.sleep {
            "sleep"
        } else if !scene.kicks.is_empty() || scene.bodies.iter().any(|b| b.kind == Kind::Kinematic) {
            "kinematic bodies"
        } else if scene.field.is_some() || scene.pushed {
            "forces"
        } else if scene.bodies.iter().any(|b| b.lin_damp != 0.0 || b.ang_damp != 0.0) {
            "damping"
        } else {
            return None;
        };
        Some(format!("has no {lacks}"))
    }
    fn build(&self, scene: &Scene) -> Box<dyn World> {
        let time_step = time_step(scene.dt);
        let options = SolverOptions { substeps: scene.substeps.unwrap_or(self.options.substeps), ..self.options };
        let mut bodies: Vec<Body> = scene.bodies.iter().map(Body::new).collect();
        let joints = Joints::new(scene, &mut bodies);
        Box::new(Bed {
            timing: Timing::new(time_step, scene.gravity.map(Fx::number)),
            time_step,
            options,
            widest: self.widest,
            bodies,
            joints,
            pairs: Pairs::default(),
            solver: Solver::default(),
            flights: Vec::new(),
            corrections: Vec::new(),
            passes_us: 0.0,
        })
    }
}

struct Bed {
    timing: Timing,
    time_step: TimeStep,
    options: SolverOptions,
    widest: VectorSet,
    bodies: Vec<Body>,
    joints: Joints,
    pairs: Pairs,
    solver: Solver,
    flights: Vec<Flight>,
    corrections: Vec<Correction>,
    /// The time of the solver's passes in the last step.
    passes_us: f64,
}

impl World for Bed {
    fn step(&mut self) {
        // Pairs and manifolds are those of the start poses.
        let poses: Vec<_> = self.bodies.iter().map(Body::pose).collect();
        self.joints.place(&self.bodies);
        self.flights.clear();
        self.flights.extend(self.bodies.iter_mut().map(|body| body.fly(&self.timing)));
        self.pairs.collide(&self.bodies, &poses, &self.flights, &self.joints.pairs);
        let (joints, contacts) = (&mut self.joints.joints, &mut self.pairs.contacts);
        self.solver.prepare(self.time_step, &self.options, &self.flights, joints, contacts);
        VectorSet::allow(self.widest);
        let before = Instant::now();
        self.solver.run_passes(self.time_step, &self.options, contacts);
        self.passes_us = before.elapsed().as_secs_f64() * 1e6;
        VectorSet::allow(VectorSet::Avx512);
        self.solver.finish(self.time_step, &self.options, &self.flights, joints, contacts, &mut self.corrections);
        for (body, correction) in self.bodies.iter_mut().zip(&self.corrections) {
            body.correct(correction);
        }
        self.pairs.keep();
    }
    fn body_count(&self) -> usize {
        self.bodies.len()
    }
    fn state(&self, i: usize) -> State {
        self.bodies[i].state()
    }
    fn hash(&self) -> u64 {
        let mut h = Hash::new();
        for b in &self.bodies {
            h.word(b.angle.to_bits());
            for part in [b.position.x, b.position.y, b.velocity.x, b.velocity.y, b.angular_velocity] {
                let bits = part.to_bits();
                h.word(bits as u64);
                h.word((bits >> 64) as u64);
            }
        }
        h.finish()
    }
    fn push(&mut self, _i: usize, _fx: f64, _fy: f64) {
        unreachable!("scenes with forces are refused");
    }
    fn awake(&self) -> Option<usize> {
        Some(self.bodies.iter().filter(|b| b.is_dynamic).count())
    }
    fn contact_points(&self) -> Option<usize> {
        Some(self.pairs.contacts.iter().map(|c| c.count).sum())
    }
    fn pass_times(&self) -> Vec<(&'static str, f64)> {
        vec![("run_passes", self.passes_us)]
    }
}
