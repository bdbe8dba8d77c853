//! What types of files and registries have alike, written once.

/// Methods of a trait that state one value each, in an implementation of it: `constant_methods! { name: &'static str = "pca"; … }`.
#[macro_export]
macro_rules! constant_methods {
    ($($name:ident: $type:ty = $value:expr;)*) => {
        $(fn $name(&self) -> $type {
            $value
        })*
    };
}

/// The members of a registry stand in files by their names: `named!(dyn Form, form_by_name)` compares, shows, writes and reads them so.
#[macro_export]
macro_rules! named {
    ($trait:ty, $by_name:path) => {
        impl PartialEq for $trait {
            fn eq(&self, other: &Self) -> bool {
                self.name() == other.name()
            }
        }

        impl std::fmt::Debug for $trait {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(self.name())
            }
        }

        impl serde::Serialize for $trait {
            fn serialize<S: serde::Serializer>(
                &self,
                s: S,
            ) -> std::result::Result<S::Ok, S::Error> {
                s.serialize_str(self.name())
            }
        }

        impl<'de> serde::Deserialize<'de> for &'static $trait {
            fn deserialize<D: serde::Deserializer<'de>>(
                d: D,
            ) -> std::result::Result<Self, D::Error> {
                let name: String = serde::Deserialize::deserialize(d)?;
                $by_name(&name).map_err($crate::Error::through_serde)
            }
        }
    };
}

/// How a type with a method `check` is read from a RON file and written as one; `$kind` is what errors call the file.
#[macro_export]
macro_rules! ron_file {
    ($type:ty, $kind:literal) => {
        impl $type {
            #[doc = concat!("Reads the file of a ", $kind, ".")]
            ///
            /// # Errors
            /// A missing file, anything of another form, values that do not fit together.
            pub fn read(path: impl AsRef<std::path::Path>) -> $crate::Result<Self> {
                Self::parse(&$crate::file::Source::read(path, $kind)?)
            }

            #[doc = concat!("The ", $kind, " in a text.")]
            ///
            /// # Errors
            /// As [`Self::read`].
            pub fn parse(source: &$crate::file::Source) -> $crate::Result<Self> {
                let value: Self = $crate::file::parse_ron(source)?;
                match value.check() {
                    Ok(()) => Ok(value),
                    Err(error) => Err(source.at_field(error)),
                }
            }

            /// The text of such a file.
            ///
            /// # Errors
            /// None for a value that was checked.
            pub fn to_ron(&self) -> $crate::Result<String> {
                $crate::file::write_ron(self)
            }
        }
    };
}

/// An enum whose members have a word each: with `ALL`, and the word of each by the method that is named.
#[macro_export]
macro_rules! worded {
    ($(#[$meta:meta])* $name:ident.$word:ident; $($(#[$about:meta])* $member:ident $text:literal;)*) => {
        $(#[$meta])*
        pub enum $name {
            $($(#[$about])* $member,)*
        }

        impl $name {
            /// All of them.
            pub const ALL: &[Self] = &[$(Self::$member),*];

            /// How it is called in texts and files.
            pub fn $word(self) -> &'static str {
                match self {
                    $(Self::$member => $text,)*
                }
            }
        }
    };
}

/// As [`worded!`], where the word is what stands in files and options: reading and writing. A word that none has is refused with
/// `$wrong` ("is no unit of length") and those that there are.
#[macro_export]
macro_rules! spelled {
    ($(#[$doc:meta])* $name:ident.$word:ident, $wrong:expr; $($members:tt)*) => {
        $crate::worded! {
            $(#[$doc])*
            #[derive(Debug, Clone, Copy, PartialEq, Eq)]
            $name.$word;
            $($members)*
        }

        impl std::str::FromStr for $name {
            type Err = String;

            fn from_str(word: &str) -> std::result::Result<Self, String> {
                let known = Self::ALL.iter().find(|one| one.$word() == word);
                known.copied().ok_or_else(|| {
                    let all: Vec<&str> = Self::ALL.iter().map(|one| one.$word()).collect();
                    format!("`{word}` {}; allowed: {}", $wrong, all.join(", "))
                })
            }
        }

        impl serde::Serialize for $name {
            fn serialize<S: serde::Serializer>(&self, s: S) -> std::result::Result<S::Ok, S::Error> {
                s.serialize_str(self.$word())
            }
        }

        impl<'de> serde::Deserialize<'de> for $name {
            fn deserialize<D: serde::Deserializer<'de>>(d: D) -> std::result::Result<Self, D::Error> {
                let word: String = serde::Deserialize::deserialize(d)?;
                word.parse().map_err(serde::de::Error::custom)
            }
        }
    };
}

/// Methods of a builder that take one value and give the builder back: `setters! { /// What it is. seed: u64; }` sets its field `seed`,
/// and after `within part;` the field of its field `part`.
#[macro_export]
macro_rules! setters {
    (within $part:ident; $($(#[$doc:meta])* $name:ident: $type:ty;)*) => {
        $($(#[$doc])*
        pub fn $name(mut self, $name: $type) -> Self {
            self.$part.$name = $name.into();
            self
        })*
    };
    ($($(#[$doc:meta])* $name:ident: $type:ty;)*) => {
        $($(#[$doc])*
        pub fn $name(mut self, $name: $type) -> Self {
            self.$name = $name.into();
            self
        })*
    };
}
