//! A page into a folder, with the numbers behind its figures next to it: `numbers/FIGURE.csv`, and
//! Parquet on request.

use proofmass_base::columns::Format;
use proofmass_base::error::Result;
use proofmass_base::output::Folder;
use proofmass_report::html::Page;

const CSV: &str = "numbers/*.csv";
const PARQUET: &str = "numbers/*.parquet";

/// Lists the files that are announced besides the page itself.
pub(super) fn files(parquet: bool) -> impl Iterator<Item = String> {
    [CSV, PARQUET].into_iter().take(if parquet { 2 } else { 1 }).map(str::to_owned)
}

/// Says whether these are files of numbers.
pub(super) fn announces(files: &str) -> bool {
    [CSV, PARQUET].contains(&files)
}

/// Writes a page under this name, and its numbers in the formats that were announced.
///
/// # Errors
/// The folder cannot be written.
pub(super) fn write(folder: &mut Folder, name: &str, page: Page) -> Result<()> {
    let parquet = folder.announces(PARQUET);
    for numbers in page.numbers() {
        folder.write(&format!("numbers/{}.csv", numbers.name), &Format::Csv.bytes(&numbers.columns))?;
        if parquet {
            folder.write(&format!("numbers/{}.parquet", numbers.name), &Format::Parquet.bytes(&numbers.columns))?;
        }
    }
    folder.write(name, page.finish().as_bytes())
}
