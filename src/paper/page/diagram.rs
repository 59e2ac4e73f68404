//! The Kalman filter as a block diagram whose blocks carry the numbers that were used.

use crate::fusion::Fusion;
use proofmass_base::escape::html;
use proofmass_base::number::significant;
use proofmass_base::units::DEGREE;
use proofmass_report::figure::Figure;

struct Block<'a> {
    at: (i32, i32),
    size: (i32, i32),
    lines: &'a [String],
}

pub(super) fn draw(fusion: &Fusion) -> Figure {
    let (model, rest) = (&fusion.model, &fusion.at_rest);
    let last = rest.gain.last().copied().unwrap_or([f64::NAN; 2]);
    let believed = rest.believed.last().copied().unwrap_or([f64::NAN; 2]);
    let h = significant(model.step_s, 2);
    let s = |v: f64| significant(v, 3);
    let blocks = [
        Block {
            at: (10, 40),
            size: (170, 76),
            lines: &[
                "gyro ω".into(),
                format!("N = {} °/√h", s(model.angle_walk_rad_rts / DEGREE * 60.0)),
                "Q from N and K".into(),
            ],
        },
        Block {
            at: (230, 40),
            size: (210, 76),
            lines: &["predict".into(), format!("F = [1 −{h}; 0 1]"), "P ← F P Fᵀ + Q".into()],
        },
        Block {
            at: (490, 40),
            size: (220, 76),
            lines: &["correct".into(), format!("K = [{}; {}]", s(last[0]), s(last[1])), "P ← (1 − K H) P".into()],
        },
        Block {
            at: (490, 190),
            size: (220, 76),
            lines: &[
                "accelerometer, eq. 3".into(),
                "H = [1 0]".into(),
                format!("√R = {}°", s(model.tilt_noise_rad / DEGREE)),
            ],
        },
        Block { at: (10, 190), size: (170, 76), lines: &["D: delay".into(), "one step".into(), format!("{h} s")] },
        Block {
            at: (230, 190),
            size: (210, 76),
            lines: &[
                "output: tilt, bias".into(),
                format!("√P₁₁ = {}°", s(believed[0] / DEGREE)),
                format!("√P₂₂ = {} °/s", s(believed[1] / DEGREE)),
            ],
        },
    ];
    let arrows = [
        ((180, 78), (230, 78)),
        ((440, 78), (490, 78)),
        ((600, 190), (600, 116)),
        ((490, 100), (440, 200)),
        ((230, 228), (180, 228)),
        ((180, 200), (240, 116)),
    ];
    let mut svg = String::from(
        "<svg width=\"720\" height=\"290\" viewBox=\"0 0 720 290\" xmlns=\"http://www.w3.org/2000/svg\" role=\"img\">\n\
         <defs><marker id=\"tip\" viewBox=\"0 0 8 8\" refX=\"7\" refY=\"4\" markerWidth=\"8\" markerHeight=\"8\" \
         orient=\"auto\"><path class=\"f-soft\" d=\"M0 0 8 4 0 8z\"/></marker></defs>\n\
         <text class=\"title\" x=\"10\" y=\"22\">The recursion, with its steady-state values</text>\n",
    );
    for ((x1, y1), (x2, y2)) in arrows {
        svg += &format!(
            "<line class=\"s-soft\" x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\" stroke-width=\"2\" \
             marker-end=\"url(#tip)\"/>\n"
        );
    }
    for block in &blocks {
        let ((x, y), (w, h)) = (block.at, block.size);
        svg += &format!(
            "<rect class=\"s-c1 f-tint\" x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" rx=\"6\" stroke-width=\"2\"/>\n"
        );
        for (i, line) in block.lines.iter().enumerate() {
            let class = if i == 0 { "block chief" } else { "block" };
            svg += &format!(
                "<text class=\"{class}\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                x + w / 2,
                y + 22 + 22 * i as i32,
                html(line)
            );
        }
    }
    Figure::from_svg(svg + "</svg>\n")
}
