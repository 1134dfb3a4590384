//! Bodies that calls put elsewhere: their ways have a gap there.

use umbra_physics::scalar::ToF64;
use umbra_physics::{BodyId, Scalar, World};

/// The places of bodies at a tick, m, from which the next one tells which of them jumped.
#[derive(Clone, Debug, Default)]
pub(crate) struct Jumps {
    /// By slot.
    places: Vec<Option<(BodyId, [f64; 2])>>,
}

impl Jumps {
    /// Takes in the world after a step. Returns the bodies that calls before it put elsewhere: farther than they move by themselves and are
    /// wide, as a game may set the place or the angle of a body in each tick, and its way is none the less one line.
    pub(crate) fn see<S: Scalar + ToF64>(&mut self, world: &World<S>) -> Vec<BodyId> {
        let (num, den) = world.def().time_step.seconds();
        let seconds = f64::from(num) / f64::from(den);
        let has_jumped = |&id: &BodyId| {
            let Ok(body) = world.body(id) else { return false };
            let before = self.places.get(slot(id)).copied().flatten().filter(|(before, _)| *before == id);
            let Some((_, [x, y])) = before else { return false };
            let [now_x, now_y] = body.position().to_f64();
            let way = length([now_x - x, now_y - y]);
            way > 2.0 * seconds * length(body.velocity().to_f64()) + width(world, id)
        };
        let jumped = world.last_report().placed.iter().copied().filter(has_jumped).collect();
        self.places.fill(None);
        for body in world.bodies() {
            let id = body.id();
            if self.places.len() <= slot(id) {
                self.places.resize(slot(id) + 1, None);
            }
            self.places[slot(id)] = Some((id, body.position().to_f64()));
        }
        jumped
    }
}

fn slot(body: BodyId) -> usize {
    body.parts().0 as usize
}

/// The longest side of the boxes around the shapes of a body, m.
fn width<S: Scalar + ToF64>(world: &World<S>, body: BodyId) -> f64 {
    let shapes = world.colliders_of(body).into_iter().flatten().filter_map(|collider| world.collider(collider).ok());
    let sides = shapes.flat_map(|collider| {
        let bounds = collider.shape.bounds();
        (bounds.max - bounds.min).to_f64()
    });
    sides.fold(0.0, f64::max)
}

fn length([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}
