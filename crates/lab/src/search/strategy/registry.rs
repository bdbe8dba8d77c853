//! Every strategy by its name in files.

use std::fmt;
use std::marker::PhantomData;

use serde::de::value::MapAccessDeserializer;
use serde::de::{DeserializeOwned, Deserializer, EnumAccess, MapAccess, VariantAccess, Visitor};
use serde::{Deserialize, Serialize};

use super::{StrategySettings, cma_es, evolution, grid, map_elites};

/// Writes the type of the strategies that a file may name.
macro_rules! strategies {
    ($($name:ident $settings:ty;)*) => {
        /// Names of all strategies in files, each followed by its settings in brackets.
        pub const STRATEGIES: &[&str] = &[$(stringify!($name)),*];

        #[derive(Debug, Clone, Copy, Serialize, Deserialize)]
        #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
        enum Name {
            $($name,)*
        }

        #[cfg(feature = "schema")]
        impl schemars::JsonSchema for StrategyFile {
            fn schema_name() -> std::borrow::Cow<'static, str> {
                "Strategy".into()
            }

            fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
                let one = |name: &str, settings: schemars::Schema| {
                    schemars::json_schema!({
                        "type": "object",
                        "properties": { name: settings },
                        "required": [name],
                        "additionalProperties": false,
                    })
                };
                let all = [$(one(stringify!($name), generator.subschema_for::<$settings>())),*];
                schemars::json_schema!({
                    "description": "A strategy with its settings.",
                    "oneOf": all,
                })
            }
        }

        fn settings<'de, A: VariantAccess<'de>>(
            name: Name,
            variant: A,
        ) -> Result<Box<dyn StrategySettings>, A::Error> {
            match name {
                $(Name::$name => {
                    let settings = PhantomData::<$settings>;
                    Ok(Box::new(variant.struct_variant(&[], Fields(settings))?))
                })*
            }
        }
    };
}

// One line adds a strategy: its name in files and its settings.
strategies! {
    Evolution evolution::Evolution;
    MapElites map_elites::MapElites;
    Grid grid::GridSettings;
    CmaEs cma_es::CmaEsSettings;
}

/// The settings of the strategy that a file names.
#[derive(Debug)]
pub struct StrategyFile(pub Box<dyn StrategySettings>);

impl<'de> Deserialize<'de> for StrategyFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer
            .deserialize_enum("Strategy", STRATEGIES, AnyStrategy)
            .map(Self)
    }
}

struct AnyStrategy;

impl<'de> Visitor<'de> for AnyStrategy {
    type Value = Box<dyn StrategySettings>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a strategy with its settings in brackets")
    }

    fn visit_enum<A: EnumAccess<'de>>(self, access: A) -> Result<Self::Value, A::Error> {
        let (name, variant) = access.variant::<Name>()?;
        settings(name, variant)
    }
}

/// The fields of one struct, wherever they are in the file.
struct Fields<T>(PhantomData<T>);

impl<'de, T: DeserializeOwned> Visitor<'de> for Fields<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("settings in brackets")
    }

    fn visit_map<A: MapAccess<'de>>(self, fields: A) -> Result<T, A::Error> {
        T::deserialize(MapAccessDeserializer::new(fields))
    }
}
