//! One table, shown on a terminal or in a page.

use std::fmt;

use proofmass_base::escape::{html, line};

/// A table of more columns is a matrix, set close so that a page holds it.
const DENSE: usize = 14;

/// Rows of text under headings. The first column is left-aligned, columns of numbers right-aligned.
#[derive(Debug, Clone, Default)]
pub struct Table {
    /// Heading of each column, with the unit.
    pub headings: Vec<String>,
    /// Cells; short rows are padded.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// An empty table with these headings.
    pub fn new(headings: &[&str]) -> Self {
        Self { headings: headings.iter().map(|h| line(h).into_owned()).collect(), rows: Vec::new() }
    }

    /// Appends a row of cells.
    pub fn row<S: Into<String>>(&mut self, cells: impl IntoIterator<Item = S>) {
        self.rows.push(cells.into_iter().map(|cell| line(&cell.into()).into_owned()).collect());
    }

    fn cell(&self, row: usize, column: usize) -> &str {
        self.rows[row].get(column).map_or("", String::as_str)
    }

    /// A column whose cells all begin like a number, and are not sentences, is set flush right.
    fn numeric(&self, column: usize) -> bool {
        let starts_numeric =
            |c: &str| c.is_empty() || c.starts_with(|f: char| f.is_ascii_digit() || "−-–±(<>≤≥+∞".contains(f));
        let short = |c: &str| c.chars().count() <= 40;
        column > 0 && (0..self.rows.len()).map(|r| self.cell(r, column)).all(|c| starts_numeric(c) && short(c))
    }

    /// A column of sentences, which a narrow screen must not squeeze into one word a line.
    fn worded(&self, column: usize) -> bool {
        column > 0 && (0..self.rows.len()).any(|r| self.cell(r, column).chars().count() > 24)
    }

    /// The table as HTML, escaped.
    pub fn to_html(&self) -> String {
        let numeric: Vec<bool> = (0..self.headings.len()).map(|c| self.numeric(c)).collect();
        let class = |c: usize| match numeric[c] {
            true => " class=\"n\"",
            false if self.worded(c) => " class=\"w\"",
            false => "",
        };
        let dense = if self.headings.len() > DENSE { " class=\"dense\"" } else { "" };
        let mut out = format!("<div class=\"scroll\"><table{dense}><thead><tr>");
        for (c, heading) in self.headings.iter().enumerate() {
            // A line ends before the quantity, not before its unit.
            let heading = html(heading).replace(" / ", "\u{a0}/\u{a0}").replace(" %", "\u{a0}%");
            out += &format!("<th{}>{heading}</th>", class(c));
        }
        out += "</tr></thead><tbody>";
        for r in 0..self.rows.len() {
            out += "<tr>";
            for c in 0..self.headings.len() {
                out += &format!("<td{}>{}</td>", class(c), html(self.cell(r, c)));
            }
            out += "</tr>";
        }
        out + "</tbody></table></div>\n"
    }

    /// The table in Markdown.
    pub fn to_markdown(&self) -> String {
        let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
        let escaped = |row: &[String]| row.iter().map(|c| c.replace('|', "\\|")).collect::<Vec<_>>();
        let rule = vec!["---".to_owned(); self.headings.len()];
        line(&self.headings) + &line(&rule) + &self.rows.iter().map(|r| line(&escaped(r))).collect::<String>()
    }
}

/// The table for a terminal: aligned columns, a rule under the headings.
impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = |c: usize| {
            let cells = (0..self.rows.len()).map(|r| self.cell(r, c).chars().count());
            cells.chain([self.headings[c].chars().count()]).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.headings.len()).map(width).collect();
        let numeric: Vec<bool> = (0..self.headings.len()).map(|c| self.numeric(c)).collect();
        let line = |f: &mut fmt::Formatter<'_>, cell: &dyn Fn(usize) -> String| {
            let parts: Vec<String> = (0..widths.len())
                .map(|c| {
                    let text = cell(c);
                    let pad = " ".repeat(widths[c].saturating_sub(text.chars().count()));
                    if numeric[c] { pad + &text } else { text + &pad }
                })
                .collect();
            writeln!(f, "{}", parts.join("  ").trim_end())
        };
        line(f, &|c| self.headings[c].clone())?;
        line(f, &|c| "─".repeat(widths[c]))?;
        for r in 0..self.rows.len() {
            line(f, &|c| self.cell(r, c).to_owned())?;
        }
        Ok(())
    }
}
