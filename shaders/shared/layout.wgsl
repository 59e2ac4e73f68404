// What host and device agree on; the mirrors stand in `src/kernel/layout.rs`, and a test compares
// them. Places in a member's column and state, streams and codes are constants that
// `src/kernel/source.rs` writes in front of this file.

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
    // Samples of the still start, one over that, and the tilt that hides an error of 1 m/s² when
    // levelling, rad.
    still_samples: u32,
    still_share: f32,
    level: f32,
    padding: u32,
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
