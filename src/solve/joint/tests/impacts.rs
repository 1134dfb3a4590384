//! Joints in impacts.

use alloc::vec;
use alloc::vec::Vec;

use super::scene::{RATE, Scene, signed};
use crate::cases::run_seed;
use crate::math::{Random, TimeStep};
use crate::solve::Solver;
use crate::solve::bodies::STILL;
use crate::solve::joint::Response;

/// The responses of the bodies of an assembly to one of them are near the answers of its joints to an impulse on that body: within a fifth for three of
/// four assemblies. (Bodies that are held in two places hardly move at all.)
#[test]
fn responses_are_answers() {
    let mut random = Random::seeded(run_seed(9));
    let mut errors = Vec::new();
    for i in 0..200 {
        let scene = Scene::random(&mut random, [12, i % 3], 5 + i % 15, 0);
        let mut solver = Solver::default();
        solver.prepare(TimeStep::hz(RATE), &scene.options, &scene.flights, &scene.joints, &[]);
        let joints = &mut solver.joints;
        joints.begin(&solver.bodies.rows, true);
        for assembly in 0..joints.assembly_count() {
            let mut rows = Vec::new();
            joints.list_rows(assembly, &mut rows);
            let Some(node) = rows.iter().position(|&row| row != STILL) else { continue };
            let (mut changes, mut responses) = (vec![[0; 3]; rows.len()], vec![Response::default(); rows.len()]);
            joints.find_responses(assembly, node, &mut changes, &mut responses);
            changes.fill([0; 3]);
            let change = [0; 3].map(|_| (signed(&mut random) * 2.0_f64.powi(50)) as i64);
            changes[node] = change;
            joints.begin_impact(assembly);
            for _ in 0..16 {
                joints.answer_impact(assembly, &mut changes, 0);
            }
            let (mut error, mut size) = (0_f64, 0_f64);
            for (k, response) in responses.iter().enumerate().filter(|&(k, _)| rows[k] != STILL) {
                for axis in 0..3 {
                    let sum: f64 = (0..3).map(|from| response[from][axis] as f64 * change[from] as f64).sum();
                    error = error.max((sum / 2.0_f64.powi(30) - changes[k][axis] as f64).abs());
                    size = size.max((changes[k][axis] as f64).abs());
                }
            }
            errors.push(error / size);
        }
    }
    errors.sort_by(f64::total_cmp);
    assert!(errors.len() > 200 && errors[errors.len() * 3 / 4] < 0.2, "{errors:?}");
}
