//! `cargo run --manifest-path tests/capi/header/Cargo.toml` makes `include/footwork.h` of `src/capi`; with `-- --check`
//! it says whether the header is what it would make.

use anyhow::{Context, Result, bail};
use cbindgen::{Builder, Config};
use std::path::Path;

/// Files of `src/capi` that declare something, in the order of the header.
const SOURCES: [&str; 4] = ["database", "policy", "characters", "status"];

fn main() -> Result<()> {
    let check = std::env::args()
        .nth(1)
        .is_some_and(|argument| argument == "--check");
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..");
    let config = Config::from_file(root.join("cbindgen.toml")).map_err(anyhow::Error::msg)?;
    let sources = SOURCES.map(|name| root.join(format!("src/capi/{name}.rs")));
    let builder = Builder::new().with_config(config);
    let builder = sources.iter().fold(builder, Builder::with_src);
    let mut text = Vec::new();
    builder
        .generate()
        .context("a header of src/capi")?
        .write(&mut text);
    // Rust's documentation has a heading for what callers promise; C's has not.
    let made = String::from_utf8(text)?.replace("// # Safety\n", "");
    let path = root.join("include/footwork.h");
    if !check {
        return std::fs::write(&path, made).context("include/footwork.h");
    }
    match std::fs::read_to_string(&path).is_ok_and(|committed| committed == made) {
        true => Ok(()),
        false => bail!(
            "include/footwork.h is stale: `cargo run --manifest-path tests/capi/header/Cargo.toml` makes it anew"
        ),
    }
}
