//! States what was found in sweeps in public numbers: effects, base model, every candidate's
//! standing.

use std::f64::consts::TAU;

use crate::driven::verdict::effects::{Channels, unit};
use crate::engine::evidence::Gain;
use crate::engine::fit::Fitted;
use crate::engine::kind::{Form as Use, Kind};
use crate::engine::names::{Found, Named};
use crate::numerics::special;
use crate::physics::library::Term;
use crate::physics::scales::Coordinate;
use crate::standing::{self, Note, Ranked};
use crate::verdict::{Effect, Estimate, Evidence, Share};

use super::system::{System, value};

/// 95 % of a normal distribution lie within this many standard deviations.
const REACH: f64 = 1.96;

/// Numbers of a search in the recording's units.
pub(super) struct Public<'a> {
    pub system: &'a System<'a>,
    pub found: &'a Found,
    pub channels: &'a Channels,
    pub columns: &'a [String],
}

/// A gain as the public document states it.
pub(super) fn share(gain: Gain) -> Share {
    Share { value: gain.share, ci95: gain.ci95() }
}

impl Public<'_> {
    /// Probability of a gain by chance, among as many laws as were tried.
    fn p_value(&self, gain: Gain) -> f64 {
        let degrees = (self.system.layout().blocks.len() as f64 - 1.0).max(1.0);
        let chance = 0.5 * special::f_survival(gain.errors.max(0.0).powi(2), 1.0, degrees);
        (chance * self.system.laws() as f64).clamp(0.0, 1.0)
    }

    /// The library's text of a law of the space.
    pub(super) fn id(&self, law: usize) -> &'static str {
        self.system.members[law].term.id()
    }

    /// Named laws, strongest first, each followed by the laws that do as well in its place.
    pub(super) fn effects(&self) -> Vec<Effect> {
        let mut all: Vec<Effect> = Vec::new();
        for named in &self.found.named {
            let model = &self.found.model;
            let id = self.id(model.set[named.place]);
            let mut others: Vec<String> = named.rivals.iter().map(|(law, _)| self.id(*law).to_owned()).collect();
            others.dedup();
            if self.may_be_quadratic(model, named.place) {
                others.push("quadratic-stiffness".to_owned());
            }
            if self.may_be_coupled(model, named.place) && others.iter().all(|other| other != "coupled-mode") {
                others.push("coupled-mode".to_owned());
            }
            all.push(Effect { confusable_with: others, ..self.effect(named, model, named.place) });
            for (law, rival) in &named.rivals {
                let place = rival.set.iter().position(|l| l == law);
                let other = place.map(|place| self.effect(named, rival, place));
                if let Some(other) = other.filter(|o| all.iter().all(|known| known.id != o.id)) {
                    all.push(Effect { confusable_with: vec![id.to_owned()], ..other });
                }
            }
        }
        all
    }

    /// Returns whether a law is a softening cubic spring.
    pub(super) fn may_be_quadratic(&self, model: &Fitted, place: usize) -> bool {
        let beta = self.system.values(&model.set, &model.point).laws[place].values[0];
        matches!(self.system.members[model.set[place]].term, Term::CubicStiffness(_)) && beta < 0.0
    }

    /// Returns whether a mode that is read with the mass may as well be coupled to it: the modes of a mass on a mass,
    /// too, are read together, each in proportion to its motion, with one sign where drive and reading are at the same
    /// place (Ewins, Modal Testing, chapter 2).
    pub(super) fn may_be_coupled(&self, model: &Fitted, place: usize) -> bool {
        let gain = self.system.values(&model.set, &model.point).laws[place].values[0];
        matches!(self.system.members[model.set[place]].term, Term::ParasiticMode(_)) && gain > 0.0
    }

    fn effect(&self, named: &Named, model: &Fitted, place: usize) -> Effect {
        let words = self.system.members[model.set[place]].term.candidate();
        Effect {
            id: words.id.to_owned(),
            statement: words.statement.to_owned(),
            equation: words.equation.to_owned(),
            parameters: self.estimates(model, place),
            channels: self.columns.to_vec(),
            form: None,
            evidence: Evidence { held_out_gain: named.gain.share, p_value: self.p_value(named.gain) },
            share: Some(share(named.gain)),
            base: Vec::new(),
            confusable_with: Vec::new(),
        }
    }

    fn estimates(&self, model: &Fitted, place: usize) -> Vec<Estimate> {
        let term = self.system.members[model.set[place]].term;
        let coordinates = self.system.law_coordinates(&term);
        let parameters = term.candidate().parameters;
        let one = |((i, c), parameter): ((usize, Coordinate), &crate::candidate::Parameter)| {
            let (z, reach) = (model.point.shared[i], REACH * model.deviations[i].min(1e3));
            let ends = match c {
                Coordinate::Held => [z; 2],
                _ => [z - reach, z + reach],
            };
            let of = |z: f64| match c {
                Coordinate::Bounded(_, low, high) => value(c, z).clamp(low, high),
                Coordinate::Log(low, high) => value(c, z).clamp(low, high),
                _ => value(c, z),
            };
            Estimate {
                name: parameter.name.to_owned(),
                value: of(z),
                unit: unit(parameter.unit, self.channels),
                ci95: ends.map(of),
            }
        };
        self.system.coordinates(&model.set, place).zip(coordinates).zip(parameters).map(one).collect()
    }

    /// f₀, width, gain, angle, settling and background, as fitted together with the named laws.
    pub(super) fn base(&self) -> Vec<Estimate> {
        let (model, s) = (&self.found.model, &self.system.sizes);
        let values = self.system.values(&model.set, &model.point);
        let y = &self.channels.output_unit;
        let about = |name: &str, unit: &str, value: f64, half: f64| Estimate {
            name: name.to_owned(),
            value,
            unit: unit.to_owned(),
            ci95: [value - half, value + half],
        };
        let half = |i: usize| REACH * model.deviations[i].min(1e3);
        let width_hz = values.mass.damping_per_s / TAU;
        let gain_unit = unit("y/(u s^2)", self.channels);
        let mut all = vec![
            about("f0", "Hz", values.mass.omega_rad_s / TAU, half(0) * s.damping_per_s / TAU),
            about("width", "Hz", width_hz, half(1) * width_hz),
            about("gain", &gain_unit, values.gain, half(2) * values.gain),
            about("phase", "rad", values.angle_rad, half(3)),
        ];
        if self.system.sweeps.is_ordered {
            all.push(about("settling", "1", values.settling, half(4)));
        }
        let names = ["background", "background_slope", "background_drive", "background_drive_slope"];
        for (i, (b, name)) in values.background.iter().zip(names).enumerate() {
            for (j, (part, axis)) in [(b.re, "x"), (b.im, "y")].into_iter().enumerate() {
                let scale = 0.1 * s.reading;
                all.push(about(&format!("{name}_{axis}"), y, part, half(super::system::OWN + 2 * i + j) * scale));
            }
        }
        all
    }

    /// Named laws first, then each law alone.
    pub(super) fn ranking(&self) -> Vec<Ranked> {
        let of = |law: usize, gain: Gain, named: bool| Ranked {
            id: self.id(law),
            channels: self.columns.to_vec(),
            gain: standing::Gain::held_out(gain.share, gain.ci95()),
            p_value: self.p_value(gain),
            named,
            note: if named { Note::BesideNamed } else { Note::Alone },
        };
        let found = self.found;
        let mut all: Vec<Ranked> = found.named.iter().map(|n| of(found.model.set[n.place], n.gain, true)).collect();
        for (law, gain) in &found.alone {
            if self.system.form(*law) == Use::Stated && all.iter().all(|r| r.id != self.id(*law)) {
                all.push(of(*law, *gain, false));
            }
        }
        all
    }
}
