//! The contact solver: bodies and contacts up to the limits, solved for some steps.
//!
//! An input is a list of values: settings of the solver, bodies, contacts. Velocities, separations and impulses of a step are those
//! that the next one starts with. Contacts keep their arms and normals: the solver promises the same for any geometry.

use std::collections::BTreeSet;

use dashu_int::{IBig, UBig};
use umbra_physics::scalar::internals::VectorSet;
use umbra_physics::solve::{Contact, Correction, Flight, Impulses, Point, Velocity};
use umbra_physics::{Fx, FxAccumulator, FxFactor, Vec2};

use super::contact_scene::{Scene, Solution, Values};
use super::tally;

/// The fewest steps of an input, and of one in 16.
const STEPS: usize = 4;
const MANY_STEPS: usize = 20;

/// The target.
pub fn run(data: &[u8]) {
    let mut values = Values { rest: data };
    let length = values.below(64);
    let steps = length % 2 + if length < 60 { STEPS } else { MANY_STEPS };
    let mut scene = values.scene();
    for step in 0..steps {
        let solution = scene.solve();
        tally::count_contacts(|| solution.impulses.iter().filter(|impulses| impulses.values != [0; 3]).count());
        // Each of these solves the scene several times again: one a step, and the input says which one at the first step.
        let is_due = |number: usize| (step + length / 4) % 4 == number;
        if is_due(1) {
            check_vectors(&scene, &solution);
        }
        if is_due(2) {
            check_images(&scene, &solution);
        }
        if is_due(3) {
            check_islands(&scene, &solution);
        }
        check_impulses(&scene, &solution);
        check_momentum(&scene, &solution);
        scene.advance(&solution);
    }
}

/// The same bits with all sets of vector instructions.
fn check_vectors(scene: &Scene, solution: &Solution) {
    for set in VectorSet::available() {
        VectorSet::allow(set);
        assert_eq!(scene.solve(), *solution, "{set:?}: {scene:?}");
    }
    VectorSet::allow(VectorSet::Avx512);
}

/// A rotation or a mirror image of a scene, in vectors; `sign` is that of angles.
#[derive(Clone, Copy)]
struct Image {
    vector: fn(Vec2) -> Vec2,
    accumulators: fn(Vec2<FxAccumulator>) -> Vec2<FxAccumulator>,
    normal: fn([i32; 2]) -> [i32; 2],
    factors: fn(Vec2<FxFactor>) -> Vec2<FxFactor>,
    is_mirrored: bool,
}

/// The mirror x → −x, and a quarter turn counter-clockwise.
const IMAGES: [Image; 2] = [
    Image {
        vector: |v| Vec2::new(-v.x, v.y),
        accumulators: |v| Vec2::new(v.x.negated(), v.y),
        normal: |[x, y]| [-x, y],
        factors: |v| v,
        is_mirrored: true,
    },
    Image {
        vector: |v| Vec2::new(-v.y, v.x),
        accumulators: |v| Vec2::new(v.y.negated(), v.x),
        normal: |[x, y]| [-y, x],
        factors: |v| Vec2::new(v.y, v.x),
        is_mirrored: false,
    },
];

impl Image {
    fn turn(&self, value: Fx) -> Fx {
        if self.is_mirrored { -value } else { value }
    }

    fn velocity(&self, velocity: Velocity) -> Velocity {
        Velocity { linear: (self.vector)(velocity.linear), angular: self.turn(velocity.angular) }
    }

    fn flight(&self, flight: &Flight) -> Flight {
        Flight {
            position: (self.vector)(flight.position),
            start: self.velocity(flight.start),
            end: self.velocity(flight.end),
            displacement: (self.vector)(flight.displacement),
            rotation: self.turn(flight.rotation),
            inverse_mass: (self.factors)(flight.inverse_mass),
            ..*flight
        }
    }

    fn impulses(&self, contact: &Contact, impulses: Impulses) -> Impulses {
        let [first, second, along] = impulses.values;
        let turn = |value: i64| if self.is_mirrored { -value } else { value };
        // With one point the second impulse is that of rolling resistance.
        Impulses { values: [first, if contact.count == 1 { turn(second) } else { second }, turn(along)], ..impulses }
    }

    fn contact(&self, contact: &Contact) -> Contact {
        Contact {
            normal: (self.normal)(contact.normal),
            points: contact.points.map(|point| Point { arms: point.arms.map(self.vector), ..point }),
            surface_speed: self.turn(contact.surface_speed),
            impulses: self.impulses(contact, contact.impulses),
            ..*contact
        }
    }

    fn correction(&self, correction: &Correction) -> Correction {
        let turn = |value: FxAccumulator| if self.is_mirrored { value.negated() } else { value };
        Correction {
            is_pushed: correction.is_pushed,
            velocity: (self.accumulators)(correction.velocity),
            angular_velocity: turn(correction.angular_velocity),
            displacement: (self.accumulators)(correction.displacement),
            rotation: turn(correction.rotation),
        }
    }
}

/// A contact with its bodies and its points in the other order.
fn swapped(contact: &Contact, bodies: u32) -> Contact {
    let mut points = contact.points.map(|point| Point { arms: [point.arms[1], point.arms[0]], ..point });
    let mut impulses = contact.impulses;
    if contact.count == 2 {
        points.swap(0, 1);
        impulses.values.swap(0, 1);
    } else {
        impulses.values[1] = -impulses.values[1];
    }
    let [a, b] = contact.bodies.map(|body| bodies - 1 - body);
    Contact { bodies: [b, a], normal: contact.normal.map(|part| -part), points, impulses, ..*contact }
}

/// The image of a scene has the image of its solution, and so has a scene in another order.
fn check_images(scene: &Scene, solution: &Solution) {
    let flights = scene.flights();
    for image in IMAGES {
        let contacts = scene.contacts.iter().map(|contact| image.contact(contact)).collect();
        let images: Vec<Flight> = flights.iter().map(|flight| image.flight(flight)).collect();
        let expected = Solution {
            impulses: scene
                .contacts
                .iter()
                .zip(&solution.impulses)
                .map(|(contact, impulses)| image.impulses(contact, *impulses))
                .collect(),
            corrections: solution.corrections.iter().map(|correction| image.correction(correction)).collect(),
            counts: solution.counts,
        };
        assert_eq!(scene.solve_seen(&images, contacts), expected, "mirrored: {}, {scene:?}", image.is_mirrored);
    }
    let contacts = scene.contacts.iter().rev().map(|contact| swapped(contact, flights.len() as u32)).collect();
    let images: Vec<Flight> = flights.iter().rev().copied().collect();
    let mut reordered = scene.solve_seen(&images, contacts);
    reordered.impulses.reverse();
    reordered.corrections.reverse();
    for (impulses, contact) in reordered.impulses.iter_mut().zip(&scene.contacts) {
        if contact.count == 2 {
            impulses.values.swap(0, 1);
        } else {
            impulses.values[1] = -impulses.values[1];
        }
    }
    assert_eq!(reordered, *solution, "in another order: {scene:?}");
}

/// The bodies that depend on each other with the first body of the first contact, and bodies at their borders that cannot be moved.
fn island(scene: &Scene) -> BTreeSet<u32> {
    let mut island: BTreeSet<u32> = scene.contacts[0].bodies.into();
    loop {
        let before = island.len();
        for [a, b] in scene.contacts.iter().map(|contact| contact.bodies) {
            for (from, to) in [(a, b), (b, a)] {
                if island.contains(&from) && !scene.bodies[from as usize].is_fixed() {
                    island.insert(to);
                }
            }
        }
        if island.len() == before {
            return island;
        }
    }
}

/// An island depends on nothing else.
fn check_islands(scene: &Scene, solution: &Solution) {
    let island = island(scene);
    let is_member = |body: &u32| island.contains(body) && !scene.bodies[*body as usize].is_fixed();
    let is_inside = |contact: &&Contact| contact.bodies.iter().any(is_member);
    let contacts = scene.contacts.iter().filter(is_inside).copied().collect();
    let alone = scene.solve_seen(&scene.flights(), contacts);
    let inside = scene.contacts.iter().zip(&solution.impulses).filter(|(contact, _)| is_inside(contact));
    assert!(inside.map(|(_, impulses)| impulses).eq(&alone.impulses), "an island alone: {scene:?}");
    for body in island.iter().filter(|body| is_member(body)) {
        let body = *body as usize;
        assert_eq!(alone.corrections[body], solution.corrections[body], "an island alone: {scene:?}");
    }
}

/// Contacts push, friction is within its cone, and what touches nothing or cannot be moved keeps its free flight.
fn check_impulses(scene: &Scene, solution: &Solution) {
    for (contact, impulses) in scene.contacts.iter().zip(&solution.impulses) {
        let [first, second, along] = impulses.values;
        // With one point the second impulse is that of rolling resistance, at most the normal one.
        let is_rolling = contact.count == 1 && second.unsigned_abs() <= first.unsigned_abs();
        assert!(first >= 0 && (is_rolling || contact.count == 2 && second >= 0), "{impulses:?} of {scene:?}");
        let two = if contact.count == 2 { second } else { 0 };
        // Cut off, friction may take steps to come into the cone.
        if solution.counts.cut == 0 {
            // The coefficient is rounded to 2^-26, and the share of the load to a unit.
            let (load, coefficient) = (i128::from(first) + i128::from(two), i128::from(contact.friction.to_bits()));
            let max = ((load * (coefficient + (1 << 5))) >> 32) + 1;
            assert!(i128::from(along.unsigned_abs()) <= max, "{impulses:?} of {scene:?}");
        }
    }
    let touched: BTreeSet<u32> = scene.contacts.iter().flat_map(|contact| contact.bodies).collect();
    for (i, (body, correction)) in scene.bodies.iter().zip(&solution.corrections).enumerate() {
        if body.is_fixed() || !touched.contains(&(i as u32)) {
            assert_eq!(*correction, Correction::default(), "body {i} of {scene:?}");
        }
    }
}

/// Impulses are equal and opposite: where all bodies can be moved along an axis, momentum changes by rounding alone.
fn check_momentum(scene: &Scene, solution: &Solution) {
    let island = island(scene);
    let members = || island.iter().map(|&body| (&scene.bodies[body as usize], &solution.corrections[body as usize]));
    for axis in [0, 1] {
        let (mut sum, mut moved, mut masses) = (IBig::ZERO, UBig::ZERO, UBig::ZERO);
        let mut is_conserved = true;
        for (body, correction) in members() {
            let inverse = [body.inverse_mass.x, body.inverse_mass.y][axis];
            let change = [correction.velocity.x, correction.velocity.y][axis].to_bits();
            // Changes beyond all velocities of a world are cut off.
            is_conserved &= !inverse.is_zero() && change.unsigned_abs() < 1 << 126;
            let mass = UBig::from(body.mass.to_bits() as u64);
            let part = IBig::from(mass.clone()) * IBig::from(change);
            moved += UBig::from(change.unsigned_abs()) * &mass;
            sum += part;
            masses += mass;
        }
        // 1/m is rounded to 2^-63 of it, and Δv to 2^-96 m/s.
        let bound = (moved >> 62) + masses;
        assert!(!is_conserved || IBig::from(bound) >= sum.clone().max(-sum), "axis {axis} of {scene:?}");
    }
}
