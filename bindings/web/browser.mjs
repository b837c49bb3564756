// A headless Chromium for the test and for pictures, and the testbed of this machine as a program.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { createRequire } from 'node:module';
import { createInterface } from 'node:readline';

/** Where npm put what drives the browser, and where pictures go. */
export const HERE = new URL('../../target/web-test/', import.meta.url);

export function launch() {
    const { chromium } = createRequire(HERE)('playwright-core');
    return chromium.launch({
        executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
        // The first is for machines whose only user is root; the last two draw without a graphics card.
        args: ['--no-sandbox', '--no-first-run', '--disable-quic', '--disable-background-networking',
            '--disable-component-update', '--disable-sync', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
    });
}

/** A page on which no error goes unnoticed. */
export async function opened(browser, address, size, more = {}) {
    const context = await browser.newContext({ viewport: size, ...more });
    const page = await context.newPage();
    page.problems = [];
    page.on('console', (message) => {
        if (['error', 'warning'].includes(message.type())) page.problems.push(message.text());
    });
    page.on('pageerror', (error) => page.problems.push(String(error)));
    await page.goto(address);
    return page;
}

/** Waits until a function of the page is true. Playwright's own way needs `eval`, which the page forbids. */
export async function until(page, work, given) {
    const end = Date.now() + 30000;
    while (!(await page.evaluate(work, given))) {
        assert.ok(Date.now() < end, `${work} for 30 s`);
        await page.waitForTimeout(30);
    }
}

/** The same with the testbed in it, when that has opened its first sample. */
export async function testbedAt(browser, address, size, more) {
    const page = await opened(browser, address, size, more);
    try {
        await until(page, () => Boolean(globalThis.testbed));
    } catch {
        assert.fail(`no testbed: ${await page.textContent('#error')} ${page.problems}`);
    }
    return page;
}

/** Runs `backstop ARGUMENTS` until `end`; `address` is the one that it prints. */
export async function native(...options) {
    const program = process.env.BACKSTOP ?? new URL('../../target/debug/backstop', import.meta.url).pathname;
    const child = spawn(program, options, { stdio: ['ignore', 'pipe', 'inherit'] });
    const address = await new Promise((done, failed) => {
        createInterface({ input: child.stdout }).once('line', done);
        child.once('error', failed);
        child.once('exit', (code) => failed(new Error(`${program} ended with ${code}`)));
    });
    return { address, end: () => child.kill('SIGKILL') };
}
