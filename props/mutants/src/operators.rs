//! What is put in an operator's, a literal's or a whole body's place.

use syn::{BinOp, Lit, Type};

/// Other operators in place of one.
pub fn binary(op: &BinOp) -> &'static [&'static str] {
    match op {
        BinOp::Add(_) => &["-", "*"],
        BinOp::Sub(_) => &["+", "/"],
        BinOp::Mul(_) => &["+", "/"],
        BinOp::Div(_) => &["*", "%"],
        BinOp::Rem(_) => &["/", "+"],
        BinOp::And(_) => &["||"],
        BinOp::Or(_) => &["&&"],
        BinOp::BitXor(_) => &["|", "&"],
        BinOp::BitAnd(_) => &["|", "^"],
        BinOp::BitOr(_) => &["&", "^"],
        BinOp::Shl(_) => &[">>"],
        BinOp::Shr(_) => &["<<"],
        BinOp::Eq(_) => &["!="],
        BinOp::Ne(_) => &["=="],
        BinOp::Lt(_) => &["==", ">", "<="],
        BinOp::Gt(_) => &["==", "<", ">="],
        BinOp::Le(_) => &[">", "<"],
        BinOp::Ge(_) => &["<", ">"],
        BinOp::AddAssign(_) => &["-=", "*="],
        BinOp::SubAssign(_) => &["+=", "/="],
        BinOp::MulAssign(_) => &["+=", "/="],
        BinOp::DivAssign(_) => &["*=", "%="],
        BinOp::RemAssign(_) => &["/=", "+="],
        BinOp::BitXorAssign(_) => &["|=", "&="],
        BinOp::BitAndAssign(_) => &["|=", "^="],
        BinOp::BitOrAssign(_) => &["&=", "^="],
        BinOp::ShlAssign(_) => &[">>="],
        BinOp::ShrAssign(_) => &["<<="],
        _ => &[],
    }
}

/// Other constants in place of one: negated and doubled, one more and one less, the other truth value.
pub fn literal(lit: &Lit, text: &str) -> Vec<String> {
    match lit {
        Lit::Float(number) if number.base10_parse::<f64>().is_ok_and(|x| x == 0.0) => {
            vec!["1.0".into()]
        }
        Lit::Float(_) => vec![format!("(-{text})"), format!("(2.0 * {text})")],
        Lit::Int(number) if number.base10_parse::<u128>().is_ok_and(|x| x == 0) => {
            vec![format!("({text} + 1)")]
        }
        Lit::Int(_) => vec![format!("({text} + 1)"), format!("({text} - 1)")],
        Lit::Bool(value) => vec![(!value.value).to_string()],
        _ => Vec::new(),
    }
}

/// What a body is replaced by, for its return type: nothing for references and opaque types.
pub fn bodies(output: Option<&Type>) -> Vec<String> {
    let words = |list: &[&str]| list.iter().map(ToString::to_string).collect();
    let Some(output) = output else {
        return words(&[""]);
    };
    match output {
        Type::Tuple(tuple) if tuple.elems.is_empty() => words(&[""]),
        Type::Reference(reference) => match &*reference.elem {
            Type::Path(path) if path.path.is_ident("str") => words(&["\"\""]),
            Type::Slice(_) => words(&["&[]"]),
            _ => Vec::new(),
        },
        Type::Path(path) => {
            let Some(last) = path.path.segments.last() else {
                return Vec::new();
            };
            match last.ident.to_string().as_str() {
                "bool" => words(&["true", "false"]),
                "f64" | "f32" => words(&["0.0", "1.0"]),
                "u8" | "u16" | "u32" | "u64" | "usize" | "i32" | "i64" | "isize" => {
                    words(&["0", "1"])
                }
                "String" => words(&["String::new()"]),
                "Option" => words(&["None"]),
                "Result" => words(&["Ok(Default::default())"]),
                _ => words(&["Default::default()"]),
            }
        }
        Type::Array(_) | Type::Tuple(_) => words(&["Default::default()"]),
        _ => Vec::new(),
    }
}
