//! Errors of model versions are compared on identical data only.

use crate::support::Folder;

const SCRUB: &str = r#"[simulation]
hidden     = { turning_scrub = { f_t = 0.02 } }
noise      = { dalpha = 0.05, alpha = 0.001, M = 0.005 }
seed       = 2
train      = 1
validation = 1
duration_s = 8.0
[model]
effects = []
[[method]]
name = "torque_regression"
"#;

const WITH_SCRUB: &str = "model.effects=[\"turning_scrub\"]";

/// Bars of the figure of versions after a run with some keys overridden; none without the figure.
fn compared(folder: &Folder, set: &[&str]) -> usize {
    let mut arguments = vec!["v.toml"];
    arguments.extend(set.iter().flat_map(|key| ["--set", key]));
    folder.run(&arguments).says(0, &[]);
    let html = folder.read("reports/v/report.html");
    let section = html.split_once("Versions of this model run so far");
    let table = section.and_then(|(_, s)| s.split("<tbody>").nth(1)?.split("</tbody>").next());
    table.map_or(0, |rows| rows.matches("<tr>").count())
}

#[test]
fn versions_on_other_seeds_or_noise_are_not_compared_and_come_back_with_their_data() {
    let folder = Folder::new();
    folder.write("v.toml", SCRUB);
    assert_eq!(compared(&folder, &[]), 0);
    assert_eq!(compared(&folder, &[WITH_SCRUB]), 2);
    // the same model again, by another method, is no other version
    assert_eq!(compared(&folder, &[WITH_SCRUB, "method=[{name=\"output_error\"}]"]), 2);
    assert_eq!(compared(&folder, &["simulation.seed=3"]), 0);
    assert_eq!(compared(&folder, &[WITH_SCRUB, "simulation.noise.dalpha=0.1"]), 0);
    // nor is another true value of the hidden effect the same data
    assert_eq!(compared(&folder, &["simulation.hidden.turning_scrub.f_t=0.03"]), 0);
    assert_eq!(compared(&folder, &["model.effects=[\"viscous_friction\"]"]), 3);
}
