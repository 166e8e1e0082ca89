#!/usr/bin/env python3
"""The commands of the guide and of the README, checked from their text, in their order.

    tests/tools/guide_test.py NEUVV NEUVV-BENCH ROOT

Each option must be one that the help of its verb lists. Each file that a command reads must be in the repository, made by
an earlier command or by tools/demo, or be the reader's own: its name is in capitals. No command may write what is there
without --overwrite or --resume. Then the commands that take no time are run: those that need neither a device nor a clip.
"""
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

OUTPUT_OPTIONS = {'-o', '--output', '--json', '--html', '--csv', '--images', '--preview', '--metrics'}
EDITORS = {'stage', 'paint'}  # which write into what is there
MADE_BY_DEMO = ['performer.mp4', 'stage.mp4', 'stage.gltf', 'coach.mp4', 'coach.html', 'contact_sheet.png', 'metrics.json',
                'performer.nvv', 'performer.nvs', 'capture']
MADE_BY_CAPTURE = ['images', 'transforms_train.json', 'transforms_test.json', 'skeleton.glb']
CHEAP = [('skeleton', 'import'), ('skeleton', 'export'), ('skeleton', 'compare'), ('stage', 'new'), ('stage', 'light'),
         ('stage', 'path'), ('export', '--as', 'camera'), ('export', '--as', 'nerfstudio'), ('info',)]
failed = []


def fail(where, text):
    failed.append(f'{where}: {text}')


def blocks(page):
    """The commands of a page: lines that are indented by four spaces, with those that a backslash continues."""
    lines, number = page.read_text(encoding='utf-8').splitlines(), 0
    while number < len(lines):
        start, line = number + 1, lines[number]
        while line.endswith('\\'):
            number += 1
            line = line[:-1] + lines[number]
        number += 1
        if line.startswith('    ') and re.search(r'\b(neuvv|neuvv-bench)\b', line):
            yield f'{page.name}:{start}', line.strip()
        elif line.startswith('    cp '):
            yield f'{page.name}:{start}', line.strip()


def commands(line):
    """The words of each command of a line, without comments, `mpirun …` and what follows a pipe."""
    for part in re.split(r'&&|[|;&()]', re.sub(r'\s#\s.*', '', line)):
        words = shlex.split(part) if part.strip() else []
        for name in ('neuvv', 'neuvv-bench', 'build/release/neuvv'):
            if name in words:
                yield name.split('/')[-1], words[words.index(name) + 1:]
                break
        if words[:1] == ['cp']:
            yield 'cp', words[1:]


class Checker:
    def __init__(self, programs, root):
        self.programs, self.root, self.helps = programs, root, {}

    def help_of(self, program, verbs):
        """The options of a verb, and whether there are verbs below it."""
        key = (program, *verbs)
        if key not in self.helps:
            done = subprocess.run([self.programs[program], *verbs, '--help'], capture_output=True, text=True, check=False)
            text = done.stdout
            options = set(re.findall(r'(?<![\w-])(--?[a-z][a-z-]*)', text)) | {'--device', '--overwrite', '--trace'}
            below = re.findall(r'(?m)^  ([a-z]+) {2,}', text)
            self.helps[key] = (options, set(below), done.returncode)
        return self.helps[key]

    def verbs_of(self, program, words):
        verbs = []
        for word in words:
            if not re.fullmatch('[a-z]+', word) or word not in self.help_of(program, verbs)[1]:
                break
            verbs.append(word)
        return verbs

    def check(self, where, program, words, made):
        if program == 'cp':
            self.expect_there(where, words[0], made)
            made.add(words[1])
            return
        if words[:1] == ['--device']:
            words = words[2:]
        verbs = self.verbs_of(program, words)
        if not verbs:
            return fail(where, f'there is no verb in: {program} {" ".join(words)}')
        own = words[:words.index('--')] if '--' in words else words
        for word in own:
            name = word.split('=')[0]
            if re.match('--?[a-z]', word) and name not in self.help_of(program, verbs)[0]:
                fail(where, f'`{program} {" ".join(verbs)}` has no option {name}')
        if '--' in words:  # neuvv cluster sbatch -- train …
            return self.check(where, program, words[words.index('--') + 1:], made)
        self.check_files(where, verbs, words[len(verbs):], made)

    def check_files(self, where, verbs, words, made):
        outputs = {words[i + 1].replace('{performer}', 'anna') for i, word in enumerate(words[:-1])
                   if word in OUTPUT_OPTIONS} - {'-'}
        words = [word.replace('{performer}', 'anna') for word in words]
        if verbs == ['stage', 'new']:
            outputs.add(words[0])
        if verbs[0] == 'paint' and verbs[-1] in ('region', 'brush', 'project', 'erase', 'restore'):
            made.add(words[1])  # the layer
        for output in sorted(outputs):
            shared = {'--overwrite', '--resume', '--part'} & set(words) or verbs[0] in EDITORS and verbs[-1] != 'new'
            if output in made and not shared:
                fail(where, f'{output} is there already')
        for word in words:
            for path in re.split('[,:]', word) if not word.startswith(('http', '-')) else []:
                if '/' in path and not re.fullmatch(r'\d+/\d+', path) and path not in outputs and word not in outputs:
                    self.expect_there(where, path, made)
        made |= outputs
        if verbs == ['capture'] or verbs == ['skeleton', 'views']:
            made |= {f'{output}/{name}' for output in outputs for name in MADE_BY_CAPTURE}
        if '--plan' in words:
            made -= outputs

    def expect_there(self, where, path, made):
        if any(re.search('[A-Z]{3}', part) for part in path.split('/')):  # the reader's own
            return
        numbered = re.sub(r'%0\d*d', '0000', path)
        known = {re.sub(r'%0\d*d', '0000', one) for one in made}
        if numbered not in known and path.rstrip('/') not in known and not (self.root / path).exists():
            fail(where, f'nothing has made {path}')


def is_cheap(words):
    return any(words[:1] == [case[0]] and all(part in words for part in case) for case in CHEAP)


def run_cheap(programs, root, lines):
    """Runs them in a folder of their own, with the repository's tools beside; those whose files were not made there are left out."""
    with tempfile.TemporaryDirectory() as folder:
        here, ran = pathlib.Path(folder), 0
        (here / 'tools').symlink_to(root / 'tools')
        for where, program, words in lines:
            paths = [word for word in words if word.startswith('work/')]
            outputs = {words[i + 1] for i, word in enumerate(words[:-1]) if word in OUTPUT_OPTIONS}
            if words[:2] == ['stage', 'new']:
                outputs.add(words[2])
            if program != 'neuvv' or not is_cheap(words) or any(
                    not (here / path).exists() for path in paths if path not in outputs):
                continue
            done = subprocess.run([programs['neuvv'], *words], cwd=here, capture_output=True, text=True, check=False)
            ran += 1
            if done.returncode != 0:
                fail(where, f'{done.stderr.strip()}')
        if ran < 10:
            fail('guide_test', f'only {ran} commands could be run')


def main():
    programs, root = {'neuvv': sys.argv[1], 'neuvv-bench': sys.argv[2]}, pathlib.Path(sys.argv[3])
    checker = Checker(programs, root)
    checked = 0
    for page in (root / 'tools/GUIDE.md', root / 'README.md'):
        made = {f'demo/{name}' for name in MADE_BY_DEMO} | {'work', 'work/views/key_points', 'build/release/neuvv'}
        lines = [(where, *command) for where, line in blocks(page) for command in commands(line)]
        for where, program, words in lines:
            if '...' in words or not words:
                continue
            checker.check(where, program, words, made)
            checked += 1
        if page.name == 'GUIDE.md':
            run_cheap(programs, root, lines)
    if checked < 100:
        fail('guide_test', f'only {checked} commands were found')
    print('\n'.join(failed) or f'{checked} commands are as the program has them')
    return 1 if failed else 0


sys.exit(main())
