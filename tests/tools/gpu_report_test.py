#!/usr/bin/env python3
"""tools/gpu-report, shortened: small images, a training of a second, no tests; and a folder that is carried elsewhere.

    gpu_report_test.py tools/gpu-report output-folder
"""
import importlib.machinery
import importlib.util
import json
import pathlib
import shutil
import subprocess
import sys

BENCHES = ['render', 'walk', 'slice', 'stereo', 'xr', 'stage', 'open', 'play', 'instances', 'train 512']


def expect(holds, what):
    if not holds:
        sys.exit(f'gpu_report_test: {what}')


def run(command):
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    expect(done.returncode == 0, f'{command} ended with {done.returncode}: {done.stdout}{done.stderr}')
    return done.stdout


def part_of(report, name):
    found = [part for part in report['parts'] if part['name'] == name]
    expect(len(found) == 1, f'{len(found)} parts are named {name}')
    return found[0]


def check_quick_report(tool, folder):
    run([tool, '--preset', 'test', '--quick', '--skip', 'tests', '--minutes', '0.04', '--output', folder])
    report = json.loads((folder / 'report.json').read_text(encoding='utf-8'))
    expect(report['failed'] == [], f'failed: {report["failed"]}')
    expect(part_of(report, 'tests')['skipped'] == 'by --skip', 'it must say what it skipped')
    for bench in BENCHES:
        expect(part_of(report, f'bench {bench}').get('figures'), f'bench {bench} has no figures')
    ratios = report['for_each_tb_s']
    for name in ('bench render shaded', 'bench stereo stereo', 'bench train 512'):
        expect(ratios.get(name, 0) > 0, f'{name} is not compared with a copy: {ratios}')
    expect(report['shares_of_a_copy'].get('bench render trace', 0) > 0, 'the trace is not compared with a copy')
    expect(report['validation_messages'] is None, 'no test has run')
    expect(report['device_facts']['buffers']['max_storage_bytes'] > 0, 'limits are missing')
    page = (folder / 'report.html').read_text(encoding='utf-8')
    expect('bench train 512' in page and 'Mrays/s for each TB/s' in page, 'the page lacks figures')


def check_pack(tool, folder):
    """A packed folder runs by itself, and says that there is no scene to measure."""
    shutil.rmtree(folder, ignore_errors=True)
    run([tool, '--pack', folder])
    said = run([folder / 'tools/gpu-report', '--preset', 'test', '--skip', 'tests,trainings', '--output', folder / 'out'])
    expect('no scene was trained' in said, said)
    report = json.loads((folder / 'out/report.json').read_text(encoding='utf-8'))
    expect(report['device'] and report['version'] != 'unknown', 'device or version is missing')
    expect(list((folder / 'lib').glob('libVkLayer_khronos_validation*')), 'the validation layers were not packed')
    shutil.rmtree(folder)


def check_validation_messages(tool, folder):
    loader = importlib.machinery.SourceFileLoader('gpu_report', tool)
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader('gpu_report', loader))
    loader.exec_module(module)
    folder.mkdir(parents=True, exist_ok=True)
    report = module.Report(folder, '', {'device': 'a device', 'date': '', 'version': ''})
    report.run('gpu_test', ['/bin/echo', 'ok'], 60)
    expect(report.validation_messages() == [], 'a quiet test has messages')
    report.run('render_test.1', ['/bin/echo', 'Validation Error: [ VUID-vkCmdDraw-None-02859 ] ... '
                                 '#VUID-vkCmdDraw-None-02859)\nValidation Error: [ SYNC-HAZARD-WRITE-AFTER-READ ]'], 60)
    expect(report.validation_messages() == ['SYNC-HAZARD-WRITE-AFTER-READ', 'VUID-vkCmdDraw-None-02859'],
           f'{report.validation_messages()}')
    expect('VUID-vkCmdDraw-None-02859.' in (folder / 'report.html').read_text(encoding='utf-8'), 'the page does not tell')


def main():
    tool, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    check_validation_messages(tool, folder / 'messages')
    check_quick_report(tool, folder / 'quick')
    check_pack(tool, folder / 'packed')


main()
