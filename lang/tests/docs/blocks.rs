//! Fenced blocks of a Markdown text.

/// A fenced block.
#[derive(Debug, Clone)]
pub struct Block {
    /// Line of its first line of text, from 1.
    pub line: usize,
    /// Words after the opening fence.
    pub info: Vec<String>,
    /// What stands between the fences.
    pub text: String,
}

impl Block {
    /// The word after the language: `agent`, `stmt`, `expr` …; empty for a whole file.
    pub fn kind(&self) -> &str {
        match self.info.get(1).map(String::as_str) {
            Some("error") | None => "",
            Some(kind) => kind,
        }
    }

    /// The code it must give, when it is meant to be wrong.
    pub fn error(&self) -> Option<&str> {
        let at = self.info.iter().position(|w| w == "error")?;
        self.info.get(at + 1).map(String::as_str)
    }
}

/// The blocks of `text` whose language is `language`, in order.
pub fn of(text: &str, language: &str) -> Vec<Block> {
    let mut out = Vec::new();
    let mut open: Option<Block> = None;
    for (i, line) in text.lines().enumerate() {
        match (&mut open, line.strip_prefix("```")) {
            (None, Some(info)) => {
                let info = info.split_whitespace().map(str::to_string).collect();
                open = Some(Block { line: i + 2, info, text: String::new() });
            }
            (Some(_), Some(_)) => {
                out.extend(open.take().filter(|b| b.info.first().is_some_and(|w| w == language)))
            }
            (Some(b), None) => {
                b.text.push_str(line);
                b.text.push('\n');
            }
            (None, None) => {}
        }
    }
    assert!(open.is_none(), "a block is not closed");
    out
}
