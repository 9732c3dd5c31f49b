//! Named sums over the episodes that ended.

/// Sums over episodes, by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stats {
    names: &'static [&'static str],
    sums: Vec<f64>,
}

impl Stats {
    /// `sums` in the order of `names`.
    pub fn new(names: &'static [&'static str], sums: &[f32]) -> Self {
        let sums = sums.iter().map(|&sum| f64::from(sum)).collect();
        Stats { names, sums }
    }

    /// A sum by name; 0 if there is none.
    pub fn sum(&self, name: &str) -> f64 {
        let found = self.iter().find(|(other, _)| *other == name);
        found.map_or(0.0, |(_, sum)| sum)
    }

    /// A sum over the number of episodes. None if no episode ended.
    pub fn mean(&self, name: &str) -> Option<f64> {
        let episodes = self.sum("episodes");
        (episodes > 0.0).then(|| self.sum(name) / episodes)
    }

    /// All names and sums.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, f64)> {
        self.names.iter().copied().zip(self.sums.iter().copied())
    }
}
