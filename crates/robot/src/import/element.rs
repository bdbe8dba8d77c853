//! Reading attributes of XML elements, with errors that name line and column.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use roxmltree::Node;

use realgap_core::error::{Error, Result};
use realgap_core::file::Source;

/// A file's text, for where in it something stands.
#[derive(Clone, Copy)]
pub(super) struct Place<'a> {
    pub source: &'a Source,
    /// Where lines end: asking the document reads it from the beginning, each time.
    pub ends: &'a [usize],
}

/// Where the lines of a text end.
pub(super) fn line_ends(text: &str) -> Vec<usize> {
    text.match_indices('\n').map(|(at, _)| at).collect()
}

impl Place<'_> {
    /// The error at an element.
    pub fn at(&self, node: Node<'_, '_>, error: Error) -> Error {
        let (line, column) = self.line_column(node);
        let name = node.tag_name().name();
        error
            .at_file(self.source.path())
            .at_line(line, column)
            .field(name)
    }

    /// The line of an element.
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

    /// An attribute that must be there.
    pub fn text<'n>(&self, node: Node<'n, '_>, name: &str) -> Result<&'n str> {
        node.attribute(name).ok_or_else(|| {
            let what = format!("the attribute `{name}` is missing");
            self.at(node, Error::invalid(what))
        })
    }

    /// Numbers of an attribute, separated by blanks or commas; what follows them is not read.
    pub fn numbers<const N: usize>(&self, node: Node<'_, '_>, name: &str) -> Result<[f64; N]> {
        let text = self.text(node, name)?;
        // Half of 0,5 is no number.
        let is_decimal_comma = N == 1 && text.contains(',');
        let numbers: Option<Vec<f64>> = words(text)
            .take(if is_decimal_comma { 0 } else { N })
            .map(|word| word.parse().ok().filter(|number: &f64| number.is_finite()))
            .collect();
        numbers
            .and_then(|numbers| numbers.try_into().ok())
            .ok_or_else(|| {
                let error = Error::invalid(format!("`{name}` is not what it must be"))
                    .found(text)
                    .allowed(format!("{N} finite numbers"));
                let error = match text.contains("${") {
                    true => error.hint("this is xacro: `xacro FILE` turns it into a URDF"),
                    false => error,
                };
                self.at(node, error)
            })
    }

    /// As [`Place::numbers`] of one number; `None` where the attribute is absent.
    pub fn number(&self, node: Node<'_, '_>, name: &str) -> Result<Option<f64>> {
        match node.has_attribute(name) {
            true => self.numbers::<1>(node, name).map(|[number]| Some(number)),
            false => Ok(None),
        }
    }

    /// The pose that the child `origin` of an element says: metres, fixed-axis roll, pitch and yaw in radians, or a quaternion with its
    /// real part last; what is empty is 0.
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
                    self.at(origin, Error::invalid("a quaternion of 0 is no turn"))
                })?
            }
        };
        Ok(Isometry3::from_parts(Translation3::new(x, y, z), turn))
    }

    /// A vector of an attribute.
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
