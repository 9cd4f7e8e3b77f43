//! The rate of the rows, where a line beside the table states it.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use super::csv::quantity;

/// Such lines are looked for in this many bytes at the beginning.
const HEAD: u64 = 1 << 16;
/// Words before the value, in lower case and without signs.
const RATES: [&str; 8] = [
    "fs",
    "rate",
    "samplerate",
    "samplingrate",
    "frequency",
    "samplefrequency",
    "samplingfrequency",
    "lograte",
];
const PERIODS: [&str; 6] = ["ts", "dt", "period", "sampletime", "samplingtime", "sampleperiod"];

/// Time between two rows \[s\] that a line of a text states, with the line: `# fs: 100 Hz`, `% Ts = 10 ms`, and without
/// the sign of a comment `Sampling rate;100 Hz`. A value without a unit is none. `None` also for a file that cannot be read.
#[must_use]
pub fn stated_period(path: &Path) -> Option<(f64, String)> {
    let file = File::open(path).ok()?;
    let lines = BufReader::new(file.take(HEAD)).split(b'\n').map_while(Result::ok);
    lines.map(|line| String::from_utf8_lossy(&line).trim().to_string()).find_map(|line| {
        let bare = line.trim_start_matches(['#', '%', '/', '"']).trim_end_matches([',', ';', '"']);
        Some((period(bare)?, line.clone()))
    })
}

/// The period of `fs: 100 Hz` or `Ts = 0.01 s` \[s\].
fn period(comment: &str) -> Option<f64> {
    let (word, value) = comment.split_once([':', '=', ';', ',', '\t'])?;
    let word: String = word.to_lowercase().chars().filter(|c| c.is_ascii_alphanumeric()).collect();
    let (number, unit) = quantity(value.trim())?;
    let seconds = match unit.to_lowercase().as_str() {
        "hz" => 1.0,
        "khz" => 1e-3,
        "s" | "sec" if PERIODS.contains(&word.as_str()) => 1.0,
        "ms" if PERIODS.contains(&word.as_str()) => 1e-3,
        _ => return None,
    };
    let period = if PERIODS.contains(&word.as_str()) {
        seconds * number
    } else if RATES.contains(&word.as_str()) {
        seconds / number
    } else {
        return None;
    };
    (period > 0.0 && period.is_finite()).then_some(period)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comment_states_the_rate_of_the_rows() {
        for (comment, expected) in [
            ("Sampling rate;100 Hz", Some(0.01)),
            ("dt,0.02", None),
            (" fs: 100 Hz", Some(0.01)),
            (" Sample rate = 2 kHz", Some(0.0005)),
            ("Ts = 20 ms", Some(0.02)),
            (" rate: 100", None),
            (" PWM frequency: 20 kHz", None),
            (" fs: 0 Hz", None),
        ] {
            assert_eq!(period(comment), expected, "{comment}");
        }
    }
}
