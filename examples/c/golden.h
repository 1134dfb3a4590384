/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0x624cb7d126423669)
#define GOLDEN_PHYSICS_HASH UINT64_C(0xa2d8b03468a97a4f)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0xf75b75cc6d607995)
