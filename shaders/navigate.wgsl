// One tile: each invocation takes one member from reading errors in three axes to errors of
// attitude, velocity and position. Twin of `src/kernel/cpu/navigate.rs`; see there for the
// equations, their names and their sources. The readings' errors are those that `simulate` has
// traced, axis by axis.

override ROUND: bool = false;
override COUPLED: bool = false;
override TAKEN: bool = false;
override AIDED: bool = false;
override FOLLOWS: bool = false;
override JITTERS: bool = false;

// What the members share over a tile; mirrored in `src/kernel/layout.rs`.
struct Flight {
    members: u32,
    stride: u32,
    // Samples of the tile, and those since the last multiple of 64 when it begins.
    samples: u32,
    since: u32,
    // Time between samples, s.
    sample_s: f32,
    // 1 where height is free, 0 where it is held.
    free: f32,
    // Zero, which no compiler knows.
    zero: u32,
    // Cosine and sine of the vehicle's heading at the end of the tile.
    cosine: f32,
    sine: f32,
    // Number of the tile's first sample.
    first_sample: u32,
    // Samples from the end of the still start to it.
    passed: u32,
    padding: u32,
    // Error of the navigator on perfect readings at the end of the tile: position, velocity, and roll, pitch and heading.
    own_place: vec4<f32>,
    own_speed: vec4<f32>,
    own_turn: vec4<f32>,
}

// One sample of the truth; mirrored in `src/kernel/truth_step.rs`.
struct Passage {
    attitude: mat3x3<f32>,
    force: vec3<f32>,
    level_rate: vec3<f32>,
    coriolis_rate: vec3<f32>,
    velocity: vec3<f32>,
    curvature: vec2<f32>,
    tangent: f32,
    convergence: f32,
    earth_rate: vec2<f32>,
    gravity: vec2<f32>,
    body_force: vec3<f32>,
    body_rate: vec3<f32>,
    warmer: f32,
    force_change: vec3<f32>,
    rate_change: vec3<f32>,
}

@group(0) @binding(0) var<uniform> flight: Flight;
// Eleven vectors for a sample.
@group(0) @binding(1) var<uniform> passages: array<vec4<f32>, 4096>;
// Errors of the readings of one axis: for each sample, accelerometer and then gyro.
@group(0) @binding(2) var<storage, read> x: array<f32>;
@group(0) @binding(3) var<storage, read> y: array<f32>;
@group(0) @binding(4) var<storage, read> z: array<f32>;
// What a still start found, and fixes since (six numbers a member), then the couplings.
@group(0) @binding(5) var<storage, read_write> given: array<f32>;
@group(0) @binding(6) var<storage, read_write> state: array<f32>;
// Errors in three groups of four, each with whether the member failed, as `reduce` reads them.
@group(0) @binding(7) var<storage, read_write> places: array<f32>;
@group(0) @binding(8) var<storage, read_write> speeds: array<f32>;
@group(0) @binding(9) var<storage, read_write> turns: array<f32>;

fn passage(n: u32) -> Passage {
    let a = passages[11u * n];
    let b = passages[11u * n + 1u];
    let c = passages[11u * n + 2u];
    let d = passages[11u * n + 3u];
    let e = passages[11u * n + 4u];
    let f = passages[11u * n + 5u];
    let g = passages[11u * n + 6u];
    let h = passages[11u * n + 7u];
    let i = passages[11u * n + 8u];
    let j = passages[11u * n + 9u];
    let k = passages[11u * n + 10u];
    return Passage(
        // Rows of the host are columns here, so that a vector stands on the left.
        mat3x3<f32>(a.xyz, vec3<f32>(a.w, b.xy), vec3<f32>(b.zw, c.x)),
        c.yzw,
        d.xyz,
        vec3<f32>(d.w, e.xy),
        vec3<f32>(e.zw, f.x),
        f.yz,
        f.w,
        g.x,
        g.yz,
        vec2<f32>(g.w, h.x),
        h.yzw,
        i.xyz,
        i.w,
        j.xyz,
        vec3<f32>(j.w, k.xy),
    );
}

// Numbers of a member: three compensated sums and what was added since.
fn part(i: u32, which: u32) -> vec3<f32> {
    let at = 3u * which * flight.stride + i;
    return vec3<f32>(state[at], state[at + flight.stride], state[at + 2u * flight.stride]);
}

fn keep(i: u32, which: u32, value: vec3<f32>) {
    let at = 3u * which * flight.stride + i;
    state[at] = value.x;
    state[at + flight.stride] = value.y;
    state[at + 2u * flight.stride] = value.z;
}

fn coupling(i: u32, row: u32) -> vec3<f32> {
    let at = (6u + 3u * row) * flight.stride + i;
    return vec3<f32>(given[at], given[at + flight.stride], given[at + 2u * flight.stride]);
}

// Three of the numbers that follow temperature and stamps, from the couplings' end on.
fn followed(i: u32, row: u32) -> vec3<f32> {
    let at = (33u + 3u * row) * flight.stride + i;
    return vec3<f32>(given[at], given[at + flight.stride], given[at + 2u * flight.stride]);
}

// A sum of two numbers each, and what adding to it makes of both.
struct Sum {
    high: vec3<f32>,
    low: vec3<f32>,
}

fn added(sum: Sum, value: vec3<f32>) -> Sum {
    let a = add_compensated(vec2<f32>(sum.high.x, sum.low.x), value.x, flight.zero);
    let b = add_compensated(vec2<f32>(sum.high.y, sum.low.y), value.y, flight.zero);
    let c = add_compensated(vec2<f32>(sum.high.z, sum.low.z), value.z, flight.zero);
    return Sum(vec3<f32>(a.x, b.x, c.x), vec3<f32>(a.y, b.y, c.y));
}

// (δC − 1) of a vector, for σ.
fn tilted(sigma: vec3<f32>, v: vec3<f32>) -> vec3<f32> {
    let once = cross(sigma, v);
    let twice = cross(sigma, once);
    let square = 0.0625 * dot(sigma, sigma);
    let share = 1.0 / ((1.0 + square) * (1.0 + square));
    return (share * 0.5) * twice + (share * (1.0 - square)) * once;
}

// Rotation vector of σ: 4 atan(|σ|/4) along it. Two halvings of the angle leave a series that is
// exact in f32.
fn rotation_vector(sigma: vec3<f32>) -> vec3<f32> {
    let size = sqrt(dot(sigma, sigma));
    let t = 0.25 * size;
    let half = t / (1.0 + sqrt(fma(t, t, 1.0)));
    let quarter = half / (1.0 + sqrt(fma(half, half, 1.0)));
    let q = quarter * quarter;
    let series = fma(q, fma(q, fma(q, fma(q, 1.0 / 9.0, -1.0 / 7.0), 0.2), -1.0 / 3.0), 1.0);
    // 16 · quarter · series / size, where size may be zero.
    let ratio = 4.0 / ((1.0 + sqrt(fma(t, t, 1.0))) * (1.0 + sqrt(fma(half, half, 1.0))));
    return (ratio * series) * sigma;
}

@compute @workgroup_size(64)
fn navigate(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if i >= flight.members {
        return;
    }
    let stride = flight.stride;
    let h = flight.sample_s;
    var turn_part = part(i, 0u);
    var speed_part = part(i, 1u);
    var place_part = part(i, 2u);
    var turn_total = Sum(part(i, 3u), part(i, 4u));
    var speed_total = Sum(part(i, 5u), part(i, 6u));
    var place_total = Sum(part(i, 7u), part(i, 8u));
    var failed = state[27u * stride + i];
    var taken_force = vec3<f32>();
    var taken_turn = vec3<f32>();
    if TAKEN {
        taken_force = vec3<f32>(given[i], given[stride + i], given[2u * stride + i]);
        taken_turn = vec3<f32>(given[3u * stride + i], given[4u * stride + i], given[5u * stride + i]);
    }

    // Rows as the host has them, read once: memory that a kernel also writes is not kept in
    // registers by itself.
    var force_rows = mat3x3<f32>();
    var rate_rows = mat3x3<f32>();
    var felt_rows = mat3x3<f32>();
    if COUPLED {
        force_rows = mat3x3<f32>(coupling(i, 0u), coupling(i, 1u), coupling(i, 2u));
        rate_rows = mat3x3<f32>(coupling(i, 3u), coupling(i, 4u), coupling(i, 5u));
        felt_rows = mat3x3<f32>(coupling(i, 6u), coupling(i, 7u), coupling(i, 8u));
    }
    var warm_force = array<vec3<f32>, 2>();
    var warm_rate = array<vec3<f32>, 2>();
    // Offset and jitter of the stamps, s, and what they gain on the true time.
    var stamps = vec3<f32>();
    // Full scale of the gyros, and what their axes' kernels have taken off.
    var range = vec3<f32>();
    var taken_before = vec3<f32>();
    if FOLLOWS {
        warm_force = array<vec3<f32>, 2>(followed(i, 0u), followed(i, 1u));
        warm_rate = array<vec3<f32>, 2>(followed(i, 2u), followed(i, 3u));
        stamps = followed(i, 4u);
        range = followed(i, 5u);
        taken_before = followed(i, 6u);
    }

    for (var n = 0u; n < flight.samples; n++) {
        let p = passage(n);
        let passed = (flight.since + n) & 63u;
        let at_force = 2u * n * stride + i;
        let at_turn = at_force + stride;
        var error = vec3<f32>(x[at_force], y[at_force], z[at_force]);
        var turn = vec3<f32>(x[at_turn], y[at_turn], z[at_turn]);
        if TAKEN {
            error -= taken_force;
            turn -= taken_turn;
        }
        if COUPLED {
            error += p.body_force * force_rows;
            turn += p.body_rate * rate_rows + p.body_force * felt_rows;
        }
        if FOLLOWS {
            var late = fma(stamps.z, (f32(flight.passed + n) + 0.5) * h, stamps.x);
            if JITTERS {
                let sample = flight.first_sample + n;
                let instants = gaussians(sample >> 2u, member_of(i), STREAM_JITTER, fix.seed);
                late = fma(stamps.y, instants[sample & 3u], late);
            }
            error += p.warmer * (warm_force[1] * p.body_force + warm_force[0]) - late * p.force_change;
            turn += p.warmer * (warm_rate[1] * p.body_rate + warm_rate[0]) - late * p.rate_change;
            let shown = p.body_rate + taken_turn + taken_before;
            turn = max(min(turn, range - shown), -range - shown);
        }
        let f = error * p.attitude;
        let w = turn * p.attitude;
        let sigma = turn_total.high + turn_part;
        let v = speed_total.high + speed_part;
        let passed_s = f32(passed) * h;
        let place = place_total.high + (passed_s * speed_total.high + place_part);
        let latitude = place.x * p.curvature.x;

        var level = vec3<f32>();
        var coriolis = vec3<f32>();
        if ROUND {
            let north = fma(p.velocity.x * p.curvature.x, place.z, v.x) * p.curvature.x;
            let east = fma(p.velocity.y * p.curvature.y, place.z, v.y) * p.curvature.y;
            let earth = vec3<f32>(-p.earth_rate.x * latitude, 0.0, -p.earth_rate.y * latitude);
            let transport = vec3<f32>(east, -north, -fma(p.tangent, east, p.convergence * latitude));
            level = transport + earth;
            coriolis = level + earth;
        }

        // Attitude.
        let u = w - level;
        let square = 0.0625 * dot(sigma, sigma);
        let along = 0.125 * dot(sigma, u);
        let around = cross(sigma, 0.5 * u + (p.level_rate + level));
        let grown = h * ((1.0 - square) * u + (along * sigma + around));

        // Velocity, by the attitude half-way.
        let mid = 0.5 * grown + sigma;
        var a = tilted(mid, p.force + f) + f;
        if ROUND {
            a -= cross(coriolis, p.velocity + v);
            a -= cross(p.coriolis_rate, v);
            a.z += fma(p.gravity.x, place.z, p.gravity.y * latitude);
        }
        a.z *= flight.free;

        // Position, by the velocity's part; that of its total is added where the parts are.
        var moved = (0.5 * h) * a + speed_part;
        if ROUND {
            let curved = p.velocity.xy * p.curvature;
            let falling = p.velocity.z * p.curvature;
            moved.x += fma(curved.x, place.z, -(falling.x * place.x));
            let narrowing = fma(p.tangent, curved.x, falling.y);
            moved.y += fma(curved.y, place.z, fma(p.velocity.y * p.tangent, latitude, -(narrowing * place.y)));
        }
        turn_part += grown;
        place_part += h * moved;
        speed_part += h * a;

        if passed == 63u {
            place_total = added(place_total, (64.0 * h) * speed_total.high);
            place_total = added(place_total, place_part);
            place_total.low += (64.0 * h) * speed_total.low;
            speed_total = added(speed_total, speed_part);
            turn_total = added(turn_total, turn_part);
            // Beyond half a turn the other way round is shorter.
            let whole = dot(turn_total.high, turn_total.high);
            if whole > 16.0 {
                turn_total.high *= -16.0 / whole;
                turn_total.low = vec3<f32>();
            }
            turn_part = vec3<f32>();
            speed_part = vec3<f32>();
            place_part = vec3<f32>();
            let fast = bitcast<vec3<u32>>(speed_total.high) & vec3<u32>(0x7FFFFFFFu);
            if any(fast > vec3<u32>(bitcast<u32>(f32(BOUND_M_S)))) {
                failed = 1.0;
            }
        }
    }

    let since_s = f32((flight.since + flight.samples) & 63u) * h;
    if AIDED && fix.present != 0u {
        let member = member_of(i);
        let speed_noise = gaussians(2u * fix.number, member, STREAM_FIX, fix.seed);
        let place_noise = gaussians(2u * fix.number + 1u, member, STREAM_FIX, fix.seed);
        let sigma = turn_total.high + (turn_part + turn_total.low);
        let v = speed_total.high + (speed_part + speed_total.low);
        let place = place_total.high
            + (since_s * speed_total.high + place_part + (place_total.low + since_s * speed_total.low));
        let seen_speed = fma(fix.sd[0].xyz, speed_noise.xyz, v);
        let seen_place = fma(fix.sd[1].xyz, place_noise.xyz, place);
        turn_part += turned_back(sigma, corrected(0u, seen_speed, seen_place)) - sigma;
        speed_part -= corrected(1u, seen_speed, seen_place);
        place_part -= corrected(2u, seen_speed, seen_place);
        let force = corrected(3u, seen_speed, seen_place);
        let rate = corrected(4u, seen_speed, seen_place);
        for (var axis = 0u; axis < 3u; axis++) {
            given[axis * stride + i] += force[axis];
            given[(3u + axis) * stride + i] += rate[axis];
        }
    }

    keep(i, 0u, turn_part);
    keep(i, 1u, speed_part);
    keep(i, 2u, place_part);
    keep(i, 3u, turn_total.high);
    keep(i, 4u, turn_total.low);
    keep(i, 5u, speed_total.high);
    keep(i, 6u, speed_total.low);
    keep(i, 7u, place_total.high);
    keep(i, 8u, place_total.low);
    state[27u * stride + i] = failed;

    // Errors at the end of the tile.
    let position = flight.own_place.xyz
        + (place_total.high + (since_s * speed_total.high + place_part + (place_total.low + since_s * speed_total.low)));
    let speed = flight.own_speed.xyz + (speed_total.high + (speed_part + speed_total.low));
    let fast = bitcast<vec3<u32>>(speed) & vec3<u32>(0x7FFFFFFFu);
    if any(fast > vec3<u32>(bitcast<u32>(f32(BOUND_M_S)))) {
        failed = 1.0;
    }
    let turned = rotation_vector(turn_total.high + (turn_part + turn_total.low));
    let roll = flight.own_turn.x + fma(flight.cosine, turned.x, flight.sine * turned.y);
    let pitch = flight.own_turn.y + fma(flight.cosine, turned.y, -(flight.sine * turned.x));
    let horizontal = sqrt(dot(position.xy, position.xy));
    var rows = array<f32, 12>(
        position.x,
        position.y,
        position.z,
        speed.x,
        speed.y,
        speed.z,
        roll,
        pitch,
        flight.own_turn.z + turned.z,
        horizontal,
        sqrt(dot(position, position)),
        position.x + position.y,
    );
    for (var q = 0u; q < 4u; q++) {
        places[q * stride + i] = rows[q];
        speeds[q * stride + i] = rows[4u + q];
        turns[q * stride + i] = rows[8u + q];
    }
    places[4u * stride + i] = failed;
    speeds[4u * stride + i] = failed;
    turns[4u * stride + i] = failed;
}
