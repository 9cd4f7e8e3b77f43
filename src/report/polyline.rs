//! Preparation of polylines: division at missing values, thinning, dashes, clipping.

/// A point, in the units of the data or in pixels.
pub(super) type Point = (f64, f64);

/// The stretches between missing values.
pub(super) fn runs(points: &[Point]) -> impl Iterator<Item = &[Point]> {
    points.split(|p| !(p.0.is_finite() && p.1.is_finite())).filter(|run| !run.is_empty())
}

/// Thins one run to about four points per column (first, lowest, highest, last), so that no peak is lost.
/// Lines that are not monotonic in x are thinned by omitting points regularly.
pub(super) fn decimate(run: &[Point], columns: usize) -> Vec<Point> {
    let columns = columns.max(1);
    let limit = 4 * columns;
    if run.len() <= limit {
        return run.to_vec();
    }
    let (first, last) = (run[0].0, run[run.len() - 1].0);
    let width = (last - first) / columns as f64;
    let turns_back = run.windows(2).any(|pair| pair[1].0 < pair[0].0);
    if turns_back || width <= 0.0 {
        let stride = run.len().div_ceil(limit);
        return run.iter().copied().step_by(stride).chain(run.last().copied()).collect();
    }
    let column = |p: &Point| (((p.0 - first) / width) as usize).min(columns - 1);
    let mut kept = Vec::with_capacity(limit);
    for bucket in run.chunk_by(|a, b| column(a) == column(b)) {
        keep_extremes(bucket, &mut kept);
    }
    kept
}

fn keep_extremes(bucket: &[Point], kept: &mut Vec<Point>) {
    let by_y = |i: &usize, j: &usize| bucket[*i].1.total_cmp(&bucket[*j].1);
    let lowest = (0..bucket.len()).min_by(by_y).unwrap_or(0);
    let highest = (0..bucket.len()).max_by(by_y).unwrap_or(0);
    let mut chosen = [0, lowest, highest, bucket.len() - 1];
    chosen.sort_unstable();
    let mut previous = None;
    for index in chosen {
        if previous != Some(index) {
            kept.push(bucket[index]);
        }
        previous = Some(index);
    }
}

/// Thins dots to at most one per square of this side, keeping the first of each.
pub(super) fn thin_dots(dots: &[Point], side: f64) -> Vec<Point> {
    let mut taken = std::collections::HashSet::new();
    let square = |v: f64| (v / side).floor() as i64;
    dots.iter().copied().filter(|p| taken.insert((square(p.0), square(p.1)))).collect()
}

/// A rectangle in pixels, y downwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rect {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

impl Rect {
    pub(super) fn width(&self) -> f64 {
        self.right - self.left
    }

    pub(super) fn height(&self) -> f64 {
        self.bottom - self.top
    }

    pub(super) fn contains(&self, p: Point) -> bool {
        (self.left..=self.right).contains(&p.0) && (self.top..=self.bottom).contains(&p.1)
    }
}

/// The parts of a polyline inside a rectangle.
///
/// Source: Y.-D. Liang, B. A. Barsky, "A new concept and method for line clipping", 1984.
pub(super) fn clip_line(line: &[Point], to: Rect) -> Vec<Vec<Point>> {
    let mut parts: Vec<Vec<Point>> = Vec::new();
    for pair in line.windows(2) {
        let Some((from, until)) = clip_segment(pair[0], pair[1], to) else { continue };
        match parts.last_mut() {
            Some(part) if part.last() == Some(&from) => part.push(until),
            _ => parts.push(vec![from, until]),
        }
    }
    parts
}

fn clip_segment(a: Point, b: Point, to: Rect) -> Option<(Point, Point)> {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    let edges =
        [(-dx, a.0 - to.left), (dx, to.right - a.0), (-dy, a.1 - to.top), (dy, to.bottom - a.1)];
    for (p, q) in edges {
        if p == 0.0 && q < 0.0 {
            return None;
        } else if p < 0.0 {
            enter = enter.max(q / p);
        } else if p > 0.0 {
            leave = leave.min(q / p);
        }
    }
    let at = |t: f64| (a.0 + t * dx, a.1 + t * dy);
    // a corner inside is kept exactly, so that consecutive pieces join
    let from = if enter == 0.0 { a } else { at(enter) };
    let until = if leave == 1.0 { b } else { at(leave) };
    (enter <= leave).then_some((from, until))
}

/// The part of a polygon inside a rectangle.
///
/// Source: I. E. Sutherland, G. W. Hodgman, "Reentrant polygon clipping", 1974.
pub(super) fn clip_polygon(polygon: &[Point], to: Rect) -> Vec<Point> {
    let sides: [&dyn Fn(Point) -> f64; 4] =
        [&|p| p.0 - to.left, &|p| to.right - p.0, &|p| p.1 - to.top, &|p| to.bottom - p.1];
    let mut kept = polygon.to_vec();
    for inside in sides {
        let corners = std::mem::take(&mut kept);
        for (i, &b) in corners.iter().enumerate() {
            let a = corners[(i + corners.len() - 1) % corners.len()];
            let (da, db) = (inside(a), inside(b));
            if (da < 0.0) != (db < 0.0) {
                let t = da / (da - db);
                kept.push((a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1)));
            }
            if db >= 0.0 {
                kept.push(b);
            }
        }
    }
    kept
}

/// Divides a polyline into dashes: `pattern` contains the lengths of mark and gap.
pub(super) fn dashes(line: &[Point], pattern: (f64, f64)) -> Vec<Vec<Point>> {
    let mut parts = Vec::new();
    let mut part = Vec::new();
    let (mut marking, mut left) = (true, pattern.0);
    for pair in line.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let length = (b.0 - a.0).hypot(b.1 - a.1);
        let mut done = 0.0;
        if marking && part.is_empty() {
            part.push(a);
        }
        while length - done > left {
            done += left;
            let t = done / length;
            let place = (a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1));
            part.push(place);
            if marking {
                parts.push(std::mem::take(&mut part));
            }
            marking = !marking;
            left = if marking { pattern.0 } else { pattern.1 };
        }
        left -= length - done;
        if marking {
            part.push(b);
        } else {
            part.clear();
        }
    }
    if marking && part.len() > 1 {
        parts.push(part);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Rect = Rect { left: 0.0, top: 0.0, right: 1.0, bottom: 1.0 };

    #[test]
    fn a_line_that_leaves_and_returns_is_two_parts_without_an_edge_between() {
        let line = [(0.25, 0.5), (0.5, -0.5), (0.75, 0.5)];
        let parts = clip_line(&line, UNIT);
        // crosses y = 0 half way of each segment
        assert_eq!(parts, vec![vec![(0.25, 0.5), (0.375, 0.0)], vec![(0.625, 0.0), (0.75, 0.5)]]);
    }

    #[test]
    fn a_line_outside_vanishes_and_one_inside_stays_whole() {
        assert!(clip_line(&[(2.0, 0.0), (3.0, 1.0)], UNIT).is_empty());
        let inside = [(0.1, 0.1), (0.2, 0.9), (0.9, 0.3)];
        assert_eq!(clip_line(&inside, UNIT), vec![inside.to_vec()]);
    }

    #[test]
    fn a_polygon_is_cut_at_the_edge() {
        let area = |p: &[Point]| {
            let term = |i: usize| {
                let (a, b) = (p[i], p[(i + 1) % p.len()]);
                a.0 * b.1 - b.0 * a.1
            };
            (0..p.len()).map(term).sum::<f64>().abs() / 2.0
        };
        // a diamond of radius 1 about the corner (0, 0): a quarter of its area 2 is inside
        let diamond = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)];
        assert!((area(&clip_polygon(&diamond, UNIT)) - 0.5).abs() < 1e-15);
    }

    #[test]
    fn thinning_keeps_every_peak_and_both_ends() {
        let mut line: Vec<Point> = (0..100_000).map(|i| (f64::from(i), 0.0)).collect();
        line[54_321].1 = 7.0;
        line[54_322].1 = -7.0;
        let thin = decimate(&line, 1000);
        assert!(thin.len() <= 4000);
        assert!(thin.contains(&(54_321.0, 7.0)) && thin.contains(&(54_322.0, -7.0)));
        assert_eq!((thin[0].0, thin[thin.len() - 1].0), (0.0, 99_999.0));
        let loops: Vec<Point> = (0..50_000).map(|i| f64::from(i).sin_cos()).collect();
        assert!(decimate(&loops, 1000).len() <= 4001);
    }

    #[test]
    fn missing_values_break_a_line() {
        let line = [(0.0, 0.0), (1.0, f64::NAN), (2.0, 0.0), (3.0, 0.0), (f64::INFINITY, 1.0)];
        let lengths: Vec<usize> = runs(&line).map(<[Point]>::len).collect();
        assert_eq!(lengths, [1, 2]);
    }

    #[test]
    fn dashes_have_the_length_of_the_pattern_around_corners() {
        let line = [(0.0, 0.0), (5.0, 0.0), (5.0, 5.0)];
        let parts = dashes(&line, (4.0, 2.0));
        // marks from 0 to 4 and from 6 to 10 along the line; the second starts behind the corner
        assert_eq!(parts, vec![vec![(0.0, 0.0), (4.0, 0.0)], vec![(5.0, 1.0), (5.0, 5.0)]]);
    }
}
