// Decodes frames of one group after the other, and makes slice trees of them, in a worker.
//   first: {module}, decoder.wasm as it is compiled
//   in:  {id, group: {key, tables, depth, degree, mostLeaves, boxSize, budget}, bytes, sizes, partCount, wantsTree}; tables: null where those of
//       the last group go on
//   out: {id, tree, coarser, times: {shapes, shapes_s, planeBytes, planes_s, tree_s}} or {id, error}; the tree's arrays are
//        whole rows of textures; coarser: by how many levels its finest leaves are larger than the stream's
import {copied, instantiated, textAt} from './decoder.js';
import {kBeginnings} from './nvs.js';
import {kWidth} from './slice_tree.js';

let ready = null, codec, group = null, groupKey = null;

function enter(wanted) {
    if (groupKey === wanted.key) return;
    if (group) codec.neuvv_group_free(group);
    group = groupKey = null;
    const tables = copied(codec, wanted.tables);
    group = codec.neuvv_group_new(tables, wanted.tables.length, wanted.depth, wanted.degree, wanted.mostLeaves, wanted.budget);
    codec.free(tables);
    if (!group) throw new Error('the tables of the stream are damaged');
    groupKey = wanted.key;
}

// Returns the seconds that it took.
function decode(request) {
    const bytes = copied(codec, request.bytes), sizes = copied(codec, new Uint8Array(Uint32Array.from(request.sizes).buffer));
    const step = run => {
        const begin = performance.now(), leaves = run(group, bytes, request.bytes.length, sizes, request.partCount);
        if (leaves < 0) throw new Error(`a frame ${textAt(codec, codec.neuvv_group_error(group))}`);
        return (performance.now() - begin) / 1000;
    };
    try {
        const shapes_s = step(codec.neuvv_group_decode_shape);
        const planes_s = step(request.partCount === kBeginnings ? codec.neuvv_group_decode_beginnings : codec.neuvv_group_decode_planes);
        return {shapes: 1, shapes_s, planes_s, planeBytes: request.bytes.length - request.sizes[0]};
    } finally {
        codec.free(bytes);
        codec.free(sizes);
    }
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

self.onmessage = async ({data}) => {
    if (data.module) {
        ready = instantiated(data.module).then(exports => codec = exports);
        ready.catch(() => {});  // it is thrown where frames are asked for
        return;
    }
    try {
        await ready;
        enter(data.group);
        const times = decode(data), begin = performance.now();
        const tree = data.wantsTree ? sliceTree(data) : null;
        times.tree_s = (performance.now() - begin) / 1000;
        self.postMessage({id: data.id, tree, coarser: codec.neuvv_group_coarser(group), times}, tree ? [tree.nodes.buffer, tree.entries.buffer, tree.links.buffer] : []);
    } catch (error) {
        self.postMessage({id: data.id, error: String(error.message ?? error)});  // WebAssembly's have no message
    }
};
