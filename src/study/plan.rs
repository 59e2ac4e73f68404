//! `[excitation]` → a waveform all members share, or a sine of each member's own.

use std::path::Path;
use std::sync::Arc;

use super::check::refuse;
use super::file::{Excitation, Kind};
use super::number::Number;
use super::tolerances::Tolerances;
use crate::error::{Error, Result};
use crate::excitation::multisine::Multisine;
use crate::excitation::random::{RandomVibration, Spectrum};
use crate::excitation::rectangle::Rectangle;
use crate::excitation::replay::Replay;
use crate::excitation::shock::Shock;
use crate::excitation::sweep::Sweep;
use crate::excitation::{self, MemberSine, Rest, Waveform};
use crate::recording;
use crate::units::STANDARD_GRAVITY_M_S2;

/// Most lines of a multisine: it is summed afresh at every step.
const MOST_LINES: u32 = 4096;

/// What the sensor is subjected to.
#[derive(Clone)]
pub struct Plan {
    /// Shared by all members, up to their gain.
    pub waveform: Arc<dyn Waveform>,
    /// How the members differ.
    pub variation: Variation,
    /// In words, with numbers and units.
    pub words: String,
    /// Highest frequency it is made of, where it is made of frequencies.
    pub highest_hz: Option<f64>,
    /// SHA-256 of the file that is replayed, hexadecimal.
    pub replayed_sha256: Option<String>,
}

impl Plan {
    /// Refuses a sine that steps of this length cannot see, and says of a spectrum that part of it folds back.
    ///
    /// # Errors
    /// A sine at or above half the rate of the steps.
    pub(super) fn resolved(mut self, name: &str, step_s: f64) -> Result<Self> {
        let half_hz = 0.5 / step_s;
        let Some(highest_hz) = self.highest_hz.filter(|f| *f >= half_hz * (1.0 - 1e-9)) else { return Ok(self) };
        let step = |share: f64| (share / highest_hz * 1e9).floor() / 1e9;
        if self.words.starts_with("sine") {
            return Err(refuse(
                name,
                format!(
                    "a sine of {highest_hz:?} Hz cannot be seen in steps of {step_s:?} s: half their rate is {half_hz:?} Hz"
                ),
                match step(0.25) {
                    0.0 => "check its exponent".to_owned(),
                    step => format!("`step_s` at or below {step:?} resolves it"),
                },
            ));
        }
        self.words += &format!(
            ". It is sampled every {step_s:?} s, so that what lies above {half_hz:?} Hz folds back below; `step_s` at or \
             below {:?} would resolve it",
            step(0.4)
        );
        Ok(self)
    }
}

/// How the excitation differs from member to member.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variation {
    /// Not at all.
    None,
    /// In size: `excitation::SIZE` is the member's gain.
    Gain,
    /// A sine of its own: size, frequency and phase are parameters.
    Sine,
}

/// Reads `[excitation]`; `folder` is what a relative `file` starts from.
pub(super) fn plan(
    name: &str,
    section: &Excitation,
    all: &mut Tolerances,
    duration_s: f64,
    seed: u64,
    folder: &Path,
) -> Result<Plan> {
    let kind = section.kind.unwrap_or_default();
    let reader = Reader { name, kind, section };
    reader.only(belonging(kind))?;
    let shared = |waveform: Arc<dyn Waveform>, words: String| Plan {
        waveform,
        variation: Variation::None,
        words,
        highest_hz: None,
        replayed_sha256: None,
    };
    let plan = match kind {
        Kind::Rest => shared(Arc::new(Rest), "at rest".into()),
        Kind::Sine => {
            let amplitude = reader.need("amplitude_m_s2", section.amplitude_m_s2)?;
            let frequency = reader.need("frequency_hz", section.frequency_hz)?;
            let phase = section.phase_rad.unwrap_or(Number::Fixed(0.0));
            let words = format!("sine of {amplitude} m/s² at {frequency} Hz");
            match (amplitude.fixed(), frequency.fixed(), phase.fixed()) {
                (Some(amplitude_m_s2), Some(frequency_hz), Some(phase_rad)) if frequency_hz > 0.0 => {
                    shared(Arc::new(MemberSine { amplitude_m_s2, frequency_hz, phase_rad }), words)
                }
                _ => {
                    all[&excitation::SIZE] = Some(amplitude);
                    all[&excitation::FREQUENCY] = Some(frequency);
                    all[&excitation::PHASE] = Some(phase);
                    super::check::signs(name, all)?;
                    let words = words + ", drawn per member";
                    Plan {
                        waveform: Arc::new(Rest),
                        variation: Variation::Sine,
                        words,
                        highest_hz: None,
                        replayed_sha256: None,
                    }
                }
            }
        }
        Kind::Rectangle => {
            let (amplitude, start_s) = (reader.need("amplitude_m_s2", section.amplitude_m_s2)?, reader.start()?);
            let length_s = reader.positive("length_s", section.length_s)?;
            let words = format!("rectangle of {amplitude} m/s² from {start_s} s for {length_s} s");
            let shape = |amplitude_m_s2| Arc::new(Rectangle { amplitude_m_s2, start_s, length_s }) as Arc<dyn Waveform>;
            sized(all, amplitude, shape, words)
        }
        Kind::Sweep => {
            let amplitude = reader.need("amplitude_m_s2", section.amplitude_m_s2)?;
            let (from_hz, to_hz) = reader.band()?;
            let words = format!("sweep of {amplitude} m/s² from {from_hz} Hz to {to_hz} Hz over the run");
            let shape = |amplitude_m_s2| {
                Arc::new(Sweep { amplitude_m_s2, from_hz, to_hz, length_s: duration_s }) as Arc<dyn Waveform>
            };
            sized(all, amplitude, shape, words)
        }
        Kind::Multisine => {
            let rms = reader.need("rms_m_s2", section.rms_m_s2)?;
            let (from_hz, to_hz) = reader.band()?;
            let lines = section.lines.ok_or_else(|| reader.missing("lines"))?;
            if lines == 0 || lines > MOST_LINES {
                return Err(refuse(
                    name,
                    format!("`excitation.lines` = {lines}: need 1 to {MOST_LINES}"),
                    "for a dense spectrum use kind = \"random\"",
                ));
            }
            let words = format!("multisine of {rms} m/s² rms, {lines} lines from {from_hz} Hz to {to_hz} Hz");
            let shape = |rms_m_s2| Arc::new(Multisine::new(rms_m_s2, from_hz, to_hz, lines, seed)) as Arc<dyn Waveform>;
            sized(all, rms, shape, words)
        }
        Kind::Random => {
            let spectrum = reader.spectrum()?;
            let points = &spectrum.points;
            let words = format!(
                "random vibration of {:.2} Grms from {} Hz to {} Hz",
                spectrum.grms(),
                points[0].0,
                points[points.len() - 1].0
            );
            shared(Arc::new(RandomVibration::new(&spectrum, duration_s, seed)), words)
        }
        Kind::Shock => {
            let (peak, start_s) = (reader.need("peak_g", section.peak_g)?, reader.start()?);
            let length_s = reader.positive("length_s", section.length_s)?;
            let words = format!("half-sine shock of {peak} g for {length_s} s at {start_s} s");
            let shape = |peak_m_s2| Arc::new(Shock { peak_m_s2, start_s, length_s }) as Arc<dyn Waveform>;
            sized(all, peak.scaled(STANDARD_GRAVITY_M_S2), shape, words)
        }
        Kind::Replay => {
            let (replay, sha256) = reader.replay(folder, duration_s)?;
            let scale = section.scale.unwrap_or(Number::Fixed(1.0));
            let column = section.column.clone().unwrap_or_default();
            let words =
                format!("replay of column {column}, {} samples at {} Hz", replay.samples_m_s2.len(), replay.rate_hz);
            let shape = |factor: f64| {
                let samples_m_s2 = replay.samples_m_s2.iter().map(|v| v * factor).collect();
                Arc::new(Replay { samples_m_s2, rate_hz: replay.rate_hz }) as Arc<dyn Waveform>
            };
            Plan { replayed_sha256: Some(sha256), ..sized(all, scale, shape, words) }
        }
    };
    Ok(Plan { highest_hz: highest_hz(section), ..plan })
}

/// Highest frequency that the keys name.
fn highest_hz(section: &Excitation) -> Option<f64> {
    let of = |number: Option<Number>| number.map(|n| n.quantile(0.99, true));
    let table = section.psd_g2_hz.as_ref().and_then(|t| t.last()).map(|point| point[0]);
    [of(section.frequency_hz), of(section.from_hz), of(section.to_hz), table].into_iter().flatten().reduce(f64::max)
}

/// A shape of fixed size, or of unit size with the members' gain.
fn sized(all: &mut Tolerances, size: Number, shape: impl Fn(f64) -> Arc<dyn Waveform>, words: String) -> Plan {
    match size.fixed() {
        Some(value) => {
            Plan { waveform: shape(value), variation: Variation::None, words, highest_hz: None, replayed_sha256: None }
        }
        None => {
            all[&excitation::SIZE] = Some(size);
            let words = words + ", drawn per member";
            Plan { waveform: shape(1.0), variation: Variation::Gain, words, highest_hz: None, replayed_sha256: None }
        }
    }
}

/// Keys that a kind takes.
fn belonging(kind: Kind) -> &'static [&'static str] {
    match kind {
        Kind::Rest => &[],
        Kind::Rectangle => &["amplitude_m_s2", "start_s", "length_s"],
        Kind::Sine => &["amplitude_m_s2", "frequency_hz", "phase_rad"],
        Kind::Sweep => &["amplitude_m_s2", "from_hz", "to_hz"],
        Kind::Multisine => &["rms_m_s2", "from_hz", "to_hz", "lines"],
        Kind::Random => &["psd_g2_hz"],
        Kind::Shock => &["peak_g", "start_s", "length_s"],
        Kind::Replay => &["file", "column", "scale", "rate_hz", "time"],
    }
}

/// One section being read, with the words its errors need.
struct Reader<'a> {
    name: &'a str,
    kind: Kind,
    section: &'a Excitation,
}

impl Reader<'_> {
    fn word(&self) -> String {
        format!("{:?}", self.kind).to_lowercase()
    }

    /// Refuses keys that belong to another kind.
    fn only(&self, belonging: &[&str]) -> Result<()> {
        let s = self.section;
        let given = [
            ("amplitude_m_s2", s.amplitude_m_s2.is_some()),
            ("frequency_hz", s.frequency_hz.is_some()),
            ("phase_rad", s.phase_rad.is_some()),
            ("start_s", s.start_s.is_some()),
            ("length_s", s.length_s.is_some()),
            ("from_hz", s.from_hz.is_some()),
            ("to_hz", s.to_hz.is_some()),
            ("rms_m_s2", s.rms_m_s2.is_some()),
            ("lines", s.lines.is_some()),
            ("psd_g2_hz", s.psd_g2_hz.is_some()),
            ("peak_g", s.peak_g.is_some()),
            ("file", s.file.is_some()),
            ("column", s.column.is_some()),
            ("scale", s.scale.is_some()),
            ("rate_hz", s.rate_hz.is_some()),
            ("time", s.time.is_some()),
        ];
        match given.iter().find(|(key, is_given)| *is_given && !belonging.contains(key)) {
            Some((key, _)) if s.kind.is_none() => Err(refuse(
                self.name,
                format!("`excitation.{key}` is given without `kind`"),
                "add kind = \"sine\", \"rectangle\", \"sweep\", \"multisine\", \"random\", \"shock\" or \"replay\"",
            )),
            Some((key, _)) if belonging.is_empty() => Err(refuse(
                self.name,
                format!("`excitation.{key}` does not belong to kind = \"rest\""),
                "take the key out, or choose another kind",
            )),
            Some((key, _)) => Err(refuse(
                self.name,
                format!("`excitation.{key}` does not belong to kind = \"{}\"", self.word()),
                format!("it takes {}", belonging.join(", ")),
            )),
            None => Ok(()),
        }
    }

    fn missing(&self, key: &str) -> Error {
        refuse(
            self.name,
            format!("`excitation.{key}` is missing: kind = \"{}\" needs it", self.word()),
            format!("it takes {}", belonging(self.kind).join(", ")),
        )
    }

    fn need(&self, key: &str, number: Option<Number>) -> Result<Number> {
        number.ok_or_else(|| self.missing(key))
    }

    /// A number that all members must share.
    fn fixed(&self, key: &str, number: Option<Number>) -> Result<f64> {
        self.need(key, number)?.fixed().ok_or_else(|| {
            refuse(
                self.name,
                format!("`excitation.{key}` is drawn per member, but all members share the shape of a {}", self.word()),
                "give one number; the size (amplitude, rms, peak, scale) may be drawn, and all numbers of a sine",
            )
        })
    }

    fn positive(&self, key: &str, number: Option<Number>) -> Result<f64> {
        match self.fixed(key, number)? {
            value if value > 0.0 => Ok(value),
            value => Err(refuse(
                self.name,
                format!("`excitation.{key}` = {value}: need more than zero"),
                "give a positive number",
            )),
        }
    }

    fn start(&self) -> Result<f64> {
        match self.fixed("start_s", self.section.start_s.or(Some(Number::Fixed(0.0))))? {
            value if value >= 0.0 => Ok(value),
            value => Err(refuse(
                self.name,
                format!("`excitation.start_s` = {value} s: need zero or more"),
                "the run begins at zero",
            )),
        }
    }

    fn band(&self) -> Result<(f64, f64)> {
        Ok((self.positive("from_hz", self.section.from_hz)?, self.positive("to_hz", self.section.to_hz)?))
    }

    fn spectrum(&self) -> Result<Spectrum> {
        let table = self.section.psd_g2_hz.as_ref().ok_or_else(|| self.missing("psd_g2_hz"))?;
        let points: Vec<(f64, f64)> = table.iter().map(|p| (p[0], p[1])).collect();
        let increasing = points.windows(2).all(|w| w[0].0 < w[1].0);
        let positive = points.iter().all(|(f, p)| *f > 0.0 && *p > 0.0 && f.is_finite() && p.is_finite());
        if points.len() < 2 || !increasing || !positive {
            return Err(refuse(
                self.name,
                "`excitation.psd_g2_hz` needs two points or more, frequencies increasing, all numbers above zero",
                "e.g. psd_g2_hz = [[20.0, 0.01], [2000.0, 0.01]] in Hz and g²/Hz",
            ));
        }
        Ok(Spectrum { points })
    }

    /// The recording to replay, and the SHA-256 of its file.
    fn replay(&self, folder: &Path, duration_s: f64) -> Result<(Replay, String)> {
        let file = self.section.file.as_ref().ok_or_else(|| self.missing("file"))?;
        let column = self.section.column.as_ref().ok_or_else(|| self.missing("column"))?;
        let (rate_hz, time) = (self.section.rate_hz, self.section.time.clone());
        if rate_hz.is_none() && time.is_none() {
            return Err(refuse(
                self.name,
                "a replay needs its clock",
                "add rate_hz = …, or time = \"t_s\" with the heading of a time column in s",
            ));
        }
        let request = recording::Request { columns: vec![column.clone()], rate_hz, time, rows: None };
        let mut recording = recording::read(&folder.join(file), &request)?;
        let samples_m_s2 = recording.columns.pop().map(|c| c.values).unwrap_or_default();
        let replay = Replay { samples_m_s2, rate_hz: recording.rate_hz };
        if replay.length_s() + 1.0 / replay.rate_hz < duration_s * (1.0 - 1e-9) {
            return Err(refuse(
                self.name,
                format!("the recording to replay lasts {} s, the run {duration_s} s", replay.length_s()),
                format!("set duration_s to {} or less", replay.length_s()),
            ));
        }
        Ok((replay, recording.sha256))
    }
}
