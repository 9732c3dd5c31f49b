//! `table`: columns of text.

use footwork::report::table::table;

#[test]
fn tables_align_numbers_to_the_right() {
    let rows = [
        vec!["walk".to_owned(), "3.25".to_owned(), "1.31 m/s".to_owned()],
        vec!["übergang".to_owned(), "12.00".to_owned(), "–".to_owned()],
        vec!["stub".to_owned()],
    ];
    let text = table(&["clip", "minutes", "speed"], &rows);
    let expected = "\
clip      minutes     speed
────────  ───────  ────────
walk         3.25  1.31 m/s
übergang    12.00         –
stub
";
    assert_eq!(text, expected);
    assert_eq!(table(&["a"], &[]), "a\n─\n");
    assert_eq!(table(&[], &[vec![]]), "\n\n\n");
}
