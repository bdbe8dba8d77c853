//! Parameters of a vehicle's range sensor: mean, spread and dropout, in the units of the sensor's file.

use std::sync::Arc;

use super::{Nudge, Parameter, entry};
use crate::Experiment;
use realgap_sensing::range::RangeModel;
use realgap_sensing::range::form::Curve;

fn sensor(experiment: &Experiment) -> Option<&RangeModel> {
    experiment.vehicle.as_ref().map(|v| &*v.sensor)
}

fn change(experiment: &mut Experiment, with: impl FnOnce(&mut RangeModel)) {
    if let Some(vehicle) = &mut experiment.vehicle {
        with(Arc::make_mut(&mut Arc::make_mut(vehicle).sensor));
    }
}

/// Index of the parameter of this name among the values of a curve.
fn index(curve: &Curve, name: &str) -> Option<usize> {
    let names = curve.form.parameters(&curve.knots);
    names.iter().position(|known| known == name)
}

fn read(curve: &Curve, name: &str) -> Option<f64> {
    Some(curve.values[index(curve, name)?])
}

fn write(curve: &mut Curve, name: &str, value: f64) {
    if let Some(index) = index(curve, name) {
        curve.values[index] = value;
    }
}

/// Defines parameters of the two curves; a sensor whose curve has no such value has no such parameter.
macro_rules! curves {
    ($($name:literal $curve:ident $part:literal ($low:literal, $high:literal) $nudge:expr, $doc:literal;)*) => {
        pub(super) static CURVES: &[Parameter] = &[
            $(entry!($name, One, ($low, $high), Linear, $nudge, $doc,
                |e, _| read(&sensor(e)?.$curve, $part),
                |e, _, value| change(e, |s| write(&mut s.$curve, $part, value))),)*
        ];
    };
}

curves! {
    "vehicle.sensor.mean.intercept" mean "intercept" (-1e6, 1e6) Nudge::Absolute(0.1), "Mean reading at distance 0, of a linear sensor, in its file's units.";
    "vehicle.sensor.mean.slope" mean "slope" (-1e6, 1e6) Nudge::Share(0.02), "Change of the mean reading with the distance, of a linear sensor.";
    "vehicle.sensor.mean.factor" mean "factor" (-1e9, 1e9) Nudge::Share(0.02), "Factor of the mean reading, of a sensor with a power or an exponential.";
    "vehicle.sensor.mean.exponent" mean "exponent" (-10.0, 10.0) Nudge::Share(0.02), "Exponent of the distance in the mean reading, of a sensor with a power.";
    "vehicle.sensor.mean.rate" mean "rate" (-100.0, 100.0) Nudge::Share(0.02), "Rate of the mean reading over the distance, of a sensor with an exponential.";
    "vehicle.sensor.spread.intercept" spread "intercept" (-1e6, 1e6) Nudge::Share(0.1), "Spread of readings at distance 0, where it is linear.";
    "vehicle.sensor.spread.slope" spread "slope" (-1e6, 1e6) Nudge::Share(0.1), "Change of the spread with the distance, where it is linear.";
    "vehicle.sensor.spread.factor" spread "factor" (0.0, 1e9) Nudge::Share(0.1), "Factor of the spread, where it is a power or an exponential.";
    "vehicle.sensor.spread.exponent" spread "exponent" (-10.0, 10.0) Nudge::Share(0.1), "Exponent of the distance in the spread, where it is a power.";
    "vehicle.sensor.spread.rate" spread "rate" (-100.0, 100.0) Nudge::Share(0.1), "Rate of the spread over the distance, where it is an exponential.";
}

#[rustfmt::skip] // a table
pub(super) static PARAMETERS: &[Parameter] = &[
    entry!("vehicle.sensor.dropout", One, (0.0, 1.0), Linear, Nudge::Absolute(0.05),
        "Probability that no reading comes.",
        |e, _| Some(sensor(e)?.dropout), |e, _, value| change(e, |s| s.dropout = value)),
    entry!("vehicle.sensor.incidence_per_deg", One, (-1e6, 1e6), Linear, Nudge::Absolute(0.01),
        "Change of the mean reading per degree of incidence, in its file's unit of readings.",
        |e, _| Some(sensor(e)?.incidence_per_deg), |e, _, value| change(e, |s| s.incidence_per_deg = value)),
];
