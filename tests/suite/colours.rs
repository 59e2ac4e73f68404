//! Colours of figures: any two inks of a theme differ for every reader, and all stand out from the
//! paper.
//!
//! Difference: CIEDE2000 (Sharma, Wu & Dalal 2005). Colour-blindness: Machado, Oliveira & Fernandes
//! 2009, severity 1, on linear RGB. Contrast: WCAG 2.

use libtest_mimic::{Failed, Trial};
use proofmass::report::figure::theme;

use super::world::{check, near, test};

/// Tests of this module.
pub fn tests() -> Vec<Trial> {
    vec![
        test("colours: the difference is that of the published pairs", published),
        test("colours: inks differ for all readers in both themes and stand out from the paper", inks),
    ]
}

type Rgb = [f64; 3];

/// Linear RGB of "#RRGGBB".
fn linear(hex: &str) -> Option<Rgb> {
    let part = |k: usize| Some(f64::from(u8::from_str_radix(hex.get(k..k + 2)?, 16).ok()?) / 255.0);
    let part = |k: usize| part(k).map(|c| if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) });
    Some([part(1)?, part(3)?, part(5)?])
}

fn times(m: &[[f64; 3]; 3], v: Rgb) -> Rgb {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

const XYZ: [[f64; 3]; 3] = [
    [0.412_456_4, 0.357_576_1, 0.180_437_5],
    [0.212_672_9, 0.715_152_2, 0.072_175_0],
    [0.019_333_9, 0.119_192_0, 0.950_304_1],
];
/// What a reader sees: everything, no red (protanopia), no green (deuteranopia).
const READERS: [(&str, [[f64; 3]; 3]); 3] = [
    ("all cones", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
    (
        "protanopia",
        [[0.152_286, 1.052_583, -0.204_868], [0.114_503, 0.786_281, 0.099_216], [-0.003_882, -0.048_116, 1.051_998]],
    ),
    (
        "deuteranopia",
        [[0.367_322, 0.860_646, -0.227_968], [0.280_085, 0.672_501, 0.047_413], [-0.011_820, 0.042_940, 0.968_881]],
    ),
];

fn lab(rgb: Rgb) -> Rgb {
    let xyz = times(&XYZ, rgb.map(|c| c.clamp(0.0, 1.0)));
    let f = |t: f64| if t > 216.0 / 24389.0 { t.cbrt() } else { (24389.0 / 27.0 * t + 16.0) / 116.0 };
    let [x, y, z] = [xyz[0] / 0.950_47, xyz[1], xyz[2] / 1.088_83].map(f);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn ciede2000(a: Rgb, b: Rgb) -> f64 {
    let mean = 0.5 * (a[1].hypot(a[2]) + b[1].hypot(b[2]));
    let g = |c: f64| (c.powi(7) / (c.powi(7) + 25f64.powi(7))).sqrt();
    let stretch = 1.0 + 0.5 * (1.0 - g(mean));
    let polar = |c: Rgb| {
        let (x, y) = (c[1] * stretch, c[2]);
        (x.hypot(y), y.atan2(x).to_degrees().rem_euclid(360.0))
    };
    let ((c1, h1), (c2, h2)) = (polar(a), polar(b));
    let turn = (h2 - h1 + 540.0).rem_euclid(360.0) - 180.0;
    let turn = if c1 * c2 == 0.0 { 0.0 } else { turn };
    let (l, c) = (b[0] - a[0], c2 - c1);
    let h = 2.0 * (c1 * c2).sqrt() * (0.5 * turn).to_radians().sin();
    let (l_mean, c_mean) = (0.5 * (a[0] + b[0]), 0.5 * (c1 + c2));
    let h_mean = if c1 * c2 == 0.0 { h1 + h2 } else { (h1 + 0.5 * turn).rem_euclid(360.0) };
    let cos = |factor: f64, shift: f64| (factor * h_mean + shift).to_radians().cos();
    let t = 1.0 - 0.17 * cos(1.0, -30.0) + 0.24 * cos(2.0, 0.0) + 0.32 * cos(3.0, 6.0) - 0.2 * cos(4.0, -63.0);
    let s_l = 1.0 + 0.015 * (l_mean - 50.0).powi(2) / (20.0 + (l_mean - 50.0).powi(2)).sqrt();
    let (s_c, s_h) = (1.0 + 0.045 * c_mean, 1.0 + 0.015 * c_mean * t);
    let rotation = -2.0 * g(c_mean) * (60.0 * (-((h_mean - 275.0) / 25.0).powi(2)).exp()).to_radians().sin();
    let (l, c, h) = (l / s_l, c / s_c, h / s_h);
    (l * l + c * c + h * h + rotation * c * h).sqrt()
}

fn published() -> Result<(), Failed> {
    // Pairs 1, 7, 17, 25 and 34 of Sharma, Wu & Dalal's table 1.
    for (a, b, expected) in [
        ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
        ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
        ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
        ([60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644),
        ([2.0776, 0.0795, -1.135], [0.9033, -0.0636, -0.5514], 0.9082),
    ] {
        near("CIEDE2000", ciede2000(a, b), expected, 5e-5)?;
    }
    Ok(())
}

/// The variables of a theme, name and colour.
fn variables(css: &str) -> Vec<(&str, &str)> {
    let inside = css.split_once('{').and_then(|(_, r)| r.split_once('}')).map_or("", |r| r.0);
    inside.split(';').filter_map(|v| v.trim_start_matches("--").split_once(':')).collect()
}

fn judge(theme: &str, colours: &[(&str, &str)]) -> Result<(), Failed> {
    let colour = |name: &str| {
        let found = colours.iter().find(|(n, _)| *n == name).and_then(|(_, hex)| linear(hex));
        found.ok_or_else(|| Failed::from(format!("{theme}: no {name} in {colours:?}")))
    };
    let names = ["c1", "c2", "c3", "c4", "c5", "c6", "ink", "soft"];
    let light = |rgb: Rgb| times(&XYZ, rgb)[1] + 0.05;
    let paper = colour("paper")?;
    for (k, name) in names.into_iter().enumerate() {
        let own = colour(name)?;
        let contrast = light(own).max(light(paper)) / light(own).min(light(paper));
        check(contrast >= 3.0, format!("{theme}: {name} has a contrast of {contrast:.2} to the paper"))?;
        for other in &names[..k] {
            for (reader, sees) in &READERS {
                let apart = ciede2000(lab(times(sees, own)), lab(times(sees, colour(other)?)));
                check(apart >= 10.5, format!("{theme}: {name} and {other} differ by {apart:.1} for {reader}"))?;
            }
        }
    }
    Ok(())
}

fn inks() -> Result<(), Failed> {
    let css = theme::css();
    let (light, dark) = css.split_once("@media(prefers-color-scheme:dark){").ok_or("no dark theme")?;
    judge("light", &variables(light))?;
    judge("dark", &variables(dark))?;
    // Okabe & Ito's set as it is: its yellow and sky blue fade on white, its blues meet the greys.
    let plain = light.replace("#BE8100", "#E69F00");
    check(plain != light && judge("control", &variables(&plain)).is_err(), "an orange that fades on white passes")?;
    let alike = light.replace("#078B65", "#B54809");
    check(judge("control", &variables(&alike)).is_err(), "two equal inks pass")
}
