//! The file `views.ron`, which states the known truth for the pictures in its folder.

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

/// The source of pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum PictureSource {
    /// A real camera.
    #[default]
    Real,
    /// A simulated camera with the settings of the model.
    Simulated,
    /// A simulated camera with other settings, which stands in for a real camera.
    StandIn,
}

impl PictureSource {
    /// The words by which a report names the source of its real pictures.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::StandIn => "stand-ins in place of real pictures",
            Self::Real | Self::Simulated => "real pictures",
        }
    }

    /// A warning if a stand-in took the place of real pictures.
    pub(super) fn warning(self) -> Option<Warning> {
        let what = "a simulated camera with other settings took the place of the real one";
        (self == Self::StandIn).then(|| Code::StandIn.warning(what))
    }
}

/// The content of `views.ron`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Views")]
pub struct ViewsFile {
    /// Source of the pictures.
    #[serde(default)]
    pub source: PictureSource,
    /// A description for readers.
    #[serde(default)]
    pub description: String,
    /// File name of the template: a picture of the object to be found.
    #[serde(default)]
    pub template: Option<String>,
    /// A picture of all characters, with their text.
    #[serde(default)]
    pub alphabet: Option<AlphabetFile>,
    /// One entry for each view.
    #[serde(default)]
    pub views: Vec<ViewFile>,
}

/// The picture from which characters are learned.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Alphabet")]
pub struct AlphabetFile {
    /// File name of the picture.
    pub picture: String,
    /// The text in the picture.
    pub text: String,
}

/// What is known of one view.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "View")]
pub struct ViewFile {
    /// Name of the view, or of one picture of it: the file name without its ending.
    pub name: String,
    /// Position of the centre of the template, if it is in the picture, pixels.
    #[serde(default)]
    pub template_at_px: Option<(f64, f64)>,
    /// Contour from which a snake starts, pixels.
    #[serde(default)]
    pub start_px: Vec<(f64, f64)>,
    /// True outline of the object, pixels.
    #[serde(default)]
    pub outline_px: Vec<(f64, f64)>,
    /// Part of the picture that contains text.
    #[serde(default)]
    pub text_region: Option<Region>,
    /// The text.
    #[serde(default)]
    pub text: Option<String>,
}

/// The known truth for the pictures in a folder.
#[derive(Debug, Clone, Default)]
pub struct Views {
    /// Source of the pictures.
    pub source: PictureSource,
    views: Vec<(String, Sought)>,
    /// Pictures in the folder that are not views: the template and the learning picture.
    auxiliary: Vec<PathBuf>,
}

impl Views {
    /// Reads `views.ron` of a folder, with the pictures that it names; the result is empty if the folder has no such file.
    ///
    /// # Errors
    /// A file of another form, pictures that cannot be read, a name that is listed twice.
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
        let mut auxiliary = Vec::new();
        let mut template = None;
        if let Some(name) = &file.template {
            let path = beside("template", name)?;
            template = Some(Arc::new(Grey::read(&path)?));
            auxiliary.push(path);
        }
        let mut alphabet = None;
        if let Some(known) = &file.alphabet {
            let path = beside("alphabet.picture", &known.picture)?;
            let learned = Alphabet::learn(&Grey::read(&path)?, &known.text);
            alphabet = Some(Arc::new(learned.map_err(|e| source.at("alphabet", e))?));
            auxiliary.push(path);
        }
        let mut views: Vec<(String, Sought)> = Vec::new();
        for (index, view) in file.views.into_iter().enumerate() {
            let at = format!("views[{index}].name");
            if views.iter().any(|(name, _)| *name == view.name) {
                let error = Error::invalid("a view is listed twice").field(&at);
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
            auxiliary,
        })
    }

    /// What extractors search for in a picture; `None` if the picture is not listed.
    pub fn sought(&self, picture: &str) -> Option<&Sought> {
        let found = self.views.iter().find(|(name, _)| name == picture);
        found.map(|(_, sought)| sought)
    }

    /// Whether a file is a template or a learning picture.
    pub(super) fn is_auxiliary(&self, path: &Path) -> bool {
        self.auxiliary.iter().any(|other| other == path)
    }
}

impl ViewsFile {
    /// Writes `views.ron` into a folder.
    ///
    /// # Errors
    /// A missing folder, a full disk.
    pub fn write(&self, folder: impl AsRef<Path>) -> Result<()> {
        write_atomic(
            folder.as_ref().join(VIEWS_FILE),
            write_ron(self)?.as_bytes(),
        )
    }
}
