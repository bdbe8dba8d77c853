//! Where the files are that a robot names.

use std::path::{Path, PathBuf};

use super::Options;

/// Folders above the robot's file that are looked through.
const UPWARDS: usize = 8;

/// The file that a robot calls `name`; `None` where there is none.
///
/// `package://NAME/rest` and `model://NAME/rest` are `rest` in the folder that the options give NAME, else in a folder of that name
/// beside or above the robot's file, or in one above it that holds `rest`. Anything else is a path from the robot's folder, or
/// from one above it.
pub(super) fn locate(name: &str, robot: &Path, options: &Options) -> Option<PathBuf> {
    let name = name.trim();
    let is_there = |path: PathBuf| path.is_file().then_some(path);
    let folder = robot.parent().unwrap_or(Path::new(""));
    let folder = match folder.as_os_str().is_empty() {
        true => PathBuf::from("."),
        false => folder.to_owned(),
    };
    let whole = folder.canonicalize().unwrap_or(folder.clone());
    let above: Vec<PathBuf> = std::iter::once(folder)
        .chain(whole.ancestors().skip(1).take(UPWARDS).map(Path::to_owned))
        .collect();
    let schemes = ["package://", "model://"];
    if let Some(rest) = schemes.iter().find_map(|scheme| name.strip_prefix(scheme)) {
        let (package, inside) = rest.split_once('/').unwrap_or(("", rest));
        let stated = options.packages.iter().find(|(known, _)| known == package);
        if let Some((_, folder)) = stated {
            return is_there(folder.join(inside));
        }
        return above
            .iter()
            .flat_map(|folder| {
                [
                    folder.join(package).join(inside),
                    folder.join(inside),
                    folder.join("robots").join(package).join(inside),
                ]
            })
            .find_map(is_there);
    }
    let path = name.strip_prefix("file://").unwrap_or(name);
    above.iter().find_map(|folder| is_there(folder.join(path)))
}
