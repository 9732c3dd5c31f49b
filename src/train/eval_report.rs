//! The tables and the JSON of `footwork eval` for motion-matching tasks.

use super::evaluate::LocomotionReport;
use crate::playback::quality::{Quality, QualityComparison};
use crate::report::table::table;

/// A table of the levels.
pub fn levels(levels: &[LocomotionReport]) -> String {
    let headers = [
        "level",
        "success %",
        "collision %",
        "loiter %",
        "time s",
        "episode s",
    ];
    let rows: Vec<_> = levels
        .iter()
        .enumerate()
        .map(|(level, report)| {
            vec![
                level.to_string(),
                format!("{:.1}", 100.0 * report.success),
                format!("{:.1}", 100.0 * report.collision),
                format!("{:.1}", 100.0 * report.loiter),
                format!("{:.2}", report.time_to_target_mean_s),
                format!("{:.2}", report.episode_length_mean_s),
            ]
        })
        .collect();
    table(&headers, &rows)
}

/// A table of the policy and the scripted controllers at their speeds, m/s.
pub fn comparison(trained: &LocomotionReport, baseline: &[(f32, LocomotionReport)]) -> String {
    let headers = [
        "controller",
        "success %",
        "time s",
        "p95 s",
        "path ratio",
        "speed m/s",
        "turn delay s",
    ];
    let row = |name: String, report: &LocomotionReport| {
        vec![
            name,
            format!("{:.1}", 100.0 * report.success),
            format!("{:.2}", report.time_to_target_mean_s),
            format!("{:.2}", report.time_to_target_p95_s),
            format!("{:.2}", report.path_ratio),
            format!("{:.2}", report.mean_speed),
            report
                .turn_delay_mean_s
                .map_or("-".into(), |delay| format!("{delay:.2}")),
        ]
    };
    let mut rows = vec![row("policy".into(), trained)];
    rows.extend(
        baseline
            .iter()
            .map(|(speed, report)| row(format!("straight at {speed} m/s"), report)),
    );
    table(&headers, &rows)
}

/// The levels as JSON.
pub fn levels_json(levels: &[LocomotionReport]) -> serde_json::Value {
    let rows = levels.iter().enumerate().map(|(level, report)| {
        serde_json::json!({
            "level": level,
            "success": report.success,
            "collision": report.collision,
            "loiter": report.loiter,
            "time_to_target_mean_s": report.time_to_target_mean_s,
            "episode_length_mean_s": report.episode_length_mean_s,
        })
    });
    rows.collect()
}

/// The reports of scripted controllers as JSON, each with the speed it requests, m/s.
///
/// # Errors
/// A report has no JSON form.
pub fn baseline_json(
    baseline: &[(f32, LocomotionReport)],
) -> serde_json::Result<serde_json::Value> {
    let rows = baseline.iter().map(|(speed, report)| {
        let mut row = serde_json::to_value(report)?;
        row["asked_speed"] = serde_json::json!((f64::from(*speed) * 10.0).round() / 10.0);
        Ok(row)
    });
    rows.collect()
}

/// A table of the motion as recorded and with each remedy.
pub fn motion_quality(motion: &QualityComparison) -> String {
    let styles: [(&str, &Quality); 5] = [
        ("as recorded, between jumps", &motion.recorded),
        ("no stitching", &motion.raw),
        ("simple stitching", &motion.simple),
        ("stitching", &motion.stitched),
        ("stitching and foot locking", &motion.locked),
    ];
    let headers = [
        "motion",
        "standing %",
        "skate cm/s",
        "sunk cm",
        "deepest cm",
        "jump cm",
        "m/s²",
        "m/s³",
    ];
    let rows = styles.map(|(name, quality)| {
        vec![
            name.to_string(),
            format!("{:.1}", 100.0 * quality.standing),
            format!("{:.2}", quality.foot_skate_cm_s),
            format!("{:.2}", quality.penetration_mean_cm),
            format!("{:.1}", quality.penetration_max_cm),
            format!("{:.2}", quality.jump_cm),
            format!("{:.1}", quality.acceleration),
            format!("{:.0}", quality.jerk),
        ]
    });
    format!(
        "\nthe motion of {} frames with {} jumps; jump, acceleration and jerk at jumps\n{}",
        motion.frames,
        motion.jumps,
        table(&headers, &rows)
    )
}
