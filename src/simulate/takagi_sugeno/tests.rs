use super::*;

fn system(consequents: Consequents, defuzzification: Defuzzification) -> TakagiSugeno {
    let range = [(-2.0, 5.0), (0.0, 4.0)];
    let mut system = TakagiSugeno::uniform(4, range, consequents, defuzzification);
    let p: Vec<f64> = (0..system.parameters().len()).map(|k| (k as f64).sin()).collect();
    system.set_parameters(&p);
    system
}

fn all() -> impl Iterator<Item = TakagiSugeno> {
    [Consequents::Constant, Consequents::Affine].into_iter().flat_map(|c| {
        [Defuzzification::WeightedAverage, Defuzzification::WeightedSum].map(|d| system(c, d))
    })
}

#[test]
fn the_papers_system_is_the_weighted_average_written_out() {
    let mut system = TakagiSugeno::uniform(
        6,
        [(0.0, 30.0); 2],
        Consequents::Constant,
        Defuzzification::WeightedAverage,
    );
    let p: Vec<f64> = (0..72).map(|k| f64::from(k % 7) - 3.0).collect();
    system.set_parameters(&p);
    let w = [7.3, 21.9];
    let (mut above, mut below) = ([0.0; 2], 0.0);
    for i in 0..6 {
        for j in 0..6 {
            // centres 0, 6, ..., 30; width 6 / 2.3548
            let s = 6.0 / 2.354_820_045_030_949;
            let mu = |x: f64, c: usize| (-(x - 6.0 * c as f64).powi(2) / (2.0 * s * s)).exp();
            let h = mu(w[0], i) * mu(w[1], j);
            below += h;
            above[0] += h * p[i * 6 + j];
            above[1] += h * p[36 + i * 6 + j];
        }
    }
    let out = system.output(&w);
    // rounding of 36 terms of size 3
    assert!((out[0] - above[0] / below).abs() < 1e-13);
    assert!((out[1] - above[1] / below).abs() < 1e-13);
    assert!((system.firing(&w).iter().sum::<f64>() - 1.0).abs() < 1e-14);
}

#[test]
fn the_output_is_the_basis_times_the_consequents() {
    for system in all() {
        let n = system.parameters().len() / 2;
        let mut basis = vec![0.0; n];
        system.basis(&[1.3, 2.2], &mut basis);
        let out = system.output(&[1.3, 2.2]);
        for o in 0..2 {
            let dot: f64 =
                basis.iter().zip(&system.parameters()[o * n..]).map(|(b, p)| b * p).sum();
            assert!((dot - out[o]).abs() < 1e-14);
        }
    }
}

#[test]
fn gradients_to_speeds_centres_and_widths_equal_differences() {
    let h = 1e-6;
    for system in all() {
        for w in [[1.3, 2.2], [-1.1, 3.9], [4.0, -1.0]] {
            let (_, gradient) = system.output_and_gradient(&w);
            for input in 0..2 {
                let (mut up, mut down) = (w, w);
                up[input] += h;
                down[input] -= h;
                let (up, down) = (system.output(&up), system.output(&down));
                for o in 0..2 {
                    // rounding 1e-16 / h and truncation h²
                    let slope = (up[o] - down[o]) / (2.0 * h);
                    assert!((slope - gradient[o][input]).abs() < 1e-8, "{w:?}");
                }
            }
            let premises = system.premises();
            for (k, exact) in system.premise_gradient(&w).iter().enumerate() {
                let at = |h: f64| {
                    let mut moved = system.clone();
                    let mut p = premises.clone();
                    p[k] += h;
                    moved.set_premises(&p);
                    moved.output(&w)
                };
                let (up, down) = (at(h), at(-h));
                for o in 0..2 {
                    let slope = (up[o] - down[o]) / (2.0 * h);
                    assert!((slope - exact[o]).abs() < 1e-8, "{k} {slope} {exact:?}");
                }
            }
        }
    }
}

#[test]
fn outside_the_range_the_output_is_that_of_the_edge() {
    for system in all() {
        assert_eq!(system.output(&[-2.0, 4.0]), system.output(&[-30.0, 90.0]));
        assert_eq!(system.output_and_gradient(&[-30.0, 90.0]).1, [[0.0; 2]; 2]);
    }
}
