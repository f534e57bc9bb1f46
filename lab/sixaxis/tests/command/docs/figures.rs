//! Figures of published studies, as README and docs have them.

use super::{on_one_line, published};

#[test]
fn the_grades_in_the_docs_are_the_published_ones() {
    let docs = on_one_line("docs/session.md");
    let published = published("blind");
    let share = |share: &serde_json::Value| {
        let number = |key: &str| share[key].as_f64().expect(key);
        let (count, of) = (number("count"), number("of"));
        let [low, high] = ["low_95", "high_95"].map(|key| 100.0 * number(key));
        format!("{count} of {of} ({low:.1} to {high:.1} %)")
    };
    let row_of = |cell: &serde_json::Value| {
        let rows = published["healthy"].as_array().expect("healthy rows");
        rows.iter()
            .find(|row| row["cell"] == *cell)
            .expect("a cell")
    };
    let tally = |cell: serde_json::Value, what: &str| share(&row_of(&cell)["tally"][what]);
    let cell = |cell| tally(cell, "good");
    let false_good = |cell| tally(cell, "false_good");
    let decoupled = |room: &str, kind: usize| {
        let row = row_of(&serde_json::json!({ "room": room }));
        100.0
            * row["tally"]["beyond_gain_95"][kind]
                .as_f64()
                .expect("errors")
    };
    for sentence in [
        format!("{} sessions", published["sessions"]),
        format!("{} of all", share(&published["false_good"])),
        format!(
            "{} of those that are called good",
            share(&published["false_good_of_good"])
        ),
        format!(
            "In the corner {}, in the gentle room {} are called good and are not",
            false_good("corner".into()),
            false_good(serde_json::json!({"room": "gentle"})),
        ),
        format!("wrong cause: {}", share(&published["wrong_cause_of_named"])),
        format!("in the corner {}", cell("corner".into())),
        format!(
            "in the gentle room {}",
            cell(serde_json::json!({"room": "gentle"}))
        ),
        format!(
            "in the usual room {}",
            cell(serde_json::json!({"room": "usual"}))
        ),
        format!(
            "of the other sessions it is {}",
            share(&published["false_good_that_could_show"])
        ),
        format!(
            "to {:.2} % (linear) and {:.2} % (angular) of the peak in the gentle room, {:.2} % and {:.2} % in the usual one",
            decoupled("gentle", 0),
            decoupled("gentle", 1),
            decoupled("usual", 0),
            decoupled("usual", 1),
        ),
    ] {
        assert!(docs.contains(&sentence), "{sentence}");
    }
}

#[test]
fn the_headline_of_the_readme_is_the_published_one() {
    let published = published("laboratories");
    let errors = |set: &str, treated: &str, against: &str| {
        let list = published[set][treated][against].as_array().expect(set);
        let percent = list.iter().map(|e| 100.0 * e.as_f64().expect("a number"));
        percent.collect::<Vec<f64>>()
    };
    // Nearest rank, as the report's table has it.
    let median_and_worst = |mut errors: Vec<f64>| {
        errors.sort_by(f64::total_cmp);
        let middle = errors.len().div_ceil(2) - 1;
        (errors[middle], errors[errors.len() - 1])
    };
    let instruments = |treated| errors("identified", treated, "instruments");
    let (open, corrected) = (instruments("open_loop"), instruments("corrected"));
    let [of_class, open_of_class] =
        [&corrected, &open].map(|errors| errors.iter().filter(|e| **e <= 1.0).count());
    let (seed_1, seed_1_corrected) = (open[0], corrected[0]);
    let count = open.len();
    let (median, worst) = median_and_worst(open);
    let (median_corrected, worst_corrected) = median_and_worst(corrected);
    let (before, _) = median_and_worst(errors("design", "open_loop", "instruments"));
    let readme = on_one_line("README.md");
    for sentence in [
        format!(
            "median {median:.1} %, worst {worst:.1} % of {count} laboratories (before identification {before:.0} %)"
        ),
        format!(
            "median {median_corrected:.1} %, worst {worst_corrected:.1} % when each run is corrected from rest to rest"
        ),
        format!("Seed 1 is a lucky one: {seed_1:.1} % and {seed_1_corrected:.2} %"),
        format!(
            "corrected, {of_class} of {count} laboratories keep all 18 cells within 1 %, open loop {open_of_class} of {count}"
        ),
    ] {
        assert!(readme.contains(&sentence), "{sentence}");
    }
}

/// Smallest and largest share of a list, per cent.
fn extremes<'a>(shares: impl IntoIterator<Item = &'a serde_json::Value>) -> (f64, f64) {
    let percent = shares
        .into_iter()
        .map(|share| 100.0 * share.as_f64().expect("a share"));
    percent.fold((f64::INFINITY, 0.0), |(low, high), share| {
        (share.min(low), share.max(high))
    })
}

/// Per cent to so many significant digits.
#[cfg(feature = "harness")]
fn percent(share: f64, digits: usize) -> String {
    let percent = 100.0 * share;
    let before = percent.log10().floor() as i32 + 1;
    let decimals = usize::try_from(digits as i32 - before).unwrap_or(0);
    format!("{percent:.decimals$}")
}

#[cfg(feature = "harness")]
#[test]
fn the_budget_in_the_readme_is_the_published_one() {
    use sixaxis_props::results::{Budget, Published, headline};

    let budget = Budget::embedded().expect("budget.json");
    let readme = on_one_line("README.md");
    let ladders = budget.ladders();
    let ladder = |name: &str| ladders.iter().find(|l| l.name == name).expect(name);
    let alone = |name: &str| ladder(name).alone(headline);
    let played = |name: &str| {
        let draws = ladder(name).steps.iter().flat_map(|(_, draws)| draws);
        draws.map(|draw| draw.mujoco).collect::<Vec<_>>()
    };
    let flexures = percent(alone("flexures that bend").expect("a size"), 1);
    let wedges = alone("wedges").expect("a size");
    let equal = ladder("unequal stiffness").steps.last().expect("a size").0;
    for sentence in [
        format!("Flexures whose lateral stiffness is {flexures} % of the axial one (in MuJoCo)"),
        format!("wedges {wedges:.2}° off (rigid limbs, median of three laboratories)"),
        format!(
            "unequal limbs alone do not, tried to {} %",
            percent(equal, 2)
        ),
    ] {
        assert!(readme.contains(&sentence), "README has not: {sentence}");
    }
    assert_eq!(alone("unequal stiffness"), None);
    assert!(played("flexures that bend").iter().all(|mujoco| *mujoco));
    assert!(played("wedges").iter().all(|mujoco| !mujoco));
    assert!(
        ladder("wedges")
            .steps
            .iter()
            .all(|(_, draws)| draws.len() == 3)
    );
}

#[test]
fn the_campaigns_in_the_docs_are_the_published_ones() {
    let docs = on_one_line("docs/campaigns.md");
    let campaign = published("campaign");
    let (mujoco, of_session) = (published("campaign_mujoco"), on_one_line("docs/session.md"));
    let held = |summary: &serde_json::Value, estimator: &str, letter: char| {
        let all = summary["parameters"].as_array().expect("parameters").iter();
        let such = all.filter(|p| p["name"].as_str().expect("a name").starts_with(letter));
        let shares: Vec<_> = such
            .map(|p| &p[estimator]["within_stated_95"]["value"])
            .collect();
        extremes(shares)
    };
    let (low, high) = ['d', 's', 'I']
        .map(|letter| held(&campaign, "joint", letter))
        .into_iter()
        .fold((100.0_f64, 0.0_f64), |(low, high), (a, b)| {
            (low.min(a), high.max(b))
        });
    let joint = format!("{low:.1} to {high:.1} %");
    let (drift, _) = held(&campaign, "four_steps", 'd');
    let (scale, _) = held(&campaign, "four_steps", 's');
    let (inertia_low, inertia_high) = held(&campaign, "four_steps", 'I');
    let products = mujoco["summary"]["parameters"]
        .as_array()
        .expect("parameters");
    let products = products[21..24].iter();
    let (product_low, product_high) =
        extremes(products.map(|p| &p["four_steps"]["within_stated_95"]["value"]));
    let pooled = |place: usize| {
        let pooled = &mujoco["coverage"][place];
        let of = |key: &str| pooled[key].as_f64().expect(key);
        let ends = &pooled["by_case_95"];
        let (low, high) = extremes(ends.as_array().expect("two"));
        (100.0 * of("inside") / of("intervals"), low, high)
    };
    let ((four_steps, ..), (fit, fit_low, fit_high)) = (pooled(0), pooled(1));
    let variance = |estimator: &str, letter: char| {
        let all = campaign["parameters"]
            .as_array()
            .expect("parameters")
            .iter();
        let of = |p: &serde_json::Value| p[estimator]["variance_over_stated"].as_f64();
        let such = all.filter(|p| p["name"].as_str().expect("a name").starts_with(letter));
        let (low, high) = such
            .map(|p| of(p).expect("a variance"))
            .fold((f64::INFINITY, 0.0_f64), |(low, high), v| {
                (low.min(v), high.max(v))
            });
        format!("{low:.2} to {high:.2}")
    };
    let of_joint = ['d', 's', 'I'].map(|letter| variance("joint", letter));
    for sentence in [
        format!(
            "| {} for drifts; thousands for the others",
            variance("four_steps", 'd')
        ),
        format!(
            "| {} for drifts; {} for scale factors, {} for inertias |",
            of_joint[0], of_joint[1], of_joint[2]
        ),
        format!("95 % intervals that hold the truth, drifts | {drift:.0} % | {joint}"),
        format!("scale factors | {scale:.0} % (too wide) | {joint}"),
        format!("inertias | {inertia_low:.0} to {inertia_high:.0} % (too narrow) | {joint}"),
        format!(
            "pooled hold {four_steps:.1} % for the four steps and {fit:.1} % ({fit_low:.1} to {fit_high:.1} %) for the joint fit"
        ),
        format!("products of inertia, of which {product_low:.0} to {product_high:.0} % are held"),
    ] {
        assert!(
            docs.contains(&sentence),
            "docs/campaigns.md has not: {sentence}"
        );
    }
    let sentence = format!(
        "hold {drift:.0} % of the drifts, all scale factors and {inertia_low:.0} to {inertia_high:.0} % of the inertias"
    );
    assert!(
        of_session.contains(&sentence),
        "docs/session.md has not: {sentence}"
    );
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
    let hardest = |of: &str| {
        let all = detection[of].as_array().expect(of).iter();
        let shares = all.filter(of_one_size).map(|failure| {
            let of = |key: &str| failure["isolated"][key].as_f64().expect(key);
            (
                100.0 * of("right") / (of("right") + of("wrong") + of("open")),
                failure["kind"].as_str().unwrap_or_default(),
            )
        });
        shares.fold((100.0, ""), |a, b| if b.0 < a.0 { b } else { a })
    };
    let (group, _) = hardest("classes");
    let (kind, hardest_kind) = hardest("kinds");
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
        format!("each group was isolated in at least {group:.1} % of the cases"),
        format!("a burst of noise, in {kind:.1} %"),
    ] {
        assert!(docs.contains(&sentence), "{sentence}");
    }
}

#[test]
fn the_false_alarms_in_the_docs_are_the_published_ones() {
    let field = on_one_line("docs/field.md");
    let published = published("watch");
    let corners = published["corners"].as_array().expect("corners");
    let corner = |equal_limbs: bool| {
        let wanted = serde_json::json!({"equal_limbs": equal_limbs, "true_parameters": false});
        corners
            .iter()
            .find(|c| c["corner"] == wanted)
            .expect("a corner")
    };
    // Over the hours in which no limb is excluded.
    let per_hour = |line: &serde_json::Value| {
        let of = |key: &str| line[key].as_f64().expect(key);
        of("alarms") / (of("hours") * (1.0 - of("flagged_share")))
    };
    let courses = corner(false)["courses"].as_array().expect("courses");
    let worst = courses.iter().map(per_hour).fold(0.0, f64::max);
    let sentence = format!(
        "{:.1} an hour with limbs unequal by 0.2 %, at most {worst:.1} in one of the seven kinds of motion; {:.1} an hour with equal limbs",
        per_hour(&corner(false)["total"]),
        per_hour(&corner(true)["total"]),
    );
    assert!(field.contains(&sentence), "{sentence}");
}
