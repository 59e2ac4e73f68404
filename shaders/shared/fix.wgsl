// A fix applied to one member. Twin of `src/kernel/cpu/aiding.rs`; see there.

// Mirrored in `src/kernel/layout.rs`.
struct Fix {
    seed: vec2<u32>,
    first_member: vec2<u32>,
    // Which of the run's fixes it is.
    number: u32,
    // 1 where the tile ends with a fix.
    present: u32,
    padding_0: u32,
    padding_1: u32,
    // Of velocity and of position, m/s and m.
    sd: array<vec4<f32>, 2>,
    // Per number that is corrected what it takes of velocity and of position.
    gain: array<vec4<f32>, 30>,
}

@group(0) @binding(10) var<uniform> fix: Fix;

// The member that an invocation takes.
fn member_of(i: u32) -> vec2<u32> {
    let low = fix.first_member.x + i;
    return vec2<u32>(low, fix.first_member.y + select(0u, 1u, low < i));
}

// Three of the numbers that are corrected: what they take of velocity and position.
fn corrected(row: u32, velocity: vec3<f32>, position: vec3<f32>) -> vec3<f32> {
    let at = 6u * row;
    return vec3<f32>(
        dot(fix.gain[at].xyz, velocity) + dot(fix.gain[at + 1u].xyz, position),
        dot(fix.gain[at + 2u].xyz, velocity) + dot(fix.gain[at + 3u].xyz, position),
        dot(fix.gain[at + 4u].xyz, velocity) + dot(fix.gain[at + 5u].xyz, position),
    );
}

// σ of exp(−δ) δC, for a small δ.
fn turned_back(sigma: vec3<f32>, by: vec3<f32>) -> vec3<f32> {
    let a = 0.0625 * dot(by, by);
    let b = 0.0625 * dot(sigma, sigma);
    let share = 1.0 / fma(a, b, fma(0.125, dot(by, sigma), 1.0));
    return share * ((b - 1.0) * by + (1.0 - a) * sigma - 0.5 * cross(by, sigma));
}
