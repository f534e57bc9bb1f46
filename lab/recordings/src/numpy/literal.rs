//! The few Python literals that stand in a header.

/// A value.
#[derive(Debug, Clone, PartialEq)]
pub enum Literal {
    /// `'<f8'`.
    Text(String),
    /// `12`; nothing in a header is negative.
    Int(u64),
    /// `True`.
    Bool(bool),
    /// A tuple or a list.
    Sequence(Vec<Literal>),
    /// A dictionary, in its order.
    Dict(Vec<(String, Literal)>),
}

/// Nesting that is followed: a dictionary of a list of tuples of tuples, and one more.
const DEPTH: usize = 6;

/// Reads one value that fills the text but for blanks.
pub fn parse(text: &str) -> Result<Literal, String> {
    let mut parser = Parser { rest: text.trim() };
    let value = parser.value(0)?;
    parser.skip();
    if parser.rest.is_empty() {
        Ok(value)
    } else {
        Err(parser.unexpected())
    }
}

struct Parser<'a> {
    rest: &'a str,
}

impl Parser<'_> {
    fn skip(&mut self) {
        self.rest = self.rest.trim_start();
    }

    /// Takes a sign if it comes next.
    fn take(&mut self, sign: char) -> bool {
        self.skip();
        match self.rest.strip_prefix(sign) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    fn unexpected(&self) -> String {
        let next: String = self.rest.chars().take(12).collect();
        format!("the header is not understood at {next:?}")
    }

    fn value(&mut self, depth: usize) -> Result<Literal, String> {
        if depth > DEPTH {
            return Err("the header is nested too deeply".to_owned());
        }
        self.skip();
        match self.rest.chars().next() {
            Some('{') => self.dict(depth),
            Some('(') => self.sequence('(', ')', depth),
            Some('[') => self.sequence('[', ']', depth),
            Some('\'' | '"') => self.text().map(Literal::Text),
            Some('0'..='9') => self.int(),
            _ => {
                for (word, value) in [("True", true), ("False", false)] {
                    if let Some(rest) = self.rest.strip_prefix(word) {
                        self.rest = rest;
                        return Ok(Literal::Bool(value));
                    }
                }
                Err(self.unexpected())
            }
        }
    }

    fn int(&mut self) -> Result<Literal, String> {
        let end = self.rest.find(|c: char| !c.is_ascii_digit());
        let (digits, rest) = self.rest.split_at(end.unwrap_or(self.rest.len()));
        let value = digits.parse().map_err(|_| self.unexpected())?;
        // Python 2 wrote long integers as `12L`.
        self.rest = rest.strip_prefix('L').unwrap_or(rest);
        Ok(Literal::Int(value))
    }

    fn text(&mut self) -> Result<String, String> {
        let mut text = String::new();
        let mut characters = self.rest.char_indices();
        let quote = characters.next().map(|(_, c)| c);
        while let Some((at, character)) = characters.next() {
            if Some(character) == quote {
                self.rest = self.rest.get(at + 1..).unwrap_or_default();
                return Ok(text);
            }
            if character != '\\' {
                text.push(character);
                continue;
            }
            match characters.next() {
                Some((_, escaped @ ('\\' | '\'' | '"'))) => text.push(escaped),
                _ => return Err("an escaped character in a name of the header".to_owned()),
            }
        }
        Err("a string in the header does not end".to_owned())
    }

    fn sequence(&mut self, open: char, close: char, depth: usize) -> Result<Literal, String> {
        self.take(open);
        let (mut values, mut comma) = (Vec::new(), false);
        while !self.take(close) {
            if !values.is_empty() && !comma {
                return Err(self.unexpected());
            }
            values.push(self.value(depth + 1)?);
            comma = self.take(',');
        }
        // Parentheses around one value are no tuple.
        match (open, comma, values.len()) {
            ('(', false, 1) => values.pop().ok_or_else(|| self.unexpected()),
            _ => Ok(Literal::Sequence(values)),
        }
    }

    fn dict(&mut self, depth: usize) -> Result<Literal, String> {
        self.take('{');
        let (mut entries, mut comma) = (Vec::new(), false);
        while !self.take('}') {
            if !entries.is_empty() && !comma {
                return Err(self.unexpected());
            }
            self.skip();
            if !self.rest.starts_with(['\'', '"']) {
                return Err(self.unexpected());
            }
            let key = self.text()?;
            if !self.take(':') {
                return Err(self.unexpected());
            }
            entries.push((key, self.value(depth + 1)?));
            comma = self.take(',');
        }
        Ok(Literal::Dict(entries))
    }
}
