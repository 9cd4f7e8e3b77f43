//! The mirror image of an effect, of which no effect states anything: it is sought among the effects with as many
//! parameters, in every order and with every sign.

use super::*;

/// Terms and acting input of an effect at some motions, of the robot and as seen in a mirror.
struct Seen {
    robot: Vec<f64>,
    image: Vec<f64>,
}

fn swap<T: Copy>(v: [T; 2]) -> [T; 2] {
    [v[1], v[0]]
}

/// What `effect` at `p` and `other` at `q` on the mirrored robot do, in the coordinates of the robot.
fn seen(effect: &dyn Effect, p: &[f64], other: &dyn Effect, q: &[f64]) -> Seen {
    let robot = Robot::amigobot();
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let (t, m) = recorded(&mut rng);
    let acting = |effect: &dyn Effect, m: &[[f64; 2]], p: &[f64]| {
        effect.input(&t, m, p).unwrap_or_else(|| m.to_vec())
    };
    let (mut here, mut there) = (vec![], vec![]);
    for _ in 0..20 {
        let x = motion(&robot, &mut rng);
        let [a, b, c, d] = x.variance;
        let image =
            Motion { alpha: swap(x.alpha), omega: swap(x.omega), variance: [b, a, d, c], ..x };
        here.extend(flat(&effect.terms(&x, p)));
        let Terms { mass: [m11, m12, m22], torque, level: [l1, l2, l3, l4] } =
            other.terms(&image, q);
        let back = Terms { mass: [m22, m12, m11], torque: swap(torque), level: [l2, l1, l3, l4] };
        there.extend(flat(&back));
    }
    let image: Vec<_> = m.iter().map(|row| swap(*row)).collect();
    here.extend(acting(effect, &m, p).into_iter().flatten());
    there.extend(acting(other, &image, q).into_iter().flat_map(swap));
    Seen { robot: here, image: there }
}

/// Every order of `count` places with every combination of signs, the plain one first.
fn signed_orders(count: usize) -> Vec<Vec<(usize, f64)>> {
    let mut orders: Vec<Vec<(usize, f64)>> = vec![vec![]];
    for _ in 0..count {
        let longer = |order: &Vec<(usize, f64)>| -> Vec<Vec<(usize, f64)>> {
            let free = (0..count).filter(|j| order.iter().all(|(taken, _)| taken != j));
            let next = free.flat_map(|j| [(j, 1.0), (j, -1.0)]);
            next.map(|place| order.iter().copied().chain([place]).collect()).collect()
        };
        orders = orders.iter().flat_map(longer).collect();
    }
    orders
}

/// Whether an effect changes wheel 1 alone: of a gain of both wheels only the ratio is identifiable.
fn is_of_wheel_1(effect: &dyn Effect, p: &[f64]) -> bool {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    let (t, m) = recorded(&mut rng);
    let robot = Robot::amigobot();
    let terms = effect.terms(&motion(&robot, &mut rng), p);
    let acting = effect.input(&t, &m, p);
    let is_unchanged = |acting: Vec<[f64; 2]>| acting.iter().zip(&m).all(|(a, m)| a[1] == m[1]);
    flat(&terms).iter().all(|v| *v == 0.0) && acting.is_some_and(is_unchanged)
}

/// The mirror image of a parameter is a parameter, of either sign: an angle changes its sign, a pair of wheels its
/// order.
#[test]
fn the_mirror_image_of_the_robot_has_the_mirror_image_of_the_effect() {
    each(1, |effect, id, _, rng| {
        let draws: Vec<Vec<f64>> = (0..5).map(|_| parameters(effect, rng)).collect();
        let specs = effect.parameters();
        let of = |order: &[(usize, f64)], p: &[f64]| -> Vec<f64> {
            order.iter().map(|(j, sign)| sign * p[*j]).collect()
        };
        let is_allowed = |q: &[f64]| {
            q.iter().zip(&specs).all(|(q, spec)| {
                spec.kind == ParameterKind::Linear || (spec.range.0..=spec.range.1).contains(q)
            })
        };
        let is_image = |other: &dyn Effect, order: &[(usize, f64)]| {
            draws.iter().all(|p| {
                let q = of(order, p);
                is_allowed(&q) && {
                    let Seen { robot, image } = seen(effect, p, other, &q);
                    // rounding
                    robot.iter().zip(&image).all(|(u, v)| (u - v).abs() <= 1e-13 * (1e-3 + u.abs()))
                }
            })
        };
        let orders = signed_orders(specs.len());
        let mut others = all();
        others.retain(|other| other.parameters().len() == specs.len());
        others.sort_by_key(|other| other.id() != id);
        let found =
            others.iter().any(|other| orders.iter().any(|order| is_image(other.as_ref(), order)));
        assert!(found || is_of_wheel_1(effect, &draws[0]), "{id} has no mirror image");
    });
}
