/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0xbba435d24de1d05a)
#define GOLDEN_PHYSICS_HASH UINT64_C(0x9eebacf15319921c)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0x1b43a5dfff0b9e56)
