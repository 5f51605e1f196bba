//! Stages the chapters for mdBook: the files in `docs/`, and other pages of the project.
//!
//! In the repository, chapters link to files inside and outside of `docs/`, for readers of the sources. In the book,
//! such a link leads to what was made from the file: a chapter, or a copy. Without these, only its text remains.

use anyhow::{Context, Result, ensure};
use pulldown_cmark::{Event, LinkType, Options, Parser, Tag};
use std::collections::BTreeSet;
use std::fs;
use std::ops::Range;
use std::path::{Component, Path, PathBuf};

/// The chapter to which the reference of the commands is appended.
const COMMANDS: &str = "docs/reference/commands.md";

/// Copies everything that the book shows from the project at `root` into `staged`.
pub fn fill(root: &Path, staged: &Path, commands: &str) -> Result<()> {
    let summary = fs::read_to_string(root.join("docs/SUMMARY.md"))?;
    let files = below(&root.join("docs"))?;
    let mut chapters: BTreeSet<PathBuf> = BTreeSet::new();
    for link in links(&summary) {
        chapters.insert(plain(&Path::new("docs").join(&summary[link.target]))?);
    }
    for file in &files {
        let name = Path::new("docs").join(file.strip_prefix(root.join("docs"))?);
        let is_page = name.extension().is_some_and(|e| e == "md") && !name.ends_with("SUMMARY.md");
        ensure!(!is_page || chapters.contains(&name), "{} is not in docs/SUMMARY.md", name.display());
        if !is_page && !name.ends_with("book.toml") {
            let to = staged.join(place(&name));
            fs::create_dir_all(to.parent().context("a file in a folder")?)?;
            fs::copy(file, to).with_context(|| format!("cannot copy {}", file.display()))?;
        }
    }
    for chapter in &chapters {
        let mut text =
            fs::read_to_string(root.join(chapter)).with_context(|| format!("chapter {}", chapter.display()))?;
        if chapter == Path::new(COMMANDS) {
            text = format!("{text}\n{commands}");
        }
        let to = staged.join(place(chapter));
        fs::create_dir_all(to.parent().context("a place in a folder")?)?;
        fs::write(to, relinked(&text, chapter, root, &chapters)?)?;
    }
    let summary = relinked(&summary, Path::new("docs/SUMMARY.md"), root, &chapters)?;
    Ok(fs::write(staged.join("SUMMARY.md"), summary)?)
}

/// The path at which the book has a file of the repository.
fn place(file: &Path) -> PathBuf {
    if let Ok(inside) = file.strip_prefix("docs") {
        let is_first = inside == Path::new("README.md");
        return if is_first { PathBuf::from("index").with_extension("md") } else { inside.to_owned() };
    }
    let name = file.to_string_lossy().replace("/README.md", ".md").replace('/', "-");
    Path::new("project").join(if name == "README.md" { concat!("overview", ".md") } else { &name })
}

/// The text of `page` with its links changed to paths in the book.
fn relinked(text: &str, page: &Path, root: &Path, chapters: &BTreeSet<PathBuf>) -> Result<String> {
    let here = place(page);
    let here = here.parent().context("a page in a folder")?;
    let (mut made, mut done) = (String::with_capacity(text.len()), 0);
    for Link { whole, text: shown, target: at } in links(text) {
        let target = &text[at.clone()];
        let (path, anchor) = target.split_at(target.find('#').unwrap_or(target.len()));
        if path.is_empty() || target.contains("://") || target.starts_with("mailto:") {
            continue;
        }
        let wanted = plain(&page.parent().context("a page in a folder")?.join(path))?;
        let wanted = if root.join(&wanted).is_dir() { wanted.join("README.md") } else { wanted };
        if chapters.contains(&wanted) || (wanted.starts_with("docs") && root.join(&wanted).is_file()) {
            made += &text[done..at.start];
            made += &"../".repeat(here.components().count());
            made += &format!("{}{anchor}", place(&wanted).display());
            done = at.end;
        } else {
            made += &text[done..whole.start];
            made += &text[shown];
            done = whole.end;
        }
    }
    Ok(made + &text[done..])
}

struct Link {
    whole: Range<usize>,
    /// The range of the shown text; `target` is that of the target.
    text: Range<usize>,
    target: Range<usize>,
}

/// All links `[text](target)` outside of code.
fn links(text: &str) -> Vec<Link> {
    let options = Options::ENABLE_TABLES | Options::ENABLE_FOOTNOTES;
    let parts = Parser::new_ext(text, options).into_offset_iter();
    let inline = parts.filter_map(|(event, range)| match event {
        Event::Start(
            Tag::Link { link_type: LinkType::Inline, .. } | Tag::Image { link_type: LinkType::Inline, .. },
        ) => Some(range),
        _ => None,
    });
    let link = |whole: Range<usize>| {
        let middle = whole.start + text[whole.clone()].rfind("](")?;
        let begin = whole.start + text[whole.clone()].find('[')? + 1;
        Some(Link { text: begin..middle, target: middle + 2..whole.end - 1, whole })
    };
    inline.filter_map(link).collect()
}

/// Removes `.` and `..` from a path. Returns an error if the path leads out of the project.
fn plain(path: &Path) -> Result<PathBuf> {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => ensure!(plain.pop(), "{} leaves the project", path.display()),
            Component::CurDir => {}
            part => plain.push(part),
        }
    }
    Ok(plain)
}

/// All files below a folder, in a fixed order.
pub fn below(folder: &Path) -> Result<Vec<PathBuf>> {
    let (mut found, mut folders) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            if path.is_dir() { folders.push(path) } else { found.push(path) }
        }
    }
    found.sort();
    Ok(found)
}
