//! Shapes by themselves: hulls, concave polygons, distances and times of impact, each against exact rationals or closed forms.

mod concave;
mod conventions;
mod distances;
mod exact;
mod hulls;
mod sweeps;
