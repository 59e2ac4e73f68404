// What `lyapunov` and `poincare` share: forced Duffing oscillators, one per invocation, time
// counted in steps per period of the force. CPU twin: src/kernel/cpu/poincare.rs. Needs `philox`.

struct OrbitTile {
    seed: vec2<u32>,
    // Number of the first point, for the noise.
    first: vec2<u32>,
    points: u32,
    // Runge–Kutta steps per period of the force.
    steps: u32,
    // First period of this tile, and how many.
    begin: u32,
    periods: u32,
    // lyapunov: whether growth is counted. poincare: whether strobes are recorded, from place
    // `strobe` on.
    counted: u32,
    strobe: u32,
    padding: vec2<u32>,
}

@group(0) @binding(0) var<uniform> tile: OrbitTile;
// Columns of `points` numbers: damping, stiffness, cubic, amplitude, step, deviation of the force
// noise.
@group(0) @binding(1) var<storage, read> parameters: array<f32>;
// cos ωt at every half step of a period.
@group(0) @binding(2) var<storage, read> cosines: array<f32>;
// Columns of `points` numbers: x, v, tangent x, tangent v, sum of logarithms, lost.
@group(0) @binding(3) var<storage, read_write> state: array<f32>;

struct Oscillator {
    damping: f32,
    stiffness: f32,
    cubic: f32,
    amplitude: f32,
    h: f32,
    sigma: f32,
}

fn oscillator_of(point: u32) -> Oscillator {
    let n = tile.points;
    return Oscillator(
        parameters[point],
        parameters[n + point],
        parameters[2u * n + point],
        parameters[3u * n + point],
        parameters[4u * n + point],
        parameters[5u * n + point],
    );
}

fn rate(o: Oscillator, x: f32, v: f32, force: f32) -> f32 {
    return force - o.damping * v - cubic_pull(o.stiffness, o.cubic, x);
}

// Sum of eight 16-bit halves of one Philox block, centred and scaled to unit variance, times sigma.
fn noise_of(o: Oscillator, point: u32, period: u32, step: u32) -> f32 {
    if (o.sigma == 0.0) {
        return 0.0;
    }
    let low = tile.first.x + point;
    let high = tile.first.y + select(0u, 1u, low < point);
    let words = philox(vec4<u32>(period * tile.steps + step, low, high, 7u), tile.seed);
    let halves = (words >> vec4<u32>(16u)) + (words & vec4<u32>(0xFFFFu));
    let total = i32(halves.x + halves.y + halves.z + halves.w) - 262140;
    return o.sigma * (f32(total) * 1.868812365e-5);
}

const LOST_M = 1e6;

// NaN compares false with everything.
fn is_lost(x: f32) -> bool {
    return !(abs(x) <= LOST_M);
}

// The force at the beginning, the middle and the end of step j of a period, noise included.
fn force_of(o: Oscillator, point: u32, period: u32, j: u32) -> vec3<f32> {
    let cosine = vec3<f32>(cosines[2u * j], cosines[2u * j + 1u], cosines[2u * j + 2u]);
    return o.amplitude * cosine + noise_of(o, point, period, j);
}
