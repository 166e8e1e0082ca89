// Decodes frames of one group after the other, and makes slice trees of them, in a worker.
//   in:  {id, group: {key, tables, depth, degree, mostLeaves, boxSize}, bytes, sizes, partCount, wantsTree}
//   out: {id, tree} or {id, error}; the tree's arrays are whole rows of textures
import {compiled, copied, instantiated} from './decoder.js';
import {kWidth} from './slice_tree.js';

let codec, group = null, groupKey = null;

function enter(wanted) {
    if (groupKey === wanted.key) return;
    if (group) codec.neuvv_group_free(group);
    group = groupKey = null;
    const tables = copied(codec, wanted.tables);
    group = codec.neuvv_group_new(tables, wanted.tables.length, wanted.depth, wanted.degree, wanted.mostLeaves);
    codec.free(tables);
    if (!group) throw new Error('the tables of the stream are damaged');
    groupKey = wanted.key;
}

function text(place) {
    const bytes = new Uint8Array(codec.memory.buffer);
    return new TextDecoder().decode(bytes.slice(place, bytes.indexOf(0, place)));
}

function decode(request) {
    const bytes = copied(codec, request.bytes), sizes = copied(codec, new Uint8Array(Uint32Array.from(request.sizes).buffer));
    const leaves = codec.neuvv_group_decode(group, bytes, request.bytes.length, sizes, request.partCount);
    codec.free(bytes);
    codec.free(sizes);
    if (leaves < 0) throw new Error(`a frame ${text(codec.neuvv_group_error(group))}`);
}

function sliceTree(request) {
    const tree = codec.neuvv_slice_tree_new(group, ...request.group.boxSize);
    if (!tree) throw new Error('there is no memory for a frame');
    const [nodes, entries, links, nodeLevels, topLevels, topFirst, topLast, scale] =
        new Uint32Array(codec.memory.buffer, codec.neuvv_slice_tree_shape(tree), 8);
    const words = (place, channels, count) => {
        const rows = Math.max(1, Math.ceil(count / kWidth)), result = new Uint32Array(rows * kWidth * channels);
        result.set(new Uint32Array(codec.memory.buffer, place, count * channels));
        return result;
    };
    const result = {nodeLevels, topLevels, topFirst, topLast, scale, degree: request.group.degree,
                    nodes: words(codec.neuvv_slice_tree_nodes(tree), 4, nodes),
                    entries: words(codec.neuvv_slice_tree_entries(tree), 2, (request.group.degree + 1) ** 2 * entries),
                    links: words(codec.neuvv_slice_tree_links(tree), 1, links)};
    codec.neuvv_slice_tree_free(tree);
    return result;
}

const ready = compiled(new URL('decoder.wasm', import.meta.url)).then(instantiated).then(exports => codec = exports);

self.onmessage = async ({data}) => {
    try {
        await ready;
        enter(data.group);
        decode(data);
        const tree = data.wantsTree ? sliceTree(data) : null;
        self.postMessage({id: data.id, tree}, tree ? [tree.nodes.buffer, tree.entries.buffer, tree.links.buffer] : []);
    } catch (error) {
        self.postMessage({id: data.id, error: String(error.message ?? error)});  // WebAssembly's have no message
    }
};
