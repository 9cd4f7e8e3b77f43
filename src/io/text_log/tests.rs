use super::*;

fn read_bytes(bytes: &[u8]) -> Option<Columns> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.txt");
    std::fs::write(&path, bytes).unwrap();
    read(&path).unwrap()
}

fn names(columns: &Columns) -> Vec<&str> {
    columns.iter().map(|(name, _)| name.as_str()).collect()
}

/// Twelve rows of t = 0, 0.1, … and its multiples.
fn rows(separator: &str, end: &str) -> String {
    let row = |k: i32| {
        let cells: Vec<String> = (1..=3).map(|j| format!("{}", 0.1 * f64::from(k * j))).collect();
        cells.join(separator) + end
    };
    (0..12).map(row).collect()
}

#[test]
fn plain_tables_are_left_to_the_reader_of_csv() {
    for above in ["t,a,b\n", "# note\n\nt,a,b\n", "t,a,b\ns,rad,rad\n", "t,a,b\nbroken,x,y\n"] {
        assert_eq!(read_bytes(format!("{above}{}", rows(",", "\n")).as_bytes()), None, "{above}");
    }
    assert_eq!(read_bytes(b"words and no table\n"), None);
    assert_eq!(read_bytes(b"t,a,b\n0,1,2\n"), None);
}

#[test]
fn names_are_found_below_a_preamble_behind_units_and_in_comments() {
    let motec = "\"Format\",\"MoTeC CSV File\",,\n\"Date\",\"05/03/2024\"\n\n\
                 \"Time\",\"Speed L\",\"Speed R\"\n\"s\",\"rpm\",\"rpm\"\n\n";
    let labview = "Writer_Version\t2\nY_Unit_Label\trpm\tA\nSamples\t12\t12\nX0\t0\t0\nDelta\t1\t1\n\
                   ***End_of_Header***\t\nX_Value\tl\tr\n";
    let savetxt = "# robot 3\n# t left right\n";
    let comments = "// logger 3\n% SI\nt,a,b\n";
    for (above, separator, expected) in [
        (motec, ",", ["Time [s]", "Speed L [rpm]", "Speed R [rpm]"]),
        (labview, "\t", ["X_Value", "l [rpm]", "r [A]"]),
        (savetxt, " ", ["t", "left", "right"]),
        (savetxt, ",", ["t", "left", "right"]),
        (comments, ",", ["t", "a", "b"]),
        ("t  a   b\n", "   ", ["t", "a", "b"]),
        ("", ",", ["column1", "column2", "column3"]),
    ] {
        let found = read_bytes(format!("{above}{}", rows(separator, "\r\n")).as_bytes()).unwrap();
        assert_eq!(names(&found), expected);
        assert_eq!(found[2].1.len(), 12);
        assert!((found[2].1[11] - 3.3).abs() < 1e-12);
    }
}

#[test]
fn two_lines_of_names_are_put_together_and_units_below_them_are_kept() {
    let expected = [
        "Time [s]",
        "Left Speed [deg/s]",
        "Left Torque [Ncm]",
        "Right Speed [deg/s]",
        "Right Torque [Ncm]",
    ];
    for below in [
        "[s],Speed [deg/s],Torque [Ncm],Speed [deg/s],Torque [Ncm]\n",
        "Time,Speed,Torque,Speed,Torque\ns,deg/s,Ncm,deg/s,Ncm\n",
    ] {
        let rows: String = (0..12).map(|k| format!("{k},1.5,2.5,-1,-2\n")).collect();
        let found = read_bytes(format!("Time,Left,Left,Right,Right\n{below}{rows}").as_bytes());
        let found = found.unwrap();
        assert_eq!((names(&found), found[2].1.len()), (expected.to_vec(), 12));
    }
    // in another encoding, with a column without unit
    let (bytes, ..) = encoding_rs::GBK.encode("时间,左轮转速,右轮转速\nms,rpm,-\n");
    let found = read_bytes(&[&bytes, rows(",", "\n").as_bytes()].concat()).unwrap();
    assert_eq!(names(&found), ["时间 [ms]", "左轮转速 [rpm]", "右轮转速"]);
}

#[test]
fn another_encoding_and_cells_without_a_number_are_read() {
    let text = format!("t\tω\tb\n0\tnull\t-\n{}", rows("\t", "\n"));
    let wide: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let found = read_bytes(&[&[0xff, 0xfe][..], &wide].concat()).unwrap();
    assert_eq!(names(&found), ["t", "ω", "b"]);
    assert!(found[1].1[0].is_nan() && found[1].1[12] == 2.2);
}

#[test]
fn records_of_a_console_and_of_json_are_tables() {
    let line = |k: i32| format!("t={k},l: {},r={}\n", 2 * k, -k);
    let found = read_bytes((0..9).map(line).collect::<String>().as_bytes()).unwrap();
    assert_eq!(names(&found), ["t", "l", "r"]);
    assert_eq!(found[1].1[8], 16.0);
    let line = |k: i32| format!("10:11:{k:02}.5 -> ms:{k} enc:{}\n", 3 * k);
    let found = read_bytes((0..9).map(line).collect::<String>().as_bytes()).unwrap();
    assert_eq!(names(&found), ["clock", "ms", "enc"]);
    let line = |k: i32| {
        let more = if k == 4 { "" } else { ",\"left\":{\"vel\":[1,2]}" };
        format!("{{\"t\":{k}{more},\"id\":\"a\"}}\n")
    };
    let found = read_bytes((0..9).map(line).collect::<String>().as_bytes()).unwrap();
    assert_eq!(names(&found), ["left.vel[0]", "left.vel[1]", "t"]);
    assert!(found[0].1[4].is_nan() && found[1].1[5] == 2.0);
}

#[test]
fn files_of_json_hold_columns_or_records() {
    let read = |text: &str| record::of_json(&serde_json::from_str(text).unwrap());
    let found = read("{\"name\":\"a\",\"t\":[0,1,2],\"left\":{\"vel\":[1,null,3]}}").unwrap();
    assert_eq!(names(&found), ["left.vel", "t"]);
    assert!(found[0].1[1].is_nan() && found[0].1[2] == 3.0);
    for text in
        ["[{\"t\":0,\"w\":[1,2]},{\"t\":1}]", "{\"rows\":[{\"t\":0,\"w\":[1,2]},{\"t\":1}]}"]
    {
        let found = read(text).unwrap();
        assert_eq!(names(&found), ["t", "w[0]", "w[1]"]);
        assert!(found[2].1[0] == 2.0 && found[2].1[1].is_nan());
    }
    assert_eq!(read("{\"sysid\":true,\"slow-forward\":[[0,1],[1,2]]}"), None);
    assert_eq!(read("{\"a\":1}"), None);
}
