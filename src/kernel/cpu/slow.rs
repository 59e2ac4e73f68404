//! Laws of a reading's slow errors that take more than a strength: a Gauss–Markov process, what
//! settles after switch-on, a sine. Next to each stands its WGSL; the numbers of its shape are the
//! columns behind its own.

use super::lanes::{Kernel, LANES, Lane};
use super::stretch::Numbers;
use crate::fragment::Fragment;
use crate::numerics::elementary::{Real, fma, sin_cos_turns};
use crate::numerics::exponential::exp;
use crate::rng::Stream;

/// A Gauss–Markov process in the shader: stream 1 starts it from its stationary law.
pub(crate) const MARKOV: Fragment = Fragment {
    begin: "
    let $term_memory = column(i, NEXT_TO_$TERM);
    let $term_step = column(i, $TERM) * sqrt($term_memory * (2.0 - $term_memory));
    var $term_numbers = vec4<f32>();
    var $term_state = state[STATE_$TERM * stride + i];
    if HAS_$TERM && tile.first_sample == 0u {
        $term_state = column(i, $TERM) * gaussians(0u, member, STREAM_$TERM | (1u << 8u), seed).x;
    }
",
    block: "",
    draw: "
        if HAS_$TERM {
            $term_numbers = gaussians(counter, member, STREAM_$TERM, seed);
        }
",
    add: "
                if HAS_$TERM {
                    $term_state = fma(-$term_memory, $term_state, $term_state);
                    $term_state = fma($term_step, pick($term_numbers, number), $term_state);
                    $out += $term_state;
                }
",
    end: "
    state[STATE_$TERM * stride + i] = $term_state;
",
};

/// Strength and shape of a Gauss–Markov process.
pub(super) struct Markov<'a, T> {
    /// Its standard deviation.
    pub sigma: &'a Lane<T>,
    /// The part of itself that it loses over a sample, 1 − e^(−T/τ).
    pub memory: &'a Lane<T>,
}

/// Starts the process where a run begins, takes it through the samples of a stretch and adds it.
pub(super) fn add_markov<T: Real>(
    terms: Markov<'_, T>,
    stream: Stream,
    numbers: &mut Numbers<'_, T>,
    state: &mut Lane<T>,
    out: &mut [Lane<T>],
) {
    let level = numbers.level;
    if numbers.from == 0 {
        let start = numbers.start(stream, 1);
        for l in 0..LANES {
            state[l] = terms.sigma[l] * start[l];
        }
    }
    level.run(AddMarkov { terms, numbers: numbers.each(stream), state, out });
}

struct AddMarkov<'a, T> {
    terms: Markov<'a, T>,
    numbers: &'a [Lane<T>],
    state: &'a mut Lane<T>,
    out: &'a mut [Lane<T>],
}

impl<T: Real> Kernel for AddMarkov<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Markov { sigma, memory } = self.terms;
        let mut step = *sigma;
        for l in 0..LANES {
            // Exact for its stationary law: σ² (1 − e^(−2T/τ)).
            step[l] = sigma[l] * (memory[l] * (T::of(2.0) - memory[l])).sqrt();
        }
        for (out, number) in self.out.iter_mut().zip(self.numbers) {
            for l in 0..LANES {
                let kept = fma::<T, FMA>(-memory[l], self.state[l], self.state[l]);
                self.state[l] = fma::<T, FMA>(step[l], number[l], kept);
                out[l] = out[l] + self.state[l];
            }
        }
    }
}

/// Fragment of what dies out.
pub(crate) const SETTLING: Fragment = Fragment {
    begin: "
    let $term_start = column(i, $TERM);
    let $term_rate = column(i, NEXT_TO_$TERM);
",
    block: "",
    draw: "",
    add: "
                if HAS_$TERM {
                    $out = fma($term_start, exp(-$term_rate * (f32(n) + 0.5)), $out);
                }
",
    end: "",
};

/// Adds what dies out exponentially: its value in the middle of each sample.
pub(super) struct AddSettling<'a, T> {
    /// Value at the beginning of the run.
    pub start: &'a Lane<T>,
    /// Samples over its time constant, inverted.
    pub rate: &'a Lane<T>,
    /// Number of the first of the samples.
    pub first: u64,
    pub out: &'a mut [Lane<T>],
}

impl<T: Real> Kernel for AddSettling<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for (i, out) in self.out.iter_mut().enumerate() {
            let time = T::of((self.first + i as u64) as f64) + T::of(0.5);
            for l in 0..LANES {
                let left = T::of(exp((-self.rate[l] * time).f64()));
                out[l] = fma::<T, FMA>(self.start[l], left, out[l]);
            }
        }
    }
}

/// A sine in the shader.
pub(crate) const SINE: Fragment = Fragment {
    begin: "
    let $term_amplitude = column(i, $TERM);
    let $term_phase = turns[TURNS_$TERM * stride + i];
    let $term_turn = turns[(TURNS_$TERM + 1u) * stride + i];
",
    block: "",
    draw: "",
    add: "
                if HAS_$TERM {
                    $out = fma($term_amplitude, sin_cos_turns($term_phase + (2u * n + 1u) * $term_turn).x, $out);
                }
",
    end: "",
};

/// A sine: its value in the middle of each sample.
pub(super) struct AddSine<'a, T> {
    pub amplitude: &'a Lane<T>,
    /// Phase at the beginning of the run, 2⁻³² turns.
    pub phase: &'a Lane<u32>,
    /// Growth in half a sample.
    pub step: &'a Lane<u32>,
    /// Number of the first of the samples.
    pub first: u64,
    pub out: &'a mut [Lane<T>],
}

impl<T: Real> Kernel for AddSine<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for (i, out) in self.out.iter_mut().enumerate() {
            let halves = (2 * (self.first + i as u64) + 1) as u32;
            for l in 0..LANES {
                let turns = self.phase[l].wrapping_add(halves.wrapping_mul(self.step[l]));
                out[l] = fma::<T, FMA>(self.amplitude[l], sin_cos_turns::<T, FMA>(turns).0, out[l]);
            }
        }
    }
}
