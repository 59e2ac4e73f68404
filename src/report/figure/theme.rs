//! Colours by role, for light and dark, and the style of figures.
//!
//! Series colours begin at Okabe & Ito's set and are moved as little as it takes for any two, text
//! and guides included, to differ by 11 (CIEDE2000) for readers with and without colour-blindness
//! (Machado 2009), with a contrast of 3 : 1 to the paper: `tests/suite/colours.rs` keeps this true.

/// Role of a colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ink {
    /// Blue, for the first series.
    Blue,
    /// Vermilion, for the second series.
    Red,
    /// Bluish green, for the third series.
    Green,
    /// Purple, for the fourth series.
    Purple,
    /// Orange, for the fifth series.
    Orange,
    /// Sky blue, for the sixth series.
    Sky,
    /// Text and the main reference line.
    Black,
    /// Guides and secondary text.
    Soft,
    /// Grid lines behind the data.
    Grid,
}

const ROLES: [(Ink, &str, &str, &str); 9] = [
    (Ink::Blue, "c1", "#0774CF", "#4CA8F0"),
    (Ink::Red, "c2", "#B54809", "#F0834A"),
    (Ink::Green, "c3", "#078B65", "#38CA9E"),
    (Ink::Purple, "c4", "#B35B94", "#C673B8"),
    (Ink::Orange, "c5", "#BE8100", "#F9BE2D"),
    (Ink::Sky, "c6", "#089DD2", "#B5E0FF"),
    (Ink::Black, "ink", "#1A1C1F", "#E6E8EB"),
    (Ink::Soft, "soft", "#5F666D", "#A3ABB3"),
    (Ink::Grid, "grid", "#DDE1E4", "#3A4047"),
];

impl Ink {
    /// The first six inks in order, for series made in a loop.
    pub fn nth(n: usize) -> Ink {
        ROLES[n % 6].0
    }

    /// The name of its classes and variables: `f-…` fills, `s-…` strokes, `b-…` colours a swatch.
    pub(super) fn class(self) -> &'static str {
        ROLES.iter().find(|r| r.0 == self).map_or("ink", |r| r.1)
    }
}

/// The style sheet: variables for both settings, and one class per role for fills and strokes.
pub fn css() -> String {
    let variables = |pick: fn(&(Ink, &'static str, &'static str, &'static str)) -> &'static str| -> String {
        ROLES.iter().map(|r| format!("--{}:{};", r.1, pick(r))).collect()
    };
    let classes: String = ROLES
        .iter()
        .map(|r| format!(".f-{0}{{fill:var(--{0})}}.s-{0}{{stroke:var(--{0})}}.b-{0}{{color:var(--{0})}}", r.1))
        .collect();
    format!(
        ":root{{{}--paper:#FFFFFF;--tint:#F3F5F7}}@media(prefers-color-scheme:dark){{:root{{{}--paper:#14171A;--tint:#20252A}}}}{classes}{MARKS}",
        variables(|r| r.2),
        variables(|r| r.3)
    )
}

/// Marks and text of a figure, in a page and in a file. Lines keep their width however a plot is
/// stretched.
const MARKS: &str = "
.line,.dashed,.dots{fill:none;vector-effect:non-scaling-stroke;stroke-linejoin:round}.line,.dashed{stroke-width:1.8}.dots{stroke-linecap:round}.dashed{stroke-dasharray:7 5}
.band{opacity:.32}.bars{opacity:.5}.cells{image-rendering:pixelated}.f-tint{fill:var(--tint)}
svg text{fill:var(--ink);font:12px system-ui,-apple-system,'Segoe UI',sans-serif}svg text.title{font-size:16px;font-weight:600}svg text.block{font-size:15px}svg text.chief{font-weight:600}
svg .x{text-anchor:middle}svg .y,svg .end{text-anchor:end}svg .narrow{display:none}
.grid line{stroke:var(--grid);shape-rendering:crispEdges}.frame{fill:none;stroke:var(--soft);shape-rendering:crispEdges}
";
