// Drives the page and a report in a headless Chromium; `scripts/web test` builds what it needs. Pictures of what it
// saw are in target/web-test/.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { serve } from './serve.mjs';

const HERE = new URL('../../target/web-test/', import.meta.url);
const { chromium } = createRequire(HERE)('playwright-core');

/** Scene, steps and hash, of the example that asserts them on every processor. */
async function pinned() {
    const text = await readFile(new URL('../../examples/same_bits.rs', import.meta.url), 'utf8');
    const rows = [...text.matchAll(/\("(\w+)", (\d+), 0x([\w_]+)\)/g)];
    return rows.map(([, name, steps, hash]) => [name, Number(steps), hash.replaceAll('_', '').toLowerCase()]);
}

/** A page on which no error goes unnoticed. */
async function opened(browser, address, size) {
    const page = await browser.newPage({ viewport: size });
    page.problems = [];
    page.on('console', (message) => {
        if (['error', 'warning'].includes(message.type())) page.problems.push(message.text());
    });
    page.on('pageerror', (error) => page.problems.push(String(error)));
    await page.goto(address);
    return page;
}

/** How many colours the middle of a picture has, and a sum that another picture has hardly. */
const pixels = (page, view) =>
    page.evaluate((path) => {
        const view = path.split('.').reduce((object, name) => object[name], globalThis);
        view.draw();
        const { gl } = view.renderer;
        const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
        const bytes = new Uint8Array(4 * width * height);
        gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
        const words = new Uint32Array(bytes.buffer);
        let sum = 0;
        for (const word of words) sum = (Math.imul(sum, 31) + word) | 0;
        return { colours: new Set(words).size, sum, error: gl.getError() };
    }, view);

function notBlank({ colours, error }) {
    // The sky alone has some hundred shades.
    assert.ok(colours > 1000, `${colours} colours`);
    assert.equal(error, 0);
}

const hash = (page) => page.evaluate(() => app.engine.report().hash);
const steps = (page, count) => page.evaluate((n) => { for (let i = 0; i < n; i++) app.step(); }, count);

async function hashesAreTheOnesPinned(page) {
    const rows = await pinned();
    assert.ok(rows.length >= 5 && rows.some(([name]) => name === 'talk'));
    for (const [name, count, wanted] of rows) {
        await page.evaluate((name) => { app.play(false); app.open(name); }, name);
        await steps(page, count);
        assert.equal(await hash(page), wanted, name);
        // Back and again: the same bits.
        await page.evaluate(() => { for (let i = 0; i < 7; i++) app.engine.back(); });
        assert.notEqual(await hash(page), wanted, name);
        assert.equal(await page.evaluate(() => app.engine.report().steps), count - 7);
        await steps(page, 7);
        assert.equal(await hash(page), wanted, `${name}, after stepping back`);
    }
}

async function everySceneIsShown(page) {
    const names = await page.evaluate(() => app.engine.scenes.map((scene) => scene.name));
    for (const name of names) {
        await page.evaluate((name) => app.open(name), name);
        const first = await pixels(page, 'app.view');
        await page.evaluate(() => { for (let i = 0; i < 40; i++) app.step(); app.show(0.5); });
        const later = await pixels(page, 'app.view');
        [first, later].forEach(notBlank);
        // The pyramid has to stand still.
        if (name !== 'large_pyramid') assert.notEqual(first.sum, later.sum, name);
        await page.screenshot({ path: new URL(`${name}.png`, HERE).pathname });
    }
}

async function controlsDoWhatTheySay(page) {
    const report = () => page.evaluate(() => app.engine.report());
    await page.selectOption('#scene', 'ragdolls');
    await page.waitForFunction(() => app.engine.report().steps > 3);
    await page.click('#play');
    const paused = (await report()).steps;
    await page.click('#step');
    assert.equal((await report()).steps, paused + 1);
    await page.click('#back');
    await page.click('#back');
    assert.equal((await report()).steps, paused - 1);
    assert.equal(await page.textContent('#play'), 'Play');
    // Settings: those of a step are back with it.
    await page.fill('#substeps', '8');
    assert.equal((await report()).substeps, 8);
    await page.click('#step');
    await page.click('#back');
    await page.click('#back');
    assert.equal((await report()).substeps, 4);
    assert.equal(await page.inputValue('#substeps'), '4');
    const before = (await report()).bodies;
    await page.fill('#size', '8');
    // Two more figures of eleven bones.
    assert.equal((await report()).bodies, before + 22);
    assert.equal((await report()).steps, 0);
    // Dragging orbits.
    const still = await pixels(page, 'app.view');
    await page.mouse.move(300, 300);
    await page.mouse.down();
    await page.mouse.move(420, 320, { steps: 3 });
    await page.mouse.up();
    assert.notEqual((await pixels(page, 'app.view')).sum, still.sum);
}

async function sleepersAreCounted(page) {
    await page.evaluate(() => { app.play(false); app.open('large_pyramid', 4); });
    await page.check('#sleeping');
    await steps(page, 120);
    await page.evaluate(() => app.show(0));
    // A pyramid of four rows is at rest from the start.
    assert.equal((await page.evaluate(() => app.engine.report())).asleep, 10);
    await page.uncheck('#sleeping');
}

async function thePageFitsATelephone(browser, address) {
    const page = await opened(browser, address, { width: 390, height: 760 });
    await page.waitForFunction('globalThis.app');
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
    notBlank(await pixels(page, 'app.view'));
    await page.screenshot({ path: new URL('telephone.png', HERE).pathname });
    assert.deepEqual(page.problems, []);
}

async function aReportPlaysFromDisk(browser) {
    const page = await opened(browser, new URL('report/index.html', HERE).href, { width: 1100, height: 1000 });
    await page.waitForFunction('globalThis.player');
    await page.waitForFunction(() => player.time > 2);
    await page.click('.player button');
    assert.equal(await page.evaluate(() => player.playing), false);
    const first = await pixels(page, 'player.view');
    await page.fill('.player input', '100');
    assert.equal(await page.evaluate(() => player.time), 100);
    const later = await pixels(page, 'player.view');
    [first, later].forEach(notBlank);
    assert.notEqual(first.sum, later.sum);
    await page.screenshot({ path: new URL('report.png', HERE).pathname });
    // The film ends where the run ended, by the command's own account.
    const run = JSON.parse(await readFile(new URL('run.json', HERE), 'utf8'));
    const ends = await page.evaluate(() => {
        const { film } = player;
        return Array.from({ length: film.bodies }, (_, i) => film.body(i, film.frames - 1, 0));
    });
    const bodies = run.bodies.filter((body) => body.kind !== 'static');
    assert.equal(ends.length, bodies.length);
    ends.forEach(({ position, turn }, i) => {
        position.forEach((x, k) => assert.ok(Math.abs(x - bodies[i].position[k]) < 1e-3, `position of ${i}`));
        const cosine = turn.reduce((sum, x, k) => sum + x * bodies[i].rotation[k], 0);
        assert.ok(Math.abs(cosine) > 1 - 1e-6, `rotation of ${i}`);
    });
    assert.deepEqual(page.problems, []);
}

const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    // The first is for machines whose only user is root; the last two draw without a graphics card.
    args: ['--no-sandbox', '--no-first-run', '--disable-quic', '--disable-background-networking',
        '--disable-component-update', '--disable-sync', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
const server = await serve(0);
try {
    const address = `http://localhost:${server.address().port}/`;
    const page = await opened(browser, address, { width: 1280, height: 800 });
    await page.waitForFunction('globalThis.app');
    for (const test of [hashesAreTheOnesPinned, everySceneIsShown, controlsDoWhatTheySay, sleepersAreCounted]) {
        await test(page);
        console.log(`ok: ${test.name}`);
    }
    assert.deepEqual(page.problems, []);
    for (const test of [() => thePageFitsATelephone(browser, address), () => aReportPlaysFromDisk(browser)]) await test();
    console.log('ok: a telephone, a report from disk, and no error in any console');
} finally {
    await browser.close();
    server.close();
}
