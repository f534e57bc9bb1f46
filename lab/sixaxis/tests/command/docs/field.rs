//! Figures of the studies that docs/field.md rests on, as it and README have them.

use sixaxis_props::blind::share::Share;

use super::figures::extremes;
use super::{on_one_line, published};

/// A count as docs have it.
fn with_comma(count: u64) -> String {
    match count {
        0..1000 => count.to_string(),
        _ => format!("{},{:03}", count / 1000, count % 1000),
    }
}

#[test]
fn the_figures_from_the_field_are_the_published_ones() {
    let docs = on_one_line("docs/field.md");
    let (tumbles, sets, detection) = (
        published("self_calibration"),
        published("failed_limbs"),
        published("detection"),
    );
    let minute = |pace: &str| {
        let lengths = tumbles["lengths"].as_array().expect("lengths");
        let found = lengths
            .iter()
            .find(|l| l["pace"] == pace && l["duration_s"] == 60.0)
            .expect(pace);
        ["rms_error", "largest_error"].map(|key| 100.0 * found[key].as_f64().expect(key))
    };
    let attained = |alarms: &serde_json::Value| {
        let of = |key: &str| alarms[key].as_f64().expect(key);
        (of("alarms") / (of("samples") * of("rate_per_sample")) - 1.0).abs()
    };
    let counted = || detection["false_alarms"].as_array().expect("counts").iter();
    let off = 100.0 * counted().map(attained).fold(0.0, f64::max);
    let alarms = || counted().map(|alarms| alarms["alarms"].as_u64().expect("a count"));
    let [fewest, most] =
        [alarms().min(), alarms().max()].map(|count| with_comma(count.expect("counts")));
    let adds = 1e12
        * sets["largest_noise_free_excess"]
            .as_f64()
            .expect("an excess");
    let ([rms, worst], [shaken_rms, shaken_worst]) = (minute("brisk"), minute("shaken"));
    let coverage = |duration_s: f64| {
        let lengths = tumbles["lengths"].as_array().expect("lengths").iter();
        let such = lengths.filter(|l| l["duration_s"] == duration_s);
        let limbs = such.flat_map(|l| l["coverage_95_by_limb"].as_array().expect("nine"));
        extremes(limbs)
    };
    let ((low, high), (low_60, high_60)) = (coverage(2.0), coverage(60.0));
    let ratios = |key: &str| {
        let all = sets["sets"].as_array().expect("sets").iter();
        all.filter_map(|set| set[key].as_f64()).fold(0.0, f64::max)
    };
    let whole = |key: &str| sets[key].as_u64().expect(key);
    // The hardest group over all kinds, and the hardest kind over all groups, of failures of one size.
    let of_one_size = |failure: &&serde_json::Value| {
        let sigmas = failure.get("sigmas").and_then(serde_json::Value::as_f64);
        sigmas.is_none_or(|sigmas| sigmas == 5.0)
    };
    let isolated = |failure: &serde_json::Value| {
        let of = |key: &str| failure["isolated"][key].as_u64().expect(key);
        let (right, all) = (of("right"), of("right") + of("wrong") + of("open"));
        let share = Share::new(right as usize, all as usize);
        let between = [share.low_95, share.high_95].map(|end| 100.0 * end);
        (100.0 * share.value(), [right, all].map(with_comma), between)
    };
    let hardest = |of: &str| {
        let all = detection[of].as_array().expect(of).iter();
        let shares = all.filter(of_one_size).map(|failure| {
            (
                isolated(failure),
                failure["kind"].as_str().unwrap_or_default(),
            )
        });
        let least = shares.min_by(|a, b| a.0.0.total_cmp(&b.0.0));
        least.expect("failures")
    };
    let small = detection["kinds"].as_array().expect("kinds").iter();
    let small = small
        .filter(|failure| failure["sigmas"] == 2.0)
        .map(|failure| (failure["kind"] == "noise_burst", isolated(failure)));
    let (bursts, others): (Vec<_>, Vec<_>) = small.partition(|(burst, _)| *burst);
    let other = others.iter().map(|(_, (share, ..))| *share);
    let other = other.fold(100.0, f64::min);
    let ((_, [group, group_of], [group_low, group_high]), _) = hardest("classes");
    let ((_, [kind, kind_of], [kind_low, kind_high]), hardest_kind) = hardest("kinds");
    let (_, [burst, burst_of], [burst_low, burst_high]) = &bursts[0].1;
    assert_eq!(hardest_kind, "noise_burst");
    let nine = sets["healthy_largest_error"]
        .as_array()
        .expect("nine limbs");
    let (nine_low, nine_high) = extremes(nine);
    for sentence in [
        format!("determines a ratio to {rms:.3} % rms, the worst of 120 records to {worst:.3} %"),
        format!("shaken, to {shaken_rms:.3} % and {shaken_worst:.3} %"),
        format!(
            "hold {low:.1} to {high:.1} % of the truths of records of 2 s, limb by limb (of a minute {low_60:.1} to {high_60:.1} %"
        ),
        format!("{} can be excluded", whole("survivable")),
        format!("{} sets stay within twice", whole("within_twice")),
        format!("the worst at {:.1} times", ratios("error_ratio")),
        format!(
            "all {} do, the worst at {:.2} times",
            whole("within_twice_consistent"),
            ratios("error_ratio_consistent")
        ),
        format!("nine limbs err by {nine_low:.1} to {nine_high:.1} % of full scale"),
        format!(
            "each group was isolated in at least {group} of {group_of} cases ({group_low:.1} to {group_high:.1} %, "
        ),
        format!("a burst of noise, in {kind} of {kind_of} ({kind_low:.1} to {kind_high:.1} %)"),
        format!(
            "At two standard deviations such a burst is isolated in {burst} of {burst_of} ({burst_low:.0} to {burst_high:.0} %)"
        ),
        format!(
            "the other kinds in at least {:.1} %",
            (10.0 * other).floor() / 10.0
        ),
        format!("{fewest} to {most} alarms differ from those asked for by at most {off:.1} %"),
        format!("an exclusion adds at most {adds:.0} × 10⁻¹² of full scale"),
    ] {
        assert!(docs.contains(&sentence), "{sentence}");
    }
}

#[test]
fn the_false_alarms_in_the_docs_are_the_published_ones() {
    let field = on_one_line("docs/field.md");
    let published = published("watch");
    let corners = published["corners"].as_array().expect("corners");
    // Over the hours in which no limb is excluded; of one kind of motion to fewer digits.
    let rate = |line: &serde_json::Value, decimals: usize| {
        let of = |key: &str| line[key].as_f64().expect(key);
        let watched_share = 1.0 - of("flagged_share");
        let per_hour = of("alarms") / (of("hours") * watched_share);
        let [low, high] =
            [0, 1].map(|end| line["per_hour_95"][end].as_f64().expect("an end") / watched_share);
        (
            per_hour,
            format!("{per_hour:.decimals$} ("),
            format!(
                "{} alarms, {low:.decimals$} to {high:.decimals$})",
                line["alarms"]
            ),
        )
    };
    for corner in corners {
        let (_, total, counted) = rate(&corner["total"], 2);
        let courses = corner["courses"].as_array().expect("courses").iter();
        let (course, (_, worst, of_worst)) = courses
            .map(|course| (course["course"].as_str().expect("a name"), rate(course, 1)))
            .max_by(|(_, a), (_, b)| a.0.total_cmp(&b.0))
            .expect("a course");
        let named = |key: &str, [yes, no]: [&'static str; 2]| {
            if corner["corner"][key] == true {
                yes
            } else {
                no
            }
        };
        let row = format!(
            "| {} | {} | {total}{counted} | {worst}{course}, {of_worst} |",
            named("equal_limbs", ["equal", "unequal by 0.2 %"]),
            named("true_parameters", ["true", "calibrated"]),
        );
        assert!(field.contains(&row), "docs/field.md has not: {row}");
    }
    assert_eq!(corners.len(), 4);
}

#[test]
fn the_field_in_the_readme_is_the_published_one() {
    let readme = on_one_line("README.md");
    let (sets, hours) = (published("failed_limbs"), published("hours"));
    let worst = |key: &str| {
        let all = sets["sets"].as_array().expect("sets").iter();
        all.filter_map(|set| set[key].as_f64()).fold(0.0, f64::max)
    };
    let rides = || hours["rides"].as_array().expect("rides").iter();
    let open_loop = rides().filter(|ride| {
        ride["aids"] == serde_json::json!({"velocity": null, "attitude": null, "rests": false})
    });
    let known_s = open_loop.map(|ride| ride["unknown_from_s"].as_f64().expect("a time"));
    let known_s: Vec<f64> = known_s.collect();
    let [first_s, last_s] = [f64::min as fn(f64, f64) -> f64, f64::max]
        .map(|of| known_s.iter().copied().reduce(of).expect("a ride"));
    assert_eq!(known_s.len(), 5);
    let mut fixed = rides().filter(|ride| !ride["aids"]["attitude"].is_null());
    assert!(fixed.all(|ride| ride["known_to_the_end"] == hours["runs"]));
    for sentence in [
        format!(
            "can be excluded, in {} of {} combinations",
            sets["survivable"],
            sets["sets"].as_array().expect("sets").len()
        ),
        format!(
            "the largest error is {:.1} times that of all nine limbs (",
            worst("error_ratio")
        ),
        format!(
            "or {:.2} times with the scale ratios fitted on the run",
            worst("error_ratio_consistent")
        ),
        format!("all axes together, reaches 5° after {first_s:.0} to {last_s:.0} s"),
    ] {
        assert!(readme.contains(&sentence), "README has not: {sentence}");
    }
}

#[test]
fn the_hours_in_the_field_are_the_published_ones() {
    let field = on_one_line("docs/field.md");
    let hours = published("hours");
    let rides = || hours["rides"].as_array().expect("rides").iter();
    // Squared errors over variances, of rate and of attitude, by the runs that are known at a look.
    let looks = rides().flat_map(|ride| ride["at"].as_array().expect("looks"));
    let ratios: Vec<(u64, f64)> = looks
        .filter_map(|look| Some((look["known"].as_u64()?, look["over_variance"].as_array()?)))
        .flat_map(|(known, both)| {
            let numbers = both.iter().filter_map(serde_json::Value::as_f64);
            numbers.map(move |ratio| (known, ratio))
        })
        .collect();
    let of = |wanted: &dyn Fn(u64) -> bool| {
        let some = ratios.iter().filter(|(known, _)| wanted(*known));
        some.fold((f64::INFINITY, 0.0_f64), |(low, high), (_, ratio)| {
            (low.min(*ratio), high.max(*ratio))
        })
    };
    let runs = hours["runs"].as_u64().expect("runs");
    let (low, high) = of(&|known| known == runs);
    let (some, one) = (
        of(&|known| known > 1 && known < runs),
        of(&|known| known == 1),
    );
    let until = |velocity: bool, rests: bool| -> Vec<f64> {
        let rides = rides().filter(|ride| {
            let aids = &ride["aids"];
            aids["attitude"].is_null()
                && aids["velocity"].is_null() != velocity
                && aids["rests"] == rests
        });
        rides
            .filter_map(|ride| ride["unknown_from_s"].as_f64())
            .collect()
    };
    let (open, velocities, rests) = (until(false, false), until(true, false), until(false, true));
    assert_eq!((open.len(), velocities.len(), rests.len()), (5, 2, 2));
    let [first_s, last_s] = [f64::min as fn(f64, f64) -> f64, f64::max]
        .map(|least| open.iter().copied().reduce(least).expect("a ride"));
    for sentence in [
        format!(
            "these ratios are {low:.2} to {high:.2} at the looks at which all {runs} are known; where fewer are, up to {:.2} (three runs) and {:.1} (one run)",
            some.1, one.1
        ),
        format!(
            "known to 5° for {first_s:.0} to {last_s:.0} s in open loop (medians of the five kinds), {:.0} and {:.0} s with velocities",
            velocities[0], velocities[1]
        ),
        format!(
            "{:.0} s (tumble) and {:.0} s (pick and place) with rests",
            rests[0], rests[1]
        ),
    ] {
        assert!(
            field.contains(&sentence),
            "docs/field.md has not: {sentence}"
        );
    }
}
