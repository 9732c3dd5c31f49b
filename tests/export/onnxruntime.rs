//! ONNX Runtime against our own pass.

use super::cases::CASES;
use super::python;

#[test]
fn every_kind_of_policy_comes_to_what_our_own_pass_does() {
    let folder = tempfile::tempdir().unwrap();
    for (run, recorded) in CASES.iter() {
        run.write(recorded, "onnx", folder.path());
    }
    let told = python::run("tests/export/check.py", &[folder.path().as_os_str()]);
    assert_eq!(told.lines().count(), CASES.len(), "{told}");
}
