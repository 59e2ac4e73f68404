// Carries orbits and one tangent vector each, and sums the logarithm of its growth once per period of the force.
// CPU twin: src/kernel/cpu/lyapunov.rs.

fn bend(o: Oscillator, x: f32, tx: f32, tv: f32) -> f32 {
    return -o.damping * tv - (o.stiffness + 3.0 * (o.cubic * (x * x))) * tx;
}

@compute @workgroup_size(64)
fn lyapunov(@builtin(global_invocation_id) id: vec3<u32>) {
    let point = id.x;
    let n = tile.points;
    if (point >= n) {
        return;
    }
    let o = oscillator_of(point);
    var x = state[point];
    var v = state[n + point];
    var tx = state[2u * n + point];
    var tv = state[3u * n + point];
    var sum = state[4u * n + point];
    var lost = state[5u * n + point];
    let half = 0.5 * o.h;
    let sixth = o.h * (1.0 / 6.0);
    for (var period = 0u; period < tile.periods; period++) {
        for (var j = 0u; j < tile.steps; j++) {
            let f = force_of(o, point, tile.begin + period, j);
            let a1 = rate(o, x, v, f.x);
            let s1 = bend(o, x, tx, tv);
            let x2 = x + half * v;
            let v2 = v + half * a1;
            let tx2 = tx + half * tv;
            let tv2 = tv + half * s1;
            let a2 = rate(o, x2, v2, f.y);
            let s2 = bend(o, x2, tx2, tv2);
            let x3 = x + half * v2;
            let v3 = v + half * a2;
            let tx3 = tx + half * tv2;
            let tv3 = tv + half * s2;
            let a3 = rate(o, x3, v3, f.y);
            let s3 = bend(o, x3, tx3, tv3);
            let x4 = x + o.h * v3;
            let v4 = v + o.h * a3;
            let tx4 = tx + o.h * tv3;
            let tv4 = tv + o.h * s3;
            let a4 = rate(o, x4, v4, f.z);
            let s4 = bend(o, x4, tx4, tv4);
            x += sixth * (v + 2.0 * (v2 + v3) + v4);
            v += sixth * (a1 + 2.0 * (a2 + a3) + a4);
            tx += sixth * (tv + 2.0 * (tv2 + tv3) + tv4);
            tv += sixth * (s1 + 2.0 * (s2 + s3) + s4);
        }
        let length = sqrt(tx * tx + tv * tv);
        if (tile.counted != 0u) {
            sum += log(length);
        }
        tx /= length;
        tv /= length;
        if (is_lost(x)) {
            lost = 1.0;
            x = 0.0;
            v = 0.0;
            tx = 1.0;
            tv = 0.0;
        }
    }
    state[point] = x;
    state[n + point] = v;
    state[2u * n + point] = tx;
    state[3u * n + point] = tv;
    state[4u * n + point] = sum;
    state[5u * n + point] = lost;
}
