// Carries orbits and one tangent vector each, and sums the logarithm of its growth once per period
// of the force. CPU twin: src/kernel/cpu/lyapunov.rs.

// Rates of x, v and of the tangent's x and v.
fn rates(o: Oscillator, s: vec4<f32>, force: f32) -> vec4<f32> {
    let bend = -o.damping * s.w - (o.stiffness + cubic_tangent_stiffness(o.cubic, s.x)) * s.z;
    return vec4<f32>(s.y, rate(o, s.x, s.y, force), s.w, bend);
}

@compute @workgroup_size(64)
fn lyapunov(@builtin(global_invocation_id) id: vec3<u32>) {
    let point = id.x;
    let n = tile.points;
    if (point >= n) {
        return;
    }
    let o = oscillator_of(point);
    var s = vec4<f32>(state[point], state[n + point], state[2u * n + point], state[3u * n + point]);
    var sum = state[4u * n + point];
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
        let size = sqrt(s.z * s.z + s.w * s.w);
        if (tile.counted != 0u) {
            sum += log(size);
        }
        s = vec4<f32>(s.xy, s.zw / size);
        if (is_lost(s.x)) {
            lost = 1.0;
            s = vec4<f32>(0.0, 0.0, 1.0, 0.0);
        }
    }
    state[point] = s.x;
    state[n + point] = s.y;
    state[2u * n + point] = s.z;
    state[3u * n + point] = s.w;
    state[4u * n + point] = sum;
    state[5u * n + point] = lost;
}
