// Time by hand: play, steps, the way through the history, speed and rate.

import { element, make } from './page.js';

const SPEEDS = [[2, '2×'], [1, '1×'], [1 / 2, '1/2×'], [1 / 4, '1/4×'], [1 / 8, '1/8×'], [1 / 16, '1/16×']];
const RATES = [30, 60, 120];

export class Transport {
    /** `changed` is called when speed, rate or whether it plays changed. */
    constructor(loop, changed) {
        Object.assign(this, { loop, changed });
        SPEEDS.forEach(([speed, text]) => element('speed').add(new Option(text, speed)));
        RATES.forEach((rate) => element('rate').add(new Option(`${rate} Hz`, rate)));
        const on = (id, event, work) => element(id).addEventListener(event, work);
        on('play', 'click', () => this.play(!loop.playing));
        on('step', 'click', () => this.step());
        on('back', 'click', () => this.back());
        on('restart', 'click', () => this.restart());
        on('speed', 'input', () => this.setSpeed(Number(element('speed').value)));
        on('rate', 'input', () => this.setRate(Number(element('rate').value)));
        on('timeline', 'input', () => this.seek(Number(element('timeline').value)));
        on('timeline', 'change', () => element('timeline').blur());
    }

    play(playing) {
        this.loop.play(playing);
        this.label();
        this.changed();
    }

    /** What the button does. */
    label() {
        const { playing } = this.loop;
        element('play').textContent = playing ? '❚❚' : '▶';
        element('play').setAttribute('aria-label', playing ? 'Pause' : 'Play');
        element('play').classList.toggle('playing', playing);
    }

    step(steps = 1) {
        if (this.loop.playing) this.play(false);
        return this.loop.advance(steps);
    }

    back(steps = 1) {
        if (this.loop.playing) this.play(false);
        return this.loop.do({ do: 'back', steps });
    }

    restart() {
        return this.loop.do({ do: 'restart' });
    }

    seek(step) {
        if (this.loop.playing) this.play(false);
        return this.loop.do({ do: 'seek', step });
    }

    setSpeed(speed) {
        const select = element('speed');
        if (!SPEEDS.some(([known]) => known === speed) && !select.querySelector(`[value="${speed}"]`)) {
            select.append(make('option', { value: speed, textContent: `${speed}×` }));
        }
        select.value = speed;
        this.loop.speed = speed;
        this.changed();
    }

    /** Steps in a second of the scene's time. */
    setRate(rate) {
        this.showRate(rate);
        this.changed();
        return this.loop.do({ do: 'settings', dt: 1 / rate });
    }

    showRate(rate) {
        const select = element('rate');
        this.loop.rate = rate;
        const text = String(Math.round(rate * 100) / 100);
        if (![...select.options].some((option) => Number(option.value) === Number(text))) {
            select.append(make('option', { value: text, textContent: `${text} Hz` }));
        }
        if (document.activeElement !== select) select.value = text;
    }

    /** Shows where the scene is in time. */
    show({ step, time, dt, past, future }) {
        const line = element('timeline');
        line.min = step - past;
        line.max = step + (future ?? 0);
        line.value = step;
        element('now').value = `${step} · ${time.toFixed(2)} s`;
        this.showRate(1 / dt);
        this.label();
    }
}
