//! `footwork bench`.

use super::Place;

#[test]
fn every_figure_is_written_down() {
    let place = Place::new();
    let told = place.done("bench --filter hits --device cpu --json figures.json");
    assert!(told.out.contains("hits"), "{told:?}");
    let rows = place.json("figures.json");
    let rows = rows["rows"].as_array().expect("rows");
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let of = |threads: usize| {
        let of = rows.iter().filter(|row| row["threads"] == threads);
        of.map(|row| row["envs"].as_u64().unwrap())
            .collect::<Vec<_>>()
    };
    for threads in [1, cores] {
        assert_eq!(of(threads), [256, 1024, 4096, 16_384, 65_536]);
    }
    for row in rows {
        assert_eq!(row["stage"], "hits");
        assert_eq!(row["variant"], "obstacles");
        assert_eq!(row["device"], "cpu");
        assert_eq!(row["batch"], row["envs"]);
        assert!(row["frames"].as_u64().unwrap() > 0);
        assert!(row["per_s"].as_f64().unwrap() > 0.0);
        assert!(row["roofline"].as_f64().unwrap() > 0.0);
    }
    // Nothing is drawn unless requested.
    assert_eq!(place.list(), [place.path("figures.json")]);
}

#[test]
fn every_device_is_measured_by_itself() {
    let place = Place::new();
    place.done("bench --filter arith --device lavapipe --json figures.json");
    let rows = place.json("figures.json");
    let [row] = &rows["rows"].as_array().expect("rows")[..] else {
        panic!("{rows}");
    };
    assert!(row["device"].as_str().unwrap().contains("llvmpipe"));
    assert_eq!(row["stage"], "arithmetic");
}

#[test]
fn what_cannot_be_measured_is_said_before_anything_is() {
    let place = Place::with_data();
    place.refused(
        "bench --filter serch",
        2,
        &["serch", "search, rasterize_maps"],
    );
    place.refused("bench --json gone/a.json", 2, &["gone/a.json", "folder"]);
    place.refused("bench --plot .", 2, &[". cannot be written"]);
    place.refused("bench --device gpux", 2, &["similar value exists: 'gpu'"]);
    let words = "bench --filter hits --device cpu --data";
    place.refused(&format!("{words} gone"), 1, &["gone"]);
    place.refused(
        &format!("{words} small.footwork --plot a.png"),
        1,
        &["nothing to draw"],
    );
    assert!(!place.path("a.png").exists());
}
