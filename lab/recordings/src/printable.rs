//! Text from files, fit for a terminal: what a terminal would take for a command, or show in another order than it stands in, is left out.

/// Stands for a character that is left out.
const LEFT_OUT: char = '\u{fffd}';

/// Whether a terminal prints it where it stands: neither a control character of either set nor a change of the writing's direction.
#[must_use]
pub fn is_printable(c: char) -> bool {
    !c.is_control()
        && !matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A name or a sentence on one line, cut to so many characters.
#[must_use]
pub fn line(text: &str, most: usize) -> String {
    cut(text, most, is_printable)
}

/// Several lines, cut to so many characters in all.
#[must_use]
pub fn lines(text: &str, most: usize) -> String {
    cut(text, most, |c| is_printable(c) || matches!(c, '\n' | '\t'))
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
    use super::{line, lines};

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
        assert_eq!(line("Größe µm/s²", 20), "Größe µm/s²");
    }
}
