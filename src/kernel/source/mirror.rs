//! Tests of the shaders: each parses and validates, and its structs, columns, bindings, workgroups
//! and bounds are the host's.

use std::mem::offset_of;

use naga::valid::{Capabilities, ValidationFlags, Validator};

use super::Shader;
use crate::layout::{self, Bins, Fix, Flight, OrbitTile, Partial, Report, Tile};
use crate::physics::coefficients::{StudyLaw, laws};
use crate::places::Places;
use crate::sensor::SensorTerm;
use crate::sensor::error_law::{ErrorLaw, Shape};
use crate::source;

/// A shader that parses and validates.
fn parsed(shader: &Shader) -> naga::Module {
    let module = naga::front::wgsl::parse_str(&shader.text).map_err(|e| e.emit_to_string(&shader.text));
    let module = module.unwrap_or_else(|e| panic!("{}: {e}", shader.name));
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::SHADER_INT64);
    validator.validate(&module).unwrap_or_else(|e| panic!("{}: {e:?}", shader.name));
    module
}

/// The ensemble kernel of members that have all numbers.
fn simulate(int64: bool, laws: &[StudyLaw]) -> Shader {
    source::simulate(int64, laws, &Places::all())
}

/// Every shader there is.
fn all() -> Vec<Shader> {
    let drawing =
        [false, true].map(|int64| [simulate(int64, laws()), source::lyapunov(int64), source::poincare(int64)]);
    let traced = source::simulate_traced(false, laws(), &Places::all());
    let others = [
        source::reduce(),
        source::compensation(),
        source::peak(),
        source::navigate(false),
        source::navigate(true),
        traced,
    ];
    drawing.into_iter().flatten().chain(others).collect()
}

#[test]
fn shaders_parse_and_validate() {
    all().iter().for_each(|s| drop(parsed(s)));
}

/// Returns whether a line that begins a loop steps its variable by a constant towards a bound.
fn counts(line: &str) -> bool {
    let Some((name, rest)) = line.strip_prefix("for (var ").and_then(|l| l.split_once(" = ")) else { return false };
    let mut parts = rest.trim_end_matches(") {").split("; ").skip(1);
    let (bound, step) = (parts.next().unwrap_or_default(), parts.next().unwrap_or_default());
    let [up, down] = ["<", ">"].map(|sign| bound.starts_with(&format!("{name} {sign}")));
    up && (step == format!("{name}++") || step == format!("{name} += PARTIAL"))
        || down && step == format!("{name} >>= 1u")
}

/// The device is given them as they are (`gpu::kernel`), so one that does not end would hang it.
#[test]
fn every_loop_counts_to_a_bound() {
    let texts = all();
    let lines = || texts.iter().flat_map(|s| s.text.lines()).map(str::trim);
    let begins = |line: &&str| ["for ", "for(", "while", "loop"].iter().any(|word| line.starts_with(word));
    assert!(lines().filter(begins).count() > 20);
    lines().filter(begins).for_each(|line| assert!(counts(line), "{line}"));
    assert!(!counts("for (var i = 0u; i < n; i += step) {") && !counts("loop {"));
}

/// Layout of a struct of a shader: bytes, members and their offsets.
#[derive(Debug, PartialEq)]
struct Mirror {
    size: u32,
    members: Vec<(String, u32)>,
}

macro_rules! mirror {
    ($t:ty { $($field:ident),* } $($padding:literal at $at:expr),*) => {{
        let mut members: Vec<(String, u32)> = vec![$((stringify!($field).into(), offset_of!($t, $field) as u32)),*];
        members.extend([$(($padding.into(), $at)),*] as [(String, u32); 0 $(+ { let _ = $padding; 1 })*]);
        members.sort_by_key(|m| m.1);
        Mirror { size: size_of::<$t>() as u32, members }
    }};
}

/// A struct as a shader has it.
fn structure(module: &naga::Module, name: &str) -> Mirror {
    let found = module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name));
    match &found.expect("the struct is there").1.inner {
        naga::TypeInner::Struct { members, span } => Mirror {
            size: *span,
            members: members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset)).collect(),
        },
        other => panic!("{other:?}"),
    }
}

fn tile() -> Mirror {
    mirror!(Tile {
        seed,
        first_member,
        members,
        stride,
        first_sample,
        samples,
        flicker_terms,
        tilt_gain,
        sample_s,
        zero,
        still_samples,
        still_share,
        level,
        padding,
        flicker
    })
}

#[test]
fn structs_have_the_same_members_at_the_same_places() {
    let orbit = || mirror!(OrbitTile { seed, first, points, steps, begin, periods, counted, strobe, padding });
    let report = mirror!(Report { members, stride, number, blocks, counts }
        "padding_0" at 20, "padding_1" at 24, "padding_2" at 28);
    let flight = mirror!(Flight {
        members,
        stride,
        samples,
        since,
        sample_s,
        free,
        zero,
        cosine,
        sine,
        first_sample,
        passed,
        padding,
        own_place,
        own_speed,
        own_turn
    });
    let fix = mirror!(Fix { seed, first_member, number, present, sd, gain } "padding_0" at 24, "padding_1" at 28);
    let partial = mirror!(Partial { count, mean, correction, squares, least, greatest });
    for (shader, name, mirror) in [
        (simulate(false, laws()), "Tile", tile()),
        (simulate(false, laws()), "Bins", mirror!(Bins { begin, per_unit })),
        (simulate(false, laws()), "Partial", partial),
        (source::reduce(), "Report", report),
        (source::navigate(false), "Flight", flight),
        (source::navigate(false), "Fix", fix),
        (source::lyapunov(false), "OrbitTile", orbit()),
        (source::poincare(false), "OrbitTile", orbit()),
    ] {
        assert_eq!(structure(&parsed(&shader), name), mirror, "{name} of {}", shader.name);
    }
}

#[test]
fn a_shifted_member_is_noticed() {
    let moved = simulate(false, laws()).text.replacen("stride: u32,", "", 1);
    let module = parsed(&Shader { name: "moved", text: moved.replace("tile.stride", "tile.members") });
    assert_ne!(structure(&module, "Tile"), tile());
}

#[test]
fn bindings_and_workgroups_are_what_the_host_dispatches() {
    for (shader, bindings, size) in [
        (simulate(false, laws()), 7, layout::SIMULATE_WORKGROUP),
        (source::simulate_traced(false, laws(), &Places::all()), 8, layout::SIMULATE_WORKGROUP),
        (source::navigate(false), 11, layout::NAVIGATE_WORKGROUP),
        (source::reduce(), 5, layout::REDUCE_WORKGROUP),
        (source::lyapunov(false), 4, layout::ORBIT_WORKGROUP),
        (source::poincare(false), 5, layout::ORBIT_WORKGROUP),
        (source::peak(), 1, layout::PEAK_WORKGROUP),
    ] {
        let module = parsed(&shader);
        let mut found: Vec<u32> =
            module.global_variables.iter().filter_map(|(_, v)| v.binding.map(|b| b.binding)).collect();
        found.sort_unstable();
        assert_eq!(found, (0..bindings).collect::<Vec<u32>>(), "{}", shader.name);
        let entry = &module.entry_points[0];
        assert_eq!((entry.name.as_str(), entry.workgroup_size), (shader.name, [size, 1, 1]));
    }
}

/// Returns whether the entry point divides.
fn divides(shader: &Shader) -> bool {
    let module = parsed(shader);
    let mut expressions = module.entry_points[0].function.expressions.iter();
    expressions.any(|(_, e)| matches!(e, naga::Expression::Binary { op: naga::BinaryOperator::Divide, .. }))
}

/// WGSL promises a division to 2.5 units in the last place only, and less than that takes a
/// quantised reading to another step: the host divides.
#[test]
fn no_reading_hangs_on_a_division() {
    let simulate = simulate(false, laws());
    assert!(!divides(&simulate));
    let (product, quotient) = ("(opaque(felt, zero) + error) * steps", "(felt + error) / max(lsb, 1e-30)");
    assert!(simulate.text.contains(product));
    assert!(divides(&Shader { name: "divided", text: simulate.text.replace(product, quotient) }));
}

/// A constant of a shader as the host knows it.
fn has(shader: &Shader, name: &str, value: &str) {
    let line = format!("const {name} = {value};");
    assert!(shader.text.lines().any(|l| l == line), "{}: no {line}", shader.name);
}

#[test]
fn columns_and_bounds_agree() {
    let simulate = simulate(false, laws());
    assert!(simulate.text.contains(&format!("array<vec4<f32>, {}>", layout::FORCES)));
    assert!(source::navigate(false).text.contains(&format!("array<vec4<f32>, {}>", layout::PASSAGES)));
    let reduce = source::reduce();
    has(&reduce, "WORKGROUP", &format!("{}u", layout::REDUCE_WORKGROUP));
    has(&reduce, "EACH", &format!("{}u", layout::BLOCK / layout::REDUCE_WORKGROUP));
}

/// Returns whether the shader's text uses a name beyond declaring it.
fn uses(shader: &Shader, name: &str) -> bool {
    let word = |c: char| c.is_alphanumeric() || c == '_';
    shader.text.split(|c| !word(c)).filter(|w| *w == name).count() > 1
}

/// Each term's column and switch are declared once and used, so that a row that no law absorbs is
/// noticed; a number of a term's shape by its place behind the term's, or as turns.
#[test]
fn every_sensor_term_is_taken_up_by_the_shader() {
    let simulate = simulate(false, laws());
    let left = |line: &str| line.starts_with("#terms") || line.contains('$');
    assert!(!simulate.text.lines().any(left), "a line was not replaced");
    let module = parsed(&simulate);
    for term in SensorTerm::ALL {
        let switch = source::terms::switch(term);
        assert!(module.overrides.iter().any(|(_, o)| o.name.as_deref() == Some(&switch)), "{switch}");
        let before = SensorTerm::ALL.into_iter().take(term as usize).rfind(|other| !other.is_shape());
        let of = source::terms::name(before.filter(|_| term.is_shape()).unwrap_or(term));
        let taken_up = match term.law() {
            ErrorLaw::Shape(Shape::Memory | Shape::Settling) => {
                simulate.text.contains(&format!("column(i, NEXT_TO_{of})"))
            }
            ErrorLaw::Shape(Shape::Frequency | Shape::Phase) => uses(&simulate, &format!("TURNS_{of}")),
            // What they do stands behind their switch.
            ErrorLaw::LowPass | ErrorLaw::Delay => uses(&simulate, &switch),
            _ => uses(&simulate, &of),
        };
        assert!(taken_up, "{term:?} is in no one's hands");
    }
    let without = Shader { name: "without", text: simulate.text.replace("column(i, GYRO_BIAS)", "0.0") };
    assert!(!uses(&without, "GYRO_BIAS"));
}

/// A law that no member follows is not in the text; each that acts is, and adds to the sum.
#[test]
fn a_shader_holds_the_laws_that_act_and_no_other() {
    for law in laws() {
        let with = simulate(false, std::slice::from_ref(law));
        drop(parsed(&with));
        let name = source::laws::function(law);
        assert!(uses(&with, &name), "{name}");
        assert!(!uses(&simulate(false, &[]), &name), "{name} is in a shader of linear masses");
    }
    drop(parsed(&simulate(false, &[])));
}

/// States of laws' own are in a shader with such a law, and leave no trace in one without.
#[test]
fn a_shader_holds_states_only_of_laws_that_have_them() {
    let (with, without): (Vec<StudyLaw>, Vec<StudyLaw>) = laws().iter().copied().partition(StudyLaw::has_states);
    assert_eq!(with.len(), 3);
    let [with, without] = [simulate(false, &with), simulate(false, &without)];
    let places = |states: usize| format!("const STATE_TERMS = {}u;", layout::state::TERMS + states);
    assert!(with.text.contains("struct Own") && with.text.contains(&places(5)));
    assert!(!without.text.contains("Own") && !without.text.contains("_own(") && without.text.contains(&places(0)));
    assert!(!with.text.lines().any(|line| line.trim().starts_with("#own")));
}
