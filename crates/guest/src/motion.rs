//! From the channels of an answer to a trajectory at the asked times.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use realgap_path::trajectory::{JointTrack, Signal, Trajectory};

/// How far an answer may end before the last asked time, in steps between its own last samples: simulators end at a whole step.
const MISSING_STEPS: f64 = 1.5;
/// Relative rounding of times that is allowed.
const ROUNDING: f64 = 1e-6;
/// Shortest quaternion that has a direction.
const SHORTEST: f64 = 1e-6;

const POSITION: [&str; 3] = ["x_m", "y_m", "z_m"];
const ORIENTATION: [&str; 4] = ["qw", "qx", "qy", "qz"];
const VELOCITY: [&str; 3] = ["vx_m_s", "vy_m_s", "vz_m_s"];
const SPIN: [&str; 3] = ["wx_rad_s", "wy_rad_s", "wz_rad_s"];
const ANGLE: &str = "_rad";

/// The trajectory of an answer at the asked times.
///
/// # Errors
/// Why the answer is none, in words that follow `answered`.
pub(crate) fn motion(
    times_s: Option<Vec<f64>>,
    channels: BTreeMap<String, Vec<f64>>,
    asked_s: &[f64],
) -> Result<Trajectory, String> {
    if channels.is_empty() {
        return Err("no channels".to_owned());
    }
    let samples = times_s.as_deref().unwrap_or(asked_s).len();
    for (name, values) in &channels {
        if values.len() != samples {
            return Err(format!(
                "{} values of `{name}` at {samples} times",
                values.len()
            ));
        }
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            return Err(format!("{} in `{name}`, sample {index}", values[index]));
        }
    }
    let channels = match &times_s {
        Some(own_s) => at_times(own_s, channels, asked_s)?,
        None => channels,
    };
    trajectory(channels, asked_s)
}

/// The channels at the asked times, along straight lines between the answered samples.
fn at_times(
    own_s: &[f64],
    mut channels: BTreeMap<String, Vec<f64>>,
    asked_s: &[f64],
) -> Result<BTreeMap<String, Vec<f64>>, String> {
    let [.., before_s, last_s] = own_s else {
        return Err("fewer than two times".to_owned());
    };
    if let Some(at) = own_s
        .windows(2)
        .position(|pair| pair[0].partial_cmp(&pair[1]) != Some(Ordering::Less))
    {
        return Err(format!(
            "times that do not increase: {} s after {} s",
            own_s[at + 1],
            own_s[at]
        ));
    }
    if own_s == asked_s {
        return Ok(channels);
    }
    let (from_s, to_s) = (asked_s[0], asked_s[asked_s.len() - 1]);
    let rounding_s = ROUNDING * (to_s - from_s);
    let late_s = to_s - last_s - MISSING_STEPS * (last_s - before_s);
    if late_s > rounding_s || own_s[0] > from_s + rounding_s {
        return Err(format!(
            "times from {} s to {last_s} s where {from_s} s to {to_s} s were asked",
            own_s[0]
        ));
    }
    same_sides(&mut channels, own_s.len());
    let mut segment = 0;
    let places = asked_s.iter().map(|at_s| {
        while segment + 2 < own_s.len() && own_s[segment + 1] < *at_s {
            segment += 1;
        }
        let length_s = own_s[segment + 1] - own_s[segment];
        (segment, (at_s - own_s[segment]) / length_s)
    });
    let places: Vec<(usize, f64)> = places.collect();
    for values in channels.values_mut() {
        let there = places.iter().map(|(segment, share)| {
            let (a, b) = (values[*segment], values[segment + 1]);
            a + share * (b - a)
        });
        *values = there.collect();
    }
    Ok(channels)
}

/// Turns the signs of quaternions so that neighbours are on the same side: q and −q are one orientation, and their mean is none.
fn same_sides(channels: &mut BTreeMap<String, Vec<f64>>, samples: usize) {
    if !ORIENTATION.iter().all(|name| channels.contains_key(*name)) {
        return;
    }
    for sample in 1..samples {
        let dot = |channels: &BTreeMap<String, Vec<f64>>| -> f64 {
            let products = ORIENTATION
                .iter()
                .map(|name| channels[*name][sample] * channels[*name][sample - 1]);
            products.sum()
        };
        if dot(channels) < 0.0 {
            for name in ORIENTATION {
                if let Some(values) = channels.get_mut(name) {
                    values[sample] = -values[sample];
                }
            }
        }
    }
}

fn trajectory(
    mut channels: BTreeMap<String, Vec<f64>>,
    times_s: &[f64],
) -> Result<Trajectory, String> {
    let said = |error: realgap_core::Error| error.message().to_owned();
    let is_planar = !channels.contains_key("z_m");
    let position = match group(&mut channels, POSITION, &["z_m"], times_s.len())? {
        Some(columns) => vectors(&columns),
        None => vec![Vector3::zeros(); times_s.len()],
    };
    let has_position = position.iter().any(|place| *place != Vector3::zeros());
    let mut motion = Trajectory::new(times_s.to_vec(), position).map_err(said)?;
    if has_position && is_planar {
        motion = motion.planar();
    }
    if let Some([w, x, y, z]) = group(&mut channels, ORIENTATION, &[], times_s.len())? {
        let turns = (0..times_s.len()).map(|k| {
            let turn = Quaternion::new(w[k], x[k], y[k], z[k]);
            UnitQuaternion::try_new(turn, SHORTEST)
                .ok_or_else(|| format!("a quaternion without length, sample {k}"))
        });
        motion = motion
            .with_orientations(turns.collect::<Result<_, String>>()?)
            .map_err(said)?;
    }
    let linear = group(&mut channels, VELOCITY, &[], times_s.len())?;
    let angular = group(&mut channels, SPIN, &[], times_s.len())?;
    if let Some((linear, angular)) = linear.zip(angular) {
        motion = motion
            .with_velocities(vectors(&linear), vectors(&angular))
            .map_err(said)?;
    }
    let names = channels.keys().filter_map(|name| name.strip_suffix(ANGLE));
    let names: Vec<String> = names
        .filter(|name| !name.is_empty())
        .map(str::to_owned)
        .collect();
    let mut joints = Vec::new();
    for name in names {
        if let Some(angles_rad) = channels.remove(&format!("{name}{ANGLE}")) {
            joints.push(JointTrack {
                speeds_rad_s: channels.remove(&format!("{name}_rad_s")),
                name,
                angles_rad,
            });
        }
    }
    let signals = channels.into_iter();
    let signals = signals.map(|(name, values)| Signal { name, values });
    motion
        .with_joints(joints)
        .and_then(|motion| motion.with_signals(signals.collect()))
        .map_err(said)
}

/// Takes the channels of one quantity: all of them or none. Those in `spare` are zero where they are left out.
fn group<const N: usize>(
    channels: &mut BTreeMap<String, Vec<f64>>,
    names: [&str; N],
    spare: &[&str],
    samples: usize,
) -> Result<Option<[Vec<f64>; N]>, String> {
    let columns = names.map(|name| channels.remove(name));
    if columns.iter().all(Option::is_none) {
        return Ok(None);
    }
    for (name, column) in names.iter().zip(&columns) {
        if column.is_none() && !spare.contains(name) {
            return Err(format!("some of {} without `{name}`", names.join(", ")));
        }
    }
    Ok(Some(columns.map(|column| {
        column.unwrap_or_else(|| vec![0.0; samples])
    })))
}

fn vectors(columns: &[Vec<f64>; 3]) -> Vec<Vector3<f64>> {
    let [x, y, z] = columns;
    let triples = x.iter().zip(y).zip(z);
    triples
        .map(|((x, y), z)| Vector3::new(*x, *y, *z))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channels(named: &[(&str, &[f64])]) -> BTreeMap<String, Vec<f64>> {
        let named = named.iter();
        named
            .map(|(name, values)| ((*name).to_owned(), values.to_vec()))
            .collect()
    }

    #[test]
    fn an_answer_at_its_own_steps_is_read_at_the_asked_times() {
        let answered = channels(&[
            ("x_m", &[0.0, 1.0, 4.0]),
            ("y_m", &[0.0; 3]),
            ("knee_rad", &[0.0, 0.1, 0.2]),
        ]);
        let motion = motion(Some(vec![0.0, 1.0, 2.0]), answered, &[0.0, 0.5, 1.5]).unwrap();
        let x_m: Vec<f64> = motion.positions_world_m().iter().map(|p| p.x).collect();
        assert_eq!(x_m, [0.0, 0.5, 2.5]);
        assert!(motion.is_planar() && motion.joint("knee").is_some());
    }

    #[test]
    fn quaternions_of_either_sign_are_one_orientation() {
        let half = 0.5_f64.sqrt();
        let answered = channels(&[
            ("qw", &[half, -half]),
            ("qx", &[0.0, 0.0]),
            ("qy", &[0.0, 0.0]),
            ("qz", &[half, -half]),
        ]);
        let motion = motion(Some(vec![0.0, 1.0]), answered, &[0.0, 0.5, 1.0]).unwrap();
        let turns = motion.orientations_world_from_body().unwrap();
        assert!(turns[1].angle_to(&turns[0]) < 1e-9);
    }

    #[test]
    fn what_is_wrong_with_an_answer_is_named() {
        let asked = [0.0, 1.0];
        let wrong = |times: Option<Vec<f64>>, named: &[(&str, &[f64])]| {
            motion(times, channels(named), &asked).unwrap_err()
        };
        assert!(wrong(None, &[("a", &[1.0])]).contains("1 values of `a` at 2 times"));
        assert!(wrong(None, &[("a", &[1.0, f64::NAN])]).contains("NaN in `a`, sample 1"));
        assert!(wrong(None, &[("x_m", &[1.0, 1.0])]).contains("without `y_m`"));
        assert!(wrong(Some(vec![0.0, 0.1]), &[("a", &[1.0, 1.0])]).contains("0.1 s where"));
        assert!(wrong(None, &[]).contains("no channels"));
    }
}
