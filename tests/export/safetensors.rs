//! Parameters without a graph: NumPy evaluates them by what is said of them.

use super::{cases, python};

#[test]
fn parameters_are_enough_to_evaluate_a_policy() {
    let folder = cases::folder();
    let all = cases::all(folder.path());
    let acting = all.iter().filter(|run| run.task.low_level().is_none());
    let mut count = 0;
    for run in acting {
        count += 1;
        let file = |ending: &str| folder.path().join(format!("{}.{ending}", run.name));
        std::fs::write(file("safetensors"), run.exported("safetensors")).unwrap();
        let recorded = run.recorded();
        let action = [("action", &recorded.outputs["action"])];
        for (name, values) in recorded
            .inputs
            .iter()
            .map(|(name, values)| (*name, values))
            .chain(action)
        {
            let bytes: &[u8] = bytemuck::cast_slice(values);
            std::fs::write(file(&format!("{name}.f32")), bytes).unwrap();
        }
    }
    let told = python::run("tests/export/evaluate.py", &[folder.path().as_os_str()]);
    assert_eq!(told.lines().count(), count, "{told}");
}
