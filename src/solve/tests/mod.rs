//! Tests of the solver: twins in wide integers and in doubles, ranges, fairness, conservation and the graph.

mod bounce;
mod cases;
mod conserve;
#[cfg(feature = "float")]
mod doubles;
mod extremes;
mod fair;
mod graph;
mod limbs;
mod made;
mod paths;
mod scene;
mod wide;
