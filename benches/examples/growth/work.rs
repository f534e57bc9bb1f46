//! One measurement: work of one kind and size in this process, its answer counted.

use std::error::Error;
use std::fs;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use glam::DVec3;
use sixaxis_benches::machine::{peak_memory_bytes, processor_s};
use sixaxis_calibration::apply::columns::Columns;
use sixaxis_calibration::apply::job::Job;
use sixaxis_calibration::apply::setup::{Overrides, Setup};
use sixaxis_calibration::calibrate::{Options, calibrate};
use sixaxis_calibration::calibration::Calibration;
use sixaxis_calibration::progress::NoProgress;
use sixaxis_calibration::report::{Estimator, Grade};
use sixaxis_campaign::plan::{CampaignPlan, Shard};
use sixaxis_campaign::run::{Order, Watch, run};
use sixaxis_core::decouple::lanes::push_lanes;
use sixaxis_core::kernel::simd::LANES;
use sixaxis_core::{Decoupler, LIMBS, LimbSet};
use sixaxis_props::results::Work;
use sixaxis_recordings::session::SessionFile;

use crate::Measured;
use crate::given::{
    LONG_SCHEME, Motion, STREAM_SAMPLES, calibration_file, campaign_plan, motion_file,
    recording_file, session_folder,
};

type Voltages = [f64; LIMBS];

/// Processor time is counted in steps of 10 ms: short work is repeated for so long, s.
const LEAST_S: f64 = 0.5;
/// Where each stream begins in the run, samples after the one before.
const STRIDE: usize = 97;

/// Does it.
pub fn measured(work: Work, size: u64, folder: &Path) -> Result<Measured, Box<dyn Error>> {
    match work {
        Work::Decouple => decouple(size, folder),
        Work::PushRecord => push_record(size as usize, folder),
        Work::PushLanes => lanes(size as usize, folder),
        Work::Calibrate => calibrated(size as usize, folder),
        Work::Campaign => campaign(size, folder),
    }
}

/// Repeats work until it has lasted long enough, and says what one repetition took.
fn repeated(
    mut once: impl FnMut() -> Result<(), Box<dyn Error>>,
) -> Result<Measured, Box<dyn Error>> {
    let processor = || processor_s().ok_or("the system does not state processor time");
    let (start, before) = (Instant::now(), processor()?);
    let mut times = 0.0;
    while times == 0.0 || start.elapsed().as_secs_f64() < LEAST_S {
        once()?;
        times += 1.0;
    }
    Ok(Measured {
        processor_s: (processor()? - before) / times,
        wall_s: start.elapsed().as_secs_f64() / times,
        peak_memory_bytes: peak_memory_bytes().ok_or("the system does not state memory")?,
    })
}

fn refuse_unless(right: bool, what: impl FnOnce() -> String) -> Result<(), Box<dyn Error>> {
    if right { Ok(()) } else { Err(what().into()) }
}

/// What the calibration and the parent say of the recordings.
fn setup(
    calibration: &Calibration,
    gravity_ground_m_s2: [f64; 3],
) -> Result<Setup, Box<dyn Error>> {
    let overrides = Overrides {
        gain_n_per_v: calibration.sensor.gain_n_per_v.to_vec(),
        ..Overrides::default()
    };
    let mut setup = Setup::new(calibration, None, None, &overrides)?;
    setup.gravity_ground_m_s2 = DVec3::from_array(gravity_ground_m_s2);
    Ok(setup)
}

fn decouple(samples: u64, folder: &Path) -> Result<Measured, Box<dyn Error>> {
    let calibration_name = calibration_file(folder);
    let calibration = Calibration::read(&calibration_name)?;
    let setup = setup(&calibration, motion(folder)?.gravity_ground_m_s2)?;
    let job = Job {
        calibration: &calibration,
        calibration_name: &calibration_name,
        setup: &setup,
        columns: Columns::MOTION,
        scheme: LONG_SCHEME,
        rest_to_rest: false,
        uncertainty: false,
        false_alarms_per_hour: None,
        excluded: LimbSet::EMPTY,
        // An hour of open loop is asked for, however little its attitude is known.
        until_sd_deg: f64::INFINITY,
        aids: &[],
        smooth: false,
        picture: false,
    };
    let out = folder.join("decoupled.parquet");
    let measured = repeated(|| {
        let done = job.run(
            &recording_file(folder),
            &|layout| Ok(sixaxis_recordings::create(&out, layout)?),
            &|_, _| {},
        )?;
        refuse_unless(done.rows + 2 == samples && done.warnings.is_empty(), || {
            format!(
                "{} rows of {samples} samples, {:?}",
                done.rows, done.warnings
            )
        })
    })?;
    fs::remove_file(out)?;
    Ok(measured)
}

fn motion(folder: &Path) -> Result<Motion, Box<dyn Error>> {
    Ok(serde_json::from_slice(&fs::read(motion_file(folder))?)?)
}

/// A decoupler ready for the first sample of the run.
fn ready(motion: &Motion, folder: &Path) -> Result<Decoupler, Box<dyn Error>> {
    let calibration = Calibration::read(&calibration_file(folder))?;
    let setup = setup(&calibration, motion.gravity_ground_m_s2)?;
    let settings = setup.settings(motion.sample_rate_hz, LONG_SCHEME);
    Ok(Decoupler::new(&setup.sensor, &setup.parameters, &settings)?)
}

fn record(ready: &Decoupler, rows: &[Voltages]) -> Result<(), Box<dyn Error>> {
    let mut answers = 0;
    ready.clone().push_record(rows, &mut |done| {
        answers += black_box(done).len();
    })?;
    refuse_unless(answers + 2 == rows.len(), || {
        format!("{answers} answers of {} samples", rows.len())
    })
}

fn push_record(samples: usize, folder: &Path) -> Result<Measured, Box<dyn Error>> {
    let motion = motion(folder)?;
    let ready = ready(&motion, folder)?;
    let rows: Vec<Voltages> = motion
        .voltage_v
        .iter()
        .cycle()
        .take(samples)
        .copied()
        .collect();
    repeated(|| record(&ready, black_box(&rows)))
}

fn lanes(streams: usize, folder: &Path) -> Result<Measured, Box<dyn Error>> {
    let motion = motion(folder)?;
    let ready = ready(&motion, folder)?;
    let run = &motion.voltage_v;
    let starts = run.len() - STREAM_SAMPLES;
    let rows: Vec<Voltages> = (0..streams)
        .flat_map(|i| &run[i * STRIDE % starts..][..STREAM_SAMPLES])
        .copied()
        .collect();
    let each: Vec<&[Voltages]> = rows.chunks_exact(STREAM_SAMPLES).collect();
    let (eights, rest) = each.as_chunks::<LANES>();
    repeated(|| {
        for rows in black_box(eights) {
            let mut streams = core::array::from_fn(|_| ready.clone());
            let mut answers = 0;
            push_lanes(&mut streams, *rows, &mut |samples| {
                answers += black_box(samples).len();
            })?;
            refuse_unless(answers + 2 == STREAM_SAMPLES, || {
                format!("{answers} answers of {STREAM_SAMPLES} samples in lanes")
            })?;
        }
        rest.iter().try_for_each(|rows| record(&ready, rows))
    })
}

fn calibrated(trials: usize, folder: &Path) -> Result<Measured, Box<dyn Error>> {
    let options = Options {
        estimator: Some(Estimator::Joint),
        ..Options::default()
    };
    let path = session_folder(folder).join("session.toml");
    repeated(|| {
        let file = SessionFile::read(&path)?;
        let done = black_box(calibrate(&file, &options, &NoProgress)?);
        let joint = matches!(done.joint, Some(Ok(_)));
        let right = joint && done.grade != Grade::Bad && done.trials.len() >= trials;
        refuse_unless(right, || format!("{}: {:?}", done.sentence, done.findings))
    })
}

/// Nobody watches.
struct Silent;

impl Watch for Silent {
    fn begins(&self, _: u64, _: u64) {}
    fn case(&self) {}
    fn set_aside(&self, _: &Path, _: &Path, _: &str) {}
}

fn campaign(cases: u64, folder: &Path) -> Result<Measured, Box<dyn Error>> {
    let plan = CampaignPlan::new(&campaign_plan(), 1, cases)?;
    let out = folder.join("campaign");
    repeated(|| {
        let done = run(
            &Order {
                plan: &plan,
                shard: Shard::WHOLE,
                folder: &out,
                threads: 0,
            },
            &Silent,
        )?;
        fs::remove_dir_all(&out)?;
        refuse_unless(done.cases == cases && done.failed == 0, || {
            format!("{done:?}")
        })
    })
}
