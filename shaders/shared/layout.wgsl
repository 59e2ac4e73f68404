// What host and device agree on; the mirrors stand in `src/kernel/layout.rs`, and a test compares them.

// One tile: samples of a batch of members.
struct Tile {
    seed: vec2<u32>,
    // Number of the batch's first member.
    first_member: vec2<u32>,
    // Members of the batch, and the distance between columns of the arrays.
    members: u32,
    stride: u32,
    // First sample and how many.
    first_sample: u32,
    samples: u32,
    flicker_terms: u32,
    // Gravity times sample period.
    tilt_gain: f32,
    // Sample period, s.
    sample_s: f32,
    // Zero, which no compiler knows: it keeps compensated sums from being optimised away.
    zero: u32,
    // Amplitudes of the flicker terms, four by four.
    flicker: array<vec4<f32>, 4>,
}

// The specific force over one substep, m/s².
struct Force {
    begin: f32,
    middle: f32,
    end: f32,
    to_middle: f32,
    to_end: f32,
}

// Bins of a histogram: where the first begins, and bins per unit.
struct Bins {
    begin: f32,
    per_unit: f32,
}

// Moments of one quantity over a block of 256 members.
struct Partial {
    count: u32,
    mean: f32,
    // Sum of deviations from the mean as rounded, and of their squares.
    correction: f32,
    squares: f32,
    least: f32,
    greatest: f32,
}

// What a report is written to: its number, and whether to count.
struct Report {
    members: u32,
    stride: u32,
    number: u32,
    blocks: u32,
    counts: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

// Places in a member's column; the first eight are the oscillator's coefficients.
const GAIN = 8u;
const SINE = 9u;
const BIAS = 10u;
const SCALE = 11u;
const K2 = 12u;
const WHITE = 13u;
const FLICKER = 14u;
const WALK = 15u;
const QUANTISATION = 16u;
const RANGE = 17u;
const FORCE = 18u;
const GYRO_BIAS = 19u;
const GYRO_WHITE = 20u;
const GYRO_FLICKER = 21u;
const GYRO_WALK = 22u;
const STEPS = 23u;

// Places in a member's state; flicker terms follow, the accelerometer's and then the gyro's.
const STATE_E = 0u;
const STATE_Q = 1u;
const STATE_WALK = 2u;
const STATE_GYRO_WALK = 3u;
const STATE_POSITION = 4u;
const STATE_VELOCITY = 5u;
const STATE_RATE = 6u;
const STATE_POSITION_TOTAL = 7u;
const STATE_VELOCITY_TOTAL = 9u;
const STATE_RATE_TOTAL = 11u;
const STATE_FAILED = 13u;
const STATE_TERMS = 14u;

const BOUND_M_S2 = 1e7;
