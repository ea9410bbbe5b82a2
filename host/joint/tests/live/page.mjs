// The page of a twin at URL in headless Chromium: plots move, buttons and sliders command the joint, no request leaves
// the page's own server. With a third argument, screenshots are kept in that folder.

import { chromium } from "playwright-core";
import assert from "node:assert";

const [, , url, folder] = process.argv;
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM || "/usr/bin/chromium",
  args: [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
  ],
});
const shoot = async (page, name) => {
  if (folder) await page.screenshot({ path: `${folder}/${name}.png`, fullPage: true });
};
const errors = [];
const open = async (options) => {
  const page = await (await browser.newContext(options)).newPage();
  page.on("console", (message) => {
    if (message.type() === "error") errors.push(message.text());
  });
  page.on("pageerror", (error) => errors.push(String(error)));
  page.on("request", (request) => assert.ok(request.url().startsWith(url), `the page asked for ${request.url()}`));
  await page.goto(url);
  await page.waitForFunction(() => document.getElementById("state").textContent === "live");
  return page;
};
const page = await open({ viewport: { width: 1440, height: 1100 }, colorScheme: "light" });
const shown = (id) => page.locator(`#${id}`).textContent();
const until = (what, condition, argument) =>
  page.waitForFunction(condition, argument, { timeout: 60_000 }).catch((error) => {
    throw new Error(`${what}: ${error}`);
  });
const text = (id, words) =>
  until(`${id} shows ${words}`, ([id, words]) => document.getElementById(id).textContent.includes(words), [id, words]);
const slide = (id, value) =>
  page.locator(`#${id}`).evaluate((slider, value) => {
    slider.value = value;
    slider.dispatchEvent(new Event("input"));
  }, String(value));

const time = Number(await shown("time"));
await until("time goes on", (time) => Number(document.getElementById("time").textContent) > time + 0.2, time);
await until("a thousand samples a second", () => Number(document.getElementById("rate").textContent) > 500);
await text("drive-mode", "client");

await page.click('#modes button[data-mode="swing"]');
await text("drive-mode", "swing");
await text("drive-state", "enabled");
await until("the teeth cross the gap", () =>
  /crossed in [\d.]+ ms/.test(document.getElementById("crossing-value").dataset.text),
);
const rate = Number(/sampled at ([\d.]+) kHz/.exec(await page.locator("#crossing-value").getAttribute("data-text"))[1]);
assert.ok(rate > 4, `a crossing at ${rate} kHz`);
await page.waitForTimeout(folder ? 5000 : 500);
await shoot(page, "swing-light");

await slide("backlash", 90);
await text("gap-value", "90.0 µm");
await slide("load", 30);
await text("message", "accepted");
await page.selectOption("#fault", "encoder_missing_counts");
await page.click("#inject");
await text("message", "accepted");
await page.click("#end-faults");
await page.waitForTimeout(folder ? 5000 : 100);
await shoot(page, "worn-light");
await page.click("#theme");
await page.waitForTimeout(300);
await shoot(page, "worn-dark");

await slide("supply", 0);
await text("drive-fault", "under voltage");
await shoot(page, "fault-dark");
await slide("supply", 48);
await text("drive-bus", "48.0 V");
await page.click("#clear-fault");
await text("drive-fault", "none");
await page.click('#modes button[data-mode="client"]');
await text("drive-mode", "client");
await text("drive-state", "disabled");

await page.click("#pause");
await until("the last sample is drawn", () => document.getElementById("time").textContent === current.end.toFixed(3));
const still = await shown("time");
await page.waitForTimeout(400);
assert.equal(await shown("time"), still, "a paused page stands still");
await page.click("#pause");

// The script of the page with samples of this test: its own class, functions and variables.
const rms = await page.evaluate(() => {
  const joint = new Joint({ planets: 1 });
  const add = (time, error) => {
    joint.time[joint.count] = time;
    joint.columns.get("error_rad")[joint.count++] = error;
  };
  for (let index = 0; index < 900; index++) add(index / 1e3, 0);
  for (let index = 0; index < 1000; index++) add(0.9 + index / 1e4, 1);
  return joint.rms("error_rad", 0);
});
assert.ok(Math.abs(rms - Math.sqrt(0.1)) < 0.01, `error 1 for a tenth of the time has the RMS ${rms}`);
const afterPause = await page.evaluate(() => {
  const joint = current,
    width = numbers.length + 2 * joint.meshes;
  // One sample that touches a side with all meshes.
  const row = (side) => {
    const view = new DataView(new ArrayBuffer(HEADER + 4 * width));
    view.setUint32(0, joint.source.number, true);
    view.setUint32(4, lost, true);
    view.setUint32(8, 1, true);
    view.setFloat64(HEADER - 8, joint.end + 1e-4, true);
    for (let column = 1; column < width; column++) view.setFloat32(HEADER + 4 * column, NaN, true);
    for (let mesh = 0; mesh < joint.meshes / 2; mesh++) {
      view.setFloat32(HEADER + 4 * (numbers.length + mesh), side, true);
    }
    return view.buffer;
  };
  const crossingsOf = (between) => {
    samples(row(1));
    const before = joint.crossings;
    between();
    samples(row(-1));
    return joint.crossings - before;
  };
  const pause = () => {
    paused = true;
    samples(row(-1));
    paused = false;
  };
  const known = [supplyKnown, (select(joint), supplyKnown)];
  return { seen: crossingsOf(() => {}), hidden: crossingsOf(pause), known };
});
assert.deepEqual(afterPause, { seen: 1, hidden: 0, known: [true, false] });

const phone = await open({ viewport: { width: 420, height: 900 }, colorScheme: "dark" });
const wide = await phone.evaluate(() => document.documentElement.scrollWidth);
assert.ok(wide <= 420, `the page is ${wide} pixels wide on a phone`);
await phone.waitForTimeout(500);
await shoot(phone, "phone-dark");
assert.deepEqual(errors, []);
await browser.close();
console.log(`crossing at ${rate} kHz`);
