//! Which names the files under `src/` take from one another, by their tokens.
//!
//! A name belongs to the file that defines it, however it is reached: `use` lists, `super::`,
//! `self::`, an inline path, or a re-export elsewhere. `mod` lines and re-exports take nothing
//! themselves, and test code may name anything.
//!
//! Modules are addressed as the facade re-exports them, whatever crate holds them: `recording::clock`
//! is `src/recording/clock.rs`, and `units::key` is `src/base/units/key.rs`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// Crates that hold several modules of the facade; every other crate is one.
pub const GROUPS: [&str; 4] = ["base", "numerics", "scenario", "simulate"];

/// Ending of the name by which the root of a group is addressed.
pub const ROOT: &str = " (crate)";

/// A module's path from the facade's root, e.g. `["recording", "clock"]`; empty for `src/lib.rs`.
pub type Module = Vec<String>;

/// One name that a file takes from another.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Taken {
    /// The file that takes it.
    pub by: Module,
    /// The file that defines it.
    pub from: Module,
    /// The name.
    pub name: String,
}

/// A path as written, and the module (an inline one, perhaps) in which it stands.
#[derive(Debug)]
struct Written {
    scope: Module,
    path: Vec<String>,
}

/// One name of a `use`.
#[derive(Debug)]
struct Use {
    written: Written,
    /// The name that it has here; `*` for all.
    alias: String,
    public: bool,
}

/// What one file defines and names.
#[derive(Debug, Default)]
struct File {
    defined: BTreeSet<String>,
    children: BTreeSet<String>,
    uses: Vec<Use>,
    paths: Vec<Written>,
}

/// All files of a crate.
#[derive(Debug, Default)]
pub struct Imports {
    files: BTreeMap<Module, File>,
    /// Modules that are crates.
    crates: BTreeSet<String>,
}

impl Imports {
    /// Reads files, each by its path below the crate (`src/a/b.rs`) and its text.
    ///
    /// # Errors
    /// Text that is not Rust.
    pub fn read(sources: &[(PathBuf, String)]) -> Result<Self, String> {
        let mut files = BTreeMap::new();
        let roots = sources.iter().filter(|(path, _)| path.ends_with("lib.rs")).map(|(path, _)| module_of(path));
        let crates = roots.filter_map(|root| root.into_iter().next()).collect();
        for (path, text) in sources {
            let tokens = TokenStream::from_str(text).map_err(|e| format!("{}: {e}", path.display()))?;
            let module = module_of(path);
            let mut file = File::default();
            file.read(tokens, &module, true);
            files.insert(module, file);
        }
        Ok(Self { files, crates })
    }

    /// Every name that a file takes from another, once.
    pub fn taken(&self) -> BTreeSet<Taken> {
        let mut all = BTreeSet::new();
        for (module, file) in &self.files {
            let used = file.uses.iter().filter(|u| !u.public).map(|u| (&u.written, u.alias == "*"));
            for (written, everything) in used.chain(file.paths.iter().map(|p| (p, false))) {
                let Some(path) = self.absolute(file, written) else { continue };
                let Some((from, mut name)) = self.of_same_name(&path).or_else(|| self.defining(&path, 0)) else {
                    continue;
                };
                if everything && name.is_empty() {
                    name = "*".to_owned();
                }
                // The name of a module alone takes nothing yet.
                if from != *module && !name.is_empty() {
                    all.insert(Taken { by: module.clone(), from, name });
                }
            }
        }
        all
    }

    /// What a module passes on under the name of one of its children, e.g. by
    /// `pub use document::document`.
    fn of_same_name(&self, path: &[String]) -> Option<(Module, String)> {
        let (name, parent) = path.split_last()?;
        let file = self.files.get(parent).filter(|_| self.is_module(path))?;
        let passed_on = file.uses.iter().find(|u| u.public && u.alias == *name)?;
        self.defining(&self.absolute(file, &passed_on.written)?, 1)
    }

    /// First segments of all paths in a file that do not lead into this crate: the crates that it
    /// names.
    pub fn foreign(&self, path: &Path) -> BTreeSet<&str> {
        let Some(file) = self.files.get(&module_of(path)) else { return BTreeSet::new() };
        let all = file.uses.iter().map(|u| &u.written).chain(&file.paths);
        all.filter(|w| self.absolute(file, w).is_none()).filter_map(|w| w.path.first().map(String::as_str)).collect()
    }

    /// Modules that stand directly below one.
    pub fn children(&self, module: &[String]) -> BTreeSet<String> {
        self.files.get(module).map(|f| f.children.clone()).unwrap_or_default()
    }

    /// All modules that are files.
    pub fn modules(&self) -> impl Iterator<Item = &Module> {
        self.files.keys()
    }

    /// From the crate's root; `None` where it leads into another crate.
    fn absolute(&self, file: &File, written: &Written) -> Option<Vec<String>> {
        let Written { scope, path } = written;
        let (first, rest) = path.split_first()?;
        match first.as_str() {
            "proofmass" => Some(rest.to_vec()),
            "crate" => Some(self.in_crate(scope, rest)),
            "self" => Some([scope.as_slice(), rest].concat()),
            "super" => {
                let up = path.iter().take_while(|s| *s == "super").count();
                let outer = scope.len().saturating_sub(up);
                Some([&scope[..outer], &path[up..]].concat())
            }
            other if other.starts_with("proofmass_") => {
                let name = other.trim_start_matches("proofmass_");
                let is_elsewhere = GROUPS.contains(&name) || rest.first().is_some_and(|r| *r == "dynamics");
                let root = if is_elsewhere { Vec::new() } else { vec![name.to_owned()] };
                Some([root.as_slice(), rest].concat())
            }
            _ if self.is_module(&[scope.as_slice(), std::slice::from_ref(first)].concat()) => {
                Some([scope.as_slice(), path].concat())
            }
            _ => {
                let imported = file.uses.iter().find(|u| u.alias == *first && u.written.path.first() != Some(first))?;
                let mut whole = self.absolute(file, &imported.written)?;
                whole.extend_from_slice(rest);
                Some(whole)
            }
        }
    }

    /// A path from the root of the crate of `scope`. Where the crate is one module, what it does not
    /// hold itself is a crate below, under the name that the root gives it.
    fn in_crate(&self, scope: &[String], rest: &[String]) -> Vec<String> {
        let own = [&scope[..scope.len().min(1)], rest].concat();
        let is_below = rest.first().is_none_or(|first| self.is_module(std::slice::from_ref(first)));
        let is_own = own.len() > 1 && self.is_module(&own[..2]);
        let is_crate = scope.first().is_some_and(|top| self.crates.contains(top));
        if is_crate && (is_own || !is_below) { own } else { rest.to_vec() }
    }

    fn is_module(&self, path: &[String]) -> bool {
        self.files.contains_key(path)
    }

    /// The file that defines a name, and the name; an empty name for a module itself.
    fn defining(&self, path: &[String], depth: usize) -> Option<(Module, String)> {
        let length = (0..=path.len()).rev().find(|n| self.is_module(&path[..*n]))?;
        let (module, rest) = path.split_at(length);
        let Some(name) = rest.first() else { return Some((module.to_vec(), String::new())) };
        let file = &self.files[module];
        if file.defined.contains(name) || depth > 16 {
            return Some((module.to_vec(), name.clone()));
        }
        let through = |u: &Use, rest: &[String]| {
            let mut whole = self.absolute(file, &u.written)?;
            whole.extend_from_slice(rest);
            self.defining(&whole, depth + 1)
        };
        if let Some(passed_on) = file.uses.iter().find(|u| u.alias == *name) {
            return through(passed_on, &rest[1..]);
        }
        let of_all = file.uses.iter().filter(|u| u.alias == "*").filter_map(|u| through(u, rest));
        let found = of_all.into_iter().find(|(m, n)| self.files.get(m).is_some_and(|f| f.defined.contains(n)));
        Some(found.unwrap_or_else(|| (module.to_vec(), name.clone())))
    }
}

/// The module that a file is.
pub fn module_of(path: &Path) -> Module {
    let below = path.strip_prefix("src").unwrap_or(path).with_extension("");
    let mut module: Module = below.components().map(|c| c.as_os_str().to_string_lossy().into_owned()).collect();
    if module.last().is_some_and(|last| last == "lib" || last == "mod") {
        module.pop();
    }
    // The root of a group only lists its modules, one of which may have its name.
    if let [group] = module.as_slice()
        && path.ends_with("lib.rs")
        && GROUPS.contains(&group.as_str())
    {
        return vec![format!("{group}{ROOT}")];
    }
    let is_elsewhere =
        |first: &str, second: &str| GROUPS.contains(&first) || (first, second) == ("physics", "dynamics");
    if module.len() > 1 && is_elsewhere(&module[0], &module[1]) {
        module.remove(0);
    }
    module
}

/// Words that define the name after them.
const DEFINES: [&str; 10] = ["fn", "struct", "enum", "union", "trait", "type", "const", "static", "mod", "macro_rules"];

impl File {
    /// Reads the tokens of a block; only those of a whole module define names for others.
    fn read(&mut self, tokens: TokenStream, scope: &[String], is_module: bool) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let (mut i, mut public) = (0, false);
        while i < tokens.len() {
            let rest = &tokens[i..];
            let mut stays_public = false;
            i += match &tokens[i] {
                TokenTree::Punct(p) if p.as_char() == '#' => match attribute(rest) {
                    Some((length, true)) => length + item(&rest[length..]),
                    Some((length, false)) => length,
                    None => 1,
                },
                TokenTree::Group(group) => {
                    self.read(group.stream(), scope, false);
                    1
                }
                TokenTree::Ident(word) if word == "pub" => {
                    stays_public = true;
                    1 + usize::from(group(rest.get(1), Delimiter::Parenthesis).is_some())
                }
                TokenTree::Ident(word) if word == "use" => {
                    let end = rest.iter().position(|t| is_punct(t, ';')).unwrap_or(rest.len());
                    self.uses.extend(tree(&rest[1..end], &[]).into_iter().map(|(path, alias)| Use {
                        written: Written { scope: scope.to_vec(), path },
                        alias,
                        public,
                    }));
                    end + 1
                }
                TokenTree::Ident(word) => {
                    let defines = DEFINES.iter().any(|d| word == d);
                    let after = rest.iter().skip(1).find(|t| !is_punct(t, '!'));
                    if let (true, Some(TokenTree::Ident(name))) = (defines, after) {
                        self.define(&word.to_string(), &name.to_string(), rest, scope, is_module)
                    } else {
                        self.path(rest, scope)
                    }
                }
                _ => 1,
            };
            public = stays_public;
        }
    }

    /// A definition; how many tokens it takes before its body.
    fn define(&mut self, word: &str, name: &str, rest: &[TokenTree], scope: &[String], is_module: bool) -> usize {
        if name == "fn" {
            return 1;
        }
        if is_module {
            self.defined.insert(name.to_owned());
        }
        if word != "mod" {
            return 2;
        }
        match group(rest.get(2), Delimiter::Brace) {
            Some(body) => {
                self.read(body, &[scope, &[name.to_owned()]].concat(), is_module);
                3
            }
            None => {
                self.defined.remove(name);
                self.children.insert(name.to_owned());
                2
            }
        }
    }

    /// A path in code, `a::b::c`; how many tokens it takes.
    fn path(&mut self, rest: &[TokenTree], scope: &[String]) -> usize {
        let (mut path, mut length) = (vec![rest[0].to_string()], 1);
        while let [TokenTree::Punct(a), TokenTree::Punct(b), TokenTree::Ident(name), ..] = &rest[length..] {
            if a.as_char() != ':' || b.as_char() != ':' {
                break;
            }
            path.push(name.to_string());
            length += 3;
        }
        if path.len() > 1 {
            self.paths.push(Written { scope: scope.to_vec(), path });
        }
        length
    }
}

fn is_punct(token: &TokenTree, character: char) -> bool {
    matches!(token, TokenTree::Punct(p) if p.as_char() == character)
}

fn group(token: Option<&TokenTree>, delimiter: Delimiter) -> Option<TokenStream> {
    match token {
        Some(TokenTree::Group(g)) if g.delimiter() == delimiter => Some(g.stream()),
        _ => None,
    }
}

/// Length of an attribute, and whether it keeps what follows to tests.
fn attribute(rest: &[TokenTree]) -> Option<(usize, bool)> {
    let at = 1 + usize::from(is_punct(rest.get(1)?, '!'));
    let body = group(rest.get(at), Delimiter::Bracket)?.to_string();
    let words: Vec<&str> = body.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|w| !w.is_empty()).collect();
    Some((at + 1, words == ["cfg", "test"] || words.starts_with(&["cfg", "all", "test"])))
}

/// Length of the item that follows an attribute: to the end of its block, or to its semicolon.
fn item(rest: &[TokenTree]) -> usize {
    let ends =
        |t: &TokenTree| is_punct(t, ';') || matches!(t, TokenTree::Group(g) if g.delimiter() == Delimiter::Brace);
    // A `use` list stands in braces too, before its semicolon.
    let uses = rest.iter().take(3).any(|t| matches!(t, TokenTree::Ident(word) if word == "use"));
    let end = rest.iter().position(|t| if uses { is_punct(t, ';') } else { ends(t) });
    end.map_or(rest.len(), |e| e + 1)
}

/// The paths of a `use` and the names that they have afterwards.
fn tree(tokens: &[TokenTree], before: &[String]) -> Vec<(Vec<String>, String)> {
    let mut path = before.to_vec();
    let mut i = 0;
    while i < tokens.len() {
        match &tokens[i] {
            TokenTree::Ident(word) if word == "as" => {
                let alias = tokens.get(i + 1).map(ToString::to_string).unwrap_or_default();
                return vec![(path, alias)];
            }
            TokenTree::Ident(word) => path.push(word.to_string()),
            TokenTree::Punct(p) if p.as_char() == '*' => return vec![(path, "*".to_owned())],
            TokenTree::Group(g) => {
                let inside: Vec<TokenTree> = g.stream().into_iter().collect();
                return inside
                    .split(|t| is_punct(t, ','))
                    .filter(|p| !p.is_empty())
                    .flat_map(|p| tree(p, &path))
                    .collect();
            }
            _ => {}
        }
        i += 1;
    }
    // `a::{self}` is `a`.
    if path.len() > 1 && path.last().is_some_and(|last| last == "self") {
        path.pop();
    }
    let alias = path.last().cloned().unwrap_or_default();
    vec![(path, alias)]
}
