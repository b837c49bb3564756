// The figures beside the scene.

import { MARKS } from './draw/marks.js';
import { element, escaped, figure } from './page.js';

/** Colours of the categories of memory and of the stages, in the order of reports. */
const CATEGORIES = ['#4d82c4', '#8f6fc0', '#6a9a5b', '#e3a23c', '#d9604c', '#3aa39a', '#b0773f', '#9aa3ad', '#c5cbd3', '#c04a86'];
const KEPT = 60;
/** Counts that are shown though they are zero; others only where they are not. */
const ALWAYS = ['bodies', 'asleep', 'joints', 'pairs', 'manifolds', 'real', 'potential', 'ghosts'];

const count = (n) => (Number.isInteger(n) ? n.toLocaleString('en').replaceAll(',', '\u202f') : figure(n));

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

    /** A step's time [ms]. */
    addTime(ms) {
        this.times.push(ms);
        if (this.times.length > 2 * KEPT) this.times.shift();
    }

    /** `header` of an answer with a ledger. */
    show(header) {
        const { ledger, past, past_bytes, hash } = header;
        const last = this.times.slice(-KEPT).sort((a, b) => a - b);
        const median = last.length ? last[last.length >> 1] : undefined;
        element('time').value = median === undefined ? '–' : time(median);
        this.course(median);
        this.stages(ledger.stages);
        const colours = { real: MARKS[0], potential: MARKS[1], ghosts: MARKS[2] };
        const shown = ([name, n]) => typeof n === 'number' && (n !== 0 || ALWAYS.includes(name));
        const row = ([name, n]) => ({ name: name.replaceAll('_', ' '), value: count(n), colour: colours[name] });
        rows(element('counts'), [
            ...ledger.counts.filter(shown).map(row),
            { name: 'steps to go back', value: `${count(past)} <small>(${bytes(past_bytes)})</small>` },
        ]);
        const total = ledger.bytes.reduce((sum, [, , reserved]) => sum + reserved, 0);
        element('total').value = bytes(total);
        const colour = (i) => CATEGORIES[i % CATEGORIES.length];
        element('bytes-bar').innerHTML = ledger.bytes
            .map(([, , n], i) => `<div style="width:${(100 * n) / Math.max(1, total)}%;background:${colour(i)}"></div>`)
            .join('');
        const category = ([name, live, reserved], i) => ({
            name,
            value: `${bytes(live)} <small>of ${bytes(reserved)}</small>`,
            colour: colour(i),
        });
        rows(element('bytes'), ledger.bytes.map(category));
        element('hash').textContent = hash;
    }

    /** Times of the stages, where there is a clock for them. */
    stages(stages) {
        element('stages').closest('details').hidden = stages.length === 0;
        const sum = stages.reduce((sum, [, ms]) => sum + ms, 0);
        element('stages-total').value = sum > 0 ? time(sum) : '';
        const most = Math.max(1e-9, ...stages.map(([, ms]) => ms));
        const bar = (ms, i) => `<i class="bar" style="width:${(60 * ms) / most}px;background:${CATEGORIES[i % CATEGORIES.length]}"></i>`;
        rows(element('stages'), stages.map(([name, ms], i) => ({ name, value: `${bar(ms, i)} ${time(ms)}` })));
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

/** What is known of a body, in the order in which it is shown. */
const KNOWN = ['body', 'kind', 'shape', 'mass', 'position', 'velocity', 'spin', 'asleep', 'contacts', 'joints'];

/** Shows what is known of the inspected body, as the engine says it. */
export function showInspected(inspected) {
    element('inspector').hidden = !inspected;
    if (!inspected) return;
    const text = (value) => {
        if (Array.isArray(value)) return value.map((x) => x.toFixed(Math.abs(x) < 10 ? 3 : 1)).join(' &nbsp;');
        if (typeof value === 'boolean') return value ? 'yes' : 'no';
        if (typeof value === 'number') return figure(value);
        // A body without a name is told by its handle.
        return escaped(String(value).replace(/^BodyHandle \{ slot: (\d+).*$/, 'number $1').replaceAll('_', ' '));
    };
    const units = { mass: 'kg', position: 'm', velocity: 'm/s', spin: 'rad/s', density: 'kg/m³', point: 'm' };
    const order = (name) => (KNOWN.includes(name) ? KNOWN.indexOf(name) : KNOWN.length);
    const line = ([name, value]) => ({ name: units[name] ? `${name} <small>[${units[name]}]</small>` : name, value: text(value) });
    const known = Object.entries(inspected).filter(([name]) => name !== 'shapes');
    rows(element('inspected'), known.sort(([a], [b]) => order(a) - order(b)).map(line));
}
