//! Keys of the configuration that the command line changes.

use clap::Args;

/// A key of the configuration with its new value.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    pub key: String,
    pub value: toml::Value,
}

/// The option `--set` where a key has one value.
#[derive(Args, Clone)]
pub struct Settings {
    /// Change one key after that, like ppo.gamma=0.98; may be given several times
    #[arg(long = "set", id = "set", value_name = "KEY=VALUE", value_parser = setting)]
    pub all: Vec<Setting>,
}

fn setting(text: &str) -> Result<Setting, String> {
    let Some((key, text)) = text.split_once('=') else {
        return Err("a key, `=` and a value, like ppo.gamma=0.98".into());
    };
    Ok(Setting {
        key: key.trim().to_string(),
        value: value(text),
    })
}

/// A value is TOML, or else a word.
pub fn value(text: &str) -> toml::Value {
    let parsed = toml::from_str(&format!("value = {text}"));
    let parsed = parsed.map(|mut table: toml::Table| table.remove("value"));
    parsed.ok().flatten().unwrap_or_else(|| text.into())
}
