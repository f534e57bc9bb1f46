//! Text from files, fit for a terminal: what a terminal would take for a command, or show in another order than it stands in, is left out.

use std::borrow::Cow;

/// Stands for a character that is left out.
const LEFT_OUT: char = '\u{fffd}';

/// Whether a terminal prints it where it stands: neither a control character of either set nor a change of the writing's direction.
pub fn is_printable(c: char) -> bool {
    !c.is_control()
        && !matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A name or a sentence on one line, cut to so many characters.
pub fn line(text: &str, most: usize) -> String {
    cut(text, most, is_printable)
}

/// Several lines, cut to so many characters in all.
pub fn lines(text: &str, most: usize) -> String {
    cut(text, most, |c| is_printable(c) || matches!(c, '\n' | '\t'))
}

/// Digits from which a number is printed with a power of ten: a count has at most 20, and a double with a fraction 15 before it.
const MANY_DIGITS: usize = 25;
const BEFORE_A_FRACTION: usize = 15;

/// The text with numbers of very many digits shortened: 1e308 would be a one and 308 zeros. A name in quotes or in a path, and
/// digits within a word, stay.
pub fn short_numbers(text: &str) -> Cow<'_, str> {
    let is_number = |c: char| c.is_ascii_digit() || c == '.';
    let of_a_name = |c: char| c.is_alphanumeric() || matches!(c, '_' | '"' | '/');
    let (mut short, mut kept) = (String::new(), 0);
    let mut at = 0;
    while let Some(start) = text[at..].find(is_number).map(|found| at + found) {
        let rest = text[start..].trim_start_matches(is_number);
        at = text.len() - rest.len();
        let number = text[start..at].trim_end_matches('.');
        let end = start + number.len();
        let whole = number.find('.').filter(|whole| *whole > BEFORE_A_FRACTION);
        if number.len() < MANY_DIGITS && whole.is_none()
            || text[..start].ends_with(of_a_name)
            || text[end..].starts_with(of_a_name)
        {
            continue;
        }
        if let Ok(value) = number.parse::<f64>() {
            let shown = format!("{value:.5e}");
            let (mantissa, power) = shown.split_once('e').unwrap_or((&shown, "0"));
            let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.');
            short += &format!("{}{mantissa}e{power}", &text[kept..start]);
            kept = end;
        }
    }
    match kept {
        0 => Cow::Borrowed(text),
        _ => Cow::Owned(short + &text[kept..]),
    }
}

fn cut(text: &str, most: usize, stays: impl Fn(char) -> bool) -> String {
    let clean = |c: char| if stays(c) { c } else { LEFT_OUT };
    let mut shown: String = text.chars().take(most).map(clean).collect();
    if text.chars().nth(most).is_some() {
        shown.pop();
        shown.push('…');
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::{line, lines, short_numbers};

    #[test]
    fn neg_no_command_reaches_the_terminal() {
        for hostile in ['\u{1b}', '\u{7}', '\u{9b}', '\u{202e}', '\u{2066}', '\r'] {
            let text = format!("a{hostile}[2Jb");
            assert_eq!(line(&text, 10), "a\u{fffd}[2Jb");
            assert_eq!(lines(&text, 10), "a\u{fffd}[2Jb");
        }
        assert_eq!(line("a\nb", 10), "a\u{fffd}b");
        assert_eq!(lines("a\n\tb", 10), "a\n\tb");
        assert_eq!(line("abcdef", 4), "abc…");
        let text = format!("{} Hz, {}, -{}.", 1e308, 1e-300, 1.234_567_8e30);
        assert_eq!(short_numbers(&text), "1e308 Hz, 1e-300, -1.23457e30.");
        assert_eq!(
            short_numbers("up to 18446744073709551616.0 V"),
            "up to 1.84467e19 V"
        );
        let digits = "1".repeat(40);
        for kept in [
            "0.1234567890123456 of 18446744073709551615..".to_owned(),
            format!("\"{digits}\", day/{digits}.csv, u{digits}"),
        ] {
            assert_eq!(short_numbers(&kept), kept);
        }
        assert_eq!(line("Größe µm/s²", 20), "Größe µm/s²");
    }
}
