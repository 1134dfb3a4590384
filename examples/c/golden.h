/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0xe105793abcd78be0)
#define GOLDEN_PHYSICS_HASH UINT64_C(0x4a56c1108e687d23)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0x0f82f03e10018b9a)
