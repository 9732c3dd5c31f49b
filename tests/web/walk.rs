//! The page of a run of motion matching.

use crate::PLANE;
use footwork::env::locomotion::EnvConfig;
use footwork::gpu::Device;
use footwork::matching::MotionMatcher;
use footwork::nn::Policy;
use footwork::rl::{Algorithm, ppo::PpoLearner};
use footwork::train::config::Preset;
use footwork::train::tasks;
use footwork::web::Page;
use footwork::web::folder::RunFiles;
use std::sync::LazyLock;

/// A policy that has learned for a second.
static FILES: LazyLock<RunFiles> = LazyLock::new(|| {
    let policy = trained().expect("a training");
    RunFiles::of_locomotion("plane", 1, &policy, &PLANE).expect("files")
});

fn trained() -> anyhow::Result<Policy> {
    let ppo = tasks::find("plane")?.config(Preset::Fast).ppo;
    let config = EnvConfig {
        task: PLANE.task,
        envs: ppo.envs,
        seed: 1,
        level: 0,
    };
    let mut envs = config.open(&Device::Cpu, &PLANE.matcher)?;
    let mut learner = PpoLearner::new(&ppo, &envs, &Device::Cpu, 1)?;
    for update in 0..40 {
        learner.iterate(&mut envs, update * ppo.batch() as u64)?;
    }
    learner.policy()
}

fn page(parts: usize) -> Page {
    let mut page = Page::open(FILES.run()).expect("a run");
    for part in &FILES.parts()[..parts] {
        page.add_part(part).expect("a part");
    }
    page.picture(1.6);
    page
}

/// Goes on by a picture at 60 Hz.
fn go_on(page: &mut Page) {
    page.advance(1.0 / 60.0).expect("a frame");
    page.search();
}

#[test]
fn a_click_sends_the_character_and_it_arrives_by_the_first_part_alone() {
    for parts in [1, FILES.parts().len()] {
        let mut page = page(parts);
        for click in 0..3 {
            for _ in 0..30 {
                go_on(&mut page);
            }
            let before = page.state();
            let at = [[0.3, -0.4], [-0.4, -0.2], [0.2, 0.0]][click];
            page.press(at);
            page.release().expect("a click");
            let clicked = page.state();
            assert_ne!(
                before.target, clicked.target,
                "the target is where the click was"
            );
            let arrived = (0..1800).any(|_| {
                go_on(&mut page);
                page.state().arrivals > clicked.arrivals
            });
            assert!(arrived, "{parts} parts, click {click}: {:?}", page.state());
        }
    }
}

#[test]
fn a_search_elsewhere_is_waited_for_and_what_it_finds_is_played() {
    let (mut here, mut there) = (page(1), page(1));
    // The candidates that the page has are those of this database.
    let mut waited = 0;
    for _ in 0..600 {
        go_on(&mut here);
        there.advance(1.0 / 60.0).expect("a frame");
        let Some(query) = there.query() else {
            continue;
        };
        let (features, candidates) = (query.features.to_vec(), query.candidates);
        let rows = there.search_rows(0);
        assert_eq!(rows.len(), candidates * features.len());
        let squared = |row: &[f32]| {
            let pairs = row.iter().zip(&features[..27]);
            pairs.map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>()
        };
        let rows = rows.chunks_exact(features.len()).enumerate();
        let nearest = rows.min_by(|a, b| squared(a.1).total_cmp(&squared(b.1)));
        let shown = there.state().frames_shown;
        if waited == 0 {
            for _ in 0..10 {
                there.advance(1.0 / 60.0).expect("no frame");
            }
            assert!(there.state().frames_shown <= shown + 1, "it waits");
            (here, there) = (page(1), page(1));
            waited += 1;
            continue;
        }
        there.set_match(nearest.expect("candidates").0 as u32);
    }
    assert_eq!(here.state().at, there.state().at);
}

#[test]
fn a_page_waits_for_its_motion_and_shows_what_it_has() {
    let mut page = Page::open(FILES.run()).expect("a run");
    page.advance(1.0).expect("nothing to do");
    assert_eq!(page.state().frames_shown, 0);
    assert_eq!(page.state().motion, [0, PLANE.matcher.database.frames()]);
    for part in FILES.parts() {
        page.add_part(part).expect("a part");
        for _ in 0..20 {
            go_on(&mut page);
        }
    }
    let picture = page.picture(1.6);
    assert!(
        picture.scene.capsules.len() > 20,
        "a character, trajectories, a target"
    );
    assert_eq!(page.state().motion, [PLANE.matcher.database.frames(); 2]);
    let more = page.add_part(&FILES.parts()[0]).expect_err("all are there");
    assert!(more.to_string().contains("parts of motion"), "{more}");
}

#[test]
fn without_an_index_the_same_is_found() {
    let indexed = &PLANE.matcher;
    let plain = MotionMatcher {
        index: None,
        ..(**indexed).clone()
    };
    let database = &indexed.database;
    let frames: Vec<u32> = database.candidates.iter().step_by(97).copied().collect();
    let queries: Vec<_> = frames
        .iter()
        .map(|&frame| {
            let mut query = database.features[frame as usize];
            query[15..27].iter_mut().for_each(|value| *value *= 1.3);
            query[27] = 1.0;
            query
        })
        .collect();
    let mut found = [vec![0; frames.len()], vec![0; frames.len()]];
    indexed.nearest_all(&frames, &queries, &mut found[0]);
    plain.nearest_all(&frames, &queries, &mut found[1]);
    assert_eq!(found[0], found[1]);
}
