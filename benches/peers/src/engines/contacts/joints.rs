//! The joints of a scene.

use super::bodies::Body;
use crate::engines::umbra::Number;
use crate::scene::Scene;
use umbra_physics::solve::{Impulses, Joint, JointKind};
use umbra_physics::{Fx, Vec2};

pub struct Joints {
    /// With the impulses of the step before.
    pub joints: Vec<Joint>,
    /// The bodies that are joined, sorted.
    pub pairs: Vec<[u32; 2]>,
    /// The anchors in the frames of the bodies.
    points: Vec<[Vec2; 2]>,
}

impl Joints {
    pub fn new(scene: &Scene, bodies: &mut [Body]) -> Self {
        let mut new = Self { joints: Vec::new(), pairs: Vec::new(), points: Vec::new() };
        for joint in &scene.joints {
            let (a, b) = (joint.a, joint.b);
            let [of_a, of_b] = joint.anchors(&scene.bodies);
            new.points.push([bodies[a].anchor(of_a), bodies[b].anchor(of_b)]);
            let kind = match joint.rod_end {
                None => JointKind::Revolute,
                Some(_) => JointKind::Distance { length: Fx::number(joint.length()) },
            };
            let ends = [a, b].map(|i| i as u32);
            new.joints.push(Joint {
                bodies: ends,
                anchors: [Vec2::ZERO; 2],
                kind,
                axis: None,
                slides: [None; 2],
                impulses: Impulses::default(),
            });
            new.pairs.push([ends[0].min(ends[1]), ends[0].max(ends[1])]);
        }
        new.pairs.sort_unstable();
        new
    }

    /// Turns the anchors with the bodies.
    pub fn place(&mut self, bodies: &[Body]) {
        for (joint, points) in self.joints.iter_mut().zip(&self.points) {
            joint.anchors = [0, 1].map(|k| bodies[joint.bodies[k] as usize].turned(points[k]));
        }
    }
}
