//! What a picture of an answer needs, whatever its length.

use sixaxis_recordings::envelope::Envelope;

/// Six accelerations over time, for a picture, m/s^2 and rad/s^2.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Curves {
    /// The answers.
    pub accelerations: [Envelope; 6],
    /// How well each is known, where deviations are written.
    pub bands: Option<[Band; 6]>,
}

/// How well an acceleration is known over time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Band {
    /// One standard deviation below it and above it.
    pub edges: [Envelope; 2],
    /// One standard deviation.
    pub deviation: Envelope,
}

impl Curves {
    /// Takes the next rows: accelerations by themselves or with their deviations.
    pub(super) fn extend(
        &mut self,
        times_s: &[f64],
        accelerations: &[Vec<f64>],
        deviations: &[Vec<f64>],
    ) {
        for (envelope, column) in self.accelerations.iter_mut().zip(accelerations) {
            for (time_s, value) in times_s.iter().zip(column) {
                envelope.push(*time_s, *value);
            }
        }
        if deviations.is_empty() {
            return;
        }
        let bands = self.bands.get_or_insert_default();
        let columns = accelerations.iter().zip(deviations);
        for (band, (values, deviations)) in bands.iter_mut().zip(columns) {
            for ((time_s, value), deviation) in times_s.iter().zip(values).zip(deviations) {
                let [below, above] = &mut band.edges;
                below.push(*time_s, value - deviation);
                above.push(*time_s, value + deviation);
                band.deviation.push(*time_s, *deviation);
            }
        }
    }
}
