// Sums longer than f32: a pair whose second part is what the first lost. Compilers may reassociate
// and then optimise the compensation away (Mesa does); exclusive or with a zero that only the host
// knows forbids it.

fn opaque(x: f32, zero: u32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ zero);
}

// sum + x, sum.y being what sum.x lost (Knuth's two-sum).
fn add_compensated(sum: vec2<f32>, x: f32, zero: u32) -> vec2<f32> {
    let total = opaque(sum.x + x, zero);
    let part = opaque(total - sum.x, zero);
    let lost = opaque(sum.x - opaque(total - part, zero), zero) + opaque(x - part, zero);
    return vec2<f32>(total, sum.y + lost);
}
