//! Says what an Allan curve means, in sentences: what each coefficient is, what the data do not
//! support, and when a fit is bad.

use crate::grouped::{Said, grouped};
use crate::table::Table;
use proofmass_base::number::{duration, rounded, significant, superscript};
use proofmass_numerics::numerics::allan::fitted::Fit;
use proofmass_numerics::numerics::allan::law::{TERMS, Term};
use proofmass_recording::finding::Finding;
use proofmass_recording::noise::{Channel, Deviation, Noise};
use proofmass_recording::unit::Quantity;

pub(super) const TABLE_NOTE: &str = "Values with their 95 % interval; “<” is an upper limit (95 %) of a term that the data \
    do not support. σ(1 s) is the Allan deviation at 1 s in \
    units of N, which many tools print as N whatever the slope there. N itself is the two-sided coefficient of IEEE \
    952; a datasheet's one-sided density is √2 times it, and both are \
    shown. B by minimum is the lowest Allan deviation over 0.664, as datasheets state it; it bounds the flicker from above, and is marked “≤” \
    where the curve still falls at its end. A \
    star marks a curve that the five terms do not describe.";

pub(super) const CONVENTIONS: [&str; 7] = [
    "Overlapping Allan deviation (IEEE 952, NIST SP 1065), fully overlapped up to 128 samples, with 80 to 128 window \
    starts per averaging time beyond; averaging times up to a third of the recording.",
    "Whiskers: 95 % intervals from χ² with the equivalent degrees of freedom of overlapping windows, computed for the fitted \
     mixture of noises and for the kurtosis of the readings' changes: heavy tails make them wider.",
    "Laws of the Allan variance: quantisation 3Q²/τ²; white noise N²/τ; flicker (2 ln 2/π)B²; random walk K²τ/3; ramp R²τ²/2.",
    "Fit: generalised least squares on the variance at octave-spaced averaging times with the full covariance of the points, \
     no coefficient negative. Behind an on-chip filter the shortest times are left out, and what the filter still takes \
     above them, a share of N² that falls as 1/τ², is fitted with the laws.",
    "Intervals: Monte Carlo test inversion, 400 simulated curves per hypothesis; the other coefficients are refitted under \
     each. A term is supported if zero lies outside.",
    "White noise: σ of a sample = N√f = n√(f/2) at the sampling rate f; n = √2 N is the one-sided density.",
    "Spectrum: Welch, Hann windows overlapping by half, one-sided.",
];

/// A value in its datasheet unit with interval, or its upper limit.
fn coefficient(channel: &Channel, term: Term) -> String {
    let Some(fit) = &channel.fit else { return "–".into() };
    let c = fit.coefficients[term as usize];
    let (_, factor) = channel.unit.coefficient(term);
    if c.supported() {
        interval(c.value * factor, c.ci95.map(|e| e * factor))
    } else {
        format!("< {}", significant(c.ci95[1] * factor, 2))
    }
}

/// A value and its ends; a power of ten stands once, behind all three.
fn interval(value: f64, ci95: [f64; 2]) -> String {
    let power = if value > 0.0 { value.log10().floor() as i32 } else { 0 };
    let (shrink, times) = if (-3..6).contains(&power) {
        (1.0, String::new())
    } else {
        (10f64.powi(power), format!(" ×10{}", superscript(power)))
    };
    let [value, low, high] = [value, ci95[0], ci95[1]].map(|v| significant(v / shrink, 3));
    format!("{value} ({low} – {high}){times}")
}

/// One row per channel: every coefficient with its interval or upper limit. Two tables, as one
/// would be wider than a screen: white noise and bias instability, then what is slower or faster.
pub fn tables(noise: &Noise) -> [Table; 2] {
    let mut first = Table::new(&["channel", "N", "density n", "B by minimum", "B"]);
    let mut second = Table::new(&["channel", "mean", "σ(1 s)", "K", "R", "Q"]);
    for channel in &noise.channels {
        let with_unit = |term| format!("{} {}", coefficient(channel, term), channel.unit.coefficient(term).0);
        let density = channel.fit.as_ref().map_or("–".into(), |fit| {
            let (unit, factor) = channel.unit.density();
            let white = fit.coefficients[Term::White as usize];
            let digits = if white.supported() { white.value } else { white.ci95[1] };
            let sign = if white.supported() { "" } else { "< " };
            format!("{sign}{} {unit}", significant(digits * factor * 2f64.sqrt(), 3))
        });
        let stability = channel.bias_stability().map_or("–".into(), |(value, ci95)| {
            let (unit, factor) = channel.unit.coefficient(Term::Flicker);
            let limit = if channel.still_falls() { "≤ " } else { "" };
            format!("{limit}{} {unit}", interval(value * factor, ci95.map(|e| e * factor)))
        });
        let star = if channel.fit.as_ref().is_some_and(|f| !f.good()) { " *" } else { "" };
        let at_one_second = channel.at_one_second().map_or("–".into(), |d| {
            let (unit, factor) = channel.unit.coefficient(Term::White);
            format!("{} {unit}", interval(d.value * factor, d.ci95.map(|e| e * factor)))
        });
        let name = format!("{}{star}", channel.name);
        first.row([name.clone(), with_unit(Term::White), density, stability, with_unit(Term::Flicker)]);
        let slower = [Term::Walk, Term::Ramp, Term::Quantisation].map(with_unit);
        let (unit, factor) = channel.unit.signal();
        let mean = format!("{} {unit}", significant(channel.mean * factor, 5));
        second.row([name, mean, at_one_second].into_iter().chain(slower));
    }
    [first, second]
}

/// Lists what a person at a terminal should know next to the table.
pub fn notes(noise: &Noise) -> Vec<String> {
    let source = &noise.source;
    let mut out = vec![format!(
        "{} samples at {} Hz: {}",
        source.samples,
        rounded(source.rate_hz, 6),
        duration(source.samples as f64 / source.rate_hz)
    )];
    out.extend(source.findings.iter().map(|f| format!("found: {f}")));
    let measured: Vec<&Channel> = noise.channels.iter().filter(|c| !c.curve.is_empty()).collect();
    let mut said = Vec::new();
    for channel in &measured {
        let of = |sentence: String, ranges: bool| Said { of: channel.name.clone(), sentence, ranges };
        said.push(of(verdict(channel), channel.fit.as_ref().is_some_and(Fit::good)));
        let about_spectrum = if channel.fit.is_some() { 5 } else { 0 };
        let about = sentences(channel).into_iter().skip(about_spectrum);
        said.extend(about.map(|sentence| {
            let is_list = sentence.starts_with(LINES);
            of(sentence, !is_list)
        }));
    }
    out.extend(grouped(&said, measured.len()));
    out
}

/// Beginning of the sentence that lists frequencies, each of which stays as it is.
const LINES: &str = "Spectral lines at";

/// The answer in numbers: white noise and lowest Allan deviation of the gyros, the accelerometers
/// and the others.
pub fn answer(noise: &Noise) -> String {
    let kinds = [(Quantity::Gyro, "Gyro"), (Quantity::Accelerometer, "Accelerometer"), (Quantity::Unknown, "Channel")];
    let of = |(quantity, name): (Quantity, &str)| {
        let channels: Vec<&Channel> = noise.channels.iter().filter(|c| c.unit.quantity == quantity).collect();
        let unit = &channels.first()?.unit;
        let factor = |c: &Channel, term: Term| c.unit.coefficient(term).1;
        let white = |c: &&Channel| {
            let white = c.fit.as_ref()?.coefficients[Term::White as usize];
            white.supported().then(|| white.value * factor(c, Term::White))
        };
        let white: Vec<f64> = channels.iter().filter_map(white).collect();
        let lowest: Vec<(&Channel, Deviation)> = channels.iter().filter_map(|c| Some((*c, c.minimum?))).collect();
        let mut parts = Vec::new();
        if !white.is_empty() {
            parts.push(format!("N = {} {}", range(&white), unit.coefficient(Term::White).0));
        }
        if !lowest.is_empty() {
            let unit = unit.coefficient(Term::Flicker).0;
            let values: Vec<f64> = lowest.iter().map(|(c, d)| d.value * factor(c, Term::Flicker)).collect();
            let times: Vec<f64> = lowest.iter().map(|(_, d)| d.tau_s).collect();
            let falling: Vec<&str> = channels.iter().filter(|c| c.still_falls()).map(|c| c.name.as_str()).collect();
            let floor = match falling.len() {
                0 => String::new(),
                n if n == channels.len() => ", where the curve still falls: no floor was reached, so this is an upper \
                                             limit of the bias instability, and a longer log is lower"
                    .to_owned(),
                _ => format!(" (the curve of {} still falls there: no floor was reached)", falling.join(", ")),
            };
            parts.push(format!("lowest Allan deviation {} {unit} at {} s{floor}", range(&values), range(&times)));
        }
        let plural = if channels.len() == 1 { "" } else { "s" };
        (!parts.is_empty()).then(|| format!("{name}{plural}: {}", parts.join(", ")))
    };
    let length = duration(noise.source.samples as f64 / noise.source.rate_hz);
    let groups: Vec<String> = kinds.into_iter().filter_map(of).collect();
    match groups.is_empty() {
        true if noise.source.findings.iter().any(|f| matches!(f, Finding::Constant { .. })) => {
            "Nothing to estimate: no channel changes.".to_owned()
        }
        true => format!("{length} at rest is too short to estimate any coefficient."),
        false => format!("{}. From {length} at rest.", groups.join(". ")),
    }
}

/// The least and the largest of values, or the one that they round to.
fn range(values: &[f64]) -> String {
    let (low, high) = values.iter().fold((f64::INFINITY, 0.0f64), |(l, h), v| (l.min(*v), h.max(*v)));
    let [low, high] = [low, high].map(|v| significant(v, 3));
    if low == high { low } else { format!("{low} to {high}") }
}

/// The page's first sentences.
pub(super) fn lede(noise: &Noise) -> String {
    let bad: Vec<&str> =
        noise.channels.iter().filter(|c| c.fit.as_ref().is_some_and(|f| !f.good())).map(|c| c.name.as_str()).collect();
    let judged = match bad.len() {
        0 => "The five laws of IEEE 952 describe every channel's curve.".to_owned(),
        _ => {
            format!(
                "The five laws of IEEE 952 do not describe {}: another effect is present; see that channel.",
                bad.join(", ")
            )
        }
    };
    format!("{} {judged}", answer(noise))
}

/// Says whether the laws hold for a channel.
pub(super) fn verdict(channel: &Channel) -> String {
    let Some(fit) = &channel.fit else {
        return "Too short for coefficients: a fit needs averaging times over four octaves (24 samples).".into();
    };
    let first = channel.curve.first().map_or(0.0, |d| d.tau_s);
    let mut out = if fit.good() {
        format!(
            "The fitted terms describe the curve from τ = {} to {} (p = {}).",
            duration(fit.from_s),
            duration(fit.to_s),
            significant(fit.p_value, 2)
        )
    } else {
        format!(
            "No sum of the five laws fits this curve (p < {}): it departs from the best one by about {} %, most at \
             τ = {}, where it is {} times the fit. The intervals allow for that. Typical causes are vibration, \
             temperature and motion; `proofmass diagnose` with kind = \"static\" identifies which.",
            significant(proofmass_numerics::numerics::allan::fitted::BAD, 1),
            significant(100.0 * fit.discrepancy, 2),
            duration(fit.worst.0),
            significant(fit.worst.1, 3)
        )
    };
    if fit.from_s > 1.5 * first {
        out += &format!(
            " Averaging times below {} follow none of the laws, as with an on-chip filter, and were excluded.",
            duration(fit.from_s)
        );
    }
    out
}

/// One sentence per term, then what the spectrum and the numbers themselves show.
pub(super) fn sentences(channel: &Channel) -> Vec<String> {
    let mut out = Vec::new();
    if channel.fit.is_some() {
        out.extend(
            [Term::White, Term::Flicker, Term::Walk, Term::Ramp, Term::Quantisation].map(|t| of_term(channel, t)),
        );
    }
    if let Some(ratio) = channel.roll_off {
        let side = if ratio < 1.0 {
            "the reading is low-pass filtered before it is logged, so the noise of single samples says little about N"
        } else {
            "the noise grows towards half the rate: aliased vibration, or differences of a rounded integral"
        };
        out.push(format!(
            "Near half the sampling rate the density is {} times that in the middle of the band: {side}.",
            significant(ratio, 2)
        ));
    }
    if !channel.lines.is_empty() {
        let lines: Vec<String> = channel
            .lines
            .iter()
            .map(|l| format!("{} Hz (× {})", significant(l.frequency_hz, 4), significant(l.excess, 2)))
            .collect();
        out.push(format!(
            "{LINES} {}: vibration or pickup. Their contribution to the Allan curve was removed before \
             the fit.",
            lines.join(", ")
        ));
    }
    out.extend(channel.step.map(|step| of_step(channel, step)));
    out
}

/// If the noise before rounding is at least this many steps, rounding acts as added white noise (Widrow & Kollár,
/// *Quantization noise*, 2008, §4).
const DITHERED: f64 = 0.5;

/// Says what rounding to steps does to the noise.
fn of_step(channel: &Channel, step: f64) -> String {
    let (unit, factor) = channel.unit.signal();
    let added = step / 12f64.sqrt();
    let stated = format!("The readings are quantised in steps of {} {unit}", significant(step * factor, 3));
    let least = DITHERED.hypot(1.0 / 12f64.sqrt()) * step;
    if channel.curve.first().is_some_and(|shortest| shortest.value < least) {
        return format!(
            "{stated}, more than the noise of a sample: most of it is lost in rounding, and N and B of the sensor may \
             be larger or smaller than stated; log it at a finer resolution."
        );
    }
    format!(
        "{stated}; quantisation alone adds {} {unit} rms of white noise per sample.",
        significant(added * factor, 2)
    )
}

fn of_term(channel: &Channel, term: Term) -> String {
    let (unit, _) = channel.unit.coefficient(term);
    let supported = channel.fit.as_ref().is_some_and(|f| f.coefficients[term as usize].supported());
    let name = name(term);
    let text = coefficient(channel, term);
    if supported && term == Term::Quantisation && !channel.lines.is_empty() {
        return format!(
            "{name}: Q = {text} {unit}; residual vibration has the same slope, so treat it as an upper limit."
        );
    }
    if supported {
        return format!("{name}: {} = {text} {unit}.", term.symbol());
    }
    format!("{name}: not supported by the data; {} is {} {unit} (95 %).", term.symbol(), text.replacen('<', "below", 1))
}

/// A term's name in words.
pub(super) fn name(term: Term) -> &'static str {
    ["Quantisation", "White noise", "Flicker (bias instability)", "Random walk", "Ramp"][term as usize]
}

/// Terms worth a line in the figure: supported, and the largest part of the fit somewhere on the
/// curve.
pub(super) fn dominant(channel: &Channel) -> Vec<Term> {
    let Some(fit) = &channel.fit else { return Vec::new() };
    let squares = fit.squares();
    let rules = |term: Term| {
        channel.curve.iter().any(|d| {
            squares[term as usize] * term.variance(d.tau_s)
                > 0.4 * proofmass_numerics::numerics::allan::law::variance(&squares, d.tau_s)
        })
    };
    TERMS.into_iter().filter(|t| fit.coefficients[*t as usize].supported() && rules(*t)).collect()
}
