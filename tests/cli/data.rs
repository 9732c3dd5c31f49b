//! `footwork data`: motion in, databases out, and motion that is refused.

use super::Place;
use super::mocap::recordings;

/// A place with the recording `walk/synthetic_000.bvh` and its text.
fn with_recording() -> (Place, String) {
    let place = Place::new();
    place.done("data synth --minutes 0.5 --out synth.footwork --bvh walk");
    let text = place.read("walk/synthetic_000.bvh");
    (place, text)
}

/// The recording cut to some of its frames; its `Frames:` line says `claimed`.
fn cut(text: &str, frames: usize, claimed: usize) -> String {
    let (hierarchy, motion) = text.split_once("Frames:").unwrap();
    let mut lines = motion.lines().skip(1);
    let time = lines.next().unwrap();
    let rows: Vec<&str> = lines.take(frames).collect();
    format!(
        "{hierarchy}Frames: {claimed}\n{time}\n{}\n",
        rows.join("\n")
    )
}

fn fingerprint(told: &str) -> &str {
    told.rsplit_once("fingerprint ").unwrap().1[..8].trim()
}

#[test]
fn synthetic_motion_can_be_looked_at() {
    let place = Place::new();
    let made = place.done("data synth --minutes 3 --out small.footwork");
    assert!(made.out.contains("3.0 minutes"), "{made:?}");
    let info = place.done("data info small.footwork --plot coverage.png");
    for part in [
        "synthetic_000",
        "CC0-1.0",
        "3.0 minutes",
        "turning < 20 deg/s",
    ] {
        assert!(info.out.contains(part), "no {part} in {info:?}");
    }
    assert!(info.out.contains(fingerprint(&made.out)));
    assert!(place.path("coverage.png").metadata().unwrap().len() > 1000);
    assert!(info.err.is_empty(), "{info:?}");
    let embedded = place.done("data info");
    assert!(embedded.err.contains("synthetic motion"), "{embedded:?}");
}

/// Boxing lies beside the database, which it leaves as it is.
#[test]
fn boxing_is_written_beside_the_database() {
    let place = Place::new();
    let alone = place.done("data synth --minutes 0.5 --out alone.footwork");
    let made = place
        .done("data synth --minutes 0.5 --out with.footwork --boxing box --boxing-minutes 0.5");
    assert_eq!(fingerprint(&made.out), fingerprint(&alone.out));
    let info = place.done("data info box");
    for part in ["boxing_000", "0.5 minutes"] {
        assert!(info.out.contains(part), "no {part} in {info:?}");
    }
}

/// The index beside a database saves time and changes nothing.
#[test]
fn a_database_trains_alike_whatever_became_of_its_index() {
    let place = Place::new();
    place.done("data synth --minutes 1 --out a.footwork");
    let index = place.path("a.footwork.index");
    let train = |run: &str| {
        let out = format!("--steps 8192 --device cpu --data a.footwork --out {run}");
        place.done(&format!("train plane {out}"));
        place.json(&format!("{run}/summary.json"))["success"].clone()
    };
    let with = train("with");
    std::fs::write(&index, "no index").unwrap();
    assert_eq!(train("damaged"), with);
    std::fs::remove_file(&index).unwrap();
    assert_eq!(train("without"), with);
    place.done("data synth --minutes 2 --out b.footwork");
    std::fs::rename(place.path("b.footwork.index"), &index).unwrap();
    assert_eq!(train("of-another"), with);
}

#[test]
fn the_seed_decides_what_is_performed() {
    let place = Place::new();
    let make = |seed| {
        let told = place.done(&format!(
            "data synth --minutes 1 --seed {seed} --out a.footwork"
        ));
        fingerprint(&told.out).to_string()
    };
    assert_eq!(make(7), make(7));
    assert_ne!(make(7), make(8));
}

#[test]
fn recordings_become_a_database() {
    let (place, text) = with_recording();
    let plain = place.done("data import walk --out plain.footwork");
    assert!(
        plain.out.contains("1 clips, 0.5 minutes, 870 candidates"),
        "{plain:?}"
    );
    let mirrored = place.done("data import walk --out mirrored.footwork --mirror");
    assert!(
        mirrored
            .out
            .contains("2 clips, 1.0 minutes, 1740 candidates"),
        "{mirrored:?}"
    );
    let info = place.done("data info mirrored.footwork");
    assert!(info.out.contains("synthetic_000 mirrored"), "{info:?}");
    let centimetres = place.done("data import walk --out cm.footwork --unit 0.01");
    assert_eq!(fingerprint(&plain.out), fingerprint(&centimetres.out));
    let smaller = place.done("data import walk --out small.footwork --unit 0.005");
    assert_ne!(fingerprint(&plain.out), fingerprint(&smaller.out));

    place.write("walk/synthetic_000.bvh", text.replace("LeftFoot", "Klump"));
    place.write("roles.toml", "left_foot = \"Klump\"");
    let roles = place.done("data import walk --out roles.footwork --roles roles.toml");
    assert_eq!(fingerprint(&plain.out), fingerprint(&roles.out));
}

#[test]
fn recordings_that_are_none_are_refused() {
    let (place, text) = with_recording();
    let words: Vec<&str> = text.split_inclusive(' ').collect();
    let with_nan = [
        &words[..words.len() - 900].concat(),
        "nan ",
        &words[words.len() - 899..].concat(),
    ]
    .concat();
    // A foot that neither its name nor its place at the end of a leg tells.
    let (before, foot) = text.split_once("LeftFoot").unwrap();
    let offset = foot.lines().find(|line| line.contains("OFFSET")).unwrap();
    let foot = foot.replacen(offset, "OFFSET 0 -1 0", 1);
    let none = format!("{before}Klump{foot}").replace("LeftToe", "Zeh");
    for (name, contents, parts) in [
        (
            "binary",
            "\u{0}\u{1}\u{2}",
            &["binary.bvh, line 1", "begins with HIERARCHY"][..],
        ),
        ("empty", "", &["empty.bvh, line 1", "the file is empty"]),
        (
            "hierarchy",
            &text[..2000],
            &["hierarchy.bvh, line", "truncated"],
        ),
        (
            "truncated",
            &text[..text.len() / 2],
            &["truncated.bvh, line", "the file is truncated"],
        ),
        ("nan", &with_nan, &["nan.bvh, line", "no usable number"]),
        (
            "frameless",
            &cut(&text, 0, 0),
            &["frameless.bvh, line", "zero frames"],
        ),
        (
            "claims",
            &cut(&text, 50, 4_000_000_000),
            &["claims.bvh, line", "Frames line is wrong"],
        ),
        (
            "roles",
            &none,
            &[
                "no joint found for left_foot, left_toe;",
                "--roles FILE",
                "Zeh",
                "left_hip = \"LeftUpLeg\"",
            ],
        ),
        (
            "short",
            &cut(&text, 40, 40),
            &["no usable clip in", "61 frames"],
        ),
    ] {
        let file = format!("{name}.bvh");
        place.write(&file, contents);
        place.refused(&format!("data info {file}"), 1, parts);
        place.refused(&format!("data import {file} --out a.footwork"), 1, parts);
        place.refused(
            &format!("train plane --device cpu --data {file} --out run"),
            1,
            parts,
        );
    }
    place.write("bytes.bvh", b"HIERARCHY\n\xff\xfe");
    place.refused("data info bytes.bvh", 1, &["not UTF-8", "line 2"]);
    let giant = std::fs::File::create(place.path("giant.bvh")).unwrap();
    giant.set_len(2 << 30).unwrap();
    place.refused("data info giant.bvh", 1, &["giant.bvh holds more than"]);
}

#[test]
fn mistakes_of_an_import_are_explained() {
    let (place, text) = with_recording();
    let legs = "the legs would be";
    place.refused(
        "data import walk --out a --unit 1",
        1,
        &[legs, "--unit METRES"],
    );
    place.refused(
        "train imitate --device cpu --data walk --unit 5 --out run",
        1,
        &[legs],
    );
    place.refused("sim --clip walk --out strips --unit 5", 1, &[legs]);
    place.refused(
        "train plane --device cpu --data walk --unit 5 --out run",
        2,
        &["takes no motion list"],
    );
    for (roles, part) in [
        ("left_fot = \"LeftFoot\"", "did you mean 'left_foot'?"),
        ("left_foot = \"LeftFoo\"", "did you mean 'LeftFoot'?"),
        ("left_foot = 3", "must be a joint's name in quotes"),
        ("left_foot =", "TOML parse error at line 1"),
    ] {
        place.write("roles.toml", roles);
        place.refused("data import walk --out a --roles roles.toml", 2, &[part]);
    }
    place.refused(
        "data import walk --out a --roles gone.toml",
        2,
        &["cannot be read"],
    );
    place.write("walk/other.bvh", text.replace("Head", "Kopf"));
    let skeletons = &[
        "two different skeletons",
        "'Head'",
        "'Kopf'",
        "folders of their own",
    ];
    place.refused("data import walk --out a", 1, skeletons);
}

/// What an import finds is kept in the database, for people and programs to read.
#[test]
fn findings_are_kept_and_told() {
    let (place, text) = with_recording();
    let (hierarchy, motion) = text.split_once("Frames: ").unwrap();
    let mut lines = motion.lines();
    let frames: usize = lines.next().unwrap().parse().unwrap();
    let time = lines.next().unwrap();
    let rows: Vec<&str> = lines.collect();
    let rest = "0 ".repeat(rows[0].split_whitespace().count());
    let rest = format!("{rest}\n{}", rows.join("\n"));
    let text = format!("{hierarchy}Frames: {}\n{time}\n{rest}\n", frames + 1);
    place.write("walk/synthetic_000.bvh", text);

    let made = place.done("data import walk --out a.footwork");
    let note = "frames dropped";
    assert!(made.err.contains(note), "{made:?}");
    let info = place.done("data info a.footwork");
    assert!(info.out.contains(note), "{info:?}");
    for part in ["a.footwork", "walk"] {
        let json = place.done(&format!("data info {part} --json"));
        let figures: serde_json::Value = serde_json::from_str(&json.out).unwrap();
        assert_eq!(figures["fingerprint"], fingerprint(&made.out));
        assert_eq!(figures["roles"]["left_foot"], "LeftFoot");
        assert!((figures["minutes"].as_f64().unwrap() - 0.5).abs() < 0.01);
        let clip = &figures["clips"][0];
        assert_eq!(clip["name"], "synthetic_000");
        assert_eq!(clip["candidates"], 870);
        assert_eq!(
            (clip["up"].as_str(), clip["seconds"].as_f64()),
            (Some("y"), Some(30.0))
        );
        assert!((clip["unit_m"].as_f64().unwrap() - 0.01).abs() < 1e-6);
        let [mean, max] = ["mean_speed", "max_speed"].map(|key| clip[key].as_f64().unwrap());
        assert!(0.0 < mean && mean < max && max < 8.0, "{mean} {max}");
        assert!(clip["notes"][0].as_str().unwrap().contains(note), "{clip}");
    }
    let roles = place.done("data info walk --roles");
    assert!(roles.out.starts_with("hips = \"Hips\"\n"), "{roles:?}");
    place.write("roles.toml", roles.out);
    place.done("data info walk --roles=roles.toml");
    place.done("data import walk --roles roles.toml --out b.footwork");
}

#[test]
fn options_of_an_import_settle_what_is_unclear() {
    let (place, text) = with_recording();
    std::fs::create_dir(place.path("walk/more")).unwrap();
    place.write("walk/more/again.bvh", &text);
    place.write("walk/empty.bvh", "");
    place.refused(
        "data info walk",
        1,
        &["1 of 2 files", "empty.bvh, line 1", "--skip-bad"],
    );
    let info = place.done("data info walk --skip-bad --recursive");
    assert!(info.out.contains("more/again"), "{info:?}");
    assert!(info.err.contains("1 of 3 files left out"), "{info:?}");
    let flat = place.done("data import walk --skip-bad --out a.footwork");
    assert!(flat.err.contains("`--recursive` reads them"), "{flat:?}");
    place.refused(
        "data info walk --skip-bad --up w",
        2,
        &["the axes are x, y, z"],
    );
    let turned = place.done("data info walk --skip-bad --up -y --json");
    let figures: serde_json::Value = serde_json::from_str(&turned.out).unwrap();
    assert_eq!(figures["clips"][0]["up"], "-y");

    // Two takes, joined.
    let (head, motion) = text.split_once("Frame Time: ").unwrap();
    let mut rows: Vec<String> = motion.lines().map(str::to_string).collect();
    for row in &mut rows[501..] {
        let (x, others) = row.split_once(' ').unwrap();
        *row = format!("{} {others}", x.parse::<f32>().unwrap() + 300.0);
    }
    let joined = format!("{head}Frame Time: {}\n", rows.join("\n"));
    place.write("joined.bvh", joined);
    let parts = &[
        "joined.bvh",
        "the motion jumps",
        "after frame 500;",
        "--trim",
    ];
    place.refused("data info joined.bvh", 1, parts);
    let trimmed = place.done("data info joined.bvh --trim");
    assert!(
        trimmed.err.contains("trimmed to the longest piece"),
        "{trimmed:?}"
    );
}

#[test]
fn real_recordings_are_imported() {
    let Some(folder) = recordings("lafan1") else {
        return;
    };
    let place = Place::new();
    let words = format!("data import {} --out real.footwork", folder.display());
    let made = place.done(&words);
    assert!(made.err.contains("note: left out"), "{made:?}");
    let info = place.done("data info real.footwork");
    assert!(info.out.contains(fingerprint(&made.out)), "{info:?}");
}
