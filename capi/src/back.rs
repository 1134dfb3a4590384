//! Steps undone.

use std::mem::MaybeUninit;

use umbra_physics::AppliedForce;

use crate::memory::given;
use crate::status::{UmbraStatus, guard};
use crate::world::UmbraWorld;

/// The forces and torques that were applied over a step: what undoing it needs beside the world.
pub struct UmbraAppliedForces {
    forces: Vec<AppliedForce>,
}

/// The forces and torques that were applied over the last step of a world: to be kept, one a tick, by a program that will undo more than
/// the last step.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_applied_forces(
    world: Option<&UmbraWorld>,
    applied: Option<&mut MaybeUninit<Option<Box<UmbraAppliedForces>>>>,
) -> UmbraStatus {
    guard(|| {
        let (world, place) = (given(world)?, given(applied)?);
        place.write(Some(Box::new(UmbraAppliedForces { forces: world.world().last_report().applied.to_vec() })));
        Ok(())
    })
}

/// Undoes the last step: the world is what it was before, to the bit, with the forces of that tick applied again. `applied` are the forces
/// of that step; null takes those of the last report, which this call empties, so that it is good for one step. Undo calls between two
/// steps yourself, the last one first, before you undo the step before them.
///
/// Steps with sleep (`UMBRA_NEVER` turns it off), damping, contacts, joints that pulled, or impulses have no inverse, among others:
/// `UMBRA_ERROR_NOT_REVERSIBLE`, and `umbra_last_cause` has the reason, 131 to 146. A world that is recorded is not set back.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_world_step_back(
    world: Option<&mut UmbraWorld>,
    applied: Option<&UmbraAppliedForces>,
) -> UmbraStatus {
    guard(|| {
        let world = given(world)?;
        let run = world.unrecorded()?;
        match applied {
            Some(applied) => run.step_back(&applied.forces)?,
            None => {
                let forces = run.last_report().applied.to_vec();
                run.step_back(&forces)?;
            }
        }
        world.forget_outcomes();
        Ok(())
    })
}

/// Frees the forces of a step. Null is ignored.
#[unsafe(no_mangle)]
pub extern "C" fn umbra_applied_forces_free(applied: Option<Box<UmbraAppliedForces>>) {
    drop(applied);
}
