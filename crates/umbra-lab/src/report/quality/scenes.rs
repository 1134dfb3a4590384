//! Scenes of the quality page, equal to those of `benches/peers` to the bit, so that its figures of other engines are of the same scenes.
//!
//! Coordinates, sizes and angles are multiples of 2^-20.

use umbra_physics::{
    Attachment, BodyDef, ColliderDef, End, Error, FieldKind, Fx, Material, Shape, SpringConstants, TimeStep, Turn,
    Vec2, World, WorldDef, fx, vec2,
};

/// A reflection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mirror {
    /// (x, y) becomes (−x, y).
    X,
    /// (x, y) becomes (x, −y).
    Y,
}

/// A world in which nothing sleeps, and the bodies to add. The path of the last body is recorded.
pub(super) struct Scene {
    pub(super) def: WorldDef,
    pub(super) bodies: Vec<BodyDef>,
    /// Springs of a length and a stiffness, from the centre of a body to a fixed point.
    pub(super) springs: Vec<(usize, Vec2, Fx, Fx)>,
    /// The reflection that maps the scene to itself.
    pub(super) mirror: Option<Mirror>,
}

/// The nearest multiple of 2^-20; halves are rounded away from zero, so that mirror images stay mirror images.
pub(super) fn grid(value: Fx) -> Fx {
    const DOWN: u32 = 32 - 20;
    let bits = value.to_bits();
    let size = (bits.abs() + (1 << (DOWN - 1))) >> DOWN << DOWN;
    Fx::from_bits(if bits < 0 { -size } else { size })
}

pub(super) fn whole(number: usize) -> Fx {
    Fx::from(number as i32)
}

/// A fraction of a whole number.
fn of(number: usize, factor: Fx) -> Fx {
    whole(number) * factor
}

/// A rectangle of half the width and half the height.
pub(super) fn rectangle(half_width: Fx, half_height: Fx) -> Result<Shape, Error> {
    Shape::rectangle(2 * grid(half_width), 2 * grid(half_height))
}

pub(super) fn unit_box() -> Result<Shape, Error> {
    rectangle(fx!(0.5), fx!(0.5))
}

/// The numbers of the generator in `benches/peers`.
pub(super) struct Numbers(pub(super) u64);

impl Numbers {
    /// A number in [0, 1), a multiple of 2^-31.
    pub(super) fn next(&mut self) -> Fx {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        Fx::from_bits((self.0 >> 33 << 1) as i64)
    }
}

impl Scene {
    pub(super) fn new(mirror: Option<Mirror>) -> Self {
        let def =
            WorldDef { time_step: TimeStep::hz(60), gravity: vec2(0, -10), sleep_after: None, ..WorldDef::default() };
        Self { def, bodies: Vec::new(), springs: Vec::new(), mirror }
    }

    pub(super) fn add(&mut self, base: BodyDef, at: Vec2, shape: Shape) -> &mut BodyDef {
        let key = self.bodies.len() as u64;
        let shift = shape.shift();
        let collider = ColliderDef { key, ..ColliderDef::new(shape) };
        let position = Vec2::new(grid(at.x) + shift.x, grid(at.y) + shift.y);
        self.bodies.push(BodyDef { position, key, ..base.with_collider(collider) });
        let last = self.bodies.len() - 1;
        &mut self.bodies[last]
    }

    pub(super) fn fixed(&mut self, x: Fx, y: Fx, shape: Shape) -> &mut BodyDef {
        self.add(BodyDef::fixed(), Vec2::new(x, y), shape)
    }

    pub(super) fn dynamic(&mut self, x: Fx, y: Fx, shape: Shape) -> &mut BodyDef {
        self.add(BodyDef::dynamic(), Vec2::new(x, y), shape)
    }

    /// A floor whose top is y = 0.
    pub(super) fn floor(&mut self, half_width: Fx) -> Result<&mut BodyDef, Error> {
        Ok(self.fixed(fx!(0), fx!(-1), rectangle(half_width, fx!(1))?))
    }

    /// The scene in a world in which what is at rest falls asleep.
    pub(super) fn sleeping(&self) -> Self {
        let sleep_after = WorldDef::<Fx>::default().sleep_after;
        Self {
            def: WorldDef { sleep_after, ..self.def },
            bodies: self.bodies.clone(),
            springs: self.springs.clone(),
            ..*self
        }
    }

    /// The world with its bodies.
    pub(super) fn build(&self, substeps: u32) -> Result<World, Error> {
        let mut def = self.def;
        def.contacts.substeps = substeps;
        let mut world = World::new(def)?;
        let ids = self.bodies.iter().map(|body| world.add_body(body.clone()));
        let ids = ids.collect::<Result<Vec<_>, _>>()?;
        for &(body, hook, rest, stiffness) in &self.springs {
            world.add_field(FieldKind::Spring {
                near: Attachment { body: ids[body], point: Vec2::ZERO },
                far: End::World(hook),
                spring: SpringConstants { rest, stiffness, damping: fx!(20) },
            })?;
        }
        Ok(world)
    }
}

pub(super) fn set_material(body: &mut BodyDef, change: impl Fn(&mut Material)) {
    body.colliders.iter_mut().for_each(|collider| change(&mut collider.material));
}

/// A pyramid of boxes, a number of them in the lowest row.
pub(super) fn pyramid(base: usize) -> Result<Scene, Error> {
    let mut scene = Scene::new(Some(Mirror::X));
    scene.floor(fx!(100))?;
    for row in 0..base {
        let count = base - row;
        for j in 0..count {
            // Twice the distance from the middle, in boxes.
            let twice = Fx::from(2 * j as i32 - count as i32 + 1);
            scene.dynamic(twice * fx!(0.525), whole(row) + fx!(0.5), unit_box()?);
        }
    }
    let rough = |body: &mut BodyDef| set_material(body, |material| material.friction = fx!(0.5));
    scene.bodies.iter_mut().for_each(rough);
    Ok(scene)
}

/// A tower of boxes, the top one of another density.
pub(super) fn tower(count: usize, top_density: Fx) -> Result<Scene, Error> {
    let mut scene = Scene::new(Some(Mirror::X));
    scene.floor(fx!(100))?;
    for k in 0..count {
        scene.dynamic(fx!(0), whole(k) + fx!(0.5), unit_box()?);
    }
    scene.bodies[count].colliders[0].density = top_density;
    Ok(scene)
}

/// Boxes in three layers on a floor that carries them towards a stop at x = 0.
pub(super) fn belt() -> Result<Scene, Error> {
    let mut scene = Scene::new(None);
    set_material(scene.floor(fx!(200))?, |material| material.surface_speed = fx!(-2));
    let mut numbers = Numbers(2);
    for i in 0..60 {
        let (x, y) = (of(i % 20, fx!(1.3)) - fx!(40), of(i / 20, fx!(1.01)) + fx!(0.5));
        scene.dynamic(x, y, unit_box()?).angle = grid(numbers.next() * fx!(0.02));
    }
    scene.fixed(fx!(0), fx!(1), rectangle(fx!(0.5), fx!(1))?);
    Ok(scene)
}

/// Discs and boxes of unequal sizes dropped into a container.
pub(super) fn mixed(count: usize) -> Result<Scene, Error> {
    let mut scene = Scene::new(None);
    scene.fixed(fx!(0), fx!(-2), rectangle(fx!(20), fx!(2))?);
    for side in [fx!(-14), fx!(14)] {
        scene.fixed(side, fx!(400), rectangle(fx!(2), fx!(402))?);
    }
    let mut numbers = Numbers(11);
    let size = |numbers: &mut Numbers, least: Fx| least + numbers.next() * fx!(0.2);
    for i in 0..count {
        let x = (whole(i % 20) - fx!(9.5)) * fx!(1.15) + numbers.next() * fx!(0.1);
        let y = of(i / 20, fx!(1.2)) + fx!(1);
        if i % 2 == 0 {
            let radius = grid(size(&mut numbers, fx!(0.25)));
            scene.dynamic(x, y, Shape::circle(radius)?);
        } else {
            let (half_width, half_height) = (size(&mut numbers, fx!(0.2)), size(&mut numbers, fx!(0.2)));
            let angle = grid(numbers.next() * fx!(6));
            scene.dynamic(x, y, rectangle(half_width, half_height)?).angle = angle;
        }
    }
    Ok(scene)
}

/// A half circle of wedges between two radii, an odd number, without mortar.
pub(super) fn arch(count: usize, radii: [Fx; 2]) -> Result<Scene, Error> {
    let mut scene = Scene::new(Some(Mirror::X));
    scene.floor(fx!(50))?;
    let edge = |k: usize| {
        let (sin, cos) = Turn::from_bits(((k as u128) << 64).div_euclid(2 * count as u128) as u64).sin_cos();
        radii.map(|radius| Vec2::new(grid(radius * cos), grid(radius * sin)))
    };
    let image = |edge: [Vec2; 2]| edge.map(|corner| Vec2::new(-corner.x, corner.y));
    let middle = count / 2;
    for k in 0..middle {
        let (at, corners) = wedge(edge(k), edge(k + 1));
        scene.dynamic(at.x, at.y, Shape::polygon(&corners)?);
    }
    let (at, corners) = wedge(edge(middle), image(edge(middle)));
    scene.dynamic(fx!(0), at.y, Shape::polygon(&corners)?);
    for k in (0..middle).rev() {
        let (at, mut corners) = wedge(edge(k), edge(k + 1));
        corners.reverse();
        let corners = corners.map(|corner| Vec2::new(-corner.x, corner.y));
        scene.dynamic(-at.x, at.y, Shape::polygon(&corners)?);
    }
    Ok(scene)
}

/// The centroid of a stone, on the grid, and its corners from there: between two edges, each given by its inner and its outer corner.
fn wedge(first: [Vec2; 2], last: [Vec2; 2]) -> (Vec2, [Vec2; 4]) {
    let corners = [first[0], first[1], last[1], last[0]];
    let exact = corners.map(|corner| [corner.x, corner.y].map(|c| i128::from(c.to_bits() >> 12)));
    // Corners are below 2^24 units, so that these are below 2^75.
    let (mut twice_area, mut sum) = (0, [0; 2]);
    for (k, a) in exact.iter().enumerate() {
        let b = exact[(k + 1) % 4];
        let cross = a[0] * b[1] - a[1] * b[0];
        twice_area += cross;
        sum = [0, 1].map(|axis| sum[axis] + cross * (a[axis] + b[axis]));
    }
    // In units of 2^-20 m, halves away from zero; the area is positive.
    let centroid = sum.map(|sum: i128| {
        let size = (2 * sum.abs() + 3 * twice_area) / (6 * twice_area);
        Fx::from_bits(((sum.signum() * size) << 12) as i64)
    });
    let centroid = Vec2::new(centroid[0], centroid[1]);
    (centroid, corners.map(|corner| corner - centroid))
}

/// A house of cards: pairs of cards that lean on each other, with a card across each gap.
pub(super) fn cards(storeys: usize) -> Result<Scene, Error> {
    let mut scene = Scene::new(Some(Mirror::X));
    scene.floor(fx!(200))?;
    let (half, thin, lean) = (fx!(0.5), fx!(0.02), grid(fx!(0.35)));
    let (sin, cos) = Turn::from_radians(lean).sin_cos();
    let width = 2 * (half * sin + thin * cos) + fx!(0.002);
    let height = 2 * (half * cos + thin * sin);
    for row in 0..storeys {
        let count = storeys - row;
        // Twice the place of a gap, from the middle.
        let twice = |j: usize| Fx::from(2 * j as i32 - count as i32 + 1);
        let base = of(row, height + 2 * thin);
        for j in 0..count {
            let x = twice(j) * width;
            for side in [fx!(-1), fx!(1)] {
                let card = rectangle(thin, half)?;
                scene.dynamic(x + side * (width * half), base + half * height, card).angle = side * lean;
            }
        }
        for j in 1..count {
            let x = (twice(j) - fx!(1)) * width;
            scene.dynamic(x, base + height + thin, rectangle(width * fx!(0.95), thin)?);
        }
    }
    Ok(scene)
}

/// A disc that runs into a triangle of 15 that touch, without friction and gravity.
pub(super) fn billiards() -> Result<Scene, Error> {
    let mut scene = Scene::new(Some(Mirror::Y));
    scene.def.gravity = Vec2::ZERO;
    let disc = Shape::circle(fx!(0.5))?;
    scene.dynamic(fx!(-10), fx!(0), disc.clone()).velocity = vec2(20, 0);
    let pitch = fx!(0.75).sqrt();
    for row in 0..5 {
        for k in 0..=row {
            scene.dynamic(of(row, pitch), whole(k) - of(row, fx!(0.5)), disc.clone());
        }
    }
    for body in &mut scene.bodies {
        set_material(body, |material| (material.restitution, material.friction) = (fx!(0.95), fx!(0)));
    }
    Ok(scene)
}

/// A box that falls 2 m flat onto a floor of restitution 0.5.
pub(super) fn flat_drop() -> Result<Scene, Error> {
    let mut scene = Scene::new(Some(Mirror::X));
    set_material(scene.floor(fx!(10))?, |material| material.restitution = fx!(0.5));
    scene.dynamic(fx!(0), fx!(2.5), unit_box()?);
    Ok(scene)
}

/// The angle of friction for the coefficient 0.6, and 1e-3 rad less and more, in units of 2^-20 rad.
pub(super) const SLOPES: [i64; 2] = [565_622, 567_719];

/// A box on a slope of an angle in units of 2^-20 rad, with the coefficient of friction 0.6.
pub(super) fn slope(angle: i64) -> Result<Scene, Error> {
    let mut scene = Scene::new(None);
    let angle = Fx::from_bits(angle << 12);
    let (sin, cos) = Turn::from_radians(angle).sin_cos();
    scene.fixed(fx!(0), fx!(0), rectangle(fx!(20), fx!(1))?).angle = angle;
    // 1 mm deep, so that the box touches from the first step.
    scene.dynamic(-(fx!(1.499) * sin), fx!(1.499) * cos, unit_box()?).angle = angle;
    Ok(scene)
}

/// A disc that falls 10 m onto a floor of restitution 0.9.
pub(super) fn bounce() -> Result<Scene, Error> {
    let mut scene = Scene::new(Some(Mirror::X));
    set_material(scene.floor(fx!(10))?, |material| material.restitution = fx!(0.9));
    scene.dynamic(fx!(0), fx!(10.5), Shape::circle(fx!(0.5))?);
    Ok(scene)
}

/// Newton's cradle: five discs on springs, 4 cm apart. The outer ones are let go from the same height at the same time.
pub(super) fn cradle() -> Result<Scene, Error> {
    let mut scene = Scene::new(Some(Mirror::X));
    scene.def.time_step = TimeStep::hz(480);
    let raised = vec2(fx!(4.949424364), fx!(1.213173163));
    for i in 0..5 {
        let hook = vec2(grid((whole(i) - fx!(2)) * fx!(1.04)), 4);
        let at = match i {
            0 => vec2(-raised.x, raised.y),
            4 => raised,
            _ => vec2(hook.x, 0),
        };
        let disc = scene.dynamic(at.x, at.y, Shape::circle(fx!(0.5))?);
        set_material(disc, |material| (material.restitution, material.friction) = (fx!(1), fx!(0)));
        scene.springs.push((i, hook, fx!(4), fx!(20_000)));
    }
    Ok(scene)
}
