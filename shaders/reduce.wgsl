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

// The four quantities side by side: barriers are what this kernel costs on software adapters.
var<workgroup> sum: array<vec4<f32>, 256>;
var<workgroup> least: array<vec4<f32>, 256>;
// The greatest, and afterwards the squares: together the arrays stay within the 16 KB that every adapter has.
var<workgroup> greatest: array<vec4<f32>, 256>;
var<workgroup> count: array<u32, 256>;

@compute @workgroup_size(256)
fn reduce(@builtin(local_invocation_id) local: vec3<u32>, @builtin(workgroup_id) block: vec3<u32>) {
    let l = local.x;
    let i = block.x * 256u + l;
    var holds = i < report.members;
    if holds {
        holds = errors[4u * report.stride + i] == 0.0;
    }
    var value = vec4<f32>();
    if holds {
        value = vec4<f32>(
            errors[i],
            errors[report.stride + i],
            errors[2u * report.stride + i],
            errors[3u * report.stride + i],
        );
    }
    count[l] = select(0u, 1u, holds);
    sum[l] = value;
    least[l] = select(vec4<f32>(3.4e38), value, holds);
    greatest[l] = select(vec4<f32>(-3.4e38), value, holds);
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
    let lowest = least[0];
    let highest = greatest[0];
    workgroupBarrier();
    let deviation = select(vec4<f32>(), value - mean, holds);
    sum[l] = deviation;
    greatest[l] = deviation * deviation;
    workgroupBarrier();
    for (var half = 128u; half > 0u; half >>= 1u) {
        if l < half {
            sum[l] += sum[l + half];
            greatest[l] += greatest[l + half];
        }
        workgroupBarrier();
    }
    let correction = sum[0];
    let squares = greatest[0];
    for (var q = 0u; q < 4u; q++) {
        if l == 0u {
            partials[(report.number * report.blocks + block.x) * 4u + q] =
                Partial(members, mean[q], correction[q], squares[q], lowest[q], highest[q]);
        }
        if holds && report.counts == 1u {
            let b = bins[report.number * 4u + q];
            let place = (value[q] - b.begin) * b.per_unit;
            let slot = select(min(u32(clamp(place, 0.0, 1e6)), BINS) + 1u, 0u, place < 0.0);
            atomicAdd(&counts[(report.number * 4u + q) * (BINS + 2u) + slot], 1u);
        }
    }
}
