//! Recordings of which only windows are held: what is said of them, and which methods read all.

use crate::identify::{Fit, Identifier, IdentifyError, Note, Task};
use crate::recording::{Finding, Issue, LongRecording, Recording, Severity};

/// What the check of the recordings says.
pub(super) fn finding(windows: &Recording, long: &LongRecording) -> Finding {
    let rows = windows.len() / long.windows.max(1);
    let issue = Issue::Windows {
        rows: long.samples,
        windows: long.windows,
        length_s: rows as f64 * windows.step(),
        share: windows.len() as f64 / long.samples as f64,
    };
    Finding { severity: Severity::Warning, issue }
}

/// The fit from every row, where the method can; else from the windows. Says which.
pub(super) fn identify(
    method: &dyn Identifier,
    task: &Task,
    long: &[Option<&LongRecording>],
) -> Result<Fit, IdentifyError> {
    let some: Vec<&LongRecording> = long.iter().copied().flatten().collect();
    if some.is_empty() {
        return method.identify(task);
    }
    let rows: usize = some.iter().map(|long| long.samples).sum();
    let (mut fit, note) = match method.identify_long(task, long) {
        Some(fit) => (fit?, Note::ReadInBlocks(rows)),
        None => {
            let windows: usize = some.iter().map(|long| long.windows).sum();
            (method.identify(task)?, Note::FittedToWindows(windows))
        }
    };
    fit.notes.push(note);
    Ok(fit)
}
