/*
 * umbra-physics: deterministic 2D rigid-body physics in fixed point, the same bits on every machine.
 *
 * Numbers are integers: an UmbraFx counts multiples of 2^-32 of a metre, kilogram, second or radian, and handles have 64 bits. No
 * struct is passed by value, and no float but for the points of drawings, which leave the library and never come back.
 *
 * Calls return UMBRA_OK or the number of an error. A refused call changes nothing and writes nothing, except the required size when a
 * buffer was too small, and where the function says so. Error numbers never change: docs/errors.md lists them.
 *
 * An object returned through a pointer to a pointer belongs to the caller, who passes it to the function that frees its type. The
 * library keeps no arguments: definitions, shapes, texts and buffers can be freed after the call.
 *
 * Pointers must be null or point to as many aligned values as the function says. Null is refused unless the function says what it
 * means; for 0 bytes, characters or entries it is allowed. Memory that a call writes to must not be used by another thread or by
 * another argument of the call. Handles of freed objects must not be used; handles of removed bodies and fields are refused.
 *
 * Threads: different worlds are independent. Several threads may call functions that take a const world at the same time, while no
 * thread changes it. Each thread has a last error of its own.
 */

#ifndef UMBRA_PHYSICS_H
#define UMBRA_PHYSICS_H

/* Made from the sources of umbra-physics-capi by cbindgen: `UMBRA_BLESS=1 cargo test --test header`. */

#include <stddef.h>
#include <stdint.h>

// The number of this interface: it moves when a function, a struct or a meaning changes so that programs have to be built
// again. A program compares `UMBRA_API` of its header with `umbra_api` of the library it loads.
#define UMBRA_API 3

// No body, no field, no collider: a handle that names nothing, in no world.
#define UMBRA_NO_HANDLE 18446744073709551615ull

// In place of a number of ticks: bodies never fall asleep.
#define UMBRA_NEVER 0

// All categories of colliders.
#define UMBRA_ALL_CATEGORIES 4294967295

// All groups.
#define UMBRA_ALL_FORCE_GROUPS 4294967295

// The forces and torques that were applied over a step: what undoing it needs beside the world.
typedef struct UmbraAppliedForces UmbraAppliedForces;

// Bytes that the library owns: a snapshot, a replay, or room that a caller without memory of its own asked for.
typedef struct UmbraBytes UmbraBytes;

// A drawing of a world: figures, and the points that they have.
typedef struct UmbraDrawing UmbraDrawing;

// The inputs of one tick, by player and sequence.
typedef struct UmbraInputs UmbraInputs;

// A movement that was made: its result, what it met and what it pushes.
typedef struct UmbraMovement UmbraMovement;

// A shape, for any number of bodies: they keep what they need of it, so that it can be freed.
typedef struct UmbraShape UmbraShape;

// A world as it was, to go back to. In memory it costs a copy of what steps change; all else is shared.
typedef struct UmbraSnapshot UmbraSnapshot;

// A world.
typedef struct UmbraWorld UmbraWorld;

// Result of a call: `UMBRA_OK`, or the number of an error. The numbers are those of the library (`docs/errors.md`), with
// some of the interface's own from 901 on. A number is never changed or reused.
typedef int32_t UmbraStatus;

// A number: this many 2^-32. 1 m is 4294967296, and `UMBRA_ONE`.
typedef int64_t UmbraFx;

// An integer of 128 bits in two's complement: high · 2^64 + low.
typedef struct UmbraInt128 {
    // The lower 64 bits.
    uint64_t low;
    // The higher 64 bits, with the sign.
    int64_t high;
} UmbraInt128;

// A factor from 0: mantissa · 2^-shift, with the top bit of the mantissa set; or both are 0.
typedef struct UmbraFactor {
    // 64 bits, the highest of them set.
    uint64_t mantissa;
    // -16384 to 16384.
    int32_t shift;
    // 0.
    uint32_t reserved;
} UmbraFactor;

// Two numbers: x to the right, y up.
typedef struct UmbraVec2 {
    // Along x.
    UmbraFx x;
    // Along y.
    UmbraFx y;
} UmbraVec2;

// A part of a compound.
typedef struct UmbraPart {
    // Position of the part's centre of mass, m.
    struct UmbraVec2 position;
    // Angle of the part, rad.
    UmbraFx angle;
    // Density relative to the other parts, above 0.
    UmbraFx density;
    // Shape of the part; it must not be a compound.
    const struct UmbraShape *shape;
} UmbraPart;

// Integrator of a world: one of the five values below.
typedef uint32_t UmbraIntegrator;

// Definition of a world; `umbra_world_def_default` fills it in.
typedef struct UmbraWorldDef {
    // A step takes step_num / step_den seconds, from 1 to 10,000 steps a second: 1 and 60.
    uint32_t step_num;
    // See `step_num`.
    uint32_t step_den;
    // Integrator; default `UMBRA_VELOCITY_VERLET`.
    UmbraIntegrator integrator;
    // The number of ticks at rest after which a body falls asleep, or `UMBRA_NEVER`: 30.
    uint32_t sleep_after;
    // Gravity, m/s²: none.
    struct UmbraVec2 gravity;
    // Damping of bodies without their own: the share of a velocity that is left after a second, from 0 (stops at once) to `UMBRA_ONE`
    // (none). This is not the damping of Box2D, which is a rate: `umbra_kept_at_rate` makes one from it. Default `UMBRA_ONE`.
    UmbraFx linear_kept_per_second;
    // Damping of bodies without their own: the share of an angular velocity that is left after a second; default `UMBRA_ONE`.
    UmbraFx angular_kept_per_second;
} UmbraWorldDef;

// Result of a command: nothing, a body, a field, a collider, or a joint.
typedef uint32_t UmbraCreatedKind;

// Result of an input.
typedef struct UmbraInputResult {
    // The player.
    uint32_t player;
    // Sequence of the input among the inputs of this player.
    uint32_t sequence;
    // `UMBRA_OK`, or why it was refused: then it changed nothing.
    UmbraStatus status;
    // Body, field, collider or joint that the input created.
    UmbraCreatedKind created;
    // The handle of the created thing, or `UMBRA_NO_HANDLE`.
    uint64_t handle;
} UmbraInputResult;

// Summary of a step in numbers; `umbra_world_faults` and similar functions list the bodies.
typedef struct UmbraReport {
    // The tick the world is at now.
    uint64_t tick;
    // Number of bodies quarantined.
    uint64_t faults;
    // Number of bodies that fell asleep.
    uint64_t fell_asleep;
    // Number of bodies woken by calls since the step before.
    uint64_t woke;
    // With Yoshida4, how many bodies had a drag too stiff for its backward sub-step, which acted around the whole step instead.
    uint32_t drag_outside;
    // 0.
    uint32_t reserved;
    // Number of contacts that ended: `umbra_world_contacts_ended`.
    uint64_t contacts_ended;
    // Number of contacts that began: `umbra_world_contacts_began`.
    uint64_t contacts_began;
    // Number of hits: `umbra_world_contact_hits`.
    uint64_t hits;
    // Number of colliders that left a sensor: `umbra_world_sensors_left`.
    uint64_t sensors_left;
    // Number of colliders that entered a sensor: `umbra_world_sensors_entered`.
    uint64_t sensors_entered;
} UmbraReport;

// A body that was quarantined in a step, and why.
typedef struct UmbraFault {
    // The body.
    uint64_t body;
    // The field whose force did not fit, or `UMBRA_NO_HANDLE`.
    uint64_t field;
    // 201 to 207.
    UmbraStatus cause;
    // 0.
    uint32_t reserved;
} UmbraFault;

// An integer of 128 bits from 0: high · 2^64 + low.
typedef struct UmbraUint128 {
    // The lower 64 bits.
    uint64_t low;
    // The higher 64 bits.
    uint64_t high;
} UmbraUint128;

// How a body moves: one of the three values below.
typedef uint32_t UmbraBodyKind;

// Source of mass and moment of inertia: one of the three values below.
typedef uint32_t UmbraMassKind;

// Components of a body's velocity that are held at zero: 0, or any of the flags below.
typedef uint32_t UmbraLocks;

// Definition of a body; `umbra_body_def_default` fills it in.
typedef struct UmbraBodyDef {
    // How the body moves; default `UMBRA_DYNAMIC`.
    UmbraBodyKind kind;
    // Source of the mass; default `UMBRA_MASS_FROM_COLLIDERS`.
    UmbraMassKind mass_kind;
    // Mass in kg, 2^-16 to 2^24, unless it is that of the colliders; default 1.
    UmbraFx mass;
    // Moment of inertia, for `UMBRA_MASS_EXPLICIT` only.
    UmbraFx inertia;
    // Position of the centre of mass, m, within ±2^30; default the origin.
    struct UmbraVec2 position;
    // Velocity, m/s, within ±2^20; default 0.
    struct UmbraVec2 velocity;
    // Angle, rad, of any size; default 0.
    UmbraFx angle;
    // Angular velocity, rad/s, within ±2^20; default 0.
    UmbraFx angular_velocity;
    // Factor on the world's gravity, within ±16; default 1.
    UmbraFx gravity_scale;
    // Damping: the share of the velocity that is left after a second, from 0 (stops at once) to `UMBRA_ONE` (none). This is not the
    // damping of Box2D, which is a rate: `umbra_kept_at_rate` makes one from it. Default `UMBRA_AS_WORLD`.
    UmbraFx linear_kept_per_second;
    // Damping: the share of the angular velocity that is left after a second; default `UMBRA_AS_WORLD`.
    UmbraFx angular_kept_per_second;
    // The largest speed it has after a step, 0 to 2^20 m/s, if it is dynamic: `UMBRA_NO_LIMIT`.
    UmbraFx max_speed;
    // The largest angular speed it has after a step, 0 to 2^20 rad/s, if it is dynamic: `UMBRA_NO_LIMIT`.
    UmbraFx max_angular_speed;
    // A name of the caller's, by which worlds built in another order are compared: 0.
    uint64_t key;
    // Anything of the caller's: 0.
    uint64_t user_data;
    // The groups it is in: a force field with one of these bits acts on it. 1.
    uint32_t force_groups;
    // Components of the velocity that are held at zero; default none.
    UmbraLocks locks;
    // The dominance: in a contact of two dynamic bodies, the body with the higher number is not moved; default 0.
    int32_t dominance;
    // 1 for a bullet, which never crosses dynamic bodies either; default 0.
    uint32_t is_bullet;
} UmbraBodyDef;

// State of activity of a body: one of the four values below.
typedef uint32_t UmbraActivity;

// A body as it is. Its colliders, what its mass was given as and where it is sent have functions of their own.
typedef struct UmbraBodyState {
    // Position of the centre of mass, m.
    struct UmbraVec2 position;
    // Velocity, m/s.
    struct UmbraVec2 velocity;
    // Angle, rad in [0, 2π).
    UmbraFx angle;
    // Angular velocity, rad/s.
    UmbraFx angular_velocity;
    // The cosine of its angle.
    UmbraFx cos;
    // The sine of its angle.
    UmbraFx sin;
    // Full position with the carried remainder: multiples of 2^-96 m.
    struct UmbraInt128 exact_x;
    // See `exact_x`.
    struct UmbraInt128 exact_y;
    // Full velocity: multiples of 2^-96 m/s.
    struct UmbraInt128 exact_velocity_x;
    // See `exact_velocity_x`.
    struct UmbraInt128 exact_velocity_y;
    // Full angular velocity: multiples of 2^-96 rad/s.
    struct UmbraInt128 exact_angular_velocity;
    // Full angle: multiples of 2^-64 turns.
    uint64_t turn;
    // Mass, kg; 0 unless the body is dynamic.
    UmbraFx mass;
    // Moment of inertia, kg·m²; 0 if it is infinite.
    struct UmbraFactor inertia;
    // Factor on the world's gravity.
    UmbraFx gravity_scale;
    // The share of the velocity that its damping leaves after a second, or minus a rate above 4/s (see `umbra_kept_at_rate`), or
    // `UMBRA_AS_WORLD`.
    UmbraFx linear_kept_per_second;
    // As `linear_kept_per_second`, of the angular velocity.
    UmbraFx angular_kept_per_second;
    // The largest speed it has after a step, or `UMBRA_NO_LIMIT`.
    UmbraFx max_speed;
    // The largest angular speed it has after a step, or `UMBRA_NO_LIMIT`.
    UmbraFx max_angular_speed;
    // The caller's name for it.
    uint64_t key;
    // The caller's data.
    uint64_t user_data;
    // How the body moves.
    UmbraBodyKind kind;
    // State of activity.
    UmbraActivity activity;
    // The groups it is in.
    uint32_t force_groups;
    // Components of the velocity that are held at zero.
    UmbraLocks locks;
    // The dominance: in a contact of two dynamic bodies, the body with the higher number is not moved.
    int32_t dominance;
    // 1 for a bullet, else 0.
    uint32_t is_bullet;
    // 0.
    uint32_t reserved;
} UmbraBodyState;

// Kinematic target: the pose to which the next step moves a body.
typedef struct UmbraGoal {
    // The position it is to have, m.
    struct UmbraVec2 position;
    // The angle it is to have, rad in [0, 2π).
    UmbraFx angle;
    // 1, or 0 if the body is not sent anywhere: then all else is 0.
    uint32_t is_there;
    // 0.
    uint32_t reserved;
} UmbraGoal;

// Values of a body needed to draw it.
typedef struct UmbraPose {
    // The body.
    uint64_t body;
    // Position of the centre of mass, m.
    struct UmbraVec2 position;
    // Angle, rad in [0, 2π).
    UmbraFx angle;
    // The caller's name for it, by which what is drawn stays with its body through a rollback.
    uint64_t key;
    // The caller's data: what to draw, say.
    uint64_t user_data;
    // How the body moves.
    UmbraBodyKind kind;
    // State of activity.
    UmbraActivity activity;
} UmbraPose;

// Rule by which the coefficients of two colliders that touch become one. Of two different ones the later one counts.
typedef uint32_t UmbraMixRule;

// Definition of a collider: a shape at a place of its body. `umbra_collider_def_default` fills it in, without a shape.
//
// Two colliders touch if each has a category in the other's mask; two of one positive group always do, two of one negative group
// never.
typedef struct UmbraColliderDef {
    // Position of the shape's centre of mass relative to that of the body, in the body's axes, m, within ±2^12; default 0.
    struct UmbraVec2 position;
    // The angle by which the shape is turned against the body, rad; default 0.
    UmbraFx angle;
    // Density, kg/m², kg/m for a segment, from 0, for bodies with `UMBRA_MASS_FROM_COLLIDERS`; default 1.
    UmbraFx density;
    // Coefficient of friction, 0 to 32; default 0.6.
    UmbraFx friction;
    // Coefficient of restitution, 0 to 1; default 0.
    UmbraFx restitution;
    // Coefficient of rolling resistance, 0 to 1; default 0. Two colliders have the larger one.
    UmbraFx rolling_resistance;
    // Speed of the surface around the shape, counter-clockwise, m/s, within ±2^10: a conveyor belt; default 0.
    UmbraFx surface_speed;
    // The direction out of the surface that holds, in the collider's axes, if `one_way` is 1: not zero; default (0, 1).
    struct UmbraVec2 one_way_direction;
    // The largest angle between that direction and the normal of a contact that holds, 0 to π/2 rad; default π/4.
    UmbraFx one_way_tolerance;
    // A name of the caller's, by which worlds built in another order are compared: 0.
    uint64_t key;
    // Anything of the caller's: 0.
    uint64_t user_data;
    // The categories it is in, as bits; default 1.
    uint32_t category;
    // The categories that it meets, as bits; default all. With 0, and no positive group, it touches nothing, and gives its body mass
    // and an outline alone.
    uint32_t mask;
    // The group; 0 for none.
    int32_t group;
    // Rule that mixes the coefficients of friction of two colliders; default `UMBRA_MIX_STANDARD`.
    UmbraMixRule friction_rule;
    // Rule that mixes the coefficients of restitution; default `UMBRA_MIX_STANDARD`.
    UmbraMixRule restitution_rule;
    // 1 for a collider that holds others from one side alone and lets them pass from the others, 0 for one that holds them all; default 0.
    uint32_t one_way;
    // Number of the material, for coefficients of two materials together; default 0, for none.
    uint32_t material_id;
    // 1 for a sensor, which touches nothing and reports what overlaps it, else 0; default 0.
    uint32_t sensor;
    // 1 to report where contacts of the collider begin and end, else 0; default 0. One of the two colliders is enough.
    uint32_t contact_events;
    // 1 to report hits of the collider, else 0; default 0. One of the two colliders is enough.
    uint32_t hit_events;
    // Shape. The last field, so that the offsets of the others do not depend on the size of pointers.
    const struct UmbraShape *shape;
} UmbraColliderDef;

// Settings of contacts; `umbra_contact_settings_default` fills them in.
typedef struct UmbraContactSettings {
    // The largest speed with which overlapping bodies are pushed apart, m/s, 0 to 2^10; default 3.
    UmbraFx push_speed;
    // The approach speed from which on bodies bounce, m/s, 0 to 2^10; default 1.
    UmbraFx restitution_speed;
    // The speed below which a body that contacts push counts as at rest, m/s, 0 to 2^10; default 0.05.
    UmbraFx sleep_speed;
    // The approach speed from which on a contact is a hit, m/s, 0 to 2^10; default 1.
    UmbraFx hit_speed;
    // The number of sub-steps in which contacts are solved, 1 to 16; default 5. Bodies that touch where one bears another of more than 64
    // times its mass take 16.
    uint32_t substeps;
    // The number of pairs of outlines that may be close to each other in a step (a compound has one for each part), 1 to 2^28; default
    // 2^20.
    uint32_t max_pairs;
    // The number of pairs of one outline that may be close where there are more than `max_pairs` in all, 1 to 2^12; default 256.
    uint32_t max_pairs_per_collider;
    // 0.
    uint32_t reserved;
} UmbraContactSettings;

// Coefficients of the contacts of two materials, in place of those that follow from both.
typedef struct UmbraMaterialPair {
    // Coefficient of friction, 0 to 32.
    UmbraFx friction;
    // Coefficient of restitution, 0 to 1.
    UmbraFx restitution;
    // Coefficient of rolling resistance, 0 to 1.
    UmbraFx rolling_resistance;
} UmbraMaterialPair;

// For how long two bodies do not touch each other.
typedef uint32_t UmbraExclusion;

// Two bodies that do not touch each other.
typedef struct UmbraExcludedPair {
    // The bodies, that in the lower slot first.
    uint64_t bodies[2];
    // For how long.
    UmbraExclusion exclusion;
    // 0.
    uint32_t reserved;
} UmbraExcludedPair;

// A point of a contact.
typedef struct UmbraContactPoint {
    // Position, m, in the middle between the two surfaces.
    struct UmbraVec2 position;
    // Distance between the surfaces along the normal, m; negative where they overlap.
    UmbraFx separation;
    // Impulse along the normal over the last sub-step, N·s, on the second body; 0 for a point that was not there in the step.
    UmbraFx normal_impulse;
} UmbraContactPoint;

// Two colliders that pushed each other at the end of the last step, at the present poses of their bodies.
typedef struct UmbraContact {
    // The colliders.
    uint64_t colliders[2];
    // The bodies of the colliders.
    uint64_t bodies[2];
    // Unit vector from the first collider to the second one; each component within 2^-29.
    struct UmbraVec2 normal;
    // Impulse of friction over the last sub-step along (normal.y, -normal.x), N·s, on the second body.
    UmbraFx tangent_impulse;
    // Angular impulse of rolling resistance over the last sub-step, N·m·s, on the second body; 0 with two points.
    UmbraFx rolling_impulse;
    // The points; zeros for a second one that is not there.
    struct UmbraContactPoint points[2];
    // Number of points, 1 or 2.
    uint32_t point_count;
    // 0.
    uint32_t reserved;
} UmbraContact;

// Two colliders that an event is about. Handles of what calls removed before the step are those that it had: calls refuse them.
//
// Of a contact, the collider of the body with the lower key comes first, of equal keys that with the lower key of its own, then that
// with the lower handle. Of a sensor, the sensor comes first.
typedef struct UmbraColliderPair {
    // The colliders.
    uint64_t colliders[2];
    // The bodies of the colliders.
    uint64_t bodies[2];
    // The keys of the colliders.
    uint64_t collider_keys[2];
    // The keys of the bodies.
    uint64_t body_keys[2];
} UmbraColliderPair;

// A contact that closed fast when an impulse stopped it.
typedef struct UmbraContactHit {
    // The colliders.
    struct UmbraColliderPair pair;
    // Speed along the normal at which they met, m/s.
    UmbraFx approach_speed;
    // Unit vector from the first collider to the second one; each component within 2^-29.
    struct UmbraVec2 normal;
    // Position at which the surfaces met, m.
    struct UmbraVec2 point;
    // Impulse of the hit along the normal, N·s, restitution included, without what carries the bodies.
    UmbraFx normal_impulse;
    // The part of a compound, or the segment of a chain, of each collider; 0 of all others.
    uint32_t parts[2];
} UmbraContactHit;

// A kind of force field: one of the seven below.
typedef uint32_t UmbraFieldKind;

// The region of a zone: one of the two below. Its edge belongs to it.
typedef uint32_t UmbraRegion;

// A force field: its kind, and the bodies that it acts on. Only what its kind reads matters. `umbra_field_def_default` fills
// it in.
typedef struct UmbraFieldDef {
    // The kind.
    UmbraFieldKind kind;
    // Groups of dynamic bodies that the field acts on, as bits; springs and thrusts act on their bodies alone. Default all.
    uint32_t force_groups;
    // The region of a zone.
    UmbraRegion region;
    // 0.
    uint32_t reserved;
    // The body that a thrust acts on, or a spring's near end is at.
    uint64_t body;
    // Point of the body, in its own axes from its centre of mass, m.
    struct UmbraVec2 point;
    // The body that an attractor's centre or a spring's far end is at, or `UMBRA_NO_HANDLE` for a point of the world.
    uint64_t other;
    // Point of the body, or of the world, m.
    struct UmbraVec2 other_point;
    // The gravitational parameter G·M of an attractor, 0 to 2^64 m³/s².
    struct UmbraFactor mu;
    // The distance below which an attractor softens, 0 to 2^12 m.
    UmbraFx softening;
    // The length of a spring at rest, 0 to 2^30 m.
    UmbraFx rest;
    // The stiffness of a spring, from 0, N/m.
    UmbraFx stiffness;
    // The damping along a spring, from 0, N·s/m.
    UmbraFx damping;
    // The linear part of a drag, from 0, N·s/m.
    UmbraFx linear;
    // The quadratic part of a drag, from 0, N·s²/m².
    UmbraFx quadratic;
    // The velocity of the medium of a drag, m/s.
    struct UmbraVec2 wind;
    // The force of a thrust in the body's axes, N.
    struct UmbraVec2 force;
    // The acceleration of a zone, m/s².
    struct UmbraVec2 acceleration;
    // The centre of a disc, m.
    struct UmbraVec2 centre;
    // The radius of a disc, m.
    UmbraFx radius;
    // The lower left corner of a box, m.
    struct UmbraVec2 min;
    // The upper right corner of a box, m.
    struct UmbraVec2 max;
    // The density of a fluid, from 0, kg/m².
    UmbraFx density;
    // The linear drag of a fluid, from 0, N·s/m for each m² in it.
    UmbraFx linear_drag;
    // The angular drag of a fluid, from 0, N·m·s for each m² in it.
    UmbraFx angular_drag;
    // The velocity of a fluid, m/s.
    struct UmbraVec2 flow;
    // The deceleration by a friction, 0 to 2^16 m/s².
    UmbraFx deceleration;
    // The deceleration of the spin by a friction, 0 to 2^16 rad/s².
    UmbraFx angular_deceleration;
} UmbraFieldDef;

// Options of a force or impulse: 0, or any of the flags below.
typedef uint32_t UmbraApplyFlags;

// An explosion: an impulse, away from a point, on each collider of a dynamic body around it.
typedef struct UmbraExplosion {
    // The centre, m.
    struct UmbraVec2 position;
    // The distance up to which it has its whole strength, m, 0 to 2^12.
    UmbraFx radius;
    // The distance from there over which the strength falls to nothing, m, 0 to 2^12.
    UmbraFx falloff;
    // The impulse on each metre of width that a collider turns to the centre, N·s/m, within ±2^16; below 0 it pulls.
    UmbraFx impulse;
    // The categories of the colliders that it acts on.
    uint32_t mask;
    // 0.
    uint32_t reserved;
} UmbraExplosion;

// A kind of joint: one of those below.
typedef uint32_t UmbraJointKind;

// A joint: its kind, its ends, and what it keeps of them. Only what its kind reads matters. `umbra_joint_def_default`,
// `umbra_joint_def_revolute`, `umbra_joint_def_weld`, `umbra_joint_def_distance`, `umbra_joint_def_prismatic`, `umbra_joint_def_wheel`,
// `umbra_joint_def_motor`, `umbra_joint_def_gear` and `umbra_joint_def_pulley` fill it in; `umbra_joint_def_set_stiffness` sets its spring in N/m. Limits,
// motor and spring are of an angle in rad, rad/s and N·m, or of a distance in m, m/s and N, as their kind says.
typedef struct UmbraJointDef {
    // The kind.
    UmbraJointKind kind;
    // 1 if the two bodies touch each other all the same. Default 0.
    uint32_t collide_connected;
    // 0 for a joint that does nothing until it is enabled. Default 1.
    uint32_t is_enabled;
    // 1 to report when the joint breaks, and its mean loads if it may break. Default 0.
    uint32_t events;
    // 1 if `lower` and `upper` are limits. Default 0.
    uint32_t has_limits;
    // 1 if there is a motor. Default 0.
    uint32_t has_motor;
    // 1 if there is a spring. Default 0.
    uint32_t has_spring;
    // 1 if there is a planar spring. Default 0.
    uint32_t has_planar_spring;
    // 1 if there is a planar motor. Default 0.
    uint32_t has_planar_motor;
    // The teeth of the ratchet of a revolute joint, which turns back to the last tooth at most: 1 to 1,024, or negative for one that turns on
    // clockwise; 0 for none, the default.
    int32_t ratchet;
    // The teeth of two gears, 1 to 1,024 or negative.
    int32_t teeth[2];
    // The strands of the rope of a pulley on both sides, 1 to 64. Default 1.
    uint32_t strands[2];
    // The bodies at the two ends, or `UMBRA_NO_HANDLE` for the world. At least one is dynamic.
    uint64_t bodies[2];
    // Points of the bodies in their own axes from their centres of mass, or of the world, m.
    struct UmbraVec2 points[2];
    // The angles of the joint's frame in the axes of both ends, rad.
    UmbraFx angles[2];
    // The points of the world over which the rope of a pulley runs, m.
    struct UmbraVec2 grounds[2];
    // The lowest angle, within ±2^17 rad, or distance, within ±2^20 m.
    UmbraFx lower;
    // The highest one, likewise.
    UmbraFx upper;
    // The speed that a motor aims at, of the second end against the first one, within ±2^20 rad/s or m/s.
    UmbraFx motor_speed;
    // The largest torque or force of a motor, from 0.
    UmbraFx motor_max_force;
    // The frequency of a spring without damping, 0 to 10^6 Hz.
    UmbraFx spring_hertz;
    // The damping of a spring over critical damping, 0 to 1024. Default 1.
    UmbraFx spring_damping_ratio;
    // The angle or the distance of a spring at rest, like the limits.
    UmbraFx spring_rest;
    // The largest torque or force of a spring, from 0, or `UMBRA_NO_LIMIT`, the default.
    UmbraFx spring_max_force;
    // The largest torque or force of friction, from 0.
    UmbraFx friction;
    // The frequency of a planar spring without damping, 0 to 10^6 Hz.
    UmbraFx planar_spring_hertz;
    // The damping of a planar spring over critical damping, 0 to 1024. Default 1.
    UmbraFx planar_spring_damping_ratio;
    // The point of a planar spring at rest in the frame of the first end, within ±2^20 m.
    struct UmbraVec2 planar_spring_rest;
    // The largest force of a planar spring, from 0, N, or `UMBRA_NO_LIMIT`, the default.
    UmbraFx planar_spring_max_force;
    // The velocity of a planar motor in the frame of the first end, within ±2^20 m/s.
    struct UmbraVec2 planar_motor_velocity;
    // The largest force of a planar motor, from 0, N.
    UmbraFx planar_motor_max_force;
    // The mean force over a step above which the joint breaks, from 0, N, or `UMBRA_NO_LIMIT`, the default.
    UmbraFx break_force;
    // The mean torque over a step above which the joint breaks, from 0, N·m, or `UMBRA_NO_LIMIT`, the default.
    UmbraFx break_torque;
    // Number of the caller's own, by which joints are listed.
    uint64_t key;
    // Number of the caller's own.
    uint64_t user_data;
} UmbraJointDef;

// The state of a joint: its place, its motion and its force.
typedef struct UmbraJointState {
    // The two ends in the world, m.
    struct UmbraVec2 points[2];
    // The distance of the ends, m; of a pulley the length of its rope in use.
    UmbraFx length;
    // The way of the second end along the axis of a prismatic, a wheel or a motor joint, m; of other kinds the distance.
    UmbraFx translation;
    // The place of the second end in the frame of the first one, m.
    struct UmbraVec2 offset;
    // The angle from the frame of the first end to that of the second one, rad.
    UmbraFx angle;
    // The angle of the tooth of a ratchet that is engaged, rad; 0 without one.
    UmbraFx stop;
    // The speed of the angle, rad/s.
    UmbraFx speed;
    // The force on the second end in the last step, N.
    struct UmbraVec2 force;
    // The torque on the second end in the last step, N·m.
    UmbraFx torque;
    // 1 if the joint is broken.
    uint32_t is_broken;
    // 1 if steps keep the joint: it is enabled and not broken, and its bodies take part.
    uint32_t is_active;
} UmbraJointState;

// The mean load of a joint over a step.
typedef struct UmbraJointLoad {
    // The joint.
    uint64_t joint;
    // The key of the joint.
    uint64_t key;
    // The mean force on the second end, N.
    struct UmbraVec2 force;
    // The mean torque on the second body, N·m.
    UmbraFx torque;
} UmbraJointLoad;

// A joint that broke.
typedef struct UmbraJointBroke {
    // The joint.
    uint64_t joint;
    // The key of the joint.
    uint64_t key;
    // The bodies at its ends, or `UMBRA_NO_HANDLE` for the world.
    uint64_t bodies[2];
    // The mean force on the second end over the step, N.
    struct UmbraVec2 force;
    // The mean torque on the second body over the step, N·m.
    UmbraFx torque;
} UmbraJointBroke;

// A condition of the caller's on a collider, with its `user_data`: 0 to leave it out. It is called in the order of the results, and must
// not call functions that change the world.
typedef uint32_t (*UmbraPredicate)(void *context, uint64_t collider, uint64_t user_data);

// The colliders that a query finds; `umbra_query_filter_default` fills it in so that all are found. Null finds all, too.
typedef struct UmbraQueryFilter {
    // The categories of the query, as bits; default all.
    uint32_t category;
    // The categories that it finds, as bits; default all. A collider is found if each has a category in the other's mask.
    uint32_t mask;
    // The group, which counts as that of a collider; 0 for none.
    int32_t group;
    // 0.
    uint32_t reserved;
    // Bodies to leave out.
    const uint64_t *without_bodies;
    // Number of them.
    size_t without_body_count;
    // Colliders to leave out.
    const uint64_t *without_colliders;
    // Number of them.
    size_t without_collider_count;
    // A condition; null for none.
    UmbraPredicate predicate;
    // The first argument of the condition.
    void *context;
} UmbraQueryFilter;

// A ray.
typedef struct UmbraRay {
    // The start of the ray, m.
    struct UmbraVec2 origin;
    // The translation from the start to the end, m; each component within ±2^20.
    struct UmbraVec2 translation;
} UmbraRay;

// A collider that a ray or a shape met on its way.
typedef struct UmbraCastHit {
    // The collider; 0 for a shape without a world.
    uint64_t collider;
    // The body of the collider; 0 for a shape without a world.
    uint64_t body;
    // The fraction of the translation, from 0 to 1, rounded down.
    UmbraFx fraction;
    // The point where they meet, m.
    struct UmbraVec2 point;
    // The outward unit normal of the surface there, that of all tiles together at a seam of tiles; zero if a ray starts in the collider, or a shape
    // overlaps it at the start.
    struct UmbraVec2 normal;
    // Number of the part of a compound or of the segment of a chain; 0 of all others.
    uint32_t part;
    // 1; 0 if nothing was met, and then all else is 0 as well.
    uint32_t is_hit;
} UmbraCastHit;

// The point of a collider that is nearest to a point.
typedef struct UmbraClosestPoint {
    // The collider.
    uint64_t collider;
    // The body of the collider.
    uint64_t body;
    // The distance, m; 0 in the collider.
    UmbraFx distance;
    // The nearest point, m.
    struct UmbraVec2 point;
    // Number of the part of a compound or of the segment of a chain; 0 of all others.
    uint32_t part;
    // 1; 0 if nothing is that near, and then all else is 0 as well.
    uint32_t is_found;
} UmbraClosestPoint;

// The distance of two shapes, or the depth in which they overlap.
typedef struct UmbraShapeDistance {
    // The distance of the surfaces, m; negative where they overlap: the length of the shortest translation that separates them.
    UmbraFx separation;
    // The unit vector from the first shape to the second one along which they are that far apart.
    struct UmbraVec2 normal;
    // The point of the first shape that is nearest to the second one, or deepest in it, m.
    struct UmbraVec2 point;
    // The point of the second shape, m.
    struct UmbraVec2 second_point;
    // Number of the part of the first shape: of a compound, or of the segment of a chain; 0 of all others.
    uint32_t part;
    // Number of the part of the second shape.
    uint32_t second_part;
} UmbraShapeDistance;

// The motion of a shape over some time: at constant velocity, and turning at a constant rate around its centre of mass.
typedef struct UmbraSweep {
    // The position of the centre of mass at the start, m.
    struct UmbraVec2 position;
    // The translation over all of the time, m; each component within ±2^20.
    struct UmbraVec2 translation;
    // The angle at the start, rad.
    UmbraFx angle;
    // The rotation over all of the time, rad, whole turns included; within ±2^17.
    UmbraFx rotation;
} UmbraSweep;

// The moment at which two moving shapes meet, and their distance then.
typedef struct UmbraShapeImpact {
    // The fraction of the time, from 0 to 1, rounded down.
    UmbraFx fraction;
    // The distance of the two parts that meet, at that moment.
    struct UmbraShapeDistance distance;
    // 1; 0 if they do not meet, and then all else is 0 as well.
    uint32_t is_hit;
    // 0.
    uint32_t reserved;
} UmbraShapeImpact;

// A character; `umbra_character_def_default` fills it in, but for the shape. Values out of range are refused with the causes 190 to 194.
typedef struct UmbraCharacterDef {
    // The shape, upright: it is never turned. Not a chain. Default null.
    const struct UmbraShape *shape;
    // The direction that is up: of any length from 2^-10 on, within ±2^10 a component. Default +y.
    struct UmbraVec2 up;
    // The distance from colliders that it keeps, m, 2^-12 to 1. Default 2^-6.
    UmbraFx skin;
    // The angle of the steepest slope that it climbs and stands on, rad, 0 to π/2. Default π/4.
    UmbraFx max_slope;
    // The angle of the steepest slope on which a downward translation moves it nowhere, rad, 0 to π/2. Default π/4.
    UmbraFx max_rest_slope;
    // The height of the highest step that it climbs, m, 0 to 2^4. Default 1/4.
    UmbraFx step_height;
    // The depth of the top of a step that it needs to climb it, m, 0 to 2^4. Default 1/16.
    UmbraFx step_width;
    // The distance by which it is moved down to stay on the ground, m, 0 to 2^4. Default 1/4.
    UmbraFx snap;
    // The mass with which it pushes dynamic bodies, kg, 0 to 2^24. Default 0, which pushes nothing.
    UmbraFx push_mass;
} UmbraCharacterDef;

// The ground that a character stands on. With it a character rides on bodies that move and turn.
typedef struct UmbraGround {
    // The body, or `UMBRA_NO_HANDLE` in the air; then nothing else is read, and all else is 0.
    uint64_t body;
    // The centre of the character in the axes of the body, m.
    struct UmbraVec2 local;
    // The point of the world where that was, m.
    struct UmbraVec2 point;
} UmbraGround;

// A request for a movement.
typedef struct UmbraCharacterMove {
    // The position of the shape's centre of mass, m.
    struct UmbraVec2 position;
    // The translation, m; each component within ±2^8.
    struct UmbraVec2 translation;
    // The ground in the state of the last movement.
    struct UmbraGround ground;
    // 1 for a movement before a step: kinematic bodies are seen where the step takes them, so that the character stands beside them after
    // it. 0 to see them where they are. Refused otherwise.
    uint32_t before_step;
    // 0.
    uint32_t reserved;
} UmbraCharacterMove;

// The result of a movement.
typedef struct UmbraMovementState {
    // The new position of the centre of mass of the shape, m.
    struct UmbraVec2 position;
    // The ground that it stands on now.
    struct UmbraGround ground;
    // The collider of the ground, or `UMBRA_NO_HANDLE` in the air.
    uint64_t ground_collider;
    // The unit normal of the ground, towards the character; zero in the air.
    struct UmbraVec2 ground_normal;
    // The velocity of the surface of the ground at the centre of the character, m/s, with the speed of a belt; zero in the air.
    struct UmbraVec2 ground_velocity;
    // The translation that was asked for, m.
    struct UmbraVec2 desired;
    // The part of it that was not gone, if it met a dynamic body, m; else zero. A movement by it after the step, with `before_step` 0, takes
    // the character up to what it pushed: to draw it and to begin the next tick with.
    struct UmbraVec2 held_back;
    // 1 if it overlaps a collider that it could not get out of, else 0.
    uint32_t is_overlapping;
    // 0.
    uint32_t reserved;
} UmbraMovementState;

// A collider that a character moved against.
typedef struct UmbraCharacterHit {
    // The collider.
    uint64_t collider;
    // The body of the collider.
    uint64_t body;
    // The point where they meet, m.
    struct UmbraVec2 point;
    // The unit normal of the collider there.
    struct UmbraVec2 normal;
    // Number of the part of a compound or of the segment of a chain; 0 of all others.
    uint32_t part;
    // 0.
    uint32_t reserved;
} UmbraCharacterHit;

// An impulse with which a character pushes a body that it met: for `umbra_world_apply_impulse`.
typedef struct UmbraCharacterPush {
    // The body.
    uint64_t body;
    // The impulse, N·s.
    struct UmbraVec2 impulse;
    // The point of the world where it acts, m.
    struct UmbraVec2 point;
} UmbraCharacterPush;

// Body or force field that a command created.
typedef struct UmbraCreated {
    // The handle of the created thing, or `UMBRA_NO_HANDLE`.
    uint64_t handle;
    // Kind of the created thing.
    UmbraCreatedKind kind;
    // 0.
    uint32_t reserved;
} UmbraCreated;

// Limits on what a replay may ask for. They also hold for finding out where a run diverges.
typedef struct UmbraReplayLimits {
    // The most ticks it may have: `UMBRA_ERROR_VERIFY_TICKS`.
    uint64_t ticks;
    // The most commands it may have over all of its ticks: `UMBRA_ERROR_VERIFY_COMMANDS`.
    uint64_t commands;
    // The most bodies there may be at any time: `UMBRA_ERROR_VERIFY_BODIES`.
    uint32_t bodies;
    // The most force fields there may be at any time: `UMBRA_ERROR_VERIFY_FIELDS`.
    uint32_t fields;
    // The most colliders there may be at any time: `UMBRA_ERROR_VERIFY_COLLIDERS`.
    uint32_t colliders;
    // The most pairs of colliders that `max_pairs` of its `UmbraContactSettings` may allow at any time, 2^20 by default:
    // `UMBRA_ERROR_VERIFY_PAIRS`.
    uint32_t pairs;
} UmbraReplayLimits;

// The parts of a world that are drawn, and the place from which their points are measured; `umbra_draw_options_default` fills it in.
typedef struct UmbraDrawOptions {
    // Points are measured from here, m: from the camera in a large world, as a float has 24 bits, a millimetre at 10 km. Default 0, 0.
    struct UmbraVec2 origin;
    // Velocities, as the way that a body takes in this many seconds; 0, the default, for none.
    UmbraFx velocity_seconds;
    // Normals of contacts, as arrows of this many m; 0, the default, for none.
    UmbraFx normal_length;
    // Impulses of contacts, as arrows of this many m for each N·s of the last sub-step; 0, the default, for none.
    UmbraFx impulse_scale;
    // 1, the default, for the outlines of bodies; or 0.
    uint32_t bodies;
    // 1, the default, for force fields that are somewhere; or 0.
    uint32_t fields;
    // 1, the default, for joints; or 0.
    uint32_t joints;
    // 1 for the points of contacts; 0 is the default.
    uint32_t contacts;
} UmbraDrawOptions;

// Form of a figure: one of the four values below.
typedef uint32_t UmbraFigureForm;

// Meaning of a figure: one of the values below. Later versions may have more.
typedef uint32_t UmbraFigureRole;

// Class of a body for drawing, to choose a colour by: one of the values below.
typedef uint32_t UmbraBodyClass;

// A figure of a drawing.
typedef struct UmbraFigure {
    // The body, field, joint or collider that it shows, or `UMBRA_NO_HANDLE`.
    uint64_t handle;
    // The collider of an outline, the second collider of a contact, or `UMBRA_NO_HANDLE`.
    uint64_t other;
    // Its form.
    UmbraFigureForm form;
    // Its meaning.
    UmbraFigureRole role;
    // The class of a body that it outlines; of others 0.
    UmbraBodyClass class_;
    // The number of points of the drawing before its own.
    uint32_t first_point;
    // The number of its points: 1 of a point, 2 of a segment and an arrow, 3 and more of a polygon.
    uint32_t point_count;
    // 0.
    uint32_t reserved;
} UmbraFigure;

// 1 as an `UmbraFx`.
#define UMBRA_ONE 4294967296

// The call was carried out.
#define UMBRA_OK 0

// A value is outside of the range of its kind; `umbra_last_cause` has the number of the kind, from 151 on.
#define UMBRA_ERROR_OUT_OF_RANGE 101

// The handle names no body: it was removed, or never there.
#define UMBRA_ERROR_NO_SUCH_BODY 102

// The handle names no force field.
#define UMBRA_ERROR_NO_SUCH_FIELD 103

// A time step is num/den seconds, with 1 to 10,000 steps a second.
#define UMBRA_ERROR_TIME_STEP 104

// A corner of a polygon is not convex, or repeats its neighbour.
#define UMBRA_ERROR_NOT_CONVEX 105

// The call needs a dynamic body.
#define UMBRA_ERROR_NOT_DYNAMIC 107

// A static body has no velocity.
#define UMBRA_ERROR_NOT_MOVABLE 108

// The body is quarantined: set its state and release it first.
#define UMBRA_ERROR_QUARANTINED 109

// The body is not quarantined, and cannot be released.
#define UMBRA_ERROR_NOT_QUARANTINED 110

// Yoshida4 needs damping that keeps more than 2^-33 of a velocity a second: a rate below 22.87.
#define UMBRA_ERROR_DAMPING_HAS_NO_INVERSE 111

// One body is named twice, where two different ones are needed.
#define UMBRA_ERROR_SAME_BODY 112

// The world already has the maximum number of bodies, colliders, outlines of colliders, force fields or excluded pairs.
#define UMBRA_ERROR_FULL 114

// The elapsed time no longer fits in a ratio of 128-bit integers.
#define UMBRA_ERROR_ELAPSED_TIME 115

// The tick already has an input of this player and sequence.
#define UMBRA_ERROR_DUPLICATE_INPUT 117

// The last step cannot be undone; `umbra_last_cause` has the number of the reason, 131 to 146.
#define UMBRA_ERROR_NOT_REVERSIBLE 120

// The body is locked along an axis of the velocity; `umbra_last_cause` has which velocity, 153 or 154.
#define UMBRA_ERROR_LOCKED 121

// The body is disabled: enable it first.
#define UMBRA_ERROR_DISABLED 122

// The body is not disabled, and cannot be enabled.
#define UMBRA_ERROR_NOT_DISABLED 123

// The call needs a kinematic body.
#define UMBRA_ERROR_NOT_KINEMATIC 124

// The handle names no collider.
#define UMBRA_ERROR_NO_SUCH_COLLIDER 128

// A chain cannot be on a dynamic body.
#define UMBRA_ERROR_DYNAMIC_CHAIN 129

// Two segments of the chain or the concave polygon cross or touch.
#define UMBRA_ERROR_CHAIN_CROSSES 130

// The handle names no joint.
#define UMBRA_ERROR_NO_SUCH_JOINT 147

// Neither end of the joint is on a dynamic body.
#define UMBRA_ERROR_NOTHING_TO_MOVE 148

// The joint is of a kind that has no motor.
#define UMBRA_ERROR_NO_MOTOR 214

// Sleeping is off in the world.
#define UMBRA_ERROR_SLEEP_IS_OFF 218

// A kinematic body that moves touches the bodies that were to sleep, or is joined to them.
#define UMBRA_ERROR_KEPT_AWAKE 219

// The bytes are not a snapshot.
#define UMBRA_ERROR_SNAPSHOT_FOREIGN 301

// The bytes have another layout.
#define UMBRA_ERROR_SNAPSHOT_FORMAT 302

// The snapshot was made under another physics version.
#define UMBRA_ERROR_SNAPSHOT_PHYSICS_VERSION 303

// The snapshot is cut off or damaged.
#define UMBRA_ERROR_SNAPSHOT_MALFORMED 304

// The snapshot contains an impossible value; `umbra_last_cause` has the reason.
#define UMBRA_ERROR_SNAPSHOT_INVALID 305

// The snapshot uses a custom force, which this interface does not support.
#define UMBRA_ERROR_SNAPSHOT_CUSTOM_FORCE 306

// The restored world does not have the hash that the snapshot states.
#define UMBRA_ERROR_SNAPSHOT_CHANGED 307

// The bytes are not what is expected there.
#define UMBRA_ERROR_MALFORMED 320

// The bytes are not a replay.
#define UMBRA_ERROR_REPLAY_FOREIGN 401

// The bytes have another layout.
#define UMBRA_ERROR_REPLAY_FORMAT 402

// The replay was recorded under another physics version.
#define UMBRA_ERROR_REPLAY_PHYSICS_VERSION 403

// The file ends before the recording did.
#define UMBRA_ERROR_REPLAY_CUT_OFF 404

// The replay was changed after it was recorded; `umbra_last_message` names the value.
#define UMBRA_ERROR_REPLAY_TAMPERED 405

// A chunk of the replay is malformed.
#define UMBRA_ERROR_REPLAY_MALFORMED 406

// A snapshot in the replay is invalid.
#define UMBRA_ERROR_REPLAY_SNAPSHOT 407

// The run diverged from the recording; `umbra_last_message` says where.
#define UMBRA_ERROR_DIVERGENCE 420

// The replay has more ticks than the limit allows.
#define UMBRA_ERROR_VERIFY_TICKS 422

// The replay makes more bodies than the limit allows.
#define UMBRA_ERROR_VERIFY_BODIES 423

// The replay makes more force fields than the limit allows.
#define UMBRA_ERROR_VERIFY_FIELDS 424

// The replay has more commands than the limit allows.
#define UMBRA_ERROR_VERIFY_COMMANDS 425

// The replay makes more colliders than the limit allows.
#define UMBRA_ERROR_VERIFY_COLLIDERS 426

// The replay's contact settings allow more pairs of colliders than the limit.
#define UMBRA_ERROR_VERIFY_PAIRS 427

// The scene says what cannot be. Scenes have numbers from 500 to 510, and those of what the engine refuses of them;
// `umbra_last_message` has the line.
#define UMBRA_ERROR_SCENE 500

// The argument is zero or negative, where the function has no value.
#define UMBRA_ERROR_MATH_NOT_POSITIVE 701

// The value does not fit in an `UmbraFx`.
#define UMBRA_ERROR_MATH_OVERFLOW 702

// A number is expected, and there is no text.
#define UMBRA_ERROR_NUMBER_EMPTY 711

// The text stops being a number.
#define UMBRA_ERROR_NUMBER_INVALID_DIGIT 712

// The number does not fit.
#define UMBRA_ERROR_NUMBER_OUT_OF_RANGE 713

// A pointer is null where that means nothing.
#define UMBRA_ERROR_NULL_POINTER 901

// An argument is none of those that the function knows: a number of a kind, a flag, a length that no memory has, text that is
// not UTF-8.
#define UMBRA_ERROR_BAD_ARGUMENT 902

// The buffer is too small; nothing was written to it, and the length or count that was asked for says how large it has to be.
#define UMBRA_ERROR_BUFFER_TOO_SMALL 903

// The library has a fault: it panicked, and the call was ended. What the call changed may only be freed.
#define UMBRA_ERROR_PANIC 904

// A world that a scene or a replay runs is changed by that alone (`umbra_world_leave_scene`), a draft is not stepped, and a world that
// is being recorded does not go to another state at once.
#define UMBRA_ERROR_BUSY 905

// The replay that runs the world has no more ticks.
#define UMBRA_ERROR_END 906

// Order 1; gains energy. For comparison.
#define UMBRA_EXPLICIT_EULER 0

// Order 1, symplectic.
#define UMBRA_SYMPLECTIC_EULER 1

// Order 2, symplectic, reversible. The one to begin with.
#define UMBRA_VELOCITY_VERLET 2

// The four stages of UMBRA as published. Order 1.
#define UMBRA_PUBLISHED_VERLET 3

// Order 4, symplectic, reversible.
#define UMBRA_YOSHIDA4 4

// Nothing new.
#define UMBRA_CREATED_NOTHING 0

// A body.
#define UMBRA_CREATED_BODY 1

// A force field.
#define UMBRA_CREATED_FIELD 2

// A collider.
#define UMBRA_CREATED_COLLIDER 3

// A joint.
#define UMBRA_CREATED_JOINT 4

// Never moves.
#define UMBRA_STATIC 0

// Moves at the velocity you set. Forces, damping and contacts have no effect on it; it pushes dynamic bodies.
#define UMBRA_KINEMATIC 1

// Responds to forces, gravity, damping and contacts.
#define UMBRA_DYNAMIC 2

// The body takes part in steps.
#define UMBRA_AWAKE 0

// The body is at rest and is skipped until something wakes it.
#define UMBRA_ASLEEP 1

// The body left the allowed range: restored to its last good state and excluded from simulation until it is released.
#define UMBRA_QUARANTINED 2

// The body was taken out of the simulation by a call, until it is enabled.
#define UMBRA_DISABLED 3

// `mass` in kg. The inertia follows from the colliders; without any it is infinite.
#define UMBRA_MASS_KILOGRAMS 1

// `mass` in kg and `inertia` in kg·m².
#define UMBRA_MASS_EXPLICIT 2

// The mass and the inertia of the colliders; without any as `UMBRA_MASS_KILOGRAMS` with 1 kg. `mass` is not read.
#define UMBRA_MASS_FROM_COLLIDERS 3

// In place of a damping of a body's own: that of the world.
#define UMBRA_AS_WORLD -1

// In place of a largest speed: none.
#define UMBRA_NO_LIMIT -1

// The velocity along x.
#define UMBRA_LOCK_X 1

// The velocity along y.
#define UMBRA_LOCK_Y 2

// The angular velocity.
#define UMBRA_LOCK_ROTATION 4

// The geometric mean for friction, the larger one for restitution.
#define UMBRA_MIX_STANDARD 0

// The geometric mean.
#define UMBRA_MIX_GEOMETRIC_MEAN 1

// The mean.
#define UMBRA_MIX_MEAN 2

// The smaller one.
#define UMBRA_MIX_MINIMUM 3

// The product; of friction at most 32.
#define UMBRA_MIX_PRODUCT 4

// The larger one.
#define UMBRA_MIX_MAXIMUM 5

// Until a call allows the pair again.
#define UMBRA_EXCLUDE_ALWAYS 0

// Until the first step in which they are too far apart to touch.
#define UMBRA_EXCLUDE_UNTIL_APART 1

// Acceleration mu·d / (d² + softening²)^(3/2) towards a point, the same for every mass. Reads `other`, `other_point`, `mu`,
// `softening`.
#define UMBRA_ATTRACTOR 0

// A spring with a damper along it. Reads `body`, `point`, `other`, `other_point`, `rest`, `stiffness`, `damping`.
#define UMBRA_SPRING 1

// Drag against a medium: F = −(linear + quadratic·|u|)·u with u the velocity relative to it. Reads `linear`, `quadratic`,
// `wind`.
#define UMBRA_DRAG 2

// A force that turns with the body. Reads `body`, `point`, `force`.
#define UMBRA_THRUST 3

// A constant acceleration of the bodies whose centre of mass is in a region. Reads `region` and what that reads, and
// `acceleration`.
#define UMBRA_ZONE 4

// A fluid in a box, which lifts colliders by the area that they have in it and slows them down. Reads `min`, `max`, `density`,
// `linear_drag`, `angular_drag`, `flow`.
#define UMBRA_BUOYANCY 5

// Friction with a ground that is seen from above: speed and spin fall at constant rates to nothing. Reads `deceleration`,
// `angular_deceleration`.
#define UMBRA_FRICTION 6

// Reads `centre` and `radius`.
#define UMBRA_DISC 0

// Reads `min` and `max`.
#define UMBRA_BOX 1

// Vector and point are in the axes of the body, the point from its centre of mass; not in those of the world.
#define UMBRA_BODY_FRAME 1

// Does not wake a sleeping body, which then ignores the force.
#define UMBRA_NO_WAKE 2

// Both ends stay at one point, around which the bodies turn. Reads the limits, the motor, the spring and `friction`.
#define UMBRA_REVOLUTE 0

// The ends stay at a distance: a rigid rod with two limits that are the same, a rope, or a spring. Reads the limits, the motor, the spring and
// `friction`.
#define UMBRA_DISTANCE 1

// Both ends stay at one point and at one angle. Reads the spring, which stands in place of the rigid angle.
#define UMBRA_WELD 2

// The second end slides along the x axis of the frame of the first one, and the bodies do not turn against each other. Reads the limits, the
// motor, the spring and `friction`, along the axis.
#define UMBRA_PRISMATIC 3

// The second end slides along the x axis of the frame of the first one, and turns. Reads the limits and the spring along the axis, the motor and
// `friction` of the turn.
#define UMBRA_WHEEL 4

// The second end is moved in the frame of the first one by forces with bounds: by the planar spring and the planar motor, and turned by the motor
// and the spring. A mouse has a planar spring alone, whose point at rest is set in each tick by `umbra_world_set_joint_kind`.
#define UMBRA_MOTOR 5

// The bodies turn at a ratio: two gears, a chain, a belt. Reads the teeth.
#define UMBRA_GEAR 6

// A rope from one body over two points of the world to the other body, which pulls. Reads the points `grounds`, the strands, and `upper`, the length
// of the rope.
#define UMBRA_PULLEY 7

// A convex area by its corners, counter-clockwise. Discs and round ends have corners too: 48 to a whole disc.
#define UMBRA_FIGURE_POLYGON 0

// A line, by its two ends.
#define UMBRA_FIGURE_SEGMENT 1

// An arrow, by its two ends: to the second one.
#define UMBRA_FIGURE_ARROW 2

// A point without a size: a mark.
#define UMBRA_FIGURE_POINT 3

// A role that this version of the interface has no number for.
#define UMBRA_ROLE_OTHER 0

// The outline of a collider of a body, or a point at the position of a body without any: `handle` is the body, `other` the collider.
#define UMBRA_ROLE_BODY 1

// An arrow along the velocity of a body: `handle` is the body.
#define UMBRA_ROLE_VELOCITY 2

// A spring, from end to end: `handle` is the field.
#define UMBRA_ROLE_SPRING 3

// The centre of an attractor: `handle` is the field.
#define UMBRA_ROLE_ATTRACTOR 4

// An arrow to the point that a thrust acts at: `handle` is the field.
#define UMBRA_ROLE_THRUST 5

// The region of a zone, and an arrow along its acceleration: `handle` is the field.
#define UMBRA_ROLE_ZONE 6

// The box of a fluid, and an arrow along its flow: `handle` is the field.
#define UMBRA_ROLE_BUOYANCY 7

// The ends of a joint, the line between them, and its axis if it has one: `handle` is the joint.
#define UMBRA_ROLE_JOINT 8

// A point of a contact: `handle` and `other` are its colliders.
#define UMBRA_ROLE_CONTACT 9

// An arrow along the normal of a contact, from the first collider, `handle`, to the second one, `other`.
#define UMBRA_ROLE_CONTACT_NORMAL 10

// An arrow along the impulse on the second collider of a contact, `other`.
#define UMBRA_ROLE_CONTACT_IMPULSE 11

// An arrow along the impulse of friction on the second collider of a contact, `other`.
#define UMBRA_ROLE_FRICTION_IMPULSE 12

// Moved by everything, and awake.
#define UMBRA_CLASS_DYNAMIC 0

// Moved by the velocity it is given.
#define UMBRA_CLASS_KINEMATIC 1

// Moved by nothing.
#define UMBRA_CLASS_STATIC 2

// At rest and skipped.
#define UMBRA_CLASS_ASLEEP 3

// Taken out of the simulation by a step.
#define UMBRA_CLASS_QUARANTINED 4

// Taken out of the simulation by a call.
#define UMBRA_CLASS_DISABLED 5

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The number of the interface that the library has.
uint32_t umbra_api(void);

// The physics version. Peers, snapshots and replays go together if they have the same.
uint32_t umbra_physics_version(void);

// The version of the library as text, which stays. This interface has the same.
const char *umbra_version(void);

// Runs the corpus of the library, and gives its digest: the same on every machine. What it is to be
// stands in `src/selftest/golden.txt`.
UmbraStatus umbra_selftest(uint64_t *digest);

// Allocates bytes, all 0, to write into: for hosts whose memory the library does not see, such as a WebAssembly host.
// They lie at a multiple of 16.
UmbraStatus umbra_bytes_new(size_t length, struct UmbraBytes **bytes);

// Address of the bytes, valid until they are freed; null for null.
uint8_t *umbra_bytes_data(struct UmbraBytes *bytes);

// Number of bytes; 0 for null.
size_t umbra_bytes_length(const struct UmbraBytes *bytes);

// Frees bytes. Null is ignored.
void umbra_bytes_free(struct UmbraBytes *bytes);

// The number nearest to a decimal text of `length` bytes, such as `-9.81` or `1.5e-3`; ties to even, never through a float.
UmbraStatus umbra_fx_from_text(const char *text,
                               size_t length,
                               UmbraFx *number);

// All digits of a number: at most 44 bytes and the zero. Read again they are the number. Text as `umbra_last_message` gives it.
UmbraStatus umbra_fx_to_text(UmbraFx number,
                             char *buffer,
                             size_t capacity,
                             size_t *length);

// All digits of a multiple of 2^-64, as energies are, at most 85 bytes and the zero: text as `umbra_last_message` gives it.
UmbraStatus umbra_wide_to_text(const struct UmbraInt128 *wide,
                               char *buffer,
                               size_t capacity,
                               size_t *length);

// The factor nearest to a decimal text, such as `3.986004418e14`: for what is too large or too small for an `UmbraFx`.
UmbraStatus umbra_factor_from_text(const char *text, size_t length, struct UmbraFactor *factor);

// The factor that a number is, exactly; of its magnitude if it is below 0.
UmbraStatus umbra_factor_from_fx(UmbraFx number, struct UmbraFactor *factor);

// The number of what caused the last error of this thread, such as 155 (a mass) for `UMBRA_ERROR_OUT_OF_RANGE`; 0 if it has
// none. Calls that are done leave it as it is.
UmbraStatus umbra_last_cause(void);

// The last error of this thread in words, with names, places and values: for a log. Empty if there was none.
//
// Text goes into `buffer`, which has room for `capacity` bytes, with a zero after it. `length`, which may be null, is given the
// number of bytes before the zero, also if the buffer is too small; a `capacity` of 0 asks for the length alone.
UmbraStatus umbra_last_message(char *buffer,
                               size_t capacity,
                               size_t *length);

// General meaning of an error number, as `docs/errors.md` gives it; text as for `umbra_last_message`.
// `UMBRA_ERROR_BAD_ARGUMENT` for an unknown number, and then nothing is written. The last error is not changed.
UmbraStatus umbra_status_message(UmbraStatus status, char *buffer, size_t capacity, size_t *length);

// The ratio of two integers, rounded to nearest, ties to even: 1 and 3 for a third. `UMBRA_ERROR_MATH_NOT_POSITIVE` if `den` is 0,
// `UMBRA_ERROR_MATH_OVERFLOW` if the ratio does not fit.
UmbraStatus umbra_fx_from_ratio(int64_t num,
                                int64_t den,
                                UmbraFx *ratio);

// The sum a + b. `UMBRA_ERROR_MATH_OVERFLOW` if it does not fit.
UmbraStatus umbra_fx_add(UmbraFx a, UmbraFx b, UmbraFx *sum);

// The difference a - b. `UMBRA_ERROR_MATH_OVERFLOW` if it does not fit.
UmbraStatus umbra_fx_sub(UmbraFx a, UmbraFx b, UmbraFx *difference);

// The product a·b, rounded to nearest, ties to even. `UMBRA_ERROR_MATH_OVERFLOW` if it does not fit.
UmbraStatus umbra_fx_mul(UmbraFx a, UmbraFx b, UmbraFx *product);

// The quotient a/b, rounded to nearest, ties to even. `UMBRA_ERROR_MATH_NOT_POSITIVE` if b is 0, `UMBRA_ERROR_MATH_OVERFLOW` if the
// quotient does not fit.
UmbraStatus umbra_fx_div(UmbraFx a,
                         UmbraFx b,
                         UmbraFx *quotient);

// The remainder of a/b, exactly, from 0 to below the magnitude of b. `UMBRA_ERROR_MATH_NOT_POSITIVE` if b is 0.
UmbraStatus umbra_fx_rem_euclid(UmbraFx a, UmbraFx b, UmbraFx *remainder);

// The square root, the nearest value. `UMBRA_ERROR_MATH_NOT_POSITIVE` below 0.
UmbraStatus umbra_fx_sqrt(UmbraFx number, UmbraFx *root);

// The length of the vector (x, y), the nearest value. `UMBRA_ERROR_MATH_OVERFLOW` if it does not fit.
UmbraStatus umbra_fx_hypot(UmbraFx x, UmbraFx y, UmbraFx *length);

// The sine of an angle in radians, within 0.5001 ulp.
UmbraStatus umbra_fx_sin(UmbraFx angle, UmbraFx *sine);

// The cosine of an angle in radians, within 0.5001 ulp.
UmbraStatus umbra_fx_cos(UmbraFx angle, UmbraFx *cosine);

// The angle of the vector (x, y) from the x axis in radians, counter-clockwise, from -π to π, within 0.5001 ulp; 0 for the zero vector.
// y comes first, as in C.
UmbraStatus umbra_fx_atan2(UmbraFx y,
                           UmbraFx x,
                           UmbraFx *angle);

// The binary logarithm, within 0.5001 ulp. `UMBRA_ERROR_MATH_NOT_POSITIVE` for 0 and below.
UmbraStatus umbra_fx_log2(UmbraFx number, UmbraFx *logarithm);

// The power of two, within 0.5001 ulp. `UMBRA_ERROR_MATH_OVERFLOW` from 31 on.
UmbraStatus umbra_fx_exp2(UmbraFx exponent, UmbraFx *power);

// The power of a base above 0, within 0.5001 ulp. `UMBRA_ERROR_MATH_NOT_POSITIVE` for a base of 0 and below,
// `UMBRA_ERROR_MATH_OVERFLOW` if the power does not fit.
UmbraStatus umbra_fx_pow(UmbraFx base, UmbraFx exponent, UmbraFx *power);

// A disc of a radius of 2^-7 to 2^12 m.
UmbraStatus umbra_shape_circle(UmbraFx radius, struct UmbraShape **shape);

// A rectangle about its centre, m: sides from 2^-7 to 2^12 m.
UmbraStatus umbra_shape_rectangle(UmbraFx width, UmbraFx height, struct UmbraShape **shape);

// A capsule along x; its length is between the centres of its half discs, and its radius from 2^-7 to 2^12 m.
UmbraStatus umbra_shape_capsule(UmbraFx length, UmbraFx radius, struct UmbraShape **shape);

// A thin rod between two points, m.
UmbraStatus umbra_shape_segment(const struct UmbraVec2 *a, const struct UmbraVec2 *b, struct UmbraShape **shape);

// A convex polygon of 3 to 64 corners, in either order, m. It is re-centred at its centre of mass.
UmbraStatus umbra_shape_polygon(const struct UmbraVec2 *corners, size_t count, struct UmbraShape **shape);

// The convex hull of up to 65,536 points, a polygon of 3 to 64 corners, m: points in it and within its sides are no corners. It is re-centred at
// its centre of mass.
UmbraStatus umbra_shape_hull(const struct UmbraVec2 *points,
                             size_t count,
                             struct UmbraShape **shape);

// A polygon of 3 to 1,024 corners that may be concave, in either order, m: a compound of up to 256 convex polygons, or one polygon if it is
// convex. A polygon that crosses or touches itself is refused with `UMBRA_ERROR_CHAIN_CROSSES`. It is re-centred at its centre of mass.
UmbraStatus umbra_shape_concave_polygon(const struct UmbraVec2 *corners,
                                        size_t count,
                                        struct UmbraShape **shape);

// A convex polygon of 3 to 64 corners, in either order, and all points within the radius of it, m. It is re-centred at its centre of
// mass.
UmbraStatus umbra_shape_rounded_polygon(const struct UmbraVec2 *corners,
                                        size_t count,
                                        UmbraFx radius,
                                        struct UmbraShape **shape);

// 1 to 256 shapes as one. It is re-centred at its centre of mass.
UmbraStatus umbra_shape_compound(const struct UmbraPart *parts, size_t count, struct UmbraShape **shape);

// A chain of segments through 2 to 65,536 points, and back to the first one if `closed` is not 0: a surface for static and kinematic
// bodies that touches what is on its right on the way through the points, m. It is not re-centred.
UmbraStatus umbra_shape_chain(const struct UmbraVec2 *points,
                              size_t count,
                              uint32_t closed,
                              struct UmbraShape **shape);

// Frees a shape. Null is ignored.
void umbra_shape_free(struct UmbraShape *shape);

// Fills in a definition: 60 steps a second by velocity Verlet, no gravity, no damping, asleep after half a second at rest.
UmbraStatus umbra_world_def_default(struct UmbraWorldDef *def);

// An empty world. It is the caller's, as is everything that a function gives through a pointer to a pointer, until it is
// handed to `umbra_world_free`.
UmbraStatus umbra_world_new(const struct UmbraWorldDef *def,
                            struct UmbraWorld **world);

// The world of a scene (`docs/scene.md`), which a JSON text of `length` bytes describes. Its steps do what the scene has for
// their ticks; the scene alone changes it, until `umbra_world_leave_scene`. It may have at most `most` bodies, as many fields,
// and as many things that its inputs do, as a short text can ask for many; 131072 is a good number.
UmbraStatus umbra_world_from_scene(const char *json,
                                   size_t length,
                                   uint32_t most,
                                   struct UmbraWorld **world);

// Ends the scene or the replay that runs a world: the world stays as it is, and the caller may change it. Of other worlds nothing changes.
UmbraStatus umbra_world_leave_scene(struct UmbraWorld *world);

// A world with the same state and future, which shares what no step changes, and with the same scene or replay. It is not recorded.
UmbraStatus umbra_world_clone(const struct UmbraWorld *world,
                              struct UmbraWorld **copy);

// Frees a world. Null is ignored.
void umbra_world_free(struct UmbraWorld *world);

// Definition of the world, with all changes since.
UmbraStatus umbra_world_def(const struct UmbraWorld *world, struct UmbraWorldDef *def);

// Moves a world on by a tick. A scene can be refused: what it does in this tick before that is done, and the step is not
// made. So can a replay: see `umbra_world_from_replay`.
UmbraStatus umbra_world_step(struct UmbraWorld *world);

// Carries out the inputs of a tick, by player and then by sequence, and moves the world on. An input that is refused changes
// nothing and stops no other: `umbra_world_outcomes` has what became of each.
UmbraStatus umbra_world_step_inputs(struct UmbraWorld *world,
                                    const struct UmbraInputs *inputs);

// Results of the inputs of the last step, in their order.
//
// Lists go into a buffer with room for `capacity` entries. `count`, which may be null, is given the number of entries, also if
// the buffer is too small; a `capacity` of 0 asks for the number alone.
UmbraStatus umbra_world_outcomes(const struct UmbraWorld *world,
                                 struct UmbraInputResult *outcomes,
                                 size_t capacity,
                                 size_t *count);

// No inputs.
UmbraStatus umbra_inputs_new(struct UmbraInputs **inputs);

// Adds a command of a player's, as the bytes of `docs/formats.md`, in its place: in whatever order they arrive.
UmbraStatus umbra_inputs_insert(struct UmbraInputs *inputs,
                                uint32_t player,
                                uint32_t sequence,
                                const uint8_t *command,
                                size_t length);

// Puts `count` commands, with sequences from 0, in the place of all inputs of a player: what a peer does with a packet, which may
// come again. `commands` has the bytes of one after the other, `lengths` how many each has. `changed`, which may be null, is
// given 1, or 0 if the player had just these.
UmbraStatus umbra_inputs_replace(struct UmbraInputs *inputs,
                                 uint32_t player,
                                 const uint8_t *commands,
                                 const size_t *lengths,
                                 size_t count,
                                 uint32_t *changed);

// Removes all, for those of another tick.
UmbraStatus umbra_inputs_clear(struct UmbraInputs *inputs);

// Frees inputs. Null is ignored.
void umbra_inputs_free(struct UmbraInputs *inputs);

// Summary of the last step.
UmbraStatus umbra_world_report(const struct UmbraWorld *world, struct UmbraReport *report);

// The bodies that the last step quarantined, in the order of their slots; a list as `umbra_world_outcomes` gives it.
UmbraStatus umbra_world_faults(const struct UmbraWorld *world,
                               struct UmbraFault *faults,
                               size_t capacity,
                               size_t *count);

// The bodies that fell asleep in the last step, in the order of their slots; a list as `umbra_world_outcomes` gives it.
UmbraStatus umbra_world_fell_asleep(const struct UmbraWorld *world, uint64_t *bodies, size_t capacity, size_t *count);

// The bodies that calls before the last step woke, in the order of the calls; a list as `umbra_world_outcomes` gives it.
UmbraStatus umbra_world_woke(const struct UmbraWorld *world,
                             uint64_t *bodies,
                             size_t capacity,
                             size_t *count);

// The number of steps made.
UmbraStatus umbra_world_tick(const struct UmbraWorld *world, uint64_t *tick);

// The time simulated in seconds, an exact ratio in lowest terms.
UmbraStatus umbra_world_elapsed(const struct UmbraWorld *world, struct UmbraUint128 *num, struct UmbraUint128 *den);

// A hash of all that the future of a world depends on, handles included: what peers compare.
UmbraStatus umbra_world_state_hash(const struct UmbraWorld *world, uint64_t *hash);

// A hash of the motion alone, bodies by their keys: for worlds that were built in another order.
UmbraStatus umbra_world_physics_hash(const struct UmbraWorld *world, uint64_t *hash);

// The first value in which two worlds differ, with both values, as in `body 3, position.x: 1 and 2 m (differ by 1 m)`; empty
// if they do not. Text as `umbra_last_message` gives it. It is for finding out what went wrong, and takes its time.
UmbraStatus umbra_world_first_difference(const struct UmbraWorld *left,
                                         const struct UmbraWorld *right,
                                         char *buffer,
                                         size_t capacity,
                                         size_t *length);

// The body of a name in a world that a scene or a replay runs: the first one, if several have it. Names end with
// `umbra_world_leave_scene`, handles do not.
UmbraStatus umbra_world_find_body(const struct UmbraWorld *world, const char *name, size_t length, uint64_t *body);

// The force field of a name, as `umbra_world_find_body` finds a body.
UmbraStatus umbra_world_find_field(const struct UmbraWorld *world, const char *name, size_t length, uint64_t *field);

// The joint of a name, as `umbra_world_find_body` finds a body.
UmbraStatus umbra_world_find_joint(const struct UmbraWorld *world, const char *name, size_t length, uint64_t *joint);

// The collider of a name, as `umbra_world_find_body` finds a body.
UmbraStatus umbra_world_find_collider(const struct UmbraWorld *world,
                                      const char *name,
                                      size_t length,
                                      uint64_t *collider);

// The name of a body in a world that a scene or a replay runs, empty if it has none; text as `umbra_last_message` gives it.
UmbraStatus umbra_world_body_name(const struct UmbraWorld *world,
                                  uint64_t body,
                                  char *buffer,
                                  size_t capacity,
                                  size_t *length);

// The name of a force field, as `umbra_world_body_name` gives that of a body.
UmbraStatus umbra_world_field_name(const struct UmbraWorld *world,
                                   uint64_t field,
                                   char *buffer,
                                   size_t capacity,
                                   size_t *length);

// The name of a joint, as `umbra_world_body_name` gives that of a body.
UmbraStatus umbra_world_joint_name(const struct UmbraWorld *world,
                                   uint64_t joint,
                                   char *buffer,
                                   size_t capacity,
                                   size_t *length);

// The name of a collider, as `umbra_world_body_name` gives that of a body.
UmbraStatus umbra_world_collider_name(const struct UmbraWorld *world,
                                      uint64_t collider,
                                      char *buffer,
                                      size_t capacity,
                                      size_t *length);

// Fills in a definition: a body of 1 kg, or of the mass of the colliders that are added to it, that everything moves, at rest at the origin.
UmbraStatus umbra_body_def_default(struct UmbraBodyDef *def);

// Adds a body, to which `umbra_world_add_collider` adds colliders. Its handle stays good until it is removed, and never names another one afterwards.
UmbraStatus umbra_world_add_body(struct UmbraWorld *world,
                                 const struct UmbraBodyDef *def,
                                 uint64_t *body);

// Removes a body, its colliders and the force fields attached to it, and wakes what they joined it to.
UmbraStatus umbra_world_remove_body(struct UmbraWorld *world, uint64_t body);

// Reads a body.
UmbraStatus umbra_world_body(const struct UmbraWorld *world, uint64_t body, struct UmbraBodyState *state);

// Mass of a body as it was given, to the bit, also while it is not dynamic; a `mass` or an `inertia` that was not given is 0.
UmbraStatus umbra_world_body_mass_def(const struct UmbraWorld *world,
                                      uint64_t body,
                                      UmbraMassKind *kind,
                                      UmbraFx *mass,
                                      UmbraFx *inertia);

// Kinematic target of a body, if it has one.
UmbraStatus umbra_world_body_goal(const struct UmbraWorld *world, uint64_t body, struct UmbraGoal *goal);

// The velocity of a point of the world that moves with a body, m/s, rounded once. `UMBRA_ERROR_NUMBER_OUT_OF_RANGE` if a
// component does not fit.
UmbraStatus umbra_world_body_velocity_at(const struct UmbraWorld *world,
                                         uint64_t body,
                                         UmbraFx x,
                                         UmbraFx y,
                                         struct UmbraVec2 *velocity);

// World coordinates of a point of a body, m, given in its axes from its centre of mass. `UMBRA_ERROR_NUMBER_OUT_OF_RANGE` if a
// component does not fit.
UmbraStatus umbra_world_body_world_point(const struct UmbraWorld *world,
                                         uint64_t body,
                                         UmbraFx x,
                                         UmbraFx y,
                                         struct UmbraVec2 *point);

// Coordinates of a world point on a body, m, in its axes from its centre of mass. `UMBRA_ERROR_NUMBER_OUT_OF_RANGE` if a
// component, or one of the way from the centre, does not fit.
UmbraStatus umbra_world_body_local_point(const struct UmbraWorld *world,
                                         uint64_t body,
                                         UmbraFx x,
                                         UmbraFx y,
                                         struct UmbraVec2 *point);

// The first body by slot that has a key; `UMBRA_ERROR_NO_SUCH_BODY` if none has. It looks through all of them.
UmbraStatus umbra_world_body_with_key(const struct UmbraWorld *world, uint64_t key, uint64_t *body);

// All bodies that have a key, in the order of their slots; a list as `umbra_world_outcomes` gives it.
UmbraStatus umbra_world_bodies_with_key(const struct UmbraWorld *world,
                                        uint64_t key,
                                        uint64_t *bodies,
                                        size_t capacity,
                                        size_t *count);

// The number of bodies, and of those that a step moves: not static, not asleep, not out of the simulation. Either pointer may be null.
UmbraStatus umbra_world_body_count(const struct UmbraWorld *world,
                                   size_t *all,
                                   size_t *moving);

// The handles of all bodies, in the order of their slots; a list as `umbra_world_outcomes` gives it.
UmbraStatus umbra_world_bodies(const struct UmbraWorld *world, uint64_t *bodies, size_t capacity, size_t *count);

// Poses of all bodies, in the order of their slots: one call a frame; a list as `umbra_world_outcomes` gives it.
UmbraStatus umbra_world_poses(const struct UmbraWorld *world, struct UmbraPose *poses, size_t capacity, size_t *count);

// Puts a body somewhere else, m; wakes it. The fraction below 2^-32 is dropped.
UmbraStatus umbra_world_set_position(struct UmbraWorld *world, uint64_t body, UmbraFx x, UmbraFx y);

// Turns a body to an angle, rad, of any size; wakes it.
UmbraStatus umbra_world_set_angle(struct UmbraWorld *world, uint64_t body, UmbraFx angle);

// Gives a body a velocity, m/s; wakes it.
UmbraStatus umbra_world_set_velocity(struct UmbraWorld *world, uint64_t body, UmbraFx x, UmbraFx y);

// Gives a body an angular velocity, rad/s; wakes it.
UmbraStatus umbra_world_set_angular_velocity(struct UmbraWorld *world, uint64_t body, UmbraFx velocity);

// Gives a body a mass, as the fields of its definition do. One that is not dynamic keeps it for when it is.
UmbraStatus umbra_world_set_mass(struct UmbraWorld *world,
                                 uint64_t body,
                                 UmbraMassKind kind,
                                 UmbraFx mass,
                                 UmbraFx inertia);

// Changes what moves a body. One that becomes static stops; what was applied to it this tick is forgotten.
UmbraStatus umbra_world_set_kind(struct UmbraWorld *world, uint64_t body, UmbraBodyKind kind);

// Changes how much of the world's gravity a body feels, within ±16.
UmbraStatus umbra_world_set_gravity_scale(struct UmbraWorld *world, uint64_t body, UmbraFx scale);

// Gives a body dampings of its own: the share of each velocity that is left after a second, 0 to 1, or what `umbra_kept_at_rate`
// returns. `UMBRA_AS_WORLD` takes one from it.
UmbraStatus umbra_world_set_body_kept_per_second(struct UmbraWorld *world,
                                                 uint64_t body,
                                                 UmbraFx linear,
                                                 UmbraFx angular);

// Changes the dominance of a body.
UmbraStatus umbra_world_set_dominance(struct UmbraWorld *world, uint64_t body, int32_t dominance);

// Makes a body a bullet, which never crosses dynamic bodies either (1), or one no more (0).
UmbraStatus umbra_world_set_bullet(struct UmbraWorld *world, uint64_t body, uint32_t is_bullet);

// Changes the groups a body is in.
UmbraStatus umbra_world_set_force_groups(struct UmbraWorld *world, uint64_t body, uint32_t force_groups);

// Changes the caller's name for a body.
UmbraStatus umbra_world_set_key(struct UmbraWorld *world, uint64_t body, uint64_t key);

// Changes the caller's data of a body.
UmbraStatus umbra_world_set_user_data(struct UmbraWorld *world, uint64_t body, uint64_t user_data);

// Locks components of a body's velocity, which are zero from now on, and frees the others.
UmbraStatus umbra_world_set_locks(struct UmbraWorld *world, uint64_t body, UmbraLocks locks);

// Gives a dynamic body largest speeds after a step, from 0, or takes them from it with `UMBRA_NO_LIMIT`.
UmbraStatus umbra_world_set_max_speeds(struct UmbraWorld *world, uint64_t body, UmbraFx linear, UmbraFx angular);

// Takes a body out of the simulation as it is, until it is enabled.
UmbraStatus umbra_world_disable(struct UmbraWorld *world, uint64_t body);

// Takes a disabled body back into the simulation, as it was.
UmbraStatus umbra_world_enable(struct UmbraWorld *world, uint64_t body);

// Moves a kinematic body to a place and an angle over the next step.
UmbraStatus umbra_world_move_to(struct UmbraWorld *world, uint64_t body, UmbraFx x, UmbraFx y, UmbraFx angle);

// Wakes a body and what springs join it to.
UmbraStatus umbra_world_wake(struct UmbraWorld *world, uint64_t body);

// Puts a body to sleep, with the bodies that springs, joints and the contacts of the last step join it to. They stop.
UmbraStatus umbra_world_sleep(struct UmbraWorld *world, uint64_t body);

// Lets a quarantined body take part again.
UmbraStatus umbra_world_release(struct UmbraWorld *world, uint64_t body);

// Fills in a definition: around the body's centre of mass, touching all others, without a shape.
UmbraStatus umbra_collider_def_default(struct UmbraColliderDef *def);

// Adds a collider to a body; wakes the body. A body with `UMBRA_MASS_FROM_COLLIDERS` gets their mass.
UmbraStatus umbra_world_add_collider(struct UmbraWorld *world,
                                     uint64_t body,
                                     const struct UmbraColliderDef *def,
                                     uint64_t *collider);

// Puts another definition in the place of a collider's; wakes its body. Its contacts and overlaps end, and begin anew in the next step.
UmbraStatus umbra_world_set_collider(struct UmbraWorld *world,
                                     uint64_t collider,
                                     const struct UmbraColliderDef *def);

// Removes a collider; wakes its body.
UmbraStatus umbra_world_remove_collider(struct UmbraWorld *world, uint64_t collider);

// Reads a collider, with null for its shape: `umbra_world_collider_shape`.
UmbraStatus umbra_world_collider(const struct UmbraWorld *world, uint64_t collider, struct UmbraColliderDef *def);

// The shape of a collider, which is the caller's as one that was made.
UmbraStatus umbra_world_collider_shape(const struct UmbraWorld *world, uint64_t collider, struct UmbraShape **shape);

// The body that a collider belongs to.
UmbraStatus umbra_world_collider_body(const struct UmbraWorld *world, uint64_t collider, uint64_t *body);

// The handles of the colliders of a body, in the order of their slots; a list as `umbra_world_outcomes` gives it.
UmbraStatus umbra_world_body_colliders(const struct UmbraWorld *world,
                                       uint64_t body,
                                       uint64_t *colliders,
                                       size_t capacity,
                                       size_t *count);

// Fills in the settings of contacts that suit bodies of 0.1 m to 10 m at 60 steps a second.
UmbraStatus umbra_contact_settings_default(struct UmbraContactSettings *settings);

// Changes the settings of contacts; wakes all bodies.
UmbraStatus umbra_world_set_contact_settings(struct UmbraWorld *world, const struct UmbraContactSettings *settings);

// Gives coefficients to the contacts of two materials, by their `material_id`, in either order.
UmbraStatus umbra_world_set_material_pair(struct UmbraWorld *world,
                                          uint32_t first,
                                          uint32_t second,
                                          const struct UmbraMaterialPair *pair);

// Takes back what `umbra_world_set_material_pair` gave to two materials, if anything.
UmbraStatus umbra_world_remove_material_pair(struct UmbraWorld *world, uint32_t first, uint32_t second);

// The settings of contacts of a world.
UmbraStatus umbra_world_contact_settings(const struct UmbraWorld *world, struct UmbraContactSettings *settings);

// Excludes two bodies from contacts with each other, or gives a pair that is excluded another exclusion; wakes both.
UmbraStatus umbra_world_exclude_pair(struct UmbraWorld *world, uint64_t a, uint64_t b, UmbraExclusion exclusion);

// Allows contacts between two bodies again; wakes both.
UmbraStatus umbra_world_allow_pair(struct UmbraWorld *world, uint64_t a, uint64_t b);

// The pairs of bodies that are excluded from contacts, by their slots; a list as `umbra_world_outcomes` gives it.
UmbraStatus umbra_world_excluded_pairs(const struct UmbraWorld *world,
                                       struct UmbraExcludedPair *pairs,
                                       size_t capacity,
                                       size_t *count);

// The contacts of one body among those of `umbra_world_contacts`; a list as `umbra_world_outcomes` gives it.
UmbraStatus umbra_world_body_contacts(const struct UmbraWorld *world,
                                      uint64_t body,
                                      struct UmbraContact *contacts,
                                      size_t capacity,
                                      size_t *count);

// The contacts that carried an impulse at the end of the last step, by the slots of their colliders; a list as
// `umbra_world_outcomes` gives it. Each call computes their points.
UmbraStatus umbra_world_contacts(const struct UmbraWorld *world,
                                 struct UmbraContact *contacts,
                                 size_t capacity,
                                 size_t *count);

// The contacts of colliders with `contact_events` that ended in the last step or by a call before it, sorted by the keys of bodies and
// colliders; a list as `umbra_world_outcomes` gives it.
UmbraStatus umbra_world_contacts_ended(const struct UmbraWorld *world,
                                       struct UmbraColliderPair *pairs,
                                       size_t capacity,
                                       size_t *count);

// The contacts of colliders with `contact_events` that began in the last step, sorted likewise; a list as `umbra_world_outcomes` gives
// it.
UmbraStatus umbra_world_contacts_began(const struct UmbraWorld *world,
                                       struct UmbraColliderPair *pairs,
                                       size_t capacity,
                                       size_t *count);

// The colliders that left a sensor in the last step or by a call before it, each behind the sensor, sorted likewise; a list as
// `umbra_world_outcomes` gives it.
UmbraStatus umbra_world_sensors_left(const struct UmbraWorld *world,
                                     struct UmbraColliderPair *pairs,
                                     size_t capacity,
                                     size_t *count);

// The colliders that entered a sensor in the last step, each behind the sensor, sorted likewise; a list as `umbra_world_outcomes`
// gives it.
UmbraStatus umbra_world_sensors_entered(const struct UmbraWorld *world,
                                        struct UmbraColliderPair *pairs,
                                        size_t capacity,
                                        size_t *count);

// The colliders that overlapped sensors at the end of the last step, each behind the sensor, by the slots of the sensors; a list as
// `umbra_world_outcomes` gives it.
UmbraStatus umbra_world_sensor_overlaps(const struct UmbraWorld *world,
                                        struct UmbraColliderPair *pairs,
                                        size_t capacity,
                                        size_t *count);

// The hits of colliders with `hit_events` in the last step, sorted by the keys of bodies and colliders, then by parts; a list as
// `umbra_world_outcomes` gives it.
UmbraStatus umbra_world_contact_hits(const struct UmbraWorld *world,
                                     struct UmbraContactHit *hits,
                                     size_t capacity,
                                     size_t *count);

// Fills in the definition of a field of a kind: all groups, no body, everything else 0.
UmbraStatus umbra_field_def_default(UmbraFieldKind kind, struct UmbraFieldDef *def);

// Adds a force field; wakes what it may act on.
UmbraStatus umbra_world_add_field(struct UmbraWorld *world, const struct UmbraFieldDef *def, uint64_t *field);

// Puts another force field in the place of one; wakes what either may act on.
UmbraStatus umbra_world_set_field(struct UmbraWorld *world, uint64_t field, const struct UmbraFieldDef *def);

// Removes a force field; wakes what it may have acted on.
UmbraStatus umbra_world_remove_field(struct UmbraWorld *world, uint64_t field);

// Reads a force field.
UmbraStatus umbra_world_field(const struct UmbraWorld *world, uint64_t field, struct UmbraFieldDef *def);

// The handles of all force fields, in the order in which they were added, in which drags act; a list as
// `umbra_world_outcomes` gives it.
UmbraStatus umbra_world_fields(const struct UmbraWorld *world, uint64_t *fields, size_t capacity, size_t *count);

// Applies a force, N, over the next step, at a point, or through the centre of mass for null.
UmbraStatus umbra_world_apply_force(struct UmbraWorld *world,
                                    uint64_t body,
                                    UmbraFx x,
                                    UmbraFx y,
                                    const struct UmbraVec2 *point,
                                    UmbraApplyFlags options);

// Applies a torque, N·m, over the next step.
UmbraStatus umbra_world_apply_torque(struct UmbraWorld *world, uint64_t body, UmbraFx torque, UmbraApplyFlags options);

// Changes the velocity by an impulse, N·s, at once, at a point, or through the centre of mass for null.
UmbraStatus umbra_world_apply_impulse(struct UmbraWorld *world,
                                      uint64_t body,
                                      UmbraFx x,
                                      UmbraFx y,
                                      const struct UmbraVec2 *point,
                                      UmbraApplyFlags options);

// Changes the angular velocity by an angular impulse, N·m·s, at once.
UmbraStatus umbra_world_apply_angular_impulse(struct UmbraWorld *world,
                                              uint64_t body,
                                              UmbraFx impulse,
                                              UmbraApplyFlags options);

// Takes back the forces and torques applied since the last step.
UmbraStatus umbra_world_clear_forces(struct UmbraWorld *world);

// The impulse of an explosion on a shape at a position, m, and an angle, rad: N·s, by the law for bodies. A game divides it by the mass of
// a character and adds it to its velocity. The mask does not matter.
UmbraStatus umbra_explosion_impulse_on(const struct UmbraExplosion *explosion,
                                       const struct UmbraShape *shape,
                                       UmbraFx x,
                                       UmbraFx y,
                                       UmbraFx angle,
                                       struct UmbraVec2 *impulse);

// Sets off an explosion, which wakes the bodies that it hits.
UmbraStatus umbra_world_explode(struct UmbraWorld *world, const struct UmbraExplosion *explosion);

// Fills in the definition of a joint of a kind, with both ends at the origin of the world: set its bodies and points.
UmbraStatus umbra_joint_def_default(UmbraJointKind kind, struct UmbraJointDef *def);

// Fills in the definition of a revolute joint of two bodies at a point of the world, m; `UMBRA_NO_HANDLE` is the world. The angle of the
// joint is 0 as the bodies stand.
UmbraStatus umbra_joint_def_revolute(const struct UmbraWorld *world,
                                     uint64_t first,
                                     uint64_t second,
                                     UmbraFx x,
                                     UmbraFx y,
                                     struct UmbraJointDef *def);

// Fills in the definition of a weld of two bodies as they stand, at a point of the world, m; `UMBRA_NO_HANDLE` is the world.
UmbraStatus umbra_joint_def_weld(const struct UmbraWorld *world,
                                 uint64_t first,
                                 uint64_t second,
                                 UmbraFx x,
                                 UmbraFx y,
                                 struct UmbraJointDef *def);

// Fills in the definition of a prismatic joint of two bodies at a point of the world, m, along an axis in the world, which turns with the first
// body; `UMBRA_NO_HANDLE` is the world. The way and the angle of the joint are 0 as the bodies stand.
UmbraStatus umbra_joint_def_prismatic(const struct UmbraWorld *world,
                                      uint64_t first,
                                      uint64_t second,
                                      UmbraFx x,
                                      UmbraFx y,
                                      UmbraFx axis_x,
                                      UmbraFx axis_y,
                                      struct UmbraJointDef *def);

// Fills in the definition of a wheel joint of a car and a wheel at its hub, a point of the world, m, along the axis of the suspension in the
// world, which turns with the car. The way of the joint is 0 as the bodies stand.
UmbraStatus umbra_joint_def_wheel(const struct UmbraWorld *world,
                                  uint64_t car,
                                  uint64_t wheel,
                                  UmbraFx x,
                                  UmbraFx y,
                                  UmbraFx axis_x,
                                  UmbraFx axis_y,
                                  struct UmbraJointDef *def);

// Fills in the definition of a motor joint of two bodies at a point of the world, m; `UMBRA_NO_HANDLE` is the world. It does nothing until its
// planar spring or motor, its spring or its motor is set. The point of the planar spring at rest is counted from the first end.
UmbraStatus umbra_joint_def_motor(const struct UmbraWorld *world,
                                  uint64_t first,
                                  uint64_t second,
                                  UmbraFx x,
                                  UmbraFx y,
                                  struct UmbraJointDef *def);

// Fills in the definition of two gears with these numbers of teeth, 1 to 1,024 or negative, whose teeth fit as the bodies stand.
UmbraStatus umbra_joint_def_gear(const struct UmbraWorld *world,
                                 uint64_t first,
                                 uint64_t second,
                                 int32_t first_teeth,
                                 int32_t second_teeth,
                                 struct UmbraJointDef *def);

// Fills in the definition of a rope from a point of one body over two points of the world to a point of another body, all given where they are in the
// world, m, with one strand on each side: set `strands` and `upper`, the length of the rope, for more. It is as long as the points are apart.
UmbraStatus umbra_joint_def_pulley(const struct UmbraWorld *world,
                                   uint64_t first,
                                   UmbraFx first_x,
                                   UmbraFx first_y,
                                   UmbraFx first_ground_x,
                                   UmbraFx first_ground_y,
                                   uint64_t second,
                                   UmbraFx second_x,
                                   UmbraFx second_y,
                                   UmbraFx second_ground_x,
                                   UmbraFx second_ground_y,
                                   struct UmbraJointDef *def);

// Fills in the definition of a rigid rod between points of two bodies, given where they are in the world, m; `UMBRA_NO_HANDLE` is the world.
// It is as long as the points are apart.
UmbraStatus umbra_joint_def_distance(const struct UmbraWorld *world,
                                     uint64_t first,
                                     UmbraFx from_x,
                                     UmbraFx from_y,
                                     uint64_t second,
                                     UmbraFx to_x,
                                     UmbraFx to_y,
                                     struct UmbraJointDef *def);

// Gives the definition of a joint a spring with a stiffness, N/m or N·m/rad, and a damper, N·s/m or N·m·s/rad, both from 0: sets `has_spring`,
// `spring_hertz` and `spring_damping_ratio` for the effective mass that the spring meets as the bodies stand. Of a motor joint it is the planar spring,
// `has_planar_spring`, `planar_spring_hertz` and `planar_spring_damping_ratio`.
UmbraStatus umbra_joint_def_set_stiffness(const struct UmbraWorld *world,
                                          struct UmbraJointDef *def,
                                          UmbraFx stiffness,
                                          UmbraFx damping);

// Adds a joint; wakes its bodies, and ends contacts between them unless they are to touch each other.
UmbraStatus umbra_world_add_joint(struct UmbraWorld *world, const struct UmbraJointDef *def, uint64_t *joint);

// Removes a joint; wakes its bodies.
UmbraStatus umbra_world_remove_joint(struct UmbraWorld *world, uint64_t joint);

// Sets the kind of a joint and the values that the kind reads in `def`; wakes its bodies. The ends and the rest of the joint stay.
UmbraStatus umbra_world_set_joint_kind(struct UmbraWorld *world,
                                       uint64_t joint,
                                       const struct UmbraJointDef *def);

// Sets the motor of a joint: its speed, rad/s or m/s, and its largest torque, N·m, or force, N, or `UMBRA_NO_LIMIT` for no motor; wakes its
// bodies.
UmbraStatus umbra_world_set_joint_motor(struct UmbraWorld *world,
                                        uint64_t joint,
                                        UmbraFx speed,
                                        UmbraFx max_force);

// Sets the mean force over a step above which a joint breaks, N, or `UMBRA_NO_LIMIT` for never; wakes its bodies.
UmbraStatus umbra_world_set_joint_break(struct UmbraWorld *world, uint64_t joint, UmbraFx force);

// Sets the mean torque over a step above which a joint breaks, N·m, or `UMBRA_NO_LIMIT` for never; wakes its bodies.
UmbraStatus umbra_world_set_joint_break_torque(struct UmbraWorld *world, uint64_t joint, UmbraFx torque);

// Enables a joint, or with 0 disables it; wakes its bodies. Either repairs a broken joint.
UmbraStatus umbra_world_enable_joint(struct UmbraWorld *world, uint64_t joint, uint32_t is_enabled);

// Reads the definition of a joint.
UmbraStatus umbra_world_joint(const struct UmbraWorld *world, uint64_t joint, struct UmbraJointDef *def);

// Reads where a joint is, its angle, its force and torque in the last step, and whether it is broken.
UmbraStatus umbra_world_joint_state(const struct UmbraWorld *world, uint64_t joint, struct UmbraJointState *state);

// The handles of all joints, sorted by their keys, then by themselves; a list as `umbra_world_outcomes` gives it.
UmbraStatus umbra_world_joints(const struct UmbraWorld *world, uint64_t *joints, size_t capacity, size_t *count);

// The first joint by handle that has a key; `UMBRA_ERROR_NO_SUCH_JOINT` if none has. It looks through all of them.
UmbraStatus umbra_world_joint_with_key(const struct UmbraWorld *world, uint64_t key, uint64_t *joint);

// All joints that have a key, sorted by their handles; a list as `umbra_world_outcomes` gives it.
UmbraStatus umbra_world_joints_with_key(const struct UmbraWorld *world,
                                        uint64_t key,
                                        uint64_t *joints,
                                        size_t capacity,
                                        size_t *count);

// The mean loads over the last step of the joints with `events` that may break, sorted by their keys, then by their handles; a list as
// `umbra_world_outcomes` gives it. For a joint that must never break set `break_force` to `INT64_MAX`.
UmbraStatus umbra_world_joint_loads(const struct UmbraWorld *world,
                                    struct UmbraJointLoad *loads,
                                    size_t capacity,
                                    size_t *count);

// The joints with `events` that broke in the last step, sorted by their keys, then by their handles; a list as `umbra_world_outcomes`
// gives it.
UmbraStatus umbra_world_joints_broke(const struct UmbraWorld *world,
                                     struct UmbraJointBroke *broke,
                                     size_t capacity,
                                     size_t *count);

// Fills in a filter that lets all colliders through.
UmbraStatus umbra_query_filter_default(struct UmbraQueryFilter *filter);

// The first collider on each of `length` rays: of several at the same fraction that with the least key, then handle. If one ray
// is invalid, nothing is written.
UmbraStatus umbra_world_cast_rays(const struct UmbraWorld *world,
                                  const struct UmbraRay *rays,
                                  struct UmbraCastHit *hits,
                                  size_t length,
                                  const struct UmbraQueryFilter *filter);

// 1 if a ray meets any collider, 0 if it meets none.
UmbraStatus umbra_world_cast_ray_any(const struct UmbraWorld *world,
                                     const struct UmbraRay *ray,
                                     const struct UmbraQueryFilter *filter,
                                     uint32_t *is_hit);

// All colliders on a ray, sorted by fraction, then key, then handle; with 1 for `ties` only those that tie for the first place. A list
// as `umbra_world_outcomes` gives it.
UmbraStatus umbra_world_cast_ray_all(const struct UmbraWorld *world,
                                     const struct UmbraRay *ray,
                                     uint32_t ties,
                                     const struct UmbraQueryFilter *filter,
                                     struct UmbraCastHit *hits,
                                     size_t capacity,
                                     size_t *count);

// All colliders that a shape meets on its way over a translation, without turning, sorted as those on a ray; with 1 for `ties` only those
// that tie for the first place. A shape that touches a collider meets it if its way leads into it, not if it slides along it or leaves it. A list as `umbra_world_outcomes` gives it.
UmbraStatus umbra_world_cast_shape(const struct UmbraWorld *world,
                                   const struct UmbraShape *shape,
                                   UmbraFx x,
                                   UmbraFx y,
                                   UmbraFx angle,
                                   UmbraFx translation_x,
                                   UmbraFx translation_y,
                                   uint32_t ties,
                                   const struct UmbraQueryFilter *filter,
                                   struct UmbraCastHit *hits,
                                   size_t capacity,
                                   size_t *count);

// The colliders that overlap a shape or touch it, sorted by key, then by handle; a list as `umbra_world_outcomes` gives it.
UmbraStatus umbra_world_overlap_shape(const struct UmbraWorld *world,
                                      const struct UmbraShape *shape,
                                      UmbraFx x,
                                      UmbraFx y,
                                      UmbraFx angle,
                                      const struct UmbraQueryFilter *filter,
                                      uint64_t *colliders,
                                      size_t capacity,
                                      size_t *count);

// The colliders that overlap a box between two corners or touch it, sorted by key, then by handle: with one point for both those at the
// point. A list as `umbra_world_outcomes` gives it.
UmbraStatus umbra_world_overlap_box(const struct UmbraWorld *world,
                                    UmbraFx min_x,
                                    UmbraFx min_y,
                                    UmbraFx max_x,
                                    UmbraFx max_y,
                                    const struct UmbraQueryFilter *filter,
                                    uint64_t *colliders,
                                    size_t capacity,
                                    size_t *count);

// The collider nearest to a point, up to a distance from 0 to 2^20 m: of several at the same distance that with the least key, then
// handle.
UmbraStatus umbra_world_closest_point(const struct UmbraWorld *world,
                                      UmbraFx x,
                                      UmbraFx y,
                                      UmbraFx most,
                                      const struct UmbraQueryFilter *filter,
                                      struct UmbraClosestPoint *closest);

// All colliders up to a distance from 0 to 2^20 m from a point, each with its nearest point, sorted by distance, then key, then handle; a
// list as `umbra_world_outcomes` gives it.
UmbraStatus umbra_world_closest_points(const struct UmbraWorld *world,
                                       UmbraFx x,
                                       UmbraFx y,
                                       UmbraFx most,
                                       const struct UmbraQueryFilter *filter,
                                       struct UmbraClosestPoint *points,
                                       size_t capacity,
                                       size_t *count);

// 1 if a point, relative to the centre of mass of a shape, is in it or on its surface, else 0.
UmbraStatus umbra_shape_contains(const struct UmbraShape *shape, UmbraFx x, UmbraFx y, uint32_t *is_inside);

// The point of a shape that is nearest to a point, both relative to its centre of mass, and their distance; without a collider and a body.
UmbraStatus umbra_shape_closest_point(const struct UmbraShape *shape,
                                      UmbraFx x,
                                      UmbraFx y,
                                      struct UmbraClosestPoint *closest);

// The first point of a shape on a ray, relative to its centre of mass; without a collider and a body.
UmbraStatus umbra_shape_cast_ray(const struct UmbraShape *shape, const struct UmbraRay *ray, struct UmbraCastHit *hit);

// The distance of two shapes, each at a position of its centre of mass, m, and an angle, rad, or the depth in which they overlap. Of shapes with
// several parts it is the pair that are nearest to each other, or that overlap deepest.
UmbraStatus umbra_shape_distance_to(const struct UmbraShape *shape,
                                    UmbraFx x,
                                    UmbraFx y,
                                    UmbraFx angle,
                                    const struct UmbraShape *second,
                                    UmbraFx second_x,
                                    UmbraFx second_y,
                                    UmbraFx second_angle,
                                    struct UmbraShapeDistance *distance);

// The moment at which two shapes meet on their ways. It is conservative: they are still apart then, by at most 2^-26 m and 2^-26 of their sizes.
// Shapes that touch at the start meet where they come to overlap by 2^-20 m, so that they may leave, slide and roll.
UmbraStatus umbra_shape_time_of_impact(const struct UmbraShape *shape,
                                       const struct UmbraSweep *sweep,
                                       const struct UmbraShape *second,
                                       const struct UmbraSweep *second_sweep,
                                       struct UmbraShapeImpact *impact);

// Fills in a character without a shape.
UmbraStatus umbra_character_def_default(struct UmbraCharacterDef *def);

// Moves a character: it rides with its ground, is pushed out of what came into its skin, goes the translation, slides along what it meets,
// climbs a step, and is moved down to the ground. Nothing of the world changes. Leave out its own body by the filter.
UmbraStatus umbra_character_move(const struct UmbraWorld *world,
                                 const struct UmbraCharacterDef *character,
                                 const struct UmbraCharacterMove *way,
                                 const struct UmbraQueryFilter *filter,
                                 struct UmbraMovement **movement);

// The result of a movement.
UmbraStatus umbra_movement_state(const struct UmbraMovement *movement, struct UmbraMovementState *state);

// The colliders that a character moved against, in the order in which it met them; a list as `umbra_world_outcomes` gives it.
UmbraStatus umbra_movement_hits(const struct UmbraMovement *movement,
                                struct UmbraCharacterHit *hits,
                                size_t capacity,
                                size_t *count);

// The impulses on the bodies that a character met, at most one a body; none without a `push_mass`. A list as `umbra_world_outcomes` gives
// it.
UmbraStatus umbra_movement_pushes(const struct UmbraMovement *movement,
                                  struct UmbraCharacterPush *pushes,
                                  size_t capacity,
                                  size_t *count);

// Frees a movement. Null is ignored.
void umbra_movement_free(struct UmbraMovement *movement);

// Carries out a command that comes as bytes (`docs/formats.md`). `created` may be null.
UmbraStatus umbra_world_execute(struct UmbraWorld *world,
                                const uint8_t *command,
                                size_t length,
                                struct UmbraCreated *created);

// Checks whether `umbra_world_execute` would carry a command out now: gives the same answer and changes nothing.
UmbraStatus umbra_world_check(const struct UmbraWorld *world, const uint8_t *command, size_t length);

// A draft: all that would change it is written down as a command instead, so that each function that changes a world also
// makes the bytes to send. It is empty, is not stepped, and what adds to it gives `UMBRA_NO_HANDLE`.
UmbraStatus umbra_draft_new(struct UmbraWorld **draft);

// The bytes of the last command that was written down in a draft; a list as `umbra_world_outcomes` gives it. None before the
// first.
UmbraStatus umbra_draft_command(const struct UmbraWorld *draft,
                                uint8_t *command,
                                size_t capacity,
                                size_t *length);

// Changes the length of a step to num/den seconds, from 1 to 10,000 steps a second; wakes all bodies.
UmbraStatus umbra_world_set_time_step(struct UmbraWorld *world, uint32_t num, uint32_t den);

// Changes gravity, m/s², within ±2^16; wakes all bodies.
UmbraStatus umbra_world_set_gravity(struct UmbraWorld *world, UmbraFx x, UmbraFx y);

// Changes the integrator; wakes all bodies.
UmbraStatus umbra_world_set_integrator(struct UmbraWorld *world, UmbraIntegrator integrator);

// Changes the damping of bodies without their own: the share of each velocity that is left after a second, 0 to 1, or what
// `umbra_kept_at_rate` returns. Wakes all bodies.
UmbraStatus umbra_world_set_kept_per_second(struct UmbraWorld *world,
                                            UmbraFx linear,
                                            UmbraFx angular);

// Returns the damping with a rate c, in 1/s, for the fields and calls named `kept_per_second`. Up to 4/s that is the share of a
// velocity that is left after a second, e^-c, within 0.5001 · 2^-32. Above 4/s, where such a share has few digits left, it is -c. The
// rate is what Box2D calls damping; 0 is none. A negative rate gives a share above 1, which is refused by what it is given to.
UmbraFx umbra_kept_at_rate(UmbraFx rate);

// Changes after how many ticks at rest a body falls asleep, or `UMBRA_NEVER`; wakes all bodies.
UmbraStatus umbra_world_set_sleep_after(struct UmbraWorld *world, uint32_t ticks);

// Seeds the world's generator of random numbers, xoshiro256**.
UmbraStatus umbra_world_seed(struct UmbraWorld *world, uint64_t seed);

// Draws a number from 0 to below `end`, all alike, from the world's generator: a change of its state, which peers make in the
// same tick and order.
UmbraStatus umbra_world_random_below(struct UmbraWorld *world,
                                     uint64_t end,
                                     uint64_t *number);

// Draws 64 bits from the world's generator.
UmbraStatus umbra_world_random_bits(struct UmbraWorld *world, uint64_t *bits);

// Puts other bytes in the place of the game's own data, at most 2^24: whatever else its next tick depends on. Snapshots, hashes
// and replays take it along.
UmbraStatus umbra_world_set_blob(struct UmbraWorld *world,
                                 const uint8_t *bytes,
                                 size_t length);

// The game's own data; a list as `umbra_world_outcomes` gives it.
UmbraStatus umbra_world_blob(const struct UmbraWorld *world, uint8_t *bytes, size_t capacity, size_t *length);

// The forces and torques that were applied over the last step of a world: to be kept, one a tick, by a program that will undo more than
// the last step.
UmbraStatus umbra_world_applied_forces(const struct UmbraWorld *world,
                                       struct UmbraAppliedForces **applied);

// Undoes the last step: the world is what it was before, to the bit, with the forces of that tick applied again. `applied` are the forces
// of that step; null takes those of the last report, which this call empties, so that it is good for one step. Undo calls between two
// steps yourself, the last one first, before you undo the step before them.
//
// Steps with sleep (`UMBRA_NEVER` turns it off), damping, contacts, joints that pulled, or impulses have no inverse, among others:
// `UMBRA_ERROR_NOT_REVERSIBLE`, and `umbra_last_cause` has the reason, 131 to 146. A world that is recorded is not set back.
UmbraStatus umbra_world_step_back(struct UmbraWorld *world,
                                  const struct UmbraAppliedForces *applied);

// Frees the forces of a step. Null is ignored.
void umbra_applied_forces_free(struct UmbraAppliedForces *applied);

// The world as it is, to go back to.
UmbraStatus umbra_world_snapshot(const struct UmbraWorld *world, struct UmbraSnapshot **snapshot);

// Takes a snapshot in the memory of another one, as a ring of them for rollback does each tick.
UmbraStatus umbra_world_snapshot_into(const struct UmbraWorld *world, struct UmbraSnapshot *snapshot);

// Goes back to a snapshot, of this world or another. Handles made after it may come to name other bodies; what became of the
// inputs of the last step is forgotten.
UmbraStatus umbra_world_restore(struct UmbraWorld *world,
                                const struct UmbraSnapshot *snapshot);

// A world that goes on from a snapshot.
UmbraStatus umbra_snapshot_world(const struct UmbraSnapshot *snapshot, struct UmbraWorld **world);

// A snapshot as bytes, the same on every machine (`docs/formats.md`).
UmbraStatus umbra_snapshot_to_bytes(const struct UmbraSnapshot *snapshot, struct UmbraBytes **bytes);

// The snapshot that is these bytes, which may come from anybody: what no world can be is refused. Reading takes at most 16
// times their memory, and 64 KiB.
UmbraStatus umbra_snapshot_from_bytes(const uint8_t *bytes,
                                      size_t length,
                                      struct UmbraSnapshot **snapshot);

// Frees a snapshot. Null is ignored.
void umbra_snapshot_free(struct UmbraSnapshot *snapshot);

// Begins to record a world as it is: all calls that change it from now on, the inputs of its ticks, a hash after every
// `hash_every` ticks (0 is taken as 1), a snapshot after every `snapshot_every`, or 0 for none on the way. The recording is kept
// in memory, which grows until it is taken (`umbra_world_take_record`).
UmbraStatus umbra_world_record(struct UmbraWorld *world,
                               uint32_t hash_every,
                               uint32_t snapshot_every);

// Takes the finished part of the recording, to be written away; each byte is handed out once. The bytes of
// `umbra_world_end_record` go after it.
UmbraStatus umbra_world_take_record(struct UmbraWorld *world, struct UmbraBytes **bytes);

// Ends the recording with the last step, and gives the rest of the file: all of it if nothing was taken before. A scene's names are kept.
UmbraStatus umbra_world_end_record(struct UmbraWorld *world,
                                   struct UmbraBytes **bytes);

// Runs a replay again and compares every hash: `UMBRA_OK`, `UMBRA_ERROR_DIVERGENCE`, or why the bytes, which may come from
// anybody, are no replay that can be played, or ask for more than `limits` allow. `ticks`, which may be null, receives the
// number of ticks, also if the run diverges or a limit is exceeded.
UmbraStatus umbra_replay_verify(const uint8_t *bytes,
                                size_t length,
                                const struct UmbraReplayLimits *limits,
                                uint64_t *ticks);

// The world that a replay starts with: a server compares its `umbra_world_state_hash` with the hash of the level that was to be played,
// as anybody can record a run of another level.
UmbraStatus umbra_replay_start(const uint8_t *bytes,
                               size_t length,
                               struct UmbraWorld **world);

// Verifies a replay as `umbra_replay_verify` does, and gives the world at its end, with its blob: to read the score, and who won.
UmbraStatus umbra_replay_end(const uint8_t *bytes,
                             size_t length,
                             const struct UmbraReplayLimits *limits,
                             struct UmbraWorld **world);

// A world that a replay runs, at its start. `umbra_world_step` plays a tick and compares its hash with the recorded one:
// `UMBRA_ERROR_DIVERGENCE` if they differ, and the world is at its tick and can go on; `UMBRA_ERROR_END` at the end, and nothing is done.
// `umbra_world_outcomes`, events, poses and names are those of the run; the replay alone changes the world, until
// `umbra_world_leave_scene`. A replay of a stranger may ask for much work: verify it first (`umbra_replay_verify`).
UmbraStatus umbra_world_from_replay(const uint8_t *bytes,
                                    size_t length,
                                    struct UmbraWorld **world);

// Goes to a tick of the replay that runs a world, from the nearest snapshot before it, without comparing: to its end or its start if the
// tick is beyond. There are no outcomes then.
UmbraStatus umbra_world_seek(struct UmbraWorld *world,
                             uint64_t tick);

// The ticks at the start and at the end of the replay that runs a world.
UmbraStatus umbra_world_replay_ticks(const struct UmbraWorld *world, uint64_t *start, uint64_t *end);

// Fills in options: bodies, force fields and joints, measured from the origin of the world.
UmbraStatus umbra_draw_options_default(struct UmbraDrawOptions *options);

// A drawing without figures, for `umbra_world_draw`.
UmbraStatus umbra_drawing_new(struct UmbraDrawing **drawing);

// Draws a world at its tick, in place of what a drawing had, in its memory. Figures come in the order of the fields, the bodies, the joints,
// the velocities and the contacts. Nothing of the world changes.
UmbraStatus umbra_world_draw(const struct UmbraWorld *world,
                             const struct UmbraDrawOptions *options,
                             struct UmbraDrawing *drawing);

// The figures of a drawing; a list as `umbra_world_outcomes` gives it.
UmbraStatus umbra_drawing_figures(const struct UmbraDrawing *drawing,
                                  struct UmbraFigure *figures,
                                  size_t capacity,
                                  size_t *count);

// The points of the figures of a drawing, m from the origin of its options: x and y of one after the other, in singles. A list as
// `umbra_world_outcomes` gives it, with two entries to a point. For a renderer alone: a float that goes back into a world is a desync to come.
UmbraStatus umbra_drawing_points(const struct UmbraDrawing *drawing,
                                 float *coordinates,
                                 size_t capacity,
                                 size_t *count);

// Frees a drawing. Null is ignored.
void umbra_drawing_free(struct UmbraDrawing *drawing);

// The kinetic energy of the dynamic bodies, multiples of 2^-64 J.
UmbraStatus umbra_world_kinetic_energy(const struct UmbraWorld *world, struct UmbraInt128 *energy);

// The potential energy of the dynamic bodies in gravity, attractors, springs and springs of joints, multiples of 2^-64 J.
UmbraStatus umbra_world_potential_energy(const struct UmbraWorld *world,
                                         struct UmbraInt128 *energy);

// Kinetic and potential energy together, multiples of 2^-64 J.
UmbraStatus umbra_world_energy(const struct UmbraWorld *world, struct UmbraInt128 *energy);

// The momentum of the dynamic bodies, multiples of 2^-64 kg·m/s; exact for the velocities that `umbra_world_body` gives.
UmbraStatus umbra_world_momentum(const struct UmbraWorld *world,
                                 struct UmbraInt128 *x,
                                 struct UmbraInt128 *y);

// The angular momentum of the dynamic bodies about the origin, multiples of 2^-64 kg·m²/s.
UmbraStatus umbra_world_angular_momentum(const struct UmbraWorld *world, struct UmbraInt128 *momentum);

// A body's part of the kinetic energy, multiples of 2^-64 J: 0 unless it is dynamic and takes part.
UmbraStatus umbra_world_body_kinetic_energy(const struct UmbraWorld *world, uint64_t body, struct UmbraInt128 *energy);

// A body's part of the momentum, multiples of 2^-64 kg·m/s: 0 unless it is dynamic and takes part.
UmbraStatus umbra_world_body_momentum(const struct UmbraWorld *world,
                                      uint64_t body,
                                      struct UmbraInt128 *x,
                                      struct UmbraInt128 *y);

// A body's part of the angular momentum about the origin, multiples of 2^-64 kg·m²/s: 0 unless it is dynamic and takes part.
UmbraStatus umbra_world_body_angular_momentum(const struct UmbraWorld *world,
                                              uint64_t body,
                                              struct UmbraInt128 *momentum);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* UMBRA_PHYSICS_H */
