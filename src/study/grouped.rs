//! Findings that are common to several recordings, grouped with the names of these.

/// Largest number of recordings that a finding lists.
const NAMED: usize = 20;

/// Groups findings of recordings into findings with the names of their recordings: "a.csv", "a.csv and
/// b.csv", "3 recordings (a.csv, b.csv, c.csv)", or "all 3 recordings" if there are `count` in total, in the
/// order of first occurrence. Two findings are grouped if `join` widens the first by the second and returns
/// true.
///
/// ```
/// use amigo_ident::recording::{Issue, StatedIssue};
/// use amigo_ident::study::grouped;
/// let found = [("a", Issue::Short(2.0)), ("b", Issue::Still(0)), ("c", Issue::Short(3.0))];
/// let found = found.map(|(name, issue)| (name, issue.stated()));
/// let groups = grouped(found.into_iter(), 4, StatedIssue::join);
/// let stated: Vec<String> =
///     groups.iter().map(|(names, issue)| format!("{names}: {}", issue.what())).collect();
/// assert_eq!(
///     stated,
///     ["a and c: the recording lasts 2.00 to 3.00 s", "b: wheel 1 (right) never moves"]
/// );
/// ```
pub fn grouped<'a, T>(
    findings: impl Iterator<Item = (&'a str, T)>,
    count: usize,
    join: impl Fn(&mut T, &T) -> bool,
) -> Vec<(String, T)> {
    let mut groups: Vec<(Vec<&str>, T)> = Vec::new();
    for (name, finding) in findings {
        match groups.iter_mut().find_map(|(names, all)| join(all, &finding).then_some(names)) {
            // a recording with the same finding twice is named once
            Some(names) if names.last() == Some(&name) => {}
            Some(names) => names.push(name),
            None => groups.push((vec![name], finding)),
        }
    }
    groups.into_iter().map(|(names, finding)| (listed(&names, count), finding)).collect()
}

/// The names of recordings, as the subject of a sentence.
fn listed(names: &[&str], count: usize) -> String {
    match names {
        [one] => (*one).to_string(),
        all if all.len() == count => format!("all {count} recordings"),
        [one, other] => format!("{one} and {other}"),
        many if many.len() > NAMED => {
            format!("{} recordings ({}, ...)", many.len(), many[..NAMED].join(", "))
        }
        many => format!("{} recordings ({})", many.len(), many.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::grouped;
    use crate::conditioning::{Action, Channel, Finding, Kind, Stated};

    fn reset(wheel: usize, row: usize) -> Stated {
        let kind = Kind::Reset { row, step_rad: 2.0 };
        Stated::of(&Finding { channel: Channel::Angle(wheel), kind, action: Action::Noted })
    }

    #[test]
    fn a_recording_with_two_findings_of_the_same_kind_is_named_once() {
        let found = [("a", reset(0, 3)), ("a", reset(0, 17)), ("b", reset(1, 3))];
        let stated = grouped(found.into_iter(), 2, Stated::join);
        assert_eq!(stated.len(), 2);
        assert_eq!(stated[0].0, "a");
        let text = stated[0].1.to_string();
        assert!(text.starts_with("alpha1 jumps by +2.0000 rad at row 3 to 17"), "{text}");
        assert!(stated[1].1.to_string().starts_with("alpha2 jumps"));
    }
}
