//! Tests of the statements and examples in the documentation.

mod figures;
mod guide;
mod items;
mod names;
mod openings;
mod packages;
