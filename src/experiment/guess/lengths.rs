//! Lengths of the robot that recordings state or determine.

use std::path::{Path, PathBuf};

use super::guessed::Guess;
use super::heading::{Turned, turned};
use crate::io::{preview, stated_radius};
use crate::math::distribution::t_quantile;

/// Fewest intervals, and the smallest sum of the changes of heading in them \[rad\].
const FEWEST: usize = 4;
const LEAST_TURN: f64 = 1.0;
/// Half-width of the interval of the half track, as a share of it, above which it is not offered.
const WIDEST: f64 = 0.25;

/// A length \[m\] with the text on its origin.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::experiment) struct Length {
    pub(in crate::experiment) metres: f64,
    pub(in crate::experiment) origin: String,
}

/// The lengths of a robot that are known from its recordings.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::experiment) struct Lengths {
    /// Radius of the wheels.
    pub(in crate::experiment) radius: Option<Length>,
    /// Half the distance between the wheels.
    pub(in crate::experiment) half_track: Option<Length>,
}

impl Lengths {
    /// The radius that the first recording states, and the half track by which the heading follows the wheels in all of
    /// them.
    pub(in crate::experiment) fn of(recordings: &[PathBuf], guess: &Guess) -> Self {
        let radius = stated_radius(&recordings[0])
            .map(|(metres, text)| Length { metres, origin: format!("{text} in the file") });
        let half_track = half_track(recordings, guess, radius.as_ref().map(|r| r.metres));
        Self { radius, half_track }
    }

    /// Sentences on them.
    pub(in crate::experiment) fn words(&self) -> impl Iterator<Item = String> {
        let of = |name: &str, length: &Option<Length>| {
            length.as_ref().map(|l| format!("{name} = {:.4} m: {}", l.metres, l.origin))
        };
        [of("r_m", &self.radius), of("l1_m", &self.half_track)].into_iter().flatten()
    }
}

fn half_track(recordings: &[PathBuf], guess: &Guess, radius: Option<f64>) -> Option<Length> {
    let of = |path: &Path| turned(&preview(path).ok()?, guess, false);
    let first = of(&recordings[0])?;
    let radius = if first.in_metres { 1.0 } else { radius? };
    let others = recordings[1..].iter().filter_map(|path| of(path));
    let name = first.name.clone();
    let changes: Vec<(f64, f64)> =
        std::iter::once(first).chain(others).flat_map(|turned| pairs(&turned, radius)).collect();
    let (length, half_width) = slope(&changes)?;
    (half_width < WIDEST * length).then(|| Length {
        metres: length,
        origin: format!(
            "`{name}` beside the positions of the wheels (95 %: {:.3} to {:.3} m); with slip, which makes it larger",
            length - half_width,
            length + half_width
        ),
    })
}

/// Changes of the heading \[rad\], and half the difference of the ways of the wheels \[m\] in the same time.
fn pairs(turned: &Turned, radius: f64) -> Vec<(f64, f64)> {
    let [right, left] = &turned.wheels;
    let ways = right.iter().zip(left).map(|(a, b)| 0.5 * radius * (a - b));
    let pairs = turned.heading.iter().copied().zip(ways);
    pairs.filter(|(a, b)| a.is_finite() && b.is_finite()).collect()
}

/// The size of the slope of a line through zero, and the half-width of its 95 % interval; its sign is that of the
/// heading, which some sensors count clockwise. `None` where there are few changes.
fn slope(changes: &[(f64, f64)]) -> Option<(f64, f64)> {
    let sum = |of: &dyn Fn(&(f64, f64)) -> f64| changes.iter().map(of).sum::<f64>();
    if changes.len() < FEWEST || sum(&|c| c.0.abs()) < LEAST_TURN {
        return None;
    }
    let (xx, xy) = (sum(&|c| c.0 * c.0), sum(&|c| c.0 * c.1));
    let slope = xy / xx;
    let dof = changes.len() as f64 - 1.0;
    let variance = sum(&|c| (c.1 - slope * c.0).powi(2)) / dof / xx;
    Some((slope.abs(), t_quantile(0.975, dof) * variance.sqrt()))
}

#[cfg(test)]
mod tests {
    use super::slope;

    #[test]
    fn the_slope_has_the_interval_of_student() {
        // scipy.stats: slope through zero of y = [1, 2.2, 2.8, 4] over [1, 2, 3, 4]
        let changes = [(1.0, 1.0), (2.0, 2.2), (3.0, 2.8), (4.0, 4.0)];
        let (value, half_width) = slope(&changes).unwrap();
        let xx = 30.0;
        let expected: f64 = (1.0 + 4.4 + 8.4 + 16.0) / xx;
        let residual: f64 = changes.iter().map(|(x, y)| (y - expected * x).powi(2)).sum();
        assert!((value - expected).abs() < 1e-12);
        let t = 3.182_446_305_284_263; // scipy.stats.t.ppf(0.975, 3)
        assert!((half_width - t * (residual / 3.0 / xx).sqrt()).abs() < 1e-9);
        // clockwise
        let turned = changes.map(|(x, y)| (x, -y));
        assert_eq!(slope(&turned).unwrap().0, value);
        assert_eq!(slope(&changes[..3]), None);
        assert_eq!(slope(&changes.map(|(x, y)| (0.01 * x, y))), None);
    }
}
