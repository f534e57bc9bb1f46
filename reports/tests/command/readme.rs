//! What README shows is accepted by the program, and what it says of the verdict is what was published.

use std::path::Path;

use sixaxis_calibration::session::SessionFile;

#[test]
fn the_session_in_readme_is_accepted() {
    let readme = include_str!("../../../README.md");
    let text = readme
        .split("```toml\n")
        .nth(1)
        .and_then(|rest| rest.split("```").next())
        .expect("README has a session file");
    let file = SessionFile::parse(Path::new("session.toml"), text.to_owned())
        .unwrap_or_else(|error| panic!("{error}"));
    // At rest, a linear trial and a tap.
    assert_eq!(file.session.recording.len(), 3);
}

#[test]
fn the_verdicts_in_readme_are_the_published_ones() {
    let readme = include_str!("../../../README.md").replace('\n', " ");
    let published: serde_json::Value =
        serde_json::from_str(include_str!("../../../props/results/blind.json")).expect("JSON");
    let number = |key: &str| published[key].as_u64().expect(key);
    for sentence in [
        format!("Of {} sessions", number("sessions")),
        format!("{} healthy", number("healthy")),
        format!(
            "{} verdicts and {} causes were right",
            number("right_verdict"),
            number("right_cause")
        ),
        format!("{} defects were called good", number("broken_promises")),
        format!("{} healthy sessions were not", number("false_alarms")),
    ] {
        assert!(readme.contains(&sentence), "{sentence}");
    }
}
