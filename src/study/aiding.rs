//! `[aiding]` checked: what measures velocity and position while a study in motion runs, and when
//! it does not.
//!
//! Only what is measured and when stands here; what a navigator makes of it is made in
//! `strapdown::aiding`.

use super::check::whole;
use super::file::{self, AidingMethod, Gnss};
use super::refusal::refuse;
use crate::error::Result;
use crate::kernel::aiding::{Fix, SEEN};
use crate::kernel::flight::Vertical;
use crate::kernel::job::Clock;
use crate::motion::Truth;

/// Most fixes of a run.
const MOST_FIXES: usize = 100_000;
/// Most outages of one study.
const MOST_OUTAGES: usize = 64;
/// A body that is slower stands still, m/s.
const STILL_M_S: f64 = 0.01;

/// Measurements that aid a run, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Aiding {
    /// Use of a measurement by the navigator.
    pub method: AidingMethod,
    /// The measurements, in the order of time, without gains.
    pub fixes: Vec<Fix>,
    /// Outages of GNSS: samples after the end of the still start, begin and end, the last of them
    /// cut at the run's.
    pub outages: Vec<[u64; 2]>,
}

/// Reads what a file says about aiding, checked; `None` without the section.
///
/// # Errors
/// Times and spreads that make no sense; a section without measurements; a run in which none is
/// made.
pub(super) fn read(
    name: &str,
    section: Option<&file::Aiding>,
    clock: &Clock,
    truth: &Truth,
    vertical: Vertical,
) -> Result<Option<Aiding>> {
    let Some(section) = section else { return Ok(None) };
    if section.gnss.is_none() && section.zupt.is_none() {
        return Err(refuse(name, "[aiding] has no measurements", "add [aiding.gnss] or [aiding.zupt]"));
    }
    let mut outages = Vec::new();
    let mut fixes: Vec<Fix> = Vec::new();
    if let Some(gnss) = &section.gnss {
        outages = self::outages(name, gnss, clock)?;
        let sd = spreads(name, gnss, vertical)?;
        let out = |sample: u64| outages.iter().any(|[from, until]| *from < sample && sample <= *until);
        let times = times(name, "aiding.gnss.every_s", gnss.every_s.unwrap_or(1.0), clock)?;
        fixes.extend(times.into_iter().filter(|sample| !out(*sample)).map(|sample| Fix::seeing(sample, sd)));
    }
    if let Some(zupt) = &section.zupt {
        let sd = zupt.velocity_sd_m_s.unwrap_or(0.01);
        positive(name, "aiding.zupt.velocity_sd_m_s", sd, "m/s")?;
        let stands =
            |sample: &u64| truth.samples.get(*sample as usize).is_some_and(|s| s.velocity_m_s.norm() < STILL_M_S);
        let times = times(name, "aiding.zupt.every_s", zupt.every_s.unwrap_or(1.0), clock)?;
        let sees = |axis: usize| (axis < 2 || axis == 2 && vertical == Vertical::Free).then_some(sd);
        let before = fixes.len();
        fixes.extend(times.into_iter().filter(stands).map(|sample| Fix::seeing(sample, std::array::from_fn(sees))));
        if fixes.len() == before {
            return Err(refuse(
                name,
                format!("[aiding.zupt] finds no stop: the body is never slower than {STILL_M_S} m/s at its times"),
                "use a trajectory with stops, e.g. kind = \"car\", or shorten aiding.zupt.every_s",
            ));
        }
    }
    fixes.sort_by_key(|fix| fix.sample);
    fixes.dedup_by(|later, first| {
        let same = later.sample == first.sample;
        if same {
            first.sd.iter_mut().zip(later.sd).for_each(|(sd, other)| *sd = together(*sd, other));
        }
        same
    });
    if fixes.is_empty() || fixes.len() > MOST_FIXES {
        let cause = format!("[aiding] makes {} measurements: need 1 to {MOST_FIXES}", fixes.len());
        return Err(refuse(name, cause, "change every_s, or shorten the outages or the run"));
    }
    Ok(Some(Aiding { method: section.method.unwrap_or_default(), fixes, outages }))
}

/// Standard deviation of the mean of two measurements, weighted as they deserve.
fn together(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a * b / a.hypot(b)),
        (a, b) => a.or(b),
    }
}

fn positive(name: &str, key: &str, value: f64, unit: &str) -> Result<()> {
    match value > 0.0 && value.is_finite() {
        true => Ok(()),
        false => {
            Err(refuse(name, format!("`{key}` = {value:?} {unit}: need more than zero"), "give a positive number"))
        }
    }
}

/// Multiples of a period, samples.
fn times(name: &str, key: &str, every_s: f64, clock: &Clock) -> Result<Vec<u64>> {
    positive(name, key, every_s, "s")?;
    if every_s > clock.duration_s() {
        return Err(refuse(
            name,
            format!("`{key}` = {every_s:?} s is longer than the run of {:?} s", clock.duration_s()),
            "shorten it, or lengthen duration_s",
        ));
    }
    let every = whole(name, key, "sample period", every_s, clock.sample_s())? as u64;
    Ok((1..=clock.samples / every).map(|k| k * every).collect())
}

/// Returns the spreads of what GNSS sees.
fn spreads(name: &str, gnss: &Gnss, vertical: Vertical) -> Result<[Option<f64>; SEEN]> {
    if gnss.position_sd_m.is_none() && gnss.velocity_sd_m_s.is_none() {
        return Err(refuse(
            name,
            "[aiding.gnss] measures nothing",
            "give position_sd_m or velocity_sd_m_s, e.g. position_sd_m = [1.5, 1.5, 3.0]",
        ));
    }
    let lists = [("velocity_sd_m_s", gnss.velocity_sd_m_s, "m/s"), ("position_sd_m", gnss.position_sd_m, "m")];
    let mut all = [None; SEEN];
    for (k, (key, list, unit)) in lists.into_iter().enumerate() {
        for (axis, sd) in list.into_iter().flatten().enumerate() {
            positive(name, &format!("aiding.gnss.{key}"), sd, unit)?;
            // A height that is held has no error to correct.
            all[3 * k + axis] = (axis < 2 || vertical == Vertical::Free).then_some(sd);
        }
    }
    Ok(all)
}

fn outages(name: &str, gnss: &Gnss, clock: &Clock) -> Result<Vec<[u64; 2]>> {
    let (key, example) = ("aiding.gnss.outages_s", "e.g. outages_s = [[60.0, 90.0]]");
    let given = gnss.outages_s.as_deref().unwrap_or_default();
    if given.len() > MOST_OUTAGES {
        return Err(refuse(name, format!("`{key}` has {} pairs: at most {MOST_OUTAGES}", given.len()), example));
    }
    let duration_s = clock.duration_s();
    if let Some([from, until]) =
        given.iter().find(|[from, until]| !(*from >= 0.0 && from < until && *from < duration_s))
    {
        return Err(refuse(
            name,
            format!("`{key}` holds [{from:?}, {until:?}] s: need begin before end, within the run of {duration_s:?} s"),
            example,
        ));
    }
    if given.windows(2).any(|pair| pair[0][1] > pair[1][0]) {
        return Err(refuse(name, format!("`{key}`: outages overlap or stand out of order"), "sort and join them"));
    }
    let sample = |time_s: f64| (time_s / clock.sample_s()).round() as u64;
    Ok(given.iter().map(|[from, until]| [sample(*from), sample(*until).min(clock.samples)]).collect())
}
