//! Whom bouts are against, as `shaders/shared/bouts.wgsl` reads it.

/// Opponents who may be drawn: first those that follow a script, then policies, the newest last.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OpponentTable {
    /// Environments.
    pub envs: usize,
    /// Sums of statistics of a row.
    pub stats: usize,
    /// How many of them follow a script.
    pub scripted: usize,
    /// Their numbers, ascending; not empty.
    pub numbers: Vec<u32>,
    /// How many of 2^24 draws draw each opponent or one before it.
    pub lots: Vec<u32>,
}

impl OpponentTable {
    /// As shaders read it.
    pub fn words(&self) -> Vec<u32> {
        let head = [self.envs, self.stats, self.numbers.len(), self.scripted];
        let head = head.map(|number| number as u32).to_vec();
        [head, self.numbers.clone(), self.lots.clone()].concat()
    }

    /// How many are policies.
    pub fn policies(&self) -> usize {
        self.numbers.len() - self.scripted
    }

    /// The index of an opponent by its number: the newest's, if it has left.
    pub fn index(&self, number: u32) -> usize {
        let found = self.numbers.iter().position(|own| *own == number);
        found.unwrap_or(self.numbers.len() - 1)
    }

    /// The index of the opponent that random `bits` draw.
    pub fn drawn(&self, bits: u32) -> usize {
        let above = self.lots.iter().position(|&lot| bits >> 8 < lot);
        above.unwrap_or(self.numbers.len() - 1)
    }
}
