//! The answer as a page: parameters, how far they differ, and what each recording can know.

use super::table::short_name;
use super::{figure, sentences, table};
use crate::html::Page;
use proofmass_diagnosis::check::Checked;
use proofmass_recording::Recording;

/// The report page of `check`; `recordings` are those of `files`.
pub fn page(files: &[String], recordings: &[Recording], checked: &Checked) -> Page {
    let title = match files {
        [file] => format!("Check of {}", short_name(file)),
        files => format!("Check of {} recordings", files.len()),
    };
    let mut page = Page::new(&title, &sentences::answer(files, checked));
    let next: Vec<String> = sentences::next(files, checked).iter().map(|step| format!("Next: {step}")).collect();
    if !next.is_empty() {
        page.list(&next);
    }
    page.section("Parameters");
    page.table(&table::of(files, checked));
    page.paragraph(
        "Values have 95 % intervals, scaled by what the fit leaves. A difference is that of the two furthest apart; \
         of sizes, such as noise, it is a ratio.",
    );
    if let Some(chart) = figure::differences(files, checked) {
        page.figure(&chart.draw(), figure::CAPTION);
    }
    page.list(&sentences::of_agreement(checked));
    page.section("What each recording can know");
    for (file, run) in files.iter().zip(&checked.runs) {
        page.subsection(&short_name(file));
        match &sentences::of_run(run)[..] {
            [] => page.paragraph("It determines every parameter."),
            said => page.list(said),
        }
    }
    page.section("Provenance");
    let of = |(file, r): (&String, &Recording)| {
        format!("{}, SHA-256 {}, {} samples", short_name(file), r.sha256, r.samples())
    };
    page.list(&[format!("proofmass {}", env!("CARGO_PKG_VERSION"))]);
    page.list(&files.iter().zip(recordings).map(of).collect::<Vec<_>>());
    page
}
