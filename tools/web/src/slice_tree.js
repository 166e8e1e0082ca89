// What drawing needs of a slice tree, as worker.js makes it.

export const kWidth = 4096;  // of textures; kTextureWidthLog2 of shaders/arrays.glsl
export const kStop = 1 / 4096;  // the transmittance below which a ray ends, as in render/volume/trace.h

/** The names and contents of a slice tree's textures: words of rows of kWidth texels. */
export const texturesOf = tree => [{name: 'tree_links', channels: 1, words: tree.links}, {name: 'nodes', channels: 4, words: tree.nodes},
                                   {name: 'entries', channels: 2, words: tree.entries}]
    .map(one => ({...one, rows: one.words.length / one.channels / kWidth}));

/** What performer.frag has to know of a tree: the box of its cells, and the one around its leaves, metres. */
export function boxesOf({boxMin, boxSize, scale, topLevels, topFirst, topLast}) {
    const size = boxSize.map(edge => scale * edge);
    const at = (packed, more) => [0, 1, 2].map(axis => boxMin[axis] + ((packed >>> 10 * axis & 1023) + more) / 4 ** topLevels * size[axis]);
    return {min: boxMin, size, leaves: {min: at(topFirst, 0), max: at(topLast, 1)}};
}
