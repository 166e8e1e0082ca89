#!/usr/bin/env python3
"""Makes intri.yml and extri.yml of ZJU-MoCap's annots.npy.

    python3 zju_mocap.py FOLDER

annots.npy is a pickle, which can run any program when it is opened: convert only files that you trust.
"""

import pathlib
import sys

import numpy as np


def matrix(key, m):
    return f"{key}: !!opencv-matrix\n  rows: {m.shape[0]}\n  cols: {m.shape[1]}\n  dt: d\n  data: {m.ravel().tolist()}\n"


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    cams = np.load(folder / "annots.npy", allow_pickle=True).item()["cams"]
    names = [f"Camera_B{i + 1}" for i in range(len(cams["K"]))]
    with open(folder / "intri.yml", "w") as intri, open(folder / "extri.yml", "w") as extri:
        intri.write("%YAML:1.0\n---\nnames: " + str(names) + "\n")
        extri.write("%YAML:1.0\n---\n")
        for i, name in enumerate(names):
            K, D, R, T = (np.array(cams[k][i], float) for k in "KDRT")
            intri.write(matrix("K_" + name, K) + matrix("D_" + name, D.reshape(-1, 1)))
            extri.write(matrix("Rot_" + name, R) + matrix("T_" + name, T.reshape(3, 1) / 1000))


if __name__ == "__main__":
    main()
