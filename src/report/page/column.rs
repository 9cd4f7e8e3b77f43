//! Columns of numbers as JSON, as short as possible without loss of digits.

use serde::ser::{Serialize, SerializeMap, Serializer};

/// Decimals tried.
const MOST_DECIMALS: i32 = 9;
/// Integers up to this value are exact in JavaScript.
const LARGEST: f64 = 9e15;

/// Numbers for the script function `column`: as `{"d":4,"v":[12,1,-3]}`, the differences of integer multiples
/// of 10⁻⁴, or unchanged if this is not exact. Non-finite numbers are `null`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Column(pub(super) Vec<f64>);

impl Column {
    /// The smallest number of decimals that reproduces every number, and the differences.
    fn steps(&self) -> Option<(i32, Vec<Option<i64>>)> {
        let finite = || self.0.iter().copied().filter(|v| v.is_finite());
        let scaled = |v: f64, d: i32| (v * 10f64.powi(d)).round();
        let exact = |v: f64, d: i32| {
            let whole = scaled(v, d);
            whole.abs() < LARGEST && whole / 10f64.powi(d) == v
        };
        let decimals = (0..=MOST_DECIMALS).find(|d| finite().all(|v| exact(v, *d)))?;
        let mut last = 0;
        let step = |v: &f64| {
            v.is_finite().then(|| {
                let whole = scaled(*v, decimals) as i64;
                whole - std::mem::replace(&mut last, whole)
            })
        };
        Some((decimals, self.0.iter().map(step).collect()))
    }
}

impl Serialize for Column {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Some((decimals, steps)) = self.steps() else { return self.0.serialize(serializer) };
        let mut map = serializer.serialize_map(Some(2))?;
        map.serialize_entry("d", &decimals)?;
        map.serialize_entry("v", &steps)?;
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn json(values: &[f64]) -> String {
        serde_json::to_string(&Column(values.to_vec())).unwrap()
    }

    #[test]
    fn columns_are_differences_where_that_is_exact() {
        assert_eq!(json(&[0.01, 0.02, f64::NAN, 0.005]), r#"{"d":3,"v":[10,10,null,-15]}"#);
        assert_eq!(json(&[-3.0, 4.0]), r#"{"d":0,"v":[-3,7]}"#);
        assert_eq!(json(&[1e-12, 1.0]), "[1e-12,1.0]");
        assert_eq!(json(&[]), r#"{"d":0,"v":[]}"#);
    }
}
