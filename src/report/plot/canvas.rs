//! The drawing surface of plotters: strokes, fills and text in CSS pixels.
//!
//! plotters rounds coordinates to whole pixels. Drawing on a canvas eight times as large and declaring the
//! original size in the header gives a resolution of an eighth of a pixel: smooth lines, even text.

use plotters::coord::Shift;
use plotters::element::{Circle, PathElement, Polygon, Rectangle, Text};
use plotters::prelude::{DrawingArea, IntoDrawingArea, RGBAColor, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, ShapeStyle};

use crate::report::ReportError;
use crate::report::palette::Rgb;
use crate::report::polyline::{Point, Rect};

use super::pen::{Anchor, Pen, SUPERSAMPLING, printable, register_fonts, rgb};

/// Half an "ex" in the SVG reader: the offset that plotters adds to a vertically centred text.
const CENTER_SHIFT: f64 = 0.25;

pub(super) struct Canvas<'a> {
    area: DrawingArea<SVGBackend<'a>, Shift>,
    figure: &'a str,
}

impl<'a> Canvas<'a> {
    pub(super) fn new(
        svg: &'a mut String,
        (width, height): (u32, u32),
        figure: &'a str,
    ) -> Result<Self, ReportError> {
        register_fonts()?;
        let scale = SUPERSAMPLING as u32;
        let area = SVGBackend::with_string(svg, (width * scale, height * scale));
        Ok(Self { area: area.into_drawing_area(), figure })
    }

    pub(super) fn finish(self) -> Result<(), ReportError> {
        self.area.present().map_err(|e| self.error(&e))
    }

    pub(super) fn line(
        &self,
        points: &[Point],
        color: Rgb,
        width: f64,
        alpha: f64,
    ) -> Result<(), ReportError> {
        if points.len() < 2 {
            return Ok(());
        }
        let style = ShapeStyle {
            color: rgba(color, alpha),
            filled: false,
            stroke_width: (width * SUPERSAMPLING).round().max(1.0) as u32,
        };
        self.area.draw(&PathElement::new(on_canvas(points), style)).map_err(|e| self.error(&e))
    }

    pub(super) fn polygon(
        &self,
        points: &[Point],
        color: Rgb,
        alpha: f64,
    ) -> Result<(), ReportError> {
        if points.len() < 3 {
            return Ok(());
        }
        self.area
            .draw(&Polygon::new(on_canvas(points), rgba(color, alpha).filled()))
            .map_err(|e| self.error(&e))
    }

    pub(super) fn rectangle(&self, rect: Rect, color: Rgb, alpha: f64) -> Result<(), ReportError> {
        let corners = [place((rect.left, rect.top)), place((rect.right, rect.bottom))];
        self.area
            .draw(&Rectangle::new(corners, rgba(color, alpha).filled()))
            .map_err(|e| self.error(&e))
    }

    pub(super) fn dot(
        &self,
        center: Point,
        radius: f64,
        color: Rgb,
        alpha: f64,
    ) -> Result<(), ReportError> {
        let radius = (radius * SUPERSAMPLING).round().max(1.0) as u32;
        self.area
            .draw(&Circle::new(place(center), radius, rgba(color, alpha).filled()))
            .map_err(|e| self.error(&e))
    }

    /// Draws a text whose baseline passes through `at`.
    pub(super) fn text(
        &self,
        text: &str,
        at: Point,
        anchor: Anchor,
        pen: Pen,
    ) -> Result<(), ReportError> {
        let horizontal = match anchor {
            Anchor::Start => HPos::Left,
            Anchor::Middle => HPos::Center,
            Anchor::End => HPos::Right,
        };
        let style = pen.style().pos(Pos::new(horizontal, VPos::Center));
        let shift = CENTER_SHIFT * pen.size;
        let at = if pen.upright { (at.0 - shift, at.1) } else { (at.0, at.1 - shift) };
        self.area.draw(&Text::new(printable(text), place(at), style)).map_err(|e| self.error(&e))
    }

    fn error(&self, cause: &dyn std::fmt::Display) -> ReportError {
        ReportError::Draw { figure: self.figure.to_owned(), cause: cause.to_string() }
    }
}

fn place(point: Point) -> (i32, i32) {
    // the conversion saturates, so that even a place far off cannot overflow
    ((point.0 * SUPERSAMPLING).round() as i32, (point.1 * SUPERSAMPLING).round() as i32)
}

fn on_canvas(points: &[Point]) -> Vec<(i32, i32)> {
    let mut places: Vec<_> = points.iter().copied().map(place).collect();
    places.dedup();
    if places.len() == 1 {
        // a stretch shorter than an eighth of a pixel still leaves a mark
        places.push((places[0].0 + 1, places[0].1));
    }
    places
}

fn rgba(color: Rgb, alpha: f64) -> RGBAColor {
    rgb(color).mix(alpha)
}

/// Writes the original size to the header, and merges the attributes of consecutive dots.
pub(super) fn tidy(svg: &str, (width, height): (u32, u32)) -> String {
    let scale = SUPERSAMPLING as u32;
    let drawn = format!("width=\"{}\" height=\"{}\"", width * scale, height * scale);
    let shown = format!("width=\"{width}\" height=\"{height}\" stroke-linejoin=\"round\"");
    let mut tidied = String::with_capacity(svg.len());
    let mut group: Option<&str> = None;
    for (number, line) in svg.lines().enumerate() {
        let circle = line.strip_prefix("<circle ").and_then(|rest| rest.split_once(" opacity="));
        let attributes = circle.map(|(_, attributes)| attributes);
        if attributes != group {
            if group.is_some() {
                tidied.push_str("</g>\n");
            }
            if let Some(attributes) = attributes {
                let attributes = attributes.trim_end_matches("/>");
                tidied.push_str(&format!("<g fill-opacity={attributes}>\n"));
            }
            group = attributes;
        }
        match circle {
            Some((place, _)) => tidied.push_str(&format!("<circle {place}/>\n")),
            None if number == 0 => tidied.push_str(&line.replacen(&drawn, &shown, 1)),
            None => tidied.push_str(line),
        }
        // text stands between its tags without line breaks, which a browser would show as spaces
        let in_text = line.starts_with("<text") || !line.starts_with('<');
        if circle.is_none() && !in_text {
            tidied.push('\n');
        }
    }
    tidied
}
