//! How much the task's reward weighs beside that of the style: fixed, or as much as the style bears.
//!
//! The rule follows the paper, whose task weight is adapted "akin to a proportional-derivative controller" as in
//! PADL (Juravsky et al. 2022). Neither prints its constants: **all constants here are ours**.
//!
//! With e = running mean of the style reward / reference - 1, every update changes lambda, the ratio of the
//! weights of task and style, by [`KP`] e + [`KD`] (e - e of the update before), within [`LAMBDA_RANGE`]. The
//! weights are w_task = lambda / (1 + lambda) and w_style = 1 / (1 + lambda).

use super::gae::RewardSource;
use crate::container::{Section, SectionError};
use serde::{Deserialize, Serialize};

/// Change of lambda in an update, of the error.
pub const KP: f64 = 0.05;
/// Change of lambda, of the error's change since the update before.
pub const KD: f64 = 0.5;
/// Range of lambda: the task weighs a third to three quarters.
pub const LAMBDA_RANGE: [f64; 2] = [0.5, 3.0];
/// The style reward that is aimed at, of the one that the policy has without a task.
pub const OF_OWN: f64 = 0.8;
/// Updates from which a run finds its reference itself.
pub const FIRST_UPDATES: f64 = 20.0;

/// Weight of the newest update in the running mean of the style reward, which is over the last five or so. Above
/// `KP / KD`, so that the derivative outruns the mean's lag: lambda leaves an end of its range at once when the
/// style is as it should be.
const NEWEST: f64 = 0.2;
/// Least reference: one of 0 could not be compared with.
const MIN_REFERENCE: f64 = 1e-6;

/// How the weight of the task is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum WeightRule {
    /// It stays as it is configured.
    #[default]
    Fixed,
    /// It grows while the style is better than its reference, and falls while it is worse.
    Pd,
}

/// Everything that may be chosen about the weight of the task.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TaskWeightConfig {
    /// How the weight is found. By [`WeightRule::Pd`] lambda starts at the ratio of the fixed weights, as far as
    /// its range lets it.
    pub rule: WeightRule,
    /// Mean style reward of a step that the rule aims at. 0 to find it: of a run that begins with another, 80 %
    /// of the style reward of that one's last updates, or the reference that it was itself trained by; else
    /// 80 % of that of its own first 20 updates in which the actor learns, until which lambda stays.
    pub style_reference: f64,
}

/// The weight of the task, if a rule finds it, and the running mean of the style reward.
pub struct TaskWeight {
    style: RunningMean,
    rule: Option<PdRule>,
}

impl TaskWeight {
    /// Weights that stay as they are.
    pub fn fixed() -> Self {
        TaskWeight {
            style: RunningMean::default(),
            rule: None,
        }
    }

    /// As it is chosen, for fixed weights of this ratio, task to style.
    pub fn new(config: &TaskWeightConfig, lambda: f64) -> Self {
        let [least, most] = LAMBDA_RANGE;
        let rule = || PdRule {
            lambda: lambda.clamp(least, most),
            error: 0.0,
            reference: match config.style_reference > 0.0 {
                true => RunningMean::known(config.style_reference),
                false => RunningMean::default(),
            },
        };
        TaskWeight {
            rule: (config.rule == WeightRule::Pd).then(rule),
            ..TaskWeight::fixed()
        }
    }

    /// Takes in the mean style reward of a step of an update in which the actor learned.
    pub fn update(&mut self, style: f64) {
        self.style.update(style, NEWEST);
        if let Some(rule) = &mut self.rule {
            rule.update(style, self.style.mean);
        }
    }

    /// The weights of the advantages of both rewards, whose sum is 1; none if they are fixed.
    pub fn weights(&self) -> Option<[(RewardSource, f32); 2]> {
        let rule = self.rule.as_ref()?;
        Some([
            (RewardSource::Task, rule.task_weight() as f32),
            (RewardSource::Style, (1.0 - rule.task_weight()) as f32),
        ])
    }

    /// What is worth a curve, by its name in `metrics.jsonl`; nothing if the weights are fixed.
    pub fn metrics(&self) -> Vec<(&'static str, f64)> {
        let Some(rule) = &self.rule else {
            return Vec::new();
        };
        let reference = rule.is_found().then_some(rule.reference.mean);
        let reference = reference.map(|reference| ("style_reference", reference));
        let weights = [("task_weight", rule.task_weight()), ("lambda", rule.lambda)];
        weights.into_iter().chain(reference).collect()
    }

    /// Finds the reference in what another run saved, if it is not known and that run has one.
    ///
    /// # Errors
    /// What it saved is damaged.
    pub fn start_from(&mut self, other: &mut Section) -> Result<(), SectionError> {
        let Some(rule) = self.rule.as_mut().filter(|rule| !rule.is_found()) else {
            return Ok(());
        };
        if let Some(reference) = saved_reference(other)? {
            rule.reference = RunningMean::known(reference);
        }
        Ok(())
    }

    /// Saves all of it.
    pub fn save(&self, to: &mut Section) {
        to.put_array("style", &[self.style]);
        to.put_array("rule", self.rule.as_slice());
    }

    /// Puts a saved state back.
    ///
    /// # Errors
    /// It is none, or of the other kind.
    pub fn load(&mut self, from: &mut Section) -> Result<(), SectionError> {
        let (style, rule) = saved(from)?;
        if rule.is_some() != self.rule.is_some() {
            return Err(SectionError("its task weight is of another rule".into()));
        }
        (self.style, self.rule) = (style, rule);
        Ok(())
    }
}

/// Reads what [`TaskWeight::save`] saved.
fn saved(from: &mut Section) -> Result<(RunningMean, Option<PdRule>), SectionError> {
    let style: RunningMean = from.take_array("style", 1)?[0];
    let rules = usize::from(from.array_len("rule") > 0);
    let rule: Option<PdRule> = from.take_array("rule", rules)?.pop();
    match style.is_valid() && rule.is_none_or(|rule| rule.is_valid()) {
        true => Ok((style, rule)),
        false => Err(SectionError("its task weight is no number".into())),
    }
}

/// The style reward that a run which begins with another is to keep to; none if that run knows of no style.
///
/// # Errors
/// What it saved is damaged.
fn saved_reference(other: &mut Section) -> Result<Option<f64>, SectionError> {
    if other.is_empty() {
        return Ok(None);
    }
    let (style, rule) = saved(other)?;
    // Of a run that was held to a reference itself, 80 % again would let the style decay from run to run.
    let inherited = rule
        .filter(PdRule::is_found)
        .map(|rule| rule.reference.mean);
    let own = (style.updates > 0.0).then_some(OF_OWN * style.mean);
    Ok(inherited.or(own))
}

/// Lambda, and what its rule remembers.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
struct PdRule {
    lambda: f64,
    /// That of the update before; 0 before the first.
    error: f64,
    /// The style reward that is aimed at: a mean over [`FIRST_UPDATES`] once it is found.
    reference: RunningMean,
}

impl PdRule {
    fn is_found(&self) -> bool {
        self.reference.updates >= FIRST_UPDATES
    }

    fn task_weight(&self) -> f64 {
        self.lambda / (1.0 + self.lambda)
    }

    /// Takes in an update's style reward and its running mean.
    fn update(&mut self, style: f64, running: f64) {
        if !self.is_found() {
            self.reference.update(OF_OWN * style, 0.0);
            return;
        }
        let error = running / self.reference.mean.max(MIN_REFERENCE) - 1.0;
        self.lambda = next_lambda(self.lambda, error, self.error);
        self.error = error;
    }

    fn is_valid(&self) -> bool {
        self.lambda.is_finite()
            && self.lambda > 0.0
            && self.error.is_finite()
            && self.reference.is_valid()
    }
}

/// The rule. Nothing adds up but lambda, which is clamped: there is nothing to be wound up.
fn next_lambda(lambda: f64, error: f64, before: f64) -> f64 {
    let [least, most] = LAMBDA_RANGE;
    (lambda + KP * error + KD * (error - before)).clamp(least, most)
}

/// A mean over updates.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
struct RunningMean {
    mean: f64,
    /// A whole number.
    updates: f64,
}

impl RunningMean {
    /// A mean that is given, of as many updates as are needed.
    fn known(mean: f64) -> Self {
        let updates = FIRST_UPDATES;
        RunningMean { mean, updates }
    }

    /// Takes a value in, by the weight `newest`; the first ones count alike.
    fn update(&mut self, value: f64, newest: f64) {
        self.updates += 1.0;
        self.mean += (value - self.mean) * newest.max(1.0 / self.updates);
    }

    fn is_valid(&self) -> bool {
        self.mean.is_finite() && self.updates.is_finite() && self.updates >= 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REFERENCE: f64 = 0.4;

    fn pd(style_reference: f64, lambda: f64) -> TaskWeight {
        let rule = WeightRule::Pd;
        let config = TaskWeightConfig {
            rule,
            style_reference,
        };
        TaskWeight::new(&config, lambda)
    }

    fn lambda(weight: &TaskWeight) -> f64 {
        weight.rule.expect("a rule").lambda
    }

    /// Lambda after each of some style rewards.
    fn play(weight: &mut TaskWeight, rewards: impl IntoIterator<Item = f64>) -> Vec<f64> {
        let rewards = rewards.into_iter();
        let played = rewards.map(|style| {
            weight.update(style);
            lambda(weight)
        });
        played.collect()
    }

    fn again(style: f64, times: usize) -> std::iter::RepeatN<f64> {
        std::iter::repeat_n(style, times)
    }

    fn saved_state(weight: &TaskWeight) -> Section {
        let mut section = Section::default();
        weight.save(&mut section);
        section
    }

    #[test]
    fn the_rule_is_the_printed_one() {
        assert_eq!(next_lambda(1.0, 0.2, 0.1), 1.0 + 0.05 * 0.2 + 0.5 * 0.1);
        let mut weight = pd(REFERENCE, 1.0);
        weight.update(0.5);
        weight.update(0.6);
        let [first, second] = [0.5, 0.55].map(|mean| mean / REFERENCE - 1.0);
        let wanted = 1.0 + KP * (first + second) + KD * second;
        assert!((lambda(&weight) - wanted).abs() < 1e-12);
    }

    #[test]
    fn it_rises_with_a_good_style_and_falls_with_a_bad_one() {
        let mut weight = pd(REFERENCE, 1.0);
        let good = play(&mut weight, again(0.5, 10));
        assert!(good.windows(2).all(|pair| pair[0] < pair[1]) && good[0] > 1.0);
        let bad = play(&mut weight, again(0.3, 10));
        assert!(bad.windows(2).all(|pair| pair[0] > pair[1]) && bad[0] < good[9]);
        let [(_, task), (_, style)] = weight.weights().expect("a rule");
        let ratio = f64::from(task / style);
        assert!((task + style - 1.0).abs() < 1e-6 && (ratio - lambda(&weight)).abs() < 1e-6);
    }

    #[test]
    fn it_stays_in_its_range() {
        let [least, most] = LAMBDA_RANGE;
        // It starts there, too.
        let mut weight = pd(REFERENCE, 9.0);
        assert_eq!(weight.metrics()[0], ("task_weight", 0.75));
        let played = play(&mut weight, again(4.0, 200));
        assert!(played.iter().all(|&lambda| lambda == most));
        assert_eq!(play(&mut weight, again(0.0, 200)).pop(), Some(least));
    }

    /// However long it lay at an end.
    #[test]
    fn it_leaves_the_ends_at_once() {
        let near = [REFERENCE * 1.01, REFERENCE * 0.99];
        for ((far, near), end) in [0.8, 0.1].into_iter().zip(near).zip([3.0, 0.5]) {
            for times in [100, 10_000] {
                let mut weight = pd(REFERENCE, 1.0);
                assert_eq!(play(&mut weight, again(far, times)).pop(), Some(end));
                let back = play(&mut weight, again(near, 20));
                assert_ne!(back[0], end, "after {times} updates at {far}");
                assert!((back[19] - end).abs() > 0.2, "{back:?}");
            }
        }
    }

    #[test]
    fn it_finds_its_reference_in_the_first_updates() {
        let mut weight = pd(0.0, 1.5);
        let first = FIRST_UPDATES as usize;
        let played = play(&mut weight, (0..first).map(|update| 0.1 * update as f64));
        assert!(played.iter().all(|&lambda| lambda == 1.5));
        let found = weight.metrics()[2].1;
        assert!((found - OF_OWN * 0.95).abs() < 1e-12, "{found}");
        weight.update(1.9);
        assert!(lambda(&weight) > 1.5);
    }

    #[test]
    fn it_begins_with_the_style_of_another_run() {
        let mut other = TaskWeight::fixed();
        again(0.6, 50).for_each(|style| other.update(style));
        let mut weight = pd(0.0, 1.0);
        weight.start_from(&mut saved_state(&other)).unwrap();
        assert!((weight.metrics()[2].1 - OF_OWN * 0.6).abs() < 1e-12);
        // What was itself held to a reference hands that on; a reference that is given stays.
        for (given, wanted) in [(0.0, weight.metrics()[2].1), (0.3, 0.3)] {
            let mut next = pd(given, 1.0);
            next.start_from(&mut saved_state(&weight)).unwrap();
            assert_eq!(next.metrics()[2].1, wanted);
        }
        // A run without a style, or that has not learned, has none.
        for mut none in [Section::default(), saved_state(&TaskWeight::fixed())] {
            let mut weight = pd(0.0, 1.0);
            weight.start_from(&mut none).unwrap();
            assert_eq!(weight.metrics().len(), 2);
        }
    }

    #[test]
    fn a_saved_state_goes_on_bit_for_bit() {
        let style = |update: usize| 0.4 + 0.13 * (update as f64).sin();
        for done in [0, 7, 20, 45] {
            let mut whole = pd(0.0, 1.0);
            play(&mut whole, (0..done).map(style));
            let mut resumed = pd(0.0, 1.0);
            resumed.load(&mut saved_state(&whole)).unwrap();
            for weight in [&mut whole, &mut resumed] {
                play(weight, (done..100).map(style));
            }
            assert!(saved_state(&whole) == saved_state(&resumed));
        }
    }

    #[test]
    fn what_is_no_state_is_refused() {
        let fixed = TaskWeight::fixed();
        assert!(pd(0.0, 1.0).load(&mut saved_state(&fixed)).is_err());
        assert!(pd(0.0, 1.0).load(&mut Section::default()).is_err());
        for broken in [f64::NAN, f64::INFINITY, -1.0] {
            let mut weight = pd(0.0, 1.0);
            weight.rule.as_mut().expect("a rule").lambda = broken;
            let mut section = saved_state(&weight);
            assert!(pd(0.0, 1.0).load(&mut section).is_err(), "{broken}");
        }
    }
}
