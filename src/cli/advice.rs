//! Says in options what the library says in words.

use clap::{Command, CommandFactory};
use realgap::unit::LengthUnit;
use realgap::warning::Code;
use realgap::{Advice, Error, ErrorKind, Warning};

use super::Cli;

/// The same error with the options that its ways out are taken by, and with the option that a wrong use names.
pub fn in_options(error: Error) -> Error {
    let error = error.with_advice_as(option);
    let option = error.field_name().map(|field| field.replace('_', "-"));
    match option {
        Some(name) if error.kind() == ErrorKind::Usage && is_option(&Cli::command(), &name) => {
            error.field(format!("--{name}"))
        }
        _ => error,
    }
}

/// A warning with the options by which its reason can be taken away.
pub fn warning_in_options(warning: &Warning) -> String {
    match warning.code {
        Code::FreeParameter => {
            format!(
                "{} (--parameters best.ron, or --set NAME=VALUE) [{}]",
                warning.message, warning.code
            )
        }
        _ => warning.to_string(),
    }
}

fn option(advice: &Advice) -> String {
    match advice {
        Advice::Resume => "go on with --resume".to_owned(),
        Advice::Restart => "start anew with --restart".to_owned(),
        Advice::OtherFolder => "choose another folder with -o".to_owned(),
        Advice::FewerThreads => "use fewer --jobs".to_owned(),
        Advice::OtherOptimizer => "choose another --optimizer".to_owned(),
        Advice::OtherSeed => "choose another --seed".to_owned(),
        Advice::Unit(LengthUnit::Metre) => "read it with --unit m".to_owned(),
        Advice::Unit(LengthUnit::Centimetre) => "read it with --unit cm".to_owned(),
        Advice::Unit(LengthUnit::Millimetre) => "read it with --unit mm".to_owned(),
        Advice::Recordings => "name them with --recordings 'FOLDER/*.csv'".to_owned(),
        Advice::CalibratedValues => {
            "give values with --parameters best.ron, or --set NAME=VALUE".to_owned()
        }
        Advice::MetricWithoutBasis => {
            "a metric without a basis, e.g. --metric rms, needs no design of 64".to_owned()
        }
        Advice::LetOptimizerChoose => "let `realgap tune` choose the points".to_owned(),
        Advice::ListParameters => "`realgap parameters` lists all of them".to_owned(),
        other => other.to_string(),
    }
}

fn is_option(command: &Command, name: &str) -> bool {
    command.get_arguments().any(|a| a.get_long() == Some(name))
        || command.get_subcommands().any(|c| is_option(c, name))
}
