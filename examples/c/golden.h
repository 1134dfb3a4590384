/* Written by capi/tests/golden.rs from the library: UMBRA_BLESS=1. */
#define GOLDEN_TICKS 600
#define GOLDEN_STATE_HASH UINT64_C(0xfa034f8f6e726726)
#define GOLDEN_PHYSICS_HASH UINT64_C(0xb683a2fba000ca5a)
/* Of scenes/lander.json. */
#define GOLDEN_SCENE_TICKS 600
#define GOLDEN_SCENE_HASH UINT64_C(0xad3a212c3d6f0dd5)
