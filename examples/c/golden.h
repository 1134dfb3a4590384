/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0x9e8d14fb8cc42be6)
#define GOLDEN_PHYSICS_HASH UINT64_C(0xb94cabb057ab135f)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0x986e02e12af79ec5)
