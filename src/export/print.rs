//! A recorded formula as statements of a language.

use crate::math::expression::{Binary, Unary};
use crate::math::{Formula, Node};

/// Largest number of operations in one expression; beyond it a temporary variable is used. Counted in
/// operations, so that every language has the same temporaries.
const MOST_OPERATIONS: usize = 8;

/// Language-dependent syntax of expressions and assignments.
#[derive(Clone, Copy)]
pub(super) struct Syntax {
    /// Name of a function of one variable.
    pub(super) unary: fn(Unary) -> &'static str,
    /// Names of minimum, maximum and power.
    pub(super) binary: [&'static str; 3],
    /// An array element, with indices from zero.
    pub(super) place: fn(&str, usize) -> String,
    /// The statement that assigns temporary number k, counted from zero.
    pub(super) temporary: fn(usize, &str) -> String,
    /// Name of temporary number k.
    pub(super) name: fn(usize) -> String,
    /// The statement that assigns an array element.
    pub(super) set: fn(&str, &str) -> String,
}

/// A printed formula.
pub(super) struct Printed {
    /// Statements, one per line, without indentation.
    pub(super) statements: Vec<String>,
    /// Number of temporaries.
    pub(super) temporaries: usize,
}

/// Text of an expression, and its precedence.
#[derive(Clone)]
struct Text(String, Tightness);

#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Tightness {
    Sum,
    Product,
    Whole,
}

impl Text {
    /// In parentheses unless its precedence is at least the required one.
    fn within(&self, needed: Tightness) -> String {
        if self.1 >= needed { self.0.clone() } else { format!("({})", self.0) }
    }
}

/// A number in a notation that all languages read back to the same bits.
pub(super) fn number(value: f64) -> String {
    format!("{value:?}")
}

/// Prints a formula with named inputs and results.
pub(super) fn print(
    formula: &Formula,
    inputs: &[String],
    targets: &[String],
    syntax: &Syntax,
) -> Printed {
    let uses = formula.uses();
    let mut texts: Vec<Text> = Vec::with_capacity(formula.nodes.len());
    let mut operations = vec![0; formula.nodes.len()];
    let mut statements = Vec::new();
    let mut temporaries = 0;
    for (k, node) in formula.nodes.iter().enumerate() {
        if uses[k] == 0 {
            texts.push(Text(String::new(), Tightness::Whole));
            continue;
        }
        let text = expression(node, &texts, inputs, syntax);
        operations[k] = match *node {
            Node::Constant(_) | Node::Input(_) => 0,
            Node::Unary(_, a) => 1 + operations[a],
            Node::Binary(_, a, b) => 1 + operations[a] + operations[b],
        };
        let leaf = matches!(node, Node::Constant(_) | Node::Input(_));
        if leaf || (uses[k] == 1 && operations[k] <= MOST_OPERATIONS) {
            texts.push(text);
            continue;
        }
        operations[k] = 0;
        statements.push((syntax.temporary)(temporaries, &text.0));
        texts.push(Text((syntax.name)(temporaries), Tightness::Whole));
        temporaries += 1;
    }
    for (target, &k) in targets.iter().zip(&formula.outputs) {
        statements.push((syntax.set)(target, &texts[k].0));
    }
    Printed { statements, temporaries }
}

fn expression(node: &Node, texts: &[Text], inputs: &[String], syntax: &Syntax) -> Text {
    match *node {
        Node::Constant(value) => {
            let negative = value.is_sign_negative();
            Text(number(value), if negative { Tightness::Sum } else { Tightness::Whole })
        }
        Node::Input(k) => Text(inputs[k].clone(), Tightness::Whole),
        // a sign needs parentheses except at the start of a sum: Modelica does not allow a * -b
        Node::Unary(Unary::Negate, a) => {
            Text(format!("-{}", texts[a].within(Tightness::Whole)), Tightness::Sum)
        }
        Node::Unary(Unary::Round, a) => {
            let inside = texts[a].within(Tightness::Sum);
            Text(format!("{}({inside} + 0.5)", (syntax.unary)(Unary::Round)), Tightness::Whole)
        }
        Node::Unary(function, a) => {
            Text(format!("{}({})", (syntax.unary)(function), texts[a].0), Tightness::Whole)
        }
        Node::Binary(function, a, b) => binary(function, &texts[a], &texts[b], syntax),
    }
}

fn binary(function: Binary, a: &Text, b: &Text, syntax: &Syntax) -> Text {
    use Tightness::{Product, Sum, Whole};
    let operator = |sign: &str, own: Tightness, right: Tightness| {
        Text(format!("{} {sign} {}", a.within(own), b.within(right)), own)
    };
    let call = |k: usize| Text(format!("{}({}, {})", syntax.binary[k], a.0, b.0), Whole);
    match function {
        Binary::Add => operator("+", Sum, Product),
        Binary::Subtract => operator("-", Sum, Product),
        Binary::Multiply => operator("*", Product, Whole),
        Binary::Divide => operator("/", Product, Whole),
        Binary::Min => call(0),
        Binary::Max => call(1),
        Binary::Power => call(2),
    }
}

#[cfg(test)]
mod tests {
    use super::super::language::LANGUAGES;
    use super::*;
    use crate::math::{Real, Symbol, record};

    fn c(f: impl Fn(&[Symbol]) -> Symbol) -> Vec<String> {
        let formula = record(&[1.0, 2.0, 3.0], |x| vec![f(x)]);
        let inputs = ["a", "b", "c"].map(str::to_owned);
        print(&formula, &inputs, &["y".to_owned()], &LANGUAGES[2].syntax).statements
    }

    #[test]
    fn parentheses_keep_the_order_of_the_operations_and_stand_nowhere_else() {
        assert_eq!(c(|x| x[0] - (x[1] - x[2])), ["y = a - (b - c);"]);
        assert_eq!(c(|x| x[0] - x[1] - x[2]), ["y = a - b - c;"]);
        assert_eq!(c(|x| (x[0] + x[1]) * x[2] / x[0]), ["y = (a + b) * c / a;"]);
        assert_eq!(c(|x| x[0] / (x[1] * x[2])), ["y = a / (b * c);"]);
        assert_eq!(c(|x| x[0] * -x[1] - -(-x[2])), ["y = a * (-b) - (-(-c));"]);
        assert_eq!(c(|x| x[0] * -1e-7 + 3.0), ["y = a * (-1e-7) + 3.0;"]);
        assert_eq!(c(|x| x[0].pow(x[1]).abs()), ["y = fabs(pow(a, b));"]);
    }

    #[test]
    fn what_is_used_twice_gets_a_name_and_long_formulas_are_cut() {
        assert_eq!(c(|x| x[0].exp() * x[0].exp()), ["const double x0 = exp(a);", "y = x0 * x0;"]);
        let long = c(|x| (0..12).fold(x[0], |sum, k| sum * x[1] + f64::from(k)));
        assert!(long.len() > 1 && long.iter().all(|line| line.len() < 80), "{long:?}");
    }
}
