//! TOML tables laid over each other, compared, and what is wrong with one.

/// Writes `changes` over `table`, refusing keys that `table` does not know and values of another
/// kind. `within` is the table's own name with a dot, if it has one; `names` are all known keys.
pub fn overlay(
    table: &mut toml::Table,
    changes: toml::Table,
    within: &str,
    names: &[String],
) -> Result<(), Mistake> {
    for (key, value) in changes {
        let full = format!("{within}{key}");
        let put = match (table.get_mut(&key), value) {
            (None, _) => Err(format!(
                "unknown key `{full}`{}",
                nearest(&key, names.iter().map(String::as_str))
            )),
            (Some(toml::Value::Table(inner)), toml::Value::Table(changes)) => {
                overlay(inner, changes, &format!("{full}."), names)?;
                Ok(())
            }
            (Some(known), value) => put(known, value).map_err(|why| format!("`{full}` must {why}")),
        };
        put.map_err(|problem| Mistake { key: full, problem })?;
    }
    Ok(())
}

/// Writes one value over another of the same kind; the error says what it must be.
fn put(known: &mut toml::Value, value: toml::Value) -> Result<(), String> {
    match (known, value) {
        // Whole numbers stand for numbers.
        (toml::Value::Float(known), toml::Value::Integer(whole)) => *known = whole as f64,
        (toml::Value::Integer(_), toml::Value::Integer(..0)) => {
            return Err("not be negative".to_string());
        }
        (known, value) if known.same_type(&value) => *known = value,
        (known, value) => {
            let (wanted, found) = (known.type_str(), value.type_str());
            return Err(format!("be of the type {wanted}, not {found}"));
        }
    }
    Ok(())
}

/// All keys of a table and the tables in it, like `ppo` and `ppo.envs`.
pub fn names(table: &toml::Table, within: &str) -> Vec<String> {
    let mut all = Vec::new();
    for (key, value) in table {
        all.push(format!("{within}{key}"));
        if let Some(inner) = value.as_table() {
            all.extend(names(inner, &format!("{within}{key}.")));
        }
    }
    all
}

/// Which known name may have been meant, if there is any; names may have the tables they stand in
/// before them.
pub(in crate::train) fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> String {
    let last = |name: &str| name.rfind('.').map_or(0, |dot| dot + 1);
    let nearest =
        known.min_by_key(|known| strsim::damerau_levenshtein(name, &known[last(known)..]));
    nearest.map_or(String::new(), |known| format!(", did you mean `{known}`?"))
}

/// What is wrong with a key.
pub struct Mistake {
    /// With the tables it stands in, like `ppo.envs`; empty if it is not known which.
    pub key: String,
    pub problem: String,
}

/// A key by which two tables differ.
pub struct Difference {
    /// With the tables it stands in, like `ppo.envs`.
    pub key: String,
    /// Whether both tables have it.
    pub in_both: bool,
}

/// The first key whose values differ, or that only one table has.
pub fn different(one: &toml::Table, other: &toml::Table, within: &str) -> Option<Difference> {
    let keys = one.keys().chain(other.keys());
    keys.filter(|&key| one.get(key) != other.get(key))
        .find_map(|name| {
            let key = format!("{within}{name}");
            match (one.get(name), other.get(name)) {
                (Some(toml::Value::Table(one)), Some(toml::Value::Table(other))) => {
                    different(one, other, &format!("{key}."))
                }
                (one, other) => Some(Difference {
                    key,
                    in_both: one.is_some() && other.is_some(),
                }),
            }
        })
}

/// The line (from 1) of a TOML text that has a key, if the text is TOML and has it.
pub fn line_of(text: &str, key: &str) -> Option<usize> {
    let table = toml::de::DeTable::parse(text).ok()?;
    let mut table = table.get_ref();
    let mut names = key.split('.').peekable();
    loop {
        let (name, value) = table.get_key_value(names.next()?)?;
        match (names.peek(), value.get_ref()) {
            (Some(_), toml::de::DeValue::Table(inner)) => table = inner,
            _ => return Some(1 + text[..name.span().start].matches('\n').count()),
        }
    }
}
