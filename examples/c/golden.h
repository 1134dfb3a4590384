/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0x93ac8c2fd5af3448)
#define GOLDEN_PHYSICS_HASH UINT64_C(0x97accf2e0b05c128)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0x645cfd1b11c847da)
