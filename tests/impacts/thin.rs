//! Bodies of the least thickness: cards.

use umbra_physics::{Shape, fx, limits::SIZE_MIN, vec2};

use crate::impacts::scenes::{
    build, conclude, dynamic, falling, fixed, float, floating, floor, number, of_material, point, position, rectangle,
    steps, velocity,
};

/// A card of the least thickness that lies.
fn card(length: f64) -> Shape {
    rectangle(number(length), SIZE_MIN)
}

/// Cards that fall by a centimetre each lie on each other in their order. A contact yields by 0.23 mm for each card above it, in 16 sub-steps
/// by a tenth of that.
#[test]
fn piles_of_cards_of_the_least_thickness_hold() {
    let thickness = float(SIZE_MIN);
    for (count, substeps) in [(2, 5), (12, 5), (12, 16)] {
        let cards = (0..count).map(|i| dynamic(card(0.0635), point(0.0, (f64::from(i) + 0.5) * (thickness + 0.002))));
        let mut def = falling();
        def.contacts.substeps = substeps;
        let (mut world, ids) = build(def, std::iter::once(floor()).chain(cards));
        steps(&mut world, 240);
        let heights: Vec<f64> = ids[1..].iter().map(|&id| position(&world, id)[1]).collect();
        let are_apart = heights.windows(2).all(|pair| pair[1] - pair[0] > thickness / 4.0);
        assert!(are_apart && heights[0] > 0.0, "{count} cards in {substeps} sub-steps: {heights:?}");
        let speeds = ids[1..].iter().map(|&id| velocity(&world, id)).map(|[x, y]| x.hypot(y));
        assert!(speeds.clone().all(|speed| speed < 0.01), "{count} cards: {:?}", speeds.collect::<Vec<_>>());
    }
}

/// Five storeys of cards of the least thickness by 40 cm, as in the samples of Box2D, whose cards have 2 mm.
#[test]
fn a_house_of_thin_cards_stands() {
    let (half, lean) = (0.2, 25f64.to_radians());
    let mut cards = Vec::new();
    for storey in 0..5 {
        let (count, x, y) =
            (5 - storey, 0.175 * f64::from(storey), half - 0.02 + f64::from(storey) * (2.0 * half - 0.03));
        for i in 0..count {
            let x = x + 0.35 * f64::from(i);
            // Upright is a quarter turn from lying.
            let upright = std::f64::consts::FRAC_PI_2;
            cards.push((x, y, upright - lean));
            cards.push((x + 0.175, y, upright + lean));
            if i + 1 < count {
                cards.push((x + 0.25, y + half - 0.015, 0.0));
            }
        }
    }
    let card = |(x, y, angle): (f64, f64, f64)| {
        let body = dynamic(card(2.0 * half), point(x, y));
        of_material(umbra_physics::BodyDef { angle: number(angle), ..body }, fx!(0.7), fx!(0))
    };
    let ground = of_material(floor(), fx!(0.7), fx!(0));
    let (mut world, ids) = build(falling(), std::iter::once(ground).chain(cards.into_iter().map(card)));
    let top = |world: &umbra_physics::World| ids[1..].iter().map(|&id| position(world, id)[1]).fold(0.0, f64::max);
    let before = top(&world);
    steps(&mut world, 600);
    assert!(top(&world) > before - 0.1, "{before} to {}", top(&world));
}

/// Cards thrown at a wall of the least thickness, at any angle and spin, stay on their side.
#[test]
fn thin_cards_cross_no_thin_wall() {
    let mut failures = Vec::new();
    let wall = fixed(rectangle(SIZE_MIN, fx!(40)), vec2(0, 0));
    for speed in [1.0, 10.0, 100.0, 1e4, 1e6] {
        for turn in 0..8 {
            let turn = f64::from(turn);
            let mut thrown = dynamic(card(0.0635), point(-0.3 - 0.013 * turn, 0.0));
            thrown.velocity = point(speed, 0.0);
            thrown.angle = number(0.31 * turn);
            thrown.angular_velocity = number(30.0 * turn - 100.0);
            let (mut world, ids) = build(floating(), [wall.clone(), thrown]);
            for tick in 0..30 {
                world.step();
                let [x, _] = position(&world, ids[1]);
                if x > 0.0 {
                    failures.push(format!("{speed} m/s, {turn}: at {x} after {tick} steps"));
                    break;
                }
            }
        }
    }
    conclude(40, &failures);
}
