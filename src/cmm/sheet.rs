//! A table of text cells with named columns, as workbooks and files of statistics software hold them. Made by their
//! readers; understood as a pasted block.

/// A table.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Sheet {
    /// What messages call it.
    pub name: String,
    /// The line or row of the names.
    pub header_line: u32,
    /// The names of the columns, with units.
    pub columns: Vec<String>,
    /// Line or row number and cells of each row; numbers with a decimal point.
    pub rows: Vec<(u32, Vec<String>)>,
}

impl Sheet {
    /// The table as lines of cells between tabs, for [`understand`](super::paste::understand); each stands on its own
    /// line number where that is possible, so that messages name it.
    #[must_use]
    pub fn tabbed(&self) -> String {
        const LONGEST_GAP: u32 = 10_000;
        let mut text = String::new();
        let mut line = 1;
        let header = std::iter::once((self.header_line, &self.columns));
        for (number, row) in header.chain(self.rows.iter().map(|(line, row)| (*line, row))) {
            let gap = number.saturating_sub(line);
            if gap <= LONGEST_GAP {
                text.extend(std::iter::repeat_n('\n', gap as usize));
                line += gap;
            }
            for (index, cell) in row.iter().enumerate() {
                if index > 0 {
                    text.push('\t');
                }
                text.extend(cell.chars().map(|c| if c.is_control() || c == '"' { ' ' } else { c }));
            }
            text.push('\n');
            line += 1;
        }
        text
    }
}
