// The page: a scene, its controls and its ledger.

import { Engine } from './engine.js';
import { Ledger } from './ledger.js';
import { View } from './view.js';

const DT = 1 / 60;
/** Steps in a row before the picture is drawn all the same [ms]. */
const PATIENCE = 24;

const element = (id) => document.getElementById(id);

class App {
    constructor(engine) {
        this.engine = engine;
        this.view = new View(element('canvas'));
        this.ledger = new Ledger();
        this.playing = false;
        for (const { name } of engine.scenes) element('scene').add(new Option(name.replaceAll('_', ' '), name));
        this.listen();
        const asked = new URLSearchParams(location.hash.slice(1));
        this.open(asked.get('scene') ?? 'talk', Number(asked.get('size')) || undefined);
        this.play(true);
    }

    get settings() {
        const [substeps, iterations] = ['substeps', 'iterations'].map((id) => Number(element(id).value));
        return { substeps, iterations, sleeping: element('sleeping').checked };
    }

    /** Opens a scene from its start. */
    open(name, size) {
        const index = Math.max(0, this.engine.scenes.findIndex((scene) => scene.name === name));
        const scene = this.engine.scenes[index];
        this.scene = scene;
        element('scene').value = scene.name;
        element('about').textContent = scene.about;
        element('unit').textContent = scene.unit;
        Object.assign(element('size'), { min: scene.least, max: scene.most, value: size ?? scene.size });
        this.guarded(() => {
            this.engine.open(index, Number(element('size').value), this.settings);
            this.view.setScene(this.engine.meshes(), this.engine.instances(), this.engine.links());
            this.ledger.clear();
            this.show(0);
        });
    }

    restart() {
        this.open(this.scene.name, Number(element('size').value));
    }

    step() {
        this.ledger.addTime(this.engine.step());
    }

    /** Steps by hand. */
    forward() {
        this.play(false);
        this.guarded(() => {
            this.step();
            this.show(DT);
        });
    }

    back() {
        this.play(false);
        this.guarded(() => {
            this.engine.back();
            // The settings of that time are back too.
            const report = this.show(DT);
            element('substeps').value = report.substeps;
            element('iterations').value = report.iterations;
            element('sleeping').checked = report.sleeping;
            this.labels();
        });
    }

    play(playing) {
        this.playing = playing;
        element('play').textContent = playing ? 'Pause' : 'Play';
        if (!playing || this.running) return;
        this.running = true;
        let [before, owed] = [performance.now(), 0];
        const frame = (now) => {
            this.running = this.playing;
            if (!this.playing) return;
            const passed = Math.min(0.1, Math.max(0, now - before) / 1000);
            [before, owed] = [now, owed + passed];
            const began = performance.now();
            this.guarded(() => {
                let stepped = false;
                // What can't be done in time is not made up for: the scene is slow then.
                for (; owed >= 0.9 * DT && performance.now() - began < PATIENCE; owed -= DT) {
                    this.step();
                    stepped = true;
                }
                owed = Math.min(owed, DT);
                if (stepped) this.show(passed);
            });
            requestAnimationFrame(frame);
        };
        requestAnimationFrame(frame);
    }

    /** Shows the present state; `seconds` since the last one. */
    show(seconds) {
        this.view.setPoses(this.engine.poses(), seconds);
        this.view.setPoints(element('points').checked ? this.engine.points() : new Float32Array(0));
        const report = this.engine.report();
        this.ledger.show(report);
        this.labels();
        return report;
    }

    labels() {
        for (const id of ['size', 'substeps', 'iterations']) element(`${id}-shown`).value = element(id).value;
    }

    /** Does something; what is refused is told, and ends the run. */
    guarded(work) {
        try {
            work();
            element('error').hidden = true;
        } catch (error) {
            this.playing = false;
            Object.assign(element('error'), { hidden: false, textContent: error.message });
        }
    }

    listen() {
        const on = (id, event, work) => element(id).addEventListener(event, work);
        on('scene', 'change', () => {
            location.hash = new URLSearchParams({ scene: element('scene').value });
            this.open(element('scene').value);
            this.play(true);
        });
        on('size', 'input', () => this.restart());
        for (const id of ['substeps', 'iterations', 'sleeping']) {
            on(id, 'input', () => {
                this.labels();
                this.guarded(() => this.engine.configure(this.settings));
            });
        }
        on('points', 'input', () => this.guarded(() => this.show(0)));
        on('play', 'click', () => this.play(!this.playing));
        on('step', 'click', () => this.forward());
        on('back', 'click', () => this.back());
        on('reset', 'click', () => this.restart());
        const keys = { ' ': () => this.play(!this.playing), ArrowRight: () => this.forward(), ArrowLeft: () => this.back(), r: () => this.restart() };
        addEventListener('keydown', (e) => {
            // Keys of a control are its own.
            if (e.target !== document.body || e.ctrlKey || e.metaKey || e.altKey || !keys[e.key]) return;
            e.preventDefault();
            keys[e.key]();
        });
    }
}

try {
    // `app` is for the console, and for tests.
    globalThis.app = new App(await Engine.load('backstop.wasm'));
} catch (error) {
    Object.assign(element('error'), { hidden: false, textContent: error.message });
    throw error;
}
