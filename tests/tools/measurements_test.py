#!/usr/bin/env python3
"""engine/MEASUREMENTS.md is what tools/gpu-report --page makes of engine/measurements/, and --keep adds a report to these.

    measurements_test.py ROOT FOLDER
"""
import json
import pathlib
import shutil
import subprocess
import sys

REPORT = {'device': 'Card', 'version': '0123abcd', 'date': '2026-12-01 10:00 UTC', 'cores': 8, 'quick': False, 'parts': [
    {'name': 'bench slice', 'command': '/x/neuvv-bench slice /y/performer.nvv --json', 'code': 0,
     'figures': {'density_ms': 0.042513, 'nodes_ms': 1234.5, 'entries_ms': None, 'slice_ms': 2}},
    {'name': 'bench train 512', 'command': '/x/neuvv-bench train a b --tiles 512 --json', 'code': 0,
     'figures': {'mrays_per_second': 30}},
    {'name': 'bench train 2048', 'command': '/x/neuvv-bench train a b --tiles 2048 --json', 'code': 0,
     'figures': {'mrays_per_second': 100}},
    {'name': 'train performer', 'command': '/x/neuvv train /y/capture -o p.nvv --minutes 8', 'code': 0},
    {'name': 'eval performer', 'command': '/x/neuvv eval p.nvv --json -', 'code': 0, 'figures': {'psnr': 35.12345}},
    {'name': 'bench walk', 'command': '', 'skipped': 'it is not built'}]}


def expect(holds, what):
    if not holds:
        sys.exit(f'measurements_test: {what}')


def run(root, *options, code=0):
    done = subprocess.run([sys.executable, root / 'tools/gpu-report', *options], capture_output=True, text=True, check=False)
    expect(done.returncode == code, f'{options} ended with {done.returncode}: {done.stdout}{done.stderr}')
    return done.stderr


def copy_of(root, folder):
    shutil.rmtree(folder, ignore_errors=True)
    for part in ('tools/gpu-report', 'tools/measurements.py'):
        (folder / part).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(root / part, folder / part)
    shutil.copytree(root / 'engine/measurements', folder / 'engine/measurements')
    return folder


def check_page(root, copy):
    run(copy, '--page')
    committed = (root / 'engine/MEASUREMENTS.md').read_text(encoding='utf-8')
    expect((copy / 'engine/MEASUREMENTS.md').read_text(encoding='utf-8') == committed,
           'engine/MEASUREMENTS.md is not what its files say: write it by tools/gpu-report --page')
    expect(max(map(len, committed.splitlines())) <= 140, 'a line of the page is too long')


def check_keep(copy):
    report = copy / 'report/report.json'
    report.parent.mkdir()
    report.write_text(json.dumps(REPORT), encoding='utf-8')
    run(copy, '--keep', 'Card', '-o', report.parent)
    changed = dict(REPORT, version='4567cdef', parts=REPORT['parts'][1:])
    changed['parts'][0]['figures']['mrays_per_second'] = 31
    report.write_text(json.dumps(changed), encoding='utf-8')
    run(copy, '--keep', 'Card', '-o', report.parent)
    kept = json.loads((copy / 'engine/measurements/Card.json').read_text(encoding='utf-8'))
    slices, steps, training = kept['measurements']
    expect(slices['figures'] == {'density, ms': 0.04251, 'nodes, ms': 1234, 'all of it, ms': 2}, f'{slices}')
    expect(slices['command'] == 'neuvv-bench slice performer.nvv' and slices['commit'] == '0123abcd', f'{slices}')
    expect(steps['figures'] == {'512 tiles': 31, '2048 tiles': 100} and steps['commit'] == '4567cdef', f'{steps}')
    expect(training['command'] == 'neuvv train capture -o p.nvv --minutes 8', f'{training}')
    expect(training['figures'] == {'PSNR of held-out views, dB': 35.12}, f'{training}')
    page = (copy / 'engine/MEASUREMENTS.md').read_text(encoding='utf-8')
    expect('- Card: `neuvv-bench slice performer.nvv`, 0123abcd, 2026-12-01' in page, 'the page lacks what was kept')
    expect('|nodes, ms|1234|' in page, 'the page lacks a figure')


def check_refusals(copy):
    report = copy / 'report/report.json'
    report.write_text(json.dumps(dict(REPORT, quick=True)), encoding='utf-8')
    expect('a quick report' in run(copy, '--keep', 'Card', '-o', report.parent, code=2), 'a quick report was kept')
    expect('is not there' in run(copy, '--keep', 'Card', '-o', copy / 'nowhere', code=2), 'there was no report')
    file = copy / 'engine/measurements/H100.json'
    device = json.loads(file.read_text(encoding='utf-8'))
    del device['measurements'][0]['commit']
    file.write_text(json.dumps(device), encoding='utf-8')
    said = run(copy, '--page', code=2)
    expect('H100.json' in said and 'commit' in said and said.count('\n') == 1, said)


def main():
    root = pathlib.Path(sys.argv[1])
    copy = copy_of(root, pathlib.Path(sys.argv[2]))
    check_page(root, copy)
    check_keep(copy)
    check_refusals(copy)


main()
