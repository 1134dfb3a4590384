/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0x0e4bd7bf6cb2592f)
#define GOLDEN_PHYSICS_HASH UINT64_C(0x95d9a2d08e332e18)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0x89755303c1e30664)
