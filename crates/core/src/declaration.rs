//! Macros that write repeated trait methods and (de)serialisation code of file types and registries.

/// Implements methods of a trait that return one constant each, inside an `impl` block: `constant_methods! { name: &'static str = "pca"; … }`.
#[macro_export]
macro_rules! constant_methods {
    ($($name:ident: $type:ty = $value:expr;)*) => {
        $(fn $name(&self) -> $type {
            $value
        })*
    };
}

/// Compares, prints, serialises and deserialises the entries of a registry by their names, e.g. `serde_by_name!(dyn Form, form_by_name)`.
#[macro_export]
macro_rules! serde_by_name {
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

/// Adds reading from and writing to a RON file to a type with a method `check`; `$kind` is the name of such a file in error messages.
#[macro_export]
macro_rules! ron_file {
    ($type:ty, $kind:literal) => {
        impl $type {
            #[doc = concat!("Reads the file of a ", $kind, " and checks its values.")]
            ///
            /// # Errors
            /// A missing file, a text of another format, values that do not fit together.
            pub fn read(path: impl AsRef<std::path::Path>) -> $crate::Result<Self> {
                Self::parse(&$crate::file::Source::read(path, $kind)?)
            }

            #[doc = concat!("Parses the ", $kind, " in a text and checks its values.")]
            ///
            /// # Errors
            /// The same as of [`Self::read`].
            pub fn parse(source: &$crate::file::Source) -> $crate::Result<Self> {
                let value: Self = $crate::file::parse_ron(source)?;
                match value.check() {
                    Ok(()) => Ok(value),
                    Err(error) => Err(source.at_field(error)),
                }
            }

            /// The text of the RON file with these values.
            ///
            /// # Errors
            /// A value that RON cannot express; a checked value never fails.
            pub fn to_ron(&self) -> $crate::Result<String> {
                $crate::file::write_ron(self)
            }
        }
    };
}

/// Declares an enum whose members have one label each: with the list `ALL`, and a method of the given name that returns the label.
#[macro_export]
macro_rules! labelled_enum {
    ($(#[$meta:meta])* $name:ident.$word:ident; $($(#[$about:meta])* $member:ident $text:literal;)*) => {
        $(#[$meta])*
        pub enum $name {
            $($(#[$about])* $member,)*
        }

        impl $name {
            /// All members.
            pub const ALL: &[Self] = &[$(Self::$member),*];

            /// The label that stands for this member in texts and files.
            pub fn $word(self) -> &'static str {
                match self {
                    $(Self::$member => $text,)*
                }
            }
        }
    };
}

/// As [`labelled_enum!`], with parsing and (de)serialisation by the label, for values of files and options. An unknown label is
/// refused with the message `$wrong` (e.g. "is no unit of length") and the list of all labels.
#[macro_export]
macro_rules! string_enum {
    ($(#[$doc:meta])* $name:ident.$word:ident, $wrong:expr; $($members:tt)*) => {
        $crate::labelled_enum! {
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

/// Declares methods of a builder that set one field and return the builder: `setters! { /// The seed. seed: u64; }` sets the field
/// `seed`; after `within part;` the method sets the field inside of the builder's field `part`.
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
