//! A small world in doubles around the solver: free flight, joints, boxes on a floor.

use alloc::collections::BTreeMap;
use alloc::vec::Vec;

use crate::fx::Fx;
use crate::kernel::simd::{VectorSet, run_with};
use crate::math::{TimeStep, Vec2};
use crate::scalar::{FxAccumulator, FxFactor, Turn};
use crate::solve::joint::Axis;
use crate::solve::substeps::SubSteps;
use crate::solve::unit::Clock;
use crate::solve::{Contact, Correction, Flight, Impulses, Joint, JointKind, Point, Solver, SolverOptions, Velocity};

/// The nearest multiple of 2^-32.
pub(super) fn fx(value: f64) -> Fx {
    Fx::from_bits((value * 2f64.powi(32)).round() as i64)
}

pub(super) fn vec2([x, y]: [f64; 2]) -> Vec2 {
    Vec2::new(fx(x), fx(y))
}

pub(super) fn double(value: Fx) -> f64 {
    value.to_bits() as f64 / 2f64.powi(32)
}

/// A change as a double.
pub(super) fn change(value: FxAccumulator) -> f64 {
    value.to_bits() as f64 / 2f64.powi(96)
}

pub(super) fn factor(value: f64) -> FxFactor {
    FxFactor::from_scalar(fx(value))
}

pub(super) fn inverse(value: f64) -> FxFactor {
    if value == 0.0 { FxFactor::ZERO } else { FxFactor::ONE.over(factor(value)) }
}

/// The times, in steps, at which values of steps change their sign.
pub(super) fn crossings(values: &[f64]) -> Vec<f64> {
    let crossing = |i: usize| i as f64 - values[i] / (values[i] - values[i - 1]);
    (1..values.len()).filter(|&i| values[i - 1] * values[i] < 0.0).map(crossing).collect()
}

/// The period of an oscillation, s, of its crossings.
pub(super) fn period(crossings: &[f64]) -> f64 {
    let half_periods = (crossings.len() - 1) as f64;
    2.0 * (crossings[crossings.len() - 1] - crossings[0]) / half_periods / f64::from(RATE)
}

pub(super) fn rotated(angle: f64, [x, y]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Body {
    pub(super) at: [f64; 2],
    pub(super) angle: f64,
    pub(super) velocity: [f64; 2],
    pub(super) spin: f64,
    /// kg; zero for a fixed body.
    pub(super) mass: f64,
    /// kg·m²
    pub(super) inertia: f64,
    pub(super) radius: f64,
    /// Half the sides of a box that the floor and discs stop; zero for none.
    pub(super) half: [f64; 2],
    /// The radius of a disc that boxes and discs stop; zero for none.
    pub(super) disc: f64,
}

impl Body {
    pub(super) fn fixed() -> Self {
        Self {
            at: [0.0; 2],
            angle: 0.0,
            velocity: [0.0; 2],
            spin: 0.0,
            mass: 0.0,
            inertia: 0.0,
            radius: 1.0,
            half: [0.0; 2],
            disc: 0.0,
        }
    }

    /// A disc of a density in kg/m².
    pub(super) fn disc(at: [f64; 2], disc: f64, density: f64) -> Self {
        let mass = core::f64::consts::PI * disc * disc * density;
        Self { at, mass, inertia: mass * disc * disc / 2.0, radius: disc, disc, ..Self::fixed() }
    }

    /// A box of a density of 1 kg/m².
    pub(super) fn rectangle(at: [f64; 2], [x, y]: [f64; 2]) -> Self {
        let mass = 4.0 * x * y;
        let inertia = mass * (x * x + y * y) / 3.0;
        Self { at, mass, inertia, radius: x.hypot(y), ..Self::fixed() }
    }

    pub(super) fn point(&self, local: [f64; 2]) -> [f64; 2] {
        let [x, y] = rotated(self.angle, local);
        [self.at[0] + x, self.at[1] + y]
    }
}

/// A joint at points in the frames of two bodies.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub(super) bodies: [usize; 2],
    pub(super) points: [[f64; 2]; 2],
    /// `None`: a revolute joint.
    pub(super) length: Option<f64>,
    /// The angle of the axis of a slider in the axes of the first body.
    pub(super) slider: Option<f64>,
    /// The laws of the angle from the first body to the second, and of the way along the axis or the line; their positions are set in each step.
    pub(super) axis: Option<Axis>,
    pub(super) slide: Option<Axis>,
    /// The angle at the start.
    pub(super) start_angle: f64,
    pub(super) impulses: Impulses,
}

#[derive(Clone, Default)]
pub(super) struct World {
    pub(super) bodies: Vec<Body>,
    pub(super) links: Vec<Link>,
    pub(super) gravity: [f64; 2],
    pub(super) options: SolverOptions,
    /// A link beside which there is a line that has no law, and so no row.
    pub(super) free_line: Option<usize>,
    /// The vectors of the passes: the widest without.
    pub(super) vectors: Option<VectorSet>,
    /// Impulses of boxes on the floor y = 0, by body.
    floor: Vec<Impulses>,
    /// Impulses of discs, by pair of bodies.
    discs: BTreeMap<[u32; 2], Impulses>,
    pub(super) solver: Solver,
    pub(super) corrections: Vec<Correction>,
    pub(super) cut: u64,
}

pub(super) const RATE: u32 = 60;

impl World {
    pub(super) fn new(bodies: &[Body], gravity: f64) -> Self {
        let floor = alloc::vec![Impulses::default(); bodies.len()];
        Self { bodies: bodies.to_vec(), gravity: [0.0, -gravity], floor, ..Self::default() }
    }

    fn link(&mut self, a: usize, b: usize, ends: [[f64; 2]; 2], length: Option<f64>) {
        let local = |body: usize, end: [f64; 2]| {
            let Body { at, angle, .. } = self.bodies[body];
            rotated(-angle, [end[0] - at[0], end[1] - at[1]])
        };
        let points = [local(a, ends[0]), local(b, ends[1])];
        for (body, point) in [(a, points[0]), (b, points[1])] {
            let radius = &mut self.bodies[body].radius;
            *radius = radius.max(point[0].hypot(point[1]));
        }
        let start_angle = self.bodies[b].angle - self.bodies[a].angle;
        self.links.push(Link {
            bodies: [a, b],
            points,
            length,
            slider: None,
            axis: None,
            slide: None,
            start_angle,
            impulses: Impulses::default(),
        });
    }

    /// A revolute joint at a point of the world.
    pub(super) fn pin(&mut self, a: usize, b: usize, at: [f64; 2]) {
        self.link(a, b, [at; 2], None);
    }

    /// A joint whose second point slides along an axis through the first point, at an angle in the world.
    pub(super) fn slider(&mut self, a: usize, b: usize, at: [f64; 2], angle: f64) {
        self.link(a, b, [at; 2], None);
        self.links.last_mut().expect("a joint").slider = Some(angle - self.bodies[a].angle);
    }

    /// The last joint gets an axis.
    pub(super) fn set_axis(&mut self, axis: Axis) {
        self.links.last_mut().expect("a joint").axis = Some(axis);
    }

    /// The last joint gets a slide; a rod becomes a line with it.
    pub(super) fn set_slide(&mut self, slide: Axis) {
        self.links.last_mut().expect("a joint").slide = Some(slide);
    }

    /// The offset of the points along and across the axis of a slider; of a line its length.
    pub(super) fn offset(&self, link: &Link) -> [f64; 2] {
        let Link { bodies: ends, points, slider, .. } = *link;
        let [a, b] = [0, 1].map(|k| self.bodies[ends[k]].point(points[k]));
        let [x, y] = [b[0] - a[0], b[1] - a[1]];
        match slider {
            Some(angle) => rotated(-angle - self.bodies[ends[0]].angle, [x, y]),
            None => [x.hypot(y), 0.0],
        }
    }

    /// The angle of a joint since it was made.
    pub(super) fn angle(&self, link: usize) -> f64 {
        let Link { bodies: [a, b], start_angle, .. } = self.links[link];
        self.bodies[b].angle - self.bodies[a].angle - start_angle
    }

    /// A rod between two points of the world.
    pub(super) fn rod(&mut self, a: usize, b: usize, ends: [[f64; 2]; 2]) {
        let length = (ends[1][0] - ends[0][0]).hypot(ends[1][1] - ends[0][1]);
        self.link(a, b, ends, Some(length));
    }

    /// Velocity Verlet under gravity, from position to position.
    pub(super) fn flight(&self, body: &Body) -> Flight {
        let h = 1.0 / f64::from(RATE);
        let velocity = |v: [f64; 2]| Velocity { linear: vec2(v), angular: fx(body.spin) };
        let kick = if body.mass == 0.0 { [0.0; 2] } else { self.gravity.map(|g| g * h) };
        let [vx, vy] = body.velocity;
        Flight {
            position: vec2(body.at),
            start: velocity(body.velocity),
            end: velocity([vx + kick[0], vy + kick[1]]),
            displacement: vec2([(vx + kick[0] / 2.0) * h, (vy + kick[1] / 2.0) * h]),
            rotation: fx(body.spin * h),
            mass: fx(body.mass),
            inverse_mass: Vec2::new(inverse(body.mass), inverse(body.mass)),
            inverse_inertia: inverse(body.inertia),
            radius: fx(body.radius),
            leader: None,
        }
    }

    pub(super) fn joint(&self, link: &Link) -> Joint {
        let anchor = |k: usize| vec2(rotated(self.bodies[link.bodies[k]].angle, link.points[k]));
        let bodies = link.bodies.map(|body| body as u32);
        let [a, b] = link.bodies;
        let kind = match (link.length, link.slider) {
            (Some(_), _) if link.slide.is_some() => JointKind::Line,
            (Some(length), _) => JointKind::Distance { length: fx(length) },
            (None, Some(angle)) => JointKind::Slider { angle: Turn::from_radians(fx(angle + self.bodies[a].angle)) },
            (None, None) => JointKind::Revolute,
        };
        let position = fx(self.bodies[b].angle - self.bodies[a].angle - link.start_angle);
        let axis = link.axis.map(|axis| Axis { position, ..axis });
        let slide = link.slide.map(|slide| Axis { position: fx(self.offset(link)[0]), ..slide });
        Joint { bodies, anchors: [anchor(0), anchor(1)], kind, axis, slides: [slide, None], impulses: link.impulses }
    }

    /// The two lowest corners of a box near the floor, which is body 0.
    fn contact(&self, index: usize, body: &Body) -> Option<Contact> {
        let [x, y] = body.half;
        if x == 0.0 || body.mass == 0.0 {
            return None;
        }
        let mut arms = [[x, y], [-x, y], [-x, -y], [x, -y]].map(|corner| rotated(body.angle, corner));
        arms.sort_by(|a, b| (a[1], a[0]).partial_cmp(&(b[1], b[0])).expect("numbers"));
        let mut low = [arms[0], arms[1]];
        low.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let floor = self.bodies[0].at;
        let points = low.map(|[rx, ry]| {
            let [px, py] = [body.at[0] + rx, body.at[1] + ry];
            Point { arms: [vec2([px - floor[0], -floor[1]]), vec2([rx, ry])], separation: fx(py) }
        });
        (points[0].separation < fx(0.3)).then_some(Contact {
            bodies: [0, index as u32],
            normal: [0, 1 << 30],
            count: 2,
            points,
            friction: fx(0.6),
            restitution: fx(0.0),
            rolling_resistance: fx(0.0),
            rolling_radius: fx(0.0),
            surface_speed: fx(0.0),
            impulses: self.floor[index],
        })
    }

    /// The contact of a body with a disc that comes after it or is the only one.
    fn disc_contact(&self, a: usize, b: usize) -> Option<Contact> {
        let (first, disc) = (&self.bodies[a], &self.bodies[b]);
        let (offset, reach) = if first.disc > 0.0 {
            ([0.0; 2], first.disc)
        } else {
            // The point of the box next to the disc.
            let [x, y] = rotated(-first.angle, [disc.at[0] - first.at[0], disc.at[1] - first.at[1]]);
            let [hx, hy] = first.half;
            (rotated(first.angle, [x.clamp(-hx, hx), y.clamp(-hy, hy)]), 0.0)
        };
        let way = [0, 1].map(|i| disc.at[i] - first.at[i] - offset[i]);
        let distance = way[0].hypot(way[1]);
        let separation = distance - reach - disc.disc;
        let normal = way.map(|c| c / distance);
        let bodies = [a, b].map(|body| body as u32);
        (separation < 0.3).then(|| Contact {
            bodies,
            normal: normal.map(|c| (c * f64::from(1 << 30)).round() as i32),
            count: 1,
            points: [Point {
                arms: [vec2([0, 1].map(|i| offset[i] + reach * normal[i])), vec2(normal.map(|c| -c * disc.disc))],
                separation: fx(separation),
            }; 2],
            friction: fx(0.6),
            restitution: fx(0.0),
            rolling_resistance: fx(0.0),
            rolling_radius: fx(0.0),
            surface_speed: fx(0.0),
            impulses: self.discs.get(&bodies).copied().unwrap_or_default(),
        })
    }

    /// The contacts of all discs.
    fn disc_contacts(&self) -> Vec<Contact> {
        let is_disc = |body: usize| self.bodies[body].disc > 0.0;
        let discs = (0..self.bodies.len()).filter(|&body| is_disc(body));
        let others = |disc: usize| {
            (0..self.bodies.len()).filter(move |&i| if is_disc(i) { i < disc } else { self.bodies[i].half[0] > 0.0 })
        };
        discs.flat_map(|disc| others(disc).filter_map(move |lower| self.disc_contact(lower, disc))).collect()
    }

    pub(super) fn step(&mut self) {
        let mut flights: Vec<Flight> = self.bodies.iter().map(|body| self.flight(body)).collect();
        for link in self.links.iter().filter(|link| link.slider.is_some()) {
            let [x, y] = self.offset(link);
            let [px, py] = link.points[0];
            let radius = &mut flights[link.bodies[0]].radius;
            *radius = (*radius).max(fx(2.0 * (x.hypot(y) + px.hypot(py))));
        }
        let mut joints: Vec<Joint> = self.links.iter().map(|link| self.joint(link)).collect();
        joints.extend(self.free_line.map(|link| Joint {
            kind: JointKind::Line,
            impulses: Impulses::default(),
            ..joints[link]
        }));
        let bodies = self.bodies.iter().enumerate();
        let mut contacts: Vec<Contact> = bodies.filter_map(|(i, body)| self.contact(i, body)).collect();
        let on_floor = contacts.len();
        contacts.extend(self.disc_contacts());
        let Self { solver, corrections, options, .. } = self;
        let time_step = TimeStep::hz(RATE);
        solver.prepare(time_step, options, &flights, &joints, &contacts);
        let clock = Clock::new(time_step, options.substeps);
        let passes = SubSteps { solver, clock: &clock, options, contacts: &contacts };
        self.cut += run_with(self.vectors.unwrap_or_else(VectorSet::used), passes);
        solver.finish(time_step, options, &flights, &mut joints, &mut contacts, corrections);
        for (link, joint) in self.links.iter_mut().zip(&joints) {
            link.impulses = joint.impulses;
        }
        self.floor.fill(Impulses::default());
        self.discs = contacts[on_floor..].iter().map(|contact| (contact.bodies, contact.impulses)).collect();
        for contact in &contacts[..on_floor] {
            self.floor[contact.bodies[1] as usize] = contact.impulses;
        }
        for ((body, flight), correction) in self.bodies.iter_mut().zip(&flights).zip(&self.corrections) {
            let sum = |a: f64, fixed: Fx, exact: FxAccumulator| a + (double(fixed) + change(exact));
            body.at = [
                sum(body.at[0], flight.displacement.x, correction.displacement.x),
                sum(body.at[1], flight.displacement.y, correction.displacement.y),
            ];
            body.angle = sum(body.angle, flight.rotation, correction.rotation);
            let Vec2 { x, y } = flight.end.linear;
            body.velocity = [sum(0.0, x, correction.velocity.x), sum(0.0, y, correction.velocity.y)];
            body.spin = sum(0.0, flight.end.angular, correction.angular_velocity);
        }
    }

    pub(super) fn run(&mut self, seconds: f64) {
        (0..(seconds * f64::from(RATE)).round() as usize).for_each(|_| self.step());
    }

    /// The capacity of the solver's buffers for joints.
    pub(super) fn memory_of_joints(&self) -> usize {
        let Solver { joints, paths, .. } = &self.solver;
        joints.capacity() + paths.capacity()
    }

    /// The largest error of the distance between the points of a joint.
    pub(super) fn worst_gap(&self) -> f64 {
        let gap = |link: &Link| {
            let [along, across] = self.offset(link);
            match (link.slider, link.slide) {
                (Some(_), _) => across.abs(),
                (None, Some(_)) => 0.0,
                (None, None) => (along - link.length.unwrap_or(0.0)).abs(),
            }
        };
        self.links.iter().map(gap).fold(0.0, f64::max)
    }

    /// The largest speed of a point of a body.
    pub(super) fn largest_speed(&self) -> f64 {
        let speed = |body: &Body| body.velocity[0].hypot(body.velocity[1]) + body.spin.abs() * body.radius;
        self.bodies.iter().map(speed).fold(0.0, f64::max)
    }

    pub(super) fn energy(&self) -> f64 {
        let body_energy = |body: &Body| {
            let [vx, vy] = body.velocity;
            let height = -(self.gravity[0] * body.at[0] + self.gravity[1] * body.at[1]);
            body.mass * (0.5 * (vx * vx + vy * vy) + height) + 0.5 * body.inertia * body.spin * body.spin
        };
        self.bodies.iter().map(body_energy).sum()
    }
}
