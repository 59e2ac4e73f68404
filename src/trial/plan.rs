//! Which cases a trial has: how many of each family, and how each is drawn from the seed.

use rand::RngExt;
use serde::{Deserialize, Serialize};

use super::case::{Body, Case, Family};
use super::driven::Driven;
use super::physics::{FOREIGN, LIBRARY, Physics};
use super::plant::{self, Drive, Size, log_uniform, plant, uniform};
use super::standstill::{SLOW, Slow, Still};
use super::turning::{FAULTS, Turned};
use crate::rng::{Philox, Stream};

/// Readout noise of every planted case, relative to the rms output.
const NOISE: f64 = 0.002;

/// What to make.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Of everything.
    pub seed: u64,
    /// About how many; each family gets its share.
    pub cases: usize,
    /// Rows per driven recording.
    pub samples: usize,
}

/// Cases per family in a trial of [`DEFAULT_CASES`].
fn share(family: Family) -> usize {
    match family {
        Family::Null => 130,
        Family::ForceNoiseOnly => 15,
        Family::SingleOnePercent | Family::SingleFivePercent => 42,
        Family::Pair => 30,
        Family::UnknownPhysics => 40,
        Family::UnderTheNoise => 21,
        Family::AbsorbedByBase => 20,
        Family::AmplitudesNotRecorded => 14,
        Family::LookAlikes => 24,
        Family::BehindALarger => 20,
        Family::RareInTime => 12,
        Family::AroundTheLimit => 63,
        Family::RingDown => 16,
        Family::StillNull => 30,
        Family::StillPlanted => 36,
        Family::WithheldColumn => 12,
        Family::TurnedNull => 12,
        Family::TurnedPlanted => 24,
    }
}

/// Size of the default trial.
pub const DEFAULT_CASES: usize = 603;

/// The nth effect of a family: a stride of eight visits all twenty-one, and a short trial a varied part of them.
fn effect(nth: usize) -> Physics {
    LIBRARY[(8 * nth) % LIBRARY.len()]
}

/// Groups whose members resemble each other.
const LOOK_ALIKES: [&[Physics]; 3] = [
    &[Physics::ReadoutNonlinearity, Physics::CubicStiffness],
    &[Physics::ReadoutDelay, Physics::ReadoutLowpass, Physics::ParasiticMode],
    &[Physics::CoulombFriction, Physics::QuadraticDamping, Physics::SqueezeFilmDamping],
];

/// What base parameters absorb when there is one amplitude and a narrow band.
const ABSORBABLE: [Physics; 7] = [
    Physics::CubicStiffness,
    Physics::QuadraticDamping,
    Physics::SqueezeFilmDamping,
    Physics::CoulombFriction,
    Physics::Hysteresis,
    Physics::ReadoutDelay,
    Physics::ReadoutLowpass,
];

/// What shows only at amplitudes that were not recorded.
const AMPLITUDE_DEPENDENT: [Physics; 5] = [
    Physics::CubicStiffness,
    Physics::QuadraticStiffness,
    Physics::SqueezeFilmDamping,
    Physics::QuadraticDamping,
    Physics::EndStop,
];

/// What a free ring-down can show.
const RING_DOWN: [Physics; 5] = [
    Physics::CubicStiffness,
    Physics::QuadraticDamping,
    Physics::SqueezeFilmDamping,
    Physics::CoulombFriction,
    Physics::BiasDrift,
];

impl Plan {
    /// The families of all cases, interleaved so that any first part of a trial holds some of each.
    pub fn families(&self) -> Vec<(Family, usize)> {
        let total: usize = Family::ALL.iter().map(|f| share(*f)).sum();
        let mut all: Vec<(f64, Family, usize)> = Vec::new();
        for family in Family::ALL {
            let count = ((share(family) * self.cases) as f64 / total as f64).round().max(1.0) as usize;
            all.extend((0..count).map(|k| ((k as f64 + 0.5) / count as f64, family, k)));
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all.into_iter().map(|(_, family, k)| (family, k)).collect()
    }

    /// Draws the case with this number, `nth` of its family.
    pub fn draw(&self, number: usize, family: Family, nth: usize) -> Case {
        let body = match family {
            Family::StillNull | Family::StillPlanted | Family::WithheldColumn => {
                let mut rng = Philox::new(self.seed, number as u64, Stream::Host);
                Body::Still(Box::new(self.still(&mut rng, family, nth)))
            }
            Family::TurnedNull | Family::TurnedPlanted => {
                let mut rng = Philox::new(self.seed, number as u64, Stream::Host);
                let mut case = Turned::bare(&mut rng);
                let size = log_uniform(&mut rng, 0.1, 3.0);
                if family == Family::TurnedPlanted {
                    case.plant(&mut rng, FAULTS[nth % FAULTS.len()], size);
                }
                Body::Turned(Box::new(case))
            }
            // A shape that cannot reach its size (a stop never touched, a spring that would snap) is drawn anew.
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
                let slow = SLOW[(4 * nth) % SLOW.len()];
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
        let library = |rng: &mut Philox| LIBRARY[rng.random_range(0..LIBRARY.len())];
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
                add(&mut case, rng, FOREIGN[(7 * nth) % FOREIGN.len()], Size::Visible(size))
            }
            Family::Pair | Family::BehindALarger => {
                let first = library(rng);
                let second = (0..).map(|_| library(rng)).find(|p| *p != first)?;
                let sizes =
                    if family == Family::Pair { [0, 1].map(|_| log_uniform(rng, 0.02, 0.05)) } else { [0.1, 0.01] };
                add(&mut case, rng, first, Size::Visible(sizes[0]))
                    && add(&mut case, rng, second, Size::Visible(sizes[1]))
            }
            Family::AbsorbedByBase => {
                let size = log_uniform(rng, 0.03, 0.1);
                add(&mut case, rng, ABSORBABLE[nth % ABSORBABLE.len()], Size::Raw(size))
            }
            Family::AmplitudesNotRecorded => {
                let physics = AMPLITUDE_DEPENDENT[nth % AMPLITUDE_DEPENDENT.len()];
                let good = add(&mut case, rng, physics, Size::Visible(0.05));
                let share = uniform(rng, 0.08, 0.3);
                plant::quieten(&mut case, share, NOISE);
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
        // Together two effects may do what neither does alone: a recording that diverges is no recording.
        (good && (case.planted.len() < 2 || case.render().reading.iter().all(|y| y.is_finite()))).then_some(case)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trial_holds_every_family_and_a_case_follows_from_its_number() {
        let plan = Plan { seed: 5, cases: 60, samples: 1000 };
        let families = plan.families();
        assert!(Family::ALL.iter().all(|f| families.iter().any(|(g, _)| f == g)));
        for (number, (family, nth)) in families.iter().enumerate().take(12) {
            let case = plan.draw(number, *family, *nth);
            assert_eq!(case, plan.draw(number, *family, *nth));
        }
        assert_eq!(share_sum(), DEFAULT_CASES);
    }

    fn share_sum() -> usize {
        Family::ALL.iter().map(|f| share(*f)).sum()
    }
}
