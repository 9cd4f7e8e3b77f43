//! Cells without what spreadsheets put around numbers.

/// The content of a cell without quotes, also of a formula that keeps a spreadsheet from changing it: `="0.01"`.
pub(super) fn bare(cell: &str) -> &str {
    let cell = cell.trim();
    cell.strip_prefix("=\"").unwrap_or(cell).trim_matches('"').trim()
}
