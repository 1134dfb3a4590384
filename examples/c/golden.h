/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0x5232b20fbd76ae3a)
#define GOLDEN_PHYSICS_HASH UINT64_C(0xd783c51410c3fa21)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0xb940ef4a744f10ee)
