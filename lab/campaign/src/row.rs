//! What is kept of one calibration: the schema of the shards.

use sixaxis_core::Parameter;
use sixaxis_core::parameter::PARAMETERS;

/// A quantity that each of the 25 parameters has one of, in the parameter's unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
pub enum Group {
    /// The sensor's own value, which the calibration does not see.
    Truth,
    /// Estimate of the four steps. For k/m the minimum of the grid, whatever step 4's verdict.
    FourSteps,
    /// Its standard error from noise alone, carried from the raw samples through all steps in closed form. k/m has none.
    FourStepsStandardError,
    /// Half width of the 95 % interval that `sixaxis calibrate` states: noise, differences between trials, standards' classes.
    StatedHalfWidth,
    /// Estimate of the joint fit of all parameters; none of k/m where the fit leaves it open.
    Joint,
    /// Its standard deviation, the certificate of the accelerometer included.
    JointStandardError,
    /// Lower end of its 95 % interval.
    JointLow,
    /// Upper end of it.
    JointHigh,
    /// What the joint fit finds when it is told the accelerometer's gain, which no trial knows unless gravity turns in the
    /// sensor: what is left is noise, and the bound is one on noise. For the statistics alone; a laboratory cannot have it.
    JointGainKnown,
    /// Cramér-Rao bound with the accelerometer's gain known, as a standard deviation.
    CramerRao,
}

impl Group {
    /// All, in the order of their columns.
    pub const ALL: [Self; 10] = [
        Self::Truth,
        Self::FourSteps,
        Self::FourStepsStandardError,
        Self::StatedHalfWidth,
        Self::Joint,
        Self::JointStandardError,
        Self::JointLow,
        Self::JointHigh,
        Self::JointGainKnown,
        Self::CramerRao,
    ];

    /// What its columns' names begin with.
    #[must_use]
    pub const fn prefix(self) -> &'static str {
        match self {
            Self::Truth => "true",
            Self::FourSteps => "four_steps",
            Self::FourStepsStandardError => "four_steps_se",
            Self::StatedHalfWidth => "half_width_95",
            Self::Joint => "joint",
            Self::JointStandardError => "joint_se",
            Self::JointLow => "joint_low_95",
            Self::JointHigh => "joint_high_95",
            Self::JointGainKnown => "joint_gain_known",
            Self::CramerRao => "cramer_rao_sd",
        }
    }
}

/// Single numbers of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
pub enum Scalar {
    /// Squared residuals of the joint fit per degree of freedom: 1 where model and noise are right.
    JointMisfit,
    /// True relative gain error of the standard accelerometer.
    AccelerometerGainError,
    /// True relative gain error of the standard gyroscope.
    GyroscopeGainError,
    /// True rate over the gyroscope's reading as step 3 took it.
    RateOverReading,
    /// Its standard error.
    RateOverReadingStandardError,
}

impl Scalar {
    /// All, in the order of their columns.
    pub const ALL: [Self; 5] = [
        Self::JointMisfit,
        Self::AccelerometerGainError,
        Self::GyroscopeGainError,
        Self::RateOverReading,
        Self::RateOverReadingStandardError,
    ];

    /// Name of its column.
    #[must_use]
    pub const fn column(self) -> &'static str {
        match self {
            Self::JointMisfit => "joint_misfit",
            Self::AccelerometerGainError => "true_accelerometer_gain_error",
            Self::GyroscopeGainError => "true_gyroscope_gain_error",
            Self::RateOverReading => "four_steps_rate_over_reading",
            Self::RateOverReadingStandardError => "four_steps_se_rate_over_reading",
        }
    }
}

/// How far a case got.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// All four steps were done.
    Calibrated,
    /// The plan with this seed cannot be played.
    NotPlayed,
    /// A recording cannot be conditioned.
    NotCleaned,
    /// One of the four steps refuses its data.
    NotIdentified,
}

impl Status {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::Calibrated,
        Self::NotPlayed,
        Self::NotCleaned,
        Self::NotIdentified,
    ];

    /// The word in the column `status`.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Calibrated => "calibrated",
            Self::NotPlayed => "not_played",
            Self::NotCleaned => "not_cleaned",
            Self::NotIdentified => "not_identified",
        }
    }
}

/// Columns of text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
pub enum Text {
    /// [`Status::word`].
    Status,
    /// Why a case failed.
    Failure,
    /// What was wrong with the session, where the plan has defects.
    Defect,
    /// Why there is no joint fit, where the four steps were done.
    JointFailure,
    /// Whether step 4 determines k/m: `determined`, or why not: `edge_of_grid`, `flat`, `noise`.
    Step4,
}

impl Text {
    /// All, in the order of their columns.
    pub const ALL: [Self; 5] = [
        Self::Status,
        Self::Failure,
        Self::Defect,
        Self::JointFailure,
        Self::Step4,
    ];

    /// Name of its column.
    #[must_use]
    pub const fn column(self) -> &'static str {
        match self {
            Self::Status => "status",
            Self::Failure => "failure",
            Self::Defect => "defect",
            Self::JointFailure => "joint_failure",
            Self::Step4 => "step_4",
        }
    }
}

/// One of each parameter, where there is one.
pub type Values = [Option<f64>; PARAMETERS];

/// One case. What took how long is not in it: the same seed gives the same row, bit for bit.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The case.
    pub seed: u64,
    /// Indexed by [`Text`].
    pub texts: [Option<String>; Text::ALL.len()],
    /// Indexed by [`Scalar`].
    pub scalars: [Option<f64>; Scalar::ALL.len()],
    /// Indexed by [`Group`].
    pub groups: [Values; Group::ALL.len()],
}

impl Row {
    /// A case of which nothing is known but how far it got.
    #[must_use]
    pub fn new(seed: u64, status: Status) -> Self {
        let mut row = Self::blank(seed);
        row.set_text(Text::Status, status.word());
        row
    }

    /// A case of which nothing is known.
    pub(crate) fn blank(seed: u64) -> Self {
        Self {
            seed,
            texts: Default::default(),
            scalars: Default::default(),
            groups: [[None; PARAMETERS]; Group::ALL.len()],
        }
    }

    /// How far it got; none for a word that no version of this program writes.
    #[must_use]
    pub fn status(&self) -> Option<Status> {
        let word = self.text(Text::Status)?;
        Status::ALL.into_iter().find(|status| status.word() == word)
    }

    /// A text.
    #[must_use]
    pub fn text(&self, text: Text) -> Option<&str> {
        self.texts[text as usize].as_deref()
    }

    /// A number.
    #[must_use]
    pub const fn scalar(&self, scalar: Scalar) -> Option<f64> {
        self.scalars[scalar as usize]
    }

    /// One of each parameter.
    #[must_use]
    pub const fn group(&self, group: Group) -> &Values {
        &self.groups[group as usize]
    }

    /// Sets a text.
    pub fn set_text(&mut self, text: Text, value: impl Into<String>) {
        self.texts[text as usize] = Some(value.into());
    }

    /// Sets a number.
    pub fn set_scalar(&mut self, scalar: Scalar, value: f64) {
        self.scalars[scalar as usize] = Some(value);
    }

    /// Sets one of each parameter.
    pub fn set_group(&mut self, group: Group, values: Values) {
        self.groups[group as usize] = values;
    }
}

/// Name of the column of one quantity of one parameter, such as `four_steps_s1_per_kg`.
#[must_use]
pub fn column(group: Group, parameter: Parameter) -> String {
    let letter = parameter.symbol().to_ascii_lowercase();
    let number = parameter
        .number()
        .map_or_else(String::new, |number| number.to_string());
    let unit = match parameter {
        Parameter::Drift(_) => "v",
        Parameter::Scale(_) => "per_kg",
        Parameter::Inertia(_) => "m2",
        Parameter::Stiffness => "per_s2",
        Parameter::Compliance => "s2",
    };
    format!("{}_{letter}{number}_{unit}", group.prefix())
}
