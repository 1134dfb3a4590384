/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0x7f0728a3e849b3af)
#define GOLDEN_PHYSICS_HASH UINT64_C(0x13ab17db89af9f57)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0x8c2ef94173e2e1e3)
