//! Joints against doubles, closed forms and their own mirror images.

mod axes;
mod cases;
mod exact;
mod forest;
mod impacts;
mod quality;
mod scene;
mod slides;
mod twin;
mod world;
