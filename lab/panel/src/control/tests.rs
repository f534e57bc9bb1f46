//! Messages are read, and what is out of bounds is refused.

use super::*;

#[test]
fn law_messages_are_read() {
    let view = r#"{"do":"view","columns":[0,8],"span_s":10,"end_s":null,"points":800}"#;
    assert!(matches!(Message::parse(view), Ok(Message::View(v)) if v.columns == [0, 8]));
    let dead = r#"{"do":"defect","defect":{"kind":"dead","limb":4}}"#;
    let defect = Some(Defect::Dead { limb: 4 });
    assert_eq!(Message::parse(dead).ok(), Some(Message::Defect { defect }));
}

#[test]
fn law_anything_else_is_refused() {
    for text in [
        "",
        "null",
        "[]",
        r#"{"do":"shutdown"}"#,
        r#"{"do":"take","please":true}"#,
        r#"{"do":"run","run":{"motion":"linear","wedge":0,"frequency_hz":6,"amplitude":1,"seconds":3}}"#,
        r#"{"do":"run","run":{"motion":"linear","wedge":9,"frequency_hz":1,"amplitude":1,"seconds":3}}"#,
        r#"{"do":"run","run":{"motion":"linear","wedge":0,"frequency_hz":1,"amplitude":1,"seconds":3,"x":1}}"#,
        r#"{"do":"defect","defect":{"kind":"dead","limb":10}}"#,
        r#"{"do":"defect","defect":{"kind":"slip","limb":1}}"#,
        r#"{"do":"view","columns":[54],"span_s":1,"end_s":null,"points":10}"#,
        r#"{"do":"view","columns":[0],"span_s":0,"end_s":null,"points":10}"#,
        r#"{"do":"view","columns":[0],"span_s":1,"end_s":null,"points":1}"#,
        r#"{"do":"speed","speed":1e999}"#,
        r#"{"do":"record","name":"../evil","format":"csv"}"#,
        r#"{"do":"record","name":"a","format":"exe"}"#,
        r#"{"do":"capture","trial":-1,"done":false}"#,
    ] {
        assert!(Message::parse(text).is_err(), "{text}");
    }
    let long = format!(r#"{{"do":"take","a":"{}"}}"#, "x".repeat(LONGEST_MESSAGE));
    let refusal = Message::parse(&long).expect_err("it is too long");
    assert_eq!(refusal.to_string(), "a message is at most 4096 bytes");
}

#[test]
fn law_names_stay_in_their_folder() {
    assert!(is_name("run-01.a_B"));
    for name in [
        "", ".", "..", "../a", "a/b", "a\\b", ".hidden", "a b", "ä", "a\0",
    ] {
        assert!(!is_name(name), "{name:?}");
    }
    assert!(!is_name(&"a".repeat(81)));
}

#[test]
fn prop_no_text_makes_it_panic() {
    let words = [
        "{",
        "}",
        "\"do\"",
        ":",
        "\"view\"",
        ",",
        "1e400",
        "-0",
        "null",
        "[",
        "]",
        "\"\\ud800\"",
        "\u{0}",
    ];
    let mut state = 3_u64;
    for _ in 0..1_000 {
        let mut text = String::new();
        for _ in 0..12 {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            text += words[(state >> 33) as usize % words.len()];
        }
        let _ = Message::parse(&text);
    }
}
