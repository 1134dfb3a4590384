//! Null is refused by every function that it means nothing to, in each of its places, with all else good.

use std::collections::BTreeSet;
use std::fs;
use std::mem::MaybeUninit;
use std::path::Path;
use std::ptr::{null, null_mut};

use umbra_physics::{RecordOptions, Recorder, World, WorldDef};
use umbra_physics_capi::*;

macro_rules! refused {
    ($seen:ident: $($call:ident($($argument:expr),*);)*) => {
        $(
            $seen.insert(stringify!($call));
            #[allow(unused_unsafe, reason = "some of them are safe")]
            // SAFETY: pointers are null or good, and lengths are theirs.
            let status = unsafe { $call($($argument),*) };
            let said = stringify!($call($($argument),*));
            assert_eq!(status, UMBRA_ERROR_NULL_POINTER, "{said}");
        )*
    };
}

/// The status of a call that is carried out.
fn made<T>(call: impl FnOnce(Option<&mut MaybeUninit<T>>) -> UmbraStatus) -> T {
    let mut place = MaybeUninit::uninit();
    assert_eq!(call(Some(&mut place)), UMBRA_OK);
    // SAFETY: a call that is done has written it.
    unsafe { place.assume_init() }
}

/// The functions of the header that take a pointer.
fn with_pointers(header: &str) -> BTreeSet<&str> {
    let (_, code) = header.split_once("#include <stdint.h>").expect("includes");
    let functions = code.split(';').filter_map(|declaration| {
        let (before, arguments) = declaration.rsplit_once('(')?;
        let name = before.rsplit([' ', '*', '\n']).next()?;
        (name.starts_with("umbra_") && arguments.contains('*')).then_some(name)
    });
    functions.collect()
}

#[test]
fn null_is_refused_everywhere() {
    let mut names = BTreeSet::new();
    // Good values for the other places.
    let world_def = made(|def| umbra_world_def_default(def));
    let body_def = made(|def| umbra_body_def_default(def));
    let field_def = made(|def| umbra_field_def_default(UMBRA_DRAG, def));
    let mut world = made(|world| umbra_world_new(Some(&world_def), world)).expect("a world");
    let draft = made(|draft| umbra_draft_new(draft)).expect("a draft");
    let mut inputs = made(|inputs| umbra_inputs_new(inputs)).expect("inputs");
    let mut snapshot = made(|snapshot| umbra_world_snapshot(Some(&world), snapshot)).expect("a snapshot");
    let (w, d, i, s) = (&mut *world, &*draft, &mut *inputs, &mut *snapshot);
    // SAFETY: the definition is filled in.
    let b = made(|body| umbra_world_add_body(Some(w), Some(&body_def), body));
    let f = made(|field| umbra_world_add_field(Some(w), Some(&field_def), field));
    let joint_def = made(|def| umbra_joint_def_revolute(Some(w), UMBRA_NO_HANDLE, b, 0, 0, def));
    let j = made(|joint| umbra_world_add_joint(Some(w), Some(&joint_def), joint));
    let shapeless = made(|def| umbra_character_def_default(def));
    let empty_collider = made(|def| umbra_collider_def_default(def));
    let disc = made(|shape| umbra_shape_circle(UMBRA_ONE, shape)).expect("a shape");
    let hero = UmbraCharacterDef { shape: &raw const *disc, ..shapeless };
    let blast =
        UmbraExplosion { position: UmbraVec2::default(), radius: 0, falloff: 0, impulse: 0, mask: 0, reserved: 0 };
    let no_ground = UmbraGround { body: UMBRA_NO_HANDLE, local: UmbraVec2::default(), point: UmbraVec2::default() };
    let far = UmbraVec2 { x: 99 * UMBRA_ONE, y: 0 };
    let still = UmbraVec2::default();
    let way = UmbraCharacterMove { position: far, translation: still, ground: no_ground, before_step: 0, reserved: 0 };
    // SAFETY: the shape is alive.
    let movement = made(|movement| unsafe { umbra_character_move(Some(w), Some(&hero), Some(&way), None, movement) });
    let movement = movement.expect("a movement");
    let collider_def = UmbraColliderDef { shape: &raw const *disc, ..empty_collider };
    // SAFETY: the definition is filled in, and its shape is alive.
    let c = made(|collider| unsafe { umbra_world_add_collider(Some(w), b, Some(&collider_def), collider) });
    let pair = UmbraMaterialPair { friction: 0, restitution: 0, rolling_resistance: 0 };
    let settings = made(|settings| umbra_contact_settings_default(settings));
    let (mut first, mut second, mut number) = (MaybeUninit::uninit(), MaybeUninit::uninit(), MaybeUninit::uninit());
    let (point, wide) = (UmbraVec2::default(), UmbraInt128::default());
    let (clear, ray, sweep) = ([27u8], UmbraRay::default(), UmbraSweep::default());
    let text = c"1".as_ptr();
    let part = UmbraPart { position: point, angle: 0, density: UMBRA_ONE, shape: null() };
    let mut place = MaybeUninit::uninit();
    let mut drawing = made(|drawing| umbra_drawing_new(drawing)).expect("a drawing");
    let g = &mut *drawing;
    let file = {
        let run = World::new(WorldDef::default()).expect("a world");
        Recorder::new(&run, RecordOptions::default()).finish(&run)
    };

    refused! { names:
        umbra_bytes_new(3, None);
        umbra_fx_from_text(null(), 1, Some(&mut number));
        umbra_fx_from_text(text, 1, None);
        umbra_fx_to_text(0, null_mut(), 1, None);
        umbra_wide_to_text(None, null_mut(), 0, None);
        umbra_wide_to_text(Some(&wide), null_mut(), 1, None);
        umbra_factor_from_text(text, 1, None);
        umbra_factor_from_text(null(), 1, Some(&mut MaybeUninit::uninit()));
        umbra_factor_from_fx(1, None);
        umbra_fx_from_ratio(1, 1, None);
        umbra_fx_add(1, 1, None);
        umbra_fx_sub(1, 1, None);
        umbra_fx_mul(1, 1, None);
        umbra_fx_div(1, 1, None);
        umbra_fx_rem_euclid(1, 1, None);
        umbra_fx_sqrt(1, None);
        umbra_fx_sin(1, None);
        umbra_fx_cos(1, None);
        umbra_fx_log2(1, None);
        umbra_fx_exp2(1, None);
        umbra_fx_hypot(1, 1, None);
        umbra_fx_atan2(1, 1, None);
        umbra_fx_pow(1, 1, None);
        umbra_last_message(null_mut(), 1, None);
        umbra_status_message(101, null_mut(), 1, None);
        umbra_selftest(None);

        umbra_shape_circle(UMBRA_ONE, None);
        umbra_shape_rectangle(UMBRA_ONE, UMBRA_ONE, None);
        umbra_shape_capsule(UMBRA_ONE, UMBRA_ONE, None);
        umbra_shape_segment(None, Some(&point), Some(&mut place));
        umbra_shape_segment(Some(&point), None, Some(&mut place));
        umbra_shape_segment(Some(&point), Some(&point), None);
        umbra_shape_polygon(null(), 3, Some(&mut place));
        umbra_shape_polygon(&raw const point, 1, None);
        umbra_shape_rounded_polygon(null(), 3, 1 << 31, Some(&mut place));
        umbra_shape_rounded_polygon(&raw const point, 1, 1 << 31, None);
        umbra_shape_chain(null(), 3, 0, Some(&mut place));
        umbra_shape_hull(null(), 3, Some(&mut place));
        umbra_shape_hull(&raw const point, 1, None);
        umbra_shape_concave_polygon(null(), 3, Some(&mut place));
        umbra_shape_concave_polygon(&raw const point, 1, None);
        umbra_shape_chain(&raw const point, 1, 0, None);
        umbra_shape_compound(null(), 1, Some(&mut place));
        umbra_shape_compound(&raw const part, 1, Some(&mut place));
        umbra_shape_compound(&raw const part, 1, None);

        umbra_world_def_default(None);
        umbra_world_new(None, Some(&mut MaybeUninit::uninit()));
        umbra_world_new(Some(&world_def), None);
        umbra_world_from_scene(null(), 1, 1, Some(&mut MaybeUninit::uninit()));
        umbra_world_from_scene(c"{}".as_ptr(), 2, 1, None);
        umbra_world_find_body(None, text, 1, Some(&mut MaybeUninit::uninit()));
        umbra_world_find_body(Some(w), null(), 1, Some(&mut MaybeUninit::uninit()));
        umbra_world_find_body(Some(w), text, 1, None);
        umbra_world_body_name(None, b, null_mut(), 0, None);
        umbra_world_find_field(None, text, 1, Some(&mut MaybeUninit::uninit()));
        umbra_world_find_field(Some(w), null(), 1, Some(&mut MaybeUninit::uninit()));
        umbra_world_find_field(Some(w), text, 1, None);
        umbra_world_field_name(None, f, null_mut(), 0, None);
        umbra_world_find_joint(None, text, 1, Some(&mut MaybeUninit::uninit()));
        umbra_world_find_joint(Some(w), null(), 1, Some(&mut MaybeUninit::uninit()));
        umbra_world_find_joint(Some(w), text, 1, None);
        umbra_world_joint_name(None, j, null_mut(), 0, None);
        umbra_world_find_collider(None, text, 1, Some(&mut MaybeUninit::uninit()));
        umbra_world_find_collider(Some(w), null(), 1, Some(&mut MaybeUninit::uninit()));
        umbra_world_find_collider(Some(w), text, 1, None);
        umbra_world_collider_name(None, c, null_mut(), 0, None);
        umbra_world_leave_scene(None);
        umbra_world_clone(None, Some(&mut MaybeUninit::uninit()));
        umbra_world_clone(Some(w), None);
        umbra_world_def(None, Some(&mut MaybeUninit::uninit()));
        umbra_world_def(Some(w), None);
        umbra_world_step(None);
        umbra_world_step_inputs(None, Some(i));
        umbra_world_step_inputs(Some(w), None);
        umbra_world_outcomes(None, null_mut(), 0, None);
        umbra_world_outcomes(Some(w), null_mut(), 1, None);
        umbra_inputs_new(None);
        umbra_inputs_insert(None, 0, 0, clear.as_ptr(), 1);
        umbra_inputs_insert(Some(i), 0, 0, null(), 1);
        umbra_inputs_replace(None, 0, clear.as_ptr(), [1].as_ptr(), 1, None);
        umbra_inputs_replace(Some(i), 0, null(), [1].as_ptr(), 1, None);
        umbra_inputs_replace(Some(i), 0, clear.as_ptr(), null(), 1, None);
        umbra_inputs_clear(None);
        umbra_world_report(None, Some(&mut MaybeUninit::uninit()));
        umbra_world_report(Some(w), None);
        umbra_world_faults(None, null_mut(), 0, None);
        umbra_world_faults(Some(w), null_mut(), 1, None);
        umbra_world_fell_asleep(None, null_mut(), 0, None);
        umbra_world_fell_asleep(Some(w), null_mut(), 1, None);
        umbra_world_woke(None, null_mut(), 0, None);
        umbra_world_woke(Some(w), null_mut(), 1, None);
        umbra_world_tick(None, Some(&mut MaybeUninit::uninit()));
        umbra_world_tick(Some(w), None);
        umbra_world_elapsed(None, Some(&mut MaybeUninit::uninit()), Some(&mut MaybeUninit::uninit()));
        umbra_world_elapsed(Some(w), None, Some(&mut MaybeUninit::uninit()));
        umbra_world_elapsed(Some(w), Some(&mut MaybeUninit::uninit()), None);
        umbra_world_state_hash(None, Some(&mut MaybeUninit::uninit()));
        umbra_world_state_hash(Some(w), None);
        umbra_world_physics_hash(None, Some(&mut MaybeUninit::uninit()));
        umbra_world_physics_hash(Some(w), None);
        umbra_world_first_difference(None, Some(w), null_mut(), 0, None);
        umbra_world_first_difference(Some(w), None, null_mut(), 0, None);
        umbra_world_first_difference(Some(w), Some(w), null_mut(), 1, None);

        umbra_body_def_default(None);
        umbra_world_add_body(None, Some(&body_def), Some(&mut MaybeUninit::uninit()));
        umbra_world_add_body(Some(w), None, Some(&mut MaybeUninit::uninit()));
        umbra_world_add_body(Some(w), Some(&body_def), None);
        umbra_world_remove_body(None, b);
        umbra_world_body(None, b, Some(&mut MaybeUninit::uninit()));
        umbra_world_body(Some(w), b, None);
        umbra_world_body_mass_def(None, b, Some(&mut MaybeUninit::uninit()), Some(&mut number), Some(&mut first));
        umbra_world_body_mass_def(Some(w), b, None, Some(&mut number), Some(&mut first));
        umbra_world_body_mass_def(Some(w), b, Some(&mut MaybeUninit::uninit()), None, Some(&mut first));
        umbra_world_body_mass_def(Some(w), b, Some(&mut MaybeUninit::uninit()), Some(&mut number), None);
        umbra_world_body_goal(None, b, Some(&mut MaybeUninit::uninit()));
        umbra_world_body_goal(Some(w), b, None);
        umbra_world_body_velocity_at(None, b, 0, 0, Some(&mut MaybeUninit::uninit()));
        umbra_world_body_velocity_at(Some(w), b, 0, 0, None);
        umbra_world_body_world_point(None, b, 0, 0, Some(&mut MaybeUninit::uninit()));
        umbra_world_body_world_point(Some(w), b, 0, 0, None);
        umbra_world_body_local_point(None, b, 0, 0, Some(&mut MaybeUninit::uninit()));
        umbra_world_body_local_point(Some(w), b, 0, 0, None);
        umbra_world_body_with_key(None, 0, Some(&mut MaybeUninit::uninit()));
        umbra_world_body_with_key(Some(w), 0, None);
        umbra_world_bodies_with_key(None, 0, null_mut(), 0, None);
        umbra_world_bodies_with_key(Some(w), 0, null_mut(), 1, None);
        umbra_world_body_count(None, None, None);
        umbra_world_bodies(None, null_mut(), 0, None);
        umbra_world_bodies(Some(w), null_mut(), 1, None);
        umbra_world_poses(None, null_mut(), 0, None);
        umbra_world_poses(Some(w), null_mut(), 1, None);
        umbra_world_set_position(None, b, 0, 0);
        umbra_world_set_angle(None, b, 0);
        umbra_world_set_velocity(None, b, 0, 0);
        umbra_world_set_angular_velocity(None, b, 0);
        umbra_world_set_mass(None, b, UMBRA_MASS_KILOGRAMS, UMBRA_ONE, 0);
        umbra_world_set_kind(None, b, UMBRA_STATIC);
        umbra_world_set_gravity_scale(None, b, 0);
        umbra_world_set_body_kept_per_second(None, b, 0, 0);
        umbra_world_set_dominance(None, b, 0);
        umbra_world_set_bullet(None, b, 0);
        umbra_world_explode(None, None);
        umbra_explosion_impulse_on(None, Some(&disc), 0, 0, 0, Some(&mut MaybeUninit::uninit()));
        umbra_explosion_impulse_on(Some(&blast), None, 0, 0, 0, Some(&mut MaybeUninit::uninit()));
        umbra_explosion_impulse_on(Some(&blast), Some(&disc), 0, 0, 0, None);
        umbra_world_set_force_groups(None, b, 0);
        umbra_world_set_key(None, b, 0);
        umbra_world_set_user_data(None, b, 0);
        umbra_world_set_locks(None, b, 0);
        umbra_world_set_max_speeds(None, b, 0, 0);
        umbra_world_disable(None, b);
        umbra_world_enable(None, b);
        umbra_world_move_to(None, b, 0, 0, 0);
        umbra_world_wake(None, b);
        umbra_world_sleep(None, b);
        umbra_world_release(None, b);

        umbra_field_def_default(UMBRA_DRAG, None);
        umbra_collider_def_default(None);
        umbra_contact_settings_default(None);
        umbra_world_add_collider(None, b, Some(&collider_def), Some(&mut MaybeUninit::uninit()));
        umbra_world_add_collider(Some(w), b, None, Some(&mut MaybeUninit::uninit()));
        umbra_world_add_collider(Some(w), b, Some(&empty_collider), Some(&mut MaybeUninit::uninit()));
        umbra_world_add_collider(Some(w), b, Some(&collider_def), None);
        umbra_world_set_collider(None, c, Some(&collider_def));
        umbra_world_set_collider(Some(w), c, None);
        umbra_world_set_collider(Some(w), c, Some(&empty_collider));
        umbra_world_remove_collider(None, c);
        umbra_world_collider(None, c, Some(&mut MaybeUninit::uninit()));
        umbra_world_collider(Some(w), c, None);
        umbra_world_collider_shape(None, c, Some(&mut MaybeUninit::uninit()));
        umbra_world_collider_shape(Some(w), c, None);
        umbra_world_collider_body(None, c, Some(&mut MaybeUninit::uninit()));
        umbra_world_collider_body(Some(w), c, None);
        umbra_world_body_colliders(None, b, null_mut(), 0, None);
        umbra_world_body_colliders(Some(w), b, null_mut(), 1, None);
        umbra_world_contacts(None, null_mut(), 0, None);
        umbra_world_contacts(Some(w), null_mut(), 1, None);
        umbra_world_body_contacts(None, b, null_mut(), 0, None);
        umbra_world_body_contacts(Some(w), b, null_mut(), 1, None);
        umbra_query_filter_default(None);
        umbra_character_def_default(None);
        umbra_character_move(None, Some(&hero), Some(&way), None, Some(&mut MaybeUninit::uninit()));
        umbra_character_move(Some(w), None, Some(&way), None, Some(&mut MaybeUninit::uninit()));
        umbra_character_move(Some(w), Some(&shapeless), Some(&way), None, Some(&mut MaybeUninit::uninit()));
        umbra_character_move(Some(w), Some(&hero), None, None, Some(&mut MaybeUninit::uninit()));
        umbra_character_move(Some(w), Some(&hero), Some(&way), None, None);
        umbra_movement_state(None, Some(&mut MaybeUninit::uninit()));
        umbra_movement_state(Some(&movement), None);
        umbra_movement_hits(None, null_mut(), 0, None);
        umbra_movement_hits(Some(&movement), null_mut(), 1, None);
        umbra_movement_pushes(None, null_mut(), 0, None);
        umbra_movement_pushes(Some(&movement), null_mut(), 1, None);
        umbra_world_cast_rays(None, null(), null_mut(), 0, None);
        umbra_world_cast_rays(Some(w), null(), null_mut(), 1, None);
        umbra_world_cast_ray_any(None, Some(&ray), None, Some(&mut MaybeUninit::uninit()));
        umbra_world_cast_ray_any(Some(w), Some(&ray), None, None);
        umbra_world_cast_ray_all(None, Some(&ray), 0, None, null_mut(), 0, None);
        umbra_world_cast_ray_all(Some(w), Some(&ray), 1, None, null_mut(), 1, None);
        umbra_world_cast_ray_all(Some(w), None, 1, None, null_mut(), 0, None);
        umbra_world_cast_ray_any(Some(w), None, None, Some(&mut MaybeUninit::uninit()));
        umbra_shape_cast_ray(Some(&disc), None, Some(&mut MaybeUninit::uninit()));
        umbra_world_cast_shape(None, Some(&disc), 0, 0, 0, 0, 0, 0, None, null_mut(), 0, None);
        umbra_world_cast_shape(Some(w), None, 0, 0, 0, 0, 0, 0, None, null_mut(), 0, None);
        umbra_world_cast_shape(Some(w), Some(&disc), 0, 0, 0, 0, 0, 0, None, null_mut(), 1, None);
        umbra_world_overlap_shape(None, Some(&disc), 0, 0, 0, None, null_mut(), 0, None);
        umbra_world_overlap_shape(Some(w), None, 0, 0, 0, None, null_mut(), 0, None);
        umbra_world_overlap_shape(Some(w), Some(&disc), 0, 0, 0, None, null_mut(), 1, None);
        umbra_world_overlap_box(None, 0, 0, 0, 0, None, null_mut(), 0, None);
        umbra_world_overlap_box(Some(w), 0, 0, 0, 0, None, null_mut(), 1, None);
        umbra_world_closest_point(None, 0, 0, 0, None, Some(&mut MaybeUninit::uninit()));
        umbra_world_closest_point(Some(w), 0, 0, 0, None, None);
        umbra_world_closest_points(None, 0, 0, 0, None, null_mut(), 0, None);
        umbra_world_closest_points(Some(w), 0, 0, 0, None, null_mut(), 1, None);
        umbra_shape_contains(None, 0, 0, Some(&mut MaybeUninit::uninit()));
        umbra_shape_contains(Some(&disc), 0, 0, None);
        umbra_shape_closest_point(None, 0, 0, Some(&mut MaybeUninit::uninit()));
        umbra_shape_closest_point(Some(&disc), 0, 0, None);
        umbra_shape_cast_ray(None, Some(&ray), Some(&mut MaybeUninit::uninit()));
        umbra_shape_cast_ray(Some(&disc), Some(&ray), None);
        umbra_shape_distance_to(None, 0, 0, 0, Some(&disc), 0, 0, 0, Some(&mut MaybeUninit::uninit()));
        umbra_shape_distance_to(Some(&disc), 0, 0, 0, None, 0, 0, 0, Some(&mut MaybeUninit::uninit()));
        umbra_shape_distance_to(Some(&disc), 0, 0, 0, Some(&disc), 0, 0, 0, None);
        umbra_shape_time_of_impact(None, Some(&sweep), Some(&disc), Some(&sweep), Some(&mut MaybeUninit::uninit()));
        umbra_shape_time_of_impact(Some(&disc), None, Some(&disc), Some(&sweep), Some(&mut MaybeUninit::uninit()));
        umbra_shape_time_of_impact(Some(&disc), Some(&sweep), None, Some(&sweep), Some(&mut MaybeUninit::uninit()));
        umbra_shape_time_of_impact(Some(&disc), Some(&sweep), Some(&disc), None, Some(&mut MaybeUninit::uninit()));
        umbra_shape_time_of_impact(Some(&disc), Some(&sweep), Some(&disc), Some(&sweep), None);
        umbra_world_contacts_ended(None, null_mut(), 0, None);
        umbra_world_contacts_ended(Some(w), null_mut(), 1, None);
        umbra_world_contacts_began(None, null_mut(), 0, None);
        umbra_world_contacts_began(Some(w), null_mut(), 1, None);
        umbra_world_contact_hits(None, null_mut(), 0, None);
        umbra_world_contact_hits(Some(w), null_mut(), 1, None);
        umbra_world_sensors_left(None, null_mut(), 0, None);
        umbra_world_sensors_left(Some(w), null_mut(), 1, None);
        umbra_world_sensors_entered(None, null_mut(), 0, None);
        umbra_world_sensors_entered(Some(w), null_mut(), 1, None);
        umbra_world_sensor_overlaps(None, null_mut(), 0, None);
        umbra_world_sensor_overlaps(Some(w), null_mut(), 1, None);
        umbra_world_set_contact_settings(None, Some(&settings));
        umbra_world_set_contact_settings(Some(w), None);
        umbra_world_set_material_pair(None, 1, 2, Some(&pair));
        umbra_world_set_material_pair(Some(w), 1, 2, None);
        umbra_world_remove_material_pair(None, 1, 2);
        umbra_world_exclude_pair(None, b, b, UMBRA_EXCLUDE_ALWAYS);
        umbra_world_allow_pair(None, b, b);
        umbra_world_excluded_pairs(None, null_mut(), 0, None);
        umbra_world_excluded_pairs(Some(w), null_mut(), 1, None);
        umbra_world_contact_settings(None, Some(&mut MaybeUninit::uninit()));
        umbra_world_contact_settings(Some(w), None);
        umbra_world_add_field(None, Some(&field_def), Some(&mut MaybeUninit::uninit()));
        umbra_world_add_field(Some(w), None, Some(&mut MaybeUninit::uninit()));
        umbra_world_add_field(Some(w), Some(&field_def), None);
        umbra_world_set_field(None, f, Some(&field_def));
        umbra_world_set_field(Some(w), f, None);
        umbra_world_remove_field(None, f);
        umbra_world_field(None, f, Some(&mut MaybeUninit::uninit()));
        umbra_world_field(Some(w), f, None);
        umbra_world_fields(None, null_mut(), 0, None);
        umbra_world_fields(Some(w), null_mut(), 1, None);
        umbra_joint_def_default(UMBRA_WELD, None);
        umbra_joint_def_revolute(None, UMBRA_NO_HANDLE, b, 0, 0, Some(&mut MaybeUninit::uninit()));
        umbra_joint_def_revolute(Some(w), UMBRA_NO_HANDLE, b, 0, 0, None);
        umbra_joint_def_weld(None, UMBRA_NO_HANDLE, b, 0, 0, Some(&mut MaybeUninit::uninit()));
        umbra_joint_def_weld(Some(w), UMBRA_NO_HANDLE, b, 0, 0, None);
        umbra_joint_def_prismatic(None, UMBRA_NO_HANDLE, b, 0, 0, 1, 0, Some(&mut MaybeUninit::uninit()));
        umbra_joint_def_prismatic(Some(w), UMBRA_NO_HANDLE, b, 0, 0, 1, 0, None);
        umbra_joint_def_wheel(None, b, b, 0, 0, 1, 0, Some(&mut MaybeUninit::uninit()));
        umbra_joint_def_wheel(Some(w), b, b, 0, 0, 1, 0, None);
        umbra_joint_def_set_stiffness(None, Some(&mut { joint_def }), 0, 0);
        umbra_joint_def_set_stiffness(Some(w), None, 0, 0);
        umbra_joint_def_motor(None, UMBRA_NO_HANDLE, b, 0, 0, Some(&mut MaybeUninit::uninit()));
        umbra_joint_def_motor(Some(w), UMBRA_NO_HANDLE, b, 0, 0, None);
        umbra_joint_def_gear(None, b, b, 1, 1, Some(&mut MaybeUninit::uninit()));
        umbra_joint_def_gear(Some(w), b, b, 1, 1, None);
        umbra_joint_def_pulley(None, b, 0, 0, 0, 1, b, 0, 0, 0, 1, Some(&mut MaybeUninit::uninit()));
        umbra_joint_def_pulley(Some(w), b, 0, 0, 0, 1, b, 0, 0, 0, 1, None);
        umbra_joint_def_distance(None, UMBRA_NO_HANDLE, 0, 0, b, 0, 0, Some(&mut MaybeUninit::uninit()));
        umbra_joint_def_distance(Some(w), UMBRA_NO_HANDLE, 0, 0, b, 0, 0, None);
        umbra_world_add_joint(None, Some(&joint_def), Some(&mut MaybeUninit::uninit()));
        umbra_world_add_joint(Some(w), None, Some(&mut MaybeUninit::uninit()));
        umbra_world_add_joint(Some(w), Some(&joint_def), None);
        umbra_world_remove_joint(None, j);
        umbra_world_set_joint_kind(None, j, Some(&joint_def));
        umbra_world_set_joint_kind(Some(w), j, None);
        umbra_world_set_joint_motor(None, j, 0, 0);
        umbra_world_set_joint_break(None, j, 0);
        umbra_world_set_joint_break_torque(None, j, 0);
        umbra_world_enable_joint(None, j, 1);
        umbra_world_joint(None, j, Some(&mut MaybeUninit::uninit()));
        umbra_world_joint(Some(w), j, None);
        umbra_world_joint_state(None, j, Some(&mut MaybeUninit::uninit()));
        umbra_world_joint_state(Some(w), j, None);
        umbra_world_joints(None, null_mut(), 0, None);
        umbra_world_joints(Some(w), null_mut(), 1, None);
        umbra_world_joint_with_key(None, 0, Some(&mut MaybeUninit::uninit()));
        umbra_world_joint_with_key(Some(w), 0, None);
        umbra_world_joints_with_key(None, 0, null_mut(), 0, None);
        umbra_world_joints_with_key(Some(w), 0, null_mut(), 1, None);
        umbra_world_joint_loads(None, null_mut(), 0, None);
        umbra_world_joint_loads(Some(w), null_mut(), 1, None);
        umbra_world_joints_broke(None, null_mut(), 0, None);
        umbra_world_joints_broke(Some(w), null_mut(), 1, None);
        umbra_world_apply_force(None, b, 0, 0, Some(&point), 0);
        umbra_world_apply_torque(None, b, 0, 0);
        umbra_world_apply_impulse(None, b, 0, 0, Some(&point), 0);
        umbra_world_apply_angular_impulse(None, b, 0, 0);
        umbra_world_clear_forces(None);

        umbra_world_execute(None, clear.as_ptr(), 1, None);
        umbra_world_execute(Some(w), null(), 1, None);
        umbra_world_check(None, clear.as_ptr(), 1);
        umbra_world_check(Some(w), null(), 1);
        umbra_draft_new(None);
        umbra_draft_command(None, null_mut(), 0, None);
        umbra_draft_command(Some(d), null_mut(), 1, None);
        umbra_world_set_time_step(None, 1, 60);
        umbra_world_set_gravity(None, 0, 0);
        umbra_world_set_integrator(None, UMBRA_YOSHIDA4);
        umbra_world_set_kept_per_second(None, 0, 0);
        umbra_world_set_sleep_after(None, 1);
        umbra_world_seed(None, 1);
        umbra_world_random_below(None, 1, Some(&mut MaybeUninit::uninit()));
        umbra_world_random_below(Some(w), 1, None);
        umbra_world_random_bits(None, Some(&mut MaybeUninit::uninit()));
        umbra_world_random_bits(Some(w), None);
        umbra_world_set_blob(None, clear.as_ptr(), 1);
        umbra_world_set_blob(Some(w), null(), 1);
        umbra_world_blob(None, null_mut(), 0, None);
        umbra_world_blob(Some(w), null_mut(), 1, None);

        umbra_world_snapshot(None, Some(&mut MaybeUninit::uninit()));
        umbra_world_snapshot(Some(w), None);
        umbra_world_snapshot_into(None, Some(s));
        umbra_world_snapshot_into(Some(w), None);
        umbra_world_restore(None, Some(s));
        umbra_world_restore(Some(w), None);
        umbra_snapshot_world(None, Some(&mut MaybeUninit::uninit()));
        umbra_snapshot_world(Some(s), None);
        umbra_snapshot_to_bytes(None, Some(&mut MaybeUninit::uninit()));
        umbra_snapshot_to_bytes(Some(s), None);
        umbra_snapshot_from_bytes(null(), 9, Some(&mut MaybeUninit::uninit()));
        umbra_snapshot_from_bytes(clear.as_ptr(), 1, None);
        umbra_world_record(None, 1, 0);
        umbra_world_take_record(None, Some(&mut MaybeUninit::uninit()));
        umbra_world_take_record(Some(w), None);
        umbra_world_end_record(None, Some(&mut MaybeUninit::uninit()));
        umbra_world_end_record(Some(w), None);
        umbra_replay_verify(null(), 1, Some(&UmbraReplayLimits::default()), None);
        umbra_replay_verify(clear.as_ptr(), 1, None, None);
        umbra_replay_start(null(), 1, Some(&mut MaybeUninit::uninit()));
        umbra_replay_start(clear.as_ptr(), 1, None);
        umbra_replay_end(null(), 1, Some(&UmbraReplayLimits::default()), Some(&mut MaybeUninit::uninit()));
        umbra_replay_end(file.as_ptr(), file.len(), None, Some(&mut MaybeUninit::uninit()));
        umbra_replay_end(clear.as_ptr(), 1, Some(&UmbraReplayLimits::default()), None);
        umbra_world_from_replay(null(), 1, Some(&mut MaybeUninit::uninit()));
        umbra_world_from_replay(clear.as_ptr(), 1, None);
        umbra_world_seek(None, 1);
        umbra_world_replay_ticks(None, Some(&mut MaybeUninit::uninit()), Some(&mut MaybeUninit::uninit()));
        umbra_world_replay_ticks(Some(w), None, Some(&mut MaybeUninit::uninit()));
        umbra_world_replay_ticks(Some(w), Some(&mut MaybeUninit::uninit()), None);
        umbra_world_applied_forces(None, Some(&mut MaybeUninit::uninit()));
        umbra_world_applied_forces(Some(w), None);
        umbra_world_step_back(None, None);
        umbra_draw_options_default(None);
        umbra_drawing_new(None);
        umbra_world_draw(None, Some(&UmbraDrawOptions::default()), Some(g));
        umbra_world_draw(Some(w), None, Some(g));
        umbra_world_draw(Some(w), Some(&UmbraDrawOptions::default()), None);
        umbra_drawing_figures(None, null_mut(), 0, None);
        umbra_drawing_figures(Some(g), null_mut(), 1, None);
        umbra_drawing_points(None, null_mut(), 0, None);
        umbra_drawing_points(Some(g), null_mut(), 1, None);

        umbra_world_kinetic_energy(None, Some(&mut second));
        umbra_world_kinetic_energy(Some(w), None);
        umbra_world_potential_energy(None, Some(&mut second));
        umbra_world_potential_energy(Some(w), None);
        umbra_world_energy(None, Some(&mut second));
        umbra_world_energy(Some(w), None);
        umbra_world_momentum(None, Some(&mut second), Some(&mut MaybeUninit::uninit()));
        umbra_world_momentum(Some(w), None, Some(&mut second));
        umbra_world_momentum(Some(w), Some(&mut second), None);
        umbra_world_angular_momentum(None, Some(&mut second));
        umbra_world_angular_momentum(Some(w), None);
        umbra_world_body_kinetic_energy(None, b, Some(&mut second));
        umbra_world_body_kinetic_energy(Some(w), b, None);
        umbra_world_body_momentum(None, b, Some(&mut second), Some(&mut MaybeUninit::uninit()));
        umbra_world_body_momentum(Some(w), b, None, Some(&mut second));
        umbra_world_body_momentum(Some(w), b, Some(&mut second), None);
        umbra_world_body_angular_momentum(None, b, Some(&mut second));
        umbra_world_body_angular_momentum(Some(w), b, None);
    }
    // What is refused changes nothing: the world is as it was made, with a body and a field.
    assert_eq!(made(|count| umbra_world_body_count(Some(w), count, None)), 1);

    // To these it means something.
    assert_eq!((umbra_bytes_data(None), umbra_bytes_length(None)), (null_mut(), 0));
    umbra_world_free(None);
    umbra_shape_free(None);
    umbra_movement_free(None);
    umbra_inputs_free(None);
    umbra_bytes_free(None);
    umbra_snapshot_free(None);
    umbra_applied_forces_free(None);
    umbra_drawing_free(None);
    let others = [
        "umbra_bytes_data",
        "umbra_bytes_length",
        "umbra_bytes_free",
        "umbra_world_free",
        "umbra_shape_free",
        "umbra_movement_free",
        "umbra_inputs_free",
        "umbra_snapshot_free",
        "umbra_applied_forces_free",
        "umbra_drawing_free",
    ];
    let header = Path::new(env!("CARGO_MANIFEST_DIR")).join("include/umbra_physics.h");
    let header = fs::read_to_string(header).expect("the header");
    let expected: BTreeSet<&str> = with_pointers(&header).into_iter().filter(|name| !others.contains(name)).collect();
    assert!(expected.len() > 100, "{}", expected.len());
    assert_eq!(names, expected);
}

/// An address where nothing may be read or written.
#[test]
fn null_is_good_for_nothing_at_all() {
    let def = made(|def| umbra_world_def_default(def));
    let mut world = made(|world| umbra_world_new(Some(&def), world));
    let mut inputs = UmbraInputs::default();
    // SAFETY: null is good for a length of 0.
    unsafe {
        assert_eq!(umbra_world_set_blob(world.as_deref_mut(), null(), 0), UMBRA_OK);
        assert_eq!(umbra_world_blob(world.as_deref(), null_mut(), 0, None), UMBRA_OK);
        assert_eq!(umbra_world_outcomes(world.as_deref(), null_mut(), 0, None), UMBRA_OK);
        assert_eq!(umbra_inputs_replace(Some(&mut inputs), 0, null(), null(), 0, None), UMBRA_OK);
        assert_eq!(umbra_fx_from_text(null(), 0, Some(&mut MaybeUninit::uninit())), UMBRA_ERROR_NUMBER_EMPTY);
        assert_eq!(umbra_inputs_insert(Some(&mut inputs), 0, 0, null(), 0), UMBRA_ERROR_MALFORMED);
    }
    umbra_world_free(world);
}
