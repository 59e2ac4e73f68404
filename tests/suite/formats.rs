//! Recordings in every format: one log gives one answer, whatever wrote it; what is damaged ends in
//! words.

use std::path::{Path, PathBuf};

use libtest_mimic::{Failed, Trial};
use proofmass::error::Error;
use proofmass::numerics::allan::law::TERMS;
use proofmass::recording::noise::{self, Noise};
use proofmass::recording::rows::{Rows, Wanted};
use proofmass::recording::source::FileSummary;
use proofmass::recording::unit::Unit;
use proofmass::recording::{self, Recording, Request, inspection, roles};
use serde_json::Value;

use super::world::{check, data_test, program, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        data_test("formats: one log gives the same coefficients in every format", same_coefficients),
        data_test("formats: the control, a log with one reading changed, gives others", another_log),
        data_test("formats: a bag without an IMU says what it holds, and HDF5 what to do", refused_in_words),
        data_test("formats: a trajectory is a table with named columns", ground_truth),
        test("formats: small files by other writers hold the numbers that were written", small_files),
        test("formats: a file cut anywhere is refused in words, or says which rows it lost", cut_anywhere),
        test(
            "formats: a topic of another type, two IMUs, several lengths and wrong magic are refused in words",
            mistaken,
        ),
        test("formats: what unpacks to more than a thousandfold is refused, and memory stays small", bombs),
        test("formats: standard input, packed text, folders and trajectories are read as they are", ways_in),
        test("formats: inspect says what a file holds and what to run next", inspected),
    ]
}

fn seeds() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus/formats")
}

/// The six channels of an IMU in their order, whatever they are called, on the clock that the file
/// states or that is found.
fn noise_of(path: &Path) -> Result<Noise, Error> {
    let (names, _) = recording::stream::headings(path, &Request::default())?;
    let roles = roles::of(&names);
    let places = roles.gyro.into_iter().chain(roles.accelerometer).flatten();
    let mut columns: Vec<String> = places.map(|p| names[p].clone()).collect();
    if columns.is_empty() {
        columns = names;
    }
    noise::analyse(path, &Request { columns, ..Request::default() }, |_| Unit::unknown())
}

/// N, B, K, R and Q of every channel, and the Allan deviation at 1 s.
fn coefficients(noise: &Noise) -> Vec<f64> {
    let of = |channel: &noise::Channel| -> Vec<f64> {
        let terms = TERMS.map(|t| channel.fit.as_ref().map_or(f64::NAN, |fit| fit.coefficients[t as usize].value));
        terms.into_iter().chain(channel.at_one_second().map(|d| d.value)).collect()
    };
    noise.channels.iter().flat_map(of).collect()
}

fn differ(a: &[f64], b: &[f64]) -> f64 {
    let off = |(a, b): (&f64, &f64)| if a == b { 0.0 } else { (a - b).abs() / a.abs().max(b.abs()) };
    if a.len() == b.len() { a.iter().zip(b).map(off).fold(0.0, f64::max) } else { f64::INFINITY }
}

const ALIKE: [&str; 16] = [
    "plain.csv.gz",
    "euroc.csv",
    "comma.csv",
    "units_row.csv",
    "imu.npy",
    "imu.npz",
    "imu_v5.mat",
    "imu.parquet",
    "imu_snappy.parquet",
    "imu.arrow",
    "imu.bag",
    "ros2_db3",
    "ros2_db3/ros2_db3.db3",
    "ros2_mcap",
    "ros2_mcap/ros2_mcap.mcap",
    "plain.csv",
];

fn same_coefficients(data: &Path) -> Result<(), Failed> {
    let folder = data.join("formats");
    let plain = coefficients(&noise_of(&folder.join("plain.csv"))?);
    check(plain.len() >= 36, format!("{} coefficients", plain.len()))?;
    // Stamps are rounded differently in each file; the last two hold numbers in single precision.
    let single = ["imu.bin", "imu.ulg"].map(|f| (f, 1e-4));
    // Where the library is there.
    let optional = cfg!(feature = "hdf5").then_some(("imu.h5", 1e-6));
    for (file, tolerance) in ALIKE.map(|f| (f, 1e-6)).into_iter().chain(single).chain(optional) {
        let noise = noise_of(&folder.join(file)).map_err(|e| format!("{file}: {e}"))?;
        check(noise.source.rows == 12_000, format!("{file}: {} rows", noise.source.rows))?;
        let off = differ(&coefficients(&noise), &plain);
        check(off <= tolerance, format!("{file}: coefficients differ by {off:e}"))?;
    }
    Ok(())
}

fn another_log(data: &Path) -> Result<(), Failed> {
    let text = std::fs::read_to_string(data.join("formats/plain.csv"))?;
    let plain = coefficients(&noise_of(&data.join("formats/plain.csv"))?);
    let folder = tempfile::tempdir()?;
    let other = folder.path().join("other.csv");
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    lines[6000] = lines[6000].replacen(",0.", ",0.5", 1).replacen(",-0.", ",-0.5", 1);
    std::fs::write(&other, lines.join("\n"))?;
    check(differ(&coefficients(&noise_of(&other)?), &plain) > 1e-4, "a changed reading goes unnoticed")
}

fn refused_in_words(data: &Path) -> Result<(), Failed> {
    let without = (!cfg!(feature = "hdf5")).then_some(("imu.h5", "HDF5"));
    for (file, words) in [("no_imu.bag", "/chatter (std_msgs/String)")].into_iter().chain(without) {
        let error = noise_of(&data.join("formats").join(file)).err().ok_or("read")?;
        check(error.cause.contains(words) && !error.hint.is_empty(), format!("{file}: {error}"))?;
    }
    Ok(())
}

fn ground_truth(data: &Path) -> Result<(), Failed> {
    let path = data.join("euroc_v102/ground_truth.csv");
    let columns: Vec<String> = ["p_RS_R_x", "q_RS_w"].map(str::to_owned).into();
    let read = recording::read(&path, &Request { columns, ..Request::default() })?;
    check(read.samples() > 1000 && (read.rate_hz - 200.0).abs() < 1.0, format!("{} Hz", read.rate_hz))
}

fn read(path: &Path, request: &Request) -> Result<Recording, Error> {
    recording::read(path, request)
}

fn named(columns: &[&str]) -> Request {
    Request { columns: columns.iter().map(|c| (*c).to_owned()).collect(), ..Request::default() }
}

/// Columns as they stand in a file, row by row, and what is known of it at its end.
fn table(path: &Path, topic: Option<&str>, columns: &[&str]) -> Result<(Vec<Vec<f64>>, FileSummary), Error> {
    let columns: Vec<String> = columns.iter().map(|c| (*c).to_owned()).collect();
    let mut rows = Rows::open_wanted(path, &Wanted { topic, time: None, columns: &columns, ..Wanted::default() })?;
    let mut row = vec![0.0; rows.names().len()];
    let mut out = vec![Vec::new(); row.len()];
    while rows.next(&mut row)? {
        out.iter_mut().zip(&row).for_each(|(column, value)| column.push(*value));
    }
    Ok((out, rows.finish()?))
}

/// The largest difference; a missing value is alike only to a missing one.
fn off(found: &[f64], wanted: &[f64]) -> f64 {
    let one = |(a, b): (&f64, &f64)| if a.is_nan() && b.is_nan() { 0.0 } else { (a - b).abs() };
    let all = found.iter().zip(wanted).map(one);
    if all.clone().any(f64::is_nan) { f64::NAN } else { all.fold(0.0, f64::max) }
}

/// The files were written by NumPy, SciPy and SQLite, and by hand after each format's text, from
/// one table of numbers.
fn small_files() -> Result<(), Failed> {
    let (wanted, source) = table(&seeds().join("stored.npz"), None, &["gyro.1", "gyro.3", "acc.3"])?;
    check(source.rows == 24 && source.sha256.len() == 64, format!("{} rows", source.rows))?;
    let stated = read(&seeds().join("stored.npz"), &named(&["gyro.1"]))?;
    check((stated.rate_hz - 200.0).abs() < 1e-9, format!("{} Hz", stated.rate_hz))?;
    let imu = ["gx", "gz", "az"];
    let cases: [(&str, [&str; 3], usize, f64); 14] = [
        ("plain.npy", ["2", "4", "7"], 24, 0.0),
        ("packed.npy.gz", ["2", "4", "7"], 24, 0.0),
        ("deflated.npz", ["gyro.1", "gyro.3", "acc.3"], 24, 0.0),
        ("plain.mat", ["gyro.1", "gyro.3", "acc.3"], 24, 0.0),
        ("packed.mat", ["gyro.1", "gyro.3", "acc.3"], 24, 0.0),
        ("plain.bag", imu, 6, 0.0),
        ("lz4.bag", imu, 6, 0.0),
        ("bzip2.bag", imu, 6, 0.0),
        ("flat.mcap", imu, 6, 0.0),
        ("chunk.mcap", imu, 6, 0.0),
        ("zstd.mcap", imu, 6, 0.0),
        ("lz4.mcap", imu, 6, 0.0),
        ("bag.db3", imu, 10, 0.0),
        // Single precision.
        ("flight.ulg", imu, 8, 1e-6),
    ];
    for (file, columns, rows, tolerance) in cases {
        let (found, source) = table(&seeds().join(file), None, &columns).map_err(|e| format!("{file}: {e}"))?;
        check(source.rows == rows, format!("{file}: {} rows, {rows} were written", source.rows))?;
        for ((name, found), wanted) in columns.iter().zip(&found).zip(&wanted) {
            let off = off(found, wanted);
            check(off <= tolerance, format!("{file}, {name}: off by {off:e}"))?;
        }
    }
    // Two row groups, two versions of pages, Snappy, gzip, Zstandard, differences, split streams, a
    // dictionary.
    let mut gap = wanted[0].clone();
    gap[3] = f64::NAN;
    let (parquet, _) = table(&seeds().join("table.parquet"), None, &["gx", "n"])?;
    check(off(&parquet[0], &gap[..16]) == 0.0 && parquet[0].len() == 16, format!("{:?}", parquet[0]))?;
    // The bits of the dictionary's indices, lowest first, are 0 1 2 3 3 2 1 0; then come whole
    // numbers from 0 on.
    let whole = [5.0, -6.0, 7.0, 8.0, 8.0, 7.0, -6.0, 5.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
    check(parquet[1] == whole, format!("{:?}", parquet[1]))?;
    for file in ["plain.arrow", "lz4.arrow", "zstd.arrow"] {
        // One batch twice.
        let (arrow, _) = table(&seeds().join(file), None, &["gx", "acc.3", "ok"])?;
        let twice = |column: &[f64]| [&column[..8], &column[..8]].concat();
        check(off(&arrow[0], &twice(&gap)) == 0.0, format!("{file}: {:?}", arrow[0]))?;
        check(off(&arrow[1], &twice(&wanted[2])) == 0.0, format!("{file}: {:?}", arrow[1]))?;
        check(arrow[2][..4] == [0.0, 1.0, 0.0, 1.0], format!("{file}: {:?}", arrow[2]))?;
    }
    // Two sensors take turns in one message; one is asked for by its number.
    let (second, source) = table(&seeds().join("flight.bin"), Some("IMU.1"), &["gx"])?;
    let odd: Vec<f64> = wanted[0].iter().skip(1).step_by(2).copied().collect();
    check(source.rows == 4 && off(&second[0], &odd) < 1e-6, format!("{:?}", second[0]))?;
    // As a control, a reading that is another one is seen.
    check(off(&second[0], &wanted[0]) > 1e-4, "two sensors are not told apart")
}

fn cut_anywhere() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    for entry in std::fs::read_dir(seeds())?.flatten() {
        // What fuzzing found has no ending and is damaged already; the other files are whole.
        if entry.path().extension().is_none() {
            continue;
        }
        let bytes = std::fs::read(entry.path())?;
        let path = folder.path().join(entry.file_name());
        let topic = (entry.file_name() == "flight.bin").then_some("IMU.0");
        let (_, whole) = table(&entry.path(), topic, &[]).map_err(|e| format!("{}: {e}", entry.path().display()))?;
        for length in (0..bytes.len()).step_by(5) {
            std::fs::write(&path, &bytes[..length])?;
            let name = format!("{} cut to {length} bytes", entry.path().display());
            match table(&path, topic, &[]) {
                Err(error) => check(!error.cause.is_empty() && !error.hint.is_empty(), format!("{name}: {error:?}"))?,
                Ok((given, source)) => {
                    let dropped: usize = source.dropped.iter().map(|d| d.rows).sum();
                    let rows = given.first().map_or(0, Vec::len);
                    let counted = rows + dropped == source.rows && source.rows <= whole.rows;
                    check(counted, format!("{name}: {rows} rows given of {}, {dropped} dropped", source.rows))?;
                }
            }
        }
    }
    Ok(())
}

fn mistaken() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let of = |file: &str, topic: &str| {
        let topic = Some(topic.to_owned()).filter(|t| !t.is_empty());
        read(&seeds().join(file), &Request { topic, ..Request::default() })
            .err()
            .map(|e| format!("{} {}", e.cause, e.hint))
    };
    for (file, topic, words) in [
        ("plain.bag", "/chatter", "std_msgs/String"),
        ("plain.bag", "/imu1", "did you mean `/imu0`?"),
        ("bag.db3", "/rosout", "rcl_interfaces/msg/Log"),
        ("flight.bin", "", "2 IMUs: IMU.0, IMU.1"),
        ("flight.ulg", "sensor", "sensor_combined"),
    ] {
        let said = of(file, topic).ok_or_else(|| format!("{file}, `{topic}`: read"))?;
        check(said.contains(words), format!("{file}, `{topic}`: {said}"))?;
    }
    // Columns of several lengths are several tables.
    let said = read(&seeds().join("stored.npz"), &named(&["gyro.1", "rate"])).err().map(|e| e.cause);
    check(said.as_deref().is_some_and(|s| s.contains("no column `rate`")), format!("{said:?}"))?;
    let wrong = folder.path().join("wrong.bag");
    let mut bytes = std::fs::read(seeds().join("plain.bag"))?;
    bytes[1] = b'X';
    std::fs::write(&wrong, &bytes)?;
    let said = read(&wrong, &Request::default()).err().map(|e| e.cause);
    check(said.as_deref().is_some_and(|s| s.contains("binary data")), format!("{said:?}"))
}

fn bombs() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    // A megabyte of blank lines 256 times over, in Zstandard's own way: blocks of one repeated byte
    // (RFC 8878, 3.1.1.2.2).
    let mut bytes = vec![0x28, 0xb5, 0x2f, 0xfd, 0x00, 0x58];
    let block = |last: u32| ((128u32 << 10) << 3 | 1 << 1 | last).to_le_bytes();
    for k in 0..2048 {
        bytes.extend_from_slice(&block(u32::from(k == 2047))[..3]);
        bytes.push(b'\n');
    }
    let path = folder.path().join("bomb.csv.zst");
    std::fs::write(&path, [b"".as_slice(), &bytes].concat())?;
    let said = read(&path, &Request { rate_hz: Some(1.0), ..Request::default() }).err();
    let words = said.as_ref().map(|e| e.cause.clone()).unwrap_or_default();
    check(words.contains("thousandfold") || words.contains("no row"), format!("{said:?}"))?;
    // A page that is said to become four gigabytes.
    let mut table = std::fs::read(seeds().join("zstd.mcap"))?;
    let at = table.windows(4).position(|w| w == b"zstd").ok_or("compression")? - 16;
    table[at..at + 8].copy_from_slice(&(4u64 << 30).to_le_bytes());
    let path = folder.path().join("bomb.mcap");
    std::fs::write(&path, &table)?;
    let words = read(&path, &Request::default()).err().map(|e| e.cause).unwrap_or_default();
    check(words.contains("256 MiB"), words)
}

fn ways_in() -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let rows: String =
        (0..400).map(|k| format!("{:.2},{:.4}\n", k as f64 * 0.01, f64::from(k * 7919 % 101) / 9.0)).collect();
    let text = format!("t_s,a\n{rows}");
    let euroc = folder.path().join("set/mav0/imu0");
    std::fs::create_dir_all(&euroc)?;
    std::fs::write(euroc.join("data.csv"), &text)?;
    std::fs::write(folder.path().join("log.csv"), &text)?;
    let run = |arguments: &[&str], input: Option<&str>| -> Result<Value, Failed> {
        let mut command = program();
        command.current_dir(folder.path()).args(arguments).arg("--json");
        command.stdin(input.map_or(Ok(std::process::Stdio::null()), |i| {
            std::fs::File::open(folder.path().join(i)).map(std::process::Stdio::from)
        })?);
        let output = command.output()?;
        check(output.status.success(), String::from_utf8_lossy(&output.stderr))?;
        Ok(serde_json::from_slice(&output.stdout)?)
    };
    let plain = run(&["allan", "log.csv"], None)?;
    for (arguments, input) in [(["allan", "-"], Some("log.csv")), (["allan", "set"], None)] {
        let same = run(&arguments, input)?;
        check(same["channels"] == plain["channels"], format!("{arguments:?}: other coefficients"))?;
        let sha256 = |v: &Value| v["recording"]["sha256"].clone();
        check(sha256(&same) == sha256(&plain), format!("{arguments:?}: another checksum"))?;
    }
    // Blanks, no headings, a quaternion: a TUM trajectory.
    let poses: String = (0..50).map(|k| format!("{}.{:02} {k} 0 0 0 0 0.6 0.8\n", 100 + k / 100, k % 100)).collect();
    std::fs::write(folder.path().join("poses.txt"), poses)?;
    let found = read(&folder.path().join("poses.txt"), &named(&["tx", "qw"]))?;
    check(found.columns[0].values[7] == 7.0 && found.columns[1].values[7] == 0.8, "columns of a TUM trajectory")?;
    check((found.rate_hz - 100.0).abs() < 1e-6, format!("{} Hz", found.rate_hz))
}

fn inspected() -> Result<(), Failed> {
    let seen = inspection::inspect(&seeds().join("plain.bag"), &Request::default())?;
    let names: Vec<&str> = seen.parts.iter().map(|p| p.name.as_str()).collect();
    check(names == ["/imu0", "/chatter"] && seen.part.as_deref() == Some("/imu0"), format!("{names:?}"))?;
    check(seen.clock.as_deref() == Some("stamp [ns]"), format!("{:?}", seen.clock))?;
    let output = program().args(["inspect", "--json"]).arg(seeds().join("flight.bin")).output()?;
    let json: Value = serde_json::from_slice(&output.stdout)?;
    check(json["schema"] == "proofmass.inspect/1" && json["obstacle"]["hint"].is_string(), json.to_string())?;
    let folder = tempfile::tempdir()?;
    let noise = |k: usize| ((k * 7919 + k * k * 104_729) % 1009) as f64 / 504.5 - 1.0;
    let rows: String = (0..12_000)
        .map(|k| {
            let [a, b, c] = [0, 31, 62].map(|s| 1e-3 * noise(k + s));
            format!("{:.2},{a},{b},{c},{a},{b},{}\n", k as f64 * 0.01, 9.8 + c)
        })
        .collect();
    std::fs::write(folder.path().join("still.csv"), format!("t_s,gx,gy,gz,ax,ay,az\n{rows}"))?;
    let output = program().current_dir(folder.path()).args(["inspect", "still.csv"]).output()?;
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    check(output.status.success() && said.contains("next: proofmass allan still.csv"), said)
}
