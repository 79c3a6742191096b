// Looks at the built site in a browser: node check.mjs SITE [PICTURES]
// Pages of each kind, light and dark, at three widths: no serious finding of axe, nothing wider than the window, nothing
// fetched from elsewhere, no error of a script, and the search finds what is there. PICTURES is a folder for screenshots.
import {createServer} from "node:http";
import {existsSync, mkdirSync, readFileSync, statSync} from "node:fs";
import {extname, join, normalize} from "node:path";
import {createRequire} from "node:module";
import {chromium} from "playwright-core";

const [site, pictures] = process.argv.slice(2);
const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const PAGES = [
  "index.html", "docs/index.html", "docs/tour.html", "docs/commands.html", "docs/commands/ik.html", "docs/format.html",
  "docs/api.html", "docs/lectures.html", "docs/lectures/laschi.html", "CONTRIBUTING.html", "search.html?q=elbow",
  "gallery/index.html", "gallery/puma560.html", "gallery/human-hand.html", "gallery/delta.html", "gallery/car.html",
  "gallery/turning/puma560.html", "gallery/turning/human-hand.html", "gallery/turning/four-bar.html",
  "gallery/turning/delta.html", "playground.html", "playground/index.html",
].filter((page) => existsSync(join(site, page.split("?")[0])));
const WIDTHS = [390, 768, 1280];
const BROWSERS = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
const KINDS = {".html": "text/html; charset=utf-8", ".css": "text/css", ".js": "text/javascript", ".png": "image/png",
  ".svg": "image/svg+xml", ".json": "application/json", ".woff2": "font/woff2", ".wasm": "application/wasm"};

// Below a folder, as on pages of a project at a forge: a link from the server's root would lead nowhere.
const BELOW = "/below/robokin/";
const server = createServer((request, response) => {
  const path = normalize(decodeURIComponent(new URL(request.url, "http://x").pathname));
  let file = path.startsWith(BELOW) ? join(site, path.slice(BELOW.length)) : null;
  if (file && existsSync(file) && statSync(file).isDirectory()) file = join(file, "index.html");
  if (!file || !existsSync(file)) { response.writeHead(404).end(); return; }
  response.writeHead(200, {"content-type": KINDS[extname(file)] ?? "application/octet-stream"}).end(readFileSync(file));
});
await new Promise((done) => server.listen(0, "127.0.0.1", done));
const home = `http://127.0.0.1:${server.address().port}${BELOW}`;
const executablePath = process.env.CHROMIUM ?? BROWSERS.find(existsSync);
const browser = await chromium.launch({executablePath, args: ["--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"]});
const found = [];
for (const theme of ["light", "dark"]) {
  const context = await browser.newContext({colorScheme: theme, reducedMotion: "reduce"});
  await context.addInitScript((theme) => {
    localStorage.setItem("mode", theme); localStorage.setItem("theme", theme);
  }, theme);
  for (const name of PAGES) {
    const page = await context.newPage(), say = (text) => found.push(`${name} (${theme}): ${text}`);
    page.on("request", (request) => { if (/^https?:/.test(request.url()) && !request.url().startsWith(home)) say(`fetches ${request.url()}`); });
    page.on("response", (response) => { if (response.status() >= 400) say(`${response.status()} ${response.url()}`); });
    page.on("pageerror", (error) => say(`a script fails: ${error.message}`));
    await page.setViewportSize({width: WIDTHS[2], height: 900});
    await page.goto(home + name, {waitUntil: "load"});
    if (name.startsWith("search")) {
      try { await page.waitForSelector("#search-results li a", {timeout: 20000}); } catch { say("the search finds nothing"); }
    }
    for (const details of await page.$$("details.turning")) await details.evaluate((one) => { one.open = true; });
    if (name === "playground/index.html") {
      const ready = () => document.getElementById("answer").dataset.of || document.querySelector("#state.fault");
      try { await page.waitForFunction(ready, null, {timeout: 120000}); } catch { say("the playground gives no answer"); }
      const fault = await page.evaluate(() => document.querySelector("#state.fault")?.textContent);
      if (fault) say(fault);
    }
    await page.evaluate(AXE);
    for (const width of WIDTHS) {
      await page.setViewportSize({width, height: 900});
      await page.waitForTimeout(150);
      const over = await page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
      if (over > 0) say(`${over} pixels wider than a window of ${width}`);
      if (pictures) {
        mkdirSync(pictures, {recursive: true});
        await page.screenshot({path: join(pictures, `${name.replace(/\W+/g, "-")}-${theme}-${width}.png`)});
      }
      if (width === WIDTHS[1]) continue;
      const {violations} = await page.evaluate(() => axe.run({resultTypes: ["violations"]}));
      for (const {id, impact, nodes} of violations) {
        const text = `${impact} at ${width}: ${id} at ${nodes.length}: ${nodes.slice(0, 3).map((node) => node.target.join(" ")).join(" ; ")}`;
        if (["serious", "critical"].includes(impact)) say(text); else console.log(`note: ${name} (${theme}): ${text}`);
      }
    }
    await page.close();
  }
  await context.close();
}
await browser.close();
server.close();
for (const line of found) console.error(line);
console.log(`${PAGES.length} pages in 2 themes at ${WIDTHS.join(", ")} pixels: ${found.length || "no"} faults`);
process.exitCode = found.length ? 1 : 0;
