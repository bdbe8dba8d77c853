//! Reading and writing of genome files: a genome, a name, and the settings of its development.

use std::fmt::Write as _;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::development::Development;
use super::development_error::DevelopmentError;
use super::locus::Locus;
use super::sequence::{Gene, Genome, check_value};
use crate::morphology::Morphology;
use realgap_core::file::{Source, parse_ron, write_ron};
use realgap_core::{Error, Result};

/// The content of a genome file: a genome, a name and the settings of its development.
#[derive(Debug, Clone, PartialEq)]
pub struct Individual {
    /// Name of the robot: letters, digits, `_` and `-`.
    pub name: String,
    /// The genes.
    pub genome: Genome,
    /// The settings by which the genes are developed into a robot.
    pub development: Development,
}

/// The RON form of a genome file.
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename = "Genome")]
pub struct IndividualFile {
    /// Name of the robot.
    #[serde(default = "unnamed")]
    name: String,
    /// Number of modules, which is the number of genes.
    modules: usize,
    /// Ten numbers from 0 to 1 for each module.
    genes: Vec<Vec<f64>>,
    /// Settings of development: how the genes are translated into a robot.
    #[serde(default)]
    development: Development,
}

fn unnamed() -> String {
    "robot".to_owned()
}

impl Individual {
    /// A genome with the default settings.
    pub fn new(name: impl Into<String>, genome: Genome) -> Self {
        Self {
            name: name.into(),
            genome,
            development: Development::default(),
        }
    }

    /// Reads a RON file.
    ///
    /// # Errors
    /// As [`Source::read`] and [`Individual::parse`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        Self::parse(&Source::read(path, "genome")?)
    }

    /// Parses a RON text.
    ///
    /// # Errors
    /// Text that is not RON of the form described in the [module documentation](super); genes of the wrong length, numbers that
    /// are NaN or out of bounds; settings out of range. Every error names file, line and column.
    pub fn parse(source: &Source) -> Result<Self> {
        let file = parse_ron::<IndividualFile>(source)?;
        let at = |path: &str, error: Error| source.at(path, error).field(path);
        Morphology::check_name(&file.name).map_err(|e| at("name", e))?;
        if file.modules != file.genes.len() {
            return Err(at(
                "genes",
                Error::invalid("the genome has the wrong length")
                    .found(format!("{} genes", file.genes.len()))
                    .allowed(format!("one gene per module, {} here", file.modules)),
            ));
        }
        let mut genes = Vec::with_capacity(file.genes.len());
        for (index, values) in file.genes.iter().enumerate() {
            let path = format!("genes[{index}]");
            let values: [f64; Gene::LEN] = values.as_slice().try_into().map_err(|_| {
                at(
                    &path,
                    Error::invalid("the gene has the wrong length")
                        .found(format!("{} numbers", values.len()))
                        .allowed(format!("{} numbers: {}", Gene::LEN, loci())),
                )
            })?;
            for (number, (locus, value)) in Locus::ALL.into_iter().zip(values).enumerate() {
                check_value(locus, value).map_err(|e| at(&format!("{path}[{number}]"), e))?;
            }
            genes.push(Gene::new(values)?);
        }
        let genome = Genome::new(genes).map_err(|e| source.at("modules", e))?;
        file.development
            .check()
            .map_err(|e| source.at("development", e))?;
        if genome.len() > file.development.max_modules {
            return Err(at(
                "modules",
                Error::invalid("more modules than the settings allow")
                    .found(genome.len())
                    .allowed(format!("1 to {}", file.development.max_modules))
                    .hint("raise `development: (max_modules: ...)` in the same file"),
            ));
        }
        Ok(Self {
            name: file.name,
            genome,
            development: file.development,
        })
    }

    /// The individual as a RON text; [`Individual::parse`] reads it back to an equal value. Settings are written out only where
    /// they are not the defaults.
    ///
    /// # Errors
    /// None is known: every genome can be written.
    pub fn to_ron(&self) -> Result<String> {
        let mut text = String::from("Genome(\n");
        let name = write_ron(&self.name)?;
        let _infallible = writeln!(text, "    name: {},", name.trim_end());
        let _infallible = writeln!(text, "    modules: {},", self.genome.len());
        let _infallible = writeln!(text, "    // {}", loci());
        text.push_str("    genes: [\n");
        for gene in self.genome.genes() {
            let numbers: Vec<String> = gene.values().iter().map(f64::to_string).collect();
            let _infallible = writeln!(text, "        [{}],", numbers.join(", "));
        }
        text.push_str("    ],\n");
        if self.development != Development::default() {
            let settings = write_ron(&self.development)?;
            let settings = settings.trim_end().replace('\n', "\n    ");
            let _infallible = writeln!(text, "    development: {settings},");
        }
        text.push_str(")\n");
        Ok(text)
    }

    /// The robot of this genome; see [`Development::develop`].
    ///
    /// # Errors
    /// The reason why the robot cannot be built.
    pub fn develop(&self) -> std::result::Result<Morphology, DevelopmentError> {
        self.development.develop(&self.name, &self.genome)
    }
}

fn loci() -> String {
    Locus::ALL.map(Locus::name).join(", ")
}
