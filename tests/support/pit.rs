//! A closed pit with a pile of bodies of all shapes, a stirrer, a one-way platform, a sensor and a bullet: in turn shaken, stirred and at
//! rest.

use umbra_physics::{
    Activity, BodyDef, BodyId, BodyKind, BodyRef, ColliderDef, Command, Created, Damping, Filter, Fx, Material, OneWay,
    Part, Random, Shape, TimeStep, Vec2, World, fx, vec2,
};

use crate::seeds::is_short;

/// The middle of the pit, far from where most of the other bodies are, m.
const CENTRE: Vec2 = Vec2::new(fx!(300), fx!(0));
/// The half of the inner width and height, m.
const HALF: i32 = 10;
/// The bodies of the pile.
pub(crate) const PILE: usize = 160;
/// Ticks of a turn, of which the pit is shaken before the first of its parts, then stirred, and from the second on at rest.
pub(crate) fn turn() -> u64 {
    if is_short() { 64 } else { 256 }
}

fn parts() -> [u64; 2] {
    [5, 9].map(|share| turn() * share / 16)
}

/// Ticks between two bullets.
const BULLETS: u64 = 16;

/// A part of the turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    /// All random commands, those that change the whole world too: gravity, time step, damping, integrator, settings.
    Shaken,
    /// A kinematic paddle turns in the pile, under everyday gravity.
    Stirred,
    /// Nothing is done to the pile but what the few random commands do: it falls asleep, wakes in parts, and falls asleep again.
    Rest,
}

impl Phase {
    pub(crate) fn of(tick: u64) -> Self {
        let [stirred, rest] = parts();
        match tick % turn() {
            part if part < stirred => Self::Shaken,
            part if part < rest => Self::Stirred,
            _ => Self::Rest,
        }
    }
}

/// The bodies of the pit.
pub(crate) struct Pit {
    random: Random,
    walls: Vec<BodyId>,
    pile: Vec<BodyId>,
    bullet: Option<BodyId>,
    /// The definition of the world at the start.
    usual: [Command; 6],
}

impl Pit {
    pub(crate) fn new(world: &World) -> Self {
        let def = world.def();
        let usual = [
            Command::SetTimeStep(TimeStep::hz(60)),
            Command::SetGravity(vec2(0, -10)),
            Command::SetIntegrator(def.integrator),
            Command::SetDamping { linear: Damping::NONE, angular: Damping::NONE },
            Command::SetSleepAfter(def.sleep_after),
            Command::SetContactSettings(def.contacts),
        ];
        Self { random: Random::seeded(3), walls: Vec::new(), pile: Vec::new(), bullet: None, usual }
    }

    /// Makes the commands of a tick and carries them out by `execute`, which returns the handle that a command created.
    pub(crate) fn tick(
        &mut self,
        tick: u64,
        outside: Vec<BodyId>,
        mut execute: impl FnMut(Command) -> Option<Created>,
    ) {
        let (part, [stirred, rest]) = (tick % turn(), parts());
        if Self::is_filled(tick) {
            self.walls.drain(..).for_each(|body| _ = execute(Command::RemoveBody(body)));
            let added = walls().into_iter().filter_map(|def| made(execute(Command::AddBody(def))));
            self.walls.extend(added);
            self.pile.retain(|body| !outside.contains(body));
            outside.into_iter().for_each(|body| _ = execute(Command::RemoveBody(body)));
            for i in self.pile.len()..PILE {
                let def = self.piece(i as i32);
                self.pile.extend(made(execute(Command::AddBody(def))));
            }
        }
        let Some(&paddle) = self.walls.last() else { return };
        let spin = |velocity| Command::SetAngularVelocity { body: paddle, velocity };
        if part == stirred {
            self.usual.iter().for_each(|command| _ = execute(command.clone()));
            execute(spin(fx!(3)));
        }
        if part == rest {
            execute(spin(fx!(0)));
        }
        if part % BULLETS == 0 && Phase::of(part) != Phase::Rest {
            self.bullet.into_iter().for_each(|body| _ = execute(Command::RemoveBody(body)));
            let shape = Shape::circle(fx!(0.0625)).expect("a fair radius");
            let turn = self.random.number(fx!(0)..=fx!(6));
            let (sin, cos) = turn.sin_cos();
            let def = BodyDef {
                position: CENTRE + vec2(0, HALF - 1),
                velocity: Vec2::new(cos, sin) * 300,
                bullet: true,
                ..BodyDef::dynamic().with_collider(ColliderDef { hit_events: true, ..ColliderDef::new(shape) })
            };
            self.bullet = made(execute(Command::AddBody(def)));
        }
    }

    /// Returns true at the ticks at which the pit is built anew, and the pile filled up.
    pub(crate) fn is_filled(tick: u64) -> bool {
        tick % turn() == 0
    }

    /// The bodies of the pile that left the pit, or that are taken out: they are to be replaced by others.
    pub(crate) fn outside(&self, world: &World) -> Vec<BodyId> {
        let is_inside = |body: BodyRef<'_>| {
            let is_near = |way: Vec2| way.x.abs() < HALF.into() && way.y.abs() < HALF.into();
            body.kind() == BodyKind::Dynamic
                && body.activity() != Activity::Quarantined
                && body.position().checked_sub(CENTRE).is_some_and(is_near)
        };
        self.pile.iter().copied().filter(|body| !world.body(*body).is_ok_and(is_inside)).collect()
    }

    /// A body of the pile.
    fn piece(&mut self, i: i32) -> BodyDef {
        let size = self.random.number(fx!(0.25)..=fx!(0.625));
        let (half, below) = (size / 2, self.random.below(8));
        let corners = [(-size, -half), (size, -half), (Fx::ZERO, size)].map(|(x, y)| Vec2::new(x, y));
        let wheel =
            |shape: Shape, x: Fx| Part { shape, position: Vec2::new(x, fx!(0)), angle: fx!(0), density: fx!(1) };
        let fair = "a fair size";
        let shape = match below {
            0 | 1 => Shape::circle(size),
            2 | 3 => Shape::rectangle(size * 2, size),
            4 => Shape::capsule(size, half),
            5 => Shape::segment(vec2(0, 0), Vec2::new(size, half)),
            6 => Shape::polygon(&corners),
            _ => Shape::circle(half).and_then(|disc| Shape::compound(&[wheel(disc.clone(), -half), wheel(disc, half)])),
        };
        let mut part = |max: Fx| self.random.number(fx!(0)..=max);
        let material = Material {
            friction: part(fx!(1)),
            restitution: if i % 4 == 0 { part(fx!(0.75)) } else { fx!(0) },
            rolling_resistance: if i % 3 == 0 { part(fx!(0.0625)) } else { fx!(0) },
            ..Material::default()
        };
        let filter = Filter { group: if i % 16 == 0 { -2 } else { 0 }, ..Filter::default() };
        let (contact_events, hit_events) = (i % 3 == 0, i % 5 == 0);
        let def = ColliderDef { material, filter, contact_events, hit_events, ..ColliderDef::new(shape.expect(fair)) };
        let place = vec2(i % 16 - 8, i / 16 - 6);
        BodyDef {
            position: CENTRE + place,
            bullet: i % 16 == 0,
            key: (i / 2) as u64,
            ..BodyDef::dynamic().with_collider(def)
        }
    }
}

fn made(created: Option<Created>) -> Option<BodyId> {
    created.and_then(|object| if let Created::Body(body) = object { Some(body) } else { None })
}

/// The walls, the floor (a chain), the platform, the sensor, and last the paddle.
fn walls() -> Vec<BodyDef> {
    let fair = "a fair size";
    let slab = |x: i32, y: i32, width: i32, height: i32| {
        let shape = Shape::rectangle(width, height).expect(fair);
        BodyDef { position: CENTRE + vec2(x, y), ..BodyDef::fixed().with_collider(ColliderDef::new(shape)) }
    };
    let bump = |i: i32| Vec2::new((HALF - i).into(), Fx::from_ratio(i64::from(i * i % 3), 4) - Fx::from(HALF));
    let hills: Vec<Vec2> = (0..=2 * HALF).map(bump).collect();
    let plank = Shape::rectangle(6, fx!(0.25)).expect(fair);
    let platform = ColliderDef { one_way: Some(OneWay::default()), contact_events: true, ..ColliderDef::new(plank) };
    let room = Shape::rectangle(HALF, fx!(4)).expect(fair);
    let sensor = ColliderDef { sensor: true, ..ColliderDef::new(room) };
    let blade = ColliderDef::new(Shape::rectangle(2 * HALF - 4, fx!(0.5)).expect(fair));
    let at = |y: i32, def: BodyDef| BodyDef { position: CENTRE + vec2(0, y), ..def };
    vec![
        slab(-HALF - 2, 0, 4, 4 * HALF),
        slab(HALF + 2, 0, 4, 4 * HALF),
        slab(0, HALF + 2, 2 * HALF, 4),
        slab(0, -HALF - 2, 2 * HALF, 4),
        at(0, BodyDef::fixed().with_collider(ColliderDef::new(Shape::chain(&hills, false).expect(fair)))),
        at(4, BodyDef::fixed().with_collider(platform)),
        at(-6, BodyDef::fixed().with_collider(sensor)),
        at(-1, BodyDef::kinematic().with_collider(blade)),
    ]
}
