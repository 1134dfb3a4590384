/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0xeaf9c16c53bd473b)
#define GOLDEN_PHYSICS_HASH UINT64_C(0x2941714890a51f5d)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0x24009fcaeecb3354)
