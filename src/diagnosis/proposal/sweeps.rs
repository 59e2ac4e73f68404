//! Headings by which lock-in amplifiers and network analysers name the columns of a sweep, and the
//! model that follows.

use crate::document::toml_string;
use crate::recording::inspection::{Column, Rows};
use crate::recording::time_unit::TimeUnit;

/// Roles of a sweep's columns and the words of a heading that say each, the plainest first. A column
/// has the first role that takes it: `Sine Out Amplitude` is a drive.
const WORDS: [(&str, &[&str]); 7] = [
    ("frequency", &["frequency", "freq", "f", "omega", "ω"]),
    ("phase", &["phase", "theta", "θ"]),
    ("drive", &["drive", "excitation", "osc", "oscillator", "sine"]),
    ("x", &["x", "re", "real", "inphase"]),
    ("y", &["y", "im", "imag", "imaginary", "quadrature"]),
    (GAIN, &["gain"]),
    ("amplitude", &["magnitude", "mag", "amplitude", "r"]),
];
/// Amplitude over the drive, as analysers of frequency response write it: an amplitude in another
/// column is the drive's then, and is in the gain already.
const GAIN: &str = "gain";
/// Roles in the order in which a model names them.
const ROLES: [&str; 6] = ["frequency", "x", "y", "amplitude", "phase", "drive"];
/// S parameters in the order in which one is taken for the response: what passes through, then what
/// is reflected.
const PARAMETERS: [&str; 2] = ["s21", "s11"];

fn words(column: &Column) -> Vec<String> {
    let lower = column.name.to_lowercase().replace("in-phase", "inphase");
    lower.split(|c: char| !c.is_alphanumeric()).filter(|w| !w.is_empty()).map(str::to_owned).collect()
}

/// The S parameter whose part a column is: `s21_re` is of s21.
fn parameter(column: &Column) -> Option<String> {
    let [name, part] = <[String; 2]>::try_from(words(column)).ok()?;
    let is_one = name.len() == 3 && name.starts_with('s') && name[1..].bytes().all(|b| b.is_ascii_digit());
    (is_one && matches!(part.as_str(), "re" | "im")).then_some(name)
}

/// The S parameter that is taken, and all that there are.
fn parameters(rows: &Rows) -> Option<(&'static str, Vec<String>)> {
    let mut all: Vec<String> = rows.columns.iter().filter_map(parameter).collect();
    all.dedup();
    let taken = PARAMETERS.into_iter().find(|taken| all.iter().any(|name| name == taken))?;
    Some((taken, all))
}

/// Columns by the role that their heading says, each role once.
fn by_role(rows: &Rows) -> Vec<(&'static str, &Column)> {
    let taken = parameters(rows).map(|(taken, _)| taken);
    let mut free: Vec<&Column> =
        rows.columns.iter().filter(|c| parameter(c).is_none_or(|name| taken == Some(name.as_str()))).collect();
    let mut found: Vec<(&str, &Column)> = Vec::new();
    for (role, known) in WORDS {
        let of = |word: &&str| -> Vec<&Column> {
            free.iter().copied().filter(|c| words(c).iter().any(|own| own == word)).collect()
        };
        let alike = known.iter().map(of).find(|columns| !columns.is_empty());
        if let Some([only]) = alike.as_deref() {
            found.push((role, only));
            free.retain(|c| c != only);
        }
    }
    if found.iter().any(|(role, _)| *role == GAIN) {
        found.retain(|(role, _)| !matches!(*role, "amplitude" | "drive"));
        found.iter_mut().filter(|(role, _)| *role == GAIN).for_each(|(role, _)| *role = "amplitude");
    }
    found
}

/// A frequency next to one half of a reading alone: the columns of both.
pub(super) fn halved(rows: &Rows) -> Option<[&str; 2]> {
    let found = by_role(rows);
    let named = |wanted: &str| found.iter().find(|(role, _)| *role == wanted).map(|(_, column)| column.name.as_str());
    let half = ["amplitude", "x", "y"].into_iter().find_map(named);
    named("frequency").zip(half).filter(|_| columns(rows).is_none()).map(|(frequency, half)| [frequency, half])
}

/// The columns of a sweep by role; `None` where the headings do not say all of one pair.
pub(super) fn columns(rows: &Rows) -> Option<Vec<(&'static str, &Column)>> {
    let mut found = by_role(rows);
    let has = |role: &str| found.iter().any(|(r, _)| *r == role);
    let unused = match (has("frequency"), has("x") && has("y"), has("amplitude") && has("phase")) {
        (true, true, _) => ["amplitude", "phase"],
        (true, false, true) => ["x", "y"],
        _ => return None,
    };
    found.retain(|(role, _)| !unused.contains(role));
    found.sort_by_key(|(role, _)| ROLES.iter().position(|known| known == role));
    Some(found)
}

/// The model of a sweep.
pub(super) fn model(rows: &Rows, clock: Option<&str>) -> String {
    let note = match parameters(rows) {
        Some((taken, all)) if all.len() > 1 => format!(" # {taken} of {}", all.join(", ")),
        _ => String::new(),
    };
    let of = |(role, column): (&str, &Column)| {
        let note = if parameter(column).is_some() { note.as_str() } else { "" };
        format!("{role} = {}{note}\n", toml_string(&column.name))
    };
    let columns: String = columns(rows).unwrap_or_default().into_iter().map(of).collect();
    // A `timestamp` without a unit counts ticks of the instrument.
    let in_seconds = |name: &&str| TimeUnit::of_heading(name).is_some() || !name.to_lowercase().contains("timestamp");
    let time = clock.filter(in_seconds).map_or(String::new(), |name| format!("time = {}\n", toml_string(name)));
    format!("kind = \"response\"\n[columns]\n{columns}{time}")
}

#[cfg(test)]
mod tests {
    use super::super::tests::model;
    use crate::model::{Model, ResponseColumns};

    fn sweep(names: &[&str]) -> ResponseColumns {
        let Ok(Model::Response(found)) = model(names) else { panic!("{names:?} are a sweep") };
        found.columns
    }

    #[test]
    fn a_frequency_with_two_components_is_a_sweep_and_without_them_is_none() {
        let columns = sweep(&["frequency_hz", "x_v", "y_v", "drive_v"]);
        assert_eq!((columns.frequency.as_str(), columns.x.as_deref()), ("frequency_hz", Some("x_v")));
        assert_eq!((columns.drive.as_deref(), columns.time), (Some("drive_v"), None));
        assert_eq!(sweep(&["f_kHz", "r_V", "theta_deg"]).phase.as_deref(), Some("theta_deg"));
        assert!(!matches!(model(&["frequency_hz", "position_m"]), Ok(Model::Response(_))));
    }

    #[test]
    fn of_s_parameters_the_transmission_is_taken_and_of_one_port_the_reflection() {
        let two = ["frequency_hz", "s11_re", "s11_im", "s21_re", "s21_im", "s12_re", "s12_im", "s22_re", "s22_im"];
        let columns = sweep(&two);
        assert_eq!((columns.x.as_deref(), columns.y.as_deref()), (Some("s21_re"), Some("s21_im")));
        assert_eq!(sweep(&two[..3]).x.as_deref(), Some("s11_re"));
    }

    // As the instruments write them: Zurich Instruments LabOne, Stanford Research SR830 and SR860,
    // Omicron Bode 100, Keysight InfiniiVision.
    #[test]
    fn headings_of_common_instruments_say_which_column_is_which() {
        let frequency = |names: &[&str]| sweep(names).frequency;
        let labone = [
            "chunk",
            "timestamp",
            "grid",
            "frequency",
            "frequencystddev",
            "x",
            "xstddev",
            "y",
            "ystddev",
            "r",
            "rstddev",
            "phase",
            "phasestddev",
            "bandwidth",
            "tc",
            "settling",
        ];
        let columns = sweep(&labone);
        assert_eq!((columns.x.as_deref(), columns.y.as_deref(), columns.phase), (Some("x"), Some("y"), None));
        let polar = sweep(&["chunk", "timestamp", "frequency", "r", "phase [rad]"]);
        assert_eq!((polar.amplitude.as_deref(), polar.phase.as_deref()), (Some("r"), Some("phase [rad]")));
        assert_eq!(polar.time, None);
        let stanford = sweep(&["Freq (Hz)", "X (V)", "Y (V)", "R (V)", "Theta (deg)", "Sine Out Amplitude (V)"]);
        assert_eq!((stanford.x.as_deref(), stanford.drive.as_deref()), (Some("X (V)"), Some("Sine Out Amplitude (V)")));
        let stanford = sweep(&["Frequency (kHz)", "R (V)", "θ (°)", "Osc (V)"]);
        assert_eq!((stanford.phase.as_deref(), stanford.drive.as_deref()), (Some("θ (°)"), Some("Osc (V)")));
        let bode = sweep(&["Frequency (Hz)", "Gain: Magnitude (dB)", "Gain: Phase (°)"]);
        assert_eq!(
            (bode.amplitude.as_deref(), bode.phase.as_deref()),
            (Some("Gain: Magnitude (dB)"), Some("Gain: Phase (°)"))
        );
        // The amplitude there is that of the drive.
        let scope = sweep(&["#", "Frequency (Hz)", "Amplitude (Vpp)", "Gain (dB)", "Phase (°)"]);
        assert_eq!((scope.amplitude.as_deref(), scope.drive), (Some("Gain (dB)"), None));
        assert_eq!(frequency(&["f [Hz]", "In-phase (V)", "Quadrature (V)"]), "f [Hz]");
        // As a control, two traces that may each be the reading are no sweep.
        let two = [
            "Frequency (Hz)",
            "Channel 1 Magnitude (dB)",
            "Channel 1 Phase (°)",
            "Channel 2 Magnitude (dB)",
            "Channel 2 Phase (°)",
        ];
        assert!(!matches!(model(&two), Ok(Model::Response(_))));
    }
}
