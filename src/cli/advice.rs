//! Advice of the library, written as options of the command line.

use clap::error::{ContextKind, ContextValue, ErrorKind as ClapKind};
use clap::{Command, CommandFactory};
use realgap::warning::Code;
use realgap::{Advice, Error, ErrorKind, Warning};

use super::Cli;

/// The error with its advice written as options; where the usage was wrong, its field is named as an option.
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

/// The text of a warning with the options that remove its cause.
pub fn warning_in_options(warning: &Warning) -> String {
    let options = match warning.code {
        Code::FreeParameter => "--parameters best.ron, or --set NAME=VALUE",
        Code::ClockOffset => "--offset auto",
        Code::DifferentDurations => "--time start compares at equal times",
        Code::Hole | Code::Standstill => "--crop FROM:TO",
        Code::QuaternionOrder => "--quaternion ORDER",
        Code::SeveralRobots => "--where COLUMN=VALUE",
        Code::UnknownAxes => "--axes world, y-up, z-down or camera",
        Code::UnlikelyLength => {
            "--unit UNIT, or --column 'x=NAME in UNIT' where a name states another one"
        }
        Code::UnlikelyTime => {
            "--time-unit UNIT, or --column 't=NAME in UNIT' where a name states another one"
        }
        _ => return warning.to_string(),
    };
    format!("{} ({options}) [{}]", warning.message, warning.code)
}

/// The same error of clap; where the value is a number with a decimal comma, it suggests the number with a decimal point.
pub fn with_decimal_point(mut error: clap::Error) -> clap::Error {
    if error.kind() == ClapKind::ValueValidation
        && let Some(ContextValue::String(value)) = error.get(ContextKind::InvalidValue)
        && let number = value.replacen(',', ".", 1)
        && number != *value
        && number.parse::<f64>().is_ok()
    {
        let tip = format!("decimals follow a point: {number}");
        error.insert(
            ContextKind::Suggested,
            ContextValue::StyledStrs(vec![tip.into()]),
        );
    }
    error
}

fn option(advice: &Advice) -> String {
    match advice {
        Advice::Resume => "go on with --resume".to_owned(),
        Advice::Restart => "start anew with --restart".to_owned(),
        Advice::OtherFolder => "choose another folder with -o".to_owned(),
        Advice::AcceptFiles => {
            "accept the files as they are with `realgap report FOLDER --accept`".to_owned()
        }
        Advice::FewerThreads => "use fewer --jobs".to_owned(),
        Advice::OtherOptimizer => "choose another --optimizer".to_owned(),
        Advice::OtherSeed => "choose another --seed".to_owned(),
        Advice::Unit(unit) => format!("read it with --unit {}", unit.symbol()),
        Advice::Scale => "give the metres of one unit with --scale, e.g. --scale 0.0021, or a known length over its size in the file: --scale 0.5/238".to_owned(),
        Advice::Split => "read them as separate recordings with --split".to_owned(),
        Advice::AngleUnit => {
            "state the unit with --angle-unit UNIT, or the counts of encoders with --ticks 4096".to_owned()
        }
        Advice::NameRobot => "give both to realgap start: realgap start FILE robot.urdf".to_owned(),
        Advice::JointOrder => "name them with --joints NAME,NAME,... in the order of the numbers".to_owned(),
        Advice::UnpaddedStamps => "read 12.5 as 12 s and 5 ns with --unpadded-stamps".to_owned(),
        Advice::Axes => "say which way axes point with --axes world, y-up, z-down or camera".to_owned(),
        Advice::MapColumns => {
            "say which column is which, e.g. --column 'x=NAME in mm' (docs/recordings.md)"
                .to_owned()
        }
        Advice::ChooseRobot => "read one of them with --where COLUMN=VALUE".to_owned(),
        Advice::SortSamples => "sort them with --sort-samples".to_owned(),
        Advice::SkipLost => "leave lost samples out with --skip-lost".to_owned(),
        Advice::SkipLines => "begin below them with --skip-lines N".to_owned(),
        Advice::NameColumns => {
            "name the columns in their order with --header t_s,x_m,y_m,... (an empty name for a column that is not read)"
                .to_owned()
        }
        Advice::Rate => "give the number of samples per second, e.g. --rate-hz 10".to_owned(),
        Advice::Topic => "choose one with --topic, and --child-frame of transforms".to_owned(),
        Advice::CommandTopic => "choose the topic of the commands with --command-topic".to_owned(),
        Advice::Crop => "choose another part with --crop FROM:TO".to_owned(),
        Advice::TimeUnit => "say their unit, e.g. --time-unit ms, or --column 't=t_s in ms' where the name states another one".to_owned(),
        Advice::Recordings => "name them with --recordings 'FOLDER/*.csv'".to_owned(),
        Advice::CalibratedValues => {
            "give values with --parameters best.ron, or --set NAME=VALUE".to_owned()
        }
        Advice::MetricWithoutBasis => {
            "a metric without a basis, e.g. --metric rms, needs no first design of 64".to_owned()
        }
        Advice::LetOptimizerChoose => "let `realgap tune` choose the points".to_owned(),
        Advice::HoldRoot => {
            "hold the root of a URDF or MJCF with: realgap robot import ROBOT --mounted -o held.ron".to_owned()
        }
        Advice::LeastSquares => {
            "to see which parameters the joint logs determine, and what each log adds: realgap tune STUDY --optimizer gauss-newton"
                .to_owned()
        }
        Advice::OtherTime => {
            "compare times since each start (--time start) or equal fractions of the durations (--time fraction)".to_owned()
        }
        Advice::Associate => {
            "allow more with --max-difference S, or interpolate with --associate interpolate"
                .to_owned()
        }
        Advice::EstimateOffset => {
            "find the offset between two clocks of one run with --offset auto".to_owned()
        }
        Advice::AllowCommand => "run it with --allow-command".to_owned(),
        Advice::ListParameters => "`realgap study parameters` lists all of them".to_owned(),
        other => other.to_string(),
    }
}

fn is_option(command: &Command, name: &str) -> bool {
    command.get_arguments().any(|a| a.get_long() == Some(name))
        || command.get_subcommands().any(|c| is_option(c, name))
}
