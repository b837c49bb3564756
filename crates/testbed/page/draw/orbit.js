// Turns, moves and zooms a camera by mouse and touch.

/** A press that moves less than this is a click [pixels], if it is not longer than `PATIENCE` [ms]. */
const NEAR = 6;
const PATIENCE = 450;

/**
 * Orbits by one finger or button; pans by two, the other buttons or shift; zooms by wheel and pinch.
 *
 * `hand`, where given, is asked first: `press(event)` when a button or a finger goes down, and while it is
 * `holding` it gets `move(event)` and `wheel(event)` in place of the camera; `drop()` ends that; `click(event)`
 * is a short press, and two frame what moves if it `doubles`. While it is `waiting` to know whether it holds
 * something, nothing moves.
 */
export function orbit(canvas, view, hand = { doubles: true, press() {}, drop() {}, click() {} }) {
    const { camera } = view;
    const fingers = new Map();
    let start;
    const middle = () => {
        const all = [...fingers.values()];
        const [x, y] = [0, 1].map((i) => all.reduce((s, p) => s + p[i], 0) / all.length);
        const spread = all.length > 1 ? Math.hypot(all[0][0] - all[1][0], all[0][1] - all[1][1]) : 0;
        return { x, y, spread };
    };
    const away = (e) => Math.hypot(e.clientX - start.x, e.clientY - start.y);
    canvas.style.touchAction = 'none';
    canvas.addEventListener('pointerdown', (e) => {
        try {
            canvas.setPointerCapture(e.pointerId);
        } catch {
            // The pointer is up already.
        }
        fingers.set(e.pointerId, [e.clientX, e.clientY]);
        start = { x: e.clientX, y: e.clientY, time: e.timeStamp, click: fingers.size === 1 && e.button === 0 };
        if (fingers.size > 1) hand.drop();
        else if (e.button === 0 && !e.shiftKey) hand.press(e);
    });
    canvas.addEventListener('pointermove', (e) => {
        hand.hover?.(e);
        if (!fingers.has(e.pointerId)) return;
        const before = middle();
        fingers.set(e.pointerId, [e.clientX, e.clientY]);
        if (start.click && away(e) > NEAR) start.click = false;
        if (hand.holding || hand.waiting) {
            hand.move(e);
            return;
        }
        if (start.click) return;
        const after = middle();
        const [dx, dy] = [after.x - before.x, after.y - before.y].map((d) => d / canvas.clientHeight);
        const pans = fingers.size > 1 || e.shiftKey || Boolean(e.buttons & 6);
        if (pans) camera.pan(-dx, dy);
        else camera.turn(-4 * dx, 3 * dy);
        if (before.spread > 0 && after.spread > 0) camera.zoomBy(before.spread / after.spread);
        view.moved(pans);
    });
    for (const end of ['pointerup', 'pointercancel']) {
        canvas.addEventListener(end, (e) => {
            if (!fingers.delete(e.pointerId)) return;
            hand.drop();
            if (end === 'pointerup' && start.click && e.timeStamp - start.time < PATIENCE) hand.click(e);
        });
    }
    canvas.addEventListener('contextmenu', (e) => e.preventDefault());
    canvas.addEventListener('wheel', (e) => {
        e.preventDefault();
        if (hand.holding) {
            hand.wheel(e);
            return;
        }
        camera.zoomBy(Math.exp(Math.max(-60, Math.min(60, e.deltaY)) * 0.004));
        view.moved();
    }, { passive: false });
    canvas.addEventListener('dblclick', () => hand.doubles && view.home());
}
