//! When an inertial sensor lay still, and in how many poses: variances and means in short windows.

use std::ops::Range;

use crate::numerics::least_squares::Linear;
use crate::numerics::order;
use crate::stream::Block;

/// Length of the windows that are judged still or moving, s.
const WINDOW_S: f64 = 1.0;
/// Samples of the shortest window; windows of a second are joined of them. Fewer tell nothing of a
/// variance.
const WIDTH: usize = 8;
/// Axes of a whole sensor, whose eight samples make a variance that tells a still window from one
/// that moves: with 21 degrees of freedom one of 500 goes beyond `QUIET` times the 1st percentile,
/// with the seven of one axis every second one does.
const AXES: usize = 3;
/// Windows in a stretch.
const SHORTEST: usize = 2;
/// A window is still whose variance is at most this many times that of the quietest ones.
const QUIET: f64 = 5.0;
/// Standard deviations of a sensor at rest are below these, rad/s and m/s²: a hovering drone's are
/// not.
const RESTLESS: [f64; 2] = [0.05, 0.3];
/// A bias does not change by more from one rest to the next, rad/s: 1.1 °/s, ten times the
/// sensitivity to gravity of a low-cost gyro (MPU-6050 datasheet: 0.1 °/s/g). What does is turned at a
/// constant rate.
const TURNING: f64 = 0.02;
/// Cosine of the angle, 20°, from which two directions of gravity are two poses: a parked vehicle's
/// differ by the slope of the road.
const APART: f64 = 0.94;

/// A stretch of time since the first sample, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Beginning of the stretch, s.
    pub from_s: f64,
    /// End of the stretch, s.
    pub to_s: f64,
}

/// Stillness of a recording.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Still {
    /// Stretches without motion, in order of time.
    pub stretches: Vec<Stretch>,
    /// Directions of gravity among them.
    pub poses: usize,
}

/// Variances of each sensor, and the mean of the accelerometers, in a window.
#[derive(Debug, Clone, Copy, Default)]
struct Window {
    /// All axes of a sensor together; 0 of one that is not there.
    variance: [f64; 2],
    rate: [f64; 3],
    force: [f64; 3],
}

/// Windows of gyros and accelerometers.
#[derive(Default)]
pub(super) struct Rest {
    /// Samples that fill the window at hand, sensor by sensor and axis by axis, and how many.
    held: [[[f64; WIDTH]; 3]; 2],
    count: usize,
    windows: Vec<Window>,
    /// Axes of each sensor.
    axes: [usize; 2],
}

impl Rest {
    /// Takes the samples of the columns at these places, three of a sensor at most.
    pub(super) fn push(&mut self, block: &Block, sensors: &[Vec<usize>; 2]) {
        self.axes = [0, 1].map(|s| sensors[s].len().min(3));
        if self.axes == [0, 0] {
            return;
        }
        let length = block.columns.first().map_or(0, Vec::len);
        let mut from = 0;
        while from < length {
            let to = length.min(from + WIDTH - self.count);
            let window = self.count..self.count + to - from;
            for (held, places) in self.held.iter_mut().zip(sensors) {
                for (axis, place) in held.iter_mut().zip(places) {
                    axis[window.clone()].copy_from_slice(&block.columns[*place][from..to]);
                }
            }
            (from, self.count) = (to, window.end);
            if self.count == WIDTH {
                self.close();
            }
        }
    }

    /// Takes the window that is filled.
    fn close(&mut self) {
        let mean = |axis: &[f64; WIDTH]| axis.iter().sum::<f64>() / WIDTH as f64;
        let [rate, force] = self.held.each_ref().map(|sensor| sensor.each_ref().map(mean));
        self.windows.push(Window { variance: self.held.each_ref().map(variance), rate, force });
        self.count = 0;
    }

    /// Gravity's length in the accelerometer's own unit; `None` without three axes of it. Where it
    /// rests in many directions, the radius of their sphere, whatever is added to every reading;
    /// else the usual length of a reading.
    pub(super) fn gravity(&self, rate_hz: f64) -> Option<f64> {
        if self.axes[1] != AXES {
            return None;
        }
        let rests = self.rests(rate_hz, [None; 2]);
        let lengths = || order::median(self.windows.iter().map(|w| norm(&w.force)).collect());
        sphere(&rests.forces()).map(|s| s.radius).or_else(lengths)
    }

    /// White noise of a gyro at rest, unit·√s, by the quieter half of the windows.
    pub(super) fn walk(&self, rate_hz: f64) -> Option<f64> {
        if self.axes[0] == 0 {
            return None;
        }
        let mut all: Vec<f64> = self.windows.iter().map(|w| w.variance[0] / self.axes[0] as f64).collect();
        order::sort(&mut all);
        let quieter = &all[..all.len().div_ceil(2)];
        Some((quieter.get(quieter.len() / 2)? / rate_hz).sqrt())
    }

    /// Windows of about a second.
    fn joined(&self, together: usize) -> Vec<Window> {
        let mean = |part: &[Window], of: &dyn Fn(&Window) -> f64| part.iter().map(of).sum::<f64>() / part.len() as f64;
        self.windows
            .chunks_exact(together)
            .map(|part| Window {
                variance: [0, 1].map(|s| mean(part, &|w| w.variance[s])),
                rate: [0, 1, 2].map(|axis| mean(part, &|w| w.rate[axis])),
                force: [0, 1, 2].map(|axis| mean(part, &|w| w.force[axis])),
            })
            .collect()
    }

    /// When all sensors there are were still; `si` is one unit of each, where it is known.
    pub(super) fn still(&self, rate_hz: f64, si: [Option<f64>; 2]) -> Still {
        let rests = self.rests(rate_hz, si);
        let forces = rests.forces();
        let centre = sphere(&forces).map_or([0.0; 3], |s| s.centre);
        let mut directions: Vec<[f64; 3]> = Vec::new();
        for force in forces {
            let way: [f64; 3] = std::array::from_fn(|i| force[i] - centre[i]);
            if directions.iter().all(|known| !alike(known, &way)) {
                directions.push(way);
            }
        }
        Still {
            stretches: rests.0.into_iter().map(|rest| rest.stretch).collect(),
            poses: if self.axes[1] == AXES { directions.len() } else { 0 },
        }
    }

    /// Stretches in which all sensors there are were still.
    fn rests(&self, rate_hz: f64, si: [Option<f64>; 2]) -> Rests {
        let mut found = self.quiet(rate_hz, si);
        if let Some(si) = si[0] {
            found.leave_out_turning(TURNING / si);
        }
        found
    }

    /// Stretches as quiet as a rest, those of steady turns among them.
    fn quiet(&self, rate_hz: f64, si: [Option<f64>; 2]) -> Rests {
        let fewest = self.axes.into_iter().filter(|axes| *axes > 0).min().unwrap_or(AXES);
        let together = ((WINDOW_S * rate_hz / WIDTH as f64).round() as usize).max(AXES.div_ceil(fewest));
        let windows = self.joined(together);
        let mut found = Rests(Vec::new());
        if windows.is_empty() {
            return found;
        }
        let limits = [0, 1].map(|s| {
            let mut all: Vec<f64> = windows.iter().map(|w| w.variance[s]).collect();
            order::sort(&mut all);
            let quiet = QUIET * all[all.len() / 100];
            si[s].map_or(quiet, |si| quiet.min((RESTLESS[s] / si).powi(2)))
        });
        let still = |w: &Window| w.variance[0] <= limits[0] && w.variance[1] <= limits[1];
        let window_s = (together * WIDTH) as f64 / rate_hz;
        let mut begin = None;
        for k in 0..=windows.len() {
            match (begin, windows.get(k).is_some_and(still)) {
                (None, true) => begin = Some(k),
                // A sensor that is turned slowly is as quiet as one at rest; fewer axes show no direction.
                (Some(from), true) if self.axes[1] == AXES && !alike(&windows[from].force, &windows[k].force) => {
                    found.end(&windows, from..k, window_s);
                    begin = Some(k);
                }
                (Some(from), false) => {
                    found.end(&windows, from..k, window_s);
                    begin = None;
                }
                _ => {}
            }
        }
        found
    }
}

/// Leaps of a rate from one rest of a gyro to the next: it is turned at steady rates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leaps {
    /// Number of them.
    pub count: usize,
    /// The largest, in units of the readings.
    pub largest: f64,
}

/// Counts the leaps of one axis of a gyro, one unit of which is `si` rad/s.
pub fn leaps(readings: &[f64], rate_hz: f64, si: f64) -> Leaps {
    let mut rest = Rest { axes: [1, 0], ..Rest::default() };
    for window in readings.chunks_exact(WIDTH) {
        rest.held[0][0].copy_from_slice(window);
        rest.close();
    }
    let by = rest.quiet(rate_hz, [Some(si), None]).leaps();
    let large = || by.iter().copied().filter(|by| *by > TURNING / si);
    Leaps { count: large().count(), largest: large().fold(0.0, f64::max) }
}

/// A stretch of rest, with what is read in its middle and of rates at both of its ends.
struct AtRest {
    stretch: Stretch,
    rate: [f64; 3],
    ends: [[f64; 3]; 2],
    force: [f64; 3],
}

struct Rests(Vec<AtRest>);

impl Rests {
    /// Takes a stretch that is long enough.
    fn end(&mut self, all: &[Window], windows: Range<usize>, window_s: f64) {
        if windows.len() >= SHORTEST {
            let [from_s, to_s] = [windows.start, windows.end].map(|k| k as f64 * window_s);
            let Window { rate, force, .. } = all[windows.start + windows.len() / 2];
            let ends = [windows.start, windows.end - 1].map(|k| all[k].rate);
            self.0.push(AtRest { stretch: Stretch { from_s, to_s }, rate, ends, force });
        }
    }

    /// By how much rates differ, all axes together, from the end of each stretch to the next one.
    fn leaps(&self) -> Vec<f64> {
        self.0.windows(2).map(|two| apart(two[0].ends[1], two[1].ends[0])).collect()
    }

    /// Leaves out the stretches of steady turns, if rates leap from one stretch to the next, as on a
    /// turntable: all that read other than the slowest one. A drift leaps nowhere.
    fn leave_out_turning(&mut self, leap: f64) {
        let does = self.leaps().into_iter().any(|by| by > leap);
        let slowest = self.0.iter().map(|rest| rest.rate).min_by(|a, b| norm(a).total_cmp(&norm(b)));
        if let Some(slowest) = slowest.filter(|_| does) {
            self.0.retain(|rest| apart(rest.rate, slowest) <= leap);
        }
    }

    fn forces(&self) -> Vec<[f64; 3]> {
        self.0.iter().map(|rest| rest.force).collect()
    }
}

/// A sphere through the forces of a sensor at rest.
struct Sphere {
    centre: [f64; 3],
    radius: f64,
}

/// Fewest forces that make a sphere, which has four numbers.
const FEWEST: usize = 6;
/// Part of its radius by which forces may be off a sphere: scale errors of a low-cost sensor.
const OFF: f64 = 0.1;

/// The sphere by least squares of |f|² = 2c·f + k, where all forces lie near it and on all its
/// sides: converters of one sign add an offset to each axis.
fn sphere(forces: &[[f64; 3]]) -> Option<Sphere> {
    if forces.len() < FEWEST {
        return None;
    }
    let mean: [f64; 3] = std::array::from_fn(|i| forces.iter().map(|f| f[i]).sum::<f64>() / forces.len() as f64);
    let about: Vec<[f64; 3]> = forces.iter().map(|f| std::array::from_fn(|i| f[i] - mean[i])).collect();
    let size = about.iter().map(norm).fold(0.0, f64::max);
    let column = |i: usize| about.iter().map(|f| if i < 3 { 2.0 * f[i] / size } else { 1.0 }).collect();
    let residual = about.iter().map(|f| -(norm(f) / size).powi(2)).collect();
    let found = Linear { residual, columns: (0..4).map(column).collect() }.normal().step(0.0);
    let centre: [f64; 3] = std::array::from_fn(|i| found[i] * size);
    let from_centre: Vec<[f64; 3]> = about.iter().map(|f| std::array::from_fn(|i| f[i] - centre[i])).collect();
    let radius = from_centre.iter().map(norm).sum::<f64>() / from_centre.len() as f64;
    let is_near = from_centre.iter().all(|f| (norm(f) - radius).abs() <= OFF * radius);
    // Within a cap of the sphere, centre and radius are hardly known.
    let is_around = (0..3).all(|i| {
        let along = || from_centre.iter().map(|f| f[i]);
        along().fold(f64::INFINITY, f64::min) < -0.5 * radius
            && along().fold(f64::NEG_INFINITY, f64::max) > 0.5 * radius
    });
    let centre = std::array::from_fn(|i| centre[i] + mean[i]);
    (radius.is_finite() && is_near && is_around).then_some(Sphere { centre, radius })
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    norm(&std::array::from_fn(|i| a[i] - b[i]))
}

fn norm(v: &[f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Returns whether two forces have one direction; without any, they have.
fn alike(a: &[f64; 3], b: &[f64; 3]) -> bool {
    let dot: f64 = a.iter().zip(b).map(|(x, y)| x * y).sum();
    dot >= APART * norm(a) * norm(b)
}

/// Variance about the mean, the three axes together.
fn variance(axes: &[[f64; WIDTH]; 3]) -> f64 {
    let n = WIDTH as f64;
    let [a, b, c] = axes.each_ref().map(|axis| {
        let mean = axis.iter().sum::<f64>() / n;
        axis.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)
    });
    a + b + c
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_lie_on_a_sphere_wherever_its_centre_is() {
        let faces = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let all = || faces.into_iter().flat_map(|f| [f, f.map(|v: f64| -v)]);
        let forces: Vec<[f64; 3]> = all().map(|f| f.map(|v| 33_000.0 + 4_770.0 * v)).collect();
        let found = sphere(&forces).expect("six faces");
        assert!((found.radius - 4_770.0).abs() < 1.0 && (found.centre[1] - 33_000.0).abs() < 1.0);
        // Controls: one pose again and again, and half of the sphere.
        assert!(sphere(&[[0.0, 0.0, 9.8]; 8]).is_none());
        assert!(
            sphere(&[
                [0.1, 0.0, 9.8],
                [-0.1, 0.0, 9.8],
                [0.0, 0.1, 9.8],
                [0.0, -0.1, 9.8],
                [0.0, 0.0, 9.8],
                [0.1, 0.1, 9.8]
            ])
            .is_none()
        );
    }
}
