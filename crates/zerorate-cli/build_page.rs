//! Packs the live page: compresses the files that `cargo xtask web` wrote to `page/`, and lists them for
//! `include_bytes!`. Without the page the list is empty, and the program says so when a browser requests the page.

use flate2::Compression;
use flate2::write::GzEncoder;
use std::collections::hash_map::DefaultHasher;
use std::fmt::Write as _;
use std::hash::{Hash, Hasher};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::{env, fs};

pub fn pack() -> io::Result<()> {
    let folder = |name: &str| env::var_os(name).map(PathBuf::from).unwrap_or_default();
    let (root, out) = (folder("CARGO_MANIFEST_DIR").join("page"), folder("OUT_DIR"));
    println!("cargo::rerun-if-changed={}", root.display());
    let mut files = Vec::new();
    walk(&root, &mut files)?;
    files.sort();
    let mut table = String::from("&[\n");
    for (index, file) in files.iter().enumerate() {
        let name = file.strip_prefix(&root).unwrap_or(file).to_string_lossy().replace('\\', "/");
        let bytes = fs::read(file)?;
        let packed = out.join(format!("page-{index}.gz"));
        let mut encoder = GzEncoder::new(fs::File::create(&packed)?, Compression::best());
        encoder.write_all(&bytes)?;
        encoder.finish()?;
        let mut hash = DefaultHasher::new();
        bytes.hash(&mut hash);
        let tag = format!("\"{:016x}\"", hash.finish());
        let _ = writeln!(table, "    Asset {{ name: {name:?}, tag: {tag:?}, packed: include_bytes!({packed:?}) }},");
    }
    table.push(']');
    fs::write(out.join("page.rs"), table)
}

fn walk(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            walk(&path, files)?;
        } else if path.file_name().is_some_and(|name| name != "README.md") {
            // README.md keeps the folder in git, because this script fails without the folder
            files.push(path);
        }
    }
    Ok(())
}
