//! A recorded formula: evaluation and analysis of its dependences.

use super::expression::{Binary, Unary};

/// One operation of a [`Formula`]; operands are numbers of earlier nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Node {
    /// A number.
    Constant(f64),
    /// Input number k.
    Input(usize),
    /// A function of one node.
    Unary(Unary, usize),
    /// An operator or function of two nodes.
    Binary(Binary, usize, usize),
}

/// A recorded formula: operations in the order in which they were done, each one once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Formula {
    /// The operations; operands stand before what uses them.
    pub nodes: Vec<Node>,
    /// The nodes that are results.
    pub outputs: Vec<usize>,
    /// Whether a value was read while recording (by a branch, or a function without a node), so that the
    /// formula may be valid only at the recorded place.
    pub read: bool,
}

impl Formula {
    /// The results at other inputs.
    ///
    /// # Panics
    /// If there are fewer inputs than were recorded.
    #[must_use]
    pub fn evaluate(&self, inputs: &[f64]) -> Vec<f64> {
        let mut values: Vec<f64> = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            values.push(match *node {
                Node::Constant(value) => value,
                Node::Input(k) => inputs[k],
                Node::Unary(function, a) => function.apply(values[a]),
                Node::Binary(function, a, b) => function.apply(values[a], values[b]),
            });
        }
        self.outputs.iter().map(|&k| values[k]).collect()
    }

    /// How often each node is used: by nodes that the results depend on, and as a result.
    #[must_use]
    pub fn uses(&self) -> Vec<usize> {
        let mut uses = vec![0; self.nodes.len()];
        self.outputs.iter().for_each(|&k| uses[k] += 1);
        for k in (0..self.nodes.len()).rev() {
            if uses[k] == 0 {
                continue;
            }
            match self.nodes[k] {
                Node::Constant(_) | Node::Input(_) => {}
                Node::Unary(_, a) => uses[a] += 1,
                Node::Binary(_, a, b) => {
                    uses[a] += 1;
                    uses[b] += 1;
                }
            }
        }
        uses
    }

    /// Whether every result is the constant zero.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        self.outputs.iter().all(|&k| self.nodes[k] == Node::Constant(0.0))
    }

    /// The largest degree of the results as polynomials of the inputs in `of`; `None` if one of them is not a
    /// polynomial.
    #[must_use]
    pub fn degree(&self, of: std::ops::Range<usize>) -> Option<usize> {
        let mut degrees: Vec<Option<usize>> = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            degrees.push(match *node {
                Node::Constant(_) => Some(0),
                Node::Input(k) => Some(usize::from(of.contains(&k))),
                Node::Unary(Unary::Negate, a) => degrees[a],
                Node::Unary(_, a) => degrees[a].filter(|degree| *degree == 0),
                Node::Binary(operator, a, b) => match (operator, degrees[a], degrees[b]) {
                    (Binary::Add | Binary::Subtract, Some(a), Some(b)) => Some(a.max(b)),
                    (Binary::Multiply, Some(a), Some(b)) => Some(a + b),
                    (Binary::Divide, Some(a), Some(0)) => Some(a),
                    (_, Some(0), Some(0)) => Some(0),
                    _ => None,
                },
            });
        }
        self.outputs.iter().try_fold(0, |most, &k| Some(most.max(degrees[k]?)))
    }

    /// Whether a result depends on input number `input`.
    #[must_use]
    pub fn depends_on(&self, input: usize) -> bool {
        let uses = self.uses();
        (0..self.nodes.len()).any(|k| self.nodes[k] == Node::Input(input) && uses[k] > 0)
    }
}

#[cfg(test)]
mod tests {
    use crate::math::{Real, Symbol, record};

    #[test]
    fn the_degree_is_that_of_the_polynomial_in_the_inputs_asked_for() {
        let degree = |f: fn(&[Symbol]) -> Symbol| record(&[0.3, 0.7], |x| vec![f(x)]).degree(0..1);
        assert_eq!(degree(|x| x[1].sin()), Some(0));
        assert_eq!(degree(|x| x[0] * x[1].exp() / x[1] - x[0]), Some(1));
        assert_eq!(degree(|x| -x[0].squared() * x[1]), Some(2));
        assert_eq!(degree(|x| x[0].squared() * x[0] + x[1]), Some(3));
        assert_eq!(degree(|x| x[0] * x[0].abs()), None);
        assert_eq!(degree(|x| x[1] / x[0]), None);
    }

    #[test]
    fn dependence_is_that_of_the_results_not_of_what_was_dropped() {
        let recorded = record(&[1.0, 2.0, 3.0], |x| {
            let _dropped = x[1].exp();
            vec![x[0] + x[2] * 0.0]
        });
        assert!(recorded.depends_on(0) && !recorded.depends_on(1) && !recorded.depends_on(2));
    }
}
