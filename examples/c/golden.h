/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0x98a5d6dd97257ff6)
#define GOLDEN_PHYSICS_HASH UINT64_C(0x3a3058a76a434376)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0x8fecba8f7fda5903)
