//! `realgap sense picture`: what a simulated camera sees in a room.

mod motion;

use clap::ArgGroup;
use indicatif::ProgressBar;
use realgap::vision::camera::{
    ALPHABET_TEXT, Camera, Light, Motif, Scene, View, alphabet_picture, known, take,
};
use realgap::vision::{AlphabetFile, Picture as Bitmap, PictureSource, ViewsFile};

use motion::Moving;

use crate::cli::kit::*;

/// Take pictures with a simulated camera: a scene's posters, boxes and lights, seen through a lens and a sensor
///
/// Writes NAME.png for every viewpoint of the scene, or of a robot in motion, and beside them what `realgap sense
/// vision` needs: views.ron (what is where), template.png and alphabet.png. The same seed gives the same bytes.
///
/// --ride takes a camera along on a body: a mount of the scene says where it sits, where it looks, and where in the
/// room the motion begins; a mount with a `body` rides on that part of a file of `simulate --parts`, else on the
/// tracked module. A picture is called after its time, t_004.000.png. A camera inside of the body that carries it sees
/// only that body's shadow. --watch stands at the scene's viewpoints instead and writes side_t_000.500.png and so on.
/// --robot puts the robot into the pictures, and of a study what else is in its scene; it needs a run of all parts, or
/// orientations and the angles of all joints, or a robot of one part. What moves while the camera exposes is smeared,
/// as its own motion is. A run that leads through a wall or below the floor is refused.
#[derive(Debug, Args)]
#[command(group(ArgGroup::new("moving").args(["ride", "watch"])))]
#[command(after_help = "\
Examples:
  realgap sense picture scenes/room.ron --light badly --repeats 3 -o pictures
  realgap sense picture scenes/room.ron --ride tripod --run run.csv -o seen
  realgap sense picture scenes/pen.ron --watch snake --run parts.csv \\
      --robot morphologies/chain5.ron --every 0.5 --view side -o watched")]
pub struct Picture {
    /// The scene (scenes/*.ron)
    scene: PathBuf,
    /// Which of its cameras, or a .ron file with one (`realgap sense vision tune` writes it)
    #[arg(long, value_name = "NAME", default_value = "model")]
    camera: String,
    /// Which of its lights
    #[arg(long, value_name = "NAME", default_value = "well")]
    light: String,
    /// Only this viewpoint; may be given several times
    #[arg(long, value_name = "NAME")]
    view: Vec<String>,
    /// Ride along: a mount of the scene, in place of its viewpoints
    #[arg(long, value_name = "NAME", requires = "run", conflicts_with_all = ["view", "repeats"])]
    ride: Option<String>,
    /// Watch a robot from the viewpoints: a mount of the scene, which says where its motion begins
    #[arg(long, value_name = "NAME", requires_all = ["run", "robot"], conflicts_with = "repeats")]
    watch: Option<String>,
    /// The motion to ride along or to watch (`realgap simulate -o` or `--parts` writes it)
    #[arg(long, value_name = "FILE", requires = "moving")]
    run: Option<PathBuf>,
    /// The robot that moves, or a study of it with what else is in its scene: it is in the pictures, too
    #[arg(long, value_name = "MORPHOLOGY|STUDY", requires = "moving")]
    robot: Option<PathBuf>,
    /// A picture every so many seconds of the motion
    #[arg(long, value_name = "S", default_value_t = 1.0, requires = "moving")]
    every: f64,
    /// Pictures of every viewpoint, called NAME_1, NAME_2 and so on
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000))]
    repeats: Option<u16>,
    /// Seed of the camera's noise and places
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// The folder to write into
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    reading: ReadingOptions,
}

/// A camera of the scene, or of a file of its own.
pub(super) fn camera_named(scene: &Scene, name: &str) -> Result<Camera> {
    if Path::new(name).extension().is_some_and(|e| e == "ron") {
        return Camera::read(name);
    }
    scene
        .camera(name)
        .cloned()
        .map_err(|e| e.field("--camera").into_usage())
}

/// What the pictures of a viewpoint are counted from: each has a number of its own.
fn numbered(view: usize) -> u64 {
    1000 * view as u64
}

/// Width of the template, pixels: about as the logo is seen from three metres.
const TEMPLATE_PX: usize = 96;

impl Picture {
    pub fn run(self) -> Result<()> {
        let scene = Scene::read(&self.scene)?;
        let option = |name: &str, e: Error| e.field(name).into_usage();
        let camera = &camera_named(&scene, &self.camera)?;
        let light = scene.light(&self.light).map_err(|e| option("--light", e))?;
        for name in &self.view {
            realgap::file::look_up("view", name, &scene.views, |view| view.name.as_str())
                .map_err(|e| option("--view", e))?;
        }
        let moving = Moving::read(&self, &scene)?;
        let folder = &self.output;
        std::fs::create_dir_all(folder).map_err(|e| Error::io("make the folder", folder, &e))?;
        let mut file = ViewsFile {
            source: if camera.is_stand_in {
                PictureSource::StandIn
            } else {
                PictureSource::Simulated
            },
            description: format!(
                "{}, camera {}, light {}, seed {}",
                scene.name, camera.name, light.name, self.seed
            ),
            ..ViewsFile::default()
        };
        if scene.posters.iter().any(|p| p.motif == Motif::Logo) {
            let logo = Motif::Logo.picture()?.resized(TEMPLATE_PX, TEMPLATE_PX);
            logo.picture().write_png(folder.join("template.png"))?;
            file.template = Some("template.png".to_owned());
        }
        if scene
            .posters
            .iter()
            .any(|p| matches!(p.motif, Motif::Text(_)))
        {
            alphabet_picture()?
                .picture()
                .write_png(folder.join("alphabet.png"))?;
            file.alphabet = Some(AlphabetFile {
                picture: "alphabet.png".to_owned(),
                text: ALPHABET_TEXT.to_owned(),
            });
        }
        let mut album = Album {
            camera,
            light,
            folder,
            file,
            bar: progress::bar(0, "taking pictures"),
        };
        let taken = match &moving {
            Some(moving) => moving.take(&self, &scene, &mut album),
            None => self.stand(&scene, &mut album),
        };
        album.bar.finish_and_clear();
        taken?;
        album.file.write(folder)?;
        if camera.is_stand_in {
            terminal::print_warnings(&[Code::StandIn.warning(format!(
                "pictures of the camera {} stand in for real ones",
                camera.name
            ))]);
        }
        terminal::print(format!(
            "{} in {}",
            counted(album.file.views.len(), "picture"),
            folder.display()
        ));
        Ok(())
    }

    /// The viewpoints that are asked for, each with its number in the scene.
    fn views<'a>(&self, scene: &'a Scene) -> impl Iterator<Item = (usize, &'a View)> {
        let all = scene.views.iter().enumerate();
        all.filter(|(_, view)| self.view.is_empty() || self.view.contains(&view.name))
    }

    /// Pictures from the scene's viewpoints.
    fn stand(&self, scene: &Scene, album: &mut Album<'_>) -> Result<()> {
        let repeats = self.repeats.unwrap_or(1);
        album.expect(self.views(scene).count() * usize::from(repeats));
        for (index, view) in self.views(scene) {
            for repeat in 1..=repeats {
                let name = match self.repeats {
                    None => view.name.clone(),
                    Some(_) => format!("{}_{repeat}", view.name),
                };
                // A view's pictures do not depend on which others are taken.
                let number = numbered(index) + u64::from(repeat);
                let (picture, pose) =
                    take(scene, album.camera, view, album.light, self.seed, number)?;
                album.keep(&picture, scene, &View { name, pose })?;
            }
        }
        Ok(())
    }
}

/// The folder that pictures go into, and with what they are taken.
struct Album<'a> {
    camera: &'a Camera,
    light: &'a Light,
    folder: &'a Path,
    file: ViewsFile,
    bar: ProgressBar,
}

impl Album<'_> {
    /// So many pictures will come.
    fn expect(&self, pictures: usize) {
        self.bar.set_length(pictures as u64);
    }

    /// Writes a picture of a room, and what is to be found in it.
    fn keep(&mut self, picture: &Bitmap, room: &Scene, view: &View) -> Result<()> {
        picture.write_png(self.folder.join(format!("{}.png", view.name)))?;
        let known = known(room, self.camera, &view.pose, &view.name);
        self.file.views.push(known);
        self.bar.inc(1);
        Ok(())
    }
}
