//! Pages in a real browser, where there is one.

use std::path::Path;
use std::process::Command;

use super::text;

/// Chromium with a page: the document after its scripts ran, and what it complained about.
pub fn browse(browser: &str, page: &Path, folder: &Path) -> (String, String) {
    let url = format!("file://{}#t=0.5", page.display());
    let output = Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu-sandbox",
            "--enable-unsafe-swiftshader",
        ])
        .args([
            "--use-angle=swiftshader",
            "--enable-logging=stderr",
            "--virtual-time-budget=4000",
        ])
        .arg(format!(
            "--user-data-dir={}",
            folder.join("profile").display()
        ))
        .args(["--dump-dom", &url])
        .output()
        .unwrap();
    let complaints: Vec<String> = text(&output.stderr)
        .lines()
        .filter(|line| line.contains("CONSOLE"))
        .map(str::to_owned)
        .collect();
    (text(&output.stdout), complaints.join("\n"))
}

/// A browser of this machine.
pub fn browser() -> Option<&'static str> {
    let known = ["chromium", "chromium-browser", "google-chrome"];
    let found = known.into_iter().find(|name| {
        let version = Command::new(name).arg("--version").output();
        version.is_ok_and(|output| output.status.success())
    });
    if found.is_none() {
        super::skipped("no chromium here: pages are not opened");
    }
    found
}
