//! Promises are kept up to their bounds, and scenes have the symmetries that they claim.

use super::rows::Length;
use super::run::Run;
use super::scenes;
use super::*;
use umbra_physics::fx;

fn judged(value: f64, promise: Option<Promise>, open: bool) -> Verdict {
    let measure = Measure { name: "largest_shift", about: "", unit: "m", value, promise, open };
    Judged::new("cards", &measure).verdict
}

#[test]
fn a_promise_is_kept_up_to_its_bound() {
    let above = 0.1 + 1e-9;
    for (promise, kept, broken) in [
        (Promise::AtMost(0.1), 0.1, above),
        (Promise::AtLeast(0.1), 0.1, 0.1 - 1e-9),
        (Promise::Within(0.5, 0.125), 0.375, 0.375 - 1e-9),
        (Promise::Within(0.0, 0.1), -0.1, -above),
        (Promise::Zero, 0.0, f64::MIN_POSITIVE),
        // The committed figure of the scene.
        (Promise::NoMoreThanBox2d, 0.107013, 0.107014),
    ] {
        assert_eq!(judged(kept, Some(promise), false), Verdict::Passed, "{promise:?}");
        for wrong in [broken, f64::NAN] {
            assert_eq!(judged(wrong, Some(promise), false), Verdict::Failed, "{promise:?}");
        }
        assert_eq!(judged(broken, Some(promise), true), Verdict::Open);
    }
    assert_eq!(judged(f64::INFINITY, Some(Promise::AtMost(600.0)), false), Verdict::Failed);
    assert_eq!(judged(1.0, None, false), Verdict::Measured);
}

#[test]
fn numbers_have_three_digits() {
    let shown = [0.0, 596.0, 0.0921, 0.5, 12.345, 1.234e-7, -0.0358, 1e7, 0.107_013].map(number);
    assert_eq!(shown, ["0", "596", "0.0921", "0.5", "12.3", "1.23·10⁻⁷", "−0.0358", "1·10⁷", "0.107"]);
}

#[test]
fn symmetric_scenes_are_their_own_mirror_images() {
    let all = [
        scenes::pyramid(40),
        scenes::tower(5, fx!(1000)),
        scenes::cards(8),
        scenes::arch(15, [fx!(5), fx!(6)]),
        scenes::arch(25, [fx!(5), fx!(5.75)]),
        scenes::billiards(),
        scenes::flat_drop(),
        scenes::bounce(),
        scenes::cradle(),
    ];
    for (i, scene) in all.into_iter().enumerate() {
        let run = Run::new(&scene.expect("a scene"), 5).expect("a world");
        assert!(run.mirror.is_some() && run.asymmetry == 0.0, "scene {i}");
    }
    let mut askew = scenes::cards(2).expect("a scene");
    askew.bodies[3].angle += umbra_physics::Fx::from_bits(1 << 12);
    assert_eq!(Run::new(&askew, 5).expect("a world").asymmetry, f64::INFINITY);
}

#[test]
fn a_difference_from_the_mirror_image_is_seen_to_the_bit() {
    let mut run = Run::new(&scenes::cards(2).expect("a scene"), 5).expect("a world");
    let card = run.world.bodies().nth(1).expect("a card").id();
    run.world.set_angular_velocity(card, umbra_physics::Fx::from_bits(1)).expect("a card");
    run.step(1);
    assert!(run.asymmetry > 0.0 && run.asymmetry < 1e-6, "{}", run.asymmetry);
}

#[test]
fn every_figure_of_other_engines_is_of_a_scene_and_a_number() {
    let names: Vec<&str> = rows().map(|row| row.name).collect();
    let figures = include_str!("peers.csv").lines().filter(|line| !line.starts_with('#')).skip(1);
    let mut count = 0;
    for line in figures {
        let fields: Vec<&str> = line.split(',').collect();
        let [engine, scene, measure, ..] = fields[..] else { panic!("{line}") };
        let peer = PEERS.into_iter().find(|peer| peer.id == engine).expect("a known engine");
        assert!(names.contains(&scene), "{line}");
        assert!(
            figure(peer, scene, measure).is_some_and(|(value, length)| value.is_finite() && length.ends_with(" s")),
            "{line}"
        );
        count += 1;
    }
    assert_eq!(count, 77);
}

#[test]
fn a_shot_without_continuous_collision_is_outside() {
    let row = row("shots").expect("a scene");
    let played = (row.play)(Length { substeps: 5, quick: true }).expect("worlds");
    let counts: Vec<f64> = played.measures.iter().map(|measure| measure.value).collect();
    assert!(counts[..2] == [0.0, 0.0] && counts[2..].iter().all(|&count| count >= 900.0), "{counts:?}");
}
