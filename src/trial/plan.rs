//! Which cases a trial has: how many of each family, and how each is drawn from the seed.

use rand::RngExt;
use serde::{Deserialize, Serialize};

use super::campaign::Campaign;
use super::case::{Body, Case, Family};
use super::driven::Driven;
use super::physics::Physics;
use super::plant::{self, Drive, Size, log_uniform, plant, uniform};
use super::standstill::{Slow, Still};
use super::turning::{Fault, Turned};
use proofmass_numerics::rng::{Philox, Stream};

/// Readout noise of every planted case, relative to the rms output.
const NOISE: f64 = 0.002;

/// Seed, number, size and families of the cases.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Seed of all random draws.
    pub seed: u64,
    /// About how many; each family gets its share.
    pub cases: usize,
    /// Rows per driven recording and per log at rest.
    pub samples: usize,
    /// Families and their proportions.
    pub campaign: Campaign,
}

/// The nth of a list for a family: strides visit all of it, families begin at different places, so
/// that a short trial holds a varied part of everything.
fn nth_of<T: Copy>(list: &[T], stride: usize, family: Family, nth: usize) -> T {
    list[(stride * nth + 5 * family as usize) % list.len()]
}

/// Groups whose members resemble each other.
const LOOK_ALIKES: [&[Physics]; 3] = [
    &[Physics::ReadoutNonlinearity, Physics::CubicStiffness],
    &[Physics::ReadoutDelay, Physics::ReadoutLowpass, Physics::ParasiticMode],
    &[Physics::CoulombFriction, Physics::QuadraticDamping, Physics::SqueezeFilmDamping],
];

/// States what base parameters absorb when there is one amplitude and a narrow band.
const ABSORBABLE: [Physics; 7] = [
    Physics::CubicStiffness,
    Physics::QuadraticDamping,
    Physics::SqueezeFilmDamping,
    Physics::CoulombFriction,
    Physics::Hysteresis,
    Physics::ReadoutDelay,
    Physics::ReadoutLowpass,
];

/// States what shows only at amplitudes that were not recorded.
const AMPLITUDE_DEPENDENT: [Physics; 5] = [
    Physics::CubicStiffness,
    Physics::QuadraticStiffness,
    Physics::SqueezeFilmDamping,
    Physics::QuadraticDamping,
    Physics::EndStop,
];

/// States what a free ring-down can show.
const RING_DOWN: [Physics; 5] = [
    Physics::CubicStiffness,
    Physics::QuadraticDamping,
    Physics::SqueezeFilmDamping,
    Physics::CoulombFriction,
    Physics::BiasDrift,
];

impl Plan {
    /// The plan of `trial --quick`: fewer and shorter recordings.
    pub fn quick(seed: u64) -> Self {
        Self { seed, cases: 150, samples: 4000, campaign: Campaign::Concealed }
    }

    /// The families of all cases, interleaved so that any first part of a trial holds some of each;
    /// what is drawn last stands at the end.
    pub fn families(&self) -> Vec<(Family, usize)> {
        let mut all: Vec<(bool, f64, Family, usize)> = Vec::new();
        for family in Family::ALL {
            let full = self.campaign.cases_of(family);
            let count = (full * self.cases).div_ceil(self.campaign.size().max(1));
            let last = family.is_drawn_last();
            all.extend((0..count).map(|k| (last, (k as f64 + 0.5) / count as f64, family, k)));
        }
        all.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        all.into_iter().map(|(_, _, family, k)| (family, k)).collect()
    }

    /// Draws the case with this number, `nth` of its family.
    pub fn draw(&self, number: usize, family: Family, nth: usize) -> Case {
        let body = match family {
            Family::StillNull | Family::StillPlanted | Family::WithheldColumn | Family::StillUnknown => {
                let mut rng = Philox::new(self.seed, number as u64, Stream::Host);
                Body::Still(Box::new(self.still(&mut rng, family, nth)))
            }
            Family::TurnedNull | Family::TurnedPlanted | Family::TurnedUnknown => {
                let mut rng = Philox::new(self.seed, number as u64, Stream::Host);
                let mut case = Turned::bare(&mut rng);
                match family {
                    Family::TurnedPlanted => {
                        let size = log_uniform(&mut rng, 0.1, 3.0);
                        case.plant(&mut rng, nth_of(Fault::LIBRARY, 1, family, nth), size);
                    }
                    Family::TurnedUnknown => {
                        let size = log_uniform(&mut rng, 0.5, 5.0);
                        case.plant(&mut rng, nth_of(Fault::FOREIGN, 1, family, nth), size);
                    }
                    _ => {}
                }
                Body::Turned(Box::new(case))
            }
            // A shape that cannot reach its size (a stop never touched, a spring that would snap)
            // is drawn anew.
            _ => (0..20)
                .find_map(|attempt| {
                    let mut rng = Philox::new(self.seed, (number as u64) << 8 | attempt, Stream::Host);
                    self.driven(&mut rng, family, nth)
                })
                .map_or_else(
                    || Body::Driven(Box::new(self.bare(&mut Philox::new(self.seed, number as u64, Stream::Host)))),
                    |case| Body::Driven(Box::new(case)),
                ),
        };
        Case { number, family, body }
    }

    fn bare(&self, rng: &mut Philox) -> Driven {
        plant::bare(rng, Drive::Any, self.samples, NOISE)
    }

    fn still(&self, rng: &mut Philox, family: Family, nth: usize) -> Still {
        let mut case = Still::bare(rng, self.samples);
        let size = log_uniform(rng, 0.2, 3.0);
        match family {
            Family::StillPlanted => {
                let slow = nth_of(Slow::LIBRARY, 4, family, nth);
                let size = match slow {
                    // A level is a factor, a step is coarser than the noise.
                    Slow::WhiteNoise => uniform(rng, 1.15, 3.0),
                    Slow::QuantisationNoise => uniform(rng, 1.5, 4.0),
                    _ => size,
                };
                case.temperature_given = slow == Slow::TemperatureSensitivity;
                case.plant(rng, slow, size);
            }
            Family::WithheldColumn => case.plant(rng, Slow::TemperatureSensitivity, size),
            Family::StillUnknown => {
                let size = log_uniform(rng, 0.5, 3.0);
                case.plant(rng, nth_of(Slow::FOREIGN, 1, family, nth), size);
            }
            _ => {}
        }
        case
    }

    fn driven(&self, rng: &mut Philox, family: Family, nth: usize) -> Option<Driven> {
        let n = self.samples;
        let add = |case: &mut Driven, rng: &mut Philox, physics: Physics, size: Size| {
            let shape = plant::shape(rng, physics, case);
            plant(case, physics, shape, size)
        };
        let library = |rng: &mut Philox| Physics::LIBRARY[rng.random_range(0..Physics::LIBRARY.len())];
        let effect = |nth: usize| nth_of(Physics::LIBRARY, 8, family, nth);
        let mut case = match family {
            Family::Null => {
                let noise = log_uniform(rng, 0.002, 0.02);
                return Some(plant::bare(rng, Drive::Any, n, noise));
            }
            Family::AbsorbedByBase => plant::bare(rng, Drive::Narrow, n, NOISE),
            Family::RingDown => plant::bare(rng, Drive::RingDown, n, NOISE),
            _ => self.bare(rng),
        };
        let good = match family {
            Family::ForceNoiseOnly => {
                let size = log_uniform(rng, 0.01, 0.1);
                add(&mut case, rng, Physics::ForceNoise, Size::Visible(size))
            }
            Family::SingleOnePercent => add(&mut case, rng, effect(nth), Size::Visible(0.01)),
            Family::SingleFivePercent => add(&mut case, rng, effect(nth), Size::Visible(0.05)),
            Family::AroundTheLimit => {
                let size = NOISE * log_uniform(rng, 0.01, 3.0);
                add(&mut case, rng, effect(nth), Size::Visible(size))
            }
            Family::UnderTheNoise => {
                let size = NOISE * log_uniform(rng, 0.05, 0.5);
                add(&mut case, rng, effect(nth), Size::Visible(size))
            }
            Family::UnknownPhysics => {
                let size = log_uniform(rng, 0.02, 0.1);
                add(&mut case, rng, nth_of(Physics::FOREIGN, 7, family, nth), Size::Visible(size))
            }
            Family::Pair | Family::BehindALarger => {
                let first = library(rng);
                let second = (0..).map(|_| library(rng)).find(|p| *p != first)?;
                let sizes =
                    if family == Family::Pair { [0, 1].map(|_| log_uniform(rng, 0.02, 0.05)) } else { [0.1, 0.01] };
                add(&mut case, rng, first, Size::Visible(sizes[0]))
                    && add(&mut case, rng, second, Size::Visible(sizes[1]))
            }
            Family::Unsearched => {
                let size = log_uniform(rng, 0.01, 0.05);
                let (physics, shape) = match nth % 2 {
                    0 => (Physics::CoupledMode, plant::shape(rng, Physics::CoupledMode, &case)),
                    // Twice to nine times as much friction forwards as backwards, or the reverse.
                    _ => (Physics::CoulombFriction, [plant::sign(rng) * uniform(rng, 0.33, 0.8), 0.0]),
                };
                plant(&mut case, physics, shape, Size::Visible(size))
            }
            Family::AbsorbedByBase => {
                let size = log_uniform(rng, 0.03, 0.1);
                add(&mut case, rng, ABSORBABLE[nth % ABSORBABLE.len()], Size::Raw(size))
            }
            Family::AmplitudesNotRecorded => {
                let physics = AMPLITUDE_DEPENDENT[nth % AMPLITUDE_DEPENDENT.len()];
                let good = add(&mut case, rng, physics, Size::Visible(0.05));
                let ratio = uniform(rng, 0.08, 0.3);
                plant::quieten(&mut case, ratio, NOISE);
                good
            }
            Family::LookAlikes => {
                let group = LOOK_ALIKES[nth % LOOK_ALIKES.len()];
                let physics = group[rng.random_range(0..group.len())];
                let size = log_uniform(rng, 0.005, 0.03);
                add(&mut case, rng, physics, Size::Visible(size))
            }
            Family::RareInTime => {
                let (contacts, stiffness) = (rng.random_range(2..=6), log_uniform(rng, 20.0, 60.0));
                plant::plant_rare_stop(&mut case, contacts, stiffness);
                true
            }
            Family::RingDown if nth.is_multiple_of(3) => true,
            Family::RingDown => add(&mut case, rng, RING_DOWN[nth % RING_DOWN.len()], Size::Visible(0.02)),
            _ => false,
        };
        // Together two effects may do what neither does alone: a recording that diverges is no
        // recording, and an effect that the other keeps from acting is not in it.
        let whole = |case: &Driven| {
            case.render().reading.iter().all(|y| y.is_finite()) && (0..case.planted.len()).all(|nth| case.acts(nth))
        };
        (good && (case.planted.len() < 2 || whole(&case))).then_some(case)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trial_holds_every_family_and_a_case_follows_from_its_number() {
        let plan = Plan { seed: 5, cases: 60, samples: 1000, campaign: Campaign::Concealed };
        let families = plan.families();
        assert!(Family::ALL.iter().all(|f| families.iter().any(|(g, _)| f == g)));
        for (number, (family, nth)) in families.iter().enumerate().take(12) {
            let case = plan.draw(number, *family, *nth);
            assert_eq!(case, plan.draw(number, *family, *nth));
        }
        assert!(families.iter().skip_while(|(f, _)| !f.is_drawn_last()).all(|(f, _)| f.is_drawn_last()));
        let full = Plan { cases: Campaign::Planted.size(), campaign: Campaign::Planted, ..plan };
        assert_eq!(full.families().len(), full.cases);
    }
}
