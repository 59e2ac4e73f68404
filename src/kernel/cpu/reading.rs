//! Adds an instrument's errors to a reading, law by law: white noise, a random walk, the end of its
//! range and the size of its steps. Next to each law that the shader takes from here stands its
//! WGSL.
//!
//! Each is added to consecutive samples of 64 members; bias instability has a file of its own, and
//! so have the laws that take more than a strength (`slow`).

use super::cheap_noise;
use super::flicker::{self, Flicker};
use super::force_errors::{
    AddForce, AddWarm, AddWarmPower, FORCE, FORCE_SQUARED, WARM, WARM_CUBED, WARM_FORCE, WARM_SQUARED,
};
use super::lanes::{Kernel, LANES, Lane};
use super::slow::{self, AddSettling, AddSine, Markov};
use super::stretch::Numbers;
use crate::fragment::Fragment;
use crate::layout::state;
use crate::member::{COLUMNS, WAVES, column};
use crate::numerics::elementary::{Real, fma};
use crate::rng::Stream;
use crate::sensor::error_law::ErrorLaw;
use crate::sensor::terms::alike;
use crate::sensor::{Sense, SensorTerm};

/// Terms that are bias instability.
const FLICKERS: usize = alike(ErrorLaw::Flicker(Stream::Host), SensorTerm::COUNT);

/// State that the terms carry from sample to sample.
#[derive(Debug, Clone)]
pub(super) struct State<T> {
    /// Value of each random walk.
    pub walks: [Lane<T>; state::WALK_COUNT],
    /// Each Gauss–Markov process.
    pub markovs: [Lane<T>; state::MARKOV_COUNT],
    /// The Gauss–Markov terms of each bias instability.
    pub flickers: [Flicker<T>; FLICKERS],
}

impl<T: Real> State<T> {
    /// At the beginning, without any flicker terms.
    pub(super) fn new() -> Self {
        let zero = Lane::splat(T::of(0.0));
        let flickers = std::array::from_fn(|_| Flicker::new(0));
        Self { walks: [zero; state::WALK_COUNT], markovs: [zero; state::MARKOV_COUNT], flickers }
    }

    /// All that changes from sample to sample.
    pub(super) fn lanes(&mut self) -> impl Iterator<Item = &mut Lane<T>> {
        let Self { walks, markovs, flickers } = self;
        walks.iter_mut().chain(markovs).chain(flickers.iter_mut().flat_map(Flicker::lanes))
    }
}

/// The WGSL of a law; none for those that act on the reading as a whole, which the shader itself
/// has.
pub(crate) fn fragment(law: ErrorLaw) -> Option<&'static Fragment> {
    match law {
        ErrorLaw::White(_) => Some(&WHITE),
        ErrorLaw::Flicker(_) => Some(&flicker::FLICKER),
        ErrorLaw::Walk(_) => Some(&WALK),
        ErrorLaw::Ramp => Some(&RAMP),
        ErrorLaw::Offset => Some(&OFFSET),
        ErrorLaw::Warm(0) => Some(&WARM),
        ErrorLaw::Warm(_) => Some(&WARM_FORCE),
        ErrorLaw::WarmPower(2) => Some(&WARM_SQUARED),
        ErrorLaw::WarmPower(_) => Some(&WARM_CUBED),
        ErrorLaw::Force(1) => Some(&FORCE),
        ErrorLaw::Force(_) => Some(&FORCE_SQUARED),
        ErrorLaw::Markov(_) => Some(&slow::MARKOV),
        ErrorLaw::Settling => Some(&slow::SETTLING),
        ErrorLaw::Sine => Some(&slow::SINE),
        ErrorLaw::Constant
        | ErrorLaw::Proportional(_)
        | ErrorLaw::Shape(_)
        | ErrorLaw::Rounding
        | ErrorLaw::FullScale
        | ErrorLaw::LowPass
        | ErrorLaw::Delay => None,
    }
}

/// Samples that the terms are added to: the errors of consecutive samples, and what was felt at
/// each.
pub(super) struct Samples<'a, T> {
    /// Specific force along the axis.
    pub felt: &'a [Lane<T>],
    /// Temperature of the sensor above its reference, K; empty where it is not.
    pub warmer: &'a [T],
    pub out: &'a mut [Lane<T>],
}

/// Whose counters make what an instrument draws at each sample.
pub(crate) const fn sample_stream(sense: Sense) -> Stream {
    match sense {
        Sense::Accelerometer => Stream::AccelerometerWhite,
        Sense::Gyro => Stream::GyroWhite,
    }
}

/// Adds one term to consecutive samples; laws that act on the reading as a whole are added
/// elsewhere.
pub(super) fn add<T: Real>(
    term: SensorTerm,
    numbers: &mut Numbers<'_, T>,
    columns: &[Lane<T>; COLUMNS],
    waves: &[Lane<u32>; WAVES],
    state: &mut State<T>,
    amplitudes: &[T],
    samples: Samples<'_, T>,
) {
    let Samples { felt, warmer, out } = samples;
    let (level, scale) = (numbers.level, &columns[column::of(term)]);
    match term.law() {
        ErrorLaw::White(stream) => level.run(AddWhite { scale, numbers: numbers.each_and_bits(stream), out }),
        ErrorLaw::Walk(stream) => {
            let walk = &mut state.walks[term.rank()];
            let first = numbers.from;
            level.run(AddWalk { scale, bits: numbers.bits(stream), first, walk, out });
        }
        ErrorLaw::Flicker(stream) => {
            let steps = sample_stream(term.sense());
            flicker::add(numbers, [steps, stream], &mut state.flickers[term.rank()], amplitudes, scale, out);
        }
        ErrorLaw::Ramp => level.run(AddRamp { scale, first: numbers.from, out }),
        ErrorLaw::Offset => level.run(AddOffset { scale, out }),
        ErrorLaw::Force(power) => level.run(AddForce { scale, felt, squared: power == 2, out }),
        ErrorLaw::Warm(power) => level.run(AddWarm { scale, felt: (power == 1).then_some(felt), warmer, out }),
        ErrorLaw::WarmPower(power) => level.run(AddWarmPower { scale, power, warmer, out }),
        ErrorLaw::Markov(stream) => {
            let terms = Markov { sigma: scale, memory: &columns[column::of(term) + 1] };
            slow::add_markov(terms, stream, numbers, &mut state.markovs[term.rank()], out);
        }
        ErrorLaw::Settling => {
            level.run(AddSettling { start: scale, rate: &columns[column::of(term) + 1], first: numbers.from, out });
        }
        ErrorLaw::Sine => {
            let [phase, step] = [0, 1].map(|i| &waves[2 * term.rank() + i]);
            level.run(AddSine { amplitude: scale, phase, step, first: numbers.from, out });
        }
        // In `oscillator` with the reading itself, in `low_pass`, `Late` and `Limit`; a shape is
        // none.
        ErrorLaw::Constant
        | ErrorLaw::Proportional(_)
        | ErrorLaw::Shape(_)
        | ErrorLaw::Rounding
        | ErrorLaw::FullScale
        | ErrorLaw::LowPass
        | ErrorLaw::Delay => {}
    }
}

/// White noise in the shader.
pub const WHITE: Fragment = Fragment {
    begin: "
    let $term_sigma = column(i, $TERM);
    var $term_numbers = vec4<f32>();
",
    block: "",
    draw: "
        if HAS_$TERM {
            $term_numbers = normals($sense_words);
        }
",
    add: "
                if HAS_$TERM {
                    $out = fma($term_sigma, pick($term_numbers, number), $out);
                }
",
    end: "",
};

struct AddWhite<'a, T> {
    pub scale: &'a Lane<T>,
    pub numbers: &'a [Lane<T>],
    pub out: &'a mut [Lane<T>],
}

impl<T: Real> Kernel for AddWhite<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for (out, number) in self.out.iter_mut().zip(self.numbers) {
            for l in 0..LANES {
                out[l] = fma::<T, FMA>(self.scale[l], number[l], out[l]);
            }
        }
    }
}

/// The mean error that a still start has found.
pub(super) struct TakeOff<'a, T> {
    pub mean: &'a Lane<T>,
    pub out: &'a mut [Lane<T>],
}

impl<T: Real> Kernel for TakeOff<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for out in self.out.iter_mut() {
            for l in 0..LANES {
                out[l] = out[l] - self.mean[l];
            }
        }
    }
}

/// A random walk in the shader.
pub const WALK: Fragment = Fragment {
    begin: "
    let $term_sigma = EIGHTH * column(i, $TERM);
    var $term_walk = state[STATE_$TERM * stride + i];
",
    block: "",
    draw: "",
    add: "
                if HAS_$TERM {
                    $term_walk = fma($term_sigma, small_step($sense_words, number, 0u), $term_walk);
                    $out += $term_walk;
                }
",
    end: "
    state[STATE_$TERM * stride + i] = $term_walk;
",
};

struct AddWalk<'a, T> {
    /// Deviation of one increment.
    pub scale: &'a Lane<T>,
    /// Of each four samples.
    pub bits: &'a [Lane<u32>],
    /// Number of the first of the samples.
    pub first: u64,
    /// Value of the walk.
    pub walk: &'a mut Lane<T>,
    pub out: &'a mut [Lane<T>],
}

impl<T: Real> Kernel for AddWalk<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let mut scale = *self.scale;
        for l in 0..LANES {
            scale[l] = T::of(cheap_noise::EIGHTH) * scale[l];
        }
        for (i, out) in self.out.iter_mut().enumerate() {
            let sample = self.first + i as u64;
            let bits = &self.bits[((sample >> 2) - (self.first >> 2)) as usize];
            for l in 0..LANES {
                self.walk[l] = fma::<T, FMA>(scale[l], cheap_noise::walk(bits[l], sample), self.walk[l]);
                out[l] = out[l] + self.walk[l];
            }
        }
    }
}

/// A straight line in the shader.
pub(crate) const RAMP: Fragment = Fragment {
    begin: "
    let $term_slope = column(i, $TERM);
",
    block: "",
    draw: "",
    add: "
                if HAS_$TERM {
                    $out = fma($term_slope, f32(n) + 0.5, $out);
                }
",
    end: "",
};

/// A straight line in time: what it is in the middle of each sample, so that its integral is exact.
struct AddRamp<'a, T> {
    /// Growth in one sample.
    scale: &'a Lane<T>,
    /// Number of the first of the samples.
    first: u64,
    out: &'a mut [Lane<T>],
}

impl<T: Real> Kernel for AddRamp<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for (i, out) in self.out.iter_mut().enumerate() {
            let time = T::of((self.first + i as u64) as f64) + T::of(0.5);
            for l in 0..LANES {
                out[l] = fma::<T, FMA>(self.scale[l], time, out[l]);
            }
        }
    }
}

/// A constant in the shader.
pub(crate) const OFFSET: Fragment = Fragment {
    begin: "
    let $term_offset = column(i, $TERM);
",
    block: "",
    draw: "",
    add: "
                if HAS_$TERM {
                    $out += $term_offset;
                }
",
    end: "",
};

struct AddOffset<'a, T> {
    scale: &'a Lane<T>,
    out: &'a mut [Lane<T>],
}

impl<T: Real> Kernel for AddOffset<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for out in self.out.iter_mut() {
            for l in 0..LANES {
                out[l] = out[l] + self.scale[l];
            }
        }
    }
}

/// A delay of the reading: until here the force was the one that it is late of.
pub(super) struct Late<'a, T> {
    /// Difference of the late force from the force itself, at unit gain.
    pub late: &'a [T],
    /// Factor of each member on the shared force.
    pub gain: &'a Lane<T>,
    pub felt: &'a mut [Lane<T>],
    pub error: &'a mut [Lane<T>],
}

impl<T: Real> Kernel for Late<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for ((error, felt), late) in self.error.iter_mut().zip(self.felt).zip(self.late) {
            for l in 0..LANES {
                error[l] = fma::<T, FMA>(self.gain[l], *late, error[l]);
                felt[l] = fma::<T, FMA>(-self.gain[l], *late, felt[l]);
            }
        }
    }
}

/// Full scale and quantisation, which act on the reading itself: on the specific force felt plus
/// the error so far.
pub(super) struct Limit<'a, T> {
    /// Largest magnitude of a reading.
    pub range: Option<&'a Lane<T>>,
    /// Size of a step, and steps per m/s²; 0 for none.
    pub steps: Option<[&'a Lane<T>; 2]>,
    pub felt: &'a [Lane<T>],
    pub error: &'a mut [Lane<T>],
}

impl<T: Real> Kernel for Limit<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for (error, felt) in self.error.iter_mut().zip(self.felt) {
            if let Some(range) = self.range {
                for l in 0..LANES {
                    error[l] = error[l].min(range[l] - felt[l]).max(-range[l] - felt[l]);
                }
            }
            if let Some([size, steps]) = self.steps {
                for l in 0..LANES {
                    let reading = (felt[l] + error[l]) * steps[l];
                    error[l] = fma::<T, FMA>(size[l], reading.round() - reading, error[l]);
                }
            }
        }
    }
}
