//! ONNX Runtime against our own pass.

use super::{cases, python};

#[test]
fn every_kind_of_policy_comes_to_what_our_own_pass_does() {
    let folder = cases::folder();
    let runs = cases::all(folder.path());
    for run in &runs {
        let file = |ending: &str| folder.path().join(format!("{}.{ending}", run.name));
        std::fs::write(file("onnx"), run.exported("onnx")).unwrap();
        let recorded = run.recorded();
        for (name, values) in recorded.inputs.iter().chain(&recorded.outputs) {
            let bytes: &[u8] = bytemuck::cast_slice(values);
            std::fs::write(file(&format!("{name}.f32")), bytes).unwrap();
        }
    }
    let told = python::run("tests/export/check.py", &[folder.path().as_os_str()]);
    assert_eq!(told.lines().count(), runs.len(), "{told}");
}
