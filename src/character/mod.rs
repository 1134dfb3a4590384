//! Character controller: how a shape walks, climbs, slides and rides through the colliders of a world.
//!
//! All of it runs in integers, whatever the scalar of the world. The colliders around a character become obstacles of its centre: the sum
//! of each convex part with the mirror image of the character's ([`crate::query`]), with a skin around it. The centre is a point in ulps
//! that is cast and slides along them. Every term of its way is a function of integers that is odd under a mirror image.

mod obstacle;
mod push;
mod result;
mod settings;
mod slide;
mod stair;
mod step;

pub use result::{CharacterHit, Ground, Movement};
pub use settings::Character;
