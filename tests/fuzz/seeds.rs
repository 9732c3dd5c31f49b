//! Good inputs to begin from, and inputs that were found to fail once.

use footwork::gpu::{Choice, Device};
use footwork::matching::Index;
use footwork::motion::database::Database;
use footwork::motion::normalise::Weights;
use footwork::motion::synthetic;
use footwork::ranks::Ranks;
use footwork::train::checkpoint::{Checkpoint, Header};
use footwork::train::config::Preset;
use footwork::train::state::TrainerState;
use footwork::train::tasks::find;
use std::path::Path;

/// What a reader's inputs are made of.
pub struct Seeds {
    good: Vec<Vec<u8>>,
    /// Words of its language.
    pub words: &'static [&'static str],
    /// Whether files have a checksum, which is put right in half of the inputs: else nothing behind it is reached.
    pub sealed: bool,
}

impl Seeds {
    fn texts(good: &[&str], words: &'static [&'static str]) -> Seeds {
        Seeds {
            good: good.iter().map(|text| text.as_bytes().to_vec()).collect(),
            words,
            sealed: false,
        }
    }

    fn files(good: Vec<Vec<u8>>) -> Seeds {
        Seeds {
            good,
            words: &["frames", "null", "[", "]", "{", "}", "\"", ",", ":", "true"],
            sealed: true,
        }
    }

    /// These, and those found earlier.
    pub fn all(&self, reader: &str) -> Vec<Vec<u8>> {
        let mut all = self.good.clone();
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("tests/fuzz/corpus")
            .join(reader);
        let found = std::fs::read_dir(folder).into_iter().flatten();
        let mut found: Vec<_> = found.filter_map(|entry| Some(entry.ok()?.path())).collect();
        found.sort();
        all.extend(
            found
                .iter()
                .map(|path| std::fs::read(path).expect("an input")),
        );
        all
    }
}

/// Puts the checksum of a file right, as far as it has one.
pub fn seal(bytes: &mut [u8]) {
    if bytes.len() > 24 {
        let sum = crc32fast::hash(&bytes[24..]);
        bytes[20..24].copy_from_slice(&sum.to_le_bytes());
    }
}

pub fn bvh() -> Seeds {
    const LEG: &str = "JOINT L{ OFFSET 0 -9 0 CHANNELS 3 Zrotation Xrotation Yrotation End Site { OFFSET 0 -9 0 } }";
    static WORDS: [&str; 14] = [
        "HIERARCHY",
        "ROOT",
        "JOINT",
        "End Site",
        "OFFSET",
        "CHANNELS",
        "MOTION",
        "Frames:",
        "Frame Time:",
        "{",
        "}",
        "Xposition",
        "Zrotation",
        "\r",
    ];
    let small = format!(
        "HIERARCHY\nROOT Hips\n{{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation \
         Yrotation\n{LEG}\n}}\nMOTION\nFrames: 3\nFrame Time: 0.0333\n{}",
        "0 90 0 0 0 0 1 2 3\n".repeat(3)
    );
    let (clips, _) = synthetic::perform(1, 0.02);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("walk.bvh");
    footwork::motion::bvh::write(&path, &clips[0]).expect("a file");
    let walk = std::fs::read(&path).expect("a file");
    Seeds {
        good: vec![small.into_bytes(), walk],
        words: &WORDS,
        sealed: false,
    }
}

pub fn mjcf() -> Seeds {
    let body = include_str!("../../src/physics/humanoid.xml");
    let small = "<mujoco model='a'><default><geom density='900'/></default><worldbody><geom type='plane' size='1 1 \
                 1'/><body pos='0 0 1'><freejoint/><geom type='capsule' fromto='0 0 0 0 0 1' size='.1'/><body pos='0 \
                 0 1'><joint type='hinge' axis='0 1 0' range='-1 1'/><geom type='box' size='.1 .1 .1'/></body></body>\
                 </worldbody><actuator><position joint='a' kp='9'/></actuator></mujoco>";
    Seeds::texts(
        &[small, body],
        &[
            "<body>",
            "</body>",
            "<joint/>",
            "range='1 -1'",
            "size='0'",
            "mass='1e30'",
            "type='mesh'",
            "<!--",
            "&",
        ],
    )
}

/// A few seconds of motion.
pub fn small_database() -> Database {
    let (clips, roles) = synthetic::perform(1, 0.05);
    Database::build(&clips[..1], roles, Weights::PAPER).expect("long enough")
}

pub fn database() -> Seeds {
    let database = small_database();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a");
    database.save(&path).expect("a file");
    Seeds::files(vec![std::fs::read(&path).expect("a file")])
}

pub fn checkpoint() -> Seeds {
    let device = Device::open(Choice::Cpu).expect("a device");
    let entry = find("stand").expect("a task");
    let mut config = entry.config(Preset::Fast);
    (config.ppo.envs, config.ppo.rollout_length) = (2, 2);
    config.ppo.network.hidden = vec![4];
    let task = (entry.load)(&config).expect("a task").task;
    let envs = task
        .open(&device, &Ranks::alone(), 2, 1)
        .expect("environments");
    let learner = task.learner(&config, &envs, &device).expect("a learner");
    let header = Header {
        version: String::new(),
        task: entry.name.to_string(),
        spec: envs.spec(),
        fingerprint: 0.into(),
        config: config.to_toml(),
        steps: 4,
    };
    let checkpoint = Checkpoint::take(header, &*learner, &envs, &TrainerState::default());
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a");
    checkpoint
        .expect("a checkpoint")
        .save(&path)
        .expect("a file");
    Seeds::files(vec![std::fs::read(&path).expect("a file")])
}

/// Of the index of a database.
pub fn index(database: &Database) -> Seeds {
    let index = Index::build(&database.features, &database.candidates, 1 << 20);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a");
    index.save(&path, 1).expect("a file");
    Seeds::files(vec![std::fs::read(&path).expect("a file")])
}

pub fn configuration() -> Seeds {
    Seeds::texts(
        &[
            "steps = 1000\nseed = 3\n[task]\nname = \"plane\"\ntarget_extent = 4.0\n[ppo]\ngamma = 0.9\nenvs = 64\n\
             [ppo.network]\nhidden = [16, 16]\nactivation = \"relu\"\n",
            "[amp]\nheads = 3\nhidden = [8]\nloss = \"hinge\"\n[task]\nname = \"punch\"\nfar = \"slow\"\nepisode_s = 3\n",
        ],
        &[
            "[",
            "]",
            "[ppo]",
            "[task]",
            "= ",
            "\"\"",
            "'''",
            "nan",
            "-inf",
            "1e400",
            "preset = \"paper\"\n",
        ],
    )
}

pub fn motion_list() -> Seeds {
    Seeds::texts(
        &[
            "[[clip]]\nfile = \"a.bvh\"\nstart = 1.0\nend = 2.0\nweight = 3.4\nmirror = true\nkind = \"boxing\"\n",
        ],
        &[
            "[[clip]]\n",
            "file = \"..\"\n",
            "weight = -1\n",
            "end = nan\n",
            "ground = true\n",
            "file = \"/dev/zero\"\n",
        ],
    )
}

pub fn deepmimic() -> Seeds {
    let frame = format!("[0.033{}]", ", 0.5, 0.1, 0.1, 0.9".repeat(11));
    let text = format!("{{\"Loop\": \"wrap\", \"Frames\": [{frame}, {frame}, {frame}]}}");
    Seeds::texts(&[&text], &["[", "]", "null", "\"Frames\"", ":", ","])
}

pub fn roles() -> Seeds {
    Seeds::texts(
        &[
            "hips = \"Hips\"\nspine = \"Spine\"\nleft_foot = \"LeftFoot\"\nright_foot = \"RightFoot\"\n",
        ],
        &["head = ", "\"\"", "= 3\n", "[hips]\n"],
    )
}

pub fn metrics() -> Seeds {
    Seeds::texts(
        &[
            "{\"update\":1,\"steps\":1024,\"wall_s\":0.5,\"episodes\":3.0,\"success\":0.5,\"episode_return\":1.5,\
           \"episode_length\":9.0,\"steps_per_s\":1.0,\"policy_s\":0.1,\"env_s\":0.1,\"learn_s\":0.1,\"kl\":0.01}\n",
        ],
        &["null", "{", "}", "\n", "\"kl\"", "1e999"],
    )
}
