//! Damping in scenes: a rate, a share or none, and never a number that could be either.

use umbra_physics::scalar::ToF64 as _;
use umbra_physics::{Damping, Fx, fx};
use umbra_scene::Scene;

fn scene(linear: &str) -> String {
    format!(r#"{{"damping": {{"linear": {linear}}}, "bodies": [{{"name": "a", "damping": {{"angular": {linear}}}}}]}}"#)
}

#[test]
fn a_damping_is_what_it_says() {
    for (text, damping) in [
        (r#""none""#, Damping::NONE),
        (r#"{"rate": 0}"#, Damping::NONE),
        (r#"{"rate": 0.1}"#, Damping::rate(fx!(0.1))),
        (r#"{"rate": 4.5}"#, Damping::rate(fx!(4.5))),
        (r#"{"rate": 30}"#, Damping::rate(fx!(30))),
        (r#"{"rate": 2147483647}"#, Damping::rate(fx!(2147483647))),
        (r#"{"kept_per_second": 0}"#, Damping::kept_per_second(fx!(0))),
        (r#"{"kept_per_second": 0.1}"#, Damping::kept_per_second(fx!(0.1))),
        (r#"{"kept_per_second": 1}"#, Damping::NONE),
    ] {
        let parsed = Scene::parse(&scene(text)).unwrap_or_else(|error| panic!("{text}: {error}"));
        assert_eq!((parsed.world.linear_damping, parsed.world.angular_damping), (damping, Damping::NONE), "{text}");
        let def = &parsed.bodies[0].def;
        assert_eq!((def.linear_damping, def.angular_damping), (None, Some(damping)), "{text}");
        let written = Scene::parse(&parsed.to_json()).expect("what it wrote itself");
        assert_eq!((written.world, &written.bodies[0].def), (parsed.world, def), "{text}");
    }
}

#[test]
fn a_strong_damping_is_written_as_the_rate_that_it_is() {
    let parsed = Scene::parse(&scene(r#"{"rate": 30.5}"#)).expect("a fair scene");
    let written = parsed.to_json();
    assert_eq!(written.matches(r#"{"rate": 30.5}"#).count(), 2, "{written}");
}

#[test]
fn a_strong_damping_is_the_same_in_floats() {
    let text = r#"{"damping": {"linear": {"rate": 30.5}}, "bodies": [{"name": "a", "velocity": [100, 0]}]}"#;
    let scene = Scene::parse(text).expect("a fair scene");
    let (mut fixed, mut float) = (scene.start::<Fx>().expect("it starts"), scene.start::<f64>().expect("it starts"));
    for tick in 1..=60 {
        fixed.advance().expect("a fair step");
        float.advance().expect("a fair step");
        let fixed = fixed.world().bodies().next().expect("a body").velocity().x.to_f64();
        let float = float.world().bodies().next().expect("a body").velocity().x;
        let exact = 100.0 * (-30.5 * f64::from(tick) / 60.0).exp();
        assert!(
            (float - exact).abs() < exact * 1e-13 && (fixed - exact).abs() < 2e-10,
            "{tick}: {fixed}, {float}, {exact}"
        );
    }
}

#[test]
fn an_invalid_damping_is_refused_with_the_valid_forms() {
    for (text, says) in [
        ("0", r#"expected a damping: {"rate": 0.1}"#),
        ("0.9", r#"{"kept_per_second": 0.9} for the share of a velocity that is left after a second"#),
        ("[1]", r#"or "none", found a list"#),
        (r#""off""#, "expected one of none, found \"off\""),
        ("{}", "one of the fields kept_per_second, rate is missing"),
        (r#"{"rate": 1, "kept_per_second": 1}"#, "give only one of the two"),
        (r#"{"rate": -0.1}"#, "a rate of at least 0"),
        (r#"{"kept_per_second": 1.1}"#, "from 0 to 1"),
        (r#"{"kept": 1}"#, "unknown field; there are kept_per_second, rate"),
    ] {
        let error = Scene::parse(&scene(text)).expect_err(text).to_string();
        assert!(error.contains(says), "{text}: {error}");
    }
}
