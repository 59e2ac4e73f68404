//! States of the laws' own in the stages of a step, as WGSL; twin of `cpu::law_lanes`, which says
//! what is kept.
//!
//! The shaders have lines `#own WHERE`; each is replaced by what the states take up there, and by
//! nothing where no law has any. Their text is in none of the others.

use super::laws::function;
use crate::layout::state;
use crate::physics::coefficients::StudyLaw;
use crate::physics::law::Role;

/// Texts at the lines `#own …`.
const LINES: [(&str, &str); 7] = [
    ("#own load", "    load_own(i);"),
    ("#own stage 1", "    sums = Own();\n    begin_own(laws, 0.0, 0.0, f.begin);"),
    ("#own stage 2", "    sum_own(1.0);\n    begin_own(laws, 0.5, f.to_middle, f.middle);"),
    ("#own stage 3", "    sum_own(2.0);\n    begin_own(laws, 0.5, f.to_middle, f.middle);"),
    ("#own stage 4", "    sum_own(2.0);\n    begin_own(laws, 1.0, f.to_end, f.end);"),
    ("#own finish", "    sum_own(1.0);\n    finish_own(laws, f.to_end);"),
    ("#own keep", "    keep_own(i);"),
];

/// A shader's text with each line `#own WHERE` replaced. An unknown WHERE stays, and no shader with
/// it compiles.
pub(super) fn expand(text: &str, laws: &[StudyLaw]) -> String {
    let any = laws.iter().any(StudyLaw::has_states);
    let line = |line: &str| match LINES.iter().find(|(name, _)| *name == line) {
        Some((_, own)) => format!("{}\n", if any { own } else { "" }),
        None => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}

/// A law's states: their name, how many, and their places.
struct Staged<'a> {
    law: &'a StudyLaw,
    name: String,
    first: usize,
}

impl Staged<'_> {
    /// A number, or a vector of two.
    fn kind(&self) -> &'static str {
        if self.law.term.states() == 1 { "f32" } else { "vec2<f32>" }
    }

    /// Returns the place of a state of this member.
    fn place(&self, s: usize) -> String {
        format!("state[{}u * tile.stride + i]", self.first + s)
    }

    /// One of its states in a variable of all of them.
    fn one(&self, of: &str, s: usize) -> String {
        let part = match self.law.term.states() {
            1 => "",
            _ => [".x", ".y"][s.min(1)],
        };
        format!("{of}.{}{part}", self.name)
    }

    /// For each of its states a line.
    fn each(&self, line: impl Fn(usize) -> String) -> String {
        (0..self.law.term.states()).map(|s| format!("    {};\n", line(s))).collect()
    }

    /// Its states at the beginning of a step, as they rest under the force's growth.
    fn begun(&self, s: usize) -> String {
        let own = self.one("own", s);
        if s > 0 { own } else { format!("fma(-laws.{}_rest, growth, {own})", self.name) }
    }
}

/// The states with their functions, and `seen`: what is read of a mass, as error and rate.
pub(super) fn text(laws: &[StudyLaw]) -> String {
    let mut first = state::TERMS;
    let mut all = Vec::new();
    for law in laws.iter().filter(|law| law.has_states()) {
        all.push(Staged { law, name: function(law), first });
        first += law.term.states();
    }
    let of_all = |line: &dyn Fn(&Staged<'_>) -> String| all.iter().map(line).collect::<String>();
    let seen = of_all(&|own| match own.law.term.role() {
        Role::Mode => {
            let name = &own.name;
            format!("    seen += vec2<f32>(fma(laws.{name}_rest, input, own.{name}.x), own.{name}.y);\n")
        }
        _ => String::new(),
    });
    let mut text = format!(
        "fn seen(laws: Laws, s: vec2<f32>, input: f32) -> vec2<f32> {{\n    var seen = s;\n{seen}    return seen;\n}}\n"
    );
    if all.is_empty() {
        return text;
    }
    let fields = of_all(&|own| format!("    {}: {},\n", own.name, own.kind()));
    let load = of_all(&|own| own.each(|s| format!("{} = {}", own.one("own", s), own.place(s))));
    let keep = of_all(&|own| own.each(|s| format!("{} = {}", own.place(s), own.one("own", s))));
    let begin = of_all(&|own| {
        let moved =
            own.each(|s| format!("{} = fma(share, {}, {})", own.one("here", s), own.one("rates", s), own.begun(s)));
        let here = own.one("here", 0);
        moved + &format!("    {here} = fma(laws.{}_rest, input, {here});\n", own.name)
    });
    let sum = of_all(&|own| {
        own.each(|s| {
            let sums = own.one("sums", s);
            format!("{sums} = fma(weight, {}, {sums})", own.one("rates", s))
        })
    });
    let finish = of_all(&|own| {
        own.each(|s| format!("{} = fma(1.0 / 6.0, {}, {})", own.one("own", s), own.one("sums", s), own.begun(s)))
    });
    text += &format!("struct Own {{\n{fields}}}\n");
    for variable in ["own", "here", "rates", "sums"] {
        text += &format!("var<private> {variable}: Own;\n");
    }
    for (name, arguments, body) in [
        ("load_own", "i: u32", load),
        ("keep_own", "i: u32", keep),
        ("begin_own", "laws: Laws, share: f32, growth: f32, input: f32", begin),
        ("sum_own", "weight: f32", sum),
        ("finish_own", "laws: Laws, growth: f32", finish),
    ] {
        text += &format!("fn {name}({arguments}) {{\n{body}}}\n");
    }
    text
}
