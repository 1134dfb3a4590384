//! Images of a scene have the images of its results, bit for bit, and joints conserve momentum.

use alloc::vec;
use alloc::vec::Vec;

use super::cases::net;
use super::scene::{RATE, Scene, signed};
use super::world::{Body, World};
use crate::cases::run_seed;
use crate::fx::Fx;
use crate::kernel::simd::VectorSet;
use crate::math::{Random, TimeStep, Vec2};
use crate::scalar::{FxAccumulator, FxFactor, Turn};
use crate::solve::joint::gains::Gains;
use crate::solve::joint::{Axis, AxisSpring};
use crate::solve::{Correction, Flight, Impulses, Joint, JointKind, Solver, Velocity};

/// A mirror image (x to −x) or a quarter turn counter-clockwise.
#[derive(Clone, Copy, Debug)]
enum Image {
    Mirror,
    Turn,
}

/// A number with a sign.
trait Signed: Copy {
    fn negated(self) -> Self;
}

impl Signed for Fx {
    fn negated(self) -> Self {
        Fx::from_bits(-self.to_bits())
    }
}

impl Signed for FxAccumulator {
    fn negated(self) -> Self {
        FxAccumulator::from_bits(-self.to_bits())
    }
}

impl Signed for i64 {
    fn negated(self) -> Self {
        -self
    }
}

impl Signed for i32 {
    fn negated(self) -> Self {
        -self
    }
}

impl Image {
    fn vector<T: Signed>(self, [x, y]: [T; 2]) -> [T; 2] {
        match self {
            Self::Mirror => [x.negated(), y],
            Self::Turn => [y.negated(), x],
        }
    }

    fn angle<T: Signed>(self, angle: T) -> T {
        match self {
            Self::Mirror => angle.negated(),
            Self::Turn => angle,
        }
    }

    fn pair<T: Signed>(self, Vec2 { x, y }: Vec2<T>) -> Vec2<T> {
        let [x, y] = self.vector([x, y]);
        Vec2::new(x, y)
    }

    fn velocity(self, v: Velocity) -> Velocity {
        Velocity { linear: self.pair(v.linear), angular: self.angle(v.angular) }
    }

    fn flight(self, flight: &Flight) -> Flight {
        let Vec2 { x, y } = flight.inverse_mass;
        Flight {
            inverse_mass: if matches!(self, Self::Turn) { Vec2::new(y, x) } else { flight.inverse_mass },
            position: self.pair(flight.position),
            start: self.velocity(flight.start),
            end: self.velocity(flight.end),
            displacement: self.pair(flight.displacement),
            rotation: self.angle(flight.rotation),
            ..*flight
        }
    }

    fn impulses(self, kind: JointKind, impulses: Impulses) -> Impulses {
        let [first, second, third] = impulses.values;
        match kind {
            JointKind::Revolute => {
                let [x, y] = self.vector([first, second]);
                Impulses { values: [x, y, self.angle(third)], ..impulses }
            }
            // The direction of a slider has an image.
            JointKind::Slider { .. } | JointKind::Planar { .. } => {
                Impulses { values: [first, self.angle(second), self.angle(third)], ..impulses }
            }
            JointKind::Distance { .. } | JointKind::Line | JointKind::Pulley { .. } => impulses,
            JointKind::Gear { .. } => Impulses { values: [first, second, self.angle(third)], ..impulses },
        }
    }

    fn kind(self, kind: JointKind) -> JointKind {
        let image = |angle: Turn| {
            Turn::from_bits(match self {
                Self::Mirror => (1_u64 << 63).wrapping_sub(angle.to_bits()),
                Self::Turn => (1_u64 << 62).wrapping_add(angle.to_bits()),
            })
        };
        match kind {
            JointKind::Slider { angle } => JointKind::Slider { angle: image(angle) },
            JointKind::Planar { angle } => JointKind::Planar { angle: image(angle) },
            JointKind::Pulley { grounds, strands } => {
                JointKind::Pulley { grounds: grounds.map(|ground| self.pair(ground)), strands }
            }
            JointKind::Revolute | JointKind::Distance { .. } | JointKind::Line | JointKind::Gear { .. } => kind,
        }
    }

    fn axis(self, axis: &Axis) -> Axis {
        match self {
            Self::Mirror => reversed(axis),
            Self::Turn => *axis,
        }
    }

    fn scene(self, scene: &Scene) -> Scene {
        let mut image = scene.clone();
        image.flights = scene.flights.iter().map(|flight| self.flight(flight)).collect();
        for joint in &mut image.joints {
            joint.anchors = joint.anchors.map(|anchor| self.pair(anchor));
            joint.impulses = self.impulses(joint.kind, joint.impulses);
            joint.kind = self.kind(joint.kind);
            joint.axis = joint.axis.as_ref().map(|axis| self.axis(axis));
            joint.slides[1] = joint.slides[1].as_ref().map(|axis| self.axis(axis));
        }
        for contact in &mut image.contacts {
            contact.normal = self.vector(contact.normal);
            contact.points.iter_mut().for_each(|point| point.arms = point.arms.map(|arm| self.pair(arm)));
        }
        image
    }

    fn correction(self, correction: &Correction) -> Correction {
        Correction {
            is_pushed: correction.is_pushed,
            velocity: self.pair(correction.velocity),
            angular_velocity: self.angle(correction.angular_velocity),
            displacement: self.pair(correction.displacement),
            rotation: self.angle(correction.rotation),
        }
    }
}

/// An axis in the opposite direction.
fn reversed(axis: &Axis) -> Axis {
    Axis {
        position: -axis.position,
        limits: axis.limits.map(|[lower, upper]| [-upper, -lower]),
        motor_speed: -axis.motor_speed,
        spring: axis.spring.map(|spring| AxisSpring { rest: -spring.rest, ..spring }),
        ..*axis
    }
}

/// Scenes with and without fixed bodies, trees and loops of joints, with contacts in half of them, and with hard masses in every third.
fn scenes(seed: u64, count: usize) -> Vec<Scene> {
    let mut random = Random::seeded(run_seed(seed));
    (0..count)
        .map(|i| {
            let contacts = if i % 2 == 0 { 0 } else { 8 };
            let mut scene = Scene::random(&mut random, [12, i % 3], 5 + i % 15, contacts);
            if i % 3 == 1 {
                scene.make_hard(&mut random);
            }
            if i % 8 > 4 {
                scene.add_slides(&mut random);
            }
            if i % 4 > 1 {
                scene.add_axes(&mut random);
            }
            scene
        })
        .collect()
}

#[test]
fn mirror_images_and_quarter_turns_keep_the_bits() {
    for scene in scenes(1, 300) {
        let (corrections, impulses, cut) = scene.solve();
        for image in [Image::Mirror, Image::Turn] {
            let expected: Vec<_> = corrections.iter().map(|correction| image.correction(correction)).collect();
            let kinds = scene.joints.iter().map(|joint| joint.kind);
            let values: Vec<_> = kinds.zip(&impulses).map(|(kind, &values)| image.impulses(kind, values)).collect();
            assert_eq!(image.scene(&scene).solve(), (expected, values, cut), "{image:?}");
        }
    }
}

#[test]
fn bodies_of_a_joint_in_either_order_keep_the_bits() {
    for scene in scenes(2, 300) {
        let (corrections, impulses, cut) = scene.solve();
        let swapped_impulses = |kind: JointKind, impulses: Impulses| match kind {
            JointKind::Revolute => Impulses { values: impulses.values.map(|value| -value), ..impulses },
            _ => impulses,
        };
        let mut swapped_scene = scene.clone();
        // A frame turns with its first body, and teeth have their order.
        let has_order =
            |joint: &&mut Joint| joint.kind.frame_angle().is_some() || matches!(joint.kind, JointKind::Gear { .. });
        for joint in swapped_scene.joints.iter_mut().filter(|joint| !has_order(joint)) {
            joint.bodies.reverse();
            joint.anchors.reverse();
            if let JointKind::Pulley { grounds, strands } = &mut joint.kind {
                grounds.reverse();
                strands.reverse();
            }
            joint.impulses = swapped_impulses(joint.kind, joint.impulses);
            joint.axis = joint.axis.as_ref().map(reversed);
        }
        let kinds = scene.joints.iter().map(|joint| joint.kind);
        let expected = kinds.zip(&impulses).map(|(kind, &values)| swapped_impulses(kind, values)).collect();
        assert_eq!(swapped_scene.solve(), (corrections, expected, cut));
    }
}

#[test]
fn any_order_of_bodies_and_joints_gives_the_same_bits() {
    let mut random = Random::seeded(run_seed(3));
    for scene in scenes(4, 300) {
        let (corrections, impulses, cut) = scene.solve();
        let mut order = |n: usize| {
            let mut keys: Vec<_> = (0..n).map(|i| (random.bits(), i)).collect();
            keys.sort_unstable();
            keys.into_iter().map(|(_, i)| i).collect::<Vec<usize>>()
        };
        let bodies = order(scene.flights.len());
        let joints = order(scene.joints.len());
        let mut place = vec![0; bodies.len()];
        bodies.iter().enumerate().for_each(|(new, &old)| place[old] = new as u32);
        let mut reordered = scene.clone();
        reordered.flights = bodies.iter().map(|&i| scene.flights[i]).collect();
        reordered.joints = joints.iter().map(|&i| scene.joints[i]).collect();
        reordered.contacts.reverse();
        let joint_ends = reordered.joints.iter_mut().map(|joint| &mut joint.bodies);
        for ends in joint_ends.chain(reordered.contacts.iter_mut().map(|contact| &mut contact.bodies)) {
            *ends = ends.map(|body| place[body as usize]);
        }
        let expected = bodies.iter().map(|&i| corrections[i]).collect();
        assert_eq!(reordered.solve(), (expected, joints.iter().map(|&i| impulses[i]).collect(), cut));
    }
}

/// Trees and loops are found when joints change: none may stay behind. Joint after joint goes, so that one solver sees loops beside trees, fewer
/// trees than stood before the loops, and no joints at all.
#[test]
fn the_past_of_a_solver_does_not_matter() {
    let mut solver = Solver::default();
    for mut scene in scenes(9, 100) {
        assert_eq!(scene.solve_by(&mut solver), scene.solve());
        assert_eq!(scene.solve_by(&mut solver), scene.solve());
        // The same joints, of which one can no longer move its first body.
        let joint = scene.joints[0].bodies[0] as usize;
        scene.flights[joint].inverse_mass = Vec2::new(FxFactor::ZERO, FxFactor::ZERO);
        scene.flights[joint].inverse_inertia = FxFactor::ZERO;
        assert_eq!(scene.solve_by(&mut solver), scene.solve());
        while scene.joints.pop().is_some() {
            assert_eq!(scene.solve_by(&mut solver), scene.solve());
        }
    }
}

/// The impulses of a joint on both its bodies add up to nothing, whatever the masses.
#[test]
fn hard_masses_keep_their_momentum() {
    let mut random = Random::seeded(run_seed(10));
    for _ in 0..200 {
        let mut scene = Scene::random(&mut random, [6, 0], 4, 0);
        scene.make_hard(&mut random);
        for flight in &mut scene.flights {
            // The masses of bodies without locks are powers of two: their products are exact.
            let exponent = (random.below(40) as i32) - 20;
            let mass = FxFactor::new(1, -exponent);
            flight.inverse_mass = [mass; 2].map(|mass| FxFactor::ONE.over(mass)).into();
            flight.mass = mass.to_scalar().expect("a mass within the limits");
        }
        let (corrections, ..) = scene.solve();
        for axis in [|v: &Vec2<FxAccumulator>| v.x, |v: &Vec2<FxAccumulator>| v.y] {
            let exponent = |flight: &Flight| 64 - flight.inverse_mass.x.parts().1;
            let momentum = |(correction, flight): (&Correction, &Flight)| {
                // Velocities are rounded to 2^-96 m/s: masses below 1 kg lose nothing that shows.
                let velocity = axis(&correction.velocity).to_bits() as f64;
                velocity * 2f64.powi(1 - exponent(flight))
            };
            let parts: Vec<f64> = corrections.iter().zip(&scene.flights).map(momentum).collect();
            let largest = parts.iter().fold(0.0, |largest, part| f64::max(largest, part.abs()));
            assert!(parts.iter().sum::<f64>().abs() <= largest * 2f64.powi(-44), "{parts:?}");
        }
    }
}

/// Only impulses that are cut off at the ends of ranges are counted; here the bodies are 10 km away from their anchors.
#[test]
fn values_that_are_cut_off_are_counted_and_cut_oddly() {
    let mut random = Random::seeded(run_seed(5));
    let mut total_cut = 0;
    for _ in 0..20 {
        let mut scene = Scene::random(&mut random, [4, 1], 4, 0);
        for (i, flight) in scene.flights.iter_mut().enumerate() {
            flight.position.x = Fx::from_bits((i as i64) * (10_000 << 32));
            flight.inverse_inertia = flight.inverse_inertia.times((1 << 20).into());
        }
        scene.joints.iter_mut().for_each(|joint| joint.impulses.exponent = 40);
        let (corrections, _, cut) = scene.solve();
        total_cut += cut;
        let expected: Vec<_> = corrections.iter().map(|correction| Image::Mirror.correction(correction)).collect();
        let (mirrored, _, mirrored_cut) = Image::Mirror.scene(&scene).solve();
        assert_eq!((mirrored, mirrored_cut), (expected, cut));
    }
    assert!(total_cut > 0);
}

/// Two free bodies of 1 and 3 kg: their momentum changes by the rounding of velocities alone.
#[test]
fn joints_conserve_momentum() {
    let mut random = Random::seeded(run_seed(6));
    for rod in [false, true] {
        let mut small = Body::rectangle([0.0, 0.0], [0.5; 2]);
        let mut large = Body::rectangle([1.5, 0.25], [0.5; 2]);
        (small.mass, small.inertia) = (1.0, 0.1);
        (large.mass, large.inertia) = (3.0, 0.4);
        small.velocity = [signed(&mut random), 2.0 * signed(&mut random)];
        (small.spin, large.spin) = (5.0 * signed(&mut random), 3.0);
        let mut world = World::new(&[small, large], 0.0);
        if rod {
            world.rod(0, 1, [[0.5, 0.5], [1.0, -0.25]])
        } else {
            world.pin(0, 1, [0.75, 0.1])
        }
        let mut largest = 0;
        for _ in 0..1000 {
            world.step();
            let [a, b] = [&world.corrections[0].velocity, &world.corrections[1].velocity];
            for (a, b) in [(a.x, b.x), (a.y, b.y)] {
                let (a, b) = (a.to_bits(), 3 * b.to_bits());
                largest = largest.max(a.abs());
                // 2^-63 of the impulse, and 2^-96 m/s times the mass of each body.
                assert!((a + b).abs() <= (a.abs() >> 63) + 4, "{a} {b}");
            }
        }
        assert!(largest > 1 << 80, "no impulses to speak of");
        assert!(world.worst_gap() < 1e-3, "{}", world.worst_gap());
        assert_eq!(world.cut, 0);
    }
}

/// Loops of pins have groups of lanes in the iterations, and all others their blocks. A line without a law beside a pin makes all the difference.
#[test]
fn groups_of_pins_give_the_bits_of_blocks() {
    let sets: Vec<VectorSet> = VectorSet::available().collect();
    for (speed, heavy) in [(0.0, 1.0), (3.0, 1.0), (300.0, 1.0), (3.0, 50.0), (30.0, 3000.0)] {
        let mut world = net(8, true);
        // The last group has lanes without a joint, and units of impulses differ.
        world.links.truncate(world.links.len() - 3);
        world.bodies[35].velocity = [speed, -2.0 * speed];
        world.bodies[12].spin = speed;
        for (i, body) in (0_u8..).zip(&mut world.bodies) {
            body.mass *= f64::from(1 + i % 3);
            body.inertia *= f64::from(1 + i % 5);
        }
        for body in [9, 20, 44] {
            world.bodies[body].mass *= heavy;
            world.bodies[body].inertia *= heavy;
        }
        // A ball strikes the net.
        world.bodies[27].disc = 0.2;
        let [x, y] = world.bodies[27].at;
        let (at, velocity) = ([x + 0.1, y + 0.6], [1.0, -30.0 - speed]);
        world.bodies.push(Body { at, velocity, mass: 1.0, inertia: 0.02, radius: 0.2, disc: 0.2, ..Body::fixed() });
        let mut strikes = 0;
        let mut worlds = vec![world.clone(); sets.len()];
        worlds.iter_mut().zip(&sets).for_each(|(world, &set)| world.vectors = Some(set));
        world.free_line = Some(20);
        for step in 0..90 {
            world.step();
            strikes += world.solver.impacts.strikes.len();
            for (lanes, set) in worlds.iter_mut().zip(&sets) {
                lanes.step();
                assert_eq!(lanes.bodies, world.bodies, "{set:?}, {speed}, {heavy}, step {step}");
                assert_eq!(lanes.cut, world.cut, "{set:?}, {speed}, {heavy}, step {step}");
            }
        }
        // Impulses beyond the lanes, and beyond the limits of passes.
        for up in [20, 40, 60] {
            for link in worlds.iter_mut().chain([&mut world]).flat_map(|world| &mut world.links) {
                link.impulses.exponent += up;
            }
            world.step();
            for (lanes, set) in worlds.iter_mut().zip(&sets) {
                lanes.step();
                assert_eq!(lanes.bodies, world.bodies, "{set:?}, {speed}, {heavy}, up {up}");
                assert_eq!(lanes.cut, world.cut, "{set:?}, {speed}, {heavy}, up {up}");
            }
        }
        assert!(strikes > 0 && world.cut > 0 && !world.solver.joints.loops.has_groups());
        for lanes in &worlds {
            assert!(lanes.solver.joints.loops.has_groups());
            assert!(world.links.iter().zip(&lanes.links).all(|(link, twin)| link.impulses == twin.impulses), "{speed}");
        }
    }
}

/// Small impulses change velocities along a shorter way, to the same bits.
#[test]
fn short_and_long_ways_to_gains_give_the_same_bits() {
    let mut random = Random::seeded(run_seed(11));
    let mut count = 0;
    for scene in scenes(12, 60) {
        let mut solver = Solver::default();
        solver.prepare(TimeStep::hz(RATE), &scene.options, &scene.flights, &scene.joints, &[]);
        let row_count = solver.bodies.rows.len();
        let [mut short, mut long] = [(); 2].map(|()| Gains::default());
        [&mut short, &mut long].into_iter().for_each(|gains| gains.set_rows(row_count));
        for block in &mut solver.joints.blocks {
            block.impulses = [0; 3].map(|_| (signed(&mut random) * 2.0_f64.powi(20)) as i64);
            block.change = block.sums(block.impulses);
            block.give_gains(&mut short);
            block.give_large_gains(&mut long);
            count += 1;
        }
        assert_eq!(short.sums(), long.sums());
        assert!(short.sums().iter().any(|sums| *sums != [0; 3]));
    }
    assert!(count > 500, "{count}");
}
