//! What a comparison writes: a picture, a table, a JSON and two CSV files.

use super::stats::{mean, spread};
use super::{ComparedRun, Comparison, FinishedRun, Outcome};
use crate::container::write_whole;
use crate::report::table::table;
use crate::train::config::VERSION;
use anyhow::Result;
use serde_json::{Value, json};

impl Comparison<'_> {
    pub(super) fn write(&self, outcomes: &[Outcome]) -> Result<()> {
        #[cfg(feature = "report")]
        self.draw(outcomes)?;
        let json = serde_json::to_string_pretty(&self.json(outcomes))? + "\n";
        for (name, text) in [
            (format!("{}.txt", self.title), self.summary(outcomes)),
            (format!("{}.json", self.title), json),
            ("evaluation.csv".into(), self.evaluations(outcomes)),
            ("curves.csv".into(), self.curves(outcomes)),
        ] {
            write_whole(&self.out.join(name), text.as_bytes())?;
        }
        Ok(())
    }

    #[cfg(feature = "report")]
    fn draw(&self, outcomes: &[Outcome]) -> Result<()> {
        use crate::report::ablation::{Method, draw};
        use crate::train::figures::points;
        let methods = self.contestants.iter().enumerate();
        let methods = methods.map(|(index, contestant)| Method {
            name: contestant.name.clone(),
            colour: index,
            seeds: of(outcomes, index).map(|run| points(&run.rows)).collect(),
        });
        Ok(draw(
            &self.out.join(format!("{}.png", self.title)),
            &methods.collect::<Vec<_>>(),
        )?)
    }

    /// A table of all, means over the seeds, and below it what failed.
    pub fn summary(&self, outcomes: &[Outcome]) -> String {
        let success = format!("{} %", success_name(outcomes).replace('_', " "));
        let mut titles = vec!["variant", "seeds", &success, "\u{b1}", "of each seed"];
        titles.extend(self.measures.iter().map(|measure| measure.title));
        titles.extend(["training s", "steps/s"]);
        let contestants = 0..self.contestants.len();
        let rows: Vec<_> = contestants.map(|index| self.row(outcomes, index)).collect();
        let failed = outcomes.iter().filter_map(|outcome| {
            let why = outcome.result.as_ref().err()?;
            Some(format!("{} failed: {why}\n", self.folder(outcome.run)))
        });
        table(&titles, &rows) + &failed.collect::<String>()
    }

    /// A contestant's row of the table.
    fn row(&self, outcomes: &[Outcome], contestant: usize) -> Vec<String> {
        let all = |value: &dyn Fn(&FinishedRun) -> f64| -> Vec<f64> {
            of(outcomes, contestant).map(value).collect()
        };
        let success = all(&|run| 100.0 * run.summary.success());
        let own = outcomes.iter();
        let own = own.filter(|outcome| outcome.run.contestant == contestant);
        let each = own.map(|outcome| match &outcome.result {
            Ok(run) => format!("{:.1}", 100.0 * run.summary.success()),
            Err(_) => "failed".into(),
        });
        let mut row = vec![
            self.contestants[contestant].name.clone(),
            success.len().to_string(),
            cell(mean(&success), 1),
            cell(spread(&success), 1),
            each.collect::<Vec<_>>().join(" "),
        ];
        row.extend(self.measures.iter().map(|measure| {
            let values = all(&|run| measure.unit * run.summary.measure(measure.name));
            cell(mean(&values), measure.digits)
        }));
        let wall_s = all(&|run| run.summary.wall_s);
        let steps_per_s = all(&|run| self.steps_per_s(contestant, run));
        row.extend([cell(mean(&wall_s), 1), cell(mean(&steps_per_s), 0)]);
        row
    }

    /// Steps of the environments within in a second of a training.
    fn steps_per_s(&self, contestant: usize, run: &FinishedRun) -> f64 {
        self.contestants[contestant].body_steps as f64 * run.summary.steps_per_s
    }

    /// All of it for programs.
    fn json(&self, outcomes: &[Outcome]) -> Value {
        let contestants = 0..self.contestants.len();
        json!({
            "version": VERSION,
            "task": self.entry.name,
            "device": self.device.name(),
            "success_name": success_name(outcomes),
            "variants": contestants.map(|index| self.variant(outcomes, index)).collect::<Value>(),
        })
    }

    /// A contestant and what came of it, for programs.
    fn variant(&self, outcomes: &[Outcome], index: usize) -> Value {
        let contestant = &self.contestants[index];
        let all = |value: &dyn Fn(&FinishedRun) -> f64| -> Vec<f64> {
            of(outcomes, index).map(value).collect()
        };
        let success = all(&|run| run.summary.success());
        let own = outcomes.iter();
        let own = own.filter(|outcome| outcome.run.contestant == index);
        json!({
            "name": contestant.name,
            "settings": contestant.settings,
            "success_mean": mean(&success),
            "success_spread": spread(&success),
            "wall_s_mean": mean(&all(&|run| run.summary.wall_s)),
            "steps_per_s_mean": mean(&all(&|run| self.steps_per_s(index, run))),
            "runs": own.map(|outcome| self.run_json(outcome)).collect::<Value>(),
        })
    }

    /// A training for programs: its folder, and its summary or why there is none.
    fn run_json(&self, outcome: &Outcome) -> Value {
        let mut found = match &outcome.result {
            Ok(run) => json!(run.summary),
            Err(why) => json!({ "failure": why }),
        };
        found["seed"] = outcome.run.seed.into();
        found["folder"] = self.folder(outcome.run).into();
        found
    }

    /// The evaluations as CSV.
    fn evaluations(&self, outcomes: &[Outcome]) -> String {
        let names = self.measures.iter().map(|measure| measure.name);
        let mut text = csv(["variant", "seed", "episodes", "success"]
            .into_iter()
            .chain(names.clone()));
        for (run, found) in finished(outcomes) {
            let summary = &found.summary;
            let first = [
                self.contestants[run.contestant].name.clone(),
                run.seed.to_string(),
                summary.episodes.to_string(),
                summary.success().to_string(),
            ];
            let measures = names.clone().map(|name| summary.measure(name).to_string());
            text += &csv(first.into_iter().chain(measures));
        }
        text
    }

    /// The updates as CSV.
    fn curves(&self, outcomes: &[Outcome]) -> String {
        let rates = self.rates;
        let first = [
            "variant", "seed", "steps", "wall_s", "level", "episodes", "success",
        ];
        let titles = first.iter().chain(rates).chain(&["return", "length"]);
        let mut text = csv(titles.copied());
        let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
        for (run, found) in finished(outcomes) {
            for row in &found.rows {
                let mut line = vec![
                    self.contestants[run.contestant].name.clone(),
                    run.seed.to_string(),
                    row.steps.to_string(),
                    row.wall_s.to_string(),
                    row.level.map_or(String::new(), |level| level.to_string()),
                    row.episodes.to_string(),
                    number(row.success),
                ];
                line.extend(rates.iter().map(|name| number(row.rate(name))));
                line.extend([number(row.episode_return), number(row.episode_length)]);
                text += &csv(line.into_iter());
            }
        }
        text
    }
}

/// The trainings that came to their end.
fn finished(outcomes: &[Outcome]) -> impl Iterator<Item = (ComparedRun, &FinishedRun)> {
    let found = outcomes.iter();
    found.filter_map(|outcome| Some((outcome.run, outcome.result.as_ref().ok()?)))
}

/// Those of a contestant.
fn of(outcomes: &[Outcome], contestant: usize) -> impl Iterator<Item = &FinishedRun> {
    let own = finished(outcomes).filter(move |(run, _)| run.contestant == contestant);
    own.map(|(_, found)| found)
}

/// What a success of the task is called.
fn success_name(outcomes: &[Outcome]) -> &str {
    let first = finished(outcomes).next();
    first.map_or("success", |(_, found)| &found.summary.success_name)
}

/// A number in a table.
fn cell(value: Option<f64>, digits: usize) -> String {
    // Not -0.
    value.map_or("-".into(), |value| format!("{:.digits$}", value + 0.0))
}

/// A line of comma-separated values.
fn csv<T: AsRef<str>>(values: impl Iterator<Item = T>) -> String {
    let values: Vec<String> = values.map(|value| quoted(value.as_ref())).collect();
    values.join(",") + "\n"
}

/// A value of a line, in quotes where it needs them.
fn quoted(value: &str) -> String {
    match value.contains([',', '"']) {
        true => format!("\"{}\"", value.replace('"', "\"\"")),
        false => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_with_commas_are_quoted() {
        let line = csv(["hidden=[64, 64]", "1", "say \"a\"", ""].into_iter());
        assert_eq!(line, "\"hidden=[64, 64]\",1,\"say \"\"a\"\"\",\n");
    }

    #[test]
    fn a_missing_mean_is_a_dash() {
        assert_eq!(cell(None, 1), "-");
        assert_eq!(cell(Some(-0.0), 1), "0.0");
    }
}
