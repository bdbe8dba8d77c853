//! `realgap sense vision`: compares features of simulated and real pictures.

use realgap::results::draw_vision;
use realgap::vision::camera::Scene;
use realgap::vision::tuning::{CameraOptions, tune_camera};
use realgap::vision::{
    EXTRACTORS, Extractor, Grey, RelativeTo, Step, Views, VisionOptions, compare_folders,
    contact_sheet, extractor_by_name, own_extractors, stacked,
};

use super::picture::camera_named;
use crate::cli::kit::*;

commands! {
    /// Compare simulated pictures with real ones by the features that image processing finds in them (paper 002)
    ///
    /// Four extractors: edges (Canny), a template (correlation in the Fourier domain), a contour (a greedy snake),
    /// and text. views.ron in the folder of simulated pictures says which feature is where; `realgap sense picture`
    /// writes it.
    VisionCommand:
    Compare(Compare),
    Extract(Extract),
    Tune(Tune),
}

/// Measure whether simulated pictures are nearer to real ones than badly lit real pictures are
///
/// Use it to decide whether image processing can be developed on the simulated pictures. Pictures (.png, .jpg; at
/// most 32 megapixels) are paired by name. Several real pictures of a view are called NAME_1, NAME_2 and so on; their
/// distances to each other are the noise floor. 90 % intervals are computed by bootstrap over views, the answer by
/// Wilcoxon's signed-rank test with the rank-biserial correlation as effect size.
///
/// A camera cannot be put down twice at exactly the same place. Therefore one picture is turned and shifted over the
/// other by the camera poses in their views.ron, never scaled. Otherwise simulated pictures would look better than
/// they are, because two real pictures differ by two errors of position and not by one. Where the real pictures have
/// no views.ron of their own, this is not possible, and a warning says so.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap sense vision compare simulated real --badly-lit real_dark -o figures")]
pub struct Compare {
    /// Folder of simulated pictures, with views.ron
    simulated: PathBuf,
    /// Folder of real pictures of the same views, well lit
    real: PathBuf,
    /// Folder of real pictures of the same views, badly lit
    #[arg(long, value_name = "DIR")]
    badly_lit: Option<PathBuf>,
    /// Use only this extractor; may be given several times [default: edges, template, contour and text]
    #[arg(long, value_name = "NAME")]
    extractor: Vec<String>,
    /// Draw edges, template, contour and text as .png and .svg into this folder (as figures 5, 6, 8 and 11 of paper 002)
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Whether differences between camera positions count (view), or are removed with the poses in views.ron (own)
    #[arg(long, value_parser = choice(RELATIVE), default_value = "own")]
    relative_to: RelativeTo,
    /// Also print every view
    #[arg(long)]
    views: bool,
    /// Seed of the bootstrap
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    telling: Telling,
}

/// Frames to which places and poses are relative.
const RELATIVE: &[Choice<RelativeTo>] =
    &[("own", RelativeTo::Own, ""), ("view", RelativeTo::View, "")];

/// Show what one extractor finds in pictures, step by step
///
/// Use it to see why two pictures differ in `realgap sense vision compare`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap sense vision extract desk.png --extractor contour -o steps.png")]
pub struct Extract {
    /// The pictures; views.ron in the same folder says what to look for
    #[arg(required = true, value_name = "PICTURE")]
    pictures: Vec<PathBuf>,
    /// edges, template, contour or text; tesseract in a build with `--features tesseract`
    #[arg(long, value_name = "NAME", default_value = "edges")]
    extractor: String,
    /// The view of views.ron [default: the picture's name]
    #[arg(long, value_name = "NAME")]
    view: Option<String>,
    /// Draw the steps side by side into this .png, a row for each picture (as figures 2, 3, 4, 7, 9, 10 and 12 of paper 002)
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Fit the settings of a simulated camera to real pictures of a known room
///
/// Use it to make simulated pictures comparable with those of your own camera. First, corners of the room that are
/// found in the pictures give the field of view, the distortion, and where each picture was taken. Then the
/// appearance of the pictures gives exposure, gain, read noise and blur, and a second compression gives the JPEG
/// quality. 90 % intervals are computed from the differences between views; views that are held out check the result.
/// The command says which settings the pictures do not determine: a gain that the camera sets itself, or the JPEG
/// quality of pictures that were scaled afterwards. Exposure is given in electrons, so it is only as accurate as the
/// scene's light.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  realgap sense vision tune scenes/room.ron real -o camera.ron
  realgap sense picture scenes/room.ron --camera camera.ron -o tuned")]
pub struct Tune {
    /// The scene (scenes/*.ron) that the pictures show
    scene: PathBuf,
    /// Folder of real pictures, named after the scene's views
    real: PathBuf,
    /// The camera to begin with: one of the scene, or a .ron file
    #[arg(long, value_name = "NAME", default_value = "model")]
    camera: String,
    /// Light of the scene
    #[arg(long, value_name = "NAME", default_value = "well")]
    light: String,
    /// A view to hold out from the fit; may be given several times [default: every third of six or more]
    #[arg(long, value_name = "NAME")]
    hold_out: Vec<String>,
    /// Standard deviation of the camera's position along each axis, centimetres
    #[arg(long, value_name = "CM", default_value_t = 2.0)]
    place_sd: f64,
    /// About how often all pictures may be simulated in the search
    #[arg(long, value_name = "N", default_value_t = 400, value_parser = clap::value_parser!(u32).range(20..=100_000))]
    budget: u32,
    /// Seed of the simulated noise and of the search
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Write the camera into this .ron file, for `realgap sense picture --camera FILE`
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    print: Print,
}

/// The extractor that an option names.
fn extractor_named(name: &str) -> Result<&'static dyn Extractor> {
    extractor_by_name(name).map_err(|e| {
        let names: Vec<&str> = EXTRACTORS.iter().map(|e| e.name()).collect();
        e.field("--extractor")
            .allowed(names.join(", "))
            .into_usage()
    })
}

impl Compare {
    /// The extractors that `--extractor` names, each once, in the order of the registry.
    fn extractors(&self) -> Result<Vec<&'static dyn Extractor>> {
        if self.extractor.is_empty() {
            return Ok(own_extractors());
        }
        let named = self.extractor.iter().map(|name| extractor_named(name));
        let named: Vec<&str> = named
            .map(|extractor| Ok(extractor?.name()))
            .collect::<Result<_>>()?;
        let asked = EXTRACTORS.iter().filter(|e| named.contains(&e.name()));
        Ok(asked.copied().collect())
    }

    pub fn run(self) -> Result<()> {
        self.telling.check()?;
        let extractors = self.extractors()?;
        if let Some(folder) = &self.output {
            std::fs::create_dir_all(folder)
                .map_err(|e| Error::io("make the folder", folder, &e))?;
        }
        let badly_lit = self.badly_lit.as_deref();
        let spinner = progress::spinner("comparing pictures");
        let report = compare_folders(
            &self.simulated,
            &self.real,
            badly_lit,
            &VisionOptions {
                extractors,
                relative_to: self.relative_to,
                seed: self.seed,
            },
        );
        spinner.finish_and_clear();
        let report = report?;
        let pictures = match &self.output {
            Some(folder) => draw_vision(&report, folder)?,
            None => Vec::new(),
        };
        self.telling.write(
            "vision",
            &self.real,
            &report,
            &report.to_string(),
            &pictures,
        )?;
        terminal::print_warnings(&report.warnings);
        self.telling.print.answer(&report, || {
            let shown = report.extractors.iter().filter(|_| self.views);
            let views: Vec<String> = shown.map(|extractor| format!("\n{extractor}")).collect();
            format!("{report}{}", views.concat())
        })
    }
}

impl Tune {
    pub fn run(self) -> Result<()> {
        output::check_all(&self.output)?;
        if !(self.place_sd > 0.0 && self.place_sd <= 1000.0) {
            return Err(Error::invalid("not a standard deviation of positions")
                .field("--place-sd")
                .found(self.place_sd)
                .allowed("above 0 to 1000 cm")
                .into_usage());
        }
        let scene = Scene::read(&self.scene)?;
        let camera = camera_named(&scene, &self.camera)?;
        let light = scene
            .light(&self.light)
            .map_err(|e| e.field("--light").into_usage())?;
        let options = CameraOptions {
            held_out: (!self.hold_out.is_empty()).then_some(self.hold_out),
            place_sd_m: 0.01 * self.place_sd,
            budget: self.budget as usize,
            seed: self.seed,
        };
        let what = "simulating all pictures, at most";
        let tuned = progress::during(options.budget, what, Default::default(), |run| {
            tune_camera(&scene, &camera, light, &self.real, &options, run.progress)
        })?;
        if let Some(output) = &self.output {
            output::write_ron(output, &tuned.camera.to_ron()?)?;
        }
        terminal::print_warnings(&tuned.warnings);
        self.print.value(&tuned)
    }
}

impl Extract {
    pub fn run(self) -> Result<()> {
        let extractor = extractor_named(&self.extractor)?;
        if let Some(program) = extractor.program() {
            program.version()?;
        }
        output::check_all(&self.output)?;
        let mut rows = Vec::new();
        for path in &self.pictures {
            if self.pictures.len() > 1 {
                terminal::print(format!("{}:", path.display()));
            }
            let steps = self.look_at(extractor, path)?;
            if self.output.is_some() {
                rows.push(contact_sheet(&steps));
            }
        }
        if let Some(output) = &self.output {
            stacked(&rows)?.picture().write_png(output)?;
        }
        Ok(())
    }

    /// Prints what is found in one picture, and returns the steps.
    fn look_at(&self, extractor: &dyn Extractor, path: &Path) -> Result<Vec<Step>> {
        let picture = Grey::read(path)?;
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
        let views = Views::read(folder.unwrap_or(Path::new(".")))?;
        let own = path.file_stem().unwrap_or_default().to_string_lossy();
        let sought = views.sought(self.view.as_deref().unwrap_or(&own));
        let sought = sought.cloned().unwrap_or_default();
        let found = extractor.extract(&picture, &sought).map_err(|e| {
            e.at_file(path)
                .or_hint("views.ron beside it says what to look for")
        })?;
        terminal::print_warnings(&found.warnings);
        for remark in &found.remarks {
            terminal::print(remark);
        }
        if let Some(text) = &found.feature.text {
            terminal::print(text);
        }
        if let (Some(error), Some(measure)) = (
            extractor.error(&found.feature, &sought),
            extractor.error_measure(),
        ) {
            terminal::print(format!("{}: {error:.3} {}", measure.name, measure.unit).trim_end());
        }
        Ok(found.steps)
    }
}
