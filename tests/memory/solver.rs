//! The heap that a step of the solver takes.

use allocation_counter::measure;
use umbra_physics::solve::{
    Contact, Correction, Flight, Impulses, Joint, JointKind, Point, Solver, SolverOptions, Velocity,
};
use umbra_physics::{Fx, FxFactor, TimeStep, Vec2, fx, vec2};

/// A box of 1 m and 1 kg, or a fixed one, that flies straight for 1/64 s.
fn flight(position: Vec2, linear: Vec2, is_fixed: bool) -> Flight {
    let velocity = Velocity { linear, angular: fx!(0) };
    let inverse = |value: FxFactor| if is_fixed { FxFactor::ZERO } else { value };
    let inverse_mass = inverse(FxFactor::ONE);
    Flight {
        position,
        start: velocity,
        end: velocity,
        displacement: linear / 64,
        rotation: fx!(0),
        mass: fx!(1),
        inverse_mass: Vec2 { x: inverse_mass, y: inverse_mass },
        inverse_inertia: inverse(FxFactor::from_ratio(6, 1)),
        radius: fx!(0.75),
        leader: None,
    }
}

/// A contact of two boxes along an axis, with points on both corners of the side.
fn contact(bodies: [u32; 2], axis: Vec2) -> Contact {
    let across = Vec2::new(axis.y, -axis.x);
    let point = |side: Vec2| Point { arms: [(axis + side) / 2, (side - axis) / 2], separation: fx!(-0.001) };
    Contact {
        bodies,
        normal: [axis.x, axis.y].map(|c| (c.to_bits() >> 2) as i32),
        count: 2,
        points: [point(across), point(-across)],
        friction: fx!(0.5),
        restitution: fx!(0.5),
        rolling_resistance: fx!(0),
        rolling_radius: fx!(0),
        surface_speed: fx!(0),
        impulses: Impulses::default(),
    }
}

#[derive(Default)]
struct Scene {
    flights: Vec<Flight>,
    joints: Vec<Joint>,
    contacts: Vec<Contact>,
}

impl Scene {
    /// A floor that moves, and on it towers and ropes; loose pairs of boxes that meet, and loose pairs that are tied together.
    fn new(count: i32) -> Self {
        let mut scene = Self::default();
        scene.push(vec2(0, 0), vec2(1, 0), true);
        for i in 0..count {
            let [mut below, mut above] = [0, 0];
            for k in 1..5 {
                let next = scene.push(vec2(4 * i, k), vec2(0, fx!(-0.125)), false);
                scene.contacts.push(contact([below, next], vec2(0, 1)));
                below = next;
                let next = scene.push(vec2(4 * i, -2 * k), vec2(0, fx!(-0.125)), false);
                scene.tie([above, next]);
                above = next;
            }
            let pair = [0, 1].map(|k| scene.push(vec2(4 * i + k, 10), vec2(2 - 4 * k, 0), false));
            scene.contacts.push(contact(pair, vec2(1, 0)));
            let pair = [0, 1].map(|k| scene.push(vec2(4 * i, 12 + 2 * k), vec2(0, 2 * k - 1), false));
            scene.tie(pair);
        }
        scene
    }

    fn push(&mut self, position: Vec2, velocity: Vec2, is_fixed: bool) -> u32 {
        self.flights.push(flight(position, velocity, is_fixed));
        self.flights.len() as u32 - 1
    }

    fn tie(&mut self, bodies: [u32; 2]) {
        let kind = JointKind::Distance { length: fx!(2) };
        self.joints.push(Joint {
            bodies,
            anchors: [vec2(0, 0); 2],
            kind,
            axis: None,
            slides: [None; 2],
            impulses: Impulses::default(),
        });
    }
}

#[test]
fn a_step_of_the_solver_takes_nothing_from_the_heap_once_its_buffers_are_as_long() {
    let (mut solver, options, mut corrections) = (Solver::default(), SolverOptions::default(), Vec::new());
    for round in 0..4 {
        for count in [8, 1, 3] {
            let Scene { flights, mut joints, mut contacts } = Scene::new(count);
            let taken = measure(|| {
                let time_step = TimeStep::hz(64);
                solver.solve(time_step, &options, &flights, &mut joints, &mut contacts, &mut corrections);
            });
            assert!((round, count) == (0, 8) || taken.count_total == 0, "round {round}, {count}: {taken:?}");
            // All parts of the solver have work to do.
            assert!(joints.iter().all(|joint| joint.impulses.values[0] != 0));
            let is_solved = |correction: &Correction| {
                correction.velocity.x.value() != fx!(0) || correction.velocity.y.value() != fx!(0)
            };
            assert!(corrections[1..].iter().all(is_solved));
            // They meet at 4 m/s, and part at half of that.
            let met = contacts.iter().filter(|contact| contact.normal[1] == 0).map(|contact| contact.bodies[1]);
            let change = |body: u32| corrections[body as usize].velocity.x.value() - fx!(3);
            assert_eq!(met.filter(|&body| change(body).abs() < Fx::from_bits(1 << 20)).count(), count as usize);
        }
    }
}
