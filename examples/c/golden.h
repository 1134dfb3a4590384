/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0x58643f6822d571d9)
#define GOLDEN_PHYSICS_HASH UINT64_C(0x4e46f0bd43ebf8e5)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0x55c6e862535bd58e)
