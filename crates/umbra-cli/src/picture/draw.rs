//! The drawing itself.

use umbra_physics::BodyClass;

use super::axis::ticks;
use super::clip;
use super::layout::Layout;
use super::outline::{Outline, Ring};
use super::simplify::simplify;
use super::svg::{Anchor, Label, Paint, Stroke, Svg, text_width};
use super::{EndState, Picture, Point, length};
use crate::surface::Surface;

/// Colours that are told apart by people who do not see all of them (Okabe, Ito 2008), without the yellow, and three
/// more.
const COLOURS: [u32; 10] =
    [0x0072B2, 0xD55E00, 0x009E73, 0xCC79A7, 0xE69F00, 0x56B4E9, 0x5A5A5A, 0x783CA0, 0x8C5A32, 0x00463C];
const WHITE: Paint = Paint::solid(0xFFFFFF);
const INK: Paint = Paint::solid(0x323232);
const SOFT: Paint = Paint::solid(0x6E6E6E);
const FAINT: Paint = Paint::solid(0xECECEC);
const ZONE: Paint = Paint::solid(0x78AADC).thinned(0.16);
const SPRING: Paint = Paint::solid(0x828282);
const JOINT: Paint = Paint::solid(0x323232).thinned(0.8);
const EXPOSURE: Paint = Paint::solid(0x787878).thinned(0.6);
const QUARANTINED: Paint = Paint::solid(0xC80000);
/// The colour of contacts: dark red, which no body has that moves.
const IMPULSE: Paint = Paint::solid(0xA50F15);
/// The colour of disabled bodies, which are outlines alone.
const ABSENT: Paint = Paint::solid(0x969696);
/// The share of its opacity that the area of a sensor has.
const SENSOR: f64 = 0.25;
/// Ways that have names beside the picture.
const NAMED: usize = 10;
/// Points of all ways in a picture, about.
const POINTS: usize = 40_000;

/// Margins around the plot, px. The left one is wider where the labels of the axis are.
const LEFT: f64 = 72.0;
const BELOW: f64 = 52.0;
const ABOVE: f64 = 62.0;
const RIGHT: f64 = 24.0;
const LEGEND: f64 = 150.0;
/// From the edge of the picture to the name of the axis, px.
const EDGE: f64 = 10.0;
/// From the plot to a label beside it, px.
const GAP: f64 = 9.0;
/// Sizes of letters, px.
const TITLE: f64 = 19.0;
const NAME: f64 = 13.0;
const SMALL: f64 = 12.0;

/// A drawing in progress. What is given in m is cut at the edge of the plot.
struct Drawing {
    svg: Svg,
    layout: Layout,
    /// The left edge of the plot, px.
    left: f64,
}

pub(super) fn draw(picture: &Picture<'_>) -> String {
    let layout = Layout::of(picture);
    let caption = caption(picture, &layout);
    let columns = ticks(layout.least.0, layout.most.0, 70.0 / layout.scale());
    let rows = ticks(layout.least.1, layout.most.1, 40.0 / layout.scale());
    let widest = rows.iter().map(|(_, label)| text_width(label, SMALL)).fold(0.0, f64::max);
    let left = LEFT.max(EDGE + NAME + 2.0 * GAP + widest);
    let right = left + layout.width;
    let has_legend = (2..=NAMED).contains(&picture.ways.len());
    let width = (right + if has_legend { LEGEND } else { RIGHT }).max(left + text_width(&caption, SMALL) + EDGE);
    let mut drawing = Drawing { svg: Svg::new(width.ceil(), ABOVE + layout.height + BELOW), layout, left };
    let letters = ((width - left) / text_width("m", TITLE)) as usize;
    drawing.text((left, 22.0), &shortened(picture.title, letters), TITLE, INK);
    drawing.text((left, 45.0), &caption, SMALL, SOFT);
    if has_legend {
        for (line, way) in picture.ways.iter().enumerate() {
            let (x, y) = (right + 16.0, ABOVE + 10.0 + 20.0 * line as f64);
            let stroke = Stroke { paint: Paint::solid(colour(picture, way.index)), width: 2.5 };
            drawing.svg.line([(x, y), (x + 18.0, y)], stroke);
            drawing.text((x + 25.0, y), &shortened(way.name, 16), SMALL, INK);
        }
    }
    drawing.axes(&columns, &rows);
    for zone in &picture.scenery.zones {
        drawing.area(zone, ZONE);
    }
    drawing.springs(&picture.scenery.springs);
    drawing.ways(picture);
    for outline in picture.exposures {
        drawing.outline(outline, EXPOSURE, 0.0, 0.8);
    }
    for body in &picture.bodies {
        drawing.end(picture, body);
    }
    drawing.joints(&picture.scenery.joints, &picture.scenery.joint_ends);
    for &(x, y) in picture.scenery.centres.iter().filter(|&&centre| layout.holds(centre)) {
        let (arm, stroke) = (5.0 / layout.scale(), Stroke { paint: INK, width: 1.5 });
        drawing.line(&[(x - arm, y - arm), (x + arm, y + arm)], stroke);
        drawing.line(&[(x - arm, y + arm), (x + arm, y - arm)], stroke);
    }
    drawing.contacts(picture);
    drawing.svg.finish()
}

/// The caption, with what the length of an impulse stands for.
fn caption(picture: &Picture<'_>, layout: &Layout) -> String {
    let contacts = &picture.contacts;
    if contacts.impulses.is_empty() {
        return picture.caption.clone();
    }
    format!("{}, impulses {:.3} m per N·s", picture.caption, contacts.scale(layout.longest_impulse()))
}

/// The colour of the way of this index.
fn colour(picture: &Picture<'_>, index: usize) -> u32 {
    let rank = picture.ways.iter().position(|way| way.index == index).unwrap_or(0);
    if picture.ways.len() <= 60 { COLOURS[rank % COLOURS.len()] } else { COLOURS[0] }
}

fn shortened(text: &str, letters: usize) -> String {
    if text.chars().count() <= letters {
        return text.to_owned();
    }
    text.chars().take(letters.saturating_sub(1)).chain(['…']).collect()
}

/// A spring as one draws it: zigzag between two straight ends.
fn coil(a: Point, b: Point, scale: f64) -> Vec<Point> {
    const TEETH: i32 = 10;
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let length = length((dx, dy));
    if length * scale < 30.0 {
        return vec![a, b];
    }
    let high = 4.0 / scale;
    let (nx, ny) = (-dy / length * high, dx / length * high);
    let at = |along: f64, side: f64| (a.0 + dx * along + nx * side, a.1 + dy * along + ny * side);
    let teeth = (0..TEETH).map(|i| {
        let along = 0.15 + 0.7 * (f64::from(i) + 0.5) / f64::from(TEETH);
        at(along, if i % 2 == 0 { 1.0 } else { -1.0 })
    });
    [a, at(0.15, 0.0)].into_iter().chain(teeth).chain([at(0.85, 0.0), b]).collect()
}

impl Drawing {
    /// The place of a point of the plane in the picture, px.
    fn place(&self, position: Point) -> Point {
        let Layout { least, height, .. } = self.layout;
        let scale = self.layout.scale();
        (self.left + (position.0 - least.0) * scale, ABOVE + height - (position.1 - least.1) * scale)
    }

    /// A text from its place in px to the right.
    fn text(&mut self, place: Point, text: &str, size: f64, paint: Paint) {
        self.svg.label(place, Label { text, size, paint, anchor: Anchor::Start });
    }

    /// The grid, the two axes, and their names.
    fn axes(&mut self, columns: &[(f64, String)], rows: &[(f64, String)]) {
        const TICK: f64 = 4.0;
        let Self { left, layout: Layout { width, height, .. }, .. } = *self;
        let (right, bottom) = (left + width, ABOVE + height);
        let (grid, axis) = (Stroke { paint: FAINT, width: 1.0 }, Stroke { paint: INK, width: 1.0 });
        let mut marks = Vec::new();
        for (value, text) in columns {
            let (x, _) = self.place((*value, 0.0));
            self.svg.line([(x, ABOVE), (x, bottom)], grid);
            marks.push([(x, bottom), (x, bottom + TICK)]);
            let place = (x, bottom + GAP + 0.5 * SMALL);
            self.svg.label(place, Label { text, size: SMALL, paint: INK, anchor: Anchor::Middle });
        }
        for (value, text) in rows {
            let (_, y) = self.place((0.0, *value));
            self.svg.line([(left, y), (right, y)], grid);
            marks.push([(left - TICK, y), (left, y)]);
            self.svg.label((left - GAP, y), Label { text, size: SMALL, paint: INK, anchor: Anchor::End });
        }
        for mark in marks {
            self.svg.line(mark, axis);
        }
        self.svg.line([(left, ABOVE), (left, bottom), (right, bottom)], axis);
        let name = |text| Label { text, size: NAME, paint: INK, anchor: Anchor::Middle };
        self.svg.label((left + 0.5 * width, bottom + BELOW - EDGE - 0.5 * NAME), name("x in m"));
        self.svg.upright_label((EDGE, ABOVE + 0.5 * height), name("y in m"));
    }

    /// A line through points of the plane.
    fn line(&mut self, points: &[Point], stroke: Stroke) {
        self.edge(points, stroke, Surface::Solid);
    }

    /// The edge of a collider through points of the plane: of a sensor, a one-way one or a belt it has dashes.
    fn edge(&mut self, points: &[Point], stroke: Stroke, surface: Surface) {
        for piece in clip::line(points, &self.layout.window()) {
            let piece: Vec<Point> = piece.into_iter().map(|point| self.place(point)).collect();
            match surface {
                Surface::Solid => self.svg.line(piece, stroke),
                Surface::Sensor => self.svg.dashed_line(piece, stroke, "4 4"),
                Surface::OneWay => self.svg.dashed_line(piece, stroke, "9 3 2 3"),
                Surface::Belt => self.svg.dashed_line(piece, stroke, "2 2"),
            }
        }
    }

    /// A polygon of the plane without its edge.
    fn area(&mut self, ring: &[Point], fill: Paint) {
        let inside: Vec<Point> =
            clip::polygon(ring, &self.layout.window()).into_iter().map(|point| self.place(point)).collect();
        if !inside.is_empty() {
            self.svg.area(inside, fill);
        }
    }

    /// A circle of a radius in px about a point of the plane.
    fn circle(&mut self, centre: Point, radius: f64, fill: Paint, rim: Option<Stroke>) {
        if self.layout.holds(centre) {
            self.svg.circle(self.place(centre), radius, fill, rim);
        }
    }

    fn outline(&mut self, outline: &Outline, paint: Paint, filled: f64, width: f64) {
        let stroke = Stroke { paint, width };
        for Ring { surface, points } in &outline.rings {
            if filled > 0.0 {
                let share = if *surface == Surface::Sensor { SENSOR } else { 1.0 };
                self.area(points, paint.thinned(filled * share));
            }
            let closed: Vec<Point> = points.iter().chain(points.first()).copied().collect();
            self.edge(&closed, stroke, *surface);
        }
        for line in &outline.strokes {
            self.edge(&line.ends, stroke, line.surface);
        }
    }

    fn springs(&mut self, springs: &[[Point; 2]]) {
        let few = springs.len() <= 24;
        let stroke =
            if few { Stroke { paint: SPRING, width: 1.1 } } else { Stroke { paint: SPRING.thinned(0.6), width: 0.7 } };
        for &[a, b] in springs {
            let path = if few { coil(a, b, self.layout.scale()) } else { vec![a, b] };
            self.line(&path, stroke);
        }
    }

    /// The lines of joints, and a small diamond at each end; of a crowd of joints the lines alone.
    fn joints(&mut self, lines: &[[Point; 2]], ends: &[Point]) {
        const CROWD: usize = 400;
        let (arm, stroke) = (2.5 / self.layout.scale(), Stroke { paint: JOINT, width: 1.2 });
        for line in lines {
            self.line(line, stroke);
        }
        for &(x, y) in ends.iter().filter(|_| ends.len() <= CROWD) {
            self.line(&[(x - arm, y), (x, y + arm), (x + arm, y), (x, y - arm), (x - arm, y)], stroke);
        }
    }

    fn ways(&mut self, picture: &Picture<'_>) {
        let (crowd, scale) = (picture.ways.len(), self.layout.scale());
        let (width, strength) = match crowd {
            0..=10 => (1.6, 0.9),
            11..=60 => (1.1, 0.7),
            _ => (0.7, 0.3),
        };
        // A tenth of a pixel, for the faint lines of a crowd a third, or more until the picture is small enough.
        let mut tolerance = if crowd <= 60 { 0.1 } else { 0.3 } / scale;
        let lines = loop {
            let lines: Vec<Vec<Vec<Point>>> = (picture.ways.iter())
                .map(|way| way.pieces.iter().map(|piece| simplify(piece, tolerance)).collect())
                .collect();
            if tolerance * scale > 1.0 || lines.iter().flatten().map(Vec::len).sum::<usize>() <= POINTS {
                break lines;
            }
            tolerance *= 2.0;
        };
        for (way, pieces) in picture.ways.iter().zip(&lines) {
            let paint = Paint::solid(colour(picture, way.index)).thinned(strength);
            for points in pieces {
                self.line(points, Stroke { paint, width });
            }
        }
        for way in picture.ways.iter().filter(|_| crowd <= 60) {
            let paint = Paint::solid(colour(picture, way.index));
            self.circle(way.pieces[0][0], 3.2, WHITE, Some(Stroke { paint, width: 1.4 }));
        }
    }

    fn end(&mut self, picture: &Picture<'_>, body: &EndState) {
        let class = body.outline.class;
        let paint = match (class, body.way) {
            (BodyClass::Quarantined, _) => QUARANTINED,
            (BodyClass::Disabled, _) => ABSENT,
            (_, Some(index)) => Paint::solid(colour(picture, index)),
            (BodyClass::Static, None) => INK,
            (_, None) => Paint::solid(COLOURS[0]),
        };
        let filled = match class {
            BodyClass::Static => 0.35,
            BodyClass::Disabled => 0.0,
            _ => 0.22,
        };
        let reach = body.outline.points().map(|p| length((p.0 - body.at.0, p.1 - body.at.1))).fold(0.0, f64::max);
        let reach = reach * self.layout.scale();
        if reach >= 2.0 {
            self.outline(&body.outline, paint, filled, 1.3);
        }
        let radius = match picture.bodies.len() {
            0..=60 => 3.2,
            61..=2_000 => 1.6,
            _ => 0.9,
        };
        if reach < 2.0 || (body.way.is_some() && reach < 60.0) {
            self.circle(body.at, radius, paint, None);
        }
    }

    /// Points over normals over impulses.
    fn contacts(&mut self, picture: &Picture<'_>) {
        let contacts = &picture.contacts;
        let is_crowd = contacts.points.len().max(contacts.normals.len()) > 600;
        let scale = contacts.scale(self.layout.longest_impulse());
        for &[from, along] in &contacts.impulses {
            self.arrow([from, (along.0 * scale, along.1 * scale)], Stroke { paint: IMPULSE, width: 1.3 });
        }
        let length = if is_crowd { 6.0 } else { 11.0 } / self.layout.scale();
        for &[from, along] in &contacts.normals {
            let to = (from.0 + along.0 * length, from.1 + along.1 * length);
            self.line(&[from, to], Stroke { paint: INK, width: 1.0 });
        }
        for &point in &contacts.points {
            self.circle(point, if is_crowd { 0.9 } else { 1.8 }, IMPULSE, None);
        }
    }

    /// An arrow from a point along a vector, m.
    fn arrow(&mut self, [from, along]: [Point; 2], stroke: Stroke) {
        let to = (from.0 + along.0, from.1 + along.1);
        self.line(&[from, to], stroke);
        let length = length(along);
        let head = (6.0 / self.layout.scale()).min(0.4 * length);
        if head * self.layout.scale() < 1.0 {
            return;
        }
        let (ux, uy) = (along.0 / length * head, along.1 / length * head);
        let side = |s: f64| (to.0 - ux - s * uy, to.1 - uy + s * ux);
        self.line(&[side(0.5), to, side(-0.5)], stroke);
    }
}
