// Opens a report in headless Chromium and uses it as a reader does.
//
//   node report.test.mjs REPORT/index.html SCREENSHOTS
//
// $CHROMIUM names the browser, else /usr/bin/chromium. Prints a line per check and ends with 1 if one failed.

import { existsSync, mkdirSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const [page_path, shots] = process.argv.slice(2);
const executablePath = process.env.CHROMIUM || "/usr/bin/chromium";
const DESKTOP = { width: 1280, height: 900 };
const PHONE = { width: 390, height: 844 };
const FLAGS = [
  "--no-first-run",
  "--disable-quic",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  // WebGL in software, as test machines have no graphics card.
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
];

function check(holds, text) {
  if (!holds) throw new Error(text);
}

// --- Checks: each takes the open page and throws what is wrong

async function everyImageShows(page) {
  const broken = await page.evaluate(async () => {
    const images = [...document.images];
    // A picture that is loaded when it comes into view has yet to come.
    images.forEach((image) => (image.loading = "eager"));
    await Promise.all(images.map((image) => image.decode().catch(() => {})));
    return images.filter((image) => !image.naturalWidth).map((image) => image.alt || image.src.slice(0, 60));
  });
  check(broken.length === 0, `pictures without content: ${broken.join(", ")}`);
}

async function everyPictureIsDescribed(page) {
  const count = await page.locator("img:not([alt])").count();
  check(count === 0, `${count} pictures have no alt text`);
}

const nextFrame = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => setTimeout(done))));

// The cells of a column that hold a number, as they stand, hidden rows apart.
const columnOf = (title) =>
  title.evaluate((th) => {
    const bodies = [...th.closest("table").tBodies];
    return bodies.map((body) =>
      [...body.rows]
        .map((row) => row.cells[th.cellIndex]?.dataset.value ?? "")
        .filter((text) => text.trim() !== "" && Number.isFinite(Number(text)))
        .map(Number),
    );
  });

const isSorted = (bodies, sign) => bodies.every((values) => values.every((v, i) => !i || sign * (v - values[i - 1]) >= 0));

// Tables behind a summary are opened first, as a reader would.
const openTables = (page) =>
  page.locator("details:has(table)").evaluateAll((list) => list.forEach((details) => (details.open = true)));

async function everyTableSorts(page) {
  await openTables(page);
  const tables = page.locator("table.sortable");
  for (let t = 0; t < (await tables.count()); t++) {
    const titles = tables.nth(t).locator("thead tr:last-child th:has(button)");
    const rows = await tables.nth(t).locator("tbody tr").count();
    check((await titles.count()) > 0, `table ${t} has no button in its head`);
    for (let c = 0; c < (await titles.count()); c++) {
      const title = titles.nth(c);
      const name = `table ${t}, column "${(await title.textContent()).trim()}"`;
      for (const [order, sign] of [["ascending", 1], ["descending", -1]]) {
        await title.locator("button").click();
        const told = await title.getAttribute("aria-sort");
        check(told === order, `${name}: aria-sort is ${told}, not ${order}`);
        const values = await columnOf(title);
        check(isSorted(values, sign), `${name}: not ${order}: ${JSON.stringify(values)}`);
        const marked = await tables.nth(t).locator("[aria-sort=ascending], [aria-sort=descending]").count();
        check(marked === 1, `${name}: ${marked} columns say that they are sorted`);
      }
    }
    const left = await tables.nth(t).locator("tbody tr").count();
    check(left === rows, `table ${t} had ${rows} rows and has ${left} after sorting`);
  }
  return `${await tables.count()} tables`;
}

async function filtersHideRows(page) {
  await openTables(page);
  const fields = page.locator("input.filter[data-table]");
  for (let f = 0; f < (await fields.count()); f++) {
    const field = fields.nth(f);
    const id = await field.getAttribute("data-table");
    const rows = page.locator(`table[id="${id}"] tbody tr`);
    const all = await rows.count();
    check(all > 0, `the filter of "${id}" has no rows to filter`);
    const shown = async () => (await rows.evaluateAll((list) => list.filter((row) => row.offsetParent).length));
    const word = (await rows.first().locator("td, th").first().textContent()).trim();
    await field.fill(word);
    const expected = await rows.evaluateAll(
      (list, words) => list.filter((row) => words.every((w) => row.textContent.toLowerCase().includes(w))).length,
      word.toLowerCase().split(/\s+/),
    );
    check((await shown()) === expected, `"${id}" shows ${await shown()} rows for "${word}", not ${expected}`);
    await field.fill("no row has this text");
    check((await shown()) === 0, `"${id}" shows rows for a text that none has`);
    await field.fill("");
    check((await shown()) === all, `"${id}" shows ${await shown()} of ${all} rows without a filter`);
  }
  return `${await fields.count()} filters`;
}

async function surfacesTurn(page) {
  if (!(await page.locator("script#viewer").count())) return "no viewer in this report";
  const buttons = page.locator("[data-surface] > button.turn");
  const count = await buttons.count();
  check(count > 0, "the viewer is there, but no picture has a button");
  const surface = page.locator("[data-surface]:has(> button.turn)").first();
  await surface.scrollIntoViewIfNeeded();
  const still = await surface.screenshot(shot("surface-still"));
  // With the keyboard: a button is reached and pressed without a mouse.
  await surface.locator("button.turn").press("Enter");
  const canvas = surface.locator("canvas");
  await canvas.waitFor({ timeout: 20_000 });
  const label = await surface.locator("button.turn").textContent();
  check(!label.startsWith("No 3D view"), label);
  const before = await settled(page, canvas);
  const seen = await colours(page, before);
  check(seen.count > 50, `the canvas shows only ${seen.count} colours`);
  const apart = await difference(page, still, await surface.screenshot());
  check(apart.share < 0.35, `${percent(apart.share)} of the first view differ from the still: another camera?`);

  const box = await canvas.boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + box.width / 4, y + 20, { steps: 4 });
  await page.mouse.up();
  const moved = async (name) => (await difference(page, before, await canvas.screenshot(shot(name)))).share;
  check(await eventually(page, async () => (await moved("surface-after")) > 0.01), "dragging does not turn the surface");
  const shares = [await covered(page, before), await covered(page, await canvas.screenshot())];
  check(shares[1].share > shares[0].share / 2, `turned, the surface covers ${percent(shares[1].share)} instead of ${percent(shares[0].share)}`);
  await canvas.dblclick();
  check(await eventually(page, async () => (await moved("surface-reset")) < 0.001), "a double click does not bring the first view back");

  for (let b = 1; b < Math.min(count, 6); b++) {
    await buttons.nth(b).click();
    await page.waitForFunction((i) => {
      const button = document.querySelectorAll("[data-surface] > button.turn")[i];
      return button.parentElement.querySelector("canvas") && !button.disabled;
    }, b, { timeout: 20_000 });
  }
  const open = await page.locator("[data-surface] > canvas").count();
  check(open === Math.min(count, 4), `${open} views are open at the same time`);
  if (count > 4) check(await surface.locator("img").isVisible(), "the oldest view did not go back to its still");
  return `${count} surfaces; the first view differs from its still in ${percent(apart.share)}`;
}

async function phoneDoesNotScrollSideways(page) {
  await page.setViewportSize(PHONE);
  await nextFrame(page);
  const width = await page.evaluate(() => document.documentElement.scrollWidth);
  const wide = await page.evaluate((most) => {
    // What scrolls inside of its own box is fine.
    const clipped = (e) => e && e !== document.body && (getComputedStyle(e).overflowX !== "visible" || clipped(e.parentElement));
    const elements = [...document.body.querySelectorAll("*")];
    const found = elements.filter((e) => e.getBoundingClientRect().right > most + 1 && !clipped(e.parentElement));
    return found.slice(0, 3).map((e) => `${e.tagName.toLowerCase()}${e.id && `#${e.id}`}`).join(", ");
  }, PHONE.width);
  await page.screenshot(shot("phone"));
  await page.setViewportSize(DESKTOP);
  await nextFrame(page);
  check(width <= PHONE.width, `the page is ${width} px wide at ${PHONE.width} px; too wide: ${wide || "unknown"}`);
}

async function printKeepsEverything(page) {
  await page.emulateMedia({ media: "print" });
  const hidden = await page.evaluate(() => {
    const parts = [...document.querySelectorAll("table, img")];
    const gone = parts.filter((e) => !e.closest("details:not([open])") && !e.checkVisibility({ visibilityProperty: true }));
    return gone.map((e) => e.id || e.alt || e.tagName).join(", ");
  });
  await page.emulateMedia({ media: "screen" });
  check(!hidden, `not on paper: ${hidden}`);
}

async function bothSchemesAreReadable(page) {
  for (const colorScheme of ["light", "dark"]) {
    await page.emulateMedia({ colorScheme });
    await page.evaluate(() => scrollTo(0, 0));
    await page.screenshot(shot(`desktop-${colorScheme}`));
    const alike = await page.evaluate(() => {
      const style = getComputedStyle(document.body);
      return style.color === style.backgroundColor;
    });
    check(!alike, `text has the colour of the page in the ${colorScheme} scheme`);
  }
  await page.emulateMedia({ colorScheme: "light" });
}

// --- Pictures, compared inside of the browser as that can read PNG

const percent = (share) => `${(100 * share).toFixed(1)} %`;

const shot = (name) => ({ path: join(shots, `${name}.png`) });

// Whether something becomes true: software takes its time to draw.
async function eventually(page, holds) {
  for (let i = 0; i < 50; i++) {
    if (await holds()) return true;
    await page.waitForTimeout(100);
  }
  return false;
}

// The canvas once two screenshots in a row are alike.
async function settled(page, canvas) {
  let last = await canvas.screenshot();
  const isAlike = async () => {
    const next = await canvas.screenshot(shot("surface-before"));
    const alike = next.equals(last);
    last = next;
    return alike;
  };
  check(await eventually(page, isAlike), "the canvas does not come to rest");
  return last;
}

async function pixels(page, pictures, judge) {
  const blank = await page.context().newPage();
  try {
    const urls = pictures.map((png) => `data:image/png;base64,${png.toString("base64")}`);
    return await blank.evaluate(
      async ([urls, judge]) => {
        const data = [];
        for (const url of urls) {
          const image = new Image();
          image.src = url;
          await image.decode();
          const canvas = new OffscreenCanvas(image.width, image.height);
          const context = canvas.getContext("2d");
          context.drawImage(image, 0, 0);
          data.push(context.getImageData(0, 0, image.width, image.height).data);
        }
        return new Function(`return (${judge})`)()(...data);
      },
      [urls, judge.toString()],
    );
  } finally {
    await blank.close();
  }
}

const colours = (page, png) =>
  pixels(page, [png], (data) => {
    const seen = new Set();
    for (let i = 0; i < data.length; i += 4) seen.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
    return { count: seen.size };
  });

// The share of pixels that are not background.
const covered = (page, png) =>
  pixels(page, [png], (data) => {
    let shown = 0;
    for (let i = 0; i < data.length; i += 4) if (Math.min(data[i], data[i + 1], data[i + 2]) < 250) shown++;
    return { share: (4 * shown) / data.length };
  });

// The share of pixels that differ by more than a fifth of the range in a channel.
const difference = (page, a, b) =>
  pixels(page, [a, b], (a, b) => {
    if (a.length !== b.length) return { share: 1 };
    let different = 0;
    for (let i = 0; i < a.length; i += 4) {
      const apart = Math.max(...[0, 1, 2].map((c) => Math.abs(a[i + c] - b[i + c])));
      if (apart > 51) different++;
    }
    return { share: (4 * different) / a.length };
  });

// --- The run

const CHECKS = [
  everyImageShows,
  everyPictureIsDescribed,
  bothSchemesAreReadable,
  everyTableSorts,
  filtersHideRows,
  surfacesTurn,
  printKeepsEverything,
  phoneDoesNotScrollSideways,
];

async function main() {
  check(page_path && shots, "usage: node report.test.mjs REPORT/index.html SCREENSHOTS");
  check(existsSync(page_path), `no report at ${page_path}`);
  mkdirSync(shots, { recursive: true });
  const browser = await chromium.launch({ executablePath, args: FLAGS });
  const failures = [];
  try {
    const context = await browser.newContext({ viewport: DESKTOP });
    const page = await context.newPage();
    const complaints = [];
    page.on("pageerror", (error) => complaints.push(error.message));
    page.on("console", (message) => {
      if (["error", "warning"].includes(message.type())) complaints.push(`${message.type()}: ${message.text()}`);
    });
    page.on("request", (request) => {
      if (/^(https?|ftp|wss?):/.test(request.url())) complaints.push(`asks the network for ${request.url()}`);
    });
    await page.goto(pathToFileURL(resolve(page_path)).href);
    const quiet = async () => check(!complaints.length, complaints.join("; "));
    for (const one of [...CHECKS, quiet]) {
      const name = (one === quiet ? "noErrorsNorRequests" : one.name).replace(/[A-Z]/g, (l) => ` ${l.toLowerCase()}`);
      try {
        const more = await one(page);
        console.log(`ok      ${name}${more ? ` (${more})` : ""}`);
      } catch (error) {
        failures.push(name);
        console.log(`FAILED  ${name}: ${error.message}`);
      }
    }
  } finally {
    await browser.close();
  }
  check(!failures.length, `${failures.length} of ${CHECKS.length + 1} checks failed; screenshots in ${shots}`);
}

main().catch((error) => {
  console.error(`error: ${error.message}`);
  process.exitCode = 1;
});
