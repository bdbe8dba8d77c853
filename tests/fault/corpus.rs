//! The files whose mutants are read: those that are shipped, and a small one for every other kind that has a reader.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::common;

use parquet::data_type::DoubleType;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use realgap::robot::genome::{Genome, Individual};
use realgap::search::generator;
use realgap::trajectory;
use realgap::unit::LengthUnit;

/// The largest file of the corpus, bytes; of longer ones the start.
const LONGEST: usize = 6000;

pub(crate) fn corpus() -> Vec<(PathBuf, Vec<u8>)> {
    let root = common::project();
    let mut files = Vec::new();
    for folder in [
        "morphologies",
        "sweeps",
        "real_trajectories",
        "real_trajectories/tripod_standin",
        "arenas",
        "controllers",
        "genomes",
        "radios",
        "scenes",
        "sensors",
        "vehicles",
    ] {
        let mut paths: Vec<PathBuf> = std::fs::read_dir(root.join(folder))
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .filter(|path| {
                path.extension()
                    .is_some_and(|e| e == "ron" || e == "csv" || e == "tum")
            })
            .collect();
        paths.sort();
        paths.truncate(12);
        for path in paths {
            let mut bytes = std::fs::read(&path).unwrap();
            if bytes.len() > LONGEST {
                let end = bytes[..LONGEST].iter().rposition(|b| *b == b'\n').unwrap();
                bytes.truncate(end + 1);
            }
            files.push((path, bytes));
        }
    }
    let genome = Genome::random(4, &mut generator(1, 0)).unwrap();
    let genome = Individual::new("four", genome).to_ron().unwrap();
    files.push((root.join("sweeps/genome.ron"), genome.into_bytes()));
    let more = [
        (
            "best.ron",
            "(description: \"best\", parameters: {\"floor.friction\": 0.4, \"gravity_m_s2\": 9.8})",
        ),
        (
            "noise.ron",
            "(start_heading_rad: Normal(0.02), servo_latency_s: Uniform(0.0, 0.02), mass_relative: LogNormal(0.02))",
        ),
        (
            "run.tum",
            "0 0 0 0 0 0 0 1\n0.1 0.1 0 0 0 0 0 1\n0.2 0.2 0 0 0 0 0 1\n",
        ),
        (
            "poses.kitti",
            "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n",
        ),
        (
            "data.csv",
            "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n0,1,2,3,1,0,0,0\n2000,1,2,4,1,0,0,0\n",
        ),
        (
            "set.csv",
            "condition,run,t_s,x_m,y_m\na,1,0,0,0\na,1,1,1,1\na,1,2,2,1\nb,1,0,0,0\nb,1,1,1,0\nb,1,2,3,0\n",
        ),
        (
            "run.jsonl",
            "{\"t\": 0, \"position\": [0, 1, 2], \"q\": {\"pan\": 1}}\n{\"t\": 0.1, \"position\": [0.1, 1, 2], \"q\": {\"pan\": 2}}\n",
        ),
        (
            "juggled.csv",
            "__time,/a/cmd,/odom/x,/odom/y\n0,,0,0\n0.1,1,,\n0.2,,1,1\n0.3,,2,2\n",
        ),
        (
            "vicon.csv",
            "TRAJECTORIES\n100,Hz\n,a:b,,\nField #,X,Y,Z\n1,1,2,3\n2,2,2,3\n3,3,2,3\n",
        ),
        (
            "motive.csv",
            "Format Version,1.23,Capture Frame Rate,100,Rotation Type,Quaternion,Length Units,Meters\n\n,Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body\n,Name,a,a,a,a,a,a,a\n,ID,1,1,1,1,1,1,1\n,,Rotation,Rotation,Rotation,Rotation,Position,Position,Position\nFrame,Time (Seconds),X,Y,Z,W,X,Y,Z\n0,0.00,0,0,0,1,0,1,2\n1,0.01,0,0,0,1,1,1,2\n2,0.02,0,0,0,1,2,1,2\n",
        ),
        (
            "marker.tsv",
            "NO_OF_FRAMES\t3\nNO_OF_CAMERAS\t2\nNO_OF_MARKERS\t1\nFREQUENCY\t100\nDATA_INCLUDED\t3D\nMARKER_NAMES\tbase\n1\t2\t3\n2\t2\t3\n3\t2\t3\n",
        ),
        (
            "lab.csv",
            "scorer,net,net,net\nbodyparts,nose,nose,nose\ncoords,x,y,likelihood\n0,1,2,0.9\n1,2,2,0.9\n2,3,2,0.9\n",
        ),
        (
            "joints.csv",
            "%time,field.name0,field.name1,field.position0,field.position1\n0,pan,lift,0,0\n20000000,pan,lift,0.1,0\n40000000,pan,lift,0.2,0.1\n",
        ),
        (
            "arm.urdf",
            "<robot name='arm'><link name='base'/><link name='tip'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial><collision><geometry><box size='1 1 1'/></geometry></collision></link><joint name='pan' type='revolute'><parent link='base'/><child link='tip'/><origin xyz='0 0 1' rpy='0 0 0'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>",
        ),
        (
            "arm.xml",
            "<mujoco><option timestep='0.01'/><default><joint damping='1'/></default><worldbody><body name='a' pos='0 0 1'><freejoint/><geom type='sphere' size='0.1' mass='1'/><body name='b'><joint name='j' axis='0 1 0' range='-1 1'/><geom type='capsule' size='0.1 0.2' mass='1'/></body></body></worldbody><actuator><position joint='j' kp='10'/></actuator></mujoco>",
        ),
    ];
    // A log of PX4: header, one structure, one topic, two messages.
    let mut log = b"ULog\x01\x12\x35\x01\0\0\0\0\0\0\0\0".to_vec();
    let messages: [(u8, &[u8]); 4] = [
        (
            b'F',
            b"vehicle_local_position:uint64_t timestamp;float x;float y;float z;",
        ),
        (b'A', b"\0\0\0vehicle_local_position"),
        (b'D', &[0; 22]),
        (
            b'D',
            &[
                0, 0, 9, 9, 9, 0, 0, 0, 0, 0, 0, 0, 128, 63, 0, 0, 0, 64, 0, 0, 0, 0,
            ],
        ),
    ];
    for (kind, body) in messages {
        log.extend([body.len() as u8, 0, kind]);
        log.extend(body);
    }
    files.push((root.join("sweeps/run.ulg"), log));
    files.extend(binary().map(|(name, bytes)| (root.join("sweeps").join(name), bytes)));
    files.extend(
        more.map(|(name, text)| (root.join("sweeps").join(name), text.as_bytes().to_vec())),
    );
    files
}

/// Small files that are no text.
fn binary() -> [(&'static str, Vec<u8>); 8] {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(
        at("run.tum"),
        "0 0 0 0 0 0 0 1\n0.1 0.1 0 0 0 0 0 1\n0.2 0.2 0 0 0 0 0 1\n",
    )
    .unwrap();
    let run = trajectory::read(at("run.tum"), LengthUnit::Metre)
        .unwrap()
        .trajectory;
    trajectory::write(at("run.mcap"), &run).unwrap();
    let picture = realgap::vision::Picture::new(8, 6, (0..3 * 8 * 6).collect()).unwrap();
    let npy = npy();
    [
        ("run.mcap", std::fs::read(at("run.mcap")).unwrap()),
        ("run.db3", bag(&at("run.db3"))),
        ("run.parquet", parquet()),
        ("run.npz", zip("t_s.npy", &npy)),
        ("run.npy", npy),
        ("small.png", picture.to_png().unwrap()),
        ("small.jpg", picture.to_jpeg(90).unwrap()),
        (
            "utf_16.csv",
            "\u{feff}t_s,x_m,y_m\n0,0,0\n0.1,1,0\n0.2,2,0\n"
                .encode_utf16()
                .flat_map(u16::to_le_bytes)
                .collect(),
        ),
    ]
}

/// A structured array of NumPy with two columns and three rows.
fn npy() -> Vec<u8> {
    let mut head = "{'descr': [('t_s', '<f8'), ('x_m', '<f8'), ('y_m', '<f8')], 'fortran_order': False, 'shape': (3,), }".to_owned();
    while !(head.len() + 11).is_multiple_of(64) {
        head.push(' ');
    }
    head.push('\n');
    let mut bytes = b"\x93NUMPY\x01\0".to_vec();
    bytes.extend((head.len() as u16).to_le_bytes());
    bytes.extend(head.as_bytes());
    for value in [0.0, 0.0, 0.0, 0.1, 1.0, 0.0, 0.2, 2.0, 0.0_f64] {
        bytes.extend(value.to_le_bytes());
    }
    bytes
}

/// An archive with one file that is not compressed.
fn zip(name: &str, content: &[u8]) -> Vec<u8> {
    let (size, crc) = (content.len() as u32, crc32(content));
    let about = |head: &[u8], after: &[u8]| {
        let mut all = head.to_vec();
        all.extend([20, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
        for number in [crc, size, size, name.len() as u32] {
            all.extend(number.to_le_bytes());
        }
        all.extend(after);
        all.extend(name.as_bytes());
        all
    };
    let mut bytes = about(b"PK\x03\x04", &[]);
    bytes.extend(content);
    let start = bytes.len() as u32;
    // Comment, disk, attributes, and the place of the file.
    bytes.extend(about(b"PK\x01\x02\x14\0", &[0; 14]));
    let length = bytes.len() as u32 - start;
    bytes.extend(b"PK\x05\x06\0\0\0\0\x01\0\x01\0");
    bytes.extend(length.to_le_bytes());
    bytes.extend(start.to_le_bytes());
    bytes.extend([0, 0]);
    bytes
}

fn crc32(content: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for byte in content {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ (0xedb8_8320 * (crc & 1));
        }
    }
    !crc
}

fn parquet() -> Vec<u8> {
    let schema = "message rows { required double t_s; required double x_m; required double y_m; }";
    let schema = Arc::new(parse_message_type(schema).unwrap());
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, schema, Arc::default()).unwrap();
    let mut group = writer.next_row_group().unwrap();
    while let Some(mut column) = group.next_column().unwrap() {
        let open = column.typed::<DoubleType>();
        open.write_batch(&[0.0, 1.0, 2.0], None, None).unwrap();
        column.close().unwrap();
    }
    group.close().unwrap();
    writer.close().unwrap();
    bytes
}

/// A bag of ROS 2 with three poses.
fn bag(path: &Path) -> Vec<u8> {
    let bag = rusqlite::Connection::open(path).unwrap();
    bag.execute_batch(
        "PRAGMA page_size = 512; PRAGMA journal_mode = DELETE;
        CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);
        CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);
        INSERT INTO topics VALUES (1, '/pose', 'geometry_msgs/msg/PoseStamped', 'cdr');",
    )
    .unwrap();
    for k in 0..3_u32 {
        let mut data = vec![0, 1, 0, 0];
        data.extend(k.to_le_bytes());
        data.extend([0; 4]);
        data.extend(4_u32.to_le_bytes());
        data.extend(b"map\0");
        for value in [f64::from(k), 0.0, 0.0, 0.0, 0.0, 0.0, 1.0] {
            data.extend(value.to_le_bytes());
        }
        bag.execute(
            "INSERT INTO messages VALUES (?1, 1, ?2, ?3)",
            (k, i64::from(k), data),
        )
        .unwrap();
    }
    drop(bag);
    std::fs::read(path).unwrap()
}

#[test]
fn every_file_of_another_program_is_read_before_it_is_mutated() {
    let folder = tempfile::tempdir().unwrap();
    let is_picture = |path: &Path| path.extension().is_some_and(|e| e == "png" || e == "jpg");
    for (name, bytes) in binary() {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        if is_picture(&path) {
            realgap::vision::Picture::read(&path).unwrap();
        } else if name != "run.npz" {
            trajectory::read(&path, LengthUnit::Metre).unwrap();
        }
    }
}
