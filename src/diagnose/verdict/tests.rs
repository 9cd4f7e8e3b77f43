//! Conclusions from errors, structure and likely effects.

use super::*;
use crate::compare::CurveBin;

fn left(log_significance: f64, size: f64) -> UnexplainedTorque {
    UnexplainedTorque {
        dependences: vec![Dependence {
            variable: Variable::Heading,
            bins: vec![],
            statistic: 0.0,
            rank: 1,
            log_significance,
            size,
        }],
    }
}

fn errors(before: f64, after: f64) -> Errors {
    Errors { before, after, floor: 1.0, most: 1.0, uncertain: 0.0, slow_floor: false, speed: 1e4 }
}

#[test]
fn recordings_of_steady_speeds_that_a_flywheel_predicts_as_well_prove_nothing() {
    // the floor is 1 and the top speed 100: constant speeds are useful up to an error of 5
    let after = |error: f64| errors(9.0, error);
    assert!(after(10.0).are_of_steady_speeds(16.0));
    // the model removes more than half of 16 - 1, or nothing is steady
    assert!(!after(8.0).are_of_steady_speeds(16.0));
    assert!(!after(20.0).are_of_steady_speeds(25.1));
    // of constant speeds at the floor a model has nothing to remove
    assert!(after(1.01).are_of_steady_speeds(1.0));
    assert!(after(f64::NAN).are_of_steady_speeds(16.0));
}

#[test]
fn structure_is_a_dependence_on_the_state_and_not_on_time_or_input() {
    let curve = |variable, acting, log_significance| Curve {
        variable,
        acting,
        bins: vec![],
        share_before: 0.3,
        share_after: None,
        log_significance,
    };
    assert!(structured(&[curve(Variable::Heading, Acting::Torque, 40.0)]));
    assert!(structured(&[curve(Variable::Time, Acting::Gain, 40.0)]));
    for (variable, acting, log_significance) in [
        (Variable::Heading, Acting::Torque, 9.0),
        (Variable::Time, Acting::Torque, 400.0),
        (Variable::Input1, Acting::Torque, 400.0),
        (Variable::Acceleration2, Acting::Torque, 400.0),
    ] {
        assert!(!structured(&[curve(variable, acting, log_significance)]), "{variable:?}");
    }
}

#[test]
fn structure_by_blocks_is_that_of_the_robot() {
    let mean = |value| crate::compare::Mean { value, std_error: 0.1, blocks: 30 };
    let bin = |value| CurveBin { at: 0.0, joined: true, before: [mean(value); 2], after: None };
    let curve = |variable| Curve {
        variable,
        acting: Acting::Torque,
        bins: vec![bin(0.5), bin(-0.5)],
        share_before: 0.3,
        share_after: None,
        log_significance: 0.0,
    };
    let all = [Variable::Time, Variable::Input1, Variable::Omega2].map(curve);
    assert_eq!(structured_by_blocks(&all), Some(Variable::Omega2));
    assert_eq!(structured_by_blocks(&all[..2]), None);
}

#[test]
fn structure_is_significant() {
    assert!(structure(&left(40.0, 0.001)).is_some());
    assert!(structure(&left(5.0, 0.02)).is_none());
    let mut of_input = left(40.0, 0.001);
    of_input.dependences[0].variable = Variable::Input1;
    assert!(structure(&of_input).is_none());
}

#[test]
fn a_model_at_the_floor_is_sufficient() {
    assert_eq!(conclude(0, &errors(1.01, 1.01), None, true), Conclusion::Sufficient);
    assert_eq!(errors(1.01, 1.01).unexplained(), 0.0);
}

#[test]
fn what_the_input_may_do_between_its_rows_is_no_missing_effect() {
    let open = Errors { most: 3.5, ..errors(4.0, 4.0) };
    assert_eq!(conclude(0, &open, None, true), Conclusion::Sufficient);
    assert_eq!(conclude(0, &Errors { most: 2.0, ..open }, None, true), Conclusion::Unknown);
    let open = Errors { uncertain: 2.5, ..errors(4.0, 4.0) };
    assert_eq!(conclude(0, &open, None, true), Conclusion::Sufficient);
    assert_eq!(conclude(1, &open, None, true), Conclusion::Missing);
    assert_eq!(conclude(0, &Errors { after: 6.0, ..open }, None, true), Conclusion::Unknown);
}

#[test]
fn an_error_above_the_floor_that_nothing_explains_is_unknown() {
    assert_eq!(conclude(0, &errors(4.0, 4.0), None, true), Conclusion::Unknown);
    assert_eq!(conclude(1, &errors(4.0, 3.0), None, true), Conclusion::Unknown);
    assert_eq!(conclude(1, &errors(4.0, 1.1), None, true), Conclusion::Missing);
    // an effect that would leave a quarter of the squared error is likely, one that leaves most is not
    assert_eq!(conclude(0, &errors(4.0, 4.0), Some(0.5), true), Conclusion::Likely);
    assert_eq!(conclude(0, &errors(4.0, 4.0), Some(0.95), true), Conclusion::Unknown);
    assert!((errors(4.0, 1.1).unexplained() - 0.1 / 3.0).abs() < 1e-12);
}

#[test]
fn effects_that_leave_a_poor_model_are_not_all_that_is_missing() {
    let slow = Errors { speed: 100.0, ..errors(4.0, 1.2) };
    assert_eq!(conclude(1, &slow, None, true), Conclusion::Missing);
    // 30 of 48 floors and a fifth of the top speed are left
    let poor = Errors { before: 2300.0, after: 900.0, speed: 2e4, ..slow };
    assert_eq!(conclude(3, &poor, None, true), Conclusion::Unknown);
    assert_eq!(conclude(3, &Errors { speed: 1e6, ..poor }, None, true), Conclusion::Missing);
}

#[test]
fn an_error_without_structure_is_unknown_only_far_above_the_floor() {
    assert_eq!(conclude(0, &errors(4.0, 4.0), None, false), Conclusion::Sufficient);
    assert_eq!(conclude(0, &errors(16.0, 16.0), None, false), Conclusion::Unknown);
}

#[test]
fn under_slow_noise_of_the_input_structure_is_no_evidence() {
    let slow = Errors { slow_floor: true, ..errors(4.0, 4.0) };
    assert_eq!(conclude(0, &slow, None, true), Conclusion::Sufficient);
    assert_eq!(conclude(0, &Errors { slow_floor: false, ..slow }, None, true), Conclusion::Unknown);
    assert_eq!(conclude(0, &Errors { after: 16.0, ..slow }, None, true), Conclusion::Unknown);
}

#[test]
fn an_error_that_is_small_beside_the_speed_does_not_matter() {
    let fast = Errors { speed: 1e6, ..errors(4.0, 4.0) };
    assert_eq!(conclude(0, &fast, None, true), Conclusion::Sufficient);
}

#[test]
fn an_error_that_is_no_number_is_never_sufficient() {
    let broken = errors(f64::NAN, f64::NAN);
    assert_eq!(conclude(0, &broken, None, true), Conclusion::Unknown);
}
