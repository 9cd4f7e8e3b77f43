//! Logs in other languages and formats, and methods that fail, through the program.

use crate::support::{Folder, csv, motion};

/// A log of the simulated robot with another header.
fn with_header(header: &str) -> String {
    let log = csv(&motion());
    let rows = log.split_once('\n').map(|(_, rows)| rows).unwrap_or_default();
    format!("{header}\n{rows}")
}

#[test]
fn headers_in_many_languages_are_understood_without_a_question() {
    for (header, right) in [
        (
            "Thời gian (s),Tốc độ phải (vòng/phút),Tốc độ trái (vòng/phút),Điện áp phải (V),Điện áp trái (V)",
            "phải",
        ),
        (
            "\"Час, с\",\"Швидкість права, об/хв\",\"Швидкість ліва, об/хв\",\"Напруга права, В\",\"Напруга ліва, В\"",
            "права",
        ),
        ("Zaman (s),Sağ hız (d/dk),Sol hız (d/dk),Sağ gerilim (V),Sol gerilim (V)", "Sağ"),
        (
            "Idő [s],Jobb fordulatszám [1/min],Bal fordulatszám [1/min],Jobb feszültség [V],Bal feszültség [V]",
            "Jobb",
        ),
        (
            "χρόνος (s),ταχύτητα δεξιά (rpm),ταχύτητα αριστερά (rpm),τάση δεξιά (V),τάση αριστερά (V)",
            "δεξιά",
        ),
        (
            "waktu_s,kecepatan_kanan_rpm,kecepatan_kiri_rpm,tegangan_kanan_V,tegangan_kiri_V",
            "kanan",
        ),
        ("الزمن (s),سرعة اليمين (rpm),سرعة اليسار (rpm),جهد اليمين (V),جهد اليسار (V)", "اليمين"),
    ] {
        let folder = Folder::new();
        folder.write("run.csv", with_header(header));
        let done = folder.run(&["new", "run.csv", "-o", "e.toml"]);
        done.says(0, &["in rpm", "input in V"]);
        assert!(!done.out.contains("question:"), "{header}: {}", done.out);
        let file = folder.read("e.toml");
        let columns = file.lines().find(|l| l.starts_with("columns")).unwrap();
        let first = columns.split("dalpha1").nth(1).unwrap().split("dalpha2").next().unwrap();
        assert!(first.contains(right), "{right}: {columns}");
    }
}

#[test]
fn a_time_in_seconds_under_the_name_of_microseconds_is_read_in_seconds() {
    let folder = Folder::new();
    folder.write("run.csv", with_header("time_us,w_r,w_l,tau_r,tau_l"));
    folder
        .run(&["new", "run.csv", "-o", "e.toml"])
        .says(0, &["its name states us, which would be 1e8 Hz: this is s (100 Hz)"]);
    folder.run(&["check", "e.toml"]).says(0, &["600 samples"]);
    let file = folder.read("e.toml").replace("unit = \"s\"", "unit = \"us\"");
    folder.write("us.toml", file);
    folder.run(&["check", "us.toml"]).says(2, &["t = { name = \"time_us\", unit = \"s\" }"]);
}

#[test]
fn the_time_beside_every_signal_is_one_column() {
    let rows: String = motion()
        .iter()
        .map(|[t, a, b, c, d]| format!("{t},{a},{t},{b},{t},{c},{t},{d}\n"))
        .collect();
    let folder = Folder::new();
    let header = "time,omega_right,time,omega_left,time,torque_right,time,torque_left";
    folder.write("sdi.csv", format!("{header}\n{rows}"));
    folder.run(&["new", "sdi.csv", "-o", "e.toml"]).says(0, &["next: experiment e.toml"]);
    folder.run(&["check", "e.toml"]).says(0, &["600 samples"]);
}

#[test]
fn a_share_of_the_battery_voltage_has_its_keys() {
    let rows: String = motion()
        .iter()
        .map(|[t, a, b, c, d]| format!("{t},{a},{b},{},{},12.4\n", 0.1 * c, 0.1 * d))
        .collect();
    let folder = Folder::new();
    let header = "Time,Right rpm,Left rpm,Right Output Percent,Left Output Percent,Bus Voltage";
    folder.write("ctre.csv", format!("{header}\n{rows}"));
    folder.run(&["new", "ctre.csv", "-o", "e.toml"]).says(0, &["is 1 the full voltage of"]);
    let file = folder.read("e.toml");
    let keys = "M1 = { name = \"Right Output Percent\", times = \"Bus Voltage\" }";
    assert!(file.contains(keys), "{file}");
}

#[test]
fn a_report_states_why_every_method_failed() {
    let folder = Folder::new();
    let log = csv(&motion());
    let short: Vec<&str> = log.lines().take(21).collect();
    folder.write("short.csv", short.join("\n"));
    folder.write(
        "short.toml",
        "[recordings]\ntrain = [\"short.csv\"]\n\n[[method]]\nname = \"weak_form\"\n",
    );
    folder.run(&["short.toml"]).says(1, &["no method has a fit", "report.html", "1 of 1"]);
    let results = folder.results("reports/short");
    let row = &results["methods"][0];
    assert_eq!(row["status"], "failed", "{row}");
    assert!(row.to_string().contains("usable samples"), "{row}");
    assert_eq!(results["recordings"][0]["samples"], 20);
    assert!(results["grade"].is_null() && results["model_as_given"].is_null(), "{results}");
    assert!(folder.read("reports/short/report.html").contains("No method has a fit"));
}

#[test]
fn methods_that_fail_are_rows_with_their_reason() {
    let folder = Folder::new();
    let log = csv(&motion());
    let short: Vec<&str> = log.lines().take(21).collect();
    folder.write("short.csv", short.join("\n"));
    let method = |name: &str| format!("[[method]]\nname = \"{name}\"\n\n");
    let text = format!(
        "[recordings]\ntrain = [\"short.csv\"]\n\n{}{}",
        method("weak_form"),
        method("prediction_error")
    );
    folder.write("short.toml", text);
    folder.run(&["short.toml"]).says(0, &["simulation error"]);
    let results = folder.results("reports/short");
    let row = &results["methods"][0];
    assert_eq!(row["status"], "failed", "{row}");
    assert!(row.to_string().contains("usable samples"), "{row}");
}
