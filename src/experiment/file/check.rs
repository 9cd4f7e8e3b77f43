//! Checks of values of an experiment file that have the right type.

use toml::Table;

use super::{
    CandidatesEntry, DiagnosisEntry, EmulatorEntry, ExperimentFile, FileError, FixedEntry,
    MovementEntry, SimulationEntry,
};

/// Largest absolute value of a parameter.
const LARGEST: f64 = 1e12;
/// Largest standard deviation of noise, and largest factor on it.
const MOST_NOISE: f64 = 1e4;
/// Largest speed [m/s] and turn rate [rad/s] of a segment.
const MOST_SPEED: f64 = 1e3;

impl ExperimentFile {
    /// Checks values that have the right type but are out of range or inconsistent.
    pub(in crate::experiment) fn check(&self, file: &str) -> Result<(), FileError> {
        let wrong = |key: &str, message: String| FileError::Value {
            file: file.into(),
            key: key.into(),
            message,
        };
        match (&self.recordings, &self.simulation) {
            (None, None) => {
                let message = "is missing; add [recordings] with train = [\"run.csv\"] for measured \
                               data, or [simulation] for synthetic data";
                return Err(wrong("[recordings]", message.into()));
            }
            (Some(_), Some(_)) => {
                let message =
                    "and [recordings] are both there; an experiment has one source of data";
                return Err(wrong("[simulation]", message.into()));
            }
            (Some(r), None) if r.train.is_empty() => {
                return Err(wrong("recordings.train", "is empty; name at least one file".into()));
            }
            (None, Some(s)) => s.check(&wrong)?,
            _ => {}
        }
        self.check_keys(file)
    }

    /// The same for a file whose recordings are given separately.
    pub(in crate::experiment) fn check_keys(&self, file: &str) -> Result<(), FileError> {
        let wrong = |key: &str, message: String| FileError::Value {
            file: file.into(),
            key: key.into(),
            message,
        };
        if let Some(diagnosis) = &self.diagnosis {
            diagnosis.check(&wrong)?;
        }
        if let Some(grid) = &self.grid {
            check_grid(grid, &wrong)?;
        }
        for (symbol, entry) in &self.model.fixed {
            if matches!(entry, FixedEntry::Value(v) if !(v.abs() <= LARGEST)) {
                let message = format!("must be a finite number of a size up to {LARGEST:e}");
                return Err(wrong(&format!("model.fixed.{symbol}"), message));
            }
        }
        self.emulator.check(&wrong)
    }
}

impl SimulationEntry {
    fn check(&self, wrong: &impl Fn(&str, String) -> FileError) -> Result<(), FileError> {
        if let MovementEntry::Segments(segments) = &self.movement {
            let length: f64 = segments.iter().map(|s| s.blend_s + s.hold_s).sum();
            let sound = segments.iter().all(|s| {
                s.blend_s >= 0.0
                    && s.hold_s >= 0.0
                    && s.speed_m_s.abs() <= MOST_SPEED
                    && s.turn_rad_s.abs() <= MOST_SPEED
            });
            if !sound || !(0.5..=1e5).contains(&length) {
                let message = "must have times that are not negative, last 0.5 s to 1e5 s, and have speeds up to 1000 m/s and rad/s";
                return Err(wrong("simulation.movement", message.into()));
            }
        }
        let positive = [
            ("simulation.rate_hz", self.rate_hz, 1.0, 1e5),
            ("simulation.control_rate_hz", self.control_rate_hz, 1.0, 1e5),
            ("simulation.duration_s", self.duration_s, 2.0, 1e5),
            ("simulation.top_speed_rad_s", self.top_speed_rad_s, 0.1, 1e4),
        ];
        for (key, value, low, high) in positive {
            if !(value >= low && value <= high) {
                return Err(wrong(key, format!("= {value} must lie between {low} and {high}")));
            }
        }
        let noise = [self.noise.dalpha, self.noise.alpha, self.noise.torque, self.noise_scale];
        if noise.iter().any(|n| !(*n >= 0.0 && *n <= MOST_NOISE)) {
            let message = format!("must be numbers from 0 to {MOST_NOISE:e}");
            return Err(wrong("simulation.noise", message));
        }
        let hidden = self.hidden.iter().flat_map(|(id, values)| {
            values.iter().map(move |(s, v)| (format!("simulation.hidden.{id}.{s}"), v))
        });
        let truth = self.truth.iter().map(|(s, v)| (format!("simulation.truth.{s}"), v));
        if let Some((key, value)) = hidden.chain(truth).find(|(_, v)| !(v.abs() <= LARGEST)) {
            let message =
                format!("= {value:e} must be a finite number of a size up to {LARGEST:e}");
            return Err(wrong(&key, message));
        }
        if self.train == 0 {
            return Err(wrong("simulation.train", "= 0; at least one recording is needed".into()));
        }
        if self.encoder_ticks.is_some_and(|t| !(t >= 1.0)) {
            return Err(wrong("simulation.encoder_ticks", "must be at least 1".into()));
        }
        Ok(())
    }
}

impl DiagnosisEntry {
    fn check(&self, wrong: &impl Fn(&str, String) -> FileError) -> Result<(), FileError> {
        if !(self.false_alarm > 0.0 && self.false_alarm < 1.0) {
            let message = format!("= {} must lie between 0 and 1", self.false_alarm);
            return Err(wrong("diagnosis.false_alarm", message));
        }
        if self.max_effects == 0 {
            let message = "= 0 allows no effects; use at least 1".to_string();
            return Err(wrong("diagnosis.max_effects", message));
        }
        if matches!(&self.candidates, CandidatesEntry::Some(ids) if ids.is_empty()) {
            let message = "is empty; name effects, or \"all\", or remove [diagnosis]";
            return Err(wrong("diagnosis.candidates", message.into()));
        }
        Ok(())
    }
}

impl EmulatorEntry {
    fn check(&self, wrong: &impl Fn(&str, String) -> FileError) -> Result<(), FileError> {
        let given = [self.gain.is_some(), self.poles.is_some(), self.matrix.is_some()];
        if given.iter().filter(|g| **g).count() > 1 {
            let message = "has more than one of gain, poles and matrix; keep one".to_string();
            return Err(wrong("[emulator]", message));
        }
        Ok(())
    }
}

fn check_grid(grid: &Table, wrong: &impl Fn(&str, String) -> FileError) -> Result<(), FileError> {
    for (key, values) in grid {
        let empty = match values {
            toml::Value::Array(values) => values.is_empty(),
            toml::Value::Table(t) => t.get("count").is_some_and(|c| c.as_integer() == Some(0)),
            _ => false,
        };
        if empty {
            let message = "has no value; give at least one, or remove the key".to_string();
            return Err(wrong(&format!("grid.{key}"), message));
        }
    }
    if grid.is_empty() {
        let message = "has no key; name what varies, for example noise_scale = [0.5, 1, 2]";
        return Err(wrong("[grid]", message.into()));
    }
    Ok(())
}
