// Time: which steps are owed, and one request for each picture, never more than one at a time.

/** Time that the steps of one picture may take [ms]: what can't be done in it is not made up for. */
const PATIENCE = 24;
/** Time between two ledgers while the scene runs [ms]. */
const LEDGER = 120;

export class Loop {
    /**
     * `layers()` says which sections to draw; `shown(answer, seconds)` shows one; `between(share, seconds)` what
     * is on the way to it; `failed(error)` tells an error.
     */
    constructor(engine, { layers, shown, between, failed }) {
        Object.assign(this, { engine, layers, shown, between, failed });
        [this.playing, this.speed, this.rate] = [false, 1, 60];
        [this.owed, this.cost, this.ledgerAt] = [0, 1, 0];
        [this.revision, this.opened, this.meshes] = [0, 0, []];
        this.clear();
    }

    clear() {
        [this.commands, this.steps, this.wants] = [[], 0, new Set()];
    }

    /** Whether there are fewer steps than pictures. */
    get slow() {
        return this.playing && this.speed * this.rate < 45;
    }

    /** Commands for the next picture. Several `drag`s and `controls` become one. */
    do(...commands) {
        for (const command of commands) {
            const last = this.commands.at(-1);
            if (last?.do === command.do && ['drag', 'controls'].includes(command.do)) this.commands.pop();
            this.commands.push(command);
        }
        return this.wake();
    }

    want(...names) {
        names.forEach((name) => this.wants.add(name));
        return this.wake();
    }

    /** Steps by hand, in the next picture. */
    advance(steps) {
        this.steps += steps;
        return this.wake();
    }

    play(playing) {
        if (playing && !this.playing) [this.before, this.owed] = [undefined, 0];
        this.playing = playing;
        this.wake();
    }

    /** Makes that there is a picture soon; resolves when the answer was shown, to it. */
    wake() {
        this.next ??= Promise.withResolvers?.() ?? deferred();
        this.frame ??= requestAnimationFrame((now) => this.tick(now));
        return this.next.promise;
    }

    tick(now) {
        this.frame = undefined;
        // The answer wakes it again.
        if (this.busy) return;
        const passed = this.before === undefined ? 0 : Math.min(0.1, Math.max(0, (now - this.before) / 1000));
        this.before = now;
        let steps = this.steps;
        if (this.playing) {
            this.owed += passed * this.speed * this.rate;
            const most = Math.max(1, Math.floor(PATIENCE / Math.max(0.01, this.cost)));
            const whole = Math.min(most, Math.floor(this.owed + 0.1));
            steps += whole;
            this.owed = Math.min(this.owed - whole, 1);
        }
        if (steps === 0 && this.slow) this.between(Math.min(1, this.owed), passed);
        if (steps === 0 && this.playing && this.commands.length === 0 && this.wants.size === 0) {
            this.wake();
            return;
        }
        const { commands, wants, next } = this;
        if (steps === 0 || now - this.ledgerAt > LEDGER) {
            wants.add('ledger');
            this.ledgerAt = now;
        }
        this.clear();
        this.next = undefined;
        this.send({ commands, steps, want: [...wants] }, passed).then(next.resolve, next.reject);
        next.promise.catch(() => {});
    }

    /** One request, outside of the order of pictures if need be, and what it shows. */
    async send(request, seconds = 0) {
        this.busy = (this.busy ?? 0) + 1;
        try {
            const began = performance.now();
            let answer = await this.ask(request);
            if (request.steps > 0) this.learn((performance.now() - began) / request.steps);
            if (answer.header.revision !== this.revision && !answer.has('instances')) {
                const { error } = answer.header;
                answer = await this.ask({ want: ['scene', 'ledger', ...(request.want ?? [])] });
                answer.header.error ??= error;
            }
            this.shown(answer, seconds);
            return answer;
        } catch (error) {
            this.playing = false;
            this.failed(error);
            throw error;
        } finally {
            this.busy -= 1;
            if (!this.busy && (this.playing || this.next)) this.wake();
        }
    }

    /** A request with what all of them have. Meshes that the page has are not sent again. */
    async ask(request) {
        const meshes = [this.opened, this.meshes.length];
        const answer = await this.engine.request({ layers: this.layers(), meshes, ...request });
        const { header } = answer;
        if (answer.has('instances')) {
            if (header.opened !== this.opened) this.meshes = [];
            for (let i = header.meshes.first; i < header.meshes.count; i++) {
                this.meshes[i] = answer.numbers(`mesh${i}`).slice();
            }
            [this.opened, this.revision] = [header.opened, header.revision];
        }
        return answer;
    }

    /** Takes the cost of a step from the time that an answer took [ms]. */
    learn(ms) {
        this.cost += 0.2 * (ms - this.cost);
    }
}

function deferred() {
    const made = {};
    made.promise = new Promise((resolve, reject) => Object.assign(made, { resolve, reject }));
    return made;
}
