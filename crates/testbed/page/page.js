// Small helpers around the document.

export const element = (id) => document.getElementById(id);

/** A new element with properties and children. */
export function make(tag, properties = {}, ...children) {
    const made = Object.assign(document.createElement(tag), properties);
    made.append(...children);
    return made;
}

export function shows(id, shown) {
    element(id).hidden = !shown;
}

/** Tells an error, or takes it away without one. */
export function tell(error) {
    const text = error === undefined || error === null ? '' : String(error.message ?? error);
    Object.assign(element('error'), { hidden: text === '', textContent: text });
}

export const escaped = (text) => text.replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);

/** A number for reading: four digits, and no more zeros than it needs. */
export function figure(x) {
    if (!Number.isFinite(x)) return String(x);
    if (Number.isInteger(x) && Math.abs(x) < 1e6) return String(x);
    const size = Math.abs(x);
    if (size >= 1e5 || (size > 0 && size < 1e-3)) return x.toExponential(2);
    return String(Number(x.toPrecision(size < 1 ? 3 : 5)));
}
