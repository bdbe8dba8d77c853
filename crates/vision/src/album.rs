//! Lists the pictures of a folder and assigns them to views by name.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::views::{PictureSource, Views};
use realgap_core::error::{Error, Result};

/// Endings of the names of picture files.
const ENDINGS: [&str; 3] = ["png", "jpg", "jpeg"];

/// The pictures of a folder, assigned to views.
#[derive(Debug, Clone, PartialEq)]
pub struct Shots {
    /// Source of the pictures.
    pub source: PictureSource,
    /// The pictures of each view, in the order in which the views were given: `NAME`, or `NAME_1`, `NAME_2`, …
    pub of_view: Vec<Vec<PathBuf>>,
}

impl Shots {
    /// Assigns the pictures of a folder to these views by name.
    ///
    /// # Errors
    /// A folder that cannot be listed, has no pictures or none of these views; a bad `views.ron`.
    pub fn read(folder: impl AsRef<Path>, views: &[&str]) -> Result<Self> {
        let album = Album::read(folder.as_ref())?;
        let named = views
            .iter()
            .map(|view| ((*view).to_owned(), PathBuf::new()))
            .collect();
        let of = |view: &&str| album.of_view(view, &named).into_iter().cloned().collect();
        let of_view: Vec<Vec<PathBuf>> = views.iter().map(of).collect();
        if of_view.iter().all(Vec::is_empty) {
            let names: Vec<&str> = album.pictures.keys().take(5).map(String::as_str).collect();
            return Err(Error::invalid("no picture has the name of a view")
                .at_file(&album.folder)
                .found(names.join(", "))
                .allowed(views.join(", "))
                .hint("a picture is VIEW.png, several of one view are VIEW_1.png, VIEW_2.png"));
        }
        Ok(Self {
            source: album.source(),
            of_view,
        })
    }
}

/// The name of a picture: its file name without the ending.
pub(super) fn stem(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}

/// The pictures of a folder with their known truth.
#[derive(Debug, Clone)]
pub(super) struct Album {
    pub folder: PathBuf,
    pub views: Views,
    /// Paths of the pictures by name (the file name without the ending).
    pub pictures: BTreeMap<String, PathBuf>,
}

impl Album {
    pub(super) fn read(folder: &Path) -> Result<Self> {
        let entries = std::fs::read_dir(folder)
            .map_err(|e| Error::io("list the folder of pictures", folder, &e))?;
        let views = Views::read(folder)?;
        let mut pictures: BTreeMap<String, PathBuf> = BTreeMap::new();
        for entry in entries {
            let path = entry
                .map_err(|e| Error::io("list the folder of pictures", folder, &e))?
                .path();
            let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
            let is_picture = ending.is_some_and(|e| ENDINGS.contains(&e.as_str()));
            if !is_picture || views.is_auxiliary(&path) {
                continue;
            }
            let name = stem(&path);
            if let Some(other) = pictures.insert(name.clone(), path) {
                return Err(Error::invalid("two pictures have the same name")
                    .at_file(folder)
                    .found(other.display())
                    .hint("remove or rename one of them"));
            }
        }
        if pictures.is_empty() {
            return Err(Error::invalid("there are no pictures")
                .at_file(folder)
                .allowed(".png, .jpg"));
        }
        Ok(Self {
            folder: folder.to_owned(),
            views,
            pictures,
        })
    }

    /// The pictures of a view: `NAME`, and its repeats `NAME_1`, `NAME_2`, … unless another view has exactly that name.
    pub(super) fn of_view(&self, view: &str, views: &BTreeMap<String, PathBuf>) -> Vec<&PathBuf> {
        let is_repeat = |name: &str| {
            name.strip_prefix(view)
                .and_then(|rest| rest.strip_prefix('_'))
                .is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()))
                && !views.contains_key(name)
        };
        self.pictures
            .iter()
            .filter(|(name, _)| *name == view || is_repeat(name))
            .map(|(_, path)| path)
            .collect()
    }

    pub(super) fn source(&self) -> PictureSource {
        self.views.source
    }
}
