//! Handles the columns of several bodies in one file: `NAME_x_m,NAME_y_m,…` in addition to or instead of `x_m,y_m,…`.

use std::collections::BTreeSet;

/// The names of the bodies that have columns of their own, in the order of the file.
pub(super) fn names(columns: &[&str]) -> Vec<String> {
    columns
        .iter()
        .filter_map(|column| column.strip_suffix("_x_m"))
        .filter(|name| !name.is_empty() && columns.contains(&format!("{name}_y_m").as_str()))
        .map(str::to_owned)
        .collect()
}

/// True if the file has position columns without the name of a body.
pub(super) fn has_plain(columns: &[&str]) -> bool {
    columns.contains(&"x_m")
}

/// The same text with the columns of one body renamed to the names of a file with one body; the columns keep their places. The columns of the
/// tracked body are renamed, so that they are not read for this body.
pub(super) fn as_if_alone(text: &str, name: &str) -> String {
    let mut header_is_done = false;
    let mut alone = String::with_capacity(text.len());
    for line in text.split_inclusive('\n') {
        if header_is_done || line.trim().is_empty() {
            alone.push_str(line);
            continue;
        }
        header_is_done = true;
        let end = &line[line.trim_end_matches(['\r', '\n']).len()..];
        let cells: Vec<&str> = line.trim_end_matches(['\r', '\n']).split(',').collect();
        let prefix = format!("{name}_");
        let own: BTreeSet<&str> = cells
            .iter()
            .filter_map(|cell| cell.trim().strip_prefix(&prefix))
            .collect();
        let renamed: Vec<String> = cells
            .iter()
            .map(|cell| match cell.trim() {
                cell if own.contains(cell) || PLAIN[1..].contains(&cell) => {
                    format!("other_{cell}")
                }
                cell => cell.strip_prefix(&prefix).unwrap_or(cell).to_owned(),
            })
            .collect();
        alone.push_str(&renamed.join(","));
        alone.push_str(end);
    }
    alone
}

/// The same table with the columns of one more body appended; `own` is the separate table of this body, with the same number of lines.
pub(super) fn beside(text: &str, name: &str, own: &str) -> String {
    let mut wide = String::with_capacity(text.len() + own.len());
    for (index, (line, own)) in text.lines().zip(own.lines()).enumerate() {
        wide.push_str(line);
        // The first column is the time, which the table has already.
        for cell in own.split(',').skip(1) {
            wide.push(',');
            if index == 0 {
                wide.push_str(name);
                wide.push('_');
            }
            wide.push_str(cell);
        }
        wide.push('\n');
    }
    wide
}

/// The columns of the tracked body in a file without its name, except for joints; the first is the time.
const PLAIN: [&str; 14] = [
    "t_s", "x_m", "y_m", "z_m", "qw", "qx", "qy", "qz", "vx_m_s", "vy_m_s", "vz_m_s", "wx_rad_s",
    "wy_rad_s", "wz_rad_s",
];

/// True if every column belongs to one of these bodies or to the tracked body, or is the time.
pub(super) fn all_belong(columns: &[&str], bodies: &[String]) -> bool {
    columns.iter().all(|column| {
        let is_of = |name: &String| {
            let rest = column.strip_prefix(name.as_str());
            rest.is_some_and(|rest| rest.starts_with('_'))
        };
        let is_joint = column.ends_with("_rad") || column.ends_with("_rad_s");
        PLAIN.contains(column) || is_joint || bodies.iter().any(is_of)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_of_several_bodies_is_read_as_if_it_were_alone() {
        let text = "t_s,a_x_m,a_y_m,b_x_m,b_y_m\n0,1,2,3,4\n";
        let columns = ["t_s", "a_x_m", "a_y_m", "b_x_m", "b_y_m"];
        assert_eq!(names(&columns), ["a", "b"]);
        assert!(!has_plain(&columns) && all_belong(&columns, &names(&columns)));
        assert_eq!(
            as_if_alone(text, "b"),
            "t_s,a_x_m,a_y_m,x_m,y_m\n0,1,2,3,4\n"
        );
        let plain = "t_s,x_m\n0,1\n1,2\n";
        let wide = beside(plain, "b", "t_s,x_m,y_m\n0,5,6\n1,7,8\n");
        assert_eq!(wide, "t_s,x_m,b_x_m,b_y_m\n0,1,5,6\n1,2,7,8\n");
        let mixed = "t_s,x_m,y_m,b_x_m,b_y_m\n0,1,2,3,4\n";
        assert_eq!(
            as_if_alone(mixed, "b"),
            "t_s,other_x_m,other_y_m,x_m,y_m\n0,1,2,3,4\n"
        );
        let bare = "t_s,x_m,y_m,qw,a_rad,b_x_m,b_y_m\n0,1,2,1,0,3,4\n";
        assert_eq!(
            as_if_alone(bare, "b"),
            "t_s,other_x_m,other_y_m,other_qw,a_rad,x_m,y_m\n0,1,2,1,0,3,4\n"
        );
    }
}
