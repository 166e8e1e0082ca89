"""Published benchmarks of dynamic view synthesis: their protocols, and figures of other methods with their sources.

A protocol names the cameras, frames and images that are trained and measured, and what the metrics are of. What NeuVV
does otherwise stands in `differs`, as (metrics, text): these metrics are not comparable with the published ones. Frames
are counted as the files of the data set are. `source` says where a published figure stands.
"""
import dataclasses

PSNR, SSIM, LPIPS = 'PSNR', 'SSIM', 'LPIPS'
ALL = (PSNR, SSIM, LPIPS)
MEAN = 'mean'  # in place of a scene's name: over all scenes


@dataclasses.dataclass(frozen=True)
class Row:
    """A published method: each metric by scene. What is not published, or not by scene, is left out."""
    method: str
    source: str
    psnr: dict
    ssim: dict = dataclasses.field(default_factory=dict)
    lpips: dict = dataclasses.field(default_factory=dict)

    def values_of(self, metric):
        return {PSNR: self.psnr, SSIM: self.ssim, LPIPS: self.lpips}[metric]


@dataclasses.dataclass(frozen=True)
class Scene:
    """What a protocol says of one scene: the first frame, how many, and the cameras, where these differ by scene."""
    frames: tuple = ()
    test: tuple = ()
    split: str = 'test'
    reduction: int = 0


@dataclasses.dataclass(frozen=True)
class Benchmark:
    title: str
    layout: str           # of `neuvv train --format`
    files: tuple          # patterns of which the folder must have files
    protocol: str         # where it is published
    scenes: dict          # by the name of its folder
    published: tuple = ()
    frames: tuple = ()    # the first and how many; empty: all of them, of the cameras that the files hold out
    train: tuple = ()     # places in the order of the files; empty: all others
    test: tuple = ()      # names; empty: all others
    left_out: tuple = ()  # names of those that neither train nor are measured
    test_step: int = 1    # of the frames, each so many-th is measured
    pairs: object = None  # in place of it, a function of the frames that gives (camera, frame) for each measured image
    reduction: int = 1    # of the original images
    size: tuple = ()      # after that, one of these (width, height)
    background: str = 'white'
    crop: str = 'none'
    differs: tuple = ()
    must_name_scene: bool = False


def by_scene(scenes, values):
    """"1 2 3": a value for each scene and their mean, "-" where there is none."""
    return {name: float(value) for name, value in zip([*scenes, MEAN], values.split()) if value != '-'}


N3DV_SCENES = ('coffee_martini', 'cook_spinach', 'cut_roasted_beef', 'flame_salmon', 'flame_steak', 'sear_steak')
EX4DGS = 'Ex4DGS, arXiv:2410.15629, Table 1'
FREETIMEGS = 'FreeTimeGS, arXiv:2506.05348, Table 1'


def n3dv_row(method, psnr):
    return Row(method, EX4DGS, by_scene(N3DV_SCENES, psnr))


N3DV = Benchmark(
    title='Neural 3D Video (N3DV)', layout='n3v', files=('poses_bounds.npy', 'cam*'),
    protocol='the centre camera is held out, 300 frames at half of the resolution: arXiv:2410.15629, section 5.1',
    scenes={name: Scene() for name in N3DV_SCENES}, frames=(0, 300), test=('cam00',), reduction=2, size=((1352, 1014),),
    published=(
        n3dv_row('HyperReel', '28.37 32.30 32.92 28.26 32.20 32.57 31.10'),
        n3dv_row('K-Planes', '29.99 32.60 31.82 30.44 32.38 32.52 31.63'),
        n3dv_row('MixVoxels-X', '30.39 32.31 32.63 30.60 32.10 32.33 31.73'),
        n3dv_row('4DGaussians', '27.34 32.46 32.90 29.20 32.51 32.49 31.15'),
        n3dv_row('4DGS', '28.33 32.93 33.85 29.38 34.03 33.51 32.01'),
        n3dv_row('Ex4DGS', '28.79 33.23 33.73 29.29 33.91 33.69 32.11'),
        Row('STGS', FREETIMEGS, {MEAN: 32.05}, lpips={MEAN: 0.044}),
        Row('FreeTimeGS', FREETIMEGS, {MEAN: 33.19}, lpips={MEAN: 0.036})),
    differs=((ALL, 'of the performer alone, as the mattes cut it out, over white; published: of whole images'),))

DNERF_SCENES = ('hellwarrior', 'mutant', 'hook', 'bouncingballs', 'lego', 'trex', 'standup', 'jumpingjacks')
DEFORMABLE = 'Deformable 3DGS, arXiv:2309.13101, Table 1'


def dnerf_row(method, psnr):
    return Row(method, DEFORMABLE, by_scene(DNERF_SCENES, psnr))


DNERF = Benchmark(
    title='D-NeRF', layout='nerf', files=('transforms_train.json', 'transforms_test.json'),
    protocol='the files\' own test images, of lego the validation images, at 800×800 over black: arXiv:2309.13101, '
             'Tables 1 and 8, and github.com/ingra14m/Deformable-3D-Gaussians',
    scenes={name: Scene(split='val' if name == 'lego' else 'test') for name in DNERF_SCENES}, size=((800, 800),),
    background='black',
    published=(
        dnerf_row('3D-GS', '29.89 24.53 21.71 23.20 22.10 21.93 21.91 20.64'),
        dnerf_row('D-NeRF', '24.06 30.31 29.02 38.17 25.56 30.61 33.13 32.70'),
        dnerf_row('TiNeuVox', '27.10 31.87 30.61 40.23 26.64 31.25 34.61 33.49'),
        dnerf_row('Tensor4D', '31.26 29.11 28.63 24.47 23.24 23.86 30.56 24.20'),
        dnerf_row('K-Planes', '24.58 32.50 28.12 40.05 28.91 30.43 33.10 31.11'),
        dnerf_row('Deformable 3DGS', '41.54 42.63 37.42 41.01 33.07 38.10 44.62 37.72 39.51')))

ZJU_SCENES = ('313', '315', '392', '393', '394', '377', '386', '390', '387')
ZJU_FRAMES = {'313': (0, 60), '315': (0, 400), '390': (700, 300)}
NEURAL_BODY = 'github.com/zju3dv/neuralbody, supplementary_material.md'


def zju_row(method, psnr, ssim):
    return Row(method, NEURAL_BODY, by_scene(ZJU_SCENES, psnr), by_scene(ZJU_SCENES, ssim))


ZJU = Benchmark(
    title='ZJU-MoCap', layout='easymocap', files=('intri.yml', 'extri.yml'),
    protocol='cameras 0, 6, 12 and 18 train, the others are measured every 30 frames, at 512×512 over black: '
             + NEURAL_BODY,
    scenes={name: Scene(frames=ZJU_FRAMES.get(name, (0, 300))) for name in ZJU_SCENES}, frames=(0, 300),
    train=(0, 6, 12, 18), test_step=30, reduction=2, size=((512, 512),), background='black', crop='rectangle',
    published=(
        zju_row('Neural Volumes', '20.09 18.57 22.88 21.29 22.08 21.15 23.21 22.49 20.74 21.39',
                '0.831 0.824 0.726 0.842 0.843 0.842 0.820 0.825 0.838 0.821'),
        zju_row('Multi-view Neural Human Rendering', '26.68 19.81 24.73 23.47 25.01 23.79 25.02 23.72 22.65 23.87',
                '0.935 0.874 0.902 0.894 0.906 0.918 0.879 0.873 0.858 0.893'),
        zju_row('Deferred Neural Human Rendering', '25.78 19.44 24.96 23.50 24.84 23.74 24.93 24.33 22.44 23.77',
                '0.929 0.869 0.905 0.896 0.903 0.917 0.877 0.881 0.888 0.896'),
        zju_row('Neural Body', '30.56 27.24 29.44 27.58 28.44 27.64 28.60 27.59 25.79 28.10',
                '0.971 0.962 0.946 0.939 0.940 0.951 0.931 0.926 0.928 0.944')),
    differs=((ALL, 'of the rectangle around the matte; published: of the pixels in the projected box of the body, '
              'which is larger'),
             ((SSIM,), 'of a Gaussian window of 11×11; published: of a uniform one of 7×7, for values from -1 to 1'),
             ((LPIPS,), 'by AlexNet; published: by VGG')))

# Indices from 0, as in HumanRF's actorshq/evaluation/presets.py; cameras are called by index + 1.
ACTORSHQ_HERO = 126
ACTORSHQ_LANDSCAPE = (0, 63, 97, 30, 13, 70, 114, 24, 84, 43, 64, 103, 57)
ACTORSHQ_LEFT_OUT = (10, 19, 33, 44, 50, 73, 83, 90, 104, 117, 128, 129, 136, 137, 144, 145, 146, 147, 152, 153, 154,
                     155)
HUMANRF = 'synthesiaresearch.github.io/humanrf, numerical results, 20 frames'


def actorshq_camera(index):
    return f'Cam{index + 1:03}'


def actorshq_pairs(frames):
    """The measured images: of the upright camera every third frame, of the others one every fifth frame in turn."""
    hero = {(actorshq_camera(ACTORSHQ_HERO), frame) for frame in frames[::3]}
    turns = {(actorshq_camera(ACTORSHQ_LANDSCAPE[i % len(ACTORSHQ_LANDSCAPE)]), frame)
             for i, frame in enumerate(frames[::5])}
    return hero | turns


ACTORSHQ = Benchmark(
    title='ActorsHQ', layout='actorshq', files=('calibration.csv', 'rgbs', 'masks'),
    protocol='HumanRF\'s cameras, frames 15 to 34 and measured images, PSNR of the masks\' pixels: '
             'github.com/synthesiaresearch/humanrf, actorshq/evaluation',
    scenes={}, frames=(15, 20),
    test=tuple(actorshq_camera(index) for index in sorted((*ACTORSHQ_LANDSCAPE, ACTORSHQ_HERO))), pairs=actorshq_pairs,
    left_out=tuple(map(actorshq_camera, ACTORSHQ_LEFT_OUT)), background='black', crop='matte',
    published=tuple(Row(method, HUMANRF, {MEAN: psnr}) for method, psnr in (
        ('HyperNeRF', 25.70), ('TiNeuVox', 26.07), ('NDVG', 26.60), ('Neural Body', 27.03), ('TAVA', 27.44),
        ('Instant-NGP', 29.45), ('HumanRF', 30.30))),
    differs=((ALL, 'of this sequence at this scale; the source says neither scale nor sequences'),))

FOUR_K = '4K4D, arXiv:2310.11448, Table 1'
DNA = Benchmark(
    title='DNA-Rendering', layout='easymocap', files=('intri.yml', 'extri.yml', 'images', 'masks'),
    protocol='cameras 11, 25, 37 and 57 are held out and measured every 20 frames of 150, over white: '
             'github.com/zju3dv/im4d, configs/components/datasets/base_dataset.yaml; arXiv:2310.11448, section 5',
    scenes={}, frames=(0, 150), test=('11', '25', '37', '57'), test_step=20, reduction=2,
    size=((1024, 1224), (1224, 1024), (1125, 1536), (1536, 1125)), crop='rectangle',
    published=(
        Row('K-Planes', FOUR_K, {MEAN: 27.452}, {MEAN: 0.952}, {MEAN: 0.118}),
        Row('IBRNet', FOUR_K, {MEAN: 27.844}, {MEAN: 0.967}, {MEAN: 0.081}),
        Row('ENeRF', FOUR_K, {MEAN: 28.108}, {MEAN: 0.972}, {MEAN: 0.056}),
        Row('Im4D', FOUR_K, {MEAN: 28.991}, {MEAN: 0.973}, {MEAN: 0.062}),
        Row('4K4D', FOUR_K + ', and 4 (0013_01)', {MEAN: 31.173, '0013_01': 31.990}, {MEAN: 0.976, '0013_01': 0.982},
            {MEAN: 0.055, '0013_01': 0.040})),
    differs=((ALL, 'of the rectangle around the matte; published: of the projected box of the body, and of cameras 48 '
              'to 59 at 0.375 of their size'),))

FREETIMEGS_DYNAMIC = 'FreeTimeGS, arXiv:2506.05348, Table 3, dynamic regions'
SELFCAP = Benchmark(
    title='SelfCap', layout='easymocap', files=('intri.yml', 'extri.yml'),
    protocol='one camera is held out, 60 frames, the dynamic region over black: arXiv:2506.05348, section 5, and '
             'README.md of the data set',
    scenes={'dance1': Scene((4120, 60), ('0015',)), 'dance2': Scene((5530, 60), ('0015',)),
            'corgi1': Scene((200, 60), ('0007',)), 'corgi2': Scene((2950, 60), ('0007',)),
            'bike1': Scene((8900, 60), ('0009',), reduction=1), 'bike2': Scene((30020, 60), ('0009',), reduction=1)},
    reduction=2, must_name_scene=True, background='black', crop='rectangle',
    published=(
        Row('Deformable 3DGS', FREETIMEGS_DYNAMIC, {MEAN: 25.27}, lpips={MEAN: 0.139}),
        Row('STGS', FREETIMEGS_DYNAMIC, {MEAN: 25.32}, lpips={MEAN: 0.123}),
        Row('4DGS', FREETIMEGS_DYNAMIC, {MEAN: 26.75}, lpips={MEAN: 0.104}),
        Row('FreeTimeGS', FREETIMEGS_DYNAMIC, {MEAN: 29.38}, lpips={MEAN: 0.080})),
    differs=((ALL, 'of the rectangle around the matte; published: of that of another matte, and black outside of it'),
             (ALL, 'of images with the focal length of the files; published: undistorted by COLMAP, without blank '
              'pixels')))

BENCHMARKS = {'n3dv': N3DV, 'dnerf': DNERF, 'zju': ZJU, 'dna': DNA, 'actorshq': ACTORSHQ, 'selfcap': SELFCAP}


def value_text(metric, value):
    return '' if value is None else f'{value:.{2 if metric == PSNR else 3}f}'


def published_row(row, scene):
    """The cells of a row: figures of the scene, else means, with a star."""
    cells = []
    for metric in ALL:
        values = row.values_of(metric)
        cells.append(value_text(metric, values.get(scene, values.get(MEAN))))
        if scene not in values and MEAN in values:
            cells[-1] += '*'
    return [row.method, *cells, row.source]


def table(benchmark, scene, ours=None, differs=()):
    """Markdown. `ours`: the name of our row, and its values by metric, None where it has none."""
    rows = [row for row in (published_row(one, scene) for one in benchmark.published) if any(row[1:4])]
    starred = any(cell.endswith('*') for row in rows for cell in row[1:4])
    not_comparable = {metric for metrics, _ in differs for metric in metrics}
    if ours:
        cells = [value_text(metric, ours[1].get(metric)) for metric in ALL]
        cells = [f'({cell})' if cell and metric in not_comparable else cell for metric, cell in zip(ALL, cells)]
        rows.append([f'**{ours[0]}**', *cells, 'this run'])
    title = f'{benchmark.title}: {scene}' if scene else benchmark.title
    lines = [f'|{title}|PSNR dB|SSIM|LPIPS|source|', '|---|---|---|---|---|']
    lines += ['|' + '|'.join(row) + '|' for row in rows]
    if starred:
        lines += ['', '\\* mean over the scenes of the source']
    if ours and not_comparable:
        lines += ['', 'In parentheses: not comparable with the published figures. What differs:', '']
        lines += [f'- {", ".join(metrics)} {text}' for metrics, text in differs]
    return '\n'.join(lines) + '\n'


def overview():
    """All benchmarks with what is published."""
    text = ''
    for name, one in BENCHMARKS.items():
        text += f'# {name}: {one.title}\n\n{one.protocol}.\n\n'
        scenes = [scene for scene in one.scenes if any(scene in row.psnr for row in one.published)]
        text += '\n'.join(table(one, scene) for scene in scenes or ['']) + '\n'
    return text
