//! Circles of imports: files, or rooms, that need one another to be understood.

use std::collections::{BTreeMap, BTreeSet};

use super::imports::{Module, Taken};

/// Who imports whom.
pub type Arrows = BTreeMap<Module, BTreeSet<Module>>;

/// File by file.
pub fn among_files<'a>(taken: impl IntoIterator<Item = &'a Taken>) -> Arrows {
    let mut arrows = Arrows::new();
    for t in taken {
        arrows.entry(t.by.clone()).or_default().insert(t.from.clone());
    }
    arrows
}

/// Room by room: of the modules directly below each module those that are folders, with all that
/// stands in them.
pub fn among_rooms<'a>(taken: impl IntoIterator<Item = &'a Taken>, is_folder: impl Fn(&Module) -> bool) -> Arrows {
    let mut arrows = Arrows::new();
    for t in taken {
        let common = t.by.iter().zip(&t.from).take_while(|(a, b)| a == b).count();
        if common < t.by.len() && common < t.from.len() {
            let (by, from) = (t.by[..=common].to_vec(), t.from[..=common].to_vec());
            if is_folder(&by) && is_folder(&from) {
                arrows.entry(by).or_default().insert(from);
            }
        }
    }
    arrows
}

/// Some circle, from a module along its imports back to itself; `None` where there is none.
pub fn find(arrows: &Arrows) -> Option<Vec<Module>> {
    let mut done = BTreeSet::new();
    arrows.keys().find_map(|start| walk(arrows, start, &mut Vec::new(), &mut done))
}

fn walk(arrows: &Arrows, at: &Module, way: &mut Vec<Module>, done: &mut BTreeSet<Module>) -> Option<Vec<Module>> {
    if let Some(begin) = way.iter().position(|m| m == at) {
        return Some([&way[begin..], std::slice::from_ref(at)].concat());
    }
    if done.contains(at) {
        return None;
    }
    way.push(at.clone());
    let found = arrows.get(at).into_iter().flatten().find_map(|next| walk(arrows, next, way, done));
    way.pop();
    done.insert(at.clone());
    found
}

/// A circle as a line, with some of what each takes from the next.
pub fn in_words(circle: &[Module], taken: &BTreeSet<Taken>) -> String {
    let names = |by: &Module, from: &Module| {
        let files: Vec<&Taken> = taken.iter().filter(|t| t.by == *by && t.from == *from).collect();
        let rooms = taken.iter().filter(|t| t.by.starts_with(by) && t.from.starts_with(from));
        let all = if files.is_empty() { rooms.collect() } else { files };
        all.iter().take(3).map(|t| t.name.as_str()).collect::<Vec<_>>().join(", ")
    };
    let step = |w: &[Module]| format!("{} takes {} from {}", w[0].join("/"), names(&w[0], &w[1]), w[1].join("/"));
    circle.windows(2).map(step).collect::<Vec<_>>().join("; ")
}
