/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0x6cc0a790a873e1e5)
#define GOLDEN_PHYSICS_HASH UINT64_C(0x870ab9942da8af6a)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0x1eb7b5a42fbb3427)
