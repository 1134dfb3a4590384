/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0xf0acb31a6f9be573)
#define GOLDEN_PHYSICS_HASH UINT64_C(0x3e25432dce2c27dd)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0x6bd21bdfcbf37306)
