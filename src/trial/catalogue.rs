//! Lists of what can be planted: one word per effect, and for physics foreign to the library what
//! it is.
//!
//! A list is written once; its enum, its two tables and its public ids follow from it.

/// Declares an enum whose variants are public ids (kebab case), with `LIBRARY` for what a candidate
/// describes and `FOREIGN` for what none does. What is `alike` the library holds without
/// searching for it, as it resembles what it does search for; both names are right.
macro_rules! catalogue {
    (
        $(#[$doc:meta])*
        $name:ident
        library { $($known:ident,)* }
        foreign { $($strange:ident = $words:literal,)* }
        $(alike { $($twin:ident = $searched:ident,)* })?
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
        #[serde(rename_all = "kebab-case")]
        #[allow(missing_docs, reason = "a variant is its public id; `foreign_words` says what the others are")]
        pub enum $name {
            $($known,)*
            $($strange,)*
            $($($twin,)*)?
        }

        impl $name {
            /// States what the library has a candidate for, in its public order.
            pub const LIBRARY: &[$name] = &[$($name::$known,)*];
            /// Physics that no candidate describes, unlike each other.
            pub const FOREIGN: &[$name] = &[$($name::$strange,)*];
            /// States what the library holds and does not search for, as it resembles a candidate
            /// that it does.
            pub const ALIKE: &[$name] = &[$($($name::$twin,)*)?];

            /// The public id, or a name of the same form for foreign physics.
            pub fn id(self) -> String {
                match serde_json::to_value(self) {
                    Ok(serde_json::Value::String(id)) => id,
                    _ => String::new(),
                }
            }

            /// The ids that are right for it: its own, and that of a candidate that is searched for
            /// in its place.
            pub fn names(self) -> Vec<String> {
                match self {
                    $($($name::$twin => vec![self.id(), $name::$searched.id()],)*)?
                    _ => vec![self.id()],
                }
            }

            /// Returns what a foreign effect is, in words; empty for the library's own.
            pub fn foreign_words(self) -> &'static str {
                match self {
                    $($name::$strange => $words,)*
                    _ => "",
                }
            }
        }
    };
}

pub(super) use catalogue;
