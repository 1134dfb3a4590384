/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0xc0525e272776b8f2)
#define GOLDEN_PHYSICS_HASH UINT64_C(0x129ed42fe828aad3)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0xed6b395152f9133b)
