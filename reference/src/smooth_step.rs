//! The way from rest to motion: a step whose first four derivatives vanish at either end.
//!
//! A motion that merely starts as a sine has a jump in some derivative, and every jump rings the sensor's modes.

/// Step from 0 to 1 over x in \[0, 1\], clamped outside: its integral from 0, value, first and second derivative.
pub fn smooth_step(x: f64) -> [f64; 4] {
    if x <= 0.0 {
        return [0.0; 4];
    }
    if x >= 1.0 {
        // The step is antisymmetric about its middle, so its integral is half its width.
        return [x - 0.5, 1.0, 0.0, 0.0];
    }
    let (x2, y) = (x * x, 1.0 - x);
    let (x4, y2) = (x2 * x2, y * y);
    [
        x4 * x2 * (21.0 + x * (-60.0 + x * (67.5 + x * (-35.0 + 7.0 * x)))),
        x4 * x * (126.0 + x * (-420.0 + x * (540.0 + x * (-315.0 + 70.0 * x)))),
        630.0 * x4 * y2 * y2,
        2520.0 * x2 * x * y2 * y * (y - x),
    ]
}
