// Settings and layers: controls that show what the engine says, and say what the user wants.

import { legible, MARKS } from './draw/marks.js';
import { element, figure, make, shows } from './page.js';

const css = (tone) => `rgb(${legible(tone).map((x) => Math.round(255 * x)).join(' ')})`;

const METHODS = ['one-pass', 'talk', 'speculative', 'linear-cast', 'conservative-advancement'];
const GUIDED = {
    substeps: { label: 'Substeps', least: 1, most: 16 },
    iterations: { label: 'Iterations', least: 1, most: 16 },
    gravity: { label: 'Gravity [m/s²]', least: -20, most: 10, step: 0.01, part: 1 },
    threads: { label: 'Threads', least: 1, most: 1 },
    continuous: { label: 'Continuous mode', choices: ['discrete', 'segment', 'volume'] },
    continuous_method: { label: 'Method', choices: METHODS },
    budget: { label: 'Budget [MiB]', scale: 1 << 20 },
    sleeping: { label: 'Sleeping' },
};
/** Shown elsewhere, or not as a number. */
const ELSEWHERE = ['dt', 'order'];

/** Layers: name, label, and the colour of its lines or points where it has one, as the engine has it. */
const LAYERS = [
    ['real', 'Contacts: real', MARKS[0]],
    ['potential', 'Contacts: potential', MARKS[1]],
    ['ghosts', 'Contacts: ghosts', MARKS[2]],
    ['normals', 'Normals and gaps', [235, 235, 235]],
    ['impulses', 'Impulses', [255, 150, 40]],
    ['joints', 'Joints', [190, 150, 255]],
    ['centres', 'Centres of mass', MARKS[3]],
    ['motion', 'Motion of swept bodies', [255, 225, 70]],
    ['aabbs', 'Bounds', [120, 205, 120]],
    ['fat_aabbs', 'Fat bounds', [60, 125, 75]],
    ['islands', 'Islands'],
    ['trees', 'Trees of joints'],
    ['colours', 'Solver colours'],
    ['sleep', 'Sleepers are dim'],
    ['wireframe', 'Wireframe'],
];
/** Those that the page draws by itself, of what it has anyway. */
const CONTACTS = ['real', 'potential', 'ghosts'];
const OWN = [...CONTACTS, 'sleep', 'wireframe'];
/** Layers that are shown at first. */
export const FIRST_LAYERS = ['sleep'];

/** The layers of a list of names that there are; `contacts` are three. */
export function knownLayers(names) {
    const all = [...names].flatMap((name) => (name === 'contacts' ? CONTACTS : [name]));
    return all.filter((name) => LAYERS.some(([known]) => known === name));
}

/** The names of layers that an engine has to draw for a set of the page's. */
export function engineLayers(layers) {
    const asked = [...layers].filter((name) => !OWN.includes(name));
    return CONTACTS.some((name) => layers.has(name)) ? ['contacts', ...asked] : asked;
}

export class Panel {
    /** `change(name, value)` changes a setting; `resize(size)` opens anew; `layer(name, on)` switches a layer. */
    constructor({ change, resize, layer, threads }) {
        Object.assign(this, { change, resize });
        this.rows = new Map();
        GUIDED.threads.most = threads;
        this.size = this.slider('size', { label: 'Size', least: 1, most: 2 }, (value) => this.resize(value));
        element('settings').append(this.size.row);
        for (const [name, guide] of Object.entries(GUIDED)) {
            if (name === 'threads' && threads < 2) continue;
            element('settings').append(this.add(name, guide).row);
        }
        this.boxes = new Map();
        for (const [name, label, colour] of LAYERS) {
            const box = make('input', { type: 'checkbox', id: `layer-${name}` });
            box.addEventListener('input', () => layer(name, box.checked));
            const dot = make('i', { className: 'dot' });
            dot.style.background = Array.isArray(colour) ? css(colour) : (colour ?? 'none');
            element('layers').append(make('label', { className: 'check' }, box, make('span', {}, label), dot));
            this.boxes.set(name, box);
        }
    }

    add(name, guide) {
        const change = (value) => this.change(name, value);
        let made;
        if (guide.choices) made = this.choice(name, guide, change);
        else if (guide.scale || guide.free) made = this.entry(name, guide, change);
        else if (guide.least !== undefined) made = this.slider(name, guide, change);
        else made = this.box(name, guide, change);
        this.rows.set(name, made);
        return made;
    }

    slider(name, { label, least, most, step, part }, change) {
        const input = make('input', { type: 'range', id: `set-${name}`, step: step ?? 1, min: least, max: most });
        const [output, text] = [make('output'), make('span', {}, label)];
        let whole;
        input.addEventListener('input', () => {
            const value = Number(input.value);
            output.value = figure(value);
            change(part === undefined ? value : whole.map((x, i) => (i === part ? value : x)));
        });
        const show = (value) => {
            whole = value;
            const number = part === undefined ? value : value[part];
            output.value = figure(number);
            // A value beyond the range is shown and kept.
            if (number > input.max) input.max = number;
            if (number < input.min) input.min = number;
            input.value = number;
        };
        return { row: make('label', { className: 'slider' }, text, output, input), input, text, show };
    }

    choice(name, { label, choices }, change) {
        const input = make('select', { id: `set-${name}` });
        choices.forEach((choice) => input.add(new Option(choice.replaceAll('-', ' '), choice)));
        input.addEventListener('input', () => change(input.value));
        const show = (value) => {
            if (![...input.options].some((option) => option.value === value)) input.add(new Option(value, value));
            input.value = value;
        };
        return { row: make('label', { className: 'choice' }, make('span', {}, label), input), input, show };
    }

    /** A number or a text; an empty one is none, where the setting may have none. */
    entry(name, { label, scale, kind }, change) {
        const input = make('input', { type: 'text', inputMode: 'decimal', id: `set-${name}`, placeholder: scale ? 'none' : '' });
        input.addEventListener('change', () => {
            const number = Number(input.value) * (scale ?? 1);
            if (input.value.trim() === '') change(null);
            else if (kind === 'string') change(input.value);
            else if (Number.isFinite(number)) change(scale ? Math.round(number) : number);
        });
        const show = (value) => {
            const number = value !== null && typeof value === 'object' ? value.total : value;
            if (kind === 'string') input.value = value;
            else input.value = number === null || number === undefined ? '' : figure(number / (scale ?? 1));
        };
        return { row: make('label', { className: 'choice' }, make('span', {}, label), input), input, show };
    }

    box(name, { label }, change) {
        const input = make('input', { type: 'checkbox', id: `set-${name}` });
        input.addEventListener('input', () => change(input.checked));
        const show = (value) => (input.checked = value);
        return { row: make('label', { className: 'check' }, input, make('span', {}, label)), input, show };
    }

    /** A control for a setting that has no guide. */
    other(name, value) {
        const label = name.replaceAll('_', ' ');
        if (typeof value === 'boolean') return this.add(name, { label });
        return this.add(name, { label, free: true, kind: typeof value });
    }

    /** Shows settings as they are; a control that the user is at keeps what it has. */
    show(settings) {
        for (const [name, value] of Object.entries(settings)) {
            const simple = value === null || typeof value !== 'object';
            if (!this.rows.has(name) && (ELSEWHERE.includes(name) || name in GUIDED || !simple)) continue;
            if (!this.rows.has(name)) element('more').append(this.other(name, value).row);
            const row = this.rows.get(name);
            if (document.activeElement !== row.input) row.show(value);
        }
    }

    /** Shows the size that a sample has, if it has one. */
    showSize(entry, size) {
        const has = entry?.most !== undefined;
        this.size.row.hidden = !has;
        if (!has) return;
        const { least, most, unit } = entry;
        Object.assign(this.size.input, { min: least, max: most });
        this.size.text.textContent = unit ? unit.charAt(0).toUpperCase() + unit.slice(1) : 'Size';
        this.size.show(size ?? entry.size);
    }

    showLayers(layers) {
        for (const [name, box] of this.boxes) box.checked = layers.has(name);
    }

    showDefaults(changed) {
        shows('defaults', changed);
    }
}
