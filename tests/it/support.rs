//! The program in a temporary folder: files in, exit code and words out.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A temporary folder in which the program runs.
pub(crate) struct Folder(tempfile::TempDir);

/// Result of a run of the program.
pub(crate) struct Ran {
    pub(crate) code: i32,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Ran {
    /// Checks the exit code and that the messages contain every word; no run may panic.
    pub(crate) fn says(&self, code: i32, words: &[&str]) -> &Self {
        let all = format!("{}{}", self.out, self.err);
        assert!(!all.contains("panicked"), "{all}");
        assert_eq!(self.code, code, "exit code; {all}");
        for word in words {
            assert!(all.contains(word), "`{word}` is not in: {all}");
        }
        self
    }
}

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> &Self {
        fs::write(self.path(name), bytes).unwrap();
        self
    }

    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    pub(crate) fn has(&self, name: &str) -> bool {
        self.path(name).exists()
    }

    /// Runs the program here.
    pub(crate) fn run(&self, arguments: &[&str]) -> Ran {
        self.run_in("", arguments)
    }

    /// Runs the program in a folder of this one.
    pub(crate) fn run_in(&self, inner: &str, arguments: &[&str]) -> Ran {
        let output = Command::new(env!("CARGO_BIN_EXE_experiment"))
            .args(arguments)
            .current_dir(self.0.path().join(inner))
            .env("NO_COLOR", "1")
            .output()
            .unwrap();
        Ran {
            code: output.status.code().expect("the program was ended by a signal"),
            out: String::from_utf8(output.stdout).unwrap(),
            err: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// `results.json` of an experiment under a folder of results.
    pub(crate) fn results(&self, name: &str) -> serde_json::Value {
        serde_json::from_str(&self.read(&format!("{name}/results.json"))).unwrap()
    }
}

/// The root of the project.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A row of a simulated recording: t [s], speeds [rad/s] and torques [N m].
pub(crate) type Row = [f64; 5];

/// A robot of the paper's order of size, driven along two sines so that both wheels start, turn
/// back and stop: speeds are prescribed and the torques follow from eq. (14) without noise.
pub(crate) fn motion() -> Vec<Row> {
    motion_of(600)
}

/// [`motion`] of so many rows at 100 Hz.
pub(crate) fn motion_of(rows: u32) -> Vec<Row> {
    let (a1, a2, friction) = (0.0319, -0.0024, 0.125);
    (0..rows)
        .map(|k| {
            let t = 0.01 * f64::from(k);
            let w = [5.0 * (1.3 * t).sin(), 4.0 * (2.1 * t).sin()];
            let a = [6.5 * (1.3 * t).cos(), 8.4 * (2.1 * t).cos()];
            let beta = 0.033 / 0.14 * (w[0] - w[1]);
            let m = |i: usize| {
                let turn = 0.000_293 * beta * (w[1 - i] * if i == 0 { 1.0 } else { -1.0 });
                a1 * a[i] + a2 * a[1 - i] + turn + friction * w[i].signum()
            };
            [t, w[0], w[1], m(0), m(1)]
        })
        .collect()
}

/// Rows as text with a header, a separator, a way to write numbers and an end of line.
pub(crate) fn text(
    rows: &[Row],
    header: &str,
    separator: &str,
    number: impl Fn(f64) -> String,
    end: &str,
) -> String {
    let mut out = format!("{header}{end}");
    for row in rows {
        let cells: Vec<String> = row.iter().map(|x| number(*x)).collect();
        out += &cells.join(separator);
        out += end;
    }
    out
}

/// The header of [`csv`].
pub(crate) const HEADER: &str = "t,dalpha1,dalpha2,M1,M2";

/// Rows as plain CSV.
pub(crate) fn csv(rows: &[Row]) -> String {
    text(rows, HEADER, ",", |x| format!("{x}"), "\n")
}

/// A short experiment on simulated recordings, of some ten milliseconds; tests add a `[grid]`.
pub(crate) fn short(title: &str) -> String {
    format!(
        "title = \"{title}\"\n\n[simulation]\nnoise      = {{ dalpha = 0.05, alpha = 0.001, M = 0.005 }}\n\
         train      = 1\nvalidation = 0\nduration_s = 4.0\n\n[[method]]\nname = \"torque_regression\"\n"
    )
}

/// An experiment file on one recording.
pub(crate) fn on(recording: &str) -> String {
    format!("[recordings]\ntrain = [{recording:?}]\n\n[[method]]\nname = \"prediction_error\"\n")
}
