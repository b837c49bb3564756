// The keyboard, and the pad that stands for it on a touch screen.

import { element } from './page.js';

/** What keys say to a sample with controls. */
const STEERING = {
    w: 'forward', ArrowUp: 'forward', s: 'back', ArrowDown: 'back',
    a: 'left', ArrowLeft: 'left', d: 'right', ArrowRight: 'right',
    ' ': 'jump', e: 'action',
};

/** The table of the help: keys, then the mouse. */
export const HELP = [
    ['Space, P', 'play, pause (where space is a key of the sample: P)'],
    ['N, →', 'one step'],
    ['B, ←', 'one step back'],
    ['R', 'from the start'],
    ['F', 'shoots a ball towards the pointer'],
    ['G', 'spawns the chosen shape at the pointer'],
    ['X', 'an explosion at the pointer'],
    ['I', 'inspects the body at the pointer'],
    ['Delete', 'removes the body at the pointer'],
    ['C', 'frames what moves'],
    ['L', 'the camera follows, or stays'],
    ['W A S D, arrows, space, E', 'steer, where the sample has keys'],
    ['/', 'search'],
    ['Tab', 'the panel'],
    ['Drag a body', 'grabs it; the wheel moves it nearer or away, letting go throws it'],
    ['Drag elsewhere', 'orbits; with shift or another button it pans'],
    ['Wheel', 'zooms'],
    ['Click', 'what is chosen below the picture: inspects at first'],
    ['Double-click', 'frames what moves, while clicks inspect'],
    ['One finger', 'grabs or orbits'],
    ['Two fingers', 'pan and zoom'],
];

export class Keys {
    /** `acts`: functions by key; `steer(controls)` says what the keys of a sample ask for. */
    constructor(acts, steer) {
        [this.acts, this.steer, this.down, this.steers] = [acts, steer, new Set(), false];
        addEventListener('keydown', (e) => this.press(e));
        addEventListener('keyup', (e) => this.release(e));
        addEventListener('blur', () => this.clear());
        for (const button of element('pad').querySelectorAll('button')) {
            const { key } = button.dataset;
            button.addEventListener('pointerdown', (e) => {
                e.preventDefault();
                button.setPointerCapture?.(e.pointerId);
                this.hold(key, true);
            });
            for (const end of ['pointerup', 'pointercancel']) button.addEventListener(end, () => this.hold(key, false));
            button.addEventListener('contextmenu', (e) => e.preventDefault());
        }
    }

    /** Whether the open sample has keys of its own. */
    set(steers) {
        this.clear();
        this.steers = steers;
        element('pad').hidden = !steers;
    }

    press(e) {
        // Keys of a control are its own.
        const field = e.target.closest?.('input, select, textarea, dialog');
        const simple = ['checkbox', 'range', 'radio'].includes(field?.type);
        if ((field && !simple) || e.ctrlKey || e.metaKey || e.altKey) return;
        const key = e.key.length === 1 ? e.key.toLowerCase() : e.key;
        if (simple && key.startsWith('Arrow')) return;
        if (key === ' ' && e.target.closest?.('button, summary, input') && !this.steers) return;
        if (this.steers && STEERING[key]) {
            e.preventDefault();
            if (!e.repeat) this.hold(STEERING[key], true);
            return;
        }
        if (!this.acts[key]) return;
        e.preventDefault();
        this.acts[key](e);
    }

    release(e) {
        const key = e.key.length === 1 ? e.key.toLowerCase() : e.key;
        if (STEERING[key] && this.down.has(STEERING[key])) this.hold(STEERING[key], false);
    }

    hold(name, held) {
        if (this.down.has(name) === held) return;
        if (held) this.down.add(name);
        else this.down.delete(name);
        const sign = (plus, minus) => Number(this.down.has(plus)) - Number(this.down.has(minus));
        const [forward, right] = [sign('forward', 'back'), sign('right', 'left')];
        this.steer({ forward, right, jump: this.down.has('jump'), action: this.down.has('action') });
    }

    clear() {
        for (const name of [...this.down]) this.hold(name, false);
    }
}
