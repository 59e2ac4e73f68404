//! Colours by role, for light and dark. Drawn colours are placeholders; the style sheet decides what the reader sees.
//!
//! Series colours are Okabe & Ito's set (distinguishable with colour-blindness), lightened on dark.

use plotters::style::RGBColor;

/// What a colour is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ink {
    /// First series: blue.
    Blue,
    /// Second: vermilion.
    Red,
    /// Third: bluish green.
    Green,
    /// Fourth: purple.
    Purple,
    /// Fifth: orange.
    Orange,
    /// Sixth: sky blue.
    Sky,
    /// Text and the main reference line.
    Black,
    /// Guides and secondary text.
    Soft,
    /// Grid lines.
    Grid,
}

/// Name, light, dark.
const ROLES: [(Ink, &str, &str, &str); 9] = [
    (Ink::Blue, "c1", "#0072B2", "#56A8E8"),
    (Ink::Red, "c2", "#C84E00", "#FF8A4C"),
    (Ink::Green, "c3", "#008A64", "#3CCB9F"),
    (Ink::Purple, "c4", "#A8518A", "#E08CC3"),
    (Ink::Orange, "c5", "#B87F00", "#E8B43C"),
    (Ink::Sky, "c6", "#3DAADF", "#B8E3FF"),
    (Ink::Black, "ink", "#1A1C1F", "#E6E8EB"),
    (Ink::Soft, "soft", "#5F666D", "#A3ABB3"),
    (Ink::Grid, "grid", "#DDE1E4", "#3A4047"),
];

impl Ink {
    /// The first six inks in order, for series made in a loop.
    pub fn nth(n: usize) -> Ink {
        ROLES[n % 6].0
    }

    pub(super) fn rgb(self) -> RGBColor {
        let hex = ROLES.iter().find(|r| r.0 == self).map_or("#000000", |r| r.2);
        let part = |i: usize| u8::from_str_radix(&hex[i..i + 2], 16).unwrap_or(0);
        RGBColor(part(1), part(3), part(5))
    }
}

/// The style sheet: variables for both settings, and one class per role for fills and strokes.
pub fn css() -> String {
    let variables = |pick: fn(&(Ink, &'static str, &'static str, &'static str)) -> &'static str| -> String {
        ROLES.iter().map(|r| format!("--{}:{};", r.1, pick(r))).collect()
    };
    let classes: String =
        ROLES.iter().map(|r| format!(".f-{0}{{fill:var(--{0})}}.s-{0}{{stroke:var(--{0})}}", r.1)).collect();
    format!(
        ":root{{{}--paper:#FFFFFF;--tint:#F3F5F7}}@media(prefers-color-scheme:dark){{:root{{{}--paper:#14171A;--tint:#20252A}}}}{classes}",
        variables(|r| r.2),
        variables(|r| r.3)
    )
}

/// Gives every element drawn in a role's colour that role's class, so that the style sheet can recolour it.
pub(super) fn classify(svg: &str) -> String {
    let mut out = String::with_capacity(svg.len() + svg.len() / 8);
    for tag in svg.split_inclusive('>') {
        let classes: Vec<String> = ROLES
            .iter()
            .flat_map(|r| [("fill", "f"), ("stroke", "s")].map(|(attribute, prefix)| (r, attribute, prefix)))
            .filter(|(r, attribute, _)| tag.contains(&format!("{attribute}=\"{}\"", r.2)))
            .map(|(r, _, prefix)| format!("{prefix}-{}", r.1))
            .collect();
        match (tag.find('<'), classes.is_empty()) {
            (Some(start), false) => {
                let name_end = tag[start..].find(' ').map_or(tag.len(), |e| start + e);
                out += &tag[..name_end];
                out += &format!(" class=\"{}\"", classes.join(" "));
                out += &tag[name_end..];
            }
            _ => out += tag,
        }
    }
    out
}
