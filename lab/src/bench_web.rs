//! `cargo xtask bench-web`: compares the speed of the core as WebAssembly with a native program on one thread. It also
//! measures how soon the page shows something, and how many bytes the page loads.

use crate::bench_peers::{self, Line, missed};
use crate::venv::{done, printed};
use crate::web;
use anyhow::{Context, Result};
use serde::Deserialize;
use std::process::Command;

const DATA: &str = "target/bench-web.f64";
/// Number of samples: an hour at 5.7 kSPS.
const SAMPLES: &str = "20500000";
/// Goal: largest ratio of WebAssembly's time to the native time.
const MOST_TIMES: f64 = 1.6;
/// Goal: longest time until the page draws something, s.
const MOST_S: f64 = 1.0;
/// Goals: largest size that the page loads before it draws anything, and largest size of the readers of logs, KB.
const MOST_KB: [f64; 2] = [150.0, 800.0];

#[derive(Deserialize)]
struct Page {
    seconds: f64,
    dev: Vec<f64>,
    first_picture_s: f64,
    first_load_bytes: f64,
    session_bytes: f64,
    readers_bytes: f64,
    recordings_bytes: f64,
}

pub fn run() -> Result<()> {
    web::build_small()?;
    let peers = bench_peers::peers()?;
    let peers = || Command::new(&peers);
    done(peers().args(["generate", DATA, SAMPLES]))?;
    let native = printed(peers().args(["time", DATA]))?;
    let page = printed(Command::new("node").arg("test/bench.mjs").arg(std::path::absolute(DATA)?).current_dir("web"))?;
    std::fs::remove_file(DATA)?;
    let page: Page = serde_json::from_str(&page).context("what the page prints")?;
    print(&page, &one_thread(&native)?);
    Ok(())
}

fn one_thread(text: &str) -> Result<Line> {
    let ours = |line: &Line| line.who == "zerorate, 1 thread" && line.work == "oadev";
    bench_peers::parse(text)?.into_iter().find(ours).context("the peers did not time zerorate on one thread")
}

fn print(page: &Page, native: &Line) {
    let seconds = native.seconds.unwrap_or(f64::NAN);
    let times = page.seconds / seconds;
    println!(
        "OADEV of {SAMPLES} samples: WebAssembly {:.3} s, the program on one thread {seconds:.3} s",
        page.seconds
    );
    println!("  {times:.2} times as long (goal at most {MOST_TIMES}{})", missed(times <= MOST_TIMES));
    let pairs = native.dev.iter().flatten().flatten().zip(&page.dev);
    let worst = pairs.map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
    println!("  at most {worst:.1e} apart, relative, in {} points", page.dev.len());
    let s = page.first_picture_s;
    println!("first picture on the twin: {s:.2} s (goal {MOST_S}{})", missed(s <= MOST_S));
    println!("session, behind the first picture: {:.0} KB with brotli", page.session_bytes / 1e3);
    println!("session with recordings, when one is dropped: {:.0} KB with brotli", page.recordings_bytes / 1e3);
    let loads = [("first load", page.first_load_bytes), ("readers of logs", page.readers_bytes)];
    for ((what, bytes), most) in loads.into_iter().zip(MOST_KB) {
        let kilobytes = bytes / 1e3;
        println!("{what}: {kilobytes:.0} KB with brotli (goal {most}{})", missed(kilobytes <= most));
    }
}
