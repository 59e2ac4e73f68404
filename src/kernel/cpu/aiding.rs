//! A fix applied to 64 members. Twin of `shaders/shared/fix.wgsl`.
//!
//! What is seen is the error itself and noise; what it corrects is added to the parts, so that it
//! may come at any sample. An attitude error is turned back, as a navigator turns its attitude: σ
//! of exp(−δ) δC, by the composition of modified Rodrigues vectors (Shuster, *A survey of attitude
//! representations*, J. Astronaut. Sci. 41 (1993) 439).

use super::lanes::{Kernel, LANES, Lane};
use super::navigate::{State, cross, dot, plus};
use super::noise::{Drawer, stream};
use crate::aiding::{Fix, SEEN};
use crate::numerics::elementary::{Real, fma};
use crate::rng::Stream;

/// Numbers of what is seen.
const NOISE: usize = 8;

/// One fix and the members that it corrects.
pub(super) struct Correct<'a, T> {
    pub state: &'a mut State<T>,
    /// Corrections of accelerometers and gyros.
    pub taken: &'a mut [[Lane<T>; 3]; 2],
    pub fix: &'a Fix,
    /// Which of the run's fixes it is.
    pub number: u32,
    pub drawer: Drawer,
    /// Time since the totals were last added to, s.
    pub since_s: f64,
}

impl<T: Real> Kernel for Correct<'_, T> {
    type Output = ();
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let mut noise = [Lane::splat(T::of(0.0)); NOISE];
        self.drawer.fill::<T, FMA>(stream(Stream::Fix, 0), 2 * self.number, 4, &mut noise);
        let sd = self.fix.sd.map(|sd| T::of(sd.unwrap_or(0.0)));
        let gain = self.fix.gain.map(|row| row.map(T::of));
        for l in 0..LANES {
            let errors = self.state.current(l, self.since_s);
            let mut seen = [T::of(0.0); SEEN];
            for i in 0..3 {
                seen[i] = fma::<T, FMA>(sd[i], noise[i][l], T::of(errors[1][i]));
                seen[3 + i] = fma::<T, FMA>(sd[3 + i], noise[4 + i][l], T::of(errors[2][i]));
            }
            let mut correction = [[T::of(0.0); 3]; 5];
            for row in 0..15 {
                let mut sum = T::of(0.0);
                for k in 0..SEEN {
                    sum = fma::<T, FMA>(gain[row][k], seen[k], sum);
                }
                correction[row / 3][row % 3] = sum;
            }
            let sigma = [T::of(errors[0][0]), T::of(errors[0][1]), T::of(errors[0][2])];
            let turned = turned_back::<T, FMA>(sigma, correction[0]);
            for i in 0..3 {
                self.state.add(l, i, [turned[i] - sigma[i], -correction[1][i], -correction[2][i]]);
                self.taken[0][i][l] = self.taken[0][i][l] + correction[3][i];
                self.taken[1][i][l] = self.taken[1][i][l] + correction[4][i];
            }
        }
    }
}

/// σ of exp(−δ) δC, for a small δ.
#[inline(always)]
fn turned_back<T: Real, const FMA: bool>(sigma: [T; 3], by: [T; 3]) -> [T; 3] {
    let one = T::of(1.0);
    let (a, b) = (T::of(1.0 / 16.0) * dot::<T, FMA>(by, by), T::of(1.0 / 16.0) * dot::<T, FMA>(sigma, sigma));
    let share = one / fma::<T, FMA>(a, b, fma::<T, FMA>(T::of(0.125), dot::<T, FMA>(by, sigma), one));
    let across = cross::<T, FMA>(by, sigma);
    let along = plus::<T, FMA>(b - one, by, [(one - a) * sigma[0], (one - a) * sigma[1], (one - a) * sigma[2]]);
    let sum = plus::<T, FMA>(T::of(-0.5), across, along);
    [share * sum[0], share * sum[1], share * sum[2]]
}

#[cfg(test)]
mod tests {
    use nalgebra::{UnitQuaternion, Vector3};

    use super::turned_back;

    fn sigma(turn: &UnitQuaternion<f64>) -> Vector3<f64> {
        turn.imag() * (4.0 / (1.0 + turn.w))
    }

    #[test]
    fn a_turn_back_is_a_product_of_rotations() {
        let error = UnitQuaternion::from_scaled_axis(Vector3::new(0.9, -0.4, 1.1));
        let by = UnitQuaternion::from_scaled_axis(Vector3::new(0.02, 0.3, -0.1));
        let got = Vector3::from(turned_back::<f64, false>(sigma(&error).into(), sigma(&by).into()));
        assert!((got - sigma(&(by.inverse() * error))).norm() < 1e-12);
        // Control: neither the other order nor a difference is the same.
        assert!((got - sigma(&(error * by.inverse()))).norm() > 1e-3);
        assert!((got - (sigma(&error) - sigma(&by))).norm() > 1e-3);
    }
}
