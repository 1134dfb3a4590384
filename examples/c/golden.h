/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0x0d295329c21c356e)
#define GOLDEN_PHYSICS_HASH UINT64_C(0xc88863ce481b2533)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0x2216b25eb42fb4b6)
