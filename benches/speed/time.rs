//! Time of a piece of work, as a row of the table.

use std::hint::black_box;
use std::time::Instant;

/// Time of one run [s]: the shortest of those within 0.4 s, or the mean processor time over them
/// where that is less (other processes lengthen every run of some milliseconds).
pub(crate) fn best<T>(mut work: impl FnMut() -> T) -> f64 {
    let (mut shortest, mut total, mut runs) = (f64::INFINITY, 0.0, 0.0);
    let used = processor_time();
    while total < 0.4 {
        let begin = Instant::now();
        black_box(work());
        let wall = begin.elapsed().as_secs_f64();
        (shortest, total, runs) = (shortest.min(wall), total + wall, runs + 1.0);
    }
    let used = processor_time().zip(used).map(|(after, before)| (after - before) / runs);
    used.map_or(shortest, |used| shortest.min(used))
}

/// Time that this thread has run on a processor [s], where the system reports it (Linux).
fn processor_time() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().next()?.parse::<f64>().ok().map(|nanoseconds| 1e-9 * nanoseconds)
}

pub(crate) fn row(what: &str, over: &str, time: f64, unit: f64) {
    let ratio = time / unit;
    let digits = if ratio < 9.95 { 2 } else { 0 };
    let (scaled, name) = match time {
        t if t < 1e-6 => (t * 1e9, "ns"),
        t if t < 1e-3 => (t * 1e6, "us"),
        t if t < 1.0 => (t * 1e3, "ms"),
        t => (t, "s"),
    };
    println!("| {what} | {over} | {ratio:.digits$} | {scaled:.3} {name} |");
}
