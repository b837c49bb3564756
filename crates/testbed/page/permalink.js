// The state of the page in its address: `#sample=pile&size=2000&substeps=8&layers=real,normals`.

/** What is not a setting. */
const RESERVED = ['sample', 'size', 'layers', 'speed', 'rate', 'play', 'follow', 'camera'];

function value(text) {
    if (text === 'true' || text === 'false') return text === 'true';
    if (text === 'none') return null;
    if (/^[-+.\de]+(,[-+.\de]+)+$/.test(text)) return text.split(',').map(Number);
    const number = Number(text);
    return text !== '' && Number.isFinite(number) ? number : text;
}

/** The state that an address says; fields that it doesn't mention are missing. */
export function parsed(hash) {
    const asked = new URLSearchParams(hash.replace(/^#/, ''));
    const state = { settings: {} };
    for (const [name, text] of asked) {
        if (name === 'sample' || name === 'scene') state.sample = text;
        else if (name === 'layers') state.layers = text.split(',').filter(Boolean);
        else if (name === 'follow') state.follow = text === '1';
        else if (name === 'play') state.play = text !== '0';
        else if (RESERVED.includes(name)) state[name] = value(text);
        else state.settings[name] = value(text);
    }
    return state;
}

const text = (value) => (value === null ? 'none' : Array.isArray(value) ? value.join(',') : String(value));

/** The address of a state; what is as at first is left out. */
export function written({ sample, size, settings, layers, speed, rate, play, follow, camera }) {
    const parts = [['sample', sample]];
    if (size !== undefined) parts.push(['size', size]);
    for (const [name, value] of Object.entries(settings)) parts.push([name, text(value)]);
    if (layers) parts.push(['layers', layers.join(',')]);
    if (rate !== undefined && rate !== 60) parts.push(['rate', rate]);
    if (speed !== undefined && speed !== 1) parts.push(['speed', speed]);
    if (follow !== undefined) parts.push(['follow', follow ? 1 : 0]);
    if (play === false) parts.push(['play', 0]);
    if (camera) parts.push(['camera', camera.map((x) => Number(x.toPrecision(4))).join(',')]);
    return '#' + parts.map(([name, value]) => `${name}=${encodeURIComponent(value).replaceAll('%2C', ',')}`).join('&');
}
