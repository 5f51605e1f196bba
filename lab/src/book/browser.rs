//! Opens pages of the book in Chromium from files. The book's scripts must run under its content security policy, and
//! an inline script must not run.

use crate::tools::{Tool, available, is_root};
use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::Path;
use std::process::Command;

const CHROMIUM: Tool = Tool { program: "chromium", package: "chromium" };
/// A long page, a page at the root, and a page in a folder.
const PAGES: [&str; 3] = ["codes.html", "index.html", "formats/capture.html"];

/// Checks some pages of the book in `out`. Without Chromium, prints that and skips them.
pub fn check(out: &Path) -> Result<()> {
    if !available(&[CHROMIUM], "the book in a browser")? {
        return Ok(());
    }
    let out = out.canonicalize()?;
    for page in PAGES {
        let (shown, said) = opened(&out.join(page))?;
        ensure!(said.is_empty(), "{page}: the browser says:\n{said}");
        ensure!(shown.contains("<html lang=\"en\" class=\"js"), "{page}: its first script did not run");
        ensure!(shown.contains("chapter-item"), "{page}: the list of chapters is not there");
    }
    let foreign = out.join("with-a-script.html");
    let text = fs::read_to_string(out.join("index.html"))?;
    fs::write(&foreign, text.replace("</body>", "<script>document.title = \"run\"</script></body>"))?;
    let seen = opened(&foreign);
    fs::remove_file(&foreign)?;
    let (shown, said) = seen?;
    ensure!(said.contains("Content Security Policy") && !shown.contains("<title>run"), "the policy is not in force");
    println!("{} pages of the book in Chromium keep to their policy, which is in force", PAGES.len());
    Ok(())
}

/// Opens a page. Returns its content after its scripts ran, and the browser's messages about them.
fn opened(page: &Path) -> Result<(String, String)> {
    let profile = tempfile::tempdir()?;
    let mut chromium = Command::new(CHROMIUM.program);
    chromium.args(["--headless", "--disable-gpu", "--enable-logging=stderr", "--dump-dom"]);
    // as root, Chromium only starts without its sandbox
    chromium.args(is_root().then_some("--no-sandbox"));
    chromium.arg(format!("--user-data-dir={}", profile.path().display()));
    let output = chromium.arg(format!("file://{}", page.display())).output().context("cannot start Chromium")?;
    ensure!(output.status.success(), "Chromium ended with {}", output.status);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let said = said.lines().filter(|line| line.contains(":CONSOLE")).collect::<Vec<_>>().join("\n");
    Ok((String::from_utf8_lossy(&output.stdout).into_owned(), said))
}
