//! Which fields of a model are fitted, and in which ranges.

use realgap::robot::morphology::CommandScale;
use realgap::simulation::Quantity;
use realgap::trajectory::Recording;

use super::super::super::kit::*;
use super::super::effort::{Driven, Effort, Scales};
use super::super::proposal::{MOST_DELAY_S, Proposal, rounded};
use super::model::{Commanded, Joint, Model, follows_motion};

/// The largest friction of a contact.
const MOST_FRICTION: f64 = 1.5;
/// The largest value of a quantity that is searched, for the joint's own.
type Most = fn(&Scales, f64) -> f64;
/// Assumptions, each with its evidence.
type Clues = Vec<(String, String)>;

/// A field to fit, or several that a pattern ties.
fn proposal(name: impl Into<String>, (from, to): (f64, f64), own: Option<f64>) -> Proposal {
    let (from, to) = (rounded(from), rounded(to));
    Proposal {
        name: name.into(),
        from,
        to,
        own: own.map(|own| own.clamp(from, to)),
    }
}

/// The fields of the joints whose angles were recorded.
///
/// # Errors
/// A model without any of these joints.
pub(super) fn of_joints(
    model: &Model,
    recordings: &[Recording],
    commanded: &Commanded,
    gains: Option<(f64, f64)>,
) -> Result<(Vec<Proposal>, Clues)> {
    let motion = &recordings[0].trajectory;
    let recorded: Vec<&Joint> = model
        .joints
        .iter()
        .filter(|joint| motion.joint(&joint.name).is_some())
        .collect();
    if recorded.is_empty() {
        let names = model.joints.iter().map(|joint| joint.name.as_str());
        return Err(Error::usage("no column is called after a joint of the model")
            .allowed(format!("columns NAME_rad of the joints {}", names.collect::<Vec<_>>().join(", ")))
            .hint("map the names in a file, e.g. (names: {\"theirs\": \"NAME_rad\"}), and give it with --reading FILE"));
    }
    let gravity_nm = model.mass_kg * 9.81 * model.body_length_m.unwrap_or(1.0);
    let scales = |joint: &Joint| {
        let driven = driven(joint, gains);
        let limit_nm = driven.as_ref().map(|driven| driven.limit_nm);
        let effort = Effort::of(joint.inertia_kg_m2, driven.as_ref(), recordings);
        Scales::new(effort, limit_nm, gravity_nm)
    };
    let most: [(&str, Most); 3] = [
        ("armature", Scales::most_armature),
        ("damping", Scales::most_viscous),
        ("frictionloss", Scales::most_dry),
    ];
    let mut all = Vec::new();
    for (quantity, most) in most {
        for (name, members) in tied(model, &recorded, quantity) {
            let own = |joint: &Joint| model.value(&field(joint, quantity)).unwrap_or_default();
            let each = members.iter().map(|joint| most(&scales(joint), own(joint)));
            let own = members.iter().map(|joint| own(joint)).fold(0.0, f64::max);
            all.push(proposal(name, (0.0, each.fold(0.0, f64::max)), Some(own)));
        }
    }
    let is_position = |joint: &&&Joint| {
        let follows = commanded
            .get(&joint.name)
            .is_some_and(|q| q.contains(&Quantity::Position));
        follows && joint.drive.as_deref() == Some("position")
    };
    for joint in recorded.iter().filter(is_position) {
        let gain = joint
            .actuator
            .as_ref()
            .map(|name| format!("actuator.{name}.kp"));
        if let Some((name, kp)) = gain.and_then(|name| Some((name.clone(), model.value(&name)?))) {
            all.push(proposal(name, (kp / 10.0, 4.0 * kp), Some(kp)));
        }
    }
    let has_angles = |joint: &&&Joint| {
        commanded
            .get(&joint.name)
            .is_some_and(|q| q.contains(&Quantity::Position))
    };
    for joint in recorded.iter().filter(has_angles) {
        let most = if joint.turns { 0.1 } else { 0.01 };
        let name = format!("joint.{}.zero", joint.name);
        all.push(proposal(name, (-most, most), Some(0.0)));
    }
    if let Some((kp, _)) = gains {
        // Stated gains are numbers of the firmware; torque constants are seldom exact.
        all.push(proposal("pd.kp", (0.5 * kp, 2.0 * kp), Some(kp)));
    }
    if commanded.values().any(|q| follows_motion(q)) {
        all.push(proposal("command.delay", (0.0, MOST_DELAY_S), Some(0.0)));
    }
    let mut clues = vec![(
        "ranges begin around the model's own values".to_owned(),
        "`prior` holds them with half of the range as spread, so that what the recordings do not tell stays near them".to_owned(),
    )];
    let ties: Vec<&str> = all
        .iter()
        .map(|p| p.name.as_str())
        .filter(|n| n.contains('*'))
        .collect();
    if !ties.is_empty() {
        clues.push((
            "joints of the same name but for their first word share a value".to_owned(),
            format!(
                "{}; name one joint in place of * to fit it alone",
                ties.join(", ")
            ),
        ));
    }
    Ok((all, clues))
}

/// What drives a joint; a motor with the gains of its controller, if it has one.
fn driven(joint: &Joint, gains: Option<(f64, f64)>) -> Option<Driven<'_>> {
    let actuator = joint.actuator.as_deref()?;
    let is_motor = joint.drive.as_deref() == Some("motor");
    Some(Driven {
        joint: &joint.name,
        names: vec![&joint.name, actuator],
        gains: if is_motor { gains } else { joint.gains },
        limit_nm: joint.limit.unwrap_or(f64::INFINITY),
        command: CommandScale::default(),
    })
}

fn field(joint: &Joint, quantity: &str) -> String {
    format!("joint.{}.{quantity}", joint.name)
}

/// The names under which a quantity of the joints is fitted: `joint.*_REST.QUANTITY` for joints that differ in their first word alone
/// and that the model gives the same value, else each by its own.
fn tied<'a>(
    model: &Model,
    recorded: &[&'a Joint],
    quantity: &str,
) -> Vec<(String, Vec<&'a Joint>)> {
    let rest = |joint: &Joint| {
        joint
            .name
            .split_once('_')
            .map(|(_, rest)| format!("_{rest}"))
    };
    let mut all: Vec<(String, Vec<&Joint>)> = Vec::new();
    for joint in recorded {
        if model.value(&field(joint, quantity)).is_none() {
            continue;
        }
        let alike = rest(joint).map(|rest| {
            let ends = |other: &&Joint| other.name.ends_with(&rest);
            let of_model = model.joints.iter().filter(ends).count();
            let group: Vec<&Joint> = recorded.iter().copied().filter(ends).collect();
            (rest, group, of_model)
        });
        let tie = alike.filter(|(_, group, of_model)| {
            let first = model.value(&field(joint, quantity));
            let equal = |other: &&Joint| model.value(&field(other, quantity)) == first;
            group.len() > 1 && group.len() == *of_model && group.iter().all(equal)
        });
        let (name, members) = match tie {
            Some((rest, group, _)) => (format!("joint.*{rest}.{quantity}"), group),
            None => (field(joint, quantity), vec![*joint]),
        };
        if all.iter().all(|(other, _)| *other != name) {
            all.push((name, members));
        }
    }
    all
}

/// Friction and stiffness of contacts.
///
/// # Errors
/// A model whose geoms have no names.
pub(super) fn of_contacts(model: &Model, file: &Path) -> Result<(Vec<Proposal>, Clues)> {
    let names = |ending: &str| -> Vec<f64> {
        let fields = model.fields.iter();
        let of_geoms =
            fields.filter(|(name, _)| name.starts_with("geom.") && name.ends_with(ending));
        of_geoms.map(|(_, field)| field.value).collect()
    };
    let (frictions, solrefs) = (names(".friction"), names(".solref"));
    if frictions.is_empty() {
        return Err(Error::usage(
            "no geom of the model has a name, so that no contact can be fitted",
        )
        .at_file(file)
        .hint("give those that touch a name: <geom name=\"floor\" .../>"));
    }
    let mut all = vec![proposal("geom.*.friction", (0.05, MOST_FRICTION), None)];
    let mut clues = vec![(
        "friction and `solref` of all named geoms are fitted, each as one".to_owned(),
        "MuJoCo takes the larger friction of two geoms that touch, and mixes their solref"
            .to_owned(),
    )];
    // A negative solref is a stiffness, whose size nothing tells.
    if let Some(own) = solrefs
        .iter()
        .copied()
        .reduce(f64::max)
        .filter(|own| *own > 0.0)
    {
        let from = (own / 5.0).max(2.0 * model.timestep_s);
        all.push(proposal(
            "geom.*.solref",
            (from, (5.0 * own).max(2.0 * from)),
            None,
        ));
    }
    if model.unnamed_touching_geoms > 0 {
        clues.push((
            "geoms without names keep their values".to_owned(),
            format!(
                "{} touch and have no name; name them to have them fitted, because MuJoCo takes the larger friction",
                counted(model.unnamed_touching_geoms, "geom")
            ),
        ));
    }
    Ok((all, clues))
}
