/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0x04c81f31e6765e50)
#define GOLDEN_PHYSICS_HASH UINT64_C(0xc00e10ba5eef00e8)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0xce7638284c5bd70b)
