/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0x2ca565f2fd0b9fa5)
#define GOLDEN_PHYSICS_HASH UINT64_C(0x1a94d297b7dac899)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0xc29c2c6c47bf003f)
