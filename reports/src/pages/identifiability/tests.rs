//! What must hold of whatever is published: it reads, it is whole, and it is of the parameters that the study has.

use sixaxis_core::Parameter;

use super::*;

#[test]
fn inv_published_results_are_of_the_25() {
    let campaign = published::campaign().expect("props/results/campaign.json");
    let propagation = published::propagation().expect("props/results/propagation.json");
    let of_campaign: Vec<Parameter> = campaign.parameters.iter().map(|p| p.parameter).collect();
    assert_eq!(of_campaign, Parameter::all().collect::<Vec<_>>());
    // A campaign has the stiffness, a fit its reciprocal.
    let fitted: Vec<Parameter> = Parameter::all().map(Parameter::estimated).collect();
    for set in &propagation.sets {
        let of_set: Vec<Parameter> = set.parameters.iter().map(|p| p.parameter).collect();
        assert_eq!(of_set, fitted);
    }
}

#[test]
fn inv_published_campaign_has_what_the_page_shows() {
    let campaign = published::campaign().expect("props/results/campaign.json");
    let (_, known) = campaign.parameters.split_last().expect("25 parameters");
    for p in known {
        let joint = p.joint.as_ref().expect("a joint fit");
        let told = p.joint_gain_known.as_ref().expect("a bound");
        for share in [
            joint.within_stated_95.expect("coverage").value,
            p.four_steps.within_stated_95.expect("coverage").value,
        ] {
            assert!((0.0..=1.0).contains(&share), "{}", p.parameter);
        }
        assert!(
            told.variance_over_stated.is_some_and(|v| v > 0.0),
            "{}",
            p.parameter
        );
    }
}

#[test]
fn inv_published_sets_share_their_bands() {
    let propagation = published::propagation().expect("props/results/propagation.json");
    let edges = |set: &published::Set| -> Vec<f64> {
        set.by_attitude.iter().map(|band| band.below_rad).collect()
    };
    for set in &propagation.sets {
        assert_eq!(edges(set), edges(&propagation.sets[0]));
    }
}
