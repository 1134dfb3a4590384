//! The drawing itself.

use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use umbra_physics::BodyClass;

use super::clip;
use super::layout::{FINE, Layout};
use super::outline::Outline;
use super::simplify::simplify;
use super::{EndState, Picture, Point};

type Plane<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
type Drawn = Result<(), String>;

/// Colours that are told apart by people who do not see all of them (Okabe, Ito 2008), without the yellow, and three
/// more.
const COLOURS: [RGBColor; 10] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(90, 90, 90),
    RGBColor(120, 60, 160),
    RGBColor(140, 90, 50),
    RGBColor(0, 70, 60),
];
const INK: RGBColor = RGBColor(50, 50, 50);
const FAINT: RGBColor = RGBColor(236, 236, 236);
/// The colour of contacts: dark red, which no body has that moves.
const IMPULSE: RGBColor = RGBColor(165, 15, 21);
/// The line style of disabled bodies, which are outlines alone.
const ABSENT: RGBColor = RGBColor(150, 150, 150);
/// Ways that have names beside the picture.
const NAMED: usize = 10;
/// Points of all ways in a picture, about.
const POINTS: usize = 40_000;

/// Margins around the plot, px.
const LEFT: i32 = 72;
/// From the edge of the picture to the name of the axis, px.
const EDGE: i32 = 10;
const BELOW: i32 = 52;
const ABOVE: i32 = 62;
const RIGHT: i32 = 24;
const LEGEND: i32 = 150;

fn fault(error: impl std::fmt::Display) -> String {
    error.to_string()
}

fn width(px: f64) -> u32 {
    (px * f64::from(FINE)).round() as u32
}

fn font(px: i32) -> FontDesc<'static> {
    ("sans-serif", px * FINE).into_font()
}

pub(super) fn draw(picture: &Picture<'_>) -> Result<String, String> {
    let layout = Layout::of(picture);
    let legend = (2..=NAMED).contains(&picture.ways.len());
    let size =
        ((LEFT + layout.width + if legend { LEGEND } else { RIGHT }) * FINE, (ABOVE + layout.height + BELOW) * FINE);
    let mut svg = String::new();
    {
        let root =
            SVGBackend::with_string(&mut svg, (size.0.unsigned_abs(), size.1.unsigned_abs())).into_drawing_area();
        root.fill(&WHITE).map_err(fault)?;
        let label = |text: &str, x: i32, y: i32, px: i32, colour: RGBColor| {
            let style = font(px).color(&colour).pos(Pos::new(HPos::Left, VPos::Center));
            root.draw(&Text::new(text.to_owned(), (x * FINE, y * FINE), style)).map_err(fault)
        };
        label(picture.title, LEFT, 22, 19, INK)?;
        label(&caption(picture, &layout), LEFT, 45, 12, RGBColor(110, 110, 110))?;
        if legend {
            for (line, way) in picture.ways.iter().enumerate() {
                let (x, y) = (LEFT + layout.width + 16, ABOVE + 10 + 20 * line as i32);
                let swatch = [(x * FINE, y * FINE), ((x + 18) * FINE, y * FINE)];
                let style = colour(picture, way.index).stroke_width(width(2.5));
                root.draw(&PathElement::new(swatch, style)).map_err(fault)?;
                label(&shortened(way.name), x + 25, y, 12, INK)?;
            }
        }
        let area = root.clone().shrink(
            ((EDGE * FINE).unsigned_abs(), (ABOVE * FINE).unsigned_abs()),
            (((LEFT - EDGE + layout.width) * FINE).unsigned_abs(), ((layout.height + BELOW) * FINE).unsigned_abs()),
        );
        draw_plane(picture, &layout, &area)?;
        root.present().map_err(fault)?;
    }
    // The size of the picture on a page; its inner coordinates stay fine.
    let fine = format!("width=\"{}\" height=\"{}\"", size.0, size.1);
    let page = format!("width=\"{}\" height=\"{}\"", size.0 / FINE, size.1 / FINE);
    Ok(svg.replacen(&fine, &page, 1))
}

fn draw_plane(
    picture: &Picture<'_>,
    layout: &Layout,
    area: &DrawingArea<SVGBackend<'_>, plotters::coord::Shift>,
) -> Drawn {
    let mut plane = ChartBuilder::on(area)
        .set_label_area_size(LabelAreaPosition::Left, (LEFT - EDGE) * FINE)
        .set_label_area_size(LabelAreaPosition::Bottom, BELOW * FINE)
        .build_cartesian_2d(layout.least.0..layout.most.0, layout.least.1..layout.most.1)
        .map_err(fault)?;
    let labels = |px: i32, each: i32| (px / each).unsigned_abs().max(3) as usize;
    plane
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(FAINT.stroke_width(width(1.0)))
        .axis_style(INK.stroke_width(width(1.0)))
        .label_style(font(12).color(&INK))
        .axis_desc_style(font(13).color(&INK))
        .x_labels(labels(layout.width, 70))
        .y_labels(labels(layout.height, 40))
        .x_label_formatter(&metres)
        .y_label_formatter(&metres)
        .x_desc("x in m")
        .y_desc("y in m")
        .set_all_tick_mark_size(4 * FINE)
        .draw()
        .map_err(fault)?;
    let fill = RGBColor(120, 170, 220).mix(0.16).filled();
    for zone in &picture.scenery.zones {
        draw_ring(&mut plane, layout, zone, Some(fill), None)?;
    }
    draw_springs(picture, layout, &mut plane)?;
    draw_ways(picture, layout, &mut plane)?;
    for outline in picture.exposures {
        draw_outline(&mut plane, layout, outline, RGBColor(120, 120, 120).mix(0.6), 0.0, 0.8)?;
    }
    for body in &picture.bodies {
        draw_end(picture, layout, &mut plane, body)?;
    }
    for &centre in picture.scenery.centres.iter().filter(|&&centre| layout.holds(centre)) {
        let mark = Cross::new(centre, 5 * FINE, INK.stroke_width(width(1.5)));
        plane.draw_series([mark]).map_err(fault)?;
    }
    draw_contacts(picture, layout, &mut plane)
}

/// The caption, with what the length of an impulse stands for.
fn caption(picture: &Picture<'_>, layout: &Layout) -> String {
    let contacts = &picture.contacts;
    if contacts.impulses.is_empty() {
        return picture.caption.clone();
    }
    format!("{}, impulses {:.3} m per N·s", picture.caption, contacts.scale(layout.longest_impulse()))
}

/// Points over normals over impulses.
fn draw_contacts(picture: &Picture<'_>, layout: &Layout, plane: &mut Plane<'_, '_>) -> Drawn {
    let contacts = &picture.contacts;
    let crowd = contacts.points.len().max(contacts.normals.len()) > 600;
    let scale = contacts.scale(layout.longest_impulse());
    for &[from, along] in &contacts.impulses {
        draw_arrow(plane, layout, [from, (along.0 * scale, along.1 * scale)], IMPULSE.stroke_width(width(1.3)))?;
    }
    let length = if crowd { 6.0 } else { 11.0 } / layout.scale();
    for &[from, along] in &contacts.normals {
        let to = (from.0 + along.0 * length, from.1 + along.1 * length);
        draw_line(plane, layout, &[from, to], INK.stroke_width(width(1.0)))?;
    }
    for &point in contacts.points.iter().filter(|&&point| layout.holds(point)) {
        let dot = Circle::new(point, width(if crowd { 0.9 } else { 1.8 }), IMPULSE.filled());
        plane.draw_series([dot]).map_err(fault)?;
    }
    Ok(())
}

/// An arrow from a point along a vector, m.
fn draw_arrow(plane: &mut Plane<'_, '_>, layout: &Layout, [from, along]: [Point; 2], style: ShapeStyle) -> Drawn {
    let to = (from.0 + along.0, from.1 + along.1);
    draw_line(plane, layout, &[from, to], style)?;
    let length = along.0.hypot(along.1);
    let head = (6.0 / layout.scale()).min(0.4 * length);
    if head * layout.scale() < 1.0 {
        return Ok(());
    }
    let (ux, uy) = (along.0 / length * head, along.1 / length * head);
    let side = |s: f64| (to.0 - ux - s * uy, to.1 - uy + s * ux);
    draw_line(plane, layout, &[side(0.5), to, side(-0.5)], style)
}

/// A coordinate at an axis, without zeros at its end.
fn metres(value: &f64) -> String {
    if value.abs() >= 1e6 {
        // Too long for the margin: 2.5e8.
        let text = format!("{value:.3e}");
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        let digits = digits.trim_end_matches('0').trim_end_matches('.');
        return format!("{digits}e{power}").replace('-', "\u{2212}");
    }
    // Rounded to what a label can show, which takes away what the additions before left: 0.30000000000000004.
    let text = format!("{value:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.replace('-', "\u{2212}") }
}

/// The colour of the way of this index.
fn colour(picture: &Picture<'_>, index: usize) -> RGBColor {
    let rank = picture.ways.iter().position(|way| way.index == index).unwrap_or(0);
    if picture.ways.len() <= 60 { COLOURS[rank % COLOURS.len()] } else { COLOURS[0] }
}

fn shortened(name: &str) -> String {
    const LONGEST: usize = 16;
    if name.chars().count() <= LONGEST {
        return name.to_owned();
    }
    name.chars().take(LONGEST - 1).chain(['…']).collect()
}

fn draw_ways(picture: &Picture<'_>, layout: &Layout, plane: &mut Plane<'_, '_>) -> Drawn {
    let crowd = picture.ways.len();
    let (line, strength) = match crowd {
        0..=10 => (1.6, 0.9),
        11..=60 => (1.1, 0.7),
        _ => (0.7, 0.3),
    };
    // A tenth of a pixel, for the faint lines of a crowd a third, or more until the picture is small enough.
    let mut tolerance = if crowd <= 60 { 0.1 } else { 0.3 } / layout.scale();
    let lines = loop {
        let lines: Vec<Vec<Point>> = picture.ways.iter().map(|way| simplify(way.points, tolerance)).collect();
        if tolerance * layout.scale() > 1.0 || lines.iter().map(Vec::len).sum::<usize>() <= POINTS {
            break lines;
        }
        tolerance *= 2.0;
    };
    for (way, points) in picture.ways.iter().zip(&lines) {
        let style = colour(picture, way.index).mix(strength).stroke_width(width(line));
        draw_line(plane, layout, points, style)?;
    }
    if crowd <= 60 {
        for way in picture.ways.iter().filter(|way| layout.holds(way.points[0])) {
            let style = colour(picture, way.index).stroke_width(width(1.4));
            let inside = Circle::new(way.points[0], width(3.2), WHITE.filled());
            plane.draw_series([inside]).map_err(fault)?;
            plane.draw_series([Circle::new(way.points[0], width(3.2), style)]).map_err(fault)?;
        }
    }
    Ok(())
}

fn draw_end(picture: &Picture<'_>, layout: &Layout, plane: &mut Plane<'_, '_>, body: &EndState) -> Drawn {
    let class = body.outline.class;
    let tint = match (class, body.way) {
        (BodyClass::Quarantined, _) => RGBColor(200, 0, 0),
        (BodyClass::Disabled, _) => ABSENT,
        (_, Some(index)) => colour(picture, index),
        (BodyClass::Static, None) => INK,
        (_, None) => COLOURS[0],
    };
    let filled = match class {
        BodyClass::Static => 0.35,
        BodyClass::Disabled => 0.0,
        _ => 0.22,
    };
    let seen = body.outline.rings.iter().flatten().chain(body.outline.strokes.iter().flatten());
    let reach = seen.map(|p| (p.0 - body.at.0).hypot(p.1 - body.at.1)).fold(0.0, f64::max) * layout.scale();
    if reach >= 2.0 {
        draw_outline(plane, layout, &body.outline, tint.mix(1.0), filled, 1.3)?;
    }
    let crowd = picture.bodies.len();
    let dot = if crowd <= 60 {
        3.2
    } else if crowd <= 2_000 {
        1.6
    } else {
        0.9
    };
    if layout.holds(body.at) && (reach < 2.0 || (body.way.is_some() && reach < 60.0)) {
        plane.draw_series([Circle::new(body.at, width(dot), tint.filled())]).map_err(fault)?;
    }
    Ok(())
}

fn draw_outline(
    plane: &mut Plane<'_, '_>,
    layout: &Layout,
    outline: &Outline,
    tint: RGBAColor,
    filled: f64,
    line: f64,
) -> Drawn {
    let fill = (filled > 0.0).then(|| tint.mix(filled).filled());
    for ring in &outline.rings {
        draw_ring(plane, layout, ring, fill, Some(tint.stroke_width(width(line))))?;
    }
    for stroke in &outline.strokes {
        draw_line(plane, layout, stroke, tint.stroke_width(width(line)))?;
    }
    Ok(())
}

fn draw_line(plane: &mut Plane<'_, '_>, layout: &Layout, points: &[Point], style: ShapeStyle) -> Drawn {
    for piece in clip::line(points, &layout.window()) {
        plane.draw_series([PathElement::new(piece, style)]).map_err(fault)?;
    }
    Ok(())
}

fn draw_ring(
    plane: &mut Plane<'_, '_>,
    layout: &Layout,
    ring: &[Point],
    fill: Option<ShapeStyle>,
    line: Option<ShapeStyle>,
) -> Drawn {
    if let Some(fill) = fill {
        let inside = clip::polygon(ring, &layout.window());
        if !inside.is_empty() {
            plane.draw_series([Polygon::new(inside, fill)]).map_err(fault)?;
        }
    }
    if let Some(line) = line {
        let closed: Vec<Point> = ring.iter().chain(ring.first()).copied().collect();
        draw_line(plane, layout, &closed, line)?;
    }
    Ok(())
}

fn draw_springs(picture: &Picture<'_>, layout: &Layout, plane: &mut Plane<'_, '_>) -> Drawn {
    let few = picture.scenery.springs.len() <= 24;
    let style =
        RGBColor(130, 130, 130).mix(if few { 1.0 } else { 0.6 }).stroke_width(width(if few { 1.1 } else { 0.7 }));
    for &[a, b] in &picture.scenery.springs {
        let path = if few { coil(a, b, layout.scale()) } else { vec![a, b] };
        draw_line(plane, layout, &path, style)?;
    }
    Ok(())
}

/// A spring as one draws it: zigzag between two straight ends.
fn coil(a: Point, b: Point, scale: f64) -> Vec<Point> {
    const TEETH: i32 = 10;
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let length = dx.hypot(dy);
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
