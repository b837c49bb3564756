// A camera that frames what moves, and orbits around it.

/** Half of the vertical field of view [rad]. */
const HALF_ANGLE = 0.38;
/** Share of the way to what it should frame that the camera goes in a second: 1 - e^-RATE. */
const RATE = 2.5;

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const scaled = (a, s) => a.map((x) => x * s);
const sum = (a, b) => a.map((x, i) => x + b[i]);

/** The product of two 4x4 matrices by columns. */
export function product(a, b) {
    const out = new Float32Array(16);
    for (let c = 0; c < 4; c++) {
        for (let r = 0; r < 4; r++) {
            for (let k = 0; k < 4; k++) out[4 * c + r] += a[4 * k + r] * b[4 * c + k];
        }
    }
    return out;
}

/** From the world to a frame with its origin at `eye` and z along `back`. */
export function look(eye, back) {
    const right = cross(Math.abs(back[1]) > 0.999 ? [0, 0, -1] : [0, 1, 0], back);
    const x = scaled(right, 1 / Math.hypot(...right));
    const y = cross(back, x);
    const columns = [0, 1, 2].map((i) => [x[i], y[i], back[i], 0]);
    return [...columns.flat(), -dot(x, eye), -dot(y, eye), -dot(back, eye), 1];
}

function perspective(focal, aspect, near, far) {
    const depth = 1 / (near - far);
    return [focal / aspect, 0, 0, 0, 0, focal, 0, 0, 0, 0, (near + far) * depth, -1, 0, 0, 2 * near * far * depth, 0];
}

/** The value that a share of a list is below. */
function quantile(values, share) {
    values.sort((a, b) => a - b);
    return values[Math.min(values.length - 1, Math.floor(share * values.length))];
}

const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);

/**
 * Centre and radius of a ball that holds some places with what reaches around them, and the ground at height zero below them. `home`: the first
 * frame, of which all is to be seen; later ones leave out what flew off, and by quantiles a little more, so that the
 * camera stays with the rest. None without places.
 */
export function frameOf(places, home) {
    if (places.length === 0) return null;
    if (home) {
        const stayed = places.filter((p) => distance(p, home.middle) < 1.6 * home.radius);
        // Unless nearly all went.
        if (4 * stayed.length >= places.length) places = stayed;
    }
    const onGround = places.every((p) => p[1] > 0);
    const rest = home ? 0.04 : 0;
    const middle = [0, 1, 2].map((i) => {
        const low = onGround && i === 1 ? 0 : quantile(places.map((p) => p[i] - p[3]), rest);
        return 0.5 * (low + quantile(places.map((p) => p[i] + p[3]), 1 - rest));
    });
    if (onGround) places = [...places, ...places.map((p) => [p[0], 0, p[2], 0])];
    const away = places.map((p) => distance(p, middle) + p[3]);
    return { middle, radius: Math.max(0.5, 1.1 * quantile(away, 1 - rest)) };
}

export class Camera {
    constructor() {
        this.frame = { middle: [0, 0, 0], radius: 5 };
        /** How far above the middle of the picture its target is, in halves of its height. */
        this.lift = 0;
        this.reset();
    }

    /** Takes back what the user turned, moved and zoomed. */
    reset() {
        [this.yaw, this.pitch, this.zoom, this.shift] = [0.6, 0.35, 1, [0, 0, 0]];
    }

    /**
     * Goes towards what should be framed, or at once without a time [s]. From then on it goes no further away
     * than to see a quarter more: what flies apart leaves the picture.
     */
    follow(frame, seconds) {
        if (!frame) return;
        if (seconds === undefined) this.home = frame;
        const share = seconds === undefined ? 1 : 1 - Math.exp(-RATE * seconds);
        const to = (a, b) => a + (b - a) * share;
        const middle = this.frame.middle.map((x, i) => to(x, frame.middle[i]));
        this.frame = { middle, radius: to(this.frame.radius, Math.min(frame.radius, 1.25 * this.home.radius)) };
    }

    /** Goes along with a place. */
    accompany(place, seconds) {
        if (!place || place.length < 3) return;
        const share = 1 - Math.exp(-3 * RATE * seconds);
        this.frame = { ...this.frame, middle: this.frame.middle.map((x, i) => x + (place[i] - x) * share) };
    }

    /** Looks from one place to another. */
    between(eye, target) {
        const away = eye.map((x, i) => x - target[i]);
        const distance = Math.max(1e-3, Math.hypot(...away));
        this.reset();
        this.frame = { middle: [...target], radius: distance * Math.sin(HALF_ANGLE) };
        this.home = this.frame;
        [this.yaw, this.pitch] = [Math.atan2(away[0], away[2]), Math.asin(away[1] / distance)];
    }

    /** Eye and target, six numbers. */
    saved() {
        return [...sum(this.target, scaled(this.back, this.distance)), ...this.target];
    }

    restore(numbers) {
        this.between(numbers.slice(0, 3), numbers.slice(3));
    }

    /** What the camera looks at. */
    get target() {
        return sum(this.frame.middle, this.shift);
    }

    /** Direction from the target to the eye. */
    get back() {
        const flat = Math.cos(this.pitch);
        return [Math.sin(this.yaw) * flat, Math.sin(this.pitch), Math.cos(this.yaw) * flat];
    }

    get distance() {
        return (this.frame.radius / Math.sin(HALF_ANGLE)) * this.zoom;
    }

    turn(yaw, pitch) {
        this.yaw += yaw;
        this.pitch = Math.min(1.55, Math.max(-1.2, this.pitch + pitch));
    }

    /** Moves along the picture, by shares of its height. */
    pan(right, up) {
        const m = look([0, 0, 0], this.back);
        const seen = 2 * this.distance * Math.tan(HALF_ANGLE);
        this.shift = this.shift.map((x, i) => x + (m[4 * i] * right + m[4 * i + 1] * up) * seen);
    }

    zoomBy(factor) {
        this.zoom = Math.min(30, Math.max(0.03, this.zoom * factor));
    }

    /** The ray from the eye through a place of the picture: -1 to 1 to the right and up; `aspect` wide. */
    ray(x, y, aspect) {
        y -= this.lift;
        const m = look([0, 0, 0], this.back);
        const high = Math.tan(HALF_ANGLE) / Math.min(1, aspect);
        const along = [0, 1, 2].map((i) => m[4 * i] * x * high * aspect + m[4 * i + 1] * y * high - this.back[i]);
        const origin = sum(this.target, scaled(this.back, this.distance));
        return { origin, direction: scaled(along, 1 / Math.hypot(...along)) };
    }

    /** What the renderer needs to know, for a picture of some size in pixels. */
    view(width, height) {
        // Upright pictures show as much across as others show up and down.
        const focal = (1 / Math.tan(HALF_ANGLE)) * Math.min(1, width / height);
        const { distance, back } = this;
        const target = this.target;
        const eye = sum(target, scaled(back, distance));
        const lens = perspective(focal, width / height, 0.02 * distance, 40 * distance);
        lens[9] = -this.lift;
        const clip = product(lens, look(eye, back));
        const pixel = 2 / (focal * height);
        return { clip, eye, target, back, radius: this.frame.radius * Math.max(this.zoom, 1), pixel };
    }
}
