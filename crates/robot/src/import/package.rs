//! Search for the mesh files that a robot's file refers to.

use std::path::{Path, PathBuf};

use super::Options;

/// Number of parent folders of the robot's file that are searched.
const UPWARDS: usize = 8;

/// Path of the file that a robot's file refers to as `name`; `None` if no such file exists.
///
/// `package://NAME/rest` and `model://NAME/rest` stand for `rest` in the folder that the options state for the package NAME;
/// otherwise in a folder NAME beside the robot's file or in one of its parent folders; otherwise `rest` in one of the parent
/// folders. Any other name is a path relative to the robot's folder or to one of its parent folders.
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
