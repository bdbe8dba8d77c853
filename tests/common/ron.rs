//! RON as JSON, as docs/files.md says that it is read.

use std::collections::BTreeSet;

use serde_json::{Map, Value, json};

/// A RON text as the JSON that means the same (docs/files.md); `names` are names of structs, which do not change the value.
struct Ron<'a> {
    rest: &'a str,
    names: BTreeSet<String>,
}

impl Ron<'_> {
    fn skip(&mut self) {
        loop {
            self.rest = self.rest.trim_start();
            if let Some(comment) = self.rest.strip_prefix("//") {
                self.rest = comment.split_once('\n').map_or("", |(_, rest)| rest);
            } else if self.rest.starts_with("#!") {
                self.rest = self.rest.split_once(']').unwrap().1;
            } else {
                return;
            }
        }
    }

    fn take(&mut self, expected: char) -> bool {
        self.skip();
        let rest = self.rest.strip_prefix(expected);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn word(&mut self) -> Option<String> {
        self.skip();
        let is_first = |c: char| c.is_ascii_alphabetic() || c == '_';
        if !self.rest.starts_with(is_first) {
            return None;
        }
        let end = self
            .rest
            .find(|c: char| !(c.is_ascii_alphanumeric() || c == '_'));
        let (word, rest) = self.rest.split_at(end.unwrap_or(self.rest.len()));
        self.rest = rest;
        Some(word.to_owned())
    }

    fn value(&mut self) -> Value {
        self.skip();
        if let Some(word) = self.word() {
            return match word.as_str() {
                "true" => true.into(),
                "false" => false.into(),
                "None" => Value::Null,
                _ if !self.take('(') => word.into(),
                "Some" => {
                    let inner = self.value();
                    assert!(self.take(')'));
                    inner
                }
                name if self.names.contains(name) => self.brackets(),
                _ => {
                    let inner = self.brackets();
                    // A single value in brackets is that value.
                    match inner {
                        Value::Array(mut all) if all.len() == 1 => json!({ word: all.remove(0) }),
                        inner => json!({ word: inner }),
                    }
                }
            };
        }
        match self.rest.chars().next().unwrap() {
            '(' => {
                self.take('(');
                self.brackets()
            }
            '[' => {
                self.take('[');
                self.list(']')
            }
            '{' => {
                self.take('{');
                let mut fields = Map::new();
                while !self.take('}') {
                    let name = self.value().as_str().unwrap().to_owned();
                    assert!(self.take(':'));
                    fields.insert(name, self.value());
                    self.take(',');
                }
                fields.into()
            }
            '"' => {
                let mut is_escaped = false;
                let ends = |c: char| {
                    let is_end = c == '"' && !is_escaped;
                    is_escaped = c == '\\' && !is_escaped;
                    is_end
                };
                let end = 2 + self.rest[1..].find(ends).unwrap();
                let (text, rest) = self.rest.split_at(end);
                self.rest = rest;
                ::ron::from_str::<String>(text).unwrap().into()
            }
            _ => {
                let end = self
                    .rest
                    .find(|c: char| !(c.is_ascii_alphanumeric() || "+-._".contains(c)));
                let (number, rest) = self.rest.split_at(end.unwrap());
                self.rest = rest;
                let number = number.replace('_', "");
                number
                    .parse::<i64>()
                    .map(Value::from)
                    .or_else(|_| number.parse::<f64>().map(Value::from))
                    .unwrap_or_else(|_| panic!("{number}"))
            }
        }
    }

    /// After `(`: fields with names, or values without.
    fn brackets(&mut self) -> Value {
        self.skip();
        let before = self.rest;
        let is_named = self.word().is_some() && self.take(':');
        self.rest = before;
        if !is_named && !self.rest.starts_with(')') {
            return self.list(')');
        }
        let mut fields = Map::new();
        while !self.take(')') {
            let name = self.word().unwrap();
            assert!(self.take(':'), "{name}");
            fields.insert(name, self.value());
            self.take(',');
        }
        fields.into()
    }

    fn list(&mut self, end: char) -> Value {
        let mut all = Vec::new();
        while !self.take(end) {
            all.push(self.value());
            self.take(',');
        }
        all.into()
    }
}

/// A file as the JSON that its schema describes.
pub fn as_json(ron: &str, schema: &Value) -> Value {
    let definitions = schema["$defs"].as_object().cloned().unwrap_or_default();
    let structs = definitions
        .iter()
        .filter(|(_, one)| one.get("properties").is_some());
    // A variant may have the name of the struct in it; this name must be kept.
    let variants = definitions
        .values()
        .filter_map(|one| one["oneOf"].as_array());
    let variants: BTreeSet<&String> = variants
        .flatten()
        .filter_map(|variant| variant["properties"].as_object())
        .flat_map(Map::keys)
        .collect();
    let mut reader = Ron {
        rest: ron,
        names: structs
            .map(|(name, _)| name.clone())
            .filter(|name| !variants.contains(name))
            .collect(),
    };
    // The outermost name does not change the value.
    reader.word();
    reader.value()
}
