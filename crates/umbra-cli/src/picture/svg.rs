//! SVG of a few elements, in px.

use std::fmt::Write as _;

use super::Point;
use crate::text::markup;

/// A colour, 0xRRGGBB, and how much of it covers what is below, 0 to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Paint {
    colour: u32,
    opacity: f64,
}

impl Paint {
    pub(super) const fn solid(colour: u32) -> Self {
        Self { colour, opacity: 1.0 }
    }

    /// The paint with a share of its opacity.
    pub(super) const fn thinned(self, share: f64) -> Self {
        Self { opacity: self.opacity * share, ..self }
    }

    /// The attributes of an element that is filled or stroked with it.
    fn attributes(self, kind: &str) -> String {
        let Self { colour, opacity } = self;
        let colour = format!("{kind}=\"#{colour:06X}\"");
        if opacity == 1.0 { colour } else { format!("{colour} {kind}-opacity=\"{opacity:.2}\"") }
    }
}

/// A line of a width, px.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    pub(super) paint: Paint,
    pub(super) width: f64,
}

impl Stroke {
    fn attributes(self) -> String {
        format!("{} stroke-width=\"{}\"", self.paint.attributes("stroke"), number(self.width))
    }
}

/// The side of its place on which a text is.
#[derive(Clone, Copy, Debug)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A text in one line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Label<'a> {
    pub(super) text: &'a str,
    /// The size of the letters, px.
    pub(super) size: f64,
    pub(super) paint: Paint,
    pub(super) anchor: Anchor,
}

/// The width of a text, px, at a guess: which font a viewer has is not known.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    0.6 * size * text.chars().count() as f64
}

/// A picture in progress.
#[derive(Debug)]
pub(super) struct Svg(String);

impl Svg {
    /// A white picture of a size, px.
    pub(super) fn new(width: f64, height: f64) -> Self {
        let size = format!("width=\"{}\" height=\"{}\"", number(width), number(height));
        Self(format!(
            "<svg {size} viewBox=\"0 0 {} {}\" xmlns=\"http://www.w3.org/2000/svg\" font-family=\"sans-serif\" \
             stroke-linejoin=\"round\">\n<rect {size} fill=\"#FFFFFF\"/>\n",
            number(width),
            number(height),
        ))
    }

    pub(super) fn line(&mut self, points: impl IntoIterator<Item = Point>, stroke: Stroke) {
        let (points, stroke) = (list(points), stroke.attributes());
        let _ = writeln!(self.0, "<polyline fill=\"none\" {stroke} points=\"{points}\"/>");
    }

    /// A line with dashes, which are given as SVG has them.
    pub(super) fn dashed_line(&mut self, points: impl IntoIterator<Item = Point>, stroke: Stroke, dashes: &str) {
        let (points, stroke) = (list(points), stroke.attributes());
        let _ =
            writeln!(self.0, "<polyline fill=\"none\" {stroke} stroke-dasharray=\"{dashes}\" points=\"{points}\"/>");
    }

    pub(super) fn area(&mut self, corners: impl IntoIterator<Item = Point>, fill: Paint) {
        let (corners, fill) = (list(corners), fill.attributes("fill"));
        let _ = writeln!(self.0, "<polygon {fill} points=\"{corners}\"/>");
    }

    pub(super) fn circle(&mut self, centre: Point, radius: f64, fill: Paint, rim: Option<Stroke>) {
        let rim = rim.map_or_else(String::new, |rim| format!(" {}", rim.attributes()));
        let [x, y, radius] = [centre.0, centre.1, radius].map(number);
        let fill = fill.attributes("fill");
        let _ = writeln!(self.0, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" {fill}{rim}/>");
    }

    /// A text about as high above its place as below it.
    pub(super) fn label(&mut self, place: Point, label: Label<'_>) {
        let [x, y] = [place.0, place.1 + 0.35 * label.size].map(number);
        self.text(&format!("x=\"{x}\" y=\"{y}\""), label);
    }

    /// A text that is read from below, to the right of its place.
    pub(super) fn upright_label(&mut self, place: Point, label: Label<'_>) {
        let [x, y] = [place.0 + label.size, place.1].map(number);
        self.text(&format!("transform=\"translate({x} {y}) rotate(-90)\""), label);
    }

    fn text(&mut self, place: &str, Label { text, size, paint, anchor }: Label<'_>) {
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        let (size, fill, text) = (number(size), paint.attributes("fill"), markup(text));
        let _ = writeln!(self.0, "<text {place} font-size=\"{size}\" {fill}{anchor}>{text}</text>");
    }

    pub(super) fn finish(self) -> String {
        self.0 + "</svg>\n"
    }
}

fn list(points: impl IntoIterator<Item = Point>) -> String {
    points.into_iter().map(|(x, y)| format!("{},{}", number(x), number(y))).collect::<Vec<_>>().join(" ")
}

/// A number to a tenth, without a zero at its end.
fn number(value: f64) -> String {
    ((value * 10.0).round() / 10.0 + 0.0).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!([2.0, -1.26, 0.1 + 0.2, -0.01].map(number), ["2", "-1.3", "0.3", "0"]);
    }

    #[test]
    fn texts_are_no_markup() {
        let mut svg = Svg::new(10.0, 20.0);
        let paint = Paint::solid(0xABC).thinned(0.5);
        svg.label((1.0, 2.0), Label { text: "<a & \"b\">", size: 10.0, paint, anchor: Anchor::End });
        let line = r##"<text x="1" y="5.5" font-size="10" fill="#000ABC" fill-opacity="0.50" text-anchor="end">&lt;a &amp; &quot;b&quot;&gt;</text>"##;
        assert_eq!(svg.finish().lines().nth(2), Some(line));
    }
}
