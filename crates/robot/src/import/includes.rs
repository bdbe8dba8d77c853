//! The way to the parser of MJCF: all files that a model names are weighed before the parser follows them.
//!
//! A file may be included many times, and each file may include others, so that few bytes can stand for a model without end. The
//! weight of each file is computed once and multiplied, and a model that is too heavy is refused before it is read.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use mjcf_rs::Model;
use roxmltree::{Document, Node};

use super::element::XmlSource;
use super::{ROBOT, element};
use realgap_core::confined::{PATIENCE, within};
use realgap_core::error::{Error, Result};
use realgap_core::file::{Source, measure_xml, read_regular};

/// Files that a model includes, each counted as often as it is included.
const MOST_FILES: u64 = 1000;
/// Bytes of a model with all files that it includes, each counted as often as it is included.
const MOST_BYTES: u64 = 64_000_000;
/// Files that include each other in a chain.
const LONGEST_CHAIN: usize = 32;

/// Reads the model of a file, and of the files that it includes.
///
/// # Errors
/// A model that is too large with its included files, or that includes itself; whatever the parser refuses.
pub(super) fn model(place: XmlSource<'_>, root: Node<'_, '_>) -> Result<Model> {
    let path = place.source.path();
    let mut walk = Walk {
        home: folder(path).to_owned(),
        trail: vec![canonical(path)],
        known: BTreeMap::new(),
    };
    let text = root.document().input_text();
    walk.weigh(&place, root, text.len(), 0)?;
    let (text, home) = (text.to_owned(), walk.home);
    let refuse =
        |why: String| Error::invalid(format!("not an MJCF that can be read: {why}")).at_file(path);
    match within(PATIENCE, move || Model::from_str(&text, home)) {
        Ok(model) => model.map_err(|error| refuse(error.to_string())),
        Err(mishap) => Err(refuse(mishap.to_string())),
    }
}

fn folder(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

fn canonical(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

/// The weight of a file with all files that it includes, each as often as it is included.
#[derive(Debug, Clone, Copy, Default)]
struct Weight {
    files: u64,
    bytes: u64,
    elements: u64,
    /// Elements that are open at once.
    depth: u64,
    /// Elements of the heaviest model that the file offers to `<attach>`.
    heaviest_model: u64,
}

impl Weight {
    fn add(&mut self, other: Self, depth: u64) {
        self.files = self.files.saturating_add(other.files).saturating_add(1);
        self.bytes = self.bytes.saturating_add(other.bytes);
        self.elements = self.elements.saturating_add(other.elements);
        self.depth = self.depth.max(depth.saturating_add(other.depth));
        self.heaviest_model = self.heaviest_model.max(other.heaviest_model);
    }

    /// The first limit that the weight exceeds: what, how much, and the limit.
    fn excess(&self) -> Option<(&'static str, u64, u64)> {
        [
            ("included files", self.files, MOST_FILES),
            ("bytes", self.bytes, MOST_BYTES),
            ("elements", self.elements, ROBOT.elements as u64),
            (
                "elements nested in each other",
                self.depth,
                ROBOT.depth as u64,
            ),
        ]
        .into_iter()
        .find(|(_, found, most)| found > most)
    }
}

/// A walk through the files that a model includes.
struct Walk {
    /// The folder of the model's own file.
    home: PathBuf,
    /// The files that are being read: each includes the next.
    trail: Vec<PathBuf>,
    /// The weights of files that were read, by their path and the heaviest model that was offered to them.
    known: BTreeMap<(PathBuf, u64), Weight>,
}

impl Walk {
    /// The weight of a document; `offered` is the number of elements of the heaviest model that the files before it offer to `<attach>`.
    fn weigh(
        &mut self,
        place: &XmlSource<'_>,
        root: Node<'_, '_>,
        bytes: usize,
        offered: u64,
    ) -> Result<Weight> {
        let size = measure_xml(root.document().input_text(), ROBOT)
            .map_err(|error| error.at_file(place.source.path()))?;
        let mut weight = Weight {
            bytes: bytes as u64,
            elements: size.elements as u64,
            depth: size.depth as u64,
            heaviest_model: offered,
            ..Weight::default()
        };
        for node in root.descendants().filter(Node::is_element) {
            let depth = node.ancestors().count() as u64;
            match (node.tag_name().name(), node.attribute("file")) {
                ("include", Some(file)) => {
                    let inside = self.file(place, node, file, weight.heaviest_model)?;
                    weight.add(inside, depth);
                }
                ("model", Some(file)) => {
                    let inside = self.file(place, node, file, 0)?;
                    weight.add(inside, depth);
                    weight.heaviest_model = weight.heaviest_model.max(inside.elements);
                }
                ("attach", _) => {
                    let copied = weight.heaviest_model;
                    weight.elements = weight.elements.saturating_add(copied);
                }
                _ => continue,
            }
            if let Some((what, found, most)) = weight.excess() {
                let error =
                    Error::invalid("the model is too large with the files that it includes")
                        .found(format!("{found} {what} up to here"))
                        .allowed(format!(
                            "at most {most} {what}, each counted as often as it is included"
                        ))
                        .hint("include each file once, or write one file without includes");
                return Err(place.at(node, error));
            }
        }
        Ok(weight)
    }

    /// The weight of a file that an element names; nothing for a file that is missing or no XML, which the parser refuses itself.
    fn file(
        &mut self,
        place: &XmlSource<'_>,
        node: Node<'_, '_>,
        file: &str,
        offered: u64,
    ) -> Result<Weight> {
        let places = [folder(place.source.path()).join(file), self.home.join(file)];
        let Some(path) = places.into_iter().find(|path| path.exists()) else {
            return Ok(Weight::default());
        };
        let own = canonical(&path);
        if let Some(weight) = self.known.get(&(own.clone(), offered)) {
            return Ok(*weight);
        }
        let is_cycle = self.trail.contains(&own);
        if is_cycle || self.trail.len() > LONGEST_CHAIN {
            let what = match is_cycle {
                true => "the file includes itself",
                false => "files include each other in too long a chain",
            };
            let error = Error::invalid(what)
                .found(file)
                .allowed(format!(
                    "files of which no one leads back, at most {LONGEST_CHAIN} in a chain"
                ))
                .hint("remove this element");
            return Err(place.at(node, error));
        }
        let bytes = read_regular(&path, MOST_BYTES, "included file").map_err(|error| {
            let by = place.source.path().display();
            match place.line(node) {
                Some(line) => {
                    error.hint(format!("line {line} of {by} includes it: remove that line"))
                }
                None => error.hint(format!("{by} includes it")),
            }
        })?;
        let (Ok(text), size) = (String::from_utf8(bytes.clone()), bytes.len()) else {
            return Ok(Weight::default());
        };
        measure_xml(&text, ROBOT).map_err(|error| error.at_file(&path))?;
        let Ok(document) = Document::parse(&text) else {
            return Ok(Weight::default());
        };
        let ends = element::line_ends(&text);
        let source = Source::new(&path, text.as_str());
        let inside = XmlSource {
            source: &source,
            ends: &ends,
        };
        self.trail.push(own.clone());
        let weight = self.weigh(&inside, document.root_element(), size, offered)?;
        self.trail.pop();
        self.known.insert((own, offered), weight);
        Ok(weight)
    }
}
