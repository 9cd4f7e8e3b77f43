//! Checks of the time column: rate, jitter, gaps, length, sensors slower than the log.

use super::super::Recording;
use super::issue::{SHORT, SLOW};
use super::{Finding, Gaps, Issue, Severity};

/// Jitter above which the sampling is non-uniform \[1\].
const UNEVEN: f64 = 0.3;
/// Shortest piece between gaps with a simulation error \[s\].
const PIECE: f64 = 2.0;

/// Rate \[Hz\], jitter \[1\] and gaps.
pub(super) fn measure(r: &Recording) -> (f64, f64, Gaps) {
    let (t, step) = (r.t(), r.step());
    let (mut square, mut count) = (0.0, 0_usize);
    for piece in r.pieces() {
        for w in t[piece.clone()].windows(2) {
            square += ((w[1] - w[0]) / step - 1.0).powi(2);
            count += 1;
        }
    }
    let jumps = r.pieces().windows(2).map(|p| t[p[1].start] - t[p[0].end - 1]);
    let gaps = Gaps { count: r.pieces().len() - 1, longest: jumps.fold(0.0, f64::max) };
    (1.0 / step, (square / count.max(1) as f64).sqrt(), gaps)
}

pub(super) fn findings(r: &Recording, jitter: f64, gaps: Gaps) -> Vec<Finding> {
    let mut out = Vec::new();
    let rate = 1.0 / r.step();
    if r.covered() < SHORT {
        out.push(Finding::new(Severity::Warning, Issue::Short(r.covered())));
    }
    // steps of 50 ms are 20 Hz despite rounding of the time stamps
    if rate < SLOW * (1.0 - 1e-3) {
        out.push(Finding::new(Severity::Warning, Issue::Slow(rate)));
    }
    if jitter > UNEVEN {
        out.push(Finding::new(Severity::Warning, Issue::Uneven(jitter)));
    }
    if gaps.count > 0 {
        let short = r.pieces().iter().filter(|p| r.t()[p.end - 1] - r.t()[p.start] < PIECE).count();
        let severity =
            if 2 * short > r.pieces().len() { Severity::Warning } else { Severity::Note };
        out.push(Finding::new(severity, Issue::Gaps(gaps, short)));
    }
    if r.repeats_readings() {
        let share = 1.0 - r.readings() as f64 / r.len() as f64;
        out.push(Finding::new(Severity::Note, Issue::Repeats(share)));
    }
    out
}
