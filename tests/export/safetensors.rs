//! Parameters without a graph: NumPy evaluates them by what is said of them.

use super::cases::CASES;
use super::python;

#[test]
fn parameters_are_enough_to_evaluate_a_policy() {
    let folder = tempfile::tempdir().unwrap();
    let acting = CASES
        .iter()
        .filter(|(run, _)| run.task.low_level().is_none());
    for (run, recorded) in acting.clone() {
        run.write(recorded, "safetensors", folder.path());
    }
    let told = python::run("tests/export/evaluate.py", &[folder.path().as_os_str()]);
    assert_eq!(told.lines().count(), acting.count(), "{told}");
}
