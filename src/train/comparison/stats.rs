//! What several seeds have in common.

/// The mean; none of nothing.
pub fn mean(values: &[f64]) -> Option<f64> {
    let count = values.len() as f64;
    (count > 0.0).then(|| values.iter().sum::<f64>() / count)
}

/// The standard deviation over the seeds that there could be; none of fewer than two.
pub fn spread(values: &[f64]) -> Option<f64> {
    let mean = mean(values).filter(|_| values.len() > 1)?;
    let squares = values.iter().map(|value| (value - mean).powi(2));
    Some((squares.sum::<f64>() / (values.len() - 1) as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_seeds_have_no_spread() {
        assert_eq!((mean(&[]), spread(&[])), (None, None));
        assert_eq!((mean(&[3.0]), spread(&[3.0])), (Some(3.0), None));
        assert_eq!(mean(&[1.0, 2.0, 6.0]), Some(3.0));
        assert_eq!(spread(&[1.0, 2.0, 6.0]), Some(7.0_f64.sqrt()));
    }
}
