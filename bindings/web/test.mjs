// Drives the page and a report in a headless Chromium; `scripts/web test` builds what it needs. Pictures of what it
// saw are in target/web-test/.
import assert from 'node:assert/strict';
import { mkdir, readFile } from 'node:fs/promises';
import { HERE, launch, native, opened, testbedAt, until } from './browser.mjs';
import { serve } from './serve.mjs';
import * as tools from './tools.mjs';

/** Time that each sample is run for, in its own time [s]. */
const SECONDS = 5;

/** Scene, steps and hash, of the example that asserts them on every processor. */
async function pinned() {
    const text = await readFile(new URL('../../examples/same_bits.rs', import.meta.url), 'utf8');
    const rows = [...text.matchAll(/\("(\w+)", (\d+), 0x([\w_]+)\)/g)];
    return rows.map(([, name, steps, hash]) => [name, Number(steps), hash.replaceAll('_', '').toLowerCase()]);
}

function notBlank({ colours, height, error }, what) {
    // The sky alone has one colour in each row.
    assert.ok(colours > 1.1 * height, `${what}: ${colours} colours`);
    assert.equal(error, 0, what);
}

async function hashesAreTheOnesPinned(page) {
    const rows = await pinned();
    assert.ok(rows.length >= 5 && rows.some(([name]) => name === 'talk'));
    const hash = () => page.evaluate(() => testbed.header.hash);
    for (const [name, count, wanted] of rows) {
        await page.evaluate(([name, count]) => testbed.open(name).then(() => testbed.step(count)), [name, count]);
        assert.equal(await hash(), wanted, name);
        // Back and again: the same bits.
        await page.evaluate(() => testbed.back(7));
        assert.notEqual(await hash(), wanted, name);
        await page.evaluate(() => testbed.step(7));
        assert.equal(await hash(), wanted, `${name}, after stepping back`);
    }
}

/** Runs a sample, and draws it at last: what went wrong, and what is seen. */
const run = (page, name) =>
    page.evaluate(async ([name, seconds]) => {
        const opened = await testbed.open(name);
        const began = performance.now();
        const { error, step } = await testbed.step(Math.round(seconds / opened.dt));
        const wrong = testbed.poses.findIndex((x) => !Number.isFinite(x));
        testbed.camera();
        return { refused: opened.error ?? error, step, wrong, ms: performance.now() - began, ...testbed.draw() };
    }, [name, SECONDS]);

async function everySampleRuns(page, folder) {
    const names = await page.evaluate(() => testbed.catalogue.map((entry) => entry.name));
    await mkdir(folder, { recursive: true });
    await page.evaluate(() => [testbed.still(true), testbed.bare(true)]);
    const slow = [];
    for (const name of names) {
        const { refused, step, wrong, ms, ...picture } = await run(page, name);
        assert.equal(refused, undefined, name);
        assert.ok(step > 0 && wrong < 0, `${name}: number ${wrong} of the poses`);
        notBlank(picture, name);
        await page.screenshot({ path: new URL(`${name}.png`, folder).pathname });
        assert.deepEqual(page.problems, [], name);
        slow.push([ms, name]);
    }
    await page.evaluate(() => [testbed.still(false), testbed.bare(false)]);
    slow.sort(([a], [b]) => b - a);
    const worst = slow.slice(0, 3).map(([ms, name]) => `${name} ${(ms / 1000).toFixed(1)} s`);
    console.log(`    ${names.length} samples of ${SECONDS} s each; the slowest: ${worst.join(', ')}`);
}

async function thePageFitsATelephone(browser, address) {
    const touch = { hasTouch: true, isMobile: true, deviceScaleFactor: 2 };
    const page = await testbedAt(browser, `${address}#sample=dominoes&play=0`, { width: 390, height: 760 }, touch);
    const fits = () => page.evaluate(() => document.documentElement.scrollWidth <= innerWidth);
    assert.ok(await fits());
    notBlank(await page.evaluate(() => testbed.draw()), 'telephone');
    await page.screenshot({ path: new URL('telephone.png', HERE).pathname });
    // One finger orbits, two zoom.
    const camera = () => page.evaluate(() => [testbed.app.view.camera.yaw, testbed.app.view.camera.distance]);
    const session = await page.context().newCDPSession(page);
    const touches = (type, ...points) =>
        session.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
    const first = await camera();
    await touches('touchStart', [120, 200]);
    for (const x of [140, 170, 220]) {
        await touches('touchMove', [x, 205]);
        await page.waitForTimeout(60);
    }
    await touches('touchEnd');
    const turned = await camera();
    assert.notEqual(turned[0], first[0], 'one finger turns');
    await touches('touchStart', [150, 300]);
    await touches('touchStart', [150, 300], [230, 300]);
    for (const by of [10, 30, 60]) await touches('touchMove', [150 - by, 300], [230 + by, 300]);
    await touches('touchEnd');
    assert.ok((await camera())[1] < 0.8 * turned[1], 'two fingers zoom');
    // Sides come in and go.
    await page.tap('#samples-open');
    await page.waitForTimeout(300);
    await page.screenshot({ path: new URL('telephone-samples.png', HERE).pathname });
    await page.tap('#list button[data-name=windmill]');
    await until(page, () => testbed.header.name === 'windmill');
    await page.waitForSelector('#samples', { state: 'hidden' });
    await page.tap('#panel-open');
    await page.waitForTimeout(300);
    await page.screenshot({ path: new URL('telephone-panel.png', HERE).pathname });
    await page.tap('#panel .close');
    await page.waitForTimeout(300);
    await page.evaluate(() => testbed.play(false));
    // Taps do what is chosen.
    const bodies = () => page.evaluate(() => testbed.do().then(({ ledger }) => ledger.counts[0][1]));
    const before = await bodies();
    await page.locator('#tools label', { hasText: 'Shoot' }).tap();
    await page.touchscreen.tap(200, 250);
    await page.evaluate(() => testbed.app.loop.want('ledger'));
    assert.equal(await bodies(), before + 1);
    assert.ok(await fits());
    assert.deepEqual(page.problems, []);
    await page.context().close();
}

/** The same page with the engine as a program of this machine. */
async function theProgramServesTheSamePage(browser) {
    const { address, end } = await native('testbed');
    try {
        const page = await testbedAt(browser, address, { width: 900, height: 600 });
        assert.equal(await page.evaluate(() => testbed.app.engine.kind), 'native');
        for (const name of ['dominoes', 'windmill', 'ragdolls']) {
            const { refused, wrong, ...picture } = await run(page, name);
            assert.ok(!refused && wrong < 0, name);
            notBlank(picture, name);
        }
        const stages = await page.evaluate(() => testbed.header.ledger.stages.length);
        assert.ok(stages > 3, 'stages have times');
        await page.screenshot({ path: new URL('native.png', HERE).pathname });
        assert.deepEqual(page.problems, []);
        // Nobody without the address gets in.
        const { status } = await fetch(new URL('/frame', address), { method: 'POST', body: '{}' });
        assert.ok(status >= 400, `${status}`);
        await page.context().close();
    } finally {
        end();
    }
}

async function aReportPlaysFromDisk(browser) {
    const page = await opened(browser, new URL('report/index.html', HERE).href, { width: 1100, height: 1000 });
    await until(page, () => Boolean(globalThis.player));
    await until(page, () => player.time > 2);
    await page.click('.player button');
    assert.equal(await page.evaluate(() => player.playing), false);
    const pixels = () => page.locator('.player canvas').screenshot();
    const first = await pixels();
    await page.fill('.player input', '100');
    assert.equal(await page.evaluate(() => player.time), 100);
    await page.evaluate(() => player.view.draw());
    assert.notDeepEqual(await pixels(), first);
    await page.screenshot({ path: new URL('report.png', HERE).pathname });
    // The film ends where the run ended, by the command's own account.
    const ran = JSON.parse(await readFile(new URL('run.json', HERE), 'utf8'));
    const ends = await page.evaluate(() => {
        const { film } = player;
        return Array.from({ length: film.bodies }, (_, i) => film.body(i, film.frames - 1, 0));
    });
    const bodies = ran.bodies.filter((body) => body.kind !== 'static');
    assert.equal(ends.length, bodies.length);
    ends.forEach(({ position, turn }, i) => {
        position.forEach((x, k) => assert.ok(Math.abs(x - bodies[i].position[k]) < 1e-3, `position of ${i}`));
        const cosine = turn.reduce((sum, x, k) => sum + x * bodies[i].rotation[k], 0);
        assert.ok(Math.abs(cosine) > 1 - 1e-6, `rotation of ${i}`);
    });
    assert.deepEqual(page.problems, []);
    await page.context().close();
}

const browser = await launch();
const server = await serve(0);
const only = process.argv[2] ?? '';
const began = performance.now();
/** One test, unless only others are wanted. */
async function test(work, ...given) {
    if (!work.name.includes(only)) return;
    const start = performance.now();
    await work(...given);
    console.log(`ok: ${work.name} (${((performance.now() - start) / 1000).toFixed(1)} s)`);
}
try {
    const address = `http://localhost:${server.address().port}/`;
    const size = { width: 1280, height: 800 };
    const small = await testbedAt(browser, `${address}#play=0`, { width: 480, height: 320 });
    await test(hashesAreTheOnesPinned, small);
    await test(everySampleRuns, small, new URL('samples/', HERE));
    assert.deepEqual(small.problems, []);
    await small.context().close();
    const page = await testbedAt(browser, `${address}#play=0`, size);
    for (const name of ['aBodyIsGrabbedAndThrown', 'keysShootSpawnExplodeAndRemove', 'aStepBackIsTheSameBits',
        'settingsAreThoseOfTheirTime', 'samplesAreFoundAndRead']) await test(tools[name], page);
    await page.screenshot({ path: new URL('page.png', HERE).pathname });
    assert.deepEqual(page.problems, []);
    await page.context().close();
    await test(tools.theAddressIsTheState, browser, address, size);
    await test(thePageFitsATelephone, browser, address);
    await test(theProgramServesTheSamePage, browser);
    await test(aReportPlaysFromDisk, browser);
    console.log(`all in ${((performance.now() - began) / 1000).toFixed(0)} s, and no error in any console`);
} finally {
    await browser.close();
    server.close();
}
