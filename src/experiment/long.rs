//! Recordings of which only windows are in memory: the remark on them, and methods that read all rows.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use crate::diagnose::Progress;
use crate::identify::{Excited, Fit, Identifier, IdentifyError, Note};
use crate::recording::{
    Channels, Finding, Issue, LongRecording, Recording, Rows, RowsError, Severity,
};

/// The issue reported by the quality check.
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

/// The fit to every row, if the method supports this; otherwise to the windows. A note states which.
pub(super) fn identify(
    method: &dyn Identifier,
    excited: &Excited,
    long: &[Option<&LongRecording>],
) -> Result<Fit, IdentifyError> {
    let some: Vec<&LongRecording> = long.iter().copied().flatten().collect();
    if some.is_empty() {
        return excited.identify(method);
    }
    let rows: usize = some.iter().map(|long| long.samples).sum();
    let (mut fit, note) = match method.identify_long(excited.task(), long) {
        Some(fit) => (fit?, Note::ReadInBlocks(rows)),
        None => {
            let windows: usize = some.iter().map(|long| long.windows).sum();
            (excited.identify(method)?, Note::FittedToWindows(windows))
        }
    };
    fit.notes.push(note);
    Ok(fit)
}

/// The rows of a long recording, counted while they are read.
struct Counted {
    long: Arc<LongRecording>,
    /// Number of rows read so far, and of all rows, over all recordings.
    read: Arc<AtomicUsize>,
    all: usize,
    progress: Progress,
}

impl Rows for Counted {
    fn blocks(&self) -> Box<dyn Iterator<Item = Result<Channels, RowsError>> + '_> {
        let count = |block: &Result<Channels, RowsError>| {
            let rows = block.as_ref().map_or(0, |block| block.t.len());
            (self.progress)(self.read.fetch_add(rows, Relaxed) + rows, self.all);
        };
        Box::new(self.long.rows.blocks().inspect(count))
    }

    fn left_out(&self) -> (usize, usize) {
        self.long.rows.left_out()
    }
}

/// The same recordings; `progress` is called with the number of rows read so far in all of them.
pub(super) fn counted(
    long: &[Option<Arc<LongRecording>>],
    progress: &Progress,
) -> Vec<Option<LongRecording>> {
    let all = long.iter().flatten().map(|long| long.samples).sum();
    let read = Arc::new(AtomicUsize::new(0));
    let of = |long: &Arc<LongRecording>| LongRecording {
        rows: Box::new(Counted {
            long: long.clone(),
            read: read.clone(),
            all,
            progress: progress.clone(),
        }),
        samples: long.samples,
        duration: long.duration,
        windows: long.windows,
    };
    long.iter().map(|long| long.as_ref().map(of)).collect()
}
