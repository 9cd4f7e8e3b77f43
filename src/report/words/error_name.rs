//! The name of the simulation error, with the length of its windows.

use crate::study::Study;

/// Length of a window \[s\] of recordings that are as long.
const WINDOW: f64 = 2.0;

/// "2 s simulation error"; of judged recordings that are all shorter, with the longest of them: "0.5 s simulation error".
#[must_use]
pub fn simulation_error(study: &Study) -> String {
    let durations = study.judged().into_iter().map(|r| study.recordings[r].duration_s);
    named(durations.fold(0.0, f64::max))
}

fn named(longest: f64) -> String {
    // tenths of a second
    let window = (10.0 * longest.min(WINDOW)).round() / 10.0;
    let window = if window > 0.0 { window } else { WINDOW };
    format!("{window} s simulation error")
}

#[cfg(test)]
mod tests {
    use super::named;

    #[test]
    fn the_name_has_the_length_of_the_windows() {
        assert_eq!(named(30.0), "2 s simulation error");
        assert_eq!(named(1.97), "2 s simulation error");
        assert_eq!(named(0.52), "0.5 s simulation error");
        // no recording
        assert_eq!(named(0.0), "2 s simulation error");
    }
}
