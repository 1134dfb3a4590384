/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0x830ded69ca199464)
#define GOLDEN_PHYSICS_HASH UINT64_C(0xd430a09d4924e329)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0x59d1804523e61d22)
