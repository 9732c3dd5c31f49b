//! Pictures are written whole or not at all.

use super::{Picture, training};
use footwork::report::{learning_curve, png_file};
use std::fs;

#[test]
fn a_picture_that_cannot_be_written_is_an_error_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing").join("picture.png");
    let error = learning_curve::draw(&missing, &training(), &[], &[]).unwrap_err();
    assert!(error.to_string().contains("missing"), "{error}");

    // A folder in the picture's place: everything succeeds but the last step.
    let taken = folder.path().join("taken.png");
    fs::create_dir(&taken).unwrap();
    assert!(learning_curve::draw(&taken, &training(), &[], &[]).is_err());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_failed_picture_leaves_the_previous_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.png");
    png_file::save(&path, 2, 1, &[0, 1, 2, 3, 4, 5]).unwrap();
    assert!(
        png_file::save(&path, 2, 1, &[9; 5]).is_err(),
        "a byte short"
    );
    assert_eq!(Picture::open(&path).rgb, [0, 1, 2, 3, 4, 5]);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}
