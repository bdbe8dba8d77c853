//! What is known of the pictures in a folder: `views.ron` beside them.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::alphabet::Alphabet;
use super::extractor::Sought;
use super::picture::{Grey, Region};
use realgap_core::error::{Error, Result};
use realgap_core::file::{Source, check_name, parse_ron, write_atomic, write_ron};
use realgap_core::warning::{Code, Warning};

/// Name of the file.
pub const VIEWS_FILE: &str = "views.ron";

/// Where pictures come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum PictureSource {
    /// A camera.
    #[default]
    Real,
    /// A simulated camera with the settings that are thought right.
    Simulated,
    /// A simulated camera with other settings, in place of a real one.
    StandIn,
}

impl PictureSource {
    /// What took the place of reality in a report.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::StandIn => "stand-ins in place of real pictures",
            Self::Real | Self::Simulated => "real pictures",
        }
    }

    /// What the reader should know where the pictures are no real ones.
    pub(super) fn warning(self) -> Option<Warning> {
        let what = "a simulated camera with other settings took the place of the real one";
        (self == Self::StandIn).then(|| Code::StandIn.warning(what))
    }
}

/// The text of `views.ron`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Views")]
pub struct ViewsFile {
    /// Where the pictures come from.
    #[serde(default)]
    pub source: PictureSource,
    /// Anything for people.
    #[serde(default)]
    pub description: String,
    /// A picture of the thing to be found.
    #[serde(default)]
    pub template: Option<String>,
    /// A picture of every character, and which they are.
    #[serde(default)]
    pub alphabet: Option<AlphabetFile>,
    /// One entry a view.
    #[serde(default)]
    pub views: Vec<ViewFile>,
}

/// A learning picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Alphabet")]
pub struct AlphabetFile {
    /// The picture.
    pub picture: String,
    /// Its text.
    pub text: String,
}

/// What is known of one view.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "View")]
pub struct ViewFile {
    /// The view, or one picture of it: the file's name without its ending.
    pub name: String,
    /// Where the centre of the template is, if it is in the picture.
    #[serde(default)]
    pub template_at_px: Option<(f64, f64)>,
    /// Where a contour begins.
    #[serde(default)]
    pub start_px: Vec<(f64, f64)>,
    /// The outline that it should come to.
    #[serde(default)]
    pub outline_px: Vec<(f64, f64)>,
    /// Where text is.
    #[serde(default)]
    pub text_region: Option<Region>,
    /// The text.
    #[serde(default)]
    pub text: Option<String>,
}

/// What is known of the pictures in a folder.
#[derive(Debug, Clone, Default)]
pub struct Views {
    /// Where the pictures come from.
    pub source: PictureSource,
    views: Vec<(String, Sought)>,
    /// Pictures that are no views.
    aside: Vec<PathBuf>,
}

impl Views {
    /// Reads `views.ron` of a folder, with the pictures it names; nothing is known where there is none.
    ///
    /// # Errors
    /// Anything that is not such a file, pictures that cannot be read, a name that stands twice.
    pub fn read(folder: impl AsRef<Path>) -> Result<Self> {
        let folder = folder.as_ref();
        let path = folder.join(VIEWS_FILE);
        if !path.exists() {
            return Ok(Self::default());
        }
        let source = Source::read(&path, "list of views")?;
        let file: ViewsFile = parse_ron(&source)?;
        let beside = |field: &str, name: &str| {
            check_name(name, "a picture")
                .map(|()| folder.join(name))
                .map_err(|e| source.at(field, e.field(field)))
        };
        let mut aside = Vec::new();
        let mut template = None;
        if let Some(name) = &file.template {
            let path = beside("template", name)?;
            template = Some(Arc::new(Grey::read(&path)?));
            aside.push(path);
        }
        let mut alphabet = None;
        if let Some(known) = &file.alphabet {
            let path = beside("alphabet.picture", &known.picture)?;
            let learned = Alphabet::learn(&Grey::read(&path)?, &known.text);
            alphabet = Some(Arc::new(learned.map_err(|e| source.at("alphabet", e))?));
            aside.push(path);
        }
        let mut views: Vec<(String, Sought)> = Vec::new();
        for (index, view) in file.views.into_iter().enumerate() {
            let at = format!("views[{index}].name");
            if views.iter().any(|(name, _)| *name == view.name) {
                let error = Error::invalid("a view stands twice").field(&at);
                return Err(source.at(&at, error.found(&view.name)));
            }
            let points = |points: &[(f64, f64)]| points.iter().map(|(x, y)| [*x, *y]).collect();
            let sought = Sought {
                template: view.template_at_px.and(template.clone()),
                template_at_px: view.template_at_px.map(|(x, y)| [x, y]),
                start_px: points(&view.start_px),
                outline_px: points(&view.outline_px),
                text_region: view.text_region,
                alphabet: view.text.as_ref().and(alphabet.clone()),
                text: view.text,
            };
            views.push((view.name, sought));
        }
        Ok(Self {
            source: file.source,
            views,
            aside,
        })
    }

    /// What is sought in a picture; `None` where it is not listed.
    pub fn sought(&self, picture: &str) -> Option<&Sought> {
        let found = self.views.iter().find(|(name, _)| name == picture);
        found.map(|(_, sought)| sought)
    }

    /// Whether a file is a template or a learning picture.
    pub(super) fn is_aside(&self, path: &Path) -> bool {
        self.aside.iter().any(|aside| aside == path)
    }
}

impl ViewsFile {
    /// Writes `views.ron` into a folder.
    ///
    /// # Errors
    /// A folder that is missing, a full disk.
    pub fn write(&self, folder: impl AsRef<Path>) -> Result<()> {
        write_atomic(
            folder.as_ref().join(VIEWS_FILE),
            write_ron(self)?.as_bytes(),
        )
    }
}
