//! The few elementary functions this crate needs, from std on a host and from libm without one.

#[cfg(feature = "std")]
mod imp {
    pub fn sqrt(x: f64) -> f64 {
        x.sqrt()
    }
    pub fn sin_cos(x: f64) -> (f64, f64) {
        x.sin_cos()
    }
    pub fn exp(x: f64) -> f64 {
        x.exp()
    }
    pub fn ln(x: f64) -> f64 {
        x.ln()
    }
    #[cfg(feature = "alloc")]
    pub fn cos(x: f64) -> f64 {
        x.cos()
    }
    #[cfg(feature = "alloc")]
    pub fn tan(x: f64) -> f64 {
        x.tan()
    }
}

#[cfg(not(feature = "std"))]
mod imp {
    pub fn sqrt(x: f64) -> f64 {
        libm::sqrt(x)
    }
    pub fn sin_cos(x: f64) -> (f64, f64) {
        libm::sincos(x)
    }
    pub fn exp(x: f64) -> f64 {
        libm::exp(x)
    }
    pub fn ln(x: f64) -> f64 {
        libm::log(x)
    }
    #[cfg(feature = "alloc")]
    pub fn cos(x: f64) -> f64 {
        libm::cos(x)
    }
    #[cfg(feature = "alloc")]
    pub fn tan(x: f64) -> f64 {
        libm::tan(x)
    }
}

pub(crate) use imp::*;
