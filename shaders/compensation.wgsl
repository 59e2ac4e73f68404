// Is compensation alive on this device? numbers: a small one, a large one, zero, zero. Afterwards:
// what a plain and a compensated sum keep of the small one when the large one is added and taken
// away again.

@group(0) @binding(0) var<storage, read_write> numbers: array<f32>;

@compute @workgroup_size(1)
fn compensation() {
    let zero = bitcast<u32>(numbers[2]);
    let plain = opaque(opaque(numbers[1] + numbers[0], zero) - numbers[1], zero);
    var sum = add_compensated(vec2<f32>(numbers[1], 0.0), numbers[0], zero);
    sum = add_compensated(sum, -numbers[1], zero);
    numbers[0] = plain;
    numbers[1] = sum.x + sum.y;
}
