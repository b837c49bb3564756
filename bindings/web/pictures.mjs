// Pictures of a scene: `scripts/pictures` says how it is called.
import { existsSync } from 'node:fs';
import { mkdir, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { parseArgs } from 'node:util';
import { launch, native, testbedAt } from './browser.mjs';
import { animated } from './webp.mjs';

const text = { type: 'string' };
const { values, positionals } = parseArgs({
    allowPositionals: true,
    options: Object.fromEntries(
        ['steps', 'every', 'first', 'size', 'number', 'show', 'eye', 'look-at', 'settings', 'webp', 'quality'].map((name) => [name, text]),
    ),
});

function refuse(why) {
    console.error(why);
    process.exit(1);
}

const number = (name, usual, least = 0) => {
    const value = Number(values[name] ?? usual);
    if (!(value >= least)) refuse(`--${name} must be a number from ${least} on`);
    return value;
};
const place = (name) => {
    const numbers = values[name]?.split(',').map(Number);
    if (numbers && !(numbers.length === 3 && numbers.every(Number.isFinite))) refuse(`--${name} must be X,Y,Z`);
    return numbers;
};

const [scene, folder] = positionals;
const [steps, every, first] = [number('steps', 300), number('every', 1, 1), number('first', 0)];
const [width, height] = (values.size ?? '960x540').split('x').map(Number);
if (!(width > 0 && height > 0)) refuse('--size must be WxH');
const [eye, lookAt] = [place('eye'), place('look-at')];
if (Boolean(eye) !== Boolean(lookAt)) refuse('--eye and --look-at go together');
const quality = number('quality', 0.75);

/** The picture as it is on the canvas, drawn at twice the size for smooth edges. */
const still = (page, type) =>
    page.evaluate(([type, width, height, quality]) => {
        testbed.draw();
        const canvas = Object.assign(document.createElement('canvas'), { width, height });
        const ink = canvas.getContext('2d', { alpha: false });
        ink.imageSmoothingQuality = 'high';
        ink.drawImage(testbed.app.view.canvas, 0, 0, width, height);
        return canvas.toDataURL(type, quality).split(',')[1];
    }, [type, width, height, quality]).then((base64) => Buffer.from(base64, 'base64'));

const file = existsSync(scene);
const { address, end } = file ? await native('run', scene, '--view') : await native('testbed', '--scene', scene);
const browser = await launch();
try {
    const more = [values.number ? `&size=${values.number}` : '', values.settings ? `&${values.settings}` : ''].join('');
    const start = `${address.split('#')[0]}#sample=${file ? 'file' : encodeURIComponent(scene)}&play=0${more}`;
    const page = await testbedAt(browser, start, { width, height }, { deviceScaleFactor: 2 });
    await page.evaluate(() => {
        testbed.bare(true);
        testbed.still(true);
    });
    const refused = await page.evaluate(() => testbed.header.error);
    if (refused) throw new Error(refused);
    if (values.show !== undefined) await page.evaluate((names) => testbed.layers(names), values.show.split(',').filter(Boolean));
    if (eye) await page.evaluate((way) => testbed.camera(way), { eye, lookAt });
    const pictures = [];
    if (!values.webp) await mkdir(folder, { recursive: true });
    for (let step = 0; step <= steps; step += every) {
        if (step > 0) await page.evaluate((n) => testbed.step(n), every);
        if (step < first) continue;
        if (values.webp) {
            pictures.push(await still(page, 'image/webp'));
        } else {
            const name = `frame-${String(pictures.length).padStart(5, '0')}.png`;
            await writeFile(join(folder, name), await still(page, 'image/png'));
            pictures.push(name);
        }
        const { error } = await page.evaluate(() => testbed.header);
        if (error) throw new Error(error);
    }
    if (page.problems.length > 0) throw new Error(page.problems.join('\n'));
    const dt = await page.evaluate(() => testbed.header.dt);
    if (values.webp) await writeFile(values.webp, animated(pictures, { width, height, duration: every * dt * 1000 }));
    console.log(`${pictures.length} pictures: ${values.webp ?? folder}`);
} catch (error) {
    refuse(error.message);
} finally {
    await browser.close();
    end();
}
