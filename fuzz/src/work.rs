//! Cost of a step at worst: scenes of 1,000 bodies made from a few bytes.
//!
//! The first bytes say what there is: an integrator, and how many bodies and fields of which kind. The others are values:
//! places, speeds, masses, strengths, up to the limits. Two scenes of the same first bytes have to cost about the same,
//! which `benches/worst.rs` looks into by counting instructions; the target sees to it that any of them can be stepped at
//! all, and that no step takes out of proportion long, which libFuzzer's own timeout says.

use umbra_physics::{
    ApplyOptions, Attachment, BodyDef, BodyId, BodyKind, ColliderDef, Command, Damping, End, FieldKind, ForceField,
    ForceOrImpulse, Fx, FxFactor, Integrator, Mass, Random, Region, Shape, SpringConstants, TimeStep, Vec2, World,
    WorldDef, fx, vec2,
};

/// Number of bodies.
pub const BODIES: usize = 1_000;
/// Bytes that say what there is, and bytes in all.
pub const KINDS: usize = 12;
pub const BYTES: usize = 48;

/// A scene as bytes.
pub type Genes = [u8; BYTES];

/// The target.
pub fn run(data: &[u8]) {
    let mut genes = [0; BYTES];
    let count = data.len().min(BYTES);
    genes[..count].copy_from_slice(&data[..count]);
    let mut scene = Busy::new(&genes);
    let calm = Busy::new(&calm(&genes));
    assert_eq!(scene.counts(), calm.counts(), "what there is is no matter of values");
    for _ in 0..4 {
        scene.push();
        scene.world.step();
    }
}

/// The scene of the same kinds with everyday values.
#[must_use]
pub fn calm(genes: &Genes) -> Genes {
    let mut calm = CALM;
    calm[..KINDS].copy_from_slice(&genes[..KINDS]);
    calm
}

/// A scene from hexadecimal digits.
#[must_use]
pub fn genes(text: &str) -> Option<Genes> {
    let mut genes = [0; BYTES];
    for (i, byte) in genes.iter_mut().enumerate() {
        *byte = u8::from_str_radix(text.get(2 * i..2 * i + 2)?, 16).ok()?;
    }
    (text.len() == 2 * BYTES).then_some(genes)
}

/// Everyday values, each in its place: a byte of 128 is the everyday size.
const CALM: Genes = [128; BYTES];

/// A world and what is pushed in it before each step.
pub struct Busy {
    /// The world.
    pub world: World,
    pushed: Vec<BodyId>,
    force: Vec2,
    torque: Fx,
}

/// Reads the values, one byte after the other.
struct Values<'a> {
    rest: &'a [u8],
    random: Random,
}

impl Values<'_> {
    fn byte(&mut self) -> u8 {
        let (byte, rest) = self.rest.split_first().unwrap_or((&128, &[]));
        self.rest = rest;
        *byte
    }

    /// `usual` at 128, and from there by quarters of powers of two up and down, to 2^±32 of it, within the two.
    fn size(&mut self, usual: Fx, min: Fx, max: Fx) -> Fx {
        let byte = i32::from(self.byte()) - 128;
        let (octaves, quarters) = (byte.div_euclid(4), byte.rem_euclid(4));
        let bits = i128::from(usual.to_bits()) * (4 + i128::from(quarters)) / 4;
        let bits = if octaves >= 0 { bits << octaves } else { bits >> -octaves };
        Fx::from_bits(bits.clamp(min.to_bits().into(), max.to_bits().into()) as i64)
    }

    /// A value of either sign, up to a size.
    fn number(&mut self, size: Fx) -> Fx {
        self.random.number(-size..=size)
    }

    fn vector(&mut self, size: Fx) -> Vec2 {
        Vec2::new(self.number(size), self.number(size))
    }
}

impl Busy {
    /// The scene that these bytes are.
    #[must_use]
    pub fn new(genes: &Genes) -> Self {
        let [integrator, sleeps, springs, dampers, attractors, drags, zones, thrusts, pushes, damped, levers, kinds] =
            *genes.first_chunk().expect("there are as many");
        let many = |byte: u8| usize::from(byte % 5) * BODIES / 4;
        let integrator = Integrator::ALL[usize::from(integrator) % Integrator::ALL.len()];
        let mut values = Values { rest: &genes[KINDS..], random: Random::seeded(1) };

        let rate = [60, 1, 2, 30, 64, 144, 1_000, 10_000][usize::from(values.byte() % 128) % 8];
        let ticks = u32::from(values.byte() % 128) + 1;
        // No damping at all is another kind of scene; Yoshida's cannot take away all.
        let mut share = || match damped % 4 {
            0 => Fx::ONE,
            _ => Fx::from_bits(i64::from(values.byte()) << 24 | 1),
        };
        let (linear, angular) = (share(), share());
        let gravity = values.size(fx!(10), Fx::ZERO, fx!(65536));
        let def = WorldDef {
            time_step: TimeStep::hz(rate),
            gravity: Vec2::new(Fx::ZERO, -gravity),
            integrator,
            linear_damping: Damping::kept_per_second(linear),
            angular_damping: Damping::kept_per_second(angular),
            sleep_after: if sleeps % 2 == 0 { None } else { Some(ticks) },
            ..WorldDef::default()
        };
        let mut world = World::new(def).expect("all within its limits");

        let apart = values.size(fx!(4), Fx::ZERO, fx!(32768));
        let off = values.size(fx!(1), Fx::ZERO, fx!(1000000000));
        let speed = values.size(fx!(4), Fx::ZERO, fx!(1048576));
        let spin = values.size(fx!(1), Fx::DELTA, fx!(1048576));
        let mass = values.size(fx!(1), fx!(0.0000152587890625), fx!(16777216));
        let radius = values.size(fx!(0.5), fx!(0.0078125), fx!(4096));
        // How many kinds of gravity scale and damping there are; how many bodies have a place of their own.
        let factor_table = [1, 2, 7, 1_000][usize::from(values.byte() % 128) % 4];
        let places = [BODIES, 1, 31][usize::from(values.byte() % 128) % 3];
        let disc = ColliderDef::ghost(Shape::circle(radius).expect("a fair radius"));
        let mut ids = Vec::new();
        for i in 0..BODIES {
            let kind = if i < many(kinds) / 2 { BodyKind::Kinematic } else { BodyKind::Dynamic };
            let place = vec2((i % places % 32) as i32, (i % places / 32) as i32);
            let steps = |x: Fx| x.saturating_mul(apart);
            let position = Vec2::new(steps(place.x) + off, steps(place.y) - off);
            let own_limit =
                |max: Fx| (factor_table > 1).then(|| Fx::from_bits(max.to_bits() - (i % factor_table) as i64 * 4_097));
            let own_damping = |kept| {
                let kept = own_limit(kept).filter(|_| damped % 4 != 0);
                kept.map(|kept| Damping::kept_per_second(kept.max(Fx::DELTA)))
            };
            let def = BodyDef {
                kind,
                position: position.map(|x| x.clamp(fx!(-1073741824), fx!(1073741824))),
                angle: values.number(fx!(3)),
                velocity: values.vector(speed),
                angular_velocity: values.number(spin),
                mass: Mass::Kilograms(mass),
                gravity_scale: own_limit(fx!(16)).unwrap_or(fx!(1)),
                linear_damping: own_damping(linear),
                angular_damping: own_damping(angular),
                ..BodyDef::dynamic().with_collider(disc.clone())
            };
            ids.push(world.add_body(def).expect("all within its limits"));
        }
        // Dynamic ones, in the order of their handles, for what is attached.
        let dynamic = &ids[many(kinds) / 2..];

        let stiffness = values.size(fx!(5), Fx::DELTA, fx!(1000000000));
        let rest = values.size(fx!(4), Fx::ZERO, fx!(1073741824));
        let damping = if dampers % 2 == 0 { Fx::ZERO } else { values.size(fx!(0.5), Fx::DELTA, fx!(1000000000)) };
        let lever = if levers % 2 == 0 { Vec2::ZERO } else { vec2(values.size(fx!(0.25), Fx::DELTA, fx!(4096)), 0) };
        let stride = [1, 2, 17, dynamic.len() / 2][usize::from(values.byte() % 128) % 4];
        let mut add = |kind: FieldKind| {
            world.add_field(ForceField { kind, force_groups: u32::MAX }).map(drop).expect("a fair field")
        };
        for i in 0..many(springs) {
            let near = Attachment { body: dynamic[i % dynamic.len()], point: lever };
            let far = Attachment { body: dynamic[(i + stride) % dynamic.len()], point: lever };
            add(FieldKind::Spring { near, far: End::Body(far), spring: SpringConstants { rest, stiffness, damping } });
        }
        let mu = values.size(fx!(100), Fx::DELTA, Fx::MAX);
        let (mu, more) = (FxFactor::from_scalar(mu), u64::from(values.byte() / 129));
        let mu = mu.times(FxFactor::from_ratio(1 + (more << 32), 1));
        let softening = values.size(fx!(1), Fx::ZERO, fx!(4096));
        for (i, &body) in dynamic.iter().enumerate().take(usize::from(attractors % 5)) {
            // One of them is carried by a body, if there are many.
            let at = Attachment { body, point: lever };
            let centre = if i == 3 { End::Body(at) } else { End::World(vec2(i as i32 * 7, -3)) };
            add(FieldKind::Attractor { centre, mu, softening });
        }
        let linear = values.size(fx!(0.25), Fx::DELTA, fx!(1000000000));
        let quadratic = values.size(fx!(0.25), Fx::DELTA, fx!(1000000000));
        let wind = values.size(fx!(2), Fx::ZERO, fx!(1000000));
        for _ in 0..drags % 4 {
            add(FieldKind::Drag { linear, quadratic, wind: vec2(wind, 0) });
        }
        let reach = values.size(fx!(1000000), Fx::DELTA, fx!(1073741824));
        let acceleration = vec2(values.size(fx!(1), Fx::DELTA, fx!(65536)), 0);
        for i in 0..zones % 4 {
            let region = if i % 2 == 0 {
                Region::Disc { centre: Vec2::ZERO, radius: reach }
            } else {
                Region::Box { min: vec2(-reach, -reach), max: vec2(reach, reach) }
            };
            add(FieldKind::Zone { region, acceleration });
        }
        let thrust = values.size(fx!(1), Fx::DELTA, fx!(1000000000));
        for i in 0..many(thrusts) {
            let at = Attachment { body: dynamic[i % dynamic.len()], point: lever };
            add(FieldKind::Thrust { at, force: vec2(thrust, thrust) });
        }
        let push = values.size(fx!(1), Fx::DELTA, fx!(1000000000));
        let torque = values.size(fx!(1), Fx::DELTA, fx!(1000000000));
        let pushed = dynamic.iter().copied().take(many(pushes)).collect();
        Self { world, pushed, force: vec2(push, -push), torque }
    }

    /// Applies the forces of a tick.
    pub fn push(&mut self) {
        let options = ApplyOptions { wake: false, ..ApplyOptions::default() };
        for &body in &self.pushed {
            let force = ForceOrImpulse::Force { force: self.force, point: None };
            for action in [force, ForceOrImpulse::Torque(self.torque)] {
                // Who was taken out feels nothing.
                _ = self.world.execute(&Command::Apply { body, action, options });
            }
        }
    }

    /// Numbers of things in the scene: bodies of each kind, and fields of each kind with what they depend on.
    #[must_use]
    pub fn counts(&self) -> Vec<(String, usize)> {
        let bodies = self.world.bodies().map(|body| format!("{:?}", body.kind()));
        let fields = self.world.fields().map(|(_, field)| match &field.kind {
            FieldKind::Attractor { centre: End::World(_), .. } => "attractor".to_string(),
            FieldKind::Attractor { .. } => "carried attractor".to_string(),
            FieldKind::Spring { spring, .. } => format!("spring, damped: {}", spring.damping != Fx::ZERO),
            FieldKind::Drag { .. } => "drag".to_string(),
            FieldKind::Friction { .. } => "friction".to_string(),
            FieldKind::Thrust { .. } => "thrust".to_string(),
            FieldKind::Zone { .. } => "zone".to_string(),
            FieldKind::Buoyancy { .. } => "buoyancy".to_string(),
            _ => "custom force".to_string(),
        });
        let mut all: Vec<String> = bodies.chain(fields).chain([format!("pushed: {}", self.pushed.len())]).collect();
        all.sort();
        all.chunk_by(|a, b| a == b).map(|same| (same[0].clone(), same.len())).collect()
    }
}
