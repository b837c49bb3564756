// Light highlighting of Rust.

import { escaped } from './page.js';

const WORDS = `as break const continue crate else enum false fn for if impl in let loop match mod move mut pub ref
return self static struct super trait true type unsafe use where while dyn`.split(/\s+/);

/** What is looked for, in this order: the names are classes of CSS. */
const PARTS = [
    ['comment', '//[^\\n]*|/\\*[\\s\\S]*?\\*/'],
    ['string', 'r#*"[\\s\\S]*?"#*|b?"(?:\\\\.|[^"\\\\])*"|b?\'(?:\\\\.|[^\'\\\\])\''],
    ['attribute', '#!?\\[[^\\]]*\\]'],
    ['lifetime', "'[a-z_]+"],
    ['number', '\\b\\d[\\d_]*(?:\\.\\d[\\d_]*)?(?:e-?\\d+)?(?:f32|f64|u\\d+|i\\d+|usize|isize)?\\b'],
    ['keyword', `\\b(?:${WORDS.join('|')})\\b`],
    ['type', '\\b[A-Z]\\w*\\b'],
    ['call', '\\b[a-z_]\\w*(?=!?\\()'],
];
const ALL = new RegExp(PARTS.map(([name, pattern]) => `(?<${name}>${pattern})`).join('|'), 'g');

/** A text of Rust as HTML. */
export function highlighted(text) {
    let [html, last] = ['', 0];
    for (const found of text.matchAll(ALL)) {
        const [name] = Object.entries(found.groups).find(([, value]) => value !== undefined);
        html += escaped(text.slice(last, found.index)) + `<span class="${name}">${escaped(found[0])}</span>`;
        last = found.index + found[0].length;
    }
    return html + escaped(text.slice(last));
}
