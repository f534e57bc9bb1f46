//! Whether a recording's mean acceleration can be that of a motion: over some seconds, what moves and does not fly stays about where
//! it is, and gravity taken off the wrong way does not.

use glam::DVec3;

/// Shortest time that is judged, s: a throw is over by then.
const SHORTEST_S: f64 = 2.0;
/// Mean acceleration of no motion, m/s^2. A tumble with the direction of gravity inverted has 17 to 23 (three tumbles), and 0.3 to 0.4
/// with it as it is; 3 to 7 where a limb has drifted by 0.3 %.
const LARGEST_M_S2: f64 = 5.0;
/// Velocity that it must end at besides, m/s: 90 km/h.
const FASTEST_M_S: f64 = 25.0;

/// Mean of the acceleration in ground axes, where it is known.
#[derive(Debug, Clone, Copy, Default)]
pub struct MeanAcceleration {
    sum_m_s2: DVec3,
    rows: u64,
}

impl MeanAcceleration {
    /// Takes three columns, m/s^2, of which rows that are not known are NaN.
    pub fn look(&mut self, ground: [&[f64]; 3]) {
        let [x, y, z] = ground;
        for ((x, y), z) in x.iter().zip(y).zip(z) {
            let row = DVec3::new(*x, *y, *z);
            if row.is_finite() {
                self.sum_m_s2 += row;
                self.rows += 1;
            }
        }
    }

    /// What to check, if it is no motion's; `down_is_stated` unless gravity is taken not to turn.
    pub fn verdict(&self, sample_rate_hz: f64, down_is_stated: bool) -> Option<String> {
        let duration_s = self.rows as f64 / sample_rate_hz;
        let mean_m_s2 = self.sum_m_s2.length() / self.rows as f64;
        let check = if down_is_stated {
            "is the direction of gravity inverted (--down is where it pulls, 0,0,-1 with z up), are gains or the unit another recording's, has a limb drifted (self-calibrate), or has the attitude been lost, which an open loop holds for seconds?"
        } else {
            "gravity turned in the sensor and nobody says where down is: give --down or --session"
        };
        let flies = mean_m_s2 > LARGEST_M_S2 && mean_m_s2 * duration_s > FASTEST_M_S;
        (duration_s > SHORTEST_S && flies).then(|| {
            format!(
                "over {duration_s:.1} s the acceleration in ground axes has a mean of {mean_m_s2:.1} m/s², which would end at {:.0} km/h: {check}",
                3.6 * mean_m_s2 * duration_s
            )
        })
    }
}
