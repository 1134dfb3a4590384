/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0xfed443307d1d3abd)
#define GOLDEN_PHYSICS_HASH UINT64_C(0x4caff8fc84148564)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0xeab69bcceb37a72f)
