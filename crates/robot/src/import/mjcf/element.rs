//! XML elements of an MJCF as owned values, so that elements can be copied (replicate), moved to other files (include, attach) and
//! given the attributes of their default classes.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use nalgebra::Vector3;
use roxmltree::{Document, Node};

use super::super::element::words;
use super::super::{ROBOT, without_comments};
use realgap_core::error::{Error, Result};
use realgap_core::file::{measure_xml, read_regular};

/// Largest number of files of one model.
const MOST_FILES: usize = 1000;
/// Largest size of all files of one model together, bytes.
const MOST_BYTES: u64 = 16_000_000;
/// Largest number of elements of one model, after all copies are made.
pub(super) const MOST_ELEMENTS: usize = ROBOT.elements;
/// Largest depth to which elements are nested, through all included files.
const MOST_DEPTH: usize = ROBOT.depth;

/// An element with its attributes and children.
#[derive(Debug, Clone, Default)]
pub(super) struct Element {
    pub tag: String,
    pub attributes: BTreeMap<String, String>,
    pub children: Vec<Element>,
    /// The file that contains the element.
    pub file: Rc<PathBuf>,
    /// Its line in that file, from 1.
    pub line: usize,
    /// Its first byte in that file.
    pub at: usize,
    /// Index of the model that states the element: 0, or that of an attached model, which has settings, defaults and assets of its own.
    pub origin: usize,
}

impl Element {
    /// An error about this element.
    pub fn error(&self, error: Error) -> Error {
        error
            .at_file(&*self.file)
            .at_line(self.line, 1)
            .field(&self.tag)
    }

    /// The text of an attribute.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.attributes.get(name).map(String::as_str)
    }

    /// The numbers of an attribute; empty if it is absent.
    pub fn list(&self, name: &str) -> Result<Vec<f64>> {
        let Some(text) = self.get(name) else {
            return Ok(Vec::new());
        };
        let numbers: Option<Vec<f64>> = words(text)
            .map(|word| word.parse().ok().filter(|number: &f64| !number.is_nan()))
            .collect();
        numbers.ok_or_else(|| {
            self.error(
                Error::invalid(format!("`{name}` has the wrong form"))
                    .found(text)
                    .allowed("numbers that are separated by blanks"),
            )
        })
    }

    /// Exactly `N` numbers; `None` if the attribute is absent.
    pub fn numbers<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>> {
        if self.get(name).is_none() {
            return Ok(None);
        }
        let list = self.list(name)?;
        let found = list.len();
        list.try_into().map(Some).map_err(|_| {
            self.error(
                Error::invalid(format!("`{name}` has the wrong form"))
                    .found(format!("{found} numbers"))
                    .allowed(format!("{N} numbers")),
            )
        })
    }

    /// One number; `usual` if the attribute is absent. Further numbers are coefficients of higher order.
    pub fn number(&self, name: &str, usual: f64) -> Result<f64> {
        Ok(self.list(name)?.first().copied().unwrap_or(usual))
    }

    /// Three numbers as a vector; zero if the attribute is absent.
    pub fn vector(&self, name: &str) -> Result<Vector3<f64>> {
        Ok(self
            .numbers::<3>(name)?
            .map_or_else(Vector3::zeros, Vector3::from))
    }

    /// Whether an attribute is `true`; `None` if it is absent or `auto`.
    pub fn truth(&self, name: &str) -> Option<bool> {
        match self.get(name) {
            Some("true") => Some(true),
            Some("false") => Some(false),
            _ => None,
        }
    }

    /// Whether a range applies: as stated, or because the range is stated.
    pub fn is_limited(&self, name: &str, range: Option<[f64; 2]>, autolimits: bool) -> bool {
        let states = range.is_some_and(|[low, high]| low < high);
        self.truth(name).unwrap_or(autolimits && states) && range.is_some()
    }

    /// The child elements of a name.
    pub fn named<'a>(&'a self, tag: &'a str) -> impl Iterator<Item = &'a Self> {
        self.children.iter().filter(move |child| child.tag == tag)
    }

    /// Number of elements, including this one.
    pub fn count(&self) -> usize {
        1 + self.children.iter().map(Self::count).sum::<usize>()
    }
}

/// Reads the files of a model.
pub(super) struct FileReader {
    /// Folder of the main file of the model.
    pub folder: PathBuf,
    pub origin: usize,
    pub files: usize,
    pub bytes: u64,
    elements: usize,
    included: Vec<PathBuf>,
    /// Elements that are open around the file that is read.
    depth: usize,
}

impl FileReader {
    pub fn new(folder: &Path, origin: usize) -> Self {
        Self {
            folder: folder.to_owned(),
            origin,
            files: 0,
            bytes: 0,
            elements: 0,
            included: Vec::new(),
            depth: 0,
        }
    }

    /// The root element of a text, in which included files take the places of their `<include>`.
    pub fn root(&mut self, text: &str, file: &Path) -> Result<Element> {
        self.files += 1;
        self.bytes += text.len() as u64;
        if self.files > MOST_FILES || self.bytes > MOST_BYTES {
            return Err(Error::invalid("too many or too large files")
                .at_file(file)
                .found(format!("{} files, {} bytes", self.files, self.bytes))
                .allowed(format!("{MOST_FILES} files, {MOST_BYTES} bytes")));
        }
        let text = without_comments(text);
        let size = measure_xml(&text, ROBOT).map_err(|error| error.at_file(file))?;
        self.elements += size.elements;
        if self.elements > MOST_ELEMENTS {
            return Err(Error::invalid("too many elements")
                .at_file(file)
                .found(format!("{} elements up to this file", self.elements))
                .allowed(format!("{MOST_ELEMENTS}, with all included files")));
        }
        let document = Document::parse(&text).map_err(|error| {
            let place = error.pos();
            Error::invalid(format!("not XML: {error}"))
                .at_file(file)
                .at_line(place.row as usize, place.col as usize)
        })?;
        let lines = super::super::element::line_ends(&text);
        let file = Rc::new(file.to_owned());
        self.element(document.root_element(), &lines, &file, self.depth)
    }

    fn element(
        &mut self,
        node: Node<'_, '_>,
        lines: &[usize],
        file: &Rc<PathBuf>,
        depth: usize,
    ) -> Result<Element> {
        let mut element = Element {
            tag: node.tag_name().name().to_owned(),
            attributes: (node.attributes())
                .map(|given| (given.name().to_owned(), given.value().to_owned()))
                .collect(),
            children: Vec::new(),
            file: Rc::clone(file),
            line: lines.partition_point(|end| *end < node.range().start) + 1,
            at: node.range().start,
            origin: self.origin,
        };
        if depth > MOST_DEPTH {
            let error = Error::invalid("elements are nested too deep");
            return Err(element.error(error.allowed(format!("{MOST_DEPTH} levels"))));
        }
        for child in node.children().filter(Node::is_element) {
            let child = self.element(child, lines, file, depth + 1)?;
            match child.tag.as_str() {
                "include" => {
                    let around = std::mem::replace(&mut self.depth, depth);
                    let included = self.include(&child)?;
                    self.depth = around;
                    element.children.extend(included.children);
                }
                _ => element.children.push(child),
            }
        }
        Ok(element)
    }

    /// The root of an included file: relative to the main file, or to the file that includes it.
    fn include(&mut self, element: &Element) -> Result<Element> {
        let name = element.get("file").unwrap_or_default();
        let beside = element.file.parent().unwrap_or(Path::new(""));
        let places = [self.folder.join(name), beside.join(name)];
        let Some(path) = places.into_iter().find(|path| path.exists()) else {
            let error = Error::invalid("the included file cannot be found").found(name);
            return Err(
                element.error(error.hint("a path relative to the main file, or to this one"))
            );
        };
        let whole = path.canonicalize().unwrap_or_else(|_| path.clone());
        if self.included.contains(&whole) {
            let error = Error::invalid("a file is included twice").found(name);
            return Err(
                element.error(error.hint("MuJoCo refuses it, too: use <attach> for copies"))
            );
        }
        self.included.push(whole);
        let text = self.text(&path).map_err(|error| element.error(error))?;
        self.root(&text, &path)
    }

    /// The text of a regular file that is not too large.
    pub fn text(&self, path: &Path) -> Result<String> {
        let left = MOST_BYTES.saturating_sub(self.bytes);
        let bytes = read_regular(path, left, "included file")
            .map_err(|error| error.hint(format!("the included file is {}", path.display())))?;
        String::from_utf8(bytes).map_err(|_| {
            Error::invalid("the included file is not UTF-8 text")
                .found(path.display().to_string())
                .hint("save it as UTF-8 in a text editor")
        })
    }
}
