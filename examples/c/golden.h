/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0x696f91f03cc0d7a1)
#define GOLDEN_PHYSICS_HASH UINT64_C(0x17b1c5f58083d790)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0x1614cd4d124cf54e)
