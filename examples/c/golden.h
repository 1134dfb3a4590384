/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0x4535ad14695a9d4b)
#define GOLDEN_PHYSICS_HASH UINT64_C(0x6ca51a1d22851240)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0x6c1e9dd931bccdd8)
