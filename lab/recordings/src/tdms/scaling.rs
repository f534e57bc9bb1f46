//! Scales from raw to physical values.
//!
//! Each scale takes its input from the raw values or from another scale; the last one gives the channel's values. Formulas and
//! order of operations are those of npTDMS, in f64 throughout (npTDMS scales f32 samples in f32).

use super::value::Properties;

/// Number that stands for the raw values where a scale names its input.
const RAW: u64 = 0xFFFF_FFFF;
/// Scales that one channel may pass through. More means a circle, or a file made to exhaust its reader.
const MAX_SCALES: usize = 64;

/// A function of the raw value.
#[derive(Debug, Clone, PartialEq)]
pub enum Scale {
    Raw,
    /// Of what another scale gives.
    Of(Function, Box<Scale>),
    Add(Box<Scale>, Box<Scale>),
    /// Right minus left: that is what NI's own readers do with these names.
    Subtract(Box<Scale>, Box<Scale>),
}

/// A function of one value.
#[derive(Debug, Clone, PartialEq)]
pub enum Function {
    Linear {
        slope: f64,
        intercept: f64,
    },
    /// Coefficients from the constant up.
    Polynomial(Vec<f64>),
    /// Linear between its points (ascending inputs), constant outside them.
    Table {
        inputs: Vec<f64>,
        outputs: Vec<f64>,
    },
}

impl Function {
    fn at(&self, x: f64) -> f64 {
        match self {
            Self::Linear { slope, intercept } => x * slope + intercept,
            Self::Polynomial(coefficients) => {
                coefficients.iter().rev().fold(0.0, |sum, c| c + sum * x)
            }
            Self::Table { inputs, outputs } => interpolate(inputs, outputs, x),
        }
    }
}

impl Scale {
    /// What the properties of a channel, its group and its file (in this order; the first that speaks of scales counts)
    /// prescribe. `scaler` is the number of the scale that stands for DAQmx raw values. None if there is nothing to apply.
    ///
    /// # Errors
    /// Which scale is not supported, and why.
    pub fn find<'a>(
        levels: impl IntoIterator<Item = &'a Properties>,
        scaler: Option<u32>,
    ) -> Result<Option<Self>, String> {
        for properties in levels {
            let count = count(properties);
            if count > 0 {
                let status = properties.get("NI_Scaling_Status").and_then(|v| v.text());
                return match status {
                    None | Some("unscaled") => Builder {
                        properties,
                        scaler: scaler.map(u64::from),
                        count,
                        left: MAX_SCALES,
                    }
                    .scale(count - 1)
                    .map(Some),
                    Some("scaled") => Ok(None),
                    Some(other) => Err(format!("scaling status {other:?}")),
                };
            }
        }
        match scaler {
            Some(_) => Err("DAQmx raw data without scales".into()),
            None => Ok(None),
        }
    }

    /// Applies it in place.
    pub fn apply(&self, values: &mut [f64]) {
        match self {
            Self::Raw => {}
            Self::Of(function, input) => {
                input.apply(values);
                values.iter_mut().for_each(|x| *x = function.at(*x));
            }
            Self::Add(left, right) | Self::Subtract(left, right) => {
                let mut other = values.to_vec();
                left.apply(values);
                right.apply(&mut other);
                let subtract = matches!(self, Self::Subtract(..));
                for (value, other) in values.iter_mut().zip(other) {
                    *value = if subtract {
                        other - *value
                    } else {
                        *value + other
                    };
                }
            }
        }
    }
}

fn interpolate(inputs: &[f64], outputs: &[f64], x: f64) -> f64 {
    if x.is_nan() {
        return x;
    }
    let above = inputs.partition_point(|point| *point <= x);
    let point = |at: usize| Some((*inputs.get(at)?, *outputs.get(at)?));
    match (above.checked_sub(1).and_then(point), point(above)) {
        (Some((x0, y0)), Some((x1, y1))) if x > x0 => (y1 - y0) / (x1 - x0) * (x - x0) + y0,
        (Some((_, y)), _) | (None, Some((_, y))) => y,
        (None, None) => f64::NAN,
    }
}

/// How many scales there are.
fn count(properties: &Properties) -> u64 {
    if let Some(count) = properties.get("NI_Number_Of_Scales") {
        // Some writers put it as a text or a float. What is no number at all leads to a scale that is not there.
        let number = || count.number().map(|number| number as u64);
        let text = || count.text()?.trim().parse().ok();
        return count.whole().or_else(number).or_else(text).unwrap_or(RAW);
    }
    let numbered = properties.keys().filter_map(|name| {
        let number = name
            .strip_prefix("NI_Scale[")?
            .strip_suffix("]_Scale_Type")?;
        number.parse::<u64>().ok()?.checked_add(1)
    });
    numbered.max().unwrap_or(0)
}

struct Builder<'a> {
    properties: &'a Properties,
    scaler: Option<u64>,
    count: u64,
    left: usize,
}

impl Builder<'_> {
    fn scale(&mut self, at: u64) -> Result<Scale, String> {
        let Some(left) = self.left.checked_sub(1) else {
            return Err(format!("a chain of more than {MAX_SCALES} scales"));
        };
        self.left = left;
        if at == RAW {
            return match self.scaler {
                None => Ok(Scale::Raw),
                Some(_) => Err("a scale of raw values that only a DAQmx scaler gives".into()),
            };
        }
        let name = format!("NI_Scale[{at}]_Scale_Type");
        let kind = match self.properties.get(&name) {
            Some(value) => value.text().unwrap_or("without a type"),
            None if self.scaler == Some(at) => return Ok(Scale::Raw),
            None => {
                return Err(format!(
                    "scale {at} of {}, which is not described,",
                    self.count
                ));
            }
        };
        let prefix = format!("NI_Scale[{at}]_{kind}");
        let function = match kind {
            "Linear" => Function::Linear {
                slope: self.number(&format!("{prefix}_Slope"))?,
                intercept: self.number(&format!("{prefix}_Y_Intercept"))?,
            },
            "Polynomial" => {
                let size = format!("{prefix}_Coefficients_Size");
                let size = if self.properties.contains_key(&size) {
                    self.whole(&size)?
                } else {
                    4
                };
                Function::Polynomial(self.list(&format!("{prefix}_Coefficients"), size)?)
            }
            "Table" => self.table(at, &prefix)?,
            "Add" | "Subtract" => {
                let left = self.operand(&format!("{prefix}_Left_Operand_Input_Source"))?;
                let right = self.operand(&format!("{prefix}_Right_Operand_Input_Source"))?;
                return Ok(match kind {
                    "Add" => Scale::Add(left, right),
                    _ => Scale::Subtract(left, right),
                });
            }
            other => return Err(format!("scale {at} ({other})")),
        };
        let input = format!("{prefix}_Input_Source");
        let input = if self.properties.contains_key(&input) {
            self.operand(&input)?
        } else {
            Box::new(self.scale(RAW)?)
        };
        Ok(Scale::Of(function, input))
    }

    fn table(&self, at: u64, prefix: &str) -> Result<Function, String> {
        let size = self.whole(&format!("{prefix}_Pre_Scaled_Values_Size"))?;
        if self.whole(&format!("{prefix}_Scaled_Values_Size"))? != size || size == 0 {
            return Err(format!(
                "scale {at} (Table) with columns of different or no length"
            ));
        }
        let mut inputs = self.list(&format!("{prefix}_Pre_Scaled_Values"), size)?;
        let mut outputs = self.list(&format!("{prefix}_Scaled_Values"), size)?;
        if inputs.first() > inputs.last() {
            inputs.reverse();
            outputs.reverse();
        }
        if !inputs.is_sorted_by(|a, b| a < b) || inputs.iter().any(|x| x.is_nan()) {
            return Err(format!("scale {at} (Table) that is not monotonic"));
        }
        Ok(Function::Table { inputs, outputs })
    }

    fn number(&self, name: &str) -> Result<f64, String> {
        self.properties
            .get(name)
            .and_then(|value| value.number())
            .ok_or_else(|| format!("a scale without {name}"))
    }

    fn whole(&self, name: &str) -> Result<u64, String> {
        self.properties
            .get(name)
            .and_then(|value| value.whole())
            .ok_or_else(|| format!("a scale without {name}"))
    }

    fn list(&self, name: &str, size: u64) -> Result<Vec<f64>, String> {
        // Ends at the first that is missing, whatever size is announced.
        (0..size)
            .map(|at| self.number(&format!("{name}[{at}]")))
            .collect()
    }

    fn operand(&mut self, name: &str) -> Result<Box<Scale>, String> {
        let at = self.whole(name)?;
        self.scale(at).map(Box::new)
    }
}
