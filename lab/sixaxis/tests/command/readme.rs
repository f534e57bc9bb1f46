//! What README shows is accepted by the program, and what it says of the verdict is what was published.

use std::path::Path;

use sixaxis_recordings::session::SessionFile;

#[test]
fn the_session_in_readme_is_accepted() {
    let readme = include_str!("../../../../README.md");
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
    let readme = include_str!("../../../../README.md").replace('\n', " ");
    let published: serde_json::Value =
        serde_json::from_str(include_str!("../../../../props/results/blind.json")).expect("JSON");
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

#[test]
fn the_figures_from_the_field_in_readme_are_the_published_ones() {
    let readme = include_str!("../../../../README.md").replace("\n  ", " ");
    let read = |text| serde_json::from_str::<serde_json::Value>(text).expect("JSON");
    let tumbles = read(include_str!(
        "../../../../props/results/self_calibration.json"
    ));
    let sets = read(include_str!("../../../../props/results/failed_limbs.json"));
    let detection = read(include_str!("../../../../props/results/detection.json"));
    let minute = |pace: &str| {
        let lengths = tumbles["lengths"].as_array().expect("lengths");
        let found = lengths
            .iter()
            .find(|l| l["pace"] == pace && l["duration_s"] == 60.0)
            .expect(pace);
        ["rms_error", "largest_error"].map(|key| 100.0 * found[key].as_f64().expect(key))
    };
    let ([rms, worst], [shaken_rms, shaken_worst]) = (minute("brisk"), minute("shaken"));
    let coverage = tumbles["lengths"][0]["coverage_95_by_limb"]
        .as_array()
        .expect("nine");
    let coverage = coverage
        .iter()
        .map(|c| 100.0 * c.as_f64().expect("a share"));
    let (low, high) = coverage.fold((f64::MAX, 0.0), |(a, b), c| (c.min(a), c.max(b)));
    let ratios = |key: &str| {
        let all = sets["sets"].as_array().expect("sets").iter();
        all.filter_map(|set| set[key].as_f64()).fold(0.0, f64::max)
    };
    let whole = |key: &str| sets[key].as_u64().expect(key);
    let isolated = detection["classes"]
        .as_array()
        .expect("classes")
        .iter()
        .map(|class| {
            let of = |key: &str| class["isolated"][key].as_f64().expect(key);
            of("right") / (of("right") + of("wrong") + of("open"))
        })
        .fold(1.0, f64::min);
    for sentence in [
        format!("right to {rms:.3} % rms, the worst of 120 records to {worst:.3} %"),
        format!("shaken, to {shaken_rms:.3} % and {shaken_worst:.3} %"),
        format!("hold {low:.1} to {high:.1} %, limb by limb"),
        format!("{} can be done without", whole("survivable")),
        format!("{} sets stay within twice", whole("within_twice")),
        format!("the worst at {:.1} times", ratios("error_ratio")),
        format!(
            "all {} do, the worst at {:.2} times",
            whole("within_twice_consistent"),
            ratios("error_ratio_consistent")
        ),
        format!("isolated in {:.1} % to its class", 100.0 * isolated),
    ] {
        assert!(readme.contains(&sentence), "{sentence}");
    }
}
