// Slow motion: what is between two steps, so that it moves smoothly where steps are few.

import { POSE } from './draw/renderer.js';

export class Slow {
    /** Takes the poses of a step; what is to be shown at first. */
    take(poses, slow) {
        const goesOn = slow && this.now?.length === poses.length;
        this.before = goesOn ? this.now : poses;
        this.now = poses.slice();
        return this.before;
    }

    /** A share of the way from the step before the last to the last. */
    at(share) {
        const { before, now } = this;
        const out = now.slice();
        for (let i = 0; i < now.length; i += POSE) {
            for (let k = 0; k < 3; k++) out[i + k] = before[i + k] + (now[i + k] - before[i + k]) * share;
            // Two quaternions are one rotation: the one on the same side.
            let dot = 0;
            for (let k = 3; k < 7; k++) dot += before[i + k] * now[i + k];
            const side = dot < 0 ? -1 : 1;
            let length = 0;
            for (let k = 3; k < 7; k++) {
                out[i + k] = side * before[i + k] * (1 - share) + now[i + k] * share;
                length += out[i + k] ** 2;
            }
            const scale = 1 / (Math.sqrt(length) || 1);
            for (let k = 3; k < 7; k++) out[i + k] *= scale;
        }
        return out;
    }
}
