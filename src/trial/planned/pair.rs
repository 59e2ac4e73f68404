//! A sensor with one law, and a first recording that may leave open which.

use serde::{Deserialize, Serialize};

use crate::independent::draw::Draw;
use crate::independent::driven::Driven;
use crate::independent::exact::piece;
use crate::independent::oscillator_base::{Size, Wish, stage};
use crate::independent::sizing::strengthen;

/// Laws of which another one can be told, if an experiment is right.
const LAWS: [&str; 12] = [
    "cubic-stiffness",
    "quadratic-damping",
    "readout-nonlinearity",
    "squeeze-film-damping",
    "quadratic-stiffness",
    "coulomb-friction",
    "readout-delay",
    "hysteresis",
    "drive-nonlinearity",
    "readout-lowpass",
    "coupled-mode",
    "parasitic-mode",
];
/// Rows of the longest first recording.
const ROWS: usize = 4000;
/// Draws after which a sensor is given up.
const DRAWS: usize = 40;

/// Reason for which the first recording leaves laws open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Left {
    /// The law shows a tenth to a half of the noise.
    Weak,
    /// One sine, under which many laws act alike.
    OneSine,
}

impl Left {
    /// All, in the order of the report.
    pub const ALL: [Self; 2] = [Self::Weak, Self::OneSine];

    /// Words for tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Weak => "law below the noise",
            Self::OneSine => "one sine",
        }
    }
}

/// A sensor with its first recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Pair {
    /// Number of the sensor: same seed and number, same sensor.
    pub number: usize,
    /// Id of the law that it follows.
    pub law: String,
    /// Reason for which its first recording may leave it open.
    pub left: Left,
    /// Sensor, first input and noise.
    pub driven: Driven,
}

impl Pair {
    /// Makes a sensor by its number. `None` where no draw shows its law.
    pub fn make(seed: u64, number: usize) -> Option<Self> {
        let law = LAWS[number % LAWS.len()];
        let left = Left::ALL[number / LAWS.len() % Left::ALL.len()];
        let mut draw = Draw::new(seed, number as u64, 41);
        let driven = (0..DRAWS).find_map(|_| attempt(law, left, &mut draw))?;
        Some(Self { number, law: law.into(), left, driven })
    }
}

fn attempt(law: &str, left: Left, draw: &mut Draw) -> Option<Driven> {
    let (wish, over_noise) = match left {
        Left::Weak => (Wish::Rich, draw.log_between(0.1, 0.5)),
        Left::OneSine => (Wish::Sine, draw.log_between(0.5, 5.0)),
    };
    let mut base = stage(draw, wish, Size { rows: ROWS });
    let target = over_noise * base.sigma;
    let mut piece = piece(law, draw, &base, target)?;
    if !strengthen(&base, &mut piece, target) {
        return None;
    }
    piece.put(&mut base);
    // Delays and poles have no size: the noise is made to fit what is seen of the law.
    let visible = base.visible(base.oscillator.rows)?;
    base.sigma = visible / over_noise;
    if base.columns.output_scale.abs() * base.sigma < 1.0 {
        base.columns.step = 0.0;
    }
    (1e-5..0.5).contains(&base.sigma).then_some(base)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_means_the_same_sensor_and_each_law_shows_as_much_as_was_asked() {
        let mut made = 0;
        for number in 0..2 * LAWS.len() {
            let Some(pair) = Pair::make(3, number) else { continue };
            made += 1;
            assert_eq!(Some(&pair), Pair::make(3, number).as_ref());
            let driven = &pair.driven;
            let over_noise = driven.visible(driven.oscillator.rows).expect("bounded") / driven.sigma;
            let [low, high] = if pair.left == Left::Weak { [0.1, 0.5] } else { [0.5, 5.0] };
            assert!(over_noise > 0.99 * low && over_noise < 1.01 * high, "{} {over_noise}", pair.law);
        }
        assert!(made >= 2 * LAWS.len() - 2, "{made} sensors");
    }
}
