// Nothing but multiply-adds, eight independent chains per invocation: the most that the device can
// do. numbers[0] is the factor and numbers[1] the term, so that nothing is known before it runs.

@group(0) @binding(0) var<storage, read_write> numbers: array<f32>;

@compute @workgroup_size(64)
fn peak(@builtin(global_invocation_id) id: vec3<u32>) {
    let factor = vec4<f32>(numbers[0]);
    let term = vec4<f32>(numbers[1]);
    var a = vec4<f32>(f32(id.x));
    var b = a + term;
    for (var i = 0u; i < 512u; i++) {
        a = fma(a, factor, term);
        b = fma(b, factor, term);
        a = fma(a, factor, term);
        b = fma(b, factor, term);
    }
    let sum = a + b;
    // Never true, but the compiler cannot know.
    if (sum.x + sum.y + sum.z + sum.w == 1.0e30) {
        numbers[2] = sum.x;
    }
}
