//! Selection of the recordings listed individually: if there are too many, those with the largest errors.

use crate::study::Study;

/// Largest number of recordings in a table; `results.json` contains all.
pub(super) const MOST: usize = 200;

/// The recordings that are listed, in their order: all, or the [`MOST`] with the largest ratio of 2 s
/// simulation error to noise floor.
pub(super) fn recordings(study: &Study) -> Vec<usize> {
    let mut all: Vec<usize> = (0..study.recordings.len()).collect();
    if all.len() <= MOST {
        return all;
    }
    let method = study.reference_method();
    let excess = |r: usize| {
        let error = method.and_then(|m| m.performance.get(r)).map_or(f64::NAN, |p| p.window_rms);
        error / study.recordings[r].floor.window_rms
    };
    // NaN counts as the largest
    all.sort_by(|&a, &b| excess(b).total_cmp(&excess(a)));
    all.truncate(MOST);
    all.sort_unstable();
    all
}

/// Remark if not all are listed.
pub(super) fn left_out(study: &Study) -> Option<String> {
    let count = study.recordings.len();
    (count > MOST).then(|| {
        format!(
            "Of {count} recordings the {MOST} are listed in which the 2 s simulation error exceeds the \
             noise floor most; results.json has all."
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::section::tests::full;

    #[test]
    fn of_many_recordings_the_worst_are_listed() {
        let mut study = full();
        assert_eq!(recordings(&study).len(), study.recordings.len());
        assert!(left_out(&study).is_none());
        let (recording, reference) = (study.recordings[0].clone(), study.reference.unwrap());
        study.recordings = vec![recording; 1000];
        let performance = study.methods[reference].performance[0].clone();
        study.methods[reference].performance = (0..1000)
            .map(|r| {
                let mut one = performance.clone();
                one.window_rms *= 1.0 + f64::from(r % 5);
                one
            })
            .collect();
        // a fifth of them has the largest error
        let worst: Vec<usize> = (0..1000).filter(|r| r % 5 == 4).collect();
        assert_eq!(recordings(&study), worst);
        assert!(left_out(&study).unwrap().starts_with("Of 1000 recordings the 200"));
    }
}
