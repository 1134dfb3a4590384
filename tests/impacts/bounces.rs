//! Impacts of single bodies and of stacks against closed forms: e·v at any moment, whatever else the body touches.

use umbra_physics::{
    BodyDef, BodyId, BodyKind, ColliderDef, Filter, Fx, Random, Shape, TimeStep, Vec2, World, WorldDef, fx, vec2,
};

use crate::impacts::flights::length;
use crate::impacts::scenes::{
    allowance, angle, between, bouncing, build, conclude, disc, dynamic, energy, falling, fixed, float, floating,
    floor, kinematic, kinetic_energy, number, of_any_size, of_material, point, position, random, rectangle, seeds,
    spin, steps, velocity,
};

/// A body that does not meet others with this filter.
fn apart(mut body: BodyDef) -> BodyDef {
    for collider in &mut body.colliders {
        collider.filter = Filter { group: -1, ..Filter::default() };
    }
    body
}

/// Shapes half a metre high.
fn shapes() -> [Shape; 3] {
    [disc(fx!(0.25)), rectangle(fx!(0.5), fx!(0.5)), Shape::capsule(fx!(0.5), fx!(0.25)).expect("a capsule")]
}

/// Bodies that fly to a wall on the right at x = 5, over a floor whose top is at a height, each at another moment of the step.
fn against_a_wall(shape: &Shape, speed: f64, restitution: Fx, height: Option<Fx>) -> (World, Vec<BodyId>) {
    let mut bodies = vec![of_material(fixed(rectangle(fx!(1), fx!(9)), vec2(fx!(5.5), fx!(4.5))), fx!(0), restitution)];
    bodies.extend(
        height.map(|top| of_material(fixed(rectangle(fx!(60), fx!(1)), vec2(0, top - fx!(0.5))), fx!(0), fx!(0))),
    );
    for phase in 0..100 {
        let start = 3.0 + f64::from(phase) * speed / 6_000.0;
        let body = dynamic(shape.clone(), vec2(number(start), fx!(0.25)));
        bodies.push(apart(of_material(BodyDef { velocity: vec2(number(speed), 0), ..body }, fx!(0), fx!(0))));
    }
    let gravity = if height.is_some() { vec2(0, -10) } else { Vec2::ZERO };
    let count = bodies.len();
    let (world, ids) = build(WorldDef { gravity, ..floating() }, bodies);
    (world, ids[count - 100..].to_vec())
}

#[test]
fn a_bounce_off_a_wall_is_whole_whatever_the_floor_does() {
    let mut failures = Vec::new();
    let mut tried = 0;
    for shape in shapes() {
        for (speed, restitution) in [(3.0, 1.0), (3.0, 0.8), (3.0, 0.5), (1.5, 1.0), (20.0, 1.0), (20.0, 0.5)] {
            for height in [Some(fx!(0)), Some(fx!(-0.05)), Some(fx!(-0.2)), None] {
                let (mut world, ids) = against_a_wall(&shape, speed, number(restitution), height);
                steps(&mut world, (60.0 * 2.2 / speed) as u32 + 4);
                for (phase, &id) in ids.iter().enumerate() {
                    tried += 1;
                    let [v, _] = velocity(&world, id);
                    if (v + restitution * speed).abs() > 1e-3 * speed {
                        failures.push(format!(
                            "{} corners, {speed} m/s, e {restitution}, floor {height:?}, phase {phase}: {v:.4} m/s",
                            shape.outlines()[0].corners().len()
                        ));
                    }
                }
            }
        }
    }
    conclude(tried, &failures);
}

/// Friction of the floor turns the ball, and the wall has none: the ball comes back with e·v, and what the floor takes in a step.
#[test]
fn a_ball_that_rolls_bounces_off_a_wall() {
    let mut failures = Vec::new();
    for restitution in [1.0, 0.6] {
        let wall = of_material(fixed(rectangle(fx!(1), fx!(9)), vec2(fx!(5.5), fx!(4.5))), fx!(0), number(restitution));
        let mut bodies = vec![floor(), wall];
        for phase in 0..100 {
            let start = number(3.0 + f64::from(phase) * 3.0 / 6_000.0);
            let motion = (vec2(3, 0), fx!(-12));
            let ball = dynamic(disc(fx!(0.25)), vec2(start, fx!(0.25)));
            bodies.push(apart(BodyDef { velocity: motion.0, angular_velocity: motion.1, ..ball }));
        }
        let (mut world, ids) = build(falling(), bodies);
        let mut back = vec![None; 100];
        for _ in 0..60 {
            world.step();
            for (phase, &id) in ids[2..].iter().enumerate() {
                let [v, _] = velocity(&world, id);
                if v < 0.0 && back[phase].is_none() {
                    back[phase] = Some(v);
                }
            }
        }
        for (phase, v) in back.iter().enumerate() {
            let v = v.unwrap_or(0.0);
            // μ·g of a step: 0.1 m/s.
            if v < -3.0 * restitution - 1e-3 || v > -3.0 * restitution + 0.101 {
                failures.push(format!("e {restitution}, phase {phase}: {v:.4} m/s"));
            }
        }
    }
    conclude(200, &failures);
}

/// Both components turn round in a right angle, one after the other or at once.
#[test]
fn a_ball_comes_out_of_a_corner_as_it_went_in() {
    let mut failures = Vec::new();
    for case in 0..100 {
        let walls = [
            of_material(fixed(rectangle(fx!(9), fx!(1)), vec2(0, fx!(-0.5))), fx!(0), fx!(1)),
            of_material(fixed(rectangle(fx!(1), fx!(9)), vec2(fx!(4.5), fx!(4.5))), fx!(0), fx!(1)),
        ];
        // Some arrive at both walls at once.
        let (speed, aside) =
            (2.0 + f64::from(case % 10), if case % 3 == 0 { 0.0 } else { f64::from(case) / 50.0 - 1.0 });
        let ball =
            BodyDef { velocity: point(speed, -speed), ..dynamic(disc(fx!(0.25)), point(2.0 + aside * 0.1, 2.0)) };
        let (mut world, ids) = build(floating(), walls.into_iter().chain([of_material(ball, fx!(0), fx!(1))]));
        steps(&mut world, 80);
        let [x, y] = velocity(&world, ids[2]);
        if length([x + speed, y - speed]) > 1e-3 * speed {
            failures.push(format!("case {case}, {speed} m/s: {x:.4} {y:.4}"));
        }
    }
    conclude(100, &failures);
}

#[test]
fn a_ball_in_a_wedge_of_two_walls_keeps_its_energy() {
    let mut failures = Vec::new();
    for case in 0..60 {
        let lean = number(0.3 + f64::from(case) / 60.0);
        // The two walls meet near the origin, and rise to both sides.
        let wall = |side: i32| BodyDef {
            angle: lean * side,
            ..fixed(
                rectangle(fx!(20), fx!(1)),
                Vec2::new((lean.cos() * 10 + lean.sin() / 2) * side, lean.sin() * 10 - lean.cos() / 2),
            )
        };
        let ball =
            BodyDef { velocity: vec2(0, -12), ..dynamic(disc(fx!(0.5)), point(f64::from(case % 7) / 20.0, 4.0)) };
        let walls = [wall(1), wall(-1)].map(|wall| of_material(wall, fx!(0), fx!(1)));
        let (mut world, _) = build(bouncing(floating()), walls.into_iter().chain([of_material(ball, fx!(0), fx!(1))]));
        let before = kinetic_energy(&world);
        steps(&mut world, 90);
        let share = kinetic_energy(&world) / before;
        if (share - 1.0).abs() > 1e-3 {
            failures.push(format!("walls at {lean:.2} rad: energy × {share:.4}"));
        }
    }
    conclude(60, &failures);
}

/// The ball rises to e² of its height, less what the heavy box takes: 2 kg in a thousand. The floor under the box sees the impact in part.
#[test]
fn a_ball_that_falls_on_a_heavy_box_rises_to_its_share() {
    let mut failures = Vec::new();
    let mut tried = 0;
    for restitution in [0.8, 0.5, 1.0] {
        for phase in 0..60 {
            let drop = 2.0 + f64::from(phase) / 60.0;
            let heavy = ColliderDef { density: fx!(50), ..ColliderDef::new(rectangle(fx!(2), fx!(1))) };
            let heavy = of_material(dynamic(heavy, vec2(0, fx!(0.5))), fx!(0.6), number(restitution));
            let (mut world, _) = build(falling(), [floor(), heavy]);
            steps(&mut world, 20);
            let ball = of_material(dynamic(disc(fx!(0.25)), point(0.0, 1.25 + drop)), fx!(0.6), number(restitution));
            let ball = world.add_body(ball).expect("a body");
            let mut apex = None;
            for _ in 0..80 {
                world.step();
                let [height, speed] = [position(&world, ball)[1] - 1.25, velocity(&world, ball)[1]];
                if speed > 0.0 {
                    apex = Some(height + speed * speed / 20.0);
                    break;
                }
            }
            tried += 1;
            let share = (apex.unwrap_or(0.0) / drop).max(0.0).sqrt();
            if share > restitution + 0.003 || share < restitution - 0.015 {
                failures.push(format!("e {restitution}, drop {drop:.3} m: {share:.4}"));
            }
        }
    }
    conclude(tried, &failures);
}

/// A corridor of a metre, a ball of 1.01 m.
#[test]
fn a_clamped_ball_comes_to_rest_and_falls_asleep() {
    for restitution in [fx!(0), fx!(0.3), fx!(0.5), fx!(0.9)] {
        for speed in [1, 5, 20] {
            let wall = |y: i32| of_material(fixed(rectangle(fx!(20), fx!(2)), vec2(0, y)), fx!(0), fx!(0));
            let ball = BodyDef { velocity: vec2(0, speed), ..dynamic(disc(fx!(0.505)), vec2(0, fx!(0.5))) };
            let ball = of_material(ball, fx!(0), restitution);
            let def = WorldDef { sleep_after: Some(30), ..floating() };
            let (mut world, ids) = build(def, [wall(-1), wall(2), ball]);
            let name = format!("e {restitution}, {speed} m/s");
            steps(&mut world, 60);
            assert!(velocity(&world, ids[2])[1].abs() < 0.05, "{name}: {:?}", velocity(&world, ids[2]));
            steps(&mut world, 240);
            let body = world.body(ids[2]).expect("a body");
            assert_eq!(body.activity(), umbra_physics::Activity::Asleep, "{name}");
            assert!((float(body.position().y) - 0.5).abs() < 0.006, "{name}");
        }
    }
}

/// A press comes down on a ball, stops where it holds the ball a centimetre too tight, and lets it go.
#[test]
fn a_ball_under_a_press_rests_and_does_not_jump_off() {
    let mut failures = Vec::new();
    let mut tried = 0;
    for restitution in [fx!(0), fx!(0.3), fx!(0.6), fx!(0.9)] {
        for phase in 0..14 {
            tried += 1;
            let start = 1.6 + f64::from(phase) / 200.0;
            let press = kinematic(rectangle(fx!(4), fx!(1)), point(0.0, start + 0.5));
            let ball = of_material(dynamic(disc(fx!(0.5)), vec2(0, fx!(0.5))), fx!(0.6), restitution);
            let (mut world, ids) = build(falling(), [floor(), press, ball]);
            let mut fastest = 0.0f64;
            for tick in 0..180 {
                let bottom = f64::max(0.99, start - f64::from(tick + 1) / 60.0);
                world.move_to(ids[1], point(0.0, bottom + 0.5), fx!(0)).expect("a way");
                world.step();
                if tick > 120 {
                    fastest = fastest.max(length(velocity(&world, ids[2])));
                }
            }
            let mut highest = 0.0f64;
            for tick in 0..60 {
                world.move_to(ids[1], point(0.0, 1.49 + f64::from(tick + 1) / 30.0), fx!(0)).expect("a way");
                world.step();
                highest = highest.max(position(&world, ids[2])[1]);
            }
            if fastest > 0.05 || highest > 0.52 {
                failures.push(format!("e {restitution}, phase {phase}: {fastest:.3} m/s, up to {highest:.3} m"));
            }
        }
    }
    conclude(tried, &failures);
}

/// The crates of a stack: at 0, 0 and 0.3, and one that is dropped at 0.55 from this height.
fn overhang(rate: u32, drop: f64) -> (World, BodyId) {
    let square = rectangle(fx!(1), fx!(1));
    let places = [(0.0, 0.5), (0.0, 1.5), (0.3, 2.5)];
    let crates = places.map(|(x, y)| dynamic(square.clone(), point(x, y)));
    let def = WorldDef { time_step: TimeStep::hz(rate), sleep_after: Some(30), ..falling() };
    let (mut world, _) = build(def, [floor()].into_iter().chain(crates));
    steps(&mut world, rate);
    let last = world.add_body(dynamic(square, point(0.55, 3.5 + drop))).expect("a body");
    (world, last)
}

#[test]
fn a_crate_that_lands_on_an_overhang_does_not_tip_the_stack() {
    let mut failures = Vec::new();
    let drops: Vec<f64> = (1..=20).map(|i| f64::from(i) * 0.025).collect();
    for rate in [60, 240] {
        for &drop in &drops {
            let (mut world, last) = overhang(rate, drop);
            let mut tilt = 0.0f64;
            for _ in 0..3 * rate {
                world.step();
                tilt = tilt.max(angle(&world, last).abs());
            }
            let height = position(&world, last)[1];
            if tilt > 0.1 || (height - 3.5).abs() > 0.03 {
                failures.push(format!("{rate} Hz, drop {drop} m: tilt {tilt:.3}, height {height:.3}"));
            }
        }
    }
    conclude(2 * drops.len(), &failures);
}

/// The plastic impact on the overhang, worked out exactly: both crates get a spin of 0.055 rad/s.
#[test]
fn an_impact_on_an_overhang_turns_the_crates_by_little() {
    for phase in 0..12 {
        let square = rectangle(fx!(1), fx!(1));
        let base = fixed(square.clone(), vec2(0, fx!(0.5)));
        let (mut world, ids) = build(falling(), [base, dynamic(square.clone(), vec2(fx!(0.3), fx!(1.5)))]);
        steps(&mut world, 60);
        let drop = 0.5 - f64::from(phase) * 0.004;
        let last = world.add_body(dynamic(square, point(0.55, 2.5 + drop))).expect("a body");
        while world.contacts_of(last).expect("a body").next().is_none() {
            world.step();
        }
        for id in [ids[1], last] {
            let spin = spin(&world, id).abs();
            assert!(spin <= 0.1, "drop {drop}: {spin}");
        }
        steps(&mut world, 120);
        assert!(angle(&world, last).abs() < 0.02 && position(&world, last)[1] > 2.48, "drop {drop}");
    }
}

/// Disc on disc, off the middle: the normal is that of the moment at which they meet.
#[test]
fn a_glancing_hit_takes_the_normal_of_the_moment_of_contact() {
    let (mut failures, mut tried) = (Vec::new(), 0);
    for seed in seeds(100) {
        let random = &mut random("glancing", seed);
        let radii = [(); 2].map(|()| between(random, 0.1, 0.8));
        let reach = radii[0] + radii[1];
        let offset = between(random, -0.9, 0.9) * reach;
        let speed = of_any_size(random, 2.0, 200.0);
        let restitution = [1.0, 0.7, 0.3, 0.0][random.below(4) as usize];
        let is_static = random.below(3) == 0;
        let partner = of_material(dynamic(disc(number(radii[1])), vec2(0, 0)), fx!(0), number(restitution));
        let partner = BodyDef { kind: if is_static { BodyKind::Static } else { BodyKind::Dynamic }, ..partner };
        let way = 0.01 * between(random, 0.0, 628.0);
        let (sin, cos) = way.sin_cos();
        // Up to 20 steps before they meet, at any moment of a step.
        let distance = reach + speed * between(random, 0.02, 0.3);
        let body = BodyDef {
            position: point(-distance * cos - offset * sin, -distance * sin + offset * cos),
            velocity: point(speed * cos, speed * sin),
            bullet: random.below(4) == 0,
            ..dynamic(disc(number(radii[0])), vec2(0, 0))
        };
        let body = of_material(body, fx!(0), number(restitution));
        let (mut world, ids) = build(bouncing(floating()), [partner, body]);
        steps(&mut world, (60.0 * distance / speed) as u32 + 2);
        let masses = radii.map(|radius| radius * radius);
        let [after, rebound] = glanced([cos, sin], [speed, offset / reach], restitution, masses, is_static);
        tried += 1;
        let off = length([velocity(&world, ids[1])[0] - after[0], velocity(&world, ids[1])[1] - after[1]])
            + length([velocity(&world, ids[0])[0] - rebound[0], velocity(&world, ids[0])[1] - rebound[1]]);
        if off > 0.01 * speed {
            failures.push(format!(
                "seed {seed}: {speed:.1} m/s, e {restitution}, offset {:.2} of the radii, static {is_static}: off by {:.4} of the speed",
                offset / reach,
                off / speed
            ));
        }
    }
    conclude(tried, &failures);
}

/// The velocities of both discs after a hit; `hit` is the speed and the sine of the angle between the way and the normal.
fn glanced(way: [f64; 2], hit: [f64; 2], restitution: f64, masses: [f64; 2], is_static: bool) -> [[f64; 2]; 2] {
    let [speed, sine] = hit;
    let cosine = (1.0 - sine * sine).sqrt();
    // The normal from the first disc to the second.
    let normal = [way[0] * cosine + way[1] * sine, way[1] * cosine - way[0] * sine];
    let [a, b] = [1.0 / masses[0], if is_static { 0.0 } else { 1.0 / masses[1] }];
    let impulse = (1.0 + restitution) * speed * cosine / (a + b);
    [
        [speed * way[0] - impulse * a * normal[0], speed * way[1] - impulse * a * normal[1]],
        [impulse * b * normal[0], impulse * b * normal[1]],
    ]
}

/// A disc that meets the corner of a box: the normal is from the corner to its centre.
#[test]
fn a_disc_bounces_off_a_corner_along_the_line_to_its_centre() {
    let (mut failures, mut tried) = (Vec::new(), 0);
    for seed in seeds(40) {
        let random = &mut random("corners", seed);
        let radius = between(random, 0.1, 0.6);
        let speed = of_any_size(random, 2.0, 100.0);
        // It falls beside the corner at the origin, its centre to the right of it.
        let offset = between(random, 0.1, 0.9) * radius;
        let height = (radius * radius - offset * offset).sqrt() + speed * between(random, 0.02, 0.3);
        let block = of_material(fixed(rectangle(fx!(4), fx!(2)), vec2(-2, -1)), fx!(0), fx!(1));
        let ball = BodyDef { velocity: point(0.0, -speed), ..dynamic(disc(number(radius)), point(offset, height)) };
        let (mut world, ids) = build(bouncing(floating()), [block, of_material(ball, fx!(0), fx!(1))]);
        steps(&mut world, 22);
        let (sin, cos) = (offset / radius, (1.0 - (offset / radius).powi(2)).sqrt());
        let expected = [2.0 * speed * cos * sin, -speed + 2.0 * speed * cos * cos];
        tried += 1;
        let [x, y] = velocity(&world, ids[1]);
        let off = length([x - expected[0], y - expected[1]]) / speed;
        if off > 0.01 {
            failures.push(format!("seed {seed}: {speed:.1} m/s, {:.2} of the radius: off by {off:.4}", sin));
        }
    }
    conclude(tried, &failures);
}

/// A disc that hits a floor slides through the impact, or rolls from it on: Coulomb's law for the whole impulse.
#[test]
fn friction_of_an_impact_is_that_of_its_impulse() {
    let (mut failures, mut tried) = (Vec::new(), 0);
    for seed in seeds(40) {
        let random = &mut random("friction", seed);
        let (friction, restitution) = (between(random, 0.0, 1.2), [0.0, 0.5, 1.0][random.below(3) as usize]);
        let (along, down, turning) =
            (between(random, -20.0, 20.0), of_any_size(random, 2.0, 40.0), between(random, -20.0, 20.0));
        let height = 0.5 + down * between(random, 0.02, 0.3);
        let ball = BodyDef {
            velocity: point(along, -down),
            angular_velocity: number(turning),
            ..dynamic(disc(fx!(0.5)), point(0.0, height))
        };
        let [ground, ball] = [floor(), ball].map(|body| of_material(body, number(friction), number(restitution)));
        let (mut world, ids) = build(floating(), [ground, ball]);
        steps(&mut world, 20);
        // The slip at the bottom; a disc rolls when the impulse has taken a third of it.
        let slip = along + turning / 2.0;
        let impulse = f64::min(friction * (1.0 + restitution) * down, slip.abs() / 3.0) * -slip.signum();
        let expected = [along + impulse, restitution * down, turning + 4.0 * impulse];
        let [x, y] = velocity(&world, ids[1]);
        let off = [x - expected[0], y - expected[1], spin(&world, ids[1]) - expected[2]].map(f64::abs);
        tried += 1;
        if off[0] > 0.01 || off[1] > 0.01 || off[2] > 0.04 {
            failures.push(format!(
                "seed {seed}: μ {friction:.2}, e {restitution}, slip {slip:.2}, down {down:.2} m/s: off by {off:.4?}"
            ));
        }
    }
    conclude(tried, &failures);
}

#[test]
fn a_ball_rises_to_the_share_of_its_height_at_each_bounce() {
    for (rate, restitution) in [(60, 0.9), (30, 0.9), (240, 0.9), (60, 0.5), (60, 1.0)] {
        let def = WorldDef { time_step: TimeStep::hz(rate), ..falling() };
        let ball = of_material(dynamic(disc(fx!(0.5)), point(0.0, 10.5)), fx!(0.6), number(restitution));
        let (mut world, ids) = build(def, [floor(), ball]);
        let mut bounces = 0;
        let mut before = -1.0;
        for _ in 0..40 * rate {
            world.step();
            let speed = velocity(&world, ids[1])[1];
            if before < 0.0 && speed > 0.0 {
                bounces += 1;
                let expected = 10.0 * f64::powi(restitution, 2 * bounces);
                let apex = position(&world, ids[1])[1] - 0.5 + speed * speed / 20.0;
                let off = apex / expected - 1.0;
                assert!(off.abs() < 2e-5, "{rate} Hz, e {restitution}, bounce {bounces}: {apex} for {expected}");
            }
            before = speed;
            if bounces == if restitution < 0.6 { 3 } else { 10 } {
                break;
            }
        }
        assert!(bounces >= 3, "{rate} Hz, e {restitution}: {bounces} bounces");
    }
}

/// A stack on a floor does not fall while it is struck: gravity acts on the ball alone up to the moment of the impact.
#[test]
fn a_ball_bounces_off_bodies_at_rest_as_off_the_floor() {
    let mut failures = Vec::new();
    let mut tried = 0;
    for (height, mass, restitution, speed) in [
        (1, 1.0, 1.0, 4.0),
        (1, 0.02, 1.0, 4.0),
        (1, 20.0, 1.0, 4.0),
        (1, 1.0, 0.8, 2.0),
        (1, 1.0, 0.5, 20.0),
        (2, 1.0, 1.0, 4.0),
        (3, 0.02, 1.0, 4.0),
        (3, 1.0, 0.8, 2.0),
        (3, 20.0, 1.0, 10.0),
    ] {
        // Along one axis, and along both.
        for (gravity, across) in [(vec2(0, -10), [1.0, 0.0]), (vec2(6, -8), [0.8, 0.6])] {
            for (rate, phase) in [(60, 0), (60, 1), (60, 2), (60, 3), (60, 4), (60, 5), (60, 6), (30, 3), (240, 3)] {
                let [x, y] = across;
                let place = |up: f64| point(-y * up, x * up);
                let turned = |body: BodyDef| {
                    of_material(BodyDef { angle: number(y.atan2(x)), ..body }, fx!(0.6), number(restitution))
                };
                let mut bodies = vec![turned(fixed(rectangle(fx!(20), fx!(2)), place(-1.0)))];
                bodies
                    .extend((0..height).map(|i| turned(dynamic(rectangle(fx!(1), fx!(1)), place(f64::from(i) + 0.5)))));
                let def = WorldDef { time_step: TimeStep::hz(rate), gravity, ..falling() };
                let (mut world, _) = build(def, bodies);
                steps(&mut world, rate);
                let top = f64::from(height) + 0.25;
                // It arrives at another part of a sub-step in each phase.
                let start = top + (2.3 + f64::from(phase) / 7.0) * speed / f64::from(rate);
                let density = number(mass / 0.19635);
                let ball = dynamic(ColliderDef { density, ..ColliderDef::new(disc(fx!(0.25))) }, place(start));
                let ball = BodyDef { velocity: place(-speed), ..turned(ball) };
                let ball = world.add_body(ball).expect("a ball");
                steps(&mut world, 6);
                let ([px, py], [vx, vy]) = (position(&world, ball), velocity(&world, ball));
                let (up, back) = (x * py - y * px - top, x * vy - y * vx);
                // Half of the square of the speed at the surface, before and after.
                let [before, after] = [speed * speed / 2.0 + 10.0 * (start - top), back * back / 2.0 + 10.0 * up];
                let share = (after / before).sqrt();
                tried += 1;
                if back <= 0.0 || (share / restitution - 1.0).abs() > 2e-3 {
                    failures.push(format!(
                        "{height} boxes, {mass} kg, e {restitution}, {speed} m/s, {rate} Hz, phase {phase}, {gravity}: {share:.5}"
                    ));
                }
            }
        }
    }
    conclude(tried, &failures);
}

/// With a `restitution_speed` of 0 the least impact bounces; gravity ends that all the same.
#[test]
fn a_pile_that_always_bounces_comes_to_rest() {
    let random = &mut Random::seeded(11);
    let mut bodies =
        vec![floor(), fixed(rectangle(fx!(1), fx!(20)), vec2(-4, 10)), fixed(rectangle(fx!(1), fx!(20)), vec2(4, 10))];
    for i in 0..48 {
        let size = number(between(random, 0.3, 0.45));
        let shape = if i % 2 == 0 { disc(size) } else { rectangle(size * 2, size * 2) };
        bodies.push(dynamic(shape, vec2(i % 6 - 3, fx!(1) + Fx::from(i / 6) * fx!(1.1)) + vec2(fx!(0.5), 0)));
    }
    let bodies = bodies.into_iter().map(|body| of_material(body, fx!(0.5), fx!(0.5)));
    let def = WorldDef { sleep_after: Some(30), ..bouncing(falling()) };
    let (mut world, ids) = build(def, bodies);
    let bound = energy(&world) + allowance(&world);
    for tick in 0..1_200 {
        world.step();
        assert!(energy(&world) <= bound, "tick {tick}: {} for {bound}", energy(&world));
    }
    let fastest = ids.iter().map(|&id| length(velocity(&world, id))).fold(0.0, f64::max);
    let awake = world.moving_count();
    assert!(fastest < 0.05 && awake == 0, "{fastest} m/s, {awake} awake");
}
