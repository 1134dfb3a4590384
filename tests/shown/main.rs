//! What the documentation shows, and that it is so.

mod guide;
mod items;
