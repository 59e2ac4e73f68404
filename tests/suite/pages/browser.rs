//! A headless Chromium that looks at pages in frames; tests that need one are shown as ignored where
//! there is none.

use std::fs;
use std::process::Command;

use libtest_mimic::{Failed, Trial};

/// Names under which a Chromium may be installed.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

fn browser() -> Option<String> {
    let answers = |name: &str| Command::new(name).arg("--version").output().is_ok_and(|o| o.status.success());
    std::env::var("PROOFMASS_CHROMIUM").ok().or_else(|| NAMES.iter().find(|n| answers(n)).map(|n| (*n).to_owned()))
}

/// Whether there is one on this machine.
pub fn installed() -> bool {
    static INSTALLED: std::sync::OnceLock<bool> = std::sync::OnceLock::new();
    *INSTALLED.get_or_init(|| browser().is_some())
}

/// A test that needs a Chromium: ignored where there is none, a failure where
/// `PROOFMASS_REQUIRE_BROWSER=1` demands one.
pub fn browser_test(name: &str, body: fn() -> Result<(), Failed>) -> Trial {
    if installed() || std::env::var_os("PROOFMASS_REQUIRE_BROWSER").is_some() {
        return super::super::tiers::timed(name.to_owned(), body);
    }
    Trial::test(format!("{name} (needs a browser: install chromium)"), || Ok(())).with_ignored_flag(true)
}

/// What the browser says of pages in frames: lines per frame. `work` is an expression of `win`,
/// `width` and `print`.
pub fn look(pages: &[(u32, bool, &str)], work: &str) -> Result<Vec<Vec<String>>, Failed> {
    let folder = tempfile::tempdir()?;
    let mut frames = String::new();
    for (width, print, page) in pages {
        // On paper the rules of print hold at once; the policy names the untouched style, so it
        // must go.
        let page = match print {
            true => page.replace("@media print", "@media all").replace("http-equiv=\"Content-Security-Policy\"", ""),
            false => (*page).to_owned(),
        };
        let page = page.replace('&', "&amp;").replace('"', "&quot;");
        frames +=
            &format!("<iframe data-print=\"{print}\" width=\"{width}\" height=\"900\" srcdoc=\"{page}\"></iframe>\n");
    }
    let html = format!(
        "<!doctype html><meta charset=\"utf-8\"><style>iframe{{border:0}}</style>{frames}<pre></pre><script>\n{}\n{}\n\
         addEventListener('load', async () => {{ const out = [];\n\
         for (const frame of document.querySelectorAll('iframe')) {{\n\
         const win = frame.contentWindow, width = +frame.width, print = frame.dataset.print === 'true';\n\
         try {{ out.push(await {work}); }} catch (e) {{ out.push([String(e.stack)]); }} }}\n\
         document.querySelector('pre').textContent = '[[' + JSON.stringify(out) + ']]'; }});</script>",
        include_str!("measure.js"),
        include_str!("touch.js"),
    );
    let file = folder.path().join("frames.html");
    fs::write(&file, html)?;
    let mut command = Command::new(browser().ok_or("there is no browser")?);
    command.args([
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--window-size=2000,1000",
        "--virtual-time-budget=20000",
    ]);
    command.arg(format!("--user-data-dir={}", folder.path().join("profile").display()));
    let output = command.arg("--dump-dom").arg(format!("file://{}", file.display())).output()?;
    let dom = String::from_utf8_lossy(&output.stdout);
    let said = dom.rsplit_once("<pre>[[").and_then(|(_, rest)| rest.split_once("]]</pre>"));
    let said =
        said.ok_or_else(|| format!("the browser gave no answer: {}", String::from_utf8_lossy(&output.stderr)))?.0;
    let said = said.replace("&lt;", "<").replace("&gt;", ">").replace("&nbsp;", " ").replace("&amp;", "&");
    Ok(serde_json::from_str(&said)?)
}
