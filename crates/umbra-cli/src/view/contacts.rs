//! Contacts of a frame as bytes for the page.
//!
//! A contact is, with all numbers little-endian: a word of 32 bits, the number of its second body in the page times two, plus
//! one if it has two points; the angle of its normal, rad, and the impulse of friction, N·s; and for each point its place from the
//! centre of the second body, m, in x and y, and its impulse along the normal, N·s. These are singles: they are for drawing alone.
//! `contacts.js` reads the same.

use umbra_physics::scalar::ToF64;
use umbra_physics::{BodyId, Fx, World};

/// The contacts of a world. `life` has the number under which the page knows a body.
pub(super) fn frame(world: &World<Fx>, life: impl Fn(BodyId) -> Option<usize>) -> Vec<u8> {
    let mut bytes = Vec::new();
    for contact in world.contacts() {
        let second = contact.bodies[1];
        let (Some(life), Ok(body)) = (life(second), world.body(second)) else { continue };
        let word = (life as u32) << 1 | u32::from(contact.points().len() == 2);
        bytes.extend(word.to_le_bytes());
        let mut add = |number: f64| bytes.extend((number as f32).to_le_bytes());
        let ([nx, ny], [x, y]) = (contact.normal.to_f64(), body.position().to_f64());
        add(ny.atan2(nx));
        add(contact.tangent_impulse.to_f64());
        for point in contact.points() {
            let at = point.position.to_f64();
            [at[0] - x, at[1] - y, point.normal_impulse.to_f64()].into_iter().for_each(&mut add);
        }
    }
    bytes
}
