//! Figures 5 to 12 on the page.

use super::diagram;
use super::section::{checks, head, thin};
use crate::Paper;
use crate::check::Provenance;
use crate::fusion::{BACK_AFTER_S, Fusion, MOVED_UNTIL_S, STILL_UNTIL_S};
use crate::moved::Line;
use crate::pitch::{Curve, Pitch};
use proofmass_base::number::{significant, with_uncertainty};
use proofmass_base::units::DEGREE;
use proofmass_numerics::numerics::order::quantile;
use proofmass_report::figure::{Axis, Chart, Figure, Ink, Mark};
use proofmass_report::html::Page;
use proofmass_report::table::Table;

pub(super) fn write(page: &mut Page, paper: &Paper) {
    moving(page, &paper.pitch);
    still(page, &paper.pitch);
    distributions(page, &paper.pitch);
    figure_11(page, &paper.fusion);
    figure_12(page, &paper.fusion, &paper.pitch);
}

fn degrees(curve: &[(f64, f64)], most: usize) -> Curve {
    thin(&curve.iter().map(|p| (p.0, p.1 / DEGREE)).collect::<Vec<_>>(), most)
}

fn pitches(title: &str, force: &[(f64, f64)], gyro: &[(f64, f64)]) -> Chart {
    Chart::new(title, Axis::linear("time / s"), Axis::linear("pitch / °"))
        .with("accelerometer, eq. 3", Ink::Red, Mark::Line, degrees(force, 1400))
        .with("gyro, integrated", Ink::Blue, Mark::Line, degrees(gyro, 1400))
}

fn moving(page: &mut Page, pitch: &Pitch) {
    let [exhibit_5, exhibit_6, ..] = &pitch.exhibits;
    head(page, exhibit_5);
    page.paragraph(
        "Tilt can be read from gravity itself: eq. 3, pitch = atan(a_x/√(a_y² + a_z²)), needs no integration and so cannot \
         drift. But it mistakes every acceleration for gravity.",
    );
    let alone = Chart::new("A hand-rotated sensor", Axis::linear("time / s"), Axis::linear("pitch / °"))
        .with("accelerometer, eq. 3", Ink::Red, Mark::Line, degrees(&pitch.moving_force, 1800))
        .draw();
    page.figure(
        &alone,
        &format!(
            "{}. Counts were turned into m/s² and rad/s by a calibration on the still poses alone: offsets, a scale per axis, \
             misalignment, the gyro's sensitivity to force. Eq. 3 is smooth at rest and jagged in every move.",
            pitch.origin
        ),
    );
    checks(page, exhibit_5);

    head(page, exhibit_6);
    page.paragraph(
        "The gyro feels no acceleration. Its pitch starts from the mean of the pose before and is carried through the move by \
         the measured rate, turning the direction of gravity in three dimensions. Each new pose confirms it.",
    );
    let part = |c: &[(f64, f64)]| -> Curve {
        c.iter().copied().filter(|p| p.0 >= pitch.enlarged_s.0 && p.0 <= pitch.enlarged_s.1).collect()
    };
    let (force, gyro) = (part(&pitch.moving_force), part(&pitch.moving_gyro));
    page.figure(
        &pitches("One move of figure 5", &force, &gyro).draw(),
        "The move of the recording on which accelerometer and gyro disagree most. The gyro's curve is the true motion to about \
         a tenth of a degree, as its agreement with the next pose shows; the rest of the orange curve is the hand.",
    );
    checks(page, exhibit_6);
}

fn still(page: &mut Page, pitch: &Pitch) {
    let [_, _, exhibit_7, exhibit_8, exhibit_9, _] = &pitch.exhibits;
    head(page, exhibit_7);
    page.paragraph(
        "At rest the roles are exchanged: the gyro's pitch is an integral, and an integral of noise wanders.",
    );
    let gyro = Chart::new("At rest", Axis::linear("time / s"), Axis::linear("pitch / °"))
        .with("gyro, integrated", Ink::Blue, Mark::Line, degrees(&pitch.still_gyro, 1200))
        .draw();
    page.figure(
        &gyro,
        "The motionless start of the recording: the rate, minus the offset that the calibration found over all poses, \
        integrated. Nothing moves, and the angle does.",
    );
    checks(page, exhibit_7);

    head(page, exhibit_8);
    page.paragraph(
        "Side by side: the accelerometer scatters about the truth and stays there; the gyro is smooth and leaves.",
    );
    page.figure(
        &pitches("At rest", &pitch.still_force, &pitch.still_gyro).draw(),
        "The same stretch. Orange: eq. 3 minus its mean. Blue: as in figure 7. What the paper calls bias may equally \
        be random walk here: white rate noise alone explains a final drift of this size.",
    );
    checks(page, exhibit_8);

    head(page, exhibit_9);
    let n = &pitch.angle_walk;
    let hourly = |v: f64| significant(v / DEGREE * 60.0, 3);
    page.paragraph(&format!(
        "How fast it leaves is one number, the angle random walk N: the angle's standard deviation after a time t is N√t. \
         Fitted to the Allan deviation of this stretch, N = {} °/√h (95 %: {} to {}).",
        hourly(n.value),
        hourly(n.ci95[0]),
        hourly(n.ci95[1])
    ));
    let end = pitch.still_walk.last().map_or(1.0, |p| p.0);
    // With the mean rate taken off, the walk is tied to zero at both ends: its deviation is N√(t(T
    // − t)/T).
    let arch = |sign: f64| -> Curve {
        let at = |k: u32| f64::from(k) / 100.0 * end;
        (0..=100).map(|k| (at(k), sign * n.value / DEGREE * (at(k) * (end - at(k)) / end).sqrt())).collect()
    };
    let walk = Chart::new("The walk and its law", Axis::linear("time / s"), Axis::linear("pitch / °"))
        .with("accelerometer", Ink::Red, Mark::Line, degrees(&pitch.still_force, 800))
        .with("gyro, mean rate removed", Ink::Black, Mark::Line, degrees(&pitch.still_walk, 800))
        .with("one standard deviation", Ink::Soft, Mark::Dashed, arch(1.0))
        .with("", Ink::Soft, Mark::Dashed, arch(-1.0))
        .draw();
    let law: Curve = pitch.allan.iter().map(|p| (p.0, n.value / DEGREE / p.0.sqrt())).collect();
    let allan = Chart::new(
        "Allan deviation of the rate",
        Axis::log("averaging time τ / s"),
        Axis::log("Allan deviation / (°/s)"),
    )
    .with("this stretch", Ink::Blue, Mark::Dots(3), degrees(&pitch.allan, 200))
    .with("N/√τ", Ink::Black, Mark::Dashed, law)
    .draw();
    page.figure_row(&[
        (&walk, "The gyro's angle without its own mean rate, so that it is tied to zero at both ends; the dashed arch is the \
                 standard deviation N√(t(T − t)/T) of such a walk."),
        (&allan, "Slope −½ is white noise of the rate; its height at 1 s is N. Beyond ten seconds few independent \
        averages remain."),
    ]);
    checks(page, exhibit_9);
}

fn distributions(page: &mut Page, pitch: &Pitch) {
    let exhibit_10 = &pitch.exhibits[5];
    head(page, exhibit_10);
    let tenth = |v: f64| v / DEGREE;
    page.paragraph(&format!(
        "The paper prefers the gyro's distribution because it is narrower. That is true only for a while: the accelerometer's \
         width is fixed at {}°, the gyro's grows as √T. By the law N²T/12 of a walk tied at both ends they are equally wide \
         after {} s; over this whole still stretch the gyro's width is {}°, and the accelerometer's distribution is the {} \
         one. What makes the Kalman filter work is not that one is narrower but that one is good for short times and the \
         other for long ones.",
        with_uncertainty(tenth(pitch.force_deviation.value), tenth(pitch.force_deviation.standard_error)),
        significant(pitch.equal_s, 2),
        with_uncertainty(tenth(pitch.walk_deviation.value), tenth(pitch.walk_deviation.standard_error)),
        if pitch.force_deviation.value < pitch.walk_deviation.value { "narrower" } else { "wider" },
    ));
    let reach = 3.5 * tenth(pitch.force_deviation.value.max(pitch.walk_deviation.value));
    let bins = 36;
    let width = 2.0 * reach / f64::from(bins);
    let middle = |c: &Curve| c.iter().map(|p| p.1).sum::<f64>() / c.len().max(1) as f64;
    let histogram = |c: &Curve| -> Curve {
        let mut counts = vec![0.0; bins as usize];
        let centre = middle(c);
        for p in c {
            let bin = ((tenth(p.1 - centre) + reach) / width).floor();
            if (0.0..f64::from(bins)).contains(&bin) {
                counts[bin as usize] += 1.0 / (c.len() as f64 * width);
            }
        }
        counts.iter().enumerate().map(|(i, n)| (-reach + (i as f64 + 0.5) * width, *n)).collect()
    };
    let chart = Chart::new(
        "Distributions over the still stretch",
        Axis::linear("pitch minus its mean / °"),
        Axis::linear("density / (1/°)"),
    )
    .with("accelerometer", Ink::Red, Mark::Bars(width), histogram(&pitch.still_force))
    .with("gyro, mean rate removed", Ink::Black, Mark::Bars(width), histogram(&pitch.still_walk))
    .draw();
    // What makes the teeth is known for the recording alone; the simulation does not round.
    let teeth = match exhibit_10.source {
        Provenance::Recorded => " The comb in the accelerometer's distribution is its quantisation.",
        Provenance::Simulated => "",
    };
    page.figure(
        &chart,
        &format!(
            "The samples of figure 9 as densities. The accelerometer's are nearly independent, so that their width is \
            known to \
             a per cent; the gyro's are one single walk, and its width is known only to about a third: another minute \
             would give another shape.{teeth}"
        ),
    );
    checks(page, exhibit_10);
}

fn figure_11(page: &mut Page, fusion: &Fusion) {
    let exhibit = &fusion.exhibits[0];
    head(page, exhibit);
    page.paragraph(
        "The filter keeps two states, the tilt and the gyro's bias, and their covariance P. Every hundredth of a \
        second it predicts with the gyro, which increases P, and corrects with the accelerometer, which reduces it. \
        The gain K is the fraction of the innovation that it applies. All matrices follow from the datasheet noise of \
        the sensors; nothing is tuned.",
    );
    page.figure(
        &diagram::draw(fusion),
        "State x = (tilt, gyro bias); F moves the tilt by rate less bias; H says that the accelerometer sees the tilt; D is the \
         delay by one step. The numbers are those of the filter after a minute at rest.",
    );
    let rest = &fusion.at_rest;
    let curve =
        |pick: &dyn Fn(usize) -> f64| -> Curve { rest.time_s.iter().enumerate().map(|(i, t)| (*t, pick(i))).collect() };
    let p = Chart::new(
        "Standard deviation in the filter, and actual error",
        Axis::log("time / s"),
        Axis::log("standard deviation"),
    )
    .with("√P of the tilt / °", Ink::Blue, Mark::Line, curve(&|i| rest.believed[i][0] / DEGREE))
    .with("√P of the bias / (°/s)", Ink::Green, Mark::Line, curve(&|i| rest.believed[i][1] / DEGREE))
    .with("400 simulated sensors", Ink::Black, Mark::Dots(2), curve(&|i| rest.actual[i][0] / DEGREE))
    .with("", Ink::Black, Mark::Dots(2), curve(&|i| rest.actual[i][1] / DEGREE))
    .draw();
    let k = Chart::new("The gain", Axis::log("time / s"), Axis::log("K"))
        .with("on the tilt", Ink::Blue, Mark::Line, curve(&|i| rest.gain[i][0]))
        .with("on the bias, size / (1/s)", Ink::Green, Mark::Line, curve(&|i| rest.gain[i][1].abs()))
        .draw();
    page.figure_row(&[
        (
            &p,
            "P over time from a start that knows the tilt to 1° and the bias to 0.2 °/s; dots are the actual errors \
        of an ensemble that satisfies the filter's model.",
        ),
        (&k, "K over time: large at first, about a twentieth in steady state."),
    ]);
    checks(page, exhibit);
}

fn spread(values: &[f64], unit: f64, digits: usize) -> String {
    let at = |fraction| significant(quantile(values, fraction) / unit, digits);
    format!("{} ({} to {})", at(0.5), at(0.05), at(0.95))
}

/// Accelerometer, gyro and the three filters: time, the two, the three; s and rad. First what the
/// accelerometer and the plain filter do; then, enlarged, what hides near zero next to them.
fn filters(title: &str, label: &str, lines: &[Line], (from_s, to_s): (f64, f64), reach_deg: f64) -> [Figure; 2] {
    let inside: Vec<_> = lines.iter().filter(|l| l.0 >= from_s && l.0 <= to_s).collect();
    let pick = |value: fn(&Line) -> f64| -> Curve {
        thin(&inside.iter().map(|l| (l.0, value(l) / DEGREE)).collect::<Vec<_>>(), 900)
    };
    let chart = |title: &str, reach_deg: f64| {
        let y = Axis::linear(label).within(-reach_deg, reach_deg);
        Chart::new(title, Axis::linear("time / s").within(from_s, to_s), y)
    };
    let whole = chart(title, reach_deg)
        .with("accelerometer", Ink::Red, Mark::Line, pick(|l| l.1))
        .with("gyro", Ink::Blue, Mark::Line, pick(|l| l.2))
        .with("plain filter", Ink::Green, Mark::Line, pick(|l| l.3[0]));
    let (gyro, weighted, adaptive) = (pick(|l| l.2), pick(|l| l.3[1]), pick(|l| l.3[2]));
    let small = [&gyro, &weighted, &adaptive].into_iter().flatten().map(|p| p.1.abs()).fold(0.0, f64::max);
    let enlarged = chart(&format!("{title}, enlarged"), 1.1 * small.max(1e-3))
        .with("plain filter", Ink::Green, Mark::Line, pick(|l| l.3[0]))
        .with("gyro", Ink::Blue, Mark::Line, gyro)
        .with("weighted by ||a| − g|", Ink::Purple, Mark::Line, weighted)
        .with("and adaptive R", Ink::Orange, Mark::Dashed, adaptive);
    [whole.draw(), enlarged.draw()]
}

fn figure_12(page: &mut Page, fusion: &Fusion, pitch: &Pitch) {
    let exhibit = &fusion.exhibits[1];
    let (motion, moved) = (&fusion.in_motion, &fusion.moved);
    head(page, exhibit);
    page.paragraph(&format!(
        "The plain filter always trusts the accelerometer as if it were at rest. Pushed to one side between \
        {STILL_UNTIL_S} and \
         {MOVED_UNTIL_S} s, a level sensor reads tens of degrees; the filter follows, and then takes several of its \
         time constants to recover. In the paper it is back after {BACK_AFTER_S} s; with datasheet noise and no \
         tuning the \
         ensemble's median is {} s.",
        significant(MOVED_UNTIL_S + quantile(&motion.recovery_s[0], 0.5), 3)
    ));
    page.paragraph(
        "The filter could have detected it. |a| departs from g in every push, and the innovation, squared over its \
        variance (NIS), \
         jumps from 1 to hundreds of thousands. A filter that raises R by the tilt which an excess of |a| allows, 2||a| − g|/g, \
         hardly moves; one that also watches the scatter of its innovations helps where the force keeps its length, as in \
         slow moves by hand. The cost is that it distrusts the accelerometer for longer afterwards.",
    );
    let [example, enlarged] = filters("One push, simulated", "tilt / °", &motion.example, (0.9, 3.4), 20.0);
    let mut histogram = Chart::new(
        "Time until back, plain filter",
        Axis::linear("after the end of the motion / s"),
        Axis::linear("members of 400"),
    );
    let width = 0.05;
    let bars: Curve = (0..40)
        .map(|i| {
            let from = f64::from(i) * width;
            let inside = motion.recovery_s[0].iter().filter(|r| **r >= from && **r < from + width).count();
            (from + 0.5 * width, inside as f64)
        })
        .collect();
    let top = bars.iter().map(|b| b.1).fold(0.0, f64::max);
    let papers = BACK_AFTER_S - MOVED_UNTIL_S;
    histogram.add("simulated", Ink::Green, Mark::Bars(width), bars);
    histogram.add("the paper's", Ink::Black, Mark::Dashed, vec![(papers, 0.0), (papers, top)]);
    page.figure_row(&[
        (&example, "One of 400 simulated sensors. The push is one swing of acceleration, so that it starts and ends at rest; its \
                    size is drawn per member (typically 12 m/s²). The accelerometer's swing goes far beyond the frame."),
        (&enlarged, "The same without the accelerometer: the weighted filters stay with the gyro while the plain one \
        leaves the \
                     frame."),
        (&histogram.draw(), "Recovery: the time after the motion at which its trace, against a copy with the same \
        noise that was not pushed, is below the filter's own standard deviation √P."),
    ]);
    let words = match moved.source {
        Provenance::Recorded => "on the recording's own moves",
        Provenance::Simulated => "on the moves of a simulation, since no recording was found",
    };
    let errors: Vec<Line> = moved.example.iter().map(|l| (l.0, l.2 - l.1, 0.0, l.3.map(|f| f - l.1))).collect();
    let end = errors.last().map_or(8.0, |l| l.0);
    let [recorded, enlarged] = filters("A move by hand", "tilt minus reference / °", &errors, (-1.0, end), 10.0);
    let caption = format!(
        "The three filters {words} ({}), with the noise fitted to the still minute: the move with the plain filter's largest \
         error, as errors against a reference: the pitch that the gyro carries from pose to pose, made to meet the \
         accelerometer in both.",
        pitch.origin
    );
    page.figure_row(&[
        (&recorded, &caption),
        (&enlarged, "The same without the accelerometer. The blue line is the reference itself, and so is zero."),
    ]);
    let mut table = Table::new(&[
        "filter",
        "simulated push: largest error / °",
        "back after / s",
        "NIS before, in, after",
        "moves by hand: largest error / °",
        "back after / s",
    ]);
    for (w, name) in ["plain", "weighted by ||a| − g|", "and adaptive R"].into_iter().enumerate() {
        table.row([
            name.to_owned(),
            spread(&motion.peak_rad[w], DEGREE, 2),
            spread(&motion.recovery_s[w], 1.0, 2),
            motion.nis[w].map(|n| significant(n, 2)).join(", "),
            spread(&moved.peak_rad[w], DEGREE, 2),
            spread(&moved.recovery_s[w], 1.0, 2),
        ]);
    }
    page.table(&table);
    page.paragraph(&format!(
        "Medians with 5 to 95 % in brackets; {} moves by hand, where \"back\" is within 0.25° of the pose for good. A \
        hand comes to rest gently, so even the plain filter recovers soon; the filters differ in how large their \
        error became.",
        moved.recovery_s[0].len()
    ));
    checks(page, exhibit);
}
