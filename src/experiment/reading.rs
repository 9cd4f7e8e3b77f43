//! How a recording is read: columns, units, what is corrected.

use std::path::Path;
use std::sync::Arc;

use super::error::{ExperimentError, Meaning, words};
use super::robot_table::UNKNOWN;
use super::source::MeasuredRecording;
use super::unrepaired;
use crate::conditioning::{
    Action, Channel, Context, Encoders, Finding, Kind, Settings, SlowPair, SpeedLag, condition,
    repair_factors,
};
use crate::io::{
    ColumnMap, RawChannels, needed_columns, read_channels, read_long_recording, table_channels,
};
use crate::recording::{DriveUnit, LongRecording, Recording};
use crate::robot::Robot;
use crate::study::Role;

/// How recordings are read, conditioned and checked: what `[recordings]` and `[conditioning]` say.
#[derive(Clone, Debug)]
pub struct Reading {
    /// Where each quantity stands, and in which unit.
    pub columns: ColumnMap,
    /// Unit of the input.
    pub drive_unit: DriveUnit,
    /// Rows up to which a recording is held in memory; of a longer file windows are held.
    pub hold_rows: usize,
    /// What may be corrected.
    pub conditioning: Settings,
    /// The robot, for wheel radius and quality check.
    pub robot: Robot,
    /// What the recordings of the log say together.
    pub(super) shown: Shown,
}

/// What recordings of one logger show together, and a single one need not.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Shown {
    /// A lag of the speeds.
    pub(super) speed_lag: SpeedLag,
    /// Speeds that were computed from the angles.
    pub(super) speeds_of_angles: Option<f64>,
    /// The encoder behind speeds without angles.
    pub(super) encoders: Encoders,
    /// The sensors that are slower than the others of the same wheels.
    pub(super) slow_pair: Option<SlowPair>,
    /// Even rows with the stamps of a receiver.
    pub(super) even_times: bool,
}

impl Reading {
    /// Recordings of a robot whose columns have the names and units of the contract; everything is
    /// corrected that can be.
    #[must_use]
    pub fn new(robot: Robot, drive_unit: DriveUnit) -> Self {
        let radius = (robot.name != UNKNOWN).then(|| robot.r());
        let columns = ColumnMap::new(drive_unit, radius);
        let (conditioning, hold_rows) = (Settings::default(), super::file::hold_rows());
        Self { columns, drive_unit, hold_rows, conditioning, robot, shown: Shown::default() }
    }

    /// The same with columns of other names or units, written as `recordings.columns` of a file.
    ///
    /// # Errors
    /// Keys that are no quantity of the contract, unknown units.
    pub fn with_columns(mut self, table: &toml::Table) -> Result<Self, ExperimentError> {
        let entries = super::file::column_entries(table);
        let entries = entries.map_err(|e| words(e).of("columns"))?;
        for (key, column) in entries {
            self.columns.put(&key, column.into())?;
        }
        Ok(self)
    }

    /// The same with the keys of `[conditioning]` of a file.
    ///
    /// # Errors
    /// Keys that are none.
    pub fn with_conditioning(mut self, table: &toml::Table) -> Result<Self, ExperimentError> {
        let settings = table.clone().try_into();
        self.conditioning =
            settings.map_err(|e: toml::de::Error| words(e.message().into()).of("conditioning"))?;
        Ok(self)
    }

    /// The recording of a file, conditioned and checked; windows of it where it is too long to be held.
    ///
    /// # Errors
    /// What is wrong with the file or its values, with the place.
    pub fn file(&self, role: Role, file: &Path) -> Result<MeasuredRecording, ExperimentError> {
        self.one(role, file).map_err(|e| e.of(&file.display().to_string()))
    }

    /// The recording of a table in memory that has the columns [`Self::needed`], conditioned and checked.
    ///
    /// # Errors
    /// Missing columns, and what is wrong with their values.
    pub fn table(
        &self,
        role: Role,
        name: &str,
        columns: &[(String, Vec<f64>)],
    ) -> Result<MeasuredRecording, ExperimentError> {
        self.one_table(role, name, columns).map_err(|e| e.of(name))
    }

    /// Which of the columns `names` of a table are read.
    ///
    /// # Errors
    /// A quantity that is not there, with the names that are.
    pub fn needed(&self, name: &str, names: &[String]) -> Result<Vec<String>, ExperimentError> {
        Ok(needed_columns(name, names, &self.columns)?)
    }

    pub(super) fn one(&self, role: Role, file: &Path) -> Result<MeasuredRecording, Meaning> {
        let long = read_long_recording(file, &self.columns, self.drive_unit, self.hold_rows)?;
        let (recording, long, sha256, conditioning) = match long {
            Some((windows, long, sha256)) => {
                unrepaired::check(&windows, &long, &self.conditioning, &self.context())?;
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
        let mut findings = super::quality::findings(&recording, &self.robot, &conditioning);
        if let Some(long) = &long {
            findings.insert(0, super::long::finding(&recording, long));
        }
        let sha256 = Some(sha256);
        Ok(MeasuredRecording { role, recording, long, sha256, conditioning, findings })
    }

    pub(super) fn one_table(
        &self,
        role: Role,
        name: &str,
        columns: &[(String, Vec<f64>)],
    ) -> Result<MeasuredRecording, Meaning> {
        let raw = table_channels(name, columns, &self.columns)?;
        let (recording, conditioning) = self.conditioned(raw)?;
        let findings = super::quality::findings(&recording, &self.robot, &conditioning);
        Ok(MeasuredRecording { role, recording, long: None, sha256: None, conditioning, findings })
    }

    /// What is known beside the channels.
    fn context(&self) -> Context {
        let commanded = self.drive_unit == DriveUnit::Volt;
        let wheel_radius = (self.robot.name != UNKNOWN).then(|| self.robot.r());
        let Shown { speed_lag, speeds_of_angles, encoders, slow_pair, even_times } = self.shown;
        Context {
            wheel_radius,
            commanded,
            speed_lag,
            speeds_of_angles,
            encoders,
            counts: ["dalpha1", "dalpha2"]
                .map(|key| self.columns.get(key).per_turn.map(|n| std::f64::consts::TAU / n)),
            slow_pair,
            even_times,
        }
    }

    fn conditioned(&self, mut raw: RawChannels) -> Result<(Recording, Vec<Finding>), Meaning> {
        let mut channels = std::mem::take(&mut raw.channels);
        let mut findings = repair_factors(&mut channels, &raw.factors, &self.conditioning);
        let done = condition(channels, &self.conditioning, &self.context())
            .map_err(|e| words(format!("{}: {e}", raw.name)))?;
        raw.channels = done.channels;
        findings.extend(done.findings);
        Ok((raw.recording(self.drive_unit)?, findings))
    }
}

/// What was left out of a recording that is read block by block.
fn long_rows(long: &LongRecording) -> Vec<Finding> {
    let (rows, first) = long.rows.left_out();
    let (kind, action) = (Kind::TimeRows { rows, first }, Action::Corrected("rows"));
    if rows == 0 { vec![] } else { vec![Finding { channel: Channel::Time, kind, action }] }
}
