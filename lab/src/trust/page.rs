//! Writes docs/reference/reliability.md.

use super::Class;
use super::verdict::Count;
use anyhow::Result;
use std::fmt::Write;
use std::fs;

const PAGE: &str = "docs/reference/reliability.md";
const HEAD: &str = include_str!("reliability.md.in");

pub fn write(counts: &[(Class, Count)]) -> Result<()> {
    let mut table = String::from(
        "| class | what a run does | runs | right | refused, true cause | refused, another cause | wrong and warned | \
         wrong, unknowable | **wrong and silent** |\n\
         |---|---|---|---|---|---|---|---|---|\n",
    );
    for (class, count) in counts {
        let Count { runs, right, refused, misjudged, warned, unknowable, silent, .. } = count;
        writeln!(
            table,
            "| {} | {} | {runs} | {right} | {refused} | {misjudged} | {warned} | {unknowable} | **{silent}** |",
            class.name, class.what
        )?;
    }
    let causes = counts.iter().flat_map(|(class, count)| {
        count.other_causes.iter().map(move |(said, times)| format!("* {}, {times} ×: “{said}”\n", class.name))
    });
    let page = HEAD.replace("{table}", &table).replace("{causes}", &causes.collect::<String>());
    fs::write(PAGE, page)?;
    println!("{PAGE} is written");
    Ok(())
}
