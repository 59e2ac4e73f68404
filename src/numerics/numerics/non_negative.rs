//! Least squares with up to five unknowns of which none may be negative: variances, mostly.

/// Minimises ½ xᵀ`normal`x − `target`ᵀx over x ≥ 0; unknowns that are not `free` are zero.
///
/// All that violate the conditions of optimality are exchanged at once (Portugal, Júdice & Vicente,
/// Math. Comp. 63, 1994); the rare cycle is broken by trying every subset.
pub fn non_negative(normal: &[[f64; 5]; 5], target: &[f64; 5], free: &[bool; 5]) -> [f64; 5] {
    let scale: [f64; 5] = std::array::from_fn(|p| normal[p][p].sqrt().max(f64::MIN_POSITIVE));
    let mut system = [[0.0; 6]; 5];
    for p in 0..5 {
        for q in 0..5 {
            system[p][q] = normal[p][q] / (scale[p] * scale[q]);
        }
        system[p][5] = target[p] / scale[p];
    }
    let mut members = *free;
    for _ in 0..8 {
        let Some(solution) = solve_subset(&system, &members) else { break };
        let slope = |p: usize| (0..5).map(|q| system[p][q] * solution[q]).sum::<f64>() - system[p][5];
        let wrong = |p: &usize| if members[*p] { solution[*p] < 0.0 } else { free[*p] && slope(*p) < 0.0 };
        let wrong: Vec<usize> = (0..5).filter(wrong).collect();
        if wrong.is_empty() {
            return std::array::from_fn(|p| solution[p] / scale[p]);
        }
        wrong.iter().for_each(|p| members[*p] = !members[*p]);
    }
    let mut best = ([0.0; 5], 0.0);
    for subset in 1u32..32 {
        let members = std::array::from_fn(|p| subset >> p & 1 == 1);
        if (0..5).any(|p| members[p] && !free[p]) {
            continue;
        }
        if let Some(solution) = solve_subset(&system, &members).filter(|s| s.iter().all(|v| *v >= 0.0)) {
            let gain: f64 = (0..5).map(|p| solution[p] * system[p][5]).sum();
            if gain > best.1 {
                best = (solution, gain);
            }
        }
    }
    std::array::from_fn(|p| best.0[p] / scale[p])
}

/// Least squares with coefficients of zero or more, the first of either sign where `is_signed`.
pub fn signed(normal: &[[f64; 5]; 5], target: &[f64; 5], free: &[bool; 5], is_signed: bool) -> [f64; 5] {
    let solution = non_negative(normal, target, free);
    if solution[0] > 0.0 || !free[0] || !is_signed {
        return solution;
    }
    let sign = |p: usize| if p == 0 { -1.0 } else { 1.0 };
    let mirrored = std::array::from_fn(|p| std::array::from_fn(|q| sign(p) * sign(q) * normal[p][q]));
    let solution = non_negative(&mirrored, &std::array::from_fn(|p| sign(p) * target[p]), free);
    std::array::from_fn(|p| sign(p) * solution[p])
}

/// Solves the rows and columns of `members` by elimination (the system is positive definite);
/// `None` if singular.
fn solve_subset(system: &[[f64; 6]; 5], members: &[bool; 5]) -> Option<[f64; 5]> {
    let mut rows = *system;
    for i in (0..5).filter(|i| members[*i]) {
        if rows[i][i] < 1e-10 {
            return None;
        }
        let above = rows[i];
        for row in (i + 1..5).filter(|k| members[*k]) {
            let ratio = rows[row][i] / above[i];
            rows[row].iter_mut().zip(above).skip(i).for_each(|(to, from)| *to -= ratio * from);
        }
    }
    let mut solution = [0.0; 5];
    for i in (0..5).rev().filter(|i| members[*i]) {
        let known: f64 = (i + 1..5).filter(|j| members[*j]).map(|j| rows[i][j] * solution[j]).sum();
        solution[i] = (rows[i][5] - known) / rows[i][i];
    }
    Some(solution)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_wall_at_zero_holds_and_an_inner_minimum_is_found() {
        // Normal equations of a positive definite form: distance from neighbours on a line, plus
        // one.
        let normal: [[f64; 5]; 5] = std::array::from_fn(|p| {
            std::array::from_fn(|q| if p == q { 3.0 } else { 0.5f64.powi((p as i32 - q as i32).abs()) })
        });
        for truth in [[0.3, 1.0, 0.5, 0.1, 0.2], [0.0, 1.0, 0.0, 0.1, 0.0], [0.0; 5]] {
            let target = std::array::from_fn(|p| (0..5).map(|q| normal[p][q] * truth[q]).sum());
            let got = non_negative(&normal, &target, &[true; 5]);
            assert!(got.iter().zip(truth).all(|(g, t)| (g - t).abs() < 1e-9), "{got:?} is not {truth:?}");
        }
        assert_eq!(non_negative(&normal, &[-1.0; 5], &[true; 5]), [0.0; 5]);
        assert_eq!(non_negative(&normal, &[1.0; 5], &[false, true, false, false, false])[0], 0.0);
    }
}
