//! A Pratt parser that writes instructions in postfix order as it reads.
//!
//! Source: V. R. Pratt, "Top down operator precedence", POPL 1973.

use std::ops::Range;

use super::{Binary, Expression, ExpressionError, MAX_DEPTH, MAX_LENGTH, Op, Unary};

const UNARY: [(&str, Unary); 10] = [
    ("sin", Unary::Sin),
    ("cos", Unary::Cos),
    ("tan", Unary::Tan),
    ("exp", Unary::Exp),
    ("ln", Unary::Ln),
    ("sqrt", Unary::Sqrt),
    ("abs", Unary::Abs),
    ("sgn", Unary::Sgn),
    ("tanh", Unary::Tanh),
    ("erf", Unary::Erf),
];
const BINARY: [(&str, Binary); 2] = [("min", Binary::Min), ("max", Binary::Max)];

/// How tightly a sign binds: looser than `^`, tighter than `*`.
const SIGN_POWER: u8 = 5;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Token<'a> {
    Number(f64),
    Name(&'a str),
    Symbol(char),
    End,
}

pub(super) fn parse(source: &str) -> Result<Expression, ExpressionError> {
    if source.len() > MAX_LENGTH {
        return Err(ExpressionError::TooLong { span: 0..source.len(), limit: MAX_LENGTH });
    }
    let mut parser = Parser {
        source,
        token: Token::End,
        span: 0..0,
        depth: 0,
        ops: Vec::new(),
        variables: Vec::new(),
    };
    parser.advance()?;
    parser.expression(0)?;
    if parser.token != Token::End {
        return Err(parser.unexpected("an operator or the end"));
    }
    let Parser { ops, variables, .. } = parser;
    Ok(Expression { source: source.to_owned(), ops, variables })
}

struct Parser<'a> {
    source: &'a str,
    /// The piece under view and its bytes.
    token: Token<'a>,
    span: Range<usize>,
    depth: usize,
    ops: Vec<Op>,
    variables: Vec<(String, Range<usize>)>,
}

impl<'a> Parser<'a> {
    /// Reads operators that bind tighter than `least`.
    fn expression(&mut self, least: u8) -> Result<(), ExpressionError> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(ExpressionError::TooDeep { span: self.span.clone(), limit: MAX_DEPTH });
        }
        self.operand()?;
        while let Token::Symbol(symbol) = self.token {
            let Some((left, right, operator)) = binding(symbol) else { break };
            if left <= least {
                break;
            }
            self.advance()?;
            self.expression(right)?;
            self.emit(Op::Binary(operator));
        }
        self.depth -= 1;
        Ok(())
    }

    fn operand(&mut self) -> Result<(), ExpressionError> {
        match self.token {
            Token::Number(value) => {
                self.emit(Op::Constant(value));
                self.advance()
            }
            Token::Name(name) => self.name(name),
            Token::Symbol('-') => {
                self.advance()?;
                self.expression(SIGN_POWER)?;
                self.emit(Op::Unary(Unary::Negate));
                Ok(())
            }
            Token::Symbol('+') => {
                self.advance()?;
                self.expression(SIGN_POWER)
            }
            Token::Symbol('(') => {
                self.advance()?;
                self.expression(0)?;
                self.expect(')', "`)` or an operator")
            }
            _ => Err(self.unexpected("a number, a name, a sign or `(`")),
        }
    }

    /// A variable, a constant or a call.
    fn name(&mut self, name: &'a str) -> Result<(), ExpressionError> {
        let span = self.span.clone();
        self.advance()?;
        let unary = UNARY.iter().find(|(known, _)| *known == name).map(|f| (Op::Unary(f.1), 1));
        let binary = BINARY.iter().find(|(known, _)| *known == name).map(|f| (Op::Binary(f.1), 2));
        if let Some((op, expected)) = unary.or(binary) {
            self.expect('(', "`(` after the name of a function")?;
            let found = self.arguments()?;
            if found != expected {
                let function = name.to_owned();
                return Err(ExpressionError::WrongArgumentCount {
                    span,
                    function,
                    found,
                    expected,
                });
            }
            self.emit(op);
        } else if self.token == Token::Symbol('(') {
            let known: Vec<&str> =
                UNARY.iter().map(|f| f.0).chain(BINARY.iter().map(|f| f.0)).collect();
            return Err(ExpressionError::unknown_function(name, span, &known));
        } else if name == "pi" {
            self.emit(Op::Constant(std::f64::consts::PI));
        } else {
            let index = self.variable(name, span);
            self.emit(Op::Variable(index));
        }
        Ok(())
    }

    /// Reads arguments up to and with the closing parenthesis; gives their number.
    fn arguments(&mut self) -> Result<usize, ExpressionError> {
        let mut count = 0;
        if self.token == Token::Symbol(')') {
            self.advance()?;
            return Ok(count);
        }
        loop {
            self.expression(0)?;
            count += 1;
            if self.token != Token::Symbol(',') {
                break;
            }
            self.advance()?;
        }
        self.expect(')', "`)`, `,` or an operator")?;
        Ok(count)
    }

    fn variable(&mut self, name: &str, span: Range<usize>) -> usize {
        self.variables.iter().position(|(known, _)| known == name).unwrap_or_else(|| {
            self.variables.push((name.to_owned(), span));
            self.variables.len() - 1
        })
    }

    /// Appends an instruction, or its result if its operands do not vary.
    fn emit(&mut self, op: Op) {
        let result = match (op, self.ops.as_slice()) {
            (Op::Unary(f), [.., Op::Constant(x)]) => Some((1, Op::Constant(f.apply(*x)))),
            (Op::Binary(f), [.., Op::Constant(a), Op::Constant(b)]) => {
                Some((2, Op::Constant(f.apply(*a, *b))))
            }
            (Op::Binary(Binary::Power), [.., Op::Constant(power)]) => Some((1, Op::Power(*power))),
            _ => None,
        };
        let (replaced, op) = result.unwrap_or((0, op));
        self.ops.truncate(self.ops.len() - replaced);
        self.ops.push(op);
    }

    fn expect(&mut self, symbol: char, expected: &'static str) -> Result<(), ExpressionError> {
        if self.token == Token::Symbol(symbol) {
            self.advance()
        } else {
            Err(self.unexpected(expected))
        }
    }

    fn unexpected(&self, expected: &'static str) -> ExpressionError {
        let found = match self.token {
            Token::End => "the end of the formula".to_owned(),
            _ => format!("`{}`", &self.source[self.span.clone()]),
        };
        ExpressionError::UnexpectedToken { span: self.span.clone(), found, expected }
    }

    /// Moves to the next piece.
    fn advance(&mut self) -> Result<(), ExpressionError> {
        let rest = &self.source[self.span.end..];
        let start = self.span.end + rest.len() - rest.trim_start().len();
        let rest = &self.source[start..];
        let Some(first) = rest.chars().next() else {
            self.token = Token::End;
            self.span = start..start;
            return Ok(());
        };
        let length = match first {
            '0'..='9' | '.' => number_length(rest),
            'a'..='z' | 'A'..='Z' | '_' => name_length(rest),
            _ => first.len_utf8(),
        };
        let text = &rest[..length];
        self.span = start..start + length;
        self.token = match first {
            '0'..='9' | '.' => Token::Number(self.number(text)?),
            'a'..='z' | 'A'..='Z' | '_' => Token::Name(text),
            '+' | '-' | '*' | '/' | '^' | '(' | ')' | ',' => Token::Symbol(first),
            found => {
                return Err(ExpressionError::UnexpectedCharacter {
                    span: self.span.clone(),
                    found,
                });
            }
        };
        Ok(())
    }

    fn number(&self, text: &str) -> Result<f64, ExpressionError> {
        let (span, found) = (self.span.clone(), text.to_owned());
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            Ok(_) => Err(ExpressionError::NumberTooLarge { span, found }),
            Err(_) => Err(ExpressionError::UnexpectedCharacter { span, found: '.' }),
        }
    }
}

/// Left and right binding power of an operator.
fn binding(symbol: char) -> Option<(u8, u8, Binary)> {
    Some(match symbol {
        '+' => (1, 1, Binary::Add),
        '-' => (1, 1, Binary::Subtract),
        '*' => (3, 3, Binary::Multiply),
        '/' => (3, 3, Binary::Divide),
        '^' => (7, 6, Binary::Power), // weaker to its right: associates from the right
        _ => return None,
    })
}

fn name_length(text: &str) -> usize {
    text.bytes().take_while(|b| b.is_ascii_alphanumeric() || *b == b'_').count()
}

/// Bytes of `12`, `1.5`, `.5`, `1e-3`; an `e` without digits after it does not belong.
fn number_length(text: &str) -> usize {
    let digits = |from: usize| text[from..].bytes().take_while(u8::is_ascii_digit).count();
    let mut end = digits(0);
    if text[end..].starts_with('.') {
        end += 1 + digits(end + 1);
    }
    if text[end..].starts_with(['e', 'E']) {
        let sign = usize::from(text[end + 1..].starts_with(['+', '-']));
        let exponent = digits(end + 1 + sign);
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    end
}
