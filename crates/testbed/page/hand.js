// The mouse and fingers in the scene: a body is grabbed and thrown, and a click does what the chosen tool does.

const TOOLS = { inspect: 'Inspect', shoot: 'Shoot', spawn: 'Spawn', explode: 'Explode', remove: 'Remove' };
export { TOOLS };

const clamped = (x, least, most) => Math.min(most, Math.max(least, x));

export class Hand {
    /** `loop` takes commands. */
    constructor(loop) {
        [this.loop, this.tool, this.shape] = [loop, 'inspect', 'box'];
        [this.holding, this.waiting, this.pressed] = [false, false, false];
    }

    /** The view that it is used in. */
    attach(view) {
        this.view = view;
    }

    ray(e) {
        return this.view.ray(e.clientX, e.clientY);
    }

    /** Asks whether there is something to grab; the camera waits for the answer. */
    async press(e) {
        [this.pressed, this.waiting, this.at] = [true, true, e];
        const press = (this.count = (this.count ?? 0) + 1);
        const answer = await this.loop.do({ do: 'grab', ...this.ray(e) }).catch(() => undefined);
        if (press !== this.count) return;
        this.waiting = false;
        const grabbed = answer?.header.grabbed;
        if (!grabbed) return;
        if (!this.pressed) {
            this.loop.do({ do: 'release' });
            return;
        }
        this.holding = true;
        this.target = grabbed.slice(0, 3);
        // It may have moved meanwhile.
        if (this.at !== e) this.move(this.at);
    }

    /** The place under the pointer on the plane that faces the eye. */
    move(e) {
        this.at = e;
        if (!this.holding) return;
        const { origin, direction } = this.ray(e);
        const { back } = this.view.camera;
        const along = (a) => a.reduce((s, x, i) => s + x * back[i], 0);
        const way = (along(this.target) - along(origin)) / along(direction);
        if (!(way > 0)) return;
        this.target = origin.map((x, i) => x + direction[i] * way);
        this.loop.do({ do: 'drag', to: this.target });
    }

    /** Nearer or further away. */
    wheel(e) {
        const { origin } = this.ray(e);
        const share = Math.exp(clamped(-e.deltaY, -60, 60) * 0.003);
        this.target = origin.map((x, i) => x + (this.target[i] - x) * share);
        this.loop.do({ do: 'drag', to: this.target });
    }

    /** Lets go. */
    drop() {
        this.pressed = false;
        if (!this.holding) return;
        this.holding = false;
        this.loop.do({ do: 'release' });
    }

    hover(e) {
        this.over = e;
    }

    /** Whether two clicks are more than that: shots follow each other fast. */
    get doubles() {
        return this.tool === 'inspect';
    }

    click(e) {
        this.use(this.tool, e);
    }

    /** Uses a tool at a place of the page, or where the pointer is. */
    use(tool, e = this.over ?? this.middle()) {
        const ray = this.ray(e);
        const { camera } = this.view;
        const { radius } = camera.frame;
        const distance = camera.distance;
        const size = clamped(0.08 * radius, 0.08, 0.6);
        const commands = {
            inspect: { do: 'inspect', ...ray },
            shoot: { do: 'shoot', ...ray, speed: clamped(5 * radius, 15, 60) },
            spawn: { do: 'spawn', sight: ray, distance, shape: this.shape, size },
            explode: { do: 'explode', sight: ray, distance, radius: clamped(0.8 * radius, 1, 12), speed: clamped(3 * radius, 5, 25) },
            remove: { do: 'remove', ...ray },
        };
        return this.loop.do(commands[tool]);
    }

    /** The middle of the picture. */
    middle() {
        const { left, top, width, height } = this.view.canvas.getBoundingClientRect();
        return { clientX: left + 0.5 * width, clientY: top + 0.5 * height };
    }
}
