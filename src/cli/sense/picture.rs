//! `realgap sense picture`: renders pictures of a room with a simulated camera.

mod motion;

use clap::ArgGroup;
use indicatif::ProgressBar;
use realgap::vision::camera::{
    ALPHABET_TEXT, Camera, Light, Motif, Scene, View, alphabet_picture, known, take,
};
use realgap::vision::{AlphabetFile, Picture as Bitmap, PictureSource, ViewsFile};

use motion::Moving;

use crate::cli::kit::*;

/// Render pictures of a scene with a simulated camera, including its lens and sensor
///
/// Use it to try image processing on simulated pictures, alone or next to real ones (`realgap sense vision compare`).
///
/// The command writes NAME.png for every viewpoint of the scene, or for every time of a robot's motion, and in the
/// same folder the files that `realgap sense vision` needs: views.ron (which feature is where), template.png and
/// alphabet.png. The same seed gives the same bytes.
///
/// --ride mounts the camera on a moving body. A mount of the scene says where the camera sits, where it looks, and
/// where in the room the motion begins; a mount with a `body` rides on that part of a file of `simulate --parts`, any
/// other mount on the tracked module. Each picture is named after its time, e.g. t_004.000.png. A camera inside of
/// the body that carries it sees only that body's shadow. --watch takes the pictures from the scene's viewpoints
/// instead, and names them side_t_000.500.png and so on. --robot adds the robot to the pictures and, where it names a
/// study, the other bodies of the study's scene; it needs a run of all parts, or orientations and the angles of all
/// joints, or a robot of one part. What moves during the exposure is blurred, and so is everything where the camera
/// moves. A run that leads through a wall or below the floor is refused.
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
    /// Camera of the scene, or a .ron file with a camera (`realgap sense vision tune` writes it)
    #[arg(long, value_name = "NAME", default_value = "model")]
    camera: String,
    /// Light of the scene
    #[arg(long, value_name = "NAME", default_value = "well")]
    light: String,
    /// Only this viewpoint; may be given several times
    #[arg(long, value_name = "NAME")]
    view: Vec<String>,
    /// Take the pictures from this mount of the scene, on the moving body, in place of the viewpoints
    #[arg(long, value_name = "NAME", requires = "run", conflicts_with_all = ["view", "repeats"])]
    ride: Option<String>,
    /// Take pictures of a moving robot from the viewpoints; this mount of the scene says where its motion begins
    #[arg(long, value_name = "NAME", requires_all = ["run", "robot"], conflicts_with = "repeats")]
    watch: Option<String>,
    /// Trajectory of the motion (`realgap simulate -o` or `--parts` writes it)
    #[arg(long, value_name = "FILE", requires = "moving")]
    run: Option<PathBuf>,
    /// The robot to show in the pictures, or a study, whose robot and scene are shown
    #[arg(long, value_name = "MORPHOLOGY|STUDY", requires = "moving")]
    robot: Option<PathBuf>,
    /// Time between two pictures, in seconds of the motion
    #[arg(long, value_name = "S", default_value_t = 1.0, requires = "moving")]
    every: f64,
    /// Number of pictures from every viewpoint, named NAME_1, NAME_2 and so on
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000))]
    repeats: Option<u16>,
    /// Seed of the camera's noise and of its errors of position
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// The folder to write into
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    reading: ReadingOptions,
}

/// A camera of the scene, or the camera of a file.
pub(super) fn camera_named(scene: &Scene, name: &str) -> Result<Camera> {
    if Path::new(name).extension().is_some_and(|e| e == "ron") {
        return Camera::read(name);
    }
    scene
        .camera(name)
        .cloned()
        .map_err(|e| e.field("--camera").into_usage())
}

/// The number before the first picture of a viewpoint; every picture has its own number, which seeds its noise.
fn numbered(view: usize) -> u64 {
    1000 * view as u64
}

/// Width of the template, pixels: about the width of the logo when it is seen from three metres.
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

    /// The viewpoints that `--view` names, each with its number in the scene.
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
                // The pictures of a view must not depend on the other views.
                let number = numbered(index) + u64::from(repeat);
                let (picture, pose) =
                    take(scene, album.camera, view, album.light, self.seed, number)?;
                album.keep(&picture, scene, &View { name, pose })?;
            }
        }
        Ok(())
    }
}

/// The output folder, with the camera and the light of its pictures.
struct Album<'a> {
    camera: &'a Camera,
    light: &'a Light,
    folder: &'a Path,
    file: ViewsFile,
    bar: ProgressBar,
}

impl Album<'_> {
    /// Sets the number of pictures of the progress bar.
    fn expect(&self, pictures: usize) {
        self.bar.set_length(pictures as u64);
    }

    /// Writes a picture, and records which features it shows where.
    fn keep(&mut self, picture: &Bitmap, room: &Scene, view: &View) -> Result<()> {
        picture.write_png(self.folder.join(format!("{}.png", view.name)))?;
        let known = known(room, self.camera, &view.pose, &view.name);
        self.file.views.push(known);
        self.bar.inc(1);
        Ok(())
    }
}
