//! What the documentation shows, and that it is so.

mod figures;
mod guide;
mod items;
