//! Names of the columns of a matrix in a list of texts beside it.

use std::collections::HashSet;

use super::Variable;

/// Names the columns of each matrix by the one list that contains as many different texts as it has columns; a list of
/// as many texts of which some repeat contains their units. Several such lists or matrices are left alone.
pub(super) fn name_columns(variables: &mut [Variable]) {
    let lists: Vec<Vec<String>> =
        variables.iter_mut().map(|v| std::mem::take(&mut v.texts)).collect();
    let differ = |list: &&Vec<String>| list.iter().collect::<HashSet<_>>().len() == list.len();
    for names in lists.iter().filter(|list| list.len() > 1).filter(differ) {
        let same = || lists.iter().filter(|list| list.len() == names.len());
        let mut matrices =
            variables.iter_mut().filter(|v| is_matrix(v) && v.columns.len() == names.len());
        let (Some(matrix), None) = (matrices.next(), matrices.next()) else { continue };
        let (1, mut units) = (same().filter(differ).count(), same().filter(|list| !differ(list)))
        else {
            continue;
        };
        let units = units.next().filter(|_| units.next().is_none());
        for (k, (column, name)) in matrix.columns.iter_mut().zip(names).enumerate() {
            column.0 = match units {
                Some(units) if !name.contains(['[', '(']) => format!("{name} [{}]", units[k]),
                _ => name.clone(),
            };
        }
    }
}

/// Whether a variable is a matrix with several columns, `name(:,1)` or `name(1,:)`.
fn is_matrix(variable: &Variable) -> bool {
    let is_part =
        |name: &str| name.strip_prefix(&variable.name).is_some_and(|index| index.starts_with('('));
    variable.columns.len() > 1 && variable.columns.iter().all(|(name, _)| is_part(name))
}

/// The texts of cells that contain nothing else.
pub(super) fn texts(cells: &[Variable]) -> Vec<String> {
    let texts: Option<Vec<String>> = cells.iter().map(|cell| cell.text.clone()).collect();
    texts.unwrap_or_default()
}

/// The rows of a character array, which is stored column after column.
pub(super) fn rows(all: &str, rows: usize) -> Vec<String> {
    let letters: Vec<char> = all.chars().collect();
    if rows < 2 || !letters.len().is_multiple_of(rows) {
        return vec![];
    }
    let row = |k: usize| letters[k..].iter().step_by(rows).collect::<String>().trim().to_owned();
    (0..rows).map(row).collect()
}
