//! The answer as the public document `proofmass.study/1`.

use serde::Serialize;

use super::Drift;
use super::compare::Outcome;
use super::expected::Expected;
use super::windows::{self, Drifted};
use crate::navigation::power_law::EXPONENTS;
use crate::statistics::jcgm101::{Linear, Stated};
use crate::statistics::{Machine, Origin, Summary, quantity};
use crate::study::Study;

/// Value of `schema` in the document.
pub const SCHEMA: &str = "proofmass.study/1";

/// The whole document; every list runs along `time_s`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Document {
    #[cfg_attr(feature = "schema", schemars(extend("const" = SCHEMA)))]
    schema: &'static str,
    name: String,
    version: &'static str,
    seed: u64,
    members: u64,
    failed: u64,
    backend: Backend,
    integrator: String,
    time_s: Vec<f64>,
    position_error_m: Distribution,
    velocity_error_m_s: Distribution,
    acceleration_error_m_s2: Distribution,
    tilt_error_rad: Distribution,
    closed_form: ClosedForm,
    growth: Vec<Power>,
    error_budget: Vec<BudgetRow>,
    /// The recorded log in windows next to the prediction; absent where the study asks for none,
    /// empty without the log.
    #[serde(skip_serializing_if = "Option::is_none")]
    windows: Option<Vec<Windows>>,
    /// The same without windows that hold a knock, a jump or a filled gap, where there are such.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    windows_undisturbed: Vec<Windows>,
    findings: Vec<String>,
    /// The position error at the last report time, where a number of digits was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    jcgm101: Option<Jcgm101>,
    member_steps: u64,
    seconds: f64,
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Jcgm101 {
    #[serde(flatten)]
    stated: Stated,
    linear: Linear,
}

/// Device that an ensemble was integrated on.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Backend {
    kind: String,
    name: String,
    driver: String,
    precision: String,
    fused_multiply_add: String,
    /// Which members were integrated where, and why; left out where it was all of them, here, as
    /// asked.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    parts: Vec<Part>,
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Part {
    /// First member, and the one after the last.
    members: [u64; 2],
    kind: String,
    name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<String>,
}

/// The distribution of one quantity; every list runs along the report times.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Distribution {
    mean: Vec<f64>,
    sd: Vec<f64>,
    min: Vec<f64>,
    max: Vec<f64>,
    p01: Vec<f64>,
    p05: Vec<f64>,
    p50: Vec<f64>,
    p95: Vec<f64>,
    p99: Vec<f64>,
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct ClosedForm {
    position_error_m: Moments,
    velocity_error_m_s: Moments,
    acceleration_error_m_s2: Moments,
    tilt_error_rad: Moments,
    left_out: Vec<String>,
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Moments {
    mean: Vec<f64>,
    sd: Vec<f64>,
}

/// Windows of one length of one axis: the share of them inside the central 50, 90 and 99 % of the
/// prediction, and standard deviations in m (accelerometer) or rad (gyro, tilt).
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Windows {
    axis: String,
    seconds: f64,
    windows: usize,
    inside50: f64,
    inside90: f64,
    inside99: f64,
    sd_recorded: f64,
    sd_predicted: f64,
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Power {
    exponent: f64,
    fitted_m_per_s_to_the_exponent: f64,
    closed_form_m_per_s_to_the_exponent: f64,
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct BudgetRow {
    source: &'static str,
    position_sd_m: Vec<f64>,
    position_mean_m: Vec<f64>,
    share_of_variance: Vec<f64>,
}

impl Document {
    /// The same with more findings, before its own.
    pub fn with_findings(mut self, more: impl IntoIterator<Item = String>) -> Self {
        self.findings.splice(0..0, more);
        self
    }

    /// The same with the result to this many digits.
    pub fn with_digits(mut self, result: Option<(Stated, Linear)>) -> Self {
        self.jcgm101 = result.map(|(stated, linear)| Jcgm101 { stated, linear });
        self
    }

    /// The document of an answer.
    pub fn of(study: &Study, drift: &Drift) -> Self {
        let machine = &drift.statistics.machine;
        let distribution = |q| Distribution::of(&drift.at_report(q));
        let closed = |q| Moments::of(&drift.expected, q, &drift.report);
        let power = |k: usize| Power {
            exponent: EXPONENTS[k],
            fitted_m_per_s_to_the_exponent: drift.growth.fitted[k],
            closed_form_m_per_s_to_the_exponent: drift.growth.expected[k],
        };
        let budget = &drift.budget;
        let asked = study.compare.as_ref().is_some_and(|c| c.windows_s.is_some());
        let (findings, drifted): (Vec<String>, &[Drifted]) = match &drift.compared {
            Outcome::NotAsked => (Vec::new(), &[]),
            Outcome::Absent(file) => {
                (vec![format!("the log {file} is not on this machine: nothing was compared")], &[])
            }
            Outcome::Compared(comparison) => (comparison.findings.clone(), &comparison.windows),
        };
        let windows = |undisturbed: bool| -> Vec<Windows> {
            let of_axis = |axis: &Drifted| {
                let those = axis.windows.iter().filter(|w| !undisturbed || w.disturbed() > 0);
                those.map(|w| Windows::of(&axis.column, w, undisturbed)).collect::<Vec<_>>()
            };
            drifted.iter().flat_map(of_axis).collect()
        };
        Self {
            schema: SCHEMA,
            name: study.name.clone(),
            version: env!("CARGO_PKG_VERSION"),
            seed: study.seed,
            members: drift.statistics.members,
            failed: drift.statistics.failed,
            backend: Backend { parts: parts(&drift.statistics.origins), ..Backend::of(machine) },
            integrator: machine.integrator.clone(),
            time_s: drift.report_times_s(),
            position_error_m: distribution(quantity::POSITION),
            velocity_error_m_s: distribution(quantity::VELOCITY),
            acceleration_error_m_s2: distribution(quantity::ACCELERATION),
            tilt_error_rad: distribution(quantity::TILT),
            closed_form: ClosedForm {
                position_error_m: closed(quantity::POSITION),
                velocity_error_m_s: closed(quantity::VELOCITY),
                acceleration_error_m_s2: closed(quantity::ACCELERATION),
                tilt_error_rad: closed(quantity::TILT),
                left_out: drift.expected.left_out.clone(),
            },
            growth: (0..EXPONENTS.len()).map(power).collect(),
            error_budget: budget
                .contributions
                .iter()
                .map(|contribution| BudgetRow {
                    source: contribution.source.name(),
                    position_sd_m: drift.report.iter().map(|k| contribution.variance_m2[*k].sqrt()).collect(),
                    position_mean_m: drift.report.iter().map(|k| contribution.mean_m[*k]).collect(),
                    share_of_variance: drift.report.iter().map(|k| budget.fraction(contribution, *k)).collect(),
                })
                .collect(),
            windows: asked.then(|| windows(false)),
            windows_undisturbed: windows(true),
            findings,
            jcgm101: None,
            member_steps: drift.statistics.member_steps,
            seconds: drift.statistics.seconds,
        }
    }
}

fn parts(origins: &[Origin]) -> Vec<Part> {
    let part = |origin: &Origin| Part {
        members: [origin.members.start, origin.members.end],
        kind: origin.machine.kind.clone(),
        name: origin.machine.name.clone(),
        reason: origin.reason.clone(),
    };
    match origins {
        [only] if only.reason.is_none() => Vec::new(),
        origins => origins.iter().map(part).collect(),
    }
}

impl Windows {
    fn of(axis: &str, windows: &windows::Windows, undisturbed: bool) -> Self {
        let count = windows.errors(undisturbed).len();
        let [inside50, inside90, inside99] = windows.inside(undisturbed).map(|hits| hits as f64 / count.max(1) as f64);
        Self {
            axis: axis.to_owned(),
            seconds: windows.seconds,
            windows: count,
            inside50,
            inside90,
            inside99,
            sd_recorded: windows.sd_recorded(undisturbed),
            sd_predicted: windows.sd_predicted,
        }
    }
}

impl Backend {
    /// A machine that did all of it.
    pub fn of(machine: &Machine) -> Self {
        Self {
            kind: machine.kind.clone(),
            name: machine.name.clone(),
            driver: machine.driver.clone(),
            precision: machine.precision.clone(),
            fused_multiply_add: machine.fused_multiply_add.clone(),
            parts: Vec::new(),
        }
    }
}

impl Distribution {
    /// Of a quantity's summaries at the report times.
    pub fn of(at: &[&Summary]) -> Self {
        let series = |pick: fn(&Summary) -> f64| at.iter().map(|s| pick(s)).collect();
        Self {
            mean: series(|s| s.mean),
            sd: series(|s| s.sd),
            min: series(|s| s.min),
            max: series(|s| s.max),
            p01: series(|s| s.percentiles[0]),
            p05: series(|s| s.percentiles[1]),
            p50: series(|s| s.percentiles[2]),
            p95: series(|s| s.percentiles[3]),
            p99: series(|s| s.percentiles[4]),
        }
    }
}

impl Moments {
    fn of(expected: &Expected, quantity: usize, report: &[usize]) -> Self {
        let total = expected.total(quantity);
        Self {
            mean: report.iter().map(|k| total[*k].mean).collect(),
            sd: report.iter().map(|k| total[*k].variance.sqrt()).collect(),
        }
    }
}
