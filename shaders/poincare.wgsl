// Carries orbits over periods of the force and records them once per period. CPU twin: src/kernel/cpu/poincare.rs.

@group(0) @binding(4) var<storage, read_write> strobes: array<vec2<f32>>;

@compute @workgroup_size(64)
fn poincare(@builtin(global_invocation_id) id: vec3<u32>) {
    let point = id.x;
    let n = tile.points;
    if (point >= n) {
        return;
    }
    let o = oscillator_of(point);
    var x = state[point];
    var v = state[n + point];
    var lost = state[5u * n + point];
    let half = 0.5 * o.h;
    let sixth = o.h * (1.0 / 6.0);
    for (var period = 0u; period < tile.periods; period++) {
        for (var j = 0u; j < tile.steps; j++) {
            let f = force_of(o, point, tile.begin + period, j);
            let a1 = rate(o, x, v, f.x);
            let v2 = v + half * a1;
            let a2 = rate(o, x + half * v, v2, f.y);
            let v3 = v + half * a2;
            let a3 = rate(o, x + half * v2, v3, f.y);
            let v4 = v + o.h * a3;
            let a4 = rate(o, x + o.h * v3, v4, f.z);
            x += sixth * (v + 2.0 * (v2 + v3) + v4);
            v += sixth * (a1 + 2.0 * (a2 + a3) + a4);
        }
        if (is_lost(x)) {
            lost = 1.0;
            x = 0.0;
            v = 0.0;
        }
        if (tile.counted != 0u) {
            strobes[(tile.strobe + period) * n + point] = vec2<f32>(x, v);
        }
    }
    state[point] = x;
    state[n + point] = v;
    state[5u * n + point] = lost;
}
