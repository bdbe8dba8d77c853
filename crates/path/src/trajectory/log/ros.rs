//! Decodes messages of ROS: poses, joints, commands, and sensors beside them.

use super::cdr::Cdr;
use super::message::{Column, Content, Frames, Kinds, Plan, Point, Quantity, Row, Sample};

/// The kind of a message, by the name of its type, e.g. `geometry_msgs/msg/PoseStamped`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Pose,
    Odometry,
    Transform,
    Transforms,
    Path,
    Joints,
    Plan,
    Controller,
    Numbers,
    Twist,
    TwistStamped,
    Imu,
    Wrench,
}

impl Kind {
    /// True for kinds whose messages say where the robot should go.
    pub(super) fn is_command(self) -> bool {
        matches!(
            self,
            Self::Plan | Self::Numbers | Self::Twist | Self::TwistStamped
        )
    }
}

/// The names of message types in ROS 2; those of ROS 1 lack `/msg`.
pub(super) const KINDS: Kinds<Kind> = Kinds(&[
    ("geometry_msgs/msg/PoseStamped", Kind::Pose),
    // The covariance follows after the pose and is ignored.
    ("geometry_msgs/msg/PoseWithCovarianceStamped", Kind::Pose),
    ("nav_msgs/msg/Odometry", Kind::Odometry),
    ("geometry_msgs/msg/TransformStamped", Kind::Transform),
    ("tf2_msgs/msg/TFMessage", Kind::Transforms),
    ("nav_msgs/msg/Path", Kind::Path),
    ("sensor_msgs/msg/JointState", Kind::Joints),
    ("trajectory_msgs/msg/JointTrajectory", Kind::Plan),
    (
        "control_msgs/msg/JointTrajectoryControllerState",
        Kind::Controller,
    ),
    ("std_msgs/msg/Float64MultiArray", Kind::Numbers),
    ("geometry_msgs/msg/Twist", Kind::Twist),
    ("geometry_msgs/msg/TwistStamped", Kind::TwistStamped),
    ("sensor_msgs/msg/Imu", Kind::Imu),
    ("geometry_msgs/msg/WrenchStamped", Kind::Wrench),
]);

/// The kind of a message type of either ROS.
pub(super) fn kind(name: &str) -> Option<Kind> {
    KINDS.of(name).or_else(|| match name {
        "tf/tfMessage" => Some(Kind::Transforms),
        _ => KINDS.of(&name.replacen('/', "/msg/", 1)),
    })
}

/// Decodes a header: its time, nanoseconds, and its frame.
fn header(cdr: &mut Cdr<'_>) -> Option<(i64, String)> {
    if cdr.is_ros1() {
        let _count = cdr.u32()?;
    }
    let seconds = i64::from(cdr.i32()?);
    let stamp_ns = seconds * 1_000_000_000 + i64::from(cdr.u32()?);
    Some((stamp_ns, cdr.text()?))
}

fn pose(cdr: &mut Cdr<'_>, stamp_ns: i64, log_ns: i64) -> Option<Sample> {
    Some(Sample {
        stamp_ns,
        log_ns,
        place_m: cdr.numbers()?,
        turn_xyzw: cdr.numbers()?,
        twist: None,
    })
}

fn transform(cdr: &mut Cdr<'_>, log_ns: i64) -> Option<(Frames, Sample)> {
    let (stamp_ns, parent) = header(cdr)?;
    let child = cdr.text()?;
    Some((Some((parent, child)), pose(cdr, stamp_ns, log_ns)?))
}

/// A list with one number for each joint; NaN for all of them where the message has none.
fn for_all(list: Vec<f64>, joints: usize) -> Option<Vec<f64>> {
    match list.len() {
        0 => Some(vec![f64::NAN; joints]),
        count => (count == joints).then_some(list),
    }
}

/// A row of quantities of joints: first all joints' numbers of the first quantity.
fn joint_row(
    (stamp_ns, log_ns): (i64, i64),
    joints: &[String],
    quantities: Vec<(Quantity, Vec<f64>)>,
) -> Option<Content> {
    let (mut columns, mut values) = (Vec::new(), Vec::new());
    for (quantity, list) in quantities {
        let names = joints.iter().cloned();
        columns.extend(names.map(|joint| Column::Joint(joint, quantity)));
        values.extend(for_all(list, joints.len())?);
    }
    Some(Content::Row(Row {
        stamp_ns,
        log_ns,
        columns,
        values,
    }))
}

/// Decodes a point of a plan: angles, speeds, and the time since the start. Accelerations and efforts are not used.
fn point(cdr: &mut Cdr<'_>) -> Option<Point> {
    let (angles, speeds) = (cdr.list()?, cdr.list()?);
    let (_accelerations, _efforts) = (cdr.list()?, cdr.list()?);
    let seconds = i64::from(cdr.i32()?);
    // In ROS 1 nanoseconds have a sign, too, but are never negative.
    let after_start_ns = seconds * 1_000_000_000 + i64::from(cdr.u32()?);
    Some(Point {
        after_start_ns,
        angles,
        speeds,
    })
}

/// A row of numbers with these names.
fn named((stamp_ns, log_ns): (i64, i64), names: Vec<String>, values: Vec<f64>) -> Content {
    Content::Row(Row {
        stamp_ns,
        log_ns,
        columns: names.into_iter().map(Column::Named).collect(),
        values,
    })
}

/// The names of three axes behind the name of a frame.
fn axes<'a>(frame: &'a str, what: &'a str, unit: &'a str) -> impl Iterator<Item = String> + 'a {
    let axes = ["x", "y", "z"].into_iter();
    axes.map(move |axis| format!("{frame}_{what}_{axis}_{unit}"))
}

/// The names of a commanded twist, as [`TwistColumns`](crate::trajectory::TwistColumns) finds them.
const TWIST: [&str; 6] = [
    "cmd_vel.linear.x",
    "cmd_vel.linear.y",
    "cmd_vel.linear.z",
    "cmd_vel.angular.x",
    "cmd_vel.angular.y",
    "cmd_vel.angular.z",
];

/// Decodes a message; `None` if the message is incomplete.
pub(super) fn content(kind: Kind, log_ns: i64, mut cdr: Cdr<'_>) -> Option<Content> {
    let cdr = &mut cdr;
    let all = match kind {
        Kind::Pose => {
            let (stamp_ns, _) = header(cdr)?;
            vec![(None, pose(cdr, stamp_ns, log_ns)?)]
        }
        Kind::Odometry => {
            let (stamp_ns, _) = header(cdr)?;
            let _child = cdr.text()?;
            let mut sample = pose(cdr, stamp_ns, log_ns)?;
            let _covariance: [f64; 36] = cdr.numbers()?;
            sample.twist = Some(cdr.numbers()?);
            vec![(None, sample)]
        }
        Kind::Transform => vec![transform(cdr, log_ns)?],
        Kind::Transforms => (0..cdr.u32()?)
            .map(|_| transform(cdr, log_ns))
            .collect::<Option<_>>()?,
        Kind::Path => {
            header(cdr)?;
            let samples = (0..cdr.u32()?).map(|_| {
                let (stamp_ns, _) = header(cdr)?;
                pose(cdr, stamp_ns, log_ns)
            });
            return samples.collect::<Option<_>>().map(Content::Path);
        }
        Kind::Joints => {
            let (stamp_ns, _) = header(cdr)?;
            let joints = cdr.texts()?;
            let quantities = vec![
                (Quantity::Angle, cdr.list()?),
                (Quantity::Speed, cdr.list()?),
                (Quantity::Effort, cdr.list()?),
            ];
            return joint_row((stamp_ns, log_ns), &joints, quantities);
        }
        Kind::Controller => {
            let (stamp_ns, _) = header(cdr)?;
            let joints = cdr.texts()?;
            // `desired` and `actual` in older versions, `reference` and `feedback` in later ones.
            let (wanted, found) = (point(cdr)?, point(cdr)?);
            let quantities = vec![
                (Quantity::Reference, wanted.angles),
                (Quantity::Angle, found.angles),
                (Quantity::Speed, found.speeds),
            ];
            return joint_row((stamp_ns, log_ns), &joints, quantities);
        }
        Kind::Plan => {
            let (stamp_ns, _) = header(cdr)?;
            let joints = cdr.texts()?;
            let points: Vec<Point> = (0..cdr.u32()?).map(|_| point(cdr)).collect::<Option<_>>()?;
            let is_whole = |point: &Point| {
                let speeds = point.speeds.len();
                point.angles.len() == joints.len() && (speeds == 0 || speeds == joints.len())
            };
            let is_twice = |index: usize| joints[..index].contains(&joints[index]);
            let are_unique = !(0..joints.len()).any(is_twice);
            let is_sound = are_unique && points.iter().all(is_whole);
            return is_sound.then_some(Content::Plan(Plan {
                stamp_ns,
                log_ns,
                joints,
                points,
            }));
        }
        Kind::Numbers => {
            // The layout: labels, sizes and strides of its dimensions, and an offset.
            for _ in 0..cdr.u32()? {
                let _label = cdr.text()?;
                let _size_and_stride = (cdr.u32()?, cdr.u32()?);
            }
            let _offset = cdr.u32()?;
            let values = cdr.list()?;
            return Some(Content::Row(Row {
                stamp_ns: 0,
                log_ns,
                columns: (0..values.len()).map(Column::Numbered).collect(),
                values,
            }));
        }
        Kind::Twist | Kind::TwistStamped => {
            let stamp_ns = match kind {
                Kind::TwistStamped => header(cdr)?.0,
                _ => 0,
            };
            let twist: [f64; 6] = cdr.numbers()?;
            let names = TWIST.map(str::to_owned).to_vec();
            return Some(named((stamp_ns, log_ns), names, twist.to_vec()));
        }
        Kind::Imu => {
            let (stamp_ns, frame) = header(cdr)?;
            let _turn_and_covariance: [f64; 4 + 9] = cdr.numbers()?;
            let turn_rates: [f64; 3] = cdr.numbers()?;
            let _covariance: [f64; 9] = cdr.numbers()?;
            let accelerations: [f64; 3] = cdr.numbers()?;
            let names = axes(&frame, "gyro", "rad_s").chain(axes(&frame, "accel", "m_s2"));
            let values = [turn_rates, accelerations].concat();
            return Some(named((stamp_ns, log_ns), names.collect(), values));
        }
        Kind::Wrench => {
            let (stamp_ns, frame) = header(cdr)?;
            let wrench: [f64; 6] = cdr.numbers()?;
            let names = axes(&frame, "force", "n").chain(axes(&frame, "moment", "nm"));
            return Some(named((stamp_ns, log_ns), names.collect(), wrench.to_vec()));
        }
    };
    Some(Content::Poses(all))
}
