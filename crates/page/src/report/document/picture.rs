//! The pictures of a results folder inside of its page.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use super::base64;
use super::page::html;
use super::section::Section;
use crate::results::Kind;
use crate::results::kind::picture_stem;
use realgap_core::error::{Error, Result};

/// Larger pictures stay in the folder.
const LARGEST_BYTES: usize = 1_500_000;

/// A picture as it stands in a file.
#[derive(Debug, Clone, PartialEq)]
struct EncodedPicture {
    media_type: &'static str,
    bytes: Vec<u8>,
}

/// The pictures of a results folder by their names without ending.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Pictures(BTreeMap<String, EncodedPicture>);

impl Pictures {
    /// Adds a picture: as PNG where that is small enough, because an SVG needs its fonts; else as SVG; else not at all.
    pub(crate) fn add(&mut self, stem: &str, png: Option<Vec<u8>>, svg: Option<Vec<u8>>) {
        let formats = [("image/png", png), ("image/svg+xml", svg)];
        let mut there = formats.into_iter().filter_map(|(media_type, bytes)| {
            let bytes = bytes.filter(|bytes| bytes.len() <= LARGEST_BYTES)?;
            Some(EncodedPicture { media_type, bytes })
        });
        if let Some(picture) = there.next() {
            self.0.insert(stem.to_owned(), picture);
        }
    }

    /// The pictures in a folder that are results of this kind.
    ///
    /// # Errors
    /// A folder or a file that cannot be read.
    pub(in crate::report) fn read(folder: &Path, kind: Kind) -> Result<Self> {
        let refuse = |e: &std::io::Error| Error::io("look into the results folder", folder, e);
        let mut found: BTreeMap<String, [Option<Vec<u8>>; 2]> = BTreeMap::new();
        for entry in fs::read_dir(folder).map_err(|e| refuse(&e))? {
            let entry = entry.map_err(|e| refuse(&e))?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let Some(stem) = picture_stem(&name).filter(|_| kind.has(&name)) else {
                continue;
            };
            let path = entry.path();
            let is_small = |m: fs::Metadata| m.is_file() && m.len() <= LARGEST_BYTES as u64;
            if fs::metadata(&path).is_ok_and(is_small) {
                let bytes = fs::read(&path).map_err(|e| Error::io("read the file", &path, &e))?;
                let format = usize::from(name.ends_with(".svg"));
                found.entry(stem.to_owned()).or_default()[format] = Some(bytes);
            }
        }
        let mut pictures = Self::default();
        for (stem, [png, svg]) in found {
            pictures.add(&stem, png, svg);
        }
        Ok(pictures)
    }

    /// A section with the wanted pictures, in elements that run nothing.
    pub(in crate::report) fn section(
        &self,
        id: &'static str,
        title: &'static str,
        wanted: impl Fn(&str) -> bool,
    ) -> Section {
        let shown = self.0.iter().filter(|(stem, _)| wanted(stem));
        let figures = shown.map(|(stem, picture)| {
            let name = stem.replace('_', " ");
            embedded(&picture.bytes, picture.media_type, &name)
        });
        let figures: String = figures.collect();
        Section::new(id, title, beside(&figures))
    }
}

/// A picture as a figure that needs no file beside the page.
pub(in crate::report) fn embedded(bytes: &[u8], media_type: &str, name: &str) -> String {
    let name = html(name);
    format!(
        "<figure><h3>{name}</h3><img alt=\"{name}\" src=\"data:{media_type};base64,{}\"></figure>",
        base64::encode(bytes)
    )
}

/// Figures of pictures beside each other; nothing of none.
pub(in crate::report) fn beside(figures: &str) -> String {
    match figures {
        "" => String::new(),
        _ => format!("<div class=\"pictures\">{figures}</div>"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_has_the_small_pictures_of_its_kind() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["rmse.png", "rmse.svg", "confidence.svg", "mine.png"] {
            fs::write(folder.path().join(name), name).unwrap();
        }
        let large = vec![0; LARGEST_BYTES + 1];
        fs::write(folder.path().join("confidence.png"), &large).unwrap();
        let read = Pictures::read(folder.path(), Kind::Gap).unwrap();
        let mut made = Pictures::default();
        let bytes = |name: &str| Some(name.as_bytes().to_vec());
        made.add("rmse", bytes("rmse.png"), bytes("rmse.svg"));
        made.add("confidence", Some(large), bytes("confidence.svg"));
        assert_eq!(read, made);
        let html = read.section("p", "P", |_| true).html;
        assert_eq!(html.matches("<img").count(), 2);
        assert!(html.contains("image/svg+xml"));
    }
}
