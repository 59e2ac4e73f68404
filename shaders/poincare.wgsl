// Carries orbits over periods of the force and records them once per period. CPU twin:
// src/kernel/cpu/poincare.rs.

@group(0) @binding(4) var<storage, read_write> strobes: array<vec2<f32>>;

fn rates(o: Oscillator, s: vec2<f32>, force: f32) -> vec2<f32> {
    return vec2<f32>(s.y, rate(o, s.x, s.y, force));
}

@compute @workgroup_size(64)
fn poincare(@builtin(global_invocation_id) id: vec3<u32>) {
    let point = id.x;
    let n = tile.points;
    if (point >= n) {
        return;
    }
    let o = oscillator_of(point);
    var s = vec2<f32>(state[point], state[n + point]);
    var lost = state[5u * n + point];
    let half = 0.5 * o.h;
    let sixth = o.h * (1.0 / 6.0);
    for (var period = 0u; period < tile.periods; period++) {
        for (var j = 0u; j < tile.steps; j++) {
            let f = force_of(o, point, tile.begin + period, j);
            let d1 = rates(o, s, f.x);
            let d2 = rates(o, s + half * d1, f.y);
            let d3 = rates(o, s + half * d2, f.y);
            let d4 = rates(o, s + o.h * d3, f.z);
            s += sixth * (d1 + 2.0 * (d2 + d3) + d4);
        }
        if (is_lost(s.x)) {
            lost = 1.0;
            s = vec2<f32>();
        }
        if (tile.counted != 0u) {
            strobes[(tile.strobe + period) * n + point] = s;
        }
    }
    state[point] = s.x;
    state[n + point] = s.y;
    state[5u * n + point] = lost;
}
