//! Every combination of the values of several keys.

use super::setting::{Setting, value};

/// A key of the configuration with the values to try.
#[derive(Clone, Debug, PartialEq)]
pub struct SweptKey {
    pub key: String,
    pub values: Vec<toml::Value>,
}

/// A key and its values as the command line has them.
pub fn swept_key(text: &str) -> Result<SweptKey, String> {
    let Some((key, values)) = text.split_once('=') else {
        return Err("a key, `=` and values, like ppo.gamma=0.97,0.98,0.99".into());
    };
    let values = split(values);
    if values.contains(&"") {
        return Err("between two commas there is a value missing".into());
    }
    Ok(SweptKey {
        key: key.trim().to_string(),
        values: values.into_iter().map(value).collect(),
    })
}

/// The values of a list. Commas within brackets, braces or quotes separate nothing.
fn split(text: &str) -> Vec<&str> {
    let (mut depth, mut quoted) = (0, false);
    let values = text.split(|letter| {
        match letter {
            '"' => quoted = !quoted,
            '[' | '{' if !quoted => depth += 1,
            ']' | '}' if !quoted => depth -= 1,
            _ => {}
        }
        letter == ',' && depth == 0 && !quoted
    });
    values.map(str::trim).collect()
}

/// Every combination of the values; those of the last key change fastest.
pub fn combinations(keys: &[SweptKey]) -> Vec<Vec<Setting>> {
    let with_value = |point: &Vec<Setting>, key: &str, value: &toml::Value| {
        let setting = Setting {
            key: key.to_string(),
            value: value.clone(),
        };
        point.iter().cloned().chain([setting]).collect()
    };
    keys.iter().fold(vec![Vec::new()], |points, swept| {
        let values = |point| {
            let values = swept.values.iter();
            values.map(move |value| with_value(point, &swept.key, value))
        };
        points.iter().flat_map(values).collect()
    })
}

/// The name of a combination: its keys, as short as they are still told apart, with their values.
pub fn name(point: &[Setting]) -> String {
    let parts = point.iter().map(|setting| {
        let key = short(&setting.key, point);
        match setting.value.as_str() {
            Some(word) => format!("{key}={word}"),
            None => format!("{key}={}", setting.value),
        }
    });
    parts.collect::<Vec<_>>().join(" ")
}

/// The end of a key that no other key has.
fn short<'a>(key: &'a str, all: &[Setting]) -> &'a str {
    let dots = key.rmatch_indices('.').map(|(dot, _)| &key[dot + 1..]);
    let ends_so = |end: &str| all.iter().filter(|other| other.key.ends_with(end)).count();
    let mut ends = dots.filter(|end| ends_so(end) == 1);
    ends.next().unwrap_or(key)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys(texts: &[&str]) -> Vec<SweptKey> {
        texts.iter().map(|text| swept_key(text).unwrap()).collect()
    }

    #[test]
    fn commas_within_brackets_and_quotes_separate_nothing() {
        for (text, values) in [
            ("0.9,0.99", &["0.9", "0.99"][..]),
            ("[64,64], [128] ,[]", &["[64,64]", "[128]", "[]"]),
            ("[[1,2],[3]],[[4]]", &["[[1,2],[3]]", "[[4]]"]),
            ("[{a=1,b=2},{a=3}]", &["[{a=1,b=2},{a=3}]"]),
            ("\"a,b\",c", &["\"a,b\"", "c"]),
            ("\"[\",2", &["\"[\"", "2"]),
            ("one", &["one"]),
            ("1,,2", &["1", "", "2"]),
        ] {
            assert_eq!(split(text), values, "{text}");
        }
    }

    #[test]
    fn values_are_toml_or_words() {
        let swept = swept_key("a.b = 1,2.5,true,tanh,[64, 64]").unwrap();
        assert_eq!(swept.key, "a.b");
        let array = toml::Value::Array(vec![64.into(), 64.into()]);
        let values: [toml::Value; 5] = [1.into(), 2.5.into(), true.into(), "tanh".into(), array];
        assert_eq!(swept.values, values);
        for text in ["ppo.gamma", "ppo.gamma=", "ppo.gamma=1,", "ppo.gamma=,1"] {
            assert!(swept_key(text).is_err(), "{text}");
        }
    }

    #[test]
    fn the_last_key_changes_fastest() {
        let points = combinations(&keys(&["a.x=1,2", "b=[3,4],[5]"]));
        let names: Vec<String> = points.iter().map(|point| name(point)).collect();
        let wanted = ["x=1 b=[3, 4]", "x=1 b=[5]", "x=2 b=[3, 4]", "x=2 b=[5]"];
        assert_eq!(names, wanted);
        assert_eq!(combinations(&[]), [vec![]]);
    }

    #[test]
    fn keys_are_shortened_as_far_as_they_are_told_apart() {
        for (texts, named) in [
            (&["ppo.network.hidden=[64]"][..], "hidden=[64]"),
            (&["ppo.lr=1", "amp.lr=2"], "ppo.lr=1 amp.lr=2"),
            (&["a.ppo.lr=1", "b.amp.lr=2"], "ppo.lr=1 amp.lr=2"),
            (&["steps=1", "task.max_steps=2"], "steps=1 max_steps=2"),
            (&["steps=1", "task.steps=2"], "steps=1 task.steps=2"),
            (&["activation=tanh"], "activation=tanh"),
        ] {
            assert_eq!(name(&combinations(&keys(texts))[0]), named);
        }
    }
}
