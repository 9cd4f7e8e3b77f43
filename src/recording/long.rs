//! Recordings too long for memory: selected windows, and repeated reading of all rows.

use std::sync::Arc;

use super::check::{MINIMUM_SAMPLES, check_rows};
use super::{Channels, DriveUnit, Recording, RecordingError, limits};
use crate::math::median_step;

/// Approximate number of rows of all windows together.
const KEPT: usize = 200_000;
/// Smallest length of a window in rows and seconds.
const WINDOW: (usize, f64) = (5_000, 10.0);
/// Largest number of windows; at least half as many are kept, if the recording is long enough.
const WINDOWS: (usize, usize) = (8, 40);

/// Why the rows cannot be read again.
#[derive(Clone, Debug, thiserror::Error)]
#[error(transparent)]
pub struct RowsError(Arc<dyn std::error::Error + Send + Sync>);

impl RowsError {
    /// Wraps the error of the source of the rows.
    pub fn new(source: impl std::error::Error + Send + Sync + 'static) -> Self {
        Self(Arc::new(source))
    }
}

/// The rows of a recording, which can be read repeatedly.
pub trait Rows: Send + Sync {
    /// All rows in order, in blocks of any length with equal columns. If reading fails, the last item is the
    /// error.
    fn blocks(&self) -> Box<dyn Iterator<Item = Result<Channels, RowsError>> + '_>;

    /// Rows that are omitted because their time does not increase: their number, and the index of the first
    /// one, from 1.
    fn left_out(&self) -> (usize, usize) {
        (0, 0)
    }
}

/// Properties of a recording of which only windows are kept in memory.
pub struct LongRecording {
    /// Source of the rows.
    pub rows: Box<dyn Rows>,
    /// Number of rows.
    pub samples: usize,
    /// From the first to the last row \[s\].
    pub duration: f64,
    /// Number of windows in memory.
    pub windows: usize,
}

/// Reads the rows of a long recording once: checks each, and keeps windows distributed over the whole
/// recording, whose length need not be known in advance.
///
/// The recording is divided into windows, and these into groups; of each group the window with the smallest
/// hash is kept, because equidistant windows might all have the same phase in a repeated manoeuvre. When the
/// number of groups becomes too large, neighbouring groups are merged.
pub struct Survey {
    name: String,
    drive_unit: DriveUnit,
    samples: usize,
    /// First and last time \[s\].
    span: (f64, f64),
    /// Median step of the first block \[s\].
    step: f64,
    /// Rows per window, and the largest number of windows.
    window: (usize, usize),
    /// Windows per group.
    group: usize,
    /// Windows with their numbers.
    kept: Vec<(usize, Channels)>,
}

impl Survey {
    /// A survey of the recording with this name.
    #[must_use]
    pub fn new(name: impl Into<String>, drive_unit: DriveUnit) -> Self {
        Self {
            name: name.into(),
            drive_unit,
            samples: 0,
            span: (0.0, 0.0),
            step: 0.0,
            window: (0, 0),
            group: 1,
            kept: vec![],
        }
    }

    /// Checks the next rows and keeps those that belong to a window.
    ///
    /// # Errors
    /// As [`Recording::new`]; rows are counted from the first row of the recording.
    pub fn add(&mut self, block: &Channels) -> Result<(), RecordingError> {
        if self.samples == 0 {
            self.begin(block)?;
        }
        self.check(block).map_err(|e| later(e, self.samples))?;
        let mut from = 0;
        while from < block.t.len() {
            let number = (self.samples + from) / self.window.0;
            let rest = self.window.0 - (self.samples + from) % self.window.0;
            let to = (from + rest).min(block.t.len());
            if self.is_kept(number) {
                self.keep(number, &part(block, from..to));
            }
            from = to;
        }
        self.samples += block.t.len();
        self.span.1 = block.t.last().copied().unwrap_or(self.span.1);
        Ok(())
    }

    fn begin(&mut self, first: &Channels) -> Result<(), RecordingError> {
        let (samples, needed) = (first.t.len(), MINIMUM_SAMPLES);
        if samples < needed {
            return Err(RecordingError::TooShort { name: self.name.clone(), samples, needed });
        }
        self.step = median_step(&first.t);
        let rows = ((WINDOW.1 / self.step.max(1e-6)).round() as usize).max(WINDOW.0);
        self.window = (rows, (KEPT / rows).clamp(WINDOWS.0, WINDOWS.1));
        self.span.0 = first.t[0];
        Ok(())
    }

    fn check(&self, block: &Channels) -> Result<(), RecordingError> {
        let Channels { t, alpha, omega, torque } = block;
        check_rows(&self.name, t, alpha.as_deref(), omega.as_deref(), torque)?;
        if self.samples > 0 && t.first().is_some_and(|t| *t <= self.span.1) {
            let (row, name) = (1, self.name.clone());
            return Err(RecordingError::TimeNotIncreasing {
                name,
                row,
                t: t[0],
                previous: self.span.1,
            });
        }
        let (alpha, omega) =
            (alpha.as_deref().unwrap_or_default(), omega.as_deref().unwrap_or_default());
        let columns = [("dalpha", omega), ("M", torque), ("alpha", alpha)];
        limits::check(&self.name, t, self.step, columns)
    }

    /// Whether a window has the smallest hash of its group so far.
    fn is_kept(&self, number: usize) -> bool {
        let latest = self.kept.last().map(|(last, _)| *last);
        latest.is_none_or(|last| {
            last / self.group != number / self.group || hash(number) <= hash(last)
        })
    }

    fn keep(&mut self, number: usize, rows: &Channels) {
        match self.kept.last_mut() {
            Some((last, window)) if *last == number => append(window, rows),
            Some((last, window)) if *last / self.group == number / self.group => {
                (*last, *window) = (number, rows.clone());
            }
            _ => self.kept.push((number, rows.clone())),
        }
        if self.kept.len() > self.window.1 {
            self.group *= 2;
            let group = self.group;
            // `dedup_by` keeps the earlier of two, so the one with the smaller hash is moved there
            self.kept.dedup_by(|later, earlier| {
                let same = later.0 / group == earlier.0 / group;
                if same && hash(later.0) < hash(earlier.0) {
                    std::mem::swap(later, earlier);
                }
                same
            });
        }
    }

    /// The windows as one recording with gaps, and the properties of the whole recording.
    ///
    /// # Errors
    /// As [`Recording::new`].
    pub fn finish(
        mut self,
        rows: Box<dyn Rows>,
    ) -> Result<(Recording, LongRecording), RecordingError> {
        // a window that is less than half full is of little use
        let short = |(_, w): &(usize, Channels)| 2 * w.t.len() < self.window.0;
        if self.kept.len() > 1 && self.kept.last().is_some_and(short) {
            self.kept.pop();
        }
        let windows = self.kept.len();
        let mut windows_of = self.kept.into_iter().map(|(_, window)| window);
        let mut all = windows_of.next().unwrap_or_default();
        windows_of.for_each(|window| append(&mut all, &window));
        let excerpt = Recording::new(self.name, all, self.drive_unit)?;
        let duration = self.span.1 - self.span.0;
        Ok((excerpt, LongRecording { rows, samples: self.samples, duration, windows }))
    }
}

/// A hash without regular patterns: the finaliser of MurmurHash3, which is a bijection.
fn hash(number: usize) -> u64 {
    let mut h = number as u64 + 1;
    for factor in [0xff51_afd7_ed55_8ccd, 0xc4ce_b9fe_1a85_ec53] {
        h = (h ^ (h >> 33)).wrapping_mul(factor);
    }
    h ^ (h >> 33)
}

/// The error with its row counted from the first row of the recording.
fn later(mut error: RecordingError, before: usize) -> RecordingError {
    match &mut error {
        RecordingError::TimeNotIncreasing { row, .. }
        | RecordingError::NotFinite { row, .. }
        | RecordingError::Beyond { row, .. } => *row += before,
        _ => {}
    }
    error
}

fn part(block: &Channels, range: std::ops::Range<usize>) -> Channels {
    let of = |rows: &Vec<[f64; 2]>| rows[range.clone()].to_vec();
    Channels {
        t: block.t[range.clone()].to_vec(),
        alpha: block.alpha.as_ref().map(of),
        omega: block.omega.as_ref().map(of),
        torque: of(&block.torque),
    }
}

fn append(to: &mut Channels, rows: &Channels) {
    to.t.extend(&rows.t);
    for (to, rows) in [(&mut to.alpha, &rows.alpha), (&mut to.omega, &rows.omega)] {
        if let (Some(to), Some(rows)) = (to, rows) {
            to.extend(rows);
        }
    }
    to.torque.extend(&rows.torque);
}

/// A recording in memory as a source of rows.
impl Rows for Recording {
    fn blocks(&self) -> Box<dyn Iterator<Item = Result<Channels, RowsError>> + '_> {
        const BLOCK: usize = 1 << 16;
        Box::new((0..self.len()).step_by(BLOCK).map(|from| {
            let range = from..(from + BLOCK).min(self.len());
            Ok(Channels {
                t: self.t()[range.clone()].to_vec(),
                alpha: Some(self.alpha()[range.clone()].to_vec()),
                omega: Some(self.omega()[range.clone()].to_vec()),
                torque: self.torque()[range].to_vec(),
            })
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(rows: std::ops::Range<usize>) -> Channels {
        let t: Vec<f64> = rows.map(|k| 0.001 * k as f64).collect();
        let omega = Some(t.iter().map(|t| [t.sin(), *t]).collect());
        Channels { torque: vec![[0.1, 0.2]; t.len()], alpha: None, omega, t }
    }

    fn surveyed(samples: usize, step: usize) -> (Recording, LongRecording) {
        let mut survey = Survey::new("a", DriveUnit::NewtonMetre);
        for from in (0..samples).step_by(step) {
            survey.add(&block(from..(from + step).min(samples))).unwrap();
        }
        let rows = Recording::new("a", block(0..100), DriveUnit::NewtonMetre).unwrap();
        survey.finish(Box::new(rows)).unwrap()
    }

    #[test]
    fn windows_are_spread_over_all_rows_however_many_there_are() {
        for (samples, windows) in [(150_000, 15), (1_000_000, 13)] {
            let (excerpt, long) = surveyed(samples, 77_777);
            assert_eq!((long.samples, long.windows), (samples, windows));
            assert!(excerpt.len() <= KEPT && excerpt.len() == windows * 10_000);
            assert!((long.duration - 0.001 * (samples - 1) as f64).abs() < 1e-6);
            let last = excerpt.t()[excerpt.len() - 1];
            assert!(excerpt.t()[0] < 0.1 * long.duration && last > 0.9 * long.duration, "{last}");
            // a window is rows as they were
            assert_eq!(excerpt.omega()[12_345][1], excerpt.t()[12_345]);
        }
        // a manoeuvre of 40 s, that is four windows, is seen in every phase
        let (excerpt, _) = surveyed(1_000_000, 77_777);
        let phases: std::collections::BTreeSet<usize> =
            excerpt.t().iter().map(|t| (t / 10.0 + 1e-6) as usize % 4).collect();
        assert_eq!(phases.len(), 4);
        // blocks of another size make no difference
        assert!(surveyed(1_000_000, 5_000).0.t() == surveyed(1_000_000, 77_777).0.t());
    }

    #[test]
    fn what_is_wrong_is_named_with_its_row_among_all() {
        let mut survey = Survey::new("run.csv", DriveUnit::NewtonMetre);
        survey.add(&block(0..1000)).unwrap();
        let e = survey.add(&block(999..2000)).unwrap_err().to_string();
        assert!(e.starts_with("run.csv, row 1001: t = 0.999 s does not exceed 0.999 s"), "{e}");
        let mut bad = block(1000..2000);
        bad.torque[4][1] = f64::NAN;
        let e = survey.add(&bad).unwrap_err().to_string();
        assert!(e.starts_with("run.csv, row 1005: M2 is NaN"), "{e}");
    }
}
