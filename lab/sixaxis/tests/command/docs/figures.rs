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
    let decoupled_median = |room: &str| {
        let row = row_of(&serde_json::json!({ "room": room }));
        100.0
            * row["tally"]["median_decoupling_error"]
                .as_f64()
                .expect("a median")
    };
    let wrong = published["kinds"].as_array().expect("kinds").iter();
    let wrong = wrong.filter_map(|kind| {
        let bins = kind["bins"].as_array().expect("bins").iter();
        let counts = bins.map(|bin| bin["tally"]["wrong_cause"]["count"].as_u64());
        let count = counts.map(|count| count.expect("a count")).sum::<u64>();
        let name = kind["kind"].as_str().expect("a name");
        (count > 0).then(|| format!("{count} of `{name}`"))
    });
    let wrong = wrong.collect::<Vec<_>>().join(", ");
    let pairs = super::published("blind_mujoco");
    let of_pairs = |what: &str| share(&pairs[what]);
    let same_grade = of_pairs("same_grade");
    let (count, bounds) = same_grade.split_once(" of ").expect("a share");
    let (of, bounds) = bounds.split_once(' ').expect("bounds");
    for sentence in [
        format!(
            "Of {of} further sessions, played by MuJoCo, whose limbs yield along their axes, and once more with rigid limbs and the same noise, {count} have the same \
             grade {bounds}, and"
        ),
        format!("{} sessions", published["sessions"]),
        format!("{} of all", share(&published["false_good"])),
        format!(
            "{} of those that are called good",
            share(&published["false_good_of_good"])
        ),
        format!(
            "of these are called good and are not: in the corner {}, in the gentle room {}, in the usual room {};",
            false_good("corner".into()),
            false_good(serde_json::json!({"room": "gentle"})),
            false_good(serde_json::json!({"room": "usual"})),
        ),
        format!(
            "wrong cause: {} sessions that name one.",
            share(&published["wrong_cause_of_named"])
        ),
        format!("The wrong ones by kind of defect, as `simulate --defect` calls it: {wrong};"),
        format!(
            "only medians are published: {:.2} % in the gentle room, {:.2} % in the usual one.",
            decoupled_median("gentle"),
            decoupled_median("usual")
        ),
        format!("In the corner {}", cell("corner".into())),
        format!(
            "in the gentle room {}",
            cell(serde_json::json!({"room": "gentle"}))
        ),
        format!(
            "in the usual room {}",
            cell(serde_json::json!({"room": "usual"}))
        ),
        format!(
            "Of the other sessions it is {},",
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

#[cfg(feature = "harness")]
#[test]
fn the_grades_of_all_healthy_sessions_are_the_published_ones() {
    use sixaxis_props::blind::share::Share;
    use sixaxis_props::results::{Blind, BlindPairs, Published};

    let blind = Blind::embedded().expect("blind.json");
    let tallies = || blind.healthy.iter().map(|row| &row.tally);
    let sessions = tallies().map(|tally| tally.sessions).sum();
    let bounds = |share: Share| {
        let [low, high] = [share.low_95, share.high_95].map(|end| 100.0 * end);
        format!("({low:.1} to {high:.1} %)")
    };
    let words = |share: Share| format!("{} of {} {}", share.count, share.of, bounds(share));
    let good = Share::new(tallies().map(|tally| tally.good.count).sum(), sessions);
    let false_good = Share::new(
        tallies().map(|tally| tally.false_good.count).sum(),
        sessions,
    );
    let by_upper_end = |a: &Share, b: &Share| a.high_95.total_cmp(&b.high_95);
    let worst = tallies().map(|tally| tally.false_good).max_by(by_upper_end);
    let worst = worst.expect("a kind");
    let sentence = format!(
        "called good: {} in all sixteen kinds, of which {} are not, in the kind that excludes least {}.",
        words(good),
        words(false_good),
        words(worst)
    );
    assert_eq!(blind.healthy.len(), 16);
    let pairs = BlindPairs::embedded().expect("blind_mujoco.json");
    let alike = pairs.same_cause_of_named();
    let docs = on_one_line("docs/session.md");
    for sentence in [
        sentence,
        format!(
            "of those among them that are called good {};",
            words(blind.false_good_of_good_that_could_show())
        ),
        format!(
            "of the {} that name a cause {} name the same first {}",
            alike.of,
            alike.count,
            bounds(alike)
        ),
    ] {
        assert!(
            docs.contains(&sentence),
            "docs/session.md has not: {sentence}"
        );
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
    let of_seed_1 = |errors: &[f64]| {
        let rank = 1 + errors.iter().filter(|e| **e < errors[0]).count();
        (errors[0], rank)
    };
    let ((seed_1, rank), (seed_1_corrected, rank_corrected)) =
        (of_seed_1(&open), of_seed_1(&corrected));
    let count = open.len();
    let told = |treated| median_and_worst(errors("with_truth", treated, "truth")).0;
    let (told, told_corrected) = (told("open_loop"), told("corrected"));
    let (median, worst) = median_and_worst(open);
    let (median_corrected, worst_corrected) = median_and_worst(corrected);
    let (before, _) = median_and_worst(errors("design", "open_loop", "instruments"));
    let (of_truth, worst_of_truth) = median_and_worst(errors("identified", "open_loop", "truth"));
    let readme = on_one_line("README.md");
    for sentence in [
        format!(
            "median {median:.1} %, worst {worst:.1} % of {count} laboratories (against truth {of_truth:.1} % and {worst_of_truth:.1} %; before \
             identification, median {before:.0} %)"
        ),
        format!(
            "median {median_corrected:.1} %, worst {worst_corrected:.1} % when each run is corrected from rest to rest"
        ),
        format!(
            "the true 25 parameters the medians against truth are {told:.2} % open loop and {told_corrected:.2} % corrected;"
        ),
        format!(
            "seed 1 has {seed_1:.1} % and, corrected, {seed_1_corrected:.2} %: rank {rank} and rank {rank_corrected} of {count}"
        ),
        format!(
            "Corrected, {of_class} of {count} laboratories keep all 18 cells within 1 %, open loop {open_of_class} of {count}"
        ),
    ] {
        assert!(readme.contains(&sentence), "{sentence}");
    }
}

/// Smallest and largest share of a list, per cent.
pub(super) fn extremes<'a>(shares: impl IntoIterator<Item = &'a serde_json::Value>) -> (f64, f64) {
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
    let between = |name: &str| alone(name).expect("two sizes");
    let powers = between("flexures that bend").map(|size| {
        let power = size.log10().round();
        assert!((size.log10() - power).abs() < 1e-9, "{size}");
        ["10⁻⁴", "10⁻³"][(power + 4.0) as usize]
    });
    let [wedges, more] = between("wedges");
    let perfect = budget.combined(false)[0][0]
        .errors
        .as_ref()
        .map(headline)
        .expect("errors");
    let instruments = ladder("instruments");
    let class_1 = instruments.steps.iter().find(|(size, _)| *size == 1.0);
    let (_, draws) = class_1.expect("class 1");
    let errors = draws.iter().filter_map(|draw| draw.errors.as_ref());
    let mut left: Vec<f64> = errors.map(headline).collect();
    left.sort_by(f64::total_cmp);
    let [least, middle, most] = left[..] else {
        panic!("three laboratories: {left:?}");
    };
    let [least, middle, most] = [least, middle, most].map(|share| format!("{:.1}", 100.0 * share));
    let equal = ladder("unequal stiffness").steps.last().expect("a size").0;
    for sentence in [
        format!(
            "flexures whose lateral stiffness is {} and {} of the axial one (in MuJoCo)",
            powers[0], powers[1]
        ),
        format!("wedges drawn up to {wedges}° and {more}° off (rigid limbs, median of three"),
        format!(
            "instruments of class 1 % alone leave {least}, {middle} and {most} % in three laboratories, perfect ones {} %",
            percent(perfect, 2)
        ),
        format!(
            "unequal limbs alone do not reach it, tried to {} %",
            percent(equal, 2)
        ),
        format!(
            "a perfect laboratory is left with {} %, most of which the low-pass takes",
            percent(perfect, 2)
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
fn the_rooms_in_the_docs_are_the_published_ones() {
    let docs = on_one_line("docs/session.md");
    let published = published("rooms");
    let [gentle, usual] = [0, 1].map(|place| &published["rooms"][place]);
    assert_eq!(
        (&gentle["room"], &usual["room"]),
        (&"gentle".into(), &"usual".into())
    );
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    let held = |room: &serde_json::Value, letter: char| {
        let all = room["intervals"].as_array().expect("parameters").iter();
        let such = all.filter(|p| p["name"].as_str().expect("a name").starts_with(letter));
        let shares = such.map(|p| number(&p["held"]["count"]) / number(&p["held"]["of"]));
        let shares: Vec<serde_json::Value> = shares.map(Into::into).collect();
        let (low, high) = extremes(&shares);
        format!("{low:.1} to {high:.1} %")
    };
    let of = |room| ['d', 's', 'I'].map(|letter| held(room, letter));
    let ([drift, scale, inertia], [drift_usual, scale_usual, inertia_usual]) =
        (of(gentle), of(usual));
    let sessions = number(&gentle["sessions"]);
    // None was refused, calibrated by the four steps or not decoupled.
    for room in [gentle, usual] {
        for kept in ["by_joint_fit", "runs", "sessions"] {
            assert_eq!(room[kept], gentle["sessions"], "{kept}");
        }
    }
    let percent =
        |room: &serde_json::Value, key: &str| format!("{:.1}", 100.0 * number(&room[key]));
    let both = |key| format!("{} and {} %", percent(gentle, key), percent(usual, key));
    let of_kind = |room: &serde_json::Value, less: f64, what: &str| {
        let sizes = room["one_kind"].as_array().expect("sizes");
        let of_size = sizes.iter().find(|one| number(&one["less"]) == less);
        let of_size = &of_size.expect("this size")[what];
        let [low, high] = ["low_95", "high_95"].map(|end| 100.0 * number(&of_size[end]));
        format!("{} ({low:.0} to {high:.0} %)", of_size["count"])
    };
    let days = number(&gentle["one_kind"][0]["good"]["of"]);
    let of_both = |less, what| {
        let [gentle, usual] = [gentle, usual].map(|room| of_kind(room, less, what));
        format!("{gentle} and {usual}")
    };
    for sentence in [
        format!(
            "Of {days} days in each room on which one channel shows 2 % less in the angular trials alone, {} are called good, and of {} the channel is named; \
             with 1 % less {} and {} (`props/results/rooms.json`).",
            of_both(0.02, "good"),
            of_both(0.02, "named"),
            of_both(0.01, "good"),
            of_both(0.01, "named")
        ),
        format!(
            "`props/results/rooms.json`, {sessions} healthy sessions of each, calibrated from their files: a share of 95 % has a standard error of {:.1} %",
            100.0 * (0.95 * 0.05 / sessions).sqrt()
        ),
        format!(
            "hold {drift} of the drifts, {scale} of the scale factors and {inertia} of the inertias in the gentle room, {drift_usual}, {scale_usual} and \
             {inertia_usual} in the usual one."
        ),
        format!(
            "have {} of all values in ground axes within three stated deviations, in 95 % of the runs at least {}.",
            both("values_within"),
            both("values_within_95")
        ),
    ] {
        assert!(
            docs.contains(&sentence),
            "docs/session.md has not: {sentence}"
        );
    }
}

#[test]
fn the_campaigns_in_the_docs_are_the_published_ones() {
    let docs = on_one_line("docs/campaigns.md");
    let campaign = published("campaign");
    let (mujoco, of_session) = (published("campaign_mujoco"), on_one_line("docs/session.md"));
    let of_kind = |letter: char| {
        let all = campaign["parameters"].as_array().expect("parameters");
        let such =
            move |p: &&serde_json::Value| p["name"].as_str().expect("a name").starts_with(letter);
        all.iter().filter(such).collect::<Vec<_>>()
    };
    let held = |estimator: &str, letter: char| {
        let of = of_kind(letter).into_iter();
        extremes(of.map(|p| &p[estimator]["within_stated_95"]["value"]))
    };
    let range = |(low, high): (f64, f64)| format!("{low:.1} to {high:.1} %");
    let [drift, scale, inertia] = ['d', 's', 'I']
        .map(|letter| held("joint", letter))
        .map(range);
    let steps = ['d', 's', 'I'].map(|letter| held("four_steps", letter));
    let [(drift_low, _), (all_scale, _), (inertia_low, inertia_high)] = steps;
    let [steps_drift, _, steps_inertia] = steps.map(range);
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
    let number =
        |p: &serde_json::Value, estimator: &str, key: &str| p[estimator][key].as_f64().expect(key);
    let ends = |values: Vec<f64>| {
        let ends = (f64::INFINITY, f64::NEG_INFINITY);
        values
            .iter()
            .fold(ends, |(low, high), v| (low.min(*v), high.max(*v)))
    };
    let variance = |estimator: &str, letter: char| {
        let of = of_kind(letter).into_iter();
        let (low, high) = ends(
            of.map(|p| number(p, estimator, "variance_over_stated"))
                .collect(),
        );
        let [low, high] = match high {
            100.0.. => [low, high].map(super::speeds::two_digits),
            _ => [low, high].map(|v| format!("{v:.2}")),
        };
        if low == high {
            low
        } else {
            format!("{low} to {high}")
        }
    };
    let of_steps = |letter| variance("four_steps", letter);
    let of_joint = |letter| variance("joint", letter);
    let told = |letter| variance("joint_gain_known", letter);
    // Of the four steps' squared errors, what the fit's errors lose when it is told the gain.
    let of_gain = |letter| {
        let share = |p: &serde_json::Value| {
            let square = |estimator| number(p, estimator, "attained_sd").powi(2);
            100.0 * (square("joint") - square("joint_gain_known")) / square("four_steps")
        };
        let (low, high) = ends(of_kind(letter).into_iter().map(share).collect());
        format!("{low:.0} to {high:.0} %")
    };
    let joint = published("joint");
    let biases = |of: &str| {
        let levels = joint["levels"].as_array().expect("levels").iter();
        let loudest = levels.filter(|level| level["noise_db"] == 34.0);
        let biases = loudest.flat_map(|level| level[of].as_array().expect("nine"));
        biases
            .map(|bias| bias.as_f64().expect("a bias").abs())
            .fold(0.0, f64::max)
    };
    let tap = published("tap");
    let damped = &tap["tallies"][0];
    for sentence in [
        format!("hold the truth, drifts | {steps_drift} | {drift} |"),
        format!("the same, scale factors | {all_scale:.1} % (too wide) | {scale} |"),
        format!("the same, inertias | {steps_inertia} (too narrow) | {inertia} |"),
        format!(
            "stated variance, drifts | {} | {} |",
            of_steps('d'),
            of_joint('d')
        ),
        format!(
            "scale factors | {} | {}; told the gain, {} |",
            of_steps('s'),
            of_joint('s'),
            told('s')
        ),
        format!(
            "inertias | {} | {}; told the gain, {} |",
            of_steps('I'),
            of_joint('I'),
            told('I')
        ),
        format!(
            "squared error {} is the accelerometer's gain, of the inertias' {}.",
            of_gain('s'),
            of_gain('I')
        ),
        format!(
            "biased by up to {:.1} of their standard deviations, the joint fit by at most {:.2} ± {:.2}",
            biases("plain_least_squares"),
            biases("joint_fit"),
            joint["scatter"].as_f64().expect("a scatter"),
        ),
        format!(
            "to {:.0} × 10⁻⁴ rms (`props/results/tap.json`, {} taps with {:.0} % noise, limbs damped by {:.0} % of what is critical under the whole mass, {:.0} kHz)",
            1e4 * damped["rms_error_ln"].as_f64().expect("an error"),
            damped["taps"],
            100.0 * tap["noise_over_peak"].as_f64().expect("noise"),
            100.0 * damped["damping_ratio"].as_f64().expect("damping"),
            tap["sample_rate_hz"].as_f64().expect("a rate") / 1e3,
        ),
        format!(
            "pooled hold {four_steps:.1} % for the four steps and {fit:.1} % ({fit_low:.1} to {fit_high:.1} %) for the joint fit"
        ),
        format!("products of inertia, of which {product_low:.0} to {product_high:.0} % are held"),
        format!(
            "is determined by step 4 in {} of {} (",
            mujoco["summary"]["step_4"]["determined"]
                .as_u64()
                .unwrap_or(0),
            mujoco["summary"]["cases"]
        ),
    ] {
        assert!(
            docs.contains(&sentence),
            "docs/campaigns.md has not: {sentence}"
        );
    }
    let sentence = format!(
        "hold {drift_low:.0} % of the drifts, all scale factors and {inertia_low:.0} to {inertia_high:.0} % of the inertias"
    );
    assert!(
        of_session.contains(&sentence),
        "docs/session.md has not: {sentence}"
    );
}
