//! A self-contained page: title, lede, sections of prose, tables and inline figures.
//!
//! It loads nothing: its one style and its one script, which makes figures answer, stand in it and
//! are the only ones that its content security policy allows, by their digests. Without the script
//! the figures stand as they were drawn.

use std::collections::HashSet;

use base64::Engine as _;
use sha2::{Digest, Sha256};

use super::figure::theme;
use super::figure::{Figure, Numbers};
use super::table::Table;
use proofmass_base::escape::html;

/// A page being written, top to bottom.
#[derive(Debug, Clone)]
pub struct Page {
    title: String,
    contents: Vec<(String, String)>,
    body: String,
    prefix: String,
    numbers: Vec<Numbers>,
}

impl Page {
    /// A page that opens with its title and the answer in a sentence or two.
    pub fn new(title: &str, lede: &str) -> Self {
        let body = format!("<header><h1>{}</h1><p class=\"lede\">{}</p></header>\n", html(title), html(lede));
        Self { title: title.into(), contents: Vec::new(), body, prefix: String::new(), numbers: Vec::new() }
    }

    /// From here on, the names of the figures' numbers begin so.
    pub fn prefix(&mut self, prefix: String) {
        self.prefix = prefix;
    }

    /// The numbers behind its figures, no two of one name.
    pub fn numbers(&self) -> Vec<Numbers> {
        let mut taken = HashSet::new();
        let unique = |numbers: &Numbers| {
            let mut names = std::iter::once(numbers.name.clone()).chain((2..).map(|n| format!("{}-{n}", numbers.name)));
            let name = names.find(|name| taken.insert(name.to_lowercase())).unwrap_or_default();
            Numbers { name, columns: numbers.columns.clone() }
        };
        self.numbers.iter().map(unique).collect()
    }

    /// Begins a section; it also appears in the contents when there are four or more.
    pub fn section(&mut self, heading: &str) {
        let id = format!("s{}", self.contents.len() + 1);
        self.body += &format!("<h2 id=\"{id}\">{}</h2>\n", html(heading));
        self.contents.push((id, heading.into()));
    }

    /// Adds a heading one level below a section.
    pub fn subsection(&mut self, heading: &str) {
        self.body += &format!("<h3>{}</h3>\n", html(heading));
    }

    /// A paragraph of plain text.
    pub fn paragraph(&mut self, text: &str) {
        self.body += &format!("<p>{}</p>\n", html(text));
    }

    /// A paragraph set apart: a verdict, a warning, a hint.
    pub fn callout(&mut self, text: &str) {
        self.body += &format!("<p class=\"callout\">{}</p>\n", html(text));
    }

    /// A bulleted list of plain sentences.
    pub fn list<S: AsRef<str>>(&mut self, items: &[S]) {
        let items: String = items.iter().map(|i| format!("<li>{}</li>", html(i.as_ref()))).collect();
        self.body += &format!("<ul>{items}</ul>\n");
    }

    /// Text in its own line breaks, e.g. TOML.
    pub fn preformatted(&mut self, text: &str) {
        self.body += &format!("<pre>{}</pre>\n", html(text));
    }

    /// Adds a table.
    pub fn table(&mut self, table: &Table) {
        self.body += &table.to_html();
    }

    /// A figure with its caption.
    pub fn figure(&mut self, figure: &Figure, caption: &str) {
        let named = |n: &Numbers| Numbers { name: format!("{}{}", self.prefix, n.name), columns: n.columns.clone() };
        self.numbers.extend(figure.numbers().iter().map(named));
        self.body += &format!("<figure>{}<figcaption>{}</figcaption></figure>\n", figure.inline(), html(caption));
    }

    /// Two or more figures side by side where the screen is wide enough.
    pub fn figure_row(&mut self, figures: &[(&Figure, &str)]) {
        self.body += "<div class=\"row\">";
        for (figure, caption) in figures {
            self.figure(figure, caption);
        }
        self.body += "</div>\n";
    }

    /// Adds another page as a section: its lede opens it, its headings stand one level lower, and the names of
    /// its figures' numbers begin with `prefix`.
    pub fn chapter(&mut self, heading: &str, prefix: &str, other: Self) {
        self.section(heading);
        let (head, body) = other.body.split_once("</header>\n").unwrap_or(("", &other.body));
        let lede = head.split_once("</h1>").map_or("", |(_, lede)| lede);
        self.body += lede;
        // Deepest first, so that none is lowered twice.
        let lower = body.replace("<h3>", "<h4>").replace("</h3>", "</h4>").replace("</h2>", "</h3>");
        let mut parts = lower.split("<h2 id=\"");
        self.body += parts.next().unwrap_or_default();
        for part in parts {
            // A section of a chapter is not in the contents, and two chapters would share its name.
            self.body += &format!("<h3>{}", part.split_once('>').map_or(part, |(_, rest)| rest));
        }
        let named = |n: Numbers| Numbers { name: format!("{}{prefix}{}", self.prefix, n.name), columns: n.columns };
        self.numbers.extend(other.numbers.into_iter().map(named));
    }

    /// The page as a self-contained HTML document.
    pub fn finish(self) -> String {
        let contents = if self.contents.len() < 4 {
            String::new()
        } else {
            let items: String =
                self.contents.iter().map(|(id, h)| format!("<li><a href=\"#{id}\">{}</a></li>", html(h))).collect();
            format!("<nav><ol>{items}</ol></nav>\n")
        };
        // What a page opens with, before its first heading, is its answer: the contents come after
        // it.
        let body = match self.body.split_once("<h2 ") {
            Some((opening, rest)) => format!("{opening}{contents}<h2 {rest}"),
            None => self.body,
        };
        let style = format!("{}{PAGE_CSS}", theme::css());
        let (allowed, script) = match body.contains("<figure>") {
            true => (digest(FIGURE_JS), format!("<script>{FIGURE_JS}</script>\n")),
            false => ("'none'".to_owned(), String::new()),
        };
        let policy = format!(
            "default-src 'none'; style-src {}; script-src {allowed}; img-src data:; base-uri 'none'; form-action 'none'",
            digest(&style)
        );
        format!(
            "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
             <meta name=\"color-scheme\" content=\"light dark\">\
             <title>{}</title><style>{style}</style></head><body>\n{body}{script}</body></html>\n",
            html(&self.title),
        )
    }
}

/// Names a text as a content security policy that allows it does.
fn digest(text: &str) -> String {
    format!("'sha256-{}'", base64::engine::general_purpose::STANDARD.encode(Sha256::digest(text.as_bytes())))
}

const PAGE_CSS: &str = include_str!("html/page.css");
const FIGURE_JS: &str =
    concat!(include_str!("html/axis.js"), include_str!("html/readout.js"), include_str!("html/figure.js"));
