//! The stages of conditioning and their one order, of which the whole-record conditioning, its transpose, the stream and the
//! calibration's page are made.

/// One thing that is done to the channels of a recording before anything is computed from them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Limbs' channels that were sampled late or early, and standards with a delay, are brought onto one clock.
    Delays,
    /// Wild samples are replaced.
    Outliers,
    /// The amplifiers' first-order high-pass is undone.
    HighPass,
    /// A straight line between the rests is taken off.
    Trend,
    /// Zero-phase low-pass.
    LowPass,
    /// The accelerometer's first-order lag is undone.
    AccelerometerLag,
    /// The gyroscope's first-order lag is undone.
    GyroscopeLag,
    /// The gyroscope's rate is differentiated.
    Derivative,
}

impl Stage {
    /// All stages in the order in which they run:
    ///
    /// 1. Delays, when the recording is read: whatever follows needs all channels on one clock, the joint fit too, which takes
    ///    voltages that no other stage has touched.
    /// 2. Outliers before every filter: a filter spreads one wild value over its whole response, and the integral that undoes a
    ///    high-pass keeps it until the end of the run.
    /// 3. The amplifiers' high-pass before the trend, on the limbs' voltages alone, which are what the amplifiers pass: undoing it
    ///    turns an error of the baseline into a slope, which the trend takes off.
    /// 4. The trend before the low-pass, which answers an offset with a transient at both ends of the run.
    /// 5. The low-pass on limbs and standards alike, so that what it takes off is the same on both sides of every equation.
    /// 6. The standards' lags after it: undoing a lag raises noise in proportion to its frequency.
    pub const ORDER: [Self; 8] = [
        Self::Delays,
        Self::Outliers,
        Self::HighPass,
        Self::Trend,
        Self::LowPass,
        Self::AccelerometerLag,
        Self::GyroscopeLag,
        Self::Derivative,
    ];

    /// The name in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Delays => "channel delays",
            Self::Outliers => "outliers",
            Self::HighPass => "amplifier's high-pass",
            Self::Trend => "trend",
            Self::LowPass => "low-pass",
            Self::AccelerometerLag => "accelerometer's lag",
            Self::GyroscopeLag => "gyroscope's lag",
            Self::Derivative => "differentiator of the gyroscope",
        }
    }

    /// The channels that pass through it.
    pub const fn channels(self) -> &'static str {
        match self {
            Self::HighPass => "limbs",
            Self::Delays | Self::Outliers | Self::Trend | Self::LowPass => "limbs and standards",
            Self::AccelerometerLag => "accelerometer",
            Self::GyroscopeLag | Self::Derivative => "gyroscope",
        }
    }
}
