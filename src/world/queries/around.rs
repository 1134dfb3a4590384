//! The colliders around a shape, as obstacles of its centre.

use alloc::vec::Vec;

use super::cast::checked_shape;
use super::{Queries, QueryFilter};
use crate::body::BodyKind;
use crate::collider::Side;
use crate::error::Error;
use crate::fx::Fx;
use crate::math::Vec2;
use crate::query::{Core, Point, Sum, beside, from_to};
use crate::scalar::{Angle as _, Scalar, Wide as _};
use crate::shape::Shape;
use crate::slots::{BodyId, ColliderId};
use crate::world::{Moment, Stance, World};

/// A part of a collider and one of a shape. The centre of the shape is a point that meets the sum of the two.
#[derive(Debug)]
pub(crate) struct Neighbour {
    pub(crate) collider: ColliderId,
    pub(crate) body: BodyId,
    pub(crate) part: u32,
    /// The sum, and the cores of the shape and of the collider, as seen from the start.
    pub(crate) sum: Sum,
    pub(crate) cores: [Core; 2],
    /// The way from the first to the second end of a segment of a chain.
    pub(crate) link: Option<Point>,
    /// The side from which a one-way collider holds, in the axes of the world.
    pub(crate) side: Option<Side<Fx>>,
    pub(crate) is_dynamic: bool,
}

impl<'a, S: Scalar> Queries<'a, S> {
    /// The world of the queries.
    pub(crate) fn world(&self) -> &'a World<S> {
        self.world
    }

    /// The moment at which the queries see kinematic bodies.
    pub(crate) fn moment(&self) -> Moment {
        self.moment
    }

    /// The stance of a body as the queries see it; `None` if it is gone.
    pub(crate) fn stance(&self, body: BodyId) -> Option<Stance<S>> {
        self.world.bodies.find(body).ok().map(|dense| self.world.stance_at(dense, self.moment))
    }

    /// The parts of colliders that come within `reach` ulps of a shape at a position, along an axis, sorted by key, handle and part.
    pub(crate) fn around(
        &self,
        shape: &Shape<S>,
        position: Vec2<S>,
        reach: i64,
        filter: &QueryFilter<'_, S>,
    ) -> Result<(Point, Vec<Neighbour>), Error> {
        let (from, parts) = checked_shape(shape, position, S::ZERO)?;
        let mut ranked = Vec::new();
        for (own_part, part) in (0_u32..).zip(&parts) {
            let [min, max] = part.bounds().map(|corner| beside(from, corner));
            let bounds = [min.map(|part| part - reach), max.map(|part| part + reach)];
            self.in_box(bounds, filter, |outline| {
                if let (Some((core, is_link)), Some(target)) = (outline.core(from), outline.target()) {
                    let def = &target.collider.def;
                    let link = match core.corners() {
                        &[a, b] if is_link => Some(from_to(a, b)),
                        _ => None,
                    };
                    let side = target.collider.side.and_then(|side| {
                        let Stance { angle, .. } = self.stance(target.collider.body)?;
                        let turned = angle.rotate(side.direction)?.try_map(|part| Some(part.to_scalar()?.to_fx()))?;
                        Some(Side { direction: turned, cosine: side.cosine.to_fx() })
                    });
                    let neighbour = Neighbour {
                        collider: target.id,
                        body: target.collider.body,
                        part: target.part,
                        sum: Sum::new(part, &core),
                        cores: [part.clone(), core],
                        link,
                        side,
                        is_dynamic: self.kind(target.collider.body) == Some(BodyKind::Dynamic),
                    };
                    ranked.push(((def.key, target.id, target.part, own_part), neighbour));
                }
                true
            });
        }
        ranked.sort_unstable_by_key(|&(rank, _)| rank);
        let neighbours = ranked.into_iter().map(|(_, neighbour)| neighbour);
        Ok((from, neighbours.filter(|neighbour| self.accepts(neighbour.collider, filter)).collect()))
    }
}
