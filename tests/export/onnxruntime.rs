//! ONNX Runtime against our own pass.

use super::cases::CASES;
use super::python;
use std::path::PathBuf;

/// The files are left in the folder that `FOOTWORK_EXPORT_CASES` names, if it does: tract is shown them, too.
#[test]
fn every_kind_of_policy_comes_to_what_our_own_pass_does() {
    let own = tempfile::tempdir().unwrap();
    let named = std::env::var_os("FOOTWORK_EXPORT_CASES").map(PathBuf::from);
    let folder = named.as_deref().unwrap_or(own.path());
    for (run, recorded) in CASES.iter() {
        run.write(recorded, "onnx", folder);
    }
    let told = python::run("tests/export/check.py", &[folder.as_os_str()]);
    assert_eq!(told.lines().count(), CASES.len(), "{told}");
}
