//! Generates the TypeScript types of the messages that the web page sends and receives.

use anyhow::Result;
use std::fs;
use ts_rs::{Config, TS};
use zerorate_view::export::ExportForm;
use zerorate_web::log::message::{LogAxis, LogBias, LogInspection, LogSettings, LogSummary, NoiseFileCommand};
use zerorate_web::message::{Answer, Frame, Request};

const HEAD: &str = "// Made from zerorate-web/src/message.rs and log/message.rs, and zerorate-imu/src/report/.\n\n";

/// The text of `web/src/protocol.ts`.
pub fn text() -> Result<String> {
    let folder = tempfile::tempdir()?;
    let config = Config::new().with_out_dir(folder.path()).with_large_int("number");
    Request::export_all(&config)?;
    Answer::export_all(&config)?;
    Frame::export_all(&config)?;
    LogSettings::export_all(&config)?;
    LogInspection::export_all(&config)?;
    LogAxis::export_all(&config)?;
    LogBias::export_all(&config)?;
    LogSummary::export_all(&config)?;
    NoiseFileCommand::export_all(&config)?;
    let mut files: Vec<_> = fs::read_dir(folder.path())?.map(|entry| Ok(entry?.path())).collect::<Result<_>>()?;
    files.sort();
    let mut types = Vec::new();
    for file in files {
        let text = fs::read_to_string(file)?;
        let lines = text.lines().filter(|line| !line.starts_with("import ") && !line.starts_with("// This file"));
        types.push(lines.collect::<Vec<_>>().join("\n").trim().to_owned() + "\n");
    }
    Ok(HEAD.to_owned() + &types.join("\n") + &forms()?)
}

/// The TypeScript constant with the formats of a download, from which the page makes its buttons.
fn forms() -> Result<String> {
    let exports = ExportForm::ALL.into_iter().filter(|form| !form.is_autopilot());
    let exports = exports.map(|form| (form.row().name, form.row().label));
    let forms: Vec<_> = [("toml", "TOML")].into_iter().chain(exports).chain([("report", "Report")]).collect();
    let forms = serde_json::to_string(&forms)?;
    Ok(format!(
        "\n/**\n * Forms of a download: name and label.\n */\nexport const FORMS = {forms} as const;\n\n\
         export type Form = (typeof FORMS)[number][0];\n"
    ))
}
