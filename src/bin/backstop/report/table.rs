//! Tables in the terminal.

use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, Table};

/// Columns under their headings: the first `words` of them of text, the others of numbers, on the right.
pub(crate) fn table(
    headings: &[impl AsRef<str>],
    words: usize,
    rows: impl IntoIterator<Item = Vec<String>>,
) -> String {
    let mut table = Table::new();
    table.load_style(NOTHING).set_header(headings.iter().map(AsRef::as_ref));
    rows.into_iter().for_each(|row| _ = table.add_row(row));
    for (i, column) in table.column_iter_mut().enumerate() {
        column.set_padding((0, 2));
        column.set_cell_alignment(if i < words { CellAlignment::Left } else { CellAlignment::Right });
    }
    table.trim_fmt() + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_on_the_left_and_numbers_on_the_right() {
        let rows = [["stones", "7", "!"], ["µ", "12345", ""]].map(|row| row.map(str::to_owned).to_vec());
        let expected = "\
name    count  note
stones      7     !
µ       12345
";
        assert_eq!(table(&["name", "count", "note"], 1, rows), expected);
    }
}
