//! Motions of a body that meets a plane: an edge of a second body that never moves.

use umbra_physics::{BodyKind, Damping, Fx, Vec2, World};

use super::{Exact, Real, real, to_f64};

/// A body and the plane under it, with vectors along the plane and away from it.
struct OnPlane {
    /// Unit vectors along the plane, and from it to the body: the first one turned by a quarter.
    along: [Real; 2],
    away: [Real; 2],
    start: [Real; 2],
    /// The distance from the plane to the nearest point of the body, m.
    height: Real,
    /// Velocities along the plane and away from it, m/s.
    v: Real,
    rise: Real,
    /// Gravity along the plane, and towards it, m/s².
    downhill: Real,
    pull: Real,
    friction: Real,
}

fn dot(a: &[Real; 2], b: &[Real; 2]) -> Real {
    &a[0] * &b[0] + &a[1] * &b[1]
}

fn is_positive(value: &Real) -> bool {
    *value > real(0)
}

/// -1, 0 or 1
fn sign(value: &Real) -> Real {
    real(i64::from(is_positive(value)) - i64::from(is_positive(&-value)))
}

impl OnPlane {
    /// Reads the first body of a world and the plane nearest under it: an edge of the second body, which is static. Each has one
    /// convex collider at its centre; both are alike in friction, and neither is turned. `None` for other worlds.
    fn of(world: &World, bits: usize) -> Option<Self> {
        let bodies: Vec<_> = world.bodies().collect();
        let [body, ground] = &bodies[..] else { return None };
        let wide = |value: Fx| value.exact().with_precision(bits).value();
        let pair = |v: Vec2| [wide(v.x), wide(v.y)];
        let colliders: Vec<_> = world.colliders().map(|(_, collider)| collider).collect();
        let [body_collider, ground_collider] = &colliders[..] else { return None };
        let are_centred = [body_collider, ground_collider]
            .iter()
            .all(|collider| collider.position == Vec2::ZERO && collider.angle == Fx::ZERO);
        let are_level = [body, ground].iter().all(|body| body.angle() == Fx::ZERO);
        let is_fixed = ground.kind() == BodyKind::Static;
        let are_alike = body_collider.material.friction == ground_collider.material.friction;
        let is_free = world.def().linear_damping == Damping::NONE && world.fields().next().is_none();
        if !(are_centred && are_level && is_fixed && are_alike && is_free) {
            return None;
        }
        let ([outline], [edges]) = (body_collider.shape.outlines(), ground_collider.shape.outlines()) else {
            return None;
        };
        let (start, velocity, gravity) = (pair(body.position()), pair(body.velocity()), pair(world.def().gravity));
        let from = pair(ground.position());
        let height = |corner: &[Real; 2], away: &[Real; 2]| {
            let lowest = outline
                .corners()
                .iter()
                .map(|&corner| dot(&pair(corner), away))
                .reduce(|a, b| if a < b { a } else { b })?;
            Some(lowest + dot(&start, away) - dot(&from, away) - dot(corner, away) - wide(outline.radius()))
        };
        let corners: Vec<[Real; 2]> = edges.corners().iter().map(|&corner| pair(corner)).collect();
        let planes = corners.iter().zip(corners.iter().cycle().skip(1)).filter_map(|(a, b)| {
            let way = [&b[0] - &a[0], &b[1] - &a[1]];
            let length = dot(&way, &way).sqrt();
            // Corners go counter-clockwise: the inside is on the left.
            let away = [&way[1] / &length, -(&way[0] / &length)];
            Some((height(a, &away)?, away))
        });
        let (height, away) = planes.reduce(|a, b| if a.0 < b.0 { b } else { a })?;
        let along = [away[1].clone(), -&away[0]];
        Some(Self {
            v: dot(&velocity, &along),
            rise: dot(&velocity, &away),
            downhill: dot(&gravity, &along),
            pull: -dot(&gravity, &away),
            friction: wide(body_collider.material.friction),
            along,
            away,
            start,
            height,
        })
    }

    /// The place of the body after it has moved along the plane and away from it.
    fn place(&self, moved: &Real, risen: &Real) -> Vec<Real> {
        (0..2).map(|i| &self.start[i] + moved * &self.along[i] + risen * &self.away[i]).collect()
    }
}

/// The place of a block that slides along the plane it stands on, until friction stops it for good. `None` if it does not touch the plane
/// along all of a side, does not slide, or would slide back.
pub(super) fn slide(world: &World, time: &Real, bits: usize) -> Option<Vec<Real>> {
    let contact = OnPlane::of(world, bits)?;
    let touches = to_f64(&contact.height).abs() < 1e-30 && to_f64(&contact.rise).abs() < 1e-30;
    if !touches || sign(&contact.v) == real(0) {
        return None;
    }
    let grip = &contact.friction * &contact.pull;
    let slowing = &contact.downhill - sign(&contact.v) * &grip;
    let stop = -(&contact.v / &slowing);
    let stays = is_positive(&stop) && is_positive(&(grip.sqr() - contact.downhill.sqr()));
    if is_positive(&stop) && stop < *time && !stays {
        return None;
    }
    let until = if stays && stop < *time { &stop } else { time };
    Some(contact.place(&(&contact.v * until + &slowing * until.sqr() / real(2)), &real(0)))
}

/// A disc above a plane or on it.
struct Disc {
    on: OnPlane,
    /// Inertia over mass and the square of the radius.
    inertia: Real,
    restitution: Real,
    /// The approach speed from which on it bounces, m/s.
    bounces_from: Real,
    /// The speed at which its rim passes its centre, m/s: as `v` if it rolls.
    rim: Real,
    moved: Real,
    risen: Real,
    /// s
    left: Real,
}

/// The place of a disc that falls to a plane, bounces or slides on it, and rolls. An impact without restitution takes away all speed
/// towards the plane, and friction acts in it as Coulomb's law has it. `None` for a disc that spins or slides where it bounces, or that
/// slides down where it should roll.
pub(super) fn disc(world: &World, time: &Real, bits: usize) -> Option<Vec<Real>> {
    let contact = OnPlane::of(world, bits)?;
    let (body, wide) = (world.bodies().next()?, |value: Real| value.with_precision(bits).value());
    let colliders = || world.colliders().map(|(_, collider)| collider);
    let outlines = colliders().next()?.shape.outlines();
    let radius = wide(outlines.first().filter(|outline| outline.corners().len() == 1)?.radius().exact());
    let inertia = wide(body.inertia()?.exact()) / (wide(body.mass()?.exact()) * radius.sqr());
    let disc = Disc {
        inertia,
        restitution: wide(colliders().map(|collider| collider.material.restitution).max()?.exact()),
        bounces_from: wide(world.def().contacts.restitution_speed.exact()),
        rim: -(wide(body.angular_velocity().exact()) * radius),
        moved: wide(real(0)),
        risen: wide(real(0)),
        left: time.clone(),
        on: contact,
    };
    disc.place()
}

impl Disc {
    /// Goes on by `time` at the acceleration along the plane.
    fn go(&mut self, time: &Real, acceleration: &Real) {
        self.moved += (&self.on.v + acceleration * time / real(2)) * time;
        self.on.v += acceleration * time;
        self.left -= time;
    }

    fn slip(&self) -> Real {
        &self.on.v - &self.rim
    }

    fn place(mut self) -> Option<Vec<Real>> {
        while self.falls() {
            if self.fly() {
                return Some(self.on.place(&self.moved, &self.risen));
            }
            self.land()?;
        }
        self.slide();
        self.roll()?;
        Some(self.on.place(&self.moved, &self.risen))
    }

    fn falls(&self) -> bool {
        is_positive(&self.on.rise) || to_f64(&(&self.on.height + &self.risen)) > 1e-30
    }

    /// Flies to the plane. Returns true if the time ends before.
    fn fly(&mut self) -> bool {
        let (height, pull) = (&self.on.height + &self.risen, self.on.pull.clone());
        let meets = (&self.on.rise + (self.on.rise.sqr() + (&pull * height) * real(2)).sqrt()) / &pull;
        let ends = self.left <= meets;
        let time = if ends { self.left.clone() } else { meets };
        self.risen += (&self.on.rise - &pull * &time / real(2)) * &time;
        self.on.rise -= pull * &time;
        let downhill = self.on.downhill.clone();
        self.go(&time, &downhill);
        ends
    }

    /// Meets the plane: bounces, or stays on it and loses slip by friction.
    fn land(&mut self) -> Option<()> {
        let speed = -self.on.rise.clone();
        self.risen = -self.on.height.clone();
        if is_positive(&self.restitution) && speed > self.bounces_from {
            self.on.rise = &self.restitution * speed;
            return (self.slip() == real(0)).then_some(());
        }
        self.on.rise = real(0);
        let slip = self.slip();
        // The friction that ends the slip, and what there is of it.
        let needed = sign(&slip) * &slip / (real(1) + real(1) / &self.inertia);
        let limit = &self.on.friction * speed;
        let sticks = needed <= limit;
        let push = sign(&slip) * if sticks { needed } else { limit };
        self.on.v -= &push;
        self.rim += push / &self.inertia;
        if sticks {
            self.rim = self.on.v.clone();
        }
        Some(())
    }

    /// Slides until it rolls.
    fn slide(&mut self) {
        let slip = self.slip();
        if slip == real(0) {
            return;
        }
        let grip = sign(&slip) * &self.on.friction * &self.on.pull;
        let slowing = &grip * (real(1) + real(1) / &self.inertia) - &self.on.downhill;
        let rolls_after = &slip / &slowing;
        let rolls = is_positive(&rolls_after) && rolls_after < self.left;
        let time = if rolls { rolls_after } else { self.left.clone() };
        self.rim += &grip / &self.inertia * &time;
        let acceleration = &self.on.downhill - grip;
        self.go(&time, &acceleration);
        if rolls {
            self.rim = self.on.v.clone();
        }
    }

    /// Rolls for the rest of the time.
    fn roll(&mut self) -> Option<()> {
        let acceleration = &self.on.downhill / (real(1) + &self.inertia);
        let needed = (&acceleration * &self.inertia).sqr();
        let left = self.left.clone();
        self.go(&left, &acceleration);
        (needed <= (&self.on.friction * &self.on.pull).sqr()).then_some(())
    }
}

#[cfg(test)]
mod tests;
