//! The mapping from quantities to the columns of a file, e.g. `x: "pose.x in mm"`.

use std::fmt;

use serde::de::{MapAccess, Visitor};
use serde::ser::SerializeStruct;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use realgap_core::error::{Error, Result};
use realgap_core::file::unknown_name;
use realgap_core::unit::{AngleUnit, LengthUnit, TimeUnit};

/// The kind of quantity that a unit measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Measure {
    Time,
    Length,
    Velocity,
    Angle,
    AngularVelocity,
    /// A number without unit.
    Number,
    /// A name or number that distinguishes recordings.
    Label,
}

impl Measure {
    /// The size of `unit` in the SI unit; for an unknown unit, a message with the allowed units.
    fn factor(self, unit: &str) -> std::result::Result<f64, String> {
        let per_second = |what: &str| {
            let named = unit.strip_suffix("/s");
            named.ok_or_else(|| format!("`{unit}` is no unit of {what}; allowed: e.g. mm/s, deg/s"))
        };
        match self {
            Self::Time => Ok(unit.parse::<TimeUnit>()?.seconds()),
            Self::Length => Ok(unit.parse::<LengthUnit>()?.metres()),
            Self::Velocity => Ok(per_second("velocity")?.parse::<LengthUnit>()?.metres()),
            Self::Angle => Ok(unit.parse::<AngleUnit>()?.radians()),
            Self::AngularVelocity => Ok(per_second("angular velocity")?
                .parse::<AngleUnit>()?
                .radians()),
            Self::Number | Self::Label => Err("it has no unit".to_owned()),
        }
    }
}

/// True if the word is a unit of any quantity that a column may hold.
fn is_unit(word: &str) -> bool {
    let measures = [
        Measure::Time,
        Measure::Length,
        Measure::Velocity,
        Measure::Angle,
        Measure::AngularVelocity,
    ];
    measures.iter().any(|measure| measure.factor(word).is_ok())
}

/// Declares the enum of roles with the table of their names and kinds of quantity.
macro_rules! roles {
    ($($variant:ident $name:literal $measure:ident $doc:literal;)*) => {
        /// The role of a column: the quantity that it holds.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Role {
            $(#[doc = $doc] $variant,)*
        }

        impl Role {
            /// All roles.
            pub const ALL: &[Self] = &[$(Self::$variant),*];
            const NAMES: &[&'static str] = &[$($name),*];

            /// The name of the role in a mapping.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)*
                }
            }

            pub(super) fn measure(self) -> Measure {
                match self {
                    $(Self::$variant => Measure::$measure,)*
                }
            }
        }
    };
}

roles! {
    Time "t" Time "Time.";
    Nanos "t_ns" Time "The part of a time below one second, in nanoseconds, if a second column holds it.";
    X "x" Length "Position along world x.";
    Y "y" Length "Position along world y.";
    Z "z" Length "Position along world z, up.";
    Qw "qw" Number "Real part of the orientation.";
    Qx "qx" Number "x component of the orientation.";
    Qy "qy" Number "y component of the orientation.";
    Qz "qz" Number "z component of the orientation.";
    Heading "heading" Angle "Angle of the body about world z, for planar recordings.";
    Vx "vx" Velocity "Velocity along world x.";
    Vy "vy" Velocity "Velocity along world y.";
    Vz "vz" Velocity "Velocity along world z.";
    Wx "wx" AngularVelocity "Angular velocity about the body's x axis.";
    Wy "wy" AngularVelocity "Angular velocity about the body's y axis.";
    Wz "wz" AngularVelocity "Angular velocity about the body's z axis.";
    Condition "condition" Label "Name of the set to which a repeat belongs.";
    Run "run" Label "Name or number of the repeat.";
}

/// A column of a file: its name, and its unit if that differs from the unit of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// The name in the file's header.
    pub name: String,
    /// Symbol of the column's unit.
    unit: Option<String>,
    /// Factor from the column's unit to SI.
    pub(super) factor: Option<f64>,
}

impl fmt::Display for Column {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.unit {
            Some(unit) => write!(f, "{} in {unit}", self.name),
            None => f.write_str(&self.name),
        }
    }
}

impl Column {
    /// Parses `NAME` or `NAME in UNIT`.
    fn parse(role: Role, text: &str) -> std::result::Result<Self, String> {
        let (name, unit) = match text.rsplit_once(" in ") {
            Some((name, unit)) if is_unit(unit.trim()) => (name, Some(unit.trim())),
            _ => (text, None),
        };
        let factor = unit.map(|unit| role.measure().factor(unit)).transpose();
        let name = name.trim();
        if name.is_empty() {
            return Err(format!("`{}` needs the name of a column", role.name()));
        }
        Ok(Self {
            name: name.to_owned(),
            unit: unit.map(str::to_owned),
            factor: factor.map_err(|why| format!("{}: {why}", role.name()))?,
        })
    }
}

/// A mapping from roles to columns. A file that has none of these columns is read by its own column names.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Columns(Vec<(Role, Column)>);

impl Columns {
    /// Adds a column to the mapping, as `NAME` or `NAME in UNIT`; it replaces an earlier column of the same role.
    ///
    /// # Errors
    /// No name, or a unit of another quantity.
    pub fn with(mut self, role: Role, column: &str) -> Result<Self> {
        let column = Column::parse(role, column).map_err(Error::invalid)?;
        self.put(role, column);
        Ok(self)
    }

    /// As [`Columns::with`], from a text `ROLE=NAME in UNIT`.
    ///
    /// # Errors
    /// An unknown role; the errors of [`Columns::with`].
    pub fn with_text(self, text: &str) -> Result<Self> {
        let (role, column) = text.split_once('=').ok_or_else(|| {
            Error::usage("not a column")
                .found(text)
                .allowed("WHAT=NAME or WHAT=NAME in UNIT, e.g. \"t=%time in ns\"")
        })?;
        let known = Role::ALL.iter().find(|known| known.name() == role.trim());
        let role = known.ok_or_else(|| {
            unknown_name(
                "content of a column",
                role.trim(),
                Role::NAMES.iter().copied(),
            )
        })?;
        self.with(*role, column)
    }

    fn put(&mut self, role: Role, column: Column) {
        self.0.retain(|(known, _)| *known != role);
        self.0.push((role, column));
        self.0.sort_by_key(|(role, _)| *role);
    }

    /// The column of a role, if it is mapped.
    pub fn get(&self, role: Role) -> Option<&Column> {
        let found = self.0.iter().find(|(known, _)| *known == role);
        found.map(|(_, column)| column)
    }

    /// All roles with their columns, sorted by role.
    pub fn iter(&self) -> impl Iterator<Item = (Role, &Column)> {
        self.0.iter().map(|(role, column)| (*role, column))
    }

    /// True if no column is mapped.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// This mapping, completed by the columns of `other` for roles that this mapping does not have.
    #[must_use]
    pub(super) fn or(mut self, other: &Self) -> Self {
        for (role, column) in other.iter() {
            if self.get(role).is_none() {
                self.put(role, column.clone());
            }
        }
        self
    }
}

impl Serialize for Columns {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        let mut fields = serializer.serialize_struct("columns", self.0.len())?;
        for (role, column) in self.iter() {
            fields.serialize_field(role.name(), &column.to_string())?;
        }
        fields.end()
    }
}

impl<'de> Deserialize<'de> for Columns {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        deserializer.deserialize_struct("columns", Role::NAMES, ColumnsVisitor)
    }
}

struct ColumnsVisitor;

/// The name of a field, as a role.
struct Key(Role);

impl<'de> Deserialize<'de> for Key {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        struct KeyVisitor;

        impl Visitor<'_> for KeyVisitor {
            type Value = Key;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("what a column holds")
            }

            fn visit_str<E: serde::de::Error>(self, name: &str) -> std::result::Result<Key, E> {
                let role = Role::ALL.iter().find(|role| role.name() == name);
                role.map(|role| Key(*role))
                    .ok_or_else(|| E::unknown_field(name, Role::NAMES))
            }
        }

        deserializer.deserialize_identifier(KeyVisitor)
    }
}

impl<'de> Visitor<'de> for ColumnsVisitor {
    type Value = Columns;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("columns such as (t: \"%time in ns\", x: \"pose.x in mm\")")
    }

    fn visit_map<A: MapAccess<'de>>(
        self,
        mut map: A,
    ) -> std::result::Result<Self::Value, A::Error> {
        use serde::de::Error as _;
        let mut columns = Columns::default();
        while let Some(Key(role)) = map.next_key()? {
            if columns.get(role).is_some() {
                return Err(A::Error::duplicate_field(role.name()));
            }
            let text: String = map.next_value()?;
            let column = Column::parse(role, &text).map_err(A::Error::custom)?;
            columns.put(role, column);
        }
        Ok(columns)
    }
}
