//! Headers of several lines, units in them, a second header within the rows, and JSON with what is no number.

use crate::support::{Folder, motion};

#[test]
fn what_is_no_number_in_json_is_missing() {
    let list = |k: usize| -> Vec<f64> { motion().iter().map(|row| row[k]).collect() };
    let mut log = format!(
        r#"{{"t": {:?}, "left": {{"vel": {:?}, "torque": {:?}}}, "right": {{"vel": {:?}, "torque": {:?}}}}}"#,
        list(0),
        list(2),
        list(4),
        list(1),
        list(3)
    );
    let place = log.find("\"vel\": [").unwrap() + 8;
    log.insert_str(place, "NaN, ");
    let cut = log[place + 5..].find(',').unwrap() + place + 5;
    // in place of the first value
    log.replace_range(place + 5..=cut, "");
    let folder = Folder::new();
    folder.write("run.json", &log);
    folder.run(&["new", "run.json"]).says(0, &["dalpha1  = right.vel"]);
    folder.write("cut.json", &log[..log.len() / 2]);
    let refused = folder.run(&["new", "cut.json"]);
    refused.says(2, &["cut.json cannot be read as JSON: it ends within a list or an object"]);
    assert!(!refused.err.contains("SysId"), "{}", refused.err);
}
