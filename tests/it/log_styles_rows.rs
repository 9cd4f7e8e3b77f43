//! Rows in quotes, in brackets and with damaged cells, and directions in several recordings.

use crate::log_styles::{lines, started};
use crate::support::Folder;

const NAMES: &str = "t,omega_r,omega_l,tau_r,tau_l";
const FOUND: [&str; 3] = ["t        = t", "dalpha1  = omega_r", "M2       = tau_l"];

#[test]
fn rows_in_one_pair_of_quotes_or_brackets_are_rows_of_several_cells() {
    let row = |t: f64, w1: f64, w2: f64, m1: f64, m2: f64| {
        format!("{t:.3}, {w1:e}, {w2:e}, {m1:e}, {m2:e}")
    };
    let rows = |open: &str, close: &str| {
        lines(|[t, w1, w2, m1, m2]| format!("{open}{}{close}\n", row(*t, *w1, *w2, *m1, *m2)))
    };
    let quoted = rows("\"", "\"");
    started("run.csv", &format!("{NAMES}\n{quoted}"), &FOUND);
    started("run.csv", &format!("\"{NAMES}\"\n{quoted}"), &FOUND);
    // the empty columns of the spreadsheet
    started("run.csv", &format!("\"{NAMES}\";;\n{}", rows("\"", "\";;")), &FOUND);
    started("run.txt", &format!("{NAMES}\n{}", rows("(", ")")), &FOUND);
    let semicolons = quoted.replace(',', ";").replace('.', ",");
    started("run.csv", &format!("\"{}\"\n{semicolons}", NAMES.replace(',', "; ")), &FOUND);
    let formulas = lines(|[t, w1, w2, m1, m2]| {
        format!("=\"{t:.3}\",=\"{w1}\",=\"{w2}\",=\"{m1}\",=\"{m2}\"\n")
    });
    started("run.csv", &format!("{NAMES}\n{formulas}"), &FOUND);
}

/// A log in which every row of these has another text.
fn damaged(head: &str, is_damaged: impl Fn(usize) -> bool, text: &str) -> Folder {
    let rows = lines(|[t, w1, w2, m1, m2]| format!("{t:.3},{w1},{w2},{m1},{m2}\n"));
    let row = |(k, row): (usize, &str)| match is_damaged(k) {
        true => format!("{:.3},{text}\n", 0.01 * k as f64),
        false => format!("{row}\n"),
    };
    let body: String = rows.lines().enumerate().map(row).collect();
    let folder = Folder::new();
    folder.write("run.csv", format!("{head}{body}"));
    folder
}

#[test]
fn damaged_rows_are_left_out_or_refused_with_their_content() {
    let head = format!("{NAMES}\n");
    let new = ["new", "run.csv", "-o", "e.toml"];
    for text in ["1,2,3,4,5", "1,2,3"] {
        let folder = damaged(&head, |k| k == 40 || k == 300, text);
        let words = ["2 of 600 rows have", "left out (first: row 41 (line 42) `0.400,1,2,3"];
        folder.run(&new).says(0, &words);
        folder.run(&["check", "e.toml"]).says(0, &["598 samples", "first: row 41"]);
    }
    // with a header and without, and between other separators
    let often = |k: usize| k % 20 == 7;
    let folder = damaged(&head, often, "1,2,3,4,5");
    folder.run(&new).says(2, &["row 8 (line 9) `0.070,1,2,3,4,5`: 6 cells, and the header has 5"]);
    let folder = damaged("", often, "1,2,3,4,5");
    folder.run(&new).says(2, &["row 8 (line 8)", "6 cells, and the other rows have 5"]);
    let folder = damaged("", often, "1,2,3,4\t5");
    folder.run(&new).says(2, &["row 8 (line 8)", "6 cells, and the other rows have 5"]);
    // a logger that leaves out empty cells at the end
    let folder = damaged(&head, often, "1,2,3");
    folder.run(&new).says(0, &["30 of 600 rows have fewer cells than the others; their last"]);
}

#[test]
fn the_direction_of_a_motor_is_that_of_all_recordings() {
    let run = |word: &str, sign: f64| {
        let rows = lines(|[t, w1, _, m1, _]| {
            let pwm = (200.0 * m1.abs()).round();
            format!("{:.0},{word},{pwm},{:.4}\n", 1e3 * t, sign * w1.abs())
        });
        format!("t_ms,dir,pwm,rpm\n{rows}")
    };
    let folder = Folder::new();
    for (file, word, sign) in [("n.csv", "N", 1.0), ("f.csv", "F", 1.0), ("r.csv", "R", -1.0)] {
        folder.write(file, run(word, sign));
    }
    for (k, files) in
        [["n.csv", "f.csv", "r.csv"], ["f.csv", "r.csv", "n.csv"], ["r.csv", "n.csv", "f.csv"]]
            .into_iter()
            .enumerate()
    {
        let out = format!("e{k}.toml");
        let found = [&["new"][..], &files, &["-o", &out]].concat();
        folder.run(&found).says(0, &["direction from `dir`: `R` is backward"]);
    }
}
