// The list of samples with its search, and the source of the open one.

import { highlighted } from './highlight.js';
import { element, make, shows } from './page.js';

const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);
/** A group's name as a heading. */
const heading = (group) => capital(group.replaceAll('_', ' '));

export class Samples {
    /** `catalogue`: entries as the engine sends them. `open(name)` opens one. */
    constructor(catalogue, open) {
        this.catalogue = catalogue;
        this.rows = [];
        const groups = new Map();
        for (const entry of catalogue) {
            if (!groups.has(entry.group)) groups.set(entry.group, []);
            groups.get(entry.group).push(entry);
        }
        for (const [group, entries] of groups) {
            const title = make('h3', { textContent: heading(group) });
            const buttons = entries.map((entry) => this.row(entry, title, open));
            element('list').append(title, ...buttons);
        }
        const search = element('search');
        search.addEventListener('input', () => this.search(search.value));
        search.addEventListener('keydown', (e) => {
            if (e.key === 'Escape') this.search((search.value = ''));
            const first = this.rows.find(({ button }) => !button.hidden);
            if (e.key === 'Enter' && first) open(first.entry.name);
        });
    }

    row(entry, title, open) {
        const button = make('button', { type: 'button', textContent: entry.title ?? entry.name, title: entry.about ?? '' });
        button.dataset.name = entry.name;
        button.addEventListener('click', () => open(entry.name));
        const text = [entry.name, entry.title, entry.group, entry.about].join(' ').toLowerCase();
        this.rows.push({ button, entry, title, text });
        return button;
    }

    entry(name) {
        return this.catalogue.find((entry) => entry.name === name);
    }

    /** Leaves the rows that have all words of a text. */
    search(text) {
        const words = text.toLowerCase().split(/\s+/);
        const full = new Set();
        for (const { button, title, text } of this.rows) {
            button.hidden = !words.every((word) => text.includes(word));
            if (!button.hidden) full.add(title);
        }
        for (const { title } of this.rows) title.hidden = !full.has(title);
    }

    /** Shows which one is open. */
    mark(name) {
        const entry = this.entry(name) ?? { name, title: name };
        for (const { button } of this.rows) {
            const current = button.dataset.name === name;
            button.toggleAttribute('aria-current', current);
            if (current) button.scrollIntoView?.({ block: 'nearest' });
        }
        element('title').textContent = entry.title ?? entry.name;
        element('about').textContent = capital(entry.about ?? '');
        element('keys').textContent = entry.controls ? `Keys: ${entry.controls}` : '';
        document.title = `${entry.title ?? entry.name} · backstop`;
    }
}

/** Shows a text of Rust with its path. */
export function showSource({ source, path }) {
    shows('source-open', Boolean(source));
    element('path').textContent = path ?? '';
    element('code').innerHTML = highlighted(source ?? '');
}

/** The button that copies the source. */
export function copies() {
    element('copy').addEventListener('click', async () => {
        const text = element('code').textContent;
        try {
            await navigator.clipboard.writeText(text);
            element('copy').textContent = 'Copied';
        } catch {
            // Without the permission the text is selected, to be copied by hand.
            getSelection().selectAllChildren(element('code'));
            element('copy').textContent = 'Selected';
        }
        setTimeout(() => (element('copy').textContent = 'Copy'), 1500);
    });
}
