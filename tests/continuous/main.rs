//! Continuous collision: nothing is crossed by speed, and slow scenes do not pay.

#[path = "../support/seeds.rs"]
mod seeds;

mod classic;
mod fair;
mod shots;
