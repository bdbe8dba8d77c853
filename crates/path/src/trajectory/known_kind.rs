//! Kinds of files that people have recordings in and that are not read, with what to do about each of them.

/// A kind of file: its extensions, what it is, and what makes a file of it that is read.
struct Kind {
    extensions: &'static [&'static str],
    what: &'static str,
    remedy: &'static str,
}

const KINDS: &[Kind] = &[
    Kind {
        extensions: &["bag", "active"],
        what: "a bag of ROS 1",
        remedy: "convert it into a bag of ROS 2: pip install rosbags; rosbags-convert --src FILE.bag --dst FOLDER (a bag that was not closed first needs `rosbag reindex`)",
    },
    Kind {
        extensions: &["bin", "tlog"],
        what: "a log of ArduPilot",
        remedy: "write one kind of message as CSV: pip install pymavlink; mavlogdump.py --format csv --types POS FILE > FILE.csv",
    },
    Kind {
        extensions: &["c3d"],
        what: "motion capture in C3D",
        remedy: "export CSV or TSV from the program that captured it (Vicon, Qualisys, Motive)",
    },
    Kind {
        extensions: &["bvh", "fbx", "amc", "asf"],
        what: "an animated skeleton",
        remedy: "write the angles of the joints as CSV columns JOINT_deg with a column t_s",
    },
    Kind {
        extensions: &["h5", "hdf5", "mat", "zarr", "nc"],
        what: "arrays in a container of other programs",
        remedy: "write the arrays that are needed as NumPy's .npz: numpy.savez(\"run.npz\", t_s=..., x_m=..., y_m=...)",
    },
    Kind {
        extensions: &["xlsx", "xls", "ods"],
        what: "a spreadsheet",
        remedy: "save the sheet as CSV",
    },
    Kind {
        extensions: &["feather", "arrow", "ipc"],
        what: "a table of Arrow",
        remedy: "write it as Parquet: pandas.read_feather(FILE).to_parquet(\"run.parquet\")",
    },
    Kind {
        extensions: &["pkl", "pickle", "pt", "pth"],
        what: "objects of Python, which can run any program when they are loaded",
        remedy: "write their arrays as .npz: numpy.savez(\"run.npz\", t_s=..., x_m=..., y_m=...)",
    },
    Kind {
        extensions: &["zst", "zstd", "gz", "zip", "xz", "bz2", "7z", "tar"],
        what: "a packed file",
        remedy: "unpack it first, e.g. zstd -d FILE, gunzip FILE or unzip FILE",
    },
    Kind {
        extensions: &["mp4", "avi", "mov", "mkv", "webm"],
        what: "a video",
        remedy: "track the robot in it, and write the places as CSV (t_s, x_m, y_m)",
    },
    Kind {
        extensions: &["tfrecord", "rrd", "svo", "svo2"],
        what: "a record of another program",
        remedy: "export the poses or joints as CSV or Parquet with that program",
    },
];

/// What a file with this extension is, and what to do about it; `None` for an extension that says nothing.
pub(super) fn known_kind(extension: &str) -> Option<(&'static str, &'static str)> {
    let mut all = KINDS.iter();
    let found = all.find(|kind| kind.extensions.contains(&extension))?;
    Some((found.what, found.remedy))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::FORMATS;

    #[test]
    fn no_extension_is_both_read_and_refused() {
        for format in FORMATS {
            for extension in format.extensions() {
                assert_eq!(known_kind(extension), None, "{extension}");
            }
        }
    }
}
