//! Tables in the terminal.

use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, Table};

/// Columns under their headings: the first `words` of them of text, the others of numbers, on the right,
/// but for notes, which have no heading.
pub(crate) fn table(
    headings: &[impl AsRef<str>],
    words: usize,
    rows: impl IntoIterator<Item = Vec<String>>,
) -> String {
    let mut table = Table::new();
    table.load_style(NOTHING).set_header(headings.iter().map(AsRef::as_ref));
    rows.into_iter().for_each(|row| _ = table.add_row(row));
    for ((i, heading), column) in headings.iter().enumerate().zip(table.column_iter_mut()) {
        let is_text = i < words || heading.as_ref().is_empty();
        column.set_padding((0, 2));
        column.set_cell_alignment(if is_text { CellAlignment::Left } else { CellAlignment::Right });
    }
    table.trim_fmt() + "\n"
}

/// Values beside their labels.
pub(crate) fn list<L: Into<String>>(rows: impl IntoIterator<Item = (L, String)>) -> String {
    let mut table = Table::new();
    table.load_style(NOTHING);
    rows.into_iter().for_each(|(label, value)| _ = table.add_row([label.into(), value]));
    table.column_iter_mut().for_each(|column| _ = column.set_padding((0, 2)));
    table.trim_fmt() + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stand_beside_their_labels() {
        let rows = [("bodies", "7"), ("step time", "2 µs")].map(|(label, value)| (label, value.to_owned()));
        assert_eq!(list(rows), "bodies     7\nstep time  2 µs\n");
    }

    #[test]
    fn words_are_on_the_left_and_numbers_on_the_right() {
        let rows = [["stones", "7", "falls"], ["µ", "12345", "a"]].map(|row| row.map(str::to_owned).to_vec());
        let expected = "\
name    count
stones      7  falls
µ       12345  a
";
        assert_eq!(table(&["name", "count", ""], 1, rows), expected);
    }
}
