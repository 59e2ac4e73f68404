// Low and high half of a 32 × 32 bit product, with 64-bit integers.
fn multiply_wide(a: u32, b: u32) -> vec2<u32> {
    let product = u64(a) * u64(b);
    return vec2<u32>(u32(product & 0xFFFFFFFFlu), u32(product >> 32u));
}
