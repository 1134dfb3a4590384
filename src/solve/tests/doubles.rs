//! Steps of the solver beside a twin in doubles.
//!
//! No formula bounds how far rounding may lead: points that open or close, and bodies split among many contacts, amplify it. So
//! the twin runs again with roundings of its own, at random and of the size of the solver's; the solver has to be about as
//! close to the exact twin as those are.

use alloc::vec::Vec;

use super::made::Ranges;
use super::twin::{Twin, Vector};
use crate::cases::run_seed;
use crate::math::Random;
use crate::scalar::FxAccumulator;

fn exact(value: FxAccumulator) -> f64 {
    value.to_bits() as f64 / 2f64.powi(96)
}

/// The largest difference of one of many quantities.
fn apart(a: &[[Vector; 2]], b: &[[Vector; 2]]) -> f64 {
    let [a, b] = [a, b].map(|of| of.as_flattened().as_flattened());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn steps_follow_a_twin_in_doubles() {
    let mut random = Random::seeded(run_seed(1));
    let cases = if cfg!(debug_assertions) { 200 } else { 3000 };
    let (mut close, mut touching) = (0, 0);
    for case in 0..cases {
        let separation = [[-0.05, 0.0], [-0.05, 0.05], [0.0, 0.05]][random.below(3) as usize];
        let ranges = Ranges { separation, mass: [-2.0, 2.0], ..Ranges::default() };
        let contacts = 1 + random.below(6) as usize;
        let mut scene = ranges.scene(&mut random, 4, contacts);
        scene.options.substeps = 1 + random.below(16) as u32;
        let twin = Twin::new(&scene, None);
        let solution = scene.solve();
        assert_eq!(solution.counts.cut, 0, "case {case}");
        let ours = solution.corrections.iter().enumerate().map(|(body, of)| {
            let velocity = [of.velocity.x, of.velocity.y, of.angular_velocity].map(exact);
            let moved = [of.displacement.x, of.displacement.y, of.rotation].map(exact);
            twin.in_units(body, [velocity, moved])
        });
        let ours: Vec<_> = ours.collect();
        let exactly = twin.run();
        let rounded = (0..24).map(|seed| apart(&exactly, &Twin::new(&scene, Some(seed)).run()));
        let (off, most) = (apart(&exactly, &ours), rounded.fold(0.0, f64::max));
        assert!(off <= 2.0 * most + 2.0, "case {case}: {off} units from the twin, where rounding explains {most}");
        touching += u32::from(solution.corrections.iter().any(|of| of.velocity.x.to_bits() != 0));
        close += u32::from(off < 64.0);
    }
    // Most are close: a few units, not only less than rounding could lead.
    assert!(touching > cases / 2 && close > cases / 2, "{touching} touch, {close} are close, of {cases}");
}
