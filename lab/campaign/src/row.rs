//! What is kept of one calibration: the schema of the shards.

use sixaxis_core::Parameter;
use sixaxis_core::parameter::PARAMETERS;

/// An enum of things that have a name in the file: all of them in the order of their columns, each with its name.
macro_rules! named {
    ($(#[$about:meta])* $name:ident { $($(#[$of:meta])* $variant:ident => $text:literal,)* }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[repr(usize)]
        pub enum $name {
            $($(#[$of])* $variant,)*
        }

        impl $name {
            /// All, in the order of their columns.
            pub const ALL: [Self; [$($text),*].len()] = [$(Self::$variant),*];

            /// The name in the file.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $text,)*
                }
            }
        }
    };
}

named! {
    /// A quantity that each of the 25 parameters has one of, in the parameter's unit; the name is what its columns begin with.
    Group {
        /// The sensor's own value, which the calibration does not see.
        Truth => "true",
        /// Estimate of the four steps. For k/m the minimum of the grid, whatever step 4's verdict.
        FourSteps => "four_steps",
        /// Its standard error from noise alone, carried from the raw samples through all steps in closed form. k/m has none.
        FourStepsStandardError => "four_steps_se",
        /// Half width of the 95 % interval that `sixaxis calibrate` states: noise, differences between trials, standards' classes.
        StatedHalfWidth => "half_width_95",
        /// Estimate of the joint fit of all parameters; none of k/m where the fit leaves it open.
        Joint => "joint",
        /// Its standard deviation, the certificate of the accelerometer included.
        JointStandardError => "joint_se",
        /// Lower end of its 95 % interval.
        JointLow => "joint_low_95",
        /// Upper end of it.
        JointHigh => "joint_high_95",
        /// What the joint fit finds when it is told the accelerometer's gain, which no trial knows unless gravity turns in the
        /// sensor: what is left is noise, and the bound is one on noise. For the statistics alone; a laboratory cannot have it.
        JointGainKnown => "joint_gain_known",
        /// Cramér-Rao bound with the accelerometer's gain known, as a standard deviation.
        CramerRao => "cramer_rao_sd",
    }
}

named! {
    /// Single numbers of a case.
    Scalar {
        /// Squared residuals of the joint fit per degree of freedom: 1 where model and noise are right.
        JointMisfit => "joint_misfit",
        /// True relative gain error of the standard accelerometer.
        AccelerometerGainError => "true_accelerometer_gain_error",
        /// True relative gain error of the standard gyroscope.
        GyroscopeGainError => "true_gyroscope_gain_error",
        /// True rate over the gyroscope's reading as step 3 took it.
        RateOverReading => "four_steps_rate_over_reading",
        /// Its standard error.
        RateOverReadingStandardError => "four_steps_se_rate_over_reading",
    }
}

named! {
    /// How far a case got.
    Status {
        /// All four steps were done.
        Calibrated => "calibrated",
        /// The plan with this seed cannot be played.
        NotPlayed => "not_played",
        /// A recording cannot be conditioned.
        NotCleaned => "not_cleaned",
        /// One of the four steps refuses its data.
        NotIdentified => "not_identified",
    }
}

named! {
    /// Columns of text.
    Text {
        /// [`Status::name`].
        Status => "status",
        /// Why a case failed.
        Failure => "failure",
        /// What was wrong with the session, where the plan has defects.
        Defect => "defect",
        /// Why there is no joint fit, where the four steps were done.
        JointFailure => "joint_failure",
        /// Whether step 4 determines k/m: `determined`, or why not: `edge_of_grid`, `flat`, `noise`.
        Step4 => "step_4",
    }
}

/// One of each parameter, where there is one.
pub type Values = [Option<f64>; PARAMETERS];

/// One case. What took how long is not in it: the same seed gives the same row, bit for bit on one kind of processor.
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
    pub fn new(seed: u64, status: Status) -> Self {
        let mut row = Self::blank(seed);
        row.set_text(Text::Status, status.name());
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
    pub fn status(&self) -> Option<Status> {
        let word = self.text(Text::Status)?;
        Status::ALL.into_iter().find(|status| status.name() == word)
    }

    /// A text.
    pub fn text(&self, text: Text) -> Option<&str> {
        self.texts[text as usize].as_deref()
    }

    /// A number.
    pub const fn scalar(&self, scalar: Scalar) -> Option<f64> {
        self.scalars[scalar as usize]
    }

    /// One of each parameter.
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
    format!("{}_{letter}{number}_{unit}", group.name())
}
