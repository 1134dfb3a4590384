//! Contacts in a picture: their points, normals and impulses at the end of a run.

use clap::ValueEnum;
use umbra_physics::scalar::ToF64;
use umbra_physics::{DebugDraw, DrawOptions, Pose, Role, Scalar, World};

use super::{Point, length};

/// A part of a contact that is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ContactMark {
    /// The points at which two colliders touch.
    Points,
    /// The normals there, from the first collider to the second one.
    Normals,
    /// The impulses of the last sub-step, on the second collider: along the normal at each point, and friction.
    Impulses,
}

/// Choice of what is drawn of contacts.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactOptions {
    pub(crate) marks: Vec<ContactMark>,
    /// The length of an arrow, m for each N·s; chosen by the longest one without it.
    pub(crate) impulse_scale: Option<f64>,
}

/// Contacts as they are drawn.
#[derive(Clone, Debug, Default)]
pub(super) struct Contacts {
    pub(super) points: Vec<Point>,
    /// Each with its direction, a unit vector.
    pub(super) normals: Vec<[Point; 2]>,
    /// Each with what it points along: its size in N·s.
    pub(super) impulses: Vec<[Point; 2]>,
    pub(super) impulse_scale: Option<f64>,
}

impl Contacts {
    pub(super) fn of<S: Scalar + ToF64>(world: &World<S>, options: &ContactOptions) -> Self {
        let has = |mark| options.marks.contains(&mark);
        let drawn = DrawOptions {
            bodies: false,
            fields: false,
            joints: false,
            contacts: has(ContactMark::Points),
            contact_normals: has(ContactMark::Normals).then_some(1.0),
            contact_impulses: has(ContactMark::Impulses).then_some(1.0),
            ..DrawOptions::default()
        };
        let mut contacts = Self { impulse_scale: options.impulse_scale, ..Self::default() };
        world.debug_draw(Pose::of, &drawn, &mut contacts);
        contacts
    }

    /// The length of an arrow of an impulse, m for each N·s, if the longest one is to be this long, m.
    pub(super) fn scale(&self, longest: f64) -> f64 {
        self.impulse_scale.unwrap_or_else(|| {
            let largest = self.impulses.iter().map(|[_, impulse]| length(*impulse)).fold(0.0, f64::max);
            if largest > 0.0 { longest / largest } else { 1.0 }
        })
    }
}

impl DebugDraw for Contacts {
    fn polygon(&mut self, _corners: &[[f64; 2]], _role: Role) {}

    fn segment(&mut self, _ends: [[f64; 2]; 2], _role: Role) {}

    fn point(&mut self, [x, y]: [f64; 2], _role: Role) {
        self.points.push((x, y));
    }

    fn arrow(&mut self, from: [f64; 2], to: [f64; 2], role: Role) {
        let arrow = [(from[0], from[1]), (to[0] - from[0], to[1] - from[1])];
        match role {
            Role::ContactNormal(_) => self.normals.push(arrow),
            _ => self.impulses.push(arrow),
        }
    }
}
