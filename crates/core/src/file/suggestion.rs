//! Looks up names that users write, and suggests the nearest known name ("did you mean ...?").

use crate::error::{Error, Result};

/// The largest number of names that an error lists.
const SHOWN: usize = 30;

/// The item of a registry with this `name`; `what` is the kind of item in the error message.
///
/// ```
/// use realgap_core::file::look_up;
///
/// let springs = [("soft", 10.0), ("stiff", 1e4)];
/// assert_eq!(look_up("spring", "stiff", springs, |spring| spring.0)?.1, 1e4);
/// assert_eq!(
///     look_up("spring", "stif", springs, |spring| spring.0).unwrap_err().to_string(),
///     "unknown spring\n  found:   stif\n  allowed: soft, stiff\n  hint:    did you mean `stiff`?"
/// );
/// # Ok::<(), realgap_core::Error>(())
/// ```
///
/// # Errors
/// The error of [`unknown_name`] if no item has this name.
pub fn look_up<'a, T>(
    what: &str,
    name: &str,
    items: impl IntoIterator<Item = T>,
    name_of: impl Fn(&T) -> &'a str,
) -> Result<T> {
    let mut known = Vec::new();
    for item in items {
        let its_name = name_of(&item);
        if its_name == name {
            return Ok(item);
        }
        known.push(its_name);
    }
    Err(unknown_name(what, name, known))
}

/// The error for a `name` that is not in the list `allowed`: it lists the allowed names and suggests the nearest one.
pub fn unknown_name<'a>(
    what: &str,
    name: &str,
    allowed: impl IntoIterator<Item = &'a str>,
) -> Error {
    let allowed: Vec<&str> = allowed.into_iter().collect();
    let list = match allowed.len() {
        0 => "nothing".to_owned(),
        count if count <= SHOWN => allowed.join(", "),
        count => format!("{} and {} more", allowed[..SHOWN].join(", "), count - SHOWN),
    };
    let error = Error::invalid(format!("unknown {what}"))
        .found(shorten(name))
        .allowed(list);
    match nearest_name(name, allowed) {
        Some(near) => error.hint(format!("did you mean `{near}`?")),
        None => error,
    }
}

/// Cuts a text to one line of at most 60 characters, for messages.
pub(super) fn shorten(text: &str) -> String {
    const LONGEST: usize = 60;
    let one_line: String = text.split_whitespace().collect::<Vec<_>>().join(" ");
    if one_line.chars().count() <= LONGEST {
        return one_line;
    }
    let start: String = one_line.chars().take(LONGEST - 4).collect();
    start + " ..."
}

/// The allowed name that is nearest to the written name, if it is near enough for the difference to be a typing error.
///
/// ```
/// use realgap_core::file::nearest_name;
///
/// assert_eq!(nearest_name("masskg", ["side_m", "mass_kg"]), Some("mass_kg"));
/// assert_eq!(nearest_name("rsm", ["pca", "rms"]), Some("rms"));
/// assert_eq!(nearest_name("colour", ["side_m", "mass_kg"]), None);
/// ```
///
/// A name may lack what stands before its last point, and the unit at its end.
///
/// ```
/// use realgap_core::file::nearest_name;
///
/// let known = ["floor.friction", "servo.stiffness_n_m_rad"];
/// assert_eq!(nearest_name("friction", known), Some("floor.friction"));
/// assert_eq!(nearest_name("servo.stiffness", known), Some("servo.stiffness_n_m_rad"));
/// ```
pub fn nearest_name<'a>(
    found: &str,
    allowed: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    // A very long text is no typing error, and the computation of its distance would take quadratic time.
    if found.chars().count() > 64 {
        return None;
    }
    // One error per three letters is allowed; a single letter is near to every other letter, so it gets no suggestion.
    let limit = (found.chars().count() + 1) / 3;
    allowed
        .into_iter()
        .map(|name| (distance(found, name), name))
        .filter(|&(distance, _)| distance <= limit)
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, name)| name)
}

/// How far a written name is from a known one, as a whole or as a part of it.
fn distance(found: &str, name: &str) -> usize {
    let whole = edit_distance(found, name);
    let last = name.rsplit('.').next().unwrap_or(name);
    // A part is worse than a whole name as near.
    let of_part = match found.contains('.') {
        true => usize::MAX,
        false => edit_distance(found, last).saturating_add(usize::from(last != name)),
    };
    let is_start = |name: &str| {
        let rest = name.strip_prefix(found);
        rest.is_some_and(|rest| rest.starts_with('_'))
    };
    let is_without_unit = found.len() >= LEAST_START && (is_start(name) || is_start(last));
    let of_start = if is_without_unit { 1 } else { usize::MAX };
    whole.min(of_part).min(of_start)
}

/// A shorter text is the start of too many names.
const LEAST_START: usize = 4;

/// Edit distance: the number of letters left out, added, replaced or exchanged with their neighbour (optimal string alignment); upper and
/// lower case count as equal.
fn edit_distance(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.to_lowercase().chars().collect();
    let b: Vec<char> = b.to_lowercase().chars().collect();
    let mut rows = vec![vec![0; b.len() + 1]; a.len() + 1];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            rows[i][j] = if i == 0 || j == 0 {
                i + j
            } else {
                let replaced = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
                let nearest = replaced.min(rows[i - 1][j] + 1).min(rows[i][j - 1] + 1);
                if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                    nearest.min(rows[i - 2][j - 2] + 1)
                } else {
                    nearest
                }
            };
        }
    }
    rows[a.len()][b.len()]
}
