//! Gives names to the columns of GoPro's telemetry. There, the name of one column lists the axes of several columns,
//! and numbers name the other columns: `Gyroscope (z,x,y) [rad/s]`, `1`, `2`.

/// Gives each column the name of its axis: `Gyroscope z [rad/s]`, `Gyroscope x [rad/s]`, `Gyroscope y [rad/s]`.
pub fn spread(names: &mut [String]) {
    for first in 0..names.len() {
        let Some((before, axes, after)) = listed(&names[first]) else { continue };
        let of_axes = |axis: &char| format!("{before}{axis}{after}");
        let own: Vec<String> = axes.iter().map(of_axes).collect();
        let Some(columns) = names.get_mut(first..first + own.len()) else { continue };
        if columns[1..].iter().zip(1..).all(|(name, number)| name.parse() == Ok(number)) {
            columns.clone_from_slice(&own);
        }
    }
}

/// The axes that a name lists, with the text before and after.
fn listed(name: &str) -> Option<(String, Vec<char>, String)> {
    let (before, rest) = name.split_once('(')?;
    let (list, after) = rest.split_once(')')?;
    let axis = |part: &str| part.trim().parse().ok().filter(|axis: &char| "xyzXYZ".contains(*axis));
    let axes: Vec<char> = list.split(',').map(axis).collect::<Option<_>>()?;
    (axes.len() > 1).then(|| (before.to_owned(), axes, after.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_that_one_name_lists_get_their_own() {
        let spread = |names: &[&str]| {
            let mut names: Vec<String> = names.iter().copied().map(str::to_owned).collect();
            spread(&mut names);
            names
        };
        assert_eq!(
            spread(&["cts", "Gyroscope (z,x,y) [rad/s]", "1", "2", "temperature [°C]"]),
            ["cts", "Gyroscope z [rad/s]", "Gyroscope x [rad/s]", "Gyroscope y [rad/s]", "temperature [°C]"]
        );
        for others in [&["a (x,y)", "2"][..], &["a (x,y)"], &["a (dps)", "1"], &["a (x,y)", "b"]] {
            assert_eq!(spread(others), others);
        }
    }
}
