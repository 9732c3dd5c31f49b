//! Scripts in Python, with NumPy and ONNX Runtime.

use std::ffi::OsStr;
use std::path::Path;
use std::process::Command;

/// Runs a script of the repository. Returns what it printed.
pub fn run(script: &str, arguments: &[&OsStr]) -> String {
    let program = std::env::var_os("PYTHON").unwrap_or("python3".into());
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join(script);
    let output = Command::new(&program)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .arg(&script)
        .args(arguments)
        .output();
    let output = output.unwrap_or_else(|error| panic!("{program:?}: {error}; {NEEDED}"));
    let [out, errors] =
        [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    assert!(
        !errors.contains("ModuleNotFoundError"),
        "{program:?}: {errors}{NEEDED}"
    );
    assert!(
        output.status.success(),
        "{}:\n{out}{errors}",
        script.display()
    );
    out
}

const NEEDED: &str = "these tests need Python with NumPy and ONNX Runtime: let tests/run see to it, or name an \
                      interpreter by PYTHON that has tests/reference/requirements.txt";
