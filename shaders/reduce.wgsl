// From errors of members to partial sums: one workgroup per block of 256 members. Twin of `src/kernel/cpu/reduce.rs`.
//
// Sums run over a fixed tree, deviations are taken from the block's own mean, and counts are integers: the same members
// give the same bits whatever the batch.

@group(0) @binding(0) var<uniform> report: Report;
@group(0) @binding(1) var<storage, read> errors: array<f32>;
@group(0) @binding(2) var<storage, read> bins: array<Bins>;
@group(0) @binding(3) var<storage, read_write> partials: array<Partial>;
@group(0) @binding(4) var<storage, read_write> counts: array<atomic<u32>>;

const BINS = 4096u;

var<workgroup> sum: array<f32, 256>;
var<workgroup> squares: array<f32, 256>;
var<workgroup> least: array<f32, 256>;
var<workgroup> greatest: array<f32, 256>;
var<workgroup> count: array<u32, 256>;

@compute @workgroup_size(256)
fn reduce(@builtin(local_invocation_id) local: vec3<u32>, @builtin(workgroup_id) block: vec3<u32>) {
    let l = local.x;
    let i = block.x * 256u + l;
    var holds = i < report.members;
    if holds {
        holds = errors[4u * report.stride + i] == 0.0;
    }
    for (var q = 0u; q < 4u; q++) {
        var value = 0.0;
        if holds {
            value = errors[q * report.stride + i];
        }
        count[l] = select(0u, 1u, holds);
        sum[l] = value;
        least[l] = select(3.4e38, value, holds);
        greatest[l] = select(-3.4e38, value, holds);
        workgroupBarrier();
        for (var half = 128u; half > 0u; half >>= 1u) {
            if l < half {
                count[l] += count[l + half];
                sum[l] += sum[l + half];
                least[l] = min(least[l], least[l + half]);
                greatest[l] = max(greatest[l], greatest[l + half]);
            }
            workgroupBarrier();
        }
        let members = count[0];
        let mean = sum[0] / max(f32(members), 1.0);
        workgroupBarrier();
        let deviation = select(0.0, value - mean, holds);
        sum[l] = deviation;
        squares[l] = deviation * deviation;
        workgroupBarrier();
        for (var half = 128u; half > 0u; half >>= 1u) {
            if l < half {
                sum[l] += sum[l + half];
                squares[l] += squares[l + half];
            }
            workgroupBarrier();
        }
        if l == 0u {
            partials[(report.number * report.blocks + block.x) * 4u + q] =
                Partial(members, mean, sum[0], squares[0], least[0], greatest[0]);
        }
        if holds && report.counts == 1u {
            let b = bins[report.number * 4u + q];
            let place = (value - b.begin) * b.per_unit;
            let slot = select(min(u32(clamp(place, 0.0, 1e6)), BINS) + 1u, 0u, place < 0.0);
            atomicAdd(&counts[(report.number * 4u + q) * (BINS + 2u) + slot], 1u);
        }
        workgroupBarrier();
    }
}
