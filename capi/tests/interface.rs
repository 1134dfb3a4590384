//! The functions from a caller's side: what they refuse, and that each does what its namesake in the library does.

use std::ffi::c_char;
use std::fs;
use std::mem::MaybeUninit;
use std::path::Path;
use std::ptr;

use umbra_physics::scalar::ToF64 as _;
use umbra_physics::{
    ApplyOptions, Attachment, BodyDef, BodyId, BodyKind, ColliderDef, ColliderId, Command, ContactSettings, Damping,
    Distance, End, Exclusion, Explosion, FieldId, FieldKind, Filter, ForceField, ForceOrImpulse, Frame, Fx, FxFactor,
    Gear, Integrator, JointDef, JointId, JointKind, JointLimits, JointMotor, JointSpring, Locks, Mass, Material,
    MaterialPair, MixRule, Motor, OneWay, PlanarMotor, PlanarSpring, Prismatic, Pulley, Random, Region, Revolute,
    Shape, Snapshot, SpringConstants, TimeStep, Vec2, Weld, Wheel, World, WorldDef, fx, vec2,
};
use umbra_physics_capi::*;

#[path = "support/out.rs"]
mod support;
use support::{out, own};

/// More than any replay here asks for.
const LIMITS: UmbraReplayLimits =
    UmbraReplayLimits { ticks: 1_000, commands: 1_000, bodies: 100, fields: 100, colliders: 100, pairs: 1 << 20 };

/// A list, in two calls.
fn list<T>(
    mut call: impl FnMut(*mut T, usize, Option<&mut MaybeUninit<usize>>) -> UmbraStatus,
) -> Result<Vec<T>, UmbraStatus> {
    let mut count = MaybeUninit::new(0);
    match call(ptr::null_mut(), 0, Some(&mut count)) {
        UMBRA_OK | UMBRA_ERROR_BUFFER_TOO_SMALL => {}
        status => return Err(status),
    }
    // SAFETY: initialised above.
    let count = unsafe { count.assume_init() };
    let mut rows = Vec::with_capacity(count);
    match call(rows.as_mut_ptr(), count, None) {
        UMBRA_OK => {
            // SAFETY: a call that is done has written as many.
            unsafe { rows.set_len(count) };
            Ok(rows)
        }
        status => Err(status),
    }
}

fn text(
    mut call: impl FnMut(*mut c_char, usize, Option<&mut MaybeUninit<usize>>) -> UmbraStatus,
) -> Result<String, UmbraStatus> {
    let mut length = MaybeUninit::new(0);
    assert_eq!(call(ptr::null_mut(), 0, Some(&mut length)), UMBRA_ERROR_BUFFER_TOO_SMALL);
    // SAFETY: initialised above.
    let length = unsafe { length.assume_init() };
    let mut bytes = vec![b'!'; length + 1];
    assert_eq!(call(bytes.as_mut_ptr().cast(), length, None), UMBRA_ERROR_BUFFER_TOO_SMALL, "no room for the zero");
    assert_eq!(bytes[0], b'!', "nothing is written");
    match call(bytes.as_mut_ptr().cast(), length + 1, None) {
        UMBRA_OK => {
            assert_eq!(bytes.pop(), Some(0));
            Ok(String::from_utf8(bytes).expect("UTF-8"))
        }
        status => Err(status),
    }
}

fn last_message() -> String {
    // SAFETY: the buffers are those of `text`.
    text(|buffer, capacity, length| unsafe { umbra_last_message(buffer, capacity, length) }).expect("a message")
}

fn world() -> Box<UmbraWorld> {
    let def = out(|def| umbra_world_def_default(def)).expect("a definition");
    own(|world| umbra_world_new(Some(&def), world)).expect("a world")
}

fn add(world: &mut UmbraWorld, def: &UmbraBodyDef) -> Result<u64, UmbraStatus> {
    out(|body| umbra_world_add_body(Some(world), Some(def), body))
}

fn body_def() -> UmbraBodyDef {
    out(|def| umbra_body_def_default(def)).expect("a definition")
}

fn state_hash(world: &UmbraWorld) -> u64 {
    out(|hash| umbra_world_state_hash(Some(world), hash)).expect("a hash")
}

fn drafted(draft: &UmbraWorld) -> Vec<u8> {
    // SAFETY: the buffers are those of `list`.
    list(|buffer, capacity, length| unsafe { umbra_draft_command(Some(draft), buffer, capacity, length) })
        .expect("bytes")
}

fn damping(kept: i64) -> Damping {
    Damping::kept_per_second(Fx::from_bits(kept))
}

const BODY: BodyId = BodyId::from_parts(3, 2);
const BODY_WORD: u64 = 2 << 32 | 3;
const FIELD: FieldId = FieldId::from_parts(1, 7);
const FIELD_WORD: u64 = 7 << 32 | 1;
const JOINT: JointId = JointId::from_parts(1, 7);
const ONE: i64 = UMBRA_ONE;

fn fields() -> Vec<(UmbraFieldDef, ForceField)> {
    let def = |law| out(|def| umbra_field_def_default(law, def)).expect("a definition");
    let at = Attachment { body: BODY, point: vec2(1, 2) };
    let point = UmbraVec2 { x: ONE, y: 2 * ONE };
    let mu = FxFactor::parse("3.986004418e14").expect("a number");
    let (mantissa, shift) = mu.parts();
    let spring = SpringConstants { rest: fx!(1), stiffness: fx!(2), damping: fx!(3) };
    let far = Attachment { body: BodyId::from_parts(4, 0), point: vec2(0, 1) };
    vec![
        (
            UmbraFieldDef {
                other_point: point,
                mu: UmbraFactor { mantissa, shift, reserved: 0 },
                softening: ONE,
                ..def(UMBRA_ATTRACTOR)
            },
            FieldKind::Attractor { centre: End::World(vec2(1, 2)), mu, softening: fx!(1) }.into(),
        ),
        (
            UmbraFieldDef { other: BODY_WORD, other_point: point, force_groups: 5, ..def(UMBRA_ATTRACTOR) },
            ForceField {
                kind: FieldKind::Attractor { centre: End::Body(at), mu: FxFactor::default(), softening: fx!(0) },
                force_groups: 5,
            },
        ),
        (
            UmbraFieldDef {
                body: BODY_WORD,
                point,
                other: 4,
                other_point: UmbraVec2 { x: 0, y: ONE },
                rest: ONE,
                stiffness: 2 * ONE,
                damping: 3 * ONE,
                ..def(UMBRA_SPRING)
            },
            FieldKind::Spring { near: at, far: End::Body(far), spring }.into(),
        ),
        (
            UmbraFieldDef { linear: ONE, quadratic: 2 * ONE, wind: point, ..def(UMBRA_DRAG) },
            FieldKind::Drag { linear: fx!(1), quadratic: fx!(2), wind: vec2(1, 2) }.into(),
        ),
        (
            UmbraFieldDef { deceleration: 3 * ONE, angular_deceleration: ONE, ..def(UMBRA_FRICTION) },
            FieldKind::Friction { deceleration: fx!(3), angular_deceleration: fx!(1) }.into(),
        ),
        (
            UmbraFieldDef { body: BODY_WORD, point, force: UmbraVec2 { x: -ONE, y: 1 }, ..def(UMBRA_THRUST) },
            FieldKind::Thrust { at, force: vec2(-1, Fx::DELTA) }.into(),
        ),
        (
            UmbraFieldDef { centre: point, radius: 3 * ONE, acceleration: point, ..def(UMBRA_ZONE) },
            FieldKind::Zone { region: Region::Disc { centre: vec2(1, 2), radius: fx!(3) }, acceleration: vec2(1, 2) }
                .into(),
        ),
        (
            UmbraFieldDef { region: UMBRA_BOX, min: point, max: point, acceleration: point, ..def(UMBRA_ZONE) },
            FieldKind::Zone { region: Region::Box { min: vec2(1, 2), max: vec2(1, 2) }, acceleration: vec2(1, 2) }
                .into(),
        ),
        (
            UmbraFieldDef {
                min: UmbraVec2 { x: -ONE, y: 0 },
                max: point,
                density: 4 * ONE,
                linear_drag: 5 * ONE,
                angular_drag: 6 * ONE,
                flow: point,
                ..def(UMBRA_BUOYANCY)
            },
            FieldKind::Buoyancy {
                min: vec2(-1, 0),
                max: vec2(1, 2),
                density: fx!(4),
                linear_drag: fx!(5),
                angular_drag: fx!(6),
                flow: vec2(1, 2),
            }
            .into(),
        ),
    ]
}

/// A collider of this shape, a capsule, with a value of its own in each field.
fn collider(shape: &UmbraShape) -> (UmbraColliderDef, ColliderDef) {
    let def = UmbraColliderDef {
        position: UmbraVec2 { x: 1, y: 2 },
        angle: 3,
        density: 4,
        friction: 5,
        restitution: 6,
        rolling_resistance: 13,
        surface_speed: 12,
        key: 7,
        user_data: 8,
        category: 9,
        mask: 10,
        group: -11,
        friction_rule: UMBRA_MIX_MEAN,
        restitution_rule: UMBRA_MIX_PRODUCT,
        material_id: 14,
        one_way_direction: UmbraVec2 { x: ONE, y: -ONE },
        one_way_tolerance: 15,
        one_way: 1,
        sensor: 0,
        contact_events: 1,
        hit_events: 1,
        shape,
    };
    let bits = Fx::from_bits;
    let expected = ColliderDef {
        shape: Shape::capsule(fx!(2), fx!(1)).expect("a shape"),
        position: umbra_physics::Vec2::new(bits(1), bits(2)),
        angle: bits(3),
        density: bits(4),
        material: Material {
            friction: bits(5),
            restitution: bits(6),
            rolling_resistance: bits(13),
            surface_speed: bits(12),
            friction_rule: MixRule::Mean,
            restitution_rule: MixRule::Product,
            id: 14,
        },
        filter: Filter { category: 9, mask: 10, group: -11 },
        one_way: Some(OneWay { direction: vec2(1, -1), tolerance: bits(15) }),
        sensor: false,
        contact_events: true,
        hit_events: true,
        key: 7,
        user_data: 8,
    };
    (def, expected)
}

#[test]
fn colliders_are_read_as_they_were_made() {
    let mut world = world();
    let body = add(&mut world, &body_def()).expect("a body");
    let shape = own(|shape| umbra_shape_capsule(2 * ONE, ONE, shape)).expect("a shape");
    let empty = out(|def| umbra_collider_def_default(def)).expect("a definition");
    let plain = UmbraColliderDef { shape: &raw const *shape, ..empty };
    let add = |world: &mut UmbraWorld, def: &UmbraColliderDef| {
        // SAFETY: its shape is null or alive.
        out(|collider| unsafe { umbra_world_add_collider(Some(world), body, Some(def), collider) })
    };
    assert_eq!(add(&mut world, &empty), Err(UMBRA_ERROR_NULL_POINTER));
    assert_eq!(add(&mut world, &UmbraColliderDef { friction: -1, ..plain }), Err(UMBRA_ERROR_OUT_OF_RANGE));
    assert_eq!(umbra_last_cause(), 178);
    let added = [add(&mut world, &plain), add(&mut world, &collider(&shape).0)].map(|added| added.expect("a collider"));
    // SAFETY: the buffers are those of `list`.
    let listed = list(|buffer, capacity, count| unsafe {
        umbra_world_body_colliders(Some(&world), body, buffer, capacity, count)
    });
    assert_eq!(listed, Ok(added.to_vec()));
    let read = out(|def| umbra_world_collider(Some(&world), added[1], def)).expect("it is there");
    assert_eq!((read.position, read.angle, read.density), (UmbraVec2 { x: 1, y: 2 }, 3, 4));
    assert_eq!((read.friction, read.restitution, read.key, read.user_data), (5, 6, 7, 8));
    assert_eq!((read.category, read.mask, read.group, read.shape), (9, 10, -11, ptr::null()));
    assert_eq!((read.sensor, read.contact_events, read.hit_events), (0, 1, 1));
    for bad in [
        UmbraColliderDef { sensor: 2, ..plain },
        UmbraColliderDef { contact_events: 2, ..plain },
        UmbraColliderDef { hit_events: 2, ..plain },
    ] {
        assert_eq!(add(&mut world, &bad), Err(UMBRA_ERROR_BAD_ARGUMENT));
    }
    assert_eq!(out(|body| umbra_world_collider_body(Some(&world), added[1], body)), Ok(body));
    // Shapes are the caller's.
    let again = own(|shape| umbra_world_collider_shape(Some(&world), added[0], shape)).expect("it has one");
    // SAFETY: its shape is alive.
    let replaced = unsafe {
        umbra_world_set_collider(
            Some(&mut world),
            added[1],
            Some(&UmbraColliderDef { shape: &raw const *again, ..plain }),
        )
    };
    assert_eq!(replaced, UMBRA_OK);
    umbra_shape_free(Some(again));
    let kilograms =
        |world: &UmbraWorld| out(|state| umbra_world_body(Some(world), body, state)).map(|state| state.mass);
    let both = kilograms(&world).expect("a mass");
    assert_eq!(umbra_world_remove_collider(Some(&mut world), added[0]), UMBRA_OK);
    let single = kilograms(&world).expect("a mass");
    assert!(both.abs_diff(2 * single) <= 1, "{both} {single}");
    assert_eq!(umbra_world_remove_collider(Some(&mut world), added[0]), UMBRA_ERROR_NO_SUCH_COLLIDER);
    let settings = out(|settings| umbra_contact_settings_default(settings)).expect("settings");
    assert_eq!(out(|settings| umbra_world_contact_settings(Some(&world), settings)), Ok(settings));
    let stiffer = UmbraContactSettings { substeps: 8, ..settings };
    assert_eq!(umbra_world_set_contact_settings(Some(&mut world), Some(&stiffer)), UMBRA_OK);
    assert_eq!(out(|settings| umbra_world_contact_settings(Some(&world), settings)), Ok(stiffer));
    umbra_shape_free(Some(shape));
    umbra_world_free(Some(world));
}

#[test]
fn events_are_those_of_the_library() {
    let text = r#"{"gravity": [0, -10], "bodies": [
        {"name": "floor", "kind": "static", "key": 9, "colliders": [{"shape": {"rectangle": {"width": 20, "height": 2}}, "key": 3}]},
        {"name": "gate", "kind": "static", "position": [0, 2.75], "key": 2, "colliders": [
            {"shape": {"rectangle": {"width": 2, "height": 1}}, "sensor": true}]},
        {"name": "ball", "position": [0, 4], "key": 5, "colliders": [
            {"shape": {"circle": {"radius": 0.5}}, "contact_events": true, "hit_events": true, "restitution": 0.8}]}]}"#;
    // SAFETY: the text is of that length.
    let mut here =
        own(|world| unsafe { umbra_world_from_scene(text.as_ptr().cast(), text.len(), 100, world) }).expect("a world");
    let scene = umbra_scene::Scene::parse(text).expect("a scene");
    let mut rust_world = scene.start::<Fx>().expect("it starts").into_world();
    type Pairs = unsafe extern "C" fn(
        Option<&UmbraWorld>,
        *mut UmbraColliderPair,
        usize,
        Option<&mut std::mem::MaybeUninit<usize>>,
    ) -> UmbraStatus;
    let pairs = |world: &UmbraWorld, list_of: Pairs| {
        // SAFETY: the buffers are those of `list`.
        list(|buffer, capacity, count| unsafe { list_of(Some(world), buffer, capacity, count) }).expect("a list")
    };
    let word = |(slot, generation): (u32, u32)| u64::from(generation) << 32 | u64::from(slot);
    let pair = |pair: &umbra_physics::ColliderPair| UmbraColliderPair {
        colliders: pair.colliders.map(|collider| word(collider.parts())),
        bodies: pair.bodies.map(|body| word(body.parts())),
        collider_keys: pair.collider_keys,
        body_keys: pair.body_keys,
    };
    let mut met = [0; 6];
    for _ in 0..90 {
        assert_eq!(umbra_world_step(Some(&mut here)), UMBRA_OK);
        let report = rust_world.step();
        let lists = [report.contacts_ended, report.contacts_began, report.sensors_left, report.sensors_entered];
        let calls: [Pairs; 4] = [
            umbra_world_contacts_ended,
            umbra_world_contacts_began,
            umbra_world_sensors_left,
            umbra_world_sensors_entered,
        ];
        let summary = out(|report| umbra_world_report(Some(&here), report)).expect("a report");
        let counts = [summary.contacts_ended, summary.contacts_began, summary.sensors_left, summary.sensors_entered];
        for (i, (list, call)) in lists.into_iter().zip(calls).enumerate() {
            assert_eq!(pairs(&here, call), list.iter().map(pair).collect::<Vec<_>>());
            assert_eq!(counts[i], list.len() as u64);
            met[i] += list.len();
        }
        // SAFETY: the buffers are those of `list`.
        let hits =
            list(|buffer, capacity, count| unsafe { umbra_world_contact_hits(Some(&here), buffer, capacity, count) });
        let hits = hits.expect("a list");
        assert_eq!((hits.len(), summary.hits), (report.hits.len(), report.hits.len() as u64));
        for (hit, expected) in hits.iter().zip(report.hits) {
            assert_eq!((hit.pair, hit.parts), (pair(&expected.pair), expected.parts));
            assert_eq!(hit.approach_speed, expected.approach_speed.to_bits());
            assert_eq!(hit.normal_impulse, expected.normal_impulse.to_bits());
            assert_eq!((hit.normal.x, hit.normal.y), (expected.normal.x.to_bits(), expected.normal.y.to_bits()));
            assert_eq!((hit.point.x, hit.point.y), (expected.point.x.to_bits(), expected.point.y.to_bits()));
        }
        met[4] += hits.len();
        let overlaps: Vec<_> = rust_world.sensor_overlaps().map(|overlap| pair(&overlap)).collect();
        met[5] += overlaps.len();
        assert_eq!(pairs(&here, umbra_world_sensor_overlaps), overlaps);
    }
    assert!(met.iter().all(|count| *count > 0), "{met:?}");
    umbra_world_free(Some(here));
}

#[test]
fn contacts_are_those_of_the_library() {
    let text = r#"{"gravity": [0, -10], "bodies": [
        {"name": "floor", "kind": "static", "colliders": [{"shape": {"rectangle": {"width": 20, "height": 2}}}]},
        {"name": "crate", "position": [0, 1.5], "velocity": [3, 0], "colliders": [{"shape": {"rectangle": {"width": 1, "height": 1}}}]},
        {"name": "ball", "position": [4, 1.5], "colliders": [{"shape": {"circle": {"radius": 0.5}}}]}]}"#;
    // SAFETY: the text is of that length.
    let mut here =
        own(|world| unsafe { umbra_world_from_scene(text.as_ptr().cast(), text.len(), 100, world) }).expect("a world");
    let scene = umbra_scene::Scene::parse(text).expect("a scene");
    let mut rust_world = scene.start::<Fx>().expect("it starts").into_world();
    let contacts = |world: &UmbraWorld| {
        // SAFETY: the buffers are those of `list`.
        list(|buffer, capacity, count| unsafe { umbra_world_contacts(Some(world), buffer, capacity, count) })
    };
    assert_eq!(contacts(&here), Ok(Vec::new()));
    for _ in 0..20 {
        assert_eq!(umbra_world_step(Some(&mut here)), UMBRA_OK);
        rust_world.step();
    }
    let contacts_of_c = contacts(&here).expect("a list");
    let expected: Vec<_> = rust_world.contacts().collect();
    assert_eq!((contacts_of_c.len(), expected.len()), (2, 2));
    let word = |(slot, generation): (u32, u32)| u64::from(generation) << 32 | u64::from(slot);
    let vector = |vector: umbra_physics::Vec2| UmbraVec2 { x: vector.x.to_bits(), y: vector.y.to_bits() };
    for (row, expected) in contacts_of_c.iter().zip(&expected) {
        assert_eq!(row.colliders, expected.colliders.map(|collider| word(collider.parts())));
        assert_eq!(row.bodies, expected.bodies.map(|body| word(body.parts())));
        assert_eq!(
            (row.normal, row.tangent_impulse, row.rolling_impulse),
            (vector(expected.normal), expected.tangent_impulse.to_bits(), expected.rolling_impulse.to_bits())
        );
        assert_eq!((row.point_count as usize, row.reserved), (expected.points().len(), 0));
        for (i, point) in row.points.iter().enumerate() {
            let expected = expected.points().get(i).map(|point| UmbraContactPoint {
                position: vector(point.position),
                separation: point.separation.to_bits(),
                normal_impulse: point.normal_impulse.to_bits(),
            });
            assert_eq!(*point, expected.unwrap_or_default());
        }
    }
    let of_floor = list(|buffer, capacity, count| {
        // SAFETY: the buffers are those of `list`.
        unsafe { umbra_world_body_contacts(Some(&here), contacts_of_c[1].bodies[1], buffer, capacity, count) }
    });
    assert_eq!(of_floor, Ok(vec![contacts_of_c[1]]));
    // The crate slides on two corners, the ball lies on one point.
    assert_eq!((contacts_of_c[0].point_count, contacts_of_c[1].point_count), (2, 1));
    assert!(
        contacts_of_c[0].tangent_impulse < 0 && contacts_of_c[0].points.iter().all(|point| point.normal_impulse > 0)
    );
    umbra_world_free(Some(here));
}

/// Leaves out the collider with this `user_data`, and counts the calls.
unsafe extern "C" fn is_other(context: *mut std::ffi::c_void, _: u64, user_data: u64) -> u32 {
    // SAFETY: the test below gives a number.
    let calls = unsafe { &mut *context.cast::<u32>() };
    *calls += 1;
    u32::from(user_data != 7)
}

/// A character falls onto a floor, walks along it, rides on it and pushes a crate; and each value out of range is refused.
#[test]
fn a_character_moves_as_in_the_library() {
    let mut world = world();
    let part = |x: i64, y: i64| UmbraVec2 { x: x * UMBRA_ONE / 4, y: y * UMBRA_ONE / 4 };
    let [floor, crate_, box_] = [(80, 4), (4, 4), (4, 4)].map(|(width, height)| {
        let (width, height) = (width * UMBRA_ONE / 4, height * UMBRA_ONE / 4);
        own(|shape| umbra_shape_rectangle(width, height, shape)).expect("a shape")
    });
    let plain = out(|def| umbra_collider_def_default(def)).expect("a definition");
    let mut put = |kind, velocity, position, shape: &UmbraShape| {
        let body = add(&mut world, &UmbraBodyDef { kind, velocity, position, ..body_def() }).expect("a body");
        let def = UmbraColliderDef { shape, ..plain };
        // SAFETY: the shape is alive.
        let collider = out(|id| unsafe { umbra_world_add_collider(Some(&mut world), body, Some(&def), id) });
        (body, collider.expect("a collider"))
    };
    // Its surface is at y = 0, and it moves to the right with 3 m/s.
    let (ground, ground_collider) = put(UMBRA_KINEMATIC, part(12, 0), part(0, -2), &floor);
    let (pushed, pushed_collider) = put(UMBRA_DYNAMIC, part(0, 0), part(8, 2), &crate_);
    let def = out(|def| umbra_character_def_default(def)).expect("a definition");
    let hero = UmbraCharacterDef { shape: &raw const *box_, push_mass: 3 * UMBRA_ONE, ..def };
    let air = UmbraGround { body: UMBRA_NO_HANDLE, local: part(0, 0), point: part(0, 0) };
    let go = |world: &UmbraWorld, hero: &UmbraCharacterDef, way: &UmbraCharacterMove| {
        // SAFETY: the shape is alive.
        let movement =
            own(|movement| unsafe { umbra_character_move(Some(world), Some(hero), Some(way), None, movement) })?;
        let state = out(|state| umbra_movement_state(Some(&movement), state)).expect("a state");
        // SAFETY: the buffers are those of `list`.
        let hits = list(|rows, room, count| unsafe { umbra_movement_hits(Some(&movement), rows, room, count) });
        // SAFETY: likewise.
        let pushes = list(|rows, room, count| unsafe { umbra_movement_pushes(Some(&movement), rows, room, count) });
        umbra_movement_free(Some(movement));
        Ok::<_, UmbraStatus>((state, hits.expect("hits"), pushes.expect("pushes")))
    };
    let still =
        UmbraCharacterMove { position: part(0, 8), translation: part(0, 0), ground: air, before_step: 0, reserved: 0 };
    let fall = UmbraCharacterMove { translation: part(0, -8), ..still };
    let (fallen, hits, pushes) = go(&world, &hero, &fall).expect("a movement");
    assert_eq!((fallen.ground.body, fallen.ground_collider), (ground, ground_collider));
    assert_eq!((fallen.ground_normal, fallen.ground_velocity, fallen.desired), (part(0, 4), part(12, 0), part(0, -8)));
    assert_eq!((fallen.is_overlapping, fallen.position.x, pushes.len()), (0, 0, 0));
    // Half its height above the floor, and the skin of 1/64 m, within 6 ulps.
    assert!((fallen.position.y - UMBRA_ONE / 2 - UMBRA_ONE / 64).abs() <= 6, "{}", fallen.position.y);
    let [hit] = hits[..] else { panic!("{hits:?}") };
    assert_eq!((hit.collider, hit.body, hit.normal, hit.part), (ground_collider, ground, part(0, 4), 0));
    // In the air nothing is given.
    let (flying, ..) = go(&world, &hero, &UmbraCharacterMove { translation: part(0, 1), ..fall }).expect("a movement");
    assert_eq!((flying.ground, flying.ground_collider), (air, UMBRA_NO_HANDLE));
    assert_eq!((flying.position, flying.ground_normal, flying.ground_velocity), (part(0, 9), part(0, 0), part(0, 0)));
    // It meets the crate, of 1 kg, at 1 m/s a step and pushes it.
    let walk = UmbraCharacterMove { position: fallen.position, translation: part(8, 0), ..still };
    let (walked, hits, pushes) = go(&world, &hero, &walk).expect("a movement");
    let gone = walked.position.x - fallen.position.x;
    assert!((gone + walked.held_back.x - 2 * UMBRA_ONE).abs() <= 2 && walked.held_back.x > UMBRA_ONE, "{walked:?}");
    assert_eq!(fallen.held_back, part(0, 0));
    assert!(hits.iter().any(|hit| hit.collider == pushed_collider), "{hits:?}");
    let [push] = pushes[..] else { panic!("{pushes:?}") };
    assert!(push.body == pushed && push.impulse.x > UMBRA_ONE && push.impulse.y == 0, "{push:?}");
    let weak = UmbraCharacterDef { push_mass: 0, ..hero };
    assert_eq!(go(&world, &weak, &walk).expect("a movement").2, []);
    // It rides: a tick takes the floor 3/60 m along.
    assert_eq!(umbra_world_step(Some(&mut world)), UMBRA_OK);
    let ride = UmbraCharacterMove { position: fallen.position, ground: fallen.ground, ..still };
    let (ridden, ..) = go(&world, &hero, &ride).expect("a movement");
    assert!((ridden.position.x - UMBRA_ONE / 20).abs() < 8, "{}", ridden.position.x);
    // Before the next step it goes to where that will take the floor.
    let (ahead, ..) = go(&world, &hero, &UmbraCharacterMove { before_step: 1, ..ride }).expect("a movement");
    assert!((ahead.position.x - UMBRA_ONE / 10).abs() < 16, "{}", ahead.position.x);
    assert_eq!(
        go(&world, &hero, &UmbraCharacterMove { before_step: 2, ..ride }).map(drop),
        Err(UMBRA_ERROR_BAD_ARGUMENT)
    );
    // 4 N·s a metre on a box that is 1 m tall, 3 m away at half the strength.
    let blast = UmbraExplosion {
        position: part(-12, 0),
        radius: 2 * UMBRA_ONE,
        falloff: UMBRA_ONE,
        impulse: 4 * UMBRA_ONE,
        mask: 0,
        reserved: 0,
    };
    let impulse = out(|impulse| umbra_explosion_impulse_on(Some(&blast), Some(&box_), 0, 0, 0, impulse));
    assert_eq!(impulse, Ok(part(8, 0)));
    for (bad, cause) in [
        (UmbraCharacterDef { skin: 0, ..hero }, 190),
        (UmbraCharacterDef { up: part(0, 0), ..hero }, 191),
        (UmbraCharacterDef { max_slope: -1, ..hero }, 192),
        (UmbraCharacterDef { max_rest_slope: 2 * UMBRA_ONE, ..hero }, 192),
        (UmbraCharacterDef { step_height: 17 * UMBRA_ONE, ..hero }, 193),
        (UmbraCharacterDef { step_width: -1, ..hero }, 193),
        (UmbraCharacterDef { snap: -1, ..hero }, 193),
        (UmbraCharacterDef { push_mass: -1, ..hero }, 155),
    ] {
        assert_eq!(go(&world, &bad, &walk).map(drop), Err(UMBRA_ERROR_OUT_OF_RANGE), "{bad:?}");
        assert_eq!(umbra_last_cause(), cause, "{bad:?}");
    }
    let far = UmbraCharacterMove { translation: part(2_000, 0), ..walk };
    assert_eq!(go(&world, &hero, &far).map(drop), Err(UMBRA_ERROR_OUT_OF_RANGE));
    assert_eq!(umbra_last_cause(), 194);
    assert_eq!(go(&world, &def, &walk).map(drop), Err(UMBRA_ERROR_NULL_POINTER));
}

#[test]
fn queries_are_those_of_the_library() {
    let mut world = world();
    let disc = own(|shape| umbra_shape_circle(UMBRA_ONE, shape)).expect("a disc");
    let plain = out(|def| umbra_collider_def_default(def)).expect("a definition");
    let mut added = Vec::new();
    for (x, category, user_data) in [(3, 1, 7), (6, 2, 0), (9, 4, 0)] {
        let place = UmbraVec2 { x: x * UMBRA_ONE, y: 0 };
        let body = add(&mut world, &UmbraBodyDef { position: place, ..body_def() }).expect("a body");
        let def = UmbraColliderDef { category, user_data, shape: &raw const *disc, ..plain };
        // SAFETY: the shape is alive.
        let collider = out(|id| unsafe { umbra_world_add_collider(Some(&mut world), body, Some(&def), id) });
        added.push((body, collider.expect("a collider")));
    }
    let w = Some(&*world);
    let ray = UmbraRay { origin: UmbraVec2::default(), translation: UmbraVec2 { x: 16 * UMBRA_ONE, y: 0 } };
    let away = UmbraRay { translation: UmbraVec2 { x: -UMBRA_ONE, y: 0 }, ..ray };
    let point = |x: i64| UmbraVec2 { x: x * UMBRA_ONE, y: 0 };
    let all = |filter: Option<&UmbraQueryFilter>, ties: u32| {
        // SAFETY: the buffers are those of `list`, the lists of the filter are alive.
        list(|hits, room, count| unsafe { umbra_world_cast_ray_all(w, Some(&ray), ties, filter, hits, room, count) })
            .map(|hits: Vec<UmbraCastHit>| hits.iter().map(|hit| hit.collider).collect::<Vec<_>>())
    };
    let colliders: Vec<u64> = added.iter().map(|pair| pair.1).collect();
    assert_eq!((all(None, 0), all(None, 1)), (Ok(colliders.clone()), Ok(colliders[..1].to_vec())));
    assert_eq!(all(None, 2), Err(UMBRA_ERROR_BAD_ARGUMENT));
    // Each part of a filter.
    let every = out(|filter| umbra_query_filter_default(filter)).expect("a filter");
    assert_eq!(all(Some(&every), 0), Ok(colliders.clone()));
    assert_eq!(all(Some(&UmbraQueryFilter { mask: 5, ..every }), 0), Ok(vec![colliders[0], colliders[2]]));
    let without = UmbraQueryFilter {
        without_bodies: &raw const added[0].0,
        without_body_count: 1,
        without_colliders: &raw const colliders[1],
        without_collider_count: 1,
        ..every
    };
    assert_eq!(all(Some(&without), 0), Ok(vec![colliders[2]]));
    let mut calls = 0_u32;
    let asking = UmbraQueryFilter { predicate: Some(is_other), context: (&raw mut calls).cast(), ..every };
    let mut hits = [UmbraCastHit::default(); 2];
    // SAFETY: there are two of each, and the condition gets its number.
    let status = unsafe { umbra_world_cast_rays(w, [ray, away].as_ptr(), hits.as_mut_ptr(), 2, Some(&asking)) };
    assert_eq!((status, calls), (UMBRA_OK, 2));
    let expected = UmbraCastHit {
        collider: added[1].1,
        body: added[1].0,
        fraction: UMBRA_ONE / 16 * 5,
        point: point(5),
        normal: point(-1),
        part: 0,
        is_hit: 1,
    };
    assert_eq!(hits, [expected, UmbraCastHit::default()]);
    // SAFETY: no filter.
    let any = |ray| out(|is_hit| unsafe { umbra_world_cast_ray_any(w, Some(ray), None, is_hit) });
    assert_eq!((any(&ray), any(&away)), (Ok(1), Ok(0)));
    let far = UmbraRay { translation: UmbraVec2 { x: i64::MAX, y: 0 }, ..ray };
    assert_eq!(any(&far), Err(UMBRA_ERROR_OUT_OF_RANGE));
    // SAFETY: the buffers are those of `list`.
    let cast = list(|hits, room, count| unsafe {
        let sixteen = 16 * UMBRA_ONE;
        umbra_world_cast_shape(w, Some(&disc), 0, 0, 0, sixteen, 0, 0, None, hits, room, count)
    });
    let cast: Vec<UmbraCastHit> = cast.expect("hits");
    assert_eq!((cast.len(), cast[0].fraction, cast[0].point), (3, UMBRA_ONE / 16, point(2)));
    // SAFETY: the buffers are those of `list`.
    let near_disc = list(|buffer, room, count| unsafe {
        umbra_world_overlap_shape(w, Some(&disc), 8 * UMBRA_ONE, 0, 0, None, buffer, room, count)
    });
    assert_eq!(near_disc, Ok(vec![colliders[1], colliders[2]]));
    // SAFETY: the buffers are those of `list`.
    let in_box = list(|buffer, room, count| unsafe {
        umbra_world_overlap_box(w, 0, -UMBRA_ONE, 2 * UMBRA_ONE, UMBRA_ONE, None, buffer, room, count)
    });
    assert_eq!(in_box, Ok(vec![colliders[0]]));
    // SAFETY: no filter.
    let closest =
        |metres: i64| out(|place| unsafe { umbra_world_closest_point(w, 0, 0, metres * UMBRA_ONE, None, place) });
    let closest_point = closest(4).expect("an answer");
    assert_eq!(
        (closest_point.collider, closest_point.body, closest_point.distance, closest_point.point),
        (added[0].1, added[0].0, 2 * UMBRA_ONE, point(2))
    );
    assert_eq!((closest_point.is_found, closest(1)), (1, Ok(UmbraClosestPoint::default())));
    // SAFETY: the buffers are those of `list`.
    let nearby = list(|buffer, room, count| unsafe {
        umbra_world_closest_points(w, 0, 0, 5 * UMBRA_ONE, None, buffer, room, count)
    });
    let points: Vec<UmbraClosestPoint> = nearby.expect("points");
    assert_eq!(points.iter().map(|point| point.collider).collect::<Vec<_>>(), colliders[..2]);
    // A shape alone.
    let inside = |x: i64| out(|inside| umbra_shape_contains(Some(&disc), x, 0, inside));
    assert_eq!((inside(UMBRA_ONE), inside(UMBRA_ONE + 1)), (Ok(1), Ok(0)));
    let surface_point =
        out(|surface_point| umbra_shape_closest_point(Some(&disc), 3 * UMBRA_ONE, 0, surface_point)).expect("a point");
    assert_eq!((surface_point.distance, surface_point.point, surface_point.is_found), (2 * UMBRA_ONE, point(1), 1));
    let back = UmbraRay { origin: point(4), translation: point(-4) };
    let hit = out(|hit| umbra_shape_cast_ray(Some(&disc), Some(&back), hit)).expect("a hit");
    assert_eq!((hit.fraction, hit.point, hit.normal, hit.is_hit), (UMBRA_ONE / 4 * 3, point(1), point(1), 1));
    // Two shapes: 3 m apart, overlapping by ½ m, and on their way.
    let between =
        |x: i64| out(|distance| umbra_shape_distance_to(Some(&disc), 0, 0, 0, Some(&disc), x, 0, 0, distance));
    let distance = between(5 * UMBRA_ONE).expect("a distance");
    assert_eq!((distance.separation, distance.normal, distance.part), (3 * UMBRA_ONE, point(1), 0));
    assert_eq!((distance.point, distance.second_point, distance.second_part), (point(1), point(4), 0));
    assert_eq!(between(UMBRA_ONE / 2 * 3).map(|distance| distance.separation), Ok(-UMBRA_ONE / 2));
    assert_eq!(between(UMBRA_ONE << 30), Err(UMBRA_ERROR_OUT_OF_RANGE));
    let still = UmbraSweep { position: point(5), ..UmbraSweep::default() };
    let way = |metres: i64| UmbraSweep { translation: point(metres), rotation: UMBRA_ONE, ..UmbraSweep::default() };
    let impact = |sweep: UmbraSweep| {
        out(|impact| umbra_shape_time_of_impact(Some(&disc), Some(&sweep), Some(&disc), Some(&still), impact))
    };
    let hit = impact(way(12)).expect("in range");
    assert_eq!((hit.is_hit, hit.distance.normal), (1, point(1)));
    assert!((UMBRA_ONE / 4 - hit.fraction).unsigned_abs() < 64, "{hit:?}");
    assert_eq!(impact(way(2)), Ok(UmbraShapeImpact::default()));
    assert_eq!(impact(way(1 << 21)), Err(UMBRA_ERROR_OUT_OF_RANGE));
    umbra_shape_free(Some(disc));
    umbra_world_free(Some(world));
}

#[test]
fn excluded_pairs_are_listed() {
    let mut here = world();
    let [a, b] = [0, 1].map(|_| add(&mut here, &body_def()).expect("a body"));
    assert_eq!(umbra_world_exclude_pair(Some(&mut here), b, a, UMBRA_EXCLUDE_UNTIL_APART), UMBRA_OK);
    // SAFETY: `list` gives a buffer of that length.
    let pairs =
        list(|buffer, capacity, count| unsafe { umbra_world_excluded_pairs(Some(&here), buffer, capacity, count) });
    let pairs = pairs.expect("a list");
    assert_eq!(pairs.len(), 1);
    assert_eq!((pairs[0].bodies, pairs[0].exclusion), ([a, b], UMBRA_EXCLUDE_UNTIL_APART));
    assert_eq!(umbra_world_exclude_pair(Some(&mut here), a, b, 9), UMBRA_ERROR_BAD_ARGUMENT);
    umbra_world_free(Some(here));
}

/// A draft shows what a function asks of the library, to the bit.
#[test]
fn every_change_is_the_command_of_its_name() {
    let mut draft = own(|draft| umbra_draft_new(draft)).expect("a draft");
    let mut cases = std::collections::BTreeSet::new();
    let mut is = |draft: &UmbraWorld, status: UmbraStatus, command: Command| {
        assert_eq!(status, UMBRA_OK, "{command:?}");
        let bytes = drafted(draft);
        assert_eq!(Command::from_bytes(&bytes), Ok(command));
        cases.insert(bytes[0]);
    };
    macro_rules! changes {
        ($($call:ident($($argument:expr),*) => $command:expr;)*) => {
            $({
                let status = $call(Some(&mut draft), $($argument),*);
                is(&draft, status, $command);
            })*
        };
    }
    let (body, point) = (BODY, UmbraVec2 { x: 4, y: 5 });
    let bits = Fx::from_bits;
    let pair = |x, y| umbra_physics::Vec2::new(bits(x), bits(y));
    let shape = own(|shape| umbra_shape_capsule(2 * ONE, ONE, shape)).expect("a shape");
    let force = ForceOrImpulse::Force { force: pair(6, 7), point: Some(pair(4, 5)) };
    let impulse = ForceOrImpulse::Impulse { impulse: pair(6, 7), point: None };
    let body_frame = ApplyOptions { frame: Frame::Body, wake: true };
    let no_wake = ApplyOptions { frame: Frame::World, wake: false };
    let both = UMBRA_BODY_FRAME | UMBRA_NO_WAKE;
    let coefficients = UmbraMaterialPair { friction: 1, restitution: 2, rolling_resistance: 3 };
    let settings = UmbraContactSettings {
        push_speed: 1,
        restitution_speed: 2,
        sleep_speed: 6,
        hit_speed: 7,
        substeps: 3,
        max_pairs: 4,
        max_pairs_per_collider: 5,
        reserved: 0,
    };
    changes! {
        umbra_world_remove_body(BODY_WORD) => Command::RemoveBody(body);
        umbra_world_set_position(BODY_WORD, 1, 2) => Command::SetPosition { body, position: pair(1, 2) };
        umbra_world_set_angle(BODY_WORD, 3) => Command::SetAngle { body, angle: bits(3) };
        umbra_world_set_velocity(BODY_WORD, -4, 5) => Command::SetVelocity { body, velocity: pair(-4, 5) };
        umbra_world_set_angular_velocity(BODY_WORD, 6) => Command::SetAngularVelocity { body, velocity: bits(6) };
        umbra_world_set_mass(BODY_WORD, UMBRA_MASS_FROM_COLLIDERS, 7, 8) => Command::SetMass { body, mass: Mass::FromColliders };
        umbra_world_set_mass(BODY_WORD, UMBRA_MASS_KILOGRAMS, 7, 8) => Command::SetMass { body, mass: Mass::Kilograms(bits(7)) };
        umbra_world_set_mass(BODY_WORD, UMBRA_MASS_EXPLICIT, 7, 8) =>
            Command::SetMass { body, mass: Mass::Explicit { mass: bits(7), inertia: bits(8) } };
        umbra_world_set_kind(BODY_WORD, UMBRA_STATIC) => Command::SetKind { body, kind: BodyKind::Static };
        umbra_world_set_kind(BODY_WORD, UMBRA_KINEMATIC) => Command::SetKind { body, kind: BodyKind::Kinematic };
        umbra_world_set_kind(BODY_WORD, UMBRA_DYNAMIC) => Command::SetKind { body, kind: BodyKind::Dynamic };
        umbra_world_set_gravity_scale(BODY_WORD, 9) => Command::SetGravityScale { body, scale: bits(9) };
        umbra_world_set_body_kept_per_second(BODY_WORD, 10, UMBRA_AS_WORLD) =>
            Command::SetBodyDamping { body, linear: Some(damping(10)), angular: None };
        umbra_world_set_body_kept_per_second(BODY_WORD, UMBRA_AS_WORLD, 11) =>
            Command::SetBodyDamping { body, linear: None, angular: Some(damping(11)) };
        umbra_world_exclude_pair(BODY_WORD, 3, UMBRA_EXCLUDE_UNTIL_APART) => Command::ExcludePair {
            a: body,
            b: BodyId::from_parts(3, 0),
            exclusion: Exclusion::UntilApart,
        };
        umbra_world_exclude_pair(3, BODY_WORD, UMBRA_EXCLUDE_ALWAYS) => Command::ExcludePair {
            a: BodyId::from_parts(3, 0),
            b: body,
            exclusion: Exclusion::Always,
        };
        umbra_world_allow_pair(BODY_WORD, 3) => Command::AllowPair { a: body, b: BodyId::from_parts(3, 0) };
        umbra_world_set_dominance(BODY_WORD, -12) => Command::SetDominance { body, dominance: -12 };
        umbra_world_explode(Some(&UmbraExplosion {
            position: UmbraVec2 { x: UMBRA_ONE, y: 2 * UMBRA_ONE },
            radius: 3 * UMBRA_ONE,
            falloff: 4 * UMBRA_ONE,
            impulse: 5 * UMBRA_ONE,
            mask: 6,
            reserved: 0,
        })) => Command::Explode(Explosion { position: vec2(1, 2), radius: fx!(3), falloff: fx!(4), impulse: fx!(5), mask: 6 });
        umbra_world_set_bullet(BODY_WORD, 1) => Command::SetBullet { body, bullet: true };
        umbra_world_set_force_groups(BODY_WORD, 12) => Command::SetForceGroups { body, force_groups: 12 };
        umbra_world_set_key(BODY_WORD, u64::MAX) => Command::SetKey { body, key: u64::MAX };
        umbra_world_set_user_data(BODY_WORD, 14) => Command::SetUserData { body, user_data: 14 };
        umbra_world_set_locks(BODY_WORD, UMBRA_LOCK_X | UMBRA_LOCK_ROTATION) =>
            Command::SetLocks { body, locks: Locks { x: true, y: false, rotation: true } };
        umbra_world_set_locks(BODY_WORD, UMBRA_LOCK_Y) =>
            Command::SetLocks { body, locks: Locks { x: false, y: true, rotation: false } };
        umbra_world_set_max_speeds(BODY_WORD, 0, UMBRA_NO_LIMIT) =>
            Command::SetMaxSpeeds { body, linear: Some(bits(0)), angular: None };
        umbra_world_set_max_speeds(BODY_WORD, UMBRA_NO_LIMIT, 15) =>
            Command::SetMaxSpeeds { body, linear: None, angular: Some(bits(15)) };
        umbra_world_disable(BODY_WORD) => Command::Disable(body);
        umbra_world_enable(BODY_WORD) => Command::Enable(body);
        umbra_world_move_to(BODY_WORD, 1, 2, 3) => Command::MoveTo { body, position: pair(1, 2), angle: bits(3) };
        umbra_world_wake(BODY_WORD) => Command::Wake(body);
        umbra_world_sleep(BODY_WORD) => Command::Sleep(body);
        umbra_world_release(BODY_WORD) => Command::Release(body);
        umbra_world_remove_collider(FIELD_WORD) => Command::RemoveCollider(ColliderId::from_parts(1, 7));
        umbra_world_set_mass(BODY_WORD, UMBRA_MASS_FROM_COLLIDERS, 7, 8) =>
            Command::SetMass { body, mass: Mass::FromColliders };
        umbra_world_set_contact_settings(Some(&settings)) => Command::SetContactSettings(ContactSettings {
            substeps: 3,
            push_speed: bits(1),
            restitution_speed: bits(2),
            sleep_speed: bits(6),
            hit_speed: bits(7),
            max_pairs: 4,
            max_pairs_per_collider: 5,
        });
        umbra_world_set_material_pair(6, 7, Some(&coefficients)) => Command::SetMaterialPair {
            first: 6,
            second: 7,
            pair: Some(MaterialPair { friction: bits(1), restitution: bits(2), rolling_resistance: bits(3) }),
        };
        umbra_world_remove_material_pair(6, 7) => Command::SetMaterialPair { first: 6, second: 7, pair: None };
        umbra_world_remove_field(FIELD_WORD) => Command::RemoveField(FIELD);
        umbra_world_remove_joint(FIELD_WORD) => Command::RemoveJoint(JOINT);
        umbra_world_enable_joint(FIELD_WORD, 0) => Command::EnableJoint { joint: JOINT, enabled: false };
        umbra_world_set_joint_break(FIELD_WORD, 7) => Command::SetJointBreak { joint: JOINT, force: Some(bits(7)) };
        umbra_world_set_joint_break(FIELD_WORD, UMBRA_NO_LIMIT) => Command::SetJointBreak { joint: JOINT, force: None };
        umbra_world_set_joint_break_torque(FIELD_WORD, 7) => Command::SetJointBreakTorque { joint: JOINT, torque: Some(bits(7)) };
        umbra_world_set_joint_break_torque(FIELD_WORD, UMBRA_NO_LIMIT) =>
            Command::SetJointBreakTorque { joint: JOINT, torque: None };
        umbra_world_set_joint_motor(FIELD_WORD, 7, 8) =>
            Command::SetJointMotor { joint: JOINT, motor: Some(JointMotor { speed: bits(7), max_force: bits(8) }) };
        umbra_world_set_joint_motor(FIELD_WORD, 7, UMBRA_NO_LIMIT) => Command::SetJointMotor { joint: JOINT, motor: None };
        umbra_world_set_time_step(1001, 60_000) => Command::SetTimeStep(TimeStep::ratio(1001, 60_000));
        umbra_world_set_gravity(15, -16) => Command::SetGravity(pair(15, -16));
        umbra_world_set_kept_per_second(17, 18) => Command::SetDamping { linear: damping(17), angular: damping(18) };
        umbra_world_set_sleep_after(UMBRA_NEVER) => Command::SetSleepAfter(None);
        umbra_world_set_sleep_after(1) => Command::SetSleepAfter(Some(1));
        umbra_world_seed(42) => Command::SetRandom(Random::seeded(42));
        umbra_world_clear_forces() => Command::ClearForces;
        umbra_world_apply_force(BODY_WORD, 6, 7, Some(&point), UMBRA_BODY_FRAME) =>
            Command::Apply { body, action: force, options: body_frame };
        umbra_world_apply_impulse(BODY_WORD, 6, 7, None, UMBRA_NO_WAKE) =>
            Command::Apply { body, action: impulse, options: no_wake };
        umbra_world_apply_torque(BODY_WORD, 8, 0) =>
            Command::Apply { body, action: ForceOrImpulse::Torque(bits(8)), options: ApplyOptions::default() };
        umbra_world_apply_angular_impulse(BODY_WORD, 9, both) => Command::Apply {
            body,
            action: ForceOrImpulse::AngularImpulse(bits(9)),
            options: ApplyOptions { frame: Frame::Body, wake: false },
        };
    }
    let integrators = [
        (UMBRA_EXPLICIT_EULER, Integrator::ExplicitEuler),
        (UMBRA_SYMPLECTIC_EULER, Integrator::SymplecticEuler),
        (UMBRA_VELOCITY_VERLET, Integrator::VelocityVerlet),
        (UMBRA_PUBLISHED_VERLET, Integrator::PublishedVerlet),
        (UMBRA_YOSHIDA4, Integrator::Yoshida4),
    ];
    for (number, integrator) in integrators {
        changes! { umbra_world_set_integrator(number) => Command::SetIntegrator(integrator); }
    }
    // SAFETY: the bytes are there.
    let status = unsafe { umbra_world_set_blob(Some(&mut draft), b"game".as_ptr(), 4) };
    is(&draft, status, Command::SetBlob(b"game".to_vec()));
    for (def, field) in fields() {
        assert_eq!(out(|id| umbra_world_add_field(Some(&mut draft), Some(&def), id)), Ok(UMBRA_NO_HANDLE));
        is(&draft, UMBRA_OK, Command::AddField(field));
        let status = umbra_world_set_field(Some(&mut draft), FIELD_WORD, Some(&def));
        is(&draft, status, Command::SetField { id: FIELD, field });
    }
    let def = UmbraBodyDef {
        kind: UMBRA_KINEMATIC,
        mass_kind: UMBRA_MASS_EXPLICIT,
        mass: 1,
        inertia: 2,
        position: UmbraVec2 { x: 3, y: 4 },
        velocity: UmbraVec2 { x: 5, y: 6 },
        angle: 7,
        angular_velocity: 8,
        gravity_scale: 9,
        linear_kept_per_second: 10,
        angular_kept_per_second: 11,
        max_speed: 15,
        max_angular_speed: 16,
        key: 12,
        user_data: 13,
        force_groups: 14,
        locks: UMBRA_LOCK_Y,
        dominance: -17,
        is_bullet: 1,
    };
    assert_eq!(add(&mut draft, &def), Ok(UMBRA_NO_HANDLE));
    let full = BodyDef {
        kind: BodyKind::Kinematic,
        mass: Mass::Explicit { mass: bits(1), inertia: bits(2) },
        position: pair(3, 4),
        velocity: pair(5, 6),
        angle: bits(7),
        angular_velocity: bits(8),
        gravity_scale: bits(9),
        linear_damping: Some(damping(10)),
        angular_damping: Some(damping(11)),
        max_speed: Some(bits(15)),
        max_angular_speed: Some(bits(16)),
        locks: Locks { x: false, y: true, rotation: false },
        bullet: true,
        key: 12,
        user_data: 13,
        dominance: -17,
        force_groups: 14,
        colliders: Vec::new(),
    };
    is(&draft, UMBRA_OK, Command::AddBody(full));
    let (def, expected) = collider(&shape);
    // SAFETY: its shape is alive.
    let added = out(|id| unsafe { umbra_world_add_collider(Some(&mut draft), BODY_WORD, Some(&def), id) });
    assert_eq!(added, Ok(UMBRA_NO_HANDLE));
    is(&draft, UMBRA_OK, Command::AddCollider { body, def: expected.clone() });
    // SAFETY: its shape is alive.
    let status = unsafe { umbra_world_set_collider(Some(&mut draft), FIELD_WORD, Some(&def)) };
    is(&draft, status, Command::SetCollider { collider: ColliderId::from_parts(1, 7), def: expected });
    assert_eq!(add(&mut draft, &body_def()), Ok(UMBRA_NO_HANDLE));
    is(&draft, UMBRA_OK, Command::AddBody(BodyDef::dynamic()));

    for (def, joint) in joints() {
        assert_eq!(out(|id| umbra_world_add_joint(Some(&mut draft), Some(&def), id)), Ok(UMBRA_NO_HANDLE));
        is(&draft, UMBRA_OK, Command::AddJoint(joint));
        let status = umbra_world_set_joint_kind(Some(&mut draft), FIELD_WORD, Some(&def));
        is(&draft, status, Command::SetJointKind { joint: JOINT, kind: joint.kind });
    }

    assert_eq!(cases, Command::NUMBERS.iter().copied().collect());

    assert_eq!(umbra_world_step(Some(&mut draft)), UMBRA_ERROR_BUSY);
    let place = world();
    let refused = list::<u8>(|buffer, capacity, length| {
        // SAFETY: the buffers are those of `list`.
        unsafe { umbra_draft_command(Some(&place), buffer, capacity, length) }
    });
    assert_eq!(refused, Err(UMBRA_ERROR_BAD_ARGUMENT));
    umbra_world_free(Some(draft));
}

/// Joints of every kind, with all their values.
fn joints() -> Vec<(UmbraJointDef, JointDef)> {
    let bits = Fx::from_bits;
    let blank = |kind| out(|def| umbra_joint_def_default(kind, def)).expect("a definition");
    let place = |x, y| umbra_physics::Vec2::new(bits(x), bits(y));
    let at = |body, point| End::Body(Attachment { body: BodyId::from_parts(body, 0), point });
    let plain = UmbraJointDef { bodies: [UMBRA_NO_HANDLE, 1], ..blank(UMBRA_REVOLUTE) };
    let spring = JointSpring { hertz: bits(5), damping_ratio: bits(6), rest: bits(7), max_force: Some(bits(8)) };
    let full = UmbraJointDef {
        collide_connected: 1,
        is_enabled: 0,
        events: 1,
        has_limits: 1,
        has_motor: 1,
        has_spring: 1,
        bodies: [0, 1],
        points: [UmbraVec2 { x: 1, y: 2 }, UmbraVec2 { x: 3, y: 4 }],
        angles: [11, 12],
        lower: -9,
        upper: 10,
        motor_speed: 13,
        motor_max_force: 14,
        spring_hertz: 5,
        spring_damping_ratio: 6,
        spring_rest: 7,
        spring_max_force: 8,
        friction: 15,
        break_force: 16,
        break_torque: 19,
        ratchet: -20,
        key: 17,
        user_data: 18,
        ..plain
    };
    let full_kind = JointKind::Revolute(Revolute {
        limits: Some(JointLimits { lower: bits(-9), upper: bits(10) }),
        motor: Some(JointMotor { speed: bits(13), max_force: bits(14) }),
        spring: Some(spring),
        friction: bits(15),
        ratchet: Some(-20),
    });
    let full_joint = JointDef {
        angles: [bits(11), bits(12)],
        collide_connected: true,
        enabled: false,
        break_force: Some(bits(16)),
        break_torque: Some(bits(19)),
        events: true,
        key: 17,
        user_data: 18,
        ..JointDef::new([at(0, place(1, 2)), at(1, place(3, 4))], full_kind)
    };
    let ends = [End::World(place(0, 0)), at(1, place(0, 0))];
    let weld = UmbraJointDef { kind: UMBRA_WELD, has_spring: 1, spring_hertz: ONE, ..plain };
    let weld_spring = JointSpring::new(fx!(1), fx!(1));
    let limits = Some(JointLimits { lower: fx!(-1), upper: fx!(1) });
    let prismatic = JointKind::Prismatic(Prismatic { limits, friction: bits(4), ..Prismatic::default() });
    let motor = Some(JointMotor { speed: bits(5), max_force: fx!(0) });
    let wheel = JointKind::Wheel(Wheel { spring: Some(weld_spring), motor, ..Wheel::default() });
    let rest = Vec2::new(bits(1), bits(2));
    let pushing = Motor {
        spring: Some(PlanarSpring { max_force: Some(bits(3)), ..PlanarSpring::new(rest, fx!(2), fx!(1)) }),
        motor: Some(PlanarMotor { velocity: Vec2::new(bits(4), bits(5)), max_force: bits(6) }),
        angular_spring: Some(weld_spring),
        angular_motor: motor,
    };
    vec![
        (plain, JointDef::new(ends, JointKind::default())),
        (full, full_joint),
        (UmbraJointDef { kind: UMBRA_WELD, ..plain }, JointDef::new(ends, JointKind::Weld(Weld::default()))),
        (weld, JointDef::new(ends, JointKind::Weld(Weld { spring: Some(weld_spring) }))),
        (
            UmbraJointDef { kind: UMBRA_DISTANCE, has_limits: 1, lower: 3 * ONE, upper: 3 * ONE, ..plain },
            JointDef::new(ends, JointKind::Distance(Distance::rod(fx!(3)))),
        ),
        (
            UmbraJointDef { kind: UMBRA_PRISMATIC, has_limits: 1, lower: -ONE, upper: ONE, friction: 4, ..plain },
            JointDef::new(ends, prismatic),
        ),
        (
            UmbraJointDef {
                kind: UMBRA_WHEEL,
                has_spring: 1,
                spring_hertz: ONE,
                has_motor: 1,
                motor_speed: 5,
                ..plain
            },
            JointDef::new(ends, wheel),
        ),
        (
            UmbraJointDef {
                kind: UMBRA_MOTOR,
                has_spring: 1,
                spring_hertz: ONE,
                has_motor: 1,
                motor_speed: 5,
                has_planar_spring: 1,
                planar_spring_hertz: 2 * ONE,
                planar_spring_rest: UmbraVec2 { x: 1, y: 2 },
                planar_spring_max_force: 3,
                has_planar_motor: 1,
                planar_motor_velocity: UmbraVec2 { x: 4, y: 5 },
                planar_motor_max_force: 6,
                ..plain
            },
            JointDef::new(ends, JointKind::Motor(pushing)),
        ),
        (
            UmbraJointDef { kind: UMBRA_GEAR, teeth: [12, -36], ..plain },
            JointDef::new(ends, JointKind::Gear(Gear { teeth: [12, -36] })),
        ),
        (
            UmbraJointDef {
                kind: UMBRA_PULLEY,
                grounds: [UmbraVec2 { x: 1, y: 2 }, UmbraVec2 { x: 3, y: 4 }],
                strands: [1, 2],
                upper: 9 * ONE,
                ..plain
            },
            JointDef::new(
                ends,
                JointKind::Pulley(Pulley { grounds: [place(1, 2), place(3, 4)], strands: [1, 2], length: fx!(9) }),
            ),
        ),
    ]
}

#[test]
fn joints_are_read_as_they_were_made() {
    let mut world = world();
    for _ in 0..2 {
        add(&mut world, &body_def()).expect("a body");
    }
    let mut added = Vec::new();
    for (def, _) in joints() {
        // The others stand before the one with a key.
        let id = out(|id| umbra_world_add_joint(Some(&mut world), Some(&def), id)).expect("a joint");
        assert_eq!(out(|read| umbra_world_joint(Some(&world), id, read)), Ok(def));
        added.push((def.key, id));
    }
    added.sort_unstable();
    // SAFETY: the buffers are those of `list`.
    let listed = list(|buffer, capacity, count| unsafe { umbra_world_joints(Some(&world), buffer, capacity, count) });
    assert_eq!(listed, Ok(added.iter().map(|(_, id)| *id).collect()));
    let (key, last) = added[added.len() - 1];
    // SAFETY: likewise.
    let with_key =
        |key| list(|to, size, count| unsafe { umbra_world_joints_with_key(Some(&world), key, to, size, count) });
    assert_eq!((with_key(key), with_key(key + 1)), (Ok(vec![last]), Ok(vec![])));
    assert_eq!(out(|joint| umbra_world_joint_with_key(Some(&world), key, joint)), Ok(last));
    assert_eq!(out(|joint| umbra_world_joint_with_key(Some(&world), key + 1, joint)), Err(UMBRA_ERROR_NO_SUCH_JOINT));
    assert_eq!(out(|def| umbra_joint_def_default(8, def)), Err(UMBRA_ERROR_BAD_ARGUMENT));
    let weld = added
        .iter()
        .map(|(_, id)| *id)
        .find(|&id| out(|def| umbra_world_joint(Some(&world), id, def)).is_ok_and(|def| def.kind == UMBRA_WELD));
    let weld = weld.expect("there is one");
    assert_eq!(umbra_world_set_joint_motor(Some(&mut world), weld, 0, 1), UMBRA_ERROR_NO_MOTOR);
    assert_eq!(umbra_world_remove_joint(Some(&mut world), weld), UMBRA_OK);
    assert_eq!(umbra_world_remove_joint(Some(&mut world), weld), UMBRA_ERROR_NO_SUCH_JOINT);
    assert_eq!(out(|def| umbra_world_joint(Some(&world), weld, def)), Err(UMBRA_ERROR_NO_SUCH_JOINT));
    let nothing = out(|def| umbra_joint_def_weld(Some(&world), UMBRA_NO_HANDLE, UMBRA_NO_HANDLE, 0, 0, def));
    let nothing = nothing.expect("a definition");
    let refused = out(|id| umbra_world_add_joint(Some(&mut world), Some(&nothing), id));
    assert_eq!(refused, Err(UMBRA_ERROR_NOTHING_TO_MOVE));
    umbra_world_free(Some(world));
}

#[test]
fn joints_pull_and_break_as_in_the_library() {
    let mut here = world();
    let mut rust_world = World::new(WorldDef { gravity: vec2(0, -10), ..WorldDef::default() }).expect("a world");
    assert_eq!(umbra_world_set_gravity(Some(&mut here), 0, -10 * ONE), UMBRA_OK);
    let bodies = [0, 2].map(|x| {
        let def = UmbraBodyDef { position: UmbraVec2 { x: x * ONE, y: -2 * ONE }, ..body_def() };
        add(&mut here, &def).expect("a body")
    });
    let theirs =
        [0, 2].map(|x| rust_world.add_body(BodyDef { position: vec2(x, -2), ..BodyDef::dynamic() }).expect("a body"));
    let rod = out(|def| umbra_joint_def_distance(Some(&here), UMBRA_NO_HANDLE, 0, 0, bodies[0], 0, -2 * ONE, def));
    let rod = UmbraJointDef { break_force: 15 * ONE, events: 1, key: 4, ..rod.expect("a definition") };
    let hinge = out(|def| umbra_joint_def_revolute(Some(&here), bodies[0], bodies[1], ONE, -2 * ONE, def));
    let weld = out(|def| umbra_joint_def_weld(Some(&here), bodies[0], bodies[1], ONE, -2 * ONE, def));
    let (hinge, weld) = (hinge.expect("a definition"), weld.expect("a definition"));
    assert_eq!(weld, UmbraJointDef { kind: UMBRA_WELD, ..hinge });
    let [rod, hinge] =
        [rod, hinge].map(|def| out(|id| umbra_world_add_joint(Some(&mut here), Some(&def), id)).expect("a joint"));
    let def = JointDef::between(&rust_world, None, vec2(0, 0), theirs[0], vec2(0, -2)).expect("a definition");
    let their_rod = JointDef { break_force: Some(fx!(15)), events: true, key: 4, ..def };
    let their_rod = rust_world.add_joint(their_rod).expect("a joint");
    let def = JointDef::at(&rust_world, theirs[0], theirs[1], vec2(1, -2)).expect("a definition");
    let their_hinge = rust_world.add_joint(def).expect("a joint");
    let (mut broken, mut loaded) = (0, 0);
    for _ in 0..60 {
        assert_eq!(umbra_world_step(Some(&mut here)), UMBRA_OK);
        rust_world.step();
        assert_eq!(state_hash(&here), rust_world.state_hash());
        for (ours, theirs) in [(rod, their_rod), (hinge, their_hinge)] {
            let joint = rust_world.joint(theirs).expect("it is there");
            let expected = UmbraJointState {
                points: joint.points().map(Into::into),
                length: joint.length().to_bits(),
                translation: joint.translation().to_bits(),
                offset: joint.offset().into(),
                angle: joint.angle().to_bits(),
                stop: joint.stop().unwrap_or_default().to_bits(),
                speed: joint.speed().to_bits(),
                force: joint.force().into(),
                torque: joint.torque().to_bits(),
                is_broken: joint.is_broken().into(),
                is_active: joint.is_active().into(),
            };
            assert_eq!(out(|state| umbra_world_joint_state(Some(&here), ours, state)), Ok(expected));
        }
        // SAFETY: the buffers are those of `list`.
        let broke =
            list(|buffer, capacity, count| unsafe { umbra_world_joints_broke(Some(&here), buffer, capacity, count) });
        let expected = rust_world.last_report().joints_broke.iter().map(|broke| UmbraJointBroke {
            joint: rod,
            key: 4,
            bodies: [UMBRA_NO_HANDLE, bodies[0]],
            force: broke.force.into(),
            torque: broke.torque.to_bits(),
        });
        let expected: Vec<_> = expected.collect();
        broken += expected.len();
        assert_eq!(broke, Ok(expected));
        // SAFETY: the buffers are those of `list`.
        let loads =
            list(|buffer, capacity, count| unsafe { umbra_world_joint_loads(Some(&here), buffer, capacity, count) });
        let expected = rust_world.last_report().joint_loads.iter().map(|load| UmbraJointLoad {
            joint: rod,
            key: 4,
            force: load.force.into(),
            torque: load.torque.to_bits(),
        });
        assert_eq!(loads, Ok(expected.collect()));
        loaded += loads.map_or(0, |loads| loads.len());
    }
    assert_eq!(loaded, 1, "in the step in which it breaks");
    assert_eq!(broken, 1, "two bodies of a kilogram on a rod for one and a half");
    umbra_world_free(Some(here));
}

#[test]
fn gears_turn_at_their_ratio() {
    let mut here = world();
    let bodies = [0, 2].map(|x| {
        let position = UmbraVec2 { x: x * ONE, y: 0 };
        let def = UmbraBodyDef { position, mass_kind: UMBRA_MASS_EXPLICIT, mass: ONE, inertia: ONE, ..body_def() };
        add(&mut here, &def).expect("a body")
    });
    let refused = out(|def| umbra_joint_def_gear(Some(&here), bodies[0], bodies[1], 1, 1 << 20, def));
    assert_eq!(refused, Err(UMBRA_ERROR_OUT_OF_RANGE));
    let gear = out(|def| umbra_joint_def_gear(Some(&here), bodies[0], bodies[1], 10, 20, def)).expect("a definition");
    let pin = |x, body| out(|def| umbra_joint_def_revolute(Some(&here), UMBRA_NO_HANDLE, body, x * ONE, 0, def));
    let pins = [pin(0, bodies[0]), pin(2, bodies[1])].map(|pin| pin.expect("a definition"));
    let [axle, ..] = [pins[0], pins[1], gear]
        .map(|def| out(|id| umbra_world_add_joint(Some(&mut here), Some(&def), id)).expect("a joint"));
    assert_eq!(umbra_world_set_joint_motor(Some(&mut here), axle, 2 * ONE, 1_000 * ONE), UMBRA_OK);
    for _ in 0..60 {
        assert_eq!(umbra_world_step(Some(&mut here)), UMBRA_OK);
    }
    let speed = out(|state| umbra_world_body(Some(&here), bodies[1], state)).expect("a state").angular_velocity;
    assert!((speed + ONE).abs() < ONE / 1_000, "{speed}");
    umbra_world_free(Some(here));
}

#[test]
fn loads_on_a_pulley_move_as_atwood_says() {
    let mut here = world();
    let [light, heavy] = [1, 3].map(|mass| {
        let position = UmbraVec2 { x: mass * ONE, y: 0 };
        let def =
            UmbraBodyDef { position, mass_kind: UMBRA_MASS_EXPLICIT, mass: mass * ONE, inertia: ONE, ..body_def() };
        add(&mut here, &def).expect("a body")
    });
    let rope = out(|def| {
        let (x, top) = ([ONE, 3 * ONE], 8 * ONE);
        umbra_joint_def_pulley(Some(&here), light, x[0], 0, x[0], top, heavy, x[1], 0, x[1], top, def)
    });
    let rope = rope.expect("a definition");
    assert_eq!((rope.upper, rope.strands), (16 * ONE, [1, 1]));
    let rope = out(|id| umbra_world_add_joint(Some(&mut here), Some(&rope), id)).expect("a joint");
    for _ in 0..60 {
        for (body, mass) in [(light, 1), (heavy, 3)] {
            assert_eq!(umbra_world_apply_force(Some(&mut here), body, 0, -10 * mass * ONE, None, 0), UMBRA_OK);
        }
        assert_eq!(umbra_world_step(Some(&mut here)), UMBRA_OK);
    }
    let speed = out(|state| umbra_world_body(Some(&here), light, state)).expect("a state").velocity.y;
    assert!((speed - 5 * ONE).abs() < ONE / 1_000, "{speed}");
    let state = out(|state| umbra_world_joint_state(Some(&here), rope, state)).expect("a state");
    assert!((state.force.y - 15 * ONE).abs() < ONE / 100 && state.stop == 0, "{state:?}");
    umbra_world_free(Some(here));
}

#[test]
fn a_ratchet_holds_its_tooth() {
    let mut here = world();
    let def = UmbraBodyDef { mass_kind: UMBRA_MASS_EXPLICIT, mass: ONE, inertia: ONE, ..body_def() };
    let body = add(&mut here, &UmbraBodyDef { angular_velocity: 2 * ONE, ..def }).expect("a body");
    let axle = out(|def| umbra_joint_def_revolute(Some(&here), UMBRA_NO_HANDLE, body, 0, 0, def));
    let axle = UmbraJointDef { ratchet: 12, ..axle.expect("a definition") };
    let axle = out(|id| umbra_world_add_joint(Some(&mut here), Some(&axle), id)).expect("a joint");
    for _ in 0..60 {
        assert_eq!(umbra_world_step(Some(&mut here)), UMBRA_OK);
    }
    // 2 rad are three teeth and a part.
    let stop = out(|state| umbra_world_joint_state(Some(&here), axle, state)).expect("a state").stop;
    assert!((Fx::from_bits(stop) - Fx::TAU / 4).abs() < fx!(0.000001), "{stop}");
    umbra_world_free(Some(here));
}

#[test]
fn a_motor_joint_pulls_a_body_to_its_point() {
    let mut here = world();
    let body =
        add(&mut here, &UmbraBodyDef { position: UmbraVec2 { x: 2 * ONE, y: 0 }, ..body_def() }).expect("a body");
    let mouse = out(|def| umbra_joint_def_motor(Some(&here), UMBRA_NO_HANDLE, body, 2 * ONE, 0, def));
    let mouse = UmbraJointDef {
        has_planar_spring: 1,
        planar_spring_hertz: 2 * ONE,
        planar_spring_rest: UmbraVec2 { x: 3 * ONE, y: ONE },
        planar_spring_max_force: 1_000 * ONE,
        ..mouse.expect("a definition")
    };
    let mouse = out(|id| umbra_world_add_joint(Some(&mut here), Some(&mouse), id)).expect("a joint");
    for _ in 0..240 {
        assert_eq!(umbra_world_step(Some(&mut here)), UMBRA_OK);
    }
    let state = out(|state| umbra_world_joint_state(Some(&here), mouse, state)).expect("a state");
    assert!((state.offset.x - 3 * ONE).abs() < ONE / 100, "{state:?}");
    assert!((state.offset.y - ONE).abs() < ONE / 10, "{state:?}");
    umbra_world_free(Some(here));
}

/// 10 N/m of 1 kg hang 1 m lower under 10 m/s²; a mouse has its planar spring so.
#[test]
fn springs_are_set_by_their_stiffness() {
    let def = out(|def| umbra_world_def_default(def)).expect("a definition");
    let def = UmbraWorldDef { gravity: UmbraVec2 { x: 0, y: -10 * ONE }, ..def };
    let mut here = own(|world| umbra_world_new(Some(&def), world)).expect("a world");
    let body = add(&mut here, &body_def()).expect("a body");
    let mut spring = out(|def| umbra_joint_def_distance(Some(&here), UMBRA_NO_HANDLE, 0, ONE, body, 0, 0, def));
    let spring = spring.as_mut().expect("a definition");
    spring.has_limits = 0;
    spring.spring_rest = ONE;
    assert_eq!(umbra_joint_def_set_stiffness(Some(&here), Some(spring), 10 * ONE, 5 * ONE), UMBRA_OK);
    assert_eq!(umbra_world_set_sleep_after(Some(&mut here), UMBRA_NEVER), UMBRA_OK);
    assert_eq!(spring.has_spring, 1);
    let mut mouse = out(|def| umbra_joint_def_motor(Some(&here), UMBRA_NO_HANDLE, body, 0, 0, def));
    let mouse = mouse.as_mut().expect("a definition");
    assert_eq!(umbra_joint_def_set_stiffness(Some(&here), Some(mouse), 10 * ONE, 5 * ONE), UMBRA_OK);
    assert_eq!((mouse.has_planar_spring, mouse.has_spring), (1, 0));
    assert_eq!(mouse.planar_spring_hertz, spring.spring_hertz);
    assert_eq!(mouse.planar_spring_damping_ratio, spring.spring_damping_ratio);
    let before = *spring;
    let refused = umbra_joint_def_set_stiffness(Some(&here), Some(spring), -ONE, 0);
    assert_eq!((refused, *spring), (UMBRA_ERROR_OUT_OF_RANGE, before));
    out(|id| umbra_world_add_joint(Some(&mut here), Some(spring), id)).expect("a joint");
    for _ in 0..600 {
        assert_eq!(umbra_world_step(Some(&mut here)), UMBRA_OK);
    }
    let state = out(|state| umbra_world_body(Some(&here), body, state)).expect("a state");
    assert!((state.position.y + ONE).abs() < ONE / 10_000, "{state:?}");
    umbra_world_free(Some(here));
}

#[test]
fn sliders_and_wheels_have_their_axis_in_the_world() {
    let mut here = world();
    let bodies = [0, 2].map(|x| {
        let def = UmbraBodyDef { position: UmbraVec2 { x: x * ONE, y: 0 }, ..body_def() };
        add(&mut here, &def).expect("a body")
    });
    let slider = out(|def| umbra_joint_def_prismatic(Some(&here), UMBRA_NO_HANDLE, bodies[0], 0, 0, 0, ONE, def));
    let wheel = out(|def| umbra_joint_def_wheel(Some(&here), bodies[0], bodies[1], 2 * ONE, 0, 0, ONE, def));
    let (slider, wheel) = (slider.expect("a definition"), wheel.expect("a definition"));
    assert_eq!((slider.kind, wheel.kind), (UMBRA_PRISMATIC, UMBRA_WHEEL));
    let upwards = Fx::FRAC_PI_2.to_bits();
    assert!((slider.angles[0] - upwards).abs() <= 1 && (wheel.angles[0] - upwards).abs() <= 1, "{slider:?}");
    let [slider, wheel] =
        [slider, wheel].map(|def| out(|id| umbra_world_add_joint(Some(&mut here), Some(&def), id)).expect("a joint"));
    for joint in [slider, wheel] {
        assert_eq!(umbra_world_set_joint_motor(Some(&mut here), joint, ONE, 100 * ONE), UMBRA_OK);
    }
    for _ in 0..60 {
        assert_eq!(umbra_world_step(Some(&mut here)), UMBRA_OK);
    }
    let [slider, wheel] =
        [slider, wheel].map(|id| out(|state| umbra_world_joint_state(Some(&here), id, state)).expect("a state"));
    assert!((slider.translation - ONE).abs() < ONE / 20, "{slider:?}");
    // The first body went up from the second one, which does not turn.
    assert!((wheel.translation + ONE).abs() < ONE / 20, "{wheel:?}");
    umbra_world_free(Some(here));
}

#[test]
fn fields_are_read_as_they_were_made() {
    let mut world = world();
    for _ in 0..5 {
        add(&mut world, &body_def()).expect("a body");
    }
    let mut added = Vec::new();
    for (mut def, _) in fields() {
        // Bodies that are there.
        (def.body, def.other) = (def.body.min(3), if def.other == UMBRA_NO_HANDLE { def.other } else { def.other & 7 });
        if def.kind != UMBRA_SPRING && def.kind != UMBRA_THRUST {
            def.body = UMBRA_NO_HANDLE;
        }
        let id = out(|id| umbra_world_add_field(Some(&mut world), Some(&def), id)).expect("a field");
        assert_eq!(out(|read| umbra_world_field(Some(&world), id, read)), Ok(def));
        added.push(id);
    }
    // SAFETY: the buffers are those of `list`.
    let listed = list(|buffer, capacity, count| unsafe { umbra_world_fields(Some(&world), buffer, capacity, count) });
    assert_eq!(listed, Ok(added));
    assert_eq!(out(|def| umbra_field_def_default(7, def)), Err(UMBRA_ERROR_BAD_ARGUMENT));
    umbra_world_free(Some(world));
}

#[test]
fn bodies_are_read_to_the_last_bit() {
    let mut here = world();
    let mut rust_world = World::new(WorldDef::default()).expect("a world");
    assert_eq!(umbra_world_set_gravity(Some(&mut here), 1, -9 * ONE - 3), UMBRA_OK);
    rust_world.set_gravity(vec2(Fx::DELTA, Fx::from_bits(-9 * ONE - 3))).expect("a gravity");
    let shape = own(|shape| umbra_shape_circle(ONE, shape)).expect("a shape");
    let def = UmbraBodyDef { angular_velocity: -ONE / 3, user_data: 5, key: 6, ..body_def() };
    let body = add(&mut here, &def).expect("a body");
    let ghost = UmbraColliderDef {
        shape: &raw const *shape,
        mask: 0,
        ..out(|def| umbra_collider_def_default(def)).expect("one")
    };
    // SAFETY: its shape is alive.
    out(|id| unsafe { umbra_world_add_collider(Some(&mut here), body, Some(&ghost), id) }).expect("a collider");
    umbra_shape_free(Some(shape));
    let id = rust_world
        .add_body(BodyDef { angular_velocity: Fx::from_bits(-ONE / 3), user_data: 5, key: 6, ..BodyDef::dynamic() })
        .expect("a body");
    let filter = Filter { mask: 0, ..Filter::default() };
    let disc = Shape::circle(fx!(1)).expect("a shape");
    rust_world.add_collider(id, ColliderDef { filter, ..ColliderDef::new(disc) }).expect("a collider");
    for _ in 0..77 {
        assert_eq!(umbra_world_step(Some(&mut here)), UMBRA_OK);
        rust_world.step();
    }
    assert_eq!(state_hash(&here), rust_world.state_hash());
    assert_eq!(out(|hash| umbra_world_physics_hash(Some(&here), hash)), Ok(rust_world.physics_hash()));
    let (state, look) =
        (out(|state| umbra_world_body(Some(&here), body, state)).expect("a state"), rust_world.body(id).unwrap());
    assert_eq!((state.position, state.velocity), (look.position().into(), look.velocity().into()));
    assert_eq!((state.angle, state.angular_velocity), (look.angle().to_bits(), look.angular_velocity().to_bits()));
    assert_eq!((state.cos, state.sin), (look.rotation().cos.to_bits(), look.rotation().sin.to_bits()));
    let exact =
        |bits: UmbraInt128| umbra_physics::FxAccumulator::from_bits(i128::from(bits.high) << 64 | i128::from(bits.low));
    assert_eq!((exact(state.exact_x), exact(state.exact_y)), (look.position_exact().x, look.position_exact().y));
    let velocity = (exact(state.exact_velocity_x), exact(state.exact_velocity_y));
    assert_eq!(velocity, (look.velocity_exact().x, look.velocity_exact().y));
    assert_ne!((state.exact_y.low, state.exact_velocity_y.low), (0, 0), "there are remainders to be read");
    assert_eq!(exact(state.exact_angular_velocity), look.angular_velocity_exact());
    assert_eq!(umbra_physics::Turn::from_bits(state.turn), look.angle_exact());
    let inertia = look.inertia().expect("one").parts();
    let mass = look.mass().map(Fx::to_bits);
    assert_eq!((Some(state.mass), (state.inertia.mantissa, state.inertia.shift)), (mass, inertia));
    assert_eq!((state.linear_kept_per_second, state.angular_kept_per_second), (UMBRA_AS_WORLD, UMBRA_AS_WORLD));
    assert_eq!((state.key, state.user_data, state.force_groups, state.gravity_scale), (6, 5, 1, ONE));
    assert_eq!((state.kind, state.activity), (UMBRA_DYNAMIC, UMBRA_AWAKE));

    // SAFETY: the buffers are those of `list`.
    let poses = list(|buffer, capacity, count| unsafe { umbra_world_poses(Some(&here), buffer, capacity, count) });
    let UmbraBodyState { position, angle, key, user_data, kind, activity, .. } = state;
    assert_eq!(poses, Ok(vec![UmbraPose { body, position, angle, key, user_data, kind, activity }]));
    // SAFETY: the buffers are those of `list`.
    let bodies = list(|buffer, capacity, count| unsafe { umbra_world_bodies(Some(&here), buffer, capacity, count) });
    assert_eq!(bodies, Ok(vec![body]));

    let wide =
        |value: UmbraInt128| umbra_physics::FxWide::from_bits(i128::from(value.high) << 64 | i128::from(value.low));
    type Total = extern "C" fn(Option<&UmbraWorld>, Option<&mut MaybeUninit<UmbraInt128>>) -> UmbraStatus;
    let totals: [(Total, _); 4] = [
        (umbra_world_energy, rust_world.energy()),
        (umbra_world_kinetic_energy, rust_world.kinetic_energy()),
        (umbra_world_potential_energy, rust_world.potential_energy()),
        (umbra_world_angular_momentum, rust_world.angular_momentum()),
    ];
    for (total, expected) in totals {
        assert_eq!(out(|sum| total(Some(&here), sum)).map(wide), Ok(expected.expect("a total")));
    }
    let mut x = MaybeUninit::uninit();
    let y = out(|y| umbra_world_momentum(Some(&here), Some(&mut x), y)).expect("a momentum");
    // SAFETY: the call was done.
    let x = unsafe { x.assume_init() };
    assert_eq!((wide(x), wide(y)), rust_world.momentum().map(|momentum| (momentum.x, momentum.y)).expect("a momentum"));
    let mut num = MaybeUninit::uninit();
    let den = out(|den| umbra_world_elapsed(Some(&here), Some(&mut num), den)).expect("a time");
    // SAFETY: the call was done.
    let num = unsafe { num.assume_init() };
    assert_eq!((num, den), (UmbraUint128 { low: 77, high: 0 }, UmbraUint128 { low: 60, high: 0 }));
    umbra_world_free(Some(here));
}

#[test]
fn what_cannot_be_is_refused_and_changes_nothing() {
    let mut world = world();
    let body = add(&mut world, &body_def()).expect("a body");
    let before = state_hash(&world);
    let bad = UMBRA_ERROR_BAD_ARGUMENT;
    assert_eq!(umbra_world_set_kind(Some(&mut world), body, 3), bad);
    assert_eq!(umbra_world_set_mass(Some(&mut world), body, 4, ONE, 0), bad);
    assert_eq!(umbra_world_set_integrator(Some(&mut world), 5), bad);
    assert_eq!(umbra_world_set_locks(Some(&mut world), body, 8), bad);
    assert_eq!(umbra_world_apply_force(Some(&mut world), body, 0, 0, None, 4), bad);
    assert_eq!(out(|number| umbra_world_random_below(Some(&mut world), 0, number)), Err(bad));
    assert_eq!(add(&mut world, &UmbraBodyDef { mass_kind: 9, ..body_def() }), Err(bad));
    assert_eq!(
        add(&mut world, &UmbraBodyDef { linear_kept_per_second: -2, ..body_def() }),
        Err(UMBRA_ERROR_OUT_OF_RANGE)
    );
    assert_eq!(umbra_last_cause(), 165);
    let field = UmbraFieldDef {
        mu: UmbraFactor { mantissa: 1, shift: 0, reserved: 0 },
        ..out(|def| umbra_field_def_default(UMBRA_ATTRACTOR, def)).expect("a definition")
    };
    assert_eq!(out(|id| umbra_world_add_field(Some(&mut world), Some(&field), id)), Err(bad));
    let zone = UmbraFieldDef { kind: UMBRA_ZONE, region: 2, ..field };
    assert_eq!(out(|id| umbra_world_add_field(Some(&mut world), Some(&zone), id)), Err(bad));
    // SAFETY: lengths beyond memory are never followed.
    unsafe {
        let start = ptr::dangling::<u8>();
        assert_eq!(umbra_world_execute(Some(&mut world), start, usize::MAX, None), bad);
        assert_eq!(umbra_world_set_blob(Some(&mut world), start, isize::MAX as usize + 1), bad);
        assert_eq!(own(|shape| umbra_shape_polygon(ptr::dangling(), usize::MAX / 16, shape)).err(), Some(bad));
        assert_eq!(umbra_world_poses(Some(&world), ptr::dangling_mut(), usize::MAX, None), bad);
        assert_eq!(own(|bytes| umbra_bytes_new(usize::MAX, bytes)).err(), Some(bad));
        assert_eq!(own(|bytes| umbra_bytes_new(isize::MAX as usize, bytes)).err(), Some(bad));
        let text = [0xffu8, 0xfe];
        assert_eq!(out(|number| umbra_fx_from_text(text.as_ptr().cast(), 2, number)), Err(bad));
        assert_eq!(own(|world| umbra_world_from_scene(text.as_ptr().cast(), 2, 9, world)).err(), Some(bad));
        let scene = r#"{"bodies": [{"name": "{i}", "repeat": {"i": 11}}]}"#;
        let (at, length) = (scene.as_ptr().cast(), scene.len());
        assert_eq!(own(|world| umbra_world_from_scene(at, length, 10, world)).err(), Some(510));
        assert_eq!(last_message(), "1: bodies[0].repeat: out of range: at most 10 can be made");
        assert!(own(|world| umbra_world_from_scene(at, length, 11, world)).is_ok());
    }
    assert_eq!(umbra_world_remove_body(Some(&mut world), body + 1), UMBRA_ERROR_NO_SUCH_BODY);
    assert_eq!(last_message(), "no such body: body 1");
    assert_eq!(state_hash(&world), before);
    assert_eq!(umbra_world_remove_body(Some(&mut world), body), UMBRA_OK);
    assert_eq!(umbra_world_remove_body(Some(&mut world), body), UMBRA_ERROR_NO_SUCH_BODY);
    assert_eq!(last_message(), "no such body: body 0");
    // An error is one a thread.
    std::thread::spawn(|| assert_eq!((umbra_last_cause(), last_message()), (0, String::new())))
        .join()
        .expect("it ends");
    umbra_world_free(Some(world));
}

/// Values of a body that are not in its state struct, as the library has them.
#[test]
fn the_rest_of_a_body_is_read() {
    let mut here = world();
    let def = UmbraBodyDef {
        mass_kind: UMBRA_MASS_KILOGRAMS,
        mass: 3 * ONE,
        position: UmbraVec2 { x: ONE, y: -ONE },
        velocity: UmbraVec2 { x: 2 * ONE, y: ONE / 3 },
        angle: ONE / 2,
        angular_velocity: ONE,
        key: 7,
        ..body_def()
    };
    let rod = add(&mut here, &def).expect("a body");
    let lift = add(&mut here, &UmbraBodyDef { kind: UMBRA_KINEMATIC, key: 7, ..body_def() }).expect("a body");

    let mut rust_world = World::new(WorldDef::default()).expect("a world");
    let id = rust_world.add_body(BodyDef {
        mass: Mass::Kilograms(fx!(3)),
        position: vec2(1, -1),
        velocity: vec2(2, Fx::from_bits(ONE / 3)),
        angle: fx!(0.5),
        angular_velocity: fx!(1),
        ..BodyDef::dynamic()
    });
    let look = rust_world.body(id.expect("a body")).expect("it is there");

    let mass_def = |world: &UmbraWorld, body| {
        let (mut kind, mut mass) = (MaybeUninit::uninit(), MaybeUninit::uninit());
        let inertia =
            out(|inertia| umbra_world_body_mass_def(Some(world), body, Some(&mut kind), Some(&mut mass), inertia));
        // SAFETY: a call that is done has written all three.
        inertia.map(|inertia| unsafe { (kind.assume_init(), mass.assume_init(), inertia) })
    };
    assert_eq!(mass_def(&here, rod), Ok((UMBRA_MASS_KILOGRAMS, 3 * ONE, 0)));
    assert_eq!(mass_def(&here, lift), Ok((UMBRA_MASS_FROM_COLLIDERS, 0, 0)));
    assert_eq!(umbra_world_set_mass(Some(&mut here), lift, UMBRA_MASS_EXPLICIT, 5 * ONE, 6), UMBRA_OK);
    assert_eq!(mass_def(&here, lift), Ok((UMBRA_MASS_EXPLICIT, 5 * ONE, 6)));
    assert_eq!(mass_def(&here, 99), Err(UMBRA_ERROR_NO_SUCH_BODY));

    let point = (5 * ONE + 1, -7 * ONE);
    let at = umbra_physics::Vec2::new(Fx::from_bits(point.0), Fx::from_bits(point.1));
    type Seen =
        extern "C" fn(Option<&UmbraWorld>, u64, UmbraFx, UmbraFx, Option<&mut MaybeUninit<UmbraVec2>>) -> UmbraStatus;
    let ways: [(Seen, _); 3] = [
        (umbra_world_body_velocity_at, look.velocity_at(at)),
        (umbra_world_body_world_point, look.world_point(at)),
        (umbra_world_body_local_point, look.local_point(at)),
    ];
    for (function, expected) in ways {
        let actual = out(|place| function(Some(&here), rod, point.0, point.1, place));
        assert_eq!(actual, Ok(expected.expect("it fits").into()));
        let far = out(|place| function(Some(&here), rod, i64::MIN, i64::MAX, place));
        assert_eq!(far, Err(UMBRA_ERROR_NUMBER_OUT_OF_RANGE));
        assert_eq!(out(|place| function(Some(&here), 99, 0, 0, place)), Err(UMBRA_ERROR_NO_SUCH_BODY));
    }

    let wide =
        |value: UmbraInt128| umbra_physics::FxWide::from_bits(i128::from(value.high) << 64 | i128::from(value.low));
    let energy = out(|energy| umbra_world_body_kinetic_energy(Some(&here), rod, energy));
    assert_eq!(energy.map(wide), Ok(look.kinetic_energy().expect("it fits")));
    let angular = out(|momentum| umbra_world_body_angular_momentum(Some(&here), rod, momentum));
    assert_eq!(angular.map(wide), Ok(look.angular_momentum().expect("it fits")));
    let mut x = MaybeUninit::uninit();
    let y = out(|y| umbra_world_body_momentum(Some(&here), rod, Some(&mut x), y)).expect("a momentum");
    // SAFETY: a call that is done has written both.
    let x = unsafe { x.assume_init() };
    assert_eq!((wide(x), wide(y)), (look.momentum().x, look.momentum().y));

    let goal = |world: &UmbraWorld| out(|goal| umbra_world_body_goal(Some(world), lift, goal));
    assert_eq!(goal(&here), Ok(UmbraGoal::default()));
    assert_eq!(umbra_world_move_to(Some(&mut here), lift, ONE / 8, -1, ONE / 4), UMBRA_OK);
    let position = UmbraVec2 { x: ONE / 8, y: -1 };
    assert_eq!(goal(&here), Ok(UmbraGoal { position, angle: ONE / 4, is_there: 1, reserved: 0 }));
    assert_eq!(umbra_world_step(Some(&mut here)), UMBRA_OK);
    assert_eq!(goal(&here), Ok(UmbraGoal::default()));

    let with_key = |world: &UmbraWorld, key| {
        // SAFETY: the buffers are those of `list`.
        list(|to, size, count| unsafe { umbra_world_bodies_with_key(Some(world), key, to, size, count) })
    };
    assert_eq!((with_key(&here, 7), with_key(&here, 8)), (Ok(vec![rod, lift]), Ok(vec![])));
    assert_eq!(out(|body| umbra_world_body_with_key(Some(&here), 7, body)), Ok(rod));
    assert_eq!(out(|body| umbra_world_body_with_key(Some(&here), 8, body)), Err(UMBRA_ERROR_NO_SUCH_BODY));
    umbra_world_free(Some(here));
}

#[test]
fn shapes_are_those_of_the_library() {
    let mut draft = own(|draft| umbra_draft_new(draft)).expect("a draft");
    let disc = own(|shape| umbra_shape_circle(ONE, shape)).expect("a shape");
    let at = |x| UmbraVec2 { x, y: 0 };
    let part = |x, density| UmbraPart { position: at(x), angle: ONE / 2, density, shape: &raw const *disc };
    let corners = [at(0), at(3 * ONE), UmbraVec2 { x: 0, y: 3 * ONE }];
    let parts = [part(0, ONE), part(3 * ONE, 2 * ONE)];
    let like = Shape::circle(fx!(1)).expect("a shape");
    let like_part =
        |x: i32, density| umbra_physics::Part { shape: like.clone(), position: vec2(x, 0), angle: fx!(0.5), density };
    let dart = [[0, 0], [4, 0], [1, 1], [0, 4]].map(|[x, y]| UmbraVec2 { x: x * ONE, y: y * ONE });
    // SAFETY: corners and parts are there, and so is their shape.
    let rows = unsafe {
        [
            (own(|shape| umbra_shape_rectangle(ONE, 2 * ONE, shape)), Shape::rectangle(fx!(1), fx!(2))),
            (own(|shape| umbra_shape_capsule(ONE, 2 * ONE, shape)), Shape::capsule(fx!(1), fx!(2))),
            (
                own(|shape| umbra_shape_segment(Some(&at(0)), Some(&at(ONE)), shape)),
                Shape::segment(vec2(0, 0), vec2(1, 0)),
            ),
            (
                own(|shape| umbra_shape_polygon(corners.as_ptr(), 3, shape)),
                Shape::polygon(&[vec2(0, 0), vec2(3, 0), vec2(0, 3)]),
            ),
            (
                own(|shape| umbra_shape_hull(corners.as_ptr(), 3, shape)),
                Shape::polygon(&[vec2(0, 0), vec2(3, 0), vec2(0, 3)]),
            ),
            (
                own(|shape| umbra_shape_concave_polygon(dart.as_ptr(), 4, shape)),
                Shape::concave_polygon(&[vec2(0, 0), vec2(4, 0), vec2(1, 1), vec2(0, 4)]),
            ),
            (
                own(|shape| umbra_shape_rounded_polygon(corners.as_ptr(), 3, 1 << 31, shape)),
                Shape::rounded_polygon(&[vec2(0, 0), vec2(3, 0), vec2(0, 3)], fx!(0.5)),
            ),
            (
                own(|shape| umbra_shape_chain(corners.as_ptr(), 3, 1, shape)),
                Shape::chain(&[vec2(0, 0), vec2(3, 0), vec2(0, 3)], true),
            ),
            (
                own(|shape| umbra_shape_compound(parts.as_ptr(), 2, shape)),
                Shape::compound(&[like_part(0, fx!(1)), like_part(3, fx!(2))]),
            ),
        ]
    };
    let plain = out(|def| umbra_collider_def_default(def)).expect("a definition");
    for (shape, expected) in rows {
        let shape = shape.expect("a shape");
        let def = UmbraColliderDef { shape: &raw const *shape, ..plain };
        // SAFETY: its shape is alive.
        out(|id| unsafe { umbra_world_add_collider(Some(&mut draft), BODY_WORD, Some(&def), id) }).expect("a collider");
        let command = Command::AddCollider { body: BODY, def: expected.expect("a shape").into() };
        assert_eq!(Command::from_bytes(&drafted(&draft)), Ok(command));
        umbra_shape_free(Some(shape));
    }
    umbra_shape_free(Some(disc));
    umbra_world_free(Some(draft));
}

#[test]
fn a_definition_is_read_as_it_was_given_and_changed() {
    let def = UmbraWorldDef {
        step_num: 2,
        step_den: 128,
        integrator: UMBRA_YOSHIDA4,
        sleep_after: UMBRA_NEVER,
        gravity: UmbraVec2 { x: 1, y: -2 },
        linear_kept_per_second: ONE / 2,
        angular_kept_per_second: ONE / 4,
    };
    let mut world = own(|world| umbra_world_new(Some(&def), world)).expect("a world");
    let read = |world: &UmbraWorld| out(|def| umbra_world_def(Some(world), def));
    // A ratio is kept in lowest terms.
    assert_eq!(read(&world), Ok(UmbraWorldDef { step_num: 1, step_den: 64, ..def }));
    assert_eq!(umbra_world_set_kept_per_second(Some(&mut world), 3, 4), UMBRA_OK);
    assert_eq!(umbra_world_set_time_step(Some(&mut world), 1, 30), UMBRA_OK);
    let changed =
        UmbraWorldDef { step_num: 1, step_den: 30, linear_kept_per_second: 3, angular_kept_per_second: 4, ..def };
    assert_eq!(read(&world), Ok(changed));
    umbra_world_free(Some(world));
}

#[test]
fn a_rate_of_damping_becomes_the_share_that_is_kept() {
    for rate in [0, 1, ONE / 10, ONE / 2, ONE, 20 * ONE, 23 * ONE, i64::MAX] {
        assert_eq!(umbra_kept_at_rate(rate), Damping::rate(Fx::from_bits(rate)).number().to_bits(), "{rate}");
    }
    // e^-0.5, and above 4/s minus the rate.
    assert_eq!((umbra_kept_at_rate(0), umbra_kept_at_rate(ONE / 2)), (ONE, 2_605_029_347));
    assert_eq!((umbra_kept_at_rate(4 * ONE) > 0, umbra_kept_at_rate(23 * ONE)), (true, -23 * ONE));
    for negative in [-1, -ONE, i64::MIN] {
        let kept = umbra_kept_at_rate(negative);
        let standard = out(|def| umbra_world_def_default(def)).expect("a definition");
        let def = UmbraWorldDef { linear_kept_per_second: kept, ..standard };
        let refused = own(|world| umbra_world_new(Some(&def), world)).map(drop).expect_err("it gains speed");
        assert_eq!((refused, umbra_last_cause()), (UMBRA_ERROR_OUT_OF_RANGE, 165), "{negative}");
    }
}

#[test]
fn a_packet_that_comes_twice_is_taken_once() {
    let mut world = world();
    let body = add(&mut world, &body_def()).expect("a body");
    let mut inputs = own(|inputs| umbra_inputs_new(inputs)).expect("inputs");
    let speed = |x| Command::<Fx>::SetVelocity { body: BodyId::from_parts(body as u32, 0), velocity: vec2(x, 0) };
    let packet: Vec<Vec<u8>> = [speed(1), Command::ClearForces, speed(3)].iter().map(Command::to_bytes).collect();
    let replace = |inputs: &mut UmbraInputs, commands: &[Vec<u8>]| {
        let (bytes, lengths) = (commands.concat(), commands.iter().map(Vec::len).collect::<Vec<_>>());
        out(|changed| {
            let count = lengths.len();
            // SAFETY: bytes and lengths are there.
            unsafe { umbra_inputs_replace(Some(inputs), 4, bytes.as_ptr(), lengths.as_ptr(), count, changed) }
        })
    };
    assert_eq!(replace(&mut inputs, &packet), Ok(1));
    assert_eq!(replace(&mut inputs, &packet), Ok(0));
    // What is no command, or longer than anything, leaves those that are there.
    assert_eq!(replace(&mut inputs, &[packet[0].clone(), vec![99]]), Err(UMBRA_ERROR_MALFORMED));
    // SAFETY: a length beyond memory is never followed.
    let beyond =
        unsafe { umbra_inputs_replace(Some(&mut inputs), 4, packet[0].as_ptr(), [1, usize::MAX].as_ptr(), 2, None) };
    assert_eq!(beyond, UMBRA_ERROR_BAD_ARGUMENT);
    assert_eq!(umbra_world_step_inputs(Some(&mut world), Some(&inputs)), UMBRA_OK);
    // SAFETY: the buffers are those of `list`.
    let outcomes = list(|to, size, count| unsafe { umbra_world_outcomes(Some(&world), to, size, count) });
    let result = |sequence| UmbraInputResult {
        player: 4,
        sequence,
        status: UMBRA_OK,
        created: UMBRA_CREATED_NOTHING,
        handle: UMBRA_NO_HANDLE,
    };
    assert_eq!(outcomes, Ok(vec![result(0), result(1), result(2)]));
    let state = out(|state| umbra_world_body(Some(&world), body, state)).expect("a state");
    assert_eq!(state.velocity, UmbraVec2 { x: 3 * ONE, y: 0 });
    // The same inputs cleared are none.
    assert_eq!(umbra_inputs_clear(Some(&mut inputs)), UMBRA_OK);
    assert_eq!(umbra_world_step_inputs(Some(&mut world), Some(&inputs)), UMBRA_OK);
    // SAFETY: the buffers are those of `list`.
    let outcomes = list(|to, size, count| unsafe { umbra_world_outcomes(Some(&world), to, size, count) });
    assert_eq!(outcomes, Ok(vec![]));
    umbra_inputs_free(Some(inputs));
    umbra_world_free(Some(world));
}

/// A ring of them, as rollback has it, in the memory of the first.
#[test]
fn a_snapshot_is_made_where_another_was() {
    let mut world = world();
    let body = add(&mut world, &UmbraBodyDef { velocity: UmbraVec2 { x: ONE, y: 0 }, ..body_def() }).expect("a body");
    let mut snapshot = own(|snapshot| umbra_world_snapshot(Some(&world), snapshot)).expect("a snapshot");
    let start = state_hash(&world);
    assert_eq!(umbra_world_step(Some(&mut world)), UMBRA_OK);
    assert_eq!(umbra_world_snapshot_into(Some(&world), Some(&mut snapshot)), UMBRA_OK);
    let before = state_hash(&world);
    assert_eq!(umbra_world_remove_body(Some(&mut world), body), UMBRA_OK);
    assert_eq!(umbra_world_step(Some(&mut world)), UMBRA_OK);
    assert_eq!(umbra_world_restore(Some(&mut world), Some(&snapshot)), UMBRA_OK);
    assert_eq!(state_hash(&world), before);
    assert_ne!(before, start);
    umbra_snapshot_free(Some(snapshot));
    umbra_world_free(Some(world));
}

#[test]
fn numbers_become_factors() {
    for number in [0, 1, ONE, -5 * ONE / 3, i64::MAX, i64::MIN] {
        let factor = out(|factor| umbra_factor_from_fx(number, factor)).expect("a factor");
        let like = FxFactor::from_scalar(Fx::from_bits(number));
        assert_eq!((factor.mantissa, factor.shift), like.parts());
    }
    // As long as they are said to be.
    let length = |number: i64| {
        // SAFETY: the buffers are those of `text`.
        text(|to, size, length| unsafe { umbra_fx_to_text(number, to, size, length) }).expect("a text").len()
    };
    assert_eq!(length(i64::MIN + 1), 44);
    let least = UmbraInt128 { low: 1, high: i64::MIN };
    // SAFETY: the buffers are those of `text`.
    let wide = text(|to, size, length| unsafe { umbra_wide_to_text(Some(&least), to, size, length) });
    assert_eq!(wide.expect("a text").len(), 85);
}

#[test]
fn nothing_is_written_of_what_is_refused() {
    let mut length = MaybeUninit::new(77);
    let mut text = [1u8; 4];
    // SAFETY: a capacity beyond memory is never used, and null is not written to.
    unsafe {
        let to = text.as_mut_ptr().cast();
        assert_eq!(umbra_fx_to_text(ONE, to, usize::MAX, Some(&mut length)), UMBRA_ERROR_BAD_ARGUMENT);
        assert_eq!(umbra_fx_to_text(ONE, ptr::null_mut(), 1, Some(&mut length)), UMBRA_ERROR_NULL_POINTER);
        assert_eq!(umbra_status_message(1, to, 4, Some(&mut length)), UMBRA_ERROR_BAD_ARGUMENT);
        assert_eq!((length.assume_init(), text), (77, [1; 4]));
    }
}

/// The version that the library reports is this package's.
#[test]
fn the_interface_has_the_version_of_the_library() {
    // SAFETY: it is text that ends with a zero, and stays.
    let version = unsafe { std::ffi::CStr::from_ptr(umbra_version()) }.to_str().expect("UTF-8");
    let package =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../Cargo.toml")).expect("the library's");
    assert!(package.lines().any(|line| line == format!("version = \"{version}\"")), "{version}");
    assert_eq!((umbra_api(), umbra_physics_version()), (UMBRA_API, umbra_physics::PHYSICS_VERSION));
    let digest = out(|digest| umbra_selftest(digest)).expect("a digest");
    let golden = include_str!("../../src/selftest/golden.txt").lines().find(|line| line.starts_with("all "));
    let golden = golden.and_then(|line| line.split_whitespace().last()).expect("a digest of all");
    assert_eq!(format!("{digest:016x}"), golden);
}

#[test]
fn steps_report_what_they_did() {
    let mut world = world();
    let fast = UmbraBodyDef { velocity: UmbraVec2 { x: ONE << 20, y: 0 }, ..body_def() };
    let fast = UmbraBodyDef { position: UmbraVec2 { x: ONE << 30, y: 0 }, ..fast };
    let (fast, still) = (add(&mut world, &fast).expect("a body"), add(&mut world, &body_def()).expect("a body"));
    let mut slept = Vec::new();
    for tick in 1..=40 {
        assert_eq!(umbra_world_step(Some(&mut world)), UMBRA_OK);
        let report = out(|report| umbra_world_report(Some(&world), report)).expect("a report");
        assert_eq!((report.tick, report.faults), (tick, u64::from(tick == 1)));
        // SAFETY: the buffers are those of `list`.
        let faults =
            list(|buffer, capacity, count| unsafe { umbra_world_faults(Some(&world), buffer, capacity, count) });
        let fault = UmbraFault { body: fast, field: UMBRA_NO_HANDLE, cause: 201, reserved: 0 };
        assert_eq!(faults, Ok(if tick == 1 { vec![fault] } else { vec![] }));
        // SAFETY: the buffers are those of `list`.
        slept
            .extend(list(|to, size, count| unsafe { umbra_world_fell_asleep(Some(&world), to, size, count) }).unwrap());
    }
    assert_eq!(slept, [still]);
    let state = out(|state| umbra_world_body(Some(&world), fast, state)).expect("a state");
    assert_eq!(state.activity, UMBRA_QUARANTINED);
    assert_eq!(umbra_world_set_velocity(Some(&mut world), fast, 0, 0), UMBRA_OK);
    assert_eq!(umbra_world_release(Some(&mut world), fast), UMBRA_OK);
    assert_eq!(umbra_world_wake(Some(&mut world), still), UMBRA_OK);
    let mut moving = MaybeUninit::uninit();
    assert_eq!(out(|all| umbra_world_body_count(Some(&world), all, Some(&mut moving))), Ok(2));
    // SAFETY: the call was done.
    assert_eq!(unsafe { moving.assume_init() }, 2);
    assert_eq!(umbra_world_step(Some(&mut world)), UMBRA_OK);
    // SAFETY: the buffers are those of `list`.
    let woke = list(|to, size, count| unsafe { umbra_world_woke(Some(&world), to, size, count) });
    assert_eq!(woke, Ok(vec![still]));
    assert_eq!(out(|tick| umbra_world_tick(Some(&world), tick)), Ok(41));
    umbra_world_free(Some(world));
}

#[test]
fn what_a_game_keeps_goes_along() {
    let mut world = world();
    assert_eq!(umbra_world_seed(Some(&mut world), 42), UMBRA_OK);
    // SAFETY: the bytes are there.
    assert_eq!(unsafe { umbra_world_set_blob(Some(&mut world), b"score".as_ptr(), 5) }, UMBRA_OK);
    let mut copy = own(|copy| umbra_world_clone(Some(&world), copy)).expect("a copy");
    // SAFETY: the buffers are those of `list`.
    let blob = list(|to, size, count| unsafe { umbra_world_blob(Some(&copy), to, size, count) });
    assert_eq!(blob, Ok(b"score".to_vec()));
    let mut random = Random::seeded(42);
    for _ in 0..5 {
        assert_eq!(out(|number| umbra_world_random_below(Some(&mut copy), 6, number)), Ok(random.below(6)));
        assert_eq!(out(|bits| umbra_world_random_bits(Some(&mut copy), bits)), Ok(random.bits()));
    }
    let difference = |left: &UmbraWorld, right: &UmbraWorld| {
        // SAFETY: the buffers are those of `text`.
        text(|to, size, length| unsafe { umbra_world_first_difference(Some(left), Some(right), to, size, length) })
    };
    assert!(difference(&world, &copy).expect("words").starts_with("the world, random"));
    assert_eq!(difference(&world, &world), Ok(String::new()));
    umbra_world_free(Some(copy));
    umbra_world_free(Some(world));
}

#[test]
fn a_scene_is_recorded_and_verified_as_any_run() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let json = fs::read_to_string(root.join("scenes/lander.json")).expect("a scene");
    // SAFETY: the text is there.
    let from = || own(|world| unsafe { umbra_world_from_scene(json.as_ptr().cast(), json.len(), 1000, world) });
    let mut world = from().expect("a world");
    assert_eq!(umbra_world_record(Some(&mut world), 1, 16), UMBRA_OK);
    assert_eq!(umbra_world_record(Some(&mut world), 1, 16), UMBRA_ERROR_BUSY);
    let mut file = Vec::new();
    let take = |file: &mut Vec<u8>, mut bytes: Box<UmbraBytes>| {
        let (at, length) = (umbra_bytes_data(Some(&mut bytes)), umbra_bytes_length(Some(&bytes)));
        // SAFETY: that is where they are.
        file.extend_from_slice(unsafe { std::slice::from_raw_parts(at, length) });
        umbra_bytes_free(Some(bytes));
    };
    for _ in 0..100 {
        assert_eq!(umbra_world_step(Some(&mut world)), UMBRA_OK);
        take(&mut file, own(|bytes| umbra_world_take_record(Some(&mut world), bytes)).expect("bytes"));
    }
    take(&mut file, own(|bytes| umbra_world_end_record(Some(&mut world), bytes)).expect("bytes"));
    assert_eq!(own(|bytes| umbra_world_end_record(Some(&mut world), bytes)).err(), Some(UMBRA_ERROR_BAD_ARGUMENT));
    // SAFETY: the bytes are there.
    let verify =
        |file: &[u8]| out(|ticks| unsafe { umbra_replay_verify(file.as_ptr(), file.len(), Some(&LIMITS), ticks) });
    assert_eq!(verify(&file), Ok(100));
    assert_eq!(verify(&file[..file.len() - 9]), Err(UMBRA_ERROR_REPLAY_CUT_OFF));

    // The same without a recorder; then it is the caller's.
    let mut plain = from().expect("a world");
    let find = |world: &UmbraWorld, name: &str| {
        // SAFETY: the text is there.
        out(|body| unsafe { umbra_world_find_body(Some(world), name.as_ptr().cast(), name.len(), body) })
    };
    let first = find(&plain, "lander").expect("a body of that name");
    assert_eq!(find(&plain, "nobody"), Err(UMBRA_ERROR_BAD_ARGUMENT));
    // SAFETY: the buffers are those of `text`.
    let name = text(|to, size, length| unsafe { umbra_world_body_name(Some(&plain), first, to, size, length) });
    assert_eq!(name.as_deref(), Ok("lander"));
    for _ in 0..100 {
        assert_eq!(umbra_world_step(Some(&mut plain)), UMBRA_OK);
    }
    assert_eq!(state_hash(&plain), state_hash(&world));
    let snapshot = own(|snapshot| umbra_world_snapshot(Some(&plain), snapshot)).expect("a snapshot");
    assert_eq!(umbra_world_restore(Some(&mut plain), Some(&snapshot)), UMBRA_ERROR_BUSY);
    let mut bytes = own(|bytes| umbra_snapshot_to_bytes(Some(&snapshot), bytes)).expect("bytes");
    // SAFETY: that is where they are.
    let bytes_there =
        unsafe { std::slice::from_raw_parts(umbra_bytes_data(Some(&mut bytes)), umbra_bytes_length(Some(&bytes))) };
    assert_eq!(Snapshot::from_bytes(bytes_there, &[]).expect("a snapshot").world().state_hash(), state_hash(&plain));
    assert_eq!(umbra_world_leave_scene(Some(&mut plain)), UMBRA_OK);
    assert_eq!(find(&plain, "lander"), Err(UMBRA_ERROR_BAD_ARGUMENT), "names end with the scene");
    assert_eq!(umbra_world_restore(Some(&mut plain), Some(&snapshot)), UMBRA_OK);
    assert_eq!(umbra_world_clear_forces(Some(&mut plain)), UMBRA_OK);
    umbra_bytes_free(Some(bytes));
    umbra_snapshot_free(Some(snapshot));
    umbra_world_free(Some(plain));
    umbra_world_free(Some(world));
}

#[test]
fn a_replay_is_verified_within_limits() {
    let mut world = world();
    let body = add(&mut world, &body_def()).expect("a body");
    assert_eq!(umbra_world_record(Some(&mut world), 0, 0), UMBRA_OK);
    let shape = own(|shape| umbra_shape_circle(UMBRA_ONE, shape)).expect("a shape");
    let empty = out(|def| umbra_collider_def_default(def)).expect("a definition");
    let def = UmbraColliderDef { shape: &raw const *shape, ..empty };
    let drag = out(|def| umbra_field_def_default(UMBRA_DRAG, def)).expect("a definition");
    for _ in 0..2 {
        add(&mut world, &body_def()).expect("a body");
        out(|field| umbra_world_add_field(Some(&mut world), Some(&drag), field)).expect("a field");
        // SAFETY: the shape of the definition is there.
        out(|id| unsafe { umbra_world_add_collider(Some(&mut world), body, Some(&def), id) }).expect("a collider");
        assert_eq!(umbra_world_step(Some(&mut world)), UMBRA_OK);
    }
    umbra_shape_free(Some(shape));
    let mut bytes = own(|bytes| umbra_world_end_record(Some(&mut world), bytes)).expect("bytes");
    let (at, length) = (umbra_bytes_data(Some(&mut bytes)), umbra_bytes_length(Some(&bytes)));
    let mut ticks = MaybeUninit::new(77);
    // SAFETY: that is where they are.
    let mut verify = |limits| unsafe { umbra_replay_verify(at, length, Some(&limits), Some(&mut ticks)) };
    let limits = UmbraReplayLimits { ticks: 2, commands: 6, bodies: 3, fields: 2, colliders: 2, pairs: 1 << 20 };
    assert_eq!(verify(limits), UMBRA_OK);
    assert_eq!(verify(UmbraReplayLimits { ticks: 1, ..limits }), UMBRA_ERROR_VERIFY_TICKS);
    assert_eq!(last_message(), "the replay has 2 ticks, more than the limit of 1");
    assert_eq!(verify(UmbraReplayLimits { bodies: 2, ..limits }), UMBRA_ERROR_VERIFY_BODIES);
    assert_eq!(verify(UmbraReplayLimits { fields: 1, ..limits }), UMBRA_ERROR_VERIFY_FIELDS);
    assert_eq!(verify(UmbraReplayLimits { colliders: 1, ..limits }), UMBRA_ERROR_VERIFY_COLLIDERS);
    assert_eq!(verify(UmbraReplayLimits { pairs: (1 << 20) - 1, ..limits }), UMBRA_ERROR_VERIFY_PAIRS);
    assert_eq!(verify(UmbraReplayLimits { commands: 5, ..limits }), UMBRA_ERROR_VERIFY_COMMANDS);
    // SAFETY: initialised above.
    assert_eq!(unsafe { ticks.assume_init() }, 2, "given also if it is more than it may be");
    umbra_bytes_free(Some(bytes));
    umbra_world_free(Some(world));
}

/// All bytes of a recording that ends, freed.
fn end_record(world: &mut UmbraWorld) -> Vec<u8> {
    let mut bytes = own(|bytes| umbra_world_end_record(Some(world), bytes)).expect("bytes");
    let (at, length) = (umbra_bytes_data(Some(&mut bytes)), umbra_bytes_length(Some(&bytes)));
    // SAFETY: that is where they are.
    let file = unsafe { std::slice::from_raw_parts(at, length) }.to_vec();
    umbra_bytes_free(Some(bytes));
    file
}

/// A recording of 60 ticks of a ball that falls, with a score in the blob, and the hashes of all ticks.
fn recorded_fall(gravity: i64) -> (Vec<u8>, Vec<u64>) {
    let mut world = world();
    assert_eq!(umbra_world_set_gravity(Some(&mut world), 0, gravity), UMBRA_OK);
    let body = add(&mut world, &body_def()).expect("a body");
    assert_eq!(umbra_world_record(Some(&mut world), 1, 20), UMBRA_OK);
    let mut inputs = UmbraInputs::default();
    let mut draft = own(|draft| umbra_draft_new(draft)).expect("a draft");
    let mut hashes = vec![state_hash(&world)];
    for tick in 0..60 {
        assert_eq!(umbra_world_set_velocity(Some(&mut draft), body, tick * ONE, 0), UMBRA_OK);
        let command = drafted(&draft);
        assert_eq!(umbra_inputs_clear(Some(&mut inputs)), UMBRA_OK);
        // SAFETY: the bytes are there.
        let insert = unsafe { umbra_inputs_insert(Some(&mut inputs), 3, 0, command.as_ptr(), command.len()) };
        assert_eq!(insert, UMBRA_OK);
        // SAFETY: the byte is there.
        assert_eq!(unsafe { umbra_world_set_blob(Some(&mut world), [tick as u8].as_ptr(), 1) }, UMBRA_OK);
        assert_eq!(umbra_world_step_inputs(Some(&mut world), Some(&inputs)), UMBRA_OK);
        hashes.push(state_hash(&world));
    }
    let file = end_record(&mut world);
    umbra_world_free(Some(draft));
    umbra_world_free(Some(world));
    (file, hashes)
}

fn blob(world: &UmbraWorld) -> Vec<u8> {
    // SAFETY: the buffers are those of `list`.
    list(|to, size, count| unsafe { umbra_world_blob(Some(world), to, size, count) }).expect("a blob")
}

#[test]
fn a_server_knows_where_a_replay_starts_and_who_won() {
    let (file, hashes) = recorded_fall(-10 * ONE);
    // SAFETY: the bytes are there.
    let start = own(|world| unsafe { umbra_replay_start(file.as_ptr(), file.len(), world) }).expect("a start");
    assert_eq!(state_hash(&start), hashes[0]);
    // The same match in a level without gravity is good in itself, and starts elsewhere.
    let (forged, _) = recorded_fall(0);
    let end = |file: &[u8], limits: UmbraReplayLimits| {
        // SAFETY: the bytes are there.
        own(|world| unsafe { umbra_replay_end(file.as_ptr(), file.len(), Some(&limits), world) })
    };
    assert!(end(&forged, LIMITS).is_ok());
    // SAFETY: the bytes are there.
    let elsewhere = own(|world| unsafe { umbra_replay_start(forged.as_ptr(), forged.len(), world) }).expect("a start");
    assert_ne!(state_hash(&elsewhere), hashes[0]);

    let last = end(&file, LIMITS).expect("the end");
    assert_eq!((state_hash(&last), blob(&last)), (hashes[60], vec![59]));
    let refused = end(&file, UmbraReplayLimits { commands: 59, ..LIMITS }).err();
    assert_eq!(refused, Some(UMBRA_ERROR_VERIFY_COMMANDS));
    let mut changed = file.clone();
    changed[200] ^= 1;
    assert_eq!(end(&changed, LIMITS).err(), Some(UMBRA_ERROR_REPLAY_TAMPERED));
    assert_eq!(end(&file[..file.len() - 9], LIMITS).err(), Some(UMBRA_ERROR_REPLAY_CUT_OFF));
    // What it gives is the caller's, as any world.
    let mut last = last;
    assert_eq!(umbra_world_step(Some(&mut last)), UMBRA_OK);
    for world in [start, elsewhere, last] {
        umbra_world_free(Some(world));
    }
}

#[test]
fn a_replay_is_played_step_by_step() {
    let (file, hashes) = recorded_fall(-10 * ONE);
    // SAFETY: the bytes are there.
    let played = own(|world| unsafe { umbra_world_from_replay(file.as_ptr(), file.len(), world) });
    let mut world = played.expect("a world");
    let mut end = MaybeUninit::new(0);
    let start = out(|start| umbra_world_replay_ticks(Some(&world), start, Some(&mut end))).expect("ticks");
    // SAFETY: initialised above.
    assert_eq!((start, unsafe { end.assume_init() }), (0, 60));
    let outcomes = |world: &UmbraWorld| {
        // SAFETY: the buffers are those of `list`.
        list(|to, size, count| unsafe { umbra_world_outcomes(Some(world), to, size, count) }).expect("outcomes")
    };
    for &hash in &hashes[1..=30] {
        assert_eq!(umbra_world_step(Some(&mut world)), UMBRA_OK);
        assert_eq!(state_hash(&world), hash);
        assert_eq!(
            outcomes(&world).iter().map(|outcome| (outcome.player, outcome.status)).collect::<Vec<_>>(),
            [(3, 0)]
        );
    }
    // The replay alone changes it.
    let body = out(|body| umbra_world_body_with_key(Some(&world), 0, body));
    let refused = umbra_world_set_velocity(Some(&mut world), body.unwrap_or(0), 0, 0);
    assert_eq!((refused, last_message().as_str()), (UMBRA_ERROR_BUSY, "a replay runs this world"));
    assert_eq!(umbra_world_record(Some(&mut world), 1, 0), UMBRA_ERROR_BUSY);
    assert_eq!(umbra_world_step_back(Some(&mut world), None), UMBRA_ERROR_BUSY);
    let mut inputs = UmbraInputs::default();
    // SAFETY: a command of one byte.
    assert_eq!(unsafe { umbra_inputs_insert(Some(&mut inputs), 0, 0, [27].as_ptr(), 1) }, UMBRA_OK);
    assert_eq!(umbra_world_step_inputs(Some(&mut world), Some(&inputs)), UMBRA_ERROR_BUSY);
    assert_eq!((state_hash(&world), outcomes(&world).len()), (hashes[30], 1), "what is refused changes nothing");

    // A copy plays on by itself; the first goes to and fro.
    let mut copy = own(|copy| umbra_world_clone(Some(&world), copy)).expect("a copy");
    for (tick, expected) in [(7, 7), (59, 59), (1000, 60), (0, 0), (45, 45)] {
        assert_eq!(umbra_world_seek(Some(&mut world), tick), UMBRA_OK);
        assert_eq!((state_hash(&world), outcomes(&world).len()), (hashes[expected], 0), "tick {tick}");
    }
    for &hash in &hashes[31..=60] {
        assert_eq!(umbra_world_step(Some(&mut copy)), UMBRA_OK);
        assert_eq!(state_hash(&copy), hash);
    }
    assert_eq!(umbra_world_step(Some(&mut copy)), UMBRA_ERROR_END);
    assert_eq!((state_hash(&copy), outcomes(&copy).len()), (hashes[60], 1), "nothing is done");
    // Then it is the caller's, and no replay's any more.
    assert_eq!(umbra_world_leave_scene(Some(&mut world)), UMBRA_OK);
    assert_eq!(umbra_world_seek(Some(&mut world), 3), UMBRA_ERROR_BAD_ARGUMENT);
    assert_eq!((state_hash(&world), umbra_world_step(Some(&mut world))), (hashes[45], UMBRA_OK));
    umbra_world_free(Some(copy));
    umbra_world_free(Some(world));
}

#[test]
fn all_names_of_a_scene_and_of_its_replay_are_found() {
    let json = r#"{
        "bodies": [
            {"name": "wall", "kind": "static", "colliders": [{"name": "brick", "shape": {"rectangle": {"width": 1, "height": 1}}}]},
            {"name": "door", "position": [4, 0], "colliders": [{"shape": {"circle": {"radius": 1}}}, {"name": "knob", "shape": {"circle": {"radius": 0.1}}}]}
        ],
        "fields": [{"name": "wind", "drag": {"linear": 1, "wind": [1, 0]}}],
        "joints": [{"name": "hinge", "bodies": ["wall", "door"], "point": [2, 0], "revolute": {}}]
    }"#;
    // SAFETY: the text is there.
    let world = own(|world| unsafe { umbra_world_from_scene(json.as_ptr().cast(), json.len(), 100, world) });
    let mut world = world.unwrap_or_else(|_| panic!("{}", last_message()));
    assert_eq!(umbra_world_record(Some(&mut world), 1, 0), UMBRA_OK);
    assert_eq!(umbra_world_step(Some(&mut world)), UMBRA_OK);
    let file = end_record(&mut world);
    // SAFETY: the bytes are there.
    let replayed = own(|world| unsafe { umbra_world_from_replay(file.as_ptr(), file.len(), world) }).expect("a world");

    type Find = unsafe extern "C" fn(Option<&UmbraWorld>, *const c_char, usize, Option<&mut MaybeUninit<u64>>) -> i32;
    type Name =
        unsafe extern "C" fn(Option<&UmbraWorld>, u64, *mut c_char, usize, Option<&mut MaybeUninit<usize>>) -> i32;
    let kinds: [(Find, Name, &[&str], UmbraStatus); 4] = [
        (umbra_world_find_body, umbra_world_body_name, &["wall", "door"], UMBRA_ERROR_NO_SUCH_BODY),
        (umbra_world_find_field, umbra_world_field_name, &["wind"], UMBRA_ERROR_NO_SUCH_FIELD),
        (umbra_world_find_joint, umbra_world_joint_name, &["hinge"], UMBRA_ERROR_NO_SUCH_JOINT),
        (umbra_world_find_collider, umbra_world_collider_name, &["brick", "knob"], UMBRA_ERROR_NO_SUCH_COLLIDER),
    ];
    for run in [&world, &replayed] {
        for (find, name, names, unknown) in kinds {
            for expected in names {
                // SAFETY: the text is there.
                let handle = out(|handle| unsafe { find(Some(run), expected.as_ptr().cast(), expected.len(), handle) });
                let handle = handle.expect(expected);
                // SAFETY: the buffers are those of `text`.
                let written = text(|to, size, length| unsafe { name(Some(run), handle, to, size, length) });
                assert_eq!(written.as_deref(), Ok(*expected));
            }
            // SAFETY: the text is there.
            let nobody = out(|handle| unsafe { find(Some(run), c"it".as_ptr(), 2, handle) });
            assert_eq!(nobody, Err(UMBRA_ERROR_BAD_ARGUMENT));
            // SAFETY: null is good for a capacity of 0.
            assert_eq!(unsafe { name(Some(run), UMBRA_NO_HANDLE, ptr::null_mut(), 0, None) }, unknown);
        }
    }
    // The first collider of the door has none.
    // SAFETY: the text is there.
    let door = out(|body| unsafe { umbra_world_find_body(Some(&world), c"door".as_ptr(), 4, body) }).expect("a door");
    // SAFETY: the buffers are those of `list`.
    let colliders = list(|to, size, count| unsafe { umbra_world_body_colliders(Some(&world), door, to, size, count) });
    let first = colliders.expect("colliders")[0];
    let mut buffer = [1u8; 4];
    // SAFETY: the buffer is there.
    let status = unsafe { umbra_world_collider_name(Some(&world), first, buffer.as_mut_ptr().cast(), 4, None) };
    assert_eq!((status, buffer[0]), (UMBRA_OK, 0));
    umbra_world_free(Some(replayed));
    umbra_world_free(Some(world));
}

#[test]
fn steps_are_undone_as_in_the_library() {
    let mut def = out(|def| umbra_world_def_default(def)).expect("a definition");
    (def.sleep_after, def.gravity.y) = (UMBRA_NEVER, -10 * ONE);
    let mut world = own(|world| umbra_world_new(Some(&def), world)).expect("a world");
    let body = add(&mut world, &body_def()).expect("a body");
    assert_eq!(umbra_world_step_back(Some(&mut world), None), UMBRA_ERROR_NOT_REVERSIBLE);
    assert_eq!(umbra_last_cause(), 133, "no step has been taken");
    let (mut hashes, mut kept) = (Vec::new(), Vec::new());
    for tick in 0..20 {
        hashes.push(state_hash(&world));
        if tick % 3 == 0 {
            assert_eq!(umbra_world_apply_force(Some(&mut world), body, 7 * ONE, ONE / 3, None, 0), UMBRA_OK);
        }
        assert_eq!(umbra_world_step(Some(&mut world)), UMBRA_OK);
        kept.push(own(|applied| umbra_world_applied_forces(Some(&world), applied)).expect("forces"));
    }
    // The last one by the report of the world, which is good for one step.
    assert_eq!(umbra_world_step_back(Some(&mut world), None), UMBRA_OK);
    umbra_applied_forces_free(kept.pop());
    for tick in (0..19).rev() {
        // Over the tick that was undone nothing of this tick acts: the forces are applied again, to be cleared.
        assert_eq!(umbra_world_clear_forces(Some(&mut world)), UMBRA_OK);
        let applied = kept.pop().expect("forces");
        assert_eq!(umbra_world_step_back(Some(&mut world), Some(&applied)), UMBRA_OK, "{}", last_message());
        umbra_applied_forces_free(Some(applied));
        let mut cleared = own(|copy| umbra_world_clone(Some(&world), copy)).expect("a copy");
        assert_eq!(umbra_world_clear_forces(Some(&mut cleared)), UMBRA_OK);
        assert_eq!(state_hash(&cleared), hashes[tick], "tick {tick}");
        umbra_world_free(Some(cleared));
    }
    assert_eq!(umbra_world_record(Some(&mut world), 1, 0), UMBRA_OK);
    assert_eq!(umbra_world_step_back(Some(&mut world), None), UMBRA_ERROR_BUSY);
    umbra_world_free(Some(world));
}

/// Corners as a renderer gets them: of a box that turns, a disc, a body without a collider, and the contact of the two that touch.
#[test]
fn a_drawing_has_the_figures_of_the_library() {
    let json = r#"{
        "gravity": [0, -10],
        "bodies": [
            {"name": "floor", "kind": "static", "position": [1000, 0], "colliders": [{"shape": {"rectangle": {"width": 8, "height": 2}}}]},
            {"name": "ball", "position": [1000, 1.5], "colliders": [{"shape": {"circle": {"radius": 0.5}}}]},
            {"name": "box", "position": [1004, 9], "angle": 1, "colliders": [{"shape": {"rectangle": {"width": 2, "height": 1}}}]},
            {"name": "dot", "position": [1000, 20], "velocity": [3, 0]}
        ]
    }"#;
    // SAFETY: the text is there.
    let world = own(|world| unsafe { umbra_world_from_scene(json.as_ptr().cast(), json.len(), 100, world) });
    let mut world = world.unwrap_or_else(|_| panic!("{}", last_message()));
    for _ in 0..3 {
        assert_eq!(umbra_world_step(Some(&mut world)), UMBRA_OK);
    }
    let mut drawing = own(|drawing| umbra_drawing_new(drawing)).expect("a drawing");
    let standard = out(|options| umbra_draw_options_default(options)).expect("options");
    let mut draw = |options: &UmbraDrawOptions| {
        assert_eq!(umbra_world_draw(Some(&world), Some(options), Some(&mut drawing)), UMBRA_OK);
        // SAFETY: the buffers are those of `list`.
        let figures = list(|to, size, count| unsafe { umbra_drawing_figures(Some(&drawing), to, size, count) });
        // SAFETY: the buffers are those of `list`.
        let points = list(|to, size, count| unsafe { umbra_drawing_points(Some(&drawing), to, size, count) });
        let (figures, points) = (figures.expect("figures"), points.expect("points"));
        let points: Vec<[f32; 2]> = points.chunks(2).map(|pair| [pair[0], pair[1]]).collect();
        // Each point is of one figure, in their order.
        let ends = figures.iter().scan(0, |end, figure| {
            assert_eq!(figure.first_point, *end);
            *end += figure.point_count;
            Some(*end)
        });
        assert_eq!(ends.last().unwrap_or(0) as usize, points.len());
        let corners = |figure: &UmbraFigure| {
            let first = figure.first_point as usize;
            points[first..first + figure.point_count as usize].to_vec()
        };
        figures.iter().map(|figure| (*figure, corners(figure))).collect::<Vec<_>>()
    };
    let origin = UmbraVec2 { x: 1000 * ONE, y: ONE };
    let all = draw(&UmbraDrawOptions { origin, contacts: 1, velocity_seconds: ONE / 2, ..standard });
    let body = |name: &str| {
        // SAFETY: the text is there.
        out(|body| unsafe { umbra_world_find_body(Some(&world), name.as_ptr().cast(), name.len(), body) }).expect(name)
    };
    let figures_of = |name: &str, role| {
        all.iter().filter(|(figure, _)| figure.role == role && figure.handle == body(name)).collect::<Vec<_>>()
    };
    let [(floor, corners)] = figures_of("floor", UMBRA_ROLE_BODY)[..] else { panic!("{all:?}") };
    assert_eq!((floor.form, floor.class), (UMBRA_FIGURE_POLYGON, UMBRA_CLASS_STATIC));
    // Its collider, and the one of no other body.
    let outlined = out(|body| umbra_world_collider_body(Some(&world), floor.other, body));
    assert_eq!(outlined, Ok(body("floor")));
    assert_eq!(corners[..], [[-4.0, -2.0], [4.0, -2.0], [4.0, 0.0], [-4.0, 0.0]]);
    // A disc of 48 corners, and the line to its rim.
    let [(disc, rim), (radius, ends)] = figures_of("ball", UMBRA_ROLE_BODY)[..] else { panic!("{all:?}") };
    assert_eq!((disc.point_count, disc.class, radius.form), (48, UMBRA_CLASS_DYNAMIC, UMBRA_FIGURE_SEGMENT));
    let centre = ends[0];
    assert!(rim.iter().all(|point| ((point[0] - centre[0]).hypot(point[1] - centre[1]) - 0.5).abs() < 1e-6));
    // The box is where its body is: its middle, and the way from its first corner to the second.
    let state = out(|state| umbra_world_body(Some(&world), body("box"), state)).expect("a body");
    let (position, angle) = (Vec2::from(state.position).to_f64(), Fx::from_bits(state.angle).to_f64());
    let [(_, corners)] = figures_of("box", UMBRA_ROLE_BODY)[..] else { panic!("{all:?}") };
    let middle = [0, 1].map(|i| corners.iter().map(|corner| f64::from(corner[i])).sum::<f64>() / 4.0);
    assert!((middle[0] + 1000.0 - position[0]).abs() < 1e-6 && (middle[1] + 1.0 - position[1]).abs() < 1e-6);
    let along = [0, 1].map(|i| f64::from(corners[1][i] - corners[0][i]));
    assert!((along[0] - 2.0 * angle.cos()).abs() < 1e-6 && (along[1] - 2.0 * angle.sin()).abs() < 1e-6);
    let [(dot, at)] = figures_of("dot", UMBRA_ROLE_BODY)[..] else { panic!("{all:?}") };
    assert_eq!((dot.form, dot.other, at.len()), (UMBRA_FIGURE_POINT, UMBRA_NO_HANDLE, 1));
    // 1.5 m to the right, as it falls with less than that.
    let [(arrow, ends)] = figures_of("dot", UMBRA_ROLE_VELOCITY)[..] else { panic!("{all:?}") };
    assert_eq!((arrow.form, ends[0], ends[1][0] - ends[0][0]), (UMBRA_FIGURE_ARROW, at[0], 1.5));
    let contacts: Vec<_> = all.iter().filter(|(figure, _)| figure.role == UMBRA_ROLE_CONTACT).collect();
    let [(contact, point)] = contacts[..] else { panic!("{all:?}") };
    let touching = out(|body| umbra_world_collider_body(Some(&world), contact.other, body));
    assert_eq!(touching, Ok(body("ball")));
    assert!(point[0][0].abs() < 1e-3 && point[0][1].abs() < 1e-2);
    // Without options that are off by default there are bodies alone, and the memory is that of the drawing before.
    assert!(draw(&standard).iter().all(|(figure, _)| figure.role == UMBRA_ROLE_BODY));
    let nothing = draw(&UmbraDrawOptions { bodies: 0, fields: 0, joints: 0, ..standard });
    assert!(nothing.is_empty());
    umbra_drawing_free(Some(drawing));
    umbra_world_free(Some(world));
}

#[test]
fn arithmetic_is_that_of_the_library() {
    type Binary = extern "C" fn(UmbraFx, UmbraFx, Option<&mut MaybeUninit<UmbraFx>>) -> UmbraStatus;
    type Unary = extern "C" fn(UmbraFx, Option<&mut MaybeUninit<UmbraFx>>) -> UmbraStatus;
    type Reference2 = fn(Fx, Fx) -> Option<Fx>;
    type Reference = fn(Fx) -> Option<Fx>;
    let binary: [(Binary, Reference2); 9] = [
        (umbra_fx_from_ratio, |a, b| Fx::checked_from_ratio(a.to_bits(), b.to_bits())),
        (umbra_fx_add, Fx::checked_add),
        (umbra_fx_sub, Fx::checked_sub),
        (umbra_fx_mul, Fx::checked_mul),
        (umbra_fx_div, Fx::checked_div),
        (umbra_fx_rem_euclid, |a, b| (b != Fx::ZERO).then(|| a.rem_euclid(b))),
        (umbra_fx_hypot, Fx::checked_hypot),
        (umbra_fx_atan2, |a, b| Some(a.atan2(b))),
        (umbra_fx_pow, |a, b| a.pow(b).ok()),
    ];
    let unary: [(Unary, Reference); 5] = [
        (umbra_fx_sqrt, Fx::checked_sqrt),
        (umbra_fx_sin, |a| Some(a.sin())),
        (umbra_fx_cos, |a| Some(a.cos())),
        (umbra_fx_log2, |a| a.log2().ok()),
        (umbra_fx_exp2, |a| a.exp2().ok()),
    ];
    let mut random = Random::seeded(5);
    let edges = [0, 1, -1, ONE, -ONE, 3 * ONE, i64::MAX, i64::MIN];
    let some: Vec<i64> = (0..40).map(|i| (random.bits() as i64) >> i).chain(edges).collect();
    let (mut refused, mut done) = (0, 0);
    let mut same = |result: Result<i64, UmbraStatus>, expected: Option<Fx>| match (result, expected) {
        (Ok(bits), Some(expected)) => {
            assert_eq!(bits, expected.to_bits());
            done += 1;
        }
        (Err(UMBRA_ERROR_MATH_NOT_POSITIVE | UMBRA_ERROR_MATH_OVERFLOW), None) => refused += 1,
        pair => panic!("{pair:?}"),
    };
    for &a in &some {
        for (function, reference) in unary {
            same(out(|number| function(a, number)), reference(Fx::from_bits(a)));
        }
        for &b in &some {
            for (function, reference) in binary {
                same(out(|number| function(a, b, number)), reference(Fx::from_bits(a), Fx::from_bits(b)));
            }
        }
    }
    assert!(refused > 1000 && done > 10_000, "{refused} {done}");
    // Which reason, and its words.
    let reason = |status: UmbraStatus| (status, last_message());
    let mut number = MaybeUninit::new(7);
    let zero = "division by zero".to_owned();
    assert_eq!(reason(umbra_fx_div(ONE, 0, Some(&mut number))), (UMBRA_ERROR_MATH_NOT_POSITIVE, zero.clone()));
    assert_eq!(reason(umbra_fx_from_ratio(1, 0, Some(&mut number))), (UMBRA_ERROR_MATH_NOT_POSITIVE, zero));
    let too_large = "the value does not fit in I32F32".to_owned();
    assert_eq!(
        reason(umbra_fx_mul(1 << 60, 1 << 60, Some(&mut number))),
        (UMBRA_ERROR_MATH_OVERFLOW, too_large.clone())
    );
    assert_eq!(reason(umbra_fx_exp2(31 * ONE, Some(&mut number))), (UMBRA_ERROR_MATH_OVERFLOW, too_large));
    let root = "the square root of a negative number".to_owned();
    assert_eq!(reason(umbra_fx_sqrt(-1, Some(&mut number))), (UMBRA_ERROR_MATH_NOT_POSITIVE, root));
    let logarithm = "the argument is not positive".to_owned();
    assert_eq!(reason(umbra_fx_log2(0, Some(&mut number))), (UMBRA_ERROR_MATH_NOT_POSITIVE, logarithm));
    // SAFETY: initialised above.
    assert_eq!(unsafe { number.assume_init() }, 7, "nothing is written of what is refused");
}

#[test]
fn room_that_is_asked_for_is_aligned_for_every_struct() {
    for length in [0, 1, 7, 24, 4096] {
        let mut bytes = own(|bytes| umbra_bytes_new(length, bytes)).expect("room");
        let at = umbra_bytes_data(Some(&mut bytes));
        assert_eq!((at as usize % 16, umbra_bytes_length(Some(&bytes))), (0, length));
        // SAFETY: that is where they are.
        assert!(unsafe { std::slice::from_raw_parts(at, length) }.iter().all(|&byte| byte == 0));
        umbra_bytes_free(Some(bytes));
    }
}

#[test]
fn the_numbers_of_errors_are_those_of_the_document() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let document = fs::read_to_string(root.join("docs/errors.md")).expect("the document");
    let header = fs::read_to_string(root.join("capi/include/umbra_physics.h")).expect("the header");
    let mut count = 0;
    for line in header.lines().filter_map(|line| line.strip_prefix("#define UMBRA_ERROR_")) {
        let (name, number) = line.split_once(' ').expect("a number");
        let row = document.lines().find_map(|line| line.strip_prefix(&format!("| E{number} | `"))).expect(line);
        let theirs = row.split_once('`').expect("a name").0;
        // `SnapshotError::CustomForce` as `SNAPSHOT_FORCE_LAW`.
        let mut ours = String::new();
        for c in theirs.replace("ParseFxError", "Number").replace("Error", "").replace("::", "").chars() {
            if c.is_uppercase() && !ours.is_empty() {
                ours.push('_');
            }
            ours.push(c.to_ascii_uppercase());
        }
        assert!(ours == name || theirs == format!("UMBRA_ERROR_{name}"), "{name} and {theirs}");
        let code: UmbraStatus = number.parse().expect("a number");
        // SAFETY: the buffers are those of `text`.
        let words = text(|to, size, length| unsafe { umbra_status_message(code, to, size, length) }).expect("words");
        assert!(words.len() > 3 && !words.contains(['`', '|', '[']), "{words}");
        count += 1;
    }
    assert_eq!(count, 61);
}

/// The struct sizes of C, which the page in `examples/web` relies on too.
#[test]
fn structs_lie_as_they_are_known() {
    assert_eq!((size_of::<UmbraWorldDef>(), size_of::<UmbraPose>()), (48, 56));
    assert_eq!((size_of::<UmbraBodyDef>(), std::mem::offset_of!(UmbraBodyDef, is_bullet)), (144, 140));
    assert_eq!((size_of::<UmbraBodyState>(), size_of::<UmbraFieldDef>()), (264, 288));
    assert_eq!((size_of::<UmbraGoal>(), size_of::<UmbraContactPoint>(), size_of::<UmbraContact>()), (32, 32, 136));
    assert_eq!((size_of::<UmbraDrawOptions>(), size_of::<UmbraFigure>()), (56, 40));
    assert_eq!(std::mem::offset_of!(UmbraFieldDef, max), 216);
}
