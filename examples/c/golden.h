/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0x061480c19c567cfa)
#define GOLDEN_PHYSICS_HASH UINT64_C(0x974fafc78efa43e0)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0x3abbaab33087d62b)
