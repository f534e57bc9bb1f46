//! The few inline marks a text may contain, and their three renderings.
//!
//! | written | shown |
//! |---|---|
//! | `` `code` `` | fixed width |
//! | `**words**` | bold |
//! | `$k/m$` | letters italic, as in formulas |
//! | `x_{0}`, `s^{-2}` | lowered, raised |
//! | `10⁻³`, `v₀` | raised, lowered (Unicode figures become real ones of the page's own font) |
//!
//! A single `*`, `_`, `^` or `$` means itself. Everything is escaped; no mark opens a way for HTML.

/// Position of a piece against the base line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Level {
    /// On the line.
    #[default]
    Base,
    /// Raised.
    Sup,
    /// Lowered.
    Sub,
}

/// A stretch of text with one look.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Piece {
    /// The characters, not escaped.
    pub text: String,
    /// Position against the base line.
    pub level: Level,
    /// Italic.
    pub italic: bool,
    /// Bold.
    pub bold: bool,
    /// Fixed width.
    pub code: bool,
}

/// Splits a text at its marks.
pub fn pieces(text: &str) -> Vec<Piece> {
    let mut out: Vec<Piece> = Vec::new();
    let (mut bold, mut math, mut code, mut level) = (false, false, false, Level::Base);
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let after = &rest[c.len_utf8()..];
        if c == '`' && (code || after.contains('`')) {
            code = !code;
            rest = after;
            continue;
        }
        if !code {
            if let Some(tail) = rest.strip_prefix("**")
                && (bold || tail.contains("**"))
            {
                bold = !bold;
                rest = tail;
                continue;
            }
            if c == '$' && (math || after.contains('$')) {
                math = !math;
                rest = after;
                continue;
            }
            let opens = [("_{", Level::Sub), ("^{", Level::Sup)]
                .into_iter()
                .find_map(|(mark, to)| rest.strip_prefix(mark).map(|tail| (tail, to)));
            if let Some((tail, to)) = opens
                && level == Level::Base
                && tail.contains('}')
            {
                level = to;
                rest = tail;
                continue;
            }
            if c == '}' && level != Level::Base {
                level = Level::Base;
                rest = after;
                continue;
            }
        }
        let (shown, own_level) = if code {
            (c, Level::Base)
        } else {
            unicode_level(c)
        };
        let piece = Piece {
            text: String::new(),
            level: if own_level == Level::Base {
                level
            } else {
                own_level
            },
            italic: math && shown.is_alphabetic(),
            bold,
            code,
        };
        match out.last_mut() {
            Some(last)
                if (Piece {
                    text: String::new(),
                    ..last.clone()
                }) == piece =>
            {
                last.text.push(shown);
            }
            _ => out.push(Piece {
                text: shown.to_string(),
                ..piece
            }),
        }
        rest = after;
    }
    out
}

/// As HTML.
pub fn html(text: &str) -> String {
    pieces(text)
        .iter()
        .map(|piece| {
            let mut s = escape(&piece.text);
            for (wanted, tag) in [
                (piece.code, "code"),
                (piece.italic, "i"),
                (piece.bold, "strong"),
                (piece.level == Level::Sup, "sup"),
                (piece.level == Level::Sub, "sub"),
            ] {
                if wanted {
                    s = format!("<{tag}>{s}</{tag}>");
                }
            }
            s
        })
        .collect()
}

/// As the inside of an SVG text element.
pub fn svg(text: &str) -> String {
    let mut out = String::new();
    // Shifts accumulate along a text; the next piece on the line takes the last one back.
    let mut shifted = 0.0;
    for piece in pieces(text) {
        let (shift, small): (f64, bool) = match piece.level {
            Level::Base => (0.0, false),
            Level::Sup => (-0.36, true),
            Level::Sub => (0.18, true),
        };
        let mut attributes = String::new();
        let move_by: f64 = shift - shifted;
        if move_by != 0.0 {
            // `em` counts in the piece's own size.
            let em = if small { move_by / SMALL } else { move_by };
            attributes += &format!(" dy=\"{em:.2}em\"");
        }
        if small {
            attributes += &format!(" font-size=\"{:.0}%\"", SMALL * 100.0);
        }
        if piece.italic {
            attributes += " font-style=\"italic\"";
        }
        if piece.bold {
            attributes += " font-weight=\"600\"";
        }
        shifted = shift;
        let escaped = escape(&piece.text);
        if attributes.is_empty() {
            out += &escaped;
        } else {
            out += &format!("<tspan{attributes}>{escaped}</tspan>");
        }
    }
    out
}

/// As plain characters, for tooltips and screen readers.
pub fn plain(text: &str) -> String {
    pieces(text)
        .iter()
        .map(|piece| match piece.level {
            Level::Base => piece.text.clone(),
            Level::Sup => piece.text.chars().map(|c| relevel(c, Level::Sup)).collect(),
            Level::Sub => piece.text.chars().map(|c| relevel(c, Level::Sub)).collect(),
        })
        .collect()
}

/// A careful estimate of a text's width in units of its font size, on the wide side.
pub fn width(text: &str) -> f64 {
    pieces(text)
        .iter()
        .map(|piece| {
            let em: f64 = piece.text.chars().map(char_width).sum();
            if piece.level == Level::Base {
                em
            } else {
                em * SMALL
            }
        })
        .sum()
}

/// Escapes what has a meaning in HTML and XML.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            '\'' => out += "&#39;",
            other => out.push(other),
        }
    }
    out
}

/// Size of raised and lowered figures against the line's.
const SMALL: f64 = 0.72;

const RAISED: &str = "⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻";
const LOWERED: &str = "₀₁₂₃₄₅₆₇₈₉₊₋";
const LEVEL: &str = "0123456789+−";

fn unicode_level(c: char) -> (char, Level) {
    let level_of = |set: &str| {
        set.chars()
            .position(|s| s == c)
            .and_then(|i| LEVEL.chars().nth(i))
    };
    if let Some(base) = level_of(RAISED) {
        (base, Level::Sup)
    } else if let Some(base) = level_of(LOWERED) {
        (base, Level::Sub)
    } else {
        (c, Level::Base)
    }
}

/// A figure or sign at that level, as Unicode has it; other characters stay as they are.
pub(crate) fn relevel(c: char, level: Level) -> char {
    let set = if level == Level::Sup { RAISED } else { LOWERED };
    let c = if c == '-' { '−' } else { c };
    LEVEL
        .chars()
        .position(|s| s == c)
        .and_then(|i| set.chars().nth(i))
        .unwrap_or(c)
}

fn char_width(c: char) -> f64 {
    match c {
        'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' | '\u{202f}' | '·' => 0.31,
        ' ' | '\u{a0}' | 'f' | 't' | 'r' | 'I' | '(' | ')' | '[' | ']' | '/' | '-' => 0.40,
        'm' | 'w' | 'M' | 'W' | '—' | '%' | '@' | '×' => 0.92,
        '+' | '−' | '=' | '<' | '>' | '≤' | '≥' => 0.75,
        c if c.is_uppercase() => 0.72,
        _ => 0.61,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escapes_everything() {
        assert_eq!(html("<script>\"&'"), "&lt;script&gt;&quot;&amp;&#39;");
        assert_eq!(html("`<b>`"), "<code>&lt;b&gt;</code>");
        assert_eq!(svg("a<b"), "a&lt;b");
    }

    #[test]
    fn marks() {
        assert_eq!(
            html("$k/m$ in s^{-2}"),
            "<i>k</i>/<i>m</i> in s<sup>-2</sup>"
        );
        assert_eq!(html("**no** x_{0}"), "<strong>no</strong> x<sub>0</sub>");
        assert_eq!(html("10⁻³"), "10<sup>−3</sup>");
        assert_eq!(html("`a_{b} **c**`"), "<code>a_{b} **c**</code>");
    }

    #[test]
    fn single_marks_mean_themselves() {
        for text in [
            "mean |w*|",
            "limb_force",
            "5 $ each",
            "a ^ b",
            "a`b",
            "**half",
            "x_{open",
            "}",
        ] {
            assert_eq!(html(text), text);
        }
    }

    #[test]
    fn shifts_in_svg_cancel() {
        assert_eq!(
            svg("10⁻³ m"),
            "10<tspan dy=\"-0.50em\" font-size=\"72%\">−3</tspan><tspan dy=\"0.36em\"> m</tspan>"
        );
    }

    #[test]
    fn plain_text() {
        assert_eq!(plain("$k/m$ 10⁸ s^{-2}, x_{0}"), "k/m 10⁸ s⁻², x₀");
        assert!(width("10⁻³") < width("10−3"));
    }
}
