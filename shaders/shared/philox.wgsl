// Philox4x32-10 (Salmon et al., SC 2011), bit for bit that of `src/rng.rs`. Needs `multiply_wide`,
// which stands in philox_multiply_16.wgsl or, where the adapter has 64-bit integers, in
// philox_multiply_64.wgsl.

fn philox(counter: vec4<u32>, key: vec2<u32>) -> vec4<u32> {
    var c = counter;
    var k = key;
    for (var round = 0u; round < 10u; round++) {
        let product_0 = multiply_wide(0xD2511F53u, c.x);
        let product_1 = multiply_wide(0xCD9E8D57u, c.z);
        c = vec4<u32>(product_1.y ^ c.y ^ k.x, product_1.x, product_0.y ^ c.w ^ k.y, product_0.x);
        k += vec2<u32>(0x9E3779B9u, 0xBB67AE85u);
    }
    return c;
}

// The gaussian numbers that four words make.
fn normals(words: vec4<u32>) -> vec4<f32> {
    return vec4<f32>(gaussian_pair(words.x, words.y), gaussian_pair(words.z, words.w));
}

// Gaussian numbers 4·counter to 4·counter + 3 of a member.
fn gaussians(counter: u32, member: vec2<u32>, stream: u32, seed: vec2<u32>) -> vec4<f32> {
    return normals(philox(vec4<u32>(counter, member, stream), seed));
}

// The first two of them.
fn gaussian_first_pair(counter: u32, member: vec2<u32>, stream: u32, seed: vec2<u32>) -> vec2<f32> {
    let words = philox(vec4<u32>(counter, member, stream), seed);
    return gaussian_pair(words.x, words.y);
}
