//! Conversions between vectors and the types of the crate `mint`.

use ::mint::{IntoMint, Point2, Vector2};

use super::Vec2;

impl<S> From<Vec2<S>> for Vector2<S> {
    fn from(Vec2 { x, y }: Vec2<S>) -> Self {
        Self { x, y }
    }
}

impl<S> From<Vector2<S>> for Vec2<S> {
    fn from(Vector2 { x, y }: Vector2<S>) -> Self {
        Self { x, y }
    }
}

impl<S> From<Vec2<S>> for Point2<S> {
    fn from(Vec2 { x, y }: Vec2<S>) -> Self {
        Self { x, y }
    }
}

impl<S> From<Point2<S>> for Vec2<S> {
    fn from(Point2 { x, y }: Point2<S>) -> Self {
        Self { x, y }
    }
}

impl<S> IntoMint for Vec2<S> {
    type MintType = Vector2<S>;
}
