//! Pairs of outlines near each other: random ones, and those that tie.

use crate::collide::random::SplitMix;
use umbra_physics::collide::{Manifold, Pose, collide};
use umbra_physics::{Fx, Shape, Turn, Vec2, fx, vec2};

pub(crate) const KINDS: [&str; 7] = ["disc", "segment", "capsule", "box", "bar", "triangle", "polygon"];

/// A shape as what it is made from, so that it can be mirrored and renumbered.
#[derive(Clone, Debug)]
pub(crate) enum Recipe {
    Disc(Fx),
    Segment([Vec2; 2]),
    Capsule(Fx, Fx),
    Rectangle(Fx, Fx),
    Polygon(Vec<Vec2>),
}

impl Recipe {
    pub(crate) fn shape(&self) -> Option<Shape> {
        match self {
            Self::Disc(radius) => Shape::circle(*radius),
            Self::Segment([a, b]) => Shape::segment(*a, *b),
            Self::Capsule(length, radius) => Shape::capsule(*length, *radius),
            Self::Rectangle(width, height) => Shape::rectangle(*width, *height),
            Self::Polygon(corners) => Shape::polygon(corners),
        }
        .ok()
    }

    /// The mirror image, x → −x.
    pub(crate) fn mirrored(&self) -> Self {
        let flip = |v: &Vec2| Vec2::new(-v.x, v.y);
        match self {
            Self::Segment(ends) => Self::Segment([flip(&ends[1]), flip(&ends[0])]),
            Self::Polygon(corners) => Self::Polygon(corners.iter().rev().map(flip).collect()),
            _ => self.clone(),
        }
    }

    /// Returns the same shape with another first corner, and for odd numbers with the other winding.
    pub(crate) fn renumbered(&self, steps: usize) -> Self {
        match self {
            Self::Segment([a, b]) => Self::Segment([*b, *a]),
            Self::Polygon(corners) => {
                let mut corners = corners.clone();
                let count = corners.len();
                corners.rotate_left(steps / 2 % count);
                if steps % 2 == 1 {
                    corners.reverse();
                }
                Self::Polygon(corners)
            }
            _ => self.clone(),
        }
    }
}

/// Two shapes at their poses.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    pub(crate) recipes: [Recipe; 2],
    pub(crate) positions: [Vec2; 2],
    pub(crate) angles: [Turn; 2],
    pub(crate) margin: Fx,
}

impl Case {
    pub(crate) fn shapes(&self) -> [Shape; 2] {
        [0, 1].map(|i| self.recipes[i].shape().expect("a shape"))
    }

    pub(crate) fn manifold(&self) -> Option<Manifold> {
        let shapes = self.shapes();
        let pose = [0, 1].map(|i| Pose::new(self.positions[i], self.angles[i]));
        collide(&shapes[0].outlines()[0], &pose[0], &shapes[1].outlines()[0], &pose[1], self.margin)
    }
}

fn bits(random: &mut SplitMix, low: i64, high: i64) -> Fx {
    Fx::from_bits(random.between(low, high))
}

/// A size between 2^(e − 1) and 2^e ulps.
fn size(random: &mut SplitMix, e: u32) -> Fx {
    bits(random, 1 << (e - 1), 1 << e)
}

/// A shape of this kind about 2^(e − 32) m large.
pub(crate) fn recipe(random: &mut SplitMix, kind: &str, e: u32) -> Recipe {
    loop {
        let reach = 1i64 << e;
        let mut point = || Vec2::new(bits(random, -reach, reach), bits(random, -reach, reach));
        let recipe = match kind {
            "disc" => Recipe::Disc(size(random, e)),
            "segment" => Recipe::Segment([point(), point()]),
            "capsule" => Recipe::Capsule(size(random, e), size(random, e - 1)),
            "box" => Recipe::Rectangle(size(random, e), size(random, e)),
            "bar" => Recipe::Rectangle(size(random, e + 2), size(random, e - 1)),
            "triangle" => Recipe::Polygon((0..3).map(|_| point()).collect()),
            _ => {
                let count = [5, 6, 8, 9, 24, 64][random.between(0, 6) as usize];
                let corner = |i: i64| {
                    let (sin, cos) = Fx::TAU.checked_mul(Fx::from_ratio(i, count)).expect("at most a turn").sin_cos();
                    vec2(cos, sin).checked_scale(Fx::from_bits(reach)).expect("small")
                };
                Recipe::Polygon((0..count).map(corner).collect())
            }
        };
        if recipe.shape().is_some() {
            return recipe;
        }
    }
}

/// The largest distance of a shape from its centre, in ulps, about.
pub(crate) fn reach(shape: &Shape) -> i64 {
    umbra_physics::collide::radius_bound(&shape.outlines()[0]).to_bits()
}

/// A random pair whose shapes touch, nearly or deeply, or are apart.
pub(crate) fn random_case(random: &mut SplitMix, kinds: [&str; 2], exponents: [u32; 2]) -> Case {
    let recipes = [recipe(random, kinds[0], exponents[0]), recipe(random, kinds[1], exponents[1])];
    let far = recipes.iter().map(|r| reach(&r.shape().expect("a shape"))).sum::<i64>();
    let place = || Vec2::new(Fx::from_bits(0), Fx::from_bits(0));
    let mut positions = [place(), place()];
    let origin = Vec2::new(bits(random, -1 << 50, 1 << 50), bits(random, -1 << 50, 1 << 50));
    let offset = Vec2::new(bits(random, -far, far), bits(random, -far, far));
    positions[0] = origin;
    positions[1] = origin + offset;
    let angles = [0; 2].map(|_| Turn::from_bits(random.next()));
    let margin = [Fx::ZERO, fx!(0.02), Fx::from_bits(far >> 3)][random.between(0, 3) as usize];
    Case { recipes, positions, angles, margin }
}

/// A pair made to tie: aligned, stacked, corner to corner, of one pose, symmetric about a diagonal.
pub(crate) fn tied_case(random: &mut SplitMix) -> Case {
    let unit = 1i64 << random.between(29, 34);
    let f = Fx::from_bits;
    let square = Recipe::Rectangle(f(2 * unit), f(2 * unit));
    let partner = match random.between(0, 8) {
        0 => Recipe::Rectangle(f(4 * unit), f(2 * unit)),
        1 => Recipe::Disc(f(unit)),
        2 => Recipe::Capsule(f(2 * unit), f(unit / 2)),
        3 => Recipe::Segment([Vec2::new(f(-unit), f(0)), Vec2::new(f(unit), f(0))]),
        // Square as a polygon, with a corner in the middle of an edge that sticks out by an ulp.
        4 => {
            let u = unit;
            let corners = [[-u, -u], [u, -u], [u, u], [0, u + 3], [-u, u]];
            Recipe::Polygon(corners.map(|[x, y]| Vec2::new(f(x), f(y))).into())
        }
        5 => Recipe::Polygon([[0, -unit], [unit, 0], [0, unit], [-unit, 0]].map(|[x, y]| Vec2::new(f(x), f(y))).into()),
        _ => square.clone(),
    };
    let mut recipes = [square, partner];
    if random.between(0, 3) == 0 {
        recipes[0] = recipes[1].clone();
    }
    if random.between(0, 2) == 0 {
        recipes.swap(0, 1);
    }
    // Offsets in steps of half a size, give or take some ulps; angles in eighths of a turn, or one angle and its negative.
    let shake = |random: &mut SplitMix| [0, 0, 0, 1, -1, 7, -100][random.between(0, 7) as usize];
    let step = |random: &mut SplitMix| random.between(-4, 5) * (unit / 2) + shake(random);
    let (mut x, mut y) = (step(random), step(random));
    if random.between(0, 3) == 0 {
        (x, y) = (y, y);
    }
    let any = random.next();
    let angles = match random.between(0, 4) {
        0 => [any, any],
        1 => [any, any.wrapping_neg()],
        _ => [0, 1].map(|_| (random.between(0, 8) as u64) << 61),
    }
    .map(Turn::from_bits);
    // Along the axes of the first, or of the world.
    let offset = Vec2::new(f(x), f(y));
    let turned = angles[0].rotate(offset).and_then(|v| v.try_map(umbra_physics::FxWide::to_scalar)).expect("small");
    let offset = if random.between(0, 2) == 0 { offset } else { turned };
    let origin = Vec2::new(bits(random, -1 << 62, 1 << 62), bits(random, -1 << 62, 1 << 62));
    let margin = [Fx::ZERO, fx!(0.02), f(unit)][random.between(0, 3) as usize];
    Case { recipes, positions: [origin, origin + offset], angles, margin }
}

/// A pair with an edge on an edge, or nearly: parallel but for some units of the angle, apart or sunk by little.
pub(crate) fn resting_case(random: &mut SplitMix, exponents: [u32; 2]) -> Case {
    let mut half = [[0i64; 2]; 2];
    let recipes = [0, 1].map(|i| {
        let e = exponents[i];
        let even = |random: &mut SplitMix, e: u32| random.between(1 << (e - 2), 1 << (e - 1));
        let (x, y) = (even(random, e), even(random, e));
        let f = |half: i64| Fx::from_bits(2 * half);
        let (recipe, reach) = match random.between(0, 5) {
            0 => (Recipe::Capsule(f(x), Fx::from_bits(y)), [x + y, y]),
            1 => (Recipe::Segment([-x, x].map(|x| Vec2::new(Fx::from_bits(x), Fx::ZERO))), [x, 0]),
            2 => (Recipe::Disc(Fx::from_bits(x)), [x, x]),
            3 => {
                let corners = [[-x, 0], [x / 3, -y], [x, 0], [-x / 3, y]];
                let corners = corners.map(|[x, y]| Vec2::new(Fx::from_bits(x), Fx::from_bits(y)));
                (Recipe::Polygon(corners.into()), [x, y])
            }
            _ => (Recipe::Rectangle(f(x), f(y)), [x, y]),
        };
        half[i] = reach;
        recipe
    });
    let small = |random: &mut SplitMix, e: u32| random.of_bits(e);
    let turn = random.next();
    let quarter = random.between(0, 4) as u64;
    // Turned by a quarter, the other extent is upwards.
    let [side, up] = if quarter & 1 == 1 { [half[1][1], half[1][0]] } else { half[1] };
    let x = random.between(-half[0][0] - side, half[0][0] + side + 1);
    let x = if random.between(0, 4) == 0 { (half[0][0] - side) * random.between(-1, 2) } else { x };
    let y = half[0][1] + up + small(random, exponents[0].min(exponents[1]) - 4);
    let tilt = [0, small(random, 20), small(random, 50)][random.between(0, 3) as usize] as u64;
    let angles = [turn, turn.wrapping_add(quarter << 62).wrapping_add(tilt)].map(Turn::from_bits);
    let offset = Vec2::new(Fx::from_bits(x), Fx::from_bits(y));
    let offset = angles[0].rotate(offset).and_then(|v| v.try_map(umbra_physics::FxWide::to_scalar)).expect("small");
    let origin = Vec2::new(bits(random, -1 << 60, 1 << 60), bits(random, -1 << 60, 1 << 60));
    let margin = [Fx::ZERO, fx!(0.02)][random.between(0, 2) as usize];
    Case { recipes, positions: [origin, origin + offset], angles, margin }
}

/// A shape with edges along the axes and the diagonals, whose corners are multiples of two steps.
fn lattice_recipe(random: &mut SplitMix, step: i64) -> Recipe {
    let size = |random: &mut SplitMix, max| 2 * random.between(1, max) * step;
    let (x, y, cut) = (size(random, 16), size(random, 16), size(random, 6));
    let f = Fx::from_bits;
    let polygon = |corners: &[[i64; 2]]| Recipe::Polygon(corners.iter().map(|&[x, y]| Vec2::new(f(x), f(y))).collect());
    let far = x + cut;
    let octagon = [[-x, -far], [x, -far], [far, -x], [far, x], [x, far], [-x, far], [-far, x], [-far, -x]];
    match random.between(0, 11) {
        0 | 1 => Recipe::Rectangle(f(2 * x), f(2 * y)),
        2 => Recipe::Rectangle(f(2 * x), f(2 * x)),
        3 => Recipe::Disc(f(x)),
        4 => Recipe::Capsule(f(2 * x), f(cut)),
        5 => Recipe::Segment([-x, x].map(|x| Vec2::new(f(x), Fx::ZERO))),
        6 => Recipe::Segment([-x, x].map(|x| Vec2::new(f(x), f(x)))),
        7 => polygon(&[[-x, 0], [0, -x], [x, 0], [0, x]]),
        8 => polygon(&[[-x - y, -y], [x - y, -y], [x + y, y], [y - x, y]]),
        9 => polygon(&[[-x - y, 0], [-x, -y], [x, -y], [x + y, 0], [x, y], [-x, y]]),
        _ => polygon(&octagon),
    }
}

/// A pair of such shapes, turned by quarters, an even number of steps apart: no number of it is rounded but the normals of diagonals.
pub(crate) fn lattice_case(random: &mut SplitMix) -> Case {
    let step = 1i64 << random.between(24, 36);
    let first = lattice_recipe(random, step);
    let second = if random.between(0, 3) == 0 { first.clone() } else { lattice_recipe(random, step) };
    let recipes = [first, second];
    let far = recipes.iter().map(|r| reach(&r.shape().expect("a shape"))).sum::<i64>() / (2 * step);
    let mut part = || 2 * step * random.between(-far, far + 1);
    let (x, y) = (part(), part());
    let (x, y) = [(x, y), (x, x), (x, 0), (0, y)][random.between(0, 4) as usize];
    let origin = Vec2::new(bits(random, -1 << 60, 1 << 60), bits(random, -1 << 60, 1 << 60));
    let offset = Vec2::new(Fx::from_bits(x), Fx::from_bits(y));
    let angles = [0; 2].map(|_| Turn::from_bits((random.next() & 3) << 62));
    // Along diagonals a separation that is exactly the margin may round to either side of it.
    let is_straight = |r: &Recipe| matches!(r, Recipe::Rectangle(..) | Recipe::Capsule(..) | Recipe::Disc(_));
    let more = if recipes.iter().all(is_straight) { 0 } else { random.between(step / 4, step / 2) };
    let margin = Fx::from_bits(random.between(0, 3) * step + more);
    Case { recipes, positions: [origin, origin + offset], angles, margin }
}
