/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0x1868182d07a8ae42)
#define GOLDEN_PHYSICS_HASH UINT64_C(0x72dc49d598090993)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0xfc0b8a7fa950a269)
