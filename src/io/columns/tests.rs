use super::*;

fn factor(map: &ColumnMap, key: &str, column: Column) -> Result<(f64, f64), IoError> {
    map.conversion(key, &column, None)
}

fn in_unit(unit: &str) -> Column {
    Column { unit: Some(unit.into()), ..Column::new("x") }
}

#[test]
fn units_are_read_in_the_spellings_of_other_programs() {
    let map = ColumnMap::new(DriveUnit::NewtonMetre, Some(0.05));
    let same = |key: &str, one: &str, other: &str| {
        let of = |unit: &str| factor(&map, key, in_unit(unit)).unwrap();
        assert_eq!(of(one), of(other), "{one}");
    };
    same("dalpha1", "rad/sec", "rad/s");
    same("dalpha1", "deg/sec", "deg/s");
    same("dalpha1", "rot/s", "rev/s");
    same("dalpha1", "U/min", "rpm");
    same("dalpha1", "m/sec", "m/s");
    same("t", "secs", "s");
    same("M1", "N-m", "N m");
    let current = |unit: &str| Column { torque_constant: Some(0.5), ..in_unit(unit) };
    assert_eq!(factor(&map, "M1", current("Amps")).unwrap(), (0.5, 0.0));
    let volts = ColumnMap::new(DriveUnit::Volt, None);
    assert_eq!(factor(&volts, "M1", in_unit("Volts")).unwrap(), (1.0, 0.0));
}

#[test]
fn units_become_si() {
    let map = ColumnMap::new(DriveUnit::NewtonMetre, Some(0.05));
    let of = |key: &str, unit: &str| factor(&map, key, in_unit(unit)).unwrap().0;
    // 60 rpm is a turn a second
    assert!((60.0 * of("dalpha1", "rpm") - TAU).abs() < 1e-12);
    assert!((360.0 * of("alpha2", "deg") - TAU).abs() < 1e-12);
    assert_eq!(of("dalpha2", "rev/s"), TAU);
    assert_eq!([of("dalpha2", "m/s"), of("alpha1", "m")], [20.0; 2]);
    assert!((of("dalpha2", "mm/s") - 0.02).abs() < 1e-15);
    assert!(
        (of("alpha1", "cm") - 0.2).abs() < 1e-15 && (of("dalpha1", "cm/s") - 0.2).abs() < 1e-15
    );
    assert_eq!([of("M1", "Nm"), of("M1", "N·m"), of("M2", "mNm")], [1.0, 1.0, 1e-3]);
    assert_eq!([of("t", "ms"), of("t", "µs"), of("t", "ns")], [1e-3, 1e-6, 1e-9]);
}

#[test]
fn the_unit_of_a_command_leaves_its_size_to_scale() {
    let volts = ColumnMap::new(DriveUnit::Volt, None);
    let duty = Column { scale: 0.01, times: Some("battery".into()), ..Column::new("duty [%]") };
    assert_eq!(volts.conversion("M1", &duty, Some("%")).unwrap(), (0.01, 0.0));
    assert!(volts.conversion("M1", &duty, Some("rpm")).is_err());
    assert!(ColumnMap::default().conversion("M1", &duty, Some("%")).is_err());
}

#[test]
fn torques_in_weights_and_days_become_si() {
    let map = ColumnMap::default();
    let of = |key: &str, unit: &str| factor(&map, key, in_unit(unit)).unwrap().0;
    // NIST SP 811: 1 kgf m = 9.80665 N m, 1 ozf in = 7.061552e-3, 1 lbf in = 0.1129848, 1 lbf ft = 1.355818
    for (unit, expected) in [
        ("kgf.cm", 0.098_066_5),
        ("kg-cm", 0.098_066_5),
        ("oz-in", 7.061_552e-3),
        ("in-lb", 0.112_984_8),
        ("lb-ft", 1.355_818),
    ] {
        // seven digits are given
        assert!((of("M1", unit) / expected - 1.0).abs() < 3e-7, "{unit}");
    }
    assert_eq!(of("t", "days"), 86_400.0);
}

#[test]
fn what_does_not_add_up_is_refused() {
    let sum = |unit: DriveUnit, key: &str, plus: &[&str]| {
        let plus = plus.iter().map(ToString::to_string).collect();
        ColumnMap::new(unit, None).put(key, Column { plus, ..Column::new("a") })
    };
    assert_eq!(sum(DriveUnit::Ampere, "M2", &["b", "c"]), Ok(()));
    for (unit, key, plus, words) in [
        (DriveUnit::Volt, "M1", "b", "voltages do not add up"),
        (DriveUnit::NewtonMetre, "dalpha1", "b", "only torques and currents"),
        (DriveUnit::NewtonMetre, "M1", "a", "`a` is listed twice"),
    ] {
        let e = sum(unit, key, &[plus]).unwrap_err().to_string();
        assert!(e.contains(words) && e.contains(&format!("columns.{key}.plus")), "{e}");
    }
}

#[test]
fn counts_currents_scale_and_offset_are_converted() {
    let map = ColumnMap::default();
    let ticks = Column { per_turn: Some(500.0), ..Column::new("enc") };
    assert!((factor(&map, "alpha1", ticks).unwrap().0 * 500.0 - TAU).abs() < 1e-12);
    let current = Column {
        unit: Some("mA".into()),
        torque_constant: Some(0.1),
        scale: -1.0,
        offset: 50.0,
        ..Column::new("i")
    };
    // 250 mA read, -250 + 50 = -200 mA meant, -0.02 N m
    let (scale, offset) = factor(&map, "M1", current).unwrap();
    assert!((250.0 * scale + offset + 0.02).abs() < 1e-15);
}

#[test]
fn units_that_do_not_fit_are_refused_with_what_is_needed() {
    let map = ColumnMap::default();
    let e = factor(&map, "dalpha1", in_unit("knots")).unwrap_err().to_string();
    assert!(e.contains("`knots` is not known for a speed") && e.contains("rpm"), "{e}");
    let e = factor(&map, "alpha1", in_unit("ticks")).unwrap_err().to_string();
    assert!(e.contains("needs per_turn"), "{e}");
    let e = factor(&map, "M1", in_unit("A")).unwrap_err().to_string();
    assert!(e.contains("torque_constant") && e.contains("drive_unit = \"A\""), "{e}");
    let amperes = &mut ColumnMap::new(DriveUnit::Ampere, None);
    let column = Column { torque_constant: Some(0.1), ..Column::new("i") };
    let e = amperes.put("M1", column).unwrap_err().to_string();
    assert!(e.contains("drive_unit = \"N m\""), "{e}");
    let volts = ColumnMap::new(DriveUnit::Volt, None);
    assert!(factor(&volts, "M1", in_unit("N m")).is_err());
    let e = ColumnMap::default().set("alfa1", "q", None, 1.0).unwrap_err().to_string();
    assert!(e.contains("did you mean `alpha1`?"), "{e}");
    let e = ColumnMap::default().set("M1", "q", None, 0.0).unwrap_err().to_string();
    assert!(e.contains("columns.M1"), "{e}");
}
