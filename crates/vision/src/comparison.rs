//! Compares simulated with real pictures by extracted features, and tests whether bad light changes them more than simulation does.

mod text;

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde::Serialize;

use super::album::{Album, stem};
use super::alignment::{Motion, RelativeTo};
use super::codec::size_of;
use super::extractor::{Extractor, Feature, Measure, Sought};
use super::option::VisionOptions;
use super::picture::{Grey, MOST_PIXELS};
use super::program::Program;
use super::views::PictureSource;
use realgap_core::error::{Error, Result};
use realgap_core::statistics::{
    PairedTest, mean, percentile_interval, smaller_resamples, wilcoxon_signed_rank,
};
use realgap_core::unit::counted;
use realgap_core::warning::{Code, Warning};

/// Number of resamples for an interval, and share of them below and above it.
const RESAMPLES: usize = 2000;
const TAIL: f64 = 0.05;
/// Level of significance of tests.
const SIGNIFICANT: f64 = 0.05;
/// With fewer views, a test cannot be significant at that level.
const FEW_VIEWS: usize = 6;

/// A mean over views with a 90 % interval (bootstrap over views).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Mean {
    /// The mean.
    pub value: f64,
    /// The 90 % interval of the mean; `None` for a single view.
    pub interval: Option<(f64, f64)>,
    /// Number of views.
    pub views: usize,
}

impl Mean {
    fn of(values: impl Iterator<Item = Option<f64>>, seed: u64) -> Option<Self> {
        let values: Vec<f64> = values.flatten().collect();
        if values.is_empty() {
            return None;
        }
        let means: Vec<f64> = smaller_resamples(values.len(), RESAMPLES, seed)
            .iter()
            .map(|resample| resample.mean(&values))
            .collect();
        Some(Self {
            value: mean(&values),
            interval: percentile_interval(&means, TAIL),
            views: values.len(),
        })
    }
}

/// The results of one extractor for one view. Errors are distances from the known truth; the other values are distances between the
/// features of two pictures. If there are several pictures of a view, values are means.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ViewRow {
    /// Name of the view.
    pub view: String,
    /// Error in the simulated picture.
    pub simulated_error: Option<f64>,
    /// Error in the real pictures.
    pub real_error: Option<f64>,
    /// Error in the badly lit pictures.
    pub badly_lit_error: Option<f64>,
    /// Distance from simulated to real pictures: the gap.
    pub simulated_real: Option<f64>,
    /// Distance from badly lit to real pictures.
    pub badly_lit_real: Option<f64>,
    /// Distance from simulated to badly lit pictures.
    pub simulated_badly_lit: Option<f64>,
    /// Distance between real pictures of the same view: the noise floor.
    pub floor: Option<f64>,
}

/// Whether a simulated picture is nearer to a real one than a badly lit one is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Answer {
    /// The simulated picture is nearer.
    Nearer,
    /// The simulated picture is farther away.
    Farther,
    /// The test is not significant.
    Open,
}

/// The paired comparison of simulated and badly lit pictures with real ones: the answer and its test.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PairedComparison {
    /// Whether the simulated or the badly lit picture is nearer.
    pub answer: Answer,
    /// Number of views in which the simulated picture is nearer.
    pub nearer: usize,
    /// Number of views in which both distances are equal.
    pub equal: usize,
    /// Number of views.
    pub views: usize,
    /// Wilcoxon's signed-rank test of the distance of badly lit pictures minus that of simulated ones.
    pub test: PairedTest,
}

/// The results of one extractor.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ExtractorReport {
    /// Name of the extractor.
    pub extractor: &'static str,
    /// The other program that the extractor calls, with its version; `None` for an extractor of this library.
    pub program: Option<String>,
    /// The figure of paper 002 that shows the same comparison.
    pub figure: u8,
    /// The quantity of errors.
    pub error_measure: Option<Measure>,
    /// The quantity of distances.
    pub distance_measure: Measure,
    /// Error in simulated pictures.
    pub simulated_error: Option<Mean>,
    /// Error in real pictures.
    pub real_error: Option<Mean>,
    /// Error in badly lit pictures.
    pub badly_lit_error: Option<Mean>,
    /// Distance from simulated to real pictures.
    pub gap: Option<Mean>,
    /// Distance from badly lit to real pictures.
    pub badly_lit: Option<Mean>,
    /// Distance between real pictures of the same view: the noise floor.
    pub floor: Option<Mean>,
    /// Gap divided by noise floor, if the noise floor is above 0.
    pub gap_ratio: Option<f64>,
    /// The comparison with badly lit pictures, if there are any.
    pub verdict: Option<PairedComparison>,
    /// The results for each view.
    pub views: Vec<ViewRow>,
}

/// The comparison of simulated with real pictures.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct VisionReport {
    /// Source of the "real" pictures.
    pub real: PictureSource,
    /// Whether pictures were aligned before distances were computed.
    pub relative_to: RelativeTo,
    /// Names of the views.
    pub views: Vec<String>,
    /// One entry for each extractor for which the views state something to search for.
    pub extractors: Vec<ExtractorReport>,
    /// Warnings to the reader.
    pub warnings: Vec<Warning>,
}

/// The pictures of one view, each with what extractors search for in it.
struct View {
    name: String,
    /// The simulated, real and badly lit pictures.
    groups: [Vec<(PathBuf, Sought)>; 3],
    /// Whether positions are known for a real picture itself (not only for the view).
    is_known: bool,
}

/// The features that an extractor found in the simulated, real and badly lit pictures of a view.
type Found = [Vec<Option<Feature>>; 3];

/// Compares the pictures of two folders, paired by name. With a third folder of badly lit pictures, it also tests whether a simulated
/// picture is nearer to a real one than a badly lit one is. Several real pictures of a view are named `NAME_1`, `NAME_2`, … The camera
/// is displaced at random in every real picture but not in a simulated one; therefore pictures are aligned by the positions that are
/// known for each of them.
///
/// # Errors
/// Folders without pictures, no common name, pictures that cannot be read, pictures of one view with different sizes.
pub fn compare_folders(
    simulated: impl AsRef<Path>,
    real: impl AsRef<Path>,
    badly_lit: Option<&Path>,
    options: &VisionOptions,
) -> Result<VisionReport> {
    let relative_to = options.relative_to;
    let programs = options.extractors.iter().filter_map(|e| e.program());
    // Programs are checked before any picture is read, because a missing program is an error for all pictures.
    programs.map(Program::version).collect::<Result<Vec<_>>>()?;
    let simulated = Album::read(simulated.as_ref())?;
    let real = Album::read(real.as_ref())?;
    let badly_lit = badly_lit.map(Album::read).transpose()?;
    let mut warnings = Vec::new();
    let views = paired(&simulated, &real, badly_lit.as_ref(), &mut warnings)?;
    let mut of_extractor: Vec<Vec<ViewRow>> = vec![Vec::new(); options.extractors.len()];
    for few in views.chunks(at_once(&views)?) {
        let found: Vec<(Vec<Option<ViewRow>>, Vec<Warning>)> = few
            .par_iter()
            .map(|view| look_at(view, options))
            .collect::<Result<_>>()?;
        for (its, own_warnings) in found {
            for (rows, row) in of_extractor.iter_mut().zip(its) {
                rows.extend(row);
            }
            warnings.extend(own_warnings);
        }
    }
    let mut extractors = Vec::new();
    for (extractor, rows) in options.extractors.iter().zip(of_extractor) {
        if !rows.is_empty() {
            extractors.push(report(*extractor, rows, options.seed)?);
        }
    }
    if extractors.is_empty() {
        let names: Vec<&str> = options.extractors.iter().map(|e| e.name()).collect();
        return Err(
            Error::invalid("the views state nothing that the extractors could search for")
                .at_file(simulated.folder)
                .field("extractor")
                .found(names.join(", "))
                .hint("the file views.ron states what to search for in each view"),
        );
    }
    warnings.extend(real.source().warning());
    if relative_to == RelativeTo::Own && !views.iter().any(|view| view.is_known) {
        warnings.push(Code::NoOwnPlaces.warning(
            "views.ron of the real pictures does not state positions of things in them, so distances include the displacement of the camera",
        ));
    }
    if views.len() < FEW_VIEWS {
        warnings.push(Code::FewRecordings.warning(format!(
            "{}: with fewer than {FEW_VIEWS}, no test can be significant at 5 %",
            counted(views.len(), "view")
        )));
    }
    Ok(VisionReport {
        real: real.source(),
        relative_to,
        views: views.into_iter().map(|view| view.name).collect(),
        extractors,
        warnings,
    })
}

fn paired(
    simulated: &Album,
    real: &Album,
    badly_lit: Option<&Album>,
    warnings: &mut Vec<Warning>,
) -> Result<Vec<View>> {
    let mut views = Vec::new();
    let mut unpaired = Vec::new();
    for (name, path) in &simulated.pictures {
        let model = simulated.views.sought(name).cloned().unwrap_or_default();
        // What is known of a picture itself takes precedence over what is known of the view in its folder, and that over what is known
        // of the simulated picture.
        let of = |album: &Album| -> Vec<(PathBuf, Sought)> {
            let its = album.of_view(name, &simulated.pictures);
            its.into_iter()
                .map(|path| {
                    let own = album.views.sought(&stem(path));
                    let own = own.or(album.views.sought(name));
                    let own = own.cloned().unwrap_or_default();
                    (path.clone(), merged(own, &model))
                })
                .collect()
        };
        let (its_real, its_bad) = (of(real), badly_lit.map(of).unwrap_or_default());
        if its_real.is_empty() || (badly_lit.is_some() && its_bad.is_empty()) {
            unpaired.push(name.as_str());
            continue;
        }
        let places =
            |sought: &Sought| sought.template_at_px.is_some() || !sought.outline_px.is_empty();
        let of_itself =
            |(path, _): &(PathBuf, Sought)| real.views.sought(&stem(path)).is_some_and(places);
        views.push(View {
            is_known: its_real.iter().any(of_itself),
            name: name.clone(),
            groups: [vec![(path.clone(), model.clone())], its_real, its_bad],
        });
    }
    if views.is_empty() {
        let names = |album: &Album| {
            let names: Vec<&str> = album.pictures.keys().take(5).map(String::as_str).collect();
            names.join(", ")
        };
        return Err(Error::invalid("no pictures have the same name")
            .at_file(&real.folder)
            .found(names(real))
            .allowed(format!(
                "names of {}: {}",
                simulated.folder.display(),
                names(simulated)
            ))
            .hint("a real picture is NAME.png, several of one view are NAME_1.png, NAME_2.png"));
    }
    if !unpaired.is_empty() {
        warnings.push(Code::PicturesUnpaired.warning(format!(
            "left out, because the other folder has no picture of this name: {}",
            unpaired.join(", ")
        )));
    }
    Ok(views)
}

fn merged(own: Sought, model: &Sought) -> Sought {
    Sought {
        template: own.template.or(model.template.clone()),
        template_at_px: own.template_at_px.or(model.template_at_px),
        start_px: if own.start_px.is_empty() {
            model.start_px.clone()
        } else {
            own.start_px
        },
        outline_px: if own.outline_px.is_empty() {
            model.outline_px.clone()
        } else {
            own.outline_px
        },
        text_region: own.text_region.or(model.text_region),
        text: own.text.or(model.text.clone()),
        alphabet: own.alphabet.or(model.alphabet.clone()),
    }
}

/// Number of views that are processed at the same time, so that memory does not grow with the number of views: one picture of each has
/// at most [`MOST_PIXELS`] pixels in all.
fn at_once(views: &[View]) -> Result<usize> {
    let mut largest = 1;
    for (path, _) in views.iter().flat_map(|view| &view.groups[0]) {
        let (width, height) = size_of(path)?;
        largest = largest.max(width * height);
    }
    Ok((MOST_PIXELS / largest).max(1))
}

/// Runs every extractor on every picture of a view; one row for each extractor for which the view states something to search for.
fn look_at(view: &View, options: &VisionOptions) -> Result<(Vec<Option<ViewRow>>, Vec<Warning>)> {
    let extractors = &options.extractors;
    let mut size = None;
    let mut warnings = Vec::new();
    let mut found: Vec<Found> = vec![Found::default(); extractors.len()];
    for (group, pictures) in view.groups.iter().enumerate() {
        for (path, sought) in pictures {
            let picture = Grey::read(path)?;
            let its = (picture.width(), picture.height());
            let first = *size.get_or_insert(its);
            if its != first {
                return Err(
                    Error::invalid("the pictures of a view have different sizes")
                        .at_file(path)
                        .field(&view.name)
                        .found(format!("{} x {} px", its.0, its.1))
                        .allowed(format!(
                            "{} x {} px, as the simulated one",
                            first.0, first.1
                        ))
                        .hint("scale or crop them to the same size"),
                );
            }
            for (extractor, found) in extractors.iter().zip(&mut found) {
                if !extractor.is_sought(sought) {
                    found[group].push(None);
                    continue;
                }
                let extraction = extractor
                    .extract(&picture, sought)
                    .map_err(|e| e.at_file(path))?;
                found[group].push(Some(extraction.feature));
                warnings.extend(
                    extraction
                        .warnings
                        .into_iter()
                        .map(|w| w.code.warning(format!("{}: {}", path.display(), w.message))),
                );
            }
        }
    }
    let is_sought = |extractor: &dyn Extractor| {
        let all = &view.groups[0];
        all.iter().all(|(_, sought)| extractor.is_sought(sought))
    };
    let rows = extractors.iter().zip(&found).map(|(extractor, found)| {
        is_sought(*extractor).then(|| row(*extractor, view, found, options.relative_to))
    });
    Ok((rows.collect(), warnings))
}

fn row(extractor: &dyn Extractor, view: &View, found: &Found, relative_to: RelativeTo) -> ViewRow {
    let some = |values: Vec<f64>| (!values.is_empty()).then(|| mean(&values));
    let error = |group: usize| {
        let errors = found[group].iter().zip(&view.groups[group]);
        let errors = errors.filter_map(|(f, (_, sought))| extractor.error(f.as_ref()?, sought));
        some(errors.collect())
    };
    let each = |group: usize| {
        let known = view.groups[group].iter().map(|(_, sought)| sought);
        let both = found[group].iter().zip(known);
        both.filter_map(|(f, sought)| Some((f.as_ref()?, sought)))
            .collect::<Vec<_>>()
    };
    let distance =
        |(x, at_x): (&Feature, &Sought), (y, at_y): (&Feature, &Sought)| match relative_to {
            RelativeTo::View => extractor.distance(x, y),
            RelativeTo::Own => extractor.distance(x, &Motion::between(at_y, at_x).moved(y)),
        };
    let between = |a: usize, b: usize| {
        let mut all = Vec::new();
        for x in each(a) {
            all.extend(each(b).into_iter().filter_map(|y| distance(x, y)));
        }
        some(all)
    };
    let floor = {
        let real = each(1);
        let mut all = Vec::new();
        for (index, x) in real.iter().enumerate() {
            let others = real[index + 1..].iter();
            all.extend(others.filter_map(|y| distance(*x, *y)));
        }
        some(all)
    };
    ViewRow {
        view: view.name.clone(),
        simulated_error: error(0),
        real_error: error(1),
        badly_lit_error: error(2),
        simulated_real: between(0, 1),
        badly_lit_real: between(2, 1),
        simulated_badly_lit: between(0, 2),
        floor,
    }
}

fn report(extractor: &dyn Extractor, views: Vec<ViewRow>, seed: u64) -> Result<ExtractorReport> {
    let of = |value: fn(&ViewRow) -> Option<f64>| Mean::of(views.iter().map(value), seed);
    let (gap, floor) = (of(|v| v.simulated_real), of(|v| v.floor));
    let differences: Vec<f64> = views
        .iter()
        .filter_map(|v| Some(v.badly_lit_real? - v.simulated_real?))
        .collect();
    let verdict = if differences.is_empty() {
        None
    } else {
        let test = wilcoxon_signed_rank(&differences)?;
        Some(PairedComparison {
            answer: match test.p_value < SIGNIFICANT {
                true if test.effect > 0.0 => Answer::Nearer,
                true => Answer::Farther,
                false => Answer::Open,
            },
            nearer: differences.iter().filter(|d| **d > 0.0).count(),
            equal: differences.iter().filter(|d| **d == 0.0).count(),
            views: differences.len(),
            test,
        })
    };
    Ok(ExtractorReport {
        extractor: extractor.name(),
        program: match extractor.program() {
            Some(program) => Some(program.version()?.to_owned()),
            None => None,
        },
        figure: extractor.figure(),
        error_measure: extractor.error_measure(),
        distance_measure: extractor.distance_measure(),
        simulated_error: of(|v| v.simulated_error),
        real_error: of(|v| v.real_error),
        badly_lit_error: of(|v| v.badly_lit_error),
        gap_ratio: match (gap, floor) {
            (Some(gap), Some(floor)) if floor.value > 0.0 => Some(gap.value / floor.value),
            _ => None,
        },
        gap,
        badly_lit: of(|v| v.badly_lit_real),
        floor,
        verdict,
        views,
    })
}
