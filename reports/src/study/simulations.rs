//! All of MuJoCo's work, in parallel: every run is independent of every other.

use anyhow::{Context, Result};
use glam::DVec3;
use rayon::prelude::*;
use sixaxis_recordings::session::Role;
use sixaxis_reference::laboratory::plan::RigPlan;
use sixaxis_reference::laboratory::schedule::{PlannedTrial, compound_trials, trials};
use sixaxis_reference::motion::SimulatedRun;
use sixaxis_reference::mujoco::model::SensorModel;
use sixaxis_reference::mujoco::ring_down::{self, RingDown};
use sixaxis_reference::mujoco::simulate_run;
use sixaxis_reference::mujoco::threshold::{self, SweepPoint};
use sixaxis_reference::rig::run::{Mode, Mounting};
use sixaxis_reference::sensor::TrueSensor;

use super::Progress;
use super::plan::{
    CAMPAIGN_RATE_HZ, CAMPAIGN_STEPS, COMPOUND_RATE_HZ, COMPOUND_STEPS, Plan, SWEEP_STEP_S,
};

/// Everything that was simulated.
pub struct Simulations {
    /// Steps 2 to 4 at the campaign's step, in the plan's order.
    pub campaign: Vec<(PlannedTrial, SimulatedRun)>,
    /// The same at twice the step; empty if not asked for.
    pub campaign_coarse: Vec<(PlannedTrial, SimulatedRun)>,
    /// Tables 4 to 6 at the compound step.
    pub compound: Vec<SimulatedRun>,
    /// The same at half the step; empty if not asked for.
    pub compound_halved: Vec<SimulatedRun>,
    /// Tables 4 to 6 with the axis level.
    pub axis_level: Vec<SimulatedRun>,
    /// The same at half the step.
    pub axis_level_halved: Vec<SimulatedRun>,
    /// Fig. 7: design linear, design angular, identified linear, identified angular.
    pub sweeps: [Vec<SweepPoint>; 4],
    /// Ring-downs of the design sensor and of the identified one.
    pub ring_downs: [[RingDown; 6]; 2],
}

/// The four sweeps of Fig. 7 in the order of [`Simulations::sweeps`].
pub fn sweep_kinds() -> [(&'static str, TrueSensor, Mode); 4] {
    let design = TrueSensor::design();
    let identified = TrueSensor::identified();
    [
        ("design", design, Mode::Linear),
        ("design", design, Mode::Angular),
        ("identified", identified, Mode::Linear),
        ("identified", identified, Mode::Angular),
    ]
}

enum Task {
    Run {
        list: List,
        trial: PlannedTrial,
        rate_hz: f64,
        steps: usize,
    },
    Sweep {
        kind: usize,
        frequency_hz: f64,
    },
    RingDown {
        sensor: usize,
    },
}

#[derive(Clone, Copy, PartialEq)]
enum List {
    Campaign,
    CampaignCoarse,
    Compound,
    CompoundHalved,
    AxisLevel,
    AxisLevelHalved,
}

enum Outcome {
    Run(SimulatedRun),
    Sweep(SweepPoint),
    RingDown([RingDown; 6]),
}

impl Task {
    /// Runge-Kutta steps, the unit of work.
    fn steps(&self) -> u64 {
        match self {
            Self::Run {
                trial,
                rate_hz,
                steps,
                ..
            } => (trial.run.duration_s() * rate_hz) as u64 * *steps as u64,
            Self::Sweep { frequency_hz, .. } => (1.6 / frequency_hz / SWEEP_STEP_S) as u64,
            Self::RingDown { .. } => 6 * 2_000,
        }
    }

    fn run(&self) -> Result<Outcome> {
        match self {
            Self::Run {
                trial,
                rate_hz,
                steps,
                ..
            } => {
                let sensor = TrueSensor::identified();
                let model = SensorModel::new(&sensor, trial.gravity_ground_m_s2());
                simulate_run(&model, &trial.run, *rate_hz, *steps)
                    .map(Outcome::Run)
                    .with_context(|| {
                        format!("{:?} run at {} Hz", trial.role, trial.run.frequency_hz)
                    })
            }
            Self::Sweep { kind, frequency_hz } => {
                let (_, sensor, mode) = sweep_kinds()[*kind];
                let run = threshold::excitation(mode, *frequency_hz);
                let gravity = Mounting::AxisVertical.gravity_ground_m_s2(run.direction_ground);
                let model = SensorModel::new(&sensor, gravity);
                threshold::measure(&model, &run, SWEEP_STEP_S)
                    .map(Outcome::Sweep)
                    .with_context(|| format!("threshold sweep at {frequency_hz} Hz"))
            }
            Self::RingDown { sensor } => {
                let sensor = if *sensor == 0 {
                    TrueSensor::design()
                } else {
                    TrueSensor::identified()
                };
                ring_down::measure(&SensorModel::new(&sensor, DVec3::ZERO))
                    .map(Outcome::RingDown)
                    .context("ring-down")
            }
        }
    }
}

fn tasks(plan: &Plan) -> Vec<Task> {
    let mut tasks = Vec::new();
    let mut run = |list, trial, rate_hz, steps| {
        tasks.push(Task::Run {
            list,
            trial,
            rate_hz,
            steps,
        });
    };
    let upright = RigPlan::one_turn(Mounting::AxisVertical);
    for trial in trials(&upright, plan.trials_per_step(), None) {
        if trial.role == Role::Validation {
            run(
                List::Compound,
                trial.clone(),
                COMPOUND_RATE_HZ,
                COMPOUND_STEPS,
            );
            run(
                List::CompoundHalved,
                trial,
                COMPOUND_RATE_HZ,
                2 * COMPOUND_STEPS,
            );
        } else {
            run(
                List::Campaign,
                trial.clone(),
                CAMPAIGN_RATE_HZ,
                plan.campaign_steps(),
            );
            if plan.checks_campaign_step() {
                run(
                    List::CampaignCoarse,
                    trial,
                    CAMPAIGN_RATE_HZ,
                    CAMPAIGN_STEPS / 2,
                );
            }
        }
    }
    for trial in compound_trials(&RigPlan::one_turn(Mounting::AxisLevel)) {
        // The slower runs cost seven times the fastest; a quick look goes without them.
        if plan.quick && trial.run.frequency_hz < 4.0 {
            continue;
        }
        run(
            List::AxisLevel,
            trial.clone(),
            COMPOUND_RATE_HZ,
            COMPOUND_STEPS,
        );
        run(
            List::AxisLevelHalved,
            trial,
            COMPOUND_RATE_HZ,
            2 * COMPOUND_STEPS,
        );
    }
    for kind in 0..sweep_kinds().len() {
        for frequency_hz in plan.sweep_frequencies_hz() {
            tasks.push(Task::Sweep { kind, frequency_hz });
        }
    }
    tasks.extend([Task::RingDown { sensor: 0 }, Task::RingDown { sensor: 1 }]);
    tasks
}

/// Simulates everything the plan needs.
///
/// # Errors
/// The first simulation that fails, by name.
pub fn simulate(plan: &Plan, progress: &Progress<'_>) -> Result<Simulations> {
    run_all(tasks(plan), progress)
}

/// Simulates only what a laboratory records: the trials of the steps, and the compound runs of Tables 4 to 6 at the usual step.
///
/// # Errors
/// Those of [`simulate`].
pub fn simulate_recorded(plan: &Plan, progress: &Progress<'_>) -> Result<Simulations> {
    let recorded = |task: &Task| match task {
        Task::Run { list, .. } => matches!(list, List::Campaign | List::Compound),
        Task::Sweep { .. } | Task::RingDown { .. } => false,
    };
    let tasks = tasks(plan).into_iter().filter(recorded).collect();
    run_all(tasks, progress)
}

fn run_all(mut tasks: Vec<Task>, progress: &Progress<'_>) -> Result<Simulations> {
    // Longest first, each to the thread that is free next, so that none is left alone with a long run at the end.
    tasks.sort_by_key(|task| core::cmp::Reverse(task.steps()));
    let total = tasks.iter().map(Task::steps).sum();
    let mut outcomes = tasks
        .iter()
        .enumerate()
        .par_bridge()
        .map(|(place, task)| {
            let outcome = task.run()?;
            progress("MuJoCo", total, task.steps());
            Ok((place, outcome))
        })
        .collect::<Result<Vec<_>>>()?;
    outcomes.sort_by_key(|(place, _)| *place);

    let mut result = Simulations {
        campaign: Vec::new(),
        campaign_coarse: Vec::new(),
        compound: Vec::new(),
        compound_halved: Vec::new(),
        axis_level: Vec::new(),
        axis_level_halved: Vec::new(),
        sweeps: Default::default(),
        ring_downs: [[RingDown {
            predicted_hz: f64::NAN,
            measured_hz: f64::NAN,
        }; 6]; 2],
    };
    for (task, (_, outcome)) in tasks.iter().zip(outcomes) {
        match (task, outcome) {
            (Task::Run { list, trial, .. }, Outcome::Run(run)) => match list {
                List::Campaign => result.campaign.push((trial.clone(), run)),
                List::CampaignCoarse => result.campaign_coarse.push((trial.clone(), run)),
                List::Compound => result.compound.push(run),
                List::CompoundHalved => result.compound_halved.push(run),
                List::AxisLevel => result.axis_level.push(run),
                List::AxisLevelHalved => result.axis_level_halved.push(run),
            },
            (Task::Sweep { kind, .. }, Outcome::Sweep(point)) => result.sweeps[*kind].push(point),
            (Task::RingDown { sensor }, Outcome::RingDown(modes)) => {
                result.ring_downs[*sensor] = modes;
            }
            _ => {}
        }
    }
    // The tasks ran longest first; put them back in the order in which people read.
    let by_role = |a: &(PlannedTrial, SimulatedRun), b: &(PlannedTrial, SimulatedRun)| {
        (a.0.role.cmp(&b.0.role)).then(a.0.run.frequency_hz.total_cmp(&b.0.run.frequency_hz))
    };
    result.campaign.sort_by(by_role);
    result.campaign_coarse.sort_by(by_role);
    for list in [
        &mut result.compound,
        &mut result.compound_halved,
        &mut result.axis_level,
        &mut result.axis_level_halved,
    ] {
        list.sort_by(|a, b| a.motion.frequency_hz.total_cmp(&b.motion.frequency_hz));
    }
    for sweep in &mut result.sweeps {
        sweep.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    }
    Ok(result)
}
