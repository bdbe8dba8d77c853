//! Renames the columns of foreign tables to realgap's names, and splits lists of several numbers in one column (`[0.1, 0.2]`), as LeRobot and
//! other programs write them, into separate columns.

use super::reading::Reading;
use super::table::header_line;
use super::text::{Separator, excerpt};
use realgap_core::error::{Error, Result};
use realgap_core::file::unknown_name;
use realgap_core::unit::counted;

/// The text of a table with its columns renamed as `reading` says, and its lists split into separate columns. Line numbers stay the same.
///
/// # Errors
/// A missing column, or a list whose length differs from the number of its column names.
pub(super) fn relabelled(text: String, reading: &Reading) -> Result<String> {
    if reading.names.is_empty() && reading.lists.is_empty() && reading.wheels.is_none() {
        return Ok(text);
    }
    let mut lines = text.lines().enumerate();
    let Some((header_index, header)) = header_line(&mut lines, reading) else {
        return Ok(text);
    };
    let separator = Separator::of_header(header);
    let cells = split(header, separator.character());
    let known = |name: &String| {
        if cells.contains(&name.as_str()) {
            return Ok(());
        }
        let names = cells.iter().copied();
        Err(unknown_name("column", name, names).at_line(header_index + 1, 1))
    };
    reading.names.keys().try_for_each(known)?;
    reading.lists.keys().try_for_each(known)?;
    let twist = match &reading.wheels {
        Some(wheels) => {
            [&wheels.forward, &wheels.turn]
                .into_iter()
                .try_for_each(known)?;
            let at = |name: &str| cells.iter().position(|cell| *cell == name);
            at(&wheels.forward)
                .zip(at(&wheels.turn))
                .map(|at| (wheels, at))
        }
        None => None,
    };
    let mut out = String::with_capacity(text.len());
    for (index, line) in text.lines().enumerate() {
        if index > 0 {
            out.push('\n');
        }
        if index < header_index || line.trim().is_empty() {
            out.push_str(line);
            continue;
        }
        for (column, cell) in split(line, separator.character()).into_iter().enumerate() {
            if column > 0 {
                out.push(separator.character());
            }
            let Some(name) = cells.get(column).copied() else {
                out.push_str(cell);
                continue;
            };
            match reading.lists.get(name) {
                Some(names) if index == header_index => push_all(&mut out, names, separator),
                Some(names) => {
                    let numbers = numbers(cell);
                    if numbers.len() != names.len() {
                        return Err(Error::invalid("a list of the wrong length")
                            .at_line(index + 1, 1)
                            .field(format!("lists.{name}"))
                            .found(format!(
                                "{}: {}",
                                counted(numbers.len(), "number"),
                                excerpt(cell)
                            ))
                            .allowed(counted(names.len(), "number")));
                    }
                    push_all(&mut out, &numbers, separator);
                }
                None if index == header_index => {
                    out.push_str(reading.names.get(name).map_or(cell, String::as_str));
                }
                None => out.push_str(cell),
            }
        }
        if let Some((wheels, (forward, turn))) = twist {
            let row = split(line, separator.character());
            let number = |at: usize| separator.number(row.get(at)?.trim_matches('"'));
            let names = wheels.names();
            let cells: Vec<String> = match number(forward).zip(number(turn)) {
                _ if index == header_index => names.collect(),
                Some((forward, turn)) => wheels
                    .speeds_rad_s(forward, turn)
                    .map(|speed| speed.to_string())
                    .collect(),
                // A row of units, or a lost sample.
                None => names.map(|_| String::new()).collect(),
            };
            out.push(separator.character());
            push_all(&mut out, &cells, separator);
        }
    }
    out.push('\n');
    Ok(out)
}

fn push_all(out: &mut String, cells: &[impl AsRef<str>], separator: Separator) {
    for (index, cell) in cells.iter().enumerate() {
        if index > 0 {
            out.push(separator.character());
        }
        out.push_str(cell.as_ref());
    }
}

/// The numbers of a list, with any brackets around them and any separators between them.
pub(super) fn numbers(cell: &str) -> Vec<&str> {
    let inner = cell.trim_matches(|c: char| "\"'[]() ".contains(c));
    let parts = inner.split(|c: char| c == ',' || c == ';' || c.is_whitespace());
    parts.filter(|part| !part.is_empty()).collect()
}

/// The cells of a line; separators within quotes or brackets do not split a cell.
pub(super) fn split(line: &str, separator: char) -> Vec<&str> {
    let (mut cells, mut from, mut quoted, mut depth) = (Vec::new(), 0, false, 0_usize);
    for (at, c) in line.char_indices() {
        match c {
            '"' => quoted = !quoted,
            '[' | '(' => depth += 1,
            ']' | ')' => depth = depth.saturating_sub(1),
            c if c == separator && !quoted && depth == 0 => {
                cells.push(&line[from..at]);
                from = at + c.len_utf8();
            }
            _ => {}
        }
    }
    cells.push(&line[from..]);
    cells.into_iter().map(str::trim).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use realgap_core::file::Source;

    fn reading(text: &str) -> Reading {
        Reading::parse(&Source::new("reading.ron", text)).unwrap()
    }

    #[test]
    fn wheels_get_the_speeds_that_follow_from_forward_speed_and_turn_rate() {
        let reading = reading(
            r#"(wheels: Some((forward: "v", forward_m_s: 1.0, turn: "w", turn_rad_s: 1.0, wheels: [
                (joint: "l", left_m: 0.25, radius_m: 0.5), (joint: "r", left_m: -0.25, radius_m: 0.5)])))"#,
        );
        assert_eq!(
            relabelled("t_s,v,w\n0,1,2\n".to_owned(), &reading).unwrap(),
            "t_s,v,w,l_command_rad_s,r_command_rad_s\n0,1,2,1,3\n"
        );
        let error = relabelled("t_s,v\n0,0.2\n".to_owned(), &reading).unwrap_err();
        assert!(error.to_string().contains("unknown column"), "{error}");
    }

    #[test]
    fn lists_become_columns_and_columns_are_renamed() {
        let reading = reading(
            r#"(names: {"stamp": "t_s"}, lists: {"action": ["pan_command_rad", "lift_command_rad"]})"#,
        );
        for text in [
            "stamp,action,other\n0.5,\"[1.0, 2.0]\",x\n",
            "stamp,action,other\n0.5,[1.0 2.0],x\n",
        ] {
            assert_eq!(
                relabelled(text.to_owned(), &reading).unwrap(),
                "t_s,pan_command_rad,lift_command_rad,other\n0.5,1.0,2.0,x\n"
            );
        }
        let short = "stamp,action\n0.5,[1.0]\n".to_owned();
        let error = relabelled(short, &reading).unwrap_err().to_string();
        assert!(
            error.contains("1 number") && error.contains("2 numbers"),
            "{error}"
        );
        let without = relabelled("stamp,x\n0,1\n".to_owned(), &reading).unwrap_err();
        assert!(without.to_string().contains("stamp, x"), "{without}");
    }
}
