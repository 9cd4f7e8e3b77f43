//! The name of the simulation error, with the length of its windows.

use crate::simulate::WINDOW;
use crate::study::Study;

/// "2 s simulation error"; of judged recordings that are all shorter, with the longest of them: "0.5 s simulation
/// error".
#[must_use]
pub fn simulation_error(study: &Study) -> String {
    let durations = study.judged().into_iter().map(|r| study.recordings[r].duration_s);
    simulation_error_over(durations.fold(0.0, f64::max))
}

/// The same for judged recordings of which the longest lasts so many seconds.
pub(in crate::report) fn simulation_error_over(longest: f64) -> String {
    // tenths of a second
    let window = (10.0 * longest.min(WINDOW)).round() / 10.0;
    let window = if window > 0.0 { window } else { WINDOW };
    format!("{window} s simulation error")
}

#[cfg(test)]
mod tests {
    use super::simulation_error_over;

    #[test]
    fn the_name_has_the_length_of_the_windows() {
        assert_eq!(simulation_error_over(30.0), "2 s simulation error");
        assert_eq!(simulation_error_over(1.97), "2 s simulation error");
        assert_eq!(simulation_error_over(0.52), "0.5 s simulation error");
        // no recording
        assert_eq!(simulation_error_over(0.0), "2 s simulation error");
    }
}
