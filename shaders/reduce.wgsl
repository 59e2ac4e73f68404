// From errors of members to partial sums: one workgroup per block of 256 members. Twin of
// `src/kernel/cpu/reduce.rs`.
//
// Sums run in a fixed order, deviations are taken from the block's own mean, and counts are
// integers: the same members give the same bits whatever the batch.

@group(0) @binding(0) var<uniform> report: Report;
@group(0) @binding(1) var<storage, read> errors: array<f32>;
@group(0) @binding(2) var<storage, read> bins: array<Bins>;
@group(0) @binding(3) var<storage, read_write> partials: array<Partial>;
@group(0) @binding(4) var<storage, read_write> counts: array<atomic<u32>>;

const BINS = 4096u;

// An invocation takes four members of the block, their four quantities side by side, before the
// tree begins: barriers are what this kernel costs on software adapters, and 64 invocations are no
// more than two subgroups of a card.
const WORKGROUP = 64u;
const EACH = 4u;

var<workgroup> sum: array<vec4<f32>, WORKGROUP>;
var<workgroup> squares: array<vec4<f32>, WORKGROUP>;
var<workgroup> least: array<vec4<f32>, WORKGROUP>;
var<workgroup> greatest: array<vec4<f32>, WORKGROUP>;
var<workgroup> count: array<u32, WORKGROUP>;

fn holds(i: u32) -> bool {
    return i < report.members && errors[4u * report.stride + i] == 0.0;
}

fn errors_of(i: u32) -> vec4<f32> {
    let n = report.stride;
    return vec4<f32>(errors[i], errors[n + i], errors[2u * n + i], errors[3u * n + i]);
}

@compute @workgroup_size(WORKGROUP)
fn reduce(@builtin(local_invocation_id) local: vec3<u32>, @builtin(workgroup_id) block: vec3<u32>) {
    let l = local.x;
    let first = block.x * (WORKGROUP * EACH) + l;
    var number = 0u;
    var total = vec4<f32>();
    var low = vec4<f32>(3.4e38);
    var high = vec4<f32>(-3.4e38);
    for (var m = 0u; m < EACH; m++) {
        let i = first + m * WORKGROUP;
        if holds(i) {
            let value = errors_of(i);
            number++;
            total += value;
            low = min(low, value);
            high = max(high, value);
        }
    }
    count[l] = number;
    sum[l] = total;
    least[l] = low;
    greatest[l] = high;
    workgroupBarrier();
    for (var half = WORKGROUP / 2u; half > 0u; half >>= 1u) {
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

    total = vec4<f32>();
    var square = vec4<f32>();
    for (var m = 0u; m < EACH; m++) {
        let i = first + m * WORKGROUP;
        if holds(i) {
            let value = errors_of(i);
            let deviation = value - mean;
            total += deviation;
            square += deviation * deviation;
            if report.counts == 1u {
                tally(value);
            }
        }
    }
    sum[l] = total;
    squares[l] = square;
    workgroupBarrier();
    for (var half = WORKGROUP / 2u; half > 0u; half >>= 1u) {
        if l < half {
            sum[l] += sum[l + half];
            squares[l] += squares[l + half];
        }
        workgroupBarrier();
    }
    if l < 4u {
        partials[(report.number * report.blocks + block.x) * 4u + l] =
            Partial(members, mean[l], sum[0][l], squares[0][l], least[0][l], greatest[0][l]);
    }
}

// Counts a member's errors in their bins: below the first, in one, above the last.
fn tally(value: vec4<f32>) {
    for (var q = 0u; q < 4u; q++) {
        let b = bins[report.number * 4u + q];
        let place = (value[q] - b.begin) * b.per_unit;
        let slot = select(min(u32(clamp(place, 0.0, 1e6)), BINS) + 1u, 0u, place < 0.0);
        atomicAdd(&counts[(report.number * 4u + q) * (BINS + 2u) + slot], 1u);
    }
}
