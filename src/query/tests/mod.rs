//! The kernels against their definition in rational numbers, and against their own mirror images.

mod cases;
mod exact;
mod images;
