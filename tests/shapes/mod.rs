//! Shapes by themselves: hulls and concave polygons, against exact integers.

mod concave;
mod exact;
mod hulls;
