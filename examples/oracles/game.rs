//! Three ships around a ball that lies free, until one of them takes it in tow.
//!
//! The first version has a defect: if two players reach for the ball in the same tick, the player whose packet came first gets
//! it, so peers may disagree.

use umbra_oracles::Game;
use umbra_physics::Symmetry;
use umbra_physics::{
    ApplyOptions, Attachment, BodyDef, BodyId, Command, Damping, End, FieldKind, ForceOrImpulse, Fx, Mass, Random,
    SpringConstants, Stepper, Vec2, World, WorldDef, fx, vec2,
};

/// Reach of a ship, m, between the centres of the ship and the ball.
const REACH: Fx = fx!(3);
/// Impulse of a thrust, N·s.
const THRUST: Fx = fx!(4);

pub(crate) const PLAYERS: usize = 3;

/// Action of a player.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Action {
    /// A thrust in a direction.
    Thrust(Vec2),
    /// Takes the ball in tow, if it is free and within reach.
    Grab,
}

/// An action and its player.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Input {
    pub(crate) player: usize,
    pub(crate) action: Action,
}

/// Bots: random actions in each tick.
pub(crate) fn bots(random: &mut Random) -> Vec<Input> {
    let mut inputs = Vec::new();
    for player in 0..PLAYERS {
        match random.below(12) {
            0 => inputs.push(Input { player, action: Action::Grab }),
            way @ 1..5 => {
                let direction = [Vec2::X, Vec2::Y, -Vec2::X, -Vec2::Y][way as usize - 1];
                inputs.push(Input { player, action: Action::Thrust(direction) });
            }
            _ => {}
        }
    }
    inputs
}

/// Handles that are fixed for a match; everything else is in the world. The ball's user data says who has it: 0 for nobody,
/// then the players.
#[derive(Clone, Debug)]
pub(crate) struct Tow {
    ships: [BodyId; PLAYERS],
    ball: BodyId,
    /// True if inputs are processed by player, in whatever order they arrive.
    pub(crate) is_mended: bool,
}

impl Tow {
    /// A match before its start.
    pub(crate) fn new(is_mended: bool) -> Self {
        let nobody = BodyId::from_parts(u32::MAX, 0);
        Self { ships: [nobody; PLAYERS], ball: nobody, is_mended }
    }

    /// Effect of an action on the world.
    fn act(&self, world: &mut World, Input { player, action }: Input, driver: &mut dyn Stepper) -> Option<()> {
        let ship = self.ships[player];
        match action {
            Action::Thrust(direction) => {
                let action = ForceOrImpulse::Impulse { impulse: direction.checked_scale(THRUST)?, point: None };
                driver.execute(world, &Command::Apply { body: ship, action, options: ApplyOptions::default() }).ok()?;
            }
            Action::Grab => {
                let ball = world.body(self.ball).ok()?;
                let apart = world.body(ship).ok()?.position() - ball.position();
                if ball.user_data() == 0 && apart.checked_length()? <= REACH {
                    let spring = SpringConstants { rest: fx!(1), stiffness: fx!(20), damping: fx!(1) };
                    let tow = FieldKind::Spring {
                        near: Attachment::centre(ship),
                        far: End::Body(Attachment::centre(self.ball)),
                        spring,
                    };
                    driver.execute(world, &Command::AddField(tow.into())).ok()?;
                    let whose = Command::SetUserData { body: self.ball, user_data: 1 + player as u64 };
                    driver.execute(world, &whose).ok()?;
                }
            }
        }
        Some(())
    }
}

impl Game for Tow {
    type Input = Input;

    fn start(&mut self) -> World {
        let mut world =
            World::new(WorldDef { linear_damping: Damping::kept_per_second(fx!(0.5)), ..WorldDef::default() })
                .expect("a fair world");
        let mut add = |def| world.add_body(def).expect("a fair body");
        self.ball = add(BodyDef { mass: Mass::Kilograms(fx!(0.5)), ..BodyDef::dynamic() });
        // On their way to the ball, which they come to at the same time.
        let starts = [(vec2(-5, 0), vec2(3, 0)), (vec2(4, 3), vec2(fx!(-2.4), fx!(-1.8))), (vec2(4, -3), vec2(-2, 1))];
        let mut key = 0;
        self.ships = starts.map(|(position, velocity)| {
            key += 1;
            add(BodyDef { position, velocity, mass: Mass::Kilograms(fx!(2)), key, ..BodyDef::dynamic() })
        });
        world
    }

    fn tick(&mut self, world: &mut World, inputs: &[Input], driver: &mut dyn Stepper) {
        let mut inputs = inputs.to_vec();
        if self.is_mended {
            inputs.sort_by_key(|input| input.player);
        }
        for input in inputs {
            // An impossible action is ignored.
            let _ = self.act(world, input, driver);
        }
        driver.step(world);
    }

    /// The game does not depend on left and right, nor on its place.
    fn symmetries(&self) -> Vec<Symmetry> {
        let shift = Symmetry::shift(vec2(1_000, -777));
        [Symmetry::MIRROR, Symmetry::FLIP, Symmetry::DIAGONAL, Symmetry::TURN].into_iter().chain(shift).collect()
    }

    fn image(&self, input: &Input, symmetry: &Symmetry) -> Option<Input> {
        Some(match input.action {
            Action::Thrust(direction) => Input { action: Action::Thrust(symmetry.vector(direction)?), ..*input },
            Action::Grab => *input,
        })
    }
}
