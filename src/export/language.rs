//! Languages of the exported functions: syntax of expressions, and template.

use crate::math::expression::Unary;

use super::print::Syntax;

/// A language of exported models.
pub(super) struct Language {
    /// Name of the file.
    pub(super) file: &'static str,
    /// The template of the file with placeholders.
    pub(super) frame: &'static str,
    /// Start of a comment line.
    pub(super) comment: &'static str,
    /// Syntax of expressions.
    pub(super) syntax: Syntax,
    /// A constant from name, value and remark.
    pub(super) constant: fn(&str, &str, &str) -> String,
    /// Literals of the language for false and true.
    pub(super) truth: [&'static str; 2],
}

/// All languages.
pub(super) const LANGUAGES: [Language; 5] = [
    Language {
        file: "model.py",
        frame: include_str!("frame/model.py"),
        comment: "#",
        syntax: Syntax {
            unary: |f| match f {
                Unary::Ln => "math.log",
                Unary::Abs => "abs",
                Unary::Sgn => "sgn",
                Unary::Sin => "math.sin",
                Unary::Cos => "math.cos",
                Unary::Tan => "math.tan",
                Unary::Exp => "math.exp",
                Unary::Sqrt => "math.sqrt",
                Unary::Tanh => "math.tanh",
                Unary::Erf => "math.erf",
                Unary::Round => "math.floor",
                Unary::Negate => "-",
            },
            binary: ["min", "max", "math.pow"],
            place: |array, k| format!("{array}[{k}]"),
            temporary: |k, text| format!("x{k} = {text}"),
            name: |k| format!("x{k}"),
            set: |target, text| format!("{target} = {text}"),
        },
        constant: |name, value, remark| format!("{name} = {value}  # {remark}"),
        truth: ["False", "True"],
    },
    Language {
        file: "model.m",
        frame: include_str!("frame/model.m"),
        comment: "%",
        syntax: Syntax {
            unary: |f| match f {
                Unary::Sgn => "sign",
                other => plain(other),
            },
            binary: ["min", "max", "power"],
            place: |array, k| format!("{array}({})", k + 1),
            temporary: |k, text| format!("x{k} = {text};"),
            name: |k| format!("x{k}"),
            set: |target, text| format!("{target} = {text};"),
        },
        constant: |name, value, remark| format!("{name} = {value};  % {remark}"),
        truth: ["false", "true"],
    },
    Language {
        file: "model.c",
        frame: include_str!("frame/model.c"),
        comment: "//",
        syntax: Syntax {
            unary: |f| match f {
                Unary::Abs => "fabs",
                other => plain(other),
            },
            binary: ["fmin", "fmax", "pow"],
            place: |array, k| format!("{array}[{k}]"),
            temporary: |k, text| format!("const double x{k} = {text};"),
            name: |k| format!("x{k}"),
            set: |target, text| format!("{target} = {text};"),
        },
        constant: |name, value, remark| {
            format!("static const double {name} = {value}; // {remark}")
        },
        truth: ["0", "1"],
    },
    Language {
        file: "model.mo",
        frame: include_str!("frame/model.mo"),
        comment: "//",
        syntax: Syntax {
            unary: |f| match f {
                Unary::Sgn => "sign",
                other => plain(other),
            },
            binary: ["min", "max", "power"],
            place: |array, k| format!("{array}[{}]", k + 1),
            temporary: |k, text| format!("x[{}] := {text};", k + 1),
            name: |k| format!("x[{}]", k + 1),
            set: |target, text| format!("{target} := {text};"),
        },
        constant: |name, value, remark| format!("constant Real {name} = {value}; // {remark}"),
        truth: ["false", "true"],
    },
    JAVASCRIPT,
];

/// JavaScript, which is also used by the page of the report.
pub(super) const JAVASCRIPT: Language = Language {
    file: "model.js",
    frame: include_str!("frame/model.js"),
    comment: "//",
    syntax: Syntax {
        unary: |f| match f {
            Unary::Ln => "Math.log",
            Unary::Abs => "Math.abs",
            Unary::Sin => "Math.sin",
            Unary::Cos => "Math.cos",
            Unary::Tan => "Math.tan",
            Unary::Exp => "Math.exp",
            Unary::Sqrt => "Math.sqrt",
            Unary::Tanh => "Math.tanh",
            Unary::Round => "Math.floor",
            Unary::Sgn | Unary::Erf | Unary::Negate => plain(f),
        },
        binary: ["Math.min", "Math.max", "Math.pow"],
        place: |array, k| format!("{array}[{k}]"),
        temporary: |k, text| format!("const x{k} = {text};"),
        name: |k| format!("x{k}"),
        set: |target, text| format!("{target} = {text};"),
    },
    constant: |name, value, remark| {
        format!("const {name} = changed.{name} ?? {value}; // {remark}")
    },
    truth: ["false", "true"],
};

/// Function names common to most languages.
fn plain(function: Unary) -> &'static str {
    match function {
        Unary::Negate => "-",
        Unary::Sin => "sin",
        Unary::Cos => "cos",
        Unary::Tan => "tan",
        Unary::Exp => "exp",
        Unary::Ln => "log",
        Unary::Sqrt => "sqrt",
        Unary::Abs => "abs",
        Unary::Sgn => "sgn",
        Unary::Tanh => "tanh",
        Unary::Erf => "erf",
        Unary::Round => "floor",
    }
}
