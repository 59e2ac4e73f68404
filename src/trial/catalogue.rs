//! Lists of what can be planted: one word per effect, and for physics foreign to the library what
//! it is.
//!
//! A list is written once; its enum, its two tables and its public ids follow from it.

/// Declares an enum whose variants are public ids (kebab case), with `LIBRARY` for what a candidate
/// describes and `FOREIGN` for what none does.
macro_rules! catalogue {
    (
        $(#[$doc:meta])*
        $name:ident
        library { $($known:ident,)* }
        foreign { $($strange:ident = $words:literal,)* }
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
        #[serde(rename_all = "kebab-case")]
        #[allow(missing_docs, reason = "a variant is its public id; `foreign_words` says what the others are")]
        pub enum $name {
            $($known,)*
            $($strange,)*
        }

        impl $name {
            /// What the library has a candidate for, in its public order.
            pub const LIBRARY: &[$name] = &[$($name::$known,)*];
            /// Physics that no candidate describes, unlike each other.
            pub const FOREIGN: &[$name] = &[$($name::$strange,)*];

            /// The public id, or a name of the same form for foreign physics.
            pub fn id(self) -> String {
                match serde_json::to_value(self) {
                    Ok(serde_json::Value::String(id)) => id,
                    _ => String::new(),
                }
            }

            /// What a foreign effect is, in words; empty for the library's own.
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
