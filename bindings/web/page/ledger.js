// The figures beside the scene.

import { MARKS } from './renderer.js';

/** Colours of the categories of memory, in the order of reports. */
const CATEGORIES = ['#4d82c4', '#8f6fc0', '#6a9a5b', '#e3a23c', '#d9604c', '#3aa39a', '#b0773f', '#9aa3ad', '#c5cbd3', '#c04a86'];
const KEPT = 60;

const element = (id) => document.getElementById(id);
const count = (n) => n.toLocaleString('en').replaceAll(',', '\u202f');

function bytes(n) {
    if (n < 1024) return `${n} B`;
    return n < 1 << 20 ? `${(n / 1024).toFixed(1)} KiB` : `${(n / (1 << 20)).toFixed(1)} MiB`;
}

/** A time in a suitable unit; a clock of the browser may have no more than tenths of a millisecond. */
function time(ms) {
    return ms < 1 ? `${Math.round(ms * 1000)} µs` : `${ms.toFixed(2)} ms`;
}

function rows(table, lines) {
    const cells = ({ name, value, colour }) => {
        const dot = colour ? `<i class="dot" style="background:${colour}"></i>` : '';
        return `<tr><td>${dot}${name}</td><td>${value}</td></tr>`;
    };
    table.innerHTML = lines.map(cells).join('');
}

export class Ledger {
    constructor() {
        this.clear();
    }

    /** Forgets all times. */
    clear() {
        this.times = [];
    }

    addTime(ms) {
        this.times.push(ms);
        if (this.times.length > 2 * KEPT) this.times.shift();
    }

    show(report) {
        const last = this.times.slice(-KEPT).sort((a, b) => a - b);
        const median = last.length ? last[last.length >> 1] : undefined;
        element('time').value = median === undefined ? '–' : time(median);
        this.course(median);
        rows(element('counts'), [
            { name: 'step', value: `${count(report.steps)} <small>(${report.time.toFixed(2)} s)</small>` },
            { name: 'bodies', value: count(report.bodies) },
            { name: 'asleep', value: count(report.asleep) },
            { name: 'joints', value: count(report.joints) },
            { name: 'pairs', value: count(report.pairs) },
            { name: 'manifolds', value: count(report.manifolds) },
            { name: 'real points', value: count(report.real), colour: MARKS[0] },
            { name: 'potential points', value: count(report.potential), colour: MARKS[1] },
            { name: 'ghosts', value: count(report.ghosts), colour: MARKS[2] },
            { name: 'held by the guard', value: count(report.held) },
            { name: 'steps to go back', value: `${count(report.past)} <small>(${bytes(report.past_bytes)})</small>` },
        ]);
        const total = report.bytes.reduce((sum, [, , reserved]) => sum + reserved, 0);
        element('total').value = bytes(total);
        element('bar').innerHTML = report.bytes
            .map(([, , n], i) => `<div style="width:${(100 * n) / total}%;background:${CATEGORIES[i]}"></div>`)
            .join('');
        const category = ([name, , reserved], i) => ({ name, value: bytes(reserved), colour: CATEGORIES[i] });
        rows(element('bytes'), report.bytes.map(category));
        element('hash').textContent = report.hash;
    }

    /** Times of the last steps as columns, with a line at the median. */
    course(median) {
        const canvas = element('course');
        const ratio = window.devicePixelRatio || 1;
        [canvas.width, canvas.height] = [canvas.clientWidth, canvas.clientHeight].map((n) => Math.round(n * ratio));
        const ink = canvas.getContext('2d');
        // A few columns may be cut off, so that one slow step doesn't flatten all others.
        const sorted = this.times.slice().sort((a, b) => a - b);
        const most = Math.max(1e-3, 1.15 * (sorted[Math.floor(0.97 * (sorted.length - 1))] ?? 0));
        const wide = canvas.width / (2 * KEPT);
        ink.fillStyle = '#9dbbdc';
        this.times.forEach((t, i) => {
            const high = Math.max(ratio, (t / most) * canvas.height);
            ink.fillRect(i * wide, canvas.height - high, wide - 0.5 * ratio, high);
        });
        if (median === undefined) return;
        ink.fillStyle = '#2f6fb5';
        ink.fillRect(0, canvas.height * (1 - median / most), canvas.width, ratio);
    }
}
