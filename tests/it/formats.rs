//! Recordings in the formats of robots, through `experiment new` and `experiment check`.

use crate::support::{Folder, root};

/// Writes an experiment file for a recording of `tests/data` and checks it.
fn started_and_checked(name: &str, words: &[&str]) {
    let folder = Folder::new();
    folder.write(name, std::fs::read(root().join("tests/data").join(name)).unwrap());
    folder.run(&["new", name, "-o", "e.toml"]).says(0, words);
    assert!(folder.read("e.toml").contains(&format!("#   {name}")));
    // positions and velocities that state no unit could be those of a way as well, and torques in whole numbers any
    let unit = |of: &str| format!("unit = \"{of}\"");
    let answered = ["rad", "rad/s", "N m"].iter().fold(folder.read("e.toml"), |file, of| {
        // of each quantity one column a wheel
        file.replacen(&unit("?"), &unit(of), 2)
    });
    folder.write("e.toml", answered);
    folder.run(&["check", "e.toml"]).says(0, &[name]);
}

#[test]
fn a_bag_is_started_and_checked_like_a_table() {
    started_and_checked(
        "joint_states.mcap",
        &[
            "alpha1   = right_wheel.position",
            "dalpha2  = left_wheel.velocity",
            "M1       = right_wheel.effort",
        ],
    );
    started_and_checked(
        "two_topics.mcap",
        &["dalpha1  = /states/right.velocity", "M2       = /commands/left.effort"],
    );
}

#[test]
fn a_wpilog_is_started_and_checked_like_a_table() {
    started_and_checked(
        "drive.wpilog",
        &["dalpha1  = /drive/right/velocity", "M2       = /drive/left/torque_128th"],
    );
}

#[test]
fn a_file_of_sysid_is_started_and_checked_like_a_table() {
    started_and_checked("sysid.json", &["alpha1   = right_position [rev] in rev", "input in V"]);
}

#[test]
fn a_matlab_file_is_checked_with_the_columns_that_are_named() {
    let folder = Folder::new();
    folder.write("v7.mat", std::fs::read(root().join("tests/data/v7.mat")).unwrap());
    let columns = "{ alpha1 = \"q(:,1)\", alpha2 = \"q(:,2)\", dalpha1 = \"dq(1,:)\", \
                   dalpha2 = \"dq(2,:)\", M1 = \"tau_128th(:,1)\", M2 = \"tau_128th(:,2)\" }";
    let file = |columns: &str| {
        format!(
            "[recordings]\ntrain = [\"v7.mat\"]\ncolumns = {columns}\n\n[[method]]\nname = \"prediction_error\"\n"
        )
    };
    folder.write("e.toml", file(columns));
    folder.run(&["check", "e.toml"]).says(0, &["v7.mat"]);
    folder.write("e.toml", file(&columns.replace("tau_128th(:,2)", "tau")));
    folder.run(&["check", "e.toml"]).says(2, &["v7.mat", "no column `tau`", "tau_128th(:,1)"]);
}
