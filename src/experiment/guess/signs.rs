//! Speeds that lost their sign.

use super::names::Quantity;
use super::values::{AT_REST, extent};
use super::{Candidate, Guess};
use crate::io::PreviewColumn;

/// The question of speeds that are never negative beside set-points that are: the wheels turned both ways, and only a
/// log with signs shows it.
pub(super) fn lost(all: &[Candidate], columns: &[PreviewColumn], guess: &Guess) -> Option<String> {
    let of = |name: &str| columns.iter().find(|c| c.name == name).map_or(&[][..], |c| &c.values);
    let mut speeds = guess.columns.iter().filter(|c| c.key.starts_with("dalpha")).peekable();
    let first = speeds.peek()?.name.clone();
    let wished = |c: &&Candidate| {
        c.named.wished
            && c.named.side.is_some()
            && matches!(c.named.quantity, None | Some(Quantity::Speed))
    };
    let asked = all.iter().filter(wished).find(|c| turns_back(&c.column.values))?;
    speeds.all(|c| !turns_back(of(&c.name))).then(|| {
        format!(
            "`{}` is negative at times and `{first}` never is: a magnitude? Without its sign a motion back is one \
             forward; record speeds and inputs with their signs",
            asked.column.name
        )
    })
}

fn turns_back(values: &[f64]) -> bool {
    let (low, high) = extent(values);
    low < -AT_REST * high && low < 0.0
}
