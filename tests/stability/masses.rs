//! Mass ratios up to all that the limits admit.

use umbra_physics::limits::{MASS_MAX, MASS_MIN};
use umbra_physics::{Fx, Integrator, fx};

use crate::seeds::times;
use crate::stability::long::Run;
use crate::stability::scene::{Gravity, Scene, Spring, bits};

const RATE: u32 = 240;
/// The last is 2^40 to 1.
const MASSES: [[Fx; 2]; 4] = [[fx!(1), fx!(1)], [fx!(1000), fx!(1)], [fx!(1000000), fx!(1)], [MASS_MAX, MASS_MIN]];

/// On a spring of 8 m, with ω² of 16 (1 + light/heavy).
fn on_a_spring(masses: [Fx; 2]) -> Run {
    let mut scene = Scene::pair(masses, fx!(10), fx!(5));
    scene.springs.push(Spring { near: 0, far: Some(1), rest: fx!(8), stiffness: masses[1] * fx!(16) });
    Run { name: "spring", scene, rate: RATE, fastest: 32f64.sqrt(), is_free: true }
}

/// About each other, from 10 m, with G·(M + m) of about 1,000: e = 0.36, and 3.6 rad/s when nearest.
fn in_orbit(masses: [Fx; 2]) -> Run {
    let mut scene = Scene::pair(masses, fx!(10), fx!(8));
    scene.gravity = Some(Gravity { constant: fx!(1000) / (masses[0] + masses[1]), softening: fx!(0) });
    Run { name: "orbit", scene, rate: RATE, fastest: 3.6, is_free: true }
}

fn runs() -> impl Iterator<Item = Run> {
    MASSES.into_iter().flat_map(|masses| [on_a_spring(masses), in_orbit(masses)])
}

#[test]
fn light_and_heavy_bodies_keep_energy_and_momenta() {
    runs().for_each(|run| run.assert_keeps(times(30_000)));
}

#[test]
fn light_and_heavy_bodies_do_not_keep_them_in_f32() {
    runs().for_each(|run| run.assert_f32_fails(10_000));
}

#[test]
fn a_heavy_body_that_a_light_one_pulls_below_half_an_ulp_a_second_keeps_its_place_and_its_momentum() {
    let run = in_orbit([MASS_MAX, MASS_MIN]);
    let mut world = run.scene.world::<Fx>(RATE, Integrator::VelocityVerlet);
    let [x, y, ..] = bits(&world)[0];
    let mut fastest = 0;
    for _ in 0..10_000 {
        world.step();
        let [now_x, now_y, v, w] = bits(&world)[0];
        assert_eq!([now_x, now_y], [x, y]);
        fastest = fastest.max(v.abs()).max(w.abs());
    }
    // Some 15 m/s of the light one at the most, by 2^40: in units of 2^-96 m/s, of which half an ulp has 2^63.
    assert!(fastest > 1 << 58 && fastest < 1 << 63, "{fastest}");
}
