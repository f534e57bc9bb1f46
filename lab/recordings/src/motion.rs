//! Names and units of the columns of a motion file, as `sixaxis decouple` writes it and `sixaxis compare` reads it.

/// Columns of a decoupled or true motion, beside the time: accelerations in ground axes, rate in shell axes, attitude of the
/// shell in the ground as a quaternion.
pub const MOTION_CHANNELS: [(&str, &str); 13] = [
    ("ax", "m/s^2"),
    ("ay", "m/s^2"),
    ("az", "m/s^2"),
    ("alpha_x", "rad/s^2"),
    ("alpha_y", "rad/s^2"),
    ("alpha_z", "rad/s^2"),
    ("wx", "rad/s"),
    ("wy", "rad/s"),
    ("wz", "rad/s"),
    ("qw", "1"),
    ("qx", "1"),
    ("qy", "1"),
    ("qz", "1"),
];

/// Columns that need no attitude, in sensor axes: specific force a - g, and angular acceleration.
pub const SENSOR_CHANNELS: [(&str, &str); 6] = [
    ("fx", "m/s^2"),
    ("fy", "m/s^2"),
    ("fz", "m/s^2"),
    ("alpha_sensor_x", "rad/s^2"),
    ("alpha_sensor_y", "rad/s^2"),
    ("alpha_sensor_z", "rad/s^2"),
];
