//! Formulas against a numerical solution of another kind, and by hand.

use umbra_scene::Scene;

use super::super::{BITS, MORE_BITS};
use super::*;

/// A slope of 3 in 4 whose surface goes through the origin, and a floor at height 0.
const SLOPE: &str = r#"{"name": "slope", "kind": "static", "position": [0.75, -1], "colliders": [{"friction": MU, "shape":
    {"polygon": [[31.25, 25], [-32.75, -23], [-31.25, -25], [32.75, 23]]}}]}"#;
const FLOOR: &str = r#"{"name": "floor", "kind": "static", "position": [0, -1], "colliders": [{"friction": MU, "shape":
    {"rectangle": {"width": 64, "height": 2}}}]}"#;

fn world(body: &str, ground: &str, friction: f64) -> World {
    let text = format!(r#"{{"gravity": [0, -10], "bodies": [{body}, {ground}]}}"#);
    let text = text.replace("MU", &friction.to_string());
    Scene::parse(&text).expect("a scene").build().expect("a world")
}

fn slope_disc(radius: f64, friction: f64, start: &str) -> World {
    let centre = [-0.6 * radius, 0.8 * radius];
    let body = format!(
        r#"{{"name": "disc", "position": {centre:?}, {start} "colliders": [{{"friction": MU, "shape": {{"circle": {{"radius": {radius}}}}}}}]}}"#
    );
    world(&body, SLOPE, friction)
}

fn floor_disc(height: f64, friction: f64, restitution: f64, spin: f64) -> World {
    let body = format!(
        r#"{{"name": "disc", "position": [0, {height}], "angular_velocity": {spin}, "colliders":
            [{{"friction": MU, "restitution": {restitution}, "shape": {{"circle": {{"radius": 0.375}}}}}}]}}"#
    );
    world(&body, FLOOR, friction)
}

/// A disc, or with infinite inertia a block, on a plane through the origin.
struct Stepped {
    /// x, y, v_x, v_y, ω
    state: [f64; 5],
    away: [f64; 2],
    radius: f64,
    /// Inertia over mass and the square of the radius.
    inertia: f64,
    friction: f64,
    restitution: f64,
}

impl Stepped {
    /// The place after a time, by semi-implicit Euler in steps of a microsecond with an impulse wherever the body has
    /// reached the plane and still approaches: errs by some steps' way at each impact and at each change from sliding.
    fn place(&self, seconds: f64) -> [f64; 2] {
        const STEP: f64 = 1e-6;
        let [mut x, mut y, mut vx, mut vy, mut spin] = self.state;
        let [nx, ny] = self.away;
        for _ in 0..(seconds / STEP).round() as u64 {
            vy -= 10.0 * STEP;
            let approach = -(vx * nx + vy * ny);
            if x * nx + y * ny <= self.radius + 1e-12 && approach > 0.0 {
                let share = if approach > 1.0 { 1.0 + self.restitution } else { 1.0 };
                let (tx, ty) = (ny, -nx);
                let slip = vx * tx + vy * ty + spin * self.radius;
                let limit = self.friction * approach * share;
                let along = (-slip / (1.0 + 1.0 / self.inertia)).clamp(-limit, limit);
                vx += nx * approach * share + tx * along;
                vy += ny * approach * share + ty * along;
                if self.radius > 0.0 {
                    spin += along / (self.inertia * self.radius);
                }
            }
            (x, y) = (x + vx * STEP, y + vy * STEP);
        }
        [x, y]
    }

    fn disc(radius: f64, friction: f64, away: [f64; 2], [vx, vy, spin]: [f64; 3]) -> Self {
        let [x, y] = away.map(|n| n * radius);
        Self { state: [x, y, vx, vy, spin], away, radius, inertia: 0.5, friction, restitution: 0.0 }
    }
}

fn assert_near(values: Option<Vec<Real>>, expected: [f64; 2], tolerance: f64, case: &str) {
    let values: Vec<f64> = values.unwrap_or_else(|| panic!("{case}: no formula")).iter().map(to_f64).collect();
    let off = (values[0] - expected[0]).hypot(values[1] - expected[1]);
    assert!(off < tolerance, "{case}: {values:?} for {expected:?}");
}

const UPHILL: [f64; 2] = [-0.6, 0.8];

#[test]
fn discs_go_where_small_steps_lead() {
    let at = |world: &World| disc(world, &real(3), BITS);
    // 2 m/s² down the slope for each m/s² of 3 that it would slide: it rolls at once.
    let rolling = slope_disc(0.625, 0.5, "");
    let stepped = Stepped::disc(0.625, 0.5, UPHILL, [0.0; 3]);
    assert_near(at(&rolling), stepped.place(3.0), 1e-4, "rolling");
    // Spun against the way, it slides first; thrown up the slope it comes back.
    let spun = slope_disc(0.625, 0.5, r#""angular_velocity": -8,"#);
    let stepped = Stepped::disc(0.625, 0.5, UPHILL, [0.0, 0.0, -8.0]);
    assert_near(at(&spun), stepped.place(3.0), 1e-4, "spun");
    let thrown = slope_disc(0.625, 0.5, r#""velocity": [4, 3],"#);
    let stepped = Stepped::disc(0.625, 0.5, UPHILL, [4.0, 3.0, 0.0]);
    assert_near(at(&thrown), stepped.place(3.0), 1e-4, "thrown");
    // Friction slows the slide of a disc that lands with spin; with much friction the impact ends it.
    for friction in [0.25, 8.0] {
        let landing = floor_disc(1.375, friction, 0.0, -48.0);
        let stepped = Stepped::disc(0.375, friction, [0.0, 1.0], [0.0, 0.0, -48.0]);
        let stepped = Stepped { state: [0.0, 1.375, 0.0, 0.0, -48.0], ..stepped };
        assert_near(at(&landing), stepped.place(3.0), 1e-4, "landing");
    }
    let ball = floor_disc(2.375, 0.5, 0.75, 0.0);
    let stepped = Stepped::disc(0.375, 0.5, [0.0, 1.0], [0.0; 3]);
    let stepped = Stepped { state: [0.0, 2.375, 0.0, 0.0, 0.0], restitution: 0.75, ..stepped };
    assert_near(at(&ball), stepped.place(3.0), 1e-4, "bouncing");
}

#[test]
fn blocks_go_where_small_steps_lead() {
    let block = |velocity: &str, friction| {
        let shape = "[[0.40625, 0.5], [-0.59375, -0.25], [-0.40625, -0.5], [0.59375, 0.25]]";
        let body = format!(
            r#"{{"name": "block", "position": [-0.09375, 0.125], "velocity": {velocity},
                "colliders": [{{"friction": MU, "shape": {{"polygon": {shape}}}}}]}}"#
        );
        world(&body, SLOPE, friction)
    };
    for (text, [vx, vy], friction) in [
        // Stops; goes on faster and faster; is slowed, and has not stopped yet.
        ("[-1.625, -1.21875]", [-1.625, -1.21875], 0.875),
        ("[-1, -0.75]", [-1.0, -0.75], 0.5),
        ("[-4, -3]", [-4.0, -3.0], 0.8125),
    ] {
        let stepped = Stepped {
            state: [-0.09375, 0.125, vx, vy, 0.0],
            away: UPHILL,
            radius: 0.15625,
            inertia: f64::INFINITY,
            friction,
            restitution: 0.0,
        };
        assert_near(slide(&block(text, friction), &real(3), BITS), stepped.place(3.0), 1e-4, text);
    }
    // Up the slope it stops and slides back, unless friction holds it.
    assert_eq!(slide(&block("[4, 3]", 0.5), &real(3), BITS), None);
    assert!(slide(&block("[4, 3]", 0.875), &real(3), BITS).is_some());
    assert_eq!(slide(&block("[0, 0]", 0.5), &real(3), BITS), None);
}

#[test]
fn places_are_known_by_hand() {
    // √(2/5) s down; then at 3/4, 9/16, ... of the speed each.
    let down = 0.4f64.sqrt();
    let after = |t: f64| disc(&floor_disc(2.375, 0.5, 0.75, 0.0), &t.exact(), MORE_BITS);
    assert_near(after(down / 2.0), [0.0, 0.375 + 1.5], 1e-14, "half way down");
    assert_near(after(down * 1.75), [0.0, 0.375 + 2.0 * 0.5625], 1e-14, "top of the first bounce");
    assert_near(after(down * (2.5 + 0.5625)), [0.0, 0.375 + 2.0 * 0.5625f64.powi(2)], 1e-14, "top of the second one");
    // 2/3 · 6 m/s² for two seconds.
    assert_near(disc(&slope_disc(0.625, 0.5, ""), &real(2), BITS), [-0.375 - 6.4, 0.5 - 4.8], 1e-14, "rolling");
}

#[test]
fn motions_of_another_kind_have_no_formula() {
    let at = |world: &World| disc(world, &real(3), BITS);
    assert_eq!(at(&slope_disc(0.625, 0.125, "")), None, "it slides down for ever");
    assert_eq!(at(&floor_disc(2.375, 0.5, 0.75, 1.0)), None, "it spins and bounces");
    let turned = r#"{"name": "floor", "kind": "static", "position": [0, -1], "angle": 0.1,
        "colliders": [{"friction": MU, "shape": {"rectangle": {"width": 64, "height": 2}}}]}"#;
    let body =
        r#"{"name": "disc", "position": [0, 2], "colliders": [{"friction": MU, "shape": {"circle": {"radius": 1}}}]}"#;
    assert!(at(&world(body, FLOOR, 0.5)).is_some());
    assert_eq!(at(&world(body, turned, 0.5)), None, "a plane that is turned");
    assert_eq!(at(&world(body, &FLOOR.replace("MU", "0.25"), 0.5)), None, "two coefficients of friction");
    assert_eq!(slide(&world(body, FLOOR, 0.5), &real(3), BITS), None, "it is above the plane");
}
