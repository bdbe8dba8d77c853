//! Parquet files as pandas writes them; without the feature, an error that names it.

use realgap::trajectory::{Reading, read};

use super::put;

#[cfg(not(feature = "parquet"))]
#[test]
fn without_the_feature_a_parquet_file_is_refused_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let path = put(folder.path(), "run.parquet", b"PAR1");
    let error = read(&path, Reading::default()).unwrap_err().to_string();
    assert!(
        error.contains("run.parquet") && error.contains("default features"),
        "{error}"
    );
}

#[cfg(feature = "parquet")]
mod with_the_feature {
    use realgap::file::Source;
    use realgap::trajectory::read_all;

    use super::super::common::python_with;
    use super::super::python;
    use super::{Reading, put, read};

    fn reading(text: &str) -> Reading {
        Reading::parse(&Source::new("reading.ron", text)).unwrap()
    }

    #[test]
    fn columns_of_pandas_are_mapped_as_those_of_a_csv_file() {
        let Some(program) = python_with("pandas, pyarrow") else {
            return;
        };
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let script = "
import numpy as np, pandas as pd
n = 50
t = 1700000000_000000000 + 20_000_000 * np.arange(n)
own = pd.DataFrame({'t_s': 0.02 * np.arange(n), 'x_m': np.arange(n) / 7, 'y_m': 0.1 / (1 + np.arange(n))})
for kind in ('snappy', 'lz4', 'zstd', None):
    own.to_parquet(f'{kind}.parquet', compression=kind)
own.to_parquet('pages.parquet', compression='zstd', data_page_version='2.0', data_page_size=64, row_group_size=20)
own.to_parquet('plain.parquet', compression='zstd', use_dictionary=False)
own.to_csv('own.csv', index=False)
other = pd.DataFrame({'stamp': pd.to_datetime(t), 'pose, x': np.float32(10 * np.arange(n)), 'pose.y': np.arange(n), 'trial': ['a', 'b'] * (n // 2)})
other.to_parquet('other.parquet', coerce_timestamps='us')
own.to_parquet('gzip.parquet', compression='gzip')
own['y_m'] = own['y_m'].where(np.arange(n) != 3)
own.to_parquet('lost.parquet')
pd.DataFrame({'t_s': [0.0, 1.0], 'x_m': [[1, 2], [3]], 'y_m': [0.0, 1.0]}).to_parquet('lists.parquet')
";
        python(&program, folder, script);
        let csv = read(folder.join("own.csv"), Reading::default()).unwrap();
        for kind in ["snappy", "lz4", "None", "zstd", "pages", "plain"] {
            let found = read(folder.join(format!("{kind}.parquet")), Reading::default());
            // Bit for bit: pandas writes the shortest digits.
            assert_eq!(found.unwrap().trajectory, csv.trajectory, "{kind}");
        }
        let mapped = "(columns: (t: \"stamp in us\", x: \"pose, x in mm\", y: \"pose.y in mm\", run: \"trial\"))";
        let all = read_all(folder.join("other.parquet"), reading(mapped)).unwrap();
        let names: Vec<&str> = all
            .iter()
            .map(|recording| recording.name.as_str())
            .collect();
        assert_eq!(names, ["other/a", "other/b"]);
        let motion = &all[1].trajectory;
        assert!((motion.times_s()[0] - 1_700_000_000.02).abs() < 1e-6);
        assert!((motion.positions_world_m()[24].x - 0.49).abs() < 1e-12);

        let refused = |name: &str| {
            let error = read(folder.join(name), Reading::default()).unwrap_err();
            error.to_string()
        };
        assert!(
            refused("gzip.parquet").contains("compression=\"snappy\""),
            "{}",
            refused("gzip.parquet")
        );
        let mut damaged = std::fs::read(folder.join("zstd.parquet")).unwrap();
        // The mark of a packed page.
        let mark = [0x28, 0xb5, 0x2f, 0xfd];
        let at = damaged.windows(4).position(|bytes| bytes == mark).unwrap();
        damaged[at + 1] ^= 1;
        let path = put(folder, "damaged.parquet", &damaged);
        let error = read(path, Reading::default()).unwrap_err().to_string();
        assert!(error.contains("cannot be read"), "{error}");
        let error = refused("lists.parquet");
        assert!(error.contains("[1,2]"), "{error}");
        assert!(refused("lost.parquet").contains("skip_lost: true"));
        let kept = read(folder.join("lost.parquet"), reading("(skip_lost: true)")).unwrap();
        assert_eq!(kept.trajectory.len(), 49);
    }

    #[test]
    fn a_file_that_is_not_parquet_is_refused_with_an_error() {
        let folder = tempfile::tempdir().unwrap();
        for content in [&b""[..], b"PAR1", b"PAR1 and no more PAR1", b"t_s,x_m\n"] {
            let path = put(folder.path(), "run.parquet", content);
            let error = read(&path, Reading::default()).unwrap_err().to_string();
            assert!(error.contains("the Parquet file cannot be read"), "{error}");
        }
    }
}
