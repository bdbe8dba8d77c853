//! Publishing results: they replace older results all at once.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use super::kind::Kind;
use super::kind::file::{PAGE, TIMING};
use super::table::CsvTable;
use crate::plot::{Format, Picture, file_bytes};
use crate::report::Pictures;
use realgap_core::error::{Error, Result};
use realgap_core::file::{SEAL_FILE, Seal, write_atomic};

/// Name of the folder in which results wait until all of them are written; no other program uses this name.
const DRAFT: &str = ".realgap-draft";

/// A results folder that is being written: its files stand in a folder of their own until all of them are there.
pub(super) struct Draft {
    folder: PathBuf,
    pictures: Pictures,
}

impl Draft {
    /// Where the files are written.
    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    /// Writes a table.
    pub(super) fn table(&self, name: &str, table: &CsvTable) -> Result<()> {
        table.write(&self.folder.join(name))
    }

    /// Writes `STEM.png` and `STEM.svg`, and keeps the picture for the page.
    pub(super) fn draw(&mut self, stem: &str, picture: &impl Picture) -> Result<()> {
        let svg = file_bytes(picture, Format::Svg)?;
        write_atomic(self.folder.join(format!("{stem}.svg")), &svg)?;
        self.write_png(stem, picture, Some(svg))
    }

    /// Writes `STEM.png` alone, and keeps the picture for the page.
    pub(super) fn draw_png(&mut self, stem: &str, picture: &impl Picture) -> Result<()> {
        self.write_png(stem, picture, None)
    }

    fn write_png(
        &mut self,
        stem: &str,
        picture: &impl Picture,
        svg: Option<Vec<u8>>,
    ) -> Result<()> {
        let png = file_bytes(picture, Format::Png)?;
        write_atomic(self.folder.join(format!("{stem}.png")), &png)?;
        self.pictures.add(stem, Some(png), svg);
        Ok(())
    }

    /// The pictures drawn so far, for the page.
    pub(super) fn take_pictures(&mut self) -> Pictures {
        std::mem::take(&mut self.pictures)
    }
}

/// Lets `write` fill a draft inside of `folder`, then moves every file of it to its place, and then removes what an older
/// run left there: results of this kind that are not in the draft. Then the folder is sealed. A run that is stopped before the
/// last file is written leaves the older results whole; a run that is stopped before the seal leaves a seal that does not fit.
///
/// # Errors
/// Those of `write`; a full disk or an unwritable folder.
pub(super) fn publish<T>(
    folder: &Path,
    kind: Kind,
    write: impl FnOnce(&mut Draft) -> Result<T>,
) -> Result<T> {
    let mut filled = Draft {
        folder: folder.join(DRAFT),
        pictures: Pictures::default(),
    };
    let draft = filled.folder.clone();
    remove_draft(&draft)?;
    fs::create_dir_all(&draft).map_err(|e| Error::io("make the folder", &draft, &e))?;
    let written = write(&mut filled).inspect_err(|_| {
        // Best effort: the first error is the one that matters.
        let _ignored = remove_draft(&draft);
    })?;
    let new = files(&draft)?;
    // The page of the same results belongs to them: it stays until another page takes its place, so that a run that is killed
    // before that leaves a page.
    let has_page = PAGE.iter().any(|name| folder.join(name).exists());
    let is_there = |name: &PathBuf| {
        let [made, there] = [&draft, folder].map(|place| fs::read(place.join(name)).ok());
        made.is_some() && made == there
    };
    let is_as_before = has_page && new.iter().all(is_there);
    for name in &new {
        let (from, to) = (draft.join(name), folder.join(name));
        if let Some(parent) = to.parent() {
            fs::create_dir_all(parent).map_err(|e| Error::io("make the folder", parent, &e))?;
        }
        fs::rename(&from, &to).map_err(|e| Error::io("write the file", &to, &e))?;
    }
    remove_draft(&draft)?;
    let mut removed = BTreeSet::new();
    for name in files(folder)?.difference(&new) {
        let stays = |name: &str| {
            [TIMING, SEAL_FILE].contains(&name) || (is_as_before && PAGE.contains(&name))
        };
        let text = name.to_str();
        if text.is_some_and(|name| kind.has(name) && !stays(name)) {
            let old = folder.join(name);
            fs::remove_file(&old).map_err(|e| Error::io("remove an old result", &old, &e))?;
            removed.insert(name.clone());
        }
    }
    // Last of all. Results of another kind that share the folder stay sealed.
    let mut seal = Seal::of(folder, new.iter().filter_map(|name| name.to_str()))?;
    if let Ok(Some(old)) = Seal::read(folder) {
        seal.keep(old, |name| !removed.contains(Path::new(name)));
    }
    seal.write(folder)?;
    Ok(written)
}

fn remove_draft(draft: &Path) -> Result<()> {
    match fs::remove_dir_all(draft) {
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
            Err(Error::io("remove an unfinished draft", draft, &e))
        }
        _ => Ok(()),
    }
}

/// Paths of the files in a folder and in its folders, relative to it. Links are not followed.
pub(super) fn files(folder: &Path) -> Result<BTreeSet<PathBuf>> {
    let refuse = |e: &std::io::Error| Error::io("look into the results folder", folder, e);
    let mut all = BTreeSet::new();
    for entry in fs::read_dir(folder).map_err(|e| refuse(&e))? {
        let entry = entry.map_err(|e| refuse(&e))?;
        let name = PathBuf::from(entry.file_name());
        let kind = entry.file_type().map_err(|e| refuse(&e))?;
        if kind.is_file() {
            all.insert(name);
        } else if kind.is_dir() {
            let inside = fs::read_dir(entry.path()).map_err(|e| refuse(&e))?;
            let is_file = |file: &fs::DirEntry| file.file_type().is_ok_and(|kind| kind.is_file());
            let files = inside.flatten().filter(is_file);
            all.extend(files.map(|file| name.join(file.file_name())));
        }
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All files but the seal.
    fn names(folder: &Path) -> Vec<String> {
        let files = files(folder).unwrap();
        let names = files.iter().map(|f| f.display().to_string());
        names.filter(|name| name != SEAL_FILE).collect()
    }

    #[test]
    fn new_results_replace_old_ones_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let put = |name: &str| {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, "old").unwrap();
        };
        for name in [
            "history.csv",
            "archive.csv",
            "best/01_robot_00001.ron",
            "best/mine.ron",
            "notes.txt",
            "timing.json",
        ] {
            put(name);
        }
        publish(folder.path(), Kind::Search, |draft| {
            let draft = draft.folder();
            fs::write(draft.join("history.csv"), "new").unwrap();
            fs::create_dir(draft.join("best")).unwrap();
            fs::write(draft.join("best/01_robot_00002.ron"), "new").unwrap();
            Ok(())
        })
        .unwrap();
        assert_eq!(
            names(folder.path()),
            [
                "best/01_robot_00002.ron",
                "best/mine.ron",
                "history.csv",
                "notes.txt",
                "timing.json"
            ]
        );
        assert_eq!(
            fs::read_to_string(folder.path().join("history.csv")).unwrap(),
            "new"
        );
        assert!(!folder.path().join(DRAFT).exists());
    }

    /// A run that is killed between results and page leaves the old page, if that page belongs to equal results.
    #[test]
    fn a_page_goes_with_the_results_that_it_is_of() {
        let folder = tempfile::tempdir().unwrap();
        let publish_points = |text: &str| {
            publish(folder.path(), Kind::Study, |draft| {
                fs::write(draft.folder().join("points.csv"), text).unwrap();
                Ok(())
            })
            .unwrap();
            names(folder.path())
        };
        publish_points("one");
        for name in PAGE {
            fs::write(folder.path().join(name), "page of one").unwrap();
        }
        assert_eq!(
            publish_points("one"),
            ["page.json", "points.csv", "report.html"]
        );
        assert_eq!(publish_points("two"), ["points.csv"]);
    }

    #[test]
    fn whoever_fails_midway_leaves_the_old_results_whole() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("points.csv"), "old").unwrap();
        let failed = publish(folder.path(), Kind::Study, |draft| {
            let draft = draft.folder();
            fs::write(draft.join("points.csv"), "half").unwrap();
            Err::<(), _>(Error::invalid("the disk is full"))
        });
        assert_eq!(failed.unwrap_err().message(), "the disk is full");
        assert_eq!(
            fs::read_to_string(folder.path().join("points.csv")).unwrap(),
            "old"
        );
        assert_eq!(names(folder.path()), ["points.csv"]);
        // A draft that a killed run has left is no obstacle.
        fs::create_dir(folder.path().join(DRAFT)).unwrap();
        fs::write(folder.path().join(DRAFT).join("points.csv"), "half").unwrap();
        publish(folder.path(), Kind::Gap, |_| Ok(())).unwrap();
        assert_eq!(names(folder.path()), ["points.csv"]);
    }
}
