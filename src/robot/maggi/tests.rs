//! The derivation against the closed form, over random states and construction data.

use super::*;
use crate::robot::{Robot, kinematics};
use proptest::prelude::*;

/// Construction data over two decades in size around the AmigoBot's; S may be ahead of the axle.
fn constructions() -> impl Strategy<Value = Construction> {
    let base = Construction::amigobot();
    (prop::array::uniform9(-1.0..1.0_f64), -0.2..0.2_f64).prop_map(move |(u, l2_m)| {
        let k = u.map(|u| 10f64.powf(u));
        let m1_kg = base.m1_kg * k[2];
        Construction {
            l1_m: base.l1_m * k[0],
            l2_m,
            r_m: base.r_m * k[1],
            m1_kg,
            m2_kg: m1_kg,
            m4_kg: base.m4_kg * k[3],
            ix1_kg_m2: base.ix1_kg_m2 * k[4],
            iz1_kg_m2: base.iz1_kg_m2 * k[5],
            iz4_kg_m2: base.iz4_kg_m2 * k[6],
            n1_n: base.n1_n * k[7],
            n2_n: base.n2_n * k[8],
            ..base.clone()
        }
    })
}

fn states() -> impl Strategy<Value = State> {
    prop::array::uniform4(-30.0..30.0_f64)
        .prop_map(|[a1, a2, w1, w2]| State { alpha: [a1, a2], omega: [w1, w2] })
}

fn five(size: f64) -> impl Strategy<Value = [f64; 5]> {
    prop::array::uniform5(-size..size)
}

/// Size of the terms that are added in the equations of one wheel, for the rounding bounds.
fn size_of_terms(c: &Construction, motion: &Motion) -> f64 {
    let [_, _, turn_rate, ..] = motion.q_dot;
    let fastest = motion.q_dot.iter().fold(1.0_f64, |m, v| m.max(v.abs())) + 1.0;
    let largest = motion.q_ddot.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
    let lengths = 1.0 + c.l1_m + c.l2_m.abs();
    let inertia = (2.0 * c.m1_kg + c.m4_kg) * lengths * lengths
        + 2.0 * c.ix1_kg_m2
        + c.iz4_kg_m2
        + c.iz1_kg_m2;
    let arms = 1.0 + c.r_m + c.r_m / c.l1_m;
    inertia * arms * (largest + fastest * (1.0 + turn_rate.abs()) + fastest * fastest)
        + c.n1_n
        + c.n2_n
}

proptest! {
    #[test]
    fn the_maggi_equations_give_eq_14_with_the_parameters_of_eq_15(
        c in constructions(), state in states(),
        dw in prop::array::uniform2(-50.0..50.0_f64), offset in -4.0..4.0_f64,
    ) {
        let a = c.parameters();
        let closed = a.inverse(&state, dw);
        let derived = inverse(&c, &state, dw, offset, [ContactForce::default(); 2]);
        let size = a.a1 * (dw[0].abs() + dw[1].abs()) + a.a3.abs() * 900.0 + a.a4 + a.a5;
        for i in 0..2 {
            // of 20 000 draws the median is 4e-16 and the largest 2e-12: where l2 is much larger
            // than l1, terms of the forces on the frame cancel before they reach the wheels
            prop_assert!((derived[i] - closed[i]).abs() <= 1e-11 * size, "{derived:?} {closed:?}");
        }
    }

    #[test]
    fn the_forces_between_wheel_and_floor_drop_out(
        c in constructions(), beta in -4.0..4.0_f64, t in prop::array::uniform4(-100.0..100.0_f64),
    ) {
        let contact = [
            ContactForce { along: t[0], across: t[1] },
            ContactForce { along: t[2], across: t[3] },
        ];
        let q = generalised_forces(&c, beta, [0.0; 2], [0.0; 2], contact);
        let left = maggi_coefficients(&c, beta) * q;
        // forces up to 100 N on arms of r, eight terms
        prop_assert!(left.abs().max() <= 1e-15 * 400.0 * 4.0 * c.r_m, "{left:?}");
    }

    #[test]
    fn the_matrices_8_and_9_follow_from_the_kinetic_energy(
        c in constructions(), q in five(4.0), q_dot in five(10.0), q_ddot in five(50.0),
    ) {
        let from_energy = lagrange_terms(&c, q, q_dot, q_ddot);
        let printed = inertia_matrix(&c, q[2]) * Vector5::from(q_ddot)
            + coriolis_matrix(&c, q[2], q_dot[2]) * Vector5::from(q_dot);
        let size = size_of_terms(&c, &Motion { q, q_dot, q_ddot });
        prop_assert!((from_energy - printed).abs().max() <= 1e-14 * size);
    }

    #[test]
    fn the_energy_is_half_the_quadratic_form_of_eq_8_and_that_of_the_wheels_alone(
        c in constructions(), state in states(), offset in -4.0..4.0_f64, q_dot in five(10.0),
    ) {
        let beta = offset;
        let free = kinetic_energy(&c, [0.0, 0.0, beta, 0.0, 0.0], q_dot);
        let v = Vector5::from(q_dot);
        let form = 0.5 * v.dot(&(inertia_matrix(&c, beta) * v));
        // terms cancel in the form, none in the sum of squares; 30 terms of the form's size
        let size = 0.5 * v.abs().dot(&(inertia_matrix(&c, beta).abs() * v.abs()));
        prop_assert!((free - form).abs() <= 1e-14 * size);

        let motion = Motion::rolling(&c, &state, [0.0; 2], offset);
        let rolling = kinetic_energy(&c, motion.q, motion.q_dot);
        let closed = c.parameters().kinetic_energy(state.omega);
        prop_assert!((rolling - closed).abs() <= 1e-13 * (rolling + closed));
    }

    #[test]
    fn the_coefficients_give_the_velocities_of_eq_11_and_no_side_slip(
        c in constructions(), state in states(), offset in -4.0..4.0_f64,
    ) {
        let robot = Robot::new("", c.clone()).unwrap();
        let motion = Motion::rolling(&c, &state, [0.0; 2], offset);
        let v = kinematics::forward_speed(&robot, state.omega);
        let (sin, cos) = motion.q[2].sin_cos();
        // products of numbers up to 15 m/s
        prop_assert!((motion.q_dot[0] - v * cos).abs() < 1e-14);
        prop_assert!((motion.q_dot[1] - v * sin).abs() < 1e-14);
        let turn_rate = kinematics::turn_rate(&robot, state.omega);
        prop_assert!((motion.q_dot[2] - turn_rate).abs() <= 1e-15 * (1.0 + 30.0 * c.r_m / c.l1_m));
        prop_assert_eq!([motion.q_dot[3], motion.q_dot[4]], state.omega);
    }
}

#[test]
fn the_rate_of_the_coefficients_equals_a_central_difference() {
    let c = Construction::amigobot();
    let (beta, beta_dot, h) = (0.7, 1.3, 1e-6);
    let ahead = maggi_coefficients(&c, beta + h * beta_dot);
    let behind = maggi_coefficients(&c, beta - h * beta_dot);
    let difference = (ahead - behind) / (2.0 * h);
    // truncation h² ~ 1e-12, rounding of entries of size r: 0.05 eps / h ~ 1e-11
    assert!((maggi_coefficients_rate(&c, beta, beta_dot) - difference).abs().max() < 1e-10);
}

#[test]
fn a_wrong_sign_of_the_mass_behind_the_axle_is_noticed() {
    // the test of the tests: with S ahead instead of behind, the derivation must disagree
    let behind = Construction::amigobot();
    let ahead = Construction { l2_m: -behind.l2_m, ..behind.clone() };
    let state = State { alpha: [0.0; 2], omega: [6.0, 2.0] };
    let derived = inverse(&behind, &state, [0.0; 2], 0.0, [ContactForce::default(); 2]);
    let closed = ahead.parameters().inverse(&state, [0.0; 2]);
    // 2 a3 w2 (w1 - w2) = 2 · 2.93e-4 · 2 · 4 = 4.7e-3
    assert!((derived[0] - closed[0]).abs() > 4e-3);
}
