/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0xf021817c6951a60c)
#define GOLDEN_PHYSICS_HASH UINT64_C(0x40b930ff6a3dfc76)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0xb5d41ae30dbafc56)
