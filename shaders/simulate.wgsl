// One tile: each invocation takes one member through the samples, from state to state. Twin of
// `src/kernel/cpu/simulate.rs`; see there for what happens in which order and why. Lines `#terms …`
// are replaced by what the sensor terms have to say there, see `src/kernel/source/terms.rs`; lines
// `#own …` by the states of laws that have any, see `src/kernel/source/staged.rs`; the line `#warm …`
// by the temperature, where a law follows it, and lines `#trace …` by the writing of every reading's
// errors, where `navigate` reads them, and by nothing elsewhere.

override INTEGRATOR: u32 = 0u;
override SUBSTEPS: u32 = 1u;
override HAS_FORCE: bool = false;
override HAS_SINE: bool = false;
override HAS_GYRO: bool = false;
override HAS_READING: bool = false;
override HAS_STILL: bool = false;

@group(0) @binding(0) var<uniform> tile: Tile;
@group(0) @binding(1) var<storage, read> columns: array<f32>;
@group(0) @binding(2) var<storage, read> turns: array<u32>;
@group(0) @binding(3) var<storage, read_write> state: array<f32>;
// Per substep: end, middle, middle less begin, end less begin; the first entry holds where the
// first begins. Uniform memory, because all members read the same place at the same time.
@group(0) @binding(4) var<uniform> forces: array<vec4<f32>, 4096>;
@group(0) @binding(5) var<storage, read_write> errors: array<f32>;
// How much warmer than its reference the sensor is in each sample of the tile, K, and behind that
// what the late force has more than the force itself; one zero where neither is needed.
@group(0) @binding(6) var<storage, read> warmer: array<f32>;
#trace declare

fn column(i: u32, which: u32) -> f32 {
    return columns[which * tile.stride + i];
}

// One of the four numbers of a draw, as a value: numbers in memory would be slow.
fn pick(numbers: vec4<f32>, number: u32) -> f32 {
    return numbers[number];
}

fn amplitude(term: u32) -> f32 {
    return tile.flicker[term >> 2u][term & 3u];
}

// Sum of the flicker terms 2 and slower that begin at `base`.
fn sum_slowest(i: u32, base: u32) -> f32 {
    var sum = 0.0;
    for (var j = 2u; j < tile.flicker_terms; j++) {
        sum = fma(amplitude(j), state[(base + j) * tile.stride + i], sum);
    }
    return sum;
}

// Slow terms at the beginning of a run.
fn start_terms(i: u32, base: u32, member: vec2<u32>, stream: u32) {
    for (var j = 0u; j < tile.flicker_terms; j++) {
        state[(base + j) * tile.stride + i] = gaussians(0u, member, stream | ((2u + j) << 8u), tile.seed).x;
    }
}

// Where in the schedule of renewals the 64 members of this one begin, samples.
fn place(i: u32) -> u32 {
    let group = ((tile.first_member.x >> 6u) | (tile.first_member.y << 26u)) + (i >> 6u);
    return ((group * SPREAD) & PLACE_MASK) << 4u;
}

// Sum of the terms 2 and slower after the renewal of one of them, which is due only where a group
// of eight begins.
fn renew_slowest(i: u32, base: u32, n: u32, number: f32, sum: f32) -> f32 {
    let zeros = countTrailingZeros(n + place(i));
    let j = (zeros + 1u) >> 1u;
    if n < tile.first_sample || n == 0u || (zeros & 1u) == 0u || j >= tile.flicker_terms {
        return sum;
    }
    let place = (base + j) * tile.stride + i;
    state[place] = fma(RETAINED, state[place], RENEWED * number);
    return sum_slowest(i, base);
}

// A small step of a sample: three bits that no gaussian number looks at, from bit `place` of its
// word on.
fn small_step(words: vec4<u32>, number: u32, place: u32) -> f32 {
    return f32((words[number] >> place) & 7u) - 3.5;
}

// That of the term renewed once in four samples.
fn fourth_step(words: vec4<u32>) -> f32 {
    let last = (words >> vec4<u32>(6u)) & vec4<u32>(1u);
    return f32(last.x + last.y + last.z + last.w) - 2.0;
}

// Terms 0 and 1 after the renewals of a sample, the third or another of its group of four.
fn renew_fastest(words: vec4<u32>, number: u32, terms: vec3<f32>) -> vec3<f32> {
    let first = fma(RETAINED, terms.x, RENEWED_EIGHTH * small_step(words, number, 3u));
    let second = select(terms.y, fma(RETAINED, terms.y, RENEWED * fourth_step(words)), number == 2u);
    return vec3<f32>(first, second, terms.z);
}

@compute @workgroup_size(64)
fn simulate(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if i >= tile.members {
        return;
    }
    let stride = tile.stride;
    let low = tile.first_member.x + i;
    let member = vec2<u32>(low, tile.first_member.y + select(0u, 1u, low < i));
    let seed = tile.seed;
    let zero = tile.zero;

    let k = Coefficients(
        vec4<f32>(column(i, COEFFICIENT_0), column(i, COEFFICIENT_1), column(i, COEFFICIENT_2), column(i, COEFFICIENT_3)),
        vec4<f32>(column(i, COEFFICIENT_4), column(i, COEFFICIENT_5), column(i, COEFFICIENT_6), column(i, COEFFICIENT_7)),
    );
    let laws = laws_of(i);
#own load
    let gain = column(i, GAIN);
    // While a still start lasts, nothing moves and no tilt is integrated.
    let still = HAS_STILL && tile.first_sample < tile.still_samples;
    let sine = select(column(i, SINE), 0.0, still);
    let tilt_gain = select(tile.tilt_gain, 0.0, still);
    let phase = turns[i];
    let phase_step = turns[stride + i];
    let bias = column(i, ACCELEROMETER_BIAS);
    let scale = column(i, SCALE_FACTOR);
    let k2 = column(i, NONLINEARITY);
    let k3 = column(i, CUBIC_NONLINEARITY);
    let range = column(i, RANGE);
    let lsb = column(i, QUANTISATION);
    let steps = column(i, STEPS);
    let force_sigma = column(i, FORCE);
    let gyro_bias = column(i, GYRO_BIAS);

    var s = vec2<f32>(state[STATE_E * stride + i], state[STATE_Q * stride + i]);
    var position = state[STATE_POSITION * stride + i];
    var velocity = state[STATE_VELOCITY * stride + i];
    var rate = state[STATE_RATE * stride + i];
    var position_total =
        vec2<f32>(state[STATE_POSITION_TOTAL * stride + i], state[(STATE_POSITION_TOTAL + 1u) * stride + i]);
    var velocity_total =
        vec2<f32>(state[STATE_VELOCITY_TOTAL * stride + i], state[(STATE_VELOCITY_TOTAL + 1u) * stride + i]);
    var rate_total = vec2<f32>(state[STATE_RATE_TOTAL * stride + i], state[(STATE_RATE_TOTAL + 1u) * stride + i]);
    var failed = state[STATE_FAILED * stride + i];
    var low_pass = state[STATE_LOW_PASS * stride + i];
    var weights = array<f32, 7>();
    if HAS_READOUT_LOW_PASS {
        weights[0] = column(i, LOW_PASS_KEPT);
        weights[1] = column(i, LOW_PASS_E_BEGIN);
        weights[2] = column(i, LOW_PASS_V_BEGIN);
        weights[3] = column(i, LOW_PASS_E_END);
        weights[4] = column(i, LOW_PASS_V_END);
        weights[5] = column(i, LOW_PASS_GROWTH);
        weights[6] = column(i, LOW_PASS_PUSH);
    }
    let bound = bitcast<u32>(f32(BOUND_M_S2));

    // At its end the means are taken off and the integrals begin.
    var mean = 0.0;
    var gyro_mean = 0.0;
    if HAS_STILL {
        mean = state[STATE_MEAN * stride + i];
        gyro_mean = state[STATE_GYRO_MEAN * stride + i];
        if tile.first_sample == tile.still_samples {
            mean = tile.still_share * (velocity_total.x + (velocity + velocity_total.y));
            gyro_mean = tile.still_share * (rate_total.x + (rate + rate_total.y));
            position = 0.0;
            velocity = 0.0;
            rate = 0.0;
            position_total = vec2<f32>();
            velocity_total = vec2<f32>();
            rate_total = vec2<f32>();
        }
    }

#terms begin
    var pushes = vec4<f32>();
    var accelerometer_words = vec4<u32>();
    var gyro_words = vec4<u32>();
    var error = 0.0;

    // Four samples at a time, which one draw serves, and sixteen, in which the slow terms are
    // renewed twice. The four are a loop of known length, so that a compiler unrolls it, and
    // samples outside the tile are masked: software adapters run both sides of a branch and gain
    // nothing by skipping.
    let stop = tile.first_sample + tile.samples;
    let first_counter = tile.first_sample >> 2u;
    let last_counter = (stop - 1u) >> 2u;
    var before = forces[0].x;
    for (var block = tile.first_sample >> 4u; block <= (stop - 1u) >> 4u; block++) {
#terms block
        let first = max(4u * block, first_counter);
        let last = min(4u * block + 3u, last_counter);
        for (var counter = first; counter <= last; counter++) {
            if draws_accelerometer() {
                accelerometer_words = philox(vec4<u32>(counter, member, STREAM_ACCELEROMETER), seed);
            }
            if draws_gyro() {
                gyro_words = philox(vec4<u32>(counter, member, STREAM_GYRO), seed);
            }
            if HAS_FORCE {
                pushes = gaussians(counter, member, STREAM_FORCE, seed);
            }
#terms draw

            for (var number = 0u; number < 4u; number++) {
                let n = 4u * counter + number;
                if n >= tile.first_sample && n < stop {
                    // Mechanics.
#warm sample
                    let push = force_sigma * pick(pushes, number);
                    var felt = 0.0;
                    for (var substep = 0u; substep < SUBSTEPS; substep++) {
                        let now = forces[(n - tile.first_sample) * SUBSTEPS + substep + 1u];
                        var own = vec3<f32>();
                        if HAS_SINE {
                            let half = (n * SUBSTEPS + substep) * 2u;
                            own.x = sine * sin_cos_turns(phase + half * phase_step).x;
                            own.y = sine * sin_cos_turns(phase + (half + 1u) * phase_step).x;
                            own.z = sine * sin_cos_turns(phase + (half + 2u) * phase_step).x;
                        }
                        let f = Force(
                            fma(gain, before, own.x),
                            fma(gain, now.y, own.y),
                            fma(gain, now.x, own.z),
                            fma(gain, now.z, own.y - own.x),
                            fma(gain, now.w, own.z - own.x),
                        );
                        before = now.x;
                        let begin = seen(laws, s, f.begin);
                        // A run begins at rest, and with it what the low-pass holds.
                        if HAS_READOUT_LOW_PASS && n * SUBSTEPS + substep == 0u {
                            low_pass = begin.x;
                        }
                        s = advance(k, laws, s, f, push, f32(n * SUBSTEPS + substep));
                        felt = f.end;
                        if HAS_READOUT_LOW_PASS {
                            var p = fma(weights[5], f.to_end, weights[6] * push);
                            let end = seen(laws, s, f.end);
                            p = fma(weights[4], end.y - f.to_end, p);
                            p = fma(weights[3], end.x, p);
                            p = fma(weights[2], begin.y - f.to_end, p);
                            p = fma(weights[1], begin.x, p);
                            low_pass = fma(weights[0], low_pass, p);
                        }
                    }

                    // The accelerometer's reading.
                    let shown = select(seen(laws, s, felt).x, low_pass, HAS_READOUT_LOW_PASS);
                    error = shown + bias;
                    if HAS_READING {
                        let a = felt + shown;
                        error = fma(fma(fma(k3, a, k2), a, scale), a, error);
                    }
                    // Until here the force was the one that the reading is late of.
                    if HAS_READOUT_DELAY {
                        let late = gain * warmer[tile.samples + n - tile.first_sample];
                        error += late;
                        felt -= late;
                    }
#terms add accelerometer
                    if HAS_RANGE {
                        error = max(min(error, range - felt), -range - felt);
                    }
                    if HAS_QUANTISATION {
                        // Opaque, so that no compiler fuses what must round to the same whole number
                        // everywhere.
                        let reading = opaque((opaque(felt, zero) + error) * steps, zero);
                        error = fma(lsb, round(reading) - reading, error);
                    }
                    if HAS_STILL {
                        error -= mean;
                    }

#trace accelerometer

                    // The gyro, the tilt and what gravity makes of it.
                    if HAS_GYRO {
                        var turn = gyro_bias;
#terms add gyro
                        if HAS_STILL {
                            turn -= gyro_mean;
                        }
#trace gyro
                        error = fma(tilt_gain, fma(0.5, turn, rate_total.x + rate), error);
                        rate += turn;
                    }

                    // Two integrations.
                    position += fma(0.5, error, velocity);
                    velocity += error;
                }
            }

            if (counter & 15u) == 15u && 4u * counter + 3u < stop {
                position_total = add_compensated(position_total, 64.0 * velocity_total.x, zero);
                position_total = add_compensated(position_total, position, zero);
                position_total.y += 64.0 * velocity_total.y;
                velocity_total = add_compensated(velocity_total, velocity, zero);
                rate_total = add_compensated(rate_total, rate, zero);
                position = 0.0;
                velocity = 0.0;
                rate = 0.0;
                if (bitcast<u32>(error) & 0x7FFFFFFFu) > bound || (bitcast<u32>(s.x) & 0x7FFFFFFFu) > bound {
                    failed = 1.0;
                }
            }
        }
    }

    state[STATE_E * stride + i] = s.x;
    state[STATE_Q * stride + i] = s.y;
#own keep
    state[STATE_POSITION * stride + i] = position;
    state[STATE_VELOCITY * stride + i] = velocity;
    state[STATE_RATE * stride + i] = rate;
    state[STATE_POSITION_TOTAL * stride + i] = position_total.x;
    state[(STATE_POSITION_TOTAL + 1u) * stride + i] = position_total.y;
    state[STATE_VELOCITY_TOTAL * stride + i] = velocity_total.x;
    state[(STATE_VELOCITY_TOTAL + 1u) * stride + i] = velocity_total.y;
    state[STATE_RATE_TOTAL * stride + i] = rate_total.x;
    state[(STATE_RATE_TOTAL + 1u) * stride + i] = rate_total.y;
    state[STATE_FAILED * stride + i] = failed;
    if HAS_READOUT_LOW_PASS {
        state[STATE_LOW_PASS * stride + i] = low_pass;
    }
    if HAS_STILL {
        state[STATE_MEAN * stride + i] = mean;
        state[STATE_GYRO_MEAN * stride + i] = gyro_mean;
    }
#terms end

    // Errors at the end of the tile: position, velocity, acceleration, tilt, and whether the member
    // failed.
    let since = f32((tile.first_sample + tile.samples) & 63u);
    let moved = position_total.x + (fma(since, velocity_total.x, position) + (position_total.y + since * velocity_total.y));
    if (bitcast<u32>(error) & 0x7FFFFFFFu) > bound {
        failed = 1.0;
    }
    errors[i] = tile.sample_s * tile.sample_s * moved;
    errors[stride + i] = tile.sample_s * (velocity_total.x + (velocity + velocity_total.y));
    errors[2u * stride + i] = error;
    // Levelling by an accelerometer that errs by its mean leaves a tilt whose share of gravity
    // hides that mean; a drawn tilt is the one that lets its share in.
    errors[3u * stride + i] = fma(tile.level, initial_tilt_offset - mean, tile.sample_s * (rate_total.x + (rate + rate_total.y)));
    errors[4u * stride + i] = failed;
}
