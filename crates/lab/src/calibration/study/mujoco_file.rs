//! A model of MuJoCo as the simulator of a study: the command of the Python package that runs it.

use std::collections::BTreeSet;
use std::path::Path;

use crate::calibration::study::simulator_file::is_of_recordings;
use realgap_core::file::read_limited;
use realgap_core::{Error, Result};
use realgap_guest::CommandLine;
use realgap_simulation::parameter::FOREIGN;

/// How options of the Python program begin.
const OPTION: &str = "--";
/// Largest file of a model that is searched for the files that it includes, bytes.
const MOST_BYTES: u64 = 16_000_000;

/// A model of MuJoCo, and how it is driven.
#[derive(Debug, Default)]
pub(in crate::calibration) struct MujocoFile<'a> {
    /// The model, relative to the study.
    pub model: &'a str,
    /// The body or site whose pose is compared.
    pub track: Option<&'a str>,
    /// Gains of the controller of motors.
    pub pd: Option<(f64, f64)>,
    /// The keyframe in which runs start.
    pub keyframe: Option<&'a str>,
    /// Time with the first command before each run, seconds.
    pub settle_s: Option<f64>,
    /// Whether the base is held.
    pub hold: bool,
    /// Further files that decide what it does.
    pub files: &'a [String],
    /// The Python that has realgap and mujoco.
    pub python: Option<&'a str>,
    /// Whether parameters are not tested before the study.
    pub no_probe: bool,
}

impl MujocoFile<'_> {
    /// The command that serves the model with these parameters.
    ///
    /// # Errors
    /// A model or a file that cannot be read.
    pub fn command(&self, folder: &Path, varied: &[&str]) -> Result<CommandLine> {
        let python = self.python.unwrap_or("python3");
        let mut words: Vec<String> = [python, "-m", "realgap.mujoco", self.model]
            .map(str::to_owned)
            .to_vec();
        let mut add = |option: &str, value: Option<String>| {
            words.extend(value.map(|value| format!("{OPTION}{option}={value}")));
        };
        let own = |name: &&str| -> Option<String> {
            let name = name
                .strip_prefix(FOREIGN)
                .and_then(|rest| rest.strip_prefix('.'))
                .unwrap_or(*name);
            (!is_of_recordings(name)).then(|| name.to_owned())
        };
        let names: BTreeSet<String> = varied.iter().filter_map(own).collect();
        names
            .into_iter()
            .for_each(|name| add("parameter", Some(name)));
        add("track", self.track.map(str::to_owned));
        add("pd", self.pd.map(|(kp, kd)| format!("{kp},{kd}")));
        add("keyframe", self.keyframe.map(str::to_owned));
        add("settle", self.settle_s.map(|seconds| seconds.to_string()));
        let flags = [("hold", self.hold), ("no-probe", self.no_probe)];
        let flags = flags.iter().filter(|(_, is_set)| *is_set);
        words.extend(flags.map(|(flag, _)| format!("{OPTION}{flag}")));
        let mut files = included(folder, self.model)?;
        files.extend(self.files.iter().cloned());
        CommandLine::new(words, folder, &files)
    }
}

/// The files that a model includes, and those that they include, relative to the folder of the study.
fn included(folder: &Path, model: &str) -> Result<Vec<String>> {
    let beside = Path::new(model).parent().unwrap_or(Path::new(""));
    let (mut found, mut next) = (Vec::new(), vec![model.to_owned()]);
    while let Some(name) = next.pop() {
        let path = folder.join(&name);
        let bytes = read_limited(&path, MOST_BYTES, "model")
            .map_err(|error| error.hint("the model of MuJoCo is named relative to the study"))?;
        let text = String::from_utf8_lossy(&bytes).into_owned();
        for (at, _) in text.match_indices("<include") {
            let Some(file) = attribute(&text[at..], "file") else {
                continue;
            };
            let name = beside.join(file).to_string_lossy().into_owned();
            // MuJoCo says itself what is wrong with a file that is missing or included twice.
            if !found.contains(&name) && folder.join(&name).is_file() {
                found.push(name.clone());
                next.push(name);
            }
            if found.len() > 1000 {
                return Err(Error::invalid("a model of more than 1000 files").at_file(path));
            }
        }
    }
    Ok(found)
}

/// The text of an attribute of the tag with which a text begins.
fn attribute<'a>(text: &'a str, name: &str) -> Option<&'a str> {
    let tag = &text[..text.find('>')?];
    let value = tag[tag.find(name)? + name.len()..].trim_start();
    let value = value.strip_prefix('=')?.trim_start();
    let quote = value.chars().next().filter(|c| ['"', '\''].contains(c))?;
    value[1..].split(quote).next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_names_what_the_study_varies_and_hashes_what_the_model_includes() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text);
        write("scene.xml", "<mujoco><include\n file='a.xml'/></mujoco>").unwrap();
        write("a.xml", "<mujoco><include file = \"b.xml\"/></mujoco>").unwrap();
        write("b.xml", "<mujoco/>").unwrap();
        let file = MujocoFile {
            pd: Some((20.0, 0.5)),
            model: "scene.xml",
            ..MujocoFile::default()
        };
        let varied = ["joint.a.damping", "sim.body.b.mass", "recording.scale"];
        let command = file.command(folder.path(), &varied).unwrap();
        assert_eq!(
            command.to_string(),
            "python3 -m realgap.mujoco scene.xml --parameter=body.b.mass --parameter=joint.a.damping --pd=20,0.5"
        );
        let files: Vec<&str> = command
            .files()
            .iter()
            .map(|(name, _)| name.as_str())
            .collect();
        assert_eq!(files, ["scene.xml", "a.xml", "b.xml"]);
        let missing = MujocoFile {
            model: "none.xml",
            ..MujocoFile::default()
        };
        assert!(missing.command(folder.path(), &[]).is_err());
    }
}
