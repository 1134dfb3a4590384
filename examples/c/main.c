/*
 * A program in C99: builds a world and steps it, and compares its hash with that of the same world built in Rust; runs a scene;
 * draws it; goes back to a snapshot; records a run, verifies and plays it; sends a command; and is refused what cannot be.
 *
 *   main SCENE.json
 *
 * `capi/tests/golden.rs` has the world in Rust and writes golden.h.
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "golden.h"
#include "umbra_physics.h"

static int failures = 0;

/* What has to be so. */
static void check(int is_so, const char *what)
{
    if (!is_so) {
        printf("FAILED: %s\n", what);
        failures++;
    }
}

/* A call that has to be done. */
static void done(UmbraStatus status, const char *call)
{
    char message[512];
    if (status == UMBRA_OK)
        return;
    if (umbra_last_message(message, sizeof message, NULL) != UMBRA_OK)
        message[0] = '\0';
    printf("FAILED: %s: %s [E%" PRId32 "]\n", call, message, status);
    failures++;
}
#define DO(call) done((call), #call)

/* A call that has to be refused with this number. */
static void refused(UmbraStatus status, UmbraStatus expected, const char *call)
{
    char meaning[256];
    if (status != expected) {
        printf("FAILED: %s gave %" PRId32 ", not %" PRId32 "\n", call, status, expected);
        failures++;
        return;
    }
    DO(umbra_status_message(status, meaning, sizeof meaning, NULL));
    printf("  E%" PRId32 " %s\n", status, meaning);
}
#define REFUSED(call, expected) refused((call), (expected), #call)

static UmbraFx fx(const char *text)
{
    UmbraFx number = 0;
    DO(umbra_fx_from_text(text, strlen(text), &number));
    return number;
}

static uint64_t hash_of(const UmbraWorld *world)
{
    uint64_t hash = 0;
    DO(umbra_world_state_hash(world, &hash));
    return hash;
}

/* Ground, a ball that comes down on it, a plank on two springs in the wind, a moon about a star, and a rocket. */
static UmbraWorld *build(uint64_t *ball, uint64_t *rocket)
{
    UmbraWorldDef def;
    UmbraBodyDef body;
    UmbraColliderDef collider, ghost;
    UmbraFieldDef field;
    UmbraWorld *world = NULL;
    UmbraShape *shape = NULL;
    uint64_t ground = 0, plank = 0, star = 0, moon = 0, id = 0;
    const UmbraVec2 corners[4] = {{0, 0}, {200 * UMBRA_ONE, 0}, {200 * UMBRA_ONE, UMBRA_ONE}, {0, UMBRA_ONE}};
    const UmbraVec2 nose[3] = {{-UMBRA_ONE / 2, -UMBRA_ONE}, {UMBRA_ONE / 2, -UMBRA_ONE}, {0, UMBRA_ONE}};

    DO(umbra_world_def_default(&def));
    def.gravity.y = fx("-9.81");
    def.linear_kept_per_second = fx("0.9");
    DO(umbra_world_new(&def, &world));

    DO(umbra_shape_polygon(corners, 4, &shape));
    DO(umbra_body_def_default(&body));
    body.kind = UMBRA_STATIC;
    body.position.y = -6 * UMBRA_ONE;
    DO(umbra_world_add_body(world, &body, &ground));
    DO(umbra_collider_def_default(&collider));
    collider.shape = shape;
    DO(umbra_world_add_collider(world, ground, &collider, &id));
    umbra_shape_free(shape);

    DO(umbra_shape_circle(fx("0.5"), &shape));
    DO(umbra_body_def_default(&body));
    body.velocity.x = 3 * UMBRA_ONE;
    body.angular_kept_per_second = fx("0.5");
    body.angular_velocity = UMBRA_ONE;
    body.user_data = 7;
    DO(umbra_world_add_body(world, &body, ball));
    collider.shape = shape;
    collider.density = fx("2.5");
    DO(umbra_world_add_collider(world, *ball, &collider, &id));
    umbra_shape_free(shape);

    DO(umbra_shape_rectangle(4 * UMBRA_ONE, fx("0.25"), &shape));
    DO(umbra_body_def_default(&body));
    body.mass_kind = UMBRA_MASS_KILOGRAMS;
    body.mass = 2 * UMBRA_ONE;
    body.angle = fx("0.1");
    body.position.x = 20 * UMBRA_ONE;
    body.force_groups = 2;
    DO(umbra_world_add_body(world, &body, &plank));
    /* Nothing is to touch the plank. */
    DO(umbra_collider_def_default(&ghost));
    ghost.mask = 0;
    ghost.shape = shape;
    DO(umbra_world_add_collider(world, plank, &ghost, &id));
    umbra_shape_free(shape);

    DO(umbra_field_def_default(UMBRA_SPRING, &field));
    field.body = plank;
    field.point.x = 2 * UMBRA_ONE;
    field.other_point.x = 22 * UMBRA_ONE;
    field.other_point.y = 5 * UMBRA_ONE;
    field.rest = 4 * UMBRA_ONE;
    field.stiffness = 50 * UMBRA_ONE;
    DO(umbra_world_add_field(world, &field, &id));
    field.point.x = -2 * UMBRA_ONE;
    field.other_point.x = 18 * UMBRA_ONE;
    field.damping = UMBRA_ONE / 4;
    DO(umbra_world_add_field(world, &field, &id));
    DO(umbra_field_def_default(UMBRA_DRAG, &field));
    field.quadratic = fx("0.02");
    field.wind.x = 3 * UMBRA_ONE;
    field.force_groups = 2;
    DO(umbra_world_add_field(world, &field, &id));

    DO(umbra_body_def_default(&body));
    body.kind = UMBRA_KINEMATIC;
    body.position.y = 100 * UMBRA_ONE;
    body.velocity.x = UMBRA_ONE / 2;
    DO(umbra_world_add_body(world, &body, &star));
    DO(umbra_body_def_default(&body));
    body.position.x = 5 * UMBRA_ONE;
    body.position.y = 100 * UMBRA_ONE;
    body.velocity.y = 14 * UMBRA_ONE;
    body.gravity_scale = 0;
    body.linear_kept_per_second = UMBRA_ONE;
    body.force_groups = 4;
    DO(umbra_world_add_body(world, &body, &moon));
    DO(umbra_field_def_default(UMBRA_ATTRACTOR, &field));
    field.other = star;
    field.force_groups = 4;
    DO(umbra_factor_from_text("1e3", 3, &field.mu));
    DO(umbra_world_add_field(world, &field, &id));

    DO(umbra_shape_polygon(nose, 3, &shape));
    DO(umbra_body_def_default(&body));
    body.mass_kind = UMBRA_MASS_EXPLICIT;
    body.mass = 3 * UMBRA_ONE;
    body.inertia = 2 * UMBRA_ONE;
    body.position.x = -20 * UMBRA_ONE;
    DO(umbra_world_add_body(world, &body, rocket));
    ghost.shape = shape;
    DO(umbra_world_add_collider(world, *rocket, &ghost, &id));
    umbra_shape_free(shape);
    DO(umbra_field_def_default(UMBRA_THRUST, &field));
    field.body = *rocket;
    field.point.x = fx("0.01");
    field.point.y = -UMBRA_ONE;
    field.force.y = 40 * UMBRA_ONE;
    DO(umbra_world_add_field(world, &field, &id));
    DO(umbra_field_def_default(UMBRA_ZONE, &field));
    field.region = UMBRA_BOX;
    field.min.x = -30 * UMBRA_ONE;
    field.min.y = 5 * UMBRA_ONE;
    field.max.x = 0;
    field.max.y = 50 * UMBRA_ONE;
    field.acceleration.x = UMBRA_ONE;
    DO(umbra_world_add_field(world, &field, &id));
    return world;
}

/* What a player does in a tick. */
static void play(UmbraWorld *world, uint64_t ball, uint64_t rocket, int tick)
{
    const UmbraVec2 rim = {UMBRA_ONE / 2, 0};
    if (tick % 60 == 0)
        DO(umbra_world_apply_impulse(world, ball, 0, 20 * UMBRA_ONE, &rim, UMBRA_BODY_FRAME));
    if (tick % 90 < 30)
        DO(umbra_world_apply_torque(world, rocket, UMBRA_ONE / 8, 0));
    if (tick == 100)
        DO(umbra_world_apply_force(world, ball, 100 * UMBRA_ONE, 0, NULL, 0));
    if (tick == 200)
        DO(umbra_world_set_velocity(world, ball, 0, 5 * UMBRA_ONE));
}

/* Outlines for a renderer, measured from a camera above the rocket: all points lie in the room around it. */
static void drawn(const UmbraWorld *world, uint64_t rocket)
{
    enum { CAPACITY = 4096 };
    static float points[CAPACITY];
    static UmbraFigure figures[CAPACITY];
    UmbraDrawOptions options;
    UmbraDrawing *drawing = NULL;
    UmbraBodyState state;
    UmbraFx height = 0;
    size_t count = 0, figure_count = 0, i;
    int rockets = 0;

    DO(umbra_drawing_new(&drawing));
    DO(umbra_draw_options_default(&options));
    DO(umbra_world_body(world, rocket, &state));
    options.origin = state.position;
    DO(umbra_fx_add(state.position.y, 2 * UMBRA_ONE, &height));
    options.origin.y = height;
    DO(umbra_world_draw(world, &options, drawing));
    DO(umbra_drawing_points(drawing, points, CAPACITY, &count)); /* x, y of one corner after the other */
    DO(umbra_drawing_figures(drawing, figures, CAPACITY, &figure_count));
    for (i = 0; i < figure_count; i++) {
        const UmbraFigure *figure = &figures[i];
        check(2 * (figure->first_point + figure->point_count) <= count, "a figure has its points");
        if (figure->role == UMBRA_ROLE_BODY && figure->handle == rocket) {
            const float *corner = points + 2 * figure->first_point;
            check(figure->form == UMBRA_FIGURE_POLYGON && figure->point_count == 3, "the rocket is a triangle");
            check(corner[1] < 0 && corner[1] > -4, "below the camera");
            rockets++;
        }
    }
    check(rockets == 1, "it is drawn once");
    umbra_drawing_free(drawing);
}

static void golden(void)
{
    uint64_t ball = 0, rocket = 0, physics = 0;
    UmbraWorld *world = build(&ball, &rocket);
    UmbraBodyState state;
    UmbraPose *poses;
    UmbraInt128 energy;
    char text[128];
    UmbraContact contact;
    size_t count = 0, i;
    int tick, touched = 0;

    for (tick = 0; tick < GOLDEN_TICKS; tick++) {
        play(world, ball, rocket, tick);
        DO(umbra_world_step(world));
        DO(umbra_world_body_contacts(world, ball, &contact, 1, &count));
        touched += count == 1;
    }
    printf("the ball is on the ground in %d ticks\n", touched);
    check(touched > 0 && touched < GOLDEN_TICKS, "it comes down and goes up again");
    DO(umbra_world_physics_hash(world, &physics));
    printf("hash %016" PRIx64 " after %d ticks\n", hash_of(world), GOLDEN_TICKS);
    check(hash_of(world) == GOLDEN_STATE_HASH, "the state hash is that of the world built in Rust");
    check(physics == GOLDEN_PHYSICS_HASH, "and so is the hash of the motion");

    DO(umbra_world_body(world, ball, &state));
    check(state.user_data == 7 && state.kind == UMBRA_DYNAMIC && state.activity == UMBRA_AWAKE, "the ball is as it was made");
    DO(umbra_fx_to_text(state.position.y, text, sizeof text, NULL));
    check(fx(text) == state.position.y, "the text of a number is all of it");
    printf("  the ball is at a height of %s m\n", text);
    DO(umbra_world_energy(world, &energy));
    DO(umbra_wide_to_text(&energy, text, sizeof text, NULL));
    printf("  energy %s J\n", text);

    /* How many, then all. */
    REFUSED(umbra_world_poses(world, NULL, 0, &count), UMBRA_ERROR_BUFFER_TOO_SMALL);
    check(count == 6, "six bodies");
    poses = malloc(count * sizeof *poses);
    if (poses != NULL) {
        DO(umbra_world_poses(world, poses, count, &count));
        for (i = 0; i < count; i++) {
            DO(umbra_world_body(world, poses[i].body, &state));
            check(state.position.x == poses[i].position.x && state.angle == poses[i].angle, "a pose is that of its body");
        }
    }
    free(poses);
    drawn(world, rocket);
    umbra_world_free(world);
}

/* A server and the file of a stranger: the match began in this level, its run is right, and the world at its end has the score. */
static UmbraWorld *judge(const UmbraWorld *level, const uint8_t *file, size_t length, const UmbraReplayLimits *limits)
{
    UmbraWorld *start = NULL, *end = NULL;

    DO(umbra_replay_start(file, length, &start));
    check(hash_of(start) == hash_of(level), "the match began in this level");
    umbra_world_free(start);
    DO(umbra_replay_end(file, length, limits, &end)); /* plays it, and compares every hash */
    return end;
}

/* Saved in memory and as bytes, played on, and back again; recorded meanwhile, in another world. */
static void saved(void)
{
    uint64_t ball = 0, rocket = 0, later, ticks = 0;
    UmbraWorld *world = build(&ball, &rocket), *other = NULL, *level = NULL, *end = NULL, *played = NULL;
    UmbraSnapshot *snapshot = NULL, *read = NULL;
    UmbraBytes *bytes = NULL, *replay = NULL;
    UmbraReplayLimits limits;
    int tick;

    DO(umbra_world_snapshot(world, &snapshot));
    DO(umbra_snapshot_to_bytes(snapshot, &bytes));
    for (tick = 0; tick < 100; tick++) {
        play(world, ball, rocket, tick);
        DO(umbra_world_step(world));
    }
    later = hash_of(world);
    DO(umbra_world_restore(world, snapshot));
    check(hash_of(world) != later, "it is back");

    DO(umbra_snapshot_from_bytes(umbra_bytes_data(bytes), umbra_bytes_length(bytes), &read));
    DO(umbra_snapshot_world(read, &other));
    check(hash_of(world) == hash_of(other), "from bytes as from memory");
    DO(umbra_world_record(other, 1, 0));
    REFUSED(umbra_world_restore(other, snapshot), UMBRA_ERROR_BUSY);
    for (tick = 0; tick < 100; tick++) {
        play(world, ball, rocket, tick);
        play(other, ball, rocket, tick);
        DO(umbra_world_step(world));
        DO(umbra_world_step(other));
    }
    check(hash_of(world) == later && hash_of(other) == later, "the same future, twice");

    DO(umbra_world_end_record(other, &replay));
    limits.ticks = 1000000;
    limits.commands = 1000000;
    limits.bodies = 1000;
    limits.fields = 1000;
    limits.colliders = 1000;
    limits.pairs = 1 << 20;
    DO(umbra_replay_verify(umbra_bytes_data(replay), umbra_bytes_length(replay), &limits, &ticks));
    check(ticks == 100, "the replay has all ticks");
    printf("replay of %" PRIu64 " ticks, %lu bytes, verified\n", ticks, (unsigned long)umbra_bytes_length(replay));
    DO(umbra_snapshot_world(snapshot, &level));
    end = judge(level, umbra_bytes_data(replay), umbra_bytes_length(replay), &limits);
    check(hash_of(end) == later, "the end of the match");
    DO(umbra_world_from_replay(umbra_bytes_data(replay), umbra_bytes_length(replay), &played));
    DO(umbra_world_seek(played, 99));
    DO(umbra_world_step(played));
    check(hash_of(played) == later, "the last tick, played");
    REFUSED(umbra_world_step(played), UMBRA_ERROR_END);
    umbra_world_free(played);
    umbra_world_free(end);
    umbra_world_free(level);
    limits.ticks = 99;
    REFUSED(umbra_replay_verify(umbra_bytes_data(replay), umbra_bytes_length(replay), &limits, NULL), UMBRA_ERROR_VERIFY_TICKS);
    limits.ticks = 100;
    limits.bodies = 5;
    REFUSED(umbra_replay_verify(umbra_bytes_data(replay), umbra_bytes_length(replay), &limits, NULL), UMBRA_ERROR_VERIFY_BODIES);
    limits.bodies = 6;
    umbra_bytes_data(replay)[200] ^= 1;
    REFUSED(umbra_replay_verify(umbra_bytes_data(replay), umbra_bytes_length(replay), &limits, NULL), UMBRA_ERROR_REPLAY_TAMPERED);
    umbra_bytes_data(bytes)[40] ^= 1;
    umbra_snapshot_free(read);
    read = NULL;
    check(umbra_snapshot_from_bytes(umbra_bytes_data(bytes), umbra_bytes_length(bytes), &read) != UMBRA_OK && read == NULL,
          "a snapshot that was changed is refused");

    umbra_bytes_free(bytes);
    umbra_bytes_free(replay);
    umbra_snapshot_free(snapshot);
    umbra_world_free(other);
    umbra_world_free(world);
}

/* Two peers: one writes down what its player does, both carry it out in the same tick. */
static void sent(void)
{
    uint64_t ball = 0, rocket = 0;
    UmbraWorld *here = build(&ball, &rocket), *there = build(&ball, &rocket), *draft = NULL;
    UmbraInputs *inputs = NULL;
    UmbraInputResult outcomes[2];
    uint8_t packet[128];
    size_t length = 0, count = 0;

    DO(umbra_draft_new(&draft));
    DO(umbra_inputs_new(&inputs));
    DO(umbra_world_set_velocity(draft, ball, UMBRA_ONE, 2 * UMBRA_ONE));
    DO(umbra_draft_command(draft, packet, sizeof packet, &length));
    check(length == 25, "the bytes that docs/formats.md has for it");
    DO(umbra_world_check(here, packet, length));
    DO(umbra_inputs_insert(inputs, 1, 0, packet, length));
    REFUSED(umbra_inputs_insert(inputs, 1, 0, packet, length), UMBRA_ERROR_DUPLICATE_INPUT);
    DO(umbra_world_set_velocity(draft, UMBRA_NO_HANDLE, 0, 0));
    DO(umbra_draft_command(draft, packet, sizeof packet, &length));
    DO(umbra_inputs_insert(inputs, 0, 0, packet, length));
    DO(umbra_world_step_inputs(here, inputs));
    DO(umbra_world_step_inputs(there, inputs));
    check(hash_of(here) == hash_of(there), "both are the same");
    DO(umbra_world_outcomes(here, outcomes, 2, &count));
    check(count == 2 && outcomes[0].status == UMBRA_ERROR_NO_SUCH_BODY && outcomes[1].status == UMBRA_OK
              && outcomes[1].player == 1,
          "by player, one refused");
    REFUSED(umbra_world_execute(here, packet, 3, NULL), UMBRA_ERROR_MALFORMED);

    umbra_inputs_free(inputs);
    umbra_world_free(draft);
    umbra_world_free(there);
    umbra_world_free(here);
}

/* All of a file, which is the caller's to free; NULL if it cannot be read. */
static char *text_of(const char *file, size_t *length)
{
    FILE *input = fopen(file, "rb");
    char *text = NULL;
    long size = -1;

    if (input == NULL)
        return NULL;
    if (fseek(input, 0, SEEK_END) == 0)
        size = ftell(input);
    if (size >= 0 && fseek(input, 0, SEEK_SET) == 0)
        text = malloc((size_t)size + 1);
    if (text != NULL) {
        *length = fread(text, 1, (size_t)size, input);
        if (*length != (size_t)size) {
            free(text);
            text = NULL;
        }
    }
    fclose(input);
    return text;
}

static void scene(const char *file)
{
    size_t length = 0;
    char *text = text_of(file, &length);
    UmbraWorld *world = NULL;
    int tick;

    if (text == NULL) {
        printf("FAILED: %s cannot be read\n", file);
        failures++;
        return;
    }
    DO(umbra_world_from_scene(text, length, 131072, &world));
    free(text);
    for (tick = 0; tick < GOLDEN_SCENE_TICKS; tick++)
        DO(umbra_world_step(world));
    printf("scene %016" PRIx64 " after %d ticks\n", hash_of(world), GOLDEN_SCENE_TICKS);
    check(hash_of(world) == GOLDEN_SCENE_HASH, "the hash of the scene is that of its run in Rust");
    REFUSED(umbra_world_set_gravity(world, 0, 0), UMBRA_ERROR_BUSY);
    DO(umbra_world_leave_scene(world));
    DO(umbra_world_set_gravity(world, 0, 0));
    umbra_world_free(world);
}

static void mistakes(void)
{
    uint64_t ball = 0, rocket = 0, before, number;
    UmbraWorld *world = build(&ball, &rocket), *none = NULL;
    UmbraShape *shape = NULL;
    UmbraBodyState state;
    UmbraBodyDef body;
    UmbraFx parsed;
    const char *broken = "{\"bodies\": [{\"name\": \"a\", \"mass\": -1}]}";
    const uint8_t byte = 0;

    printf("refused:\n");
    DO(umbra_world_remove_body(world, ball));
    before = hash_of(world);
    REFUSED(umbra_world_step(NULL), UMBRA_ERROR_NULL_POINTER);
    REFUSED(umbra_world_state_hash(world, NULL), UMBRA_ERROR_NULL_POINTER);
    REFUSED(umbra_world_body(world, ball, &state), UMBRA_ERROR_NO_SUCH_BODY);
    REFUSED(umbra_world_remove_field(world, UMBRA_NO_HANDLE), UMBRA_ERROR_NO_SUCH_FIELD);
    REFUSED(umbra_world_set_velocity(world, rocket, (1 << 20) * UMBRA_ONE + 1, 0), UMBRA_ERROR_OUT_OF_RANGE);
    check(umbra_last_cause() == 153, "the cause is the velocity");
    DO(umbra_body_def_default(&body));
    body.mass_kind = UMBRA_MASS_KILOGRAMS;
    body.mass = 0;
    REFUSED(umbra_world_add_body(world, &body, &number), UMBRA_ERROR_OUT_OF_RANGE);
    body.kind = 3;
    REFUSED(umbra_world_add_body(world, &body, &number), UMBRA_ERROR_BAD_ARGUMENT);
    REFUSED(umbra_world_apply_torque(world, rocket, UMBRA_ONE, 4), UMBRA_ERROR_BAD_ARGUMENT);
    REFUSED(umbra_world_set_time_step(world, 1, 0), UMBRA_ERROR_TIME_STEP);
    REFUSED(umbra_world_execute(world, &byte, SIZE_MAX, NULL), UMBRA_ERROR_BAD_ARGUMENT);
    REFUSED(umbra_shape_circle(0, &shape), UMBRA_ERROR_OUT_OF_RANGE);
    REFUSED(umbra_fx_from_text("1.5x", 4, &parsed), UMBRA_ERROR_NUMBER_INVALID_DIGIT);
    REFUSED(umbra_world_from_scene(broken, strlen(broken), 100, &none), UMBRA_ERROR_OUT_OF_RANGE);
    check(hash_of(world) == before && shape == NULL && none == NULL, "what is refused changes nothing");
    umbra_world_free(world);
    umbra_world_free(NULL);
}

int main(int count, char **arguments)
{
    if (count != 2) {
        fprintf(stderr, "usage: main SCENE.json\n");
        return 2;
    }
    if (umbra_api() != UMBRA_API) {
        fprintf(stderr, "the library has interface %" PRIu32 ", the header %d\n", umbra_api(), UMBRA_API);
        return 2;
    }
    printf("umbra-physics %s, physics version %" PRIu32 "\n", umbra_version(), umbra_physics_version());
    golden();
    saved();
    sent();
    scene(arguments[1]);
    mistakes();
    puts(failures == 0 ? "all as it should be" : "not all as it should be");
    return failures == 0 ? 0 : 1;
}
