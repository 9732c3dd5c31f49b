//! `footwork render`.

use super::{Place, TRAIN};

/// Width, height and RGB of a PNG file.
pub fn png(place: &Place, name: &str) -> (u32, u32, Vec<u8>) {
    let file = std::fs::File::open(place.path(name)).unwrap();
    let decoder = png::Decoder::new(std::io::BufReader::new(file));
    let mut reader = decoder.read_info().unwrap();
    let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut rgb).unwrap();
    (info.width, info.height, rgb)
}

#[test]
fn draws_pictures_animations_and_frames() {
    let place = Place::with_run();
    place.done("render run -o one.png --size 96x64");
    let (width, height, first) = png(&place, "one.png");
    assert_eq!((width, height), (96, 64));
    // The same episode at the same moment is the same picture; at another it is not.
    place.done("render run -o again.png --size 96x64");
    assert!(png(&place, "again.png").2 == first);
    place.done("render run/checkpoints/last.ckpt -o later.png --start 3 --size 96x64");
    assert!(png(&place, "later.png").2 != first);

    place.done("render run -o frames --seconds 0.5 --rate 10 --size 96x64");
    let frames = place
        .list()
        .into_iter()
        .filter(|path| path.parent() == Some(&place.path("frames")));
    assert_eq!(frames.count(), 5);
    assert!(png(&place, "frames/frame-00000.png").2 == first);
    // A shorter film leaves nothing of a longer one.
    place.done("render run -o frames --force --seconds 0.2 --rate 10 --size 96x64");
    assert!(place.path("frames/frame-00001.png").exists());
    assert!(!place.path("frames/frame-00002.png").exists());

    place.done("render run -o walk.gif --seconds 1 --rate 15 --size 96x64 --blend linear");
    assert_eq!(animation(&place, "walk.gif"), ([96, 64], 15, 100));
}

/// Size of a GIF file, its frames, and hundredths of a second.
fn animation(place: &Place, name: &str) -> ([u16; 2], usize, u32) {
    let file = std::fs::File::open(place.path(name)).unwrap();
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::Indexed);
    let mut decoder = options.read_info(file).unwrap();
    let size = [decoder.width(), decoder.height()];
    let (mut count, mut delays) = (0, 0);
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        assert_eq!([frame.width, frame.height], size);
        delays += u32::from(frame.delay);
        count += 1;
    }
    (size, count, delays)
}

/// Policies are filmed as they learn, of motion matching and of bodies; nothing comes of it but the films.
#[test]
fn trainings_are_filmed() {
    let place = Place::with_data();
    let films = "--set film_share=1000 --set checkpoint_every=4096";
    place.done(&format!("{TRAIN} --steps 8192 --out run {films}"));
    place.done(&format!(
        "{TRAIN} --steps 8192 --out unseen --set film_share=0"
    ));
    for steps in ["0000004096", "0000008192"] {
        let film = format!("run/pictures/film/steps-{steps}.gif");
        assert_eq!(animation(&place, &film), ([320, 180], 50, 500));
        png(&place, &format!("run/pictures/walks/steps-{steps}.png"));
    }
    assert!(!place.path("unseen/pictures/film").exists());
    let policy = |run: &str| {
        let path = place.path(run).join("checkpoints/last.ckpt");
        footwork::train::checkpoint::Checkpoint::load(&path)
            .unwrap()
            .policy
            .parameters
    };
    assert!(policy("run") == policy("unseen"));

    let body = "train box --device cpu --envs 16 --set ppo.rollout_length=8 --set ppo.minibatch_size=64 \
                --set amp.minibatch_size=32 --set amp.replay_capacity=256 --set amp.replay_per_update=64 \
                --set amp.steps=2 --steps 512 --set film_share=1000 --set checkpoint_every=512";
    place.done(&format!("{body} --out bout"));
    let (size, frames, _) = animation(&place, "bout/pictures/film/steps-0000000512.gif");
    assert_eq!((size, frames), ([320, 180], 50));
}

#[test]
fn what_is_there_stays_unless_forced() {
    let place = Place::with_run();
    place.write("one.png", "mine");
    place.refused("render run -o one.png", 1, &["one.png", "--force"]);
    assert_eq!(place.read("one.png"), "mine");
    place.done("render run -o one.png --force --size 64x48");
    assert_eq!(png(&place, "one.png").0, 64);
    place.refused(
        "render run -o run/checkpoints --seconds 1",
        1,
        &["run/checkpoints", "--force"],
    );
    place.refused("render run -o small.footwork --force", 2, &[".png"]);
    place.refused("render run -o none/one.png", 1, &["none"]);
    place.write("plain", "mine");
    place.refused("render run -o plain --force", 1, &["plain"]);
}

#[test]
fn wrong_wishes_are_refused() {
    let place = Place::with_run();
    for (wish, part) in [
        ("--start -1", "--start"),
        ("--start NaN", "--start"),
        ("--seconds 0", "--seconds"),
        ("--rate 7", "--rate"),
        ("--rate 0", "--rate"),
        ("--size 640", "640x360"),
        ("--size 1x1", "640x360"),
        ("--yaw inf", "--yaw"),
        ("--pitch 90", "--pitch"),
        ("--distance 0", "--distance"),
        ("--episode 1000", "--episode"),
    ] {
        place.refused(&format!("render run -o one.gif {wish}"), 2, &[part]);
    }
}

#[test]
fn a_run_that_cannot_be_shown_says_why() {
    let place = Place::with_run();
    let one = "play run/checkpoints/last.ckpt --follow";
    place.refused(one, 2, &["--follow takes a run's folder"]);
    for program in ["render RUN -o one.png", "play RUN"] {
        let words = |run: &str| program.replace("RUN", run);
        place.refused(&words("nothing"), 1, &["nothing"]);
        std::fs::create_dir_all(place.path("empty")).unwrap();
        place.refused(&words("empty"), 1, &["config.toml"]);
    }
    let (here, there) = (place.path("small.footwork"), place.path("moved.footwork"));
    std::fs::rename(&here, &there).unwrap();
    for program in ["render run -o one.png", "play run", "eval run"] {
        place.refused(program, 1, &["small.footwork", "--data"]);
    }
    place.done("render run -o one.png --data moved.footwork --size 64x48");
    place.done("data synth --minutes 2 --out other.footwork");
    place.refused(
        "render run -o two.png --data other.footwork",
        1,
        &["other data"],
    );
    std::fs::remove_file(place.path("run/checkpoints/last.ckpt")).unwrap();
    for program in [
        "render run -o two.png --data moved.footwork",
        "play run --data moved.footwork",
    ] {
        place.refused(program, 1, &["last.ckpt"]);
    }
}

#[test]
fn a_checkpoint_of_an_older_format_is_not_taken_for_a_damaged_one() {
    let place = Place::with_run();
    let path = place.path("run/checkpoints/last.ckpt");
    let mut bytes = std::fs::read(&path).unwrap();
    bytes[16..20].copy_from_slice(&1u32.to_le_bytes());
    std::fs::write(&path, bytes).unwrap();
    for program in ["render run -o one.png", "play run", "eval run"] {
        place.refused(program, 1, &["(format 1)", "use the one that wrote it"]);
    }
}
