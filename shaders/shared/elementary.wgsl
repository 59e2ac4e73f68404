// Twin of `src/numerics/elementary.rs`: WGSL promises sin and cos to 2^-11 only, so these are our
// own.

const TAU: f32 = 6.2831853071795864;

// ln u for u = (2k + 1) 2^-24 made of the upper 23 bits k of a random word.
fn ln_uniform(word: u32) -> f32 {
    let u = f32((word >> 8u) | 1u) * (1.0 / 16777216.0);
    // Split u = m·2^e around √½.
    let bits = bitcast<u32>(u);
    let exponent = bitcast<i32>(bits - 0x3F3504F3u) >> 23u;
    let x = bitcast<f32>(bits - (bitcast<u32>(exponent) << 23u)) - 1.0;
    var q = fma(0.08980339, x, -0.14426385);
    q = fma(q, x, 0.14883195);
    q = fma(q, x, -0.16551857);
    q = fma(q, x, 0.19963533);
    q = fma(q, x, -0.2500258);
    q = fma(q, x, 0.3333393);
    q = fma(q, x, -0.49999982);
    return fma(f32(exponent), 0.69314718, fma(x * x, q, x));
}

// sin and cos of x in [-π/4, π/4].
fn sin_cos_small(x: f32) -> vec2<f32> {
    let z = x * x;
    let s = fma(fma(-0.000195173, z, 0.008332178), z, -0.16666655);
    let c = fma(fma(0.00002443845, z, -0.0013887368), z, 0.041666646);
    return vec2<f32>(fma(x * z, s, x), fma(z * z, c, fma(z, -0.5, 1.0)));
}

// The sine and cosine of an angle that many quarters further on.
fn turn_by_quarters(sc: vec2<f32>, quarters: u32) -> vec2<f32> {
    var turned = select(sc, sc.yx, (quarters & 1u) == 1u);
    turned.x = select(turned.x, -turned.x, (quarters & 2u) == 2u);
    turned.y = select(turned.y, -turned.y, ((quarters + 1u) & 2u) == 2u);
    return turned;
}

// sin and cos of 2π·turns/2^32.
fn sin_cos_turns(turns: u32) -> vec2<f32> {
    let quadrant = (turns + 0x20000000u) >> 30u;
    let rest = bitcast<i32>(turns - (quadrant << 30u));
    return turn_by_quarters(sin_cos_small(f32(rest >> 7u) * (TAU / 33554432.0)), quadrant);
}

// sin and cos of x, |x| below some thousands.
fn sin_cos(x: f32) -> vec2<f32> {
    let quarters = round(x * 0.63661977);
    let rest = fma(-quarters, 0.0004838268, fma(-quarters, 1.5703125, x));
    return turn_by_quarters(sin_cos_small(rest), bitcast<u32>(i32(quarters)));
}

// Two independent standard normal numbers (Box and Muller 1958).
fn gaussian_pair(radius: u32, angle: u32) -> vec2<f32> {
    let r = sqrt(max(-2.0 * ln_uniform(radius), 0.0));
    return r * sin_cos_turns(angle).yx;
}
