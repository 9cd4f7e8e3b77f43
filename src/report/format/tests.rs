use super::*;

#[test]
fn digits_keep_their_zeros_and_sentences_are_set_as_in_print() {
    assert_eq!(digits(0.0, 3), "0");
    assert_eq!(digits(9.996, 3), "10.0");
    assert_eq!(digits(1.2e-7, 3), "1.20 × 10⁻⁷");
    assert_eq!(digits(f64::NAN, 3), "–");
    assert_eq!(
        sentence("Noise: 4.985e-4 white, -1e2; 3 rad^2/s (the e-th, 2e)"),
        "Noise: 4.985 × 10⁻⁴ white, −100; 3 rad²/s (the e-th, 2e)"
    );
    assert_eq!(unit("kg m^2"), "kg m²");
}

#[test]
fn numbers_keep_their_significant_digits() {
    assert_eq!(number(0.0), "0");
    assert_eq!(number(-0.0), "0");
    assert_eq!(number(3.0), "3");
    assert_eq!(number(1234.56), "1235");
    assert_eq!(number(12_345.6), "12346");
    assert_eq!(number(123_456.0), "1.235 × 10⁵");
    assert_eq!(number(0.001), "0.001");
    assert_eq!(number(0.000_999_96), "0.001");
    assert_eq!(number(9.999_6), "10");
    assert_eq!(number(-1.5e-300), "−1.5 × 10⁻³⁰⁰");
    assert_eq!(number(f64::INFINITY), "∞");
    assert_eq!(number(f64::NEG_INFINITY), "−∞");
    assert_eq!(scientific(1.234e-4, 3), "1.23 × 10⁻⁴");
}

#[test]
fn an_estimate_is_written_to_the_digits_of_its_error() {
    assert_eq!(estimate(12.345, 0.67), "12.35 ± 0.67");
    assert_eq!(estimate(12.345, 1.7), "12.3 ± 1.7");
    assert_eq!(estimate(1234.5, 170.0), "1234 ± 170");
    assert_eq!(estimate(-0.000_1, 0.02), "0.000 ± 0.020");
    assert_eq!(estimate(0.5, 0.0996), "0.50 ± 0.10");
    assert_eq!(estimate(2.0e6, 1.0e4), "(2.000 ± 0.010) × 10⁶");
    assert_eq!(estimate(1e-300, 1e-301), "(1.00 ± 0.10) × 10⁻³⁰⁰");
    assert_eq!(estimate(1.0, 1e-9), "1.0000000000 ± 0.0000000010");
    assert_eq!(estimate(0.0, 0.5), "0.00 ± 0.50");
    assert_eq!(estimate(0.25, 0.0), "0.25");
}

#[test]
fn what_the_data_do_not_determine_is_stated_in_words() {
    assert_eq!(estimate(f64::NAN, 1.0), "–");
    assert_eq!(estimate(1.234, f64::NAN), "1.2");
    assert_eq!(estimate(f64::INFINITY, 1.0), "not identifiable");
}

#[test]
fn p_values_never_claim_more_than_nine_zeros() {
    assert_eq!(p_value(0.0), "p < 10⁻⁹");
    assert_eq!(p_value(3.21e-5), "p = 3.2 × 10⁻⁵");
    assert_eq!(p_value(0.049), "p = 0.049");
    assert_eq!(p_value(0.0999), "p = 0.10");
    assert_eq!(p_value(0.5), "p = 0.50");
    assert_eq!(p_value(1.0), "p = 1.00");
    assert_eq!(p_value(f64::NAN), "p = –");
    assert_eq!(p_value(1.5), "p = –");
}

#[test]
fn units_prefixes_and_counts() {
    assert_eq!(with_unit(0.5, "kg m²"), "0.5 kg m²");
    assert_eq!(with_unit(f64::NAN, "m"), "–");
    assert_eq!(percent(0.01234), "1.2 %");
    assert_eq!(percent(0.9999), "100 %");
    assert_eq!(percent(-1.5), "−150 %");
    assert_eq!(percent(8.5e-7), "< 0.01 %");
    assert_eq!(count(1234), "1234");
    assert_eq!(count(1_234_567), "1\u{2009}234\u{2009}567");
    assert_eq!(fixed(-0.001, 2), "0.00");
    assert_eq!(superscript(-120), "⁻¹²⁰");
}

#[test]
fn an_interval_has_the_power_of_its_estimate_and_the_digits_in_which_its_ends_differ() {
    assert_eq!(interval((0.031_871, 0.031_912), 0.0319, 1e-5), "[0.031871, 0.031912]");
    assert_eq!(interval((-1.0, 3.0), 1.0, 1.0), "[−1.0, 3.0]");
    assert_eq!(interval((-6.44e-3, -3.81e-6), -3.2e-3, 1.6e-3), "[−0.00644, 0.00000]");
    assert_eq!(interval((0.1245, 0.125_23), 0.1249, 2e-4), "[0.12450, 0.12523]");
    // an end with one digit more than the value
    assert_eq!(estimate(8.7e-5, 2.1e-5), "(8.7 ± 2.1) × 10⁻⁵");
    assert_eq!(interval((4.6e-5, 1.28e-4), 8.7e-5, 2.1e-5), "[4.6, 12.8] × 10⁻⁵");
    assert_eq!(interval((0.0, 0.0), 0.0, 0.0), "[0, 0]");
}
