//! The graph of which module uses which, and the search for circles (dependency cycles) in it.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// Uses between modules, each with the place where it was seen first.
#[derive(Default)]
pub struct Graph {
    uses: BTreeMap<String, BTreeMap<String, String>>,
}

impl Graph {
    pub fn add(&mut self, user: &str, used: &str, place: String) {
        self.uses.entry(user.to_owned()).or_default().entry(used.to_owned()).or_insert(place);
    }

    /// Finds the sets of modules that reach each other. Returns a text for each set: the names of its modules, and a
    /// shortest circle with a line for each use.
    pub fn circles(&self) -> Vec<String> {
        let mut seen = BTreeSet::new();
        let mut found = Vec::new();
        for module in self.uses.keys() {
            if seen.contains(module) || self.way(module, module).is_none() {
                continue;
            }
            let around = |other: &&String| self.way(module, other).is_some() && self.way(other, module).is_some();
            let circle: Vec<&String> = self.uses.keys().filter(around).collect();
            seen.extend(circle.iter().copied());
            found.push(self.describe(&circle));
        }
        found
    }

    fn describe(&self, circle: &[&String]) -> String {
        let ways = circle.iter().filter_map(|module| self.way(module, module));
        let shortest = ways.min_by_key(Vec::len).expect("a module of a circle reaches itself");
        let mut text = circle.iter().map(|module| module.as_str()).collect::<Vec<_>>().join(" ");
        for pair in shortest.windows(2) {
            let place = &self.uses[pair[0]][pair[1]];
            text.push_str(&format!("\n    {} uses {} ({place})", pair[0], pair[1]));
        }
        text
    }

    /// The shortest path with at least one use from a module to another, or back to itself.
    fn way<'a>(&'a self, from: &'a str, to: &str) -> Option<Vec<&'a str>> {
        let (mut seen, mut open) = (BTreeSet::new(), VecDeque::from([vec![from]]));
        while let Some(way) = open.pop_front() {
            for used in self.uses.get(way[way.len() - 1]).into_iter().flat_map(BTreeMap::keys) {
                let longer = [&way[..], &[used.as_str()]].concat();
                if used == to {
                    return Some(longer);
                }
                if seen.insert(used) {
                    open.push_back(longer);
                }
            }
        }
        None
    }
}
