// The page: puts its parts together, and keeps what they share.

import { dialogs, drawer, toolBar } from './bars.js';
import { View } from './draw/view.js';
import { Engine } from './engine.js';
import { Hand } from './hand.js';
import { hook } from './hook.js';
import { Keys } from './keys.js';
import { Ledger, showInspected } from './ledger.js';
import { Loop } from './loop.js';
import { element, shows, tell } from './page.js';
import { engineLayers, FIRST_LAYERS, knownLayers, Panel } from './panel.js';
import { parsed, written } from './permalink.js';
import { copies, Samples, showSource } from './samples.js';
import { Slow } from './slow.js';
import { Transport } from './transport.js';

/** Colours of the line from a grabbed body to the hand, 0 to 255. */
const PULL = [208, 96, 24];
const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);

class App {
    constructor(engine) {
        this.engine = engine;
        this.layers = new Set(FIRST_LAYERS);
        this.loop = new Loop(engine, {
            layers: () => engineLayers(this.layers),
            shown: (answer, seconds) => this.show(answer, seconds),
            between: (share, seconds) => this.view.setPoses(this.slow.at(share), seconds),
            failed: tell,
        });
        this.hand = new Hand(this.loop);
        this.view = new View(element('canvas'), this.hand, (panned) => this.turned(panned));
        this.hand.attach(this.view);
        this.slow = new Slow();
        this.ledger = new Ledger();
        this.transport = new Transport(this.loop, () => this.link());
        this.keys = new Keys(this.acts(), (controls) => this.loop.do({ do: 'controls', ...controls }));
        const threads = engine.kind === 'native' ? navigator.hardwareConcurrency || 1 : 1;
        this.panel = new Panel({
            change: (name, value) => this.loop.do({ do: 'settings', [name]: value }),
            resize: (size) => this.open(this.name, { size }),
            layer: (name, on) => this.switchLayer(name, on),
            threads,
        });
        this.panel.showLayers(this.layers);
    }

    /** Asks what there is, and opens what the address says. */
    async start() {
        const { header } = await this.engine.request({ want: ['catalogue'] });
        this.samples = new Samples(header.catalogue, (name) => this.open(name, {}, true));
        this.listen();
        await this.follow(location.hash);
    }

    /** Opens what an address says, with its settings. */
    async follow(hash) {
        const state = parsed(hash);
        const first = this.samples.catalogue[0].name;
        const known = state.sample === undefined || this.samples.entry(state.sample);
        if (state.layers) this.setLayers(state.layers);
        await this.open(known ? (state.sample ?? first) : first, state);
        if (!known) tell(`there is no sample "${state.sample}"`);
        if (state.camera?.length !== 6) return;
        this.setFollow(state.follow ?? false);
        this.view.camera.restore(state.camera);
        this.view.invalidate();
        this.turnedBy = state.camera;
        this.link();
    }

    /** Opens a sample from its start. `add`: as a page to come back from. */
    async open(name, { size, settings = {}, speed = 1, rate, play, follow, camera } = {}, add = false) {
        const entry = this.samples.entry(name);
        const turn = (this.turn = (this.turn ?? 0) + 1);
        // What was asked for before is of another scene.
        this.loop.clear();
        const moves = play ?? (this.name === undefined ? true : this.loop.playing || add);
        const stays = this.name === name && !add && !camera;
        this.loop.play(false);
        [this.name, this.size, this.turnedBy] = [name, size, stays ? this.turnedBy : undefined];
        this.fresh = !stays;
        this.samples.mark(name);
        this.keys.set(Boolean(entry?.controls));
        showSource(entry ?? {});
        this.panel.showSize(entry, size);
        this.setFollow(follow ?? (stays ? this.follows : true));
        this.ledger.clear();
        if (add) history.pushState(null, '', `#sample=${name}`);
        const kept = stays && Object.keys(settings).length === 0 ? this.changed : settings;
        const answer = await this.loop.send({ commands: [{ do: 'open', name, size }] });
        // Another one was opened meanwhile.
        if (turn !== this.turn) return;
        this.first = answer.header.settings;
        const wanted = rate ? { ...kept, dt: 1 / rate } : kept;
        if (Object.keys(wanted).length > 0) {
            await this.loop.send({ commands: [{ do: 'settings', ...wanted }] }).catch(tell);
        }
        if (entry?.camera && !stays) this.view.camera.between(entry.camera.eye, entry.camera.look_at);
        this.transport.setSpeed(stays ? this.loop.speed : speed);
        if (moves && !answer.header.error) this.transport.play(true);
        this.closeDrawers();
    }

    /** Shows an answer; `seconds` since the last one. */
    show(answer, seconds) {
        const { header } = answer;
        tell(header.error);
        if (header.error) this.loop.play(false);
        if (header.step === undefined) return;
        const { renderer } = this.view;
        if (answer.has('instances')) {
            const stays = !this.fresh;
            this.view.setScene(this.loop.meshes, answer.numbers('instances'), answer.numbers('links'), stays);
            this.fresh = false;
            this.shapes = undefined;
        }
        this.inspect(header.inspected);
        this.mark(answer);
        renderer.options.dims = this.layers.has('sleep');
        renderer.options.wireframe = this.layers.has('wireframe');
        renderer.anchors = answer.numbers('anchors');
        this.view.setPoses(this.slow.take(answer.numbers('poses'), this.loop.slow), seconds);
        this.transport.show(header);
        this.panel.show(header.settings);
        this.header = header;
        const steps = header.step - (this.steps ?? 0);
        if (header.step_ms > 0 && steps > 0) this.ledger.addTime(header.step_ms / steps);
        this.steps = header.step;
        if (header.ledger) this.ledger.show(header);
        this.link();
    }

    /** Lines, points and colours of the layers, and the hand's pull. */
    mark(answer) {
        const { header } = answer;
        const tones = [...(header.tones ?? []), PULL];
        let lines = answer.numbers('lines');
        if (header.grabbed) {
            const [from, to] = [header.grabbed.slice(0, 3), header.grabbed.slice(3)];
            lines = new Float32Array([...lines, ...from, tones.length - 1, ...to, tones.length - 1]);
        }
        const { renderer } = this.view;
        renderer.marks.setLines(lines, tones);
        const kinds = ['real', 'potential', 'ghosts', 'centres'].map((name) => this.layers.has(name));
        const points = answer.numbers('points');
        const wanted = [];
        for (let i = 0; i < points.length; i += 4) if (kinds[points[i + 3]]) wanted.push(...points.subarray(i, i + 4));
        renderer.marks.setPoints(new Float32Array(wanted));
        renderer.setTints(answer.numbers('tints').length > 0 ? answer.numbers('tints') : null, tones);
    }

    /** Shows the inspected body, with its outline and, if the camera follows, in the middle. */
    inspect(inspected) {
        showInspected(inspected);
        const shapes = inspected?.shapes ?? [];
        if (!same(shapes, this.shapes)) {
            this.shapes = shapes;
            const set = new Set(shapes);
            this.view.renderer.select(set.size > 0 ? (i) => set.has(i) : null);
        }
        const whom = shapes.length > 0 ? shapes[0] : 'moving';
        this.view.follows = this.follows && !this.hand.holding ? whom : 'nothing';
    }

    setFollow(follows) {
        this.follows = follows;
        element('follow').checked = follows;
        this.link();
    }

    setLayers(names) {
        this.layers = new Set(knownLayers(names));
        this.panel.showLayers(this.layers);
        this.link();
        return this.loop.wake();
    }

    switchLayer(name, on) {
        const names = new Set(this.layers);
        if (on) names.add(name);
        else names.delete(name);
        return this.setLayers(names);
    }

    /** The user turned the camera: it is a part of the address from now on. */
    turned(panned) {
        // Who moves the camera to a place wants it to stay there.
        if (panned) this.setFollow(false);
        this.turnedBy = this.view.camera.saved();
        this.link();
    }

    /** What differs from the sample's own settings. */
    get changed() {
        const now = this.header?.settings ?? {};
        const names = Object.keys(now).filter((name) => this.first && !same(now[name], this.first[name]));
        return Object.fromEntries(names.map((name) => [name, now[name]]));
    }

    /** The address of what is seen. */
    get address() {
        const { playing, speed, rate } = this.loop;
        const layers = same([...this.layers], FIRST_LAYERS) ? undefined : [...this.layers];
        const isSimple = (value) => value === null || typeof value !== 'object' || Array.isArray(value);
        const settings = Object.fromEntries(Object.entries(this.changed).filter(([, value]) => isSimple(value)));
        return written({
            sample: this.name,
            size: this.size,
            settings,
            layers,
            speed,
            rate: Math.round(rate * 100) / 100,
            play: playing,
            follow: this.follows ? undefined : false,
            camera: this.turnedBy,
        });
    }

    /** Keeps the address true, some times a second: browsers refuse more. */
    link() {
        this.panel?.showDefaults(Object.keys(this.changed).length > 0);
        this.linking ??= setTimeout(() => {
            this.linking = undefined;
            if (this.name && this.first && location.hash !== this.address) history.replaceState(null, '', this.address);
        }, 250);
    }

    acts() {
        const { transport } = this;
        const tool = (name) => () => this.hand.use(name);
        const forward = () => transport.step();
        const back = () => transport.back();
        return {
            ' ': () => transport.play(!this.loop.playing), p: () => transport.play(!this.loop.playing),
            n: forward, ArrowRight: forward, b: back, ArrowLeft: back, r: () => transport.restart(),
            f: tool('shoot'), g: tool('spawn'), x: tool('explode'), i: tool('inspect'),
            Delete: tool('remove'), Backspace: tool('remove'),
            c: () => this.view.home(), l: () => this.setFollow(!this.follows),
            '/': () => (drawer('samples', true), element('search').focus()),
            '?': () => element('help').showModal(),
            Tab: () => drawer('panel'),
            Escape: () => this.closeDrawers(),
        };
    }

    closeDrawers() {
        for (const id of ['samples', 'panel']) element(id).classList.remove('open');
    }

    /** Puts what is framed into the middle of what nothing covers. */
    makeRoom() {
        const high = (name) => document.querySelector(`main > ${name}`).offsetHeight;
        this.view.camera.lift = (high('footer') - high('header')) / Math.max(1, element('canvas').clientHeight);
        this.view.invalidate();
    }

    listen() {
        const room = new ResizeObserver(() => this.makeRoom());
        for (const name of ['footer', 'header', '#canvas']) room.observe(document.querySelector(`main > ${name}`));
        const on = (id, event, work) => element(id).addEventListener(event, work);
        addEventListener('hashchange', () => this.follow(location.hash));
        dialogs();
        toolBar(this.hand);
        copies();
        on('inspector-close', 'click', () => this.loop.do({ do: 'inspect', origin: [0, 1e5, 0], direction: [0, 1, 0] }));
        on('follow', 'input', () => this.setFollow(element('follow').checked));
        on('defaults', 'click', (e) => {
            e.preventDefault();
            const first = Object.keys(this.changed).map((name) => [name, this.first[name]]);
            this.loop.do({ do: 'settings', ...Object.fromEntries(first) });
        });
    }
}

try {
    const kind = document.querySelector('meta[name=backstop-engine]').content;
    const app = new App(await Engine.start(kind));
    addEventListener('unhandledrejection', (event) => tell(event.reason));
    await app.start();
    globalThis.testbed = hook(app);
} catch (error) {
    tell(error);
    shows('error', true);
    throw error;
}
