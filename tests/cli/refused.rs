//! Options and configurations that cannot be meant: exit code 2, and nothing is made.

use super::{Place, TRAIN};
use footwork::container::{self, Arrays, Format};

#[test]
fn mistaken_options_name_what_was_meant() {
    let place = Place::with_data();
    for (words, part) in [
        ("dta", "similar subcommand exists: 'data'"),
        ("train plan", "similar value exists: 'plane'"),
        ("train", "required arguments"),
        ("ablate obstacle", "similar value exists: 'obstacles'"),
        ("train plane --evns 4", "similar argument exists: '--envs'"),
        ("train plane --device gpux", "similar value exists: 'gpu'"),
        ("train plane --preset quick", "possible values: fast, paper"),
        ("train plane --envs 0", "ppo.envs is 0"),
        ("train plane --envs -5", "invalid value '-5' for '--envs"),
        ("train plane --envs nan", "invalid value 'nan'"),
        ("train plane --envs 2000000", "between 1 and 1048576"),
        ("train plane --envs 99999999999999999999", "too large"),
        ("train plane --steps 0", "steps is 0"),
        ("train plane --steps -1", "invalid value '-1'"),
        ("train plane --steps 18446744073709551615", "steps is"),
        ("train plane --seed -1", "invalid value '-1'"),
        ("train plane --seed 4294967296", "not in 0..=4294967295"),
        ("train plane --max-time 0s", "max_time_s is 0"),
        ("train plane --max-time 5", "time unit needed"),
        ("train plane --max-time -5m", "invalid value '-5m'"),
        ("train plane --stop-at-success 0", "stop_at_success is 0"),
        ("train plane --stop-at-success 2", "stop_at_success is 2"),
        (
            "train plane --stop-at-success nan",
            "stop_at_success is NaN",
        ),
        ("train plane --stop-at-success -1", "stop_at_success is -1"),
        ("train plane --set ppo.gama=1", "mean `ppo.gamma`?"),
        ("train plane --set ppo.gamma", "a key, `=` and a value"),
        (
            "train plane --set ppo.gamma=high",
            "must be of the type float",
        ),
        ("train plane --set ppo.gamma=2", "ppo.gamma is 2"),
        ("train plane --set task.count=2", "unknown key `task.count`"),
        ("train plane --set task.name=obstacles", "--set task.name"),
        ("train plane --set preset=paper", "--set preset"),
        (
            "train plane --no-curriculum",
            "unknown key `task.curriculum`",
        ),
        ("train plane --config gone.toml", "cannot read gone.toml"),
        ("train plane --config .", "cannot read .:"),
        ("train plane --config small.footwork", "cannot read small"),
        ("train plane --resume run --envs 4", "cannot be used with"),
        (
            "train plane --resume run --config a.toml",
            "cannot be used with",
        ),
        (
            "train punch --resume run --task-weight pd",
            "cannot be used with",
        ),
        ("eval", "required arguments"),
        (
            "eval run --episodes 0",
            "--episodes must be from 1 to 1000000",
        ),
        ("eval run --episodes -1", "invalid value '-1'"),
        ("data import small.footwork", "required arguments"),
        ("data import gone --out a --unit 0", "--unit must be from"),
        ("data import gone --out a --unit -1", "--unit must be from"),
        ("data import gone --out a --unit nan", "--unit must be from"),
        ("data synth --out a --minutes 0", "--minutes must be from"),
        ("data synth --out a --minutes -3", "--minutes must be from"),
        ("data synth --out a --minutes nan", "--minutes must be from"),
        ("data synth --out a --minutes 1e9", "--minutes must be from"),
        (
            "data synth --out a --weights hold",
            "similar value exists: 'holden'",
        ),
    ] {
        place.refused(words, 2, &[part]);
    }
}

#[test]
fn mistaken_configurations_name_key_line_and_nearest() {
    let place = Place::with_data();
    for (text, parts) in [
        (
            "stepz = 3",
            &["unknown key `stepz`", "line 1", "`steps`"][..],
        ),
        ("seed = 3\n[pop]\nenvs = 3", &["line 2", "`pop`", "`ppo`"]),
        (
            "ppo.learning_rte = 1",
            &["line 1", "mean `ppo.learning_rate`"],
        ),
        (
            "steps = 9\n[ppo]\nsteps = 9",
            &["line 3", "key `ppo.steps`", "mean `steps`"],
        ),
        (
            "learning_rate = 1",
            &["key `learning_rate`", "mean `ppo.learning_rate`"],
        ),
        ("ppo = 3", &["line 1", "`ppo` must be of the type table"]),
        (
            "[task]\nsuccess_radius = \"far\"",
            &["line 2", "`task.success_radius`", "not string"],
        ),
        ("steps = \"many\"", &["`steps` must be of the type integer"]),
        ("steps = 1.5", &["`steps` must be of the type integer"]),
        ("steps = -1", &["`steps` must not be negative"]),
        ("seed = 99999999999", &["`seed`"]),
        ("preset = \"quick\"", &["`quick`", "`fast` or `paper`"]),
        ("preset = 3", &["`preset` must be of the type string"]),
        ("device = \"tpu\"", &["`tpu`", "`lavapipe`"]),
        ("data = 3", &["`data` must be of the type string"]),
        ("steps = 5\nsteps = 6", &["line 2", "duplicate key"]),
        ("this is no toml", &["line 1", "expected `=`"]),
        ("max_time_s = -1", &["max_time_s is -1", "between"]),
        ("stop_at_success = 3", &["stop_at_success is 3", "between"]),
        (
            "task.name = \"obstacles\"",
            &["line 1", "of the task `obstacles`, not of `plane`"],
        ),
        ("[plane]\nreach = 1", &["line 1", "unknown key `plane`"]),
        ("evaluate_every = 0", &["evaluate_every is 0"]),
        ("checkpoint_every = 0", &["checkpoint_every is 0"]),
        (
            "task.weights.foot_position = nan",
            &["weights.foot_position is NaN"],
        ),
        (
            "task.weights.trajectory_position = 0",
            &["weights.trajectory_position is 0"],
        ),
        ("task.target_extent = inf", &["task.target_extent is inf"]),
        (
            "task.success_radius = 6",
            &["task.success_radius is 6", "less than task.target_extent"],
        ),
        ("task.success_bonus = nan", &["task.success_bonus is NaN"]),
        (
            "task.max_steps = 4294967295",
            &["task.max_steps is 4294967295"],
        ),
        (
            "ppo.rollout_length = 1000",
            &["ppo.rollout_length is 1000", "max_steps"],
        ),
        ("ppo.epochs = 0", &["ppo.epochs is 0"]),
        ("ppo.learning_rate = nan", &["ppo.learning_rate is NaN"]),
        ("ppo.learning_rate = -1", &["ppo.learning_rate is -1"]),
        (
            "ppo.final_lr_fraction = nan",
            &["ppo.final_lr_fraction is NaN"],
        ),
        ("ppo.gamma = 1.5", &["ppo.gamma is 1.5", "between 0 and 1"]),
        ("ppo.init_log_std = nan", &["ppo.init_log_std is NaN"]),
        ("ppo.max_grad_norm = -1", &["ppo.max_grad_norm is -1"]),
        (
            "ppo.network.hidden = [0]",
            &["ppo.network.hidden has a layer of width 0"],
        ),
        (
            "ppo.network.hidden = [1000000000000]",
            &["ppo.network.hidden has a layer of width 1000000000000"],
        ),
        (
            "ppo.network.hidden = [1, 1, 1, 1, 1, 1, 1, 1, 1]",
            &["ppo.network.hidden has 9 layers"],
        ),
        (
            "ppo.network.hidden = 3",
            &["`ppo.network.hidden` must be of the type array"],
        ),
        (
            "ppo.network.convolutions = [{ filters = 8, size = 3, stride = 1 }]",
            &["ppo.network.convolutions needs maps"],
        ),
        (
            "ppo.network.encoder_hidden = [8]",
            &["ppo.network.encoder_hidden needs maps"],
        ),
        (
            "ppo.network.activation = \"sigmoid\"",
            &["unknown variant `sigmoid`"],
        ),
    ] {
        place.write("run.toml", text);
        place.refused(&format!("{TRAIN} --config run.toml --out run"), 2, parts);
    }
    place.write("run.toml", "preset = \"paper\"");
    let words = format!("{TRAIN} --config run.toml --preset fast --out run");
    place.refused(&words, 2, &["differ: drop one"]);
}

#[test]
fn a_folder_that_is_no_run_is_refused() {
    let place = Place::with_data();
    std::fs::create_dir(place.path("empty")).unwrap();
    for (run, part) in [
        ("gone", "gone is not a run folder"),
        ("empty", "empty holds no run: its config.toml is missing"),
    ] {
        place.refused(&format!("eval {run}"), 1, &[part]);
        place.refused(&format!("train plane --resume {run}"), 1, &[part]);
    }
    place.refused(
        "train plane --resume small.footwork",
        1,
        &["is not in the checkpoints of a run"],
    );
    place.refused(
        "eval small.footwork",
        1,
        &["is not in the checkpoints of a run"],
    );
}

#[test]
fn runs_of_older_versions_are_refused() {
    let place = Place::with_run();
    let config = place.read("run/config.toml");
    place.write(
        "run/config.toml",
        "preset = \"fast\"\nsteps = 1000\n[plane]\nreach = 0.5\n",
    );
    let part = "run/config.toml names no task in its table [task]: it was written by footwork 0.1 from before";
    for words in [
        "eval run",
        "train plane --resume run",
        "play run",
        "render run --out a.png",
    ] {
        place.refused(words, 2, &[part]);
    }
    // A key of the version that wrote it.
    let other = config.replacen("version = \"", "version = \"9.", 1);
    place.write("run/config.toml", other.replacen("gamma", "gamna", 1));
    place.refused("eval run", 2, &["unknown key `ppo.gamna`", "(footwork 9."]);
    // No task of this version.
    place.write(
        "run/config.toml",
        config.replacen("\"plane\"", "\"plain\"", 1),
    );
    place.refused(
        "eval run",
        2,
        &["there is no task `plain`, did you mean `plane`?"],
    );
    place.write("run/config.toml", &config);

    let format = Format {
        kind: "checkpt",
        version: 3,
    };
    let path = place.path("run/checkpoints/last.ckpt");
    container::save(&path, format, &"a header", &Arrays::default()).unwrap();
    let part = "last.ckpt was written by an earlier footwork 0.1 (format 3)";
    for words in ["eval run", "train plane --resume run --steps 10240"] {
        place.refused(words, 1, &[part]);
    }
}

#[test]
fn data_that_is_not_there_is_refused() {
    let place = Place::new();
    std::fs::create_dir_all(place.path("above/inner")).unwrap();
    std::fs::create_dir(place.path("empty")).unwrap();
    place.write("above/inner/a.bvh", "");
    for (path, part) in [
        ("gone", "cannot read "),
        ("gone.bvh", "cannot read "),
        ("empty", "no .bvh file in "),
        ("above", "above/inner"),
    ] {
        place.refused(&format!("data info {path}"), 1, &[part]);
        place.refused(&format!("data import {path} --out a"), 1, &[part]);
        place.refused(
            &format!("train plane --device cpu --data {path} --out run"),
            1,
            &[part],
        );
    }
}

/// Vulkan and OpenGL find no driver.
#[test]
#[cfg(target_os = "linux")]
fn a_device_that_is_not_there_is_refused_before_anything_is_made() {
    let place = Place::with_data();
    let before = place.list();
    for (device, part) in [
        ("gpu", "no GPU found"),
        ("lavapipe", "no software Vulkan adapter"),
    ] {
        let words = format!("train plane --data small.footwork --device {device} --out run");
        let mut command = place.command(&words);
        for drivers in [
            "VK_ICD_FILENAMES",
            "VK_DRIVER_FILES",
            "__EGL_VENDOR_LIBRARY_FILENAMES",
        ] {
            command.env(drivers, "/nonexistent");
        }
        let told = super::Told::from(&words, command.output().unwrap());
        told.is_refusal(1, &[part, "--device cpu"]);
        assert_eq!(place.list(), before);
    }
}

/// What is no file might never end.
#[cfg(unix)]
#[test]
fn pipes_and_devices_are_no_files() {
    let place = Place::with_run();
    let made = std::process::Command::new("mkfifo")
        .arg(place.path("pipe.bvh"))
        .status();
    assert!(made.unwrap().success());
    for words in [
        "data info pipe.bvh",
        "data info /dev/zero",
        "train plane --config /dev/zero",
        "train imitate --data pipe.bvh --out new",
        "eval run --data /dev/zero",
        "sim --model pipe.bvh",
    ] {
        let code = if words.contains("--config") { 2 } else { 1 };
        place.refused(words, code, &["no regular file"]);
    }
}
