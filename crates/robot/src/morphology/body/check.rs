//! Range checks of single bodies, joints and poses.

use nalgebra::SymmetricEigen;

use super::super::assembly::Freedom;
use super::super::flaw::Range;
use super::super::flaw::{Checked, Flaw};
use super::super::module::check_name;
use super::{Body, Form, Joint, Pose, Triple};
use realgap_core::Error;

/// A principal moment below this fraction of the largest one counts as zero.
pub(super) const SINGULAR: f64 = 1e-12;
/// Largest length in a robot, metres.
const MOST_M: f64 = 1000.0;

fn all(triple: Triple) -> [(usize, f64); 3] {
    [(0, triple.0), (1, triple.1), (2, triple.2)]
}

fn check_place(at_m: Triple, at: &str) -> Checked<()> {
    let range = Range::within(-MOST_M, MOST_M, "m");
    all(at_m)
        .into_iter()
        .try_for_each(|(index, value)| range.check(value, &format!("{at}[{index}]")))
}

/// Checks that a pose has finite numbers and states its orientation once.
pub(super) fn check_pose(pose: &Pose, at: &str) -> Checked<()> {
    check_place(pose.at_m, &format!("{at}.at_m"))?;
    if pose.rpy_rad.is_some() && pose.quaternion.is_some() {
        return Err(Flaw::new(
            format!("{at}.quaternion"),
            Error::invalid("an orientation is stated twice")
                .allowed("`rpy_rad` or `quaternion`, not both"),
        ));
    }
    let turns = pose.rpy_rad.into_iter().flat_map(all);
    for (index, value) in turns {
        Range::within(-1e4, 1e4, "rad").check(value, &format!("{at}.rpy_rad[{index}]"))?;
    }
    if let Some((w, x, y, z)) = pose.quaternion {
        let length = (w * w + x * x + y * y + z * z).sqrt();
        if !(0.5..2.0).contains(&length) {
            return Err(Flaw::new(
                format!("{at}.quaternion"),
                Error::invalid("not a unit quaternion")
                    .found(format!("a quaternion of length {length}"))
                    .allowed("length 1; (1, 0, 0, 0) is no rotation"),
            ));
        }
    }
    Ok(())
}

/// Checks the values of one body.
pub(super) fn check_body(body: &Body, at: &str) -> Checked<()> {
    check_name(&body.name, "a body", &format!("{at}.name"))?;
    Range::within(0.0, 1e6, "kg").check(body.mass_kg, &format!("{at}.mass_kg"))?;
    Range::within(-100.0, 100.0, "").check(
        body.gravity_compensation,
        &format!("{at}.gravity_compensation"),
    )?;
    if let Some(centre_m) = body.centre_of_mass_m {
        check_place(centre_m, &format!("{at}.centre_of_mass_m"))?;
    }
    if let Some(tensor) = &body.inertia_kg_m2 {
        let path = format!("{at}.inertia_kg_m2");
        let matrix = tensor.matrix();
        let is_finite = matrix.iter().all(|value| value.is_finite());
        let least = if is_finite {
            SymmetricEigen::new(matrix).eigenvalues.min()
        } else {
            f64::NAN
        };
        let largest = matrix.amax();
        if !is_finite || least < -SINGULAR * largest || largest > 1e9 {
            return Err(Flaw::new(
                path,
                Error::invalid("the inertia is physically impossible")
                    .found(format!("a smallest principal moment of {least:e} kg m^2"))
                    .allowed("no moment below 0, at most 1e9 kg m^2")
                    .hint("leave inertia_kg_m2 out to use that of uniform shapes"),
            ));
        }
    }
    for (index, piece) in body.shapes.iter().enumerate() {
        let at = format!("{at}.shapes[{index}]");
        check_pose(&piece.pose, &format!("{at}.pose"))?;
        check_form(&piece.form, &format!("{at}.form"))?;
        if let Some(tyre) = &piece.tyre {
            tyre.check(&format!("{at}.tyre"))?;
        }
        piece.turning.check(&format!("{at}.turning"))?;
    }
    Ok(())
}

fn check_form(form: &Form, at: &str) -> Checked<()> {
    let length = Range::above(0.0, MOST_M, "m");
    let lengths = |triple: Triple, field: &str| {
        all(triple)
            .into_iter()
            .try_for_each(|(index, value)| length.check(value, &format!("{at}.{field}[{index}]")))
    };
    match form {
        Form::Box { sides_m } => lengths(*sides_m, "sides_m"),
        Form::Ellipsoid { radii_m } => lengths(*radii_m, "radii_m"),
        Form::Sphere { radius_m } => length.check(*radius_m, &format!("{at}.radius_m")),
        Form::Cylinder { radius_m, length_m } => {
            length.check(*radius_m, &format!("{at}.radius_m"))?;
            length.check(*length_m, &format!("{at}.length_m"))
        }
        Form::Capsule { radius_m, length_m } => {
            length.check(*radius_m, &format!("{at}.radius_m"))?;
            Range::within(0.0, MOST_M, "m").check(*length_m, &format!("{at}.length_m"))
        }
        Form::Hull { points_m } => {
            if points_m.len() < 4 || points_m.len() > 1000 {
                return Err(Flaw::new(
                    format!("{at}.points_m"),
                    Error::invalid("wrong number of points for a hull")
                        .found(format!("{} points", points_m.len()))
                        .allowed("4 to 1000"),
                ));
            }
            let mut points = points_m.iter().enumerate();
            points.try_for_each(|(index, point)| {
                check_place(*point, &format!("{at}.points_m[{index}]"))
            })
        }
    }
}

/// Checks the values of one joint.
pub(super) fn check_joint(joint: &Joint, at: &str) -> Checked<()> {
    check_name(&joint.name, "a joint", &format!("{at}.name"))?;
    check_pose(&joint.pose, &format!("{at}.pose"))?;
    let at = format!("{at}.kind");
    let Some(motion) = joint.kind.motion() else {
        return Ok(());
    };
    check_place(motion.anchor_m, &format!("{at}.anchor_m"))?;
    let (losses, field, most) = match motion.freedom {
        Freedom::Turn => {
            let units = ["N m s/rad", "N m", "kg m^2", "N m/rad"];
            let names = ["viscous_nm_s_rad", "dry_nm", "armature_kg_m2", "spring"];
            (names.into_iter().zip(units), "limits_rad", 1e4)
        }
        Freedom::Slide => {
            let units = ["N s/m", "N", "kg", "N/m"];
            let names = ["viscous_n_s_m", "dry_n", "armature_kg", "spring"];
            (names.into_iter().zip(units), "limits_m", MOST_M)
        }
    };
    if let Some(start) = joint.start {
        Range::within(-most, most, "")
            .check(start, &format!("{}.start", at.trim_end_matches(".kind")))?;
    }
    let length = super::vector(motion.axis).norm();
    if !length.is_finite() || length < 1e-9 {
        return Err(Flaw::new(
            format!("{at}.axis"),
            Error::invalid("an axis needs a direction")
                .allowed("a vector that is not zero, e.g. (0, 1, 0)"),
        ));
    }
    let bearing = motion.bearing;
    let values = [
        bearing.viscous_nm_s_rad,
        bearing.dry_nm,
        bearing.armature_kg_m2,
        bearing.spring.map_or(0.0, |s| s.stiffness_nm_rad),
    ];
    for ((field, unit), value) in losses.zip(values) {
        Range::within(0.0, 1e9, unit).check(value, &format!("{at}.{field}"))?;
    }
    if let Some((low, high)) = bearing.limits_rad
        && !(low < high && low >= -most && high <= most)
    {
        return Err(Flaw::new(
            format!("{at}.{field}"),
            Error::invalid("not the limits of a joint")
                .found(format!("{low} to {high}"))
                .allowed(format!(
                    "the smaller value first, both between -{most} and {most}"
                ))
                .hint(format!("leave {field} out for a joint without limits")),
        ));
    }
    Ok(())
}
