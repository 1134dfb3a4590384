//! The functions that this crate compiles for its own number types.
//!
//! The engine is generic over the scalar, and rustc compiles generic code in the crate that uses it. Without this file each
//! program would compile the whole engine once more, with every change of a line. The public methods that have much code call
//! one of the functions here instead. These are not generic in the impl for a number type of this crate, so the library holds
//! their code.

#![allow(private_interfaces, reason = "the trait is public only because `Scalar` is; nothing outside can call it")]

use alloc::sync::Arc;
use alloc::vec::Vec;

use crate::body::{Bodies, BodyDef, BodyKind, Change, FactorTable, Key, Locks, Mass};
use crate::collider::ColliderDef;
use crate::error::Error;
use crate::force::{AppliedForce, ForceField};
use crate::fx::Fx;
use crate::joint::JointDef;
use crate::math::Vec2;
use crate::replay::{Difference, HashTree};
use crate::scalar::Scalar;
use crate::shape::{Geometry, Part, Shape};
use crate::slots::{BodyId, ColliderId, FieldId, JointId};
#[cfg(feature = "float")]
use crate::solve::FloatSolver;
use crate::solve::{ContactSolver, Solver};
use crate::world::{
    ApplyOptions, BodyRef, Command, Created, ForceOrImpulse, InputResult, Inputs, Preview, Trace, World, WorldDef,
};

/// Makes the trait with a body for each function, and an impl with the same bodies for each number type of this crate.
macro_rules! compiled {
    ($(fn $name:ident($($argument:ident: $type:ty),*) $(-> $result:ty)? $body:block)*) => {
        /// Functions of the engine that the library holds compiled. A scalar of a test takes them as they are.
        #[doc(hidden)]
        pub trait Compiled<S: Scalar> {
            /// The solver of the contacts of worlds of this scalar.
            #[doc(hidden)]
            type Solver: ContactSolver;

            $(
                #[doc(hidden)]
                fn $name($($argument: $type),*) $(-> $result)? $body
            )*
        }

        compiled!(impl Fx, Solver: $(fn $name($($argument: $type),*) $(-> $result)? $body)*);
        #[cfg(all(feature = "float", not(test)))]
        compiled!(impl f32, FloatSolver: $(fn $name($($argument: $type),*) $(-> $result)? $body)*);
        #[cfg(all(feature = "float", not(test)))]
        compiled!(impl f64, FloatSolver: $(fn $name($($argument: $type),*) $(-> $result)? $body)*);
        // The unit tests use few of the functions for floats: they compile these alone.
        #[cfg(all(feature = "float", test))]
        compiled!(impl f32, FloatSolver:);
        #[cfg(all(feature = "float", test))]
        compiled!(impl f64, FloatSolver:);
    };
    (impl $scalar:ty, $solver:ty: $($functions:item)*) => {
        const _: () = {
            type S = $scalar;
            impl Compiled<S> for S {
                type Solver = $solver;

                $($functions)*
            }
        };
    };
}

compiled! {
    fn step(world: &mut World<S>) {
        world.advance(None);
    }
    fn step_traced(world: &mut World<S>) -> Trace<S> {
        world.step_traced_inner()
    }
    fn step_back(world: &mut World<S>, applied: &[AppliedForce<S>]) -> Result<(), Error> {
        world.step_back_inner(applied)
    }
    fn preview(world: &World<S>, body: BodyId) -> Result<Preview<S>, Error> {
        world.preview_inner(body)
    }
    fn new_world(def: WorldDef<S>) -> Result<World<S>, Error> {
        World::new_inner(def)
    }
    fn clone_world(world: &World<S>) -> World<S> {
        world.clone_inner()
    }
    fn clone_world_from(world: &mut World<S>, source: &World<S>) {
        world.clone_from_inner(source);
    }
    fn keep(kept: &mut World<S>, world: &World<S>) {
        kept.keep(world);
        kept.workspace.clone_cached_from(&world.workspace);
    }
    fn restore(world: &mut World<S>, kept: &World<S>) {
        world.clone_from_inner(kept);
        world.workspace.clone_cached_from(&kept.workspace);
    }
    fn check(world: &World<S>, command: &Command<S>) -> Result<(), Error> {
        world.check_inner(command)
    }
    fn execute(world: &mut World<S>, command: &Command<S>) -> Result<Created, Error> {
        world.execute_inner(command)
    }
    fn carry_out(world: &mut World<S>, inputs: &Inputs<S>, outcomes: &mut Vec<InputResult>) {
        world.carry_out_inner(inputs, outcomes);
    }
    fn add_body(world: &mut World<S>, def: BodyDef<S>) -> Result<BodyId, Error> {
        world.add_body_inner(def)
    }
    fn remove_body(world: &mut World<S>, body: BodyId) -> Result<(), Error> {
        world.remove_body_inner(body)
    }
    fn add_collider(world: &mut World<S>, body: BodyId, def: ColliderDef<S>) -> Result<ColliderId, Error> {
        world.add_collider_inner(body, def)
    }

    fn set_collider(world: &mut World<S>, collider: ColliderId, def: ColliderDef<S>) -> Result<(), Error> {
        world.set_collider_inner(collider, def)
    }

    fn remove_collider(world: &mut World<S>, collider: ColliderId) -> Result<(), Error> {
        world.remove_collider_inner(collider)
    }

    fn set_kind(world: &mut World<S>, body: BodyId, kind: BodyKind) -> Result<(), Error> {
        world.set_kind_inner(body, kind)
    }
    fn set_locks(world: &mut World<S>, body: BodyId, locks: Locks) -> Result<(), Error> {
        world.set_locks_inner(body, locks)
    }
    fn set_mass(world: &mut World<S>, body: BodyId, mass: Mass<S>) -> Result<(), Error> {
        world.set_mass_inner(body, mass)
    }
    fn move_to(world: &mut World<S>, body: BodyId, position: Vec2<S>, angle: S) -> Result<(), Error> {
        world.move_to_inner(body, position, angle)
    }
    fn apply(
        world: &mut World<S>,
        body: BodyId,
        action: ForceOrImpulse<S>,
        options: ApplyOptions
    ) -> Result<(), Error> {
        world.apply_inner(body, action, options)
    }
    fn touch(world: &mut World<S>, body: BodyId, change: Change) -> Result<usize, Error> {
        world.touch_inner(body, change)
    }
    fn wake_joined(world: &mut World<S>, body: BodyId) {
        world.wake_joined_inner(body);
    }
    fn sleep(world: &mut World<S>, body: BodyId) -> Result<(), Error> {
        world.sleep_inner(body)
    }
    fn set_factors(bodies: &mut Bodies<S>, dense: usize, table: &mut Arc<FactorTable<S>>, key: Key<S>) {
        bodies.set_factors(dense, Arc::make_mut(table), key);
    }
    fn redefine(world: &mut World<S>, def: WorldDef<S>) {
        world.redefine_inner(def);
    }
    fn set_sleep_after(world: &mut World<S>, ticks: Option<u32>) -> Result<(), Error> {
        world.set_sleep_after_inner(ticks)
    }
    fn add_field(world: &mut World<S>, field: ForceField<S>) -> Result<FieldId, Error> {
        world.add_field_inner(field)
    }
    fn set_field(world: &mut World<S>, id: FieldId, field: ForceField<S>) -> Result<(), Error> {
        world.set_field_inner(id, field)
    }
    fn remove_field(world: &mut World<S>, id: FieldId) -> Result<(), Error> {
        world.remove_field_inner(id)
    }
    fn add_joint(world: &mut World<S>, def: JointDef<S>) -> Result<JointId, Error> {
        world.add_joint_inner(def)
    }
    fn remove_joint(world: &mut World<S>, joint: JointId) -> Result<(), Error> {
        world.remove_joint_inner(joint)
    }
    fn replace(inputs: &mut Inputs<S>, player: u32, commands: &mut dyn Iterator<Item = Command<S>>) -> bool {
        inputs.replace_inner(player, commands)
    }
    fn clone_inputs(inputs: &Inputs<S>) -> Inputs<S> {
        inputs.clone_inner()
    }
    fn clone_inputs_from(inputs: &mut Inputs<S>, source: &Inputs<S>) {
        inputs.clone_from_inner(source);
    }
    fn new_shape(geometry: Geometry<S>, shift: Vec2<S>, measure: <S as Scalar>::Factor, gyration: <S as Scalar>::Factor) -> Shape<S> {
        Shape::of_inner(geometry, shift, measure, gyration)
    }
    fn rounded_polygon(corners: &[Vec2<S>], radius: S) -> Result<Shape<S>, Error> {
        Shape::rounded_polygon_inner(corners, radius)
    }
    fn polygon(corners: &[Vec2<S>]) -> Result<Shape<S>, Error> {
        Shape::polygon_inner(corners)
    }
    fn compound(parts: &[Part<S>]) -> Result<Shape<S>, Error> {
        Shape::compound_inner(parts)
    }

    fn chain(points: &[Vec2<S>], closed: bool) -> Result<Shape<S>, Error> {
        Shape::chain_inner(points, closed)
    }
    fn state_hash(world: &World<S>) -> u64 {
        world.state_hash_inner()
    }
    fn physics_hash(world: &World<S>) -> u64 {
        world.physics_hash_inner()
    }
    fn physics_hash_of(body: &BodyRef<'_, S>) -> u64 {
        body.physics_hash_inner()
    }
    fn hash_tree(world: &World<S>) -> HashTree {
        HashTree::of_inner(world)
    }
    fn differences(left: &World<S>, right: &World<S>) -> Vec<Difference> {
        left.differences_inner(right)
    }
    fn first_difference(left: &World<S>, right: &World<S>) -> Option<Difference> {
        left.first_difference_inner(right)
    }
    fn kinetic_energy(world: &World<S>) -> Result<<S as Scalar>::Wide, Error> {
        world.kinetic_energy_inner()
    }
    fn potential_energy(world: &World<S>) -> Result<<S as Scalar>::Wide, Error> {
        world.potential_energy_inner()
    }
}
