"""The newest figures of each device, engine/measurements/DEVICE.json, and engine/MEASUREMENTS.md, which is made of them.

A file is {"device", "machine", "measurements": [{"title", "command", "commit", "date", "note", "figures"}]}. `figures`
has a number for each label, and the label names its unit; only `note` may be missing. Measurements of one title stand in
one table of the page, with a column for each device. tools/gpu-report --keep adds those that `KEPT` finds in its report.
The page's tables have no spaces around bars, because a bar between spaces counts as a word.
"""
import json
import math
import pathlib
import re
import textwrap

COLUMNS = 140  # of the page's lines
HEAD = """# Measurements

`tools/gpu-report` measures a device; with `--keep DEVICE` it stores the figures in `engine/measurements/DEVICE.json`, of which `--page`
writes this page. *mage*, *mage20* and *m47* are made of a capture that is not part of this repository (36 cameras, 24 times); *performer*
is the person of `tools/performer`. Below each table are command, commit and date. Times are medians, by the device's clock where nothing
else is said.
"""


class Wrong(Exception):
    """A file that lacks something, in one line."""


def path_ms(key):
    return lambda figures: figures['ways'][key]['slice_ms'] + figures['ways'][key]['rest_ms']


def at(*keys):
    def value(figures):
        for key in keys:
            figures = figures[key]
        return figures
    return value


def stage_ms(name):
    return lambda figures: next(way['ms'] for way in figures['ways'] if way['name'] == name)


def share_of_walk(key):
    return lambda figures: figures['trace_ms'][key] / figures['trace_ms']['restart']


# Part of a report: the title, and the figures that are kept.
KEPT = {
    'bench render': ('An image of 1280×720', {
        'the paper\'s path, ms': path_ms('paper'),
        'all weights at each sample, the walk of `march.glsl`, ms': path_ms('direct'),
        'a slice in slots, ms': path_ms('slice'),
        'a slice tree, ms': path_ms('tree'),
        'a slice tree, shaded, ms': path_ms('shaded'),
        'the same, playing: 7.2 views a slice, ms': at('playing', 'ms'),
        'playing, times as fast as the paper\'s path': at('playing', 'times_paper'),
        'of the shaded image: trace, ms': at('shaded_passes_ms', 'trace')}),
    'bench walk': ('The walk through the tree, as a share of the first line', {
        'from the root to every cell': share_of_walk('restart'),
        'a node\'s masks in registers': share_of_walk('node'),
        'between the bounds of tiles': share_of_walk('ranges'),
        'empty octants and nodes in one step': share_of_walk('coalesce'),
        'from the grid over the upper levels': share_of_walk('grid')}),
    'bench slice': ('A slice tree', {
        'density, ms': at('density_ms'), 'nodes, ms': at('nodes_ms'), 'entries, ms': at('entries_ms'),
        'all of it, ms': at('slice_ms')}),
    'bench stereo': ('Both eyes of a headset, slices resident', {
        'one dispatch, ms': at('ways', 'stereo', 'ms'), 'p99, ms': at('ways', 'stereo', 'p99_ms'),
        'one eye after the other, ms': at('ways', 'one_by_one', 'ms'),
        '0.7 rays along a pixel\'s side, ms': at('ways', 'scaled', 'ms'),
        '0.5 rays, ms': at('ways', 'half', 'ms')}),
    'bench xr': ('A headset\'s frame, of a stage with a floor', {
        'waiting for each frame, ms': at('waiting_ms'), 'recording while the device draws, ms': at('overlapping_ms'),
        'host, ms': at('cpu_ms', 'p50'), 'device, ms': at('gpu_ms', 'p50'),
        'latency, p99, ms': at('latency_ms', 'p99')}),
    'bench stage': ('A stage of two performers, by the host\'s clock', {
        'lights of the set alone, ms': stage_ms('plain'), 'with shadows, ms': stage_ms('shadows'),
        'with falloff, ms': stage_ms('falloff'), 'with both, ms': stage_ms('shadows and falloff')}),
    'bench open': ('From a path to an image', {
        'the coarse tree, s': at('first', 'total_s'), 'all of it, s': at('whole', 'total_s')}),
    'bench play': ('A clip that plays on a stage at 25 frames a second', {
        'an image, ms': at('ms'), 'p99, ms': at('p99_ms'), 'after a seek, ms': at('seek_ms'),
        'images that show an earlier frame, of 100': lambda figures: 100 * figures['held_images'] / figures['images']}),
    'bench instances': ('Sixteen copies, all slices resident', {
        'an image, ms': at('all', 'ms'), 'growth of time by growth of covered rays': at('time_by_rays')}),
    **{f'bench train {tiles}': ('A training step by its tiles, millions of rays a second', {
        f'{tiles} tiles': at('mrays_per_second')}) for tiles in (512, 2048, 8192)},
    'eval performer': ('Training *performer*', {
        'PSNR of held-out views, dB': at('psnr'), 'SSIM': at('ssim')}),
}


COMMAND_OF = {'eval performer': 'train performer'}  # the part whose command says what was measured, where it is another


def rounded(value):
    """Four digits, as an integer where it is one."""
    short = float(f'{value:.4g}')
    return int(short) if short == int(short) else short


def command_text(command):
    """Without folders, and without what only a program reads."""
    return ' '.join(pathlib.Path(word).name for word in command.split() if word not in ('--json', '-'))


def kept_of(report):
    """The measurements of a report.json; parts of one title become one measurement."""
    found = {}
    commands = {part['name']: part['command'] for part in report['parts']}
    for part in report['parts']:
        title, labels = KEPT.get(part['name'], (None, {}))
        figures = {}
        for label, value in labels.items() if part.get('figures') else []:
            try:
                number = value(part['figures'])
            except (KeyError, TypeError, StopIteration, ZeroDivisionError):
                continue  # a device may lack a figure, as a clip without a coarse tree does
            if isinstance(number, (int, float)) and math.isfinite(number):
                figures[label] = rounded(number)
        if figures:
            command = commands.get(COMMAND_OF.get(part['name']), part['command'])
            new = {'title': title, 'command': command_text(command), 'commit': report['version'],
                   'date': report['date'][:10], 'figures': {}}
            found.setdefault(title, new)['figures'].update(figures)
    return list(found.values())


def expect(holds, file, text):
    if not holds:
        raise Wrong(f'{file}: {text}')


def read_device(file):
    try:
        device = json.loads(file.read_text(encoding='utf-8'))
    except (OSError, ValueError) as problem:
        raise Wrong(f'{file}: {problem}') from None
    expect(isinstance(device, dict) and set(device) == {'device', 'machine', 'measurements'}, file,
           'it must have device, machine and measurements')
    titles = [one.get('title') for one in device['measurements']]
    for one in device['measurements']:
        title = one.get('title')
        expect(set(one) - {'note'} == {'title', 'command', 'commit', 'date', 'figures'}, file,
               f'"{title}" must have title, command, commit, date, figures, and may have a note')
        expect(titles.count(title) == 1, file, f'"{title}" is there twice')
        expect(re.fullmatch('[0-9a-f]{7,40}', one['commit']), file, f'"{title}" has no commit')
        expect(re.fullmatch(r'\d{4}-\d\d-\d\d', one['date']), file, f'"{title}" has no date')
        expect(one['figures'] and all(type(value) in (int, float) for value in one['figures'].values()), file,
               f'"{title}" must have numbers as figures')
    return device


def keep(report, name, folder):
    """Stores a report's figures as those of the device `name`, in place of earlier ones with the same titles."""
    file = folder / f'{name}.json'
    new = kept_of(report)
    expect(re.fullmatch(r'[\w-]+', name), file, 'the name of a device has letters, digits, _ and - alone')
    expect(not report.get('quick'), file, 'a quick report has no figures worth keeping')
    expect(new, file, 'the report has no figures')
    old = read_device(file)['measurements'] if file.exists() else []
    by_title = {one['title']: one for one in old + new}
    device = {'device': report['device'], 'machine': f'{report["cores"]} cores', 'measurements': list(by_title.values())}
    if file.exists():
        device['machine'] = read_device(file)['machine']
    file.write_text(json.dumps(device, indent=2, ensure_ascii=False) + '\n', encoding='utf-8')
    read_device(file)


def wrapped(text):
    return textwrap.fill(text, COLUMNS, subsequent_indent='  ', break_long_words=False, break_on_hyphens=False)


def section(title, found):
    """`found`: the measurement of each device that has it, by the device's name."""
    labels = list(dict.fromkeys(label for one in found.values() for label in one['figures']))
    lines = [f'## {title}', '', '|' + '|'.join(['', *found]) + '|', '|---' * (len(found) + 1) + '|']
    for label in labels:
        cells = [f'{one["figures"][label]:.10g}' if label in one['figures'] else '' for one in found.values()]
        lines.append('|' + '|'.join([label, *cells]) + '|')
    lines.append('')
    for name, one in found.items():
        note = f'. {one["note"]}' if 'note' in one else ''
        lines.append(wrapped(f'- {name}: `{one["command"]}`, {one["commit"][:8]}, {one["date"]}{note}'))
    return '\n'.join(lines) + '\n'


def page(folder):
    """The text of MEASUREMENTS.md."""
    files = sorted(folder.glob('*.json'), key=lambda file: (file.stem != 'lavapipe', file.stem))
    devices = {file.stem: read_device(file) for file in files}
    lines = [f'- {name}: {device["device"]}; {device["machine"]}' for name, device in devices.items()]
    titles = dict.fromkeys(one['title'] for device in devices.values() for one in device['measurements'])
    sections = []
    for title in titles:
        found = {name: one for name, device in devices.items() for one in device['measurements'] if one['title'] == title}
        sections.append(section(title, found))
    return '\n'.join([HEAD, '\n'.join(lines) + '\n', *sections])
