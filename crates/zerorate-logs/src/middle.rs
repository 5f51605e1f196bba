//! Means and medians.

/// The mean; not a number without numbers.
pub fn mean(numbers: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = numbers.fold((0.0, 0u32), |(sum, count), number| (sum + number, count + 1));
    sum / f64::from(count)
}

/// The median: the upper one, if two numbers are in the middle. 0 without numbers.
pub fn median(numbers: &mut [f64]) -> f64 {
    let middle = numbers.len() / 2;
    if numbers.is_empty() { 0.0 } else { *numbers.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// Mean of the steps from half to twice the median, so that gaps are left out. `None` unless the median is positive.
pub fn usual_step(mut steps: Vec<f64>) -> Option<f64> {
    let middle = Some(median(&mut steps)).filter(|median| *median > 0.0)?;
    Some(mean(steps.into_iter().filter(|step| (0.5..=2.0).contains(&(step / middle)))))
}
