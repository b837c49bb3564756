// The bar of tools, the dialogs, and what folds.

import { TOOLS } from './hand.js';
import { HELP } from './keys.js';
import { element, make } from './page.js';

const SHAPES = ['box', 'sphere', 'capsule', 'tapered_capsule', 'cylinder', 'tapered_cylinder', 'cone', 'hull', 'ragdoll'];

/** Folds a side in or out: over the picture where there is no room beside it. */
export function drawer(id, open) {
    const narrow = matchMedia('(max-width: 900px)').matches;
    const set = open === undefined ? undefined : open === narrow;
    element(id).classList.toggle(narrow ? 'open' : 'folded', set);
}

/** What a click does, and which shape is spawned. */
export function toolBar(hand) {
    for (const [name, label] of Object.entries(TOOLS)) {
        const input = make('input', { type: 'radio', name: 'tool', value: name, checked: name === hand.tool });
        input.addEventListener('input', () => {
            hand.tool = name;
            // Keys are the scene's again.
            input.blur();
        });
        element('tools').append(make('label', {}, input, make('span', {}, label)));
    }
    const shape = element('shape');
    SHAPES.forEach((name) => shape.add(new Option(name.replaceAll('_', ' '), name)));
    shape.addEventListener('input', () => {
        hand.shape = shape.value;
        shape.blur();
    });
}

/** Buttons that open and close sides and dialogs. */
export function dialogs() {
    const on = (id, work) => element(id).addEventListener('click', work);
    for (const id of ['samples', 'panel']) on(`${id}-open`, () => drawer(id));
    for (const id of ['source', 'help']) on(`${id}-open`, () => element(id).showModal());
    for (const button of document.querySelectorAll('[data-closes]')) {
        const side = element(button.dataset.closes);
        button.addEventListener('click', () => (side.close ? side.close() : drawer(side.id, false)));
    }
    const row = ([keys, text]) => make('tr', {}, make('td', { textContent: keys }), make('td', { textContent: text }));
    element('help-text').append(make('table', {}, ...HELP.map(row)));
}
