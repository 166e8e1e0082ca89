#!/usr/bin/env python3
"""The commands of the guide and of the README, checked from their text, in their order.

    tests/tools/guide_test.py NEUVV NEUVV-BENCH ROOT

Each option must be one that the help of its verb lists. Each file that a command reads must be in the repository, made by
an earlier command or by tools/demo, or be the reader's own: its name is in capitals. No command may write what is there
without --overwrite or --resume.

The pages of the guide are those that tools/GUIDE.md links to, in that order. Their commands are also run, in one folder, where
small files stand in for what takes long to make. A block with a command that cannot be run has a line before it,

    <!-- not run: the reason -->

and no other block may have it. What such a block has besides is run, too.

Of the README, the first task is run, with smaller images and fewer steps than it has, in a folder of its own.

Of commands and options between the lines, in `backquotes`, the names are checked: an option must be one of a command of its page.
"""
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

OUTPUT_OPTIONS = {'-o', '--output', '--json', '--html', '--csv', '--images', '--preview', '--metrics', '--web'}
EDITORS = {'stage', 'paint'}  # which write into what is there
MADE_BY_DEMO = ['performer.mp4', 'stage.mp4', 'stage.gltf', 'coach.mp4', 'coach.html', 'contact_sheet.png', 'metrics.json',
                'performer.nvv', 'performer.nvs', 'web', 'capture']
MADE_BY_CAPTURE = ['images', 'transforms_train.json', 'transforms_test.json', 'skeleton.glb']
QUICK = {'devices', 'info', 'dataset', 'eval', 'stage', 'paint', 'clip'}  # verbs that take seconds at most
QUICK_SKELETON = {'import', 'export', 'compare'}
QUICK_EXPORTS = {'camera', 'nerfstudio', 'instant-ngp', 'layout'}
# A clip of more than a second, and the data set that it was trained on.
SMALL_CAPTURE = 'capture tools/performer/performer.glb -o small/performer --cameras 6 --frames 28 --size 64x64'
SMALL_TRAINING = 'train small/performer -o small/performer.nvv --steps 30'
OTHERS_OPTIONS = {'--enable-recovery', '--allow-run-as-root', '--mca', '--bind-to'}  # of mpirun
NOT_RUN = re.compile(r'<!-- not run: \w.* -->')
failed = []


def fail(where, text):
    failed.append(f'{where}: {text}')


class Block:
    """Consecutive lines that are indented by four spaces; `lines` has those that a backslash continues as one, with its number."""

    def __init__(self, page, number, marked):
        self.where, self.page, self.number, self.marked, self.lines = f'{page.name}:{number}', page, number, marked, []

    def add(self, number, line):
        if self.lines and self.lines[-1][1].endswith('\\'):
            self.lines[-1] = (self.lines[-1][0], self.lines[-1][1][:-1] + line.strip())
        else:
            self.lines.append((f'{self.page.name}:{number}', line.strip()))


def blocks(page):
    found, before, block = [], '', None
    for number, line in enumerate(page.read_text(encoding='utf-8').splitlines(), 1):
        if line.startswith('    '):
            if block is None:
                block = Block(page, number, bool(NOT_RUN.fullmatch(before)))
                found.append(block)
            block.add(number, line)
        else:
            block = None
            if NOT_RUN.fullmatch(before) and line:
                fail(f'{page.name}:{number}', 'no commands follow the line "not run"')
        before = line if line else before
    return found


def commands(line):
    """The program and the words of each command of a line, without comments and what neither reads nor writes files."""
    for part in re.split(r'&&|[|;&()]', re.sub(r'\s#\s.*', '', line)):
        words = shlex.split(part) if part.strip() else []
        for name in ('neuvv', 'neuvv-bench', 'build/release/neuvv'):
            if name in words[:-1]:
                yield name.split('/')[-1], words[words.index(name) + 1:], words[0] == name
                break
        else:
            if words[:1] == ['cp'] or words and words[0].startswith('tools/'):
                yield words[0], words[1:], words[0] == 'cp'


def can_run(program, words):
    """Whether a command takes seconds at most, and needs nothing but the repository and what stands in for other results."""
    verb, *rest = words[2:] if words[:1] == ['--device'] else words or ['']
    output = words[words.index('-o') + 1] if '-o' in words[:-1] else ''
    if any(re.search('[A-Z]{3}', word) for word in words):  # the reader's own
        return False
    return (program == 'cp' or program == 'neuvv' and (
        verb in QUICK and '--rig' not in rest
        or verb == 'train' and '--plan' in rest
        or verb == 'skeleton' and rest[0] in QUICK_SKELETON
        or verb == 'export' and '--as' in rest and rest[rest.index('--as') + 1] in QUICK_EXPORTS
        or verb == 'render' and '--capture' not in rest and not rest[0].endswith('.npz') and (
            'list' in rest or '--frames' in rest and output.endswith(('.png', '.exr')) and '%' not in output)))


class Checker:
    def __init__(self, programs, root):
        self.programs, self.root, self.helps, self.checked = programs, root, {}, 0

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
        if program.startswith('tools/'):
            return self.check_script(where, program, words, made)
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

    def check_script(self, where, program, words, made):
        if not os.access(self.root / program, os.X_OK):
            return fail(where, f'there is no {program}')
        text = (self.root / program).read_text(encoding='utf-8')
        for before, word in zip(['', *words], words):
            if word.startswith('work') and before != '-o':
                self.expect_there(where, word, made)
            elif not re.search('[A-Z]{3}|^work', word) and word not in text:
                fail(where, f'{program} knows no {word}')

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


class Runner:
    """Runs commands in a folder of its own, with the repository's tools beside, and small files in place of large results."""

    def __init__(self, program, root, folder):
        self.program, self.root, self.folder, self.ran = pathlib.Path(program).resolve(), root, folder, 0
        (folder / 'tools').symlink_to(root / 'tools')
        (folder / 'work').mkdir()
        for command in (SMALL_CAPTURE, SMALL_TRAINING):
            self.run('guide_test', 'neuvv', shlex.split(command))

    def run(self, where, program, words):
        if program == 'cp':
            shutil.copy(self.folder / words[0], self.folder / words[1])
            return
        done = subprocess.run([self.program, *words], cwd=self.folder, capture_output=True, text=True, check=False)
        self.ran += 1
        if done.returncode != 0:
            fail(where, f'`neuvv {shlex.join(words)}` ends with {done.returncode}: {done.stderr.strip()[-400:]}')
        return done.stdout + done.stderr

    def stand_in(self, words):
        """Puts small files where a command that is not run would write its results."""
        for option, name in zip(words, words[1:]):
            there = self.folder / name
            if option != '-o' or not name.startswith('work/') or there.exists():
                continue
            there.parent.mkdir(parents=True, exist_ok=True)
            if words[0] == 'capture':
                shutil.copytree(self.folder / 'small/performer', there)
            elif name.endswith('.nvv'):
                shutil.copy(self.folder / 'small/performer.nvv', there)
            elif name.endswith('.nvs'):
                shutil.copy(self.root / 'tests/stream/vectors/usual.nvs', there)


def check_block(block, checker, runner, made):
    all_run = True
    for where, line in block.lines:
        found = [command for command in commands(line) if '...' not in command[1]]
        if not found and runner:
            fail(where, 'is no command that this test knows')
        alone = len(found) == 1 and not re.search(r'[|;&()]', re.sub(r"\s#\s.*|'[^']*'", '', line))
        for program, words, first in found:
            checker.check(where, program, words, made)
            checker.checked += 1
            if runner and first and alone and can_run(program, words):
                runner.run(where, program, words)
            elif runner:
                all_run = False
                runner.stand_in(words)
    if runner and all_run == block.marked:
        fail(block.where, 'all of it can be run: remove the line "not run"' if all_run else
             'something of it cannot be run: write <!-- not run: REASON --> before it')


def run_first_task(page, runner, folder):
    """Runs the README's first task, and expects that the mistakes of its studio are found, as it says."""
    (folder / 'work').mkdir(parents=True)
    (folder / 'tools').symlink_to(runner.root / 'tools')
    runner.folder, said = folder, ''
    lines = page.read_text(encoding='utf-8').split('### 2.')[0].splitlines()
    first = next(number for number, line in enumerate(lines) if line.startswith('### 1.'))
    for block in blocks(page):
        for where, line in block.lines if first < block.number <= len(lines) else []:
            for program, words, _ in commands(line):
                if words[0] == 'view':
                    continue
                for option, other in (('--size', ['--size', '96x96']), ('--minutes', ['--steps', '10'])):
                    if option in words:
                        at = words.index(option)
                        words[at:at + 2] = other
                said += runner.run(where, program, words)
    for expected in ('does not show what the images of camera', 'seem to be swapped', 'mean '):
        if expected not in said:
            fail(page.name, f'the first task never says "{expected}"')


def check_prose(page, checker):
    """Commands and options that the text between the blocks names."""
    text = '\n'.join(line for line in page.read_text(encoding='utf-8').splitlines() if not line.startswith('    '))
    codes = re.findall(r'`([^`]+)`', text)
    lines = [line for block in blocks(page) for _, line in block.lines]
    known = set(OTHERS_OPTIONS)
    for program, words, _ in [command for line in lines + codes for command in commands(line)]:
        if program in checker.programs:
            after = words.index('--') + 1 if '--' in words else 0  # neuvv cluster sbatch -- train …
            for own in (words[2:] if words[:1] == ['--device'] else words, words[after:]):
                known |= checker.help_of(program, checker.verbs_of(program, own))[0]
        elif program.startswith('tools/'):
            known |= set(re.findall('--[a-z-]+', (checker.root / program).read_text(encoding='utf-8')))
    for code in codes:
        for option in re.findall(r'(?<![\w-])--[a-z][a-z-]*', code):
            if option not in known:
                fail(page.name, f'no command of this page has {option} (`{code}`)')


def pages_of_guide(root):
    contents = root / 'tools/GUIDE.md'
    pages = [contents.parent / name for name in re.findall(r'\((guide/[a-z]+\.md)\)', contents.read_text(encoding='utf-8'))]
    for page in sorted(set((root / 'tools/guide').glob('*.md')) - set(pages)):
        fail('GUIDE.md', f'does not link to {page.name}')
    return pages


def main():
    programs, root = {'neuvv': sys.argv[1], 'neuvv-bench': sys.argv[2]}, pathlib.Path(sys.argv[3]).resolve()
    checker = Checker(programs, root)
    by_demo = {f'demo/{name}' for name in MADE_BY_DEMO} | {'work', 'build/release/neuvv'}
    with tempfile.TemporaryDirectory() as folder:
        runner, made = Runner(programs['neuvv'], root, pathlib.Path(folder)), set(by_demo)
        for page in pages_of_guide(root):
            for block in blocks(page):
                check_block(block, checker, runner, made)
            check_prose(page, checker)
        run_first_task(root / 'README.md', runner, pathlib.Path(folder) / 'day')
    for block in blocks(root / 'README.md'):
        check_block(block, checker, None, by_demo)
    if checker.checked < 100 or runner.ran < 40:
        fail('guide_test', f'only {checker.checked} commands were found, and {runner.ran} run')
    print('\n'.join(failed) or f'{checker.checked} commands are as the program has them; {runner.ran} were run')
    return 1 if failed else 0


sys.exit(main())
