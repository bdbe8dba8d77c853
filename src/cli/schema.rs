//! `realgap study schema`: JSON Schemas of files and answers, for editors and programs.

use realgap::file::{unknown_name, write_atomic};

use super::form::SCHEMAS;
use super::kit::*;

/// Print the JSON Schema of a file or of an answer, or list all schemas
///
/// Use it for editors, and for programs that read answers or write files of realgap. Files are RON, and every command
/// that reads one also reads the same content as JSON: the schemas of files describe this JSON (docs/files.md lists
/// the fields for people). The schemas of answers describe what `--format json` prints and what results folders hold;
/// each answer has a field `schema_version`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap study schema
  realgap study schema study
  realgap study schema -o schemas")]
pub struct SchemaCommand {
    /// Name of a schema, e.g. study or sweep; without it, all schemas are listed
    name: Option<String>,
    /// Write all schemas into this folder: files/NAME.json and answers/NAME.json
    #[arg(short, long, value_name = "DIR", conflicts_with = "name")]
    output: Option<PathBuf>,
}

/// A schema that comes with the program.
struct Shipped {
    folder: &'static str,
    name: &'static str,
    text: &'static str,
}

macro_rules! files {
    ($($name:literal $(if $feature:literal)?,)*) => {
        &[$(
            $(#[cfg(feature = $feature)])?
            ($name, include_str!(concat!("../../schemas/files/", $name, ".json"))),
        )*]
    };
}

/// The schemas of files, in the order of `realgap::schema::files`.
const FILES: &[(&str, &str)] = files![
    "robot", "bodies", "study", "noise", "search", "meta", "reading", "genome", "parameters", "arena",
    "vehicle", "controller", "sensor", "sensorgraph", "radio",
    "scene" if "papers", "camera" if "papers", "views" if "papers",
    "basis", "plan",
];

/// All schemas.
fn shipped() -> impl Iterator<Item = Shipped> {
    let files = FILES.iter().map(|(name, text)| ("files", name, text));
    let mut answers: Vec<_> = SCHEMAS.iter().collect();
    #[cfg(feature = "papers")]
    answers.extend(super::sense::form::SCHEMAS);
    answers.sort_by_key(|(name, _)| *name);
    let answers = answers
        .into_iter()
        .map(|(name, text)| ("answers", name, text));
    files
        .chain(answers)
        .map(|(folder, name, text)| Shipped { folder, name, text })
}

impl Shipped {
    /// The name with its folder.
    fn path(&self) -> String {
        format!("{}/{}", self.folder, self.name)
    }

    /// Its description, one sentence.
    fn doc(&self) -> String {
        let schema: serde_json::Value = serde_json::from_str(self.text).unwrap_or_default();
        schema["description"]
            .as_str()
            .unwrap_or_default()
            .to_owned()
    }
}

/// The schema that a name means.
fn find(name: &str) -> Result<Shipped> {
    let wanted = name.trim_end_matches(".json");
    let is_meant = |one: &Shipped| one.name == wanted || one.path() == wanted;
    let mut found = shipped().filter(is_meant);
    match (found.next(), found.next()) {
        (Some(one), None) => Ok(one),
        (None, _) => Err(unknown_name("schema", name, shipped().map(|one| one.name)).into_usage()),
        _ => {
            let paths: Vec<String> = shipped().filter(is_meant).map(|one| one.path()).collect();
            Err(Error::usage("a file and an answer have this name")
                .found(name)
                .allowed(paths.join(" or ")))
        }
    }
}

impl SchemaCommand {
    pub fn run(self) -> Result<()> {
        match (&self.name, &self.output) {
            (Some(name), _) => terminal::print(find(name)?.text.trim_end()),
            (None, Some(folder)) => {
                for one in shipped() {
                    let file = folder.join(one.path()).with_extension("json");
                    let parent = folder.join(one.folder);
                    std::fs::create_dir_all(&parent)
                        .map_err(|e| Error::io("make the folder", &parent, &e))?;
                    output::check(&file)?;
                    write_atomic(&file, one.text.as_bytes())?;
                }
                let count = counted(shipped().count(), "schema");
                terminal::print(format!("{count} in {}", folder.display()));
            }
            (None, None) => {
                let mut table = TextTable::new([("schema", Side::Left), ("describes", Side::Left)]);
                for one in shipped() {
                    table.push([one.path(), one.doc()]);
                }
                terminal::print(terminal::table(&table));
            }
        }
        Ok(())
    }
}

#[cfg(all(test, feature = "schema"))]
#[allow(clippy::unwrap_used, reason = "helpers of tests")]
mod tests {
    use realgap::file::SCHEMA_VERSION;
    use serde_json::{Value, json};

    use super::shipped;
    use crate::cli::committed::must_hold;
    use crate::cli::form::FORMS;

    /// Arguments of `cargo test` that run these tests.
    const TEST: &str = "--features schema --bin realgap schema";

    /// The content of the files: the schemas of the types, with titles.
    fn made() -> Vec<(String, Value)> {
        let files = realgap::schema::files().into_iter().map(|kind| {
            let path = format!("files/{}", kind.name);
            (path, titled(kind.name, kind.doc, kind.schema.into(), false))
        });
        let mut forms: Vec<_> = FORMS.iter().collect();
        #[cfg(feature = "papers")]
        forms.extend(crate::cli::sense::form::FORMS);
        forms.sort_by_key(|form| form.name);
        let answers = forms.into_iter().map(|form| {
            let schema = versioned((form.schema)().into());
            let path = format!("answers/{}", form.name);
            (path, titled(form.name, form.doc, schema, form.is_list))
        });
        files.chain(answers).collect()
    }

    /// The schema with title and description in front; for a list, `schema` is that of its elements.
    fn titled(name: &str, doc: &str, schema: Value, is_list: bool) -> Value {
        let Value::Object(mut own) = schema else {
            panic!("{name}: no object");
        };
        let mut whole = json!({
            "$schema": own.remove("$schema"),
            "title": format!("realgap {name}"),
            "description": doc,
        });
        own.remove("title");
        own.remove("description");
        let definitions = own.remove("$defs");
        let fields = whole.as_object_mut().unwrap();
        if is_list {
            fields.insert("type".to_owned(), "array".into());
            fields.insert("items".to_owned(), own.into());
        } else {
            fields.extend(own);
        }
        if let Some(definitions) = definitions {
            fields.insert("$defs".to_owned(), definitions);
        }
        whole
    }

    /// The schema with the version that every answer has; numbers that are not finite are written as null.
    fn versioned(schema: Value) -> Value {
        let Value::Object(mut own) = nullable(schema) else {
            panic!("no object");
        };
        let field = json!({
            "description": "Version of the form.",
            "const": SCHEMA_VERSION,
        });
        let fields = own.entry("properties").or_insert_with(|| json!({}));
        fields
            .as_object_mut()
            .unwrap()
            .insert("schema_version".to_owned(), field);
        let required = own.entry("required").or_insert_with(|| json!([]));
        required
            .as_array_mut()
            .unwrap()
            .insert(0, "schema_version".into());
        own.into()
    }

    fn nullable(schema: Value) -> Value {
        match schema {
            Value::Object(fields) => {
                let is_number = fields.get("type") == Some(&json!("number"));
                let mut fields: serde_json::Map<_, _> =
                    fields.into_iter().map(|(k, v)| (k, nullable(v))).collect();
                if is_number {
                    fields.insert("type".to_owned(), json!(["number", "null"]));
                }
                fields.into()
            }
            Value::Array(all) => all.into_iter().map(nullable).collect(),
            other => other,
        }
    }

    #[test]
    fn committed_schemas_equal_those_of_the_types() {
        let made = made();
        let paths: Vec<&String> = made.iter().map(|(path, _)| path).collect();
        let shipped: Vec<String> = shipped().map(|one| one.path()).collect();
        assert_eq!(paths, shipped.iter().collect::<Vec<_>>());
        for (path, schema) in made {
            let text = serde_json::to_string_pretty(&schema).unwrap() + "\n";
            must_hold(&format!("schemas/{path}.json"), &text, TEST);
        }
    }

    #[cfg(feature = "papers")]
    #[test]
    fn the_page_of_files_equals_the_schemas() {
        must_hold("docs/files.md", &realgap::schema::page(), TEST);
    }
}
