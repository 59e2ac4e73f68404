//! A table: named columns of numbers and of words, side by side.

/// The values of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Numbers; what is not finite is missing.
    Numbers(Vec<f64>),
    /// Text, one entry per row.
    Words(Vec<String>),
}

impl Values {
    fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Words(values) => values.len(),
        }
    }
}

/// A column: its name ends in its unit (`time_s`).
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Heading of the column.
    pub name: String,
    /// A value a row.
    pub values: Values,
}

/// A table of columns, no two of one name.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Columns {
    columns: Vec<Column>,
}

impl Columns {
    /// Adds a column of numbers; one whose name is taken gets a number behind it.
    pub fn numbers(&mut self, name: &str, values: Vec<f64>) {
        self.add(name, Values::Numbers(values));
    }

    /// Adds a column of words.
    pub fn words(&mut self, name: &str, values: Vec<String>) {
        self.add(name, Values::Words(values));
    }

    fn add(&mut self, name: &str, values: Values) {
        let names = std::iter::once(name.to_owned()).chain((2..).map(|n| format!("{name}_{n}")));
        let taken = |name: &String| self.columns.iter().any(|c| c.name == *name);
        let name = names.into_iter().find(|n| !taken(n)).unwrap_or_default();
        self.columns.push(Column { name, values });
    }

    /// All of them, from left to right.
    pub fn all(&self) -> &[Column] {
        &self.columns
    }

    /// Rows: the length of the longest column; shorter ones end in missing values.
    pub fn rows(&self) -> usize {
        self.columns.iter().map(|c| c.values.len()).max().unwrap_or(0)
    }
}
