//! Reads attributes of XML elements; errors name line and column.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use roxmltree::Node;

use realgap_core::error::{Error, Result};
use realgap_core::file::Source;

/// The text of a file and its line ends, to find the line and column of an element.
#[derive(Clone, Copy)]
pub(super) struct XmlSource<'a> {
    pub source: &'a Source,
    /// Byte positions of the line ends. They are stored because the XML document searches from the beginning of the text for
    /// every query.
    pub ends: &'a [usize],
}

/// Byte positions of the line ends of a text.
pub(super) fn line_ends(text: &str) -> Vec<usize> {
    text.match_indices('\n').map(|(at, _)| at).collect()
}

impl XmlSource<'_> {
    /// Adds file, line, column and name of an element to an error.
    pub fn at(&self, node: Node<'_, '_>, error: Error) -> Error {
        let (line, column) = self.line_column(node);
        let name = node.tag_name().name();
        error
            .at_file(self.source.path())
            .at_line(line, column)
            .field(name)
    }

    /// Line of an element, from 1.
    pub fn line(&self, node: Node<'_, '_>) -> Option<usize> {
        Some(self.line_column(node).0)
    }

    /// Line and column of an element, from 1; columns count characters.
    fn line_column(&self, node: Node<'_, '_>) -> (usize, usize) {
        let at = node.range().start;
        let before = self.ends.partition_point(|end| *end < at);
        let start = before.checked_sub(1).map_or(0, |last| self.ends[last] + 1);
        let text = &node.document().input_text()[start..at];
        (before + 1, text.chars().count() + 1)
    }

    /// A required attribute.
    pub fn text<'n>(&self, node: Node<'n, '_>, name: &str) -> Result<&'n str> {
        node.attribute(name).ok_or_else(|| {
            let what = format!("the attribute `{name}` is missing");
            self.at(node, Error::invalid(what))
        })
    }

    /// The first `N` numbers of an attribute, separated by blanks or commas; text after them is ignored.
    pub fn numbers<const N: usize>(&self, node: Node<'_, '_>, name: &str) -> Result<[f64; N]> {
        let text = self.text(node, name)?;
        // A single number must not contain a comma: `0,5` would otherwise be read as 0.
        let is_decimal_comma = N == 1 && text.contains(',');
        let numbers: Option<Vec<f64>> = words(text)
            .take(if is_decimal_comma { 0 } else { N })
            .map(|word| word.parse().ok().filter(|number: &f64| number.is_finite()))
            .collect();
        numbers
            .and_then(|numbers| numbers.try_into().ok())
            .ok_or_else(|| {
                let error = Error::invalid(format!("`{name}` has the wrong form"))
                    .found(text)
                    .allowed(format!("{N} finite numbers"));
                let error = match text.contains("${") {
                    true => error.hint("this is xacro: `xacro FILE` turns it into a URDF"),
                    false => error,
                };
                self.at(node, error)
            })
    }

    /// As [`XmlSource::numbers`] of one number; `None` where the attribute is absent.
    pub fn number(&self, node: Node<'_, '_>, name: &str) -> Result<Option<f64>> {
        match node.has_attribute(name) {
            true => self.numbers::<1>(node, name).map(|[number]| Some(number)),
            false => Ok(None),
        }
    }

    /// The pose in the child element `origin`: metres, and fixed-axis roll, pitch and yaw in radians or a quaternion with its
    /// real part last; empty attributes are read as 0.
    pub fn origin(&self, node: Node<'_, '_>) -> Result<Isometry3<f64>> {
        let Some(origin) = child(node, "origin") else {
            return Ok(Isometry3::identity());
        };
        let triple = |name| match origin.attribute(name).map(str::trim) {
            None | Some("") => Ok([0.0; 3]),
            Some(_) => self.numbers::<3>(origin, name),
        };
        let ([x, y, z], [roll, pitch, yaw]) = (triple("xyz")?, triple("rpy")?);
        let turn = match origin.has_attribute("quat_xyzw") {
            false => UnitQuaternion::from_euler_angles(roll, pitch, yaw),
            true => {
                let [i, j, k, w] = self.numbers::<4>(origin, "quat_xyzw")?;
                UnitQuaternion::try_new(Quaternion::new(w, i, j, k), 1e-9).ok_or_else(|| {
                    self.at(
                        origin,
                        Error::invalid("a quaternion of length 0 is not an orientation"),
                    )
                })?
            }
        };
        Ok(Isometry3::from_parts(Translation3::new(x, y, z), turn))
    }

    /// The three numbers of an attribute as a vector.
    pub fn vector(&self, node: Node<'_, '_>, name: &str) -> Result<Vector3<f64>> {
        self.numbers::<3>(node, name).map(Vector3::from)
    }
}

/// The words of a list of numbers.
pub(super) fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c.is_whitespace() || c == ',')
        .filter(|word| !word.is_empty())
}

/// The first child element of this name.
pub(super) fn child<'n, 'd>(node: Node<'n, 'd>, name: &str) -> Option<Node<'n, 'd>> {
    node.children().find(|child| child.has_tag_name(name))
}

/// All child elements of this name.
pub(super) fn children<'n, 'd: 'n>(
    node: Node<'n, 'd>,
    name: &'static str,
) -> impl Iterator<Item = Node<'n, 'd>> {
    node.children()
        .filter(move |child| child.has_tag_name(name))
}
