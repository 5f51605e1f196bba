//! A small reader of Rust that finds the names a file uses.

/// A word, `::`, or any other character, with its line.
#[derive(Clone, Copy)]
pub struct Token<'a> {
    pub text: &'a str,
    pub line: usize,
}

/// One end of a branching path: `a::{b, c as d}` has the ends `a::b` and `a::c`, which is called `d`.
#[derive(Debug)]
struct Leaf<'a> {
    pub path: Vec<&'a str>,
    pub name: &'a str,
}

/// The tokens of a file, without comments, string literals and spaces.
pub fn tokens(text: &str) -> Vec<Token<'_>> {
    let mut found = Vec::new();
    let mut at = 0;
    let mut line = 1;
    while at < text.len() {
        let rest = &text[at..];
        let length = token_length(rest);
        let token = &rest[..length];
        let is_word = token.starts_with(is_part_of_word);
        if is_word || token == "::" || token.len() == 1 && !token.starts_with(char::is_whitespace) {
            found.push(Token { text: token, line });
        }
        line += token.matches('\n').count();
        at += length;
    }
    found
}

fn is_part_of_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Length in bytes of the word, comment, literal or other token at the start of `rest`.
fn token_length(rest: &str) -> usize {
    let until = |end: &str| rest.find(end).map_or(rest.len(), |at| at + end.len());
    if rest.starts_with("//") {
        return until("\n");
    }
    if rest.starts_with("/*") {
        return until("*/");
    }
    if let Some(hashes) = rest.strip_prefix('r').map(|rest| &rest[..rest.len() - rest.trim_start_matches('#').len()])
        && rest[1 + hashes.len()..].starts_with('"')
    {
        let end = format!("\"{hashes}");
        let start = 2 + hashes.len();
        return rest[start..].find(&end).map_or(rest.len(), |at| start + at + end.len());
    }
    if rest.starts_with('"') {
        return quoted_length(rest, '"');
    }
    if rest.starts_with('\'') && is_char(rest) {
        return quoted_length(rest, '\'');
    }
    if rest.starts_with("::") {
        return 2;
    }
    let word = rest.find(|c| !is_part_of_word(c)).unwrap_or(rest.len());
    if word > 0 { word } else { rest.chars().next().map_or(0, char::len_utf8) }
}

/// True for `'a'` and `'\n'`, not for `'a`, which is a lifetime.
fn is_char(rest: &str) -> bool {
    let mut inside = rest.chars().skip(1);
    inside.next() == Some('\\') || inside.next() == Some('\'')
}

fn quoted_length(rest: &str, quote: char) -> usize {
    let mut escaped = false;
    for (at, c) in rest.char_indices().skip(1) {
        if c == quote && !escaped {
            return at + 1;
        }
        escaped = c == '\\' && !escaped;
    }
    rest.len()
}

/// The tokens without items behind `#[cfg(test)]` or `#[cfg(all(test, …))]`.
pub fn without_tests(tokens: Vec<Token<'_>>) -> Vec<Token<'_>> {
    let mut kept = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        let begins = |words: &[&str]| words.iter().eq(tokens[at..].iter().take(words.len()).map(|token| &token.text));
        if begins(&["#", "[", "cfg", "(", "test"]) || begins(&["#", "[", "cfg", "(", "all", "(", "test"]) {
            at = end_of_item(&tokens, end_of_group(&tokens, at + 1));
        } else {
            kept.push(tokens[at]);
            at += 1;
        }
    }
    kept
}

/// Index after the bracket that closes the one at `at`.
fn end_of_group(tokens: &[Token], at: usize) -> usize {
    let mut depth = 0;
    for (ahead, token) in tokens[at..].iter().enumerate() {
        depth += bracket(token.text);
        if depth == 0 {
            return at + ahead + 1;
        }
    }
    tokens.len()
}

/// Index after the item that begins at `at`: after its semicolon or its block.
fn end_of_item(tokens: &[Token], mut at: usize) -> usize {
    while at < tokens.len() {
        match tokens[at].text {
            ";" => return at + 1,
            "{" => return end_of_group(tokens, at),
            text if bracket(text) > 0 => at = end_of_group(tokens, at),
            _ => at += 1,
        }
    }
    at
}

fn bracket(text: &str) -> i32 {
    match text {
        "(" | "[" | "{" => 1,
        ")" | "]" | "}" => -1,
        _ => 0,
    }
}

/// Names of the modules that the root of a crate declares and that are in files of their own.
pub fn declared<'a>(root: &[Token<'a>]) -> Vec<&'a str> {
    let triples = root.windows(3).filter(|three| three[0].text == "mod" && three[2].text == ";");
    triples.map(|three| three[1].text).collect()
}

/// Names that the root of a crate re-exports or uses, each with the module or crate that it comes from.
pub fn given<'a>(root: &[Token<'a>]) -> Vec<(&'a str, &'a str)> {
    let mut found = Vec::new();
    for (at, _) in root.iter().enumerate().filter(|(_, token)| token.text == "use") {
        for leaf in leaves(&root[at + 1..]) {
            let module = leaf.path.iter().find(|part| !matches!(**part, "crate" | "self"));
            found.extend(module.map(|module| (leaf.name, *module)));
        }
    }
    found
}

/// The types, traits and functions that the root of a crate defines itself.
pub fn defined<'a>(root: &[Token<'a>]) -> Vec<&'a str> {
    let mut depth = 0;
    let mut found = Vec::new();
    for (at, token) in root.iter().enumerate() {
        depth += bracket(token.text);
        if depth == 0 && matches!(token.text, "struct" | "enum" | "trait" | "fn") {
            found.extend(root.get(at + 1).map(|name| name.text));
        }
    }
    found
}

/// The names that items of the root use, each with the module or crate that it comes from.
pub fn used_by_items<'a>(root: &[Token<'a>]) -> Vec<(&'a str, &'a str)> {
    let is_used = |name: &str| root.iter().filter(|token| token.text == name).count() > 1;
    given(root).into_iter().filter(|(name, module)| name != module && is_used(name)).collect()
}

/// Names of the crate root that a file uses by `crate::` or `super::`, with their lines. The file is `depth` modules
/// below the root.
pub fn names_of_the_root<'a>(tokens: &[Token<'a>], depth: usize) -> Vec<(&'a str, usize)> {
    let mut found = Vec::new();
    let mut braces = 0;
    let mut inline = Vec::new();
    let mut supers = 0;
    for (at, token) in tokens.iter().enumerate() {
        match token.text {
            "{" => {
                braces += 1;
                if at > 1 && tokens[at - 2].text == "mod" {
                    inline.push(braces);
                }
            }
            "}" => {
                inline.pop_if(|opened| *opened == braces);
                braces -= 1;
            }
            _ => {}
        }
        supers = match token.text {
            "super" => supers + 1,
            "::" => supers,
            _ => 0,
        };
        let is_root = token.text == "crate" || supers == depth + inline.len();
        if is_root && token.text != "::" && tokens.get(at + 1).is_some_and(|next| next.text == "::") {
            let leaves = leaves(&tokens[at + 2..]);
            found.extend(leaves.iter().filter_map(|leaf| leaf.path.first().map(|name| (*name, token.line))));
        }
    }
    found
}

/// All ends of the path at the start of `tokens`.
fn leaves<'a>(tokens: &[Token<'a>]) -> Vec<Leaf<'a>> {
    let mut found = Vec::new();
    follow(tokens, 0, &mut Vec::new(), &mut found);
    found
}

/// Adds all ends of the path at `at` to `found`, and returns the index after the path.
fn follow<'a>(tokens: &[Token<'a>], mut at: usize, path: &mut Vec<&'a str>, found: &mut Vec<Leaf<'a>>) -> usize {
    let text = |at: usize| tokens.get(at).map_or("", |token| token.text);
    let before = path.len();
    let mut continues = true;
    while continues && text(at).starts_with(is_part_of_word) {
        path.push(text(at));
        continues = text(at + 1) == "::";
        at += if continues { 2 } else { 1 };
    }
    if continues && text(at) == "{" {
        at += 1;
        while !matches!(text(at), "}" | "") {
            let next = follow(tokens, at, path, found);
            at = if text(next) == "," || next == at { next + 1 } else { next };
        }
        at += 1;
    } else if let Some(mut name) = path.last().copied() {
        if text(at) == "as" {
            name = text(at + 1);
            at += 2;
        }
        found.push(Leaf { path: path.clone(), name });
        at += usize::from(text(at) == "*");
    }
    path.truncate(before);
    at
}
