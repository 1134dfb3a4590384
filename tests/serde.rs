//! Plain data goes through text formats and binary ones and comes back equal; nothing comes back that could not be made.

#[path = "support/cases.rs"]
mod cases;
#[path = "support/commands.rs"]
#[allow(dead_code, reason = "this test needs no world at odds with its commands")]
mod commands;
#[path = "support/random.rs"]
mod random;

use std::collections::BTreeSet;
use std::fmt::Debug;

use cases::cases;
use commands::Author;
use proptest::prelude::*;
use random::SplitMix;
use serde::Serialize;
use serde::de::{DeserializeOwned, Deserializer, Visitor, value::Error as NoValue};
use serde_json::Value;
use umbra_physics::scalar::FxSum;
use umbra_physics::{
    Activity, AppliedForce, ApplyOptions, Attachment, BodyDef, BodyId, BodyKind, BodyState, Cause, ColliderDef,
    ColliderId, Command, ContactSettings, Created, CustomForceError, Damping, Dependence, Dimension, Distance, Elapsed,
    End, Error, Fault, FieldId, FieldKind, Filter, ForceField, ForceOrImpulse, ForceTorque, Frame, Fx, FxAccumulator,
    FxFactor, FxWide, Gear, Geometry, Input, InputResult, Inputs, Integrator, Irreversible, JointId, JointKind, Locks,
    Mass, Material, MathError, MixRule, Motor, ParseFxError, Part, Prismatic, Pulley, Quantity, Random, Region, Rot,
    Shape, SpringConstants, Stage, StageKind, TimeStep, Turn, Vec2, Weld, Wheel, World, WorldDef, fx, vec2,
};

fn through_both<T: Serialize + DeserializeOwned + PartialEq + Debug>(value: &T) {
    let json = serde_json::to_string(value).expect("JSON can say it");
    let back: T = serde_json::from_str(&json).unwrap_or_else(|error| panic!("{error} in {json}"));
    assert_eq!(&back, value, "{json}");
    // As readers do that look at it first.
    let looked_at: Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(&serde_json::from_value::<T>(looked_at).expect("the same"), value, "{json}");
    let bytes = postcard::to_allocvec(value).expect("bytes can say it");
    assert_eq!(&postcard::from_bytes::<T>(&bytes).expect("what was written"), value, "{bytes:?}");
}

/// Writes no value, and finds out the names of the variants there are.
struct Variants<'a>(&'a mut Vec<&'static str>);

impl<'de> Deserializer<'de> for Variants<'_> {
    type Error = NoValue;

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, NoValue> {
        Err(serde::de::Error::custom("no enum"))
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        variants: &'static [&'static str],
        _: V,
    ) -> Result<V::Value, NoValue> {
        self.0.extend_from_slice(variants);
        Err(serde::de::Error::custom("the names are all there is"))
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit unit_struct
        newtype_struct seq tuple tuple_struct map struct identifier ignored_any
    }
}

/// Takes a list with every variant of an enum through both, and fails if one is missing.
fn every_variant<T: Serialize + DeserializeOwned + PartialEq + Debug>(values: impl IntoIterator<Item = T>) {
    let mut all = Vec::new();
    assert!(T::deserialize(Variants(&mut all)).is_err());
    assert!(!all.is_empty(), "it is no enum");
    let mut variants = BTreeSet::new();
    for value in values {
        through_both(&value);
        variants.insert(match serde_json::to_value(&value).expect("JSON can say it") {
            Value::String(name) => name,
            Value::Object(object) => object.keys().next().expect("a variant has a name").clone(),
            json => panic!("{json} is no variant"),
        });
    }
    assert_eq!(variants, all.iter().map(|&name| name.to_owned()).collect());
}

fn body(slot: u32) -> BodyId {
    BodyId::from_parts(slot, u32::MAX)
}

fn field(slot: u32) -> FieldId {
    FieldId::from_parts(slot, 3)
}

fn attachment() -> Attachment {
    Attachment { body: body(1), point: vec2(fx!(0.1), -1) }
}

fn quantities() -> Vec<Quantity> {
    use Quantity::*;
    vec![
        Position,
        Angle,
        Velocity,
        AngularVelocity,
        Mass { value: fx!(-1) },
        Inertia { value: fx!(0) },
        Density { value: fx!(-0.5) },
        Size { dimension: Dimension::Edge(7), value: fx!(0.004) },
        Count,
        Force,
        Torque,
        Impulse,
        Gravity,
        GravityScale,
        Damping,
        Mu,
        Softening,
        Stiffness,
        Drag,
        RestLength,
        Deceleration,
        SleepAfter,
        Total,
        Blob,
        MaxSpeed,
        MaxAngularSpeed,
        ColliderPosition,
        ColliderDensity { value: fx!(-2) },
        Friction,
        Restitution,
        FluidBox,
        JointPoint,
        JointLength,
        BreakForce,
        JointAngle,
        JointLimits,
        Teeth,
        Strands,
        JointForce,
        MotorSpeed,
        SpringFrequency,
        DampingRatio,
        Substeps,
        ContactSpeed,
        Pairs,
        SurfaceSpeed,
        OneWayDirection,
        OneWayTolerance,
        Query,
        RollingResistance,
        MaterialId,
        CharacterSkin,
        CharacterUp,
        CharacterSlope,
        CharacterStep,
        CharacterTranslation,
        ExplosionRadius,
        ExplosionImpulse,
    ]
}

fn errors() -> Vec<Error> {
    let (body, field) = (body(4), field(5));
    vec![
        Error::OutOfRange { quantity: Quantity::Mu },
        Error::NoSuchBody { body },
        Error::NoSuchField { field },
        Error::TimeStep,
        Error::NotConvex { corner: 63 },
        Error::NotDynamic { body },
        Error::NotMovable { body },
        Error::Quarantined { body },
        Error::NotQuarantined { body },
        Error::DampingHasNoInverse,
        Error::SameBody { body },
        Error::CustomForce { id: u64::MAX },
        Error::Full,
        Error::ElapsedTime,
        Error::DuplicateInput { player: 1, sequence: u32::MAX },
        Error::Inconsistent,
        Error::TickForgotten { tick: 1, oldest: u64::MAX },
        Error::TickToCome { tick: 9, present: 8 },
        Error::NotReversible { why: Irreversible::Velocity { field } },
        Error::Locked { quantity: Quantity::Velocity },
        Error::Disabled { body },
        Error::NotDisabled { body },
        Error::SleepIsOff,
        Error::KeptAwake { kinematic: body },
        Error::NotKinematic { body },
        Error::NoSuchPlayer { player: 3 },
        Error::ChangedBetweenTicks { tick: 4 },
        Error::SteppedInTick { tick: u64::MAX },
        Error::NoSuchCollider { collider: ColliderId::from_parts(3, u32::MAX) },
        Error::NoSuchJoint { joint: JointId::from_parts(3, u32::MAX) },
        Error::NoMotor { joint: JointId::from_parts(3, u32::MAX) },
        Error::NothingToMove,
        Error::DynamicChain,
        Error::ChainCrosses { segments: [0, 65_535] },
    ]
}

fn custom_forces() -> Vec<FieldKind> {
    let spring = SpringConstants { rest: fx!(0.1), stiffness: Fx::MAX, damping: Fx::DELTA };
    let (near, at) = (attachment(), attachment());
    let mu = FxFactor::from_ratio(1, 3);
    let region = Region::Disc { centre: vec2(1, 2), radius: fx!(0.1) };
    vec![
        FieldKind::Attractor { centre: End::Body(near), mu, softening: fx!(0.1) },
        FieldKind::Spring { near, far: End::World(vec2(1, 2)), spring },
        FieldKind::Drag { linear: fx!(1), quadratic: fx!(2), wind: vec2(3, fx!(-0.1)) },
        FieldKind::Thrust { at, force: vec2(3, fx!(-0.1)) },
        FieldKind::Friction { deceleration: fx!(0.1), angular_deceleration: fx!(2) },
        FieldKind::Zone { region, acceleration: vec2(3, fx!(-0.1)) },
        FieldKind::Custom { id: u64::MAX },
        FieldKind::Buoyancy {
            min: vec2(-1, fx!(-0.1)),
            max: vec2(1, 2),
            density: fx!(0.1),
            linear_drag: fx!(3),
            angular_drag: Fx::MAX,
            flow: vec2(0, fx!(-0.3)),
        },
    ]
}

fn shapes() -> Vec<Shape> {
    let corners = [vec2(fx!(0.1), 0), vec2(1, fx!(0.3)), vec2(fx!(0.7), 2), vec2(0, fx!(1.1))];
    let part = |shape: Shape, x: i32| Part { shape, position: vec2(x, fx!(0.1)), angle: fx!(-7.3), density: fx!(0.3) };
    let mut shapes = vec![
        Shape::circle(fx!(0.1)).expect("fair"),
        Shape::rectangle(fx!(0.1), fx!(3)).expect("fair"),
        Shape::capsule(fx!(0.1), fx!(3)).expect("fair"),
        Shape::polygon(&corners).expect("convex"),
        Shape::polygon(&[corners[2], corners[1], corners[0]]).expect("convex"),
        Shape::segment(corners[0], corners[1]).expect("fair"),
        Shape::rounded_polygon(&corners, fx!(0.3)).expect("fair"),
    ];
    let parts: Vec<Part> = shapes.iter().zip(0..).map(|(shape, x)| part(shape.clone(), x)).collect();
    shapes.push(Shape::compound(&parts).expect("fair"));
    shapes.extend([false, true].map(|closed| Shape::chain(&corners, closed).expect("it does not cross itself")));
    shapes
}

fn bodies() -> Vec<BodyDef> {
    let def = |collider: Option<ColliderDef>| BodyDef {
        colliders: collider.into_iter().collect(),
        angle: fx!(-0.1),
        linear_damping: Some(Damping::kept_per_second(fx!(0.1))),
        angular_damping: Some(Damping::rate(fx!(4.1))),
        dominance: i32::MIN,
        force_groups: u32::MAX,
        key: u64::MAX,
        user_data: 1 << 63,
        ..BodyDef::dynamic()
    };
    shapes().into_iter().map(|shape| Some(ColliderDef::ghost(shape))).chain([None]).map(def).collect()
}

fn a_world() -> (Author, World) {
    let mut author = Author { random: SplitMix::seeded(5), unfair: 9 };
    let mut world = World::new(WorldDef::default()).expect("fair");
    while world.bodies().count() < 5 || world.fields().count() < 3 {
        let _ = world.add_body(author.body());
        let _ = world.add_field(author.field(&world));
    }
    (author, world)
}

#[test]
fn every_variant_of_every_enum_comes_back() {
    every_variant([BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic]);
    every_variant([Activity::Awake, Activity::Asleep, Activity::Quarantined, Activity::Disabled]);
    every_variant([
        Mass::Kilograms(Fx::MIN),
        Mass::Explicit { mass: Fx::MAX, inertia: Fx::DELTA },
        Mass::FromColliders,
    ]);
    every_variant(quantities());
    every_variant(errors());
    let (field, code) = (field(1), u32::MAX);
    every_variant(
        [Cause::Position, Cause::Velocity, Cause::AngularVelocity, Cause::Force, Cause::Pairs]
            .into_iter()
            .chain([Cause::Field { field }, Cause::CustomForce { field, code }]),
    );
    every_variant([Dependence::Nothing, Dependence::Position, Dependence::Velocity]);
    every_variant([End::World(vec2(fx!(0.1), 0)), End::Body(attachment())]);
    let (centre, radius) = (vec2(fx!(0.1), 0), fx!(0.1));
    every_variant([Region::Disc { centre, radius }, Region::Box { min: centre, max: vec2(1, 2) }]);
    every_variant(custom_forces());
    every_variant(Integrator::ALL);
    every_variant([
        StageKind::Fields,
        StageKind::Kick,
        StageKind::Drift,
        StageKind::Damp,
        StageKind::Clear,
        StageKind::Detect,
        StageKind::Solve,
        StageKind::Push,
    ]);
    every_variant([Frame::World, Frame::Body]);
    let (force, point) = (vec2(fx!(0.1), 0), Some(vec2(fx!(0.1), 0)));
    every_variant([
        ForceOrImpulse::Force { force, point },
        ForceOrImpulse::Torque(fx!(0.1)),
        ForceOrImpulse::Impulse { impulse: force, point: None },
        ForceOrImpulse::AngularImpulse(Fx::MIN),
    ]);
    every_variant([
        Irreversible::Scalar,
        Irreversible::Integrator,
        Irreversible::Start,
        Irreversible::TimeStep,
        Irreversible::Sleep,
        Irreversible::Damping,
        Irreversible::Velocity { field },
        Irreversible::Quarantined { body: body(1) },
        Irreversible::Pending,
        Irreversible::Twice { body: body(1) },
        Irreversible::Fault(Fault { body: body(1), cause: Cause::Position }),
        Irreversible::Capped,
        Irreversible::Moved,
        Irreversible::End,
        Irreversible::Contact,
        Irreversible::Joint,
    ]);
    let collider = Created::Collider(ColliderId::from_parts(2, 1));
    let joint = Created::Joint(JointId::from_parts(2, 1));
    every_variant([Created::Nothing, Created::Body(body(1)), Created::ForceField(field), collider, joint]);
    every_variant::<JointKind>([
        JointKind::default(),
        JointKind::Distance(Distance::default()),
        JointKind::Weld(Weld::default()),
        JointKind::Prismatic(Prismatic::default()),
        JointKind::Wheel(Wheel::default()),
        JointKind::Motor(Motor::default()),
        JointKind::Gear(Gear { teeth: [1, 2] }),
        JointKind::Pulley(Pulley { grounds: [vec2(0, 1), vec2(2, 1)], strands: [1, 2], length: fx!(3) }),
    ]);
    every_variant([ParseFxError::Empty, ParseFxError::InvalidDigit { position: 7 }, ParseFxError::OutOfRange]);
    every_variant([MathError::NotPositive, MathError::Overflow]);
    every_variant(shapes());
    let (mut author, world) = a_world();
    every_variant(Command::NUMBERS.iter().map(|&kind| author.of_kind(kind, &world)));
}

#[test]
fn every_plain_struct_comes_back() {
    through_both(&Vec2::new(fx!(0.1), Fx::MIN));
    through_both(&Rot::from_radians(fx!(0.1)));
    through_both(&TimeStep::ratio(1001, 60_000));
    through_both(&Elapsed { num: u128::MAX, den: u128::MAX - 1 });
    through_both(&Random::seeded(1));
    through_both(&ApplyOptions::BODY);
    through_both(&Locks { x: true, y: false, rotation: true });
    through_both(&WorldDef::<Fx> { gravity: vec2(0, fx!(-9.81)), sleep_after: None, ..WorldDef::default() });
    through_both(&attachment());
    custom_forces().into_iter().for_each(|law| through_both(&ForceField { kind: law, force_groups: 5 }));
    bodies().iter().for_each(through_both);
    let disc = ColliderDef::new(shapes().remove(0));
    let material = Material {
        friction: fx!(0.1),
        restitution: fx!(1),
        rolling_resistance: fx!(0.7),
        surface_speed: fx!(-0.3),
        friction_rule: MixRule::Product,
        restitution_rule: MixRule::GeometricMean,
        id: u32::MAX,
    };
    let filter = Filter { category: u32::MAX, mask: 1 << 31, group: i32::MIN };
    let flags = ColliderDef { sensor: true, contact_events: true, ..disc.clone() };
    let full = ColliderDef { material, filter, angle: fx!(-0.1), hit_events: true, key: u64::MAX, ..flags };
    through_both(&material);
    through_both(&filter);
    through_both(&full);
    through_both(&ContactSettings::<Fx> { substeps: 8, push_speed: fx!(0.1), ..ContactSettings::default() });
    through_both(&BodyDef::dynamic().with_collider(disc).with_collider(full));
    for integrator in Integrator::ALL {
        integrator.stages().iter().for_each(through_both::<Stage>);
    }
    through_both(&SpringConstants { rest: fx!(0.1), stiffness: Fx::MAX, damping: Fx::ZERO });
    through_both(&Fault { body: body(1), cause: Cause::Field { field: field(2) } });
    let position = vec2(fx!(0.1), 0);
    let (velocity, angle, angular_velocity) = (position, fx!(0.1), fx!(-0.1));
    through_both(&BodyState { position, angle, velocity, angular_velocity, mass: fx!(3), key: 4, user_data: u64::MAX });
    through_both(&ForceTorque { force: position, torque: fx!(0.1) });
    through_both(&CustomForceError { code: u32::MAX });
    through_both(&InputResult { player: 1, sequence: 2, result: Ok(Created::Body(body(3))) });
    errors().into_iter().for_each(|error| through_both(&InputResult { player: 1, sequence: 2, result: Err(error) }));
    let (mut author, world) = a_world();
    let mut inputs = Inputs::new();
    for player in [3, 1, 2] {
        let input = Input { player, sequence: 7, command: author.any(&world) };
        through_both(&input);
        inputs.insert(input).expect("each has a place of its own");
    }
    through_both(&inputs);
}

#[test]
fn forces_applied_over_a_tick_are_read_back() {
    let mut world = World::new(WorldDef::default()).expect("fair");
    let ids = [0, 1].map(|_| world.add_body(BodyDef::dynamic()).expect("fair"));
    for _ in 0..5 {
        world.apply_force_at_point(ids[0], vec2(fx!(-0.1), Fx::MAX), vec2(fx!(0.3), 7)).expect("fair");
        // More than a `Wide` holds, so that the sum is carried.
        world.apply_force_at_point(ids[1], Vec2::new(Fx::MIN, Fx::MAX), Vec2::new(fx!(-1e9), fx!(-1e9))).expect("fair");
    }
    let report = world.step();
    assert_eq!(report.applied.iter().map(|row| row.torque().is_some()).collect::<Vec<_>>(), [true, false]);
    report.applied.iter().for_each(through_both::<AppliedForce>);
    let json = serde_json::to_value(report).expect("JSON can say it");
    assert_eq!(json["tick"], 1);
    assert_eq!(json["applied"].as_array().map(Vec::len), Some(2));
}

#[test]
fn any_command_comes_back() {
    let (mut author, world) = a_world();
    for _ in 0..4_000 {
        through_both(&author.any(&world));
    }
}

proptest! {
    #![proptest_config(cases(500))]

    #[test]
    fn any_number_comes_back(bits: i128, word: u64, small: i64, shift in -16_384i32..=16_384, cut in 0u32..128) {
        for bits in [bits, bits >> cut, i128::MIN, i128::MAX, -1] {
            through_both(&FxAccumulator::from_bits(bits));
            through_both(&FxWide::from_bits(bits));
        }
        through_both(&Turn::from_bits(word));
        through_both(&Fx::from_bits(small));
        through_both(&(BodyId::from_parts(word as u32, (word >> 32) as u32), FieldId::from_parts(word as u32, 0)));
        let factor = format!(r#"{{"mantissa":{},"shift":{shift}}}"#, word | 1 << 63);
        through_both(&serde_json::from_str::<FxFactor>(&factor).expect("a factor"));
        let mut sum = FxSum::default();
        for _ in 0..word % 9 {
            sum.add(FxWide::from_bits(bits));
        }
        through_both(&sum);
    }

    #[test]
    fn any_shape_comes_back_to_the_bit(
        corners in proptest::collection::vec((-(1i64 << 44)..=1 << 44, -(1i64 << 44)..=1 << 44), 3..6),
        scale in 0u32..36,
        parts in proptest::collection::vec((any::<i64>(), any::<i64>(), any::<i64>(), 1i64..), 1..9),
    ) {
        let point = |&(x, y): &(i64, i64)| Vec2::new(Fx::from_bits(x >> scale), Fx::from_bits(y >> scale));
        let corners: Vec<Vec2> = corners.iter().map(point).collect();
        let simple: Vec<Shape> = [Shape::polygon(&corners), Shape::polygon(&corners[..3]), Shape::segment(corners[0], corners[1])]
            .into_iter().flatten().chain(Shape::circle(fx!(0.3))).collect();
        simple.iter().for_each(through_both);
        let part = |(i, &(x, y, angle, density)): (usize, &(i64, i64, i64, i64))| Part {
            shape: simple[i % simple.len()].clone(),
            position: point(&(x >> 19, y >> 19)),
            angle: Fx::from_bits(angle),
            density: Fx::from_bits(density),
        };
        let parts: Vec<Part> = parts.iter().enumerate().map(part).collect();
        parts.iter().for_each(through_both);
        through_both(&Shape::compound(&parts).expect("all are within the limits"));
    }
}

fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("JSON can say it")
}

#[test]
fn numbers_are_exact_decimals_where_people_read() {
    assert_eq!(json(&FxWide::from_bits(-5 << 62)), r#""-1.25""#);
    assert_eq!(json(&FxAccumulator::from_bits(3 << 95)), r#""1.5""#);
    assert_eq!(json(&FxAccumulator::from_bits(i128::MIN)), r#""-2147483648""#);
    assert_eq!(json(&Turn::QUARTER), r#""0.25""#);
    assert_eq!(json(&Elapsed { num: 60_001, den: 60_000 }), r#"{"num":"60001","den":"60000"}"#);
    assert_eq!(json(&Damping::kept_per_second(fx!(0.25))), r#"{"kept_per_second":"0.25"}"#);
    assert_eq!(json(&Damping::rate(fx!(30))), r#"{"rate":"30"}"#);
    // Any rate is read, and is what a program makes of it; beside it there is nothing.
    for rate in [fx!(0), fx!(0.5), fx!(4), fx!(4.5), fx!(-1)] {
        let text = format!(r#"{{"rate":"{rate}"}}"#);
        assert_eq!(serde_json::from_str::<Damping>(&text).expect("a damping"), Damping::rate(rate), "{text}");
    }
    for text in [r#"{"rate":"1","kept_per_second":"1"}"#, r#"{"kept":"1"}"#, "{}", r#""1""#] {
        assert!(serde_json::from_str::<Damping>(text).is_err(), "{text}");
    }
    assert_eq!(json(&TimeStep::hz(60)), r#"{"num":1,"den":60}"#);
    let least = FxAccumulator::from_bits(1);
    // 2^-96 has 96 digits behind the point, and 5^96 is what they end with.
    let text = json(&least);
    assert!(text.len() == 96 + 4 && text.ends_with("4462890625\""), "{text}");
    for (text, bits) in [("-0", Some(0)), ("007.50", Some(15 << 63)), ("1.", None), (".5", None), ("", None)] {
        let read = serde_json::from_str::<FxWide>(&format!("{text:?}"));
        assert_eq!(read.ok(), bits.map(FxWide::from_bits), "{text}");
    }
    for text in ["+1", "1e3", "0x1", "-", "--1", "1_0", "9223372036854775808", "-9223372036854775808.5", "0.1", "٣"] {
        let error = serde_json::from_str::<FxWide>(&format!("{text:?}")).expect_err("no such number");
        assert!(error.to_string().contains("multiple of 2^-64"), "{text}: {error}");
    }
    assert!(serde_json::from_str::<FxWide>(&format!("\"0.{}\"", "0".repeat(300))).is_ok());
    assert!(serde_json::from_str::<FxWide>(&format!("\"0.{}1\"", "0".repeat(300))).is_err());
    assert!(serde_json::from_str::<FxWide>(&format!("\"{}\"", "9".repeat(300))).is_err());
}

fn refused<T: DeserializeOwned + Debug>(json: &str, why: &str) {
    let error = serde_json::from_str::<T>(json).expect_err(json);
    assert!(error.to_string().contains(why), "{json}: {error}");
}

#[test]
fn invalid_values_are_not_read() {
    // A factor in any other form would not be equal to the same one.
    for (mantissa, shift) in
        [(1u64, 0), (0, 1), (1 << 62, 62), (1 << 63, 16_385), (1 << 63, -16_385), (1 << 63, i32::MIN)]
    {
        refused::<FxFactor>(&format!(r#"{{"mantissa":{mantissa},"shift":{shift}}}"#), "a factor is");
    }
    for text in ["1", "-0.5"] {
        refused::<Turn>(&format!("{text:?}"), "below 1 turn");
    }
    refused::<Random>(r#"{"state":[0,0,0,0]}"#, "never moves");
    for (num, den) in [(1, 0), (0, 0), (0, 2), (2, 4)] {
        refused::<Elapsed>(&format!(r#"{{"num":"{num}","den":"{den}"}}"#), "lowest terms");
    }
    let step: TimeStep = serde_json::from_str(r#"{"num":2,"den":120}"#).expect("a time step");
    assert_eq!(step, TimeStep::hz(60));
    let step: TimeStep =
        postcard::from_bytes(&postcard::to_allocvec(&(0u32, 5u32)).expect("bytes")).expect("a time step");
    assert_eq!(step, TimeStep::ratio(0, 5));
    for (json, why) in [
        (r#"{"circle":{"radius":"0"}}"#, "expected a radius from 2^-7 (0.0078125) to 2^12 m, not 0"),
        (
            r#"{"polygon":{"corners":[{"x":0,"y":0},{"x":1,"y":0},{"x":2,"y":0}]}}"#,
            "is not convex, or repeats its neighbour",
        ),
        (r#"{"compound":{"parts":[]}}"#, "1 to 256 parts"),
        (r#"{"segment":{"ends":[{"x":0,"y":0}]}}"#, "invalid length 1"),
    ] {
        refused::<Shape>(json, why);
    }
    let input = |player: u32| format!(r#"{{"player":{player},"sequence":0,"command":{{"set_sleep_after":null}}}}"#);
    refused::<Inputs>(
        &format!("[{0},{1},{0}]", input(2), input(1)),
        "player 2 already has an input with sequence 0 in this tick",
    );
    let inputs: Inputs = serde_json::from_str(&format!("[{},{}]", input(2), input(1))).expect("in any order");
    assert_eq!(inputs.iter().map(|input| input.player).collect::<Vec<_>>(), [1, 2]);
}

#[test]
fn a_compound_has_no_compounds_however_deep() {
    let compound = |inner: &str| {
        format!(r#"{{"compound":{{"parts":[{{"shape":{inner},"position":{{"x":0,"y":0}},"angle":0,"density":1}}]}}}}"#)
    };
    let single = compound(r#"{"circle":{"radius":1}}"#);
    assert!(serde_json::from_str::<Shape>(&single).is_ok());
    refused::<Shape>(&compound(&single), "no compound");
    // Variant 5 with one part, whose shape is variant 5 with one part, and so on: bytes enough for any stack.
    let bytes = [5, 1].repeat(1 << 20);
    assert!(postcard::from_bytes::<Shape>(&bytes).is_err());
    // A part that stands alone may have one, as a compound refuses it.
    assert!(postcard::from_bytes::<Part>(&bytes).is_err());
    // More corners than there are bytes for.
    assert!(postcard::from_bytes::<Shape>(&[3, 255, 255, 255, 255, 15]).is_err());
}

/// Each object within a value, once with a field that it does not have.
fn with_unknown_fields(value: &Value) -> Vec<Value> {
    match value {
        Value::Object(fields) => {
            let mut all = vec![{
                let mut fields = fields.clone();
                fields.insert("bystander".into(), Value::from(1));
                Value::Object(fields)
            }];
            for (name, inner) in fields {
                all.extend(with_unknown_fields(inner).into_iter().map(|inner| {
                    let mut fields = fields.clone();
                    fields.insert(name.clone(), inner);
                    Value::Object(fields)
                }));
            }
            all
        }
        Value::Array(items) => {
            let inside = |(i, item): (usize, &Value)| {
                let put = move |inner: Value| {
                    let mut items = items.clone();
                    items[i] = inner;
                    Value::Array(items)
                };
                with_unknown_fields(item).into_iter().map(put).collect::<Vec<_>>()
            };
            items.iter().enumerate().flat_map(inside).collect()
        }
        _ => Vec::new(),
    }
}

fn refuses_unknown_fields<T: Serialize + DeserializeOwned + Debug>(value: &T) {
    let json = serde_json::to_value(value).expect("JSON can say it");
    for json in with_unknown_fields(&json) {
        let read = serde_json::from_value::<T>(json.clone());
        assert!(read.is_err(), "{json} was read as {read:?}");
    }
}

#[test]
fn a_field_that_is_not_there_is_refused_wherever_it_stands() {
    let (mut author, world) = a_world();
    let kinds = Command::NUMBERS.iter().cycle().take(40 * Command::NUMBERS.len());
    kinds.for_each(|&kind| refuses_unknown_fields(&author.of_kind(kind, &world)));
    bodies().iter().for_each(refuses_unknown_fields);
    errors().iter().for_each(refuses_unknown_fields);
    custom_forces().iter().for_each(refuses_unknown_fields);
    refuses_unknown_fields(&WorldDef::<Fx>::default());
    refuses_unknown_fields(&Elapsed::ZERO);
    refuses_unknown_fields(&Random::seeded(1));
    refuses_unknown_fields(&FxSum::default());
    refuses_unknown_fields(&Rot::<Fx>::IDENTITY);
    refuses_unknown_fields(&Fault { body: body(1), cause: Cause::Field { field: field(2) } });
    refuses_unknown_fields(&InputResult { player: 1, sequence: 2, result: Ok(Created::Body(body(3))) });
    refuses_unknown_fields(&Integrator::Yoshida4.stages()[0]);
    refuses_unknown_fields(&ForceTorque::<Fx>::default());
    refuses_unknown_fields(&CustomForceError { code: 1 });
}

#[test]
fn bytes_that_were_damaged_are_read_as_something_else_or_refused_and_no_world_minds() {
    let (mut author, world) = a_world();
    let mut read = 0;
    for _ in 0..20_000 {
        let mut bytes = postcard::to_allocvec(&author.any(&world)).expect("bytes can say it");
        for _ in 0..1 + author.random.next() % 3 {
            let at = author.random.next() as usize % bytes.len();
            match author.random.next() % 3 {
                0 => bytes[at] = author.random.next() as u8,
                1 => bytes[at] ^= 1 << (author.random.next() % 8),
                _ => bytes.truncate(at + 1),
            }
        }
        if let Ok(command) = postcard::from_bytes::<Command>(&bytes) {
            read += 1;
            through_both(&command);
            let mut world = world.clone();
            assert_eq!(world.check(&command), world.execute(&command).map(drop));
            world.step();
        }
    }
    assert!(read > 1_000, "{read}");
}

#[test]
fn the_geometry_of_a_shape_can_be_written() {
    let geometry = |shape: &Shape| serde_json::to_value(shape.geometry()).expect("JSON can say it");
    let corners: Vec<Value> = shapes().iter().map(geometry).collect();
    assert_eq!(corners[0]["circle"]["radius"], fx!(0.1).to_string());
    // About the centre of mass, as it is used.
    let Geometry::Polygon { corners: used } = shapes()[3].geometry().clone() else { panic!("a polygon") };
    assert_eq!(corners[3]["polygon"]["corners"][0]["x"], used[0].x.to_string());
    assert_eq!(corners[6]["rounded_polygon"]["radius"], fx!(0.3).to_string());
    assert_eq!(corners[7]["compound"]["parts"].as_array().map(Vec::len), Some(7));
}

#[cfg(feature = "float")]
#[test]
fn commands_of_the_float_builds_come_back() {
    let shape = Shape::new(Geometry::Rectangle { width: 0.5, height: 1.5 }).expect("fair");
    let body: BodyDef<f64> = BodyDef { angle: 0.1, ..BodyDef::dynamic().with_collider(shape) };
    through_both(&Command::AddBody(body));
    let law = FieldKind::<f64>::Attractor { centre: End::World(Vec2::new(0.25, 3.0)), mu: 0.1, softening: 0.5 };
    through_both(&Command::AddField(ForceField::from(law)));
    through_both(&WorldDef::<f32>::default());
}
