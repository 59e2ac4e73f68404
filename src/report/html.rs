//! A self-contained page: title, lede, sections of prose, tables and inline figures. No script, no external load.

use super::figure::Figure;
use super::figure::theme;
use super::table::Table;
use crate::escape::html;

/// A page being written, top to bottom.
#[derive(Debug, Clone)]
pub struct Page {
    title: String,
    contents: Vec<(String, String)>,
    body: String,
}

impl Page {
    /// A page that opens with its title and the answer in a sentence or two.
    pub fn new(title: &str, lede: &str) -> Self {
        let body = format!("<header><h1>{}</h1><p class=\"lede\">{}</p></header>\n", html(title), html(lede));
        Self { title: title.into(), contents: Vec::new(), body }
    }

    /// Begins a section; it also appears in the contents when there are four or more.
    pub fn section(&mut self, heading: &str) {
        let id = format!("s{}", self.contents.len() + 1);
        self.body += &format!("<h2 id=\"{id}\">{}</h2>\n", html(heading));
        self.contents.push((id, heading.into()));
    }

    /// A smaller heading.
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

    /// A table.
    pub fn table(&mut self, table: &Table) {
        self.body += &table.to_html();
    }

    /// A figure with its caption.
    pub fn figure(&mut self, figure: &Figure, caption: &str) {
        self.body += &format!("<figure>{}<figcaption>{}</figcaption></figure>\n", figure.inline_svg(), html(caption));
    }

    /// Two or more figures side by side where the screen is wide enough.
    pub fn figure_row(&mut self, figures: &[(&Figure, &str)]) {
        self.body += "<div class=\"row\">";
        for (figure, caption) in figures {
            self.figure(figure, caption);
        }
        self.body += "</div>\n";
    }

    /// The finished document.
    pub fn finish(self) -> String {
        let contents = if self.contents.len() < 4 {
            String::new()
        } else {
            let items: String =
                self.contents.iter().map(|(id, h)| format!("<li><a href=\"#{id}\">{}</a></li>", html(h))).collect();
            format!("<nav><ol>{items}</ol></nav>\n")
        };
        // What a page opens with, before its first heading, is its answer: the contents come after it.
        let body = match self.body.split_once("<h2 ") {
            Some((opening, rest)) => format!("{opening}{contents}<h2 {rest}"),
            None => self.body,
        };
        format!(
            "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
             <meta name=\"color-scheme\" content=\"light dark\">\
             <title>{}</title><style>{}{}</style></head><body>\n{body}</body></html>\n",
            html(&self.title),
            theme::css(),
            PAGE_CSS
        )
    }
}

const PAGE_CSS: &str = "
body{font:16px/1.55 system-ui,-apple-system,'Segoe UI',sans-serif;max-width:60rem;margin:0 auto;padding:1.2rem;\
background:var(--paper);color:var(--ink);overflow-wrap:break-word}
h1{font-size:1.7rem;line-height:1.2;margin:.6rem 0}h2{margin:2.2rem 0 .4rem;font-size:1.3rem;border-bottom:1px solid var(--grid)}
h3{margin:1.4rem 0 .3rem;font-size:1.05rem}
.lede{font-size:1.15rem}.callout{border-left:4px solid var(--c1);padding:.4rem .9rem;background:var(--tint)}
figure{margin:1rem 0;min-width:0}figure svg{display:block;width:100%;height:auto;max-width:40rem;margin:0 auto}
figcaption{font-size:.9rem;color:var(--soft);max-width:40rem;margin:.3rem auto 0}
.row{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(26rem,100%),1fr));gap:0 1.2rem}
.scroll{overflow-x:auto;margin:.8rem 0}table{border-collapse:collapse;font-size:.92rem;font-variant-numeric:tabular-nums}
th,td{padding:.25rem .7rem;text-align:left;border-bottom:1px solid var(--grid);vertical-align:top}
td:first-child{min-width:6.6rem}td.w{min-width:11rem}th{color:var(--soft);font-weight:600}td.n,th.n{text-align:right}td.n{white-space:nowrap}
pre{background:var(--tint);padding:.7rem;overflow-x:auto;font-size:.85rem}a{color:var(--c1)}
nav ol{columns:2 16rem;column-gap:2.5rem;font-size:.95rem}
@media print{body{max-width:none}h2{break-after:avoid}figure{break-inside:avoid}}
";
