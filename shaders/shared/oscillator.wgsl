// Twin of `src/kernel/cpu/oscillator.rs` and `src/kernel/cpu/general.rs`: one substep of the proof
// mass in error coordinates. The state is (e, q): the error of the reading, and the reading's rate
// times the substep. The cubic spring is that of `src/physics/cubic_stiffness.rs`.

struct Coefficients {
    low: vec4<f32>,
    high: vec4<f32>,
}

fn relax(k: vec4<f32>, s: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(fma(k.x, s.x, k.y * s.y), fma(k.z, s.x, k.w * s.y));
}

fn exact_hold(k: Coefficients, s: vec2<f32>, f: Force, w: f32) -> vec2<f32> {
    let rest = fma(-k.high.x, f.to_end, w);
    return relax(k.low, s - vec2<f32>(rest, f.to_end)) + vec2<f32>(rest, f.to_end);
}

fn cubic(k: vec4<f32>, e: f32, a: f32, q: f32, push: f32) -> f32 {
    return fma(-k.y, q, cubic_acceleration(k.z, a, fma(-k.x, e, push)));
}

fn runge_kutta_4(k: Coefficients, s: vec2<f32>, f: Force, w: f32) -> vec2<f32> {
    let middle = s.x - f.to_middle;
    let end = s.x - f.to_end;
    let d1 = cubic(k.low, s.x, s.x + f.begin, s.y, w);
    let e2 = fma(0.5, s.y, middle);
    let q2 = fma(0.5, d1, s.y);
    let d2 = cubic(k.low, e2, e2 + f.middle, q2, w);
    let e3 = fma(0.5, q2, middle);
    let q3 = fma(0.5, d2, s.y);
    let d3 = cubic(k.low, e3, e3 + f.middle, q3, w);
    let e4 = end + q3;
    let q4 = s.y + d3;
    let d4 = cubic(k.low, e4, e4 + f.end, q4, w);
    let twice = d2 + d3;
    let once = d1 + twice;
    return vec2<f32>(fma(1.0 / 6.0, once, end + s.y), fma(1.0 / 6.0, once + twice + d4, s.y));
}

// What the laws of `src/physics` are given, with the substep as unit of time and the reading as
// displacement.
struct Instant {
    x: f32,
    v: f32,
    input: f32,
    time: f32,
    step: f32,
    gain: f32,
    stiffness: f32,
    warmer: f32,
}

// How much warmer than its reference the sensor is in the present sample, K. Slow beside the mass:
// that of the sample's middle holds for all of it.
var<private> warmer_k: f32;

// Acceleration with all laws that act: `Laws` and `act` are written by `src/kernel/source/laws.rs`.
fn general(k: Coefficients, laws: Laws, e: f32, q: f32, input: f32, time: f32, push: f32) -> f32 {
    let at = Instant(e + input, q, input, time, 1.0, k.low.x, k.low.x, warmer_k);
    return act(at, laws, fma(-k.low.y, q, fma(-k.low.x, e, push)));
}

// Lines `#own …` are replaced by what states of the laws' own take up there, see
// `src/kernel/source/staged.rs`; by nothing where no law has any.
fn runge_kutta_4_general(k: Coefficients, laws: Laws, s: vec2<f32>, f: Force, w: f32, time: f32) -> vec2<f32> {
    let middle = s.x - f.to_middle;
    let end = s.x - f.to_end;
#own stage 1
    let d1 = general(k, laws, s.x, s.y, f.begin, time, w);
#own stage 2
    let e2 = fma(0.5, s.y, middle);
    let q2 = fma(0.5, d1, s.y);
    let d2 = general(k, laws, e2, q2, f.middle, time + 0.5, w);
#own stage 3
    let e3 = fma(0.5, q2, middle);
    let q3 = fma(0.5, d2, s.y);
    let d3 = general(k, laws, e3, q3, f.middle, time + 0.5, w);
#own stage 4
    let e4 = end + q3;
    let q4 = s.y + d3;
    let d4 = general(k, laws, e4, q4, f.end, time + 1.0, w);
#own finish
    let twice = d2 + d3;
    let once = d1 + twice;
    return vec2<f32>(fma(1.0 / 6.0, once, end + s.y), fma(1.0 / 6.0, once + twice + d4, s.y));
}

fn exponential_rk_2(k: Coefficients, s: vec2<f32>, f: Force, w: f32) -> vec2<f32> {
    let rest = fma(-k.high.x, f.to_end, w);
    let a0 = s.x + f.begin;
    let bent = -cubic_acceleration(k.high.y, a0, 0.0);
    let first = relax(k.low, s - vec2<f32>(rest - bent, f.to_end)) + vec2<f32>(rest - bent, f.to_end);
    let a1 = first.x + f.end;
    let growth = -cubic_acceleration(k.high.y, a1, bent);
    return fma(-k.high.zw, vec2<f32>(growth), first);
}

fn rosenbrock_euler(k: Coefficients, s: vec2<f32>, f: Force, w: f32) -> vec2<f32> {
    let half_c = 0.5 * k.low.y;
    let a = s.x + f.begin;
    // In units of ω₀².
    let slope = cubic_tangent_stiffness(k.low.z, a);
    let stiff = fma(k.low.x, slope, k.low.x);
    let r = s.y - f.to_end;
    let pull = fma(k.low.x, -cubic_acceleration(k.low.z, a, w - s.x), k.low.y * s.y);
    let share = 1.0 / stiff;
    let g = slope * f.to_end * (k.low.x * share);
    let y = vec2<f32>((pull - k.low.y * (r + g)) * share, r + g);
    let frequency = sqrt(max(fma(-half_c, half_c, stiff), 1e-12));
    let sc = sin_cos(frequency);
    let odd = k.low.w * (sc.x / frequency);
    let even = k.low.w * sc.y;
    let moved = vec2<f32>(
        fma(even + half_c * odd, y.x, odd * y.y),
        fma(-stiff * odd, y.x, (even - half_c * odd) * y.y),
    );
    return vec2<f32>(s.x - g + (moved.x - y.x), r + (moved.y - y.y) + f.to_end);
}
