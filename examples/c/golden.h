/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0x129d9e26e0a7d60a)
#define GOLDEN_PHYSICS_HASH UINT64_C(0xd35efda781838f4c)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0xce7638284c5bd70b)
