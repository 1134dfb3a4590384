//! The promises, over runs that are made up: each a module, P1 to P9. What breaks one is shrunk, and left as a scene that
//! `umbra run` runs.

#[path = "../support/real.rs"]
mod real;
#[path = "../support/reference.rs"]
#[allow(dead_code, reason = "half of π is the hard inputs'")]
mod reference;

#[path = "../support/cases.rs"]
mod cases;
mod check;
mod plan;

mod closure;
mod energy;
mod envelope;
mod exact_time;
mod order;
mod pays;
mod reverse;
mod rounding;
mod same_bits;
mod shrinking;
mod symmetry;
