//! One pass over a recording, for [`LANES`] parameter sets at once: simulate, compare with the
//! reading, correct.
//!
//! The oscillator's linear part is propagated exactly (Lawson's fourth-order Runge–Kutta in the
//! rotating frame), so that step length limits only the terms and the input. Without noise terms
//! nothing is corrected and the innovations are the errors of free simulation; with them they are
//! one-step prediction errors, whose likelihood is Gaussian and white.

// Lanes are indexed alike in many arrays at once; iterators over one of them would hide that.
#![allow(clippy::needless_range_loop)]

use std::ops::Range;

use crate::model::Output;
use crate::physics::law::Role;
use crate::physics::state::{Instants, LANES, Lanes};

use super::acting::Acting;
use super::force::Force;
use super::mover::{MOST_STATES, Mover, movers};
use super::step::{Parts, Plan, StepState, together};

/// Specification of one pass of a simulation.
#[derive(Debug)]
pub(super) struct Pass<'a> {
    /// Samples to run over.
    pub run: Range<usize>,
    /// Readings of the whole recording.
    pub reading: &'a [f64],
    /// Input on half steps, `2·steps` per sample; empty without one.
    pub grid: &'a [f64],
    pub grid_end: usize,
    /// Environment, row by row.
    pub environment: &'a [f64],
    pub environments: usize,
    /// Time of each sample where they do not follow one another at the sampling rate; else empty.
    pub clock_s: &'a [f64],
    pub parts: Parts<'a>,
    /// Places where the run begins, and where it begins anew, in the order of time.
    pub beginnings: Vec<Beginning>,
    /// Corrections per unit innovation; `None` for free simulation.
    pub gains: Option<[Lanes; 4]>,
}

/// Place where a mass begins.
#[derive(Debug, Clone, Copy)]
pub(super) struct Beginning {
    pub sample: usize,
    /// Index of its recording among those that the parameters know.
    pub recording: usize,
    /// Offset of the reading from there on.
    pub offset: Lanes,
    /// Displacement and velocity there.
    pub initial: [Lanes; 2],
}

/// Keeps parts of the state of a pass besides the innovations.
pub trait Keep {
    /// Called at every sample with displacement and velocity as expected before the reading is
    /// seen.
    fn keep(&mut self, sample: usize, x: &Lanes, v: &Lanes);
}

/// An observer of the pass that keeps nothing.
pub struct Nothing;

impl Keep for Nothing {
    #[inline(always)]
    fn keep(&mut self, _: usize, _: &Lanes, _: &Lanes) {}
}

/// Keeps displacement and velocity of lane 0.
#[derive(Debug, Default)]
pub(crate) struct States {
    pub x: Vec<f64>,
    pub v: Vec<f64>,
}

impl Keep for States {
    #[inline(always)]
    fn keep(&mut self, _: usize, x: &Lanes, v: &Lanes) {
        self.x.push(x[0]);
        self.v.push(v[0]);
    }
}

impl Pass<'_> {
    /// Innovations (reading less expectation), one row of lanes per sample of the run.
    pub(super) fn innovations<K: Keep>(&self, keep: &mut K) -> Vec<Lanes> {
        #[cfg(target_arch = "x86_64")]
        {
            if std::arch::is_x86_feature_detected!("avx512f") {
                // SAFETY: the processor has been asked for AVX-512F.
                return unsafe { self.wide(keep) };
            }
            if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
                // SAFETY: the processor has been asked for AVX2 and FMA.
                return unsafe { self.middle(keep) };
            }
        }
        self.by(Force::plain(), keep)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f")]
    fn wide<K: Keep>(&self, keep: &mut K) -> Vec<Lanes> {
        self.by(Force::wide(), keep)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    fn middle<K: Keep>(&self, keep: &mut K) -> Vec<Lanes> {
        self.by(Force::middle(), keep)
    }

    #[inline(always)]
    fn by<K: Keep>(&self, force: Force, keep: &mut K) -> Vec<Lanes> {
        let Parts { steps, interval_s, .. } = self.parts;
        let plan = Plan::of(&self.parts, force);
        let acting = Acting::new(self.grid, self.grid_end, steps, interval_s, plan.late_s.as_ref());
        let [begin, later @ ..] = self.beginnings.as_slice() else { return Vec::new() };
        let (mut later, mut offset, mut motion) = (later.iter(), begin.offset, self.beginning(&plan, begin));
        let mut next = later.next();
        let mut out = Vec::with_capacity(self.run.len());
        for k in self.run.clone() {
            if let Some(begin) = next.filter(|b| b.sample == k) {
                (offset, motion) = (begin.offset, self.beginning(&plan, begin));
                next = later.next();
            }
            let environment = &self.environment[k * self.environments..(k + 1) * self.environments];
            let mut at = Instants {
                time: self.clock_s.get(k).copied().unwrap_or(k as f64 * interval_s),
                step: plan.step_s,
                input: acting.recorded(k),
                x: motion.x,
                v: motion.v,
                base: &self.parts.base,
                environment,
            };
            if self.parts.observed.at_once {
                plan.settle(&mut at, acting.at(k), &mut motion);
                at.input = acting.recorded(k);
            }
            let y = self.expected(&plan, &at, acting.at(k), &offset, &motion);
            keep.keep(k, &motion.x, &motion.v);
            let reading = self.reading[k];
            let mut e = [0.0; LANES];
            for l in 0..LANES {
                e[l] = reading - y[l];
            }
            out.push(e);
            self.correct(&plan, &e, &mut motion);
            let begin = at.time;
            for step in 0..steps {
                let u = acting.over(k, step);
                let stride = if self.parts.observed.at_once {
                    at.time = begin + (step + 1) as f64 * plan.step_s;
                    plan.settled(&mut at, u, &mut motion)
                } else if plan.linear {
                    plan.swing(u, &mut motion)
                } else {
                    at.time = begin + step as f64 * plan.step_s;
                    plan.pushed(&mut at, u, &mut motion)
                };
                plan.follow(stride, &mut motion.own);
            }
        }
        out
    }

    fn beginning(&self, plan: &Plan<'_>, begin: &Beginning) -> StepState {
        let [x, v] = begin.initial;
        // A term's values with its initial states in this recording.
        let values = |m: &Mover<'_>| -> Vec<Lanes> {
            let (all, unknown) = (&self.parts.parameters[m.first..], m.term.unknown_beginnings());
            let mut values = all[..m.term.values()].to_vec();
            let known = values.len() - unknown;
            values[known..].copy_from_slice(&all[known + begin.recording * unknown..][..unknown]);
            values
        };
        let mut own = [[0.0; LANES]; MOST_STATES];
        let (later, earlier): (Vec<_>, Vec<_>) = movers(self.parts.terms, self.parts.first, self.parts.parameters)
            .into_iter()
            .partition(|m| matches!(m.role, Role::Filter(_)));
        for m in &earlier {
            m.term.begin(&x, &v, &values(m), &mut own[m.state..]);
        }
        for m in &later {
            let (x, v) = together(&plan.modes, &own, [&x, &v]);
            m.term.begin(&x, &v, &values(m), &mut own[m.state..]);
        }
        StepState::new([x, v], own)
    }

    /// The reading expected before it is seen.
    #[inline(always)]
    fn expected(
        &self,
        plan: &Plan<'_>,
        at: &Instants<'_, f64, LANES>,
        acting: Lanes,
        offset: &Lanes,
        motion: &StepState,
    ) -> Lanes {
        let seen = self.parts.observed.output;
        let mut y = if seen == Output::Displacement { at.x } else { plan.observed(at, acting, motion) };
        for r in &plan.sensing {
            match r.role {
                Role::Mode if seen != Output::Displacement => continue,
                Role::Filter(place) if seen != Output::Displacement => {
                    plan.filtered(r, place, at, motion, &mut y);
                    continue;
                }
                _ => {}
            }
            r.term.reading(at, &r.values, &motion.own[r.state..], &mut y);
        }
        for l in 0..LANES {
            y[l] += offset[l] + motion.bias[l];
        }
        for r in &plan.adding {
            r.term.reading(at, &r.values, &motion.own[r.state..], &mut y);
        }
        y
    }

    /// Corrects the motion by a reading.
    #[inline(always)]
    fn correct(&self, plan: &Plan<'_>, e: &Lanes, motion: &mut StepState) {
        let Some(gains) = &self.gains else { return };
        for l in 0..LANES {
            motion.x[l] += gains[0][l] * e[l];
            motion.v[l] += gains[1][l] * e[l];
            motion.bias[l] += gains[2][l] * e[l];
        }
        if let Some(state) = plan.lagging {
            for l in 0..LANES {
                motion.own[state][l] += gains[3][l] * e[l];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driven::intake::observed::Observed;
    use crate::physics::coulomb_friction::{CoulombFriction, Sides};
    use crate::physics::library::Term;
    use crate::physics::state::BaseLanes;

    const OMEGA: f64 = 5.0;
    const PULL: f64 = 25.0;

    /// Pass over one recording with these parts, from rest at this displacement.
    fn pass<'a>(parts: Parts<'a>, reading: &'a [f64], grid: &'a [f64], start: f64) -> Pass<'a> {
        let initial = [[start; LANES], [0.0; LANES]];
        Pass {
            run: 0..reading.len(),
            reading,
            grid,
            grid_end: 0,
            environment: &[],
            environments: 0,
            clock_s: &[],
            parts,
            beginnings: vec![Beginning { sample: 0, recording: 0, offset: [0.0; LANES], initial }],
            gains: None,
        }
    }

    /// Displacements at samples a step of `angle` radians apart, pulled by `push` and rubbed by
    /// `friction`; ζ = 0.
    fn swings(angle: f64, samples: usize, start: f64, friction: f64, push: impl Fn(f64) -> f64) -> Vec<f64> {
        rubbed(Sides::Alike, &[[friction; LANES]], angle, samples, start, push)
    }

    /// The same with these parameters of friction.
    fn rubbed(
        sides: Sides,
        parameters: &[Lanes],
        angle: f64,
        samples: usize,
        start: f64,
        push: impl Fn(f64) -> f64,
    ) -> Vec<f64> {
        let h = angle / OMEGA;
        let grid: Vec<f64> = (0..=2 * samples).map(|i| push(0.5 * h * i as f64)).collect();
        let parts = Parts {
            base: BaseLanes { gain: [1.0; LANES], stiffness: [PULL; LANES], damping: [0.0; LANES] },
            oscillator: [[OMEGA; LANES], [0.0; LANES]],
            terms: &[Term::CoulombFriction(CoulombFriction(sides))],
            parameters,
            first: &[0],
            interval_s: h,
            steps: 1,
            observed: Observed::default(),
        };
        let reading = vec![0.0; samples];
        pass(parts, &reading, &grid, start).innovations(&mut Nothing).iter().map(|e| -e[LANES - 1]).collect()
    }

    // Between turns friction only shifts the equilibrium by f/ω₀²: each half swing loses 2 f/ω₀²,
    // until it holds. The quadrature of a constant force over a step errs by (ω₀h)⁴/2880 of 0.07.
    #[test]
    fn a_ring_down_in_steps_of_half_a_radian_stops_where_arithmetic_says() {
        let x = swings(0.5, 80, 1.0, 0.07 * PULL, |_| 0.0);
        assert!((x[79] - -0.02).abs() < 1e-4, "{}", x[79]);
        assert!(x[50] == x[79], "it holds");
    }

    // Rubbed by 0.09 ω₀² forwards and 0.05 ω₀² backwards, the turning points are −x + 2·0.05 and −x
    // − 2·0.09 in turn: 1, −0.9, 0.72, −0.62, 0.44, −0.34, 0.16, −0.06, where the spring pulls less
    // than friction forwards holds.
    #[test]
    fn friction_that_differs_in_both_directions_ends_off_the_centre() {
        let sizes = [[0.07 * PULL; LANES], [0.02 * PULL; LANES]];
        let x = rubbed(Sides::Apart, &sizes, 0.5, 80, 1.0, |_| 0.0);
        assert!((x[79] - -0.06).abs() < 1e-4 && x[60] == x[79], "{}", x[79]);
        let alike = rubbed(Sides::Apart, &[sizes[0], [0.0; LANES]], 0.5, 80, 1.0, |_| 0.0);
        assert_eq!(alike, swings(0.5, 80, 1.0, 0.07 * PULL, |_| 0.0), "without a difference it is the plain law");
    }

    // Loose from t = f/a on under a pull a·t: x = (a/ω₀²)(τ − sin(ω₀τ)/ω₀) with τ from there.
    #[test]
    fn a_growing_pull_breaks_it_loose_inside_a_step() {
        let x = swings(0.25, 24, 0.0, 1.3, |t| 2.0 * t);
        for (k, x) in x.iter().enumerate() {
            let late = (k as f64 * 0.25 / OMEGA - 0.65).max(0.0);
            let expected = 2.0 / PULL * (late - (OMEGA * late).sin() / OMEGA);
            assert!((x - expected).abs() < 1e-5, "{k}: {x} for {expected}");
        }
    }

    // Of second order at least, where a smoothed sign, of first order, leaves a quarter.
    #[test]
    fn a_quarter_of_the_step_leaves_less_than_a_sixteenth_of_the_error_across_many_turns() {
        let at = |angle: f64| {
            let every = (0.5 / angle) as usize;
            swings(angle, 240 * every, 0.3, 3.0, |t| 18.0 * (3.1 * t).sin())
                .into_iter()
                .step_by(every)
                .collect::<Vec<_>>()
        };
        let exact = at(0.5 / 64.0);
        let error = |angle: f64| at(angle).iter().zip(&exact).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        let [coarse, fine] = [0.5, 0.125].map(error);
        assert!(coarse > 16.0 * fine, "{coarse} {fine}");
    }

    // One arithmetic, whatever the processor: a verdict is the same on every machine.
    #[test]
    fn every_instruction_set_gives_the_same_bits() {
        let known = |id: &str| Term::tried(0, true).into_iter().find(|t| t.id() == id).expect("it is in the library");
        let mixed = ["hysteresis", "coulomb-friction", "parasitic-mode"];
        for set in [&[][..], &["cubic-stiffness", "quadratic-damping"], &mixed] {
            let terms: Vec<Term> = set.iter().map(|id| known(id)).collect();
            let first: Vec<usize> = (0..terms.len()).map(|i| terms[..i].iter().map(|t| t.values()).sum()).collect();
            let parameters: Vec<Lanes> =
                (0..20).map(|i| std::array::from_fn(|l| 0.3 + 0.1 * f64::from(i) + 0.01 * l as f64)).collect();
            let grid: Vec<f64> = (0..=2 * 500).map(|i| 9.0 * (0.37 * f64::from(i)).sin()).collect();
            let at_gain = |gain: f64| {
                let parts = Parts {
                    base: BaseLanes { gain: [gain; LANES], stiffness: [PULL; LANES], damping: [0.5; LANES] },
                    oscillator: [[OMEGA; LANES], [0.05; LANES]],
                    terms: &terms,
                    parameters: &parameters,
                    first: &first,
                    interval_s: 0.05,
                    steps: 1,
                    observed: Observed::default(),
                };
                pass(parts, &[0.0; 500], &grid, 0.1)
            };
            let plain = at_gain(1.0).by(Force::plain(), &mut Nothing);
            assert!(plain == at_gain(1.0).innovations(&mut Nothing), "{set:?}");
            #[cfg(target_arch = "x86_64")]
            if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
                // SAFETY: the processor has been asked for AVX2 and FMA.
                assert!(plain == unsafe { at_gain(1.0).middle(&mut Nothing) }, "{set:?}");
            }
            // Control: another gain gives other numbers.
            assert!(plain != at_gain(1.0 + 1e-15).innovations(&mut Nothing), "{set:?}");
        }
    }
}
