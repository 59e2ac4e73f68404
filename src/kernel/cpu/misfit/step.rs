//! One integration step of all lanes: Lawson's Runge–Kutta of order 4, every candidate's term in a loop of its own.

use super::{Group, Shared};
use crate::kernel::cpu::lanes::{LANES, Lane};
use crate::kernel::misfit::{COLUMNS, Parts, column};
use crate::numerics::elementary::{Real, fma};

/// Input of every lane at a point of the grid.
#[inline(always)]
pub(super) fn input<T: Real>(shared: &Shared<T>, c: &[Lane<T>; COLUMNS], index: usize) -> Lane<T> {
    let last = shared.grid.len().wrapping_sub(1);
    if shared.grid.is_empty() {
        return Lane::splat(T::of(0.0));
    }
    if !shared.parts.delay {
        return Lane::splat(shared.grid[index.min(last)]);
    }
    let mut u = Lane::splat(T::of(0.0));
    for l in 0..LANES {
        let from = index as i64 - i64::from(c[column::SHIFT][l].to_i32()) - 1;
        let at = |j: i64| shared.grid[(from + j).clamp(0, last as i64) as usize];
        let w = |j: usize| c[column::WEIGHTS + j][l];
        u[l] = w(0) * at(0) + w(1) * at(1) + w(2) * at(2) + w(3) * at(3);
    }
    u
}

/// Displacement and velocity.
type Motion<T> = [Lane<T>; 2];

/// One step of all lanes.
#[inline(always)]
pub(super) fn advance<T: Real, const FMA: bool>(shared: &Shared<T>, group: &mut Group<T>, k: usize, step: usize) {
    let (c, parts) = (&group.columns, &shared.parts);
    let index = 2 * (shared.steps * k + step);
    let u = [
        input(shared, c, index),
        input(shared, c, index + 1),
        input(shared, c, (index + 2).wrapping_sub(shared.grid_end)),
    ];
    let before = [group.state[0], group.state[1]];
    let free = carried::<T, FMA>(c, column::FULL, &before);
    let after = if parts.moves() {
        pushed::<T, FMA>(shared, group, [k, step], &u, &free)
    } else {
        swung::<T, FMA>(shared, c, &u, &free)
    };
    if parts.lag {
        lagged(shared, group, &before, &after);
    }
    [group.state[0], group.state[1]] = after;
}

/// Where the base model goes by itself over the whole step or half of it.
#[inline(always)]
fn carried<T: Real, const FMA: bool>(c: &[Lane<T>; COLUMNS], over: usize, [x, v]: &Motion<T>) -> Motion<T> {
    let zero = Lane::splat(T::of(0.0));
    let (mut to_x, mut to_v) = (zero, zero);
    for l in 0..LANES {
        to_x[l] = fma::<T, FMA>(c[over][l], x[l], c[over + 1][l] * v[l]);
        to_v[l] = fma::<T, FMA>(c[over + 2][l], x[l], c[over + 3][l] * v[l]);
    }
    [to_x, to_v]
}

/// The end of a step on which nothing but the input acts.
#[inline(always)]
fn swung<T: Real, const FMA: bool>(
    shared: &Shared<T>,
    c: &[Lane<T>; COLUMNS],
    u: &[Lane<T>; 3],
    [fx, fv]: &Motion<T>,
) -> Motion<T> {
    let (h, sixth) = (T::of(1.0 / shared.steps as f64), T::of(1.0 / 6.0));
    let zero = Lane::splat(T::of(0.0));
    let (mut nx, mut nv) = (zero, zero);
    let four = T::of(4.0);
    for l in 0..LANES {
        let gain = h * c[column::GAIN][l];
        let (a0, a1, a2) = (gain * u[0][l], four * (gain * u[1][l]), gain * u[2][l]);
        let rise = fma::<T, FMA>(c[column::FULL + 1][l], a0, c[column::HALF + 1][l] * a1);
        let push = fma::<T, FMA>(c[column::FULL + 3][l], a0, fma::<T, FMA>(c[column::HALF + 3][l], a1, a2));
        nx[l] = fma::<T, FMA>(sixth, rise, fx[l]);
        nv[l] = fma::<T, FMA>(sixth, push, fv[l]);
    }
    [nx, nv]
}

/// The end of a step under forces that depend on the motion, by four stages; states of the terms go along.
#[inline(always)]
fn pushed<T: Real, const FMA: bool>(
    shared: &Shared<T>,
    group: &mut Group<T>,
    [k, step]: [usize; 2],
    u: &[Lane<T>; 3],
    [fx, fv]: &Motion<T>,
) -> Motion<T> {
    let (c, parts) = (&group.columns, &shared.parts);
    let h = T::of(1.0 / shared.steps as f64);
    let (half, two, sixth) = (T::of(0.5), T::of(2.0), T::of(1.0 / 6.0));
    let (x, v) = (group.state[0], group.state[1]);
    let zero = Lane::splat(T::of(0.0));
    let (mut nx, mut nv) = (zero, zero);
    let [hx, hv] = carried::<T, FMA>(c, column::HALF, &[x, v]);
    let own = parts.hysteresis || parts.mode;
    // Sums of the stages with Runge–Kutta's weights; accelerations and rates are those per step.
    let (mut a, mut sum_x, mut sum_v) = (zero, zero, zero);
    let (mut at, mut rate, mut sums) = ([zero; 5], [zero; 3], [zero; 3]);
    for stage in 0..4 {
        let lead = if stage == 3 { T::of(1.0) } else { half };
        match stage {
            0 => (at[0], at[1]) = (x, v),
            1 => {
                for l in 0..LANES {
                    let push = half * a[l];
                    at[0][l] = fma::<T, FMA>(c[column::HALF + 1][l], push, hx[l]);
                    at[1][l] = fma::<T, FMA>(c[column::HALF + 3][l], push, hv[l]);
                }
            }
            2 => {
                for l in 0..LANES {
                    at[0][l] = hx[l];
                    at[1][l] = fma::<T, FMA>(half, a[l], hv[l]);
                }
            }
            _ => {
                for l in 0..LANES {
                    at[0][l] = fma::<T, FMA>(c[column::HALF + 1][l], a[l], fx[l]);
                    at[1][l] = fma::<T, FMA>(c[column::HALF + 3][l], a[l], fv[l]);
                }
            }
        }
        if own {
            for s in 0..3 {
                for l in 0..LANES {
                    let step = if stage == 0 { T::of(0.0) } else { lead * rate[s][l] };
                    at[2 + s][l] = group.state[2 + s][l] + step;
                }
            }
        }
        let place = [0.0, 0.5, 0.5, 1.0][stage];
        let since = k as f64 + (step as f64 + place) / shared.steps as f64;
        let u = &u[[0, 1, 1, 2][stage]];
        forces::<T, FMA>(parts, c, &at, u, T::of(since), h, &mut a, &mut rate);
        // What the stage adds by the end of the step, with its weight.
        if stage == 3 {
            for l in 0..LANES {
                sum_v[l] = sum_v[l] + a[l];
            }
        } else {
            let (over, weight) = if stage == 0 { (column::FULL, T::of(1.0)) } else { (column::HALF, two) };
            for l in 0..LANES {
                let push = weight * a[l];
                sum_x[l] = fma::<T, FMA>(c[over + 1][l], push, sum_x[l]);
                sum_v[l] = fma::<T, FMA>(c[over + 3][l], push, sum_v[l]);
            }
        }
        if own {
            let weight = if stage == 1 || stage == 2 { two } else { T::of(1.0) };
            for s in 0..3 {
                for l in 0..LANES {
                    sums[s][l] = fma::<T, FMA>(weight, rate[s][l], sums[s][l]);
                }
            }
        }
    }
    for l in 0..LANES {
        nx[l] = fma::<T, FMA>(sixth, sum_x[l], fx[l]);
        nv[l] = fma::<T, FMA>(sixth, sum_v[l], fv[l]);
    }
    if own {
        for s in 0..3 {
            for l in 0..LANES {
                group.state[2 + s][l] = fma::<T, FMA>(sixth, sums[s][l], group.state[2 + s][l]);
            }
        }
    }
    [nx, nv]
}

/// Carries a low-pass over a step of the displacement.
#[inline(always)]
fn lagged<T: Real>(shared: &Shared<T>, group: &mut Group<T>, [x, v]: &Motion<T>, [nx, nv]: &Motion<T>) {
    let (c, h, two) = (&group.columns, T::of(1.0 / shared.steps as f64), T::of(2.0));
    for l in 0..LANES {
        // The displacement over a step is Hermite's cubic through both ends; a cubic's answer is known in closed form.
        let ratio = c[column::LAG][l];
        let (rise, a, b) = (nx[l] - x[l], h * v[l], h * nv[l]);
        let c3 = a + b - two * rise;
        let c2 = T::of(3.0) * rise - two * a - b - T::of(3.0) * ratio * c3;
        let c1 = a - two * ratio * c2;
        let c0 = x[l] - ratio * c1;
        group.state[5][l] = c0 + c1 + c2 + c3 + (group.state[5][l] - c0) * c[column::KEEPS][l];
    }
}

/// Acceleration less the base model's own, and rates of z, x₂ and v₂, all times the step; `at` is x, v, z, x₂, v₂.
#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "inlined: a struct would only name what is passed on")]
fn forces<T: Real, const FMA: bool>(
    parts: &Parts,
    c: &[Lane<T>; COLUMNS],
    at: &[Lane<T>; 5],
    u: &Lane<T>,
    time: T,
    h: T,
    a: &mut Lane<T>,
    rate: &mut [Lane<T>; 3],
) {
    let zero = T::of(0.0);
    for l in 0..LANES {
        a[l] = c[column::GAIN][l] * u[l];
    }
    if parts.friction {
        // The sign averaged over one step, as in the diagnosis' own term.
        for l in 0..LANES {
            let friction = c[column::FRICTION][l];
            let pull = fma::<T, FMA>(-c[column::STIFFNESS][l], at[0][l], a[l]);
            let width = T::of(0.5) * h * pull.abs().max(friction.abs()).max(T::of(1e-30));
            let sign = (at[1][l] / width).max(T::of(-1.0)).min(T::of(1.0));
            a[l] = fma::<T, FMA>(-friction, sign, a[l]);
        }
    }
    if parts.spring {
        for l in 0..LANES {
            let bend = fma::<T, FMA>(c[column::CUBIC][l], at[0][l], c[column::QUADRATIC][l]);
            a[l] = fma::<T, FMA>(-(at[0][l] * at[0][l]), bend, a[l]);
        }
    }
    if parts.damping {
        for l in 0..LANES {
            let square = c[column::SQUEEZE_FILM][l] * at[0][l] * at[0][l];
            let damping = fma::<T, FMA>(c[column::SPEED_DAMPING][l], at[1][l].abs(), square);
            a[l] = fma::<T, FMA>(-damping, at[1][l], a[l]);
        }
    }
    if parts.drift {
        for l in 0..LANES {
            a[l] = fma::<T, FMA>(-(c[column::STIFFNESS_DRIFT][l] * time), at[0][l], a[l]);
        }
    }
    if parts.drive {
        for l in 0..LANES {
            a[l] = fma::<T, FMA>(c[column::DRIVE_SQUARE][l] * u[l], u[l], a[l]);
        }
    }
    if parts.stop {
        for l in 0..LANES {
            let above = (at[0][l] - c[column::GAP_ABOVE][l]).max(zero);
            let below = (-at[0][l] - c[column::GAP_BELOW][l]).max(zero);
            let stop = fma::<T, FMA>(-c[column::STOP_ABOVE][l], above, c[column::STOP_BELOW][l] * below);
            a[l] = a[l] + stop;
        }
    }
    if parts.hysteresis {
        for l in 0..LANES {
            let (z, v) = (at[2][l], at[1][l]);
            a[l] = fma::<T, FMA>(-c[column::HYSTERESIS][l], z, a[l]);
            let share = c[column::SHARE][l];
            let slip = fma::<T, FMA>(share * v.abs(), z, (T::of(1.0) - share) * v * z.abs());
            rate[0][l] = h * fma::<T, FMA>(-c[column::YIELD][l], slip, v);
        }
    }
    if parts.mode {
        for l in 0..LANES {
            rate[1][l] = h * at[4][l];
            let pull = fma::<T, FMA>(c[column::MODE_DAMPING][l], at[4][l], c[column::MODE_STIFFNESS][l] * at[3][l]);
            rate[2][l] = h * fma::<T, FMA>(c[column::MODE_GAIN][l], u[l], -pull);
        }
    }
    for l in 0..LANES {
        a[l] = h * a[l];
    }
}
