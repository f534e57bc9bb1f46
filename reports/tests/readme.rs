//! README's session file is one that is accepted.

use std::path::Path;

use sixaxis_calibration::session::SessionFile;

#[test]
fn the_session_in_readme_is_accepted() {
    let readme = include_str!("../../README.md");
    let text = readme
        .split("```toml\n")
        .nth(1)
        .and_then(|rest| rest.split("```").next())
        .expect("README has a session file");
    let file = SessionFile::parse(Path::new("session.toml"), text.to_owned())
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(file.session.recording.len(), 2);
}
