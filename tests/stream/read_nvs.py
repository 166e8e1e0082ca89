#!/usr/bin/env python3
"""A reader of .nvs files that follows engine/stream/README.md alone.

It is slow and simple, and is used to check the test vectors: it shows that the page says all that
a reader needs. It shares no code with the engine.

    read_nvs.py FILE.nvs...

decodes all frames of each file, and frame 0 also by its first 1, 2, 3 and 4 parts, and compares
them with FILE.json beside it, exactly. It exits with 1 where a file is broken or anything differs.
"""

import json
import math
import pathlib
import struct
import sys
import zlib

# The kinds of tables: how many there are of each, and how many symbols each table has.
TABLES = {
    "octants": (128, 256),
    "leaves": (8, 2),
    "repeats": (2, 2),
    "any": (108, 2),
    "numbers": (108, 16),
}
TOTAL = 4096  # The shares of a table sum to this.
LEAST_STATE = 65536  # Between two symbols the state of a stream is never less.
ESCAPE = 15
PARTS = 5
KINDS = 6


def check(condition, message):
    """Raises ValueError where the condition does not hold."""
    if not condition:
        raise ValueError(message)


def to_f32(number):
    """The nearest number of 32 bits, so that each operation can be rounded as `f32` is."""
    return struct.unpack("<f", struct.pack("<f", number))[0]


# ---------------------------------------------------------------------------------------------
# Bytes


class Bytes:
    """Takes numbers from bytes, one after the other, and never beyond their end."""

    def __init__(self, data, name):
        self.data = data
        self.name = name
        self.position = 0

    def take_bytes(self, count):
        end = self.position + count
        check(end <= len(self.data), f"{self.name} ends too early")
        taken = self.data[self.position:end]
        self.position = end
        return taken

    def take(self, layout):
        """Takes numbers of a `struct` layout, lowest byte first, as a tuple."""
        layout = "<" + layout
        return struct.unpack(layout, self.take_bytes(struct.calcsize(layout)))

    def finish(self):
        check(self.position == len(self.data), f"{self.name} has bytes left over")


# ---------------------------------------------------------------------------------------------
# The file's head


class Group:
    """What the head says of a group; `frames` is a list of (whether it is a key frame,
    lengths of the parts, their CRCs)."""

    def __init__(self, head, version):
        self.frame_count, self.depth, self.degree, self.most_leaves = head.take("4I")
        head.take("6f")  # The box is needed only to draw the leaves.
        self.offset, self.table_bytes, self.table_crc = head.take("QII")
        head.take("8x")
        if version >= 3:
            filled = head.take("6f")
            check(not any(filled) or all(0 <= filled[i] and filled[3 + i] - filled[i] >= 2**-12
                                         and filled[3 + i] <= 1 for i in range(3)),
                  "the leaves of a group lie in a box that cannot be")
        self.frames = []
        check(1 <= self.frame_count <= 1000, "a group has no frames or too many")
        check(self.depth in range(2, 13, 2), f"depth {self.depth} of a group is not allowed")
        check(self.degree <= 3, f"degree {self.degree} of a group is not allowed")
        check(self.most_leaves <= 2**24, "a group has too many leaves")
        self.plane_count = 1 + 3 * (self.degree + 1) ** 2

    def byte_count(self):
        return self.table_bytes + sum(sum(lengths) for _, lengths, _ in self.frames)


def read_header(data):
    """The groups of a file, in order, with the places of their frames' parts."""
    head = Bytes(data, "the head")
    check(head.take_bytes(8) == b"NVStream", "the file is no NVStream")
    (version,) = head.take("I")
    check(version in (2, 3), f"version {version} is not known")
    frame_count, group_count, frames_a_second = head.take("IIf")
    head.take("8x")
    check(1 <= frame_count <= 10**7, "the file has no frames or too many")
    check(1 <= group_count <= frame_count, "the file has no groups or too many")
    check(0.001 <= frames_a_second <= 10000, "the number of frames a second is not allowed")

    groups = [Group(head, version) for _ in range(group_count)]
    check(sum(g.frame_count for g in groups) == frame_count, "the groups miss or add frames")
    for group in groups:
        for _ in range(group.frame_count):
            (is_key,) = head.take("I")
            lengths, crcs = head.take(f"{PARTS}I"), head.take(f"{PARTS}I")
            group.frames.append((is_key, lengths, crcs))
    crc = zlib.crc32(data[:head.position])
    check(head.take("I")[0] == crc, "the CRC of the head is wrong")
    check_places(groups, head.position, len(data))
    return groups


def check_places(groups, position, end):
    """The groups follow the head, and each other, without gaps until the end of the file."""
    for group in groups:
        check(group.offset == position, "a group does not begin where the one before ends")
        position += group.byte_count()
    check(position == end, "the file does not end where its last group does")


# ---------------------------------------------------------------------------------------------
# Symbols


def read_tables(data, group):
    """The tables of a group: for each kind a list of tables, each a list of shares."""
    stored = data[group.offset:group.offset + group.table_bytes]
    check(zlib.crc32(stored) == group.table_crc, "the CRC of a group's tables is wrong")
    size = sum(2 * number * symbols for number, symbols in TABLES.values())
    inflater = zlib.decompressobj()
    try:
        content = inflater.decompress(stored, size + 1)
    except zlib.error as error:
        raise ValueError(f"the tables are no zlib stream: {error}") from error
    check(inflater.eof and not inflater.unused_data, "the tables' zlib stream has a wrong length")

    shares = Bytes(content, "the list of tables")
    tables = {}
    for kind, (number, symbols) in TABLES.items():
        tables[kind] = [checked(list(shares.take(f"{symbols}H"))) for _ in range(number)]
    shares.finish()
    return tables


def checked(shares):
    """A table of these shares."""
    check(sum(shares) == TOTAL, "the shares of a table have a wrong sum")
    return shares


class Stream:
    """Takes symbols from the bytes of a stream."""

    def __init__(self, data, name):
        self.words = Bytes(data, name)
        self.name = name
        self.state = LEAST_STATE
        if data:
            high, low = self.words.take("HH")
            self.state = 65536 * high + low
            check(self.state >= LEAST_STATE, f"{name} begins with a wrong state")

    def take_symbol(self, shares):
        check(self.words.data, f"{self.name} is empty, but a symbol is needed")
        v = self.state % TOTAL
        first = 0
        symbol = 0
        while v >= first + shares[symbol]:
            first += shares[symbol]
            symbol += 1
        self.state = shares[symbol] * (self.state // TOTAL) + v - first
        if self.state < LEAST_STATE:
            self.state = 65536 * self.state + self.words.take("H")[0]
        return symbol

    def take_bits(self, count):
        return self.take_symbol([TOTAL >> count] * (1 << count))

    def take_number(self, shares):
        """A coefficient: a symbol of the table, or an escape with the digits of the number."""
        f = self.take_symbol(shares)
        if f == ESCAPE:
            f = 14 + self.take_escaped()
        q = (f + 1) // 2 if f % 2 == 1 else -(f // 2)
        check(-32768 <= q <= 32767, f"{self.name} has a coefficient that is too large")
        return q

    def take_escaped(self):
        """A number m >= 1: how many binary digits follow its highest, then these digits."""
        digits = self.take_bits(4)
        above = max(digits - 8, 0)
        m = 1
        if above > 0:
            m = (m << above) + self.take_bits(above)
        return (m << (digits - above)) + self.take_bits(digits - above)

    def finish(self):
        self.words.finish()
        check(self.state == LEAST_STATE, f"{self.name} ends with a wrong state")


# ---------------------------------------------------------------------------------------------
# Leaves and cells


class Cell:
    """A cell of the octree of the leaves that are not repeated."""

    def __init__(self, depth, code):
        self.depth = depth
        self.code = code
        self.is_leaf = False
        self.octants = [None] * 8


def place_of(code, depth):
    """The x, y and z of a cell, from the alternating bits of its code."""
    place = [0, 0, 0]
    for bit in range(3 * depth):
        place[bit % 3] += (code >> bit & 1) << bit // 3
    return tuple(place)


def read_octree(stream, tables, depth, leaf_count):
    """The cells of the octree: a list for each depth from 0, in order of their codes."""
    levels = [[Cell(0, 0)]]
    found = 0
    for d in range(depth):
        parents = [cell for cell in levels[d] if not cell.is_leaf]
        read_octants(stream, tables["octants"], levels[d], 0 if d == depth - 1 else 1)
        children = [octant for cell in parents for octant in cell.octants if octant]
        if d < depth - 1:
            read_leaves(stream, tables["leaves"], parents, 0 if d == depth - 2 else 1)
        else:
            for cell in children:
                cell.is_leaf = True
        found += sum(cell.is_leaf for cell in children)
        check(found <= leaf_count, "the octree has too many leaves")
        levels.append(children)
    check(found == leaf_count, "the octree has too few leaves")
    return levels


def read_octants(stream, tables, cells, c):
    """Gives each of the cells of a depth that is no leaf its octants."""
    places = {place_of(cell.code, cell.depth) for cell in cells}
    for cell in cells:
        if cell.is_leaf:
            continue
        table = tables[64 * c + neighbours_of(place_of(cell.code, cell.depth), places)]
        octants = stream.take_symbol(table)
        check(octants != 0, "a cell that is no leaf has no octants")
        for i in range(8):
            if octants >> i & 1:
                cell.octants[i] = Cell(cell.depth + 1, 8 * cell.code + i)


def neighbours_of(place, places):
    """A bit for each face at which there is a cell: -x, +x, -y, +y, -z, +z."""
    x, y, z = place
    touching = [(x - 1, y, z), (x + 1, y, z), (x, y - 1, z),
                (x, y + 1, z), (x, y, z - 1), (x, y, z + 1)]
    return sum(1 << bit for bit, other in enumerate(touching) if other in places)


def read_leaves(stream, tables, parents, c):
    """Says of the octants of the cells whether they are leaves."""
    for cell in parents:
        before = 0
        for octant in cell.octants:
            if octant:
                octant.is_leaf = stream.take_symbol(tables[4 * c + before]) == 1
                before |= 1 if octant.is_leaf else 2


# ---------------------------------------------------------------------------------------------
# Pairs, coefficients and planes


def halvings_of(cell):
    """How a cell is divided, in order: (first octant, first octant of the second half, octants of
    a half, whether it is a pair). The halves that have no cells at all are left out."""
    halvings = []
    for s in (4, 2, 1):
        for i in range(0, 8, 2 * s):
            first = any(cell.octants[i:i + s])
            second = any(cell.octants[i + s:i + 2 * s])
            if first or second:
                halvings.append((i, i + s, s, first and second))
    return halvings


def activity_class(a):
    return (0, 1, 2, 3, 3, 4, 4, 4)[a] if a < 8 else 5


class PlaneDecoder:
    """Decodes one plane of the leaves that are not repeated."""

    def __init__(self, levels, plane, tables):
        self.levels = levels
        self.depth = len(levels) - 1
        self.kind = plane if plane < 4 else 4 if plane % 3 == 1 else 5
        self.tables = tables
        self.activities = {levels[0][0]: 0}
        self.coefficients = {}  # For each cell whose stream is there, those of its pairs.

    def read_coarse(self, stream):
        for d in range(self.depth - 1):
            self.read_depth(stream, d)
        stream.finish()

    def read_fine(self, stream):
        self.read_depth(stream, self.depth - 1)
        stream.finish()

    def read_depth(self, stream, d):
        t = 18 * self.kind + 6 * min(self.depth - 1 - d, 2)
        for cell in self.levels[d]:
            if not cell.is_leaf:
                self.read_cell(stream, cell, t)

    def read_cell(self, stream, cell, t):
        """Reads the coefficients of a cell, and passes its activity to its octants."""
        halvings = halvings_of(cell)
        pair_count = sum(is_pair for *_, is_pair in halvings)
        activity = self.activities[cell]
        if pair_count == 0:
            self.coefficients[cell] = []
            octant_activities = [activity] * 8
        elif stream.take_symbol(self.tables["any"][t + activity_class(activity)]) == 0:
            self.coefficients[cell] = [0] * pair_count
            octant_activities = [activity // 2] * 8
        else:
            octant_activities = self.read_numbers(stream, cell, t)
        for octant, octant_activity in zip(cell.octants, octant_activities):
            if octant:
                self.activities[octant] = octant_activity

    def read_numbers(self, stream, cell, t):
        """Reads a cell's coefficients one by one, and returns the activities of its octants."""
        numbers = []
        halves = [self.activities[cell]] * 8  # The activity of a half is at its first octant.
        for first, second, _, is_pair in halvings_of(cell):
            a = halves[first]
            if is_pair:
                q = stream.take_number(self.tables["numbers"][t + activity_class(a)])
                numbers.append(q)
                a = min(a // 2 + 2 * min(abs(q), 8), 15)
            halves[first] = halves[second] = a
        check(any(numbers), f"{stream.name} has a cell whose coefficients should not all be 0")
        self.coefficients[cell] = numbers
        return halves

    def numbers_of_leaves(self, root, step, leaf_weights, is_opacity):
        """The plane of the leaves, as a dictionary from each leaf to its number."""
        weights = self.weights_of_cells(leaf_weights)
        values = {self.levels[0][0]: to_f32(root)}
        for level in self.levels:
            for cell in level:
                if not cell.is_leaf:
                    self.divide(cell, values, weights, step, 1 if is_opacity else 1 / 1023)
        least, greatest = (0, 1023) if is_opacity else (-4092, 4092)
        return {leaf: whole(values[leaf], least, greatest) for leaf in leaf_weights}

    def weights_of_cells(self, leaf_weights):
        """The weights of all cells, each the sum of those of its leaves."""
        weights = dict(leaf_weights)
        for level in reversed(self.levels):
            for cell in level:
                if not cell.is_leaf:
                    weights[cell] = sum(weights[octant] for octant in cell.octants if octant)
        return weights

    def divide(self, cell, values, weights, step, u):
        """Passes the value of a cell to its octants, pair by pair."""
        octant_weights = [weights[octant] if octant else 0 for octant in cell.octants]
        numbers = iter(self.coefficients.get(cell, []))
        halves = [values[cell]] * 8  # The value of a half is at its first octant.
        for first, second, s, is_pair in halvings_of(cell):
            v = halves[first]
            if is_pair:
                w_a = sum(octant_weights[first:first + s])
                w_b = sum(octant_weights[second:second + s])
                # The coefficients of a missing stream are 0.
                halves[first], halves[second] = divide_pair(v, next(numbers, 0), step, w_a, w_b, u)
            else:
                halves[first] = halves[second] = v
        for octant, value in zip(cell.octants, halves):
            if octant:
                values[octant] = value


def divide_pair(v, q, step, w_a, w_b, u):
    """The values of the two halves of a pair."""
    w_a, w_b = float(w_a), float(w_b)
    r = to_f32(math.sqrt((w_a + w_b) / ((w_a * w_b) * u)))
    b = to_f32(w_b / (w_a + w_b))
    e = to_f32(to_f32(to_f32(q) * to_f32(step)) * r)
    v_a = to_f32(v - to_f32(b * e))
    v_b = to_f32(v_a + e)
    return v_a, v_b


def whole(value, least, greatest):
    return math.floor(to_f32(min(max(value, least), greatest) + 0.5))


# ---------------------------------------------------------------------------------------------
# Frames


class Frame:
    """A decoded frame: `leaves` is a list of (first cell at depth D, depth), in order, and
    `planes` is a list of planes, each a list with a number for each leaf."""

    def __init__(self, leaves, planes):
        self.leaves = leaves
        self.planes = planes


def check_leaves(leaves, depth, most_leaves):
    """There are not too many leaves, and none overlaps the next."""
    check(len(leaves) <= most_leaves, "a frame has too many leaves")
    end = 0
    for first_cell, leaf_depth in leaves:
        check(first_cell >= end, "leaves of a frame overlap")
        end = first_cell + 8 ** (depth - leaf_depth)


def read_repeats(stream, tables, before):
    """The places of the leaves of the frame before that this frame repeats."""
    repeated = []
    symbol = 0
    block = None
    for i, (first_cell, _) in enumerate(before.leaves):
        if first_cell // 64 != block:
            block = first_cell // 64
            symbol = stream.take_symbol(tables["repeats"][symbol])
        if symbol == 1:
            repeated.append(i)
    return repeated


def parts_of_frames(data, group):
    """The parts of all frames of a group: parts 0 of its frames stand first, then parts 1, ..."""
    position = group.offset + group.table_bytes
    parts_of = [[] for _ in group.frames]
    for i in range(PARTS):
        for parts, (_, lengths, crcs) in zip(parts_of, group.frames):
            part = data[position:position + lengths[i]]
            check(zlib.crc32(part) == crcs[i], f"the CRC of part {i} of a frame is wrong")
            parts.append(part)
            position += lengths[i]
    return parts_of


def split_streams(part, planes, name):
    """The streams of a part, one for each of the planes."""
    content = Bytes(part, name)
    lengths = content.take(f"{len(planes)}I")
    streams = [
        Stream(content.take_bytes(length), f"{name}, plane {plane}")
        for plane, length in zip(planes, lengths)
    ]
    content.finish()
    return streams


def decode_frame(parts, group, tables, before):
    """Decodes a frame from its first parts. The frame before is None at a group's beginning."""
    shape = Bytes(parts[0], "part 0")
    is_key, leaf_count = shape.take("BI")
    steps = shape.take(f"{KINDS}H")
    roots = shape.take(f"{group.plane_count}h")
    (length,) = shape.take("I")
    stream = Stream(shape.take_bytes(length), "the stream of the shape")
    shape.finish()
    check(is_key in (0, 1), "a frame is neither a key frame nor none")
    check(is_key or before, "the first frame of a group is no key frame")
    check(leaf_count <= group.most_leaves, "a frame has too many leaves")

    repeated = [] if is_key else read_repeats(stream, tables, before)
    levels = read_octree(stream, tables, group.depth, leaf_count) if leaf_count else []
    stream.finish()
    decoders = read_planes(parts, group, tables, levels)
    decoded = [
        (before.leaves[i], [plane[i] for plane in before.planes]) for i in repeated
    ] + decode_planes(decoders, levels, group.depth, steps, roots)

    decoded.sort(key=lambda leaf: leaf[0])
    leaves = [leaf for leaf, numbers in decoded]
    check_leaves(leaves, group.depth, group.most_leaves)
    planes = [[numbers[i] for leaf, numbers in decoded] for i in range(group.plane_count)]
    return Frame(leaves, planes)


def read_planes(parts, group, tables, levels):
    """Reads the coefficients of all planes, as far as there are parts with them."""
    decoders = []
    if levels:
        decoders = [PlaneDecoder(levels, i, tables) for i in range(group.plane_count)]
    for number in range(1, len(parts)):
        planes = range(4) if number in (1, 3) else range(4, group.plane_count)
        streams = split_streams(parts[number], planes, f"part {number}")
        for plane, stream in zip(planes, streams):
            if not decoders:
                stream.finish()
                check(not stream.words.data, f"{stream.name} should be empty")
            elif number in (1, 2):
                decoders[plane].read_coarse(stream)
            else:
                decoders[plane].read_fine(stream)
    return decoders


def decode_planes(decoders, levels, depth, steps, roots):
    """The leaves that are not repeated, each with its numbers of all planes."""
    leaves = [cell for level in levels for cell in level if cell.is_leaf]
    areas = {leaf: 4 ** (depth - leaf.depth) for leaf in leaves}
    weights = areas
    planes = []
    for i, decoder in enumerate(decoders):
        plane = decoder.numbers_of_leaves(roots[i], steps[decoder.kind], weights, i == 0)
        planes.append(plane)
        if i == 0:
            weights = {leaf: areas[leaf] * max(plane[leaf], 20) for leaf in leaves}
    return [
        ((leaf.code << 3 * (depth - leaf.depth), leaf.depth), [plane[leaf] for plane in planes])
        for leaf in leaves
    ]


def decode_group(data, group):
    """All frames of a group, and its first frame by its first 1, 2, 3 and 4 parts."""
    tables = read_tables(data, group)
    frames = []
    first_parts = []
    for i, parts in enumerate(parts_of_frames(data, group)):
        try:
            check(parts[0][:1] == bytes([group.frames[i][0]]), "a key frame or not differs")
            if i == 0:
                for count in range(1, PARTS):
                    first_parts.append(decode_frame(parts[:count], group, tables, None))
            frames.append(decode_frame(parts, group, tables, frames[-1] if frames else None))
        except ValueError as error:
            raise ValueError(f"frame {i} of the group: {error}") from error
    return frames, first_parts


def read_nvs(data):
    """All frames of a file, and its frame 0 by its first 1, 2, 3 and 4 parts."""
    groups = []
    for i, group in enumerate(read_header(data)):
        try:
            groups.append(decode_group(data, group))
        except ValueError as error:
            raise ValueError(f"group {i}: {error}") from error
    frames = [frame for group_frames, _ in groups for frame in group_frames]
    return frames, groups[0][1]


# ---------------------------------------------------------------------------------------------
# The test vectors


def compare_frame(name, frame, expected):
    """Raises ValueError with the first leaf or plane that differs from what is expected."""
    leaves = [tuple(leaf) for leaf in expected["leaves"]]
    compare_lists(f"{name}: leaf", frame.leaves, leaves)
    check(len(frame.planes) == len(expected["planes"]), f"{name}: the number of planes differs")
    for i, (plane, numbers) in enumerate(zip(frame.planes, expected["planes"])):
        compare_lists(f"{name}: plane {i}, leaf", plane, numbers)


def compare_lists(name, decoded, expected):
    for i, (got, wanted) in enumerate(zip(decoded, expected)):
        check(got == wanted, f"{name} {i} is {got}, expected {wanted}")
    check(len(decoded) == len(expected),
          f"{name}: there are {len(decoded)}, expected {len(expected)}")


def check_file(path):
    """Compares a file with its JSON, and returns how many frames it has."""
    frames, first_parts = read_nvs(path.read_bytes())
    expected = json.loads(path.with_suffix(".json").read_text())
    check(len(frames) == len(expected["frames"]), "the number of frames differs")
    check(len(first_parts) == len(expected["first_parts"]), "the number of first parts differs")
    for i, frame in enumerate(frames):
        compare_frame(f"frame {i}", frame, expected["frames"][i])
    for i, frame in enumerate(first_parts):
        compare_frame(f"frame 0 by {i + 1} of its parts", frame, expected["first_parts"][i])
    return len(frames)


def main(names):
    if not names:
        print("usage: read_nvs.py FILE.nvs...", file=sys.stderr)
        return 2
    for path in map(pathlib.Path, names):
        try:
            print(f"{path.name}: {check_file(path)} frames, as expected")
        except (ValueError, OSError) as error:
            print(f"{path.name}: {error}")
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
