//! The header is that of the sources.

use cbindgen::{Builder, Config};
use std::path::Path;

/// Files of `src/capi` that declare something, in the order of the header.
const SOURCES: [&str; 4] = ["database", "policy", "characters", "status"];

#[test]
fn the_header_is_that_of_the_sources() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = Config::from_file(root.join("cbindgen.toml")).expect("cbindgen.toml");
    let sources = SOURCES.map(|name| root.join(format!("src/capi/{name}.rs")));
    let builder = Builder::new().with_config(config);
    let builder = sources.iter().fold(builder, Builder::with_src);
    let mut text = Vec::new();
    builder.generate().expect("a header").write(&mut text);
    // Rust's documentation has a heading for what callers promise; C's has not.
    let made = String::from_utf8(text)
        .unwrap()
        .replace("// # Safety\n", "");
    let path = root.join("include/footwork.h");
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    if std::env::var_os("FOOTWORK_KEEP").is_some() {
        std::fs::write(&path, &made).unwrap();
    } else if made != committed {
        panic!("{} is stale: FOOTWORK_KEEP=1 makes it anew", path.display());
    }
}
