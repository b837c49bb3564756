// What the hand, the keys and the panel of the page do.
import assert from 'node:assert/strict';
import { testbedAt, until } from './browser.mjs';

const header = (page) => page.evaluate(() => testbed.header);
const bodies = (header) => header.ledger.counts.find(([name]) => name === 'bodies')[1];
/** After everything that was asked for. */
const settled = (page) => page.evaluate(async () => {
    await testbed.app.loop.want('ledger');
    return testbed.header;
});

/** Where the page shows what its camera looks at. */
async function middle(page) {
    const { x, y, width, height } = await page.locator('#canvas').boundingBox();
    const lift = await page.evaluate(() => testbed.app.view.camera.lift);
    return [x + width / 2, y + (height / 2) * (1 - lift)];
}

/** Opens dominoes with a box of 1 m before the eye, which looks at it. */
async function aBoxBeforeTheEye(page) {
    await page.evaluate(async () => {
        await testbed.open('dominoes');
        await testbed.do({ do: 'spawn', shape: 'box', position: [0, 6, 0], size: 1 });
        testbed.camera({ eye: [0, 7, 9], lookAt: [0, 6, 0] });
    });
    return middle(page);
}

/** Height and speed of what is in the middle of the picture. */
async function inspected(page) {
    const [x, y] = await middle(page);
    await page.mouse.click(x, y);
    return (await settled(page)).inspected;
}

export async function aBodyIsGrabbedAndThrown(page) {
    const [x, y] = await aBoxBeforeTheEye(page);
    const first = await inspected(page);
    assert.equal(first.kind, 'dynamic');
    await page.mouse.move(x, y);
    await page.mouse.down();
    assert.ok((await settled(page)).grabbed, 'it is in the hand');
    await page.mouse.move(x + 90, y - 60, { steps: 4 });
    await settled(page);
    await page.evaluate(() => testbed.step(60));
    // It hangs at the hand, to the right, and does not fall, though it weighs a ton.
    const { inspected: { position: held }, grabbed } = await header(page);
    assert.ok(held[0] > first.position[0] + 0.5 && held[1] > first.position[1] - 0.2, `${held}`);
    assert.ok(Math.hypot(...[0, 1, 2].map((i) => grabbed[i] - grabbed[i + 3])) < 0.2, `${grabbed}`);
    await page.mouse.move(x - 200, y - 60, { steps: 2 });
    await settled(page);
    await page.evaluate(() => testbed.step(6));
    await page.mouse.up();
    assert.equal((await settled(page)).grabbed, undefined);
    await page.evaluate(() => testbed.step(6));
    const thrown = (await header(page)).inspected;
    assert.ok(thrown.velocity[0] < -1, `it flies on: ${thrown.velocity}`);
}

export async function keysShootSpawnExplodeAndRemove(page) {
    const [x, y] = await aBoxBeforeTheEye(page);
    await page.mouse.move(x, y);
    const first = bodies(await settled(page));
    await page.keyboard.press('f');
    assert.equal(bodies(await settled(page)), first + 1, 'a ball is shot');
    await page.evaluate(() => testbed.step(20));
    await page.keyboard.press('b');
    await aBoxBeforeTheEye(page);
    await page.mouse.move(x, y);
    await page.selectOption('#shape', 'ragdoll');
    await page.keyboard.press('g');
    assert.ok(bodies(await settled(page)) > first + 5, 'a figure is spawned');
    await page.selectOption('#shape', 'box');
    await aBoxBeforeTheEye(page);
    await page.mouse.move(x, y + 20);
    await page.keyboard.press('x');
    await settled(page);
    await page.evaluate(() => testbed.step(1));
    const { velocity } = await inspected(page);
    assert.ok(Math.hypot(...velocity) > 0.5, `it is blown away: ${velocity}`);
    await aBoxBeforeTheEye(page);
    await page.mouse.move(x, y);
    const before = bodies(await settled(page));
    await page.keyboard.press('Delete');
    assert.equal(bodies(await settled(page)), before - 1, 'it is removed');
    assert.equal((await header(page)).error, undefined);
}

export async function aStepBackIsTheSameBits(page) {
    await page.evaluate(() => testbed.open('ragdolls'));
    const hashes = [];
    for (let i = 0; i < 12; i++) {
        await page.evaluate(() => testbed.step(5));
        hashes.push((await header(page)).hash);
    }
    for (let i = 10; i >= 5; i--) {
        await page.evaluate(() => testbed.back(5));
        assert.equal((await header(page)).hash, hashes[i]);
    }
    await page.evaluate(() => testbed.seek(10));
    assert.equal((await header(page)).hash, hashes[1]);
    await page.evaluate(() => testbed.step(50));
    assert.equal((await header(page)).hash, hashes[11]);
    // By hand: two buttons and the line.
    await page.click('#back');
    await page.click('#back');
    assert.equal((await settled(page)).step, 58);
    await page.click('#step');
    assert.equal((await settled(page)).step, 59);
    await page.fill('#timeline', '20');
    assert.equal((await settled(page)).step, 20);
    assert.equal(await page.getAttribute('#play', 'aria-label'), 'Play');
}

export async function settingsAreThoseOfTheirTime(page) {
    await page.evaluate(() => testbed.open('pile', { size: 64 }));
    await page.fill('#set-substeps', '8');
    await page.selectOption('#set-continuous_method', 'speculative');
    await page.check('#set-sleeping');
    await page.fill('#set-budget', '64');
    await page.locator('#set-budget').blur();
    const { settings } = await settled(page);
    assert.deepEqual([settings.substeps, settings.continuous_method, settings.sleeping], [8, 'speculative', true]);
    assert.equal(settings.budget, 64 << 20);
    await page.evaluate(() => testbed.step(3));
    await page.fill('#set-substeps', '2');
    assert.equal((await settled(page)).settings.substeps, 2);
    await page.evaluate(() => testbed.step(2));
    await page.evaluate(() => document.activeElement.blur());
    await page.evaluate(() => testbed.seek(1));
    assert.equal((await header(page)).settings.substeps, 8);
    assert.equal(await page.inputValue('#set-substeps'), '8');
    const before = bodies(await settled(page));
    await page.fill('#set-size', '100');
    await until(page, (n) => testbed.header.ledger?.counts[0][1] > n, before);
    // The settings stay with a new size.
    assert.equal((await settled(page)).settings.continuous_method, 'speculative');
    await page.fill('#set-budget', '');
    await page.locator('#set-budget').blur();
    assert.equal((await settled(page)).settings.budget, null);
}

export async function theAddressIsTheState(browser, address, size) {
    const page = await testbedAt(browser, `${address}#sample=pile&size=80&play=0`, size);
    await until(page, () => testbed.header.name === 'pile');
    await page.fill('#set-substeps', '6');
    await page.fill('#set-gravity', '-3.5');
    await page.selectOption('#rate', '120');
    await page.selectOption('#speed', '0.25');
    await page.check('#layer-normals');
    await page.check('#layer-real');
    const [x, y] = await middle(page);
    await page.mouse.move(x, 200);
    await page.keyboard.down('Shift');
    await page.mouse.down();
    await page.mouse.move(x + 120, y - 40, { steps: 3 });
    await page.mouse.up();
    await page.keyboard.up('Shift');
    await settled(page);
    await page.waitForTimeout(400);
    const state = () => [location.hash, document.title, testbed.header.settings, testbed.header.dt, testbed.app.loop.speed];
    const first = await page.evaluate(state);
    assert.match(first[0], /sample=pile&size=80&.*gravity=0,-3.5,0.*layers=sleep,normals,real.*camera=/);
    const other = await testbedAt(browser, address + first[0], size);
    await until(other, () => testbed.app.loop.speed === 0.25 && testbed.header.settings.substeps === 6);
    await other.waitForTimeout(400);
    assert.deepEqual(await other.evaluate(state), first);
    // A page to come back to.
    await other.click('#list button[data-name=dominoes]');
    await until(other, () => testbed.header.name === 'dominoes');
    await other.goBack();
    await until(other, () => testbed.header.name === 'pile');
    for (const { problems } of [page, other]) assert.deepEqual(problems, []);
    await Promise.all([page, other].map((page) => page.context().close()));
}

export async function samplesAreFoundAndRead(page) {
    await page.fill('#search', 'domino');
    const shown = await page.locator('#list button:visible').allTextContents();
    assert.ok(shown.length >= 1 && shown.length < 5, `${shown}`);
    await page.press('#search', 'Enter');
    await until(page, () => testbed.header.name === 'dominoes');
    await page.fill('#search', '');
    await page.click('#source-open');
    assert.match(await page.textContent('#code'), /fn start\(\)/);
    assert.ok((await page.locator('#code .keyword').count()) > 3);
    await page.click('#source .close');
    await page.evaluate(() => testbed.play(false));
}
