//! The tests of bodies that collide or are joined, a folder a subject, as one program: shapes, the narrow phase, contacts, impacts, joints, and
//! collision on the way.
#![allow(clippy::duplicate_mod, reason = "each folder takes in what it needs of `support` by itself")]

#[path = "support/seeds.rs"]
mod seeds;

mod collide;
mod contacts;
// Its twins do without continuous collision.
#[cfg(feature = "selftest")]
mod continuous;
mod impacts;
mod joints;
mod shapes;
