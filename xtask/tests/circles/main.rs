//! Checks that no module of a crate depends on itself through other modules.
//!
//! A module here is one that the root of a crate declares, with its submodules. The root may use every module. A name
//! that the root re-exports counts as a name of the module that it comes from. If the root defines items itself, it
//! counts as a module too. Tests are left out.

mod graph;
mod rust;
#[path = "../tree/mod.rs"]
mod tree;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use graph::Graph;
use rust::{Token, tokens, without_tests};
use tree::{files_below, root};

#[test]
fn no_module_reaches_itself_through_another() {
    let packages = packages();
    assert!(packages.iter().any(|package| package.ends_with("crates/zerorate")), "the crates were not found");
    let mut found = Vec::new();
    for package in packages {
        let name = package.strip_prefix(root()).unwrap().display().to_string();
        let circles: Vec<String> = roots(&package).iter().flat_map(|root| uses(&sources(root)).circles()).collect();
        found.extend(circles.iter().map(|circle| format!("{name}: {circle}")));
    }
    let advice = "Move what they share to a module that uses none of them";
    assert!(found.is_empty(), "modules in circles. {advice}:\n{}", found.join("\n"));
}

struct Source {
    /// Path of the file below `src`, or below the folder of its program in `src/bin`.
    path: String,
    text: String,
}

impl Source {
    fn is_root(&self) -> bool {
        matches!(&*self.path, "lib.rs" | "main.rs")
    }

    fn is_test(&self) -> bool {
        self.path.split('/').any(|part| matches!(part, "tests" | "tests.rs"))
    }

    /// The modules that contain the file, from the root on.
    fn modules(&self) -> Vec<&str> {
        let path = self.path.trim_end_matches(".rs").trim_end_matches("/mod");
        path.split('/').collect()
    }

    fn tokens(&self) -> Vec<Token<'_>> {
        without_tests(tokens(&self.text))
    }
}

fn uses(sources: &[Source]) -> Graph {
    let roots: Vec<Vec<Token>> = sources.iter().filter(|file| file.is_root()).map(Source::tokens).collect();
    let modules: BTreeSet<&str> = roots.iter().flat_map(|root| rust::declared(root)).collect();
    let given: BTreeMap<&str, &str> = roots.iter().flat_map(|root| rust::given(root)).collect();
    let defined: BTreeSet<&str> = roots.iter().flat_map(|root| rust::defined(root)).collect();
    let mut graph = Graph::default();
    for (name, module) in roots.iter().flat_map(|root| rust::used_by_items(root)) {
        graph.add("root", module, format!("the root, by `{name}`"));
    }
    for file in sources.iter().filter(|file| !file.is_root() && !file.is_test()) {
        let inside = file.modules();
        let tokens = file.tokens();
        for (name, line) in rust::names_of_the_root(&tokens, inside.len()) {
            if defined.contains(name) {
                graph.add(inside[0], "root", format!("src/{}:{line}", file.path));
            }
            let target = modules.get(name).or_else(|| given.get(name)).filter(|module| modules.contains(**module));
            if let Some(target) = target.filter(|target| modules.contains(inside[0]) && **target != inside[0]) {
                graph.add(inside[0], target, format!("src/{}:{line}", file.path));
            }
        }
    }
    graph
}

/// Every folder of the project with a manifest and sources.
fn packages() -> Vec<PathBuf> {
    let manifests = files_below(&root()).into_iter().filter(|path| path.ends_with("Cargo.toml"));
    manifests.map(|path| path.parent().unwrap().to_owned()).filter(|folder| folder.join("src").is_dir()).collect()
}

/// The folders in which the crates of a package begin: `src`, and the folders of programs in `src/bin`.
fn roots(package: &Path) -> Vec<PathBuf> {
    let source = package.join("src");
    let programs = fs::read_dir(source.join("bin")).into_iter().flatten().map(|entry| entry.unwrap().path());
    let programs: Vec<PathBuf> = programs.filter(|path| path.is_dir()).collect();
    [vec![source], programs].concat()
}

fn sources(folder: &Path) -> Vec<Source> {
    let files = files_below(folder).into_iter().filter(|path| path.extension().is_some_and(|e| e == "rs"));
    let source = |path: PathBuf| Source {
        path: path.strip_prefix(folder).unwrap().display().to_string().replace('\\', "/"),
        text: fs::read_to_string(&path).unwrap(),
    };
    files.map(source).collect()
}

fn circles_of(files: &[(&str, &str)]) -> Vec<String> {
    let file = |(path, text): &(&str, &str)| Source { path: (*path).to_owned(), text: (*text).to_owned() };
    uses(&files.iter().map(file).collect::<Vec<_>>()).circles()
}

#[test]
fn a_circle_is_named_with_the_lines_that_close_it() {
    let root = ("lib.rs", "mod air;\nmod fire;\nmod water;\npub use fire::Flame;");
    let air = ("air.rs", "use core::fmt;\n\nuse crate::{fmt, water::{Ice, Steam}};");
    let fire = ("fire/mod.rs", "mod log;\nuse log::Log;");
    let log = ("fire/log.rs", "use super::super::air::Wind;\nuse super::Flame;");
    let water = ("water.rs", "fn boil() -> crate::Flame {}");
    let expected = "air fire water\n    air uses water (src/air.rs:3)\n    water uses fire (src/water.rs:1)\n    \
                    fire uses air (src/fire/log.rs:1)";
    assert_eq!(circles_of(&[root, air, fire, log, water]), [expected]);
    assert!(circles_of(&[root, air, fire, water]).is_empty());
}

#[test]
fn a_root_that_defines_what_its_modules_use_is_in_a_circle() {
    let root = ("lib.rs", "mod air;\nuse air::Wind;\npub struct Sky(Wind);");
    let expected = "air root\n    air uses root (src/air.rs:1)\n    root uses air (the root, by `Wind`)";
    assert_eq!(circles_of(&[root, ("air.rs", "use crate::Sky;")]), [expected]);
    assert!(circles_of(&[root, ("air.rs", "pub struct Wind;")]).is_empty());
    let names_only = ("lib.rs", "mod air;\npub use air::Wind;");
    assert!(circles_of(&[names_only, ("air.rs", "use crate::Wind;")]).is_empty());
}

#[test]
fn tests_comments_and_texts_close_no_circle() {
    let root = ("lib.rs", "mod air;\nmod fire;\n#[cfg(test)]\nmod trial;");
    let air = ("air.rs", "use crate::fire::Flame;");
    let quiet = "// crate::air\n/* crate::air\ncrate::air */\nconst A: &str = \"\\\"crate::air\";
        const B: &str = r#\"\"crate::air\"#;\n#[cfg(test)]\nmod tests { use crate::air; }
        #[cfg(all(test, unix))]\nuse crate::air::Wind;\nfn lives<'a>(_: &'a str) { ' ' == '\"'; }";
    let trial = ("trial.rs", "use crate::air;");
    let tests = ("fire/tests.rs", "use crate::air;");
    assert!(circles_of(&[root, air, ("fire.rs", quiet), trial, tests]).is_empty());
    let loud = format!("{quiet}\nuse crate::air::Wind;");
    assert_eq!(circles_of(&[root, air, ("fire.rs", &loud)]).len(), 1, "what follows the tests counts");
}

#[test]
fn a_module_inside_a_file_is_one_level_deeper() {
    let root = ("lib.rs", "mod air;\nmod fire;");
    let air = ("air.rs", "use crate::fire::Flame;");
    let own = ("fire.rs", "mod air {}\nmod inner { use super::air; }");
    assert!(circles_of(&[root, air, own]).is_empty());
    let other = ("fire.rs", "mod inner { use super::super::air; }");
    assert_eq!(circles_of(&[root, air, other]).len(), 1);
    let after = ("fire.rs", "mod inner { struct Inner {} }\nuse super::air;");
    assert_eq!(circles_of(&[root, air, after]).len(), 1);
}
