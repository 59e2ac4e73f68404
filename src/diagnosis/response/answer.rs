//! The public answer of sweeps: verdict, names with their shares, places, and figure data.

use std::f64::consts::TAU;

use nalgebra::Complex;

use crate::answer::{self, Answer, Places};
use crate::candidate::Kind as Recorded;
use crate::driven::verdict::effects::Channels;
use crate::engine::fit::Fitted;
use crate::engine::levels::{AT_NOISE, FAINT};
use crate::engine::names::Found;
use crate::model::Response;
use crate::numerics::special;
use crate::recording::Recording;
use crate::remainder::{Remainder, Size, Test};
use crate::ruling::{self, rule};
use crate::verdict::{DependsOn, Fit, Noise, RecordingInfo, Score};

use super::detail::{Backbone, Detail, Sweep};
use super::effects::{Public, share};
use super::jumps::{Jump, jumps};
use super::location::stretches;
use super::predicted::{Amplitude, Predicted};
use super::steady_state::Table;
use super::system::System;
use super::{repetition, thermal, units};

/// Steps apart at which steps are held against each other: further than the memory of noise, which at ⅓ from step to
/// step is ¹⁄₂₇ here, and less than a width.
const APART: std::ops::RangeInclusive<usize> = 3..=6;
/// Frequencies at which branches are drawn.
const DRAWN: usize = 400;

/// Holds what a conclusion is drawn about.
pub(super) struct Case<'a> {
    pub recording: &'a Recording,
    pub model: &'a Response,
    pub system: &'a System<'a>,
    pub found: &'a Found,
    /// Standard deviation of X and of Y.
    pub deviation: f64,
    /// States whether it was measured apart from the fit.
    pub is_measured: bool,
}

impl Case<'_> {
    /// The complete answer.
    pub(super) fn conclude(&self, mut findings: Vec<String>) -> Answer {
        let (system, found, c) = (self.system, self.found, &self.model.columns);
        let heading = c.x.as_ref().or(c.amplitude.as_ref()).unwrap_or(&c.frequency);
        let stated = self.model.unit.clone();
        let channels = Channels {
            output: heading.clone(),
            output_unit: stated.unwrap_or_else(|| match units::of_level(self.recording, heading) {
                Some(unit) => unit.to_owned(),
                None => units::words(self.recording, heading, "output unit"),
            }),
            input_unit: c.drive.as_ref().map_or("drive".into(), |d| units::words(self.recording, d, "drive unit")),
            environment_units: Vec::new(),
        };
        let read = [&c.x, &c.y, &c.amplitude, &c.phase];
        let columns: Vec<String> = read.into_iter().flatten().cloned().collect();
        let public = Public { system, found, channels: &channels, columns: &columns };
        let followed = [&found.base, &found.model].map(|m| system.predicted(&m.set, &m.point, Amplitude::Followed));
        let jumps = jumps(system.sweeps, &followed[1]);
        let remainder = self.remainder();
        let outcome = rule(&ruling::Evidence {
            named: found.named.len(),
            departs: found.named.iter().any(|n| n.departs.is_some()),
            tied: found
                .named
                .iter()
                .filter(|n| n.rivals.iter().any(|(law, _)| !system.is_same(found.model.set[n.place], *law)))
                .count(),
            stand_ins: !found.imitations.is_empty(),
            remainder: remainder.size,
            ..ruling::Evidence::default()
        });
        let argument =
            found.rest.first().map(|rest| DependsOn { name: rest.argument.word().to_owned(), share: share(rest.gain) });
        findings.extend(self.sentences(&jumps));
        let noise = Noise {
            value: self.deviation,
            unit: channels.output_unit.clone(),
            how: match self.is_measured {
                true => "what seven neighbouring steps leave of a pole, and one standard error of that".into(),
                false => "the residual of the base model: no seven steps follow one another".into(),
            },
        };
        let detail = self.detail(&public, &followed, jumps);
        Answer {
            kind: Recorded::Response,
            outcome,
            recording: RecordingInfo::of(self.recording),
            base: public.base(),
            effects: public.effects(),
            places: Places { argument, ..self.places() },
            fit: self.score(&channels.output_unit, noise),
            residual_after: remainder.whiteness(),
            findings,
            ranking: public.ranking(),
            trace: Vec::new(),
            repair: None,
            detail: answer::Detail::Response(Box::new(detail)),
        }
    }

    /// Squared error of each step over the variance of one of its numbers; zero where it is not
    /// fitted.
    fn squares(&self, model: &Fitted) -> Vec<f64> {
        let scale = 1.0 / self.deviation.powi(2);
        model.model.residual.chunks(2).map(|e| (e[0] * e[0] + e[1] * e[1]) * scale).collect()
    }

    fn places(&self) -> Places {
        let squares = self.squares(&self.found.base);
        let base = self.system.predicted(&self.found.base.set, &self.found.base.point, self.system.amplitude);
        let counted: Vec<usize> = (0..squares.len()).filter(|k| self.system.sweeps.counts[*k]).collect();
        let of = |values: &[f64]| -> Vec<f64> { counted.iter().map(|k| values[*k]).collect() };
        let squares = of(&squares);
        let amplitude: Vec<f64> = self.system.sweeps.reading.iter().map(|y| y.norm()).collect();
        debug_assert_eq!(base.reading.len(), amplitude.len());
        Places {
            frequency_hz: stretches(&of(&self.system.sweeps.frequency_hz), &squares),
            state: stretches(&of(&amplitude), &squares),
            ..Places::default()
        }
    }

    /// Returns what the final model leaves over the noise: real where it depends on an argument, or
    /// where neighbouring steps leave alike; where laws are named, more than the noise is no noise,
    /// even on few steps that are no neighbours.
    fn remainder(&self) -> Remainder {
        let (found, noise) = (self.found, self.deviation.powi(2));
        let excess = found.model.variance / noise - 1.0;
        let depends = !found.rest.is_empty() || found.named.iter().any(|n| n.departs.is_some());
        let p_value = match (depends, found.named.is_empty()) {
            (true, _) => 0.0,
            (false, true) => self.alike_by_chance(&found.model),
            (false, false) => self.alike_by_chance(&found.model).min(self.larger_by_chance(excess)),
        };
        Remainder::of([Test { p_value, size: Size::of(excess, AT_NOISE, FAINT) }])
    }

    /// Probability that noise exceeds by so much the most that its measurement allows: less than that in
    /// truth, so that no noise is taken for physics.
    fn larger_by_chance(&self, excess: f64) -> f64 {
        let rows = self.system.layout.rows() as f64;
        special::f_survival(1.0 + excess, rows, super::noise::freedom(self.system.sweeps.len()))
    }

    /// Probability that noise is as much alike over some steps, or, where a drive was swept more than once, from sweep
    /// to sweep: noise has a short memory, and does not repeat.
    fn alike_by_chance(&self, model: &Fitted) -> f64 {
        let e: Vec<Complex<f64>> = model.model.residual.chunks(2).map(|e| Complex::new(e[0], e[1])).collect();
        let along = self.alike_along_by_chance(&e);
        // The smaller one of two.
        repetition::repeats_by_chance(self.system.sweeps, &e).map_or(along, |again| (2.0 * along.min(again)).min(1.0))
    }

    /// Probability that steps some steps apart are as much alike in noise of a short memory (Ljung & Box,
    /// Biometrika 65, 1978).
    fn alike_along_by_chance(&self, e: &[Complex<f64>]) -> f64 {
        let power: f64 = e.iter().map(|e| e.norm_sqr()).sum::<f64>().max(1e-300);
        let n = 2.0 * self.system.sweeps.counts.iter().filter(|c| **c).count() as f64;
        let sum: f64 = APART
            .map(|lag| {
                let of = |s: &std::ops::Range<usize>| -> f64 {
                    (s.start + lag..s.end).map(|k| (e[k] * e[k - lag].conj()).re).sum()
                };
                let r = self.system.sweeps.sweeps.iter().map(of).sum::<f64>() / power;
                r * r / (n - lag as f64)
            })
            .sum();
        special::chi_squared_survival(n * (n + 2.0) * sum, APART.count() as f64)
    }

    /// Errors before and after, on fitted and on held-out steps.
    fn score(&self, unit: &str, noise: Noise) -> Fit {
        let found = self.found;
        let rows = self.system.layout.rows() as f64;
        let named = !found.named.is_empty();
        let fitted = |m: &Fitted| (m.model.residual.iter().map(|e| e * e).sum::<f64>() / rows).sqrt();
        let held_out = |m: &Fitted| (m.error / rows).sqrt();
        let of = |error: &dyn Fn(&Fitted) -> f64| Score {
            rmse_before: error(&found.base),
            rmse_after: named.then(|| error(&found.model)),
            ratio_ci95: None,
            share: None,
        };
        let together = found.together.map(share);
        let floor = self.deviation.powi(2) * rows;
        let remains =
            |s: f64| ((floor + (1.0 - s) * (found.base.error - floor).max(0.0)) / found.base.error).max(0.0).sqrt();
        let ratio_ci95 = together.map(|s| [remains(s.ci95[1]), remains(s.ci95[0])]);
        Fit {
            unit: unit.to_owned(),
            noise_floor: self.deviation,
            noise: Some(noise),
            train: of(&fitted),
            test: Score { ratio_ci95, share: together, ..of(&held_out) },
            test_ranges: Vec::new(),
            recordings: Vec::new(),
            log_score: None,
            one_step_rmse: None,
            with_unnamed: None,
        }
    }

    /// Returns what was found besides physics.
    fn sentences(&self, jumps: &[Jump]) -> Vec<String> {
        let sweeps = self.system.sweeps;
        let up = sweeps.sweeps.iter().filter(|s| sweeps.rises(s)).count();
        let of = |number: usize, what: &str| format!("{number} {what}{}", if number == 1 { "" } else { "s" });
        let mut all = vec![format!(
            "{} ({up} up) at {}; {} of {} steps are fitted",
            of(sweeps.sweeps.len(), "sweep"),
            of(sweeps.drives(), "drive"),
            sweeps.counts.iter().filter(|c| **c).count(),
            sweeps.len()
        )];
        if !sweeps.jumps.is_empty() {
            let read = of(sweeps.jumps.len(), "time");
            let hit = jumps.iter().filter(|j| j.steps.is_some_and(|s| s <= 1)).count();
            all.push(format!(
                "the reading jumps {read}; two steps on both sides of a jump are not fitted; the model, following \
                 the history of each sweep, has {hit} of the jumps within one step"
            ));
        }
        all
    }

    fn detail(&self, public: &Public<'_>, followed: &[Predicted; 2], jumps: Vec<Jump>) -> Detail {
        let (system, found, sweeps) = (self.system, self.found, self.system.sweeps);
        let errors = [&found.base, &found.model].map(|m| self.squares(m));
        let pair = |z: Complex<f64>| [z.re, z.im];
        let sweep = |own: &std::ops::Range<usize>| Sweep {
            rises: sweeps.rises(own),
            drive: sweeps.drive[own.start],
            frequency_hz: sweeps.frequency_hz[own.clone()].to_vec(),
            read: sweeps.reading[own.clone()].iter().copied().map(pair).collect(),
            base: followed[0].reading[own.clone()].iter().copied().map(pair).collect(),
            model: followed[1].reading[own.clone()].iter().copied().map(pair).collect(),
            errors: own.clone().map(|k| errors.each_ref().map(|e| (0.5 * e[k]).sqrt())).collect(),
        };
        let mass = system.values(&found.model.set, &found.model.point).mass;
        Detail {
            sweeps: sweeps.sweeps.iter().map(sweep).collect(),
            backbone: self.backbone(),
            jumps,
            unit: public.channels.output_unit.clone(),
            drive_unit: public.channels.input_unit.clone(),
            resonance_hz: [mass.omega_rad_s / TAU, mass.damping_per_s / TAU],
            harmonics: followed[1].table.harmonics,
            imitations: found.imitations.iter().map(|law| public.id(*law).to_owned()).collect(),
            noise: self.deviation,
            thermal: self
                .model
                .thermal
                .map(|stated| thermal::noise(stated, mass, system.sweeps.derivatives, found.model.variance.sqrt())),
            excess: found.model.variance / self.deviation.powi(2) - 1.0,
            may_be_quadratic: found.named.iter().any(|n| public.may_be_quadratic(&found.model, n.place)),
        }
    }

    /// Every stable motion over the band for each drive, and the amplitude of resonance.
    fn backbone(&self) -> Backbone {
        let (system, found) = (self.system, self.found);
        let values = system.values(&found.model.set, &found.model.point);
        let [low, high] = system.sizes.band_hz;
        let table = Table::new(&values.mass, &values.laws, 1.6 * system.sizes.amplitude, [low, high].map(|f| TAU * f));
        let at = |i: usize| low + (high - low) * i as f64 / (DRAWN - 1) as f64;
        let linear = |omega: f64| -> Complex<f64> {
            values.laws.iter().filter(|l| l.is_linear()).map(|l| l.linear(&values.mass, omega, 0.0)).sum()
        };
        let stable = |drive: f64, i: usize| {
            let omega = TAU * at(i);
            table.along(&values.mass, omega, linear(omega)).stable(values.gain * drive)
        };
        let mut drives: Vec<f64> = Vec::new();
        for sweep in &system.sweeps.sweeps {
            let drive = system.sweeps.drive[sweep.start];
            if drive > 0.0 && drives.iter().all(|d| (d - drive).abs() > 0.02 * drive) {
                drives.push(drive);
            }
        }
        let branch = |drive: f64| -> Vec<(f64, f64)> {
            (0..DRAWN).flat_map(|i| stable(drive, i).into_iter().map(move |a| (at(i), a))).collect()
        };
        let largest = |drive: f64| branch(drive).into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
        let spine = (1..=16).filter_map(|i| largest(system.sizes.drive * f64::from(i) / 16.0)).collect();
        Backbone { spine, branches: drives.into_iter().map(|d| (d, branch(d))).collect() }
    }
}
