//! Tests of the broad phase: all pairs by comparison of each two, after any history.

mod core_tree;
mod exact;
mod limits;
mod scene;
mod statics;
mod steady;
