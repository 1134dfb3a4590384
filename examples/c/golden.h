/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0x7d2a06e569503c28)
#define GOLDEN_PHYSICS_HASH UINT64_C(0xf3f2ba7c45f20b8f)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0x01f45ed18c8d91a9)
