//! A temperature chamber made of a shell script and files in a folder, with one of several faults. `cargo xtask trust`
//! includes this file too.

use std::fs;
use std::io;
use std::path::PathBuf;

/// The safe set point in the plans of these tests, °C. No step goes there.
const SAFE: &str = "25.0";

/// `chamber.sh set C` sets the chamber. `chamber.sh read` prints the air temperature, which lags by 15 s. Each reading
/// is one second after the last. A command takes effect only at its end, so a signal could end it before.
const SCRIPT: &str = r#"#!/bin/sh
cd "${0%/*}" || exit 1
read -r fault onset < fault
read -r set_c < set_c
read -r air_c < air_c
read -r readings < readings
echo "$*" >> heard
case $onset in
    end) [ "$*" = "set 25.0" ] && : > faulty ;;
    *) [ "$readings" -ge "$onset" ] && : > faulty ;;
esac
fault_is() { [ "$fault" = "$1" ] && [ -e faulty ]; }

# `hangs` is about the command that reads, `dead` about both
fault_is dead && sleep 600
fault_is fails && { echo "no route to the chamber" >&2; exit 1; }
fault_is fails-thrice && [ "$(wc -l < failures)" -lt 3 ] && { echo once more >> failures; exit 1; }
case $1 in
    set)
        fault_is refuses && { echo "out of range" >&2; exit 2; }
        fault_is slow && sleep 0.5
        echo "$2" > asked
        mv asked set_c ;;
    read)
        fault_is hangs && sleep 600
        fault_is garbage && { echo "23.4 C"; exit 0; }
        fault_is hot && air_c=500 set_c=500
        fault_is stuck && air_c=70 set_c=70
        fault_is lazy && set_c=$air_c
        echo $((readings + 1)) > readings
        awk -v set_c="$set_c" -v air_c="$air_c" 'BEGIN { printf "%.3f\n", air_c + (set_c - air_c) / 15 }' > next
        mv next air_c
        cat air_c ;;
esac
# it obeyed, and says that it failed
fault_is unheard && { echo "no answer" >&2; exit 1; }
exit 0
"#;

/// The faults, by their names in the script.
pub const FAULTS: [&str; 11] =
    ["hot", "stuck", "lazy", "hangs", "dead", "fails", "fails-thrice", "refuses", "unheard", "garbage", "slow"];

/// The onset of a fault that begins with the command for the safe set point.
pub const AT_END: &str = "end";

#[derive(Debug)]
pub struct ScriptChamber {
    folder: PathBuf,
}

impl ScriptChamber {
    /// Makes the chamber in an existing folder. Its fault begins after `onset` readings. If `onset` is [`AT_END`], it
    /// begins with the command for the safe set point.
    pub fn new(folder: PathBuf, fault: &str, onset: &str) -> io::Result<Self> {
        let fault = format!("{fault} {onset}\n");
        // the chamber was left at 60 °C before this test
        let files = [("fault", fault.as_str()), ("set_c", "60.0\n"), ("air_c", "25.0\n"), ("readings", "0\n")];
        for (name, content) in [("chamber.sh", SCRIPT), ("heard", ""), ("failures", "")].into_iter().chain(files) {
            fs::write(folder.join(name), content)?;
        }
        Ok(Self { folder })
    }

    /// The options with which the program controls the chamber.
    pub fn arguments(&self, retry_s: u32) -> [String; 6] {
        let script = self.folder.join("chamber.sh");
        let command = |what: &str| format!("sh '{}' {what}", script.display());
        let (set, read, retry_s) = (command("set {temp_c}"), command("read"), retry_s.to_string());
        ["--set-temperature", &set, "--read-temperature", &read, "--retry-s", &retry_s].map(str::to_owned)
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.folder.join(name)).unwrap_or_default()
    }

    pub fn heard(&self) -> Vec<String> {
        self.text("heard").lines().map(str::to_owned).collect()
    }

    pub fn is_faulty(&self) -> bool {
        self.folder.join("faulty").exists()
    }

    /// True if the chamber holds the safe set point, or was never set.
    pub fn is_safe(&self) -> bool {
        self.holds_safe() || !self.heard().iter().any(|line| line.starts_with("set "))
    }

    fn holds_safe(&self) -> bool {
        self.text("set_c").trim() == SAFE
    }

    /// Checks the last line of a program that controlled the chamber. Returns what is wrong; `None` if the line is
    /// true, and the chamber is safe or the user knows that it may not be.
    pub fn complaint(&self, stderr: &str) -> Option<String> {
        let last = stderr.lines().last().unwrap_or_default();
        let is_left = last.starts_with("the chamber was left at 25.0 °C");
        let why = match () {
            () if is_left && !self.holds_safe() => "it was not left at 25 °C",
            () if is_left || last.starts_with("warning: chamber-left: ") => return None,
            () if self.is_safe() && !self.holds_safe() => return None,
            () => "the last line does not say how it was left",
        };
        Some(format!("{why}: {:?}", self.heard()))
    }
}
