//! The order of all that a sub-step does: impacts, joints and contacts in turn, the move, and the passes that leave no bias behind.

use super::follow::follow;
use super::impact::SubStep;
use super::motion::{Advance, Begin};
use super::pass::Pass;
use super::unit::Clock;
use super::{Contact, Solver, SolverOptions};
use crate::kernel::simd::{Job, Lanes};
use crate::timers::timed;

/// All sub-steps. The result is the number of values that were cut off.
pub(super) struct SubSteps<'a> {
    pub(super) solver: &'a mut Solver,
    pub(super) clock: &'a Clock,
    pub(super) options: &'a SolverOptions,
    pub(super) contacts: &'a [Contact],
}

impl Job for SubSteps<'_> {
    type Result = u64;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> u64 {
        let Self { solver, clock, options, contacts } = self;
        let n = clock.substeps;
        let mut cut = 0;
        for k in 1..=n {
            solver.joints.begin(&solver.bodies.rows, k == 1);
            Begin { rows: &mut solver.bodies.rows, k, n }.run(lanes);
            follow(&mut solver.bodies);
            if k == 1 {
                cut += solver.pass(Pass::WarmStart, lanes);
            }
            let substep = SubStep { k, n, clock, graph: &solver.graph, contacts };
            let (bodies, groups, joints) = (&mut solver.bodies, &mut solver.groups, &mut solver.joints);
            timed!(solver, impacts, solver.impacts.solve(substep, bodies, groups, joints, lanes));
            follow(&mut solver.bodies);
            cut += solver.joints.warm_start(&mut solver.bodies.rows, lanes);
            for _ in 0..options.joint_rounds {
                cut += solver.joints.solve(&mut solver.bodies.rows, lanes);
                follow(&mut solver.bodies);
                cut += solver.pass(Pass::Solve, lanes);
            }
            Advance { rows: &mut solver.bodies.rows }.run(lanes);
            cut += solver.joints.relax(&mut solver.bodies.rows, lanes);
            follow(&mut solver.bodies);
            cut += solver.pass(Pass::Relax, lanes);
            if options.relax_passes > 1 {
                // The impulses count that the last pass leaves.
                solver.groups.add_applied(-1);
                for _ in 1..options.relax_passes {
                    cut += solver.pass(Pass::RelaxAgain, lanes);
                }
                solver.groups.add_applied(1);
            }
        }
        solver.joints.finish();
        cut
    }
}
