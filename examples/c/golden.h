/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0xe1a8529ec700a2ca)
#define GOLDEN_PHYSICS_HASH UINT64_C(0xea28331e063b9813)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0x8dbb9f434602b1d4)
