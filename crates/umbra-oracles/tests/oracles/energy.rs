//! The energy of worlds that nobody acts on: what is judged of it, and what is not.

use umbra_oracles::{Course, Game, Oracle, Script, Verdict};
use umbra_physics::{
    Attachment, BodyDef, BodyId, BodyKind, ColliderDef, Command, End, FieldKind, ForceOrImpulse, Integrator, JointDef,
    JointKind, JointMotor, JointSpring, Material, Revolute, Shape, Stepper, Vec2, Weld, World, WorldDef, fx, vec2,
};

/// A ball above a floor, which in each tick of an input gets faster past the driver.
#[derive(Clone)]
struct Kicked;

const BALL: BodyId = BodyId::from_parts(1, 0);

fn def() -> WorldDef {
    WorldDef { gravity: vec2(0, -10), ..WorldDef::default() }
}

fn floor() -> BodyDef {
    let shape = Shape::rectangle(fx!(20), fx!(2)).expect("a rectangle");
    BodyDef { position: vec2(0, -1), ..BodyDef::fixed().with_collider(shape) }
}

fn ball(height: impl Into<umbra_physics::Fx>) -> BodyDef {
    let shape = Shape::circle(fx!(0.5)).expect("a disc");
    BodyDef { position: vec2(0, height.into()), ..BodyDef::dynamic().with_collider(shape) }
}

impl Game for Kicked {
    type Input = ();

    fn start(&mut self) -> World {
        let mut world = World::new(def()).expect("a fair definition");
        world.add_body(floor()).expect("a fair body");
        world.add_body(ball(2)).expect("a fair body");
        world
    }

    fn tick(&mut self, world: &mut World, inputs: &[()], driver: &mut dyn Stepper) {
        for () in inputs {
            let velocity = world.body(BALL).expect("it is there").velocity();
            world.set_velocity(BALL, velocity + velocity / 8).expect("it is dynamic");
        }
        driver.step(world);
    }
}

#[test]
fn energy_from_nothing_is_found_with_its_tick_and_value() {
    let kicked = Course { inputs: vec![(12, ())], ticks: 60 };
    let violation = Oracle::Energy.judge(&Kicked, &kicked).expect_err("it is kicked");
    assert_eq!(violation.tick, 12);
    let text = violation.to_string();
    assert!(text.starts_with("energy, tick 12, energy from nothing: the world, energy: "), "{text}");
    // Without the kick it bounces, or does not, and comes to rest.
    assert_eq!(Oracle::Energy.judge(&Kicked, &Course { inputs: vec![], ticks: 300 }), Ok(Verdict::Held));
}

/// A ball that falls on a floor, with these commands.
fn script(def: WorldDef, commands: Vec<(u64, Command)>) -> Script {
    let mut all = vec![(0, Command::AddBody(floor())), (0, Command::AddBody(ball(3)))];
    all.extend(commands);
    Script { world: def, commands: all, ticks: 90 }
}

#[test]
fn an_input_is_a_new_start() {
    let action = ForceOrImpulse::Impulse { impulse: vec2(0, 9), point: None };
    let push = |tick| (tick, Command::Apply { body: BALL, action, options: umbra_physics::ApplyOptions::default() });
    assert_eq!(script(def(), vec![push(30), push(50)]).judge(Oracle::Energy), Ok(Verdict::Held));
    let action = ForceOrImpulse::Force { force: vec2(0, 900), point: None };
    let pull = Command::Apply { body: BALL, action, options: umbra_physics::ApplyOptions::default() };
    assert_eq!(script(def(), vec![(40, pull.clone())]).judge(Oracle::Energy), Ok(Verdict::Held));
    // A force in each tick leaves nothing to judge.
    let always = script(def(), (0..90).map(|tick| (tick, pull.clone())).collect());
    assert!(matches!(always.judge(Oracle::Energy), Ok(Verdict::Inapplicable { .. })));
}

#[test]
fn worlds_that_something_else_gives_energy_to_are_not_judged() {
    let lift = BodyDef { position: vec2(9, 0), velocity: vec2(0, 1), ..BodyDef::kinematic() };
    let belt = ColliderDef {
        material: Material { surface_speed: fx!(1), ..Material::default() },
        ..ColliderDef::new(Shape::circle(fx!(1)).expect("a disc"))
    };
    let belt = BodyDef { position: vec2(8, -9), ..BodyDef::fixed().with_collider(belt) };
    let wind = |wind| FieldKind::Drag { linear: fx!(1), quadratic: fx!(0), wind };
    let thrust = FieldKind::Thrust { at: Attachment::centre(BALL), force: vec2(1, 0) };
    let pin =
        |kind| Command::AddJoint(JointDef::new([End::World(vec2(0, 3)), End::Body(Attachment::centre(BALL))], kind));
    let turning = |speed| {
        let motor = Some(JointMotor { speed, max_force: fx!(5) });
        pin(JointKind::Revolute(Revolute { motor, ..Revolute::default() }))
    };
    let bent = JointSpring { rest: fx!(2), ..JointSpring::new(fx!(1), fx!(0)) };
    let master = BodyDef { dominance: 1, position: vec2(8, 8), ..BodyDef::dynamic() };
    for command in [
        Command::AddBody(lift.clone()),
        Command::AddBody(belt),
        Command::AddField(wind(vec2(1, 0)).into()),
        Command::AddField(thrust.into()),
        Command::AddBody(master),
        Command::SetIntegrator(Integrator::ExplicitEuler),
        turning(fx!(4)),
        pin(JointKind::Weld(Weld { spring: Some(bent) })),
    ] {
        let verdict = script(def(), vec![(0, command.clone())]).judge(Oracle::Energy);
        assert!(matches!(verdict, Ok(Verdict::Inapplicable { .. })), "{command:?}: {verdict:?}");
    }
    let stopped = BodyDef { velocity: Vec2::ZERO, ..lift };
    let fixed = BodyDef { kind: BodyKind::Static, position: vec2(7, 0), ..BodyDef::dynamic() };
    for command in [
        Command::AddBody(stopped),
        Command::AddBody(fixed),
        Command::AddField(wind(Vec2::ZERO).into()),
        turning(fx!(0)),
    ] {
        let verdict = script(def(), vec![(0, command.clone())]).judge(Oracle::Energy);
        assert_eq!(verdict, Ok(Verdict::Held), "{command:?}");
    }
}

#[test]
fn bodies_are_judged_once_they_are_pushed_out_of_each_other() {
    let commands = vec![(0, Command::AddBody(floor())), (0, Command::AddBody(ball(fx!(0.25))))];
    let overlapping = |ticks| Script { world: def(), commands: commands.clone(), ticks };
    assert!(matches!(overlapping(2).judge(Oracle::Energy), Ok(Verdict::Inapplicable { .. })));
    assert_eq!(overlapping(120).judge(Oracle::Energy), Ok(Verdict::Held));
}
