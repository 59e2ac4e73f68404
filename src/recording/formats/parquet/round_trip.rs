//! Reads what [`proofmass_base::columns`] writes.

use proofmass_base::columns::{Columns, Format};

use crate::{Request, stream};

#[test]
fn what_is_written_is_read() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let mut table = Columns::default();
    // More than one row group.
    let rows = (1 << 17) + 100;
    table.numbers("t_s", (0..rows).map(|k| k as f64 * 0.01).collect());
    table.words("what", vec!["µ".into(); rows]);
    table.numbers("a_m_s2", (0..rows).map(|k| (k as f64).sin()).collect());
    let path = folder.path().join("table.parquet");
    std::fs::write(&path, Format::Parquet.bytes(&table)).expect("written");
    let (names, _) = stream::headings(&path, &Request::default()).expect("headings");
    assert!(names.contains(&"a_m_s2".to_owned()) && !names.contains(&"what".to_owned()), "{names:?}");
    let request = Request { columns: vec!["a_m_s2".into()], rate_hz: Some(100.0), ..Request::default() };
    let recording = crate::read(&path, &request).expect("read");
    assert_eq!(recording.columns[0].values[rows - 1], ((rows - 1) as f64).sin());
    assert_eq!(recording.columns[0].values.len(), rows);
}
