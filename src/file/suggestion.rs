//! "Did you mean ...?"

/// The allowed name closest to what was written, if it is close enough to be a slip of the pen.
///
/// ```
/// use realgap::file::nearest_name;
///
/// assert_eq!(nearest_name("masskg", ["side_m", "mass_kg"]), Some("mass_kg"));
/// assert_eq!(nearest_name("colour", ["side_m", "mass_kg"]), None);
/// ```
pub fn nearest_name<'a>(
    found: &str,
    allowed: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    // Long garbage is no slip of the pen, and its distance would cost quadratic time.
    if found.chars().count() > 64 {
        return None;
    }
    // One slip per three letters: a single letter is close to every other, which says nothing.
    let limit = (found.chars().count() + 1) / 3;
    allowed
        .into_iter()
        .map(|name| (edit_distance(found, name), name))
        .filter(|&(distance, _)| distance <= limit)
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, name)| name)
}

/// Levenshtein distance, ignoring upper and lower case.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.to_lowercase().chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.to_lowercase().chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &to) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(from != to);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}
