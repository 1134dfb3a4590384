/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0xb327bfadfb45a27e)
#define GOLDEN_PHYSICS_HASH UINT64_C(0x471c28ab5a8e6045)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0x3a2854cbf09a794f)
