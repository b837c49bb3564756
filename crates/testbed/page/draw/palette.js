// Colours of shapes.

/**
 * Colours: sphere, capsule, box, cylinder and cone, hull; kinematic; static; ground that is seen from both sides:
 * meshes, height fields; planes, which have no end.
 */
const TONES = ['#d9604c', '#e3a23c', '#4d82c4', '#57a773', '#8f6fc0', '#3aa39a', '#c3c7cd', '#b3b8b0', '#cfd2cc'];
/** Colours of figures: dynamic bodies that are joined have one. */
const FIGURES = ['#d9604c', '#4d82c4', '#57a773', '#e3a23c', '#8f6fc0', '#3aa39a', '#c8688f', '#8a9a3c'];
export const KINEMATIC = 5;
export const STATIC = 6;
export const GROUND = 7;

const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);

/** The figure of each shape, counted from 0; -1 for shapes that no joint holds. */
export function figures(tones, links) {
    const root = tones.map((_, i) => i);
    const find = (i) => {
        while (root[i] !== i) i = root[i] = root[root[i]];
        return i;
    };
    const joined = new Set();
    for (let k = 0; k + 1 < links.length; k += 2) {
        const [a, b] = [links[k], links[k + 1]];
        if (tones[a] >= KINEMATIC || tones[b] >= KINEMATIC) continue;
        root[find(a)] = find(b);
        joined.add(a).add(b);
    }
    const numbers = new Map();
    return tones.map((_, i) => {
        if (!joined.has(i)) return -1;
        const of = find(i);
        if (!numbers.has(of)) numbers.set(of, numbers.size);
        return numbers.get(of);
    });
}

/** Red, green and blue of a shape by its tone, its figure and its place in the list. */
export function colour(tone, figure, i) {
    const own = rgb(figure < 0 ? TONES[tone] : FIGURES[figure % FIGURES.length]);
    if (tone >= STATIC) return own;
    // Neighbours of a kind differ a little, so that they can be told apart; joined ones belong together.
    const scale = 1 + (((i * 0.618034) % 1) - 0.5) * (figure < 0 ? 0.2 : 0.12);
    return own.map((x) => Math.min(1, x * scale));
}
