// Models of a driven recording simulated freely, one per invocation, their errors squared and summed. Twin of
// `src/kernel/cpu/misfit.rs`; see there and `src/kernel/misfit.rs` for what the numbers are.

override MOVES: bool = false;
override HAS_SPRING: bool = false;
override HAS_DAMPING: bool = false;
override HAS_FRICTION: bool = false;
override HAS_DRIFT: bool = false;
override HAS_DRIVE: bool = false;
override HAS_STOP: bool = false;
override HAS_HYSTERESIS: bool = false;
override HAS_MODE: bool = false;
override HAS_LAG: bool = false;
override HAS_FEEDTHROUGH: bool = false;
override HAS_BEND: bool = false;
override HAS_BIAS: bool = false;
override HAS_RAILS: bool = false;
override HAS_DELAY: bool = false;
override STEPS: u32 = 1u;
override DIRECTIONS: u32 = 0u;

struct MisfitTile {
    points: u32,
    // Samples of the recording: where the run begins, where this tile begins, how many it has.
    run: u32,
    first: u32,
    samples: u32,
    // The block that the tile's squares belong to, and how many blocks there are; none where `block` is not below.
    block: u32,
    blocks: u32,
    // Last point of the grid of inputs, and how far before the end of a step its last input is read.
    last: u32,
    grid_end: u32,
}

@group(0) @binding(0) var<uniform> tile: MisfitTile;
@group(0) @binding(1) var<storage, read> columns: array<f32>;
// Of the run: the reading and then the directions, sample by sample.
@group(0) @binding(2) var<storage, read> rows: array<f32>;
// Of the recording: input at every half step.
@group(0) @binding(3) var<storage, read> grid: array<f32>;
@group(0) @binding(4) var<storage, read_write> state: array<f32>;
@group(0) @binding(5) var<storage, read_write> sums: array<f32>;

const FULL = 0u;
const HALF = 4u;
const GAIN = 8u;
const STIFFNESS = 9u;
const OFFSET = 10u;
const CUBIC = 11u;
const QUADRATIC = 12u;
const SPEED_DAMPING = 13u;
const SQUEEZE_FILM = 14u;
const FRICTION = 15u;
const STIFFNESS_DRIFT = 16u;
const DRIVE_SQUARE = 17u;
const STOP_ABOVE = 18u;
const GAP_ABOVE = 19u;
const STOP_BELOW = 20u;
const GAP_BELOW = 21u;
const HYSTERESIS = 22u;
const YIELD = 23u;
const MODE_GAIN = 24u;
const MODE_DAMPING = 25u;
const MODE_STIFFNESS = 26u;
const LAG = 27u;
const KEEPS = 28u;
const FEEDTHROUGH = 29u;
const BEND_2 = 30u;
const BEND_3 = 31u;
const RAMP = 32u;
const FADE = 33u;
const LOW = 34u;
const HIGH = 35u;
const SHARE = 36u;
const SHIFT = 37u;
const WEIGHTS = 38u;

const LOST = 1e6;
// Samples whose squares are summed before they go to the block's sum.
const PARTIAL = 64u;
const MOST_DIRECTIONS = 16u;

// The point's columns, read once: places are constants everywhere, so that compilers keep them in registers.
var<private> own_columns: array<f32, 42>;

fn column(which: u32) -> f32 {
    return own_columns[which];
}

fn four(point: u32, first: u32) -> vec4<f32> {
    let n = tile.points;
    let at = first * n + point;
    return vec4<f32>(columns[at], columns[at + n], columns[at + 2u * n], columns[at + 3u * n]);
}

fn load(point: u32) {
    let a = four(point, 0u);
    let b = four(point, 4u);
    let c = four(point, 8u);
    let d = four(point, 12u);
    let e = four(point, 16u);
    let f = four(point, 20u);
    let g = four(point, 24u);
    let h = four(point, 28u);
    let i = four(point, 32u);
    let j = four(point, 36u);
    let k = four(point, 38u);
    own_columns = array<f32, 42>(
        a.x, a.y, a.z, a.w, b.x, b.y, b.z, b.w, c.x, c.y, c.z, c.w, d.x, d.y, d.z, d.w, e.x, e.y, e.z, e.w,
        f.x, f.y, f.z, f.w, g.x, g.y, g.z, g.w, h.x, h.y, h.z, h.w, i.x, i.y, i.z, i.w, j.x, j.y, k.x, k.y, k.z, k.w,
    );
}

// A matrix of the exact propagation, row by row.
fn matrix(which: u32) -> vec4<f32> {
    return vec4<f32>(column(which), column(which + 1u), column(which + 2u), column(which + 3u));
}

fn carried(m: vec4<f32>, s: vec2<f32>) -> vec2<f32> {
    return vec2<f32>(fma(m.x, s.x, m.y * s.y), fma(m.z, s.x, m.w * s.y));
}

fn value(index: i32) -> f32 {
    return grid[u32(clamp(index, 0, i32(tile.last)))];
}

fn input_at(index: u32) -> f32 {
    if !HAS_DELAY {
        return grid[min(index, tile.last)];
    }
    let at = i32(index) - i32(column(SHIFT)) - 1;
    return column(WEIGHTS) * value(at) + column(WEIGHTS + 1u) * value(at + 1)
        + column(WEIGHTS + 2u) * value(at + 2) + column(WEIGHTS + 3u) * value(at + 3);
}

// Displacement, velocity; Bouc–Wen's z, second mode.
struct Stage {
    s: vec2<f32>,
    own: vec3<f32>,
}

// Acceleration less the base model's own, and rates of the own states, all times the step.
struct Push {
    a: f32,
    own: vec3<f32>,
}

fn forces(at: Stage, u: f32, time: f32, h: f32) -> Push {
    let x = at.s.x;
    let v = at.s.y;
    var a = column(GAIN) * u;
    var own = vec3<f32>();
    if HAS_FRICTION {
        let friction = column(FRICTION);
        let pull = fma(-column(STIFFNESS), x, a);
        let width = 0.5 * h * max(max(abs(pull), abs(friction)), 1e-30);
        a = fma(-friction, clamp(v / width, -1.0, 1.0), a);
    }
    if HAS_SPRING {
        a = fma(-(x * x), fma(column(CUBIC), x, column(QUADRATIC)), a);
    }
    if HAS_DAMPING {
        a = fma(-fma(column(SPEED_DAMPING), abs(v), column(SQUEEZE_FILM) * x * x), v, a);
    }
    if HAS_DRIFT {
        a = fma(-(column(STIFFNESS_DRIFT) * time), x, a);
    }
    if HAS_DRIVE {
        a = fma(column(DRIVE_SQUARE) * u, u, a);
    }
    if HAS_STOP {
        let above = max(x - column(GAP_ABOVE), 0.0);
        let below = max(-x - column(GAP_BELOW), 0.0);
        a = a + fma(-column(STOP_ABOVE), above, column(STOP_BELOW) * below);
    }
    if HAS_HYSTERESIS {
        let z = at.own.x;
        a = fma(-column(HYSTERESIS), z, a);
        let share = column(SHARE);
        own.x = h * fma(-column(YIELD), fma(share * abs(v), z, (1.0 - share) * v * abs(z)), v);
    }
    if HAS_MODE {
        own.y = h * at.own.z;
        let pull = fma(column(MODE_DAMPING), at.own.z, column(MODE_STIFFNESS) * at.own.y);
        own.z = h * fma(column(MODE_GAIN), u, -pull);
    }
    return Push(h * a, own);
}

// One step of the oscillator with all its terms: Lawson's Runge–Kutta of order 4.
fn moved(full: vec4<f32>, half: vec4<f32>, now: Stage, u: vec3<f32>, time: f32, h: f32) -> Stage {
    let middle = carried(half, now.s);
    let end = carried(full, now.s);
    let later = fma(0.5, h, time);
    let p0 = forces(now, u.x, time, h);
    let s1 = fma(half.yw, vec2<f32>(0.5 * p0.a), middle);
    let p1 = forces(Stage(s1, fma(vec3<f32>(0.5), p0.own, now.own)), u.y, later, h);
    let s2 = vec2<f32>(middle.x, fma(0.5, p1.a, middle.y));
    let p2 = forces(Stage(s2, fma(vec3<f32>(0.5), p1.own, now.own)), u.y, later, h);
    let s3 = fma(half.yw, vec2<f32>(p2.a), end);
    let p3 = forces(Stage(s3, now.own + p2.own), u.z, time + h, h);
    var sum = full.yw * p0.a;
    sum = fma(half.yw, vec2<f32>(2.0 * p1.a), sum);
    sum = fma(half.yw, vec2<f32>(2.0 * p2.a), sum);
    sum.y = sum.y + p3.a;
    let own = fma(vec3<f32>(2.0), p1.own + p2.own, p0.own + p3.own);
    return Stage(fma(vec2<f32>(1.0 / 6.0), sum, end), fma(vec3<f32>(1.0 / 6.0), own, now.own));
}

// The same without terms.
fn pushed(full: vec4<f32>, half: vec4<f32>, s: vec2<f32>, u: vec3<f32>, h: f32) -> vec2<f32> {
    let gain = h * column(GAIN);
    let a = vec3<f32>(gain * u.x, 4.0 * (gain * u.y), gain * u.z);
    let rise = fma(full.y, a.x, half.y * a.y);
    let push = fma(full.w, a.x, fma(half.w, a.y, a.z));
    return fma(vec2<f32>(1.0 / 6.0), vec2<f32>(rise, push), carried(full, s));
}

// The low-pass over a step on which the displacement is Hermite's cubic.
fn lagged(lag: f32, before: vec2<f32>, after: vec2<f32>, h: f32) -> f32 {
    let ratio = column(LAG);
    let rise = after.x - before.x;
    let a = h * before.y;
    let b = h * after.y;
    let c3 = a + b - 2.0 * rise;
    let c2 = 3.0 * rise - 2.0 * a - b - 3.0 * ratio * c3;
    let c1 = a - 2.0 * ratio * c2;
    let c0 = before.x - ratio * c1;
    return c0 + c1 + c2 + c3 + (lag - c0) * column(KEEPS);
}

// NaN compares false with everything, but a compiler may assume it away: decided on bits.
fn is_lost(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7FFFFFFFu) > bitcast<u32>(f32(LOST));
}

@compute @workgroup_size(64)
fn misfit(@builtin(global_invocation_id) id: vec3<u32>) {
    let point = id.x;
    let n = tile.points;
    if point >= n {
        return;
    }
    load(point);
    let h = 1.0 / f32(STEPS);
    let full = matrix(FULL);
    let half = matrix(HALF);
    var now = Stage(
        vec2<f32>(state[point], state[n + point]),
        vec3<f32>(state[2u * n + point], state[3u * n + point], state[4u * n + point]),
    );
    var lag = state[5u * n + point];
    var warm = state[6u * n + point];
    var lost = state[7u * n + point];
    var total = array<f32, 1u + MOST_DIRECTIONS>();
    let width = 1u + DIRECTIONS;
    for (var begin = 0u; begin < tile.samples; begin += PARTIAL) {
        var partial = array<f32, 1u + MOST_DIRECTIONS>();
        let stop = min(begin + PARTIAL, tile.samples);
        for (var i = begin; i < stop; i++) {
            let k = tile.first + i;
            let row = (k - tile.run) * width;
            let since = f32(k);
            var y = now.s.x + column(OFFSET);
            if HAS_MODE {
                y = y + now.own.y;
            }
            if HAS_LAG {
                y = y + (lag - now.s.x);
            }
            if HAS_FEEDTHROUGH {
                y = fma(column(FEEDTHROUGH), input_at(2u * STEPS * k), y);
            }
            if HAS_BEND {
                y = fma(now.s.x * now.s.x, fma(column(BEND_3), now.s.x, column(BEND_2)), y);
            }
            if HAS_BIAS {
                y = fma(column(RAMP), since, y + warm);
                warm = fma(warm, column(FADE), warm);
            }
            if HAS_RAILS {
                y = min(max(y, column(LOW)), column(HIGH));
            }
            let error = rows[row] - y;
            partial[0] = fma(error, error, partial[0]);
            for (var d = 1u; d < width; d++) {
                partial[d] = fma(rows[row + d], error, partial[d]);
            }
            for (var step = 0u; step < STEPS; step++) {
                let index = 2u * (STEPS * k + step);
                let u = vec3<f32>(input_at(index), input_at(index + 1u), input_at(index + 2u - tile.grid_end));
                let before = now.s;
                if MOVES {
                    now = moved(full, half, now, u, since + f32(step) * h, h);
                } else {
                    now.s = pushed(full, half, now.s, u, h);
                }
                if HAS_LAG {
                    lag = lagged(lag, before, now.s, h);
                }
            }
        }
        for (var d = 0u; d < width; d++) {
            total[d] = total[d] + partial[d];
        }
        if is_lost(now.s.x) || is_lost(now.s.y) || is_lost(now.own.x) || is_lost(now.own.y) || is_lost(now.own.z) {
            lost = 1.0;
            now = Stage(vec2<f32>(), vec3<f32>());
            lag = 0.0;
        }
    }
    state[point] = now.s.x;
    state[n + point] = now.s.y;
    state[2u * n + point] = now.own.x;
    state[3u * n + point] = now.own.y;
    state[4u * n + point] = now.own.z;
    state[5u * n + point] = lag;
    state[6u * n + point] = warm;
    state[7u * n + point] = lost;
    if tile.block < tile.blocks {
        sums[tile.block * n + point] = sums[tile.block * n + point] + total[0];
        for (var d = 1u; d < width; d++) {
            let place = (tile.blocks + d - 1u) * n + point;
            sums[place] = sums[place] + total[d];
        }
    }
}
