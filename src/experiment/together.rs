//! Recordings of one robot and logger: what one of them shows holds for all.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};

use super::error::{ExperimentError, Meaning};
use super::reading::{Reading, Shown};
use super::source::MeasuredRecording;
use crate::conditioning::{
    Encoders, Finding, Kind, Lag, SpeedLag, common_encoders, common_lag, common_share,
    common_slow_pair, lags_differ,
};
use crate::recording::share_noise;
use crate::study::Role;

/// Ratio of standard errors from which on a lag of all recordings may stand in for that of one.
const EXACT: f64 = 3.0;

/// Where a recording comes from and how it is read, so that it can be read again once others have shown more of the
/// logger.
#[derive(Clone, Debug)]
pub struct Unread {
    reading: Reading,
    data: Data,
}

#[derive(Clone, Debug)]
enum Data {
    File(PathBuf),
    /// Name and columns.
    Table(String, Arc<[(String, Vec<f64>)]>),
}

impl Unread {
    /// A recording that stands in a file.
    #[must_use]
    pub fn file(reading: Reading, file: &Path) -> Self {
        Self { reading, data: Data::File(file.to_path_buf()) }
    }

    /// A table in memory that has the columns [`Reading::needed`].
    #[must_use]
    pub fn table(reading: Reading, name: &str, columns: Vec<(String, Vec<f64>)>) -> Self {
        Self { reading, data: Data::Table(name.to_owned(), columns.into()) }
    }

    /// The recording by itself, conditioned and checked.
    ///
    /// # Errors
    /// What is wrong with the file, the columns or their values, with the place.
    pub fn read(&self, role: Role) -> Result<MeasuredRecording, ExperimentError> {
        self.knowing(self.reading.shown, role).map_err(|e| e.of(&self.name()))
    }

    fn knowing(&self, shown: Shown, role: Role) -> Result<MeasuredRecording, Meaning> {
        let reading = Reading { shown, ..self.reading.clone() };
        match &self.data {
            Data::File(file) => reading.one(role, file),
            Data::Table(name, columns) => reading.one_table(role, name, columns),
        }
    }

    fn name(&self) -> String {
        match &self.data {
            Data::File(file) => file.display().to_string(),
            Data::Table(name, _) => name.clone(),
        }
    }
}

impl Reading {
    /// The recordings of files of one robot and logger, read as those of an experiment file: see [`together`].
    ///
    /// # Errors
    /// What is wrong with a file or its values, with the place.
    pub fn files<P: AsRef<Path>>(
        &self,
        train: &[P],
        validation: &[P],
    ) -> Result<Vec<MeasuredRecording>, ExperimentError> {
        let of = |role: Role, files: &[P]| -> Vec<(Role, Unread)> {
            files.iter().map(|file| (role, Unread::file(self.clone(), file.as_ref()))).collect()
        };
        let all = [of(Role::Train, train), of(Role::Validation, validation)].concat();
        read_together(&all).map_err(|e| e.of("recordings"))
    }
}

/// Reads recordings of one robot and logger, each by itself and then [`together`].
///
/// # Errors
/// What is wrong with one of them, with the place.
pub(super) fn read_together(all: &[(Role, Unread)]) -> Result<Vec<MeasuredRecording>, Meaning> {
    let measured = in_threads(all, |(role, one)| one.knowing(one.reading.shown, *role))?;
    let unread: Vec<&Unread> = all.iter().map(|(_, one)| one).collect();
    settled(&unread, measured)
}

/// Recordings of one robot and logger that were read each by itself ([`Unread::read`]), as those of an experiment file
/// are: what one of them shows of its encoders, its stamps or a lag of its speeds holds for all, for which some are
/// read again, and short ones have the noise of the sensors of long ones.
///
/// # Errors
/// What is wrong with one that is read again.
pub fn together(
    unread: &[&Unread],
    measured: Vec<MeasuredRecording>,
) -> Result<Vec<MeasuredRecording>, ExperimentError> {
    settled(unread, measured).map_err(|e| e.of("recordings"))
}

fn settled(
    unread: &[&Unread],
    mut measured: Vec<MeasuredRecording>,
) -> Result<Vec<MeasuredRecording>, Meaning> {
    let again =
        |shown: Shown, measured: &mut [MeasuredRecording], which: &dyn Fn(&[Finding]) -> bool| {
            let of: Vec<usize> = (0..unread.len())
                .filter(|&k| measured[k].long.is_none() && which(&measured[k].conditioning))
                .collect();
            let read = in_threads(&of, |&k| unread[k].knowing(shown, measured[k].role))?;
            of.into_iter().zip(read).for_each(|(k, one)| measured[k] = one);
            Ok::<_, Meaning>(())
        };
    let mut shown = Shown::default();
    // what one recording of a log shows of its logger holds for all of them
    let counts = |findings: &[Finding]| common_encoders([findings].into_iter()).is_some();
    if let Some(encoders) = common_encoders(findings_of(&measured)) {
        shown.encoders = Encoders::Known(encoders);
        again(shown, &mut measured, &|findings| !counts(findings))?;
        if !findings_of(&measured).all(counts) {
            shown.encoders = Encoders::None;
            again(shown, &mut measured, &counts)?;
        }
    }
    let even =
        |findings: &[Finding]| findings.iter().any(|f| matches!(f.kind, Kind::Jitter { .. }));
    if findings_of(&measured).any(even) {
        shown.even_times = true;
        again(shown, &mut measured, &|findings| !even(findings))?;
    }
    shown.slow_pair = common_slow_pair(findings_of(&measured));
    if shown.slow_pair.is_some() {
        let lacks = |findings: &[Finding]| common_slow_pair([findings].into_iter()).is_none();
        again(shown, &mut measured, &lacks)?;
    }
    let whole = measured.iter().filter(|m| m.long.is_none());
    let refresh =
        |m: &MeasuredRecording| m.recording.step() * m.recording.rows_per_refresh() as f64;
    if lags_differ(whole.map(|m| (m.conditioning.as_slice(), refresh(m)))) {
        shown.speed_lag = SpeedLag::Disputed;
        return again(shown, &mut measured, &|_| true).map(|()| with_noise(measured));
    }
    let lag = common_lag(findings_of(&measured));
    shown.speed_lag = lag.map_or(SpeedLag::Unknown, SpeedLag::Known);
    shown.speeds_of_angles = common_share(findings_of(&measured));
    if lag.is_some() || shown.speeds_of_angles.is_some() {
        let shows = |findings: &[Finding]| {
            let own = common_lag([findings].into_iter());
            let as_exact = |(own, lag): ([Lag; 2], [Lag; 2])| {
                (0..2).all(|i| own[i].std_error <= EXACT * lag[i].std_error)
            };
            own.zip(lag).is_some_and(as_exact) || common_share([findings].into_iter()).is_some()
        };
        again(shown, &mut measured, &|findings| !shows(findings))?;
    }
    Ok(with_noise(measured))
}

/// Gives short recordings the noise of the sensors of long ones.
fn with_noise(mut measured: Vec<MeasuredRecording>) -> Vec<MeasuredRecording> {
    share_noise(&mut measured.iter_mut().map(|m| &mut m.recording).collect::<Vec<_>>());
    measured
}

/// What was found in each recording that is held whole.
fn findings_of(measured: &[MeasuredRecording]) -> impl Iterator<Item = &[Finding]> {
    measured.iter().filter(|m| m.long.is_none()).map(|m| m.conditioning.as_slice())
}

/// Does the same with every item in threads of its own, in their order; the first error in that
/// order. Not in those of rayon: a thread of rayon that waits for polars, which has its own, begins
/// the next item meanwhile, and the one after, until files and stack are used up.
fn in_threads<T: Sync, R: Send>(
    items: &[T],
    work: impl Fn(&T) -> Result<R, Meaning> + Sync,
) -> Result<Vec<R>, Meaning> {
    let (next, failed) = (AtomicUsize::new(0), AtomicBool::new(false));
    let worker = || {
        let mut done = Vec::new();
        while !failed.load(Relaxed) {
            let k = next.fetch_add(1, Relaxed);
            let Some(item) = items.get(k) else { break };
            let result = work(item);
            failed.fetch_or(result.is_err(), Relaxed);
            done.push((k, result));
        }
        done
    };
    let workers = rayon::current_num_threads().min(items.len());
    let mut done: Vec<_> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..workers).map(|_| scope.spawn(worker)).collect();
        let joined = threads.into_iter().map(|thread| thread.join());
        joined.flat_map(|done| done.unwrap_or_else(|e| std::panic::resume_unwind(e))).collect()
    });
    // items are taken in order, so that all before the first error are done
    done.sort_by_key(|(k, _)| *k);
    done.into_iter().map(|(_, result)| result).collect()
}
