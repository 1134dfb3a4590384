//! Joints in scenes.

use std::f64::consts::TAU;

use umbra_physics::scalar::ToF64;
use umbra_physics::{
    Activity, BodyKind, BodyRef, Distance, Fx, JointDef, JointKind, JointMotor, JointRef, JointSpring, PlanarMotor,
    PlanarSpring, Revolute, Scalar, World, fx, vec2,
};
use umbra_scene::{Scene, SceneRun};

use crate::cases::is_short;
use crate::errors::{lines, told_alone};
use crate::scenes::{JOINTED, scenes, short};

fn advance(run: &mut SceneRun<'_, Fx>, tick: u64) {
    while run.tick() < tick {
        let faults = run.advance().expect("its inputs are accepted").faults.to_vec();
        assert!(faults.is_empty(), "tick {}: {faults:?}", run.tick());
    }
}

/// The joint of this name.
fn joint<'a>(run: &'a SceneRun<'_, Fx>, name: &str) -> Option<JointRef<'a>> {
    let labels = run.labels();
    run.world().joints().find(|joint| labels.joint(joint.id()) == Some(name))
}

/// The definition of the joint of this name.
fn def(run: &SceneRun<'_, Fx>, name: &str) -> Option<JointDef> {
    joint(run, name).map(|joint| *joint.def())
}

/// The body of this name.
fn body<'a>(run: &'a SceneRun<'_, Fx>, name: &str) -> BodyRef<'a> {
    run.world().bodies().find(|body| run.name(body.id()) == name).expect("it is there")
}

#[test]
fn inputs_change_joints_at_their_ticks() {
    let scene = Scene::parse(JOINTED).expect("it is one");
    assert_eq!((scene.starting_joints, scene.joints.len()), (6, 7));
    let mut run = scene.start::<Fx>().expect("it starts");
    let revolute = |run: &SceneRun<'_, Fx>, name| match def(run, name).expect("it is there").kind {
        JointKind::Revolute(revolute) => revolute,
        other => panic!("{other:?}"),
    };
    advance(&mut run, 1);
    assert_eq!(revolute(&run, "hinge").motor, Some(JointMotor { speed: fx!(2), max_force: fx!(20) }));
    advance(&mut run, 2);
    assert_eq!(revolute(&run, "hinge").motor, None);
    advance(&mut run, 3);
    let brake = JointMotor { speed: fx!(0), max_force: fx!(3) };
    assert_eq!((revolute(&run, "hinge").motor, revolute(&run, "hinge").spring), (Some(brake), None));
    assert_eq!(def(&run, "hinge").expect("it is there").break_force, Some(fx!(100)));
    assert!(def(&run, "soft").expect("it is there").enabled);
    advance(&mut run, 4);
    assert!(!def(&run, "soft").expect("it is there").enabled);
    advance(&mut run, 7);
    let soft = def(&run, "soft").expect("it is there");
    assert_eq!((soft.enabled, soft.kind), (true, JointKind::Distance(Distance::rod(fx!(0.5)))));
    assert!(def(&run, "rod").is_some() && def(&run, "late").is_none());
    advance(&mut run, 20);
    assert!(def(&run, "rod").is_none() && def(&run, "late").is_some());
    assert_eq!(run.world().joint_count(), 6);
}

#[test]
fn points_of_the_world_are_those_that_programs_give() {
    let scene = Scene::parse(JOINTED).expect("it is one");
    let world: World = scene.build().expect("it starts");
    let bodies: Vec<_> = world.bodies().map(|body| body.id()).collect();
    let [post, link, .., wheel] = bodies[..] else { unreachable!() };
    let joints: Vec<JointDef> = world.joints().map(|joint| *joint.def()).collect();
    let hinge = JointDef::at(&world, post, link, vec2(fx!(-0.5), 0)).expect("near them");
    assert_eq!((joints[0].ends, joints[0].angles), (hinge.ends, hinge.angles));
    let rod = JointDef::between(&world, None, vec2(0, -2), wheel, vec2(fx!(0.25), -5)).expect("near it");
    assert!(joints.contains(&JointDef {
        break_force: Some(fx!(5000)),
        break_torque: Some(fx!(70)),
        events: true,
        ..rod
    }));
    let tilted = r#"{"bodies": [{"name": "a", "angle": 2}, {"name": "b", "angle": -0.5, "position": [3, 1]}],
        "joints": [{"bodies": ["a", "b"], "point": [1, 2], "weld": {}}]}"#;
    let world: World = Scene::parse(tilted).expect("a scene").build().expect("it starts");
    let [a, b] = world.bodies().map(|body| body.id()).collect::<Vec<_>>()[..] else { unreachable!() };
    let weld = JointDef::at(&world, a, b, vec2(1, 2)).expect("near them");
    let joint = world.joints().next().expect("it is there");
    assert_eq!((joint.def().ends, joint.def().angles, joint.angle()), (weld.ends, weld.angles, fx!(0)));
}

#[test]
fn every_mistake_in_a_joint_is_told_at_its_field() {
    let joint = |rest: &str| format!("{{\"ends\": [[0, 0], [1, 0]], {rest}}}");
    let revolute = |rest: &str| joint(&format!("\"revolute\": {{{rest}}}"));
    let joints = [
        joint(r#""name": "a""#),
        joint(r#""weld": {}, "revolute": {}"#),
        joint(r#""weld": {}"#),
        joint(r#""weld": {}, "angles": [1]"#),
        joint(r#""weld": {}, "colide_connected": true"#),
        joint(r#""weld": {}, "break_force": -1"#),
        joint(r#""weld": {}, "break_torque": -1"#),
        joint(r#""weld": {}, "bodies": [null, null]"#),
        joint(r#""distance": {}"#),
        joint(r#""distance": {"length": 0}"#),
        joint(r#""distance": {"length": 1, "limits": [0, 1]}"#),
        joint(r#""distance": {"limits": [-1, 1]}"#),
        joint(r#""distance": {"limits": [0, 0]}"#),
        joint(r#""distance": {"spring": {"hertz": 1, "rest": -1}}"#),
        joint(r#""prismatic": {"limits": [0, 2000000]}"#),
        joint(r#""prismatic": {"motor": {"speed": -2000000, "max_force": 1}}"#),
        joint(r#""prismatic": {"friction": -1}"#),
        joint(r#""wheel": {"spring": {"hertz": 1, "rest": 2000000}}"#),
        joint(r#""wheel": {"springs": 1}"#),
        joint(r#""wheel": {}, "axis": [0, 1]"#),
        joint(r#""motor": {"spring": {"hertz": 1, "rest": [0, 2000000]}}"#),
        joint(r#""motor": {"spring": {"hertz": -1}}"#),
        joint(r#""motor": {"motor": {"velocity": [2000000, 0], "max_force": 1}}"#),
        joint(r#""motor": {"motor": {"velocity": [0, 0]}}"#),
        joint(r#""gear": {}"#),
        joint(r#""gear": {"teeth": [0, 1]}"#),
        joint(r#""gear": {"teeth": [1.5, 1]}"#),
        joint(r#""pulley": {"length": 1}"#),
        joint(r#""pulley": {"grounds": [[0, 1], [2, 1]]}"#),
        joint(r#""pulley": {"grounds": [[0, 1], [2, 1]], "length": 1, "strands": [0, 1]}"#),
        joint(r#""pulley": {"grounds": [[0, 1], [2, 1]], "length": 1, "strands": [1, 300]}"#),
        joint(r#""pulley": {"grounds": [[0, 1], [2, 1]], "length": 0}"#),
        joint(r#""pulley": {"grounds": [[0, 1]], "length": 1}"#),
        revolute(r#""ratchet": 0"#),
        revolute(r#""ratchet": 2000"#),
        revolute(r#""ratchet": 1.5"#),
        revolute(r#""limits": [1]"#),
        revolute(r#""limits": [1, -1]"#),
        revolute(r#""limits": [-1, 200000]"#),
        revolute(r#""friction": -1"#),
        revolute(r#""motor": {"speed": 1}"#),
        revolute(r#""motor": {"speed": 2000000, "max_force": 1}"#),
        revolute(r#""motor": {"max_force": -1}"#),
        revolute(r#""motor": 3"#),
        revolute(r#""spring": {}"#),
        revolute(r#""spring": {"frequency": 1}"#),
        revolute(r#""spring": {"hertz": -1}"#),
        revolute(r#""spring": {"hertz": 1, "damping_ratio": 2000}"#),
        revolute(r#""spring": {"hertz": 1, "rest": -200000}"#),
        revolute(r#""spring": {"hertz": 1, "max_force": -1}"#),
    ];
    let told = told_alone("joints", &joints);
    let expected = [
        ": one of the fields revolute, weld, distance, prismatic, wheel, motor, gear, pulley is missing [E505]",
        ".weld: `revolute` is given already: give only one of the two [E500]",
        ".ends: neither end of the joint is on a dynamic body: a joint needs a body that it can move [E148]",
        ".angles: expected a list of 2 values, found 1 [E502]",
        ".colide_connected: unknown field: did you mean `collide_connected`? [E503]",
        ".break_force: out of range: expected a force or a torque of at least zero at which a joint breaks [E101]",
        ".break_torque: out of range: expected a force or a torque of at least zero at which a joint breaks [E101]",
        ".ends: `bodies` is given already: give only one of the two [E500]",
        ".distance: the field `length` is missing [E505]",
        ".distance.length: out of range: expected a length of a joint within ±2^20 m, of a rod or a rope from 2^-7 m [E101]",
        ".distance.length: unknown field; there are limits, motor, spring, friction [E503]",
        ".distance.limits: out of range: expected a length of a joint within ±2^20 m, of a rod or a rope from 2^-7 m [E101]",
        ".distance.limits: out of range: expected a length of a joint within ±2^20 m, of a rod or a rope from 2^-7 m [E101]",
        ".distance.spring: out of range: expected a length of a joint within ±2^20 m, of a rod or a rope from 2^-7 m [E101]",
        ".prismatic.limits: out of range: expected a length of a joint within ±2^20 m, of a rod or a rope from 2^-7 m [E101]",
        ".prismatic.motor.speed: out of range: expected a speed of a joint's motor within ±2^20 rad/s or m/s [E101]",
        ".prismatic.friction: out of range: expected a force or torque in a joint of at least zero [E101]",
        ".wheel.spring.rest: out of range: expected a length of a joint within ±2^20 m, of a rod or a rope from 2^-7 m [E101]",
        ".wheel.springs: unknown field: did you mean `spring`? [E503]",
        ".axis: unknown field; there are repeat, name, collide_connected, enabled, events, break_force, break_torque, key, user_data, bodies, ends, angles, revolute, weld, distance, prismatic, wheel, motor, gear, pulley [E503]",
        ".motor.spring.rest: out of range: expected a length of a joint within ±2^20 m, of a rod or a rope from 2^-7 m [E101]",
        ".motor.spring.hertz: out of range: expected a frequency of a joint's spring from 0 to 10^6 Hz [E101]",
        ".motor.motor.velocity: out of range: expected a speed of a joint's motor within ±2^20 rad/s or m/s [E101]",
        ".motor.motor: the field `max_force` is missing [E505]",
        ".gear: the field `teeth` is missing [E505]",
        ".gear.teeth: out of range: expected whole numbers of teeth from 1 to 1,024 or negative [E101]",
        ".gear.teeth: out of range: expected whole numbers of teeth from 1 to 1,024 or negative [E101]",
        ".pulley: the field `grounds` is missing [E505]",
        ".pulley: the field `length` is missing [E505]",
        ".pulley.strands: out of range: expected whole numbers of strands from 1 to 64 [E101]",
        ".pulley.strands[1]: out of range: expected a whole number that fits in 8 bits [E508]",
        ".pulley.length: out of range: expected a length of a joint within ±2^20 m, of a rod or a rope from 2^-7 m [E101]",
        ".pulley.grounds: expected a list of 2 values, found 1 [E502]",
        ".revolute.ratchet: out of range: expected whole numbers of teeth from 1 to 1,024 or negative [E101]",
        ".revolute.ratchet: out of range: expected whole numbers of teeth from 1 to 1,024 or negative [E101]",
        ".revolute.ratchet: out of range: expected whole numbers of teeth from 1 to 1,024 or negative [E101]",
        ".revolute.limits: expected a list of 2 values, found 1 [E502]",
        ".revolute.limits: out of range: expected limits of a joint of which the upper one is not below the lower one [E101]",
        ".revolute.limits: out of range: expected an angle of a joint within ±2^17 rad [E101]",
        ".revolute.friction: out of range: expected a force or torque in a joint of at least zero [E101]",
        ".revolute.motor: the field `max_force` is missing [E505]",
        ".revolute.motor.speed: out of range: expected a speed of a joint's motor within ±2^20 rad/s or m/s [E101]",
        ".revolute.motor.max_force: out of range: expected a force or torque in a joint of at least zero [E101]",
        ".revolute.motor: expected an object, found a number [E502]",
        ".revolute.spring: the field `hertz` is missing [E505]",
        ".revolute.spring.frequency: unknown field: did you mean `hertz`? [E503]",
        ".revolute.spring.hertz: out of range: expected a frequency of a joint's spring from 0 to 10^6 Hz [E101]",
        ".revolute.spring.damping_ratio: out of range: expected a damping ratio of a joint's spring from 0 to 1024 [E101]",
        ".revolute.spring.rest: out of range: expected an angle of a joint within ±2^17 rad [E101]",
        ".revolute.spring.max_force: out of range: expected a force or torque in a joint of at least zero [E101]",
    ];
    assert_eq!(told, expected.map(|told| format!("2: joints[0]{told}")), "{told:#?}");
}

#[test]
fn every_mistake_in_the_ends_of_a_joint_is_told_at_its_field() {
    let text = r#"{"bodies": [{"name": "a"}, {"name": "b", "mass": 0}],
"joints": [
  {"bodies": ["a", "c"], "point": [0, 0], "weld": {}},
  {"bodies": ["a", "a"], "point": [0, 0], "weld": {}},
  {"bodies": ["a", null], "point": [5000, 0], "weld": {}},
  {"bodies": ["a", null], "points": [[0, 0], [1, 0]], "weld": {}},
  {"bodies": ["a", null], "points": [[0, 0], [0, 0]], "distance": {}},
  {"bodies": ["a", 3], "point": [0, 0], "weld": {}},
  {"bodies": ["a", "b"], "point": [0, 0], "weld": {}},
  {"name": "hinge", "ends": ["a", [2000000000, 0]], "weld": {}},
  {"name": "hinge", "ends": ["a", [0, 0]], "weld": {}},
  {"name": "hinge", "ends": ["a", [0, 0]], "weld": {}}],
"inputs": [
  {"at": 1, "joint": "hing", "do": "remove"},
  {"at": 1, "joint": "hinge", "do": "wake"},
  {"at": 1, "joint": "hinge", "set": {"kind": {"distance": {}}}},
  {"at": 1, "joint": "hinge", "set": {"motor": {"max_force": -1}}},
  {"at": 1, "add_joint": {"bodies": ["a", null], "point": [0, 0], "weld": {}}},
  {"from": 1, "to": 2, "add_joint": {"ends": ["a", [0, 0]], "weld": {}}}]}"#;
    let told = lines(text);
    let expected = [
        "1: bodies[1].mass: out of range: expected a mass from 2^-16 to 2^24 kg, not 0 [E101]",
        "3: joints[0].bodies[1]: there is no body \"c\" [E507]",
        "4: joints[1].bodies: both ends of the joint are on the same body [E112]",
        "5: joints[2].point: out of range: expected a point of a joint within ±2^12 m of its body's centre of mass, a component [E101]",
        "6: joints[3].points: unknown field: did you mean `point`? [E503]",
        "7: joints[4].points: out of range: expected a length of a joint within ±2^20 m, of a rod or a rope from 2^-7 m [E101]",
        "8: joints[5].bodies[1]: expected the name of a body, or null for the world, found a number [E502]",
        "10: joints[7].ends: out of range: expected a position within ±2^30 m [E101]",
        "11: joints[8].name: there is a joint \"hinge\" already: choose another name [E506]",
        "12: joints[9].name: there is a joint \"hinge\" already: choose another name [E506]",
        "14: inputs[0].joint: there is no joint \"hing\": did you mean \"hinge\"? [E507]",
        "15: inputs[1].do: expected one of remove, disable, enable, found \"wake\" [E502]",
        "16: inputs[2].set.kind.distance: the field `length` is missing [E505]",
        "17: inputs[3].set.motor.max_force: out of range: expected a force or torque in a joint of at least zero [E101]",
        "18: inputs[4].add_joint.bodies: points of the world are found on bodies at the start alone: give `ends` [E500]",
        "19: inputs[5].add_joint: out of range: a body, field, joint or collider with a name is added once: give `at` with one tick [E508]",
    ];
    assert_eq!(told, expected, "{told:#?}");
    let motor = r#"{"bodies": [{"name": "a"}], "joints": [{"name": "w", "ends": ["a", [0, 0]], "weld": {}}],
"inputs": [{"at": 1, "joint": "w", "set": {"motor": {"max_force": 1}}},
  {"at": 2, "joint": "w", "do": "remove"}, {"at": 3, "joint": "w", "do": "enable"}]}"#;
    let expected = [
        "2: inputs[0].set.motor: at tick 1: the joint is of a kind that has no motor [E214]",
        "3: inputs[2].do: at tick 3: the joint does not exist at that tick [E147]",
    ];
    assert_eq!(lines(motor), expected);
}

/// A scene with a wheel, a slider, a rope and springs.
pub(crate) const SLIDING: &str = r#"{"gravity": [0, -10], "bodies": [
        {"name": "car", "position": [0, 1], "angle": 0.5, "mass": 10, "inertia": 4},
        {"name": "wheel", "position": [1, 0], "mass": 1, "inertia": 1},
        {"name": "cabin", "position": [5, 0], "mass": 2, "inertia": 1}, {"name": "load", "position": [7, 3]},
        {"name": "yard", "kind": "static", "position": [30, 0], "colliders": [{"shape": {"concave_polygon": [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]}},
          {"shape": {"hull": [[4, 0], [6, 0], [5, 0.5], [4, 1]]}}]}],
      "joints": [
        {"name": "axle", "bodies": ["car", "wheel"], "point": [1, 0], "axis": [0, 1],
          "wheel": {"limits": [-0.2, 0.3], "spring": {"hertz": 4, "damping_ratio": 0.7}, "motor": {"speed": -5, "max_force": 9}, "friction": 0.1}},
        {"name": "lift", "bodies": [null, "cabin"], "point": [5, 0], "axis": {"length": 1, "angle": 1.5}, "prismatic": {"friction": 40}},
        {"bodies": ["cabin", "load"], "points": [[5, 0], [8, 4]], "distance": {"limits": [0, 6]}},
        {"bodies": ["car", "load"], "points": [[0, 1], [7, 3]], "distance": {"spring": {"hertz": 2}}},
        {"ends": ["cabin", "load"], "distance": {"limits": [1, 4], "spring": {"hertz": 2, "rest": 0}, "friction": 1}},
        {"ends": [[0, 0], "load"], "motor": {"spring": {"hertz": 2, "rest": [7, 4], "max_force": 9}, "motor": {"velocity": [1, 0], "max_force": 2},
          "angular_spring": {"hertz": 1, "rest": 0.5}, "angular_motor": {"max_force": 1}}},
        {"bodies": ["car", "wheel"], "gear": {"teeth": [12, -36]}},
        {"bodies": ["car", "load"], "points": [[0, 1], [7, 3]], "pulley": {"grounds": [[0, 5], [7, 6]], "strands": [2, 1]}}],
      "inputs": [{"at": 10, "joint": "lift", "set": {"motor": {"speed": 1, "max_force": 100}}},
        {"at": 12, "joint": "axle", "set": {"motor": null}}]}"#;

/// Sliders, wheels and ropes are written as they are read, stand where they are told, and have their motors set by inputs.
#[test]
fn sliders_wheels_ropes_and_motors_are_read() {
    let scene = Scene::parse(SLIDING).expect("it is one");
    assert_eq!(Scene::parse(&scene.to_json()).expect("its own text").joints.len(), 8);
    let world: World = scene.build().expect("it starts");
    let [car, wheel, _, load, _] = world.bodies().map(|body| body.id()).collect::<Vec<_>>()[..] else { unreachable!() };
    let joints: Vec<JointDef> = world.joints().map(|joint| *joint.def()).collect();
    let axle = JointDef::along(&world, car, wheel, vec2(1, 0), vec2(0, 1)).expect("near them");
    assert_eq!((joints[0].ends, joints[0].angles), (axle.ends, axle.angles));
    // A spring rests as long as its points are apart.
    let between = JointDef::between(&world, car, vec2(0, 1), load, vec2(7, 3)).expect("near them");
    let (JointKind::Distance(spring), JointKind::Distance(rod)) = (joints[3].kind, between.kind) else {
        unreachable!()
    };
    let length = rod.limits.map(|limits| limits.upper);
    assert_eq!((spring.limits, spring.spring.map(|spring| spring.rest)), (None, length));
    let JointKind::Motor(pull) = joints[5].kind else { unreachable!() };
    let spring = PlanarSpring { max_force: Some(fx!(9)), ..PlanarSpring::new(vec2(7, 4), fx!(2), fx!(1)) };
    assert_eq!(
        (pull.spring, pull.motor),
        (Some(spring), Some(PlanarMotor { velocity: vec2(1, 0), max_force: fx!(2) }))
    );
    let angular_spring = JointSpring { rest: fx!(0.5), ..JointSpring::new(fx!(1), fx!(1)) };
    assert_eq!(pull.angular_spring, Some(angular_spring));
    assert_eq!(pull.angular_motor, Some(JointMotor { speed: fx!(0), max_force: fx!(1) }));
    // The teeth fit as the bodies stand.
    let gear = JointDef::gear(&world, car, wheel, [12, -36]).expect("two bodies");
    assert_eq!((joints[6].kind, joints[6].ends, joints[6].angles), (gear.kind, gear.ends, gear.angles));
    let grounds = [vec2(0, 5), vec2(7, 6)];
    let pulley = JointDef::pulley(&world, [car, load], [vec2(0, 1), vec2(7, 3)], grounds, [2, 1]).expect("near them");
    assert_eq!(joints[7], pulley);
    let mut run = scene.start::<Fx>().expect("it starts");
    advance(&mut run, 20);
    let motor = |name: &str| match def(&run, name).expect("it is there").kind {
        JointKind::Wheel(wheel) => wheel.motor,
        JointKind::Prismatic(prismatic) => prismatic.motor,
        other => panic!("{other:?}"),
    };
    assert_eq!(motor("axle"), None);
    assert_eq!(motor("lift"), Some(JointMotor { speed: fx!(1), max_force: fx!(100) }));
    let again = Scene::parse(&scene.to_json()).expect("its own text");
    let [first, second] = [&scene, &again].map(|scene| {
        let mut run = scene.start::<Fx>().expect("it starts");
        advance(&mut run, 60);
        run.world().state_hash()
    });
    assert_eq!(first, second);
}

/// The distance of a joint from what it keeps, m: between its ends, beyond the length of a rope, or beside an axis.
fn gap<S: Scalar + ToF64>(joint: &JointRef<'_, S>) -> f64 {
    let length = joint.length().to_f64();
    match joint.def().kind {
        JointKind::Revolute(_) | JointKind::Weld(_) => length,
        JointKind::Distance(distance) => length - distance.limits.map_or(f64::INFINITY, |limits| limits.upper.to_f64()),
        JointKind::Pulley(pulley) => length - pulley.length.to_f64(),
        JointKind::Motor(_) | JointKind::Gear(_) => 0.0,
        // Sliders and wheels.
        _ => (length * length - joint.translation().to_f64().powi(2)).max(0.0).sqrt(),
    }
}

/// The farthest that a body of a scene in doubles is from its place and angle in fixed point, m and rad, up to a tick.
fn apart(scene: &Scene, tick: u64) -> f64 {
    let (mut fixed, mut float) = (scene.start::<Fx>().expect("it starts"), scene.start::<f64>().expect("it starts"));
    let mut far = 0.0_f64;
    for _ in 0..tick {
        fixed.advance().expect("its inputs are accepted");
        float.advance().expect("its inputs are accepted");
        for (a, b) in fixed.world().bodies().zip(float.world().bodies()) {
            let [from, to] = [a.position().to_f64(), b.position().to_f64()];
            let turn = (a.angle_exact().to_f64() - b.angle_exact().to_f64()).rem_euclid(TAU);
            far = far.max((from[0] - to[0]).hypot(from[1] - to[1])).max(turn.min(TAU - turn));
        }
    }
    far
}

/// Runs a scene in doubles, by day for a part of its ticks; the widest gap of a joint on the way that is not broken, m.
fn widest_in_doubles(scene: &Scene) -> f64 {
    let mut run = scene.start::<f64>().expect("it starts");
    let mut widest = 0.0_f64;
    for tick in 1..=if is_short() { short(scene) } else { scene.ticks } {
        let faults = run.advance().expect("its inputs are accepted").faults.len();
        assert_eq!(faults, 0, "tick {tick}");
        assert!(run.world().bodies().all(|body| body.position().to_f64().iter().all(|part| part.is_finite())));
        widest = run.world().joints().filter(JointRef::is_active).map(|joint| gap(&joint)).fold(widest, f64::max);
    }
    widest
}

/// Until bodies strike others, which only worlds of [`Fx`] solve at the moment, doubles and fixed point go the same way: up to a tick, within a
/// distance in m and rad. (The wheels of the clock are a loop, which is softer in fixed point.) Then joints hold in doubles too, with gaps in m.
#[test]
fn scenes_with_joints_run_in_doubles() {
    let (scenes, mut failures) = (scenes(), Vec::new());
    for (name, tick, far, wide) in [
        ("breaking-bridge", 60, 3e-5, 0.01),
        ("bridge", 10, 4e-6, 0.003),
        ("car", 60, 1e-8, 0.000_3),
        ("clock", 180, 0.001, 0.0),
        ("crane", 180, 1e-6, 0.000_01),
        ("curling", 180, 3e-8, 0.0),
        ("hoist", 180, 0.000_1, 0.000_03),
        ("lift", 180, 6e-7, 0.0),
        ("ragdolls", 10, 2e-6, 0.005),
        ("tumbler", 15, 6e-8, 0.000_02),
        ("windmill", 180, 2e-6, 0.000_1),
    ] {
        let (distance, widest) = (apart(&scenes[name], tick), widest_in_doubles(&scenes[name]));
        let line = format!("{name}: {distance:e} after {tick} ticks, gaps up to {widest:e} m");
        println!("{line}");
        if distance > far || widest > wide {
            failures.push(line);
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}

/// Runs a scene on to a tick; the widest gap of a joint on the way that is not broken, m, and the highest speed, m/s.
fn watch(run: &mut SceneRun<'_, Fx>, tick: u64) -> (f64, f64) {
    let (mut widest, mut speed) = (0.0f64, 0.0f64);
    while run.tick() < tick {
        advance(run, run.tick() + 1);
        widest = run.world().joints().filter(JointRef::is_active).map(|joint| gap(&joint)).fold(widest, f64::max);
        speed = run.world().bodies().map(|body| body.velocity().length().to_f64()).fold(speed, f64::max);
    }
    (widest, speed)
}

/// Runs a scene on to its end, at which all its bodies sleep; gap and speed as above.
fn come_to_rest(run: &mut SceneRun<'_, Fx>, ticks: u64) -> (f64, f64) {
    let watched = watch(run, ticks);
    let dynamic = run.world().bodies().filter(|body| body.kind() == BodyKind::Dynamic);
    assert_eq!(dynamic.filter(|body| body.activity() != Activity::Asleep).count(), 0, "they lie still");
    watched
}

#[test]
fn the_scenes_with_joints_are_those_that_are_tested_here() {
    let jointed = scenes().into_iter().filter(|(_, scene)| !scene.joints.is_empty());
    let names = [
        "breaking-bridge",
        "bridge",
        "car",
        "clock",
        "crane",
        "curling",
        "hoist",
        "lift",
        "ragdolls",
        "tumbler",
        "windmill",
    ];
    assert_eq!(jointed.map(|(name, _)| name).collect::<Vec<_>>(), names);
}

#[test]
fn the_ball_rolls_over_the_bridge() {
    let scene = &scenes()["bridge"];
    let mut run = scene.start::<Fx>().expect("it starts");
    let (gap, speed) = come_to_rest(&mut run, scene.ticks);
    assert!(gap < 0.02 && speed < 6.0, "{gap} m, {speed} m/s");
    let place = |name: &str| body(&run, name).position();
    assert!(place("ball").x > place("right bank").x, "{} is not beyond {}", place("ball"), place("right bank"));
    // The bridge hangs in the middle, and its two halves as far apart as they were.
    let middle = [place("plank-6"), place("plank-7")];
    assert!(middle.iter().all(|at| at.y < fx!(-1) && at.y > fx!(-1.25)) && middle[1].x - middle[0].x > fx!(0.99));
}

#[test]
fn the_ragdolls_stumble_down_the_stairs_and_lie_still() {
    let scene = &scenes()["ragdolls"];
    let mut run = scene.start::<Fx>().expect("it starts");
    let (gap, speed) = come_to_rest(&mut run, scene.ticks);
    assert!(gap < 0.02 && speed < 10.0, "{gap} m, {speed} m/s");
    for joint in run.world().joints() {
        let JointKind::Revolute(Revolute { limits: Some(limits), .. }) = joint.def().kind else { unreachable!() };
        let over = (joint.angle() - limits.upper).max(limits.lower - joint.angle());
        assert!(over < fx!(0.02), "{over} rad beyond the limits");
    }
    // Below the top of the stairs, and none through the floor.
    let heads = run.world().bodies().filter(|body| run.name(body.id()).starts_with("head"));
    let heights: Vec<f64> = heads.map(|head| head.position().y.to_f64()).collect();
    assert!(heights.iter().all(|y| (-2.4..0.0).contains(y)), "{heights:?}");
}

#[test]
fn the_car_drives_over_the_hills_and_brakes() {
    let scene = &scenes()["car"];
    let mut run = scene.start::<Fx>().expect("it starts");
    let (mut lowest, mut highest) = (fx!(0), fx!(0));
    for tick in 1..=660 {
        let (widest, _) = watch(&mut run, tick);
        assert!(widest < 0.01, "{widest} m at tick {tick}");
        for way in run.world().joints().map(|axle| axle.translation()) {
            (lowest, highest) = (lowest.min(way), highest.max(way));
        }
    }
    // The springs work on the hills, and their limits hold.
    assert!(highest - lowest > fx!(0.1) && lowest > fx!(-0.21) && highest < fx!(0.21), "{lowest} to {highest} m");
    // On the level road behind them, at the speed of the motors: 15 rad/s of wheels of 0.42 m.
    let car = body(&run, "car");
    let speed = car.velocity().length().to_f64();
    assert!(car.position().x > fx!(44) && (speed - 6.3).abs() < 0.05, "{} and {speed} m/s", car.position());
    let (gap, _) = come_to_rest(&mut run, scene.ticks);
    let car = body(&run, "car");
    assert!(gap < 0.01 && car.angle().sin().abs() < fx!(0.01), "{gap} m, {} rad", car.angle());
    assert!((fx!(50)..fx!(62)).contains(&car.position().x), "{}", car.position());
}

#[test]
fn the_crane_puts_its_weight_down_without_a_swing() {
    let scene = &scenes()["crane"];
    let mut run = scene.start::<Fx>().expect("it starts");
    // Lifted for 3.5 s at 1 m/s.
    let (first, _) = watch(&mut run, 240);
    let weight = body(&run, "weight").position();
    assert!((weight - vec2(2, 4)).length() < fx!(0.06), "{weight}");
    // On its way the weight runs ahead of the trolley, and faster.
    let (second, fastest) = watch(&mut run, 514);
    assert!((4.9..5.1).contains(&fastest), "{fastest} m/s");
    // Where the trolley stops, after one swing, the weight hangs below it.
    let (third, _) = watch(&mut run, 540);
    let [weight, trolley] = ["weight", "trolley"].map(|name| body(&run, name));
    let (apart, speed) = (weight.position().x - trolley.position().x, weight.velocity().length());
    assert!(apart.abs() < fx!(0.02) && speed < fx!(0.05), "{apart} m, {speed} m/s");
    let (last, _) = come_to_rest(&mut run, scene.ticks);
    let widest = first.max(second).max(third).max(last);
    assert!(widest < 0.01, "{widest} m");
    let weight = body(&run, "weight").position();
    assert!((weight - vec2(fx!(12.17), 2)).length() < fx!(0.03), "{weight}");
}

#[test]
fn the_lift_goes_up_to_its_limit_and_comes_down() {
    let scene = &scenes()["lift"];
    let mut run = scene.start::<Fx>().expect("it starts");
    let crates = |run: &SceneRun<'_, Fx>| ["crate-0", "crate-1", "crate-2"].map(|name| body(run, name).position());
    let start = crates(&run);
    let (mut widest, mut told) = (0.0f64, Vec::new());
    for tick in [180, 480, 720] {
        widest = widest.max(watch(&mut run, tick).0);
        let cabin = body(&run, "cabin");
        told.push((joint(&run, "guide").expect("it is there").translation().to_f64(), cabin.velocity().y.to_f64()));
    }
    // Two seconds after it sets out, when 6,000 N have brought 398.4 kg to 2 m/s, at its upper limit, and two seconds after it turns back.
    let lost = 2.0 * 2.0 / (2.0 * (6_000.0 / 398.4 - 9.81));
    let expected = [(4.0 - lost, 2.0), (10.0, 0.0), (6.05, -2.0)];
    for ((way, speed), (expected_way, expected_speed)) in told.iter().zip(expected) {
        assert!((way - expected_way).abs() < 0.01 && (speed - expected_speed).abs() < 0.001, "{told:?}");
    }
    widest = widest.max(come_to_rest(&mut run, scene.ticks).0);
    let way = joint(&run, "guide").expect("it is there").translation();
    assert!(widest < 0.01 && way.abs() < fx!(0.01), "{widest} m, {way} m");
    for (before, after) in start.into_iter().zip(crates(&run)) {
        assert!((after - before).length() < fx!(0.05), "{before} to {after}");
    }
}

#[test]
fn the_tumbler_keeps_its_time_and_all_that_is_in_it() {
    let scene = &scenes()["tumbler"];
    let mut run = scene.start::<Fx>().expect("it starts");
    watch(&mut run, 60);
    let start = body(&run, "drum").angle();
    let (mut gap, mut turned, mut last) = (0.0f64, fx!(0), start);
    while run.tick() < scene.ticks {
        let tick = run.tick() + 60;
        gap = gap.max(watch(&mut run, tick).0);
        let drum = body(&run, "drum");
        turned += (drum.angle() - last).rem_euclid(Fx::TAU);
        last = drum.angle();
        for falling in run.world().bodies().filter(|body| body.id() != drum.id()) {
            let at = drum.local_point(falling.position()).expect("near it");
            assert!(at.x.abs() < fx!(4.5) && at.y.abs() < fx!(4.5), "{at} in the drum");
        }
    }
    // 19 s at half a radian a second.
    assert!(gap < 0.01 && (turned - fx!(9.5)).abs() < fx!(0.001), "{gap} m, {turned} rad");
}

#[test]
fn the_windmill_turns_at_the_speed_of_its_balance_and_stops() {
    let scene = &scenes()["windmill"];
    let mut run = scene.start::<Fx>().expect("it starts");
    let (turning, _) = watch(&mut run, 1_200);
    // Four sails with their centres at 2.2 m: 20 N each, against 2 N·s/m and 16 N·m.
    let expected = (4.0 * 20.0 * 2.2 - 16.0) / (4.0 * 2.0 * 2.2 * 2.2);
    let speed = body(&run, "hub").angular_velocity().to_f64();
    assert!((speed / expected - 1.0).abs() < 0.002, "{speed} rad/s in place of {expected}");
    let (stopping, _) = come_to_rest(&mut run, scene.ticks);
    let gap = turning.max(stopping);
    assert!(gap < 0.01, "{gap} m");
    for sail in 0..4 {
        let way = body(&run, &format!("sail-{sail}")).angle() - body(&run, "hub").angle();
        let askew = (way - Fx::FRAC_PI_2 * sail).sin().abs();
        assert!(askew < fx!(0.001), "sail {sail}: {askew} rad");
    }
}

#[test]
fn the_clock_keeps_the_ratio_of_its_train() {
    let scene = &scenes()["clock"];
    let mut run = scene.start::<Fx>().expect("it starts");
    watch(&mut run, scene.ticks);
    let [minute, hour] = ["minute", "hour"].map(|name| body(&run, name));
    assert!((minute.angular_velocity() + Fx::PI).abs() < fx!(0.00001), "{}", minute.angular_velocity());
    assert!((hour.angular_velocity() + Fx::PI / 12).abs() < fx!(0.00001), "{}", hour.angular_velocity());
    // The minute hand is late by its start; the hour hand by a twelfth.
    let late = minute.angle();
    assert!(late.abs() < fx!(0.2) && (hour.angle() - late / 12).abs() < fx!(0.00001), "{late} {}", hour.angle());
    for name in ["first", "second"] {
        assert!(joint(&run, name).expect("it is there").angle().abs() < fx!(0.00001));
    }
}

#[test]
fn the_hoist_sets_its_cabin_down_and_holds_its_weight() {
    let scene = &scenes()["hoist"];
    let mut run = scene.start::<Fx>().expect("it starts");
    watch(&mut run, 180);
    // a = g·20/580, and the rope bears 2·300·280/580·g.
    let (speed, expected) = (body(&run, "cabin").velocity().y.to_f64(), -3.0 * 200.0 / 580.0);
    assert!((speed / expected - 1.0).abs() < 1e-5, "{speed} m/s, not {expected}");
    let force = joint(&run, "rope").expect("it is there").force().y.to_f64();
    assert!((force / (2.0 * 300.0 * 280.0 / 58.0) - 1.0).abs() < 1e-4, "{force} N");
    come_to_rest(&mut run, scene.ticks);
    let cabin = body(&run, "cabin").position().y;
    assert!((cabin + fx!(2.5)).abs() < fx!(0.001), "{cabin}");
    let winch = joint(&run, "winch").expect("it is there");
    let stop = winch.stop().expect("a ratchet");
    // From −1 rad by half a radian a second, less its start, and back to the last of 24 teeth.
    assert!((winch.angle() - stop).abs() < fx!(0.001), "{} {stop}", winch.angle());
    assert!((stop - Fx::TAU * 5 / 24).abs() < fx!(0.0001), "{stop}");
}

#[test]
fn the_stone_that_is_struck_slides_on() {
    let scene = &scenes()["curling"];
    let mut run = scene.start::<Fx>().expect("it starts");
    watch(&mut run, scene.ticks);
    // v² − 2as before the impact, at a distance of two radii; e shares its rest.
    let speed = (2.4f64 * 2.4 - 2.0 * 0.2 * 9.7).sqrt();
    for (name, expected) in
        [("red", 9.7 + (0.05 * speed).powi(2) / 0.4), ("yellow", 10.0 + (0.95 * speed).powi(2) / 0.4)]
    {
        let stone = body(&run, name);
        let place = stone.position().to_f64();
        assert!((place[0] - expected).abs() < 0.01 && place[1].abs() < 1e-6, "{name} at {place:?}, not {expected}");
        assert_eq!(stone.activity(), Activity::Asleep);
    }
}

#[test]
fn the_rotten_hinge_breaks_at_the_fifth_crate() {
    let scene = &scenes()["breaking-bridge"];
    let mut run = scene.start::<Fx>().expect("it starts");
    let is_broken = |run: &SceneRun<'_, Fx>| joint(run, "rotten").expect("it is there").is_broken();
    let (carrying, _) = watch(&mut run, 660);
    assert!(!is_broken(&run) && body(&run, "crate-3").position().y > fx!(-1), "{carrying} m");
    let (breaking, _) = watch(&mut run, 720);
    assert!(is_broken(&run));
    let (falling, _) = come_to_rest(&mut run, scene.ticks);
    let widest = carrying.max(breaking).max(falling);
    assert!(widest < 0.05, "{carrying} m, {breaking} m, {falling} m");
    assert_eq!(run.world().joints().filter(JointRef::is_broken).count(), 1);
    // Both halves hang down, and all crates lie on the ground of the gorge.
    let place = |name: &str| body(&run, name).position();
    let halves = [place("plank-6"), place("plank-7")];
    assert!(halves.iter().all(|at| at.y < fx!(-6) && at.x.abs() > fx!(6)), "{halves:?}");
    let crates = (0..6).map(|i| place(&format!("crate-{i}")));
    assert!(crates.into_iter().all(|at| at.y < fx!(-6) && at.y > fx!(-7.7) && at.x.abs() < fx!(6)));
}
