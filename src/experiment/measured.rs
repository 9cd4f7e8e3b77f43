//! The measured recordings of an experiment: read, conditioned, checked.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};

use super::error::words;
use super::error::{ExperimentError, Meaning};
use super::file::RecordingsEntry;
use super::plan::MeasuredRecording;
use super::robot_table::UNKNOWN;
use crate::conditioning::{
    Action, Channel, Context, Encoders, Finding, Kind, Lag, Settings, common_encoders, common_lag,
    common_share, condition,
};
use crate::io::{
    ColumnMap, RawChannels, needed_columns, read_channels, read_long_recording, table_channels,
};
use crate::recording::{DriveUnit, LongRecording, Recording, share_noise};
use crate::robot::Robot;
use crate::study::Role;

/// The recordings of an experiment file at `path`, each read and conditioned.
pub(super) fn read(
    path: &Path,
    entry: &RecordingsEntry,
    settings: &Settings,
    robot: &Robot,
) -> Result<Vec<MeasuredRecording>, Meaning> {
    if entry.hold_rows < 1000 {
        let found = entry.hold_rows;
        return Err(words(format!("recordings.hold_rows = {found} must be 1000 or more")));
    }
    let folder = path.parent().unwrap_or_else(|| Path::new("."));
    let mut reading = Reading::new(robot.clone(), entry.drive_unit);
    for (key, column) in &entry.columns {
        reading.columns.put(key, column.clone().into())?;
    }
    (reading.hold_rows, reading.conditioning) = (entry.hold_rows, *settings);
    let of = |role: Role, files: &[String]| -> Vec<(Role, PathBuf)> {
        files.iter().map(|file| (role, folder.join(file))).collect()
    };
    let all = [of(Role::Train, &entry.train), of(Role::Validation, &entry.validation)].concat();
    let measured = reading.together(&all)?;
    let train = measured.iter().filter(|m| m.role == Role::Train).map(|m| &m.recording);
    if super::quality::without_input(train) {
        return Err(words(format!(
            "recordings.train: M1 and M2 are zero throughout ({}); without an input the parameters \
             have no scale, so record the torques, or name their columns",
            entry.train.join(", ")
        )));
    }
    Ok(measured)
}

/// The findings of each recording that is kept completely in memory.
fn findings_of(measured: &[MeasuredRecording]) -> impl Iterator<Item = &[Finding]> {
    measured.iter().filter(|m| m.long.is_none()).map(|m| m.conditioning.as_slice())
}

/// Settings for reading, conditioning and checking recordings: those of `[recordings]` and `[conditioning]`.
#[derive(Clone, Debug)]
pub struct Reading {
    /// Column and unit of each quantity.
    pub columns: ColumnMap,
    /// Unit of the input.
    pub drive_unit: DriveUnit,
    /// Largest number of rows of a recording in memory; of a longer file only windows are kept.
    pub hold_rows: usize,
    /// Enabled corrections.
    pub conditioning: Settings,
    /// The robot, for wheel radius and quality check.
    pub robot: Robot,
    /// Delay of the speeds, determined from the recordings of the log together.
    pub speed_lag: Option<Lag>,
    /// Whether speeds were computed from the angles, determined from the recordings together.
    pub speeds_of_angles: Option<f64>,
    /// The encoder behind speeds without angles, determined from the recordings together.
    pub encoders: Encoders,
}

impl Reading {
    /// Settings for recordings with standard column names and units; all corrections are enabled.
    #[must_use]
    pub fn new(robot: Robot, drive_unit: DriveUnit) -> Self {
        let radius = (robot.name != UNKNOWN).then(|| robot.r());
        let columns = ColumnMap::new(drive_unit, radius);
        let (conditioning, hold_rows) = (Settings::default(), super::file::hold_rows());
        let (speed_lag, speeds_of_angles, encoders) = (None, None, Encoders::Unknown);
        Self {
            columns,
            drive_unit,
            hold_rows,
            conditioning,
            robot,
            speed_lag,
            speeds_of_angles,
            encoders,
        }
    }

    /// The same with columns of other names or units, in the form of `recordings.columns` of a file.
    ///
    /// # Errors
    /// Keys that are not a quantity, unknown units.
    pub fn with_columns(mut self, table: &toml::Table) -> Result<Self, ExperimentError> {
        let entries = super::file::column_entries(table);
        let entries = entries.map_err(|e| words(e).of("columns"))?;
        for (key, column) in entries {
            self.columns.put(&key, column.into())?;
        }
        Ok(self)
    }

    /// The recording of a file, conditioned and checked; windows of it if it is too long for memory.
    ///
    /// # Errors
    /// Errors in the file or its values, with the place.
    pub fn file(&self, role: Role, file: &Path) -> Result<MeasuredRecording, ExperimentError> {
        self.one(role, file).map_err(|e| e.of(&file.display().to_string()))
    }

    /// The recordings of files of one robot and logger, read like those of an experiment file: properties of
    /// encoders or a delay of the speeds found in one recording apply to all, and short ones have the sensor
    /// noise of long ones.
    ///
    /// # Errors
    /// Errors in a file or its values, with the place.
    pub fn files<P: AsRef<Path>>(
        &self,
        train: &[P],
        validation: &[P],
    ) -> Result<Vec<MeasuredRecording>, ExperimentError> {
        let train = train.iter().map(|file| (Role::Train, file));
        let all = train.chain(validation.iter().map(|file| (Role::Validation, file)));
        let all: Vec<_> = all.map(|(role, file)| (role, file.as_ref().to_path_buf())).collect();
        self.together(&all).map_err(|e| e.of("recordings"))
    }

    fn together(&self, all: &[(Role, PathBuf)]) -> Result<Vec<MeasuredRecording>, Meaning> {
        let mut reading = self.clone();
        let mut measured = in_threads(all, |(role, file)| reading.one(*role, file))?;
        let again = |reading: &Self,
                     measured: &mut [MeasuredRecording],
                     which: &dyn Fn(&[Finding]) -> bool| {
            let of: Vec<usize> = (0..all.len())
                .filter(|&k| measured[k].long.is_none() && which(&measured[k].conditioning))
                .collect();
            let read = in_threads(&of, |&k| reading.one(all[k].0, &all[k].1))?;
            of.into_iter().zip(read).for_each(|(k, one)| measured[k] = one);
            Ok::<_, Meaning>(())
        };
        // properties of the logger found in one recording of a log apply to all
        let shows = |findings: &[Finding]| common_encoders([findings].into_iter()).is_some();
        if let Some(encoders) = common_encoders(findings_of(&measured)) {
            reading.encoders = Encoders::Known(encoders);
            again(&reading, &mut measured, &|findings| !shows(findings))?;
            if !findings_of(&measured).all(shows) {
                reading.encoders = Encoders::None;
                again(&reading, &mut measured, &shows)?;
            }
        }
        reading.speed_lag = common_lag(findings_of(&measured));
        reading.speeds_of_angles = common_share(findings_of(&measured));
        if reading.speed_lag.is_some() || reading.speeds_of_angles.is_some() {
            let shows = |findings: &[Finding]| {
                common_lag([findings].into_iter()).is_some()
                    || common_share([findings].into_iter()).is_some()
            };
            again(&reading, &mut measured, &|findings| !shows(findings))?;
        }
        share_noise(&mut measured.iter_mut().map(|m| &mut m.recording).collect::<Vec<_>>());
        Ok(measured)
    }

    /// The recording of a table in memory that has the columns [`Self::needed`], conditioned and checked.
    ///
    /// # Errors
    /// Missing columns, and errors in their values.
    pub fn table(
        &self,
        role: Role,
        name: &str,
        columns: &[(String, Vec<f64>)],
    ) -> Result<MeasuredRecording, ExperimentError> {
        let raw = table_channels(name, columns, &self.columns)?;
        let (recording, conditioning) = self.conditioned(raw).map_err(|e| e.of(name))?;
        let findings = super::quality::findings(&recording, &self.robot);
        Ok(MeasuredRecording { role, recording, long: None, sha256: None, conditioning, findings })
    }

    /// The required columns among the `names` of a table.
    ///
    /// # Errors
    /// A missing quantity, with the existing names.
    pub fn needed(&self, name: &str, names: &[String]) -> Result<Vec<String>, ExperimentError> {
        Ok(needed_columns(name, names, &self.columns)?)
    }

    fn one(&self, role: Role, file: &Path) -> Result<MeasuredRecording, Meaning> {
        let long = read_long_recording(file, &self.columns, self.drive_unit, self.hold_rows)?;
        let (recording, long, sha256, conditioning) = match long {
            Some((windows, long, sha256)) => {
                let found = long_rows(&long);
                (windows, Some(Arc::new(long)), sha256, found)
            }
            None => {
                let raw = read_channels(file, &self.columns)?;
                let sha256 = raw.sha256.clone();
                let (recording, findings) = self.conditioned(raw)?;
                (recording, None, sha256, findings)
            }
        };
        let mut findings = super::quality::findings(&recording, &self.robot);
        if let Some(long) = &long {
            findings.insert(0, super::long::finding(&recording, long));
        }
        let sha256 = Some(sha256);
        Ok(MeasuredRecording { role, recording, long, sha256, conditioning, findings })
    }

    fn conditioned(&self, mut raw: RawChannels) -> Result<(Recording, Vec<Finding>), Meaning> {
        let commanded = self.drive_unit == DriveUnit::Volt;
        let wheel_radius = (self.robot.name != UNKNOWN).then(|| self.robot.r());
        let context = Context {
            wheel_radius,
            commanded,
            speed_lag: self.speed_lag,
            speeds_of_angles: self.speeds_of_angles,
            encoders: self.encoders,
        };
        let channels = std::mem::take(&mut raw.channels);
        let done = condition(channels, &self.conditioning, &context)
            .map_err(|e| words(format!("{}: {e}", raw.name)))?;
        raw.channels = done.channels;
        Ok((raw.recording(self.drive_unit)?, done.findings))
    }
}

/// The rows omitted from a recording that is read block by block.
fn long_rows(long: &LongRecording) -> Vec<Finding> {
    let (rows, first) = long.rows.left_out();
    let (kind, action) = (Kind::TimeRows { rows, first }, Action::Corrected("rows"));
    if rows == 0 { vec![] } else { vec![Finding { channel: Channel::Time, kind, action }] }
}

/// Processes every item in separate threads, in order; returns the first error in that order. Threads of
/// rayon are not suitable: while a thread of rayon waits for polars, which has its own threads, it starts the
/// next item, until files and stack are exhausted.
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
    // items are taken in order, so all before the first error are complete
    done.sort_by_key(|(k, _)| *k);
    done.into_iter().map(|(_, result)| result).collect()
}
