// A moving picture of still ones, in the container of WebP (RFC 9649).

const chunk = (name, bytes) => {
    const head = Buffer.alloc(8);
    head.write(name, 0, 'latin1');
    head.writeUInt32LE(bytes.length, 4);
    return Buffer.concat([head, bytes, Buffer.alloc(bytes.length & 1)]);
};

/** A number as three bytes. */
const three = (n) => Buffer.from([n & 255, (n >> 8) & 255, (n >> 16) & 255]);

/** The chunk of a still picture that has its pixels. */
function pixels(still) {
    for (let at = 12; at + 8 <= still.length; ) {
        const name = still.toString('latin1', at, at + 4);
        const length = still.readUInt32LE(at + 4);
        if (name === 'VP8 ' || name === 'VP8L') return chunk(name, still.subarray(at + 8, at + 8 + length));
        at += 8 + length + (length & 1);
    }
    throw new Error('no picture');
}

/** `stills`: opaque pictures of one size as WebP; each is shown for `duration` [ms], over and over. */
export function animated(stills, { width, height, duration }) {
    const size = [three(width - 1), three(height - 1)];
    const frames = stills.map((still, i) => {
        // Whole milliseconds that don't add up to an error.
        const shown = Math.round((i + 1) * duration) - Math.round(i * duration);
        const head = Buffer.concat([three(0), three(0), ...size, three(shown), Buffer.from([2])]);
        return chunk('ANMF', Buffer.concat([head, pixels(still)]));
    });
    const moving = Buffer.from([2, 0, 0, 0]);
    const all = [chunk('VP8X', Buffer.concat([moving, ...size])), chunk('ANIM', Buffer.alloc(6)), ...frames];
    const body = Buffer.concat([Buffer.from('WEBP', 'latin1'), ...all]);
    return chunk('RIFF', body);
}
