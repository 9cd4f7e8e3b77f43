//! Formulas against the same formulas written in Rust.

use proptest::prelude::*;

use super::super::scalar::Dual;
use super::*;

fn value(source: &str) -> f64 {
    parse(source).unwrap().bind(&[]).unwrap().evaluate(&[] as &[f64])
}

fn at(source: &str, x: f64) -> f64 {
    parse(source).unwrap().bind(&["x"]).unwrap().evaluate(&[x])
}

#[test]
fn operators_bind_as_in_written_mathematics() {
    let table = [
        ("1 + 2*3", 7.0),
        ("(1 + 2)*3", 9.0),
        ("8 - 4 - 2", 2.0),
        ("16/4/2", 2.0),
        ("2^3^2", 512.0),
        ("-2^2", -4.0),
        ("(-2)^2", 4.0),
        ("2^-1", 0.5),
        ("2*-3", -6.0),
        ("--3", 3.0),
        ("+3 - +1", 2.0),
        ("1.5e2 + .5 + 1.", 151.5),
        ("min(3, max(1, 2))", 2.0),
        ("-3*2 + 10", 4.0),
        ("2*pi", std::f64::consts::TAU),
    ];
    for (source, expected) in table {
        assert_eq!(value(source), expected, "{source}");
    }
}

#[test]
fn the_same_holds_when_nothing_can_be_folded() {
    let x = 1.7_f64;
    let table = [
        ("-x^2", -(x * x)),
        ("x^2^x", x.powf(2.0_f64.powf(x))),
        ("x - 1 - 2", x - 3.0),
        ("2 - x - 1", 1.0 - x),
        ("1/x/2", 0.5 / x),
        ("-x*x", -(x * x)),
        ("x^-x", x.powf(-x)),
        ("x^(1/2)", x.sqrt()),
        ("min(x, 1) + max(x, 1)", 1.0 + x),
    ];
    for (source, expected) in table {
        assert!((at(source, x) - expected).abs() < 1e-15, "{source}");
    }
}

#[test]
fn every_function_equals_its_namesake() {
    let x = 0.6_f64;
    let table = [
        ("sin(x)", x.sin()),
        ("cos(x)", x.cos()),
        ("tan(x)", x.tan()),
        ("exp(x)", x.exp()),
        ("ln(x)", x.ln()),
        ("sqrt(x)", x.sqrt()),
        ("abs(-x)", x),
        ("sgn(-x)", -1.0),
        ("sgn(x - x)", 0.0),
        ("tanh(x)", x.tanh()),
        ("erf(x)", 0.603_856_090_847_925_9), // scipy.special.erf(0.6)
    ];
    for (source, expected) in table {
        assert!((at(source, x) - expected).abs() < 2e-16, "{source}");
    }
}

#[test]
fn dual_numbers_give_the_derivatives_of_a_friction_law() {
    let law = parse("-c*exp(-(w/ws)^2)*tanh(w/0.1)").unwrap().bind(&["w", "c", "ws"]).unwrap();
    let point = [0.3, 0.02, 0.8];
    let slots = [0, 1, 2].map(|i| Dual::<3>::variable(point[i], i));
    let exact = law.evaluate(&slots);
    assert_eq!(exact.value, law.evaluate(&point));
    for i in 0..3 {
        let shifted = |h: f64| {
            let mut p = point;
            p[i] += h;
            law.evaluate(&p)
        };
        let difference = (shifted(1e-6) - shifted(-1e-6)) / 2e-6;
        // central differences: rounding 1e-17/1e-6
        assert!((exact.partial[i] - difference).abs() < 1e-10, "{i}");
    }
}

#[test]
fn powers_have_their_derivatives_at_zero_and_below() {
    let slope = |source: &str, x: f64| {
        let bound = parse(source).unwrap().bind(&["x"]).unwrap();
        bound.evaluate(&[Dual::<1>::variable(x, 0)]).partial[0]
    };
    assert_eq!(slope("x^0", 0.0), 0.0);
    assert_eq!(slope("x^1", 0.0), 1.0);
    assert_eq!(slope("x^2", -3.0), -6.0);
    assert_eq!(slope("x^3", -2.0), 12.0);
    assert!((slope("2^x", 3.0) - 8.0 * 2.0_f64.ln()).abs() < 1e-14);
    assert!((slope("x^x", 2.0) - 4.0 * (1.0 + 2.0_f64.ln())).abs() < 1e-14);
    assert!(at("x^0.5", -1.0).is_nan());
}

#[test]
fn variables_are_listed_once_and_bound_by_name() {
    let formula = parse("b*a + b*w1").unwrap();
    assert_eq!(formula.variables(), ["b", "a", "w1"]);
    assert_eq!(formula.to_string(), "b*a + b*w1");
    let bound = formula.bind(&["unused", "w1", "a", "b"]).unwrap();
    assert_eq!(bound.evaluate(&[9.0, 2.0, 3.0, 5.0]), 25.0);
}

#[test]
fn errors_point_at_the_bytes_and_name_a_remedy() {
    let table = [
        ("1 + tahn(w)", 4..8, "byte 4: unknown function `tahn`, did you mean `tanh`?"),
        (
            "",
            0..0,
            "byte 0: found the end of the formula, expected a number, a name, a sign or `(`",
        ),
        ("2 x", 2..3, "byte 2: found `x`, expected an operator or the end"),
        ("(1 + 2", 6..6, "byte 6: found the end of the formula, expected `)` or an operator"),
        ("1 $ 2", 2..3, "byte 2: `$` has no meaning in a formula; remove it"),
        ("min(1)", 0..3, "byte 0: `min` got 1 arguments, takes 2"),
        ("sin()", 0..3, "byte 0: `sin` got 0 arguments, takes 1"),
        ("1e999", 0..5, "byte 0: the number `1e999` is too large for double precision"),
        ("sin x", 4..5, "byte 4: found `x`, expected `(` after the name of a function"),
        ("3 * .", 4..5, "byte 4: `.` has no meaning in a formula; remove it"),
        ("w * ω", 4..6, "byte 4: `ω` has no meaning in a formula; remove it"),
    ];
    for (source, span, message) in table {
        let error = parse(source).unwrap_err();
        assert_eq!((error.span(), error.to_string().as_str()), (span, message), "{source}");
    }
    let unbound = parse("c*omga").unwrap().bind(&["c", "omega"]).unwrap_err();
    assert_eq!(unbound.to_string(), "byte 2: unknown variable `omga`, did you mean `omega`?");
    let strange = parse("zzz").unwrap().bind(&["a1", "w"]).unwrap_err();
    assert_eq!(strange.to_string(), "byte 0: unknown variable `zzz`; known are a1, w");
}

#[test]
fn hostile_depth_and_length_are_refused_and_long_sums_are_not() {
    for opening in ["(", "-", "sin(", "1^", "min(1,"] {
        let error = parse(&opening.repeat(500)).unwrap_err();
        assert!(matches!(error, ExpressionError::TooDeep { .. }), "{opening}: {error}");
    }
    assert!(matches!(parse(&"1+".repeat(3000)), Err(ExpressionError::TooLong { .. })));
    let sum = format!("{}x", "x+".repeat(2000));
    assert_eq!(at(&sum, 0.5), 1000.5);
}

#[test]
fn the_deepest_formula_that_is_accepted_can_be_evaluated() {
    let depth = MAX_DEPTH - 1;
    let nested = format!("{}x{}", "x+x*x^min(x,".repeat(depth / 4), ")".repeat(depth / 4));
    assert!(at(&nested, 1.0).is_finite());
    let powers = format!("{}x", "x^".repeat(depth));
    assert_eq!(at(&powers, 1.0), 1.0);
}

/// Pieces of formulas in any order: most are wrong, some are deep, a few are right.
fn pieces() -> impl Strategy<Value = String> {
    let piece = prop::sample::select(vec![
        "x", "y", "1", "2.5", "(", ")", "+", "-", "*", "/", "^", ",", "sin(", "min(", "pi", " ",
        "1e", ".", "é",
    ]);
    prop::collection::vec(piece, 0..60).prop_map(|p| p.concat())
}

proptest! {
    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = parse(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn random_pieces_never_panic_and_errors_stay_inside(source in pieces()) {
        match parse(&source) {
            Ok(formula) => {
                let names = formula.variables();
                let bound = formula.bind(&names).unwrap();
                prop_assert!(stack_height(&bound.ops) <= MAX_DEPTH + 1);
                let _: f64 = bound.evaluate(&vec![0.3; names.len()]);
            }
            Err(error) => prop_assert!(source.get(error.span()).is_some()),
        }
    }

    #[test]
    fn sums_and_products_equal_the_arithmetic_of_rust(
        a in -9.0..9.0_f64, b in -9.0..9.0_f64, c in 0.1..9.0_f64
    ) {
        let bound = parse("a - b*c + a/c - (b - c)*-a").unwrap().bind(&["a", "b", "c"]).unwrap();
        prop_assert_eq!(bound.evaluate(&[a, b, c]), a - b * c + a / c - (b - c) * -a);
    }
}
