//! Pages in a real browser, where there is one, over its debugging pipe: no other program, no port.

use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

/// Widths of windows: a phone, a laptop with something beside, a whole screen.
const WIDTHS: [u32; 3] = [390, 1100, 1440];

/// Finds texts of pictures that overlap or are cut, and numbers with excess digits.
const FAULTS: &str = r#"(() => {
  const faults = [], isPage = document.contentType === "text/html";
  const page = document.documentElement.clientWidth;
  const inner = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1;
  for (const svg of document.querySelectorAll("svg")) {
    const frame = svg.getBoundingClientRect();
    const texts = [...svg.querySelectorAll("text")].filter(t => t.textContent.trim()).map(t => [t.textContent.trim(), t.getBoundingClientRect()]).filter(([, box]) => box.width > 0);
    texts.forEach(([text, box], k) => {
      const isCut = box.left < frame.left - 1 || box.right > frame.right + 1 || box.top < frame.top - 1 || box.bottom > frame.bottom + 1;
      // A wide picture on a phone keeps its size: its frame scrolls, and the whole of it can be reached.
      const scrolls = isPage && frame.left >= 0 && ["auto", "scroll"].includes(getComputedStyle(svg.parentElement).overflowX);
      if (isCut || isPage && !scrolls && (box.left < 0 || box.right > page)) faults.push("cut: " + text);
      for (const [other, its] of texts.slice(k + 1)) if (inner(box, its)) faults.push(text + " on " + other);
    });
  }
  // A narrow column does not break the word above it.
  for (const head of document.querySelectorAll("th[scope=col]")) {
    const text = head.firstChild, range = document.createRange();
    for (const word of text ? text.data.matchAll(/[\p{L}\d]+/gu) : []) {
      range.setStart(text, word.index);
      range.setEnd(text, word.index + word[0].length);
      if (new Set([...range.getClientRects()].map(box => box.top)).size > 1) faults.push("broken: " + word[0]);
    }
  }
  if (isPage && document.documentElement.scrollWidth > innerWidth) faults.push("the page is wider than the window");
  // How it was made is said exactly.
  const said = isPage ? [...document.querySelectorAll("header, section:not(#provenance)")] : [document.documentElement];
  faults.push(...said.flatMap(part => (part.innerText ?? part.textContent).match(/\b\d+\.\d{9,}/g) || []));
  return faults;
})()"#;

/// Chromium without a window; drawn by software, as on a machine without a graphics card.
pub struct Browser {
    process: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
    last: u64,
    session: String,
    /// Errors of the console, the page and the content policy.
    pub complaints: Vec<String>,
    /// Addresses that were asked for.
    pub asked: Vec<String>,
    _profile: tempfile::TempDir,
}

impl Browser {
    /// A browser of this machine; `None`, with a note, where there is none.
    pub fn start() -> Option<Self> {
        let known = ["chromium", "chromium-browser", "google-chrome"];
        let found = known.into_iter().find(|name| {
            let version = Command::new(name).arg("--version").output();
            version.is_ok_and(|output| output.status.success())
        });
        let Some(program) = found else {
            super::skipped("Chromium is not installed: pages are not opened");
            return None;
        };
        let profile = tempfile::tempdir().unwrap();
        // The browser reads commands from its third file and answers on its fourth.
        let mut process = Command::new("sh")
            .args(["-c", "exec \"$@\" 3<&0 4>&1 >/dev/null", "sh", program])
            .args(["--headless", "--no-sandbox", "--remote-debugging-pipe"])
            .args(["--use-angle=swiftshader", "--enable-unsafe-swiftshader"])
            .args([
                "--disable-gpu-compositing",
                "--no-first-run",
                "--disable-extensions",
            ])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg("about:blank")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let (to, from) = (
            process.stdin.take().unwrap(),
            process.stdout.take().unwrap(),
        );
        let mut browser = Self {
            process,
            to,
            from: BufReader::new(from),
            last: 0,
            session: String::new(),
            complaints: Vec::new(),
            asked: Vec::new(),
            _profile: profile,
        };
        let target = browser.call("Target.createTarget", json!({ "url": "about:blank" }));
        let target = json!({ "targetId": target["targetId"], "flatten": true });
        let session = browser.call("Target.attachToTarget", target);
        session["sessionId"]
            .as_str()
            .unwrap()
            .clone_into(&mut browser.session);
        for domain in ["Page", "Runtime", "Log", "Network"] {
            browser.call(&format!("{domain}.enable"), json!({}));
        }
        Some(browser)
    }

    /// Calls a method of the browser and waits for its result.
    pub fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.last += 1;
        let mut message = json!({ "id": self.last, "method": method, "params": parameters });
        if !self.session.is_empty() {
            message["sessionId"] = json!(self.session);
        }
        let mut bytes = message.to_string().into_bytes();
        bytes.push(0);
        self.to.write_all(&bytes).unwrap();
        self.to.flush().unwrap();
        loop {
            let answer = self.read();
            if answer["id"] == json!(self.last) {
                assert!(answer.get("error").is_none(), "{method}: {answer}");
                return answer["result"].clone();
            }
        }
    }

    fn read(&mut self) -> Value {
        let mut bytes = Vec::new();
        self.from.read_until(0, &mut bytes).unwrap();
        assert_eq!(bytes.pop(), Some(0), "the browser has ended");
        let message: Value = serde_json::from_slice(&bytes).unwrap();
        let of = &message["params"];
        match message["method"].as_str().unwrap_or_default() {
            "Runtime.exceptionThrown" => self.complaints.push(of["exceptionDetails"].to_string()),
            "Runtime.consoleAPICalled" => self.complaints.push(of["args"].to_string()),
            "Log.entryAdded" => {
                let text = of["entry"].to_string();
                // Messages about the speed of the software renderer are not errors of the page.
                if !text.contains("GL Driver Message") {
                    self.complaints.push(text);
                }
            }
            "Network.requestWillBeSent" => {
                self.asked
                    .push(of["request"]["url"].as_str().unwrap().to_owned());
            }
            _ => {}
        }
        message
    }

    /// Width and height of the window, and whether the system's theme is dark.
    pub fn look(&mut self, [width, height]: [u32; 2], is_dark: bool) {
        let size =
            json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.call("Emulation.setDeviceMetricsOverride", size);
        let scheme = if is_dark { "dark" } else { "light" };
        let features = json!([{ "name": "prefers-color-scheme", "value": scheme }]);
        self.call(
            "Emulation.setEmulatedMedia",
            json!({ "features": features }),
        );
    }

    /// Opens a file, at a moment or a place of it, and waits until it is loaded.
    pub fn open(&mut self, file: &Path, place: &str) {
        self.complaints.clear();
        self.call("Page.navigate", json!({ "url": "about:blank" }));
        self.asked.clear();
        let url = format!("file://{}{place}", file.display());
        self.call("Page.navigate", json!({ "url": url }));
        self.wait("document.readyState === 'complete' && location.protocol === 'file:'");
    }

    /// Asserts of what is open that no text of a picture lies on another or is cut, at three widths; of a picture alone at its own.
    pub fn is_legible(&mut self, what: &str) {
        let widths = match self.value("document.contentType") == json!("text/html") {
            true => &WIDTHS[..],
            false => &WIDTHS[2..],
        };
        for width in widths {
            self.look([*width, 900], false);
            assert_eq!(self.value(FAULTS), json!([]), "{what}, {width} px wide");
        }
    }

    /// Asserts the same of every SVG picture in a folder; how many there are.
    pub fn are_legible(&mut self, folder: &Path) -> usize {
        let files = std::fs::read_dir(folder).unwrap();
        let mut files: Vec<_> = files.map(|file| file.unwrap().path()).collect();
        files.retain(|file| file.extension().is_some_and(|ending| ending == "svg"));
        for file in &files {
            self.open(file, "");
            self.is_legible(&file.display().to_string());
        }
        files.len()
    }

    /// What an expression is in the page.
    pub fn value(&mut self, expression: &str) -> Value {
        let asked =
            json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let answer = self.call("Runtime.evaluate", asked);
        assert!(
            answer.get("exceptionDetails").is_none(),
            "{expression}: {answer}"
        );
        answer["result"]["value"].clone()
    }

    /// Waits until an expression holds.
    pub fn wait(&mut self, expression: &str) {
        let begun = Instant::now();
        while self.value(expression) != json!(true) {
            assert!(
                begun.elapsed() < Duration::from_secs(60),
                "never: {expression}; {:?}",
                self.complaints
            );
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Clicks in the middle of the first element that a selector finds.
    pub fn click(&mut self, selector: &str) {
        let find = format!(
            "(() => {{ const e = document.querySelector({selector:?}); e.scrollIntoView({{ block: 'center', behavior: 'instant' }}); \
             const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; }})()"
        );
        let place = self.value(&find);
        for kind in ["mousePressed", "mouseReleased"] {
            let event = json!({ "type": kind, "x": place[0], "y": place[1], "button": "left", "clickCount": 1 });
            self.call("Input.dispatchMouseEvent", event);
        }
    }

    /// Asserts that the page requested no other address and caused no error.
    pub fn is_quiet(&mut self, what: &str) {
        let twice = "(() => { const all = [...document.querySelectorAll('[id]')].map(e => e.id); return all.filter((id, k) => all.indexOf(id) !== k); })()";
        assert_eq!(
            self.value(twice),
            json!([]),
            "{what}: names that two elements have"
        );
        assert_eq!(self.complaints, Vec::<String>::new(), "{what}: the console");
        let foreign: Vec<&String> = self
            .asked
            .iter()
            .filter(|url| !url.starts_with("file:") && !url.starts_with("data:image/"))
            .collect();
        assert!(foreign.is_empty(), "{what}: {foreign:?}");
        assert_eq!(
            self.asked
                .iter()
                .filter(|url| url.starts_with("file:"))
                .count(),
            1,
            "{what}: {:?}",
            self.asked
        );
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ended = self.process.kill();
        let _ended = self.process.wait();
    }
}
